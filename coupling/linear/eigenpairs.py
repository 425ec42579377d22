"""Quadratic eigenvalue problem λ² q + λ C q + K q = 0: eigenvalues with right and left vectors, every one verified.

The vectors are normalised so that pᴴ (2 λ I + C) q = 1 with |q| = 1 (Tisseur and Meerbergen 2001). The inverse of the
dynamic stiffness is then, with X the part of the rigid-body drifts,

    (s² I + s C + K)⁻¹ = X (1/s² ) - (Σ q pᴴ) (1/s) + Σ q pᴴ / (s - λ),

the sums over all eigenvalues but zero. Its behaviour at large s, where it is 1/s², gives the sum rule
Σ λ q pᴴ + X = I. One eigenpair wrong, missing or twice breaks it.

Rigid-body motions are removed before the problem is solved. Every q with K q = 0 is an eigenvector of λ = 0, mostly a
double one: an offset, and a drift at constant speed. An eigensolver splits such a double root into ± the square root of
its rounding, which hides the root and slow motions beside it. Here ranks decide, of matrices whose rows are scaled to
one size:

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

from gearwhine.coupling.errors import ModesError
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_RANK = 1e-11  # singular values of a damping matrix below this part of its largest terms are rounding
_ROUNDINGS_PER_ENTRY = 32.0  # roundings in an entry of a stiffness, one for each connector that adds to it
_PRECISION = float(np.finfo(np.float64).eps)

_RESIDUAL = 1e-9  # largest residual of a pair, relative to the terms of its equation
_REFINE = 1e-12  # pairs with a larger residual are refined
_DOUBLE = 1e-9  # relative distance within which two eigenvalues are one double eigenvalue
_INDEPENDENT = 1e-6  # singular value below which the vectors of a double eigenvalue are dependent


@dataclass(frozen=True)
class ReducedState:
    """The first-order system without its zeros: x' = A x, of order m = 2n - r - s.

    Attributes
    ----------
    matrix : ndarray, shape (m, m)
        A.
    basis : ndarray, shape (2n - r, m)
        Orthonormal basis: the state (q', Ω Uᵀ q) is ``basis @ x``.
    whole : ndarray, shape (2n - r, 2n - r)
        Matrix of the first-order system on that state.
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
    # R and L are rounded: their product with C contains at least that part of the largest damping.
    bound = _RANK * float(size.max(initial=0.0)) + n * _PRECISION * float(np.abs(damping).max(initial=0.0))
    drifting, undamped_left = right @ _null(resisted, bound), left @ _null(resisted.T, bound)
    # The right null vectors have a static deflection under the forces of their drift; the left ones are momenta.
    deflection = -np.linalg.lstsq((stiffness @ u) / root, damping @ drifting, rcond=None)[0]
    null_right = np.vstack([drifting, deflection])
    null_left = np.vstack([undamped_left, (u.T @ damping.T @ undamped_left) / root[:, None]])
    drifts = null_right.shape[1]
    complete = np.linalg.qr(null_left, mode="complete")[0]
    momenta, basis = complete[:, :drifts], complete[:, drifts:]
    drift = np.zeros((n, n))
    if drifts:
        drift = drifting @ np.linalg.solve(null_left.T @ null_right, undamped_left.T)
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
    bound = _ROUNDINGS_PER_ENTRY * len(matrix) * _PRECISION * max(float(singular.max(initial=0.0)), 1e-300)
    vectors = scale[:, None] * vectors[singular <= bound].T
    return np.asarray(np.linalg.qr(vectors)[0])


def _null(matrix: FloatArray, bound: float) -> FloatArray:
    """Orthonormal basis of the directions that a square matrix shrinks to a bound or less."""
    _, singular, vectors = np.linalg.svd(matrix)
    return np.asarray(vectors[singular <= bound].T)


@dataclass(frozen=True)
class Eigenpairs:
    """All 2n eigenvalues: r + s zeros, and m = 2n - r - s others, conjugate pairs in full.

    Attributes
    ----------
    values : ndarray of complex, shape (m,)
        λ [1/s], none of them zero.
    right, left : ndarray of complex, shapes (m, n)
        Right vectors q, of unit norm, and left vectors p, in rows.
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
    # Part of the left vectors along the momenta that the reduced state leaves out.
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
    """Refine an eigenpair by Newton's method on (λ² I + λ C + K) q = 0, uᴴ q = 1; return it with its residual.

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
