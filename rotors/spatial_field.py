"""Exact motion of a whole shaft in both planes at a complex frequency, from the states at its nodes to any place."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from .chain import Chain
from .search import require_positions
from .spatial_chain import SpatialChain
from .spatial_ties import MEMBERS

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class SpatialMotion:
    """Motions e^{λt} of a shaft, each with its own λ and speed of rotation.

    Attributes
    ----------
    chain
        Pieces and nodes of one plane.
    eigenvalues, speeds
        (w,) complex: λ and Ω, rad/s.
    forward, backward
        (w, p + 1, 4) complex: r±, β± and the forces that belong to them, right of every node, in scaled units.
    """

    chain: Chain
    eigenvalues: ComplexArray
    speeds: ComplexArray
    forward: ComplexArray
    backward: ComplexArray

    @classmethod
    def of(
        cls, chain: SpatialChain, eigenvalues: ComplexArray, speeds: ComplexArray, solutions: ComplexArray
    ) -> "SpatialMotion":
        """Motions from solutions (w, order) of a chain's equations; blocks that it lacks are at rest."""
        states = chain.states(solutions, chain.force_scale(eigenvalues))
        parts = {
            block: np.zeros((*states.shape[:2], 4), dtype=np.complex128) for block in (1, -1)
        }
        first = 0
        for block in chain.blocks:
            local = first + np.arange(len(MEMBERS[block]))
            if block:
                parts[block] = states[:, :, np.concatenate([local, chain.size + local])]
            first += local.size
        return cls(chain.bending, eigenvalues, speeds, parts[1], parts[-1])

    @property
    def count(self) -> int:
        """Number of motions w."""
        return int(self.eigenvalues.size)

    def take(self, index: npt.ArrayLike) -> "SpatialMotion":
        """Some of the motions, or their order changed."""
        chosen = np.asarray(index)
        return replace(
            self,
            eigenvalues=self.eigenvalues[chosen],
            speeds=self.speeds[chosen],
            forward=self.forward[chosen],
            backward=self.backward[chosen],
        )

    def joined(self, other: "SpatialMotion") -> "SpatialMotion":
        """These motions and then those, of the same shaft."""
        return replace(
            self,
            eigenvalues=np.concatenate([self.eigenvalues, other.eigenvalues]),
            speeds=np.concatenate([self.speeds, other.speeds]),
            forward=np.concatenate([self.forward, other.forward]),
            backward=np.concatenate([self.backward, other.backward]),
        )

    def scaled(self, factors: ComplexArray) -> "SpatialMotion":
        """Every motion times a number, (w,)."""
        by = factors[:, None, None]
        return replace(self, forward=by * self.forward, backward=by * self.backward)

    def nodal_weights(self) -> FloatArray:
        """Inertias of the nodes, half of every piece's at either end included, (p + 1, 2), scaled units."""
        chain = self.chain
        weights = chain.node_inertia.copy()
        halves = 0.5 * chain.inertia * chain.lengths[:, None]
        weights[:-1] += halves
        weights[1:] += halves
        return np.asarray(weights)

    def shares(self) -> FloatArray:
        """Kinetic weight of the forward and of the backward part of every motion, (w, 2)."""
        weights = self.nodal_weights()
        parts = [(np.abs(part[:, :, :2]) ** 2 * weights).sum(axis=(1, 2)) for part in (self.forward, self.backward)]
        return np.stack(parts, axis=-1)

    def at(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Forward and backward states (w, len(z), 4) at positions z (m), in scaled units, by the exact transfer.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        positions = require_positions(self.chain.nodes, z)
        finer = self.chain.with_nodes(positions)
        where = np.array([finer.node_at(position) for position in positions], dtype=np.intp)
        known = np.searchsorted(self.chain.nodes, finer.nodes, side="right") - 1
        is_known = np.isclose(finer.nodes, self.chain.nodes[known], rtol=0.0, atol=0.0)
        parts = []
        for block, states in ((1, self.forward), (-1, self.backward)):
            translation = -(self.eigenvalues**2)
            rotation = translation + block * 2j * self.speeds * self.eigenvalues
            transfers = finer.transfers(translation, rotation)
            filled = np.empty((self.count, finer.nodes.size, 4), dtype=np.complex128)
            for node in range(finer.nodes.size):
                if is_known[node]:
                    filled[:, node] = states[:, known[node]]
                else:
                    filled[:, node] = np.einsum("wij,wj->wi", transfers[node - 1], filled[:, node - 1])
            parts.append(filled[:, where])
        return parts[0], parts[1]

    def evaluate(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex x and y at positions z (m), both (w, len(z)), m."""
        forward, backward = self.at(z)
        unit = self.chain.displacement_unit[0]
        return planes(forward[:, :, 0] * unit, backward[:, :, 0] * unit)

    def evaluate_slopes(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex slopes of the section in x and in y at positions z (m), both (w, len(z)), rad."""
        forward, backward = self.at(z)
        unit = self.chain.displacement_unit[1]
        return planes(forward[:, :, 1] * unit, backward[:, :, 1] * unit)


def planes(forward: ComplexArray, backward: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """x and y of circular coordinates r± = (x ± i y)/√2."""
    root = np.sqrt(0.5)
    return np.asarray(root * (forward + backward)), np.asarray(-1j * root * (forward - backward))
