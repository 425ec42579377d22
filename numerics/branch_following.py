"""Branch following: modes paired from speed to speed, and the crossing of a branch with an order of the speed.

A Campbell diagram connects the modes of neighbouring speeds. Where two modes cross, the frequency alone does not say
which is which; where they veer, the shape alone does not. Both are weighed in a linear assignment.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from gearwhine.numerics.arrays import FloatArray

IntArray = npt.NDArray[np.intp]
Shape = TypeVar("Shape")


def paired_modes(
    jump: FloatArray,
    likeness: FloatArray,
    *,
    jump_scale: float,
    most_jumps: float,
    longest_jump: float,
    sure_likeness: float = np.inf,
) -> IntArray:
    """Pair the modes of one speed with those of the next so that the sum of their differences is least.

    The difference of two modes is 1 − likeness + min(jump / jump_scale, most_jumps).

    Parameters
    ----------
    jump : ndarray, shape (m, n)
        Distance of each eigenvalue at the next speed from the expected one, relative.
    likeness : ndarray, shape (m, n)
        Likeness of the shapes, 0 to 1, such as the modal assurance criterion.
    jump_scale : float
        Jump that costs as much as zero likeness of the shapes.
    most_jumps : float
        Largest cost of a jump, in multiples of ``jump_scale``.
    longest_jump : float
        Largest jump within a pair, unless its likeness exceeds ``sure_likeness``.

    Returns
    -------
    ndarray of int, shape (m,)
        Index of the same mode at the next speed, −1 where there is none.
    """
    rows, columns = linear_sum_assignment((1.0 - likeness) + np.minimum(jump / jump_scale, most_jumps))
    followed = (jump[rows, columns] < longest_jump) | (likeness[rows, columns] > sure_likeness)
    partner = np.full(jump.shape[0], -1, dtype=np.intp)
    partner[rows[followed]] = columns[followed]
    return partner


def extended_branches(table: IntArray, partner: IntArray, count: int) -> IntArray:
    """Table of branches with the modes of one more speed.

    Parameters
    ----------
    table : ndarray of int, shape (s, b)
        Index of each branch's mode at every speed so far, −1 where the branch does not exist.
    partner : ndarray of int, shape (m,)
        Index at the new speed of each of the last speed's m modes, −1 where there is none.
    count : int
        Number of modes at the new speed; modes that are no partner begin branches.

    Returns
    -------
    ndarray of int, shape (s + 1, b')
    """
    speeds, branches = table.shape
    row = np.full(branches, -1, dtype=np.intp)
    if speeds:
        active = table[-1] >= 0
        row[active] = partner[table[-1][active]]
    is_new = np.ones(count, dtype=np.bool_)
    is_new[row[row >= 0]] = False
    begun = np.flatnonzero(is_new)
    longer = np.full((speeds + 1, branches + begun.size), -1, dtype=np.intp)
    longer[:speeds, :branches] = table
    longer[speeds, :branches], longer[speeds, branches:] = row, begun
    return longer


def along_branches(table: IntArray, values: Sequence[npt.NDArray[Any]], missing: Any) -> npt.NDArray[Any]:
    """Values of the modes along the branches, (s, b, ...).

    Parameters
    ----------
    table : ndarray of int, shape (s, b)
        Index of each branch's mode at every speed, −1 where the branch does not exist.
    values : sequence of ndarray
        Array (m, ...) over the modes of each speed.
    missing : Any
        Value where a branch does not exist.
    """
    rows = []
    for row, of in zip(table, values, strict=True):
        selected = of[np.maximum(row, 0)] if of.size else np.full((row.size, *of.shape[1:]), missing)
        rows.append(np.where((row >= 0).reshape(-1, *(1,) * (of.ndim - 1)), selected, missing))
    return np.stack(rows)


def order_intervals(damped_frequencies: FloatArray, order: float, speeds: FloatArray) -> list[tuple[int, int]]:
    """Intervals of speed in which a branch crosses an order: index of the lower speed, and branch.

    Parameters
    ----------
    damped_frequencies : ndarray, shape (s, b)
        Damped frequencies of the branches [rad/s]; NaN where a branch does not exist.
    order : float
        Multiple of the speed.
    speeds : ndarray, shape (s,)
        Speeds [rad/s].
    """
    gap = damped_frequencies - order * np.abs(speeds)[:, None]
    crosses = ((gap[:-1] > 0.0) != (gap[1:] > 0.0)) & np.isfinite(gap[:-1]) & np.isfinite(gap[1:])
    return [(int(left), int(branch)) for left, branch in np.argwhere(crosses)]


@dataclass(frozen=True)
class BranchPoint(Generic[Shape]):
    """A mode on a branch: its speed of rotation [rad/s], eigenvalue [rad/s] and shape.

    ``gap`` is the damped frequency less that of the order [rad/s].
    """

    speed: float
    eigenvalue: complex
    gap: float
    shape: Shape


def refined_crossing(
    low: BranchPoint[Shape],
    high: BranchPoint[Shape],
    solve: Callable[[float, BranchPoint[Shape], BranchPoint[Shape]], BranchPoint[Shape] | None],
    *,
    tolerance: float,
    steps: int,
) -> BranchPoint[Shape] | None:
    """Solve for the point between two of a branch at which the gap vanishes, by the Illinois form of regula falsi.

    Parameters
    ----------
    low, high : BranchPoint[Shape]
        Neighbouring points on the branch whose gaps differ in sign.
    solve : callable
        Gives the branch's point at a fraction of the way from one point to another; None where it is not found.
    tolerance : float
        Largest gap over the eigenvalue.
    steps : int
        Largest number of evaluations.

    Returns
    -------
    BranchPoint or None
        None where a point is not found, or the steps do not suffice.
    """
    ends, weights = [low, high], [low.gap, high.gap]
    for _ in range(steps):
        point = solve(weights[0] / (weights[0] - weights[1]), *ends)
        if point is None or abs(point.gap) <= tolerance * abs(point.eigenvalue):
            return point
        near = 0 if (point.gap > 0.0) == (ends[0].gap > 0.0) else 1
        ends[near], weights[near] = point, point.gap
        weights[1 - near] *= 0.5
    return None
