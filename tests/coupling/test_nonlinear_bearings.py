"""Bearings with laws of their own: the law, rest, energy, impacts, the linear limit, and the passing of the balls."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling import (
    CoupledMachine,
    CoupledSystem,
    CouplingError,
    GapLaw,
    MachineLoads,
    MountedBearing,
    PeriodicError,
    RollingLaw,
    TransientOutputs,
    TransientSettings,
    amplitude_spectrum,
    assemble_machine,
    periodic_response,
    simulate,
    static_equilibrium,
)
from gearwhine.coupling.connector_forces.kernel_arrays import bearing_arrays
from gearwhine.coupling.machine.components import Component, rotor_component
from gearwhine.coupling.machine.connectors import LinearConnector, NonlinearConnector
from gearwhine.coupling.machine.loads import Unbalance
from gearwhine.coupling.signals import line_names
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.transient import TransientResult
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Disc, Rotor, Segment, ShaftMaterial, modal_rotor
from gearwhine.rotors.rolling_bearings import (
    BallRow,
    FourPointRow,
    RollerRow,
    RollingBearing,
    RollingState,
    SphericalRollerRow,
    TaperedRollerRow,
    linearised_bearing,
    paired,
    rolling_equilibrium,
    rolling_state,
)

DEEP = RollingBearing([BallRow(9, 12e-3, 60e-3, clearance=10e-6)])
FLOATING = replace(DEEP, floating=True)
ANGULAR_ROW = BallRow(12, 10e-3, 55e-3, contact_angle=0.4, inner_groove=0.515)
ANGULAR = RollingBearing([ANGULAR_ROW], axial_preload=300.0)
PAIRED = paired(ANGULAR_ROW, "back to back", 0.02, preload=200.0)
ROLLERS = RollingBearing([RollerRow(13, 9e-3, 9e-3, 50e-3, clearance=8e-6)])
TAPERED = paired(TaperedRollerRow(15, 8e-3, 12e-3, 55e-3, angle=0.25), "face to face", 0.02, preload=800.0)
SPHERICAL_ROW = SphericalRollerRow(15, 8e-3, 8e-3, 55e-3, angle=0.2)
SPHERICAL = RollingBearing([SPHERICAL_ROW.facing(1), SPHERICAL_ROW.facing(-1)])
ALL = pytest.mark.parametrize(
    "bearing",
    [DEEP, FLOATING, ANGULAR, PAIRED, ROLLERS],
    ids=["deep", "floating", "angular", "paired", "rollers"],
)
LAWS = pytest.mark.parametrize(
    "bearing",
    [DEEP, FLOATING, ANGULAR, PAIRED, ROLLERS, TAPERED, SPHERICAL, replace(SPHERICAL, floating=True)],
    ids=["deep", "floating", "angular", "paired", "rollers", "tapered", "spherical", "floating spherical"],
)
FREE = np.eye(5)


def body(mass: float, coordinates: int = 5, damping: float = 0.0) -> Component:
    """A rigid body that moves along x, y, z and about x and y by q / sqrt(mass)."""
    zeros = np.zeros((coordinates, coordinates))
    return Component("body", ("rotor",) * coordinates, zeros, damping * np.eye(coordinates), zeros)


def on_bearing(
    state: RollingState, mass: float, load: FloatArray, *, speed: float = 0.0, damping: float = 0.0
) -> CoupledSystem:
    """A rigid body on one rolling bearing, its linear tangent in place as the machine leaves it there."""
    directions = FREE / math.sqrt(mass)
    tangent = state.stiffness
    law = NonlinearConnector("bearing", directions, np.arange(5), RollingLaw(state), tangent, speed)
    linear = LinearConnector("bearing", directions, tangent, np.zeros((5, 5)))
    return CoupledSystem((body(mass, 5, damping),), (speed,), (linear,), load=load / math.sqrt(mass), nonlinear=(law,))


def everything(n: int) -> TransientOutputs:
    return TransientOutputs(np.eye(n), np.eye(n), np.eye(n))


# ------------------------------------------------------------------------------------------------------------ the law


@LAWS
def test_the_compiled_law_is_that_of_the_room_of_rotors(bearing: RollingBearing) -> None:
    """Forces and tangent by the rolling room's own code; energy and its slopes by differences."""
    from gearwhine.coupling.connector_forces.bearing_kernels import bearing_force

    q = np.array([8e-6, -12e-6, 3e-6 if bearing.has_axial_stiffness else 0.0, 2e-4, -1e-4])
    state = rolling_state(bearing, q, cage_angle=0.3)
    law = RollingLaw(state, cage_angle=0.3)
    arrays = bearing_arrays([NonlinearConnector("b", FREE, np.arange(5), law, state.stiffness, 100.0)])
    force, tangent = np.zeros(5), np.zeros((5, 5))
    _, slope = bearing_force(arrays, 0, 0.0, q, force, tangent)
    np.testing.assert_allclose(force, state.reaction - bearing.axial_preload * FREE[2], rtol=1e-11, atol=1e-9)
    np.testing.assert_allclose(tangent, state.stiffness, atol=1e-12 * np.abs(state.stiffness).max())
    work = np.array([1e-9, -2e-9, 1e-9, 1e-8, 2e-8])
    known, spare, other = force.copy(), np.zeros(5), np.zeros((5, 5))
    ahead, behind = (bearing_force(arrays, 0, 0.0, q + sign * work, spare, other)[0] for sign in (1.0, -1.0))
    assert 0.5 * (ahead - behind) == pytest.approx(known @ work, rel=1e-5)
    ahead, behind = (bearing_force(arrays, 0, sign * 1e-6, q, spare, other)[0] for sign in (1.0, -1.0))
    assert (ahead - behind) / 2e-6 == pytest.approx(slope, rel=1e-5)


def test_elements_without_a_law_in_time_are_refused() -> None:
    flanged = RollingBearing([replace(ROLLERS.rows[0], flanges="one", flange_stiffness=1e7)])
    with pytest.raises(CouplingError, match="cylindrical rollers between flanges; expected other elements"):
        RollingLaw(rolling_state(flanged, np.zeros(5)))
    four = RollingBearing([FourPointRow(9, 12e-3, 60e-3, 0.6)])
    with pytest.raises(CouplingError, match=r"balls in four-point contact.*law = \"linear\""):
        RollingLaw(rolling_state(four, np.zeros(5)))


@ALL
def test_rest_is_the_equilibrium_of_the_room_of_rotors(bearing: RollingBearing) -> None:
    """From a tangent at half the load, so that Newton's method has a way to go."""
    axial = 400.0 if bearing.has_axial_stiffness else 0.0
    load = np.array([900.0, -500.0, axial, 2.0, -1.0])
    expected = rolling_equilibrium(bearing, load)
    begin = rolling_equilibrium(bearing, 0.5 * load)
    system = on_bearing(begin, 4.0, load)
    found = static_equilibrium(system) / math.sqrt(4.0)
    scale = np.array([1.0, 1.0, 1.0, bearing.reach, bearing.reach])
    # A floating bearing does not place the shaft along its axis.
    scale[2] *= not bearing.floating
    largest = np.abs(expected.displacement * scale).max()
    np.testing.assert_allclose(found * scale, expected.displacement * scale, atol=1e-8 * largest)


# --------------------------------------------------------------------------------------------------------- the motion


def struck(system: CoupledSystem, seconds: float, step: float, velocity: FloatArray) -> TransientResult:
    start = static_equilibrium(system), velocity
    chosen = TransientSettings(seconds, 0.0, seconds / 256, step, tolerance=1.0)
    return simulate(system, chosen, everything(system.size), initial=start)


@ALL
def test_energy_is_kept(bearing: RollingBearing) -> None:
    """Kinetic and elastic energy less the load's potential, the elastic one by the rolling room's own code."""
    load = np.array([900.0, -500.0, 400.0 if bearing.has_axial_stiffness else 0.0, 2.0, -1.0])
    mass, state = 4.0, rolling_equilibrium(bearing, load)
    system = on_bearing(state, mass, load)
    # Struck so that elements come out of their load and back.
    velocity = 0.03 * np.array([1.0, -0.5, 0.3 if bearing.has_axial_stiffness else 0.0, 0.05, 0.1])
    result = struck(system, 0.01, 1e-6, velocity)
    assert result.energy.error < 1e-6
    energies = []
    for q, v in zip(result.displacement[::16], result.velocity[::16], strict=True):
        moved = q / math.sqrt(mass)
        force = rolling_state(bearing, moved)
        elastic = 0.0
        for row, loads in zip(bearing.rows, force.rows, strict=True):
            if isinstance(row, BallRow):
                elastic += float((0.4 * loads.inner_load * loads.approach).sum())
            else:
                assert loads.slice_loads is not None
                deep = (loads.slice_loads * row.slices / row.stiffness) ** 0.9
                elastic += float((9.0 / 19.0 * loads.slice_loads * deep).sum())
        energies.append(0.5 * v @ v + elastic - bearing.axial_preload * moved[2] - system.load @ q)
    kinetic = 0.5 * velocity @ velocity
    np.testing.assert_allclose(energies, energies[0], atol=2e-4 * kinetic)


@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_an_impact_lasts_as_long_as_theory_says(exponent: float) -> None:
    """Half a swing of a spring; for Hertz's law 2.94 α/v, α = (5 m v² / 4 K)^(2/5) (Johnson 1985, section 11.4).

    With p = n + 1 the constant is 2 ∫ dx / √(1 - x^p) from 0 to 1, 2 √π Γ(1/p) / (p Γ(1/p + 1/2)).
    """
    power = exponent + 1.0
    constant = 2.0 * math.sqrt(math.pi) * math.gamma(1.0 / power) / (power * math.gamma(1.0 / power + 0.5))
    assert constant == pytest.approx(math.pi if exponent == 1.0 else 2.94, abs=5e-3)
    mass, speed, gap, stiffness = 2.0, 0.4, 20e-6, 4e9 if exponent > 1.0 else 3e7
    law = GapLaw(stiffness * 1e-5**exponent, 1e-5, exponent, gap)
    directions = np.eye(2) / math.sqrt(mass)
    connector = NonlinearConnector("stop", directions, np.arange(2), law, np.zeros((2, 2)), 0.0)
    system = CoupledSystem((body(mass, 2),), (0.0,), nonlinear=(connector,))
    deepest = (1.25 * mass * speed**2 / stiffness) ** 0.4 if exponent > 1.0 else speed * math.sqrt(mass / stiffness)
    lasting = constant * deepest / speed
    direction = np.array([0.6, -0.8])
    way = gap / speed
    start = np.zeros(2), math.sqrt(mass) * speed * direction
    # Between its walls the body flies for twice the way of the gap, and back to where it was.
    total = 2.0 * (2.0 * way + lasting)
    chosen = TransientSettings(1.001 * total, 0.0, total / 1024, lasting / 2000, tolerance=1.0)
    result = simulate(system, chosen, everything(2), initial=start)
    moved = result.displacement @ direction / math.sqrt(mass)
    assert moved.max() == pytest.approx(gap + deepest, rel=1e-5)
    assert moved.min() == pytest.approx(-gap - deepest, rel=1e-5)
    # Where it crosses the middle on its way back: by then it has flown two ways and struck once.
    crossing = int(np.flatnonzero((moved[:-1] > 0.0) & (moved[1:] <= 0.0))[0])
    part = moved[crossing] / (moved[crossing] - moved[crossing + 1])
    found = float(result.times[crossing] + part * (result.times[1] - result.times[0]))
    assert found == pytest.approx(2.0 * way + lasting, rel=2e-5)
    assert result.energy.error < 1e-6


def test_a_linear_law_is_the_linear_bearing() -> None:
    """To rounding, step by step, though the tangent that it stands beside is another."""
    mass, stiffness = 3.0, 2e7
    directions = np.eye(2) / math.sqrt(mass)
    zeros = np.zeros((2, 2))
    linear = LinearConnector("spring", directions, stiffness * np.eye(2), zeros)
    beside = LinearConnector("spring", directions, 0.6 * stiffness * np.eye(2), zeros)
    law = NonlinearConnector("spring", directions, np.arange(2), GapLaw(stiffness, 1.0), beside.stiffness, 0.0)
    load = np.array([100.0, 40.0])
    one = CoupledSystem((body(mass, 2),), (0.0,), (linear,), load=load)
    other = CoupledSystem((body(mass, 2),), (0.0,), (beside,), load=load, nonlinear=(law,))
    np.testing.assert_allclose(static_equilibrium(other), static_equilibrium(one), rtol=1e-9)
    expected, found = (struck(system, 0.02, 2e-5, np.array([0.1, -0.2])) for system in (one, other))
    scale = np.abs(expected.displacement).max()
    np.testing.assert_allclose(found.displacement, expected.displacement, atol=1e-8 * scale)


def test_small_motions_follow_the_tangent() -> None:
    """The frequencies of a body that swings little about its rest on a bearing that does not turn."""
    load = np.array([900.0, -500.0, 400.0, 2.0, -1.0])
    mass, state = 4.0, rolling_equilibrium(PAIRED, load)
    system = on_bearing(state, mass, load)
    values, vectors = np.linalg.eigh(state.stiffness / mass)
    period = 2.0 * math.pi / math.sqrt(values[-1])
    chosen = TransientSettings(20.0 * period, 0.0, period / 64, period / 1000, tolerance=1.0)
    rest = static_equilibrium(system)
    result = simulate(system, chosen, everything(5), initial=(rest, 1e-5 * vectors[:, -1]))
    swing = (result.displacement - rest) @ vectors[:, -1]
    expected = 1e-5 / math.sqrt(values[-1]) * np.sin(math.sqrt(values[-1]) * result.times)
    np.testing.assert_allclose(swing, expected, atol=2e-3 * np.abs(expected).max())


# -------------------------------------------------------------------------------------------------------- the machine

STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
LOAD, SPEED = 500.0, 2.0 * math.pi * 25.0


def machine(speed: float = SPEED) -> CoupledMachine:
    """A shaft with a disc, its weight on two deep-groove ball bearings with play."""
    state = rolling_equilibrium(DEEP, [0.0, -LOAD, 0.0, 0.0, 0.0], held={"z": 0.0, "rx": 0.0, "ry": 0.0})
    shaft = Rotor("shaft", [Segment(0.1, 0.04, 0.0, STEEL)] * 4, [Disc(0.2, 50.0, 0.5, 0.3)])
    bearings = [
        replace(linearised_bearing(state, f"bearing {at:g}", at), damping=3e4 * np.eye(2)) for at in (0.05, 0.35)
    ]
    modal = modal_rotor(shaft, bearings, count=3)
    return assemble_machine(
        [rotor_component("shaft", modal, start=0.0, damping_ratio=0.02)],
        None,
        speeds={"shaft": speed},
        bearings=[MountedBearing(bearing, "shaft", None, RollingLaw(state)) for bearing in bearings],
        loads=MachineLoads(gravity=(0.0, -9.81, 0.0)),
    )


def test_balls_pass_by_themselves() -> None:
    """Under a load that stands still the shaft moves at Z/2 (1 - D cos α / D_pw) times its speed and multiples only."""
    parts = machine()
    row = DEEP.rows[0]
    passing = 0.5 * row.count * (1.0 - row.element_diameter / row.pitch_diameter) * SPEED / (2.0 * math.pi)
    assert passing == pytest.approx(9 / 2 * 0.8 * 25.0)
    periods, samples = 16, 256
    begin = 30.0 / passing
    chosen = TransientSettings(begin + (periods + 0.01) / passing, begin, 1.0 / passing / samples, 2e-4, tolerance=1e-3)
    result = simulate(parts.system, chosen, transient_outputs(parts))
    assert result.energy.error < 2e-3
    forces = histories(parts, result).bearing_force["bearing 0.05"][: periods * samples]
    spectrum = amplitude_spectrum(forces[:, 1], chosen.sample_interval, "uniform")
    amplitude = np.abs(spectrum.amplitude).copy()
    lines = np.arange(len(amplitude))
    assert spectrum.frequencies[periods] == pytest.approx(passing, rel=1e-9)
    assert amplitude[periods] > 1.0
    named = line_names(parts, [passing, 2.0 * passing, 25.0], 1e-3)
    assert [line.name for line in named[:2]] == [
        f"{multiple}× elements of bearing 0.05, {multiple}× elements of bearing 0.35" for multiple in (1, 2)
    ]
    # The shaft is in balance: it has no line of its own.
    assert [line.kind for line in named] == ["bearing", "bearing", "other"]
    # With unbalance it has every multiple, for balls are no linear springs.
    unbalanced = replace(parts, loads=replace(parts.loads, unbalances=(Unbalance("shaft", 0.2, 1e-3, 0.0),)))
    found = line_names(unbalanced, [25.0, 75.0, 175.0], 1e-3)
    assert [(line.kind, line.name) for line in found] == [("shaft", f"{number}× shaft") for number in (1, 3, 7)]
    # Between the multiples there is nothing.
    between = amplitude[(lines % periods != 0) & (lines > 0)]
    assert between.max() < 0.01 * amplitude[periods]
    # The bearings carry the weight.
    total = sum(force[: periods * samples, 1].mean() for force in histories(parts, result).bearing_force.values())
    assert total == pytest.approx(-9.81 * (50.0 + 7850.0 * 0.4 * math.pi * 0.02**2), rel=1e-3)


def test_a_shaft_that_does_not_turn_rests() -> None:
    parts = machine(0.0)
    chosen = TransientSettings(0.02, 0.0, 1e-4, 1e-4)
    result = simulate(parts.system, chosen, transient_outputs(parts))
    still = result.displacement - result.displacement[0]
    assert np.abs(still).max() < 1e-6 * np.abs(result.displacement).max()


def test_play_gives_under_the_weight() -> None:
    """The static sag of the law is that of the rolling equilibrium under half the weight: play, then Hertz."""
    parts = machine(0.0)
    q = static_equilibrium(parts.system)
    weight = 9.81 * (50.0 + 7850.0 * 0.4 * math.pi * 0.02**2)
    for connector in parts.system.nonlinear:
        expected = rolling_equilibrium(DEEP, [0.0, -weight / 2, 0.0, 0.0, 0.0], held={"z": 0.0, "rx": 0.0, "ry": 0.0})
        found = connector.directions.T @ q
        assert found[1] == pytest.approx(expected.displacement[1], rel=2e-2)
        tilted = dict(zip(("x", "y", "z", "rx", "ry"), np.zeros(5), strict=True))
        tilted.update(
            {("x", "y", "z", "rx", "ry")[axis]: float(v) for axis, v in zip(connector.axes, found, strict=True)}
        )
        exact = rolling_state(DEEP, [tilted[name] for name in ("x", "y", "z", "rx", "ry")])
        assert exact.reaction[1] == pytest.approx(-weight / 2, rel=1e-6)


def test_what_cannot_be_is_refused() -> None:
    for wrong, named in (
        ({"force": 0.0, "depth": 1e-5}, "force"),
        ({"force": 1.0, "depth": -1e-5}, "depth"),
        ({"force": 1.0, "depth": 1e-5, "exponent": 0.5}, "exponent"),
        ({"force": 1.0, "depth": 1e-5, "gap": -1.0}, "gap"),
    ):
        with pytest.raises(CouplingError, match=named):
            GapLaw(**wrong)
    state = rolling_equilibrium(DEEP, [500.0, 0.0, 0.0, 0.0, 0.0], held={"z": 0.0, "rx": 0.0, "ry": 0.0})
    with pytest.raises(CouplingError, match="axes"):
        NonlinearConnector("b", FREE, np.arange(4), RollingLaw(state), state.stiffness, 0.0)
    with pytest.raises(PeriodicError, match="nonlinear bearings"):
        periodic_response(on_bearing(state, 1.0, np.zeros(5), speed=10.0))


def test_a_gap_s_tangent_is_the_slope_of_its_force() -> None:
    law = GapLaw(100.0, 1e-5, 1.7, 3e-5)
    load = np.array([40.0, -30.0])
    beyond = 1e-5 * (50.0 / 100.0) ** (1.0 / 1.7)
    place = (3e-5 + beyond) * load / 50.0

    def force(q: FloatArray) -> FloatArray:
        radius = float(np.hypot(*q))
        return np.asarray(100.0 * ((radius - 3e-5) / 1e-5) ** 1.7 * q / radius)

    step = 1e-10
    slope = np.column_stack([(force(place + d) - force(place - d)) / (2.0 * step) for d in step * np.eye(2)])
    np.testing.assert_allclose(force(place), load, rtol=1e-12)
    np.testing.assert_allclose(law.tangent(load), slope, rtol=1e-5, atol=1.0)

    energy, push, tangent = law.at(place)
    # The work of F = 100 N (x / 10 µm)^1.7 on the way beyond the gap.
    assert energy == pytest.approx(50.0 * beyond / 2.7, rel=1e-12)
    np.testing.assert_allclose(push, load, rtol=1e-12)
    np.testing.assert_allclose(tangent, law.tangent(load), rtol=1e-10)


def test_a_linear_spring_without_a_gap_holds_its_centre() -> None:
    energy, push, tangent = GapLaw(100.0, 1e-5).at(np.zeros(2))
    assert energy == 0.0
    np.testing.assert_array_equal(push, 0.0)
    np.testing.assert_allclose(tangent, 1e7 * np.eye(2), rtol=1e-15)
    np.testing.assert_array_equal(GapLaw(100.0, 1e-5, 1.0, 2e-5).at([1e-5, 0.0])[2], 0.0)
