"""Discretised shaft: shaft elements between nodes, cut from a continuous shaft for a highest frequency.

This is the common form of bending, torsion and axial motion. Every node may carry inertia and a spring to ground; every
shaft element between two nodes has an exact transfer matrix (`gearwhine.rotors.transfer_matrix.timoshenko`). Lengths
and forces are scaled so that displacements and forces are of one size and a state vector can be normalised as a whole.
`gearwhine.rotors.transfer_matrix.rotor_shafts` makes the continuous and the discretised shafts of a rotor.

A continuous shaft has spans between stations, which are cut into elements so short that none, clamped at both ends, has
a natural frequency of its own below the highest asked. For a Timoshenko element of length h, clamped ends give by
Wirtinger's inequality ‖x‖ ≤ (h/π)‖x'‖, ‖β‖ ≤ (h/π)‖β'‖ and ‖x'‖ ≤ ‖x' − β‖ + (h/π)‖β'‖, so that its strain energy,
that of an axial force P included, exceeds its kinetic energy for every field when, with u = (h/π)² and C = max(−P, 0),

    2 (ρA ω² u + C) < κGA    and    2 (ρA ω² u + C) u + ρI ω² u < EI,

with the least stiffness and the largest inertia of the element; of a rod, when ρA ω² u < EA. An element without mass,
by ‖x'‖² ≤ g/(g − 1) ‖x' − β‖² + g ‖β‖² with g = κGA / (κGA − C), may bear 2 C > κGA: then g C u < EI. This removes the
term J₀ from the Wittrick–Williams count and bounds the growth of any transfer matrix.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray, IndexArray
from gearwhine.rotors.errors import RotorError
from gearwhine.rotors.model.profile import merged_positions, restricted
from gearwhine.rotors.model.segment import gauss_rule
from gearwhine.rotors.model.shaft import station_index
from gearwhine.rotors.transfer_matrix.timoshenko import NumberArray, ShaftElements

Scalar = TypeVar("Scalar", bound=np.generic)


# Products of two fields, on elements this short, are integrated to rounding.
GAUSS_FRACTIONS, GAUSS_WEIGHTS = gauss_rule(10)
# Quadrature rule for the squares of forward and backward whirl.
SQUARE_FRACTIONS, SQUARE_WEIGHTS = gauss_rule(6)


@dataclass(frozen=True)
class EnergyWeights:
    """Weights of squared motions and strains at the Gauss points of all elements, and then at the nodes.

    ``mass`` and ``polar`` weigh n displacements at each; ``strain`` weighs the rotation (of a beam) and the n
    forces at each Gauss point and the n displacements of each node.
    """

    mass: FloatArray
    polar: FloatArray
    strain: FloatArray


@dataclass(frozen=True)
class DiscretisedShaft:
    """A shaft as elements between nodes, in scaled units; n is 2 for bending and 1 for a rod.

    Attributes
    ----------
    nodes : ndarray, shape (p + 1,)
        Ascending positions [m] (they and the stations are not in scaled units).
    table : ShaftElements
        The distinct elements, in scaled units.
    element : ndarray of int, shape (p,)
        Place of each element in the table.
    node_inertia, node_stiffness : ndarray, shape (p + 1, n)
        Inertia and stiffness at the nodes; an infinite stiffness is a constraint.
    node_polar : ndarray, shape (p + 1,)
        Polar moment of inertia at the nodes, for the gyroscopic matrix of bending.
    length_unit : float
        Length unit [m].
    displacement_unit : ndarray, shape (n,)
        SI value of a displacement and rotation of one, at unit modal mass in kg·m² or kg.
    highest : float
        Frequency up to which the elements are short enough [rad/s].
    stations : ndarray, shape (s,)
        Ascending positions of segment ends, discs and supports [m]; nodes need not be among them.
    """

    nodes: FloatArray
    table: ShaftElements
    element: IndexArray
    node_inertia: FloatArray
    node_stiffness: FloatArray
    node_polar: FloatArray
    length_unit: float
    displacement_unit: FloatArray
    highest: float
    stations: FloatArray

    @property
    def size(self) -> int:
        """Number of displacements at a node: 2 in bending, 1 for a rod."""
        return self.table.size

    @cached_property
    def lengths(self) -> FloatArray:
        """Lengths of the elements in scaled units, (p,)."""
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
        from gearwhine.rotors.transfer_matrix.mode_shape_kernels import energy_weights

        table, nodal = self.table, (self.node_stiffness, self.node_inertia, self.node_polar)
        return EnergyWeights(
            *energy_weights(GAUSS_FRACTIONS, GAUSS_WEIGHTS, table.lengths, table.coefficients, self.element, *nodal)
        )

    @cached_property
    def inertia_weights(self) -> FloatArray:
        """Weights of squared displacement and rotation at `SQUARE_FRACTIONS` (g,) of distinct elements, (e, g, 2)."""
        along = self.table.coefficients_along(SQUARE_FRACTIONS)[:, :, 2:4]
        return np.asarray(along * (self.table.lengths[:, None] * SQUARE_WEIGHTS)[:, :, None])

    def coefficients_at(self, number: IndexArray, fraction: FloatArray) -> FloatArray:
        """Coefficients of the table at fractions (z,) of elements (z,) by number, (z, 6) or (z, 2)."""
        return self.table.coefficients_at(self.element[number], fraction)

    def transfer_matrices(self, translation: npt.ArrayLike, rotation: npt.ArrayLike | None = None) -> NumberArray:
        """Transfer matrices of all elements at every ω² of a (b,) array, (p, b, 2n, 2n).

        Parameters
        ----------
        translation : array_like, shape (b,)
            Factor ω² of the mass, real or complex; −λ² for e^{λt} in circular coordinates.
        rotation : array_like, shape (b,), optional
            Factor ω² of the rotary inertia; −λ² ± 2iΩλ in circular coordinates; by default ``translation``.
        """
        return np.moveaxis(self.table.transfer_matrices(translation, rotation)[:, :, 0], 0, 1)[self.element]

    def transfer_matrices_to(
        self,
        number: IndexArray,
        fraction: FloatArray,
        translation: npt.ArrayLike,
        rotation: npt.ArrayLike | None = None,
    ) -> NumberArray:
        """Transfer matrices from the left ends of elements (z,) by number to fractions (z,) of them, (z, b, 2n, 2n)."""
        return self.table.transfer_matrices_to(self.element[number], fraction, translation, rotation)

    def places(self, positions: FloatArray) -> tuple[IndexArray, FloatArray]:
        """Find the number of the element at each position (z,) in m, and the fraction of it to the left, both (z,)."""
        number = self.nodes.searchsorted(positions, side="right") - 1
        number = np.minimum(np.maximum(number, 0), self.element.size - 1)
        left = self.nodes[number]
        fraction = (positions - left) / (self.nodes[number + 1] - left)
        return number, np.minimum(np.maximum(fraction, 0.0), 1.0)

    def on_springs(self, stiffness: FloatArray) -> "DiscretisedShaft":
        """Return the same elements with other springs at the nodes, (p + 1, n), in scaled units."""
        return replace(self, node_stiffness=stiffness)

    def node_at(self, position: float) -> int:
        """Index of the node at a position [m], which must be one of the nodes."""
        return station_index(self.nodes, position)

    def with_nodes(self, positions: FloatArray) -> "DiscretisedShaft":
        """Add nodes at positions (k,) in m, bare ones where there were none."""
        nodes = merged_positions(self.nodes, positions.tolist())
        if nodes.size == self.nodes.size:
            return self
        number, start = self.places(nodes[:-1])
        end = np.where(number[1:] == number[:-1], start[1:], 1.0) if number.size > 1 else np.ones(0)
        part = np.append(end, 1.0) - start
        element, index = self.element[number], np.searchsorted(nodes, self.nodes)
        coefficients = restricted(self.table.coefficients[element], 2.0 * start + part - 1.0, part)
        return replace(
            self,
            nodes=nodes,
            table=ShaftElements(self.table.lengths[element] * part, coefficients),
            element=np.arange(number.size),
            node_inertia=spread(nodes.size, index, self.node_inertia),
            node_stiffness=spread(nodes.size, index, self.node_stiffness),
            node_polar=spread(nodes.size, index, self.node_polar),
        )

    @property
    def has_axial_force(self) -> bool:
        """Whether a static axial force acts along a part of the shaft, of which bending alone takes account."""
        return self.size == 2 and bool(self.table.coefficients[:, 5].any())

    @property
    def quadrature_places(self) -> FloatArray:
        """Places of `energy_weights` from the first node: Gauss points of all elements, then nodes, in scaled units."""
        inside = self.nodes[:-1, None] + np.diff(self.nodes)[:, None] * GAUSS_FRACTIONS
        return np.asarray((np.concatenate([inside.ravel(), self.nodes]) - self.nodes[0]) / self.length_unit)

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
        supported = place[self.node_stiffness[:, 0] > 0.0]
        slope, constant = np.ones_like(place), np.zeros_like(place)
        tilt_held = self.has_axial_force or bool((self.node_stiffness[:, 1] > 0.0).any())
        if supported.size == 0:
            shift = np.stack([slope, constant], axis=-1)
            tilt = np.stack([place - place.mean(), slope], axis=-1)
            return np.stack([shift] if tilt_held else [shift, tilt])
        if supported.size == 1 and not tilt_held:
            return np.stack([place - supported[0], slope], axis=-1)[None]
        return np.zeros((0, place.size, 2))


def spread(size: int, index: IndexArray, values: npt.NDArray[Scalar]) -> npt.NDArray[Scalar]:
    """Spread values at the nodes of ascending ``index`` to ``size`` nodes; zero at the others."""
    if size == index.size:
        return values
    whole = np.zeros((size, *values.shape[1:]), dtype=values.dtype)
    whole[index] = values
    return whole


# Factor by which elements are shorter than the inequalities demand: the series then stay below |λ²| = 5.
ELEMENT_MARGIN = 2.0
MOST_ELEMENTS = 50_000


@dataclass(frozen=True)
class ContinuousShaft:
    """One motion of a shaft as spans between stations, in scaled units; n is 2 for bending and 1 for a rod.

    Attributes
    ----------
    label : str
        Name in messages.
    nodes : ndarray, shape (s + 1,)
        Ends of the spans [m].
    stations : ndarray, shape (r,)
        Ascending positions of segment ends, discs and supports [m].
    kind, start, end, lengths : ndarray, shape (s,)
        Kind of every span, the fractions of the kind's span that it covers, and its length [m].
    coefficients : ndarray, shape (k, 6 or 2, j)
        Coefficients of the kinds, as in `gearwhine.rotors.transfer_matrix.timoshenko.ShaftElements`.
    uniform : ndarray of bool, shape (k,)
        Whether a kind does not taper.
    stiffness, inertia : ndarray, shape (k, n)
        Least stiffness and largest inertia of the kinds, per length in SI.
    force : ndarray, shape (k,)
        Axial force of the kinds [N].
    node_inertia, node_stiffness : ndarray, shape (s + 1, n)
        Inertia and stiffness at the nodes; ``node_polar`` (s + 1,) is the polar inertia.
    length_unit, displacement_unit : float, ndarray
        Units as in `gearwhine.rotors.transfer_matrix.discretised_shaft.DiscretisedShaft`.
    """

    label: str
    nodes: FloatArray
    stations: FloatArray
    kind: IndexArray
    start: FloatArray
    end: FloatArray
    lengths: FloatArray
    coefficients: FloatArray
    uniform: npt.NDArray[np.bool_]
    stiffness: FloatArray
    inertia: FloatArray
    force: FloatArray
    node_inertia: FloatArray
    node_stiffness: FloatArray
    node_polar: FloatArray
    length_unit: float
    displacement_unit: FloatArray

    @property
    def available_modes(self) -> float:
        """Number of modes: infinite with distributed mass, else the number of inertias that can move."""
        if bool(self.inertia.any()):
            return np.inf
        return int(np.count_nonzero((self.node_inertia > 0.0) & ~np.isinf(self.node_stiffness)))

    def likely_frequency(self, count: int) -> float:
        """Estimate of the ``count``-th natural frequency from the waves of the bare shaft, or a frequency scale; rad/s.

        It is that of a simply supported shaft without discs: a free shaft's is lower, a clamped one's higher.
        """
        shear, bending = self._wave_sums
        if shear == 0.0:
            # In scaled units stiffness is about one.
            return float(np.pi / np.sqrt(max(self.node_inertia[:, 0].sum(), 1e-300)))
        phase = (count - 0.5) * np.pi
        # Waves are no longer than those of bending without shear, nor than those of shear without bending.
        return min(phase / shear, (phase / bending) ** 2) if bending else phase / shear

    @cached_property
    def _wave_sums(self) -> tuple[float, float]:
        """Integrals ∫ (m / k)^½ dz with the shear (or rod) stiffness, and ∫ (m / k)^¼ dz with the bending stiffness."""
        heavy = self.inertia[self.kind, 0]
        shear = self.lengths @ np.sqrt(heavy / self.stiffness[self.kind, 0])
        bent = self.stiffness.shape[1] == 2
        bending = self.lengths @ (heavy / self.stiffness[self.kind, 1]) ** 0.25 if bent else 0.0
        return float(shear), float(bending)

    def cut(self, highest: float) -> DiscretisedShaft:
        """Discretise the shaft for frequencies up to ``highest`` rad/s.

        Raises
        ------
        RotorError
            It takes too many elements.
        """
        from gearwhine.rotors.transfer_matrix.timoshenko_kernels import element_counts

        counts = element_counts(
            highest, ELEMENT_MARGIN, self.kind, self.lengths, self.stiffness, self.inertia, self.force
        )
        if counts.sum() > MOST_ELEMENTS:
            raise RotorError(
                f"{self.label}: a limit of {highest:g} rad/s needs {counts.sum():.0f} shaft elements, "
                f"more than {MOST_ELEMENTS}; expected a lower frequency limit or fewer modes"
            )
        return self.in_elements(counts.astype(np.intp), highest)

    def in_elements(self, counts: IndexArray, highest: float) -> DiscretisedShaft:
        """Discretise every span into ``counts`` (s,) equal elements, valid up to ``highest`` rad/s."""
        from gearwhine.rotors.transfer_matrix.timoshenko_kernels import cut_spans

        nodes, index, element, kind, middle, half, lengths = cut_spans(
            counts, self.nodes, self.kind, self.start, self.end, self.lengths, self.uniform
        )
        coefficients = self.coefficients[kind]
        if coefficients.shape[2] > 1:
            coefficients = restricted(coefficients, middle, half)
        return DiscretisedShaft(
            nodes=nodes,
            table=ShaftElements(lengths / self.length_unit, coefficients),
            element=element,
            node_inertia=spread(nodes.size, index, self.node_inertia),
            node_stiffness=spread(nodes.size, index, self.node_stiffness),
            node_polar=spread(nodes.size, index, self.node_polar),
            length_unit=self.length_unit,
            displacement_unit=self.displacement_unit,
            highest=highest,
            stations=self.stations,
        )

    def held(self, places: Sequence[float], *springs: Sequence[tuple[float, ...]]) -> "list[ContinuousShaft]":
        """Put the shaft on springs to ground at some places [m], n stiffnesses (in scaled units) each.

        Returns one shaft for each set of springs; the places are common to all sets.
        """
        if not places:
            return [self] * len(springs)
        nodes = merged_positions(self.nodes, places)
        continuous_shaft = self if nodes.size == self.nodes.size else self.with_nodes(nodes)
        stations = merged_positions(self.stations, places)
        index = [station_index(nodes, place) for place in places]
        continuous_shafts = []
        for stiffness in springs:
            node_stiffness = continuous_shaft.node_stiffness.copy()
            for node, spring in zip(index, stiffness, strict=True):
                node_stiffness[node] += spring
            continuous_shafts.append(replace(continuous_shaft, node_stiffness=node_stiffness, stations=stations))
        return continuous_shafts

    def with_nodes(self, nodes: FloatArray) -> "ContinuousShaft":
        """Replace the nodes [m] by others that include them; new ones carry nothing, and are no stations."""
        span = np.clip(np.searchsorted(self.nodes, 0.5 * (nodes[1:] + nodes[:-1])) - 1, 0, self.kind.size - 1)
        left, width = self.nodes[span], np.diff(self.nodes)[span]
        # Places within the span, and from them within the kind's own span.
        first, last = (nodes[:-1] - left) / width, (nodes[1:] - left) / width
        reach = (self.end - self.start)[span]
        whole = (first == 0.0) & (last == 1.0)
        index = np.searchsorted(nodes, self.nodes)
        return replace(
            self,
            nodes=nodes,
            kind=self.kind[span],
            start=self.start[span] + first * reach,
            end=self.start[span] + last * reach,
            lengths=np.where(whole, self.lengths[span], np.diff(nodes)),
            node_inertia=spread(nodes.size, index, self.node_inertia),
            node_stiffness=spread(nodes.size, index, self.node_stiffness),
            node_polar=spread(nodes.size, index, self.node_polar),
        )


def discretise_together(continuous_shafts: Sequence[ContinuousShaft], highest: float) -> list[DiscretisedShaft]:
    """Discretise shafts that differ only in their springs, valid up to ``highest`` rad/s."""
    first = continuous_shafts[0].cut(highest)
    index = first.nodes.searchsorted(continuous_shafts[0].nodes)
    springs = [
        spread(first.nodes.size, index, continuous_shaft.node_stiffness) for continuous_shaft in continuous_shafts[1:]
    ]
    return [first, *(first.on_springs(stiffness) for stiffness in springs)]
