"""Machines that run up and down: their angle over time, and their motion against an independent integration."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp

from gearwhine.coupling import (
    CoupledSystem,
    CouplingError,
    SpeedProfile,
    TransientOutputs,
    TransientSettings,
    simulate,
    static_equilibrium,
)
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector, SpeedTable
from gearwhine.coupling.machine.coupled_system import HarmonicLoad, TimedLoad
from gearwhine.coupling.time.transient import TransientResult
from gearwhine.numerics.arrays import FloatArray


def drawn(rates: list[float], gaps: list[float], begin: float) -> SpeedProfile:
    times = begin + np.concatenate([[0.0], np.cumsum(gaps)])[: len(rates)]
    return SpeedProfile(times, np.array(rates))


turnings = st.builds(
    drawn,
    st.lists(st.floats(0.0, 3.0), min_size=1, max_size=6),
    st.lists(st.floats(0.05, 5.0), min_size=6, max_size=6),
    st.floats(-3.0, 3.0),
)


@given(turnings, st.floats(-5.0, 20.0).filter(lambda time: abs(time) > 1e-3))
def test_turned_time_is_the_integral_of_the_rate(turning: SpeedProfile, time: float) -> None:
    turned, rate, _ = (float(value[0]) for value in turning.at(time))
    assert rate == pytest.approx(np.interp(time, turning.times, turning.speed_ratios), abs=1e-12)
    kinks = [float(t) for t in turning.times if min(0.0, time) < t < max(0.0, time)]
    integral = quad(
        lambda t: float(np.interp(t, turning.times, turning.speed_ratios)), 0.0, time, points=kinks or None
    )[0]
    assert turned == pytest.approx(integral, abs=1e-9)


@given(turnings, st.lists(st.floats(-5.0, 20.0), min_size=1, max_size=5))
def test_times_of_turned_times(turning: SpeedProfile, times: list[float]) -> None:
    given_times = np.array(times)
    turned, rates, _ = turning.at(given_times)
    found = turning.times_of(turned)
    moving = rates > 1e-3
    np.testing.assert_allclose(turning.at(found[moving])[0], turned[moving], rtol=0, atol=1e-10)
    np.testing.assert_allclose(found[moving], given_times[moving], rtol=0, atol=1e-7)


def test_never_turned_so_far() -> None:
    stopping = SpeedProfile(np.array([0.0, 2.0]), np.array([1.0, 0.0]))
    np.testing.assert_allclose(stopping.times_of(np.array([0.5, 1.0])), [2.0 - np.sqrt(2.0), 2.0], rtol=1e-12)
    assert np.isnan(stopping.times_of(np.array([1.0001]))).all()
    assert SpeedProfile.steady().is_steady
    np.testing.assert_array_equal(SpeedProfile.steady().at([-1.0, 0.3])[0], [-1.0, 0.3])


@pytest.mark.parametrize(
    ("times", "rates", "what"),
    [
        ([0.0, 1.0], [1.0], "expected as many"),
        ([0.0, 0.0], [1.0, 2.0], "do not ascend"),
        ([0.0, 1.0], [1.0, -0.1], "one sense of rotation"),
        ([0.0, 1.0], [1.0, np.nan], "not finite"),
    ],
)
def test_speeds_that_make_no_sense(times: list[float], rates: list[float], what: str) -> None:
    with pytest.raises(CouplingError, match=what):
        SpeedProfile(np.array(times), np.array(rates))


# A shaft of two planes on a bearing that stiffens with speed, an unbalance, and a tooth contact on its x motion.
SPEED = 2.0
GYROSCOPIC = np.array([[0.0, 0.3], [-0.3, 0.0]])
OWN = np.diag([1.0, 1.5])
DAMPING = 0.05 * np.eye(2)
TABLE = SpeedTable(
    np.array([0.5, 1.0, 2.0]),
    np.array([np.diag([1.0, 2.0]), np.array([[2.0, 0.3], [-0.3, 2.5]]), np.diag([4.0, 3.0])]),
    np.array([0.1 * np.eye(2), 0.2 * np.eye(2), 0.05 * np.eye(2)]),
)
UNBALANCE = 0.4 * SPEED**2 * np.array([1.0, -1.0j])
TORQUE = TimedLoad(np.array([1.0, 4.0, 5.0]), np.array([0.0, 0.5, 0.2]), np.array([0.0, 1.0]))
RUN_UP = SpeedProfile(np.array([0.0, 6.0, 9.0]), np.array([0.9, 1.1, 1.05]))


def shaft(contacts: tuple[ContactConnector, ...] = ()) -> CoupledSystem:
    body = Component("shaft", ("rotor", "rotor"), OWN, DAMPING, GYROSCOPIC)
    bearing = LinearConnector("bearing", np.eye(2), TABLE.stiffness[1], TABLE.damping[1], TABLE)
    return CoupledSystem(
        (body,),
        (SPEED,),
        (bearing,),
        contacts,
        np.array([0.5, 0.0]),
        (HarmonicLoad(SPEED, UNBALANCE, "unbalance"), HarmonicLoad(1.3, np.array([0.1, 0.2j]))),
        (TORQUE,),
        np.array([0.7, -0.2]),
    )


def rhs(turning: SpeedProfile, tooth: tuple[float, float, float] | None = None):  # type: ignore[no-untyped-def]
    """Written out from the equations, with nothing of the march in it."""

    def slope(time: float, state: FloatArray) -> FloatArray:
        q, v = state[:2], state[2:]
        turned, rate, swing = (float(part[0]) for part in turning.at(time))
        part = [
            np.array([[np.interp(rate, TABLE.speed_ratios, m[:, i, j]) for j in range(2)] for i in range(2)])
            for m in (TABLE.stiffness, TABLE.damping)
        ]
        force = np.array([0.5, 0.0]) + np.array([0.0, 1.0]) * np.interp(time, TORQUE.times, TORQUE.values)
        force = force + swing * np.array([0.7, -0.2])
        # -m e times the second derivative of the direction (cos, sin)(Ω s).
        angle = SPEED * turned
        towards, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        force = force + 0.4 * ((SPEED * rate) ** 2 * towards - SPEED * swing * across)
        force = force + np.array([0.1 * np.cos(1.3 * time), -0.2 * np.sin(1.3 * time)])
        if tooth is not None:
            stiffness, amplitude, frequency = tooth
            error = amplitude * np.cos(frequency * turned + 0.4)
            pairs = 2.0 if (0.8 * turned) % 1.0 < 0.6 else 1.0
            force = force - np.array([1.0, 0.0]) * pairs * stiffness * max(q[0] - error, 0.0)
        spring = OWN @ q + part[0] @ q + swing * SPEED * GYROSCOPIC @ q
        return np.concatenate([v, force - spring - (DAMPING + part[1] + rate * SPEED * GYROSCOPIC) @ v])

    return slope


OUTPUTS = TransientOutputs(np.eye(2), np.eye(2), np.eye(2))


def marched(system: CoupledSystem, step: float, duration: float = 10.0) -> TransientResult:
    settings = TransientSettings(duration, 0.0, 0.5, step, tolerance=1.0)
    return simulate(system, settings, OUTPUTS, speed_profile=RUN_UP, initial=(np.array([0.2, 0.0]), np.zeros(2)))


def reference(slope, breaks: FloatArray, times: FloatArray) -> FloatArray:  # type: ignore[no-untyped-def]
    """Integrated from break to break, so that no step crosses a jump."""
    state, rows = np.array([0.2, 0.0, 0.0, 0.0]), []
    marks = np.concatenate([[0.0], breaks, [times[-1] + 0.01]])
    for begin, end in pairwise(marks):
        inside = times[(times >= begin) & (times < end)]
        hair = 1e-13 * (end - begin)
        span = (begin + hair, end - hair)
        found = solve_ivp(slope, span, state, "DOP853", dense_output=True, rtol=1e-11, atol=1e-13)
        if inside.size:
            rows.append(found.sol(np.clip(inside, *span)).T)
        state = found.y[:, -1]
    return np.concatenate(rows)


def kinks() -> FloatArray:
    speeds = [np.interp(0.0, RUN_UP.speed_ratios[:2] - rate, RUN_UP.times[:2]) for rate in (1.0,)]
    return np.unique(np.concatenate([[1.0, 4.0, 5.0, 6.0, 9.0], speeds]))


def test_run_up_is_of_second_order() -> None:
    """Unbalance, gyroscopic terms, Ω' terms, a bearing over speed and loads over time, together."""
    errors, balances = [], []
    for step in (0.01, 0.005, 0.0025):
        result = marched(shaft(), step)
        exact = reference(rhs(RUN_UP), kinks(), result.times)
        off = np.hstack([result.displacement, result.velocity]) - exact
        errors.append(np.abs(off).max() / np.abs(exact).max())
        balances.append(result.energy.error)
    np.testing.assert_allclose(np.array(errors[:-1]) / errors[1:], 4.0, rtol=0.05)
    assert errors[-1] < 5e-4


def test_run_up_through_teeth() -> None:
    """Events of the teeth at an uneven pace: still of second order, rectangular stiffness and runout."""
    contact = ToothContact(1.6, piecewise.constant(3.0, 1.6), piecewise.constant(0.0, 1.6))
    tooth = ContactConnector("mesh", np.array([1.0, 0.0]), contact, 0.0, 0.8, np.array([[0.05, 1.7, 0.4]]))
    marks = np.sort(np.concatenate([(np.arange(20.0) + part) / 0.8 for part in (0.0, 0.6)]))
    breaks = RUN_UP.times_of(marks)
    breaks = np.unique(np.concatenate([breaks[(breaks > 0.0) & (breaks < 4.0)], kinks()[kinks() < 4.0]]))
    errors = []
    for step in (0.01, 0.005, 0.0025):
        result = marched(shaft((tooth,)), step, 4.0)
        exact = reference(rhs(RUN_UP, (3.0, 0.05, 1.7)), breaks, result.times)
        errors.append(np.abs(result.displacement - exact[:, :2]).max())
    assert errors[-1] < 1e-4
    np.testing.assert_allclose(errors[0] / errors[2], 16.0, rtol=0.25)


def test_steady_turning_is_no_turning() -> None:
    """A table of one speed, written as a run: the same motion as without, to rounding."""
    system = replace(shaft(), timed_loads=())
    settings = TransientSettings(10.0, 0.0, 0.5, 0.02)
    start = (np.array([0.2, 0.0]), np.zeros(2))
    plain = simulate(system, settings, OUTPUTS, initial=start)
    nearly = SpeedProfile(np.array([0.0, 5.0]), np.array([1.0, 1.0 + 1e-14]))
    assert not nearly.is_steady
    varied = simulate(system, settings, OUTPUTS, speed_profile=nearly, initial=start)
    np.testing.assert_allclose(varied.displacement, plain.displacement, rtol=0, atol=1e-5)


def test_starts_in_equilibrium_with_the_loads_of_the_start() -> None:
    """The drive's torque and the inertia that it overcomes press the shaft from the first moment on."""
    system = replace(shaft(), harmonic_loads=(), timed_loads=())
    settings = TransientSettings(1.0, 0.0, 0.1, 0.02)
    result = simulate(system, settings, OUTPUTS, speed_profile=RUN_UP)
    pressed = replace(system, load=system.load + (1.1 - 0.9) / 6.0 * system.acceleration_load)
    np.testing.assert_allclose(result.displacement[0], static_equilibrium(pressed), rtol=1e-12)
