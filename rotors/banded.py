"""Banded complex matrices in batches: factors, determinants, solutions, and the null vectors of singular ones.

All matrices of a batch share one pattern, given by the row and column of every entry. A matrix is kept by
rows, entry (i, j) at ``[i, j - i + lower]``, with ``lower`` more places on the right for what partial
pivoting fills in. The factors are those of Gaussian elimination, P A = L U, the multipliers in place.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]

# An exactly vanishing pivot is replaced by this part of the matrix's largest entry: a root met to the last digit.
TINY = 1e-18


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
        return _determinants(self.rows, self.columns, self.order, self.lower, self.upper, values)  # type: ignore[no-any-return]

    def solve(self, values: ComplexArray, sides: ComplexArray) -> ComplexArray:
        """Solutions of A x = sides, (b, k, order) both; the matrices from values (b, nnz)."""
        solved = np.array(sides, dtype=np.complex128, order="C")
        _solve(self.rows, self.columns, self.order, self.lower, self.upper, values, solved)
        return solved

    def null_vectors(self, values: ComplexArray, start: ComplexArray, rounds: int) -> tuple[ComplexArray, ComplexArray]:
        """Right and left singular vectors of the k smallest singular values, (b, k, order), orthonormal rows.

        Found by ``rounds`` of inverse iteration, x ← A⁻¹A⁻ᴴx, from the right vectors ``start`` (b, k, order).
        """
        right = np.array(start, dtype=np.complex128, order="C")
        left = np.empty_like(right)
        _null_vectors(self.rows, self.columns, self.order, self.lower, self.upper, values, right, left, rounds)
        return right, left

    def forms(self, values: ComplexArray, left: ComplexArray, right: ComplexArray) -> ComplexArray:
        """Small matrices Lᴴ A R, (b, k, k), of vectors (b, k, order)."""
        return _forms(self.rows, self.columns, values, left, right)  # type: ignore[no-any-return]


@njit(cache=True, nogil=True)
def _fill(rows, columns, lower, values, matrix):  # type: ignore[no-untyped-def]
    matrix[:] = 0.0
    largest = 0.0
    for entry in range(rows.size):
        row = rows[entry]
        matrix[row, columns[entry] - row + lower] += values[entry]
        largest = max(largest, abs(values[entry]))
    return largest


@njit(cache=True, nogil=True)
def _factor(matrix, lower, upper, pivots, least):  # type: ignore[no-untyped-def]
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
            factor = matrix[i, k - i + lower] * inverse
            matrix[i, k - i + lower] = factor
            shift = lower - i
            above = lower - k
            for j in range(k + 1, last + 1):
                matrix[i, j + shift] -= factor * matrix[k, j + above]
    return logarithm, phase / abs(phase)


@njit(cache=True, nogil=True)
def _forward_back(matrix, lower, upper, pivots, side):  # type: ignore[no-untyped-def]
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
def _adjoint(matrix, lower, upper, pivots, side):  # type: ignore[no-untyped-def]
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
def _orthonormalise(vectors):  # type: ignore[no-untyped-def]
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
def _determinants(rows, columns, order, lower, upper, values):  # type: ignore[no-untyped-def]
    batch = values.shape[0]
    logarithms = np.empty(batch)
    phases = np.empty(batch, dtype=np.complex128)
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots = np.empty(order, dtype=np.intp)
    for b in range(batch):
        largest = _fill(rows, columns, lower, values[b], matrix)
        logarithms[b], phases[b] = _factor(matrix, lower, upper, pivots, TINY * largest)
    return logarithms, phases


@njit(cache=True, nogil=True)
def _solve(rows, columns, order, lower, upper, values, sides):  # type: ignore[no-untyped-def]
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots = np.empty(order, dtype=np.intp)
    for b in range(values.shape[0]):
        largest = _fill(rows, columns, lower, values[b], matrix)
        _factor(matrix, lower, upper, pivots, TINY * largest)
        for k in range(sides.shape[1]):
            _forward_back(matrix, lower, upper, pivots, sides[b, k])


@njit(cache=True, nogil=True)
def _null_vectors(rows, columns, order, lower, upper, values, right, left, rounds):  # type: ignore[no-untyped-def]
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots = np.empty(order, dtype=np.intp)
    for b in range(values.shape[0]):
        largest = _fill(rows, columns, lower, values[b], matrix)
        _factor(matrix, lower, upper, pivots, TINY * largest)
        for _ in range(rounds):
            for k in range(right.shape[1]):
                left[b, k] = right[b, k]
                _adjoint(matrix, lower, upper, pivots, left[b, k])
            _orthonormalise(left[b])
            for k in range(right.shape[1]):
                right[b, k] = left[b, k]
                _forward_back(matrix, lower, upper, pivots, right[b, k])
            _orthonormalise(right[b])
        for k in range(right.shape[1]):
            left[b, k] = right[b, k]
            _adjoint(matrix, lower, upper, pivots, left[b, k])
        _orthonormalise(left[b])


@njit(cache=True, nogil=True)
def _forms(rows, columns, values, left, right):  # type: ignore[no-untyped-def]
    batch, count = right.shape[0], right.shape[1]
    forms = np.zeros((batch, count, count), dtype=np.complex128)
    for b in range(batch):
        for entry in range(rows.size):
            row, column, value = rows[entry], columns[entry], values[b, entry]
            for i in range(count):
                weighted = np.conj(left[b, i, row]) * value
                for j in range(count):
                    forms[b, i, j] += weighted * right[b, j, column]
    return forms
