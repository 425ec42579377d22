"""Pairing by dominance: measured frequencies without shapes, compared with the model's dominant modes.

When 25 model modes fill 3 kHz, any measured frequency has one within a few per cent, so the nearest one proves
nothing. Where the measurement gives frequencies alone, the n dominant modes of the model, in order of frequency,
are paired with the n measured ones; see :mod:`housing.dominance`.
"""

import numpy as np
import numpy.typing as npt

from housing.correlation.comparison import Comparison, ModePair
from housing.dominance import Dominance
from housing.errors import HousingError

FloatArray = npt.NDArray[np.float64]

# Ends of the band of dominant modes, as parts of the first and the last measured frequency.
_BAND = (0.75, 1.05)


def dominance_band(measured: FloatArray) -> tuple[float, float]:
    """Band of the dominant modes: 0.75 of the first to 1.05 of the last measured frequency, in their unit."""
    return _BAND[0] * float(measured[0]), _BAND[1] * float(measured[-1])


def compare_by_dominance(
    measured: FloatArray, strengths: Dominance, *, band: tuple[float, float] | None = None
) -> Comparison:
    """Pair the measured modes with as many dominant modes of the model, in order of frequency.

    Parameters
    ----------
    measured : ndarray, shape (n,)
        Measured circular frequencies, ascending [rad/s].
    strengths : Dominance
        Of the model's modes.
    band : tuple of float, optional
        Where to look for dominant modes [rad/s]; by default that of :func:`dominance_band`.

    Raises
    ------
    HousingError
        Where nothing was measured, the measured frequencies do not ascend, or the model has fewer modes in the band.
    """
    if len(measured) == 0 or measured[0] <= 0.0 or np.any(np.diff(measured) <= 0.0):
        raise HousingError(f"measured frequencies {measured} rad/s must be positive and ascending")
    low, high = band or dominance_band(measured)
    chosen = strengths.strongest(len(measured), (low, high))
    if len(chosen) < len(measured):
        hertz = 2.0 * np.pi
        raise HousingError(
            f"{len(measured)} measured modes, but the model has only {len(chosen)} between {low / hertz:.0f} and "
            f"{high / hertz:.0f} Hz; raise the housing's frequency_limit or correct the model"
        )
    pairs = tuple(
        ModePair(
            float(frequency),
            float(strengths.frequencies[mode]),
            number,
            int(mode) + 1,
            float(strengths.acceleration[mode]),
        )
        for number, (frequency, mode) in enumerate(zip(measured, chosen, strict=True), start=1)
    )
    return Comparison(
        pairs=pairs,
        pairing="dominance in order of frequency",
        band=(low, high),
        gap=strengths.gap(len(measured), (low, high)),
        measures_agree=strengths.measures_agree(len(measured), (low, high)),
    )
