"""Compiled elimination of banded complex matrices; the layout is that of `rotors.banded`.

Importing this module imports numba.
"""

import numpy as np
import numpy.typing as npt
from numba import njit

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]

# An exactly vanishing pivot is replaced by this part of the matrix's largest entry: a root met to the last digit.
TINY = 1e-18


@njit(cache=True, nogil=True)
def fill(rows: IntArray, columns: IntArray, lower: int, values: ComplexArray, matrix: ComplexArray) -> float:
    """Put the entries into a band; returns the largest modulus."""
    matrix[:] = 0.0
    largest = 0.0
    for entry in range(rows.size):
        row = rows[entry]
        matrix[row, columns[entry] - row + lower] += values[entry]
        largest = max(largest, abs(values[entry]))
    return largest


@njit(cache=True, nogil=True)
def factor(matrix: ComplexArray, lower: int, upper: int, pivots: IntArray, least: float) -> tuple[float, complex]:
    """Factor in place; the logarithm of the determinant's modulus, and its phase factor."""
    order = matrix.shape[0]
    logarithm = 0.0
    phase = 1.0 + 0.0j
    for k in range(order):
        chosen = k
        head = matrix[k, lower]
        best = head.real * head.real + head.imag * head.imag
        last_row = min(k + lower, order - 1)
        for i in range(k + 1, last_row + 1):
            head = matrix[i, k - i + lower]
            size = head.real * head.real + head.imag * head.imag
            if size > best:
                best = size
                chosen = i
        pivots[k] = chosen
        last = min(k + lower + upper, order - 1)
        if chosen != k:
            phase = -phase
            for j in range(k, last + 1):
                kept = matrix[k, j - k + lower]
                matrix[k, j - k + lower] = matrix[chosen, j - chosen + lower]
                matrix[chosen, j - chosen + lower] = kept
        if best <= least * least:
            matrix[k, lower] = least
        pivot = matrix[k, lower]
        size = abs(pivot)
        logarithm += np.log(size)
        phase *= pivot / size
        inverse = 1.0 / pivot
        for i in range(k + 1, last_row + 1):
            if matrix[i, k - i + lower] == 0.0:
                continue
            multiplier = matrix[i, k - i + lower] * inverse
            matrix[i, k - i + lower] = multiplier
            shift = lower - i
            above = lower - k
            for j in range(k + 1, last + 1):
                matrix[i, j + shift] -= multiplier * matrix[k, j + above]
    return logarithm, phase / abs(phase)


@njit(cache=True, nogil=True)
def forward_back(matrix: ComplexArray, lower: int, upper: int, pivots: IntArray, side: ComplexArray) -> None:
    """Solve A x = side in place."""
    order = matrix.shape[0]
    for k in range(order):
        chosen = pivots[k]
        if chosen != k:
            kept = side[k]
            side[k] = side[chosen]
            side[chosen] = kept
        for i in range(k + 1, min(k + lower, order - 1) + 1):
            side[i] -= matrix[i, k - i + lower] * side[k]
    for k in range(order - 1, -1, -1):
        total = side[k]
        for j in range(k + 1, min(k + lower + upper, order - 1) + 1):
            total -= matrix[k, j - k + lower] * side[j]
        side[k] = total / matrix[k, lower]


@njit(cache=True, nogil=True)
def adjoint(matrix: ComplexArray, lower: int, upper: int, pivots: IntArray, side: ComplexArray) -> None:
    """Solve Aᴴ x = side in place."""
    order = matrix.shape[0]
    for k in range(order):
        side[k] = side[k] / np.conj(matrix[k, lower])
        for j in range(k + 1, min(k + lower + upper, order - 1) + 1):
            side[j] -= np.conj(matrix[k, j - k + lower]) * side[k]
    for k in range(order - 1, -1, -1):
        total = side[k]
        for i in range(k + 1, min(k + lower, order - 1) + 1):
            total -= np.conj(matrix[i, k - i + lower]) * side[i]
        side[k] = total
        chosen = pivots[k]
        if chosen != k:
            side[k] = side[chosen]
            side[chosen] = total


@njit(cache=True, nogil=True)
def orthonormalise(vectors: ComplexArray) -> None:
    """Gram and Schmidt, twice, on the rows in place."""
    for k in range(vectors.shape[0]):
        for _ in range(2):
            for other in range(k):
                overlap = 0.0j
                for i in range(vectors.shape[1]):
                    overlap += np.conj(vectors[other, i]) * vectors[k, i]
                for i in range(vectors.shape[1]):
                    vectors[k, i] -= overlap * vectors[other, i]
            size = 0.0
            for i in range(vectors.shape[1]):
                size = max(size, abs(vectors[k, i]))
            total = 0.0
            for i in range(vectors.shape[1]):
                vectors[k, i] /= size
                total += vectors[k, i].real ** 2 + vectors[k, i].imag ** 2
            norm = np.sqrt(total)
            for i in range(vectors.shape[1]):
                vectors[k, i] /= norm


@njit(cache=True, nogil=True)
def determinants(
    rows: IntArray, columns: IntArray, order: int, lower: int, upper: int, values: ComplexArray
) -> tuple[FloatArray, ComplexArray]:
    """Logarithms of moduli (b,) and phase factors (b,)."""
    batch = values.shape[0]
    logarithms = np.empty(batch)
    phases = np.empty(batch, dtype=np.complex128)
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots = np.empty(order, dtype=np.intp)
    for b in range(batch):
        largest = fill(rows, columns, lower, values[b], matrix)
        logarithms[b], phases[b] = factor(matrix, lower, upper, pivots, TINY * largest)
    return logarithms, phases


@njit(cache=True, nogil=True)
def solve(
    rows: IntArray, columns: IntArray, order: int, lower: int, upper: int, values: ComplexArray, sides: ComplexArray
) -> None:
    """Solve for sides (b, k, order) in place."""
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots = np.empty(order, dtype=np.intp)
    for b in range(values.shape[0]):
        largest = fill(rows, columns, lower, values[b], matrix)
        factor(matrix, lower, upper, pivots, TINY * largest)
        for k in range(sides.shape[1]):
            forward_back(matrix, lower, upper, pivots, sides[b, k])


@njit(cache=True, nogil=True)
def null_vectors(
    rows: IntArray,
    columns: IntArray,
    order: int,
    lower: int,
    upper: int,
    values: ComplexArray,
    right: ComplexArray,
    left: ComplexArray,
    rounds: int,
) -> None:
    """Inverse iteration on vectors (b, k, order) in place."""
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots = np.empty(order, dtype=np.intp)
    for b in range(values.shape[0]):
        largest = fill(rows, columns, lower, values[b], matrix)
        factor(matrix, lower, upper, pivots, TINY * largest)
        for _ in range(rounds):
            for k in range(right.shape[1]):
                left[b, k] = right[b, k]
                adjoint(matrix, lower, upper, pivots, left[b, k])
            orthonormalise(left[b])
            for k in range(right.shape[1]):
                right[b, k] = left[b, k]
                forward_back(matrix, lower, upper, pivots, right[b, k])
            orthonormalise(right[b])
        for k in range(right.shape[1]):
            left[b, k] = right[b, k]
            adjoint(matrix, lower, upper, pivots, left[b, k])
        orthonormalise(left[b])


@njit(cache=True, nogil=True)
def forms(
    rows: IntArray, columns: IntArray, values: ComplexArray, left: ComplexArray, right: ComplexArray
) -> ComplexArray:
    """Lᴴ A R of every matrix, (b, k, k)."""
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
