"""Small dense linear algebra, compiled: Gaussian elimination with row exchanges, products with few rows.

Linear systems are as small as the number of contacts. Products with a few rows of a matrix are most of the arithmetic
of a time step. The functions are inlined, as passing their arrays would cost as much again.

Importing this module imports numba.
"""

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.compiled import inner

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

# Sums may be taken in any order, so that they vectorise; the compiled order is always the same.
SUMS = {"reassoc", "contract", "nsz"}


@inner(fastmath=SUMS, forceinline=True)
def project(rows: FloatArray, x: FloatArray, out: FloatArray) -> None:
    """Multiply a few rows (k, n) with x (n,) into ``out`` (k,)."""
    for j in range(rows.shape[0]):
        value = 0.0
        for i in range(rows.shape[1]):
            value += rows[j, i] * x[i]
        out[j] = value


@inner(fastmath=SUMS, forceinline=True)
def project_spans(rows: FloatArray, spans: IntArray, x: FloatArray, out: FloatArray) -> None:
    """Multiply rows (k, n) that are zero outside their spans (k, 2) with x (n,) into ``out`` (k,)."""
    for j in range(rows.shape[0]):
        row, part = rows[j, spans[j, 0] : spans[j, 1]], x[spans[j, 0] : spans[j, 1]]
        value = 0.0
        for i in range(row.size):
            value += row[i] * part[i]
        out[j] = value


@inner(fastmath=SUMS, forceinline=True)
def largest_row_sum(rows: FloatArray) -> float:
    """Largest sum of absolute values of a row."""
    largest = 0.0
    for j in range(rows.shape[0]):
        value = 0.0
        for i in range(rows.shape[1]):
            value += abs(rows[j, i])
        largest = max(largest, value)
    return largest


@inner(fastmath={"contract"}, forceinline=True)
def add_rows(rows: FloatArray, factors: FloatArray, sign: float, out: FloatArray) -> None:
    """Add as many rows as there are factors, each times its factor and the sign.

    Four rows at a time, so that the sum is fetched and stored four times less often; each row has its own name, as
    through two indices the compiler does not vectorise.
    """
    count = factors.size
    fours = count - count % 4
    for j in range(0, fours, 4):
        a, b, c, d = sign * factors[j], sign * factors[j + 1], sign * factors[j + 2], sign * factors[j + 3]
        by_a, by_b, by_c, by_d = rows[j], rows[j + 1], rows[j + 2], rows[j + 3]
        for i in range(out.size):
            out[i] += (by_a[i] * a + by_b[i] * b) + (by_c[i] * c + by_d[i] * d)
    for j in range(fours, count):
        a, by_a = sign * factors[j], rows[j]
        for i in range(out.size):
            out[i] += by_a[i] * a


@inner()
def solve_in_place(matrix: FloatArray, right: FloatArray) -> None:
    """Gaussian elimination with row exchanges; the columns of ``right`` (n, k) become the solutions."""
    solve_part_in_place(matrix, right, right.shape[0], right.shape[1])


@inner()
def solve_part_in_place(matrix: FloatArray, right: FloatArray, n: int, columns: int) -> None:
    """Solve with the first n rows and columns of a matrix and the first columns of ``right`` alone, in place."""
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
        upper = matrix[column, column:n]
        for row in range(column + 1, n):
            lower = matrix[row, column:n]
            factor = lower[0] / upper[0]
            if factor == 0.0:
                continue
            for j in range(lower.size):
                lower[j] -= factor * upper[j]
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
