"""Compiled sampling of the determinant along a contour, for `rotors.winding`.

Importing this module imports numba.
"""

import cmath
import math

import numpy as np
import numpy.typing as npt

from .banded_kernels import TINY, factor, fill
from .compiled import counted, inner
from .entry_kernels import Pattern, Table, put_entries, scratch

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

# Factors are gathered up to these sizes before their logarithm is taken.
SMALL, LARGE = 1e-100, 1e100


@inner(error_model="python")
def _logarithm_of_product(at: complex, divided: ComplexArray) -> complex:
    """ln Π (λ − μ_k), but for whole turns."""
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
    """A difference of logarithms with the imaginary part brought into (−π, π]."""
    turns = math.floor(difference.imag / (2.0 * math.pi) + 0.5)
    return complex(difference.real, difference.imag - 2.0 * math.pi * turns)


@counted(error_model="python")
def walk(
    edge: ComplexArray,
    speed: ComplexArray,
    scale: float,
    divided: ComplexArray,
    limits: FloatArray,
    most_samples: int,
    table: Table,
    pattern: Pattern,
) -> tuple[int, int, ComplexArray]:
    """Follow ln q along a closed polygon of ln λ; how many points that took, how many determinants, and what they are.

    The last is (3, s), of which as many columns hold points, ln q and d ln q/dw; none where the path does not settle.

    ``edge`` ends with its first point; Ω = ``speed[0]`` + ``speed[1]`` λ. ``limits`` are the steepest and the largest
    misfit of a safe interval, the shortest one, and the part of an interval that is the second step of a sample. An
    interval that is not safe is halved: what its ends know of it does not depend on what was found elsewhere.
    """
    steepest, misfit, shortest, slope_part = limits[0], limits[1], limits[2], limits[3]
    rows, columns, envelope, lower, upper = pattern
    order, corners = envelope.shape[0], edge.size - 1
    beams, rods = scratch(table)
    values = np.empty(rows.size, dtype=np.complex128)
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots, ends = np.empty(order, dtype=np.intp), np.empty(order, dtype=np.intp)
    both = np.empty(2, dtype=np.complex128)
    found = np.empty((3, 64), dtype=np.complex128)
    # Behind the last point of ``found`` that is safe to go on from, points to come wait, the nearest at the end.
    waiting = np.empty((3, corners + 1 + 2 * int(-math.log2(shortest)) + 16), dtype=np.complex128)
    at_zero, samples, count, pending = 0, 0, 1, 0
    while True:
        # The points given come first, last to first; then those halfway between two that are too far apart.
        given = pending < corners and samples < 2 * corners
        if given:
            corner = corners - 1 - pending
            point, step = edge[corner], slope_part * (edge[corner + 1] - edge[corner])
        else:
            if samples == 2 * corners:
                # Motions at zero, of a free shaft, are outside: divided out like the others.
                at_zero = math.floor(waiting[2, corners].real + 0.5)
                for k in range(1, corners + 1):
                    waiting[1, k] -= at_zero * waiting[0, k]
                    waiting[2, k] -= at_zero
                # The contour's end is its beginning.
                waiting[0, 0], waiting[1, 0], waiting[2, 0] = edge[corners], waiting[1, corners], waiting[2, corners]
                for k in range(3):
                    found[k, 0] = waiting[k, corners]
            h = 0.0j
            while pending > 0:
                h = waiting[0, pending - 1] - found[0, count - 1]
                change = _principal(waiting[1, pending - 1] - found[1, count - 1])
                here, there = h * found[2, count - 1], h * waiting[2, pending - 1]
                if max(abs(here), abs(there)) > steepest or abs(change - 0.5 * (here + there)) > misfit:
                    break
                if count == found.shape[1]:
                    more = np.empty((3, 2 * count), dtype=np.complex128)
                    for row in range(3):
                        for k in range(count):
                            more[row, k] = found[row, k]
                    found = more
                found[0, count], found[2, count] = waiting[0, pending - 1], waiting[2, pending - 1]
                # Continued along the contour.
                found[1, count] = found[1, count - 1] + change
                count += 1
                pending -= 1
            if pending == 0:
                return count, samples, found
            if abs(h) < shortest or samples > most_samples or pending == waiting.shape[1]:
                return 0, samples, found
            point, step = found[0, count - 1] + 0.5 * h, 0.5 * slope_part * h
        for k in range(2):
            at = cmath.exp(point + k * step)
            put_entries(at, speed[0] + speed[1] * at, scale, table, beams, rods, values)
            largest = fill(rows, columns, lower, values, matrix)
            whole = factor(matrix, lower, envelope, pivots, ends, TINY * largest)
            both[k] = whole - _logarithm_of_product(at, divided)
        samples += 2
        place = pending + 1 if given else pending
        waiting[0, place] = point
        waiting[1, place] = both[0] - at_zero * point
        waiting[2, place] = _principal(both[1] - both[0]) / step - at_zero
        pending += 1
