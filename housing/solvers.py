"""The sparse direct solvers behind :mod:`housing.factorization`, each told the same way.

All of them factor a symmetric matrix that need not be definite, from its lower triangle, and know its inertia.
"""

from importlib.util import find_spec
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt
from scipy.sparse.linalg import splu

from housing.memory import check_memory
from housing.symmetric import SymmetricMatrix

FloatArray = npt.NDArray[np.float64]

_PARDISO_INDEFINITE = -2  # real, symmetric, not definite
_PARDISO_FACTOR, _PARDISO_SOLVE, _PARDISO_RELEASE = 12, 33, -1
# What PARDISO reports, numbered from one as in its manual.
_PERTURBED, _FILL, _POSITIVE, _NEGATIVE = 14, 18, 22, 23


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


class PardisoSolver:
    """PARDISO of Intel's Math Kernel Library, through pypardiso."""

    def __init__(self, threads: int) -> None:
        self._threads = threads

    def order(self, matrix: SymmetricMatrix) -> None:
        """Nothing: pypardiso orders each matrix anew."""

    def factor(self, matrix: SymmetricMatrix) -> "_PardisoFactor":
        """Factor."""
        return _PardisoFactor(matrix, self._threads)


class _PardisoFactor:
    def __init__(self, matrix: SymmetricMatrix, threads: int) -> None:
        import pypardiso

        # The lower triangle by columns is the upper one by rows, which is what PARDISO reads.
        self._upper = matrix.lower.T.tocsr()
        self._library = pypardiso.PyPardisoSolver(mtype=_PARDISO_INDEFINITE)
        # pypardiso has no word for it; the library's own counts for whoever uses it in this process.
        self._library.libmkl.MKL_Set_Num_Threads(threads)
        for report in (_FILL, _POSITIVE, _NEGATIVE):
            self._library.iparm[report - 1] = -1  # asks for it
        self._call(_PARDISO_FACTOR, np.zeros(matrix.shape[0]))
        told = {report: int(self._library.get_iparm(report)) for report in (_PERTURBED, _FILL, _POSITIVE, _NEGATIVE)}
        if told[_PERTURBED] or told[_POSITIVE] + told[_NEGATIVE] != matrix.shape[0]:
            self.release()
            raise RuntimeError(f"{told[_PERTURBED]} pivots vanished and were replaced, so that the inertia is unknown")
        self.negative, self.fill = told[_NEGATIVE], told[_FILL]

    def solve(self, right: FloatArray) -> FloatArray:
        return self._call(_PARDISO_SOLVE, right if right.ndim == 1 else np.asfortranarray(right))

    def _call(self, phase: int, right: FloatArray) -> FloatArray:
        import pypardiso

        self._library.set_phase(phase)
        try:
            return np.asarray(self._library._call_pardiso(self._upper, right))
        except pypardiso.PyPardisoError as error:
            raise RuntimeError(str(error)) from error

    def release(self) -> None:
        """Give back the library's memory."""
        self._call(_PARDISO_RELEASE, np.zeros(self._upper.shape[0]))

    def __del__(self) -> None:
        if hasattr(self, "_upper"):
            self.release()
