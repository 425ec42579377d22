"""The machine's Campbell diagram: against the exact rotor equations, and modes followed where they cross and veer."""

import re
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling import (
    CoupledMachine,
    CouplingError,
    GearMesh,
    MountedBearing,
    MountedGear,
    assemble_machine,
    coupled_modes,
    system_campbell,
)
from gearwhine.coupling.gears import ConstantStiffness, Gear, GearPairGeometry, tooth_contact
from gearwhine.coupling.linear.campbell import ModesAtSpeed, likeness, matched
from gearwhine.coupling.linear.eigenpairs import quadratic_eigenpairs
from gearwhine.coupling.linear.excitation_orders import ExcitationLine, excitation_lines
from gearwhine.coupling.machine.components import rotor_component
from gearwhine.rotors import (
    Bearing,
    Disc,
    ModalRotor,
    Rotor,
    Segment,
    ShaftMaterial,
    campbell,
    solve_lateral_modes,
    solve_torsional_modes,
)
from gearwhine.rotors.modes.residual_modes import add_attachment_modes

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
# Friswell, Penny, Garvey & Lees, example 5.9.1.
SHAFT = Rotor(
    "shaft",
    [Segment(0.5, 0.05, 0.0, STEEL)] * 3,
    [Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, 7810.0), Disc.from_dimensions(1.0, 0.07, 0.35, 0.05, 7810.0)],
)
TOP = 500.0
# Stiffness and damping that change with speed, unlike in x and y.
TABLE = np.array([np.diag([1e6, 8e5]), np.diag([1.3e6, 1.1e6]), np.diag([2e6, 1.2e6])])
ROUND = [Bearing.isotropic(name, at, 1e6, 300.0) for name, at in (("left", 0.0), ("right", 1.5))]
TABLED = [
    Bearing(name, at, TABLE, 3e-4 * TABLE, np.array([0.0, 250.0, 600.0]))
    for name, at in (("left", 0.0), ("right", 1.5))
]


def machine(bearings: list[Bearing], speed: float) -> CoupledMachine:
    held = [bearing.at_speed(abs(speed)) for bearing in bearings]
    lateral = solve_lateral_modes(SHAFT, [bearing.mean_support for bearing in held], count=12)
    lateral = add_attachment_modes(lateral, forces_at=[0.0, 1.5], moments_at=(0.5, 1.0))
    part = rotor_component("shaft", ModalRotor(lateral, solve_torsional_modes(SHAFT, count=1)), start=0.0)
    mounted = [MountedBearing(bearing, "shaft", None) for bearing in bearings]
    return assemble_machine([part], None, speeds={"shaft": speed}, bearings=mounted)


def test_a_crossing_that_does_not_converge_is_said_with_its_frequency_and_speeds(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("gearwhine.coupling.linear.campbell.order_crossing", lambda *_: None)
    speeds, lines = np.linspace(0.0, TOP, 6), [ExcitationLine("2x", "shaft", 2.0)]
    diagram = system_campbell(machine(ROUND, 300.0), speeds, frequency_limit=800.0, lines=lines)
    assert diagram.crossings == ()
    assert len(diagram.unsettled) >= 4
    for text in diagram.unsettled:
        said = re.fullmatch(r"2x meets the mode at (\S+) Hz between (\S+) and (\S+) rad/s, but .*", text)
        assert said is not None
        hertz, left, right = map(float, said.groups())
        # The order passes a mode of the speed to the left within the interval, and bends it little.
        assert 2.0 * left / (2.0 * np.pi) <= 1.05 * hertz
        assert hertz <= 1.05 * 2.0 * right / (2.0 * np.pi)
        found = diagram.frequencies_hz[speeds.tolist().index(left)]
        assert np.nanmin(np.abs(found / hertz - 1.0)) < 1e-4


@pytest.mark.parametrize("bearings", [ROUND, pytest.param(TABLED, marks=pytest.mark.slow)])
def test_critical_speeds_of_the_exact_equations(bearings: list[Bearing]) -> None:
    """Crossings of 1x and 2x, each within what the modal basis leaves out of the rotor room's own."""
    lines = [ExcitationLine(f"{n}x", "shaft", float(n)) for n in (1, 2)]
    diagram = system_campbell(machine(bearings, 300.0), np.linspace(0.0, TOP, 21), frequency_limit=800.0, lines=lines)
    exact = campbell(SHAFT, bearings, np.linspace(0.0, TOP, 21), frequency_limit=800.0)
    assert not diagram.unsettled
    for line in lines:
        ours = [one for one in diagram.crossings if one.line is line and one.kind == "rotor"]
        theirs = [one for one in exact.crossings(line.order) if abs(one.eigenvalue) < 800.0]
        assert len(theirs) >= 4
        np.testing.assert_allclose([one.speed for one in ours], [one.speed for one in theirs], rtol=2e-5)
        values = [one.eigenvalue for one in theirs]
        np.testing.assert_allclose([one.eigenvalue for one in ours], values, rtol=3e-5)
        for one in ours:
            assert one.eigenvalue.imag == pytest.approx(line.order * one.speed, rel=1e-6)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_forward_and_backward_keep_their_branches(sense: float) -> None:
    speeds = sense * np.linspace(0.0, TOP, 11)
    diagram = system_campbell(machine(ROUND, sense * 300.0), speeds, frequency_limit=400.0)
    np.testing.assert_allclose(diagram.speeds, speeds)
    rotor = diagram.kinds[0] == "rotor"
    whirl = sense * diagram.whirl[:, rotor]
    assert rotor.sum() == 4
    np.testing.assert_allclose(np.abs(whirl), 1.0, atol=1e-6)
    assert np.all(whirl == pytest.approx(np.broadcast_to(whirl[0], whirl.shape), abs=1e-6))
    rise = diagram.frequencies_hz[-1, rotor] - diagram.frequencies_hz[0, rotor]
    # A gyroscopic moment lifts forward whirl and lowers backward whirl.
    assert np.all(np.sign(rise) == np.sign(whirl[0]))


def test_crossing_is_a_mode_of_the_machine_at_that_speed() -> None:
    gear = machine(TABLED, 300.0)
    diagram = system_campbell(gear, np.linspace(100.0, TOP, 9), frequency_limit=700.0)
    assert len(diagram.crossings) >= 4
    for one in diagram.crossings:
        values = coupled_modes(gear.at_speed(one.speed).system).eigenvalues
        assert np.abs(values - one.eigenvalue).min() < 1e-9 * abs(one.eigenvalue)


def test_lines_of_one_order_cross_where_the_frequency_is_that_order() -> None:
    """Two names of one order have the same crossings, and progress goes on to their end."""
    lines = [ExcitationLine(name, "shaft", 1.0) for name in ("first", "second")]
    told: list[tuple[str, float | None]] = []
    diagram = system_campbell(
        machine(ROUND, 300.0),
        np.linspace(50.0, TOP, 9),
        frequency_limit=500.0,
        lines=lines,
        progress=lambda message, fraction=None: told.append((message, fraction)),
    )
    both = [[(one.speed, one.eigenvalue) for one in diagram.crossings if one.line is line] for line in lines]
    assert len(both[0]) >= 2
    assert both[0] == both[1]
    for speed, value in both[0]:
        assert value.imag == pytest.approx(speed, rel=1e-10)
    for message in ("coupled modes over speed", "crossings with excitation orders"):
        parts = [fraction for words, fraction in told if words == message]
        assert parts == sorted(parts)
        assert parts[-1] == 1.0


def two(speed: float, tie: float) -> ModesAtSpeed:
    """Squares 1 + s and 2 - s of two frequencies, tied by a weak spring: they meet at s = 1/2."""
    stiffness = np.array([[1.0 + speed, tie], [tie, 2.0 - speed]])
    pairs = quadratic_eigenpairs(stiffness, 0.01 * np.eye(2))
    upper = np.flatnonzero(pairs.values.imag > 0.0)
    upper = upper[np.argsort(pairs.values[upper].imag)]
    return ModesAtSpeed(speed, pairs.values[upper], pairs.right[upper], pairs.left[upper], 0.01 * np.eye(2))


def test_untied_modes_cross_and_tied_ones_veer() -> None:
    """One coarse step across the meeting place; the tie's gap is a tenth of the step, and is seen."""
    np.testing.assert_array_equal(matched(two(0.1, 0.0), two(0.9, 0.0), lambda s: two(s, 0.0), 10.0), [1, 0])
    np.testing.assert_array_equal(matched(two(0.1, 0.04), two(0.9, 0.04), lambda s: two(s, 0.04), 10.0), [0, 1])


def test_likeness_is_one_and_nought_within_a_system() -> None:
    np.testing.assert_allclose(likeness(two(0.3, 0.2), two(0.3, 0.2)), np.eye(2), atol=1e-12)


def geared(speed: float) -> CoupledMachine:
    """Two short shafts on stiff bearings, 20 teeth driving 50."""
    wheels = [Gear("pinion", 20, 0.003, np.radians(20.0), face_width=0.02)]
    wheels.append(Gear("wheel", 50, 0.003, np.radians(20.0), face_width=0.02))
    pair = GearPairGeometry(wheels[0], wheels[1])
    parts, bearings, mounted = [], [], []
    for name, x in (("fast", 0.0), ("slow", pair.working_centre_distance)):
        rotor = Rotor(name, [Segment(0.2, 0.03, 0.0, STEEL)], [Disc(0.1, 2.0, 0.004, 0.002)])
        held = [Bearing.isotropic(f"{name} {at}", at, 2e8, 100.0) for at in (0.0, 0.2)]
        lateral = solve_lateral_modes(rotor, [bearing.mean_support for bearing in held], count=3)
        basis = add_attachment_modes(lateral, forces_at=[0.0, 0.1, 0.2])
        parts.append(rotor_component(name, ModalRotor(basis, solve_torsional_modes(rotor, count=2)), start=0.0))
        bearings += [MountedBearing(bearing, name, None) for bearing in held]
        mounted.append(MountedGear(wheels[len(mounted)].name, name, 0.1, (x, 0.0)))
    mesh = GearMesh(mounted[0], mounted[1], pair, tooth_contact(pair, ConstantStiffness(2e8)))
    return assemble_machine(parts, None, speeds={"fast": speed, "slow": -0.4 * speed}, bearings=bearings, meshes=[mesh])


def test_orders_of_a_train() -> None:
    lines = excitation_lines(geared(100.0), shaft_orders=(1.0,), mesh_harmonics=(1, 2), sidebands=1)
    orders = {line.name: line.order for line in lines}
    assert orders["1× fast"] == 1.0
    assert orders["1× slow"] == pytest.approx(0.4)
    assert orders["2× pinion -> wheel"] == 40.0
    sidebands = sorted(line.order for line in lines if line.kind == "sideband")
    np.testing.assert_allclose(sidebands, [19.0, 19.6, 20.4, 21.0, 39.0, 39.6, 40.4, 41.0])


def test_lower_sidebands_beyond_zero_are_folded_and_the_one_at_zero_is_no_line() -> None:
    """cos 20θ cos 21θ has the order 1, cos 20θ cos 20θ a mean: of 20 teeth the lines are 1 to 19 and 1 to 2 again."""
    lines = excitation_lines(geared(100.0), shaft_orders=(), mesh_harmonics=(1,), sidebands=22)
    lower = [line.order for line in lines if "wheel - " in line.name and line.name.endswith("fast")]
    np.testing.assert_allclose(lower, [*range(19, 0, -1), 1, 2])
    assert min(line.order for line in lines) > 0.0


def test_mesh_orders_meet_the_modes() -> None:
    """Every branch below the line at both ends has none, every one it passes has one crossing."""
    diagram = system_campbell(geared(100.0), np.linspace(20.0, 1200.0, 15), frequency_limit=4e4)
    for line in (line for line in diagram.lines if line.kind == "mesh"):
        gap = diagram.eigenvalues.imag - line.order * np.abs(diagram.speeds)[:, None]
        met = sorted(one.branch for one in diagram.crossings if one.line == line)
        passed = [b for b in range(gap.shape[1]) if gap[0, b] > 0.0 > gap[-1, b]]
        assert met == passed
        assert passed
    most = max(diagram.crossings, key=lambda one: one.teeth)
    assert most.teeth > 0.1


def test_speeds_that_make_no_diagram() -> None:
    with pytest.raises(CouplingError, match="of one sense, ascending in size"):
        system_campbell(machine(ROUND, 10.0), [-1.0, 2.0], frequency_limit=100.0)
    with pytest.raises(CouplingError, match="frequency limit"):
        system_campbell(machine(ROUND, 10.0), [1.0, 2.0], frequency_limit=0.0)
    with pytest.raises(CouplingError, match="stands still"):
        system_campbell(machine(ROUND, 0.0), [1.0, 2.0], frequency_limit=100.0)


def test_a_round_shaft_at_rest_whirls_in_no_sense() -> None:
    """Forward and backward whirl are one double root there: rounding must not choose the sense that is told."""
    system = machine(ROUND, 300.0).at_speed(1e-12).system
    stiffer = [
        replace(one, stiffness=one.stiffness * (1.0 + 1e-15 * number)) for number, one in enumerate(system.linear)
    ]
    for one in (system, replace(system, linear=tuple(stiffer))):
        whirl = coupled_modes(one).whirl
        assert np.nanmax(np.abs(whirl)) < 1e-6
