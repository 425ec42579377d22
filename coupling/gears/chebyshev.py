"""A smooth function by its values at a few Chebyshev points, where each value is dear.

The polynomial through n + 1 of them nears an analytic function geometrically with n; in the barycentric form it is
exact to rounding (Berrut and Trefethen, SIAM Review 46, 2004).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Function = Callable[[FloatArray], FloatArray]

_FEWEST, _MOST = 32, 128
_ALIKE = 1e-13
"""Part of its largest value by which the function may differ from a polynomial between the points of that."""


def by_few_values(function: Function, length: float) -> Function:
    """A function that costs little and equals another on [0, length], or that other one.

    The polynomial is refined until it meets the function at all points between its own, twice as many; a function that
    is not smooth enough for that remains what it is.

    Parameters
    ----------
    function : callable
        From positions (n,) to values (n,).
    length : float
        End of the range.
    """
    degree = _FEWEST
    values = function(_points(degree, length))
    while 2 * degree <= _MOST:
        finer = _points(2 * degree, length)
        between = function(finer[1::2])
        apart = np.abs(_polynomial(values, length)(finer[1::2]) - between).max()
        refined = np.empty(finer.size)
        refined[0::2], refined[1::2] = values, between
        if apart <= _ALIKE * np.abs(refined).max():
            return _polynomial(refined, length)
        degree, values = 2 * degree, refined
    return function


def _points(degree: int, length: float) -> FloatArray:
    """Extrema of the Chebyshev polynomial, from the end of the range to 0; those of half the degree are among them."""
    return np.asarray(0.5 * length * (1.0 + np.cos(np.pi * np.arange(degree + 1) / degree)), dtype=np.float64)


def _polynomial(values: FloatArray, length: float) -> Function:
    points = _points(values.size - 1, length)
    weights = (-1.0) ** np.arange(values.size)
    weights[[0, -1]] *= 0.5

    def polynomial(position: FloatArray) -> FloatArray:
        apart = position[:, None] - points
        rows, columns = np.nonzero(apart == 0.0)
        apart[rows, columns] = 1.0
        pull = weights / apart
        found = (pull @ values) / pull.sum(axis=1)
        found[rows] = values[columns]
        return np.asarray(found, dtype=np.float64)

    return polynomial
