"""Banded complex matrices in batches: LU factors, solutions, and null vectors of singular matrices.

All matrices of a batch share one pattern, given by the row and column of every entry. A matrix is kept by
rows, entry (i, j) at ``[i, j - i + lower]``, with ``lower`` more places on the right for the fill-in of partial
pivoting. The factors are those of Gaussian elimination, P A = L U, the multipliers in place; each row is followed only
to its last entry, which on a shaft is half of the band.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import ComplexArray

IntArray = npt.NDArray[np.intp]


@dataclass(frozen=True)
class BandPattern:
    """Sparsity pattern of a batch of banded matrices; several entries at one place add up.

    Attributes
    ----------
    rows, columns : ndarray of int, shape (nnz,)
        Row and column of each entry.
    order : int
        Order of the matrices.
    lower, upper : int
        Number of diagonals below and above the main one.
    """

    rows: IntArray
    columns: IntArray
    order: int
    lower: int
    upper: int

    @classmethod
    def of(cls, rows: IntArray, columns: IntArray, order: int) -> "BandPattern":
        """Return the pattern of the given entries, (nnz,) each."""
        offset = rows - columns
        return cls(
            np.ascontiguousarray(rows, dtype=np.intp),
            np.ascontiguousarray(columns, dtype=np.intp),
            order,
            max(int(offset.max()), 0),
            max(int(-offset.min()), 0),
        )

    @cached_property
    def envelope(self) -> IntArray:
        """Last row with an entry in the columns up to k, and last column of row k, for every k, (order, 2)."""
        first, last = np.arange(self.order), np.arange(self.order)
        np.minimum.at(first, self.rows, self.columns)
        np.maximum.at(last, self.rows, self.columns)
        deepest = np.arange(self.order)
        np.maximum.at(deepest, first, np.arange(self.order))
        return np.stack([np.maximum.accumulate(deepest), last], axis=1)

    @property
    def arrays(self) -> tuple[IntArray, IntArray, IntArray, int, int]:
        """The pattern as compiled functions take it."""
        return self.rows, self.columns, self.envelope, self.lower, self.upper

    def solve(self, values: ComplexArray, sides: ComplexArray) -> ComplexArray:
        """Solutions of A x = sides, (b, k, order) both; the matrices from values (b, nnz)."""
        from gearwhine.numerics import banded_kernels as kernels

        solved = np.array(sides, dtype=np.complex128, order="C")
        kernels.solve(*self.arrays, values, solved)
        return solved

    def null_vectors(self, values: ComplexArray, start: ComplexArray, rounds: int) -> tuple[ComplexArray, ComplexArray]:
        """Right and left singular vectors of the k smallest singular values, (b, k, order), orthonormal rows.

        Found by ``rounds`` of inverse iteration, x ← A⁻¹A⁻ᴴx, from the right vectors ``start`` (b, k, order).
        """
        from gearwhine.numerics import banded_kernels as kernels

        right = np.array(start, dtype=np.complex128, order="C")
        left = np.empty_like(right)
        kernels.null_vectors(*self.arrays, values, right, left, rounds)
        return right, left

    def forms(self, values: ComplexArray, left: ComplexArray, right: ComplexArray) -> ComplexArray:
        """Small matrices Lᴴ A R, (b, k, k), of vectors (b, k, order)."""
        from gearwhine.numerics import banded_kernels as kernels

        return np.asarray(kernels.forms(self.rows, self.columns, values, left, right))
