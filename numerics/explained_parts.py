"""Parts of a variance that single inputs explain, from samples alone: regression on one input after the other."""

import numpy as np
from scipy import stats

from gearwhine.numerics.arrays import FloatArray

LEAST_SAMPLES = 32
"""Number of samples below which no part is estimated."""
_LEAST_PART = 0.01  # of the variance, below which an input ends the search


def explained_parts(values: FloatArray, inputs: FloatArray, chance: float) -> dict[int, float]:
    """Return the part of the variance of some values that goes with each input alone, where it is more than chance.

    A broken line over the ranks of an input, or the mean of each of its few values, takes the part ``(S - k s²) / T``
    of the total sum of squares T: S by its k parameters, with the mean square s² of what it leaves (Kelley 1935). That
    estimates the first-order index, also of what rises on both sides. The input of the largest part comes first, and
    each further one is fitted beside those before it: pairs of coordinates of a short Sobol' sequence follow each
    other, so that either alone would seem to explain what one of them does.

    Parameters
    ----------
    values : ndarray, shape (n,)
    inputs : ndarray, shape (n, d)
    chance : float
        Probability of the F-test above which a part is left out, and the search ends.

    Returns
    -------
    dict of int to float
        By the number of the input, the largest part first.
    """
    count = len(values)
    rest = values - values.mean()
    total = float(rest @ rest)
    if count < LEAST_SAMPLES or total == 0.0:
        return {}
    pieces = min(max(count // 32, 4), 10)
    shapes = {number: _shapes(column, pieces) for number, column in enumerate(inputs.T) if np.ptp(column) > 0.0}
    parts, freedom = dict[int, float](), count - 1
    while shapes:
        found = {number: _part(rest, shape, freedom) for number, shape in shapes.items()}
        best = max(found, key=lambda number: found[number][0])
        part, by_chance = found[best][0] / total, found[best][1]
        if by_chance >= chance or part < _LEAST_PART:
            break
        parts[best] = part
        taken = shapes.pop(best)
        freedom -= taken.shape[1]
        rest = rest - taken @ (taken.T @ rest)
        shapes = {number: _orthonormal(shape - taken @ (taken.T @ shape)) for number, shape in shapes.items()}
    return dict(sorted(parts.items(), key=lambda each: -each[1]))


def _shapes(column: FloatArray, pieces: int) -> FloatArray:
    """Orthonormal functions of an input without their means: of broken lines over its ranks, or of its few values."""
    distinct = np.unique(column)
    if distinct.size <= pieces:
        hats = (column[:, None] == distinct[1:]).astype(np.float64)
    else:
        places = pieces * (stats.rankdata(column) - 0.5) / len(column)
        hats = np.maximum(1.0 - np.abs(places[:, None] - np.arange(1, pieces + 1)), 0.0)
    return _orthonormal((hats - hats.mean(axis=0)) / np.sqrt(len(column)))


def _orthonormal(columns: FloatArray) -> FloatArray:
    left, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, sizes > 1e-6])


def _part(rest: FloatArray, shape: FloatArray, freedom: int) -> tuple[float, float]:
    """Return the adjusted sum of squares that functions take of a rest, and its probability by chance."""
    size, inner = shape.shape[1], freedom - shape.shape[1]
    if size == 0 or inner < 1:
        return 0.0, 1.0
    taken = float(np.sum((shape.T @ rest) ** 2))
    mean_square = max(float(rest @ rest) - taken, 0.0) / inner
    by_chance = float(stats.f.sf(taken / size / mean_square, size, inner)) if mean_square > 0.0 else 0.0
    return taken - size * mean_square, by_chance
