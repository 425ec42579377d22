"""Gauss collocation on one element of time: places, polynomials, and the integrals of exponentials with them.

Places and polynomials are in u, which runs from 0 to 1 over the element.
"""

import math

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

ORDER = 5
"""Places in an element; what an element ends with errs by its size to the power 2 ORDER + 1."""


def _barycentric(points: FloatArray) -> FloatArray:
    apart = points[:, None] - points[None, :] + np.eye(len(points))
    return np.asarray(1.0 / apart.prod(axis=1))


def _missing(places: FloatArray) -> FloatArray:
    """Polynomials that vanish at the places: 1 and 0 at the ends, and 0 and 1."""
    whole = np.polynomial.polynomial.polyfromroots(places)
    first = np.polynomial.polynomial.polymul(whole, [1.0, -1.0]) / whole[0]
    last = np.polynomial.polynomial.polymul(whole, [0.0, 1.0]) / whole.sum()
    return np.ascontiguousarray([first, last])


PLACES: FloatArray = 0.5 * (1.0 + np.polynomial.legendre.leggauss(ORDER)[0])
"""Gauss and Legendre's, ascending, shape (ORDER,)."""

MONOMIALS: FloatArray = np.ascontiguousarray(np.linalg.inv(np.vander(PLACES, increasing=True)).T)
"""Coefficients of u⁰, u¹, ... of the polynomial that is 1 at place j and 0 at the others, shape (ORDER, ORDER)."""

GAUSS: FloatArray = np.ascontiguousarray(0.5 * np.polynomial.legendre.leggauss(ORDER)[1])
"""Weights of an integral over the whole element, shape (ORDER,)."""

POINTS: FloatArray = np.concatenate([[0.0], PLACES, [1.0]])
"""Both ends and the places: where a compression within an element is interpolated from, shape (ORDER + 2,)."""

BARYCENTRIC: FloatArray = _barycentric(POINTS)
"""Weights of the barycentric formula on these points."""

INSIDE = 1e-6
"""Part of an element by which a look at its ends stands inside: events and switches are there themselves."""

AT_ENDS: FloatArray = np.ascontiguousarray(np.vander([INSIDE, 1.0 - INSIDE], ORDER, increasing=True) @ MONOMIALS.T)
"""What the values at the places make of the polynomial through them just inside both ends, shape (2, ORDER)."""

MISSING: FloatArray = _missing(PLACES)
"""Coefficients of what such a polynomial misses within if it misses 1 at the start or the end, (2, ORDER + 2)."""


BINOMIAL: FloatArray = np.array([[float(math.comb(j, k)) for k in range(ORDER)] for j in range(ORDER)])
"""Coefficients of (u + v)ʲ, shape (ORDER, ORDER)."""

AT_END: FloatArray = np.ascontiguousarray(MONOMIALS @ BINOMIAL)
"""Coefficients of (u - 1)⁰, (u - 1)¹, ... of the polynomial that is 1 at place j, shape (ORDER, ORDER)."""


def weights_to(part: FloatArray) -> FloatArray:
    """Weights at the places of an integral from 0 to ``part``, shapes (e,) and (e, ORDER); Gauss's own for 1."""
    powers = np.arange(1, ORDER + 1)
    return np.asarray((part[:, None] ** powers / powers) @ MONOMIALS.T)
