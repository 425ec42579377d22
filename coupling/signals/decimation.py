"""Streaming decimation with an anti-aliasing filter.

A symmetric FIR filter of 2H + 1 taps h is applied to the record, and every D-th of its values is kept,

    y[m] = sum over k of h[k] x[m D + k],   which stands for the time of sample m D + H:

its delay is exact and taken off. Half a filter's length is left out at each end of the record, where samples are
missing. The sum runs over the taps in the same order wherever a piece ends, so pieces leave no trace, to the last bit.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwhine.coupling.errors import CouplingError
from gearwhine.numerics.arrays import FloatArray

_REJECTION = 120.0  # dB: below the seven digits in which histories are kept


@dataclass(frozen=True)
class Decimation:
    """Anti-aliasing filter and decimation factor.

    Attributes
    ----------
    factor : int
        Decimation factor D.
    taps : ndarray, shape (2H + 1,)
        Taps h of the filter, symmetric, of sum 1.
    """

    factor: int
    taps: FloatArray

    @cached_property
    def delay(self) -> int:
        """Delay H: number of the sample that the first decimated value stands for."""
        return len(self.taps) // 2

    def kept(self, samples: int) -> int:
        """Return the number of values from a record of ``samples`` samples."""
        return max((samples - len(self.taps)) // self.factor + 1, 0)

    def through(self, history: FloatArray, samples: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Filter and decimate the next piece of a record.

        Parameters
        ----------
        history : ndarray, shape (p, k)
            Remainder of the previous piece; empty (p = 0) at the start of the record.
        samples : ndarray, shape (s, k)

        Returns
        -------
        kept : ndarray, shape (m, k)
        history : ndarray
            Remainder for the next piece.
        """
        record = np.concatenate([history, samples])
        count = self.kept(len(record))
        if not count:
            return record[:0], record
        span = (count - 1) * self.factor + 1
        last = len(self.taps) - 1
        total = self.taps[self.delay] * record[self.delay : self.delay + span : self.factor]
        for k in range(self.delay):
            beside = record[k : k + span : self.factor] + record[last - k : last - k + span : self.factor]
            total += self.taps[k] * beside
        return total, record[count * self.factor :].copy()


def decimation(factor: int, band: float) -> Decimation:
    """Design a low-pass filter by Kaiser's window that passes a band and suppresses aliases into it by 120 dB.

    Between the band and the frequency that folds onto its edge the response falls: the decimated signal is complete up
    to the band and attenuated above it.

    Parameters
    ----------
    factor : int
        Number of samples for one decimated value; 1 changes nothing.
    band : float
        Upper end of the band, as a part of the decimated sampling rate; below 1/2.

    References
    ----------
    J. F. Kaiser, "Nonrecursive digital filter design using the I0-sinh window function", *IEEE Int. Symp. Circuits and
    Systems*, 1974.
    """
    if factor < 1 or not 0.0 < band < 0.5:
        raise CouplingError(
            f"decimation by {factor} with a band up to {band} of the rate; expected 1 or more, below 1/2"
        )
    if factor == 1:
        return Decimation(1, np.ones(1))
    transition = 2.0 * math.pi * (1.0 - 2.0 * band) / factor
    half = math.ceil((_REJECTION - 7.95) / (2.285 * transition) / 2.0)
    # scipy.signal.firwin gives the same, but its import takes longer than a short transient.
    taps = np.sinc(np.arange(-half, half + 1) / factor) * np.kaiser(2 * half + 1, 0.1102 * (_REJECTION - 8.7))
    return Decimation(factor, taps / taps.sum())
