"""Banded complex matrices in batches: factors, determinants, solutions, and the null vectors of singular ones.

All matrices of a batch share one pattern, given by the row and column of every entry. A matrix is kept by
rows, entry (i, j) at ``[i, j - i + lower]``, with ``lower`` more places on the right for what partial
pivoting fills in. The factors are those of Gaussian elimination, P A = L U, the multipliers in place.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]


@dataclass(frozen=True)
class BandPattern:
    """Where a batch of matrices has entries; several entries at one place add up.

    Attributes
    ----------
    rows, columns
        (nnz,).
    order
        Of the matrices.
    lower, upper
        How many diagonals lie below and above the main one.
    """

    rows: IntArray
    columns: IntArray
    order: int
    lower: int
    upper: int

    @classmethod
    def of(cls, rows: IntArray, columns: IntArray, order: int) -> "BandPattern":
        """The pattern of the given entries, (nnz,) each."""
        offset = rows - columns
        return cls(
            np.ascontiguousarray(rows, dtype=np.intp),
            np.ascontiguousarray(columns, dtype=np.intp),
            order,
            max(int(offset.max()), 0),
            max(int(-offset.min()), 0),
        )

    def determinants(self, values: ComplexArray) -> tuple[FloatArray, ComplexArray]:
        """Logarithm of the modulus (b,) and the phase factor (b,), of modulus one, of every determinant."""
        from . import banded_kernels as kernels

        logarithms, phases = kernels.determinants(self.rows, self.columns, self.order, self.lower, self.upper, values)
        return np.asarray(logarithms), np.asarray(phases)

    def solve(self, values: ComplexArray, sides: ComplexArray) -> ComplexArray:
        """Solutions of A x = sides, (b, k, order) both; the matrices from values (b, nnz)."""
        from . import banded_kernels as kernels

        solved = np.array(sides, dtype=np.complex128, order="C")
        kernels.solve(self.rows, self.columns, self.order, self.lower, self.upper, values, solved)
        return solved

    def null_vectors(self, values: ComplexArray, start: ComplexArray, rounds: int) -> tuple[ComplexArray, ComplexArray]:
        """Right and left singular vectors of the k smallest singular values, (b, k, order), orthonormal rows.

        Found by ``rounds`` of inverse iteration, x ← A⁻¹A⁻ᴴx, from the right vectors ``start`` (b, k, order).
        """
        from . import banded_kernels as kernels

        right = np.array(start, dtype=np.complex128, order="C")
        left = np.empty_like(right)
        kernels.null_vectors(self.rows, self.columns, self.order, self.lower, self.upper, values, right, left, rounds)
        return right, left

    def forms(self, values: ComplexArray, left: ComplexArray, right: ComplexArray) -> ComplexArray:
        """Small matrices Lᴴ A R, (b, k, k), of vectors (b, k, order)."""
        from . import banded_kernels as kernels

        return np.asarray(kernels.forms(self.rows, self.columns, values, left, right))
