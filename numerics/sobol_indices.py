r"""Sobol' indices of a quantity: parts of its variance by its inputs, with confidence intervals.

For independent inputs x_i the variance V of a quantity f(x) splits into parts by each input and by inputs together
(Sobol' 1993). Of the matrices A, B, and A_i, which is A with input i from B,

    S_i = (1/n) Σ f(B) (f(A_i) - f(A)) / V             first order: by x_i alone (Saltelli et al. 2010),
    T_i = (1/2n) Σ (f(A) - f(A_i))² / V                total: by x_i with all others (Jansen 1999),

V that of the values of A and B together, f counted from their mean, which lowers the scatter of S_i. The intervals are
percentiles of the estimates over rows drawn again with replacement (bootstrap).
"""

from dataclasses import dataclass

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.sampling import IndexPoints

_REDRAWN = 500  # number of times that rows are drawn again
_AT_ONCE = 2_000_000  # values that are drawn at once
CONFIDENCE = 0.95
"""Probability of the intervals."""
LEAST_ROWS = 4
"""Number of rows below which no index is told."""


@dataclass(frozen=True, eq=False)
class SobolIndices:
    """Indices of k inputs, with 95 % intervals.

    Attributes
    ----------
    first, total : ndarray, shape (k,)
    first_interval, total_interval : ndarray, shape (k, 2)
        Low and high ends.
    rows : int
        Number of rows of the matrices that have all their values.
    """

    first: FloatArray
    total: FloatArray
    first_interval: FloatArray
    total_interval: FloatArray
    rows: int


def sobol_indices(points: IndexPoints, values: FloatArray, *, seed: int = 0) -> SobolIndices | None:
    """Return the indices of a quantity by its values at the points; None where it does not vary or has too few values.

    Parameters
    ----------
    points : IndexPoints
    values : ndarray, shape (n (k + 2),)
        NaN where there is none: the rows of the matrices with one are left out.
    seed : int
        Seed of the rows that are drawn again.
    """
    first, second, mixed = points.split(values)
    whole = np.isfinite(first) & np.isfinite(second) & np.all(np.isfinite(mixed), axis=0)
    rows = int(whole.sum())
    if rows < LEAST_ROWS:
        return None
    together = np.concatenate([first[whole], second[whole]])
    mean, size = together.mean(), np.abs(together).max()
    if together.std() <= 1e-13 * size:
        return None
    first, second, mixed = first[whole] - mean, second[whole] - mean, mixed[:, whole] - mean
    # Sums over rows of these are all that the estimates need.
    terms = np.concatenate(
        [
            second * (mixed - first),
            0.5 * (first - mixed) ** 2,
            [0.5 * (first + second), 0.5 * (first**2 + second**2)],
        ]
    )
    rng = np.random.default_rng(seed)
    drawn = []
    for count in _chunks(_REDRAWN, max(1, _AT_ONCE // rows)):
        weights = rng.multinomial(rows, np.full(rows, 1.0 / rows), size=count) / rows
        drawn.append(_estimates(terms @ weights.T))
    tail = 0.5 * (1.0 - CONFIDENCE)
    low, high = np.quantile(np.concatenate(drawn, axis=1), (tail, 1.0 - tail), axis=1)
    estimate, count = _estimates(terms.mean(axis=1)[:, None])[:, 0], len(points.inputs)
    intervals = np.stack([low, high], axis=1)
    return SobolIndices(estimate[:count], estimate[count:], intervals[:count], intervals[count:], rows)


def _estimates(means: FloatArray) -> FloatArray:
    """Return the indices of first and of total order, (2k, m), by the means of their terms, (2k + 2, m)."""
    variance = means[-1] - means[-2] ** 2
    return np.asarray(means[:-2] / np.where(variance > 0.0, variance, np.nan))


def _chunks(total: int, most: int) -> list[int]:
    return [min(most, total - start) for start in range(0, total, most)]
