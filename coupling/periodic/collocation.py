"""Gauss collocation on one element of time: places, polynomials, and the integrals of exponentials with them.

Places and polynomials are in u, which runs from 0 to 1 over the element.
"""

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

ORDER = 5
"""Places in an element; what an element ends with errs by its size to the power 2 ORDER + 1."""


def _gauss() -> tuple[FloatArray, FloatArray]:
    places, weights = np.polynomial.legendre.leggauss(ORDER)
    return 0.5 * (1.0 + places), 0.5 * weights


def _barycentric(points: FloatArray) -> FloatArray:
    apart = points[:, None] - points[None, :] + np.eye(len(points))
    return np.asarray(1.0 / apart.prod(axis=1))


PLACES, WEIGHTS = _gauss()
"""Gauss-Legendre places and weights, ascending, shape (ORDER,) both."""

MONOMIALS: FloatArray = np.ascontiguousarray(np.linalg.inv(np.vander(PLACES, increasing=True)).T)
"""Coefficients of u⁰, u¹, ... of the polynomial that is 1 at place j and 0 at the others, shape (ORDER, ORDER)."""

POINTS: FloatArray = np.concatenate([[0.0], PLACES, [1.0]])
"""Both ends and the places: where a compression within an element is interpolated from, shape (ORDER + 2,)."""

BARYCENTRIC: FloatArray = _barycentric(POINTS)
"""Weights of the barycentric formula on these points."""
