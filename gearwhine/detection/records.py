"""Records of samples with the noise of their sensors, and the condition indicators of them.

The noise of a sensor is white and Gaussian from 0 Hz to the trusted limit. Its average over K turns has an rms value of
1/√K of it; spectra of time, as the spectral kurtosis, see all of it.
"""

from collections.abc import Sequence

import numpy as np

from gearwhine.coupling.analyses.gear_condition import INDICATORS, WatchedSignal
from gearwhine.coupling.signals.condition_indicators import SynchronousAverage
from gearwhine.detection.samples import AVERAGE, SIGNAL
from gearwhine.numerics.arrays import FloatArray
from gearwhine.variation.quantities import Evaluation


def band_noise(rng: np.random.Generator, count: int, band: float, rms: float) -> FloatArray:
    """Draw Gaussian noise of an rms value below a frequency, a part of the sampling rate, shape (count,)."""
    lines = np.fft.rfft(rng.normal(size=count))
    frequencies = np.fft.rfftfreq(count)
    lines[frequencies > band] = 0.0
    lines[0] = 0.0
    # Of the count - 1 degrees of freedom beside the mean those below the band are left.
    kept = 2.0 * np.count_nonzero(lines) - (count % 2 == 0 and band >= 0.5)
    return np.asarray(np.fft.irfft(lines, n=count) * rms * np.sqrt(count / max(kept, 1.0)))


def watched_signal(
    found: Evaluation,
    sensor: str,
    noise: float = 0.0,
    averages: int = 1,
    rng: np.random.Generator | None = None,
    healthy: SynchronousAverage | None = None,
) -> WatchedSignal:
    """Return the signal of a sensor of a sample, with noise.

    Parameters
    ----------
    found : Evaluation
        Of :meth:`gearwhine.detection.samples.DetectionCase.evaluation`.
    sensor : str
    noise : float
        Rms value of the noise [m/s²].
    averages : int
        Number of turns over which the noise is averaged.
    rng : Generator, optional
        Needed where there is noise.
    healthy : SynchronousAverage, optional
        Average that NA4 refers to.
    """
    numbers = found.numbers
    limit, interval, turn = numbers["limit_hz"], numbers["interval_s"], numbers["turn_hz"]
    teeth = round(numbers["teeth"])
    others = tuple(round(value) for name, value in numbers.items() if name.startswith("teeth of another gear"))
    signal = found.curves[f"{SIGNAL}{sensor}"]
    # A sample has no average where no indicator takes one.
    average = found.curves.get(f"{AVERAGE}{sensor}", np.zeros(2 * teeth + 4))
    if noise > 0.0 and rng is not None:
        signal = signal + band_noise(rng, len(signal), limit * interval, noise)
        order = limit / turn / len(average)
        average = average + band_noise(rng, len(average), order, noise / np.sqrt(averages))
    harmonics = max(int((limit / turn - 1.0) / teeth), 1)
    return WatchedSignal(
        SynchronousAverage(average, teeth, harmonics, others),
        signal,
        interval,
        turn,
        limit,
        numbers["steady"] == 1.0,
        healthy=healthy,
        tone_hz=numbers.get("tone_hz", 0.0),
    )


def indicator_values(
    watched: WatchedSignal, indicators: Sequence[str], earlier: WatchedSignal | None = None
) -> tuple[list[float], list[str]]:
    """Return the indicators of a signal, NaN where one is undefined, and the reasons.

    With the signal of an earlier record they are compared with those of that one.
    """
    values, reasons = list[float](), list[str]()
    for name in indicators:
        value, reason = INDICATORS[name].value(watched)
        if earlier is not None and value is not None and INDICATORS[name].growth != "itself":
            before, reason = INDICATORS[name].value(earlier)
            value = None if before is None else INDICATORS[name].grown(value, before)
        values.append(np.nan if value is None else value)
        reasons.append(reason)
    return values, reasons
