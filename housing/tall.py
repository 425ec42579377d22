"""Block vectors: products of bases and blocks of vectors on all degrees of freedom."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

_SHARES = 4  # of the rows
_ROWS_WORTH_A_THREAD = 2**14  # rows: fewer are multiplied sooner than a thread starts


class BlockAlgebra:
    """Products of block vectors, matrices with many rows and few columns, by shares of their rows.

    The number of shares does not depend on the threads, so that sums over the rows are rounded alike.

    Parameters
    ----------
    rows : int
        Of all the matrices.
    threads : int
        Number of threads that multiply the shares; one where there are few rows.
    """

    def __init__(self, rows: int, threads: int) -> None:
        self._threads = min(threads, _SHARES) if rows > _ROWS_WORTH_A_THREAD else 1
        self._shares = [slice(rows * share // _SHARES, rows * (share + 1) // _SHARES) for share in range(_SHARES)]

    def products(self, left: FloatArray, right: FloatArray) -> FloatArray:
        """LᵀR, shape (columns of L, columns of R)."""
        return np.asarray(sum(self._each(lambda rows: left[rows].T @ right[rows])))

    def subtract(self, block: FloatArray, basis: FloatArray, parts: FloatArray) -> None:
        """Subtract B p from a block of columns, in place."""

        def take(rows: slice) -> None:
            block[rows] -= (parts.T @ basis[rows].T).T  # by columns, in half the time of basis[rows] @ parts

        self._each(take)

    def combined(self, block: FloatArray, mixture: FloatArray) -> FloatArray:
        """B m, shape (rows, columns of m)."""
        return np.concatenate(self._each(lambda rows: block[rows] @ mixture))

    def _each(self, work: Callable[[slice], Any]) -> list[Any]:
        if self._threads == 1:
            return [work(rows) for rows in self._shares]
        with ThreadPoolExecutor(self._threads) as pool:
            return list(pool.map(work, self._shares))
