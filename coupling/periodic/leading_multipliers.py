r"""Leading Floquet multipliers of a period map by Arnoldi's method, with the error of each.

The monodromy M of a periodic motion x = Φ(x) is known by its products alone: M v is the difference of the states after
a period from x + ε v and from x. Arnoldi's method projects it on the Krylov space of a random disturbance,

    M V_k = V_k H_k + h_{k+1,k} v_{k+1} e_kᵀ,

in which the disturbances that last longest stand out first: the eigenvalues θ of H_k with the largest modulus are the
leading multipliers. With an eigenvector y of H_k a residual r = h_{k+1,k} |e_kᵀ y| is left, and the multiplier is
within κ r to first order, where κ = 1 / |y_lᴴ y| is the condition of θ (Wilkinson). Lengths are those of energy, so
that M hardly lengthens any disturbance and κ is near one.

A first space is built with longer steps of the time integration than the motion has. From the disturbance that it
finds to last longest, a second and smaller one is built with the motion's own steps and the opposite sign of ε. The
change of the largest modulus between both, divided by the ratio of the steps less one, is an error of the first order
in the steps (Newmark's is of the second), and adds to κ r.

- Y. Saad, *Numerical Methods for Large Eigenvalue Problems*, 2nd ed., SIAM, 2011, ch. 6.
- J. H. Wilkinson, *The Algebraic Eigenvalue Problem*, Oxford, 1965, ch. 2.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearwhine.numerics.arrays import ComplexArray, FloatArray

MOST_DISTURBANCES = 60
"""Largest dimension of the Krylov space."""

_FEWEST = 6  # dimension before which a multiplier may be one that comes out first by chance
_FEWEST_AGAIN = 4  # the same of a space that begins with the disturbance sought, to see others nearly parallel to it
_LEFT = 0.3  # error of the largest multiplier over its distance from one at which it decides
_EXACT = 1e-6  # error of the largest multiplier that differences of states hardly fall below
_LISTED = 0.02  # largest error of a multiplier that is listed beside the largest
_EXHAUSTED = 1e-10  # part of a product outside the space below which the space is all that a disturbance meets

Product = Callable[[FloatArray, float], FloatArray]
"""Product M v of the monodromy, with a sign of the difference."""


@dataclass(frozen=True, eq=False)
class LeadingMultipliers:
    """Multipliers with the largest moduli, the largest first.

    Attributes
    ----------
    values : ndarray of complex, shape (m,)
    errors : ndarray, shape (m,)
        Estimated error of the modulus of each.
    disturbances : int
        Number of disturbances that were followed over a period.
    """

    values: ComplexArray
    errors: FloatArray
    disturbances: int


def leading_multipliers(
    start: FloatArray,
    coarse: Product,
    fine: Product,
    *,
    ratio: float,
    progress: Callable[[float], None] = lambda fraction: None,
) -> LeadingMultipliers:
    """Compute the leading multipliers until the largest is known to be within the unit circle or outside it.

    Parameters
    ----------
    start : ndarray, shape (n,)
        Disturbance with a part of all others.
    coarse, fine : callable
        Products of the monodromy with long steps and with those of the motion.
    ratio : float
        Ratio of these steps, above 1.
    progress : callable
        Called with the part of the disturbances that were followed at most, from 0 to 1.
    """
    first = _krylov(start, lambda v: coarse(v, 1.0), _FEWEST, progress)
    leading = first.vectors[:, 0]
    second = _krylov(leading.real + leading.imag, lambda v: fine(v, -1.0), _FEWEST_AGAIN, progress)
    change = abs(abs(second.values[0]) - abs(first.values[0]))
    errors = np.maximum(second.errors, _EXACT) + change / (ratio - 1.0)
    listed = errors <= np.maximum(_LISTED, errors[0] * (1.0 + 1e-9))
    disturbances = first.vectors.shape[1] + second.vectors.shape[1]
    return LeadingMultipliers(second.values[listed], errors[listed], disturbances)


@dataclass(frozen=True, eq=False)
class _Ritz:
    """Eigenvalues of a projected monodromy, the largest first, their errors but for that of its products, and vectors.

    Vectors are of length one, in columns.
    """

    values: ComplexArray
    errors: FloatArray
    vectors: ComplexArray


def _krylov(
    start: FloatArray, product: Callable[[FloatArray], FloatArray], fewest: int, progress: Callable[[float], None]
) -> _Ritz:
    """Project the monodromy on a growing Krylov space until the largest eigenvalue decides."""
    basis, most = [start / np.linalg.norm(start)], min(MOST_DISTURBANCES, len(start))
    projected = np.zeros((most, most))
    while True:
        size = len(basis)
        moved = product(basis[-1])
        length = float(np.linalg.norm(moved))
        for _ in range(2):  # twice, so that the basis is orthogonal to rounding
            parts = np.array(basis) @ moved
            projected[:size, size - 1] += parts
            moved = moved - parts @ np.array(basis)
        left = float(np.linalg.norm(moved))
        progress(size / most)
        values, vectors = np.linalg.eig(projected[:size, :size].astype(np.complex128))
        conditions = np.linalg.norm(np.linalg.pinv(vectors), axis=1)
        order = np.argsort(-np.abs(values), kind="stable")
        values, errors = values[order], (conditions * left * np.abs(vectors[-1]))[order]
        decides = size >= fewest and errors[0] <= max(_LEFT * abs(1.0 - abs(values[0])), _EXACT)
        if decides or left <= _EXHAUSTED * length or size == most:
            return _Ritz(values, errors, np.array(basis).T @ vectors[:, order])
        projected[size, size - 1] = left
        basis.append(moved / left)
