"""Compiled shooting matrix of whirl: its entries, determinant and node states, and kinetic-energy shares.

The matrix is laid out by `gearwhine.rotors.whirl.shooting_matrix`; the shares of complex motions serve
`gearwhine.rotors.whirl.motion`. Importing this module imports numba.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.banded_kernels import TINY, factor, fill, put
from gearwhine.numerics.compiled import FUSED, counted, inner
from gearwhine.rotors.transfer_matrix.timoshenko_kernels import element_transfer_matrices, transfer_matrix

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]
# Lengths (e,) and coefficients (e, 6 or 2, j) of the distinct elements, the index of each among them, (p,), the nodes
# between which elements form a run, (r + 1,), and for each run the first equal one, (r,).
Runs = tuple[FloatArray, FloatArray, IntArray, IntArray, IntArray]
# Blocks (of which 1 and −1 are bending, 0 axial motion), beams, rods, numerators (t, 5), denominators (t, 2) and
# constants (c,).
Table = tuple[IntArray, Runs, Runs, ComplexArray, FloatArray, ComplexArray]
# Rows and columns of the entries (nnz,), envelope (order, 2), numbers of diagonals below and above the main one.
Pattern = tuple[IntArray, IntArray, IntArray, int, int]


@inner(error_model="python", fastmath=FUSED)
def _times(left: ComplexArray, right: ComplexArray, out: ComplexArray) -> None:
    """Product of two matrices of order 2 or 4, with unrolled inner loops."""
    if left.shape[0] == 2:
        for i in range(2):
            for j in range(2):
                out[i, j] = left[i, 0] * right[0, j] + left[i, 1] * right[1, j]
        return
    for i in range(4):
        for j in range(4):
            near = left[i, 0] * right[0, j] + left[i, 1] * right[1, j]
            out[i, j] = near + left[i, 2] * right[2, j] + left[i, 3] * right[3, j]


@counted(error_model="python", no_cpython_wrapper=True, fastmath=FUSED)
def _put_runs(
    runs: Runs, translation: complex, rotation: complex, scale: float, transfer_matrices: Any, out: ComplexArray
) -> int:
    """Put −T of every run of elements, forces in the given unit, at the start of ``out``; return their number."""
    lengths, coefficients, element, run_ends, like = runs
    whole, over = np.ones(1), 1.0 / scale
    size, half, spare = transfer_matrices.shape[2], transfer_matrices.shape[2] // 2, lengths.size
    for e in range(lengths.size):
        transfer_matrix(lengths[e], coefficients[e], translation, rotation, whole, transfer_matrices[e])
    entry = 0
    for run in range(run_ends.size - 1):
        if like[run] < run:
            for same in range(like[run] * size * size, (like[run] + 1) * size * size):
                out[entry] = out[same]
                entry += 1
            continue
        product = element[run_ends[run]]
        for number in range(run_ends[run] + 1, run_ends[run + 1]):
            # Two spare matrices take turns.
            following = spare + 1 if product == spare else spare
            _times(
                transfer_matrices[element[number], 0], transfer_matrices[product, 0], transfer_matrices[following, 0]
            )
            product = following
        for i in range(size):
            for j in range(size):
                # Displacements from forces, and forces from displacements.
                unit = scale if i < half <= j else (over if j < half <= i else 1.0)
                value = transfer_matrices[product, 0, i, j]
                out[entry] = complex(-unit * value.real, -unit * value.imag)
                entry += 1
    return entry


@inner(error_model="python")
def force_unit(at: complex, mass: float) -> float:
    """Return the unit of force for roots near λ, as `gearwhine.rotors.whirl.equations.WhirlEquations.force_scale`."""
    return min(max((at.real**2 + at.imag**2) * mass, 1e-30), 1.0)


@counted(error_model="python", no_cpython_wrapper=True)
def scratch(table: Table, size: int) -> tuple[ComplexArray, ComplexArray, ComplexArray, int]:
    """Scratch arrays for the transfer matrices of beams and rods and two products of each, and for the entries, (nnz,).

    The constant entries are filled in, after the varying ones; the last number is that of the varying ones.
    """
    beams = np.empty((table[1][0].size + 2, 1, 4, 4), dtype=np.complex128)
    rods = np.empty((table[2][0].size + 2, 1, 2, 2), dtype=np.complex128)
    values, varying = np.empty(size, dtype=np.complex128), size - table[5].size
    put(table[5], values[varying:])
    return beams, rods, values, varying


@counted(error_model="python", no_cpython_wrapper=True, fastmath=FUSED)
def put_entries(
    at: complex, speed: complex, scale: float, table: Table, beams: ComplexArray, rods: ComplexArray, out: ComplexArray
) -> None:
    """Put the varying entries at one λ, speed Ω and unit of force into ``out``; all arrays are those of `scratch`."""
    blocks, beam_runs, rod_runs, numerators, denominators, _ = table
    squared, turning = at * at, speed * at
    first = 0
    for block in blocks:
        if block == 0:
            first += _put_runs(rod_runs, -squared, -squared, scale, rods, out[first:])
        else:
            first += _put_runs(beam_runs, -squared, -squared + block * 2j * turning, scale, beams, out[first:])
    for term in range(numerators.shape[0]):
        # No view of a row: making one takes longer than the row.
        top = numerators[term, 0] + numerators[term, 1] * at + numerators[term, 2] * squared
        top += numerators[term, 3] * turning + numerators[term, 4] * scale
        out[first + term] = top * (1.0 / (denominators[term, 0] * scale + denominators[term, 1]))


@counted(error_model="python")
def entries(at: ComplexArray, speeds: ComplexArray, scale: FloatArray, table: Table, out: ComplexArray) -> None:
    """Entries at every λ, (b, nnz)."""
    beams, rods, values, _ = scratch(table, out.shape[1])
    for b in range(at.size):
        put_entries(at[b], speeds[b], scale[b], table, beams, rods, values)
        put(values, out[b])


@counted(error_model="python")
def determinants(
    at: ComplexArray, speeds: ComplexArray, scale: FloatArray, table: Table, pattern: Pattern
) -> ComplexArray:
    """Logarithm of the determinant at every λ, (b,), its imaginary part within (−π, π]."""
    rows, columns, envelope, lower, upper = pattern
    order = envelope.shape[0]
    beams, rods, values, _ = scratch(table, rows.size)
    logarithms = np.empty(at.size, dtype=np.complex128)
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots, ends = np.empty(order, dtype=np.intp), np.empty(order, dtype=np.intp)
    for b in range(at.size):
        put_entries(at[b], speeds[b], scale[b], table, beams, rods, values)
        largest = fill(rows, columns, lower, values, matrix)
        logarithms[b] = factor(matrix, lower, envelope, pivots, ends, TINY * largest)
    return logarithms


@counted(error_model="python")
def node_states(
    runs: Runs,
    translation: ComplexArray,
    rotation: ComplexArray,
    places: IntArray,
    scale: FloatArray,
    solutions: ComplexArray,
    states: ComplexArray,
) -> None:
    """Fill in the states (w, p + 1, 2n) of one block at all nodes, those inside runs from the nodes before them.

    In ``solutions`` (w, order) the unknowns at ``places`` (r + 1, 2n) are the states where runs end, zero where a place
    is negative, their forces in units of ``scale`` (w,); ω² are those of ``translation`` and ``rotation``, (w,) both.
    """
    lengths, coefficients, element, run_ends, _ = runs
    size, whole = states.shape[2], np.ones(1)
    transfer_matrices = np.empty((lengths.size, 1, size, size), dtype=np.complex128)
    for w in range(states.shape[0]):
        for e in range(lengths.size):
            transfer_matrix(lengths[e], coefficients[e], translation[w], rotation[w], whole, transfer_matrices[e])
        for end in range(run_ends.size):
            for i in range(size):
                unit, place = scale[w] if i >= size // 2 else 1.0, places[end, i]
                states[w, run_ends[end], i] = unit * solutions[w, place] if place >= 0 else 0.0j
        for run in range(run_ends.size - 1):
            for node in range(run_ends[run] + 1, run_ends[run + 1]):
                transfer = transfer_matrices[element[node - 1], 0]
                for i in range(size):
                    total = transfer[i, 0] * states[w, node - 1, 0]
                    for j in range(1, size):
                        total += transfer[i, j] * states[w, node - 1, j]
                    states[w, node, i] = total


@counted(error_model="python")
def inertia_shares(
    elements: tuple[FloatArray, FloatArray, IntArray],
    translation: ComplexArray,
    rotation: ComplexArray,
    states: ComplexArray,
    fractions: FloatArray,
    along: FloatArray,
    nodal: FloatArray,
) -> FloatArray:
    """Weighted sums of |r|² and |β|² over Gauss points and nodes, for every motion, (w,).

    ``states`` (w, p + 1, 4) continue from the left end of every element at ω² of (w,) ``translation`` and ``rotation``;
    the weights are ``along`` (e, g, 2) at the ``fractions`` (g,) of the elements and ``nodal`` (p + 1, 2).
    """
    lengths, coefficients, element = elements
    transfer_matrices = np.empty((lengths.size, fractions.size, 4, 4), dtype=np.complex128)
    totals = np.zeros(states.shape[0])
    for w in range(states.shape[0]):
        for e in range(lengths.size):
            element_transfer_matrices(
                lengths[e], coefficients[e], translation[w], rotation[w], fractions, transfer_matrices[e]
            )
        for number in range(element.size):
            state, e = states[w, number], element[number]
            for g in range(fractions.size):
                transfer = transfer_matrices[e, g]
                for row in range(2):
                    value = transfer[row, 0] * state[0] + transfer[row, 1] * state[1]
                    value += transfer[row, 2] * state[2] + transfer[row, 3] * state[3]
                    totals[w] += along[e, g, row] * (value.real**2 + value.imag**2)
        for node in range(states.shape[1]):
            for row in range(2):
                value = states[w, node, row]
                totals[w] += nodal[node, row] * (value.real**2 + value.imag**2)
    return totals
