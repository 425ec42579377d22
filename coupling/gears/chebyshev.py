"""Chebyshev interpolation: a smooth function from its values at few points, where each value is expensive.

The interpolant through n + 1 Chebyshev points converges geometrically with n to an analytic function (Trefethen,
Approximation Theory and Approximation Practice, 2013). Its coefficients are the discrete cosine transform of the
values.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from numpy.polynomial import Chebyshev
from scipy.fft import dct

FloatArray = npt.NDArray[np.float64]
Function = Callable[[FloatArray], FloatArray]

_FEWEST, _MOST = 32, 128
_TOLERANCE = 1e-13
"""Largest difference of interpolant and function between the points, relative to the largest value."""


def chebyshev_interpolant(function: Function, length: float) -> Function:
    """Interpolate a function on [0, length]; return the function itself where it is not smooth enough.

    The degree is doubled until the interpolant meets the function at all points between its own.

    Parameters
    ----------
    function : callable
        From positions (n,) to values (n,).
    length : float
        End of the range.
    """
    values = function(_points(_FEWEST, length))
    while 2 * (degree := values.size - 1) <= _MOST:
        finer = _points(2 * degree, length)
        between = function(finer[1::2])
        error = np.abs(_interpolant(values, length)(finer[1::2]) - between).max()
        refined = np.empty(finer.size)
        refined[0::2], refined[1::2] = values, between
        if error <= _TOLERANCE * np.abs(refined).max():
            return _interpolant(refined, length)
        values = refined
    return function


def _points(degree: int, length: float) -> FloatArray:
    """Extrema of the Chebyshev polynomial, from the end of the range to 0; those of half the degree are among them."""
    return np.asarray(0.5 * length * (1.0 + np.cos(np.pi * np.arange(degree + 1) / degree)), dtype=np.float64)


def _interpolant(values: FloatArray, length: float) -> Chebyshev:
    """Chebyshev series through values at `_points`."""
    coefficients = dct(values, type=1) / (values.size - 1)
    coefficients[[0, -1]] *= 0.5
    return Chebyshev(coefficients, domain=[0.0, length])
