"""Compiled multiple shooting on a discretised shaft: banded equations and their null vectors, the mode shapes.

Importing this module imports numba. The equations are those of `rotors.shapes`; the arrays of a chain come in
the order of `rotors.count_kernels`.
"""

import math

import numpy as np
import numpy.typing as npt

from .compiled import counted, inner
from .piece_kernels import table_transfer_matrices

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

INVERSE_ITERATIONS = 2
# Replaces a vanishing pivot, as at a root hit to the last digit.
LEAST_PIVOT = 1e-30


@inner(error_model="python")
def shooting_band(
    squared: float,
    transfer_matrices: FloatArray,
    element: IntArray,
    stiffness: FloatArray,
    inertia: FloatArray,
    band: FloatArray,
    scale: FloatArray,
) -> None:
    """Fill the equations into ``band`` (order, 3 b + 1), row i holding columns i − b to i + 2 b, b = 3 n − 1.

    Every row is divided by its ``scale`` (order,), of a force balance the size of its spring or inertia.
    """
    n, nodes = stiffness.shape[1], stiffness.shape[0]
    width = 3 * n - 1
    for row in range(band.shape[0]):
        scale[row] = 1.0
        for column in range(band.shape[1]):
            band[row, column] = 0.0
    for node in range(nodes):
        for i in range(2 * n):
            # The first node has no piece to its left, hence no equations for its displacements.
            row = 2 * n * node - n + i
            if row < 0:
                continue
            if i < n:
                band[row, 2 * n * node + i - row + width] = 1.0
            else:
                component = i - n
                own = 2 * n * node + component - row + width
                if math.isinf(stiffness[node, component]):
                    band[row, own] = 1.0
                    continue
                term = stiffness[node, component] - squared * inertia[node, component]
                scale[row] = max(1.0, abs(term))
                band[row, own] = -term / scale[row]
                band[row, own + n] = 1.0 / scale[row]
            if node > 0:
                transfer = transfer_matrices[element[node - 1]]
                for j in range(2 * n):
                    band[row, 2 * n * (node - 1) + j - row + width] = -transfer[i, j] / scale[row]
    for i in range(n):
        band[2 * n * nodes - n + i, width] = 1.0


@inner(error_model="python")
def factor_band(band: FloatArray, pivots: IntArray) -> None:
    """LU factors in place, with row interchanges."""
    order, width = band.shape[0], (band.shape[1] - 1) // 3
    for k in range(order):
        last, pivot = min(k + width, order - 1), k
        for i in range(k + 1, last + 1):
            if abs(band[i, k - i + width]) > abs(band[pivot, k - pivot + width]):
                pivot = i
        pivots[k] = pivot
        end = min(k + 2 * width, order - 1)
        if pivot != k:
            for j in range(k, end + 1):
                own, other = j - k + width, j - pivot + width
                band[k, own], band[pivot, other] = band[pivot, other], band[k, own]
        if abs(band[k, width]) < LEAST_PIVOT:
            band[k, width] = LEAST_PIVOT
        for i in range(k + 1, last + 1):
            factor = band[i, k - i + width] / band[k, width]
            band[i, k - i + width] = factor
            if factor != 0.0:
                for j in range(k + 1, end + 1):
                    band[i, j - i + width] -= factor * band[k, j - k + width]


@inner(error_model="python")
def solve_band(band: FloatArray, pivots: IntArray, x: FloatArray) -> None:
    """Solve with the factors in place, for one right-hand side (order,)."""
    order, width = band.shape[0], (band.shape[1] - 1) // 3
    for k in range(order):
        x[k], x[pivots[k]] = x[pivots[k]], x[k]
        for i in range(k + 1, min(k + width, order - 1) + 1):
            x[i] -= band[i, k - i + width] * x[k]
    for k in range(order - 1, -1, -1):
        value = x[k]
        for j in range(k + 1, min(k + 2 * width, order - 1) + 1):
            value -= band[k, j - k + width] * x[j]
        x[k] = value / band[k, width]


@inner(error_model="python")
def solve_band_transposed(band: FloatArray, pivots: IntArray, x: FloatArray) -> None:
    """Solve the transposed equations with the factors in place."""
    order, width = band.shape[0], (band.shape[1] - 1) // 3
    for k in range(order):
        value = x[k]
        for i in range(max(0, k - 2 * width), k):
            value -= band[i, k - i + width] * x[i]
        x[k] = value / band[k, width]
    for k in range(order - 1, -1, -1):
        for i in range(k + 1, min(k + width, order - 1) + 1):
            x[k] -= band[i, k - i + width] * x[i]
        x[k], x[pivots[k]] = x[pivots[k]], x[k]


@inner(error_model="python")
def _orthonormalise(vectors: FloatArray) -> None:
    """Gram-Schmidt orthonormalisation of the rows in place; twice, because of rounding of nearly parallel rows.

    Plain loops compile in a tenth of the time of array expressions.
    """
    for k in range(vectors.shape[0]):
        row, largest = vectors[k], 0.0
        for i in range(row.size):
            largest = max(largest, abs(row[i]))
        for i in range(row.size):
            row[i] /= largest
        for _ in range(2):
            for other in range(k):
                overlap = 0.0
                for i in range(row.size):
                    overlap += vectors[other, i] * row[i]
                for i in range(row.size):
                    row[i] -= overlap * vectors[other, i]
            total = 0.0
            for i in range(row.size):
                total += row[i] * row[i]
            norm = math.sqrt(total)
            for i in range(row.size):
                row[i] /= norm


@counted(error_model="python")
def null_states(
    squared: FloatArray,
    lengths: FloatArray,
    given: FloatArray,
    element: IntArray,
    stiffness: FloatArray,
    inertia: FloatArray,
) -> FloatArray:
    """Node states of the shapes at natural ω² (k,), equal ones side by side, (k, p + 1, 2n).

    Equal members share one null space, found by inverse iteration with the equations and their transpose.
    """
    n, nodes, number = stiffness.shape[1], stiffness.shape[0], squared.size
    order, width = 2 * n * nodes, 3 * n - 1
    states = np.empty((number, order))
    band, scale, pivots = np.empty((order, 3 * width + 1)), np.empty(order), np.empty(order, np.intp)
    transfer_matrices = np.empty((1, lengths.size, 1, 2 * n, 2 * n))
    first = 0
    while first < number:
        end = first + 1
        while end < number and squared[end] == squared[first]:
            end += 1
        at = squared[first : first + 1]
        table_transfer_matrices(lengths, given, at, at, np.ones(1), transfer_matrices)
        shooting_band(squared[first], transfer_matrices[0, :, 0], element, stiffness, inertia, band, scale)
        factor_band(band, pivots)
        group = states[first:end]
        for k in range(end - first):
            for i in range(order):
                # An arbitrary start, the same on every machine.
                group[k, i] = ((i * 7919 + (k + 1) * 104729) % 1009) / 504.5 - 1.0
        for _ in range(INVERSE_ITERATIONS):
            for k in range(end - first):
                solve_band_transposed(band, pivots, group[k])
            _orthonormalise(group)
            for k in range(end - first):
                solve_band(band, pivots, group[k])
            _orthonormalise(group)
        first = end
    return states.reshape(number, nodes, 2 * n)


@counted(error_model="python")
def shooting_responses(
    squared: float,
    loads: FloatArray,
    lengths: FloatArray,
    given: FloatArray,
    element: IntArray,
    stiffness: FloatArray,
    inertia: FloatArray,
) -> FloatArray:
    """Node states under right-hand sides (k, order) of the equations at ω² off the roots, (k, p + 1, 2n)."""
    n, nodes = stiffness.shape[1], stiffness.shape[0]
    order, width = 2 * n * nodes, 3 * n - 1
    band, scale, pivots = np.empty((order, 3 * width + 1)), np.empty(order), np.empty(order, np.intp)
    transfer_matrices = np.empty((1, lengths.size, 1, 2 * n, 2 * n))
    at = np.full(1, squared)
    table_transfer_matrices(lengths, given, at, at, np.ones(1), transfer_matrices)
    shooting_band(squared, transfer_matrices[0, :, 0], element, stiffness, inertia, band, scale)
    factor_band(band, pivots)
    states = np.empty(loads.shape)
    for k in range(loads.shape[0]):
        for i in range(order):
            states[k, i] = loads[k, i] / scale[i]
        solve_band(band, pivots, states[k])
    return states.reshape(loads.shape[0], nodes, 2 * n)
