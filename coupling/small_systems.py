"""Small dense linear systems, compiled: Gaussian elimination with row exchanges.

Importing this module imports numba.
"""

import numpy as np
import numpy.typing as npt

from rotors.compiled import inner

FloatArray = npt.NDArray[np.float64]


@inner()
def solve_in_place(matrix: FloatArray, right: FloatArray) -> None:
    """Gaussian elimination with row exchanges; the columns of ``right`` (n, k) become the solutions."""
    solve_part_in_place(matrix, right, right.shape[0], right.shape[1])


@inner()
def solve_part_in_place(matrix: FloatArray, right: FloatArray, n: int, columns: int) -> None:
    """The same for the first n rows and columns of a matrix and the first columns of ``right``."""
    for column in range(n):
        pivot = column
        for row in range(column + 1, n):
            if abs(matrix[row, column]) > abs(matrix[pivot, column]):
                pivot = row
        if pivot != column:
            for j in range(n):
                matrix[column, j], matrix[pivot, j] = matrix[pivot, j], matrix[column, j]
            for j in range(columns):
                right[column, j], right[pivot, j] = right[pivot, j], right[column, j]
        for row in range(column + 1, n):
            factor = matrix[row, column] / matrix[column, column]
            if factor == 0.0:
                continue
            for j in range(column, n):
                matrix[row, j] -= factor * matrix[column, j]
            for j in range(columns):
                right[row, j] -= factor * right[column, j]
    for row in range(n - 1, -1, -1):
        for other in range(row + 1, n):
            factor = matrix[row, other]
            if factor == 0.0:
                continue
            for j in range(columns):
                right[row, j] -= factor * right[other, j]
        for j in range(columns):
            right[row, j] /= matrix[row, row]
