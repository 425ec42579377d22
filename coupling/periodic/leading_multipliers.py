r"""Leading Floquet multipliers of a period map by Arnoldi's method, each with its error, and a bound on all others.

The monodromy M of a periodic motion x = Φ(x) is known by its products alone: M v is the difference of the states after
a period from x + ε v and from x. Arnoldi's method projects it on the Krylov space of a random disturbance,

    M V_k = V_k H_k + h_{k+1,k} v_{k+1} e_kᵀ,

in which the disturbances that last longest stand out first: the eigenvalues θ of H_k with the largest modulus are the
leading multipliers. With an eigenvector y of H_k a residual r = h_{k+1,k} |e_kᵀ y| is left, and the multiplier is
within κ r to first order, where κ = 1 / |y_lᴴ y| is the condition of θ (Wilkinson). Lengths are those of energy, so
that M hardly lengthens any disturbance and κ is near one.

Such a residual says that a multiplier is near θ, and nothing of others that have not stood out yet. These are bounded
by the start: v_j = π_j(M) v_1, and the left eigenvector w of length one of any multiplier μ has wᴴ v_j = π_j(μ) wᴴ v_1,
so that by Bessel's inequality

    Σ |π_j(μ)|² ≤ 1 / |wᴴ v_1|²,    j = 0 … k,    z π_{j-1}(z) = Σ_i h_ij π_{i-1}(z),    π_0 = 1,

whatever the condition of μ. A direction v_1 drawn evenly from all of n coordinates has |wᴴ v_1| < s with a probability
of at most 2 s √(n/π). Where the sum is larger than 1/s² on a circle and all around it, the largest multiplier is
within that circle but for this probability (Hochstenbach does so with the norm of a matrix).

A first space is built with longer steps of the time integration than the motion has. From the disturbance that it
finds to last longest, a second and smaller one is built with the motion's own steps and the opposite sign of ε. The
change of the largest modulus between both, divided by the ratio of the steps less one, is an error of the first order
in the steps (Newmark's is of the second), and adds to κ r.

- Y. Saad, *Numerical Methods for Large Eigenvalue Problems*, 2nd ed., SIAM, 2011, ch. 6.
- M. E. Hochstenbach, Probabilistic upper bounds for the matrix two-norm, *J. Sci. Comput.* 57, 464, 2013.
- J. H. Wilkinson, *The Algebraic Eigenvalue Problem*, Oxford, 1965, ch. 2.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearwhine.numerics.arrays import ComplexArray, FloatArray

MOST_DISTURBANCES = 120
"""Largest dimension of the Krylov space."""

_FEWEST_AGAIN = 4  # dimension of a space that begins with the disturbance sought, to see others nearly parallel to it
_LEFT = 0.5  # error of the largest multiplier, over its distance from one, that suffices
_RISK = 1e-3  # probability with which a larger multiplier may lie beyond the error of the largest
_ANGLES = 129  # places on half a circle on which multipliers are sought
_DISTANCES = 2.0 ** np.arange(-10.0, 7.0)  # of circles from the largest multiplier, over its own from one
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
        Estimated error of the modulus of each; that of the first covers larger ones that have not come out.
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
        Disturbance in a direction drawn evenly from all.
    coarse, fine : callable
        Products of the monodromy with long steps and with those of the motion.
    ratio : float
        Ratio of these steps, above 1.
    progress : callable
        Called with the part of the disturbances that were followed at most, from 0 to 1.
    """
    first = _krylov(start, lambda v: coarse(v, 1.0), progress, drawn=True)
    leading = first.vectors[:, 0]
    second = _krylov(leading.real + leading.imag, lambda v: fine(v, -1.0), progress, drawn=False)
    change = abs(abs(second.values[0]) - abs(first.values[0]))
    errors = np.maximum(second.errors, _EXACT)
    listed = errors <= max(_LISTED, errors[0] * (1.0 + 1e-9))
    errors[0] = max(errors[0], first.errors[0])
    disturbances = first.vectors.shape[1] + second.vectors.shape[1]
    return LeadingMultipliers(second.values[listed], errors[listed] + change / (ratio - 1.0), disturbances)


@dataclass(frozen=True, eq=False)
class _Ritz:
    """Eigenvalues of a projected monodromy, the largest first, their errors but for that of its products, and vectors.

    Vectors are of length one, in columns.
    """

    values: ComplexArray
    errors: FloatArray
    vectors: ComplexArray


def _krylov(
    start: FloatArray, product: Callable[[FloatArray], FloatArray], progress: Callable[[float], None], *, drawn: bool
) -> _Ritz:
    """Project the monodromy on a growing Krylov space until the largest eigenvalue decides.

    The error of the largest covers those that have not come out, where the start is drawn.
    """
    fewest, most = 1 if drawn else _FEWEST_AGAIN, min(MOST_DISTURBANCES, len(start))
    basis = [start / np.linalg.norm(start)]
    projected = np.zeros((most + 1, most))
    while True:
        size = len(basis)
        moved = product(basis[-1])
        length = float(np.linalg.norm(moved))
        for _ in range(2):  # twice, so that the basis is orthogonal to rounding
            parts = np.array(basis) @ moved
            projected[:size, size - 1] += parts
            moved = moved - parts @ np.array(basis)
        left = projected[size, size - 1] = float(np.linalg.norm(moved))
        progress(size / most)
        values, vectors = np.linalg.eig(projected[:size, :size].astype(np.complex128))
        conditions = np.linalg.norm(np.linalg.pinv(vectors), axis=1)
        order = np.argsort(-np.abs(values), kind="stable")
        values, errors = values[order], (conditions * left * np.abs(vectors[-1]))[order]
        enough, last = max(_LEFT * abs(1.0 - abs(values[0])), _EXACT), left <= _EXHAUSTED * length or size == most
        if drawn and (last or errors[0] <= enough):
            errors[0] = max(errors[0], _unseen(projected[: size + 1, :size], values, len(start)))
        if last or (size >= fewest and errors[0] <= enough):
            return _Ritz(values, errors, np.array(basis).T @ vectors[:, order])
        basis.append(moved / left)


def _unseen(hessenberg: FloatArray, values: ComplexArray, count: int) -> float:
    """Distance beyond the largest of Ritz values within which the largest eigenvalue lies but for the risk.

    Parameters
    ----------
    hessenberg : ndarray, shape (k + 1, k)
    values : ndarray of complex, shape (k,)
        Ritz values, the largest first.
    count : int
        Number n of coordinates.
    """
    angles = np.concatenate([np.linspace(0.0, np.pi, _ANGLES), np.abs(np.angle(values))])
    largest = abs(values[0])
    distances = max(abs(1.0 - largest), _EXACT) * _DISTANCES
    z = np.ravel((largest + distances[:, None]) * np.exp(1j * angles))
    polynomials = np.ones((1, len(z)), dtype=np.complex128)
    most = 4.0 * count / (np.pi * _RISK**2)
    for column in range(hessenberg.shape[1]):
        last = z * polynomials[-1] - hessenberg[: column + 1, column] @ polynomials
        polynomials = np.vstack([polynomials, last / max(hessenberg[column + 1, column], 1e-100)])
        possible = np.sum(np.abs(polynomials) ** 2, axis=0) <= most
        z, polynomials = z[possible], polynomials[:, possible]
    farther = distances[largest + distances > np.abs(z).max(initial=0.0) * (1.0 + 1e-12)]
    return float(farther[0]) if len(farther) else np.inf
