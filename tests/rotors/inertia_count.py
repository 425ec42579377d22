"""Sylvester's law of inertia on K − ω² M of a row of elements, factorised in double-double arithmetic.

Bubbles leave element by element, then nodes from left to right; a symmetric matrix has as many negative eigenvalues as
pivots. Without pivoting a small pivot grows its successors: thirty-one digits are spent on that.
"""

import numpy as np
from numba import njit

from gearwhine.numerics.arrays import FloatArray


@njit(cache=True, error_model="numpy")
def product(a: float, a_low: float, b: float, b_low: float) -> tuple[float, float]:
    total = a * b
    shifted = 134217729.0 * a
    a_top = shifted - (shifted - a)
    a_rest = a - a_top
    shifted = 134217729.0 * b
    b_top = shifted - (shifted - b)
    b_rest = b - b_top
    error = ((a_top * b_top - total) + a_top * b_rest + a_rest * b_top) + a_rest * b_rest
    error += a * b_low + a_low * b
    high = total + error
    return high, error - (high - total)


@njit(cache=True, error_model="numpy")
def difference(a: float, a_low: float, b: float, b_low: float) -> tuple[float, float]:
    high = a - b
    part = high - a
    error = (a - (high - part)) - (b + part)
    low = a_low - b_low
    part = low - a_low
    low_error = (a_low - (low - part)) - (b_low + part)
    error += low
    total = high + error
    error = (error - (total - high)) + low_error
    high = total + error
    return high, error - (high - total)


@njit(cache=True, error_model="numpy")
def ratio(a: float, a_low: float, b: float, b_low: float) -> tuple[float, float]:
    first = a / b
    part, part_low = product(first, 0.0, b, b_low)
    rest, rest_low = difference(a, a_low, part, part_low)
    second = rest / b
    part, part_low = product(second, 0.0, b, b_low)
    rest, rest_low = difference(rest, rest_low, part, part_low)
    third = rest / b
    total = first + second
    error = (second - (total - first)) + third
    high = total + error
    return high, error - (high - total)


@njit(cache=True, error_model="numpy")
def _eliminate(high: FloatArray, low: FloatArray, pivot: int, first: int) -> bool:
    """Schur complement on rows and columns ``first`` … ``pivot`` − 1; whether the pivot is negative."""
    for row in range(first, pivot):
        scale, scale_low = ratio(high[row, pivot], low[row, pivot], high[pivot, pivot], low[pivot, pivot])
        if scale == 0.0:
            continue
        for column in range(first, row + 1):
            change, change_low = product(scale, scale_low, high[column, pivot], low[column, pivot])
            value, value_low = difference(high[row, column], low[row, column], change, change_low)
            high[row, column] = high[column, row] = value
            low[row, column] = low[column, row] = value_low
    return high[pivot, pivot] < 0.0


@njit(cache=True, error_model="numpy")
def negative_pivots(
    stiffness: FloatArray,
    stiffness_low: FloatArray,
    mass: FloatArray,
    mass_low: FloatArray,
    node_stiffness: FloatArray,
    node_mass: FloatArray,
    frequency: float,
) -> int:
    """How many eigenvalues of K − ω² M are negative.

    Parameters
    ----------
    stiffness, stiffness_low, mass, mass_low
        (e, n, n): element matrices as sums of two doubles; left end, right end, bubbles.
    node_stiffness, node_mass
        (e + 1, size): on the diagonal at the nodes; infinite stiffness holds.
    frequency
        ω.
    """
    elements, n = stiffness.shape[0], stiffness.shape[1]
    size = node_stiffness.shape[1]
    squared, squared_low = product(frequency, 0.0, frequency, 0.0)
    high, low = np.empty((n, n)), np.empty((n, n))
    front, front_low = np.zeros((size, size)), np.zeros((size, size))
    count = 0
    for node in range(elements + 1):
        for i in range(size):
            if not np.isinf(node_stiffness[node, i]):
                inertia, inertia_low = product(squared, squared_low, node_mass[node, i], 0.0)
                term, term_low = difference(node_stiffness[node, i], 0.0, inertia, inertia_low)
                front[i, i], front_low[i, i] = difference(front[i, i], front_low[i, i], -term, -term_low)
        last = node == elements
        if last:
            # Nothing to the right: the front alone.
            high[: 2 * size, : 2 * size] = 0.0
            low[: 2 * size, : 2 * size] = 0.0
        else:
            for i in range(n):
                for j in range(n):
                    term, term_low = product(squared, squared_low, mass[node, i, j], mass_low[node, i, j])
                    high[i, j], low[i, j] = difference(stiffness[node, i, j], stiffness_low[node, i, j], term, term_low)
            for bubble in range(n - 1, 2 * size - 1, -1):
                count += _eliminate(high, low, bubble, 0)
        # Right end first, so that the left one's unknowns are last and leave.
        ends, ends_low = np.zeros((2 * size, 2 * size)), np.zeros((2 * size, 2 * size))
        for i in range(2 * size):
            for j in range(2 * size):
                row, column = (i + size) % (2 * size), (j + size) % (2 * size)
                ends[row, column], ends_low[row, column] = high[i, j], low[i, j]
        for i in range(size):
            for j in range(size):
                row, column = i + size, j + size
                ends[row, column], ends_low[row, column] = difference(
                    ends[row, column], ends_low[row, column], -front[i, j], -front_low[i, j]
                )
        for i in range(size - 1, -1, -1):
            leaving = size + i
            if np.isinf(node_stiffness[node, i]):
                continue
            count += _eliminate(ends, ends_low, leaving, size if last else 0)
        for i in range(size):
            for j in range(size):
                front[i, j], front_low[i, j] = ends[i, j], ends_low[i, j]
    return count
