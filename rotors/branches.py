"""Branches of a Campbell diagram: whirl modes followed from speed to speed, through the places where they cross."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .branch_following import extended_branches, paired_modes
from .exact_roots import ExactRoots
from .spatial_chain import WhirlEquations
from .spatial_field import ShaftMotion

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]

# A jump by this part of the eigenvalue weighs as much as no likeness at all; no jump weighs more than so many of these.
JUMP_SCALE = 0.1
MOST_JUMPS = 100.0
# A branch that would have to jump further than this part of its frequency has ended.
LONGEST_JUMP = 0.5


@dataclass(frozen=True)
class Branch:
    """One mode over the speeds; NaN where it is not among the roots.

    Attributes
    ----------
    eigenvalues, direction, axial_share
        (s,): rad/s, and as in `rotors.WhirlModes`.
    """

    eigenvalues: ComplexArray
    direction: FloatArray
    axial_share: FloatArray

    @property
    def first_frequency(self) -> float:
        """|λ| where the branch begins, rad/s."""
        return float(np.abs(self.eigenvalues[np.isfinite(self.eigenvalues)][0]))


def followed(chain: WhirlEquations, roots: Sequence[ExactRoots], speeds: FloatArray) -> list[Branch]:
    """Branches through the roots (one set a speed) of one chain.

    A root's jump is its distance from the linear continuation of the branch; shapes are compared by the modal assurance
    criterion of the nodes' displacements.
    """
    inside = chain.layout.displacements.ravel()
    shapes = [one.solutions[:, inside] for one in roots]
    shapes = [one / np.maximum(np.linalg.norm(one, axis=1, keepdims=True), 1e-300) for one in shapes]
    table = np.zeros((0, 0), dtype=np.intp)
    for k, one in enumerate(roots):
        partner = np.zeros(0, dtype=np.intp)
        if k:
            expected = _continued(roots[max(k - 2, 0) : k], table, speeds[max(k - 2, 0) : k + 1])
            jump = np.abs(expected[:, None] - one.eigenvalues) / np.abs(one.eigenvalues)
            likeness = np.abs(shapes[k - 1].conj() @ shapes[k].T) ** 2
            partner = paired_modes(
                jump, likeness, jump_scale=JUMP_SCALE, most_jumps=MOST_JUMPS, longest_jump=LONGEST_JUMP
            )
        table = extended_branches(table, partner, one.eigenvalues.size)
    ways = _characters_of_all(chain, roots, speeds)
    branches = []
    for column in table.T:
        values, way = np.full(speeds.size, complex(np.nan, np.nan)), np.full((speeds.size, 2), np.nan)
        for k in np.flatnonzero(column >= 0).tolist():
            values[k], way[k] = roots[k].eigenvalues[column[k]], ways[k][column[k]]
        branches.append(Branch(values, way[:, 0], way[:, 1]))
    return branches


def characters(chain: WhirlEquations, roots: ExactRoots, speeds: FloatArray) -> FloatArray:
    """Whirl direction and axial share of roots at speeds, as in `rotors.WhirlModes`, (w, 2)."""
    if len(chain.blocks) == 1:
        return np.tile([float(chain.blocks[0]), 0.0 if chain.blocks[0] else 1.0], (roots.eigenvalues.size, 1))
    motion = ShaftMotion.of(chain, roots.eigenvalues, speeds.astype(np.complex128), roots.solutions, roots.scales)
    return np.stack([motion.direction, motion.axial_share], axis=-1)


def _characters_of_all(chain: WhirlEquations, roots: Sequence[ExactRoots], speeds: FloatArray) -> list[FloatArray]:
    sizes = [one.eigenvalues.size for one in roots]
    together = ExactRoots(
        np.concatenate([one.eigenvalues for one in roots]),
        np.concatenate([one.solutions for one in roots]),
        np.concatenate([one.residuals for one in roots]),
        np.concatenate([one.scales for one in roots]),
    )
    every = characters(chain, together, np.repeat(speeds, sizes))
    return np.split(every, np.cumsum(sizes)[:-1])


def _continued(roots: Sequence[ExactRoots], table: IntArray, speeds: FloatArray) -> ComplexArray:
    """Linear continuation of the last speed's roots to the next speed, along the branches of a table, (w,).

    ``roots`` are those of the last two speeds, or of the first alone; ``speeds`` are theirs and the next.
    """
    expected = roots[-1].eigenvalues.copy()
    if len(roots) > 1:
        part = (speeds[2] - speeds[1]) / (speeds[1] - speeds[0])
        before, last = table[-2:, (table[-2] >= 0) & (table[-1] >= 0)]
        values = roots[1].eigenvalues[last]
        expected[last] = values + part * (values - roots[0].eigenvalues[before])
    return expected
