"""Numbers of thirty-one digits: unevaluated sums of two doubles, as arrays (Dekker 1971; Hida, Li and Bailey 2001).

Rounding of doubles, 1e-16 of the stiffest part of a rotor, can exceed what holds its softest part. A reference in which
rounding is 1e-31 needs no judgement of what it could have blurred.
"""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray

SPLITTER = 2.0**27 + 1.0


@dataclass(frozen=True, eq=False)
class DoubleDouble:
    """An array of numbers high + low, |low| at most half a unit in the last place of high."""

    high: FloatArray
    low: FloatArray

    @classmethod
    def of(cls, values: npt.ArrayLike) -> "DoubleDouble":
        """Doubles as they are."""
        high = np.asarray(values, dtype=np.float64)
        return cls(high, np.zeros_like(high))

    @classmethod
    def of_fractions(cls, values: list[list[Fraction]]) -> "DoubleDouble":
        """Rational numbers, rounded once."""
        high = np.array([[float(value) for value in row] for row in values])
        low = np.array([[float(value - Fraction(float(value))) for value in row] for row in values])
        return cls(high, low)

    @classmethod
    def product(cls, left: npt.ArrayLike, right: npt.ArrayLike) -> "DoubleDouble":
        """The product of doubles, exactly."""
        return cls(*_two_product(np.asarray(left, dtype=np.float64), np.asarray(right, dtype=np.float64)))

    def __getitem__(self, key: object) -> "DoubleDouble":
        return DoubleDouble(self.high[key], self.low[key])  # type: ignore[index]

    def __neg__(self) -> "DoubleDouble":
        return DoubleDouble(-self.high, -self.low)

    def __add__(self, other: "DoubleDouble") -> "DoubleDouble":
        # Both halves with their errors: a sum that cancels keeps its digits.
        high, error = _two_sum(self.high, other.high)
        low, low_error = _two_sum(self.low, other.low)
        high, error = _quick_two_sum(high, error + low)
        return DoubleDouble(*_quick_two_sum(high, error + low_error))

    def __sub__(self, other: "DoubleDouble") -> "DoubleDouble":
        return self + (-other)

    def __mul__(self, other: "DoubleDouble") -> "DoubleDouble":
        high, error = _two_product(self.high, other.high)
        return DoubleDouble(*_quick_two_sum(high, error + (self.high * other.low + self.low * other.high)))


def _two_sum(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def _quick_two_sum(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    total = a + b
    return total, b - (total - a)


def _two_product(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    product = a * b
    a_high, a_low = _split(a)
    b_high, b_low = _split(b)
    return product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low


def _split(a: FloatArray) -> tuple[FloatArray, FloatArray]:
    shifted = SPLITTER * a
    high = shifted - (shifted - a)
    return high, a - high
