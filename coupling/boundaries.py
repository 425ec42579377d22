"""Event times: bounds between which a time integration steps, so that no step crosses a jump of the stiffness."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from coupling.errors import TransientError
from coupling.system import CoupledSystem
from coupling.turning import SpeedProfile

FloatArray = npt.NDArray[np.float64]

_POINTS_PER_PERIOD = 6  # of the highest natural frequency; the tolerance refines motions that matter
_STEPS_PER_SEGMENT = 64  # where no event cuts the time
_SPEED_GAIN = 2e-4  # change of speed, as a part of the nominal one, within which a stretch's matrices stay the same
_SAME_TIME = 1e-6  # part of the coarsest step within which two events are one
SAMPLES_PER_BLOCK = 32768
_STEPS_PER_BLOCK = 1 << 20
_MOST_BLOCKS = 1 << 24


def coarsest_step(system: CoupledSystem, turning: SpeedProfile, largest: float) -> float:
    """Coarsest step [s]: it resolves the highest natural frequency, and the largest step at the highest speed."""
    highest = system.highest_frequency
    resolving = 2.0 * np.pi / (highest * _POINTS_PER_PERIOD) if highest > 0.0 else np.inf
    return float(min(largest / max(1.0, float(turning.rates.max())), resolving))


def same_time(step: float) -> float:
    """Tolerance within which two events are one [s]."""
    return _SAME_TIME * step


def block_ends(duration: float, interval: float, step: float, samples: int = SAMPLES_PER_BLOCK) -> FloatArray:
    """Ends of blocks with a limited number of samples and coarsest steps, from 0 to the duration [s].

    Raises
    ------
    TransientError
        Where there would be too many blocks for any run.
    """
    count = np.ceil(max(duration / (interval * samples), duration / (step * _STEPS_PER_BLOCK), 1.0))
    if not count < _MOST_BLOCKS:
        raise TransientError(f"{duration:g} s at steps of {step:.2g} s and samples every {interval:.2g} s have no end")
    return np.asarray(duration * np.arange(int(count) + 1) / int(count))


def boundaries(
    system: CoupledSystem, turning: SpeedProfile, start: float, end: float, step: float, others: tuple[float, ...]
) -> FloatArray:
    """Start, events and end of a block, with long stretches between them cut evenly [s]."""
    inner = [np.array([time for time in others if start < time < end])]
    inner += [times[(times > start) & (times < end)] for times in _known_times(system, turning)]
    (turned_from,), (turned_to,) = (turning.at(time)[0] for time in (start, end))
    for contact in system.contacts:
        inner.append(turning.times_of(contact.event_times(float(turned_from), float(turned_to))))
    times = np.unique(np.concatenate([*inner, [start, end]]))
    times = times[np.isfinite(times) & (times >= start) & (times <= end)]
    # Events that rounding alone holds apart are one.
    near = same_time(step)
    times = times[np.concatenate([[True], np.diff(times) > near])]
    if times[-1] < end and len(times) > 1:
        times = np.append(times[:-1], end)
    # Matrices are those of a stretch's mean speed.
    gained = np.abs(np.diff(turning.at(times)[1]))
    pieces = np.maximum(np.ceil(np.diff(times) / (_STEPS_PER_SEGMENT * step)), np.ceil(gained / _SPEED_GAIN))
    pieces = np.maximum(np.minimum(pieces, np.ceil(np.diff(times) / (8.0 * step))), 1.0).astype(np.int64)
    if pieces.max() == 1:
        return np.asarray(times)
    cuts = [begin + (stop - begin) * np.arange(n) / n for begin, stop, n in zip(times, times[1:], pieces, strict=False)]
    return np.concatenate([*cuts, times[-1:]])


def _known_times(system: CoupledSystem, turning: SpeedProfile) -> Iterator[FloatArray]:
    """Times at which loads and speeds change their slope [s]."""
    if len(turning.times) > 1:
        yield turning.times
        # Connectors change their slope over speed where these speeds are passed.
        for rate in system.connector_rates if len(system.connector_rates) > 1 else ():
            before, after = turning.rates[:-1] - rate, turning.rates[1:] - rate
            crossing = before * after < 0.0
            part = before[crossing] / (before[crossing] - after[crossing])
            yield turning.times[:-1][crossing] + part * np.diff(turning.times)[crossing]
    for load in system.timed_loads:
        yield load.times
