r"""Lookup tables of the tooth contact law for the compiled kernels.

Uneven load across the face: force, tangent and energy of such a pair (:mod:`coupling.gears.face_slices`) depend on its
position s and on the compression ``u`` beyond its first touch. On a grid of both they are bicubic: with ``u = a r^2``
the grid is fine where contact begins, a cell's force is ``f = sum c_mn p^m rho^n`` with p and rho from 0 to 1 across
it, and its energy is that force's integral ``U = U_0 + int f 2 a r dr``, term by term. So the force is exactly the
energy's derivative, whatever the error of the table, and motion on it conserves energy. Beyond the last ``u`` the force
goes on with its tangent t, which is a cell too, ``f = f_end + t a (r^2 - d^2)`` with rho from 0 upward. Where a corner
of the profiles, such as a spall's edge, meets the first slice of the face and the last, which is at once over a spur
gear's, the splines along the positions end and begin.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline

from coupling.gears import piecewise
from coupling.gears.face_slices import FaceSlices, face_loads, slice_stiffness
from coupling.gears.pair_curves import ToothPairCurves, slope_jumps

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.int64]
Weight = Callable[[FloatArray], FloatArray]

CELL = 20
_POSITIONS = 160
_DEPTHS = 24
_DEEPEST = 0.02
"""Depth of the table in modules, in addition to the compression that evens out the face."""
_FEWEST = 4
"""Intervals between corners, at least."""
_APART = 1e-6
"""Corners nearer to each other than this, in base pitches, are one."""


@dataclass(frozen=True, eq=False)
class FaceForceTable:
    """Tables for every kind of pair.

    Attributes
    ----------
    knots : ndarray, shape (m + 1,)
        Positions of the middle of the face [base pitches].
    first_touch : ndarray, shape (v, m, 4)
        Cubics of the gap at which a pair first touches [m].
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
        Whether the slice is where it can touch.
    """

    whole: FloatArray
    base: FloatArray
    gap: FloatArray
    meeting: BoolArray


def face_slice_states(
    slices: FaceSlices, kinds: tuple[ToothPairCurves, ...], position: FloatArray, kind: IntArray
) -> FaceSliceStates:
    """Slices of pairs of some kinds, `kind` (p,), whose faces' middles are at `position` (p,) in base pitches."""
    at = position[:, None] + slices.shift
    start, end = kinds[0].stiffness.knots[[0, -1]]
    whole, gap = np.zeros(at.shape), np.zeros(at.shape)
    for number, curves in enumerate(kinds):
        these = kind == number if len(kinds) > 1 else slice(None)
        whole[these], gap[these] = curves.stiffness(at[these]), curves.deviation(at[these])
    return FaceSliceStates(whole, slice_stiffness(slices, whole), gap + slices.gap, (at >= start) & (at <= end))


def face_force_table(
    slices: FaceSlices,
    kinds: tuple[ToothPairCurves, ...],
    module: float,
    weights: Sequence[Weight] = (np.ones_like,),
    breaks: Sequence[float] = (),
) -> FaceForceTable:
    """Table of every kind of pair, or of sums over its slices with other weights than one.

    Parameters
    ----------
    slices : FaceSlices
    kinds : tuple of PairCurves
    module : float
        Of the gears [m]; it sets the depth of the table.
    weights : sequence of callable
        Weight of each slice's force, by its position on the path of contact [base pitches]. With w of them the table
        holds w kinds for each of `kinds`, one after another.
    breaks : sequence of float
        Places on the path where a weight has a corner.
    """
    reach = float(np.abs(slices.shift).max()) if slices.z.size > 1 else 0.0
    pieces = _pieces(_breaks(kinds, reach, breaks))
    knots = np.concatenate([*(piece[:-1] for piece in pieces[:-1]), pieces[-1]])
    deepest = _DEEPEST * module + 1.5 * float(np.ptp(slices.gap))
    unit = deepest / _DEPTHS**2
    compressions = unit * np.arange(_DEPTHS + 1.0) ** 2
    factors = [slices.width * weight(knots[:, None] + slices.shift) for weight in weights]
    touches, cells = [], []
    for number in range(len(kinds)):
        state = face_slice_states(slices, kinds, knots, np.full(knots.size, number))
        gap = np.where(state.meeting, state.gap, np.inf).min(axis=1)
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


def _breaks(kinds: tuple[ToothPairCurves, ...], reach: float, others: Sequence[float]) -> FloatArray:
    """Find the positions where corners enter or leave the face, `reach` from its middle, with the ends of the range."""
    start, end = kinds[0].stiffness.knots[[0, -1]]
    curves = [curve for kind in kinds for curve in (kind.stiffness, kind.deviation)]
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
    """Coefficients (d + 1, m, 20) from those of force and derivative by r along the positions, (m, d + 1, 4)."""
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
