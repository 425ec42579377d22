"""Levels in decibels, peak and rms values of sines, by one convention.

A level is 20 lg of an *rms* value over a reference (ISO 80000-8, ISO 1683), so a sine of peak amplitude a has the level
20 lg(a / (√2 a₀)): one of 1 m/s² peak stands at 117.0 dB re 1 µm/s², not at 120.
"""

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError

FloatArray = npt.NDArray[np.float64]

ACCELERATION_REFERENCE = 1e-6
"""Of vibratory acceleration levels [m/s²], ISO 1683."""


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
