"""Compiled mode shapes of a discretised shaft: multiple shooting, energy quadrature and orthonormalisation.

The banded equations of multiple shooting and their null vectors, the mode shapes, are those of
`gearwhine.rotors.transfer_matrix.mode_shapes`; kinetic and strain energy are integrated along the shaft; the
Gram-Schmidt orthonormalisation in mass serves `gearwhine.rotors.whirl.planar_basis`. The arrays of a discretised shaft
come in the order of `gearwhine.rotors.transfer_matrix.wittrick_williams_kernels`. Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.compiled import counted, inner, uncounted
from gearwhine.rotors.transfer_matrix.timoshenko_kernels import element_transfer_matrices, table_transfer_matrices

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]


@counted(error_model="python")
def energy_weights(
    fractions: FloatArray,
    weights: FloatArray,
    lengths: FloatArray,
    coefficients: FloatArray,
    element: IntArray,
    stiffness: FloatArray,
    inertia: FloatArray,
    polar: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Weights of the squares of `energy_rows`: mass and polar inertia for motion, compliance or stiffness for strain.

    ``weights`` (g,) are those of the quadrature over an element; infinite ``stiffness`` (p + 1, n) stores nothing.
    """
    n, elements, points = stiffness.shape[1], element.size, fractions.size
    motion_size, strain_size = elements * points * n, elements * points * (2 * n - 1)
    nodal = (elements + 1) * n
    mass, turning = np.zeros(motion_size + nodal), np.zeros(motion_size + nodal)
    strain = np.zeros(strain_size + nodal)
    values = np.empty((lengths.size, points, coefficients.shape[1]))
    for e in range(lengths.size):
        for g in range(points):
            for row in range(coefficients.shape[1]):
                total = 0.0
                for j in range(coefficients.shape[2] - 1, -1, -1):
                    total = total * (2.0 * fractions[g] - 1.0) + coefficients[e, row, j]
                values[e, g, row] = total * lengths[e] * weights[g]
    at_motion, at_strain = 0, 0
    for number in range(elements):
        for g in range(points):
            value = values[element[number], g]
            if n == 2:
                mass[at_motion], mass[at_motion + 1] = value[2], value[3]
                # A round section's polar moment of area is twice its diametral one.
                turning[at_motion + 1] = 2.0 * value[3]
                strain[at_strain], strain[at_strain + 1], strain[at_strain + 2] = value[5], value[0], value[1]
            else:
                mass[at_motion], strain[at_strain] = value[1], value[0]
            at_motion += n
            at_strain += 2 * n - 1
    for node in range(elements + 1):
        for k in range(n):
            mass[at_motion] = inertia[node, k]
            strain[at_strain] = 0.0 if math.isinf(stiffness[node, k]) else stiffness[node, k]
            if k == 1:
                turning[at_motion] = polar[node]
            at_motion += 1
            at_strain += 1
    return mass, turning, strain


@counted(error_model="python")
def energy_rows(
    squared: FloatArray,
    states: FloatArray,
    fractions: FloatArray,
    lengths: FloatArray,
    coefficients: FloatArray,
    element: IntArray,
    motion: FloatArray,
    strain: FloatArray,
) -> None:
    """Fill in the terms whose weighted squares are the energies of fields with node states (k, p + 1, 2n).

    Element by element and at every fraction (g,) of it, ``motion`` (k, p g n + ...) takes the displacements and
    ``strain`` (k, p g (2n − 1) + ...) the rotation (of a beam) and the forces; both end with the displacements of
    the nodes, n each.
    """
    size, elements = states.shape[2], element.size
    n = size // 2
    transfer_matrices = np.empty((lengths.size, fractions.size, size, size))
    state = np.empty(size)
    for k in range(squared.size):
        if k == 0 or squared[k] != squared[k - 1]:
            for e in range(lengths.size):
                element_transfer_matrices(
                    lengths[e], coefficients[e], squared[k], squared[k], fractions, transfer_matrices[e]
                )
        at_motion, at_strain = 0, 0
        for number in range(elements):
            for g in range(fractions.size):
                transfer = transfer_matrices[element[number], g]
                for row in range(size):
                    state[row] = 0.0
                    for column in range(size):
                        state[row] += transfer[row, column] * states[k, number, column]
                for row in range(n):
                    motion[k, at_motion + row] = state[row]
                for row in range(1, size):
                    strain[k, at_strain + row - 1] = state[row]
                at_motion += n
                at_strain += size - 1
        for node in range(elements + 1):
            for row in range(n):
                motion[k, at_motion + row] = strain[k, at_strain + row] = states[k, node, row]
            at_motion += n
            at_strain += n


INVERSE_ITERATIONS = 2
# Value that replaces a vanishing pivot, as at a root hit to the last digit.
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
            # The first node has no element to its left, hence no equations for its displacements.
            row = 2 * n * node - n + i
            if row < 0:
                continue
            if i < n:
                band[row, 2 * n * node + i - row + width] = 1.0
            else:
                component = i - n
                diagonal = 2 * n * node + component - row + width
                if math.isinf(stiffness[node, component]):
                    band[row, diagonal] = 1.0
                    continue
                term = stiffness[node, component] - squared * inertia[node, component]
                scale[row] = max(1.0, abs(term))
                band[row, diagonal] = -term / scale[row]
                band[row, diagonal + n] = 1.0 / scale[row]
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
                pivot_column, other = j - k + width, j - pivot + width
                band[k, pivot_column], band[pivot, other] = band[pivot, other], band[k, pivot_column]
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
    coefficients: FloatArray,
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
        table_transfer_matrices(lengths, coefficients, at, at, np.ones(1), transfer_matrices)
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
    coefficients: FloatArray,
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
    table_transfer_matrices(lengths, coefficients, at, at, np.ones(1), transfer_matrices)
    shooting_band(squared, transfer_matrices[0, :, 0], element, stiffness, inertia, band, scale)
    factor_band(band, pivots)
    states = np.empty(loads.shape)
    for k in range(loads.shape[0]):
        for i in range(order):
            states[k, i] = loads[k, i] / scale[i]
        solve_band(band, pivots, states[k])
    return states.reshape(loads.shape[0], nodes, 2 * n)


@inner(error_model="python")
def _product(motion: FloatArray, first: int, second: int, mass: FloatArray) -> float:
    total = 0.0
    for i in range(mass.size):
        total += mass[i] * motion[first, i] * motion[second, i]
    return total


@uncounted(error_model="python")
def mass_orthonormal(motion: FloatArray, strain: FloatArray, shapes: FloatArray, mass: FloatArray, least: float) -> int:
    """Make rows of ``motion`` (k, g) orthonormal under the weights ``mass`` (g,) in place, combining the others alike.

    Rows reduced below the part ``least`` of their norm are dropped, the rest moved up; returns the number left.
    """
    count = 0
    for row in range(motion.shape[0]):
        source, left = row, 1.0
        # First normalised, then orthogonalised twice, because of rounding.
        for turn in range(3):
            for other in range(count if turn else 0):
                overlap = _product(motion, other, count, mass)
                for rows in (motion, strain, shapes):
                    for i in range(rows.shape[1]):
                        rows[count, i] -= overlap * rows[other, i]
            norm = math.sqrt(_product(motion, source, source, mass))
            left = left * norm if turn else norm
            if left <= (least if turn else 0.0):
                left = 0.0
                break
            for rows in (motion, strain, shapes):
                for i in range(rows.shape[1]):
                    rows[count, i] = rows[source, i] / norm
            source, left = count, left if turn else 1.0
        if left > 0.0:
            count += 1
    return count
