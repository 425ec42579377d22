"""Sound levels: decibels, frequency weighting A, third-octave bands, and microphone positions around a machine.

Reference values are those of ISO 1683: 1 pW of sound power, 20 µPa of sound pressure in air.
"""

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray

REFERENCE_POWER = 1e-12
"""Reference sound power [W]."""
REFERENCE_PRESSURE = 20e-6
"""Reference sound pressure [Pa]."""

BOX_MICROPHONES = 9
"""Microphones of a :func:`measurement_box`."""

_NOMINAL = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)


def power_level(power: npt.ArrayLike) -> FloatArray:
    """Sound power level re 1 pW [dB] of a sound power [W]; minus infinity of none."""
    with np.errstate(divide="ignore"):
        return np.asarray(10.0 * np.log10(np.maximum(power, 0.0) / REFERENCE_POWER))


def pressure_level(amplitude: npt.ArrayLike) -> FloatArray:
    """Sound pressure level re 20 µPa [dB] of complex amplitudes [Pa]; minus infinity of none."""
    with np.errstate(divide="ignore"):
        return np.asarray(20.0 * np.log10(np.abs(amplitude) / np.sqrt(2.0) / REFERENCE_PRESSURE))


def sum_of_levels(levels: Iterable[float]) -> float:
    """Level of the sum of incoherent sounds [dB]; minus infinity of none."""
    with np.errstate(divide="ignore"):
        return float(10.0 * np.log10(np.sum(10.0 ** (0.1 * np.array(list(levels))))))


def a_weighting(frequencies_hz: npt.ArrayLike) -> FloatArray:
    """Frequency weighting A [dB], IEC 61672-1:2013, equations E.1 and E.6 with the pole frequencies of its Annex E."""
    square = np.asarray(frequencies_hz, dtype=np.float64) ** 2

    def response(square: npt.ArrayLike) -> FloatArray:
        square = np.asarray(square)
        low, middle, upper, high = 20.598997**2, 107.65265**2, 737.86223**2, 12194.217**2
        with np.errstate(divide="ignore"):
            return np.asarray(
                20.0
                * np.log10(
                    high
                    * square**2
                    / ((square + low) * np.sqrt((square + middle) * (square + upper)) * (square + high))
                )
            )

    return response(square) - response(1e6)


def third_octave_bands(frequencies_hz: FloatArray, powers: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Sum the powers of lines in third-octave bands, IEC 61260-1:2014 with the base 10.

    Returns
    -------
    nominal : ndarray, shape (n,)
        Nominal mid-band frequencies from the lowest band with a line to the highest [Hz].
    sums : ndarray, shape (n,)
        Sums in the unit of the powers.
    """
    if len(frequencies_hz) == 0:
        return np.zeros(0), np.zeros(0)
    # Bands are centred at 1000 · 10^(x/10) and half a band wide to each side.
    band = np.round(10.0 * np.log10(frequencies_hz / 1000.0)).astype(np.int64)
    bands = np.arange(band.min(), band.max() + 1)
    nominal = np.array([_NOMINAL[x % 10] * 10.0 ** (3 + x // 10) for x in bands])
    return nominal, np.asarray(np.bincount(band - bands[0], powers, len(bands)), dtype=np.float64)


def measurement_box(low: FloatArray, high: FloatArray, distance: float) -> tuple[FloatArray, float]:
    """Microphone positions and area of the box-shaped measurement surface on a floor, ISO 3744:2010, 7.2.4 and Annex C.

    The box has its faces at a distance from the reference box around the machine; its floor, at the machine's lowest
    height along y, is no part of it. Microphones stand at the middle of each of its five faces and at its four upper
    corners.

    Parameters
    ----------
    low, high : ndarray, shape (3,)
        Corners of the reference box [m].
    distance : float
        Distance [m].

    Returns
    -------
    positions : ndarray, shape (9, 3)
        [m]: +x, -x, +z, -z, top, and the corners (+x +z), (-x +z), (+x -z), (-x -z).
    area : float
        Area of the measurement surface [m²].
    """
    middle, half = 0.5 * (low + high), 0.5 * (high - low) + distance
    height = high[1] - low[1] + distance
    level, top = low[1] + 0.5 * height, low[1] + height
    sides = [(half[0], level, 0.0), (-half[0], level, 0.0), (0.0, level, half[2]), (0.0, level, -half[2])]
    corners = [(x * half[0], top, z * half[2]) for z in (1, -1) for x in (1, -1)]
    positions = np.array([*sides, (0.0, top, 0.0), *corners])
    positions[:, [0, 2]] += middle[[0, 2]]
    return positions, float(4.0 * (half[0] * half[2] + half[0] * height + half[2] * height))
