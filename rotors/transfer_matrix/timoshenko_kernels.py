"""Compiled transfer matrices of Timoshenko beam and rod elements, and the cutting of a shaft into them.

The equations are those of `gearwhine.rotors.transfer_matrix.timoshenko`; all functions of them take real or complex ω².
Spans are cut into elements by the rule of `gearwhine.rotors.transfer_matrix.discretised_shaft`. Importing this module
imports numba.
"""

import math
from math import factorial
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.compiled import FINITE, counted, inner

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
NumberArray = npt.NDArray[Any]

# |λ²| of an element stays below 5 (`gearwhine.rotors.transfer_matrix.discretised_shaft`): 5¹³ / 26! is below rounding.
CLOSED_TERMS = 13
EVEN = np.array([1.0 / factorial(2 * k) for k in range(CLOSED_TERMS)])
ODD = np.array([1.0 / factorial(2 * k + 1) for k in range(CLOSED_TERMS)])
# With ρ ≥ |λ²| the terms from the N-th on are below N max(2 ρᴺ⁻¹, ρᴺ) / (2N)!, and their slopes, needed for
# complex-step differentiation, below 24 N (N − 1) ρᴺ⁻² / (2N)! of the first one's. For every N, the largest ρ at which
# both are rounding. Four terms have all slopes at zero.
ROUNDING = 5e-17
LEAST_TERMS = 4
REACH = np.array(
    [0.0] * LEAST_TERMS
    + [
        min(
            (ROUNDING * factorial(2 * n) / (2 * n)) ** (1.0 / (n - 1)),
            (ROUNDING * factorial(2 * n) / n) ** (1.0 / n),
            (ROUNDING * factorial(2 * n) / (24 * n * (n - 1))) ** (1.0 / (n - 2)),
        )
        for n in range(LEAST_TERMS, CLOSED_TERMS)
    ]
)
# Most terms of the power series along a cone; about 25 are needed.
MOST_TERMS = 80
NEGLIGIBLE = 1e-18
BoolArray = npt.NDArray[np.bool_]

ElementArrays = tuple[FloatArray, IntArray, IntArray, IntArray, FloatArray, FloatArray, FloatArray]


@inner(error_model="python", fastmath=FINITE)
def timoshenko_transfer_matrix(
    h: float, coefficients: FloatArray, translation: Any, rotation: Any, out: NumberArray
) -> None:
    """T of a uniform beam of length h by its closed form; ``coefficients`` (6,) as in `ShaftElements`."""
    a, b, k = coefficients[0] * h, coefficients[1] * h, coefficients[4] * h
    m, j = translation * coefficients[2] * h, (rotation * coefficients[3] - coefficients[5]) * h
    am, bj, bk, km = a * m, b * j, b * k, k * m
    e1, e2 = -(am + bj), b * m * (a * j - k * k)
    older, newer = 0.0 * e1, 0.0 * e1 + 1.0
    even_low, odd_low = older, older
    c2, c3 = newer * EVEN[1], newer * ODD[1]
    # Short elements need few terms: neither λ² exceeds |e₁| + |e₂|^½.
    size = abs(e1.real) + abs(e1.imag) + math.sqrt(abs(e2.real) + abs(e2.imag))
    terms = LEAST_TERMS
    while terms < CLOSED_TERMS and size > REACH[terms]:
        terms += 1
    for n in range(2, terms):
        even_low += newer * EVEN[n]
        odd_low += newer * ODD[n]
        older, newer = newer, e1 * newer - e2 * older
        c2 += newer * EVEN[n]
        c3 += newer * ODD[n]
    c0, c1 = 1.0 - e2 * even_low, 1.0 - e2 * odd_low
    # The powers of A h, written out; A h = [[0, k, a, 0], [0, 0, 0, b], [-m, 0, 0, 0], [0, -j, -k, 0]].
    out[0, 0] = out[2, 2] = c0 - c2 * am
    out[1, 1] = out[3, 3] = c0 - c2 * bj
    out[0, 1] = k * (c1 - c3 * (am + bj))
    out[3, 2] = -out[0, 1]
    out[0, 2] = c1 * a - c3 * (bk * k + am * a)
    out[0, 3] = c2 * bk
    out[1, 2] = -out[0, 3]
    out[1, 0] = c3 * bk * m
    out[2, 3] = -out[1, 0]
    out[1, 3] = b * (c1 - c3 * bj)
    out[2, 0] = -m * (c1 - c3 * am)
    out[3, 0] = c2 * km
    out[2, 1] = -out[3, 0]
    out[3, 1] = -c1 * j + c3 * (bj * j + km * k)


@inner(error_model="python", fastmath=FINITE)
def rod_transfer_matrix(h: float, coefficients: FloatArray, translation: Any, out: NumberArray) -> None:
    """T of a uniform rod of length h, by the series of cosine and sine."""
    twist, swing = coefficients[0] * h, translation * coefficients[1] * h
    root = -twist * swing
    cosine, sine, power = 0.0 * root + 1.0, 0.0 * root + 1.0, 0.0 * root + 1.0
    for n in range(1, CLOSED_TERMS):
        power = power * root
        cosine += power * EVEN[n]
        sine += power * ODD[n]
    out[0, 0] = out[1, 1] = cosine
    out[0, 1] = sine * twist
    out[1, 0] = -sine * swing


@inner(error_model="python")
def taper_power_series(h: float, coefficients: FloatArray, translation: Any, rotation: Any, series: NumberArray) -> int:
    """Power series of the fundamental matrix about the middle of a tapering element; returns its number of terms.

    With s from −1 to 1, y(s) = Σ Y_k s^k · y(0) and Y_{k+1} = h/2 Σ_j A_j Y_{k−j} / (k + 1).
    """
    beam, order, size = coefficients.shape[0] == 6, coefficients.shape[1], series.shape[1]
    for row in range(size):
        for column in range(size):
            series[0, row, column] = 1.0 if row == column else 0.0
    quiet = 0
    for k in range(MOST_TERMS - 1):
        factor, largest = 0.5 * h / (k + 1), 0.0
        for column in range(size):
            rows = (0.0 * (translation + rotation), 0.0 * (translation + rotation))
            y0, y1 = rows
            y2, y3 = rows
            for j in range(min(k + 1, order)):
                older = series[k - j]
                if beam:
                    y0 += coefficients[4, j] * older[1, column] + coefficients[0, j] * older[2, column]
                    y1 += coefficients[1, j] * older[3, column]
                    y2 -= translation * coefficients[2, j] * older[0, column]
                    y3 -= (rotation * coefficients[3, j] - coefficients[5, j]) * older[1, column] + coefficients[
                        4, j
                    ] * older[2, column]
                else:
                    y0 += coefficients[0, j] * older[1, column]
                    y1 -= translation * coefficients[1, j] * older[0, column]
            series[k + 1, 0, column] = factor * y0
            series[k + 1, 1, column] = factor * y1
            if beam:
                series[k + 1, 2, column] = factor * y2
                series[k + 1, 3, column] = factor * y3
            for row in range(size):
                largest = max(largest, abs(series[k + 1, row, column]))
        # Two small terms in a row: one may vanish by symmetry.
        quiet = quiet + 1 if largest < NEGLIGIBLE else 0
        if quiet == 2:
            return k + 2
    return MOST_TERMS


@inner(error_model="python")
def series_at(series: NumberArray, terms: int, place: float, out: NumberArray) -> None:
    """Value of the power series of a fundamental matrix at s."""
    size = out.shape[0]
    for row in range(size):
        for column in range(size):
            value = series[terms - 1, row, column]
            for k in range(terms - 2, -1, -1):
                value = value * place + series[k, row, column]
            out[row, column] = value


@inner(error_model="python")
def symplectic_inverse(matrix: NumberArray, out: NumberArray) -> None:
    """Inverse of a fundamental matrix, which reciprocity makes symplectic: −J Mᵀ J."""
    n = matrix.shape[0] // 2
    for row in range(n):
        for column in range(n):
            out[row, column] = matrix[n + column, n + row]
            out[row, n + column] = -matrix[column, n + row]
            out[n + row, column] = -matrix[n + column, row]
            out[n + row, n + column] = matrix[column, row]


@counted(error_model="python", no_cpython_wrapper=True)
def element_transfer_matrices(
    h: float, coefficients: FloatArray, translation: Any, rotation: Any, fractions: FloatArray, out: NumberArray
) -> None:
    """T from an element's left end to fractions (k,) of its length h, into ``out`` (k, 2n, 2n)."""
    if coefficients.shape[1] == 1:
        for k in range(fractions.size):
            if coefficients.shape[0] == 6:
                timoshenko_transfer_matrix(fractions[k] * h, coefficients[:, 0], translation, rotation, out[k])
            else:
                rod_transfer_matrix(fractions[k] * h, coefficients[:, 0], translation, out[k])
        return
    size = out.shape[1]
    series = np.empty((MOST_TERMS, size, size), out.dtype)
    value, inverse = np.empty((size, size), out.dtype), np.empty((size, size), out.dtype)
    terms = taper_power_series(h, coefficients, translation, rotation, series)
    series_at(series, terms, -1.0, value)
    symplectic_inverse(value, inverse)
    for k in range(fractions.size):
        series_at(series, terms, 2.0 * fractions[k] - 1.0, value)
        for row in range(size):
            for column in range(size):
                total = value[row, 0] * inverse[0, column]
                for middle in range(1, size):
                    total += value[row, middle] * inverse[middle, column]
                out[k, row, column] = total


@counted(error_model="python", no_cpython_wrapper=True)
def transfer_matrix(
    h: float, coefficients: FloatArray, translation: Any, rotation: Any, whole: FloatArray, out: NumberArray
) -> None:
    """Transfer matrix T of a whole element into ``out`` (1, 2n, 2n), faster for uniform beams; ``whole`` is one."""
    if coefficients.shape[0] == 6 and coefficients.shape[1] == 1:
        timoshenko_transfer_matrix(h, coefficients[:, 0], translation, rotation, out[0])
    else:
        element_transfer_matrices(h, coefficients, translation, rotation, whole, out)


@counted(error_model="python")
def table_transfer_matrices(
    lengths: FloatArray,
    coefficients: FloatArray,
    translation: NumberArray,
    rotation: NumberArray,
    fractions: FloatArray,
    out: NumberArray,
) -> None:
    """T of every element of a table at every pair of ω² (b,), into ``out`` (b, e, k, 2n, 2n)."""
    for b in range(translation.size):
        for e in range(lengths.size):
            element_transfer_matrices(lengths[e], coefficients[e], translation[b], rotation[b], fractions, out[b, e])


@counted(error_model="python")
def place_transfer_matrices(
    lengths: FloatArray,
    coefficients: FloatArray,
    element: IntArray,
    fractions: FloatArray,
    translation: NumberArray,
    rotation: NumberArray,
    out: NumberArray,
) -> None:
    """T to one fraction each of some elements (z,), at every pair of ω² (b,), into ``out`` (z, b, 2n, 2n)."""
    for z in range(element.size):
        e = element[z]
        for b in range(translation.size):
            element_transfer_matrices(
                lengths[e], coefficients[e], translation[b], rotation[b], fractions[z : z + 1], out[z, b : b + 1]
            )


@inner(error_model="python")
def longest_element(squared: float, stiffness: FloatArray, inertia: FloatArray, force: float) -> float:
    """Length [m] of the longest element of one kind that has no root below ω² with clamped ends."""
    mass = squared * inertia[0]
    if stiffness.size == 1:
        return math.pi * math.sqrt(stiffness[0] / mass) if mass > 0.0 else math.inf
    # Tension counts like compression: its fields grow as fast. Only couplings, which are massless, have g above 2.
    linear = squared * inertia[1] + max(2.0, stiffness[0] / (stiffness[0] + force)) * abs(force)
    divisor = linear + math.sqrt(linear**2 + 8.0 * mass * stiffness[1])
    if divisor == 0.0:
        return math.inf
    by_bending = 2.0 * stiffness[1] / divisor
    if mass == 0.0:
        return math.pi * math.sqrt(by_bending)
    by_shear = (0.5 * stiffness[0] - max(-force, 0.0)) / mass
    return math.pi * math.sqrt(min(by_shear, by_bending))


@counted(error_model="python")
def element_counts(
    highest: float,
    margin: float,
    kind: IntArray,
    lengths: FloatArray,
    stiffness: FloatArray,
    inertia: FloatArray,
    force: FloatArray,
) -> FloatArray:
    """Return the number of elements of each span, (s,); as floats, which cannot overflow."""
    longest = np.empty(force.size)
    for k in range(force.size):
        longest[k] = longest_element(highest * highest, stiffness[k], inertia[k], force[k])
    counts = np.empty(kind.size)
    for span in range(kind.size):
        counts[span] = max(1.0, math.ceil(margin * lengths[span] / longest[kind[span]]))
    return counts


@counted(error_model="python")
def cut_spans(
    counts: IntArray,
    nodes: FloatArray,
    kind: IntArray,
    start: FloatArray,
    end: FloatArray,
    lengths: FloatArray,
    uniform: BoolArray,
) -> ElementArrays:
    """Cut spans into equal elements; elements that are alike are listed once.

    Returns the nodes (p + 1,), the old nodes' indices in them, the place of each of the p elements in the list (p,),
    and of every element of the list its kind, the middle and half width of the part of that kind it covers (from −1
    to 1), and its length, (e,) each.
    """
    total = counts.sum()
    new_nodes, element, index = np.empty(total + 1), np.empty(total, np.intp), np.empty(nodes.size, np.intp)
    which, element_length = np.empty(total, np.intp), np.empty(total)
    middle, half = np.empty(total), np.empty(total)
    number, elements = 0, 0
    for span in range(counts.size):
        index[span] = number
        count = counts[span]
        length, part = lengths[span] / count, (end[span] - start[span]) / count
        listed = -1
        if uniform[kind[span]]:
            for e in range(elements):
                if which[e] == kind[span] and element_length[e] == length:
                    listed = e
                    break
        for k in range(count):
            new_nodes[number] = nodes[span] + k * ((nodes[span + 1] - nodes[span]) / count)
            if listed < 0 or not uniform[kind[span]]:
                listed = elements
                which[elements], element_length[elements] = kind[span], length
                middle[elements], half[elements] = 2.0 * (start[span] + k * part) + part - 1.0, part
                elements += 1
            element[number] = listed
            number += 1
    new_nodes[number], index[-1] = nodes[-1], number
    return (
        new_nodes,
        index,
        element,
        which[:elements].copy(),
        middle[:elements].copy(),
        half[:elements].copy(),
        element_length[:elements].copy(),
    )
