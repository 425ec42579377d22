"""Order of the unknowns (columns) and equations (rows) of the shooting matrix.

Elimination goes from left to right, and its cost is its fill-in. At every node the unknowns of bearings come first,
then those of one block after another, displacements before forces; the equations of a node stand in the order of the
blocks too, followed by those of bearings. So a bearing's coupling is eliminated before the next run begins, and the two
senses hardly fill in each other's rows. Right of the last node there is no force.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .spatial_ties import BLOCK_COORDINATES, NodeBearing

IntArray = npt.NDArray[np.intp]


@dataclass(frozen=True)
class BearingPlaces:
    """Columns of a bearing's forces (m,) and of its pedestal's displacements (f,), and the rows of both."""

    forces: IntArray
    feet: IntArray
    force_rows: IntArray
    foot_rows: IntArray


@dataclass(frozen=True)
class Layout:
    """Places of unknowns (columns) and equations (rows), for r + 1 nodes with n displacements each.

    Attributes
    ----------
    order
        Number of unknowns, and of equations.
    displacements, forces
        (r + 1, n) and (r, n): columns of the state right of a node.
    continuity, balances
        (r, n) and (r + 1, n): rows of the displacements at every node but the first, and of the forces at every node.
    ties
        For every bearing.
    """

    order: int
    displacements: IntArray
    forces: IntArray
    continuity: IntArray
    balances: IntArray
    ties: tuple[BearingPlaces, ...]

    @classmethod
    def of(cls, blocks: tuple[int, ...], kept: IntArray, ties: Sequence[NodeBearing]) -> "Layout":
        """Layout of the blocks at the nodes with unknowns, (r + 1,), and of the bearings at some of them."""
        widths = np.array([len(BLOCK_COORDINATES[block]) for block in blocks])
        n, width = int(widths.sum()), np.repeat(widths, widths)
        # A block's displacements and then its forces, behind those of the blocks before it.
        own = np.arange(n) + np.repeat(np.cumsum(widths) - widths, widths)
        at = [int(kept.searchsorted(tie.node)) for tie in ties]
        extra = np.zeros(kept.size, dtype=np.intp)
        for node, tie in zip(at, ties, strict=True):
            extra[node] += len(tie.directions) + len(tie.foot)
        # The first node has no displacement to meet, the last no force.
        columns = np.concatenate([[0], np.cumsum(extra[:-1] + 2 * n)])
        rows = np.concatenate([[0], np.cumsum(extra[:-1] + 2 * n) - n])
        states = columns + extra
        displacements, balances = states[:, None] + own, rows[:, None] + width + own
        displacements[-1], balances[0] = states[-1] + np.arange(n), np.arange(n)
        behind = rows + 2 * n
        behind[0] = n
        places = []
        for node, tie in zip(at, ties, strict=True):
            m, f = len(tie.directions), len(tie.foot)
            column, row = np.arange(columns[node], columns[node] + m + f), np.arange(behind[node], behind[node] + m + f)
            places.append(BearingPlaces(column[:m], column[m:], row[:m], row[m:]))
            columns[node] += m + f
            behind[node] += m + f
        return cls(
            int(states[-1]) + n,
            displacements,
            states[:-1, None] + width + own,
            rows[1:, None] + own,
            balances,
            tuple(places),
        )
