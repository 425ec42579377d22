"""Compiled entries of the equations of `rotors.spatial_chain`, and their determinants; laid out by `rotors.entries`.

Importing this module imports numba.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

from .banded_kernels import TINY, factor, fill
from .compiled import counted
from .piece_kernels import piece_transfers

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]
# Lengths (e,), coefficients (e, 6 or 2, j) of the pieces that differ, and which of them each piece is, (p,).
Pieces = tuple[FloatArray, FloatArray, IntArray]
# Blocks (of which 1 and −1 are bending, 0 axial motion), beams, rods, numerators (t, 5) and denominators (t, 2).
Table = tuple[IntArray, Pieces, Pieces, ComplexArray, FloatArray]
# Rows and columns of the entries (nnz,), envelope (order, 2), and how many diagonals lie below and above the main one.
Pattern = tuple[IntArray, IntArray, IntArray, int, int]


@counted(error_model="python", no_cpython_wrapper=True)
def _put_pieces(
    pieces: Pieces, translation: complex, rotation: complex, scale: float, transfers: Any, out: ComplexArray
) -> int:
    """−T of every piece, forces in the given unit, into the beginning of ``out``; returns how many entries they are."""
    lengths, given, element = pieces
    whole = np.ones(1)
    size, half = transfers.shape[2], transfers.shape[2] // 2
    for e in range(lengths.size):
        piece_transfers(lengths[e], given[e], translation, rotation, whole, transfers[e])
        for i in range(half):
            for j in range(half):
                transfers[e, 0, i, half + j] *= scale
                transfers[e, 0, half + i, j] /= scale
    entry = 0
    for piece in range(element.size):
        for i in range(size):
            for j in range(size):
                out[entry] = -transfers[element[piece], 0, i, j]
                entry += 1
    return entry


@counted(error_model="python", no_cpython_wrapper=True)
def put_entries(
    at: complex, speed: complex, scale: float, table: Table, beams: ComplexArray, rods: ComplexArray, out: ComplexArray
) -> None:
    """Entries at one λ, speed Ω and unit of force, (nnz,); ``beams`` and ``rods`` (e, 1, 2n, 2n) are for scratch."""
    blocks, beam_pieces, rod_pieces, numerators, denominators = table
    squared, turning = at * at, speed * at
    first = 0
    for block in blocks:
        if block == 0:
            first += _put_pieces(rod_pieces, -squared, -squared, scale, rods, out[first:])
        else:
            first += _put_pieces(beam_pieces, -squared, -squared + block * 2j * turning, scale, beams, out[first:])
    for term in range(numerators.shape[0]):
        c = numerators[term]
        top = c[0] + c[1] * at + c[2] * squared + c[3] * turning + c[4] * scale
        out[first + term] = top / (denominators[term, 0] * scale + denominators[term, 1])


@counted(error_model="python")
def entries(at: ComplexArray, speeds: ComplexArray, scale: FloatArray, table: Table, out: ComplexArray) -> None:
    """Entries at every λ, (b, nnz)."""
    beams = np.empty((table[1][0].size, 1, 4, 4), dtype=np.complex128)
    rods = np.empty((table[2][0].size, 1, 2, 2), dtype=np.complex128)
    for b in range(at.size):
        put_entries(at[b], speeds[b], scale[b], table, beams, rods, out[b])


@counted(error_model="python")
def determinants(
    at: ComplexArray, speeds: ComplexArray, scale: FloatArray, table: Table, pattern: Pattern
) -> ComplexArray:
    """Logarithm of the determinant at every λ, (b,), its imaginary part within (−π, π]."""
    rows, columns, envelope, lower, upper = pattern
    order = envelope.shape[0]
    beams = np.empty((table[1][0].size, 1, 4, 4), dtype=np.complex128)
    rods = np.empty((table[2][0].size, 1, 2, 2), dtype=np.complex128)
    values, logarithms = np.empty(rows.size, dtype=np.complex128), np.empty(at.size, dtype=np.complex128)
    matrix = np.empty((order, 2 * lower + upper + 1), dtype=np.complex128)
    pivots, ends = np.empty(order, dtype=np.intp), np.empty(order, dtype=np.intp)
    for b in range(at.size):
        put_entries(at[b], speeds[b], scale[b], table, beams, rods, values)
        largest = fill(rows, columns, lower, values, matrix)
        logarithms[b] = factor(matrix, lower, envelope, pivots, ends, TINY * largest)
    return logarithms
