"""Compiled Wittrick-Williams root count of a discretised shaft, and the natural frequencies in its brackets.

The derivation is in `gearwhine.rotors.transfer_matrix.wittrick_williams`. The arrays of a discretised shaft come in one
order throughout: lengths and coefficients of the distinct shaft elements, the index of each element among them, and
stiffness and inertia of the nodes. Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.compiled import counted, inner
from gearwhine.rotors.transfer_matrix.timoshenko_kernels import element_transfer_matrices

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
State = tuple[float, float, float, float]

# Fraction of a whole element.
WHOLE = np.ones(1)


@inner(error_model="python")
def _combined(c: float, first: State, s: float, second: State) -> State:
    return (
        c * first[0] + s * second[0],
        c * first[1] + s * second[1],
        c * first[2] + s * second[2],
        c * first[3] + s * second[3],
    )


@inner(error_model="python")
def _inner(first: State, second: State) -> float:
    return first[0] * second[0] + first[1] * second[1] + first[2] * second[2] + first[3] * second[3]


@inner(error_model="python")
def _orthonormal(first: State, second: State) -> tuple[State, State]:
    """Orthonormal states of the same span and orientation, by Gram-Schmidt."""
    first = _combined(1.0 / math.sqrt(_inner(first, first)), first, 0.0, first)
    second = _combined(1.0, second, -_inner(first, second), first)
    return first, _combined(1.0 / math.sqrt(_inner(second, second)), second, 0.0, second)


@inner(error_model="python")
def _moved(transfer: FloatArray, y: State) -> State:
    return (
        transfer[0, 0] * y[0] + transfer[0, 1] * y[1] + transfer[0, 2] * y[2] + transfer[0, 3] * y[3],
        transfer[1, 0] * y[0] + transfer[1, 1] * y[1] + transfer[1, 2] * y[2] + transfer[1, 3] * y[3],
        transfer[2, 0] * y[0] + transfer[2, 1] * y[1] + transfer[2, 2] * y[2] + transfer[2, 3] * y[3],
        transfer[3, 0] * y[0] + transfer[3, 1] * y[1] + transfer[3, 2] * y[2] + transfer[3, 3] * y[3],
    )


@inner(error_model="python")
def _with_term(first: State, second: State, row: int, term: float) -> tuple[State, State, float]:
    """States after a node's spring or inertia on displacement ``row``, and the size of that displacement."""
    size = math.hypot(first[row], second[row])
    if size > 0.0:
        c, s = first[row] / size, second[row] / size
        first, second = _combined(c, first, s, second), _combined(c, second, -s, first)
    elif abs(second[2 + row]) > abs(first[2 + row]):
        # At a root hit to the last digit nothing moves here: the state closer to the reaction is replaced by it.
        first, second = second, _combined(-1.0, first, 0.0, first)
    is_rigid = math.isinf(term)
    if row == 0:
        second = (0.0, second[1], second[2], second[3])
        first = (0.0, 0.0, 1.0, 0.0) if is_rigid else (first[0], first[1], first[2] + term * first[0], first[3])
    else:
        second = (second[0], 0.0, second[2], second[3])
        first = (0.0, 0.0, 0.0, 1.0) if is_rigid else (first[0], first[1], first[2], first[3] + term * first[1])
    first, second = _orthonormal(first, second)
    return first, second, size


@inner(error_model="python")
def _beam_count(
    squared: float, transfer_matrices: FloatArray, element: IntArray, stiffness: FloatArray, inertia: FloatArray
) -> tuple[int, float]:
    """Count a beam's roots below ω² and return the determinant there, from the left part's two admissible states."""
    first, second = (1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)
    sign, total, scale = 1.0, 0, 1.0
    last = element.size
    for node in range(last + 1):
        held_x, held_b = math.isinf(stiffness[node, 0]), math.isinf(stiffness[node, 1])
        term_x = stiffness[node, 0] - squared * inertia[node, 0]
        term_b = stiffness[node, 1] - squared * inertia[node, 1]
        if term_x != 0.0:
            first, second, _ = _with_term(first, second, 0, term_x)
        if term_b != 0.0:
            first, second, size = _with_term(first, second, 1, term_b)
            if held_x and held_b and scale > 1e-200:
                # A clamp separates the shaft: the determinant is the product of those of both sides.
                scale *= size
        determinant = first[0] * second[1] - first[1] * second[0]
        mixed = second[1] * first[2] + first[0] * second[3] - first[1] * second[2] - second[0] * first[3]
        if node == last:
            closing = first[2] * second[3] - first[3] * second[2]
            negative = (closing < 0.0) != (sign < 0.0)
            trace = 0.0
        else:
            transfer = transfer_matrices[element[node]]
            next_first, next_second = _moved(transfer, first), _moved(transfer, second)
            closing = next_first[0] * next_second[1] - next_first[1] * next_second[0]
            negative = (closing < 0.0) != (sign < 0.0)
            far = transfer[0, 2] * transfer[1, 3] - transfer[0, 3] * transfer[1, 2]
            trace = (
                transfer[1, 3] * transfer[0, 0]
                + transfer[0, 2] * transfer[1, 1]
                - transfer[0, 3] * transfer[1, 0]
                - transfer[1, 2] * transfer[0, 1]
            ) / far
        if negative:
            total += 1
        elif not (held_x or held_b) and trace * abs(determinant) + sign * mixed < 0.0:
            total += 2
        if node < last:
            sign = -1.0 if closing < 0.0 else 1.0
            first, second = _orthonormal(next_first, next_second)
    return total, closing * scale


@inner(error_model="python")
def _rod_count(
    squared: float, transfer_matrices: FloatArray, element: IntArray, stiffness: FloatArray, inertia: FloatArray
) -> tuple[int, float]:
    """Count a rod's roots below ω² and return the determinant there, from the left part's one admissible state."""
    u, f, sign, total, scale = 1.0, 0.0, 1.0, 0, 1.0
    for node in range(element.size + 1):
        if math.isinf(stiffness[node, 0]):
            if scale > 1e-200:
                scale *= abs(u)
            # A single state cannot be rotated: the reaction keeps the sign of its displacement.
            u, f = 0.0, sign
        else:
            f += (stiffness[node, 0] - squared * inertia[node, 0]) * u
        if node == element.size:
            break
        transfer = transfer_matrices[element[node]]
        u, f = transfer[0, 0] * u + transfer[0, 1] * f, transfer[1, 0] * u + transfer[1, 1] * f
        if (u < 0.0) != (sign < 0.0):
            total += 1
        sign = -1.0 if u < 0.0 else 1.0
        size = math.hypot(u, f)
        u, f = u / size, f / size
    if (f < 0.0) != (sign < 0.0):
        total += 1
    # The count's parity is the determinant's sign.
    return total, (-1.0 if total % 2 else 1.0) * abs(f) / math.hypot(u, f) * scale


@counted(error_model="python", no_cpython_wrapper=True)
def count_at(
    frequency: float,
    lengths: FloatArray,
    coefficients: FloatArray,
    element: IntArray,
    stiffness: FloatArray,
    inertia: FloatArray,
    transfer_matrices: FloatArray,
) -> tuple[int, float]:
    """Count roots below a frequency; the determinant there follows. ``transfer_matrices`` (e, 1, 2n, 2n) is scratch."""
    squared = frequency * frequency
    for e in range(lengths.size):
        element_transfer_matrices(lengths[e], coefficients[e], squared, squared, WHOLE, transfer_matrices[e])
    if coefficients.shape[1] == 6:
        return _beam_count(squared, transfer_matrices[:, 0], element, stiffness, inertia)
    return _rod_count(squared, transfer_matrices[:, 0], element, stiffness, inertia)


@counted(error_model="python")
def wittrick_williams_count_of(
    frequency: float,
    lengths: FloatArray,
    coefficients: FloatArray,
    element: IntArray,
    stiffness: FloatArray,
    inertia: FloatArray,
) -> int:
    """Return the number of roots below a frequency."""
    size = 2 * stiffness.shape[1]
    transfer_matrices = np.empty((lengths.size, 1, size, size))
    return count_at(frequency, lengths, coefficients, element, stiffness, inertia, transfer_matrices)[0]


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
    coefficients: FloatArray,
    element: IntArray,
    stiffness: FloatArray,
    inertia: FloatArray,
) -> tuple[int, int, FloatArray]:
    """Solve for the roots numbered ``zeros`` to ``wanted``, ascending, if two frequencies enclose them; return counts.

    Every root has a bracket of its own, with counts below and above it at the ends; each evaluation narrows all
    brackets. A bracket with a single root has determinants of both signs at its ends and is closed by the inverse
    quadratic steps of Chandrupatla (Adv. Eng. Softw. 28, 1997), which fall back to halving; the count, not the
    determinant, decides on which side of the root a step lies. Other brackets are halved.
    """
    size = 2 * stiffness.shape[1]
    transfer_matrices = np.empty((lengths.size, 1, size, size))
    number = wanted - zeros
    first, first_value = count_at(lowest, lengths, coefficients, element, stiffness, inertia, transfer_matrices)
    last, last_value = count_at(limit, lengths, coefficients, element, stiffness, inertia, transfer_matrices)
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
                # Part of the limit below which the lowest frequency seldom lies.
                middle = max(middle, FIRST_PART * limit)
            count, value = count_at(middle, lengths, coefficients, element, stiffness, inertia, transfer_matrices)
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
            count, value = count_at(x, lengths, coefficients, element, stiffness, inertia, transfer_matrices)
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
