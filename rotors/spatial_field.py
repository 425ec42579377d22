"""Complex motion of a shaft in both planes, continued exactly from the states at its nodes to any place."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from .chain import SQUARE_FRACTIONS, SQUARE_WEIGHTS, DiscretisedShaft
from .search import require_positions
from .spatial_chain import WhirlEquations, squared_frequencies
from .spatial_ties import BLOCK_COORDINATES

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]


@dataclass(frozen=True)
class ShaftMotion:
    """Motions e^{λt} of a shaft, each with its own λ and speed of rotation.

    Attributes
    ----------
    chain
        Pieces and nodes of one plane.
    eigenvalues, speeds
        (w,) complex: λ and Ω, rad/s.
    forward, backward
        (w, p + 1, 4) complex: r±, β± and the forces that belong to them, right of every node, in scaled units.
    axial
        (w, p + 1, 2) complex: the same of z; zero where no bearing couples it to lateral motion.
    rod
        The shaft's axial motion, discretised; None without any.
    """

    chain: DiscretisedShaft
    eigenvalues: ComplexArray
    speeds: ComplexArray
    forward: ComplexArray
    backward: ComplexArray
    axial: ComplexArray
    rod: DiscretisedShaft | None = None

    @classmethod
    def of(
        cls,
        chain: WhirlEquations,
        eigenvalues: ComplexArray,
        speeds: ComplexArray,
        solutions: ComplexArray,
        scale: FloatArray,
    ) -> "ShaftMotion":
        """Motions from solutions (w, order) and their unit of force (w,); blocks without equations are at rest."""
        parts = chain.states(solutions, eigenvalues, speeds, scale)
        for block in BLOCK_COORDINATES.keys() - parts.keys():
            shape = (eigenvalues.size, chain.bending.nodes.size, 2 * len(BLOCK_COORDINATES[block]))
            parts[block] = np.zeros(shape, dtype=np.complex128)
        rod = chain.axial if 0 in chain.blocks else None
        return cls(chain.bending, eigenvalues, speeds, parts[1], parts[-1], parts[0], rod)

    @property
    def count(self) -> int:
        """Number of motions w."""
        return int(self.eigenvalues.size)

    def take(self, index: npt.ArrayLike) -> "ShaftMotion":
        """Selected motions, in the order of the index."""
        chosen = np.asarray(index)
        return replace(
            self,
            eigenvalues=self.eigenvalues[chosen],
            speeds=self.speeds[chosen],
            forward=self.forward[chosen],
            backward=self.backward[chosen],
            axial=self.axial[chosen],
        )

    def joined(self, other: "ShaftMotion") -> "ShaftMotion":
        """These motions followed by others of the same shaft."""
        return replace(
            self,
            eigenvalues=np.concatenate([self.eigenvalues, other.eigenvalues]),
            speeds=np.concatenate([self.speeds, other.speeds]),
            forward=np.concatenate([self.forward, other.forward]),
            backward=np.concatenate([self.backward, other.backward]),
            axial=np.concatenate([self.axial, other.axial]),
        )

    def plus(self, other: "ShaftMotion") -> "ShaftMotion":
        """Sum of two responses at the same frequencies."""
        return replace(
            self,
            forward=self.forward + other.forward,
            backward=self.backward + other.backward,
            axial=self.axial + other.axial,
        )

    def scaled(self, factors: ComplexArray) -> "ShaftMotion":
        """Every motion times a number, (w,)."""
        by = factors[:, None, None]
        return replace(self, forward=by * self.forward, backward=by * self.backward, axial=by * self.axial)

    @cached_property
    def shares(self) -> FloatArray:
        """∫ ρA |r±|² + ρI |β±|² dz of the forward and the backward part, ∫ ρA |z|² dz of the axial one, (w, 3), kg·m².

        With the nodes' own inertias.
        """
        from .share_kernels import inertia_shares

        chain = self.chain
        along = chain.inertia_weights
        pieces = chain.table.lengths, chain.table.coefficients, chain.element
        shares = []
        for block, states in ((1, self.forward), (-1, self.backward)):
            squared = self._squared(block)
            shares.append(inertia_shares(pieces, *squared, states, SQUARE_FRACTIONS, along, chain.node_inertia))
        return np.stack([*shares, self._axial_inertia()], axis=-1)

    def _axial_inertia(self) -> FloatArray:
        """∫ ρA |z|² dz with the nodes' masses, (w,)."""
        rod = self.rod
        if rod is None:
            return np.zeros(self.count)
        pieces = np.repeat(np.arange(rod.element.size), SQUARE_FRACTIONS.size)
        fractions = np.tile(SQUARE_FRACTIONS, rod.element.size)
        transfer_matrices = rod.transfer_matrices_to(pieces, fractions, -(self.eigenvalues**2))
        along = np.einsum("zwj,wzj->wz", transfer_matrices[:, :, 0], self.axial[:, pieces])
        mass = rod.coefficients_at(pieces, fractions)[:, 1]
        weight = np.tile(SQUARE_WEIGHTS, rod.element.size) * np.repeat(rod.lengths, SQUARE_FRACTIONS.size) * mass
        nodal = np.abs(self.axial[:, :, 0]) ** 2 @ rod.node_inertia[:, 0]
        return np.asarray(np.abs(along) ** 2 @ weight + nodal)

    @property
    def direction(self) -> FloatArray:
        """Forward minus backward part of the lateral `shares`, −1 to 1, (w,); 0 without lateral motion."""
        forward, backward = self.shares[:, 0], self.shares[:, 1]
        lateral = forward + backward
        return np.divide(forward - backward, lateral, out=np.zeros_like(lateral), where=lateral > 0.0)

    @property
    def axial_share(self) -> FloatArray:
        """The axial part of all `shares`, (w,)."""
        return np.asarray(self.shares[:, 2] / self.shares.sum(axis=1))

    def at(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Forward and backward states (w, len(z), 4) at positions z (m), in scaled units, by the exact transfer.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        positions = require_positions(self.chain.nodes, z)
        pieces, fractions = self.chain.places(positions)
        return (
            self._inside(1, self.forward, pieces, fractions),
            self._inside(-1, self.backward, pieces, fractions),
        )

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

    def section_loads(self, z: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Complex shear forces (N) and bending moments (N·m) at positions z (m), both (2, w, len(z)) over x and y."""
        forward, backward = self.at(z)
        unit = self.chain.displacement_unit
        shear = planes(forward[:, :, 2] / unit[0], backward[:, :, 2] / unit[0])
        moment = planes(forward[:, :, 3] / unit[1], backward[:, :, 3] / unit[1])
        return np.array(shear), np.array(moment)

    def axial_at(self, z: npt.ArrayLike) -> ComplexArray:
        """Axial states (w, len(z), 2) at positions z (m) of a shaft that moves along its axis, in scaled units."""
        assert self.rod is not None
        pieces, fractions = self.rod.places(require_positions(self.rod.nodes, z))
        transfer_matrices = self.rod.transfer_matrices_to(pieces, fractions, -(self.eigenvalues**2))
        return np.asarray(np.einsum("zwij,wzj->wzi", transfer_matrices, self.axial[:, pieces]))

    def _inside(self, block: int, states: ComplexArray, pieces: IntArray, fractions: FloatArray) -> ComplexArray:
        transfer_matrices = self.chain.transfer_matrices_to(pieces, fractions, *self._squared(block))
        return np.asarray(np.einsum("zwij,wzj->wzi", transfer_matrices, states[:, pieces]))

    def _squared(self, block: int) -> tuple[ComplexArray, ComplexArray]:
        return squared_frequencies(block, self.eigenvalues, self.speeds)


def planes(forward: ComplexArray, backward: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """x and y of circular coordinates r± = (x ± i y)/√2."""
    root = np.sqrt(0.5)
    return np.asarray(root * (forward + backward)), np.asarray(-1j * root * (forward - backward))
