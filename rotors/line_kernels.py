"""Compiled discretisation of a shaft: spans cut into elements by the rule of `rotors.lines`.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from .compiled import counted, inner

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
BoolArray = npt.NDArray[np.bool_]

PieceArrays = tuple[FloatArray, IntArray, IntArray, IntArray, FloatArray, FloatArray, FloatArray]


@inner(error_model="python")
def longest_piece(squared: float, stiffness: FloatArray, inertia: FloatArray, force: float) -> float:
    """Length (m) of the longest piece of one kind that has no root below ω² with clamped ends."""
    mass = squared * inertia[0]
    if stiffness.size == 1:
        return math.pi * math.sqrt(stiffness[0] / mass) if mass > 0.0 else math.inf
    # Tension counts like compression: its fields grow as fast.
    linear = squared * inertia[1] + 2.0 * abs(force)
    divisor = linear + math.sqrt(linear**2 + 8.0 * mass * stiffness[1])
    if divisor == 0.0:
        return math.inf
    by_bending = 2.0 * stiffness[1] / divisor
    if mass == 0.0:
        return math.pi * math.sqrt(by_bending)
    by_shear = (0.5 * stiffness[0] - max(-force, 0.0)) / mass
    return math.pi * math.sqrt(min(by_shear, by_bending))


@counted(error_model="python")
def piece_counts(
    highest: float,
    margin: float,
    kind: IntArray,
    lengths: FloatArray,
    stiffness: FloatArray,
    inertia: FloatArray,
    force: FloatArray,
) -> FloatArray:
    """Number of pieces of each span, (s,); as floats, which cannot overflow."""
    longest = np.empty(force.size)
    for k in range(force.size):
        longest[k] = longest_piece(highest * highest, stiffness[k], inertia[k], force[k])
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
) -> PieceArrays:
    """Nodes (p + 1,), the old nodes' indices in them, every piece's element (p,), and of every element its kind,
    the middle and half width of the part of that kind it covers (from −1 to 1), and its length, (e,) each."""
    total = counts.sum()
    new_nodes, element, index = np.empty(total + 1), np.empty(total, np.intp), np.empty(nodes.size, np.intp)
    which, piece_length = np.empty(total, np.intp), np.empty(total)
    middle, half = np.empty(total), np.empty(total)
    piece, elements = 0, 0
    for span in range(counts.size):
        index[span] = piece
        count = counts[span]
        length, part = lengths[span] / count, (end[span] - start[span]) / count
        known = -1
        if uniform[kind[span]]:
            for e in range(elements):
                if which[e] == kind[span] and piece_length[e] == length:
                    known = e
                    break
        for k in range(count):
            new_nodes[piece] = nodes[span] + k * ((nodes[span + 1] - nodes[span]) / count)
            if known < 0 or not uniform[kind[span]]:
                known = elements
                which[elements], piece_length[elements] = kind[span], length
                middle[elements], half[elements] = 2.0 * (start[span] + k * part) + part - 1.0, part
                elements += 1
            element[piece] = known
            piece += 1
    new_nodes[piece], index[-1] = nodes[-1], piece
    return (
        new_nodes,
        index,
        element,
        which[:elements].copy(),
        middle[:elements].copy(),
        half[:elements].copy(),
        piece_length[:elements].copy(),
    )
