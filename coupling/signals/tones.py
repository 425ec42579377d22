"""Tones of a record that holds no whole periods: interpolated discrete Fourier transform under Hann's window.

Under Hann's window a tone of complex amplitude a, δ line spacings above line l, has the lines

    X_k = a h(k - l - δ),    h(x) = e^{-iπx} (sinc(x) + sinc(x - 1) / 2 + sinc(x + 1) / 2),

in three or four of which it stands; each alone is up to 1.4 dB too low, and their squares add up to 3/2 of the tone's.
The ratio of the two highest, next to each other, gives its place, and then either its amplitude:

    δ = (2α - 1) / (α + 1),    α = |X_{l+1}| / |X_l|.

T. Grandke, Interpolation algorithms for discrete Fourier transforms of weighted signals, IEEE Transactions on
Instrumentation and Measurement 32 (1983) 350-355. What the lines hold of other tones, up to 2 % of one three spacings
off and 0.05 % of one ten off, is then taken away with the tones that were found, and they are found again.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.signals.spectrum import Spectrum, line_height
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_PASSES = 4  # number of passes that subtract the leakage of other tones
_ON_LINE = 1e-6  # distance from a line within which a tone is the line, in line spacings
_LEAKING = 200  # number of the highest tones whose leakage is subtracted


@dataclass(frozen=True)
class Tones:
    """Tones that some signals share.

    Attributes
    ----------
    frequencies : ndarray, shape (t,)
        Frequencies [Hz], ascending.
    amplitudes : ndarray of complex, shape (n, t)
        Amplitudes a in the unit of each signal, which is the sum of Re a e^{2πift}.
    """

    frequencies: FloatArray
    amplitudes: ComplexArray


def hann_tones(spectrum: Spectrum, weights: npt.ArrayLike, floor: float = 1e-6) -> Tones:
    """Find the tones of some signals, one frequency of each tone for all of them.

    A tone is a local maximum of the weighted sum of the signals' squares.

    Parameters
    ----------
    spectrum : Spectrum
        Spectrum of the signals, shape (n, m), under Hann's window.
    weights : array_like, shape (n,)
        Weight of each signal's amplitude in the sum; 0 for a signal of another unit.
    floor : float
        Part of the highest tone below which a maximum is rounding.

    Raises
    ------
    CouplingError
        Where the spectrum is that of another window.
    """
    if spectrum.window != "hann":
        raise CouplingError(f"tones of a spectrum under the window {spectrum.window!r}; expected 'hann'")
    lines, weight = spectrum.lines, np.asarray(weights, dtype=np.float64)
    size = _size(lines, weight)
    inner = np.arange(2, len(size) - 1)  # below are the mean and its leakage
    peaks = inner[(size[inner] >= size[inner - 1]) & (size[inner] > size[inner + 1])]
    peaks = peaks[size[peaks] > floor * size[inner].max(initial=0.0)]
    low = np.where(size[peaks + 1] >= size[peaks - 1], peaks, peaks - 1)
    pair = lines[:, low], lines[:, low + 1]
    offset, amplitudes = _interpolated(*pair, weight)
    for _ in range(_PASSES):
        loud = np.argsort(-_size(amplitudes, weight), kind="stable")[:_LEAKING]
        distance = low[:, None] - (low + offset)[loud]
        itself = np.arange(len(low))[:, None] == loud
        lower, upper = (
            raw - amplitudes[:, loud] @ np.where(itself, 0.0, hann_line(distance + side)).T
            for raw, side in zip(pair, (0.0, 1.0), strict=True)
        )
        offset, amplitudes = _interpolated(lower, upper, weight)
    return Tones(spectrum.spacing * (low + offset), amplitudes)


def _size(lines: ComplexArray, weights: FloatArray) -> FloatArray:
    """Root of the weighted sum of the signals' squares, shape (m,)."""
    return np.asarray(np.sqrt(((weights[:, None] * np.abs(lines)) ** 2).sum(axis=0)))


def _interpolated(lower: ComplexArray, upper: ComplexArray, weights: FloatArray) -> tuple[FloatArray, ComplexArray]:
    """Distances above the lower of two neighbouring lines, shape (t,), and amplitudes of tones, shape (n, t)."""
    below, above = _size(lower, weights), _size(upper, weights)
    offset = tone_offset(below, above)
    low, high = tone_weights(offset)
    return offset, low * lower + high * upper


def tone_offset(lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Distance δ of tones above the lower one of their two highest lines, by the heights of both, from 0 to 1."""
    ratio = upper / np.maximum(lower, np.finfo(float).tiny)
    return np.asarray(np.clip((2.0 * ratio - 1.0) / (ratio + 1.0), 0.0, 1.0))


def tone_weights(offset: FloatArray) -> ComplexArray:
    """Weights of the two lines beside tones in their amplitudes, shape (2, t), by their distances above the lower one.

    Least squares over both lines, so that a small line counts little.
    """
    low, high = hann_line(-offset), hann_line(1.0 - offset)
    return np.asarray(np.stack([low.conj(), high.conj()]) / (np.abs(low) ** 2 + np.abs(high) ** 2))


def tones_at(
    lines: ComplexArray, spacing: float, frequencies: npt.ArrayLike, window: str
) -> tuple[FloatArray, ComplexArray]:
    """Tones of known frequencies from the lines beside them.

    Without a window, and on a line, a tone is the nearest line.

    Parameters
    ----------
    lines : ndarray of complex, shape (..., m)
        Lines of some signals from 0 Hz on.
    spacing : float
        Spacing of the lines [Hz].
    frequencies : array_like, shape (t,)
        Between 0 Hz and the last line [Hz].
    window : {"uniform", "hann"}

    Returns
    -------
    frequencies : ndarray, shape (t,)
        Frequencies of the tones [Hz].
    amplitudes : ndarray of complex, shape (..., t)
    """
    places = np.asarray(frequencies, dtype=np.float64) / spacing
    nearest = np.rint(places).astype(np.int64)
    between = (np.abs(places - nearest) > _ON_LINE) & (window == "hann")
    lower = np.where(between, np.floor(places), nearest).astype(np.int64)
    offset = np.where(between, places - lower, 0.0)
    weights = np.where(between, tone_weights(offset), np.array([[1.0], [0.0]]))
    upper = np.minimum(lower + 1, lines.shape[-1] - 1)
    return np.asarray(spacing * (lower + offset)), np.asarray(
        lines[..., lower] * weights[0] + lines[..., upper] * weights[1]
    )


def hann_line(distance: FloatArray) -> ComplexArray:
    """Value h(x) of the line x spacings above a tone of amplitude 1."""
    return np.asarray(line_height(distance, "hann") * np.exp(-1j * np.pi * distance))
