"""Spalls of rolling bearings in motion: law, energy and power, slow and fast passing, and the names of lines."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import root
from test_spalls_in_machines import SPEED, machine

from gearwhine.coupling import (
    CoupledSystem,
    RollingLaw,
    TransientOutputs,
    TransientSettings,
    simulate,
)
from gearwhine.coupling.connector_forces.bearing_kernels import bearing_force
from gearwhine.coupling.connector_forces.kernel_arrays import bearing_arrays
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import LinearConnector, NonlinearConnector
from gearwhine.coupling.machine.driving_frequencies import spall_strikes
from gearwhine.coupling.signals import line_names
from gearwhine.coupling.signals.condition_indicators import envelope_spectrum
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import RotorError
from gearwhine.rotors.rolling_bearings import (
    BallRow,
    RollerRow,
    RollingBearing,
    RollingSpall,
    RollingState,
    TaperedRollerRow,
    characteristic_frequencies,
    paired,
    rolling_equilibrium,
    rolling_state,
    spall_contacts,
)

BALLS = BallRow(9, 12e-3, 60e-3, clearance=10e-6)
ROLLERS = RollerRow(13, 9e-3, 9e-3, 50e-3, clearance=8e-6)
TAPERED = TaperedRollerRow(15, 8e-3, 12e-3, 55e-3, angle=0.25)
FREE = np.eye(5)


def connector(state: RollingState, *spalls: RollingSpall, angle: float = 0.0, speed: float = 0.0) -> NonlinearConnector:
    """A bearing that is free in all its motions."""
    law = RollingLaw(state, angle, spalls)
    return NonlinearConnector("bearing", FREE, np.arange(5), law, state.stiffness, speed)


def force_at(one: NonlinearConnector, q: FloatArray, time: float = 0.0) -> tuple[FloatArray, float, float]:
    """Force, energy and power of a bearing's law."""
    force, tangent = np.zeros(5), np.zeros((5, 5))
    energy, power = bearing_force(bearing_arrays([one]), 0, time, q.copy(), force, tangent)
    return force, energy, power


@pytest.mark.parametrize("row", [BALLS, ROLLERS], ids=["balls", "rollers"])
@pytest.mark.parametrize("on", ["outer", "inner", "element"])
def test_one_loaded_element_over_a_spall_has_as_much_more_clearance(row: BallRow | RollerRow, on: str) -> None:
    """With the ring pushed towards it, element 2 alone carries, by its approach less the drop."""
    angle = 0.3 + 2.0 * 2.0 * math.pi / row.count
    q = (0.5 * row.clearance + 0.5e-6) * np.array([math.cos(angle), math.sin(angle), 0.0, 0.0, 0.0])
    spall = RollingSpall(on, 1e-3, 0.2e-6, azimuth=0.004, element=2)  # type: ignore[arg-type]
    if on != "element":
        spall = replace(spall, azimuth=spall.azimuth + angle)
    contact = spall_contacts(spall, RollingBearing([row]), 0.0)[0]
    drop = contact.drop(0.004)
    assert drop == 0.2e-6
    found = force_at(connector(rolling_state(RollingBearing([row]), np.zeros(5)), spall, angle=0.3), q)[0]
    looser = rolling_state(RollingBearing([replace(row, clearance=row.clearance + 2.0 * drop)]), q, cage_angle=0.3)
    np.testing.assert_allclose(found, looser.reaction, rtol=1e-10, atol=1e-9)
    sound = rolling_state(RollingBearing([row]), q, cage_angle=0.3)
    assert 0.0 < np.hypot(*looser.reaction[:2]) < 0.6 * np.hypot(*sound.reaction[:2])


@pytest.mark.parametrize(
    "bearing",
    [
        RollingBearing([BALLS]),
        RollingBearing([replace(BALLS, contact_angle=0.4)], axial_preload=300.0),
        RollingBearing([ROLLERS]),
        paired(TAPERED, "face to face", 0.02, preload=800.0),
    ],
    ids=["deep", "angular", "rollers", "tapered"],
)
@pytest.mark.parametrize("on", ["outer", "inner", "element"])
def test_force_and_power_are_the_slopes_of_the_energy(bearing: RollingBearing, on: str) -> None:
    """Over the displacement, and over the time in which cage, rings and elements turn, with a part of the width."""
    width = None if isinstance(bearing.rows[0], BallRow) else 5e-3
    length = 10e-3 if on != "element" else 3e-3
    spalls = (
        RollingSpall(on, length, 1e-3, azimuth=0.35, width=width),  # type: ignore[arg-type]
        RollingSpall(on, 0.5 * length, 3e-6, azimuth=0.9, row=len(bearing.rows) - 1, element=1),  # type: ignore[arg-type]
    )
    q = np.array([18e-6, 9e-6, 3e-6 if bearing.has_axial_stiffness else 0.0, 2e-4, -1e-4])
    one = connector(rolling_state(bearing, q), *spalls, angle=0.3, speed=40.0)
    sound = connector(rolling_state(bearing, q), angle=0.3, speed=40.0)
    felt = 0
    for time in np.linspace(0.0, 0.1, 53).tolist():
        force, energy, power = force_at(one, q, time)
        felt += energy != force_at(sound, q, time)[1]
        work = np.array([1e-9, -2e-9, 1e-9, 1e-8, 2e-8])
        along = 0.5 * (force_at(one, q + work, time)[1] - force_at(one, q - work, time)[1])
        assert along == pytest.approx(force @ work, rel=3e-5)
        # The middle of a spall and its floor bend the energy: where a bend lies between, the slopes on either side do.
        later, earlier = force_at(one, q, time + 1e-7), force_at(one, q, time - 1e-7)
        slope = (later[1] - earlier[1]) / 2e-7
        low, high = min(later[2], earlier[2], power), max(later[2], earlier[2], power)
        slack = 2e-5 * max(abs(low), abs(high)) + 1e-12
        assert low - slack <= slope <= high + slack
    assert felt > 4


def test_a_narrow_spall_takes_its_share_of_a_roller() -> None:
    """Rollers carry by their sound slices alone where the middle drops by more than they are pressed."""
    q = np.array([25e-6, 0.0, 0.0, 0.0, 0.0])
    row = replace(ROLLERS, profile="straight", slices=30)
    state = rolling_state(RollingBearing([row]), q)
    sound = force_at(connector(state), q)[0][0]
    narrow = force_at(connector(state, RollingSpall("outer", 3e-3, 1e-3, width=3e-3)), q)[0][0]
    whole = force_at(connector(state, RollingSpall("outer", 3e-3, 1e-3)), q)[0][0]
    assert whole < 0.8 * sound
    assert sound - narrow == pytest.approx((sound - whole) / 3.0, rel=1e-9)


def on_bearing(one: NonlinearConnector, mass: float, load: FloatArray, damping: float) -> CoupledSystem:
    """A rigid body on one bearing, its linear tangent in place as the machine leaves it there."""
    directions = FREE / math.sqrt(mass)
    held = replace(one, directions=directions)
    body = Component("body", ("rotor",) * 5, np.zeros((5, 5)), damping * np.eye(5), np.zeros((5, 5)))
    linear = LinearConnector("bearing", directions, one.stiffness, np.zeros((5, 5)))
    return CoupledSystem((body,), (one.speed,), (linear,), load=load / math.sqrt(mass), nonlinear=(held,))


@pytest.mark.parametrize(("on", "azimuth"), [("outer", -0.5 * math.pi), ("inner", -0.5 * math.pi - 1.5)])
def test_slow_passing_is_a_row_of_equilibria(on: str, azimuth: float) -> None:
    """Where the shaft turns slowly it stands in equilibrium at every place of the balls: solved on its own here."""
    load = np.array([0.0, -700.0, 0.0, 0.0, 0.0])
    bearing = RollingBearing([BALLS])
    spall = RollingSpall(on, 4e-3, 15e-6, azimuth=azimuth)  # type: ignore[arg-type]
    state = rolling_equilibrium(bearing, load)
    speed = 0.2
    system = on_bearing(connector(state, spall, speed=speed), 1.0, load, damping=500.0)
    chosen = TransientSettings(12.0, 3.0, 0.1, 1e-3, tolerance=1e-3)
    result = simulate(system, chosen, TransientOutputs(FREE, FREE, FREE))
    (contact,) = spall_contacts(spall, bearing, speed)

    def unbalanced(place: FloatArray, time: float) -> FloatArray:
        force = load[:2].copy()
        for ball in range(BALLS.count):
            azimuth = BALLS.cage_speed(speed) * time + 2.0 * math.pi * ball / BALLS.count
            away = np.array([math.cos(azimuth), math.sin(azimuth)])
            drop = contact.drop(azimuth - contact.azimuth - contact.rate * time)
            approach = max(float(place @ away) - 0.5 * BALLS.clearance - drop, 0.0)
            force -= BALLS.stiffness * approach**1.5 * away
        return force

    place, sound = state.displacement[:2], []
    for time, found in zip(result.times.tolist(), result.displacement, strict=True):
        place = root(unbalanced, place, args=(time,), tol=1e-13).x
        np.testing.assert_allclose(found[:2], place, atol=4e-9)
        sound.append(float(np.hypot(*place)))
    assert np.ptp(sound) > 3e-6


# -------------------------------------------------------------------------------------------------------- the machine


@pytest.mark.parametrize(
    ("on", "tone", "turning"),
    [("outer", "outer raceway", 0.0), ("inner", "inner raceway", 25.0), ("element", "rolling element", 10.0)],
)
def test_the_envelope_of_a_force_has_the_tone_of_the_damaged_part(on: str, tone: str, turning: float) -> None:
    """The line at its characteristic frequency stands out of the sound bearing's; the energy balance closes.

    The cage of this bearing turns at 0.4 of the shaft's speed, 10 Hz.
    """
    spall = RollingSpall(on, 1.5e-3, 40e-6, azimuth=-0.5 * math.pi)  # type: ignore[arg-type]
    bearing = RollingBearing([BALLS])
    known = characteristic_frequencies(BALLS, SPEED).named()[tone] / (2.0 * math.pi)
    interval = 1.0 / 16384.0
    chosen = TransientSettings(0.62, 0.1, interval, 2e-5, tolerance=1e-3)
    height = []
    for spalls in ((spall,), ()):
        parts = machine(bearing, *spalls, housing=False)
        result = simulate(parts.system, chosen, transient_outputs(parts))
        assert result.energy.error < 2e-3
        force = histories(parts, result).bearing_force["left"][:, 1]
        frequencies, lines = envelope_spectrum(force - force.mean(), interval, (2000.0, 4000.0))
        height.append(float(np.interp(known, frequencies, lines)))
        if spalls:
            assert height[0] > 0.1 * lines[0]
    assert height[0] > 1e3 * height[1]
    parts = machine(bearing, spall, housing=False)
    (strikes,) = spall_strikes(parts.system)
    assert strikes.frequency == pytest.approx(known, rel=1e-12)
    assert strikes.turning_frequency == pytest.approx(turning)
    sides = [] if turning == 0.0 else [7.0 * known - turning, 7.0 * known + 2.0 * turning]
    names = [line.name for line in line_names(parts, [7.0 * known, *sides], 1e-3)]
    # The sound bearing is passed as often as an outer raceway is struck.
    passed = "7× elements of right, " if on == "outer" else ""
    assert names[0] == f"{passed}7× {tone} of left"
    carried = {"inner": "inner ring of left", "element": "cage of left"}.get(on)
    assert names[1:] == ([] if carried is None else [f"7× {tone} of left {by}× {carried}" for by in ("- 1", "+ 2")])


def test_spalls_that_a_bearing_cannot_have_are_refused_with_its_law() -> None:
    state = rolling_state(RollingBearing([BALLS]), np.zeros(5))
    with pytest.raises(RotorError, match="row of a spall of rolling bearing is 1"):
        RollingLaw(state, spalls=(RollingSpall("outer", 1e-3, 1e-4, row=1),))
