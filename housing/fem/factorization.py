"""Sparse LDLᵀ factorisation of a symmetric matrix as an object: factor once, solve many, read the inertia.

Two direct solvers, rslab and SuperLU, have one interface. Both factor a symmetric matrix that need not be definite,
from its lower triangle, and report its inertia. Work that would exceed the available memory is refused beforehand.
"""

import importlib
import os
import sys
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from queue import SimpleQueue
from typing import Any, Literal, Protocol

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from gearwhine.housing.errors import FactorizationError
from gearwhine.housing.fem.linear_algebra import SymmetricMatrix
from gearwhine.numerics.arrays import FloatArray


def available_memory(*, system: Path = Path("/")) -> float:
    """Memory that this process can still allocate: the least of the machine's, its control group's and its own limit.

    The machine's is MemAvailable and SwapFree of ``/proc/meminfo``; the group's, of a container or a batch job, is the
    limit of the control group less its use without files that can be dropped; its own is RLIMIT_AS less the address
    space in use. A limit that the system does not report is infinite.

    Parameters
    ----------
    system : path
        Root of the file system that has ``proc`` and ``sys``.

    Returns
    -------
    float
        Memory [bytes], not negative.
    """
    return max(min(_machine(system), _group(system), _own_limit(system)), 0.0)


def check_memory(needed: float, task: str) -> None:
    """Refuse work that needs more memory than is available.

    Parameters
    ----------
    needed : float
        Memory needed [bytes].
    task : str
        Subject of the message's sentence.

    Raises
    ------
    MemoryError
        Where less than that is available; the message says both and what to do.
    """
    available = available_memory()
    if needed > available:
        raise MemoryError(
            f"{task} needs {needed / 1e9:.2g} GB of memory, and {available / 1e9:.2g} GB are available; "
            "a larger mesh_size needs less"
        )


def _machine(system: Path) -> float:
    entries = _entries(system / "proc" / "meminfo")
    return 1024.0 * (entries.get("MemAvailable:", float("inf")) + entries.get("SwapFree:", 0.0))


def _group(system: Path) -> float:
    """Memory left to the nearest control group and those around it, in version 1 or 2 of the kernel's files."""
    least = float("inf")
    for line in _lines(system / "proc" / "self" / "cgroup"):
        number, controllers, name = line.strip().split(":", 2)
        if number == "0":
            top, limit, use, cache = system / "sys/fs/cgroup", "memory.max", "memory.current", "inactive_file"
        elif "memory" in controllers.split(","):
            top, limit, use = system / "sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes"
            cache = "total_inactive_file"
        else:
            continue
        place = top / name.lstrip("/")
        for folder in (place, *place.parents):
            most, usage = _number(folder / limit), _number(folder / use)
            if most is not None and usage is not None:
                least = min(least, most - usage + _entries(folder / "memory.stat").get(cache, 0.0))
            if folder == top:
                break
    return least


def _own_limit(system: Path) -> float:
    try:
        import resource
    except ImportError:  # no such limits on this system
        return float("inf")
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return float("inf")
    pages = next(iter(_lines(system / "proc" / "self" / "statm")), "0").split()[0]
    return float(limit - int(pages) * os.sysconf("SC_PAGE_SIZE"))


def _entries(path: Path) -> dict[str, float]:
    """Name and number of each line."""
    pairs = (line.split() for line in _lines(path))
    return {pair[0]: float(pair[1]) for pair in pairs if len(pair) > 1 and pair[1].isdigit()}


def _number(path: Path) -> float | None:
    text = "".join(_lines(path)).strip()
    return float(text) if text.isdigit() else None


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="ascii", errors="replace").splitlines()
    except OSError:
        return []


class NumericFactor(Protocol):
    """The factor of one matrix."""

    @property
    def fill(self) -> int:
        """Number of entries of the factor."""

    @property
    def negative(self) -> int:
        """Number of negative eigenvalues of the matrix."""

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve for contiguous right-hand sides, shape (n,) or (n, m)."""


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
        """Do nothing: SuperLU orders each matrix anew."""

    def factor(self, matrix: SymmetricMatrix) -> "_SuperluFactor":
        """Factor a matrix."""
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


Backend = Literal["rslab", "superlu"]

_RESIDUAL_BOUND = 1e-8
_ERROR_BOUND = 1e-2  # error of a solution: 1e-8 is usual, and a singular matrix gives 1 and more


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
            numeric = self._solver.factor(matrix)
        except RuntimeError as error:
            raise FactorizationError(
                f"{self.backend} could not factor a matrix of order {matrix.shape[0]}: {error}. The shift may sit on "
                "an eigenvalue, or a part of the housing may be free"
            ) from error
        factor = Factorization(
            backend=self.backend,
            size=matrix.shape[0],
            fill=numeric.fill,
            negative=numeric.negative,
            seconds=time.perf_counter() - start,
            _factor=numeric,
        )
        _check(factor, matrix)
        return factor


def default_backend() -> Backend:
    """Return the name of the default solver: rslab where it can be imported, else SuperLU."""
    return "rslab" if can_import("rslab") else "superlu"


def _check(factor: Factorization, matrix: SymmetricMatrix) -> None:
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
