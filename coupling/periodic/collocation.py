"""Gauss collocation on one element of time: Gauss points, polynomials and quadrature weights.

Gauss points, here called places, and polynomials are in u, which runs from 0 to 1 over the element.
"""

import math

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

ORDER = 5
"""Places in an element; the error at its end is of order 2 ORDER + 1 in its size."""


def _barycentric(points: FloatArray) -> FloatArray:
    apart = points[:, None] - points[None, :] + np.eye(len(points))
    return np.asarray(1.0 / apart.prod(axis=1))


def _missing(places: FloatArray) -> FloatArray:
    """Polynomials that vanish at the places and are 1 and 0 at the ends, and 0 and 1."""
    whole = np.polynomial.polynomial.polyfromroots(places)
    first = np.polynomial.polynomial.polymul(whole, [1.0, -1.0]) / whole[0]
    last = np.polynomial.polynomial.polymul(whole, [0.0, 1.0]) / whole.sum()
    return np.ascontiguousarray([first, last])


PLACES: FloatArray = 0.5 * (1.0 + np.polynomial.legendre.leggauss(ORDER)[0])
"""Gauss-Legendre points, ascending, shape (ORDER,)."""

MONOMIALS: FloatArray = np.ascontiguousarray(np.linalg.inv(np.vander(PLACES, increasing=True)).T)
"""Coefficients of u⁰, u¹, ... of the polynomial that is 1 at place j and 0 at the others, shape (ORDER, ORDER)."""

GAUSS: FloatArray = np.ascontiguousarray(0.5 * np.polynomial.legendre.leggauss(ORDER)[1])
"""Weights of an integral over the whole element, shape (ORDER,)."""

POINTS: FloatArray = np.concatenate([[0.0], PLACES, [1.0]])
"""Both ends and the places: interpolation points of a compression within an element, shape (ORDER + 2,)."""

BARYCENTRIC: FloatArray = _barycentric(POINTS)
"""Weights of the barycentric formula on these points."""

INSIDE = 1e-6
"""Part of an element by which evaluations at its ends stand inside, as events and switches are at the ends."""

AT_ENDS: FloatArray = np.ascontiguousarray(np.vander([INSIDE, 1.0 - INSIDE], ORDER, increasing=True) @ MONOMIALS.T)
"""Weights of the values at the places in their polynomial just inside both ends, shape (2, ORDER)."""

MISSING: FloatArray = _missing(PLACES)
"""Coefficients of the defect of such a polynomial for a defect of 1 at the start or the end, (2, ORDER + 2)."""


BINOMIAL: FloatArray = np.array([[float(math.comb(j, k)) for k in range(ORDER)] for j in range(ORDER)])
"""Coefficients of (u + v)ʲ, shape (ORDER, ORDER)."""

AT_END: FloatArray = np.ascontiguousarray(MONOMIALS @ BINOMIAL)
"""Coefficients of (u - 1)⁰, (u - 1)¹, ... of the polynomial that is 1 at place j, shape (ORDER, ORDER)."""


def weights_to(part: FloatArray) -> FloatArray:
    """Weights at the places of an integral from 0 to ``part``, shapes (e,) and (e, ORDER); Gauss's own for 1."""
    powers = np.arange(1, ORDER + 1)
    return np.asarray((part[:, None] ** powers / powers) @ MONOMIALS.T)
