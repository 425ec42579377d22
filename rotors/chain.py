"""Discretised shaft: elements between nodes, the common form of bending, torsion and axial motion.

Every node may carry inertia and a spring to ground; every piece of shaft between two nodes has an exact transfer matrix
(`rotors.timoshenko`). Lengths and forces are scaled so that displacements and forces are of one size and a state vector
can be normalised as a whole. `rotors.rotor_lines` makes the discretised shafts of a rotor.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from .profile import restricted
from .quadrature import gauss_rule
from .shaft import merged_positions, station_index
from .timoshenko import NumberArray, ShaftElements

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
Scalar = TypeVar("Scalar", bound=np.generic)


# Products of two fields, on pieces this short, are integrated to rounding.
GAUSS_FRACTIONS, GAUSS_WEIGHTS = gauss_rule(10)
# For the squares of forward and backward whirl.
SQUARE_FRACTIONS, SQUARE_WEIGHTS = gauss_rule(6)


@dataclass(frozen=True)
class EnergyWeights:
    """Weights of squared motions and strains at the Gauss points of all pieces, and then at the nodes.

    ``mass`` and ``polar`` weigh n displacements at each; ``strain`` weighs the rotation (of a beam) and the n
    forces at each Gauss point and the n displacements of each node.
    """

    mass: FloatArray
    polar: FloatArray
    strain: FloatArray


@dataclass(frozen=True)
class DiscretisedShaft:
    """A shaft as pieces between nodes, in scaled units; n is 2 for bending and 1 for a rod.

    Attributes
    ----------
    nodes
        (p + 1,): ascending positions, m (they and the stations are not in scaled units).
    table
        The distinct pieces, in scaled units.
    element
        (p,): index of each piece in the table.
    node_inertia, node_stiffness
        (p + 1, n): at the nodes; an infinite stiffness is a constraint.
    node_polar
        (p + 1,): polar moment of inertia at the nodes, for the gyroscopic matrix of bending.
    length_unit
        m.
    displacement_unit
        (n,): SI value of a displacement and rotation of one, at unit modal mass in kg·m² or kg.
    highest
        rad/s up to which the pieces are short enough.
    stations
        (s,): ascending positions of segment ends, discs and supports, m; nodes need not be among them.
    """

    nodes: FloatArray
    table: ShaftElements
    element: IntArray
    node_inertia: FloatArray
    node_stiffness: FloatArray
    node_polar: FloatArray
    length_unit: float
    displacement_unit: FloatArray
    highest: float
    stations: FloatArray

    @property
    def size(self) -> int:
        """Displacements at a node: 2 in bending, 1 of a rod."""
        return self.table.size

    @cached_property
    def lengths(self) -> FloatArray:
        """Lengths of the pieces in scaled units, (p,)."""
        return self.table.lengths[self.element]

    @cached_property
    def constrained(self) -> npt.NDArray[np.bool_]:
        """Whether each node displacement is constrained, (p + 1, n)."""
        return np.isinf(self.node_stiffness)

    @cached_property
    def finite_stiffness(self) -> FloatArray:
        """Node stiffness with constraints, which store no energy, as zero, (p + 1, n)."""
        return np.where(self.constrained, 0.0, self.node_stiffness)

    @cached_property
    def energy_weights(self) -> EnergyWeights:
        """Quadrature weights of squared motions and strains: coefficients times lengths times Gauss weights."""
        from .energy_kernels import energy_weights

        table, nodal = self.table, (self.node_stiffness, self.node_inertia, self.node_polar)
        return EnergyWeights(
            *energy_weights(GAUSS_FRACTIONS, GAUSS_WEIGHTS, table.lengths, table.coefficients, self.element, *nodal)
        )

    @cached_property
    def inertia_weights(self) -> FloatArray:
        """Weights of squared displacement and rotation at the `SQUARE_FRACTIONS` (g,) of distinct pieces, (e, g, 2)."""
        along = self.table.coefficients_along(SQUARE_FRACTIONS)[:, :, 2:4]
        return np.asarray(along * (self.table.lengths[:, None] * SQUARE_WEIGHTS)[:, :, None])

    def coefficients_at(self, piece: IntArray, fraction: FloatArray) -> FloatArray:
        """Coefficients of the table at fractions (z,) of pieces (z,), (z, 6) or (z, 2)."""
        return self.table.coefficients_at(self.element[piece], fraction)

    def transfer_matrices(self, translation: npt.ArrayLike, rotation: npt.ArrayLike | None = None) -> NumberArray:
        """Transfer matrices of all pieces at every ω² of a (b,) array, (p, b, 2n, 2n).

        Parameters
        ----------
        translation, rotation
            (b,): ω² that multiplies the mass and the rotary inertia, real or complex; without the second, both
            are the first. For e^{λt} in circular coordinates they are −λ² and −λ² ± 2iΩλ.
        """
        return np.moveaxis(self.table.transfer_matrices(translation, rotation)[:, :, 0], 0, 1)[self.element]

    def transfer_matrices_to(
        self,
        piece: IntArray,
        fraction: FloatArray,
        translation: npt.ArrayLike,
        rotation: npt.ArrayLike | None = None,
    ) -> NumberArray:
        """Transfer matrices from the left ends of pieces (z,) to fractions (z,) of them, (z, b, 2n, 2n)."""
        return self.table.transfer_matrices_to(self.element[piece], fraction, translation, rotation)

    def places(self, positions: FloatArray) -> tuple[IntArray, FloatArray]:
        """Index of the piece at each position (z,) in m, and the fraction of it to the left, both (z,)."""
        piece = self.nodes.searchsorted(positions, side="right") - 1
        piece = np.minimum(np.maximum(piece, 0), self.element.size - 1)
        left = self.nodes[piece]
        fraction = (positions - left) / (self.nodes[piece + 1] - left)
        return piece, np.minimum(np.maximum(fraction, 0.0), 1.0)

    def on_springs(self, stiffness: FloatArray) -> "DiscretisedShaft":
        """The same pieces with other springs at the nodes, (p + 1, n), in scaled units."""
        return replace(self, node_stiffness=stiffness)

    def node_at(self, position: float) -> int:
        """Index of the node at a position (m), which must be one of the nodes."""
        return station_index(self.nodes, position)

    def with_nodes(self, positions: FloatArray) -> "DiscretisedShaft":
        """The same chain with nodes, bare ones where there were none, at positions (k,) in m as well."""
        nodes = merged_positions(self.nodes, positions.tolist())
        if nodes.size == self.nodes.size:
            return self
        piece, start = self.places(nodes[:-1])
        end = np.where(piece[1:] == piece[:-1], start[1:], 1.0) if piece.size > 1 else np.ones(0)
        part = np.append(end, 1.0) - start
        element, index = self.element[piece], np.searchsorted(nodes, self.nodes)
        coefficients = restricted(self.table.coefficients[element], 2.0 * start + part - 1.0, part)
        return replace(
            self,
            nodes=nodes,
            table=ShaftElements(self.table.lengths[element] * part, coefficients),
            element=np.arange(piece.size),
            node_inertia=spread(nodes.size, index, self.node_inertia),
            node_stiffness=spread(nodes.size, index, self.node_stiffness),
            node_polar=spread(nodes.size, index, self.node_polar),
        )

    @cached_property
    def rigid_shapes(self) -> FloatArray:
        """Independent rigid motions, which strain nothing, as node displacements, (zero modes, p + 1, n).

        An axial force does work on a tilting shaft, so that a shaft with an axial force has no free tilt.
        """
        if self.size == 2 and np.count_nonzero(self.node_stiffness[:, 0]) > 1:
            return np.zeros((0, self.nodes.size, 2))
        place = (self.nodes - self.nodes[0]) / self.length_unit
        if self.size == 1:
            free = not bool((self.node_stiffness > 0.0).any())
            return np.ones((1, place.size, 1))[: int(free)]
        held = place[self.node_stiffness[:, 0] > 0.0]
        slope, constant = np.ones_like(place), np.zeros_like(place)
        loaded = bool(self.table.coefficients[:, 5].any())
        tilt_held = loaded or bool((self.node_stiffness[:, 1] > 0.0).any())
        if held.size == 0:
            shift = np.stack([slope, constant], axis=-1)
            tilt = np.stack([place - place.mean(), slope], axis=-1)
            return np.stack([shift] if tilt_held else [shift, tilt])
        if held.size == 1 and not tilt_held:
            return np.stack([place - held[0], slope], axis=-1)[None]
        return np.zeros((0, place.size, 2))


def spread(size: int, index: IntArray, values: npt.NDArray[Scalar]) -> npt.NDArray[Scalar]:
    """Values at some of ``size`` nodes, those of the given ascending indices; zero at the others."""
    if size == index.size:
        return values
    whole = np.zeros((size, *values.shape[1:]), dtype=values.dtype)
    whole[index] = values
    return whole
