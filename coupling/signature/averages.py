"""Power spectral density by Welch's method, and the spectrogram of a record.

Welch (1967) averages the squares of the spectra of windowed, overlapping stretches: lines of a steady sine keep their
height, and the average of noise converges to its density.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from coupling.spectrum import Window, amplitude_spectrum

FloatArray = npt.NDArray[np.float64]

_NOISE_BANDWIDTH = {"uniform": 1.0, "hann": 1.5}  # of the window, over the spacing of lines


@dataclass(frozen=True)
class PowerDensity:
    """A one-sided power spectral density, averaged over stretches of a record and without its mean.

    Attributes
    ----------
    frequencies : ndarray, shape (m,)
        [Hz], without 0.
    density : ndarray, shape (..., m)
        Square of the signal's unit by Hz: its integral is the mean square.
    stretches : int
        Number of averaged stretches.
    window : {"uniform", "hann"}
    """

    frequencies: FloatArray
    density: FloatArray
    stretches: int
    window: Window

    @property
    def amplitude(self) -> FloatArray:
        """Peak amplitude of a sine whose line has this height, shape (..., m); meaningless for noise."""
        bandwidth = _NOISE_BANDWIDTH[self.window] * self.frequencies[0]
        return np.asarray(np.sqrt(2.0 * self.density * bandwidth))

    def rms(self, limit: float) -> FloatArray:
        """Root mean square up to a limit [Hz], shape (...)."""
        inside = self.frequencies <= limit
        return np.asarray(np.sqrt(self.density[..., inside].sum(axis=-1) * self.frequencies[0]))


def power_density(
    signal: FloatArray, interval: float, length: int, *, overlap: float = 0.5, window: Window = "hann"
) -> PowerDensity:
    """Power spectral density by Welch's method.

    Parameters
    ----------
    signal : ndarray, shape (..., s)
    interval : float
        Between samples [s].
    length : int
        Samples of a stretch, at most s.
    overlap : float
        Of neighbouring stretches, a part of their length from 0 to below 1; half of it wastes nothing under Hann's
        window.
    window : {"uniform", "hann"}

    Raises
    ------
    CouplingError
        For a length or an overlap that the record does not allow.
    """
    from scipy.signal import welch

    step = round(length * (1.0 - overlap))
    stretches = len(_starts(signal.shape[-1], length, step))
    shape = "boxcar" if window == "uniform" else window
    frequencies, density = welch(signal, 1.0 / interval, shape, length, length - step, detrend="constant")
    return PowerDensity(frequencies[1:], density[..., 1:], stretches, window)


@dataclass(frozen=True)
class Spectrogram:
    """Spectrogram: spectra along a record, t stretches.

    Attributes
    ----------
    times : ndarray, shape (t,)
        Middles of the stretches [s].
    frequencies : ndarray, shape (m,)
        [Hz].
    amplitude : ndarray, shape (t, m)
        Peak amplitudes in the signal's unit; the mean of the stretch at 0 Hz.
    window : {"uniform", "hann"}
    """

    times: FloatArray
    frequencies: FloatArray
    amplitude: FloatArray
    window: Window


def spectrogram(
    signal: FloatArray, interval: float, length: int, step: int, *, start: float = 0.0, window: Window = "hann"
) -> Spectrogram:
    """Amplitude spectra of stretches along a record: a waterfall over time, or over the speed.

    Parameters
    ----------
    signal : ndarray, shape (s,)
    interval : float
        Between samples [s].
    length, step : int
        Samples of a stretch, and from the start of one to the next. Frequencies are told apart by 1 / (length
        interval), and the speed should change little meanwhile.
    start : float
        Time of the first sample [s].
    window : {"uniform", "hann"}

    Raises
    ------
    CouplingError
        For a length or a step that the record does not allow.
    """
    starts = _starts(signal.shape[-1], length, step)
    spectra = [amplitude_spectrum(signal[first : first + length], interval, window) for first in starts]
    return Spectrogram(
        times=start + interval * (np.array(starts) + 0.5 * length),
        frequencies=spectra[0].frequencies,
        amplitude=np.array([spectrum.amplitude for spectrum in spectra]),
        window=window,
    )


def _starts(count: int, length: int, step: int) -> list[int]:
    """First samples of the stretches that fit in."""
    if not 2 <= length <= count:
        raise CouplingError(f"stretches of {length} samples from a record of {count}; expected 2 to {count}")
    if not step >= 1:
        raise CouplingError(f"stretches {step} samples apart; expected a step of at least 1, an overlap below 1")
    return list(range(0, count - length + 1, step))
