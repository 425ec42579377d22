"""A shaft cut into uniform pieces between nodes: the one form that bending and torsion share.

Every node may carry inertia and a spring to ground; every piece has an exact transfer matrix
(`rotors.timoshenko`). The chain is kept in units of its own (a length, a force or moment) in which
displacements and forces are of one size, so that a state vector can be normalised as a whole.

Pieces are short enough for the highest frequency asked that no piece, clamped at both ends, has a
natural frequency of its own below it. For a Timoshenko piece of length h, clamped ends give by
Wirtinger's inequality ‖β'‖ ≥ (π/h)‖β‖ and (π/h)‖x‖ ≤ ‖x' − β‖ + (h/π)‖β'‖, so that its strain energy
exceeds its kinetic energy for every field when

    2 ρA ω² (h/π)² < κGA    and    2 ρA ω² (h/π)⁴ + ρI ω² (h/π)² < EI.

This removes the term J₀ from the Wittrick–Williams count and bounds the growth of any transfer matrix.
"""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from .bearing import RadialSupport
from .errors import RotorError
from .lumped import station_inertias
from .shaft import Rotor, merged_positions, station_index
from .timoshenko import NumberArray, transfer_matrices

FloatArray = npt.NDArray[np.float64]

# Pieces are this many times shorter than the inequalities demand: the series then stay below |λ²| = 5.
PIECE_MARGIN = 2.0
MOST_PIECES = 50_000


@dataclass(frozen=True)
class Chain:
    """Uniform pieces between nodes, in scaled units; n is 2 for bending and 1 for torsion.

    Attributes
    ----------
    nodes
        (p + 1,): ascending positions, m (the only field not in scaled units).
    flexibility, inertia
        (p, n): per unit length, as in `rotors.timoshenko.transfer_matrices`.
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
    is_station
        (p + 1,): nodes that are stations, rather than cuts between them.
    """

    nodes: FloatArray
    flexibility: FloatArray
    inertia: FloatArray
    node_inertia: FloatArray
    node_stiffness: FloatArray
    node_polar: FloatArray
    length_unit: float
    displacement_unit: FloatArray
    highest: float
    is_station: npt.NDArray[np.bool_]

    @property
    def size(self) -> int:
        """Displacements at a node: 2 in bending, 1 in torsion."""
        return int(self.flexibility.shape[1])

    @property
    def lengths(self) -> FloatArray:
        """Lengths of the pieces in scaled units, (p,)."""
        return np.diff(self.nodes) / self.length_unit

    @property
    def constrained(self) -> npt.NDArray[np.bool_]:
        """Which node displacements are held, (p + 1, n)."""
        return np.isinf(self.node_stiffness)

    @property
    def finite_stiffness(self) -> FloatArray:
        """Node stiffness with constraints, which store no energy, as zero, (p + 1, n)."""
        return np.where(self.constrained, 0.0, self.node_stiffness)

    @property
    def available_modes(self) -> float:
        """How many modes there are: infinite with distributed mass, else the inertias that can move."""
        if bool((self.inertia > 0.0).any()):
            return np.inf
        return int(np.count_nonzero((self.node_inertia > 0.0) & ~self.constrained))

    def transfers(self, translation: NumberArray, rotation: NumberArray | None = None) -> NumberArray:
        """Transfer matrices of all pieces at every ω² of a (b,) array, real or complex, (p, b, 2n, 2n).

        ``rotation`` takes the place of ω² at the rotary inertia, where gyroscopic terms make it another.
        """
        lengths = np.ascontiguousarray(self.lengths)[:, None]
        turning = None if rotation is None else rotation[None, :]
        return transfer_matrices(
            self.flexibility[:, None], self.inertia[:, None], lengths, translation[None, :], turning
        )

    def node_at(self, position: float) -> int:
        """Index of the node at a position (m), which must be one of the nodes."""
        return station_index(self.nodes, position)

    def with_nodes(self, positions: FloatArray) -> "Chain":
        """The same chain with nodes, bare ones where there were none, at positions (k,) in m as well."""
        nodes = merged_positions(self.nodes, positions.tolist())
        piece = np.searchsorted(self.nodes, 0.5 * (nodes[1:] + nodes[:-1])) - 1
        return replace(
            self,
            nodes=nodes,
            flexibility=self.flexibility[piece],
            inertia=self.inertia[piece],
            node_inertia=_spread(nodes, self.nodes, self.node_inertia),
            node_stiffness=_spread(nodes, self.nodes, self.node_stiffness),
            node_polar=_spread(nodes, self.nodes, self.node_polar),
            is_station=_spread(nodes, self.nodes, self.is_station.astype(np.float64)) > 0.0,
        )

    def rigid_shapes(self) -> FloatArray:
        """Independent motions that strain nothing, as node displacements, (zero modes, p + 1, n)."""
        place = (self.nodes - self.nodes[0]) / self.length_unit
        if self.size == 1:
            free = not bool((self.node_stiffness > 0.0).any())
            return np.ones((1, place.size, 1))[: int(free)]
        slope, constant = np.ones_like(place), np.zeros_like(place)
        shift = np.stack([slope, constant], axis=-1)
        held = place[self.node_stiffness[:, 0] > 0.0]
        tilt_held = bool((self.node_stiffness[:, 1] > 0.0).any())
        if held.size == 0:
            tilt = np.stack([place - place.mean(), slope], axis=-1)
            return np.stack([shift] if tilt_held else [shift, tilt])
        if held.size == 1 and not tilt_held:
            return np.stack([place - held[0], slope], axis=-1)[None]
        return np.zeros((0, place.size, 2))


def bending_chain(rotor: Rotor, supports: tuple[RadialSupport, ...], highest: float) -> Chain:
    """Chain of a rotor's bending in one plane, good up to ``highest`` rad/s."""
    for support in supports:
        rotor.require_on_shaft(f"rotor {rotor.name!r} support", support.at)
    places = [*(disc.at for disc in rotor.discs), *(support.at for support in supports)]
    stations = merged_positions(rotor.joints, places)
    distributed = rotor.mass_model == "distributed"
    sections = np.array(
        [
            (1.0 / s.shear_stiffness, 1.0 / s.bending_stiffness, s.mass_per_length, s.polar_inertia_per_length)
            for s in (segment.section(0.5) for segment in rotor.segments)
        ]
    )
    per_length = sections[_segment_of_span(rotor, stations)]
    flexibility = per_length[:, :2]
    inertia = per_length[:, 2:] * np.array([1.0, 0.5]) * float(distributed)

    squared = highest**2
    mass, rotary = squared * inertia[:, 0], squared * inertia[:, 1]
    shear, bending = 1.0 / flexibility[:, 0], 1.0 / flexibility[:, 1]
    with np.errstate(divide="ignore"):
        longest_squared = np.minimum(
            shear / (2.0 * mass), 2.0 * bending / (rotary + np.sqrt(rotary**2 + 8.0 * mass * bending))
        )
    nodes, span_of_piece = _cut(rotor, stations, np.pi * np.sqrt(longest_squared), highest)

    at_nodes = station_inertias(rotor, stations)
    stiffness = np.zeros((stations.size, 2))
    for support in supports:
        stiffness[station_index(stations, support.at)] += support.stiffness, support.tilt_stiffness
    length = rotor.length
    force = float(np.exp(np.log(bending).mean())) / length**2
    per_node = np.array([length / force, 1.0 / (force * length)])
    return Chain(
        nodes=nodes,
        flexibility=flexibility[span_of_piece] * np.array([force, force * length**2]),
        inertia=inertia[span_of_piece] * np.array([length**2 / force, 1.0 / force]),
        node_inertia=_spread(nodes, stations, at_nodes[:, :2] * per_node),
        node_stiffness=_spread(nodes, stations, stiffness * per_node),
        node_polar=_spread(nodes, stations, at_nodes[:, 2] * per_node[1]),
        length_unit=length,
        displacement_unit=np.array([length, 1.0]) / np.sqrt(force * length),
        highest=highest,
        is_station=_spread(nodes, stations, np.ones(stations.size)) > 0.0,
    )


def torsion_chain(rotor: Rotor, highest: float) -> Chain:
    """Chain of a rotor's free torsion, good up to ``highest`` rad/s."""
    stations = merged_positions(rotor.joints, [*(disc.at for disc in rotor.discs)])
    sections = np.array(
        [
            (1.0 / s.torsional_stiffness, s.polar_inertia_per_length)
            for s in (segment.section(0.5) for segment in rotor.segments)
        ]
    )
    per_length = sections[_segment_of_span(rotor, stations)]
    distributed = float(rotor.mass_model == "distributed")
    flexibility, inertia = per_length[:, :1], per_length[:, 1:] * distributed
    with np.errstate(divide="ignore"):
        longest = np.pi / (highest * np.sqrt(flexibility[:, 0] * inertia[:, 0]))
    nodes, span_of_piece = _cut(rotor, stations, longest, highest)
    polar = station_inertias(rotor, stations)[:, 2:]
    moment = float(np.exp(-np.log(flexibility).mean())) / rotor.length
    return Chain(
        nodes=nodes,
        flexibility=flexibility[span_of_piece] * (moment * rotor.length),
        inertia=inertia[span_of_piece] * (rotor.length / moment),
        node_inertia=_spread(nodes, stations, polar / moment),
        node_stiffness=np.zeros((nodes.size, 1)),
        node_polar=np.zeros(nodes.size),
        length_unit=rotor.length,
        displacement_unit=np.array([1.0 / np.sqrt(moment)]),
        highest=highest,
        is_station=_spread(nodes, stations, np.ones(stations.size)) > 0.0,
    )


def _segment_of_span(rotor: Rotor, stations: FloatArray) -> npt.NDArray[np.intp]:
    """Index of the segment that holds each span between neighbouring stations, (s - 1,)."""
    middles = 0.5 * (stations[1:] + stations[:-1])
    return np.clip(np.searchsorted(rotor.joints, middles) - 1, 0, len(rotor.segments) - 1)


def _cut(
    rotor: Rotor, stations: FloatArray, longest: FloatArray, highest: float
) -> tuple[FloatArray, npt.NDArray[np.intp]]:
    """Nodes (p + 1,) that cut each span into equal pieces no longer than allowed, and each piece's span."""
    pieces = np.maximum(np.ceil(PIECE_MARGIN * np.diff(stations) / longest), 1.0)
    if pieces.sum() > MOST_PIECES:
        raise RotorError(
            f"rotor {rotor.name!r}: a limit of {highest:g} rad/s needs {pieces.sum():.0f} pieces of shaft, "
            f"more than {MOST_PIECES}; expected a lower frequency limit or fewer modes"
        )
    counts = pieces.astype(np.intp)
    inner = [
        np.linspace(left, right, count, endpoint=False)
        for left, right, count in zip(stations[:-1], stations[1:], counts, strict=True)
    ]
    nodes = np.concatenate([*inner, stations[-1:]])
    return nodes, np.repeat(np.arange(counts.size), counts)


def _spread(nodes: FloatArray, stations: FloatArray, values: FloatArray) -> FloatArray:
    """Values at the stations, put at the nodes that are those stations; zero at the others."""
    spread = np.zeros((nodes.size, *values.shape[1:]))
    spread[np.searchsorted(nodes, stations)] = values
    return spread
