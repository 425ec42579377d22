r"""Spectral peaks: the highest lines of a spectrum, under Hann's window those of the tones between the lines.

Under Hann's window a tone between two lines is up to 1.4 dB higher than either. A peak whose four lines are those of a
tone, h(x) of :mod:`gearwhine.coupling.signals.tones` at their distances from it, is that tone, by least squares over
its two highest lines; any other, such as one of two tones closer than that or of a ring-down, is its own line. A tone
is a linear function of the lines, so what other signals have of it follows from their lines in the same way, and parts
of a signal add up to the whole in its tones as they do in its lines.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gearwhine.coupling.signals.spectrum import Spectrum
from gearwhine.coupling.signals.tones import hann_line, tone_offset, tone_weights
from gearwhine.numerics.arrays import ComplexArray, FloatArray, IntArray

_LONE = 0.1  # largest deviation of a tone's four lines from those of one tone, over its height
_EXACT_LINE_DISTANCE = 0.02  # distance that the frequency of an exact line is known within, over the spacing of lines
_LEAST_TONE_DISTANCE = 0.05  # least distance that a tone's frequency is known within, over the spacing of lines
# Change of a tone's place by that of its two lines over its height: at most 2, and what fits its lines by chance.
_SLOPE = 3.0


class Peak(NamedTuple):
    """A spectral peak: frequency [Hz] and peak amplitude in the signal's unit."""

    frequency: float
    amplitude: float


@dataclass(frozen=True)
class SpectralPeaks:
    """Peaks of a spectrum, highest first.

    Attributes
    ----------
    frequencies : ndarray, shape (p,)
        Frequencies [Hz].
    amplitudes : ndarray, shape (p,)
        Peak amplitudes, in the signal's unit.
    lower : ndarray of int, shape (p,)
        Place of the lower one of the two lines that a peak is found from.
    weights : ndarray of complex, shape (2, p)
        Weights of both lines in the peak.
    resolution : ndarray, shape (p,)
        Distance that each frequency is known within [Hz]: of a tone by the deviation of its lines from those of one
        tone, of another peak half the spacing; without a window, where lines are exact, a small part of it.
    """

    frequencies: FloatArray
    amplitudes: FloatArray
    lower: IntArray
    weights: ComplexArray
    resolution: FloatArray

    def __len__(self) -> int:
        """Return the number of peaks."""
        return len(self.frequencies)

    @property
    def rows(self) -> list[Peak]:
        """Frequency and amplitude of each peak."""
        return [Peak(*row) for row in zip(self.frequencies.tolist(), self.amplitudes.tolist(), strict=True)]

    def of(self, lines: ComplexArray) -> ComplexArray:
        """Return what lines of any signals hold of each peak: complex amplitudes, shape (..., p).

        The lines, shape (..., m), are those of a spectrum at the same frequencies.
        """
        return np.asarray(lines[..., self.lower] * self.weights[0] + lines[..., self.lower + 1] * self.weights[1])


def spectral_peaks(
    spectrum: Spectrum, *, count: int = 12, above: float = 0.0, limit: float = np.inf, floor: float = 1e-3
) -> SpectralPeaks:
    """Find spectral peaks: the highest lines that are higher than both neighbours.

    Parameters
    ----------
    spectrum : Spectrum
        Spectrum of one signal.
    count : int
        Largest number of peaks.
    above, limit : float
        Range of frequencies [Hz].
    floor : float
        Least height of a peak, relative to the highest line.
    """
    a, f = spectrum.amplitude, spectrum.frequencies
    inner = np.arange(1, len(a) - 1)
    places = inner[(a[inner] >= a[inner - 1]) & (a[inner] > a[inner + 1]) & (f[inner] > above) & (f[inner] <= limit)]
    places = places[a[places] > floor * a[places].max(initial=0.0)]
    lower, offset, weights, known = (
        (*_own_lines(places), np.full(len(places), _EXACT_LINE_DISTANCE))
        if spectrum.window == "uniform"
        else _tones(a, places)
    )
    sizes = np.abs(weights)
    amplitudes = sizes[0] * a[lower] + sizes[1] * a[lower + 1]
    order = np.argsort(-amplitudes, kind="stable")[:count]
    frequencies = f[lower] + offset * spectrum.spacing
    return SpectralPeaks(
        frequencies[order], amplitudes[order], lower[order], weights[:, order], known[order] * spectrum.spacing
    )


def _own_lines(places: IntArray) -> tuple[IntArray, FloatArray, ComplexArray]:
    """Lower lines, distances above them and weights of peaks that are their own lines."""
    return places, np.zeros(len(places)), np.outer([1.0, 0.0], np.ones(len(places), dtype=np.complex128))


def _tones(a: FloatArray, places: IntArray) -> tuple[IntArray, FloatArray, ComplexArray, FloatArray]:
    """Lower lines, distances above them and weights of peaks under Hann's window, where they are lone tones.

    Returned last are the distances that their places are known within, over the spacing.
    """
    # The line at 0 Hz is the mean, and none of a tone's.
    lower = np.where((a[places + 1] >= a[places - 1]) | (places == 1), places, places - 1)
    offset = tone_offset(a[lower], a[lower + 1])
    around = np.arange(-1, 3)[:, None]
    beside = lower + around
    known = (beside > 0) & (beside < len(a))
    lines = np.where(known, hann_line(around - offset), 0.0)
    heights = np.where(known, a[np.clip(beside, 0, len(a) - 1)], 0.0)
    weights = tone_weights(offset)
    size = (np.abs(weights) * heights[1:3]).sum(axis=0)
    deviation = np.abs(heights - np.abs(lines) * size).max(axis=0, initial=0.0)
    lone = deviation <= _LONE * size
    on_lines = _own_lines(places)
    within = np.where(
        lone, np.maximum(_SLOPE * deviation / np.where(lone, size, 1.0), _LEAST_TONE_DISTANCE), 0.5 + 1e-6
    )
    return (
        np.where(lone, lower, on_lines[0]),
        np.where(lone, offset, on_lines[1]),
        np.where(lone, weights, on_lines[2]),
        within,
    )
