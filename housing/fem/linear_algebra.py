"""Linear algebra of sparse symmetric matrices: storage by the lower triangle, and products of block vectors.

A sparse symmetric matrix is kept by its lower triangle, the form that factorisations take. Block vectors are bases and
blocks of vectors on all degrees of freedom; their products run on several threads, which are started once.
"""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from functools import cache, cached_property, partial
from itertools import pairwise
from typing import Any, Literal, Protocol, TypeVar

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.numerics.arrays import FloatArray

T = TypeVar("T")

Precision = Literal["double", "single"]
"""Precision of numbers: 8 bytes with 53 bits, or 4 bytes with 24 bits."""

_WORTH_A_THREAD = 2**22  # multiplications of one triangle: fewer are done sooner than a thread starts


@cache
def _pool() -> ThreadPoolExecutor:
    """Threads of the products: a solution takes hundreds of products, and a busy machine starts a thread slowly."""
    return ThreadPoolExecutor(thread_name_prefix="products")


if hasattr(os, "register_at_fork"):
    # A forked process has none of the threads.
    os.register_at_fork(after_in_child=_pool.cache_clear)


def at_once(tasks: Sequence[Callable[[], T]]) -> list[T]:
    """Run tasks at once, the first in the calling thread, and return their results in order.

    A task itself runs none at once: it would wait for threads that wait for it.
    """
    others = [_pool().submit(task) for task in tasks[1:]]
    try:
        results = [task() for task in tasks[:1]]
    finally:
        wait(others)  # even after an error: they write where the caller reads
    return results + [other.result() for other in others]


class Operator(Protocol):
    """Linear operator: anything that can be multiplied with vectors."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Rows and columns."""

    def __matmul__(self, vectors: FloatArray, /) -> FloatArray:
        """Multiply by one vector, shape (n,), or by many, shape (n, m)."""


class FactorableMatrix(Operator, Protocol):
    """Sparse symmetric matrix that can be assembled for a factorisation, and multiplied."""

    @property
    def lower(self) -> sparse.csc_array:
        """The lower triangle."""

    def full(self) -> sparse.csc_array:
        """Both triangles."""

    def entries(self, kind: type) -> npt.NDArray[Any]:
        """Entries of the lower triangle, of a type of numbers."""


@dataclass(frozen=True)
class SymmetricMatrix:
    """The lower triangle by columns, which is also the upper one by rows.

    Attributes
    ----------
    pointer : ndarray of int, shape (n + 1,)
        Place where each column begins. Of 32 bits as the rows are, unless there are more entries.
    rows : ndarray of int
        Ascending within a column, the diagonal first.
    values : ndarray
    threads : int
        Number of threads. With two, the lower and the upper triangle are multiplied at once; the products are the same
        to the last bit.
    """

    pointer: npt.NDArray[Any]
    rows: npt.NDArray[Any]
    values: FloatArray
    threads: int = 1

    @classmethod
    def of(cls, matrix: sparse.csr_array) -> "SymmetricMatrix":
        """Take the lower triangle of a matrix with both."""
        lower = sparse.csc_array(sparse.tril(matrix))
        lower.sum_duplicates()
        return cls(lower.indptr, lower.indices, lower.data)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns, (n, n)."""
        return len(self.pointer) - 1, len(self.pointer) - 1

    def diagonal(self) -> FloatArray:
        """Diagonal, shape (n,)."""
        return np.asarray(self.values[self.pointer[:-1]])

    @cached_property
    def lower(self) -> sparse.csc_array:
        """The lower triangle alone."""
        matrix = sparse.csc_array((self.values, self.rows, self.pointer), shape=self.shape)
        matrix.has_canonical_format = True
        return matrix

    def entries(self, kind: type) -> npt.NDArray[Any]:
        """Entries of the lower triangle, of a type of numbers."""
        return np.asarray(self.values.astype(kind, copy=False))

    def full(self) -> sparse.csc_array:
        """Both triangles."""
        return sparse.csc_array(self.lower + sparse.tril(self.lower, k=-1).T)

    def __matmul__(self, vectors: FloatArray) -> FloatArray:
        """Multiply the symmetric matrix by one vector, shape (n,), or by many, shape (n, m)."""
        diagonal = self.diagonal() if vectors.ndim == 1 else self.diagonal()[:, None]
        if self.threads > 1 and vectors.size * len(self.values) > _WORTH_A_THREAD * len(diagonal):
            lower = self.lower
            product, upper = at_once([lambda: np.asarray(lower @ vectors), lambda: np.asarray(lower.T @ vectors)])
            product += upper
        else:
            product = np.asarray(self.lower @ vectors)
            product += self.lower.T @ vectors
        product -= diagonal * vectors
        return product


_SHARES = 4  # shares into which the rows are divided
_ROWS_AT_ONCE = 2**12  # rows converted to double precision
_ROWS_WORTH_A_THREAD = 2**14  # rows: fewer are multiplied sooner than a thread starts


def _pieces(rows: slice, block: npt.NDArray[Any], precision: np.dtype[Any]) -> list[slice]:
    """Rows of a block, a few at a time where they are converted to the precision of a product."""
    if block.dtype == precision:
        return [rows]
    begins = range(rows.start, rows.stop, _ROWS_AT_ONCE)
    return [slice(begin, min(begin + _ROWS_AT_ONCE, rows.stop)) for begin in begins]


class BlockAlgebra:
    """Products of block vectors, matrices with many rows and few columns, by shares of their rows.

    A basis may be in single precision; sums and products are in the precision of its factor, unless another is given.

    The number of shares does not depend on the threads, so that sums over the rows are rounded alike.

    Parameters
    ----------
    rows : int
        Number of rows of all the matrices.
    threads : int
        Number of threads that multiply the shares; one where there are few rows.
    """

    def __init__(self, rows: int, threads: int) -> None:
        self.rows = rows
        self._threads = min(threads, _SHARES) if rows > _ROWS_WORTH_A_THREAD else 1
        self._shares = [slice(rows * share // _SHARES, rows * (share + 1) // _SHARES) for share in range(_SHARES)]

    def products(
        self, left: npt.NDArray[Any], *right: npt.NDArray[Any], kind: type[np.float64] | None = None
    ) -> npt.NDArray[Any]:
        """LᵀR, shape (columns of L, columns of R), in the precision of R or in double; of several R side by side."""
        precision = np.dtype(kind or right[0].dtype)

        def multiply(rows: slice) -> Any:
            total: Any = 0.0
            for few in _pieces(rows, left, precision):
                both = right[0][few] if len(right) == 1 else np.concatenate([one[few] for one in right], axis=1)
                total = total + np.asarray(left[few], dtype=precision).T @ np.asarray(both, dtype=precision)
            return total

        return np.asarray(sum(self._each(multiply)))

    def subtract(self, block: npt.NDArray[Any], basis: npt.NDArray[Any], parts: npt.NDArray[Any]) -> None:
        """Subtract B p from a block of columns, in place."""

        def take(rows: slice) -> None:
            for few in _pieces(rows, basis, parts.dtype):
                # One column after another: half the time of basis[few] @ parts.
                block[few] -= (parts.T @ np.asarray(basis[few], dtype=parts.dtype).T).T

        self._each(take)

    def combined(self, block: npt.NDArray[Any], mixture: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """B m, shape (rows, columns of m)."""
        result = np.empty((len(block), mixture.shape[1]), dtype=mixture.dtype)

        def multiply(rows: slice) -> None:
            for few in _pieces(rows, block, mixture.dtype):
                result[few] = np.asarray(block[few], dtype=mixture.dtype) @ mixture

        self._each(multiply)
        return result

    def replace(self, block: npt.NDArray[np.float32], mixture: FloatArray, fine: int) -> None:
        """Replace columns of B in single precision by B m, and further ones by 2²⁴ times what rounding took.

        The latter are those of the first ``fine`` columns, which with these are known in double precision.
        """

        def mix(rows: slice) -> None:
            for few in _pieces(rows, block, mixture.dtype):
                mixed = block[few].astype(np.float64) @ mixture
                block[few, : mixed.shape[1]] = mixed
                mixed[:, :fine] -= block[few, :fine]
                block[few, mixed.shape[1] : mixed.shape[1] + fine] = 2.0**24 * mixed[:, :fine]

        self._each(mix)

    def _each(self, work: Callable[[slice], T]) -> list[T]:
        def together(shares: list[slice]) -> list[T]:
            return [work(rows) for rows in shares]

        ends = [_SHARES * thread // self._threads for thread in range(self._threads + 1)]
        groups = at_once([partial(together, self._shares[begin:end]) for begin, end in pairwise(ends)])
        return [result for group in groups for result in group]
