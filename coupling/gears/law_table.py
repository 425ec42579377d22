r"""Memory layout of a tooth contact law: one row of numbers for the compiled kernels.

The teeth of a mesh are a base pitch apart, so the phase fixes the positions of all pairs: pair j is at ``x + j``, x the
phase's fraction. All curves of all pairs are therefore cut at common knots of x, and one look-up finds what the law
needs of every pair. An interval is found by an index instead of a search: the period is cut into equal parts, and each
names the interval in which it begins; from there the search goes forward by few steps, mostly none.

The row begins with `HEADER` numbers, at the places named below; then come

* the parts, with the number of an interval each;
* the intervals, `INTERVAL` numbers each: where it begins and one over its width. One more begins at 1, where steps end;
* the pairs, `PAIR` numbers each, by kind of pair, interval and pair. First the cubic of its gap [m] in a variable from
  0 to 1 over the interval; then that of its stiffness [N/m] or, for an uneven load across the face, the number of its
  column of cells, and the begin and length of the interval in it. A pair outside the range of contact has an infinite
  gap;
* the pairs of the hunting period, `ENTERING` numbers each: the gap by pitch deviations of the pair that enters
  at phase n, at n mod h [m], and its kind; none where all pairs are alike;
* the cells of `coupling.gears.face_table`, `CELL` numbers each, by depth, kind and position;
* with cells, the guesses: the pairs' part of the mesh's compression in the mean over the mesh period, both counted from
  `FIRST_TOUCH`, at ``DEPTH_UNIT r^2`` of the mesh's for r = 0, 1, ... to one beyond the cells.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from coupling.gears.face_table import CELL, FaceForceTable
from coupling.gears.pair_curves import ToothPairCurves
from coupling.gears.piecewise import PiecewiseCubic

FloatArray = npt.NDArray[np.float64]

FIRST_TOUCH, PARTS, INTERVALS, PAIRS, FIRST_PAIR, KIND_STEP = 0, 1, 2, 3, 4, 5
"""Compression below which no pair touches [m]; numbers of parts, intervals, and pairs at once; j of the first pair; the
distance from one kind's pairs to the next one's."""
DAMPING, DAMPING_DEPTH, HUNTING, DEPTH_UNIT, DEPTHS, DEPTH_STEP = 6, 7, 8, 9, 10, 11
"""Damping [N s/m] and the depth over which it fades in [m]; pairs of the hunting period; unit of the cells' depth [m],
0 where there are none, their number in depth, and the distance from one depth to the next."""
INTERVALS_AT, PAIRS_AT, ENTERING_AT, CELLS_AT = 12, 13, 14, 15
"""Where these begin; the parts begin at `HEADER`."""
SHARED, GUESS_AT = 16, 17
"""Compliance that all pairs share, of their gears' bodies [m/N]; where the first guesses of the pairs' fraction of the
mesh's compression begin, by the depth of cells."""
HEADER = 18
INTERVAL, PAIR, ENTERING = 2, 8, 2

_PARTS_PER_INTERVAL = 4
_HAIR = 1e-14
"""In periods: by rounding alone a part must not begin in the interval before its own."""
_SAME_KNOT = 1e-9
"""Knots nearer to each other than this, in base pitches, are one."""


def law_table(
    curves: Sequence[ToothPairCurves] | FaceForceTable,
    entering: FloatArray,
    damping: float,
    damping_depth: float,
    shared_compliance: float = 0.0,
) -> FloatArray:
    """Row of numbers of a contact law.

    Parameters
    ----------
    curves : sequence of PairCurves, or FaceTable
        Of every kind of pair, behind the shared compliance.
    entering : ndarray, shape (h, 2)
        Gap [m] and kind of each pair of the hunting period.
    damping, damping_depth : float
        [N s/m], [m]
    shared_compliance : float
        [m/N]
    """
    if isinstance(curves, FaceForceTable):
        gaps = [PiecewiseCubic(curves.knots, touch) for touch in curves.first_touch]
        knots = _period_knots([curves.knots])
        second, cells = _cell_places(curves, knots), curves.cells
    else:
        gaps, stiffnesses = [kind.deviation for kind in curves], [kind.stiffness for kind in curves]
        knots = _period_knots([curve.knots for curve in (*gaps, *stiffnesses)])
        second, cells = np.array([_by_pair(curve, knots, 0.0) for curve in stiffnesses]), np.zeros((0, 0, 0, CELL))
    first = np.array([_by_pair(gap, knots, np.inf) for gap in gaps])
    pairs = np.concatenate([first, second], axis=-1)
    parts = _PARTS_PER_INTERVAL * (knots.size - 1)
    begins = np.minimum(np.searchsorted(knots, np.arange(parts) / parts + _HAIR, side="right") - 1, knots.size - 2)
    # Where contact ends within rounding of a period, the sliver between both is included in the search.
    begins -= (begins > 0) & (np.diff(knots)[begins - 1] < 2.0 * _HAIR)
    intervals = np.column_stack([knots, np.append(1.0 / np.diff(knots), 0.0)])
    # No cubic c0 + c1 u + ... falls below c0 and its negative coefficients together on 0 <= u <= 1.
    lowest = first[..., 0] + np.minimum(first[..., 1:], 0.0).sum(axis=-1)
    first_touch = lowest.min() + entering[:, 0].min(initial=0.0)
    guesses = _guesses(curves, first_touch, shared_compliance) if isinstance(curves, FaceForceTable) else np.zeros(0)
    sections = [array.ravel() for array in (begins, intervals, pairs, entering, cells, guesses)]
    at = HEADER + np.cumsum([0, *(section.size for section in sections)])
    header = np.zeros(HEADER)
    header[FIRST_TOUCH] = first_touch
    header[[PARTS, INTERVALS, PAIRS]] = parts, knots.size - 1, pairs.shape[2]
    header[[FIRST_PAIR, KIND_STEP]] = math.floor(gaps[0].knots[0]), pairs[0].size
    header[[DAMPING, DAMPING_DEPTH, HUNTING]] = damping, damping_depth, len(entering)
    header[SHARED] = shared_compliance
    header[[INTERVALS_AT, PAIRS_AT, ENTERING_AT, CELLS_AT, GUESS_AT]] = at[1:6]
    if isinstance(curves, FaceForceTable):
        header[[DEPTH_UNIT, DEPTHS, DEPTH_STEP]] = curves.depth_unit, cells.shape[0], cells[0].size
    return np.concatenate([header, *sections])


def _guesses(table: FaceForceTable, first_touch: float, shared: float) -> FloatArray:
    """Fraction of the mesh's compression in the pairs, without the shared bodies, mean over the period, by depth."""
    depths = np.arange(table.cells.shape[0], dtype=np.float64)
    compression = table.depth_unit * depths**2
    beyond = np.maximum(0.0, first_touch + compression[:, None] - table.first_touch[0, :, 0])
    # Linear between depths, and beyond the last.
    depth = np.sqrt(beyond / table.depth_unit)
    below = np.minimum(depth.astype(np.int64), depths.size - 2)
    force, column = table.cells[:, 0, :, 0], np.arange(below.shape[1])
    mean_force = force[below, column] + (depth - below) * (force[below + 1, column] - force[below, column])
    mesh = compression + shared * (mean_force @ np.diff(table.knots))
    left = np.interp(compression, mesh, compression)
    left[1:] /= compression[1:]
    left[0] = left[1]
    return np.append(left, left[-1])


def _period_knots(knots: Sequence[FloatArray]) -> FloatArray:
    """Where any pair's curve has a knot, over the period from 0 to 1; the ends of contact are kept exactly."""
    ends = np.unique([0.0, 1.0, *(knots[0][[0, -1]] % 1.0)])
    inner = np.unique(np.concatenate(knots) % 1.0)
    # The nearest end is one of the two that it lies between.
    above = np.searchsorted(ends, inner, side="right").clip(1, ends.size - 1)
    inner = inner[np.minimum(inner - ends[above - 1], ends[above] - inner) > _SAME_KNOT]
    inner = inner[np.diff(inner, prepend=-1.0) > _SAME_KNOT]
    return np.sort(np.concatenate([ends, inner]))


def _places(knots: FloatArray, curve_knots: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Where the intervals of all pairs begin and end on the curve, (m, j) both."""
    pairs = np.arange(math.floor(curve_knots[0]), math.ceil(curve_knots[-1]))
    return knots[:-1, None] + pairs, knots[1:, None] + pairs


def _by_pair(curve: PiecewiseCubic, knots: FloatArray, absent: float) -> FloatArray:
    """Cubics (m, j, 4) of all pairs on each interval, and a constant where there is none."""
    low, high = _places(knots, curve.knots)
    cubics = curve.between(low, high)
    middle = 0.5 * (low + high)
    cubics[(middle < curve.knots[0]) | (middle > curve.knots[-1])] = absent, 0.0, 0.0, 0.0
    return cubics


def _cell_places(table: FaceForceTable, knots: FloatArray) -> FloatArray:
    """Row of cells, begin and length in them, (v, m, j, 4), of all kinds of pairs."""
    low, high = _places(knots, table.knots)
    row = np.clip(np.searchsorted(table.knots, 0.5 * (low + high), side="right") - 1, 0, table.knots.size - 2)
    width = np.diff(table.knots)[row]
    one = np.stack([row, (low - table.knots[row]) / width, (high - low) / width, 0.0 * row], axis=-1)
    kinds = np.repeat(one[None], table.cells.shape[1], axis=0)
    kinds[..., 0] += (np.arange(len(kinds)) * table.cells.shape[2])[:, None, None]
    return kinds
