"""Machines described in Python: what follows from the parts, and the parts that make no machine."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from gearwhine.coupling import CouplingError, Machine, MountedBearing, Output, Shaft, ShaftGear, coupled_modes
from gearwhine.coupling.description.parts import rotor_with_gears
from gearwhine.coupling.gears import ConstantStiffness, Gear, GearError, SquareStiffness
from gearwhine.coupling.gears.geometry.toothed_section import bare_lengths, toothed_section
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.linear.frequency_response import mesh_error_response
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.rotors import (
    Bearing,
    Coupling,
    Disc,
    Pedestal,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    static_deflection,
)
from gearwhine.rotors.analyses.statics import StaticForce

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
MODULE, LENGTH = 3e-3, 0.25


def gear(name: str, teeth: int, **more: Any) -> Gear:
    return Gear(name, teeth, MODULE, math.radians(20.0), 12e-3, **more)


def shaft(name: str, x: float, **more: Any) -> Shaft:
    return Shaft(Rotor(name, [Segment(LENGTH, 0.03, 0.0, STEEL)]), (x, 0.0), mode_count=3, **more)


def two_stages(**changes: Any) -> Machine:
    """Teeth 20:40 and 25:30, so that three shafts turn at 1 : -1/2 : 5/12."""
    distances = MODULE * 30.0, MODULE * 27.5
    shafts = [shaft("fast", 0.0), shaft("middle", distances[0]), shaft("slow", sum(distances))]
    held = [
        MountedBearing(Bearing(f"{one.name} {at}", at, np.diag([1e8, 2e8]), np.zeros((2, 2))), one.name, None)
        for one in shafts
        for at in (0.0, LENGTH)
    ]
    parts: dict[str, Any] = {
        "shafts": shafts,
        "bearings": held,
        "gears": [
            ShaftGear(gear("a", 20), "fast", 0.1),
            ShaftGear(gear("b", 40), "middle", 0.1),
            ShaftGear(gear("c", 25), "middle", 0.16),
            ShaftGear(gear("d", 30), "slow", 0.16),
        ],
        "gear_pairs": [
            GearPair("a", "b", ConstantStiffness(2e8)),
            GearPair("c", "d", ConstantStiffness(3e8), damping_ratio=0.02),
        ],
        "speed": 300.0,
        "torque": 40.0,
    }
    return Machine(**parts | changes)


def test_speeds_torques_and_mesh_frequencies_follow_from_the_teeth() -> None:
    machine = two_stages()
    assert machine.speeds == pytest.approx({"fast": 300.0, "middle": -150.0, "slow": 125.0}, rel=1e-15)
    assert machine.mesh_frequencies == pytest.approx((20 * 300 / (2 * math.pi), 25 * 150 / (2 * math.pi)), rel=1e-15)
    assert machine.pair_torques == pytest.approx((40.0, 80.0), rel=1e-12)
    entering, leaving = machine.constant_torques
    assert (entering.rotor, entering.at, entering.value) == ("fast", 0.0, 40.0)
    assert (leaving.rotor, leaving.at) == ("slow", LENGTH)
    assert leaving.value == pytest.approx(-40.0 * 12 / 5, rel=1e-12)  # against its turning, which is positive


def test_the_assembled_machine_turns_and_loads_its_teeth_so() -> None:
    machine = two_stages()
    coupled = machine.assemble()
    assert coupled.speeds == machine.speeds
    assert [mesh.contact.damping > 0.0 for mesh in coupled.meshes] == [True, True]
    # F R_b = T on each driver.
    forces = [loaded.static.force for loaded in machine.loaded_pairs()]
    radii = [MODULE * teeth / 2 * math.cos(math.radians(20.0)) for teeth in (20, 25)]
    assert forces == pytest.approx([40.0 / radii[0], 80.0 / radii[1]], rel=1e-12)
    assert (coupled_modes(coupled.system).frequencies_hz > 0.0).any()


def test_the_mass_of_gears_is_on_their_shafts_once() -> None:
    machine = two_stages()
    bare = machine.shaft("middle").rotor
    # The gears are made from the shaft of 30 mm: each adds a ring of 12 mm outside of it.
    rings = [math.pi / 4.0 * 7850.0 * 12e-3 * ((MODULE * teeth) ** 2 - 0.03**2) for teeth in (40, 25)]
    assert machine.rotor("middle").mass == pytest.approx(bare.mass + sum(rings), rel=1e-12)
    on_a_disc = replace(machine.shafts[0], rotor=replace(machine.shafts[0].rotor, discs=[Disc(0.1, 5.0, 0.02, 0.01)]))
    gears = [replace(machine.gears[0], inertia=(0.0, 0.0, 0.0)), *machine.gears[1:]]
    other = two_stages(shafts=[on_a_disc, *machine.shafts[1:]], gears=gears)
    assert other.rotor("fast").mass == pytest.approx(bare.mass + 5.0, rel=1e-12)


def test_outputs_share_the_torque_as_they_say() -> None:
    machine = two_stages(outputs=[Output("middle", 20.0, 0.2), Output("slow", 72.0)])
    at_middle, at_slow = machine.constant_torques[1:]
    assert (at_middle.rotor, at_middle.at) == ("middle", 0.2)
    assert at_middle.value == pytest.approx(20.0, rel=1e-12)  # the shaft turns clockwise
    assert at_slow.value == pytest.approx(-72.0, rel=1e-12)
    assert machine.pair_torques == pytest.approx((40.0, 60.0), rel=1e-12)


PAIRS = [GearPair("a", "b", ConstantStiffness(2e8)), GearPair("c", "d", ConstantStiffness(3e8))]
CHANGES: list[tuple[str, dict[str, Any], str]] = [
    ("axes", {"shafts": [shaft("fast", 0.0), shaft("middle", 0.2), shaft("slow", 0.2825)]}, "lose contact|too far|200"),
    ("idle shaft", {"gear_pairs": [GearPair("a", "b")]}, "no gear pair leads from shaft 'fast'.*'slow'"),
    (
        "one shaft",
        {"gear_pairs": [GearPair("a", "b"), GearPair("b", "c")]},
        'expected a gear on another rotor than "middle"',
    ),
    (
        "unknown gear",
        {"gear_pairs": [GearPair("a", "x")]},
        "driven is 'x'; expected the name of a gear of this machine .'a', 'b', 'c', 'd'",
    ),
    ("output", {"outputs": [Output("slow", 10.0)]}, "expected outputs that balance the input torque of 40 N·m"),
    (
        "no input",
        {"torque": 0.0, "outputs": [Output("middle", 100.0), Output("slow", -120.0)]},
        "an input torque of 0; expected the torque that drives them",
    ),
    ("some torques", {"outputs": [Output("slow", 96.0), Output("middle")]}, "expected all or none"),
    ("nowhere", {"outputs": [Output("x", 96.0)]}, r"outputs\[0\].shaft is 'x'; expected the name of a shaft"),
    ("no shafts", {"shafts": []}, "expected at least one shaft"),
    (
        "pair twice",
        {"gear_pairs": [*PAIRS, GearPair("d", "c")]},
        "expected gears that are not yet a pair; it is given twice",
    ),
    ("output at input", {"outputs": [Output("fast", 40.0)]}, 'a rotor other than "fast", where the torque comes in'),
    (
        "names swapped",
        {"gear_pairs": [PAIRS[0], GearPair("d", "c")], "outputs": [Output("slow", 96.0)]},
        "expected power to flow from driver to driven, in the frame of planets' carrier; swap the two names",
    ),
    ("brake", {"torque": -40.0}, "'a -> b': backlash: expected a backlash: .* give their tooth_thinning, or"),
    ("nothing takes it", {"gears": [], "gear_pairs": []}, "a torque of 40 N·m that nothing takes"),
    (
        "no path",
        {"gears": [], "gear_pairs": [], "outputs": [Output("fast", 30.0), Output("slow", 10.0)]},
        "'fast' takes in 40 N·m and gives out 30 N·m; expected torques that balance on shaft 'fast'",
    ),
    (
        "gear off the end",
        {"gears": [ShaftGear(gear("a", 20), "fast", 0.3)], "gear_pairs": []},
        "gear 'a': at is 0.3; expected a station on rotor",
    ),
    (
        "output off the end",
        {"outputs": [Output("slow", 96.0, 0.3)]},
        r"outputs\[0\].at is 0.3; expected a station on rotor",
    ),
    ("input off the end", {"torque_at": -0.01}, "torque_at is -0.01; expected a station on rotor"),
]


@pytest.mark.parametrize(("changes", "words"), [case[1:] for case in CHANGES], ids=[case[0] for case in CHANGES])
def test_what_cannot_be_a_machine_is_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises((CouplingError, GearError, RotorError), match=words):
        two_stages(**changes)


def test_senses_and_ratios_cannot_be_given_wrong() -> None:
    """Equal gears turn at 1 : -1, whatever the speed; axes 200 mm apart are no place for gears that need 88.9 mm."""
    equal = [Gear(name, 28, 3.175e-3, math.radians(20.0), 6.35e-3) for name in ("pinion", "wheel")]

    def rig(distance: float) -> Machine:
        return Machine(
            [shaft("input", 0.0), shaft("output", distance)],
            gears=[ShaftGear(equal[0], "input", 0.1), ShaftGear(equal[1], "output", 0.1)],
            gear_pairs=[GearPair("pinion", "wheel", ConstantStiffness(2e8))],
            speed=-575.0,
            torque=71.77,
        )

    machine = rig(28 * 3.175e-3)
    assert machine.speeds == {"input": -575.0, "output": 575.0}
    assert [torque.value for torque in machine.constant_torques] == pytest.approx([-71.77, -71.77], rel=1e-12)
    needed = "at a centre distance of 200 mm; they mesh without backlash at 88.9 mm; the axes are those of 'input' and"
    with pytest.raises(GearError, match=needed):
        rig(0.2)


def test_a_bearing_needs_a_seat_on_its_shaft_and_no_pedestal_in_it() -> None:
    modes, seat = np.zeros((0, 6)), {"front": np.zeros((0, 6))}
    none = np.zeros((0, 0))
    for centre, words in (
        ((0.0, 0.0), None),
        ((0.001, 0.0), 'a seat on the axis of rotor "fast"; the seat\'s centre is 1 mm off it'),
    ):
        housing = HousingComponent(
            "housing", (), none, none, none, seats=seat, seat_z={"front": 0.0}, sensors={}, participation=modes,
            seat_axes={"front": centre},
        )  # fmt: skip
        machine = two_stages()
        seated = [replace(machine.bearings[0], seat="front"), *machine.bearings[1:]]
        if words is None:
            two_stages(bearings=seated, housing=housing)
            foot = Pedestal(1e8 * np.eye(2), np.zeros((2, 2)), 2.0)
            standing = replace(seated[0], bearing=replace(seated[0].bearing, pedestal=foot))
            with pytest.raises(CouplingError, match='expected no pedestal under a bearing in seat "front"'):
                two_stages(bearings=[standing, *seated[1:]], housing=housing)
            continue
        with pytest.raises(CouplingError, match=words):
            two_stages(bearings=seated, housing=housing)


def test_gears_that_do_not_fit_each_other_are_refused() -> None:
    machine = two_stages()
    other = replace(machine.gears[1].gear, module=3.5e-3)
    with pytest.raises(GearError, match="module"):
        two_stages(gears=[machine.gears[0], replace(machine.gears[1], gear=other), *machine.gears[2:]])
    with pytest.raises(CouplingError, match=r"expected gears in one plane, .* they are 60 mm apart along z"):
        two_stages(gears=[machine.gears[0], replace(machine.gears[1], at=0.16), *machine.gears[2:]])


def test_a_seat_without_a_housing_is_refused() -> None:
    machine = two_stages()
    seated = replace(machine.bearings[0], seat="front")
    with pytest.raises(CouplingError, match="seat is 'front'; expected None for the ground"):
        two_stages(bearings=[seated, *machine.bearings[1:]])


def test_a_loop_of_pairs_that_locks_is_refused() -> None:
    third = GearPair("e", "f", ConstantStiffness(1e8))
    machine = two_stages()
    locking = [ShaftGear(gear("e", 20), "slow", 0.22), ShaftGear(gear("f", 35), "fast", 0.22)]
    with pytest.raises(
        CouplingError, match=r"'e' -> 'f' closes a loop that cannot turn: shaft 'fast' would turn at 1 "
    ):
        two_stages(gears=[*machine.gears, *locking], gear_pairs=[*machine.gear_pairs, third])


def test_helical_thrust_needs_a_bearing_that_carries_it() -> None:
    angle = math.radians(15.0)
    distance = 30.0 * MODULE / math.cos(angle)
    parts: dict[str, Any] = {
        "shafts": [shaft("fast", 0.0), shaft("slow", distance)],
        "gears": [
            ShaftGear(gear("a", 20, helix_angle=angle), "fast", 0.1),
            ShaftGear(gear("b", 40, helix_angle=-angle), "slow", 0.1),
        ],
        "gear_pairs": [GearPair("a", "b", ConstantStiffness(2e8))],
        "speed": 300.0,
        "torque": 40.0,
    }
    with pytest.raises(CouplingError, match="push it along its axis"):
        Machine(**parts)
    held = np.diag([1e8, 1e8, 5e7, 0.0, 0.0])
    bearings = [
        MountedBearing(Bearing(f"{name} {at}", at, held, np.zeros((5, 5))), name, None)
        for name in ("fast", "slow")
        for at in (0.0, LENGTH)
    ]
    assert Machine(**parts, bearings=bearings).pair_torques == pytest.approx((40.0,), rel=1e-12)


def test_motion_is_labelled_and_carries_the_mean_torque() -> None:
    machine = two_stages()
    found = machine.simulate(revolutions=12, discard=8, points_per_revolution=512)
    data = found.dataset
    assert data["mesh_force"].dims == ("contact", "time")
    assert data["mesh_force"].attrs == {"units": "N", "long_name": "gear-mesh force along the line of action"}
    radii = [MODULE * teeth / 2 * math.cos(math.radians(20.0)) for teeth in (20, 25)]
    means = data["mesh_force"].sel(contact=["a -> b", "c -> d"]).mean("time").values
    assert means == pytest.approx([40.0 / radii[0], 80.0 / radii[1]], rel=0.02)
    assert found.energy_error < 1e-3
    # Four turns of the first driver: its mesh order is line 4 × 20.
    spectrum = found.spectrum("mesh_force", "a -> b")
    assert spectrum.frequencies[4 * 20] == pytest.approx(machine.mesh_frequencies[0], rel=1e-9)
    with pytest.raises(CouplingError, match="stands still"):
        two_stages(speed=0.0).simulate(2, 1)


def square_pairs() -> list[GearPair]:
    return [GearPair(*names, SquareStiffness(2e8), damping_ratio=0.05) for names in (("a", "b"), ("c", "d"))]


@pytest.mark.slow
def test_the_analyses_of_a_machine_are_its_methods() -> None:
    """The Campbell diagram passes through the modes at operation; errors of each mesh answer as in the assembly."""
    pairs = square_pairs()
    machine = two_stages(gear_pairs=pairs)
    assert machine.assembled is machine.assembled
    modes, limit = machine.modes(), 2.0 * math.pi * 900.0
    with pytest.raises(RotorError, match="is torn"):
        machine.campbell([0.0, 1e9], frequency_limit=limit)
    diagram = machine.campbell([100.0, 300.0], frequency_limit=limit)
    damped = np.sort(modes.eigenvalues.imag[(modes.eigenvalues.imag > 0.0) & (np.abs(modes.eigenvalues) < limit)])
    at_operation = np.sort(diagram.eigenvalues[1].imag)
    assert damped.size > 3
    assert at_operation[: damped.size] == pytest.approx(damped, rel=1e-9)
    assert {line.order for line in diagram.lines} >= {20.0, 12.5}

    frequencies = 2.0 * math.pi * np.array(machine.mesh_frequencies)
    for mesh in (0, 1):
        found = machine.mesh_error_response(frequencies, mesh=mesh)
        expected = mesh_error_response(two_stages(gear_pairs=pairs).assemble(), frequencies, mesh=mesh)
        assert np.array_equal(found.coordinates, expected.coordinates)
        assert f"{pairs[mesh].driver} -> {pairs[mesh].driven}" in found.excitation


@pytest.mark.slow
def test_the_steady_force_on_teeth_is_torque_over_radius() -> None:
    """The gears are light: at this speed the teeth of the first pair part, and a disturbance of the motion grows."""
    pairs = [replace(pair, damping_ratio=0.03) for pair in square_pairs()]
    machine = two_stages(gear_pairs=pairs, speed=305.0)
    undamped = [replace(one, damping_ratio=0.0) for one in machine.shafts]
    steady = replace(machine, shafts=undamped).steady(tolerance=1e-5)
    assert steady.contact_loss[0] > 0.02
    assert not steady.stable
    assert steady.period == pytest.approx(2.0 * math.pi / (305.0 * 2.5), rel=1e-12)  # of 20 and 12.5 a turn
    radii = [MODULE * teeth / 2 * math.cos(math.radians(20.0)) for teeth in (20, 25)]
    assert steady.mean_force[:2] == pytest.approx([40.0 / radii[0], 80.0 / radii[1]], rel=1e-3)


def test_a_machine_that_turns_the_other_way_carries_the_same_torques_through_its_teeth() -> None:
    forwards, backwards = two_stages(), two_stages(speed=-300.0)
    assert backwards.pair_torques == pytest.approx(forwards.pair_torques, rel=1e-12)
    mirrored = [-one.value for one in forwards.constant_torques]
    assert [one.value for one in backwards.constant_torques] == pytest.approx(mirrored, rel=1e-12)


def test_stations_count_from_where_a_shaft_begins() -> None:
    """Gears mesh where they meet in space: a shaft set back by as much as its gears stand further along is the same."""
    machine = two_stages()
    set_back = [replace(one, start=-0.05) if one.name == "slow" else one for one in machine.shafts]
    with pytest.raises(CouplingError, match="50 mm apart along z"):
        two_stages(shafts=set_back)
    further = [replace(one, at=one.at + 0.05) if one.shaft == "slow" else one for one in machine.gears]
    assert two_stages(shafts=set_back, gears=further).speeds == machine.speeds


def test_a_disc_at_a_gear_is_part_of_the_inertia_that_its_mesh_damps() -> None:
    """c = 2 ζ √(k m), 1/m = R₁²/J₁ + R₂²/J₂; what sits elsewhere on the shaft turns on its own."""
    extra, machine = 0.01, two_stages()

    def damping(station: float) -> float:
        slow = machine.shaft("slow")
        carrying = replace(slow, rotor=replace(slow.rotor, discs=[Disc(station, 3.0, extra, 0.5 * extra)]))
        other = two_stages(shafts=[*machine.shafts[:2], carrying])
        return other.loaded_pairs()[1].contact.damping

    bare = machine.loaded_pairs()[1].contact.damping
    driver, driven = (one.gear for one in machine.gears[2:])
    radii = [MODULE * one.teeth / 2 * math.cos(math.radians(20.0)) for one in (driver, driven)]

    def mass(more: float) -> float:
        inertias = driver.polar_inertia, driven.polar_inertia + more
        return 1.0 / sum(radius**2 / inertia for radius, inertia in zip(radii, inertias, strict=True))

    assert damping(0.05) == pytest.approx(bare, rel=1e-12)
    assert damping(0.16) / bare == pytest.approx(math.sqrt(mass(extra) / mass(0.0)), rel=1e-9)


def test_friction_of_a_pair_reaches_its_mesh() -> None:
    rubbing = [GearPair("a", "b", "iso6336", friction=0.06), two_stages().gear_pairs[1]]
    assert [mesh.friction for mesh in two_stages(gear_pairs=rubbing).assemble().meshes] == [0.06, 0.0]


def test_a_shaft_without_torque_is_in_balance() -> None:
    outputs = [Output("fast", 40.0), Output("slow", 0.0)]
    machine = two_stages(gears=[], gear_pairs=[], outputs=outputs)
    entering, *leaving = machine.constant_torques
    assert entering.value + sum(one.value for one in leaving if one.rotor == "fast") == pytest.approx(0.0, abs=1e-12)


def test_bearings_of_a_shaft_are_those_at_its_own_speed() -> None:
    """The modes of a shaft stand on the table's stiffness at the speed of that shaft, not of the first one."""
    machine = two_stages()
    speeds = np.array([100.0, 350.0])
    table = np.array([np.diag([1e7, 1e7]), np.diag([9e8, 9e8])])

    def middle(stiffness: Any, at: Any) -> Any:
        held = [
            replace(one, bearing=Bearing(one.bearing.name, one.bearing.at, stiffness, np.zeros(stiffness.shape), at))
            if one.rotor == "middle"
            else one
            for one in machine.bearings
        ]
        return two_stages(bearings=held).rotor_components()[1].modal.lateral.frequencies

    part = (150.0 - 100.0) / (350.0 - 100.0)
    own = np.diag([1e7 + part * (9e8 - 1e7)] * 2)
    assert middle(table, speeds) == pytest.approx(middle(own, None), rel=1e-6)


def test_a_damped_coupling_damps_the_twist_between_its_hubs() -> None:
    """Two stiff hubs on a soft coupling: ω² = k (1/J + 1/J), ζ about c ω / (2 k)."""
    stiffness, damping, inertia = 1e4, 0.6, 0.05
    flexible = Coupling(0.02, 1e9, 1e7, stiffness, 1e9, torsional_damping=damping)
    parts = [Segment(0.1, 0.04, 0.0, STEEL), flexible, Segment(0.1, 0.04, 0.0, STEEL)]
    hubs = [Disc(at, 5.0, inertia, inertia) for at in (0.05, 0.17)]
    held = [
        MountedBearing(Bearing(str(at), at, 1e8 * np.eye(2), np.zeros((2, 2))), "train", None) for at in (0.0, 0.22)
    ]
    train = Shaft(Rotor("train", parts, hubs), (0.0, 0.0), damping_ratio=0.0, mode_count=6)
    modes = coupled_modes(Machine([train], held, speed=100.0).assemble().system)
    # The shafts between coupling and hubs, 50 mm each, twist too: k of all three in a row, of which the coupling's part
    # is dissipative.
    row = 1.0 / (1.0 / stiffness + 0.1 / (STEEL.shear_modulus * math.pi / 32.0 * 0.04**4))
    omega = math.sqrt(2.0 * row / inertia)
    twist = np.argmin(np.abs(2.0 * math.pi * modes.frequencies_hz - omega))
    assert 2.0 * math.pi * modes.frequencies_hz[twist] == pytest.approx(omega, rel=5e-3)
    assert modes.damping_ratios[twist] == pytest.approx(damping * omega * row / (2.0 * stiffness**2), rel=1e-2)


def test_material_damping_of_a_shaft_is_that_of_its_free_twist() -> None:
    train = Shaft(Rotor("train", [Segment(LENGTH, 0.03, 0.0, STEEL)]), (0.0, 0.0), damping_ratio=0.03, mode_count=3)
    held = [MountedBearing(Bearing("one", 0.0, 1e8 * np.eye(2), np.zeros((2, 2))), "train", None)]
    modes = coupled_modes(Machine([train], held, speed=0.0).assemble().system)
    # First free-free torsion of a uniform shaft: f = √(G/ρ) / (2 L).
    expected = math.sqrt(81.2e9 / 7810.0) / (2.0 * LENGTH)
    twist = np.argmin(np.abs(modes.frequencies_hz - expected))
    assert modes.frequencies_hz[twist] == pytest.approx(expected, rel=1e-6)
    assert modes.damping_ratios[twist] == pytest.approx(0.03, rel=1e-9)


@pytest.mark.parametrize("young", [206e9, 3e9])
@pytest.mark.parametrize("stiffens", [False, True])
def test_a_shaft_gives_way_to_the_thrust_of_a_helical_gear_as_a_bar(*, stiffens: bool, young: float) -> None:
    """1/k of the bearing and ∫ dz/EA of the shaft between it and the gear, however few modes are kept.

    A gear in one piece thickens half of its face from where stress has spread into it: to the root circle, and 1.9
    modules on to the section with teeth. The gear is a sleeve of its own modulus around the shaft.
    """
    at, axial = 0.1, 5e7
    stiffness = np.diag([1e8, 1e8, axial, 0.0, 0.0])
    held = [MountedBearing(Bearing("front", 0.0, stiffness, np.zeros((5, 5))), "fast", None)]
    held.append(MountedBearing(Bearing("back", LENGTH, 1e8 * np.eye(2), np.zeros((2, 2))), "fast", None))
    helical = ShaftGear(gear("a", 20, helix_angle=0.3, youngs_modulus=young), "fast", at, stiffens_shaft=stiffens)
    machine = Machine([replace(shaft("fast", 0.0), mode_count=1)], held, [helical], speed=10.0)
    (component,) = machine.rotor_components()
    along = component.motions(at)[2]
    whole = machine.assemble(components=[component]).system.mean_stiffness
    moved = along @ np.linalg.lstsq(whole, along, rcond=1e-12)[0]
    body, half = helical.gear, 0.5 * helical.gear.face_width
    root = 2.0 * body.root_circle_radius
    bare = bare_lengths(0.03, root, body.face_width)[0]
    toothless = min(1.9 * body.module, half - bare)
    lengths = [at - half + bare, toothless, half - bare - toothless]
    diameters = [0.03, root, toothed_section(body).bending_diameter]
    if not stiffens:
        diameters = [0.03] * 3
    stretch = sum(
        length / (math.pi / 4.0 * (211e9 * 0.03**2 + young * (outer**2 - 0.03**2)))
        for length, outer in zip(lengths, diameters, strict=True)
    )
    assert moved == pytest.approx(1.0 / axial + stretch, rel=1e-6)


@pytest.mark.parametrize("young", [206e9, 110e9, 3e9])
def test_a_gear_stiffens_its_shaft_by_its_own_modulus(young: float) -> None:
    """Sag under a force F in the middle: F ∫ z²/4EI + 1/4κGA dz to either side, EI and GA those of shaft and gear.

    The gear is a sleeve around the shaft, from where stress has spread into it.
    """
    outer, length, force = 0.02, 0.2, 1000.0
    body = Gear("g", 40, 2e-3, math.radians(20.0), 0.06, youngs_modulus=young, poisson_ratio=0.3)
    steel = ShaftMaterial.from_poisson_ratio(206e9, 0.3, 7850.0)
    bare = Rotor("r", [Segment(length, outer, 0.0, steel, 0.9)])
    held = [Bearing.isotropic("left", 0.0, 1e13), Bearing.isotropic("right", length, 1e13)]
    loaded = rotor_with_gears(bare, [ShaftGear(body, "r", 0.5 * length)])
    middle = [StaticForce(0.5 * length, y=-force)]
    sag = -static_deflection(loaded, held, middle, gravity=(0.0, 0.0, 0.0)).evaluate([0.5 * length])[1, 0]

    root, section = 2.0 * body.root_circle_radius, toothed_section(body)
    core = 0.5 * length - 0.5 * body.face_width + bare_lengths(outer, root, body.face_width)[0]
    places = [0.0, core, core + section.end_length, 0.5 * length]
    expected = 0.5 * force / 1e13  # of the bearings
    for left, right, sleeve in zip(places, places[1:], (outer, root, section.bending_diameter), strict=False):
        bending = math.pi / 64.0 * (206e9 * outer**4 + young * (sleeve**4 - outer**4))
        shear = 0.9 * math.pi / 4.0 * (206e9 * outer**2 + young * (sleeve**2 - outer**2)) / 2.6
        expected += 2.0 * force * ((right**3 - left**3) / (12.0 * bending) + (right - left) / (4.0 * shear))
    assert sag == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("place", [0.0, 0.5])
def test_a_shaft_may_stand_in_another_one_s_bore_alone(place: float) -> None:
    """On the axis at the origin, where shafts that stand for others are, it is a warning."""

    def coaxial(bore: float) -> Machine:
        sizes = {"outer": (0.1, bore), "inner": (0.05, 0.0)}
        shafts = [
            Shaft(Rotor(name, [Segment(0.5, *diameters, STEEL)]), axis=(place, 0.0), start=start)
            for (name, diameters), start in zip(sizes.items(), (0.0, 0.2), strict=True)
        ]
        held = [
            MountedBearing(Bearing.isotropic(f"{name} {at}", at, 1e8), name, None)
            for name in sizes
            for at in (0.05, 0.45)
        ]
        return Machine(shafts, held, speed=10.0)

    overlap = 'clear of shaft "outer"; they overlap over 300 mm'
    assert not any(overlap in text for text in coaxial(0.06).warnings)
    if place == 0.0:
        assert any(overlap in text for text in coaxial(0.04).warnings)
    else:
        with pytest.raises(CouplingError, match=overlap):
            coaxial(0.04)
