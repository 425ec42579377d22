"""Compiled argument principle: the determinant sampled along a contour, for `rotors.whirl.argument_principle`.

Importing this module imports numba.
"""

import cmath
import math

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.banded_kernels import TINY, factor, fill
from gearwhine.numerics.compiled import counted, inner
from gearwhine.rotors.whirl.eigenvalue_kernels import edge_distance, logarithm
from gearwhine.rotors.whirl.shooting_matrix_kernels import Pattern, Table, force_unit, put_entries, scratch

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

# Largest slope of ln q in a safe interval, and largest error of its change.
STEEPEST = 1.5
MISFIT = 0.3
# Initial number of samples on each side, both ends included.
SIDE_SAMPLES = 4
# Known roots closer to the contour than this, in ln λ, are not divided out.
TOO_NEAR = 1e-4
# Step of the difference for slopes, as a part of the interval.
SLOPE_PART = 1e-3
# An interval of ln λ still unsafe at this length passes through a root.
SHORTEST = 1e-10
MOST_SAMPLES = 40_000
# Largest number of waiting points besides those of the sides: two for each halving down to the shortest interval.
MOST_WAITING = 2 * math.ceil(-math.log2(SHORTEST)) + 16
# Bounds of a product of factors before its logarithm is taken.
SMALL, LARGE = 1e-100, 1e100


@inner(error_model="python")
def _logarithm_of_product(at: complex, divided: ComplexArray) -> complex:
    """Return ln Π (λ − μ_k), up to multiples of 2πi."""
    total, product = 0.0j, 1.0 + 0.0j
    for k in range(divided.size):
        product *= at - divided[k]
        size = product.real * product.real + product.imag * product.imag
        if size < SMALL or size > LARGE:
            total += cmath.log(product)
            product = 1.0 + 0.0j
    return total + cmath.log(product)


@inner(error_model="python")
def _principal(difference: complex) -> complex:
    """Bring the imaginary part of a difference of logarithms into (−π, π]."""
    turns = math.floor(difference.imag / (2.0 * math.pi) + 0.5)
    return complex(difference.real, difference.imag - 2.0 * math.pi * turns)


@inner(error_model="python")
def _put_edge(bounds: FloatArray, edge: ComplexArray) -> None:
    """Points on the sides of a sector, counter-clockwise from its first corner and back to it."""
    part, sizes, angles = edge.size // 4, bounds[:2], bounds[2:]
    for side in range(4):
        # Indices of the bounds of ln |λ| and of arg λ at which the side begins and ends.
        start = complex(sizes[(side + 1) // 2 % 2], angles[side // 2])
        end = complex(sizes[(side + 2) // 2 % 2], angles[(side + 1) % 4 // 2])
        for k in range(part):
            edge[side * part + k] = start + (end - start) * (k / part)
    edge[4 * part] = edge[0]


@inner(error_model="python")
def _divide(
    known_roots: ComplexArray, mirrored: bool, bounds: FloatArray, divided: ComplexArray, left: ComplexArray
) -> tuple[int, int, int]:
    """Sort known roots into those divided out and those left inside; numbers of both, and of divided roots inside.

    ``mirrored`` roots have conjugates that are roots.
    """
    away, near, inside = 0, 0, 0
    for k in range(known_roots.size):
        place = logarithm(known_roots[k])
        distance = edge_distance(place, bounds)
        if abs(distance) <= TOO_NEAR:
            if distance < 0.0:
                left[near] = known_roots[k]
                near += 1
            continue
        inside += distance < 0.0
        divided[away] = known_roots[k]
        away += 1
        if mirrored and edge_distance(place.conjugate(), bounds) > TOO_NEAR:
            divided[away] = known_roots[k].conjugate()
            away += 1
    return away, near, inside


@counted(error_model="python")
def follow_contour(
    bounds: FloatArray,
    speed: tuple[complex, complex],
    mass: float,
    known_roots: ComplexArray,
    mirrored: bool,
    table: Table,
    pattern: Pattern,
) -> tuple[int, int, int, ComplexArray, ComplexArray]:
    """Follow ln q along the edge of a sector, with adaptive sampling.

    Returns the number of points (0 where the path does not converge) and of determinants, the number of roots inside,
    the known roots inside that are not divided out, and (3, s): the points, ln q and d ln q/dw.

    ``bounds`` are as of `gearwhine.rotors.whirl.eigenvalue_kernels.edge_distance`, Ω = ``speed[0]`` + ``speed[1]`` λ,
    and ``mass`` gives the unit of force. An interval that is not safe is halved.
    """
    edge = np.empty(4 * (SIDE_SAMPLES - 1) + 1, dtype=np.complex128)
    _put_edge(bounds, edge)
    divided, left = np.empty(2 * known_roots.size, dtype=np.complex128), np.empty(known_roots.size, dtype=np.complex128)
    away, near, inside = _divide(known_roots, mirrored, bounds, divided, left)
    divided, left = divided[:away], left[:near]
    scale = force_unit(complex(math.exp(bounds[1]), 0.0), mass)
    rows, columns, envelope, lower, upper = pattern
    order, corners = envelope.shape[0], edge.size - 1
    beams, rods, values, _ = scratch(table, rows.size)
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots, ends = np.empty(order, dtype=np.intp), np.empty(order, dtype=np.intp)
    both = np.empty(2, dtype=np.complex128)
    path = np.empty((3, 64), dtype=np.complex128)
    # Points beyond the last safe point of ``path``, the nearest at the end.
    waiting = np.empty((3, corners + 1 + MOST_WAITING), dtype=np.complex128)
    at_zero, samples, count, pending = 0, 0, 1, 0
    while True:
        # First the corners, last to first; then midpoints of intervals that are too long.
        at_corner = pending < corners and samples < 2 * corners
        if at_corner:
            corner = corners - 1 - pending
            point, step = edge[corner], SLOPE_PART * (edge[corner + 1] - edge[corner])
        else:
            if samples == 2 * corners:
                # Motions of a free shaft at zero are outside the sector: divided out like other known roots.
                at_zero = math.floor(waiting[2, corners].real + 0.5)
                for k in range(1, corners + 1):
                    waiting[1, k] -= at_zero * waiting[0, k]
                    waiting[2, k] -= at_zero
                # The contour's end is its beginning.
                waiting[0, 0], waiting[1, 0], waiting[2, 0] = edge[corners], waiting[1, corners], waiting[2, corners]
                for k in range(3):
                    path[k, 0] = waiting[k, corners]
            h = 0.0j
            while pending > 0:
                h = waiting[0, pending - 1] - path[0, count - 1]
                change = _principal(waiting[1, pending - 1] - path[1, count - 1])
                change_left, change_right = h * path[2, count - 1], h * waiting[2, pending - 1]
                if (
                    max(abs(change_left), abs(change_right)) > STEEPEST
                    or abs(change - 0.5 * (change_left + change_right)) > MISFIT
                ):
                    break
                if count == path.shape[1]:
                    more = np.empty((3, 2 * count), dtype=np.complex128)
                    for row in range(3):
                        for k in range(count):
                            more[row, k] = path[row, k]
                    path = more
                path[0, count], path[2, count] = waiting[0, pending - 1], waiting[2, pending - 1]
                # The logarithm is continued along the contour.
                path[1, count] = path[1, count - 1] + change
                count += 1
                pending -= 1
            if pending == 0:
                turns = math.floor((path[1, count - 1].imag - path[1, 0].imag) / (2.0 * math.pi) + 0.5)
                return count, samples, inside + turns, left, path
            if abs(h) < SHORTEST or samples > MOST_SAMPLES or pending == waiting.shape[1]:
                return 0, samples, inside, left, path
            point, step = path[0, count - 1] + 0.5 * h, 0.5 * SLOPE_PART * h
        for k in range(2):
            at = cmath.exp(point + k * step)
            put_entries(at, speed[0] + speed[1] * at, scale, table, beams, rods, values)
            largest = fill(rows, columns, lower, values, matrix)
            whole = factor(matrix, lower, envelope, pivots, ends, TINY * largest)
            both[k] = whole - _logarithm_of_product(at, divided)
        samples += 2
        place = pending + 1 if at_corner else pending
        waiting[0, place] = point
        waiting[1, place] = both[0] - at_zero * point
        waiting[2, place] = _principal(both[1] - both[0]) / step - at_zero
        pending += 1
