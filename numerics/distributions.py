r"""Distributions of varied quantities, by their quantile functions.

A sample is a point of the unit cube; each coordinate u in (0, 1) becomes a value by the quantile function
``x = F⁻¹(u)``. Low-discrepancy points, correlated points and pairs of matrices for sensitivity indices all become
values in this one way.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from scipy import special

from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Number, Numbers, RefusedPartError, attribute_findings, refuse
from gearwhine.numerics.own_copies import keep_tuples

_LEAST_INSIDE = 1e-9
"""Least probability of the range that a distribution is cut to: beyond, the tail is not what was meant."""


class DistributionError(RefusedPartError):
    """A distribution that cannot be."""


class Distribution(Protocol):
    """Distribution of a real quantity."""

    def quantile(self, probability: FloatArray) -> FloatArray:
        """Value below which the quantity lies with a probability in (0, 1), of the same shape."""
        ...


@dataclass(frozen=True)
class Normal:
    """Normal distribution, whole or cut at both ends.

    Attributes
    ----------
    mean : float
    deviation : float
        Standard deviation of the whole distribution.
    low, high : float
        Ends of the range that it is cut to, with the density inside in proportion to the whole one.

    Raises
    ------
    DistributionError
    """

    mean: float
    deviation: float
    low: float = -math.inf
    high: float = math.inf

    def __post_init__(self) -> None:
        """Check the parameters."""
        refuse(self._findings(), DistributionError)

    def _findings(self) -> Iterator[Finding]:
        part = ("normal", "")
        rules = {name: Number() for name in ("low", "high") if getattr(self, name) not in (-math.inf, math.inf)}
        wrong = list(attribute_findings(part, self, mean=Number(), deviation=Number(above=0.0), **rules))
        yield from wrong
        if wrong:
            return
        if not self.low < self.high:
            yield Finding(part, "high", float(self.high), f"a number above the low end {self.low:g}")
        elif self._inside < _LEAST_INSIDE:
            end = "low" if self.low > self.mean else "high"
            yield Finding(part, end, float(getattr(self, end)), f"a number near the mean {self.mean:g}, or beyond it")

    @property
    def _ends(self) -> tuple[float, float]:
        """Ends in standard deviations from the mean."""
        return (self.low - self.mean) / self.deviation, (self.high - self.mean) / self.deviation

    @property
    def _inside(self) -> float:
        low, high = self._ends
        return float(special.ndtr(high) - special.ndtr(low))

    def quantile(self, probability: FloatArray) -> FloatArray:
        """Value by its probability."""
        low = float(special.ndtr(self._ends[0]))
        values = self.mean + self.deviation * special.ndtri(low + probability * self._inside)
        return np.asarray(np.clip(values, self.low, self.high))


@dataclass(frozen=True)
class Uniform:
    """Uniform distribution from `low` to `high`."""

    low: float
    high: float

    def __post_init__(self) -> None:
        """Check the parameters."""
        refuse(_range_findings("uniform", self), DistributionError)

    def quantile(self, probability: FloatArray) -> FloatArray:
        """Value by its probability."""
        return np.asarray(self.low + (self.high - self.low) * probability)


@dataclass(frozen=True)
class Triangular:
    """Triangular distribution from `low` to `high` with its peak at `mode`."""

    low: float
    mode: float
    high: float

    def __post_init__(self) -> None:
        """Check the parameters."""
        findings = list(_range_findings("triangular", self))
        if not findings and not self.low <= self.mode <= self.high:
            findings = [Finding(("triangular", ""), "mode", self.mode, f"a number from {self.low:g} to {self.high:g}")]
        refuse(findings, DistributionError)

    def quantile(self, probability: FloatArray) -> FloatArray:
        """Value by its probability."""
        width, rise, fall = self.high - self.low, self.mode - self.low, self.high - self.mode
        rising = self.low + np.sqrt(probability * width * rise)
        falling = self.high - np.sqrt((1.0 - probability) * width * fall)
        return np.asarray(np.where(probability * width < rise, rising, falling))


@dataclass(frozen=True)
class Rayleigh:
    """Size of a vector in the plane with two normal components of zero mean, cut at `high`.

    Attributes
    ----------
    scale : float
        Standard deviation of each component.
    high : float
        End of the range that it is cut to.
    """

    scale: float
    high: float = math.inf

    def __post_init__(self) -> None:
        """Check the parameters."""
        part = ("rayleigh", "")
        findings = list(attribute_findings(part, self, scale=Number(above=0.0)))
        if not self.high > 0.0:
            findings.append(Finding(part, "high", float(self.high), "a number above 0"))
        refuse(findings, DistributionError)

    def quantile(self, probability: FloatArray) -> FloatArray:
        """Value by its probability, ``σ sqrt(-2 ln(1 - u P))`` with P that of the range."""
        inside = -math.expm1(-0.5 * (self.high / self.scale) ** 2)
        return np.asarray(self.scale * np.sqrt(-2.0 * np.log1p(-probability * inside)))


@dataclass(frozen=True)
class Discrete:
    """Some values, each with its part of all.

    Attributes
    ----------
    values : sequence of float
    weights : sequence of float
        Weight of each value, in any measure; all alike by default.
    """

    values: Sequence[float]
    weights: Sequence[float] = ()

    def __post_init__(self) -> None:
        """Keep own copies, and check the parameters."""
        keep_tuples(self, "values", "weights")
        part = ("discrete", "")
        rules = {"values": Numbers(), "weights": Numbers(each=Number(at_least=0.0))}
        findings = list(attribute_findings(part, self, **rules))
        if not findings and not self.values:
            findings.append(Finding(part, "values", self.values, "one value or more"))
        if not findings and self.weights and (len(self.weights) != len(self.values) or sum(self.weights) == 0.0):
            expected = f"one weight for each of the {len(self.values)} values, not all 0"
            findings.append(Finding(part, "weights", self.weights, expected))
        refuse(findings, DistributionError)

    def quantile(self, probability: FloatArray) -> FloatArray:
        """Value by its probability: the first one up to which the parts sum to it."""
        weights = np.array(self.weights or [1.0] * len(self.values))
        ends = np.cumsum(weights)[:-1] / weights.sum()
        return np.asarray(np.array(self.values)[np.searchsorted(ends, probability, side="right")])


@dataclass(frozen=True)
class Measured:
    """Distribution of measured values, without a model of it.

    The quantile function is linear between the ordered values x_(1) ... x_(n), which stand at ``(i - 1) / (n - 1)``, so
    that no sample lies beyond what was measured.

    Attributes
    ----------
    values : sequence of float
        Two values or more.
    """

    values: Sequence[float]
    _ordered: FloatArray = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Keep own copies, and check the values."""
        keep_tuples(self, "values")
        part = ("measured", "")
        findings = list(attribute_findings(part, self, values=Numbers()))
        if not findings and len(self.values) < 2:
            findings.append(Finding(part, "values", self.values, "two values or more"))
        refuse(findings, DistributionError)
        object.__setattr__(self, "_ordered", np.sort(np.array(self.values, dtype=np.float64)))

    def quantile(self, probability: FloatArray) -> FloatArray:
        """Value by its probability."""
        return np.asarray(np.interp(probability, np.linspace(0.0, 1.0, len(self._ordered)), self._ordered))


def widened(law: object, factor: float) -> Distribution | None:
    """Return a distribution with its range and its spread wider by a factor, about its mean or its peak.

    A uniform one is widened about its middle, one of Rayleigh from 0. None of values that have no tolerance: discrete
    and measured ones.
    """
    match law:
        case Normal(mean, deviation, low, high):
            return Normal(mean, factor * deviation, mean + factor * (low - mean), mean + factor * (high - mean))
        case Uniform(low, high):
            middle, half = 0.5 * (low + high), 0.5 * factor * (high - low)
            return Uniform(middle - half, middle + half)
        case Triangular(low, mode, high):
            return Triangular(mode + factor * (low - mode), mode, mode + factor * (high - mode))
        case Rayleigh(scale, high):
            return Rayleigh(factor * scale, factor * high)
        case _:
            return None


def _range_findings(kind: str, owner: Uniform | Triangular) -> Iterator[Finding]:
    """Yield what is wrong with the numbers of a range."""
    numbers = {name: Number() for name in ("low", "mode", "high") if hasattr(owner, name)}
    findings = list(attribute_findings((kind, ""), owner, **numbers))
    yield from findings
    if not findings and not owner.low < owner.high:
        yield Finding((kind, ""), "high", owner.high, f"a number above the low end {owner.low:g}")


def correlation_findings(matrix: FloatArray) -> Iterator[Finding]:
    """Yield what keeps a matrix from being one of correlation: shape, unit diagonal, symmetry, definiteness."""
    part, shape = ("correlation", ""), matrix.shape
    if matrix.ndim != 2 or shape[0] != shape[1] or not np.all(np.isfinite(matrix)):
        yield Finding(part, "", None, f"a square matrix of finite numbers, got the shape {shape}")
        return
    if np.any(np.diag(matrix) != 1.0) or np.any(matrix != matrix.T) or np.any(np.abs(matrix) > 1.0):
        yield Finding(part, "", None, "ones on the diagonal, and the same number from -1 to 1 at both places of a pair")
        return
    least = float(np.linalg.eigvalsh(matrix).min())
    if least < -1e-12 * len(matrix):
        expected = (
            f"coefficients that quantities can have together; the least eigenvalue of their matrix is {least:.3g}, "
            "where none may be below 0: make some of them smaller"
        )
        yield Finding(part, "", None, expected)


def correlated(points: FloatArray, correlation: FloatArray) -> FloatArray:
    """Return points of the unit cube whose coordinates are correlated, each still uniform.

    A Gaussian copula (Nataf 1962): the coordinates become normal scores ``z = Φ⁻¹(u)``, these ``L z`` with
    ``L Lᵀ = R``, and those again probabilities. R is the correlation of the normal scores; the rank correlation of the
    quantities is ``6/π asin(R/2)``, and their own correlation is near it.

    Parameters
    ----------
    points : ndarray, shape (n, d)
    correlation : ndarray, shape (d, d)

    Raises
    ------
    DistributionError
        Where the matrix is none of correlation.
    """
    refuse(correlation_findings(correlation), DistributionError)
    # The square root by eigenvalues also takes a matrix with perfectly correlated pairs.
    values, vectors = np.linalg.eigh(correlation)
    root = vectors * np.sqrt(np.maximum(values, 0.0)) @ vectors.T
    return np.asarray(special.ndtr(special.ndtri(points) @ root.T))
