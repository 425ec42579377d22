"""Sparse LDLᵀ factorisation of a symmetric matrix as an object: factor once, solve many, read the inertia."""

import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
import numpy.typing as npt
from scipy import sparse

from housing.errors import FactorizationError
from housing.solvers import NumericFactor, RslabSolver, SuperluSolver, can_import
from housing.symmetric import SymmetricMatrix

FloatArray = npt.NDArray[np.float64]
Backend = Literal["rslab", "superlu"]

_RESIDUAL_BOUND = 1e-8
_ERROR_BOUND = 1e-2  # of a solution: 1e-8 is usual, and a singular matrix gives 1 and more


class _Solver(Protocol):
    """A sparse solver that knows the pattern of the matrices to come."""

    def order(self, matrix: SymmetricMatrix) -> None: ...

    def factor(self, matrix: SymmetricMatrix) -> NumericFactor: ...


@dataclass(frozen=True)
class Factorization:
    """The factor of a symmetric matrix, A = L D Lᵀ.

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
        Time taken by the factorisation [s]; the first of a :class:`Factorizer` includes the rest of the ordering.
    """

    backend: Backend
    size: int
    fill: int
    negative: int
    seconds: float
    _factor: NumericFactor

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve A x = b for one or many right-hand sides, shape (n,) or (n, m)."""
        return self._factor.solve(np.ascontiguousarray(right))


class Factorizer:
    """Factors matrices of one sparsity pattern; the ordering is found once and used again.

    Parameters
    ----------
    backend : {"rslab", "superlu"}, optional
        rslab where it can be imported, else SuperLU in symmetric mode, about ten times slower.
    threads : int
        Workers of the factorisation; SuperLU has one.

    Raises
    ------
    FactorizationError
        Where the backend asked for is not installed.
    """

    def __init__(self, *, backend: Backend | None = None, threads: int = 2) -> None:
        self.backend: Backend = backend or default_backend()
        self._solver: _Solver
        if self.backend == "superlu":
            self._solver = SuperluSolver()
        elif not can_import("rslab"):
            raise FactorizationError("the backend rslab needs the package rslab, which is not installed")
        else:
            self._solver = RslabSolver(threads)
        self._ordering: Future[None] | None = None

    def order_ahead(self, matrix: SymmetricMatrix) -> None:
        """Begin to find the ordering for matrices of this pattern in a background thread.

        The first call of :meth:`factor` waits for it.
        """
        pool = ThreadPoolExecutor(1)
        self._ordering = pool.submit(self._solver.order, matrix)
        pool.shutdown(wait=False)

    def factor(self, matrix: SymmetricMatrix | sparse.csr_array) -> Factorization:
        """Factor a matrix and check that the factor solves.

        Raises
        ------
        FactorizationError
            Where the matrix is singular to working precision, or a solution leaves a relative residual above 1e-8.
        MemoryError
            Where the factor needs more memory than is available; rslab estimates it before it allocates any.
        """
        if not isinstance(matrix, SymmetricMatrix):
            matrix = SymmetricMatrix.of(matrix)
        start = time.perf_counter()
        try:
            if self._ordering is not None:
                self._ordering.result()
            found = self._solver.factor(matrix)
        except RuntimeError as error:
            raise FactorizationError(
                f"{self.backend} could not factor a matrix of order {matrix.shape[0]}: {error}. The shift may sit on "
                "an eigenvalue, or a part of the housing may be free"
            ) from error
        factor = Factorization(
            backend=self.backend,
            size=matrix.shape[0],
            fill=found.fill,
            negative=found.negative,
            seconds=time.perf_counter() - start,
            _factor=found,
        )
        _check(factor, matrix)
        return factor


def default_backend() -> Backend:
    """rslab where it can be imported, else SuperLU."""
    return "rslab" if can_import("rslab") else "superlu"


def _check(factor: Factorization, matrix: SymmetricMatrix) -> None:
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
            "another backend"
        )
