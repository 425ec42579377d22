"""What bounds the steps of a time integration: coarsest step, events, corners of speeds and loads; energy at rest."""

import numpy as np
import pytest

from gearwhine.coupling import CoupledSystem, SpeedProfile, TransientOutputs, TransientSettings, simulate
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import LinearConnector, SpeedTable
from gearwhine.coupling.machine.coupled_system import HarmonicLoad, TimedLoad
from gearwhine.coupling.machine.driving_frequencies import least_sampling_rate
from gearwhine.coupling.time.integration import boundaries, coarsest_step

RUN_UP = SpeedProfile(np.array([0.0, 4.0]), np.array([0.5, 2.0]))


def oscillator(stiffness: float = 4.0, damping: float = 0.0, **loads: object) -> CoupledSystem:
    """x'' + c x' + k x = f of a unit mass."""
    body = Component("mass", ("torsion",), np.full((1, 1), stiffness), np.full((1, 1), damping), np.zeros((1, 1)))
    return CoupledSystem((body,), (0.0,), **loads)  # type: ignore[arg-type]


def test_a_machine_that_runs_faster_is_stepped_finer() -> None:
    """The largest step is a part of a turn: at twice the nominal speed a turn takes half the time."""
    nominal = SpeedProfile(np.array([0.0]), np.array([1.0]))
    coarse, fine = (coarsest_step(oscillator(), turning, 1e-3) for turning in (nominal, RUN_UP))
    assert coarse == pytest.approx(1e-3, rel=1e-12)
    assert fine == pytest.approx(0.5e-3, rel=1e-12)
    # Six points of the period of 2 rad/s, where nothing finer is asked for.
    assert coarsest_step(oscillator(), nominal, 100.0) == pytest.approx(np.pi / 6.0, rel=1e-12)


def test_steps_shrink_and_grow_to_the_tolerance() -> None:
    """The period error (w h)²/12 of the fastest motion that is left takes most of the tolerance, and no more."""
    fast, slow = 2.0 * np.pi * 2000.0, 2.0 * np.pi * 200.0
    stiffness, damping = np.diag([fast**2, slow**2]), np.diag([0.1 * fast, 0.0])
    system = CoupledSystem((Component("masses", ("torsion",) * 2, stiffness, damping, np.zeros((2, 2))),), (0.0,))
    outputs, tolerance = TransientOutputs(*np.zeros((3, 0, 2))), 1e-4

    def steps(duration: float) -> tuple[int, float]:
        settings = TransientSettings(duration, 0.0, 0.01, 1.0, tolerance=tolerance)
        result = simulate(system, settings, outputs, initial=(np.ones(2), np.zeros(2)))
        assert result.error <= tolerance
        return result.steps, result.smallest_step

    (before, smallest), (after, _) = steps(3.0), steps(6.0)
    allowed = np.sqrt(12.0 * tolerance)
    assert 0.8 * allowed / fast < smallest <= allowed / fast
    assert 1.0 <= (after - before) * allowed / slow / 3.0 < 1.2


def test_steps_grow_no_larger_than_the_coarsest() -> None:
    settings, nothing = TransientSettings(2000.0, 0.0, 1.0, 0.1, tolerance=1.0), np.zeros((0, 1))
    outputs = TransientOutputs(nothing, nothing, nothing)
    result = simulate(oscillator(), settings, outputs, initial=(np.ones(1), np.zeros(1)))
    assert 20000 <= result.steps < 20200


def test_a_load_that_repeats_with_every_coarse_step_is_no_constant_load() -> None:
    """x'' + 4 x = cos 12 t from rest, x = (cos 12 t - cos 2 t) / (4 - 144): the coarsest step is a period of it."""
    load = HarmonicLoad(12.0, np.ones(1, dtype=np.complex128))
    settings = TransientSettings(20.0, 0.0, 0.01, 10.0, tolerance=1e-5)
    one = np.ones((1, 1))
    result = simulate(oscillator(harmonic_loads=(load,)), settings, TransientOutputs(one, one, one))
    expected = (np.cos(12.0 * result.times) - np.cos(2.0 * result.times)) / (4.0 - 144.0)
    np.testing.assert_allclose(result.displacement[:, 0], expected, atol=2e-4)


def test_samples_follow_what_excites() -> None:
    """Harmonic loads at the speed that they follow, a table by the bends of its line; one of zero asks for nothing."""
    zero = HarmonicLoad(1e6, np.zeros(1, dtype=np.complex128))
    steady, turning = (HarmonicLoad(12.0, np.ones(1, dtype=complex), follows) for follows in ("time", "turning"))
    assert least_sampling_rate(oscillator(harmonic_loads=(zero,))) == (0.0, 0.0)
    for load, highest in ((steady, 12.0), (turning, 24.0)):
        rate, frequency = least_sampling_rate(oscillator(harmonic_loads=(load,)), fastest=2.0)
        assert frequency == pytest.approx(highest / (2.0 * np.pi))
        assert rate > 2.0 * frequency
    # A triangle wave of period 0.5 s has the lines 4 / (π n)² of its range, n odd: below 1 % from n = 7 on.
    corners = np.arange(0.0, 20.0, 0.25)
    wave = TimedLoad(corners, np.where(np.arange(len(corners)) % 2, 1.0, -1.0), np.ones(1))
    rate, _ = least_sampling_rate(oscillator(timed_loads=(wave,)), 0.0, 20.0)
    assert 5.0 / 0.5 < 0.5 * rate < 9.0 / 0.5
    assert least_sampling_rate(oscillator(timed_loads=(wave,)), 30.0, 40.0) == (0.0, 0.0)


def test_no_step_crosses_a_corner_of_a_load() -> None:
    corners = np.array([0.3137, 1.7771, 2.9])
    load = TimedLoad(corners, np.array([0.0, 1.0, -1.0]), np.ones(1))
    bounds = boundaries(oscillator(timed_loads=(load,)), RUN_UP, 0.0, 4.0, 0.05, ())
    assert np.abs(bounds[:, None] - corners).min(axis=0).max() < 1e-12
    assert (bounds[0], bounds[-1]) == (0.0, 4.0)


def test_no_step_crosses_a_corner_of_a_bearing_over_speed() -> None:
    """From half the nominal speed to twice it in 4 s: 0.8 of it after 0.8 s, 1.4 of it after 2.4 s."""
    rates = np.array([0.4, 0.8, 1.4, 2.5])
    stiffness = np.array([1.0, 2.0, 1.5, 3.0])[:, None, None]
    table = SpeedTable(rates, stiffness, 0.01 * stiffness)
    bearing = LinearConnector("bearing", np.ones((1, 1)), np.ones((1, 1)), np.zeros((1, 1)), over_speed=table)
    bounds = boundaries(oscillator(linear=(bearing,)), RUN_UP, 0.0, 4.0, 0.05, ())
    for corner in (0.8, 2.4):
        assert np.abs(bounds - corner).min() < 1e-12


def test_a_run_up_starts_where_its_acceleration_holds_it() -> None:
    """The inertia force a l is at the spring from the first moment: x = a l / k, and nothing moves."""
    system = oscillator(4.0, acceleration_load=np.full(1, 3.0))
    settings = TransientSettings(duration=1.0, record_from=0.0, sample_interval=0.05, largest_step=0.01)
    rows = np.eye(1)
    found = simulate(system, settings, TransientOutputs(rows, rows, rows), speed_profile=RUN_UP)
    acceleration = (2.0 - 0.5) / 4.0
    assert found.displacement[:, 0] == pytest.approx(acceleration * 3.0 / 4.0, rel=1e-9)


@pytest.mark.parametrize("step", [0.02, 0.05])
def test_the_local_error_is_that_of_the_period(step: float) -> None:
    """One oscillation of w advances by (w h)²/12 too little for each radian: that is what an error of a step says."""
    w = 2.0
    settings = TransientSettings(duration=40.0, record_from=0.0, sample_interval=step, largest_step=step, tolerance=1.0)
    rows = np.eye(1)
    found = simulate(
        oscillator(w**2),
        settings,
        TransientOutputs(rows, rows, rows),
        initial=(np.ones(1), np.zeros(1)),
    )
    late = np.interp(0.0, *_last_crossing(found.times, found.displacement[:, 0]))
    turns = round(float(late) * w / np.pi - 0.5)
    exact = (turns + 0.5) * np.pi / w
    assert (late - exact) / exact == pytest.approx((w * step) ** 2 / 12.0, rel=0.15)
    assert found.error == pytest.approx((w * step) ** 2 / 12.0, rel=0.15)


def _last_crossing(times: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values and times on both sides of the last change from positive to negative, ascending in value."""
    last = int(np.flatnonzero((values[:-1] > 0.0) & (values[1:] <= 0.0))[-1])
    return values[[last + 1, last]], times[[last + 1, last]]
