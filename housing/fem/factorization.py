"""Sparse LDLᵀ factorisation of a symmetric matrix as an object: factor once, solve many, read the inertia.

Two direct solvers, rslab and SuperLU, have one interface. Both factor a symmetric matrix that need not be definite,
from its lower triangle, and report its inertia. Work that would exceed the available memory is refused beforehand.

A factor in single precision takes half the memory of one in double. Its solutions are refined in double precision,

    x ← x + F⁻¹ (b - A x),        F = A + E,

with F the matrix of which the factor is exact and E its backward error, and so are as accurate as those of a factor in
double. Its inertia is that of F. That this is the inertia of A too is proved by the refinement itself: on the way from
F to A, as F - tE for t from 0 to 1, an eigenvalue changes its sign only where the matrix is singular, which is where
the refinement's matrix

    G = F⁻¹ E = I - F⁻¹ A

has the real eigenvalue 1/t ≥ 1. With yᵀ its left eigenvector, the error e of a refinement from x = 0 keeps at least
its part along y: |yᵀ e_k| = t⁻ᵏ |yᵀ e_0| ≥ |yᵀ e_0|. For a known solution of independent standard normal numbers,
yᵀ e_0 / |y| is a standard normal number itself, so that an error is as small as |e_k| with a probability of at most
√(2/π) |e_k|, and those of m independent columns with the product of these. This product, for a refinement that was
carried out, bounds the probability of an inertia that is not A's. A norm of E says less: it would need a gap between
the shift and the modes that single precision never leaves on a fine mesh.
"""

import importlib
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from importlib.util import find_spec
from queue import SimpleQueue
from typing import Any, Literal, Protocol

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import splu

from gearwhine.housing.errors import FactorizationError
from gearwhine.housing.fem.linear_algebra import FactorableMatrix, Operator, Precision, SymmetricMatrix
from gearwhine.housing.fem.memory import available_memory, check_memory
from gearwhine.numerics.arrays import FloatArray


class NumericFactor(Protocol):
    """The factor of one matrix."""

    @property
    def fill(self) -> int:
        """Number of entries of the factor."""

    @property
    def negative(self) -> int:
        """Number of negative eigenvalues of the matrix."""

    def solve(self, right: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Solve for contiguous right-hand sides, shape (n,) or (n, m), in the precision of the factor."""


def can_import(module: str) -> bool:
    """Whether a module is installed; it is not imported."""
    return find_spec(module) is not None


_RSLAB = threading.Lock()


def _load_rslab() -> Any:
    """Import rslab in a thread that lasts as long as the process.

    Where the thread that loads the library ends, the process crashes at the library's next call (1.7.0): a thread other
    than the main one, which may be a caller's or one that finds an ordering, leaves that to a thread that never ends.
    """
    with _RSLAB:
        if threading.current_thread() is not threading.main_thread() and "rslab" not in sys.modules:
            done: SimpleQueue[BaseException | None] = SimpleQueue()
            threading.Thread(target=_import_and_stay, args=("rslab", done), name="rslab", daemon=True).start()
            if (error := done.get()) is not None:
                raise error
    return importlib.import_module("rslab")


def _import_and_stay(module: str, done: "SimpleQueue[BaseException | None]") -> None:
    """Import a module, report the error that this raised or None, and wait for ever."""
    try:
        importlib.import_module(module)
    except BaseException as error:
        done.put(error)
    else:
        done.put(None)
        threading.Event().wait()


class RslabSolver:
    """rslab: supernodal L D Lᵀ with pivots of order 1 and 2 (Bunch and Kaufman 1977), by threads."""

    def __init__(self, threads: int) -> None:
        self._analyze = _load_rslab().analyze
        self._threads = threads
        self._symbolic: Any = None

    def order(self, matrix: FactorableMatrix) -> None:
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

    def forget(self) -> None:
        """Give up the ordering."""
        self._symbolic = None

    def memory(self, matrix: FactorableMatrix, precision: Precision) -> float:
        """Memory that a factor and its solutions take, beside that of the ordering, which is found if need be."""
        if self._symbolic is None:
            self.order(matrix)
        plan = self._symbolic.memory_plan(dtype=_KINDS[precision].__name__, nrhs=_COLUMNS)
        return float(plan["factor_peak_bytes"])

    def factor(self, matrix: FactorableMatrix, precision: Precision) -> "_RslabFactor":
        """Factor in the ordering found, or in the first matrix's."""
        if self._symbolic is None:
            self.order(matrix)
        kind = _KINDS[precision]
        return _RslabFactor(self._symbolic.factor(matrix.entries(kind)), kind)


class _RslabFactor:
    def __init__(self, handle: Any, kind: type) -> None:
        self._handle, self._kind = handle, kind
        self.negative, self.fill = int(handle.inertia[1]), int(handle.factor_nnz)

    def solve(self, right: npt.NDArray[Any]) -> FloatArray:
        solve = self._handle.solve if right.ndim == 1 else self._handle.solve_many
        return np.asarray(solve(right.astype(self._kind, copy=False)))


class SuperluSolver:
    """scipy's SuperLU without row exchanges, so that the signs of U's diagonal are the inertia."""

    def order(self, matrix: FactorableMatrix) -> None:
        """Do nothing: SuperLU orders each matrix anew."""

    def forget(self) -> None:
        """Do nothing, as there is no ordering to give up."""

    def memory(self, matrix: FactorableMatrix, precision: Precision) -> float:
        """Return 0: SuperLU does not foresee its memory."""
        return 0.0

    def factor(self, matrix: FactorableMatrix, precision: Precision) -> "_SuperluFactor":
        """Factor a matrix, in double precision."""
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

    def solve(self, right: npt.NDArray[Any]) -> FloatArray:
        return np.asarray(self._handle.solve(right))


Backend = Literal["rslab", "superlu"]

_KINDS: dict[Precision, type] = {"double": np.float64, "single": np.float32}
_VECTORS_BESIDE = 200  # vectors in double precision beside the factor: those of a search for modes
_COLUMNS = 8  # solved at once
_MISCOUNT = 1e-15  # probability of a wrong inertia that is let pass
_REFINEMENTS = 40
_CONVERGING = 0.7  # part of an error that a refinement leaves at most, while it converges
_REFINED = 1e-14  # last correction, as a part of the solution
_UNREFINED = 1e-9  # the same, where rounding ends the refinement
_RESIDUAL_BOUND = 1e-8
_ERROR_BOUND = 1e-2  # error of a solution: 1e-8 is usual, and a singular matrix gives 1 and more


class _Solver(Protocol):
    """A sparse solver that knows the pattern of the matrices to come."""

    def order(self, matrix: FactorableMatrix) -> None: ...

    def forget(self) -> None: ...

    def memory(self, matrix: FactorableMatrix, precision: Precision) -> float: ...

    def factor(self, matrix: FactorableMatrix, precision: Precision) -> NumericFactor: ...


class UnprovedInertiaError(FactorizationError):
    """The inertia of a factor in single precision is not proved to be the matrix's."""


@dataclass(frozen=True)
class Factorization:
    """The factor of a symmetric matrix, A = L D Lᵀ.

    Attributes
    ----------
    backend : str
        Name of the solver.
    precision : {"double", "single"}
        Precision of the factor; solutions are in double precision in any case.
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

    backend: str
    precision: Precision
    size: int
    fill: int
    negative: int
    seconds: float
    _factor: NumericFactor
    _matrix: Operator | None = field(default=None, repr=False)  # A, where solutions are refined

    @property
    def name(self) -> str:
        """Name of the solver, with the precision where that is not double."""
        return self.backend if self.precision == "double" else f"{self.backend}, {self.precision} precision"

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve A x = b for one or many right-hand sides, shape (n,) or (n, m).

        Raises
        ------
        FactorizationError
            Where the refinement of a factor in single precision does not converge.
        """
        right = np.ascontiguousarray(right)
        if self._matrix is None:
            return self._factor.solve(right)
        solution = np.zeros_like(right)
        left, last = right, np.inf
        for _ in range(_REFINEMENTS):
            correction = self.solve_approximately(left)
            solution += correction
            sizes = np.linalg.norm(solution, axis=0)
            change = float(np.max(np.linalg.norm(correction, axis=0) / np.where(sizes > 0.0, sizes, 1.0)))
            if change < _REFINED or _CONVERGING * last < change < _UNREFINED:
                return solution
            if not change < 2.0 * last:
                break
            left, last = right - self._matrix @ solution, change
        raise FactorizationError(
            f"the refinement of solutions from a factor in single precision stops at corrections of {change:.1e}; "
            "move the limit a little, or give more memory, which a factor in double precision needs"
        )

    def solve_approximately(self, right: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Solve F x = b in the precision of the factor, without refinement; b in single precision gives such an x."""
        right = np.ascontiguousarray(right)
        if self.precision == "double" or right.dtype == np.float32:
            return self._factor.solve(right)
        # Small numbers in double precision may be none in single.
        scale = np.maximum(right.max(axis=0), -right.min(axis=0))
        scale = np.where(scale > 0.0, scale, 1.0)
        scaled = np.divide(right, scale, out=np.empty(right.shape, np.float32), casting="same_kind")
        return np.asarray(self._factor.solve(scaled) * scale)


class Factorizer:
    """Factors matrices of one sparsity pattern; the ordering is found once and used again.

    Parameters
    ----------
    backend : {"rslab", "superlu"}, optional
        rslab where it can be imported, else SuperLU in symmetric mode, about ten times slower.
    precision : {"double", "single"}, optional
        By default double, and single where a factor in double precision does not fit in the available memory. A factor
        in single precision whose inertia is not proved is made again in double; SuperLU has double only.
    threads : int
        Workers of the factorisation; SuperLU has one.
    progress : callable
        Called with a line of text where the precision is not double, and why.

    Raises
    ------
    FactorizationError
        Where the backend asked for is not installed, or does not have the precision.
    """

    def __init__(
        self,
        *,
        backend: Backend | None = None,
        precision: Precision | None = None,
        threads: int = 2,
        progress: Callable[[str], None] = lambda message: None,
    ) -> None:
        self.backend: Backend = backend or default_backend()
        if precision not in (None, *_KINDS):
            raise FactorizationError(f"precision {precision!r}; expected one of {', '.join(map(repr, _KINDS))}")
        self._precision = precision
        self._progress = progress
        self._solver: _Solver
        if self.backend == "superlu":
            if precision == "single":
                raise FactorizationError("the backend superlu factors in double precision only; single needs rslab")
            self._solver = SuperluSolver()
        elif not can_import("rslab"):
            raise FactorizationError("the backend rslab needs the package rslab, which is not installed")
        else:
            self._solver = RslabSolver(threads)
        self._ordering: Future[None] | None = None

    def order_ahead(self, matrix: FactorableMatrix) -> None:
        """Begin to find the ordering for matrices of this pattern in a background thread.

        The first call of :meth:`factor` waits for it.
        """
        pool = ThreadPoolExecutor(1)
        self._ordering = pool.submit(self._solver.order, matrix)
        pool.shutdown(wait=False)

    def forget_ordering(self) -> None:
        """Give up the ordering, which is a tenth of the memory that a factor takes; a later factor finds it again."""
        self._solver.forget()

    def factor(self, matrix: FactorableMatrix | sparse.csr_array) -> Factorization:
        """Factor a matrix and check that the factor solves.

        Raises
        ------
        FactorizationError
            Where the matrix is singular to working precision, or a solution leaves a relative residual above 1e-8.
        MemoryError
            Where the factor needs more memory than is available; rslab estimates it before it allocates any.
        """
        if isinstance(matrix, sparse.csr_array):
            matrix = SymmetricMatrix.of(matrix)
        start = time.perf_counter()
        if self._ordering is not None:
            self._ordering.result()
            self._ordering = None  # with the matrix that it holds
        precision = self._precision or self._fitting(matrix)
        if precision == "double":
            return self._factored(matrix, precision, start)
        try:
            return self._factored(matrix, precision, start)
        except FactorizationError as error:
            self._progress(f"{error}; factoring in double precision")
            try:
                return self._factored(matrix, "double", start)
            except MemoryError as too_large:
                raise MemoryError(f"{error}; {too_large}, or move the limit a little") from error

    def _fitting(self, matrix: FactorableMatrix) -> Precision:
        """Double precision, or single where the available memory is too small for it."""
        needed = self._solver.memory(matrix, "double") + 8.0 * _VECTORS_BESIDE * matrix.shape[0]
        available = available_memory()
        if self.backend == "superlu" or needed <= available:
            return "double"
        self._progress(
            "factoring in single precision, with proofs and refinement in double: a factor in double precision needs "
            f"{needed / 1e9:.2g} GB of memory, and {available / 1e9:.2g} GB are available"
        )
        return "single"

    def _factored(self, matrix: FactorableMatrix, precision: Precision, start: float) -> Factorization:
        # Where an allocation fails the library ends the process; so the need is foreseen, from the ordering.
        needed = self._solver.memory(matrix, precision)
        check_memory(needed, f"the factor of a matrix of order {matrix.shape[0]} in {precision} precision")
        try:
            numeric = self._solver.factor(matrix, precision)
        except RuntimeError as error:
            raise FactorizationError(
                f"{self.backend} could not factor a matrix of order {matrix.shape[0]}: {error}. The shift may sit on "
                "an eigenvalue, or a part of the housing may be free"
            ) from error
        return checked_factor(self.backend, numeric, matrix, time.perf_counter() - start, precision)


def checked_factor(
    backend: str, numeric: NumericFactor, matrix: FactorableMatrix, seconds: float, precision: Precision = "double"
) -> Factorization:
    """Check that a factor solves, and prove its inertia where it is in single precision.

    Raises
    ------
    FactorizationError
        Where it does not solve, or its inertia is not proved.
    """
    factor = Factorization(
        backend=backend,
        precision=precision,
        size=matrix.shape[0],
        fill=numeric.fill,
        negative=numeric.negative,
        seconds=seconds,
        _factor=numeric,
        _matrix=matrix if precision == "single" else None,
    )
    if precision == "single":
        _prove_inertia(factor, matrix)
    else:
        _check(factor, matrix)
    return factor


def default_backend() -> Backend:
    """Return the name of the default solver: rslab where it can be imported, else SuperLU."""
    return "rslab" if can_import("rslab") else "superlu"


def _check(factor: Factorization, matrix: FactorableMatrix) -> None:
    """Solve for a known vector; a factor that cannot is refused."""
    exact = np.random.default_rng(0).standard_normal(factor.size)
    right = matrix @ exact
    solution = factor.solve(right)
    residual = float(np.linalg.norm(matrix @ solution - right) / np.linalg.norm(right))
    # A singular matrix leaves a small residual as well, but its null space stands in the solution.
    error = float(np.linalg.norm(solution - exact) / np.linalg.norm(exact))
    if not (residual < _RESIDUAL_BOUND and error < _ERROR_BOUND):
        raise FactorizationError(
            f"the factor of {factor.backend} leaves a residual of {residual:.1e} and an error of {error:.1e}, bounds "
            f"{_RESIDUAL_BOUND:.0e} and {_ERROR_BOUND:.0e}; the matrix is singular or nearly so: try another shift or "
            "another backend"
        )


def _prove_inertia(factor: Factorization, matrix: FactorableMatrix) -> None:
    """Refine known solutions until a wrong inertia is as good as excluded; a factor that does not allow it is refused.

    The proof is that of the module's docstring, with eight columns.
    """
    exact = np.random.default_rng(0).standard_normal((factor.size, _COLUMNS))
    right = matrix @ exact
    left, solution, last = right, np.zeros_like(exact), np.inf
    for _ in range(_REFINEMENTS):
        solution += factor.solve_approximately(left)
        errors = np.linalg.norm(solution - exact, axis=0)
        if np.prod(np.sqrt(2.0 / np.pi) * errors) < _MISCOUNT:
            return
        if not errors.max() < _CONVERGING * last:
            break
        left, last = right - matrix @ solution, float(errors.max())
    raise UnprovedInertiaError(
        f"the inertia of a matrix of order {factor.size} is not proved by its factor in single precision, whose "
        f"refinement leaves an error of {errors.max() / np.sqrt(factor.size):.1e}"
    )
