"""Whirl modes followed from speed to speed, through the places where their frequencies cross."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from .exact_roots import ExactRoots
from .spatial_chain import SpatialChain
from .spatial_field import SpatialMotion

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

# Weight of a shape's likeness against the eigenvalue's continuity, as a part of the eigenvalue.
SHAPE_WEIGHT = 0.1
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


def followed(chain: SpatialChain, roots: Sequence[ExactRoots], speeds: FloatArray) -> list[Branch]:
    """Branches through the roots (one set a speed) of one chain.

    From one speed to the next, branches and roots are paired so that the sum of what they differ by is least:
    the distance of the root from the branch's linear continuation, as a part of it, and a little of 1 − MAC.
    """
    inside = chain.layout.displacements
    ways = _characters_of_all(chain, roots, speeds)
    branches: list[tuple[ComplexArray, FloatArray]] = []
    active: list[tuple[int, ComplexArray]] = []
    for k, one in enumerate(roots):
        shapes = one.solutions[:, inside.ravel()]
        shapes = shapes / np.maximum(np.linalg.norm(shapes, axis=1, keepdims=True), 1e-300)
        owner = np.full(one.eigenvalues.size, -1)
        if active and one.eigenvalues.size:
            expected = np.array([_continued(branches[b][0], speeds, k) for b, _ in active])
            jump = np.abs(expected[:, None] - one.eigenvalues) / np.abs(one.eigenvalues)
            likeness = np.abs(np.array([shape for _, shape in active]).conj() @ shapes.T) ** 2
            rows, columns = linear_sum_assignment(np.minimum(jump, 10.0) + SHAPE_WEIGHT * (1.0 - likeness))
            good = jump[rows, columns] < LONGEST_JUMP
            owner[columns[good]] = np.array([active[row][0] for row in rows])[good]
        active = []
        for root, branch in enumerate(owner.tolist()):
            if branch < 0:
                branch = len(branches)
                branches.append((np.full(speeds.size, complex(np.nan, np.nan)), np.full((speeds.size, 2), np.nan)))
            branches[branch][0][k] = one.eigenvalues[root]
            branches[branch][1][k] = ways[k][root]
            active.append((branch, shapes[root]))
    return [Branch(values, ways[:, 0], ways[:, 1]) for values, ways in branches]


def characters(chain: SpatialChain, roots: ExactRoots, speeds: FloatArray) -> FloatArray:
    """Whirl direction and axial share of roots at speeds, as in `rotors.WhirlModes`, (w, 2)."""
    if len(chain.blocks) == 1:
        return np.tile([float(chain.blocks[0]), 0.0 if chain.blocks[0] else 1.0], (roots.eigenvalues.size, 1))
    motion = SpatialMotion.of(chain, roots.eigenvalues, speeds.astype(np.complex128), roots.solutions, roots.scales)
    return np.stack([motion.direction, motion.axial_share], axis=-1)


def _characters_of_all(chain: SpatialChain, roots: Sequence[ExactRoots], speeds: FloatArray) -> list[FloatArray]:
    sizes = [one.eigenvalues.size for one in roots]
    together = ExactRoots(
        np.concatenate([one.eigenvalues for one in roots]),
        np.concatenate([one.solutions for one in roots]),
        np.concatenate([one.residuals for one in roots]),
        np.concatenate([one.scales for one in roots]),
    )
    every = characters(chain, together, np.repeat(speeds, sizes))
    return np.split(every, np.cumsum(sizes)[:-1])


def _continued(values: ComplexArray, speeds: FloatArray, k: int) -> complex:
    """Linear continuation of a branch to the speed k from the two before it."""
    if k < 2 or not np.isfinite(values[k - 2]):
        return complex(values[k - 1])
    part = (speeds[k] - speeds[k - 1]) / (speeds[k - 1] - speeds[k - 2])
    return complex(values[k - 1] + part * (values[k - 1] - values[k - 2]))
