"""Quadratic eigenvalue problem λ² q + λ C q + K q = 0: eigenvalues with right and left vectors, every one proved.

The vectors are normalised so that pᴴ (2 λ I + C) q = 1 with |q| = 1 (Tisseur and Meerbergen 2001). The inverse of the
dynamic stiffness is then, with X the drift of :mod:`coupling.rigid_motions`,

    (s² I + s C + K)⁻¹ = X (1/s² ) - (Σ q pᴴ) (1/s) + Σ q pᴴ / (s - λ),

the sums over all eigenvalues but zero. Its behaviour at large s, where it is 1/s², gives the sum rule
Σ λ q pᴴ + X = I. One eigenpair wrong, missing or twice breaks it.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.errors import ModesError
from coupling.rigid_motions import reduce_state

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_RESIDUAL = 1e-9  # largest residual of a pair, relative to the terms of its equation
_REFINE = 1e-12  # pairs with a larger residual are refined
_DOUBLE = 1e-9  # relative distance within which two eigenvalues are one double eigenvalue
_INDEPENDENT = 1e-6  # singular value below which their vectors are one as well


@dataclass(frozen=True)
class Eigenpairs:
    """All 2n eigenvalues: r + s zeros, and m = 2n - r - s others, conjugate pairs in full.

    Attributes
    ----------
    values : ndarray of complex, shape (m,)
        λ [1/s], none of them zero.
    right, left : ndarray of complex, shapes (m, n)
        q, of unit norm, and p; rows.
    rigid : ndarray, shape (r, n)
        Rigid-body motions, which no spring resists, orthonormal; rows.
    drifts : int
        s, number of double zeros: motions that no dashpot resists either.
    drift : ndarray, shape (n, n)
        X.
    residuals : ndarray, shape (m,)
        |λ² q + λ C q + K q| over the norm of the sum of its terms' absolute values.
    sum_rule : float
        Largest entry of Σ λ q pᴴ + X - I: 0 but for rounding where all pairs are there. It loses the digits that a
        defective eigenvalue takes.
    """

    values: ComplexArray
    right: ComplexArray
    left: ComplexArray
    rigid: FloatArray
    drifts: int
    drift: FloatArray
    residuals: FloatArray
    sum_rule: float


def quadratic_eigenpairs(stiffness: FloatArray, damping: FloatArray) -> Eigenpairs:
    """Every eigenpair of λ² q + λ C q + K q = 0.

    Parameters
    ----------
    stiffness, damping : ndarray, shape (n, n)
        K [1/s²] and C [1/s], symmetric or not.

    Raises
    ------
    ModesError
        Where a pair misses its equation by more than 1e-9 of the equation's terms.
    """
    state = reduce_state(stiffness, damping)
    n = len(stiffness)
    values, vectors = np.linalg.eig(state.matrix)
    values, vectors = values.astype(np.complex128), vectors.astype(np.complex128)
    _separate_doubles(values, vectors)
    moving = (state.basis @ vectors)[:n]
    right = moving / values
    try:
        inverse = np.linalg.inv(vectors)
    except np.linalg.LinAlgError:  # vectors of a defective eigenvalue that are one to the last digit
        inverse = np.linalg.pinv(vectors)
    # What the left vectors have along the momenta that the reduced state leaves out.
    leaving = (inverse @ (state.basis.T @ (state.whole @ state.momenta))) / values[:, None]
    left = (inverse @ state.basis.T + leaving @ state.momenta.T)[:, :n].conj()
    norms = np.linalg.norm(right, axis=0)
    right, left = (right / norms).T, left * norms[:, None]
    residuals = pair_residuals(stiffness, damping, values, right)
    for i in np.flatnonzero(residuals > _REFINE):
        value, vector, residual = refine_pair(stiffness, damping, values[i], right[i])
        if residual < residuals[i] and abs(value - values[i]) <= 1e-6 * abs(values[i]):
            values[i], right[i], residuals[i] = value, vector, residual
    worst = float(residuals.max(initial=0.0))
    if not worst <= _RESIDUAL:
        raise ModesError(
            f"a coupled mode at {abs(values[int(np.argmax(residuals))]) / (2.0 * np.pi):.6g} Hz misses its equation by "
            f"{worst:.1e} of its terms; expected at most {_RESIDUAL:.0e}: look for stiffness or damping entries that "
            "are many orders of magnitude apart"
        )
    rule = np.einsum("m,mi,mj->ij", values, right, left.conj(), optimize=True) + state.drift - np.eye(n)
    return Eigenpairs(
        values=values,
        right=right,
        left=left,
        rigid=state.rigid.T,
        drifts=state.drifts,
        drift=state.drift,
        residuals=residuals,
        sum_rule=float(np.abs(rule).max(initial=0.0)),
    )


def pair_residuals(
    stiffness: FloatArray, damping: FloatArray, values: ComplexArray, vectors: ComplexArray
) -> FloatArray:
    """|λ² q + λ C q + K q| over the norm of |λ|² |q| + |λ| |C| |q| + |K| |q|, shape (m,); vectors along the rows."""
    size = np.abs(values)[:, None]
    missing = values[:, None] ** 2 * vectors + values[:, None] * (vectors @ damping.T) + vectors @ stiffness.T
    plain = np.abs(vectors)
    terms = size**2 * plain + size * (plain @ np.abs(damping).T) + plain @ np.abs(stiffness).T
    norm = np.linalg.norm(terms, axis=1)
    return np.asarray(np.linalg.norm(missing, axis=1) / np.where(norm > 0.0, norm, 1.0))


def refine_pair(
    stiffness: FloatArray, damping: FloatArray, value: complex, vector: ComplexArray, steps: int = 6
) -> tuple[complex, ComplexArray, float]:
    """An eigenpair near a given one, with its residual, by Newton's method on (λ² I + λ C + K) q = 0, uᴴ q = 1.

    The bordered matrix stays regular at the eigenvalue, so no digits are lost there.
    """
    n = len(vector)
    q = np.asarray(vector / np.linalg.norm(vector), dtype=np.complex128)
    best = (value, q, float(pair_residuals(stiffness, damping, np.array([value]), q[None])[0]))
    bordered = np.zeros((n + 1, n + 1), dtype=np.complex128)
    for _ in range(steps):
        dynamic = stiffness + value * damping + value**2 * np.eye(n)
        bordered[:n, :n], bordered[:n, n], bordered[n, :n] = dynamic, 2.0 * value * q + damping @ q, q.conj()
        try:
            change = np.linalg.solve(bordered, np.append(-dynamic @ q, 0.0))
        except np.linalg.LinAlgError:
            break
        q = q + change[:n]
        value, q = complex(value + change[n]), q / np.linalg.norm(q)
        residual = float(pair_residuals(stiffness, damping, np.array([value]), q[None])[0])
        if not np.isfinite(residual) or residual >= best[2]:
            break
        best = (value, q, residual)
    return best


def _separate_doubles(values: ComplexArray, vectors: ComplexArray) -> None:
    """Orthogonalise the vectors of multiple eigenvalues, in place, where they are independent.

    An eigensolver's vectors of such a group may be all but parallel although the group is not defective.
    """
    upper = np.flatnonzero(values.imag >= 0.0)
    order = upper[np.lexsort((values[upper].real, values[upper].imag))]
    steps = np.abs(np.diff(values[order])) > _DOUBLE * np.abs(values[order[:-1]])
    for group in np.split(order, np.flatnonzero(steps) + 1):
        if group.size < 2:
            continue
        directions, singular, _ = np.linalg.svd(vectors[:, group], full_matrices=False)
        if singular[-1] < _INDEPENDENT * singular[0]:
            continue
        mirrored = np.abs(values - values[group[0]].conj()) <= group.size * _DOUBLE * np.abs(values[group[0]])
        below = np.flatnonzero(mirrored & (values.imag < 0.0))
        if values[group[0]].imag > 0.0 and below.size != group.size:
            continue
        vectors[:, group] = directions
        if below.size == group.size:
            values[below], vectors[:, below] = values[group].conj(), directions.conj()
