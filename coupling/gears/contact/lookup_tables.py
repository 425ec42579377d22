r"""Lookup tables of the tooth contact law for the compiled kernels: bicubic cells and their memory layout.

Where the load is uneven across the face, force, tangent and energy of such a pair
(:mod:`gearwhine.coupling.gears.contact.face_slices`) depend on its position s and on the compression ``u`` beyond its
first touch. On a grid of both they are bicubic: with ``u = a r^2`` the grid is fine where contact begins, a cell's
force is ``f = sum c_mn p^m rho^n`` with p and rho from 0 to 1 across it, and its energy is that force's integral
``U = U_0 + int f 2 a r dr``, term by term. So the force is exactly the energy's derivative, whatever the error of the
table, and motion on it conserves energy. Beyond the last ``u`` the force goes on with its tangent t, which is a cell
too, ``f = f_end + t a (r^2 - d^2)`` with rho from 0 upward. Where a corner of the profiles, such as a spall's edge,
meets the first slice of the face and the last, which is at once over a spur gear's, the splines along the positions end
and begin.

The whole law is one row of numbers in memory, laid out as follows.

The teeth of a mesh are a base pitch apart, so the phase fixes the positions of all pairs: pair j is at ``x + j``, x the
phase's fraction. All curves of all pairs are therefore cut at common knots of x, and one look-up finds what the law
needs of every pair. An interval is found by an index instead of a search: the period is cut into equal parts, and each
names the interval in which it begins; from there the search goes forward by few steps, mostly none.

The row begins with `HEADER` numbers, at the places named below; then come

* the parts, with the number of an interval each;
* the intervals, `INTERVAL` numbers each: where it begins and one over its width. One more begins at 1, where steps end;
* the pairs, `PAIR` numbers each, by variant of pair, interval and pair. First the cubic of its gap [m] in a variable
  from 0 to 1 over the interval; then that of its stiffness [N/m] or, for an uneven load across the face, the number of
  its column of cells, and the begin and length of the interval in it. A pair outside the range of contact has an
  infinite gap;
* the pairs of the hunting period, `ENTERING` numbers each: the gap by pitch deviations of the pair that enters
  at phase n, at n mod h [m], and its variant; none where all pairs are alike;
* the cells of the bicubic tables, `CELL` numbers each, by depth, variant and position;
* with cells, the guesses: the pairs' part of the mesh's compression in the mean over the mesh period, both counted from
  `FIRST_TOUCH`, at ``DEPTH_UNIT r^2`` of the mesh's for r = 0, 1, ... to one beyond the cells;
* the tilts of bodies as teeth differ: cubics of a deflection that adds to the gaps of all pairs [m], on even parts of
  each mesh period of a hunting period, or of that of the driver's teeth and then of that of the driven gear's.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.contact.face_slices import FaceSlices, face_loads, slice_stiffness
from gearwhine.coupling.gears.contact.tooth_pair import ToothPairCurves, slope_jumps
from gearwhine.coupling.gears.piecewise_cubic import PiecewiseCubic
from gearwhine.numerics.arrays import BoolArray, FloatArray, IntArray

Weight = Callable[[FloatArray], FloatArray]

CELL = 20
_POSITIONS = 160
_DEPTHS = 24
_DEEPEST = 0.02
"""Depth of the table in modules, in addition to the compression that evens out the face."""
_FEWEST = 4
"""Least number of intervals between corners."""
_LEAST_PART = 1e-9
"""Part of an independent slice on the path below which it does not meet: rounding exceeds its compression."""
_APART = 1e-6
"""Corners nearer to each other than this, in base pitches, are one."""


@dataclass(frozen=True, eq=False)
class FaceForceTable:
    """Tables for every variant of pair.

    Attributes
    ----------
    knots : ndarray, shape (m + 1,)
        Positions of the middle of the face [base pitches].
    first_touch : ndarray, shape (v, m, 4)
        Coefficients of the cubics of the gap at which a pair first touches [m].
    cells : ndarray, shape (d + 1, v, m, CELL)
        Coefficients c_mn of the force [N], row by row, and the four of U_0 [J]. Cells of one depth lie side by side, as
        the pairs of a mesh are about equally deep; the last ones are those beyond the table.
    depth_unit : float
        a [m].
    """

    knots: FloatArray
    first_touch: FloatArray
    cells: FloatArray
    depth_unit: float


@dataclass(frozen=True, eq=False)
class FaceSliceStates:
    """Slices of pairs at given positions, arrays of shape (p, n).

    Attributes
    ----------
    whole : ndarray
        Stiffness of a pair whose whole face were like the slice [N/m].
    base : ndarray
        k_b [N/m per m].
    gap : ndarray
        [m]
    meeting : ndarray of bool
        Whether the slice, or of independent slices a part of it, is in the range of contact.
    """

    whole: FloatArray
    base: FloatArray
    gap: FloatArray
    meeting: BoolArray


def face_slice_states(
    slices: FaceSlices, variants: tuple[ToothPairCurves, ...], position: FloatArray, variant: IntArray
) -> FaceSliceStates:
    """Slices of pairs of some variants, `variant` (p,), whose faces' middles are at `position` (p,) in base pitches."""
    places = position.tobytes(), variant.tobytes(), slices.shift.tobytes()
    stiffness = tuple(curves.stiffness for curves in variants)
    gap = _over_slices(tuple(curves.deviation for curves in variants), *places)
    whole, base, meeting = _resistance(stiffness, *places, slices.width, slices.flattening, slices.coupling)
    return FaceSliceStates(whole, base, gap + slices.gap, meeting)


@lru_cache(maxsize=8)  # keyed by identity of the curves, at places that return in each mesh period
def _over_slices(curves: tuple[PiecewiseCubic, ...], positions: bytes, variants: bytes, shifts: bytes) -> FloatArray:
    """Values of each variant's curve on the slices of pairs, (p, n)."""
    at, variant = np.frombuffer(positions)[:, None] + np.frombuffer(shifts), np.frombuffer(variants, dtype=np.int64)
    values = np.zeros(at.shape)
    for number, curve in enumerate(curves):
        these = variant == number if len(curves) > 1 else slice(None)
        values[these] = curve(at[these])
    return values


@lru_cache(maxsize=8)  # pairs that differ in their flanks alone share the curves
def _resistance(
    stiffness: tuple[PiecewiseCubic, ...],
    positions: bytes,
    variants: bytes,
    shifts: bytes,
    width: float,
    flattening: float,
    coupling: float,
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Stiffness, base and meeting of slices, see `FaceSliceStates`, whatever their gaps."""
    shift = np.frombuffer(shifts)
    slices = FaceSlices(shift, width, shift, 0.0 * shift, flattening, coupling)
    at = np.frombuffer(positions)[:, None] + shift
    start, end = stiffness[0].knots[[0, -1]]
    whole = _over_slices(stiffness, positions, variants, shifts)
    meeting = (at >= start) & (at <= end)
    if coupling == 0.0:
        part = slices.part_within(at, start, end)
        meeting = part > _LEAST_PART
        whole = np.where(meeting, part, 1.0) * whole
    return whole, slice_stiffness(slices, whole), meeting


def face_force_table(
    slices: FaceSlices,
    variants: tuple[ToothPairCurves, ...],
    module: float,
    weights: Sequence[Weight] = (np.ones_like,),
    breaks: Sequence[float] = (),
) -> FaceForceTable:
    """Force table of every variant of pair, or of its slices' forces summed with weights other than one.

    Parameters
    ----------
    slices : FaceSlices
    variants : tuple of ToothPairCurves
    module : float
        Normal module of the gears [m]; it sets the depth of the table.
    weights : sequence of callable
        Weight of each slice's force, by its position on the path of contact [base pitches]. With w weights the table
        holds w variants for each of `variants`, one after another.
    breaks : sequence of float
        Positions on the path at which a weight has a corner [base pitches].
    """
    # The length of the contact line has corners where independent slices enter the path and leave it.
    turning = slices.coupling == 0.0 and slices.half_span > 0.0
    ends = variants[0].stiffness.knots[[0, -1]] if turning else np.zeros(0)
    pieces = _pieces(_breaks(variants, slices.reach, [*breaks, *ends]))
    knots = np.concatenate([*(piece[:-1] for piece in pieces[:-1]), pieces[-1]])
    deepest = _DEEPEST * module + 1.5 * float(np.ptp(slices.gap + slices.changes))
    unit = deepest / _DEPTHS**2
    compressions = unit * np.arange(_DEPTHS + 1.0) ** 2
    factors = [slices.width * weight(knots[:, None] + slices.shift) for weight in weights]
    touches, cells = [], []
    for number in range(len(variants)):
        state = face_slice_states(slices, variants, knots, np.full(knots.size, number))
        gap = np.where(state.meeting, state.gap + slices.changes.min(axis=0), np.inf).min(axis=1)
        # At the very ends rounding may leave no slice in contact: the next position is taken.
        gap = np.where(np.isfinite(gap), gap, np.nanmax(np.where(np.isfinite(gap), gap, np.nan)))
        shape = (knots.size, _DEPTHS + 1, slices.z.size)
        base, gaps = np.repeat(state.base, _DEPTHS + 1, axis=0), np.repeat(state.gap, _DEPTHS + 1, axis=0)
        meeting = np.repeat(state.meeting, _DEPTHS + 1, axis=0)
        loads = face_loads(slices, base, gaps, meeting, (gap[:, None] + compressions).ravel())
        for factor in factors:
            force = np.einsum("pdz,pz->pd", loads.line_load.reshape(shape), factor)
            tangent = np.einsum("pdz,pz->pd", loads.line_tangent.reshape(shape), factor)
            force[:, 0] = 0.0
            rise = tangent * 2.0 * unit * np.arange(_DEPTHS + 1.0)
            touches.append(_powers(pieces, gap[:, None])[:, 0])
            cells.append(_cells(_powers(pieces, force), _powers(pieces, rise), unit))
    return FaceForceTable(knots, np.array(touches), np.stack(cells, axis=1), unit)


def _breaks(variants: tuple[ToothPairCurves, ...], reach: float, others: Sequence[float]) -> FloatArray:
    """Find the positions where corners enter or leave the face, `reach` from its middle, with the ends of the range."""
    start, end = variants[0].stiffness.knots[[0, -1]]
    curves = [curve for variant in variants for curve in (variant.stiffness, variant.deviation)]
    corners = np.concatenate([*(slope_jumps(curve) for curve in curves), others])
    breaks = np.unique(np.concatenate([corners - reach, corners + reach]))
    first, last = start - reach, end + reach
    breaks = breaks[(breaks > first + _APART) & (breaks < last - _APART)]
    return np.concatenate([[first], breaks[np.diff(breaks, append=np.inf) > _APART], [last]])


def _pieces(breaks: FloatArray) -> list[FloatArray]:
    """Knots from each break to the next, both included, as evenly spaced as the breaks allow."""
    spacing = (breaks[-1] - breaks[0]) / _POSITIONS
    # Rounding must not add an interval.
    counts = np.maximum(np.ceil(np.diff(breaks) / spacing - 1e-9).astype(int), _FEWEST)
    return [
        np.linspace(low, high, count + 1)
        for low, high, count in zip(breaks[:-1], breaks[1:], counts.tolist(), strict=True)
    ]


def _powers(pieces: list[FloatArray], values: FloatArray) -> FloatArray:
    """Cubic splines through columns of values at each piece's knots, (m, columns, 4), in a variable from 0 to 1."""
    firsts = np.cumsum([0, *(knots.size - 1 for knots in pieces)])
    return np.concatenate(
        [
            piecewise.unit_coefficients(CubicSpline(knots, values[first : first + knots.size], axis=0))
            for knots, first in zip(pieces, firsts[:-1], strict=True)
        ]
    )


def _cells(force: FloatArray, rise: FloatArray, unit: float) -> FloatArray:
    """Cell coefficients (d + 1, m, 20) from the cubics (m, d + 1, 4) of force and derivative by r along positions."""
    low, high, rise_low, rise_high = force[:, :-1], force[:, 1:], rise[:, :-1], rise[:, 1:]
    powers = np.stack(
        [
            low,
            rise_low,
            3.0 * (high - low) - 2.0 * rise_low - rise_high,
            2.0 * (low - high) + rise_low + rise_high,
        ],
        axis=-1,
    )
    # Beyond the table: linear in the compression, so of second degree in rho.
    last = low.shape[1]
    straight = rise[:, -1] / (2.0 * last)
    beyond = np.stack([force[:, -1], rise[:, -1], straight, 0.0 * straight], axis=-1)
    powers = np.concatenate([powers, beyond[:, None]], axis=1)
    n = np.arange(4.0)
    begin = np.arange(last + 1.0)
    weights = 2.0 * unit * (begin[:, None] / (n + 1.0) + 1.0 / (n + 2.0))
    gained = np.einsum("jimn,in->jim", powers, weights)
    energy = np.cumsum(gained, axis=1) - gained
    cells = np.concatenate([powers.reshape(*powers.shape[:2], 16), energy], axis=-1)
    return np.ascontiguousarray(cells.swapaxes(0, 1))


FIRST_TOUCH, PARTS, INTERVALS, PAIRS, FIRST_PAIR, VARIANT_STEP = 0, 1, 2, 3, 4, 5
"""Compression below which no pair touches [m]; numbers of parts, intervals, and pairs at once; j of the first pair; the
distance from one variant's pairs to the next one's."""
DAMPING, DAMPING_DEPTH, HUNTING, DEPTH_UNIT, DEPTHS, DEPTH_STEP = 6, 7, 8, 9, 10, 11
"""Damping [N s/m] and the depth over which it fades in [m]; pairs of the hunting period; unit of the cells' depth [m],
0 where there are none, their number in depth, and the distance from one depth to the next."""
INTERVALS_AT, PAIRS_AT, ENTERING_AT, CELLS_AT = 12, 13, 14, 15
"""Index at which intervals, pairs, hunting pairs and cells begin; the parts begin at `HEADER`."""
SHARED, GUESS_AT = 16, 17
"""Compliance that all pairs share, of their gears' bodies [m/N]; where the first guesses of the pairs' fraction of the
mesh's compression begin, by the depth of cells."""
TILTS_AT, TILT_PARTS, TILT_PERIOD, OTHER_TILT_PERIOD = 18, 19, 20, 21
"""Where the tilts begin, the number of their parts in a mesh period, and the mesh periods of both, 0 for none."""
HEADER = 22
INTERVAL, PAIR, ENTERING = 2, 8, 2

_PARTS_PER_INTERVAL = 4
_HAIR = 1e-14
"""Tolerance in periods, so that rounding does not put the begin of a part into the interval before its own."""
_SAME_KNOT = 1e-9
"""Knots nearer to each other than this, in base pitches, are one."""


def law_table(
    curves: Sequence[ToothPairCurves] | FaceForceTable,
    entering: FloatArray,
    damping: float,
    damping_depth: float,
    shared_compliance: float = 0.0,
    deflection: PiecewiseCubic | None = None,
    tilts: Sequence[FloatArray] = (),
) -> FloatArray:
    """Row of numbers of a contact law.

    Parameters
    ----------
    curves : sequence of ToothPairCurves, or FaceForceTable
        Curves of every variant of pair, without the shared compliance.
    entering : ndarray, shape (h, 2)
        Gap [m] and variant of each pair of the hunting period.
    damping, damping_depth : float
        Damping [N s/m] and the compression up to which it fades in [m].
    shared_compliance : float
        [m/N]
    deflection : PiecewiseCubic, optional
        Deflection that adds to the gaps of all pairs, by the phase from 0 to 1 [m].
    tilts : sequence of ndarray, shape (h, k, 4)
        Further ones over none, one or two hunting periods [m], see `ToothContact.tooth_tilts`.
    """
    others = [] if deflection is None else [deflection.knots]
    if isinstance(curves, FaceForceTable):
        gaps = [PiecewiseCubic(curves.knots, touch) for touch in curves.first_touch]
        knots = _period_knots([curves.knots, *others])
        second, cells = _cell_places(curves, knots), curves.cells
    else:
        gaps, stiffnesses = [variant.deviation for variant in curves], [variant.stiffness for variant in curves]
        knots = _period_knots([*(curve.knots for curve in (*gaps, *stiffnesses)), *others])
        second, cells = np.array([_by_pair(curve, knots, 0.0) for curve in stiffnesses]), np.zeros((0, 0, 0, CELL))
    first = np.array([_by_pair(gap, knots, np.inf) for gap in gaps])
    if deflection is not None:
        first += deflection.between(knots[:-1], knots[1:])[:, None]
    pairs = np.concatenate([first, second], axis=-1)
    parts = _PARTS_PER_INTERVAL * (knots.size - 1)
    begins = np.minimum(np.searchsorted(knots, np.arange(parts) / parts + _HAIR, side="right") - 1, knots.size - 2)
    # Where contact ends within rounding of a period, the sliver between both is included in the search.
    begins -= (begins > 0) & (np.diff(knots)[begins - 1] < 2.0 * _HAIR)
    intervals = np.column_stack([knots, np.append(1.0 / np.diff(knots), 0.0)])
    # No cubic c0 + c1 u + ... falls below c0 and its negative coefficients together on 0 <= u <= 1.
    lowest = first[..., 0] + np.minimum(first[..., 1:], 0.0).sum(axis=-1)
    # Beside the tilts, which the kernels take from the compression.
    first_touch = lowest.min() + entering[:, 0].min(initial=0.0)
    guesses = _guesses(curves, first_touch, shared_compliance) if isinstance(curves, FaceForceTable) else np.zeros(0)
    sections = [array.ravel() for array in (begins, intervals, pairs, entering, cells, guesses, *tilts)]
    at = HEADER + np.cumsum([0, *(section.size for section in sections)])
    header = np.zeros(HEADER)
    header[FIRST_TOUCH] = first_touch
    header[[PARTS, INTERVALS, PAIRS]] = parts, knots.size - 1, pairs.shape[2]
    header[[FIRST_PAIR, VARIANT_STEP]] = math.floor(gaps[0].knots[0]), pairs[0].size
    header[[DAMPING, DAMPING_DEPTH, HUNTING]] = damping, damping_depth, len(entering)
    header[SHARED] = shared_compliance
    header[[INTERVALS_AT, PAIRS_AT, ENTERING_AT, CELLS_AT, GUESS_AT, TILTS_AT]] = at[1:7]
    for period, tilt in zip((TILT_PERIOD, OTHER_TILT_PERIOD), tilts, strict=False):
        header[[TILT_PARTS, period]] = tilt.shape[1], len(tilt)
    if isinstance(curves, FaceForceTable):
        header[[DEPTH_UNIT, DEPTHS, DEPTH_STEP]] = curves.depth_unit, cells.shape[0], cells[0].size
    return np.concatenate([header, *sections])


def _guesses(table: FaceForceTable, first_touch: float, shared: float) -> FloatArray:
    """Mean part of the mesh's compression that is in the pairs, not in the shared bodies, at each depth."""
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
    """Union of all pairs' knots over the period from 0 to 1; the ends of contact are kept exactly."""
    ends = np.unique([0.0, 1.0, *(knots[0][[0, -1]] % 1.0)])
    inner = np.unique(np.concatenate(knots) % 1.0)
    # The nearest end is one of the two that it lies between.
    above = np.searchsorted(ends, inner, side="right").clip(1, ends.size - 1)
    inner = inner[np.minimum(inner - ends[above - 1], ends[above] - inner) > _SAME_KNOT]
    inner = inner[np.diff(inner, prepend=-1.0) > _SAME_KNOT]
    return np.sort(np.concatenate([ends, inner]))


def _places(knots: FloatArray, curve_knots: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Begin and end of the intervals of all pairs on the curve, shape (m, j) each."""
    pairs = np.arange(math.floor(curve_knots[0]), math.ceil(curve_knots[-1]))
    return knots[:-1, None] + pairs, knots[1:, None] + pairs


def _by_pair(curve: PiecewiseCubic, knots: FloatArray, absent: float) -> FloatArray:
    """Cubics (m, j, 4) of all pairs on each interval, and the constant ``absent`` outside the curve."""
    low, high = _places(knots, curve.knots)
    cubics = curve.between(low, high)
    middle = 0.5 * (low + high)
    cubics[(middle < curve.knots[0]) | (middle > curve.knots[-1])] = absent, 0.0, 0.0, 0.0
    return cubics


def _cell_places(table: FaceForceTable, knots: FloatArray) -> FloatArray:
    """Row of cells, begin and length in them, (v, m, j, 4), of all variants of pairs."""
    low, high = _places(knots, table.knots)
    row = np.clip(np.searchsorted(table.knots, 0.5 * (low + high), side="right") - 1, 0, table.knots.size - 2)
    width = np.diff(table.knots)[row]
    places = np.stack([row, (low - table.knots[row]) / width, (high - low) / width, 0.0 * row], axis=-1)
    variants = np.repeat(places[None], table.cells.shape[1], axis=0)
    variants[..., 0] += (np.arange(len(variants)) * table.cells.shape[2])[:, None, None]
    return variants
