"""Slip of cages: rates of strikes and their scatter, counted in the compiled law, by the statistics of a random walk.

The angle of the cage at the n-th passing of an element is (1 - s) of that of pure rolling and a sum of n independent
errors, so that its variance grows with n and the autocorrelation at the k-th multiple of the strikes falls off by
exp(-2 (π k σ)² n): lines of Lorentz's shape (Antoni & Randall 2003).
"""

import math

import numpy as np
import pytest

from gearwhine.coupling import RollingLaw
from gearwhine.coupling.connector_forces.bearing_kernels import bearing_force
from gearwhine.coupling.connector_forces.kernel_arrays import bearing_arrays
from gearwhine.coupling.machine.connectors import NonlinearConnector
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import RotorError
from gearwhine.rotors.rolling_bearings import (
    NO_SLIP,
    BallRow,
    CageFault,
    CageSlip,
    RollingBearing,
    RollingSpall,
    rolling_state,
)

ROW = BallRow(9, 12e-3, 60e-3, clearance=-10e-6)
SPEED = 157.0
GAMMA = 0.2
CAGE = 0.5 * (1.0 - GAMMA) * SPEED
NAME = "b"


def felt(fault: RollingSpall, slip: CageSlip, times: FloatArray, row: BallRow = ROW) -> FloatArray:
    """Energy that a spall takes from a bearing whose rings are held in the middle."""
    state, energies = rolling_state(RollingBearing([row]), np.zeros(5)), []
    for spalls in ((fault,), ()):
        law = RollingLaw(state, 0.3, spalls, slip)
        arrays = bearing_arrays([NonlinearConnector(NAME, np.eye(5), np.arange(5), law, state.stiffness, SPEED)])
        force, tangent = np.zeros(5), np.zeros((5, 5))
        energies.append([bearing_force(arrays, 0, time, np.zeros(5), force, tangent)[0] for time in times.tolist()])
    return np.asarray(np.subtract(energies[1], energies[0]))


def begins(struck: FloatArray, times: FloatArray) -> FloatArray:
    return times[1:][(struck[1:] > 0.0) & (struck[:-1] <= 0.0)]


@pytest.mark.parametrize(
    ("on", "turning", "rate"),
    [
        # Relative to the inner raceway a cage that lags is faster, past the outer one and about its axis it is slower.
        ("outer", "inner", 9 * 0.98 * CAGE),
        ("inner", "inner", 9 * (SPEED - 0.98 * CAGE)),
        ("element", "inner", 2.0 * 0.98 * CAGE * (60.0 / 12.0) * (1.0 + GAMMA)),
        ("outer", "outer", 9 * (SPEED - 0.98 * 0.5 * (1.0 + GAMMA) * SPEED)),
        ("inner", "outer", 9 * 0.98 * 0.5 * (1.0 + GAMMA) * SPEED),
    ],
)
def test_mean_slip_shifts_the_rate_of_strikes(on: str, turning: str, rate: float) -> None:
    """Elements roll on the ring at rest: a ball turns about its axis by the cage's angle times R / r."""
    row = BallRow(9, 12e-3, 60e-3, clearance=-10e-6, outer_turns=turning == "outer")
    spall, slip = RollingSpall(on, 1e-3, 1e-3, azimuth=1.1), CageSlip(0.02)  # type: ignore[arg-type]
    assert spall.tone(row, SPEED, slip) == pytest.approx(rate, rel=1e-12)
    period = 2.0 * math.pi / rate
    times = np.arange(40 * 60) * period / 60.0
    found = begins(felt(spall, slip, times, row), times)
    assert abs(len(found) - 40) <= 1
    np.testing.assert_allclose(np.diff(found[::2]), 2.0 * period, atol=1.01 * period / 60.0)


def test_the_angle_of_the_cage_is_a_random_walk() -> None:
    """Over many bearings of one seed: no mean, a variance of σ² n, and increments that know nothing of each other."""
    slip = CageSlip(scatter=0.02, seed=5)
    walks = np.array([slip.deviations(f"bearing {number}", row) for number in range(200) for row in range(2)])
    for n in (1, 10, 100, 1000, 10000):
        # Of 400 walks the mean square is within 4 standard deviations, √(2/400) each.
        assert np.mean(walks[:, n] ** 2) == pytest.approx(0.02**2 * n, rel=4.0 * math.sqrt(2.0 / 400.0))
        assert abs(np.mean(walks[:, n])) < 4.0 * 0.02 * math.sqrt(n / 400.0)
    steps = np.diff(walks[:40], axis=1) / 0.02
    assert abs(np.mean(steps[:, 1:] * steps[:, :-1])) < 4.0 / math.sqrt(steps[:, 1:].size)
    assert np.array_equal(walks[0], slip.deviations("bearing 0", 0))
    assert not np.array_equal(walks[0], CageSlip(scatter=0.02, seed=6).deviations("bearing 0", 0))


@pytest.fixture(scope="module")
def strikes() -> tuple[FloatArray, FloatArray, float]:
    """Times of a spall's strikes of the outer raceway and its energy, sampled evenly, and the mean period."""
    slip = CageSlip(0.015, 0.02, seed=3)
    spall = RollingSpall("outer", 1e-3, 1e-3, azimuth=1.1)
    period = 2.0 * math.pi / spall.tone(ROW, SPEED, slip)
    times = np.arange(3000 * 40) * period / 40.0
    struck = felt(spall, slip, times)
    return begins(struck, times), struck, period


def test_the_time_between_strikes_scatters_and_errors_add_up(strikes: tuple[FloatArray, FloatArray, float]) -> None:
    """The n-th strike is off by σ √n periods: a scatter about a clock's ticks would stay σ (Antoni & Randall)."""
    found, _, period = strikes
    assert np.mean(np.diff(found)) == pytest.approx(period, rel=4.0 * 0.02 / math.sqrt(len(found)))
    for n in (4, 16, 64):
        apart = found[n:] - found[:-n] - n * period
        # Sampling adds the difference of two even distributions of a sample, 1/40 of a period.
        expected = period**2 * (0.02**2 * n + 1.0 / (6.0 * 40.0**2))
        independent = len(found) / n
        assert np.mean(apart**2) == pytest.approx(expected, rel=4.0 * math.sqrt(2.0 / independent))


def test_multiples_of_the_strikes_have_lorentz_shape(strikes: tuple[FloatArray, FloatArray, float]) -> None:
    """Of the power of a multiple 1/2 is within the half-width b, by which lines are told, and 2/π atan 3 within 3 b."""
    _, struck, period = strikes
    lines = np.abs(np.fft.rfft(struck)) ** 2
    frequencies = np.fft.rfftfreq(len(struck), period / 40.0)
    first = CageSlip(0.015, 0.02).half_width(1.0 / period)
    assert first == pytest.approx(math.pi * 0.02**2 / period)

    def power(multiple: int, widths: float) -> float:
        within = np.abs(frequencies - multiple / period) <= widths * multiple**2 * first
        return float(lines[within].sum())

    multiples = range(3, 9)
    # Beyond 5 b of the eighth multiple the next one begins.
    total = [power(multiple, 5.0) / (2.0 / math.pi * math.atan(5.0)) for multiple in multiples]
    inside = [power(multiple, 1.0) for multiple in multiples]
    wider = [power(multiple, 3.0) for multiple in multiples]
    # Each multiple has some 2 b over the resolution independent lines within b.
    lines_inside = sum(2.0 * k**2 * first * 3000.0 * period for k in multiples)
    assert np.mean(np.divide(inside, total)) == pytest.approx(0.5, abs=4.0 * 0.5 / math.sqrt(lines_inside / 6.0))
    assert np.mean(np.divide(wider, total)) == pytest.approx(2.0 / math.pi * math.atan(3.0), abs=0.08)


def test_a_cage_with_a_worn_pocket_is_uneven_once_in_its_turn() -> None:
    """Force of a pressed bearing at multiples of the cage's turns, which an even cage has not."""
    state = rolling_state(RollingBearing([ROW]), np.zeros(5))
    pressed, turn = np.array([0.0, -10e-6, 0.0, 0.0, 0.0]), 2.0 * math.pi / CAGE
    times = np.arange(9 * 64) * turn / (9 * 64)

    def multiples(*faults: CageFault) -> FloatArray:
        law = RollingLaw(state, 0.3, faults)
        arrays = bearing_arrays([NonlinearConnector(NAME, np.eye(5), np.arange(5), law, state.stiffness, SPEED)])
        force, tangent, found = np.zeros(5), np.zeros((5, 5)), []
        for time in times.tolist():
            bearing_force(arrays, 0, time, pressed, force, tangent)
            found.append(force[1])
        return np.asarray(np.abs(np.fft.rfft(found))[:9] * 2.0 / len(times))

    fault = CageFault(1e-3, element=4)
    assert fault.tone(ROW, SPEED) == pytest.approx(CAGE)
    even, uneven = multiples(), multiples(fault)
    assert even[1:].max() < 1e-9 * even[0]
    # Of the forces f(ψ) of a single element, c_m by Fourier, those of the displaced one leave c_m (exp(i m ε) - 1).
    place, alone = np.arange(9 * 64) * 2.0 * math.pi / (9 * 64), []
    for angle in place[:64].tolist():
        loads = rolling_state(RollingBearing([ROW]), pressed, cage_angle=angle).rows[0]
        alone.append(loads.inner_load * np.sin(loads.azimuths))
    single = np.abs(np.fft.rfft(np.array(alone).T.ravel()))[:9] * 2.0 / len(place)
    shift = 1e-3 / 30e-3
    # Balls touch and part between two samples, which folds a little.
    np.testing.assert_allclose(uneven[1:], single[1:] * 2.0 * np.sin(0.5 * np.arange(1, 9) * shift), rtol=2e-4)
    assert uneven[1] > 1e-3 * uneven[0]


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: CageSlip(mean=-0.01), "mean of a slip"),
        (lambda: CageSlip(mean=0.6), "0 to 0.5"),
        (lambda: CageSlip(scatter=0.2), "scatter of a slip"),
        (lambda: CageSlip(scatter=math.nan), "scatter of a slip"),
        (lambda: CageSlip(seed=-1), "seed of a slip"),
        (lambda: CageFault(0.0), "length of a cage's fault"),
        (lambda: CageFault(1e-3, element=-1), "element of a cage's fault"),
        (lambda: CageFault(1e-3, element=9).shift(RollingBearing([ROW])), "expected one of 9, from 0"),
        (lambda: CageFault(1e-3, row=1).shift(RollingBearing([ROW])), "expected one of 1, from 0"),
        (lambda: CageFault(9e-3).shift(RollingBearing([ROW])), "the gap to the next element"),
    ],
)
def test_what_there_cannot_be_is_refused(make: object, said: str) -> None:
    with pytest.raises(RotorError, match=said):
        make()  # type: ignore[operator]


def test_no_slip_is_pure_rolling() -> None:
    assert (NO_SLIP.mean, NO_SLIP.scatter, NO_SLIP.deviations("a", 0).tolist()) == (0.0, 0.0, [0.0])
