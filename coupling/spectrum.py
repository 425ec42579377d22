"""Spectra of evenly sampled signals."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Window = Literal["uniform", "hann"]


@dataclass(frozen=True)
class Spectrum:
    """A one-sided amplitude spectrum.

    Attributes
    ----------
    frequencies : ndarray, shape (m,)
        [Hz].
    amplitude : ndarray, shape (..., m)
        Peak amplitude of each line, in the signal's unit: a sine a·sin(2πft) of whole periods in the record has
        the line a. The line at 0 Hz is the mean.
    phase : ndarray, shape (..., m)
        Of the cosine, at the start of the record [rad].
    window : {"uniform", "hann"}
    averages : int
        Stretches of the record over whose lines the mean was taken, see :func:`averaged_spectrum`.
    """

    frequencies: FloatArray
    amplitude: FloatArray
    phase: FloatArray
    window: Window
    averages: int = 1

    def rms(self, limit: float) -> FloatArray:
        """Root mean square of the lines above 0 Hz and up to a limit [Hz], shape (...), in the signal's unit.

        Parseval's sum over the lines, for a limit below half the sampling rate; under Hann's window a sine stands in
        three of them, whose squares add up to 3/2.
        """
        inside = (self.frequencies > 0.0) & (self.frequencies <= limit)
        noise_bandwidth = 1.0 if self.window == "uniform" else 1.5
        return np.asarray(np.sqrt(0.5 * (self.amplitude[..., inside] ** 2).sum(axis=-1) / noise_bandwidth))


def amplitude_spectrum(signal: FloatArray, interval: float, window: Window = "uniform") -> Spectrum:
    """Amplitude and phase of the lines of a record.

    Parameters
    ----------
    signal : ndarray, shape (..., s)
    interval : float
        Between samples [s].
    window : {"uniform", "hann"}
        Uniform for a record of whole periods, whose lines are then exact; Hann otherwise, scaled so that a sine
        keeps its height. The mean is taken off before Hann's window and given back at 0 Hz.
    """
    lines = _lines(signal, window)
    return Spectrum(_frequencies(signal.shape[-1], interval), np.abs(lines), np.angle(lines), window)


def averaged_spectrum(stretches: Iterable[FloatArray], interval: float, window: Window = "uniform") -> Spectrum:
    """Lines of a record that is too long for memory, averaged over stretches of it.

    Amplitudes are root mean squares of the stretches' own, so that power adds up whatever the phases; the mean is the
    mean of the means. Phases are those of the mean of the complex lines: they mean something where the motion repeats
    with the stretch.

    Parameters
    ----------
    stretches : iterable of ndarray, shape (..., s)
        At least one, all of the same shape.
    interval, window
        As for :func:`amplitude_spectrum`, of which this is the mean.
    """
    count = samples = 0
    together, power = np.zeros(0, dtype=np.complex128), np.zeros(0)
    for stretch in stretches:
        lines = _lines(stretch, window)
        together, power = (lines, np.abs(lines) ** 2) if not count else (together + lines, power + np.abs(lines) ** 2)
        count, samples = count + 1, stretch.shape[-1]
    amplitude, together = np.sqrt(power / count), together / count
    amplitude[..., 0] = np.abs(together[..., 0])
    return Spectrum(_frequencies(samples, interval), amplitude, np.angle(together), window, count)


def _frequencies(count: int, interval: float) -> FloatArray:
    return np.asarray(np.fft.rfftfreq(count, interval), dtype=np.float64)


def _lines(signal: FloatArray, window: Window) -> npt.NDArray[np.complex128]:
    """Complex one-sided lines; their magnitude is the peak amplitude, and the line at 0 Hz the mean."""
    count = signal.shape[-1]
    mean = signal.mean(axis=-1, keepdims=True)
    weights = np.ones(count) if window == "uniform" else 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    lines = np.fft.rfft((signal - mean) * weights, axis=-1) * (2.0 / weights.sum())
    if count % 2 == 0:
        lines[..., -1] *= 0.5  # the line at half the sampling rate stands alone
    lines[..., 0] = mean[..., 0]
    return np.asarray(lines)


@dataclass(frozen=True)
class Peak:
    """A line that stands out: frequency [Hz] and amplitude in the signal's unit."""

    frequency: float
    amplitude: float


def spectrum_peaks(
    spectrum: Spectrum, *, count: int = 12, above: float = 0.0, limit: float = np.inf, floor: float = 1e-3
) -> list[Peak]:
    """The highest lines that are higher than both neighbours, highest first.

    Parameters
    ----------
    spectrum : Spectrum
        Of one signal.
    count : int
        At most so many.
    above, limit : float
        Between these frequencies [Hz].
    floor : float
        Only lines above this part of the highest.
    """
    a, f = spectrum.amplitude, spectrum.frequencies
    inner = np.arange(1, len(a) - 1)
    peaks = inner[(a[inner] >= a[inner - 1]) & (a[inner] > a[inner + 1]) & (f[inner] > above) & (f[inner] <= limit)]
    peaks = peaks[a[peaks] > floor * a[peaks].max(initial=0.0)]
    peaks = peaks[np.argsort(-a[peaks], kind="stable")][:count]
    return [Peak(float(f[i]), float(a[i])) for i in peaks]
