"""Sparse direct solvers behind :mod:`housing.factorization`: rslab and SuperLU with one interface.

Both factor a symmetric matrix that need not be definite, from its lower triangle, and report its inertia.
"""

from importlib.util import find_spec
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt
from scipy.sparse.linalg import splu

from housing.memory import check_memory
from housing.symmetric import SymmetricMatrix

FloatArray = npt.NDArray[np.float64]


class NumericFactor(Protocol):
    """The factor of one matrix."""

    @property
    def fill(self) -> int:
        """Entries."""

    @property
    def negative(self) -> int:
        """Negative eigenvalues of the matrix."""

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve for contiguous right-hand sides, shape (n,) or (n, m)."""


def can_import(module: str) -> bool:
    """Whether a module is installed; it is not imported."""
    return find_spec(module) is not None


class RslabSolver:
    """rslab: supernodal L D Lᵀ with pivots of order 1 and 2 (Bunch and Kaufman 1977), by threads."""

    def __init__(self, threads: int) -> None:
        # Loaded here, not by a thread that finds an ordering: where the thread that loads the library ends, the
        # process crashes at the library's next call (1.7.0).
        import rslab

        self._analyze = rslab.analyze
        self._threads = threads
        self._symbolic: Any = None

    def order(self, matrix: SymmetricMatrix) -> None:
        """Find the ordering."""
        # Nested dissection outright: by default several orderings are tried, and on solids it always wins. Its
        # refinement gives up sooner than by default: a third of its time for no more fill.
        self._symbolic = self._analyze(
            matrix.lower,
            path="ldlt",
            threads=self._threads,
            ordering="metis",
            nd_move_limit=100,
            nd_init_trials=4,
        )

    def factor(self, matrix: SymmetricMatrix) -> "_RslabFactor":
        """Factor in the ordering found, or in the first matrix's."""
        if self._symbolic is None:
            self.order(matrix)
        # Where an allocation fails the library ends the process; so the need is foreseen, from the ordering.
        estimate = self._symbolic.estimate_memory()
        check_memory(estimate["transient_peak_bytes"], f"the factor of a matrix of order {matrix.shape[0]}")
        return _RslabFactor(self._symbolic.factor(matrix.values))


class _RslabFactor:
    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self.negative, self.fill = int(handle.inertia[1]), int(handle.factor_nnz)

    def solve(self, right: FloatArray) -> FloatArray:
        return np.asarray(self._handle.solve(right) if right.ndim == 1 else self._handle.solve_many(right))


class SuperluSolver:
    """scipy's SuperLU without row exchanges, so that the signs of U's diagonal are the inertia."""

    def order(self, matrix: SymmetricMatrix) -> None:
        """Nothing: SuperLU orders each matrix anew."""

    def factor(self, matrix: SymmetricMatrix) -> "_SuperluFactor":
        """Factor."""
        handle = splu(
            matrix.full(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        if not np.array_equal(handle.perm_r, handle.perm_c):
            raise RuntimeError("a pivot vanished and rows were exchanged, so the factor is not symmetric")
        return _SuperluFactor(handle)


class _SuperluFactor:
    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self.negative, self.fill = int(np.count_nonzero(handle.U.diagonal() < 0.0)), int(handle.L.nnz)

    def solve(self, right: FloatArray) -> FloatArray:
        return np.asarray(self._handle.solve(right))
