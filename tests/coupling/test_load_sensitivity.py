"""Gradients of the operating point by adjoints, against central differences of equilibria that are solved anew."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from own_statics import FULL, STEEL, TEETH, linear_bearing, one_stage, toothed
from planetary_machines import set_parts

from gearwhine.coupling import CouplingError, Machine, MountedBearing, Shaft, ShaftGear, machine_description
from gearwhine.coupling.errors import EquilibriumNotFoundError
from gearwhine.coupling.gears import ConstantStiffness
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.linear.line_outputs import SensorAmplitude
from gearwhine.coupling.linear.line_sensitivity import Line, LineModel
from gearwhine.coupling.linear.mesh_harmonics import Response
from gearwhine.coupling.load_analysis.ranking import solve_load_sensitivity
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.machine.pins import PinSprings
from gearwhine.coupling.statics import operating_point_search
from gearwhine.coupling.statics.operating_point import OperatingPoint, PairLoad
from gearwhine.coupling.statics.sensitivity import OUTCOMES, Adjoint, adjoint, pair_adjoints, tilt_adjoint
from gearwhine.coupling.statics.static_model import ConnectorLaw, LinearLaw, StaticBearing, static_bearing
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Pedestal, Rotor, Segment
from gearwhine.rotors.rolling_bearings import BallRow, paired

GRAVITY = (1.0, -9.81, 0.3)
JOURNAL = np.pad([[2.0e7, 3.5e7], [-1.2e7, 6.0e7]], (0, 3)) + np.diag([0.0, 0.0, 1e7, 0.0, 0.0])


def on_pedestals() -> Machine:
    foot = Pedestal(np.array([[3e8, 8e7], [-2e7, 5e8]]), np.zeros((2, 2)), 2.0)
    held = one_stage().bearings
    return one_stage(
        bearings=[
            replace(one, bearing=replace(one.bearing, pedestal=foot)) if n % 2 else one for n, one in enumerate(held)
        ]
    )


def on_balls() -> Machine:
    pair = paired(BallRow(13, 8.1e-3, 38.5e-3, np.radians(25.0)), "back to back", 15e-3, preload=150.0)
    return one_stage(bearings=[replace(one, rolling=pair) for one in one_stage().bearings])


MACHINES = {
    "full bearings": one_stage(),
    "spur, on the back flanks": one_stage(hand=0.0, torque=-150.0),
    "journal bearings": one_stage(stiffness=JOURNAL),
    "pedestals": on_pedestals(),
    "preloaded angular-contact ball bearings": on_balls(),
}


def in_housing(machine: Machine, sensors: Sequence[str] = ()) -> Machine:
    """The bearings on the ground in seats of an elastic body, whose seats turn in its modes, each beside its seat."""
    held = [one for one in machine.bearings if machine.shaft_around(one) is None]
    rng = np.random.default_rng(3)
    motions = rng.normal(size=(len(held), 8, 6)) * np.repeat([0.05, 0.6], 3)
    names = [one.bearing.name for one in held]
    seat_z = [machine.shaft(one.rotor).start + one.bearing.at + 4e-3 for one in held]
    stiffness = np.diag((2.0 * np.pi * np.linspace(300.0, 1500.0, 8)) ** 2)
    box = HousingComponent(
        "box",
        ("housing",) * 8,
        stiffness,
        0.02 * np.sqrt(stiffness),
        np.zeros((8, 8)),
        seats=dict(zip(names, motions, strict=True)),
        seat_z=dict(zip(names, seat_z, strict=True)),
        sensors={name: rng.normal(size=8) for name in sensors},
        participation=np.zeros((8, 6)),
    )
    seated = [replace(one, seat=one.bearing.name) if one in held else one for one in machine.bearings]
    return replace(machine, bearings=seated, housing=box)


def on_an_inner_shaft(hand: float = 1.0, **changes: Any) -> Machine:
    """The wheel's shaft is a sleeve, whose bearings sit on a shaft inside it, which a second pair drives."""
    machine = one_stage(hand)
    axis = machine.shaft("out").axis
    shafts = [
        machine.shaft("in"),
        Shaft(Rotor("out", [Segment(0.03, 0.04, 0.026, STEEL), Segment(0.05, 0.045, 0.026, STEEL)]), axis, -0.05),
        Shaft(Rotor("inner", [Segment(0.08, 0.02, 0.0, STEEL), Segment(0.17, 0.024, 0.0, STEEL)]), axis, -0.13),
    ]
    ends = [("out", 0.01, "inner"), ("out", 0.07, "inner"), ("inner", 0.01, None), ("inner", 0.24, None)]
    parts = {
        "shafts": shafts,
        "bearings": [
            *(one for one in machine.bearings if one.rotor == "in"),
            *(MountedBearing(linear_bearing(f"{shaft} {at}", at, FULL), shaft, seat) for shaft, at, seat in ends),
        ],
        "gears": [
            machine.gears[0],
            ShaftGear(toothed("wheel", TEETH[1], -hand), "out", 0.04),
            ShaftGear(toothed("second pinion", TEETH[0], -hand), "in", 0.14),
            ShaftGear(toothed("second wheel", TEETH[1], hand), "inner", 0.19),
        ],
        "gear_pairs": [*machine.gear_pairs, GearPair("second pinion", "second wheel", ConstantStiffness(4e8))],
    }
    return one_stage(hand, **parts | changes)


def on_a_carrier() -> Machine:
    """A set whose planets reach over their carrier, with bearings within its length and beyond its end.

    No two of them share a section, where the derivative by the place of one would have a jump.
    """
    parts = set_parts(count=2)
    planets = ("p 1", "p 2")
    shafts = []
    for one in parts["shafts"]:
        reaching = replace(one.rotor, segments=[replace(one.rotor.segments[0], length=0.16)])
        at_carrier = replace(one, start=0.06) if one.name == "c" else one
        shafts.append(replace(one, rotor=reaching) if one.name in planets else at_carrier)
    places = {one.name: (0.01, 0.05) for one in shafts} | {"p 1": (0.08, 0.1, 0.15), "p 2": (0.085, 0.105, 0.15)}
    held = [MountedBearing(linear_bearing(f"{on} {at}", at, FULL), on, None) for on in places for at in places[on]]
    return Machine(**parts | {"shafts": shafts, "bearings": held})


def two_paths() -> Machine:
    """Two helical pairs side by side between two shafts, in a housing, which share the torque unevenly."""
    one = one_stage()
    second = [
        ShaftGear(toothed("second pinion", TEETH[0], 1.0), "in", 0.13),
        ShaftGear(toothed("second wheel", TEETH[1], -1.0), "out", 0.13),
    ]
    pairs = [GearPair("pinion", "wheel", "iso6336"), GearPair("second pinion", "second wheel", "elastic-ring")]
    return in_housing(replace(one, gears=[*one.gears, *second], gear_pairs=pairs), ["roof", "side"])


def rubbing_pair() -> Machine:
    """A helical pair with friction between its teeth, in a housing."""
    return in_housing(one_stage(gear_pairs=[GearPair("pinion", "wheel", friction=0.08)]), ["roof", "side"])


def planets_of_a_fixed_carrier() -> Machine:
    """Three planets, one of which is off its place, in a carrier that stands still, under a light load."""
    parts = set_parts(count=3, held="c")
    return Machine(
        **parts
        | {
            "torque": 30.0,
            "gear_pairs": [replace(one, stiffness="iso6336") for one in parts["gear_pairs"]],
            "shafts": [replace(one, pin_error=(0.0, 5e-6)) if one.name == "p 1" else one for one in parts["shafts"]],
            "bearings": [
                replace(one, bearing=linear_bearing(one.bearing.name, one.bearing.at, 0.5 * FULL))
                for one in parts["bearings"]
            ],
        }
    )


def of_pair(pair: PairLoad) -> list[float]:
    return [pair.misalignment, pair.k_h_beta, pair.peak_to_peak_transmission_error]


def outcomes(point: OperatingPoint, bearing: str) -> FloatArray:
    return np.array([*of_pair(point.pairs[0]), point.bearing(bearing).tilt])


@dataclass(frozen=True)
class Scaled:
    """A law with its energy, force and tangent multiplied."""

    law: ConnectorLaw
    factor: float

    def at(self, deflection: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        energy, force, tangent = self.law.at(deflection)
        return self.factor * energy, self.factor * force, self.factor * tangent


def scaled(machine: Machine, number: int, size: float) -> OperatingPoint:
    name = machine.bearings[number].bearing.name

    def stiffer(mounted: MountedBearing, *how: Any) -> StaticBearing:
        made = static_bearing(mounted, *how)
        if mounted.bearing.name != name:
            return made
        # A linear one stays such: its part without energy is known as that.
        linear = isinstance(made.law, LinearLaw)
        factor = 1.0 + size
        return replace(made, law=LinearLaw(factor * made.law.stiffness) if linear else Scaled(made.law, factor))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(machine_description, "static_bearing", stiffer)
        return replace(machine, gravity=GRAVITY).operating_point()


def with_moved(machine: Machine, number: int, size: float) -> Machine:
    """The machine with a bearing that sits elsewhere on its shaft."""
    held = list(machine.bearings)
    own = held[number]
    held[number] = replace(own, bearing=replace(own.bearing, at=own.bearing.at + size))
    return replace(machine, bearings=held)


def moved(machine: Machine, number: int, size: float) -> OperatingPoint:
    return replace(with_moved(machine, number, size), gravity=GRAVITY).operating_point()


def difference(machine: Machine, number: int, change: Callable[..., OperatingPoint], step: float) -> FloatArray:
    """Central difference, fourth order, of the outcomes by a change of a bearing."""
    first = machine.bearings[0].bearing.name
    found = [outcomes(change(machine, number, size), first) for size in (step, -step, 2.0 * step, -2.0 * step)]
    near, far = found[0] - found[1], found[2] - found[3]
    return np.asarray((8.0 * near - far) / (12.0 * step))


def test_position_of_a_bearing_in_a_housing_whose_seats_tilt() -> None:
    """The bearing goes along its seat, which is out of line with its shaft by more than the shaft's own slope."""
    machine = in_housing(one_stage())
    point = replace(machine, gravity=GRAVITY).operating_point()
    (pair,) = pair_adjoints(point)
    for number in (0, len(machine.bearings) - 1):
        name = machine.bearings[number].bearing.name
        either = [outcomes(moved(machine, number, size), name)[:2] for size in (5e-5, -5e-5)]
        own = [pair[outcome].by_bearing_position(name) for outcome in OUTCOMES[:2]]
        np.testing.assert_allclose(own, (either[0] - either[1]) / 1e-4, rtol=2e-4)


HELD_BY_SHAFTS = [
    (on_an_inner_shaft, "out 0.01"),
    (on_a_carrier, "p 1 0.08"),
    (on_a_carrier, "p 2 0.105"),
    (on_a_carrier, "p 1 0.15"),
]


@pytest.mark.parametrize(("made", "name"), HELD_BY_SHAFTS)
def test_position_of_a_bearing_that_another_shaft_holds(made: Callable[[], Machine], name: str) -> None:
    """The seat moves with the section of an inner shaft or a carrier that bends and twists, or of the carrier's end."""
    machine = made()
    pair = pair_adjoints(replace(machine, gravity=GRAVITY).operating_point())[0]
    number = [one.bearing.name for one in machine.bearings].index(name)
    expected = difference(machine, number, moved, 2.5e-5)[:2]
    own = [pair[outcome].by_bearing_position(name) for outcome in OUTCOMES[:2]]
    np.testing.assert_allclose(own, expected, rtol=1e-6)


def test_bearings_on_elastic_pins_have_no_derivative_by_their_place() -> None:
    """The stiffness of the pin depends on it; a derivative without that would be off by 40 % to sixfold."""
    machine = planets_of_a_fixed_carrier()
    shafts = [one if one.carrier is None else replace(one, pin=PinSprings(0.03, 2e8, 2e4)) for one in machine.shafts]
    point = replace(machine, shafts=shafts).operating_point()
    ranked = solve_load_sensitivity(machine, point)
    of_planets = {f"p {at} {planet}" for at in (0.01, 0.05) for planet in (1, 2, 3)}
    every = {one.parameter for one in ranked.influences if one.kind == "bearing stiffness"}
    assert {one.parameter for one in ranked.influences if one.kind == "bearing position"} == every - of_planets
    assert ranked.note is not None
    assert "'p 0.01 1', 'p 0.05 1'" in ranked.note
    assert ranked.note.endswith("are not ranked, as they sit on elastic pins")
    with pytest.raises(CouplingError, match="no derivative by its place on an elastic pin"):
        pair_adjoints(point)[0]["misalignment"].by_bearing_position("p 0.01 1")


def test_a_gear_that_is_made_from_a_hollow_shaft_leaves_room_for_a_shaft_inside() -> None:
    machine = on_an_inner_shaft()
    thick = Rotor("inner", [Segment(0.25, 0.0262, 0.0, STEEL)])
    shafts = [replace(one, rotor=thick) if one.name == "inner" else one for one in machine.shafts]
    with pytest.raises(CouplingError, match="gear 'wheel': at: expected a gear clear of shaft \"inner\"; they overlap"):
        replace(machine, shafts=shafts)


def test_lines_by_the_position_of_a_bearing_that_another_shaft_holds() -> None:
    """A motion under a load on the pinion's shaft, against the machine assembled anew on the same modes."""
    described = in_housing(on_an_inner_shaft(0.0), ["roof"])
    point = described.operating_point()
    about = described.at_operating_point(point)
    pairs, components = about.loaded_pairs(), about.rotor_components()
    number = [one.bearing.name for one in about.bearings].index("out 0.01")

    def model(size: float = 0.0) -> LineModel:
        return LineModel(
            with_moved(about, number, size).assemble(pairs, components), point, pairs, (True, True), (False, False)
        )

    standing, step = model(), 1e-7
    load = standing.machine.rows("in", components[0].rotation(0.07))
    output = SensorAmplitude("roof", standing.machine.sensor_rows["roof"], standing.housing)

    def response(of: LineModel, w: float) -> Response:
        return Response(w, (), np.asarray(np.linalg.solve(of.dynamic_stiffness(w), load)))

    for w in 2.0 * np.pi * np.array([700.0, 1900.0, 3300.0]):
        own = standing.by_bearing_position(standing.line(output, response(standing, w)), "out 0.01")
        after, before = (output.value(w, response(model(size), w).motion) for size in (step, -step))
        assert own == pytest.approx((after - before) / (2.0 * step), rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("made", [two_paths, rubbing_pair])
def test_lines_of_flanks_that_share_a_torque_or_rub(made: Callable[[], Machine]) -> None:
    """Lines by a bearing's stiffness, in the equilibrium and in motion, against machines that are assembled anew.

    To 2e-3 of line and derivative together. With mesh forces that keep their shares, or friction that stays, single
    lines are 0.02 to 0.08 off.
    """
    described = made()
    shared = described.train.shares_torque
    assert all(shared) == (made is two_paths)
    first = described.at_operating_point()
    components, name = first.rotor_components(), described.bearings[-1].bearing.name

    def model(size: float = 0.0) -> LineModel:
        *others, last = described.bearings
        stiff = (1.0 + size) * last.bearing.spatial_stiffness
        machine = replace(
            described, bearings=[*others, replace(last, bearing=linear_bearing(name, last.bearing.at, stiff))]
        )
        point = machine.operating_point()
        about = machine.at_operating_point(point)
        pairs = about.loaded_pairs()
        return LineModel(about.assemble(pairs, components), point, pairs, (True,) * len(pairs), shared)

    def amplitudes(lines: Sequence[Line]) -> FloatArray:
        assert len(lines) == 12
        return np.array([one.value for one in sorted(lines, key=lambda one: (one.output.sensor, one.frequency))])

    standing, limit, step = model(), 4e4 * 2.0 * np.pi, 1e-3
    lines = sorted(standing.lines(limit, 6), key=lambda one: (one.output.sensor, one.frequency))
    own = np.array(
        [
            adjoint(standing.point, standing.by_static(one)).by_bearing_stiffness(name)
            + standing.by_bearing_stiffness(one, name)
            for one in lines
        ]
    )
    more, less = (amplitudes(model(size).lines(limit, 6)) for size in (step, -step))
    expected, level = (more - less) / (2.0 * step), amplitudes(lines)
    assert (np.abs(own - expected) < 2e-3 * (level + np.abs(expected))).all()


def test_lines_of_a_machine_whose_planets_turn_have_no_gradient() -> None:
    machine = in_housing(on_a_carrier(), ["roof"])
    point = machine.operating_point()
    model = LineModel(machine.assembled, point, (), (False,) * 4, (False,) * 4)
    output = SensorAmplitude("roof", model.machine.sensor_rows["roof"], model.housing)
    still = Response(100.0, (), np.zeros(model.machine.system.size, dtype=np.complex128))
    with pytest.raises(CouplingError, match="lines of a machine whose planets turn with their carrier"):
        model.line(output, still)


def test_rounds_of_shared_forces_settle(monkeypatch: pytest.MonkeyPatch) -> None:
    """A round leaves at most the exponent of the stiffness by the load, 1/4, where all else hardly yields, too."""
    machine, points = replace(two_paths(), torque=0.01), list[OperatingPoint]()

    def kept(*parts: Any) -> OperatingPoint:
        points.append(operating_point_search.solve_operating_point(*parts))
        return points[-1]

    monkeypatch.setattr(machine_description, "solve_operating_point", kept)
    settled = machine.operating_point()
    forces = np.array([[pair.force for pair in point.pairs] for point in points])
    changes = np.abs(np.diff(forces, axis=0)).max(axis=1)
    assert (changes[1:] < 0.25 * changes[:-1]).all()
    assert changes[-1] > 0.1 * changes[-2]
    assert forces[-1] == pytest.approx([0.058, 0.241], rel=0.01)
    for pair in settled.pairs:
        assert pair.pair.under is not None
        own = pair.pair.under(pair.force).between_rims.at(pair.touched)
        assert own.force == pytest.approx(pair.force, rel=1e-6)
    monkeypatch.setattr(machine_description, "_ROUNDS", 2)
    with pytest.raises(EquilibriumNotFoundError, match=r"does not settle in 2 rounds.*change by 0\.0"):
        machine.operating_point()


@pytest.mark.slow
@pytest.mark.parametrize("made", [two_paths, planets_of_a_fixed_carrier])
def test_teeth_that_share_a_torque(made: Callable[[], Machine], monkeypatch: pytest.MonkeyPatch) -> None:
    """All outcomes of all pairs by stiffness and place of bearings and by the housing, to 1e-4 of the largest.

    With teeth that keep their stiffness the transmission error would be off by a third: it is the force to the power
    3/4 by ISO 6336-1 below 100 N/mm.
    """
    monkeypatch.setattr(machine_description, "_SETTLED_FORCE", 1e-11)
    machine = made()
    point = replace(machine, gravity=GRAVITY).operating_point()
    states = [state for pair in pair_adjoints(point) for state in pair.values()]
    assert len(states) == 3 * len(point.pairs)
    forces = np.array([pair.force for pair in point.pairs])
    assert np.ptp(forces) > 0.03 * forces.max()

    def softer_box(machine: Machine, mode: int, size: float) -> OperatingPoint:
        box = machine.housing
        assert isinstance(box, HousingComponent)
        stiffness = box.stiffness.copy()
        stiffness[mode, mode] *= 1.0 + size
        return replace(machine, gravity=GRAVITY, housing=replace(box, stiffness=stiffness)).operating_point()

    def by_mode(state: Adjoint, mode: int) -> float:
        assert point.housing is not None
        assert isinstance(machine.housing, HousingComponent)
        return -float(state.housing[mode] * machine.housing.stiffness[mode, mode] * point.housing[mode])

    last = len(machine.bearings) - 1
    name = machine.bearings[last].bearing.name
    # Over longer steps a slice of a face comes into touch at one of the phases.
    parameters: list[tuple[Callable[..., OperatingPoint], int, float, FloatArray]] = [
        (scaled, last, 2e-4, np.array([state.by_bearing_stiffness(name) for state in states])),
        (moved, last, 5e-6, np.array([state.by_bearing_position(name) for state in states])),
    ]
    if machine.housing is not None:
        parameters.append((softer_box, 0, 2e-4, np.array([by_mode(state, 0) for state in states])))
    for change, number, step, own in parameters:
        more, less = (
            np.array([one for pair in change(machine, number, size).pairs for one in of_pair(pair)])
            for size in (step, -step)
        )
        expected = (more - less) / (2.0 * step)
        largest = np.abs(expected).reshape(-1, 3).max(axis=0)
        assert (np.abs(own - expected).reshape(-1, 3).max(axis=0) < 1e-4 * largest).all(), change.__name__


@pytest.mark.slow
@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)
def test_bearings(machine: Machine) -> None:
    """Stiffness and position to 1e-7 of the largest derivative of each outcome.

    The error of the differences falls with the fourth power of their steps, where rolling elements bend the outcomes.
    """
    point = replace(machine, gravity=GRAVITY).operating_point()
    tolerance = 1e-7
    (pair,) = pair_adjoints(point)
    assert tuple(pair) == OUTCOMES
    adjoints = [*pair.values(), tilt_adjoint(point, machine.bearings[0].bearing.name)]
    # One of each shaft.
    numbers = (0, len(machine.bearings) - 1)
    names = [machine.bearings[number].bearing.name for number in numbers]
    for change, step in ((scaled, 2.5e-4), (moved, 2.5e-5)):
        by = Adjoint.by_bearing_stiffness if change is scaled else Adjoint.by_bearing_position
        own = np.array([[by(one, name) for one in adjoints] for name in names])
        expected = np.array([difference(machine, number, change, step) for number in numbers])
        # A bearing's own place also moves its own tilt.
        told = np.ones(own.shape, dtype=bool)
        told[0, 3] = change is scaled
        scale = np.abs(expected).max(axis=0)
        error = np.where(told, np.abs(own - expected), 0.0).max(axis=0)
        # An even spring of the whole mesh leaves spur gears no transmission error.
        assert (error <= tolerance * np.where(scale > 1e-12, scale, 1.0)).all()
