"""The factorisation of a sparse symmetric matrix as an object: factor once, solve many, know the inertia."""

import time
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import splu

from housing.errors import FactorizationError

FloatArray = npt.NDArray[np.float64]
Backend = Literal["rslab", "superlu"]

_RESIDUAL_BOUND = 1e-8
_ERROR_BOUND = 1e-2  # of a solution: 1e-8 is usual, and a singular matrix gives 1 and more


@dataclass(frozen=True)
class Factorization:
    """A = L D Lᵀ.

    Attributes
    ----------
    backend : {"rslab", "superlu"}
    size : int
        Order of the matrix.
    fill : int
        Entries of the factor.
    negative : int
        Negative eigenvalues of A. By Sylvester's law of inertia, for A = K - σM this is the number of
        eigenvalues of (K, M) below σ.
    seconds : float
        Time taken by the factorisation [s].
    """

    backend: Backend
    size: int
    fill: int
    negative: int
    seconds: float
    _handle: Any

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve A x = b for one or many right-hand sides, shape (n,) or (n, m)."""
        if self.backend == "superlu" or right.ndim == 1:
            return np.asarray(self._handle.solve(np.ascontiguousarray(right)))
        return np.asarray(self._handle.solve_many(np.ascontiguousarray(right)))


class Factorizer:
    """Factors matrices of one sparsity pattern; the ordering is found once and used again.

    Parameters
    ----------
    pattern : scipy.sparse.csr_array, shape (n, n)
        Any symmetric matrix of the pattern.
    backend : {"rslab", "superlu"}, optional
        rslab where it can be imported, else SuperLU in symmetric mode (about three times slower).
    threads : int
        Workers of rslab's factorisation.
    """

    def __init__(self, pattern: sparse.csr_array, *, backend: Backend | None = None, threads: int = 2) -> None:
        self.backend: Backend = backend or default_backend()
        self.threads = threads
        self._pattern = pattern

    @cached_property
    def _symbolic(self) -> Any:
        import rslab

        return rslab.analyze(sparse.csc_matrix(self._pattern), path="ldlt", threads=self.threads)

    def factor(self, matrix: sparse.csr_array) -> Factorization:
        """Factor a matrix and check that the factor solves.

        Raises
        ------
        FactorizationError
            Where the matrix is singular to working precision, or a solution leaves a relative residual above 1e-8.
        """
        start = time.perf_counter()
        try:
            if self.backend == "rslab":
                handle = self._symbolic.factor(sparse.csc_matrix(matrix))
                negative, fill = int(handle.inertia[1]), int(handle.factor_nnz)
            else:
                handle, negative = _superlu(matrix)
                fill = int(handle.L.nnz)
        except RuntimeError as error:
            raise FactorizationError(
                f"{self.backend} could not factor a matrix of order {matrix.shape[0]}: {error}. The shift may sit on "
                "an eigenvalue, or a part of the housing may be free"
            ) from error
        factor = Factorization(
            backend=self.backend,
            size=matrix.shape[0],
            fill=fill,
            negative=negative,
            seconds=time.perf_counter() - start,
            _handle=handle,
        )
        _check(factor, matrix)
        return factor


def default_backend() -> Backend:
    """rslab where it can be imported, else SuperLU."""
    try:
        import rslab  # noqa: F401
    except ImportError:
        return "superlu"
    return "rslab"


def _superlu(matrix: sparse.csr_array) -> tuple[Any, int]:
    """SuperLU without row exchanges, so that the signs of U's diagonal are the inertia."""
    handle = splu(
        sparse.csc_matrix(matrix),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    if not np.array_equal(handle.perm_r, handle.perm_c):
        raise RuntimeError("a pivot vanished and rows were exchanged, so the factor is not symmetric")
    return handle, int(np.count_nonzero(handle.U.diagonal() < 0.0))


def _check(factor: Factorization, matrix: sparse.csr_array) -> None:
    """Solve for a known vector; a factor that cannot is refused."""
    known = np.random.default_rng(0).standard_normal(factor.size)
    right = matrix @ known
    found = factor.solve(right)
    residual = float(np.linalg.norm(matrix @ found - right) / np.linalg.norm(right))
    # A singular matrix leaves a small residual as well, but its null space stands in the solution.
    error = float(np.linalg.norm(found - known) / np.linalg.norm(known))
    if not (residual < _RESIDUAL_BOUND and error < _ERROR_BOUND):
        raise FactorizationError(
            f"the factor of {factor.backend} leaves a residual of {residual:.1e} and an error of {error:.1e}, bounds "
            f"{_RESIDUAL_BOUND:.0e} and {_ERROR_BOUND:.0e}; the matrix is singular or nearly so: try another shift or "
            "the other backend"
        )
