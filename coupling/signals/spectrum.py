"""Spectra of evenly sampled signals: amplitude spectrum, levels in decibels, power spectral density, spectrogram.

Amplitudes are peak values throughout: a sine a sin(2πft) has the line a, an rms value of a/√2 and, in decibels, the
level of that rms value. The mean, the d.c. part, is no vibration: it stands alone at 0 Hz.

A level in decibels is 20 lg of an *rms* value over a reference (ISO 80000-8, ISO 1683), so a sine of peak amplitude a
has the level 20 lg(a / (√2 a₀)): one of 1 m/s² peak stands at 117.0 dB re 1 µm/s², not at 120.

The power spectral density follows from Welch's method (1967), which averages the squares of the spectra of windowed,
overlapping stretches: lines of a steady sine keep their height, and the average of noise converges to its density.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError
from gearwhine.numerics.arrays import ComplexArray, FloatArray

ACCELERATION_REFERENCE = 1e-6
"""Reference of vibratory acceleration levels [m/s²], ISO 1683."""
Window = Literal["uniform", "hann"]

_WHOLE_CYCLES_TOLERANCE = 1e-6  # tolerance of a whole number of cycles: a line leaks as large a part of its height
_NOISE_BANDWIDTH = {"uniform": 1.0, "hann": 1.5}  # bandwidth of the window over the spacing of lines


def rms_of_peak(amplitude: npt.ArrayLike) -> FloatArray:
    """Root mean square of sines by their peak amplitudes."""
    return np.asarray(np.asarray(amplitude, dtype=np.float64) / np.sqrt(2.0))


def peak_of_rms(rms: npt.ArrayLike) -> FloatArray:
    """Peak amplitudes of sines by their root mean square."""
    return np.asarray(np.asarray(rms, dtype=np.float64) * np.sqrt(2.0))


def decibels(amplitude: npt.ArrayLike, reference: float = ACCELERATION_REFERENCE) -> FloatArray:
    """Levels of sines by their peak amplitudes [dB]; minus infinity for silence.

    Raises
    ------
    CouplingError
        Where the reference is not positive.
    """
    _check(reference)
    with np.errstate(divide="ignore"):
        return np.asarray(20.0 * np.log10(np.abs(rms_of_peak(amplitude)) / reference))


def from_decibels(level: npt.ArrayLike, reference: float = ACCELERATION_REFERENCE) -> FloatArray:
    """Peak amplitudes of sines by their levels [dB].

    Raises
    ------
    CouplingError
        Where the reference is not positive.
    """
    _check(reference)
    return peak_of_rms(reference * 10.0 ** (np.asarray(level, dtype=np.float64) / 20.0))


def _check(reference: float) -> None:
    if not 0.0 < reference < np.inf:
        raise CouplingError(f"levels over a reference of {reference}; expected a positive number")


@dataclass(frozen=True)
class Spectrum:
    """A one-sided amplitude spectrum.

    Attributes
    ----------
    frequencies : ndarray, shape (m,)
        Frequencies [Hz].
    amplitude : ndarray, shape (..., m)
        Peak amplitude of each line, in the signal's unit: a sine a·sin(2πft) of whole periods in the record has
        the line a. The line at 0 Hz is the mean.
    phase : ndarray, shape (..., m)
        Phase of the cosine at the start of the record [rad].
    window : {"uniform", "hann"}
    averages : int
        Number of averaged stretches of the record, see :func:`averaged_spectrum`.
    """

    frequencies: FloatArray
    amplitude: FloatArray
    phase: FloatArray
    window: Window
    averages: int = 1

    @property
    def lines(self) -> ComplexArray:
        """Complex amplitudes a e^{iφ}, shape (..., m): the signal is the sum of Re a e^{i(2πft + φ)}."""
        return np.asarray(self.amplitude * np.exp(1j * self.phase))

    @property
    def spacing(self) -> float:
        """Spacing of the lines [Hz]: the inverse of the record's length."""
        return float(self.frequencies[1]) if self.frequencies.size > 1 else 0.0

    def rms(self, limit: float) -> FloatArray:
        """Root mean square of the lines above 0 Hz and up to a limit [Hz], shape (...), in the signal's unit.

        Parseval's sum over the lines, for a limit below half the sampling rate; under Hann's window a sine stands in
        three of them, whose squares add up to 3/2.
        """
        inside = (self.frequencies > 0.0) & (self.frequencies <= limit)
        noise_bandwidth = _NOISE_BANDWIDTH[self.window]
        return np.asarray(np.sqrt(0.5 * (self.amplitude[..., inside] ** 2).sum(axis=-1) / noise_bandwidth))


def amplitude_spectrum(signal: FloatArray, interval: float, window: Window = "uniform") -> Spectrum:
    """Amplitude spectrum of a record.

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
    """Amplitude spectrum averaged over the stretches of a long record.

    Amplitudes are root mean squares over the stretches, so that power adds up whatever the phases; the mean is the
    mean of the means. Phases are those of the mean complex lines: they are meaningful where the motion repeats with the
    stretch.

    Parameters
    ----------
    stretches : iterable of ndarray, shape (..., s)
        Stretches of the signal, at least one, all of the same shape.
    interval, window
        See :func:`amplitude_spectrum`.
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


def at_time_zero(lines: ComplexArray, frequencies: FloatArray, start: float) -> ComplexArray:
    """Complex amplitudes at t = 0 from those at the start of a record: x(t) is the sum of Re a e^{2πift}.

    Parameters
    ----------
    lines : ndarray of complex, shape (..., m)
        Amplitudes by the time since the record's first sample, as those of :func:`amplitude_spectrum`.
    frequencies : ndarray, shape (m,)
        Frequencies [Hz].
    start : float
        Time of the first sample [s].
    """
    return np.asarray(lines * np.exp(-2j * np.pi * start * frequencies))


def whole_period_samples(
    count: int, interval: float, frequencies: Sequence[float], *, least: float = 0.5
) -> int | None:
    """Largest number of a record's samples in which all frequencies make whole cycles; None where there is none.

    Parameters
    ----------
    count : int
        Number of samples of the record.
    interval : float
        Between samples [s].
    frequencies : sequence of float
        Frequencies [Hz].
    least : float
        Least part of the record. A record of one common period at least has half its samples in whole ones.
    """
    counts = np.arange(count, max(math.ceil(least * count), 1) - 1, -1)
    for frequency in frequencies:
        cycles = counts * (interval * frequency)
        counts = counts[np.abs(cycles - np.rint(cycles)) < _WHOLE_CYCLES_TOLERANCE]
    return int(counts[0]) if counts.size else None


def _frequencies(count: int, interval: float) -> FloatArray:
    return np.asarray(np.fft.rfftfreq(count, interval), dtype=np.float64)


def _lines(signal: FloatArray, window: Window) -> npt.NDArray[np.complex128]:
    """Complex one-sided lines; their magnitude is the peak amplitude, and the line at 0 Hz the mean."""
    count = signal.shape[-1]
    mean = signal.mean(axis=-1, keepdims=True)
    weights = window_weights(count, window)
    lines = np.fft.rfft((signal - mean) * weights, axis=-1) * (2.0 / weights.sum())
    if count % 2 == 0:
        lines[..., -1] *= 0.5  # the line at half the sampling rate stands alone
    lines[..., 0] = mean[..., 0]
    return np.asarray(lines)


def window_weights(count: int, window: Window) -> FloatArray:
    """Weights of a periodic window, shape (count,)."""
    if window == "uniform":
        return np.ones(count)
    return np.asarray(0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count))


def line_height(distance: npt.ArrayLike, window: Window) -> FloatArray:
    """Height of the line some line spacings from a tone of amplitude 1, signed.

    The transform of the window: sinc(x), under Hann's window sinc(x) + sinc(x - 1) / 2 + sinc(x + 1) / 2.
    """
    x = np.asarray(distance, dtype=np.float64)
    if window == "uniform":
        return np.asarray(np.sinc(x))
    return np.asarray(np.sinc(x) + 0.5 * (np.sinc(x - 1.0) + np.sinc(x + 1.0)))


def lines_at(signal: FloatArray, interval: float, frequencies: FloatArray, window: Window = "uniform") -> ComplexArray:
    """Complex amplitudes at any frequencies, not only those of the record's lines, shape (..., f).

    2 Σ w (x - mean) e^{-2πift} / Σ w: the height of a sine at that frequency, under either window, without leakage from
    its neighbours. The sum goes by blocks of √s samples, within which and between which the exponentials are the same
    for all, so that 2√s of them serve in place of s.

    Parameters
    ----------
    signal : ndarray, shape (..., s)
    interval : float
        Between samples [s].
    frequencies : ndarray, shape (f,)
        Frequencies [Hz], above 0 and below half the sampling rate.
    window : {"uniform", "hann"}
    """
    count = signal.shape[-1]
    block = max(math.isqrt(count), 1)
    blocks = -(-count // block)
    weights = window_weights(count, window)
    weighted = np.zeros((*signal.shape[:-1], blocks * block))
    weighted[..., :count] = (signal - signal.mean(axis=-1, keepdims=True)) * (2.0 * weights / weights.sum())
    table = weighted.reshape(*signal.shape[:-1], blocks, block)
    turn = -2j * np.pi * interval * np.asarray(frequencies)
    within, between = np.exp(np.outer(np.arange(block), turn)), np.exp(np.outer(block * np.arange(blocks), turn))
    return np.asarray(((table @ within.real + 1j * (table @ within.imag)) * between).sum(axis=-2))


@dataclass(frozen=True)
class SignalParts:
    """Constant (d.c.) and varying (a.c.) part of a signal, each in its unit, shape (...).

    Attributes
    ----------
    mean : ndarray
        Mean, the d.c. part.
    rms : ndarray
        Root mean square of the a.c. part.
    peak : ndarray
        Largest departure from the mean.
    """

    mean: FloatArray
    rms: FloatArray
    peak: FloatArray


def signal_parts(signal: FloatArray) -> SignalParts:
    """Split a signal of shape (..., s) into its d.c. and its a.c. part."""
    mean = signal.mean(axis=-1)
    varying = signal - mean[..., None]
    return SignalParts(mean, np.asarray(np.sqrt((varying**2).mean(axis=-1))), np.abs(varying).max(axis=-1))


@dataclass(frozen=True)
class PowerDensity:
    """A one-sided power spectral density, averaged over stretches of a record and without its mean.

    Attributes
    ----------
    frequencies : ndarray, shape (m,)
        Frequencies [Hz], without 0.
    density : ndarray, shape (..., m)
        Power density in the signal's unit squared per Hz: its integral is the mean square.
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
        Number of samples of a stretch, at most s.
    overlap : float
        Overlap of neighbouring stretches over their length, from 0 to below 1; half of it wastes nothing under Hann's
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
        Frequencies [Hz].
    amplitude : ndarray, shape (t, m)
        Peak amplitudes in the signal's unit; the mean of the stretch at 0 Hz.
    window : {"uniform", "hann"}
    noise_bandwidth : ndarray, shape (t,)
        Bandwidth of each stretch's window over the spacing of lines.
    """

    times: FloatArray
    frequencies: FloatArray
    amplitude: FloatArray
    window: Window
    noise_bandwidth: FloatArray

    @property
    def rms(self) -> FloatArray:
        """Root mean square of the lines of each stretch, without its mean, in the signal's unit, shape (t,)."""
        power = (self.amplitude[:, self.frequencies > 0.0] ** 2).sum(axis=1)
        return np.asarray(np.sqrt(0.5 * power / self.noise_bandwidth))

    def up_to(self, limit: float) -> "Spectrogram":
        """Return the spectra up to a frequency [Hz]."""
        below = self.frequencies <= limit * (1.0 + 1e-9)
        return replace(self, frequencies=self.frequencies[below], amplitude=self.amplitude[:, below])


def spectrogram(
    signal: FloatArray,
    interval: float,
    length: int,
    step: int,
    *,
    start: float = 0.0,
    window: Window = "hann",
    to_the_ends: bool = False,
) -> Spectrogram:
    """Amplitude spectra of stretches along a record: a waterfall over time, or over the speed.

    Parameters
    ----------
    signal : ndarray, shape (s,)
    interval : float
        Between samples [s].
    length, step : int
        Number of samples of a stretch, and from the start of one to the next. The frequency resolution is
        1 / (length interval); the speed should change little within a stretch.
    start : float
        Time of the first sample [s].
    window : {"uniform", "hann"}
    to_the_ends : bool
        Whether the middles of the stretches reach from the first sample to the last, see :func:`cut_spectra`; they are
        evenly spaced by ``step`` at the most. Otherwise all stretches lie within the record.

    Raises
    ------
    CouplingError
        For a length or a step that the record does not allow.
    """
    starts = _starts(signal.shape[-1], length, step)
    if to_the_ends:
        middles = np.linspace(0, signal.size - 1, -(-(signal.size - 1) // step) + 1).round().astype(int)
    else:
        middles = np.array(starts) + length // 2
    amplitude, bandwidth = cut_spectra(signal, middles, length, window)
    times = start + interval * (middles if to_the_ends else np.array(starts) + 0.5 * length)
    return Spectrogram(times, _frequencies(length, interval), amplitude, window, bandwidth)


def cut_spectra(
    signal: FloatArray, middles: npt.NDArray[np.int64], length: int, window: Window
) -> tuple[FloatArray, FloatArray]:
    """Peak amplitudes under windows about samples of a record, which get shorter towards its ends.

    A window that an end would cut is as long as fits about its middle, but no shorter than a quarter; the last one
    stands beside the end. Each is scaled so that a sine keeps its height, and padded with zeros to the same lines.

    Parameters
    ----------
    signal : ndarray, shape (s,)
    middles : ndarray of int, shape (t,)
        Sample in the middle of each window.
    length : int
        Number of samples of a whole window.
    window : {"uniform", "hann"}

    Returns
    -------
    amplitude : ndarray, shape (t, length // 2 + 1)
    noise_bandwidth : ndarray, shape (t,)
        Bandwidth of each window over the spacing of lines.
    """
    before, after = length // 2, length - length // 2
    least = max(length // 8, 1)
    rows, bandwidths = [], []
    for middle in middles.tolist():
        reach = max(min(middle, signal.size - middle), least)
        centre = min(max(middle, reach), signal.size - reach)
        first, last = centre - min(before, reach), centre + min(after, reach)
        weights = window_weights(last - first, window)
        part, weight = signal[first:last], float(weights.sum())
        mean = float(part.mean())
        row = np.abs(np.fft.rfft((part - mean) * weights, length)) * (2.0 / weight)
        if length % 2 == 0:
            row[-1] *= 0.5  # the line at half the sampling rate stands alone
        row[0] = abs(mean)
        rows.append(row)
        bandwidths.append(length * float(weights @ weights) / weight**2)
    return np.array(rows), np.array(bandwidths)


def _starts(count: int, length: int, step: int) -> list[int]:
    """First samples of the stretches that fit in."""
    if not 2 <= length <= count:
        raise CouplingError(f"stretches of {length} samples from a record of {count}; expected 2 to {count}")
    if not step >= 1:
        raise CouplingError(f"stretches {step} samples apart; expected a step of at least 1, an overlap below 1")
    return list(range(0, count - length + 1, step))
