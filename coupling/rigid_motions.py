"""Rigid-body motions, removed from the quadratic eigenvalue problem before it is solved.

With λ² q + λ C q + K q = 0 every q with K q = 0 is an eigenvector of λ = 0, mostly a double one: an offset, and a
drift at constant speed. An eigensolver splits such a double root into ± the square root of its rounding, which
hides the root and slow motions beside it. Here ranks decide, of matrices whose rows are scaled to one size:

- R, the null space of K, and L, that of Kᵀ. Offsets along R are left out of the state: with U the orthogonal
  complement of R and b = Uᵀ q, the state (v = q', b) of order 2n - r obeys v' = -C v - K U b, b' = Uᵀ v, and r zeros
  are gone.
- W and Y, the null spaces of LᵀCR and of its transpose: drifts that no dashpot resists. They are the zeros that the
  reduced state still has, each with a conserved momentum; the state is restricted to those without momentum, and s more
  zeros are gone.

The reduced problem, of order 2n - r - s, has no zero; its spectrum is the rest of the system's.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

_RANK = 1e-11  # of a damping's rank: its singular values below this, relative to its largest terms, are rounding
_ROUNDING = 32.0  # roundings in an entry of a stiffness, one for each connector that adds to it
_PRECISION = float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class ReducedState:
    """The first-order system without its zeros: x' = A x, of order m = 2n - r - s.

    Attributes
    ----------
    matrix : ndarray, shape (m, m)
        A.
    basis : ndarray, shape (2n - r, m)
        Orthonormal; the state (q', Ω Uᵀ q) is this times x.
    whole : ndarray, shape (2n - r, 2n - r)
        The matrix that acts on that state.
    momenta : ndarray, shape (2n - r, s)
        Orthonormal basis of its left null space, the complement of ``basis``.
    rigid : ndarray, shape (n, r)
        R, orthonormal.
    drift : ndarray, shape (n, n)
        X, of rank s: a unit impulse f leaves the drift velocity X f behind.
    drifts : int
        s.
    """

    matrix: FloatArray
    basis: FloatArray
    whole: FloatArray
    momenta: FloatArray
    rigid: FloatArray
    drift: FloatArray
    drifts: int


def reduce_state(stiffness: FloatArray, damping: FloatArray) -> ReducedState:
    """Remove the zero eigenvalues from λ² q + λ C q + K q = 0.

    The coordinates b are the principal ones of the symmetric part of K, times the root Ω of its values. A lossless
    system then has a skew matrix, the best conditioned there is, however far its frequencies lie apart.
    """
    n = len(stiffness)
    right, left = null_space(stiffness), null_space(stiffness.T)
    complement = np.linalg.qr(right, mode="complete")[0][:, right.shape[1] :]
    symmetric = complement.T @ (0.5 * (stiffness + stiffness.T)) @ complement
    values, vectors = np.linalg.eigh(0.5 * (symmetric + symmetric.T))
    # An unsymmetric K may be regular where its symmetric part is not; any scale serves there.
    root = np.sqrt(np.maximum(np.abs(values), 1e-12 * np.abs(values).max(initial=0.0)))
    root[root == 0.0] = 1.0
    u = complement @ vectors
    whole = np.block([[-damping, -(stiffness @ u) / root], [root[:, None] * u.T, np.zeros((root.size, root.size))]])

    resisted = left.T @ damping @ right
    size = np.abs(left).T @ np.abs(damping) @ np.abs(right)
    # R and L themselves are rounded: that much of the largest damping is in their product with C in any case.
    bound = _RANK * float(size.max(initial=0.0)) + n * _PRECISION * float(np.abs(damping).max(initial=0.0))
    drifting, kept = right @ _null(resisted, bound), left @ _null(resisted.T, bound)
    # The right null vectors have a static deflection under the forces of their drift; the left ones are momenta.
    deflection = -np.linalg.lstsq((stiffness @ u) / root, damping @ drifting, rcond=None)[0]
    null_right = np.vstack([drifting, deflection])
    null_left = np.vstack([kept, (u.T @ damping.T @ kept) / root[:, None]])
    drifts = null_right.shape[1]
    complete = np.linalg.qr(null_left, mode="complete")[0]
    momenta, basis = complete[:, :drifts], complete[:, drifts:]
    drift = np.zeros((n, n))
    if drifts:
        drift = drifting @ np.linalg.solve(null_left.T @ null_right, kept.T)
    return ReducedState(basis.T @ whole @ basis, basis, whole, momenta, right, drift, drifts)


def null_space(matrix: FloatArray) -> FloatArray:
    """Orthonormal basis of the null space of a square matrix, rows and columns first brought to one size.

    Coordinates of a stiffness differ by ten orders of magnitude; a rank judged against the stiffest of them would take
    soft supports for none.

    With d its diagonal, an entry of a positive semidefinite K has terms of at most √(dᵢ dⱼ) each (Cauchy and Schwarz),
    so its m roundings amount to m ε √(dᵢ dⱼ). Scaled by 1/√dᵢ and 1/√dⱼ the error E has entries of at most m ε, and
    ‖E‖₂ ≤ n m ε. No singular value moves further (Weyl): one above that bound is a stiffness, however soft beside the
    others, and the bound is the same in all units and coordinates that scaling brings about.
    """
    size = np.abs(np.diag(matrix))
    largest = np.maximum(np.abs(matrix).max(axis=0, initial=0.0), np.abs(matrix).max(axis=1, initial=0.0))
    size = np.where(size > 1e-3 * largest, size, largest)
    scale = 1.0 / np.sqrt(np.where(size > 0.0, size, 1.0))
    _, singular, vectors = np.linalg.svd(scale[:, None] * matrix * scale)
    bound = _ROUNDING * len(matrix) * _PRECISION * max(float(singular.max(initial=0.0)), 1e-300)
    vectors = scale[:, None] * vectors[singular <= bound].T
    return np.asarray(np.linalg.qr(vectors)[0])


def _null(matrix: FloatArray, bound: float) -> FloatArray:
    """Orthonormal basis of the directions that a square matrix shrinks to a bound or less."""
    _, singular, vectors = np.linalg.svd(matrix)
    return np.asarray(vectors[singular <= bound].T)
