"""Eigensolvers of K φ = λ M φ on the shifted inverse: block Lanczos (the default), and scipy's ``eigsh`` (ARPACK).

Both work on A = (K - σM)⁻¹ M, which is self-adjoint in the inner product of M: A φ = ν φ and λ = σ + 1/ν. Modes below
σ have ν < 0 and are the smallest algebraic ν, with the gap from -1/σ to 0 behind them; modes above σ have ν > 0 and are
the largest. The factor of K - σM is shared with the inertia certificate.

*Block Lanczos* finds the modes from few sweeps over the factor. From an M-orthonormal block V₁ the recurrence

    A V_j = V_1 T_1j + … + V_j T_jj + V_{j+1} R_j

builds a basis V and T = Vᵀ M A V. A Ritz pair T s = ν s has the residual |R_j s_j| with s_j the last block's part of
s, so that the check of convergence costs nothing, and one step of inverse iteration on a Ritz vector is at hand:

    A V s / ν = V s + V_{j+1} R_j s_j / ν.

Every block is orthogonalised against the whole basis after the recurrence, so that no mode is found twice. A block has
several columns because the factor is read once for all of them (Golub and Underwood 1977; Grimes, Lewis and Simon
1994); a multiple mode needs a block at least as wide as its multiplicity.

*Responses to loads* F come with the modes where V₁ also spans the responses (K - σM)⁻¹ F = V g, in their coordinates g:
the basis is then the Krylov space of these, in which V T g, V T² g, … are the responses' derivatives by σ, and each
discarded Ritz vector has the static response

    V s (sᵀ g) / (1 + σν).

*ARPACK* is an implicitly restarted Lanczos method; the factor enters it as ``OPinv``. It may leave out a copy of a
multiple mode without notice; the certificate (:mod:`gearwhine.housing.modes.certificate`) detects it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

from gearwhine.housing.errors import IncompleteModesError
from gearwhine.housing.fem.linear_algebra import BlockAlgebra, Operator
from gearwhine.numerics.arrays import FloatArray

TOLERANCE = 1e-9
"""Tolerance of a Ritz pair's residual, as a part of ν."""

_BLOCK = 8
_LEAST_RANDOM = 4  # random columns beside loads, for modes that these do not drive
_DEPENDENT = 1e-11  # remainder of a column, as a part of it, below which it lay in the basis
_NEARLY_WITHIN = 1e-4  # remainder of a column, as a part of it, below which its rounding shows
_ORTHONORMAL = 1e-14  # largest error of the products of a new block's columns from those of orthonormal ones
_DEPENDENT_COLUMN_CORRELATION = 1e-12  # least eigenvalue of a block's correlations before it counts as fewer columns


def block_lanczos(
    solve: Callable[[FloatArray], FloatArray],
    mass: Operator,
    shift: float,
    count: int,
    *,
    above: bool = False,
    seed: int = 0,
    threads: int = 1,
    tolerance: float = TOLERANCE,
    responses: "LoadResponses | None" = None,
) -> tuple[FloatArray, FloatArray]:
    """Solve for the modes nearest to a shift on one side of it by block Lanczos.

    Parameters
    ----------
    solve : callable
        X from (K - σM) X = Y, shape (n, m) both.
    mass : matrix or operator, shape (n, n)
        M [kg].
    shift : float
        σ [rad²/s²].
    count : int
        Number of modes.
    above : bool
        Whether the shift lies above the modes wanted, which are then all modes below it, rather than below them.
    seed : int
        Seed of the random starting block; each also doubles its width.
    threads : int
        Number of threads that orthogonalise; the modes are the same to the last bit for any number.
    tolerance : float
        Tolerance of the residual of the last mode to converge, as a part of its ν; its λ is off by about the square of
        that.
    responses : LoadResponses, optional
        Loads whose responses are found beside the modes.

    Returns
    -------
    values : ndarray, shape (count,)
        λ, ascending [rad²/s²].
    vectors : ndarray, shape (n, count)
        φ, with φᵀ M φ = 1.

    Raises
    ------
    IncompleteModesError
        Where the modes do not converge.
    """
    n = mass.shape[0]
    width = min(_BLOCK * 2**seed, n)
    most = min(n, 8 * count + 40 * width)
    # The operating system allocates only the pages that are used.
    basis = np.empty((n, most + width), order="F")
    small = np.zeros((most + 2 * width, most + 2 * width))  # also of the block that no longer fits the basis
    sign = -1.0 if above else 1.0

    algebra = BlockAlgebra(n, threads)
    start = mass @ np.random.default_rng(seed).standard_normal((n, width))
    if responses is not None:
        start = np.hstack([responses.loads, start[:, : max(_LEAST_RANDOM, width - responses.loads.shape[1])]])
    addition = orthonormal(basis[:, :0], solve(np.ascontiguousarray(start)), mass, algebra)
    first = addition.projections
    recent = np.empty((n, 0))
    begin, size, checked = 0, 0, 0
    while addition.block.shape[1] and size + addition.block.shape[1] <= most + width:
        begin, size = size, size + addition.block.shape[1]
        basis[:, begin:size] = addition.block
        inertia = addition.inertia
        addition = orthonormal(
            basis[:, :size], solve(inertia), mass, algebra, recent=np.concatenate([recent, inertia], axis=1)
        )
        recent = inertia
        small[:size, begin:size] = addition.projections[:size]
        remainder = addition.projections[size:]
        whole = addition.block.shape[1] == 0
        # Once in a twentieth of the basis: the small eigenproblem must not outgrow the large one.
        if size >= count and (whole or size - checked >= size // 20 or size + width > most):
            checked = size
            nu, mixtures = np.linalg.eigh(0.5 * (small[:size, :size] + small[:size, :size].T))
            ranked = np.argsort(-sign * nu)
            errors = np.linalg.norm(remainder @ mixtures[begin:], axis=0)
            wanted = ranked[:count]
            if whole or (np.all(sign * nu[wanted] > 0.0) and np.all(errors[wanted] < tolerance * np.abs(nu[wanted]))):
                chosen = wanted[np.argsort(1.0 / nu[wanted])]
                mixture = mixtures[:, chosen]
                # Basis and block are orthonormal, so that the norms follow from the coefficients.
                step = remainder @ mixture[begin:] / nu[chosen]
                norms = np.sqrt(1.0 + np.einsum("ij,ij->j", step, step))
                vectors = algebra.combined(addition.block, step / norms)
                algebra.subtract(vectors, basis[:, :size], -(mixture / norms))
                if responses is not None:
                    others = ranked[count:]
                    vibrating = shift, nu[others], mixtures[:, others]
                    responses.take(basis[:, :size], small[:size, :size], first, *vibrating, algebra)
                return shift + 1.0 / nu[chosen], vectors
        small[size : size + len(remainder), begin:size] = remainder
        small[begin:size, size : size + len(remainder)] = remainder.T
    raise IncompleteModesError(
        f"Lanczos did not converge to {count} modes with a basis of {size}; ask for fewer, move the limit a little or "
        "refine the mesh"
    )


class LoadResponses:
    """Responses of the discarded modes to some loads, which a search by block Lanczos finds in its Krylov space.

    Parameters
    ----------
    loads : ndarray, shape (n, r)
        F.
    orders : int
        Number of responses to each load.

    Attributes
    ----------
    found : list of ndarray, shape (n, r)
        The static response, to the accuracy of the space; then (K - σM)⁻¹ F and its derivatives by σ, each divided by
        the factorial of its order, which have parts of the kept modes, too. Empty before the search.
    """

    def __init__(self, loads: FloatArray, orders: int) -> None:
        self.loads, self._orders = loads, orders
        self.found: list[FloatArray] = []

    def take(
        self,
        basis: FloatArray,
        small: FloatArray,
        first: FloatArray,
        shift: float,
        nu: FloatArray,
        mixture: FloatArray,
        algebra: BlockAlgebra,
    ) -> None:
        """Combine the basis, with T and the ν and s of the discarded Ritz vectors; the first block is V g."""
        response = np.zeros((len(small), self.loads.shape[1]))
        response[: len(first)] = first[:, : self.loads.shape[1]]
        parts = [mixture @ ((mixture.T @ response) / (1.0 + shift * nu)[:, None])]
        for _ in range(self._orders - 1):
            parts.append(response)
            response = small @ response
        self.found = np.split(algebra.combined(basis, np.hstack(parts)), self._orders, axis=1)


@dataclass(frozen=True)
class Addition:
    """Extension of a basis of m vectors by a block.

    Attributes
    ----------
    block : ndarray, shape (n, r)
        M-orthonormal columns, orthogonal to the basis; r = 0 where the block lies in it.
    inertia : ndarray, shape (n, r)
        M times these, contiguous.
    projections : ndarray, shape (m + r, width)
        The block in terms of the basis and the new columns.
    """

    block: FloatArray
    inertia: FloatArray
    projections: FloatArray


def orthonormal(
    basis: FloatArray,
    block: FloatArray,
    mass: Operator,
    algebra: BlockAlgebra,
    *,
    recent: FloatArray | None = None,
) -> Addition:
    """Orthonormalise a block against an M-orthonormal basis V, in place.

    V is projected out twice; of the first time the products with the last vectors of the basis suffice where the block
    comes of a recurrence, which in exact arithmetic leaves the others out.

    Parameters
    ----------
    basis : ndarray, shape (n, m)
        V.
    block : ndarray, shape (n, width)
    mass : operator, shape (n, n)
    algebra : BlockAlgebra
    recent : ndarray, shape (n, r), optional
        M times the last r vectors of the basis.
    """
    within = np.zeros((basis.shape[1], block.shape[1]))
    last = slice(0 if recent is None else basis.shape[1] - recent.shape[1], None)
    within[last] = algebra.products(basis, mass @ block) if recent is None else algebra.products(recent, block)
    algebra.subtract(block, basis[:, last], within[last])
    again = algebra.products(basis, mass @ block)
    algebra.subtract(block, basis, again)
    within += again
    inertia = mass @ block
    products = algebra.products(block, inertia)
    left = np.sqrt(np.maximum(products.diagonal(), 0.0))
    norms = np.sqrt(np.einsum("ij,ij->j", within, within) + left**2)
    independent = left > _DEPENDENT * norms
    values, turn = np.linalg.eigh(
        products[np.ix_(independent, independent)] / np.outer(left[independent], left[independent])
    )
    mixture = np.zeros((block.shape[1], np.count_nonzero(values > _DEPENDENT_COLUMN_CORRELATION)))
    mixture[independent] = (
        turn[:, values > _DEPENDENT_COLUMN_CORRELATION]
        / np.sqrt(values[values > _DEPENDENT_COLUMN_CORRELATION])
        / left[independent, None]
    )
    new, new_inertia, shares = (
        algebra.combined(block, mixture),
        algebra.combined(inertia, mixture),
        mixture.T @ products,
    )
    if new.shape[1]:
        # Scaling up the remainder of a block that nearly lay in the basis scales up its rounding: once more.
        if float(np.min(left[independent] / norms[independent])) < _NEARLY_WITHIN or values[0] < _NEARLY_WITHIN:
            algebra.subtract(new, basis, algebra.products(basis, new_inertia))
            new_inertia = mass @ new
            shares = algebra.products(new, inertia)
        gram = algebra.products(new, new_inertia)
        if np.abs(gram - np.eye(len(gram))).max() > _ORTHONORMAL:
            unit = np.linalg.inv(np.linalg.cholesky(gram)).T
            new, new_inertia = algebra.combined(new, unit), algebra.combined(new_inertia, unit)
            shares = algebra.products(new, inertia)
    return Addition(new, new_inertia, np.vstack([within, shares]))


Solver = Literal["lanczos", "eigsh", "slepc"]

DEFAULT_SOLVER: Solver = "lanczos"
"""At least 1.3 times faster than eigsh from factor to certificate, see benchmarks/README.md."""

_LEAST_BASIS = 20  # vectors, ARPACK's own least
_BASIS = 3  # vectors for each mode: with two, the default, restarts cost a third more


def arpack_modes(
    solve: Callable[[FloatArray], FloatArray],
    mass: Operator,
    shift: float,
    count: int,
    *,
    above: bool = False,
    seed: int = 0,
    tolerance: float = 0.0,
) -> tuple[FloatArray, FloatArray]:
    """Solve for the modes nearest to a shift on one side of it by ``scipy.sparse.linalg.eigsh`` (ARPACK).

    Values, vectors and errors are as of :func:`block_lanczos`.

    Parameters
    ----------
    solve, mass, shift, count, above
        As of :func:`block_lanczos`.
    seed : int
        Seed of the start vector; each also doubles the basis.
    tolerance : float
        Tolerance of a Ritz pair's residual as a part of ν; 0 is rounding.
    """
    n = mass.shape[0]
    start = solve(mass @ np.random.default_rng(seed).standard_normal(n))
    try:
        values, vectors = eigsh(
            LinearOperator((n, n), matvec=lambda x: x, dtype=np.float64),  # K itself is not used: OPinv stands for it
            k=count,
            M=LinearOperator((n, n), matvec=lambda x: mass @ x, dtype=np.float64),
            sigma=shift,
            which="SA" if above else "LA",
            v0=start,
            ncv=min(n, max(_BASIS * count, _LEAST_BASIS) * 2**seed),
            tol=tolerance,
            OPinv=LinearOperator((n, n), matvec=solve, dtype=np.float64),
        )
    except ArpackError as error:
        raise IncompleteModesError(
            f"eigsh did not converge to {count} modes ({error}); ask for fewer, move the limit a little or refine the "
            "mesh"
        ) from error
    order = np.argsort(values)
    return values[order], np.asfortranarray(vectors[:, order])


def nearest_modes(
    solver: Solver,
    solve: Callable[[FloatArray], FloatArray],
    mass: Operator,
    shift: float,
    count: int,
    *,
    above: bool = False,
    seed: int = 0,
    threads: int = 1,
    tolerance: float | None = None,
    responses: LoadResponses | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Choose the eigensolver by its name, and find the modes nearest to a shift on one side of it.

    Values, vectors and errors are as of :func:`block_lanczos`.

    Parameters
    ----------
    solver : {"lanczos", "eigsh"}
        :func:`block_lanczos` or scipy's ``eigsh`` (:func:`arpack_modes`).
    solve, mass, shift, count, above, seed, threads
        As :func:`block_lanczos`; ``eigsh`` has one thread beside those of ``solve``.
    tolerance : float, optional
        Residual of a Ritz pair as a part of ν; by default the finest that the solver has.
    responses : LoadResponses, optional
        As :func:`block_lanczos`; ``eigsh`` finds none.
    """
    if solver == "eigsh":
        return arpack_modes(solve, mass, shift, count, above=above, seed=seed, tolerance=tolerance or 0.0)
    tolerance = TOLERANCE if tolerance is None else tolerance
    return block_lanczos(
        solve, mass, shift, count, above=above, seed=seed, threads=threads, tolerance=tolerance, responses=responses
    )
