"""Compiled LU factorization of banded complex matrices, stored as in `gearwhine.numerics.banded`.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.compiled import FUSED, counted, inner

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]

# Part of the matrix's largest entry that replaces a vanishing pivot, at a root hit to the last digit.
TINY = 1e-18
# Bounds of the squared product of pivots, beyond which its logarithm is taken.
SMALL, LARGE = 1e-100, 1e100


@inner(error_model="python")
def fill(rows: IntArray, columns: IntArray, lower: int, values: ComplexArray, matrix: ComplexArray) -> float:
    """Put the entries into a band; returns the largest modulus."""
    for row in range(matrix.shape[0]):
        for column in range(matrix.shape[1]):
            matrix[row, column] = 0.0
    largest = 0.0
    for entry in range(rows.size):
        row, value = rows[entry], values[entry]
        matrix[row, columns[entry] - row + lower] += value
        largest = max(largest, value.real * value.real + value.imag * value.imag)
    return math.sqrt(largest)


@inner(error_model="python", fastmath=FUSED)
def factor(
    matrix: ComplexArray, lower: int, envelope: IntArray, pivots: IntArray, ends: IntArray, least: float
) -> complex:
    """LU factors in place; returns the logarithm of the determinant.

    The diagonal takes the reciprocals of the pivots, and ``ends`` (order,) the last column of every row of U: rows are
    short where nothing reaches far, and interchanges and what they fill in carry their ends along.
    """
    order = matrix.shape[0]
    logarithm = 0.0
    product = 1.0 + 0.0j
    for k in range(order):
        ends[k] = envelope[k, 1]
    for k in range(order):
        chosen = k
        head = matrix[k, lower]
        best = head.real * head.real + head.imag * head.imag
        last_row = envelope[k, 0]
        for i in range(k + 1, last_row + 1):
            head = matrix[i, k - i + lower]
            size = head.real * head.real + head.imag * head.imag
            if size > best:
                best = size
                chosen = i
        pivots[k] = chosen
        last = ends[chosen]
        if chosen != k:
            product = -product
            ends[chosen], ends[k] = ends[k], last
            for j in range(k, max(last, ends[chosen]) + 1):
                entry = matrix[k, j - k + lower]
                matrix[k, j - k + lower] = matrix[chosen, j - chosen + lower]
                matrix[chosen, j - chosen + lower] = entry
        if best <= least * least:
            matrix[k, lower] = least
            best = least * least
        pivot = matrix[k, lower]
        product *= pivot
        size = product.real * product.real + product.imag * product.imag
        if size < SMALL or size > LARGE:
            size = math.sqrt(size)
            logarithm += math.log(size)
            product = complex(product.real / size, product.imag / size)
        inverse = complex(pivot.real / best, -pivot.imag / best)
        matrix[k, lower] = inverse
        above = matrix[k, lower + 1 : last - k + lower + 1]
        for i in range(k + 1, last_row + 1):
            place = k - i + lower
            head = matrix[i, place]
            if head.real == 0.0 and head.imag == 0.0:
                continue
            multiplier = head * inverse
            matrix[i, place] = multiplier
            ends[i] = max(ends[i], last)
            row = matrix[i, place + 1 : place + 1 + above.size]
            for j in range(above.size):
                row[j] -= multiplier * above[j]
    return complex(logarithm + math.log(abs(product)), math.atan2(product.imag, product.real))


@inner(error_model="python", fastmath=FUSED)
def forward_back(
    matrix: ComplexArray, lower: int, envelope: IntArray, pivots: IntArray, ends: IntArray, side: ComplexArray
) -> None:
    """Solve A x = side in place."""
    order = matrix.shape[0]
    for k in range(order):
        chosen = pivots[k]
        if chosen != k:
            entry = side[k]
            side[k] = side[chosen]
            side[chosen] = entry
        for i in range(k + 1, envelope[k, 0] + 1):
            side[i] -= matrix[i, k - i + lower] * side[k]
    for k in range(order - 1, -1, -1):
        total = side[k]
        for j in range(k + 1, ends[k] + 1):
            total -= matrix[k, j - k + lower] * side[j]
        side[k] = total * matrix[k, lower]


@inner(error_model="python", fastmath=FUSED)
def adjoint(
    matrix: ComplexArray, lower: int, envelope: IntArray, pivots: IntArray, ends: IntArray, side: ComplexArray
) -> None:
    """Solve Aᴴ x = side in place."""
    order = matrix.shape[0]
    for k in range(order):
        side[k] = side[k] * np.conj(matrix[k, lower])
        for j in range(k + 1, ends[k] + 1):
            side[j] -= np.conj(matrix[k, j - k + lower]) * side[k]
    for k in range(order - 1, -1, -1):
        total = side[k]
        for i in range(k + 1, envelope[k, 0] + 1):
            total -= np.conj(matrix[i, k - i + lower]) * side[i]
        side[k] = total
        chosen = pivots[k]
        if chosen != k:
            side[k] = side[chosen]
            side[chosen] = total


@inner(error_model="python")
def put(vector: ComplexArray, out: ComplexArray) -> None:
    """Copy a vector; as a loop, since ``out[:] = vector`` brings numba's message for lengths that differ with it."""
    for i in range(out.size):
        out[i] = vector[i]


@inner(error_model="python")
def orthonormalise(vectors: ComplexArray) -> None:
    """Gram-Schmidt orthonormalisation of the rows in place, twice where there are earlier rows."""
    for k in range(vectors.shape[0]):
        for _ in range(2 if k else 1):
            for other in range(k):
                overlap = 0.0j
                for i in range(vectors.shape[1]):
                    overlap += np.conj(vectors[other, i]) * vectors[k, i]
                for i in range(vectors.shape[1]):
                    vectors[k, i] -= overlap * vectors[other, i]
            size = 0.0
            for i in range(vectors.shape[1]):
                size = max(size, abs(vectors[k, i].real), abs(vectors[k, i].imag))
            total, over = 0.0, 1.0 / size
            for i in range(vectors.shape[1]):
                total += (vectors[k, i].real * over) ** 2 + (vectors[k, i].imag * over) ** 2
            over = over / math.sqrt(total)
            for i in range(vectors.shape[1]):
                vectors[k, i] = complex(vectors[k, i].real * over, vectors[k, i].imag * over)


@counted(error_model="python")
def solve(
    rows: IntArray,
    columns: IntArray,
    envelope: IntArray,
    lower: int,
    upper: int,
    values: ComplexArray,
    sides: ComplexArray,
) -> None:
    """Solve for sides (b, k, order) in place."""
    order = envelope.shape[0]
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots, ends = np.empty(order, dtype=np.intp), np.empty(order, dtype=np.intp)
    for b in range(values.shape[0]):
        largest = fill(rows, columns, lower, values[b], matrix)
        factor(matrix, lower, envelope, pivots, ends, TINY * largest)
        for k in range(sides.shape[1]):
            forward_back(matrix, lower, envelope, pivots, ends, sides[b, k])


@counted(error_model="python")
def null_vectors(
    rows: IntArray,
    columns: IntArray,
    envelope: IntArray,
    lower: int,
    upper: int,
    values: ComplexArray,
    right: ComplexArray,
    left: ComplexArray,
    rounds: int,
) -> None:
    """Inverse iteration on vectors (b, k, order) in place."""
    order = envelope.shape[0]
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots, ends = np.empty(order, dtype=np.intp), np.empty(order, dtype=np.intp)
    for b in range(values.shape[0]):
        largest = fill(rows, columns, lower, values[b], matrix)
        factor(matrix, lower, envelope, pivots, ends, TINY * largest)
        for _ in range(rounds):
            for k in range(right.shape[1]):
                put(right[b, k], left[b, k])
                adjoint(matrix, lower, envelope, pivots, ends, left[b, k])
            orthonormalise(left[b])
            for k in range(right.shape[1]):
                put(left[b, k], right[b, k])
                forward_back(matrix, lower, envelope, pivots, ends, right[b, k])
            orthonormalise(right[b])
        for k in range(right.shape[1]):
            put(right[b, k], left[b, k])
            adjoint(matrix, lower, envelope, pivots, ends, left[b, k])
        orthonormalise(left[b])


@counted(error_model="python")
def forms(
    rows: IntArray, columns: IntArray, values: ComplexArray, left: ComplexArray, right: ComplexArray
) -> ComplexArray:
    """Compute Lᴴ A R of every matrix, (b, k, k)."""
    batch, count = right.shape[0], right.shape[1]
    small = np.zeros((batch, count, count), dtype=np.complex128)
    for b in range(batch):
        for entry in range(rows.size):
            row, column, value = rows[entry], columns[entry], values[b, entry]
            for i in range(count):
                weighted = np.conj(left[b, i, row]) * value
                for j in range(count):
                    small[b, i, j] += weighted * right[b, j, column]
    return small
