"""Compiled search for natural frequencies inside brackets of the Wittrick-Williams root count.

Importing this module imports numba. The arrays of a chain come in the order of `rotors.count_kernels`.
"""

import math

import numpy as np
import numpy.typing as npt

from .compiled import counted
from .count_kernels import count_at

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

# Final width of the brackets of multiple roots; steps towards single roots end at a few units of rounding.
RELATIVE_WIDTH = 2e-13
LAST_STEP = 5e-15
MOST_STEPS = 200
FIRST_PART = 0.04


@counted(error_model="python")
def lowest_roots(
    wanted: int,
    zeros: int,
    lowest: float,
    limit: float,
    lengths: FloatArray,
    given: FloatArray,
    element: IntArray,
    stiffness: FloatArray,
    inertia: FloatArray,
) -> tuple[int, int, FloatArray]:
    """Counts at two frequencies and, if they enclose them, the roots numbered ``zeros`` to ``wanted``, ascending.

    Every root has a bracket of its own, with counts below and above it at the ends; each evaluation narrows all
    brackets. A bracket with a single root has determinants of both signs at its ends and is closed by the inverse
    quadratic steps of Chandrupatla (Adv. Eng. Softw. 28, 1997), which fall back to halving; the count, not the
    determinant, decides on which side of the root a step lies. Other brackets are halved.
    """
    size = 2 * stiffness.shape[1]
    transfer_matrices = np.empty((lengths.size, 1, size, size))
    number = wanted - zeros
    first, first_value = count_at(lowest, lengths, given, element, stiffness, inertia, transfer_matrices)
    last, last_value = count_at(limit, lengths, given, element, stiffness, inertia, transfer_matrices)
    if first > zeros or last < wanted:
        return first, last, np.empty(0)
    low, high = np.full(number, lowest), np.full(number, limit)
    low_count, high_count = np.full(number, first), np.full(number, last)
    value_low, value_high = np.full(number, first_value), np.full(number, last_value)
    roots = np.empty(number)
    for root in range(number):
        order = zeros + root
        for _ in range(MOST_STEPS):
            single = low_count[root] == order and high_count[root] == order + 1
            a, b = low[root], high[root]
            if (single and b <= 4.0 * a) or b - a <= RELATIVE_WIDTH * b:
                break
            middle = math.sqrt(a) * math.sqrt(b) if b > 4.0 * a else 0.5 * (a + b)
            if a == lowest and b == limit:
                # The lowest frequency is seldom lower than this part of the limit.
                middle = max(middle, FIRST_PART * limit)
            count, value = count_at(middle, lengths, given, element, stiffness, inertia, transfer_matrices)
            for k in range(root, number):
                if count <= zeros + k:
                    if middle > low[k]:
                        low[k], low_count[k], value_low[k] = middle, count, value
                elif middle < high[k]:
                    high[k], high_count[k], value_high[k] = middle, count, value
        a, b = low[root], high[root]
        if b - a <= RELATIVE_WIDTH * b:
            roots[root] = 0.5 * (a + b)
            continue
        # x1 is the newest point, x2 the other end of its bracket, x3 the one before.
        x1, x2, f1, f2 = b, a, value_high[root], value_low[root]
        above, share = True, 0.5
        x3, f3 = x2, f2
        for _ in range(MOST_STEPS):
            x = x1 + share * (x2 - x1)
            count, value = count_at(x, lengths, given, element, stiffness, inertia, transfer_matrices)
            if (count > order) == above:
                x3, f3 = x1, f1
            else:
                x3, f3, x2, f2 = x2, f2, x1, f1
                above = not above
            x1, f1 = x, value
            roots[root] = x1 if abs(f1) < abs(f2) else x2
            least = LAST_STEP * roots[root] / abs(x2 - x1) if x2 != x1 else 1.0
            if least > 0.5 or value == 0.0:
                break
            xi, phi = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2) if f3 != f2 else 2.0
            share = 0.5
            if phi * phi < xi and (1.0 - phi) * (1.0 - phi) < 1.0 - xi and f1 != f2 and f3 != f1:
                share = f1 / (f2 - f1) * f3 / (f2 - f3) + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
            share = min(max(share, least), 1.0 - least)
    return first, last, roots
