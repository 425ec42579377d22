"""Continuous shaft: its spans between stations, and their discretisation into elements short enough for a frequency.

Pieces are so short that none, clamped at both ends, has a natural frequency of its own below the highest asked.
For a Timoshenko piece of length h, clamped ends give by Wirtinger's inequality ‖x‖ ≤ (h/π)‖x'‖,
‖β‖ ≤ (h/π)‖β'‖ and ‖x'‖ ≤ ‖x' − β‖ + (h/π)‖β'‖, so that its strain energy, that of an axial force P included,
exceeds its kinetic energy for every field when, with u = (h/π)² and C = max(−P, 0),

    2 (ρA ω² u + C) < κGA    and    2 (ρA ω² u + C) u + ρI ω² u < EI,

with the least stiffness and the largest inertia of the piece; of a rod, when ρA ω² u < EA. This removes the
term J₀ from the Wittrick–Williams count and bounds the growth of any transfer matrix.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from .chain import DiscretisedShaft, spread
from .errors import RotorError
from .profile import restricted
from .shaft import merged_positions, station_index
from .timoshenko import ShaftElements

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

# Pieces are this many times shorter than the inequalities demand: the series then stay below |λ²| = 5.
PIECE_MARGIN = 2.0
MOST_PIECES = 50_000


@dataclass(frozen=True)
class ContinuousShaft:
    """One motion of a shaft as spans between stations, in scaled units; n is 2 for bending and 1 for a rod.

    Attributes
    ----------
    label
        Name in messages.
    nodes
        (s + 1,): ends of the spans, m.
    stations
        (r,): ascending positions of segment ends, discs and supports, m.
    kind, start, end, lengths
        (s,): of every span its kind, the fractions of that kind's own span it covers, and its length, m.
    coefficients, uniform
        (k, 6 or 2, j) and (k,): of the kinds, as in `rotors.timoshenko.ShaftElements`.
    stiffness, inertia, force
        (k, n), (k, n) and (k,): their least stiffness, their largest inertia, and axial force, per length in SI.
    node_inertia, node_stiffness
        (s + 1, n); and ``node_polar`` (s + 1,).
    length_unit, displacement_unit
        As in `rotors.chain.DiscretisedShaft`.
    """

    label: str
    nodes: FloatArray
    stations: FloatArray
    kind: IntArray
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
            # In the chain's units stiffness is about one.
            return float(np.pi / np.sqrt(max(self.node_inertia[:, 0].sum(), 1e-300)))
        phase = (count - 0.5) * np.pi
        # Waves are no longer than those of bending without shear, nor than those of shear without bending.
        return min(phase / shear, (phase / bending) ** 2) if bending else phase / shear

    @cached_property
    def _wave_sums(self) -> tuple[float, float]:
        """∫ (m / k)^½ dz with the stiffness against shear (or of the rod), and ∫ (m / k)^¼ dz with that of bending."""
        heavy = self.inertia[self.kind, 0]
        shear = self.lengths @ np.sqrt(heavy / self.stiffness[self.kind, 0])
        bent = self.stiffness.shape[1] == 2
        bending = self.lengths @ (heavy / self.stiffness[self.kind, 1]) ** 0.25 if bent else 0.0
        return float(shear), float(bending)

    def cut(self, highest: float) -> DiscretisedShaft:
        """The discretised shaft, valid up to ``highest`` rad/s.

        Raises
        ------
        RotorError
            It takes too many pieces.
        """
        from .line_kernels import piece_counts

        counts = piece_counts(highest, PIECE_MARGIN, self.kind, self.lengths, self.stiffness, self.inertia, self.force)
        if counts.sum() > MOST_PIECES:
            raise RotorError(
                f"{self.label}: a limit of {highest:g} rad/s needs {counts.sum():.0f} pieces of shaft, "
                f"more than {MOST_PIECES}; expected a lower frequency limit or fewer modes"
            )
        return self.in_pieces(counts.astype(np.intp), highest)

    def in_pieces(self, counts: IntArray, highest: float) -> DiscretisedShaft:
        """The discretised shaft with every span in ``counts`` (s,) equal pieces, valid up to ``highest`` rad/s."""
        from .line_kernels import cut_spans

        nodes, index, element, kind, middle, half, lengths = cut_spans(
            counts, self.nodes, self.kind, self.start, self.end, self.lengths, self.uniform
        )
        given = self.coefficients[kind]
        if given.shape[2] > 1:
            given = restricted(given, middle, half)
        return DiscretisedShaft(
            nodes=nodes,
            table=ShaftElements(lengths / self.length_unit, given),
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
        """The same shaft on springs to ground at some places (m), n stiffnesses (in scaled units) each.

        Returns one shaft for each set of springs; the places are common to all sets.
        """
        if not places:
            return [self] * len(springs)
        nodes = merged_positions(self.nodes, places)
        line = self if nodes.size == self.nodes.size else self.with_nodes(nodes)
        stations = merged_positions(self.stations, places)
        index = [station_index(nodes, place) for place in places]
        lines = []
        for stiffness in springs:
            node_stiffness = line.node_stiffness.copy()
            for node, spring in zip(index, stiffness, strict=True):
                node_stiffness[node] += spring
            lines.append(replace(line, node_stiffness=node_stiffness, stations=stations))
        return lines

    def with_nodes(self, nodes: FloatArray) -> "ContinuousShaft":
        """The same shaft with nodes (m) that include its own; new ones carry nothing, and are no stations."""
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


def discretise_together(lines: Sequence[ContinuousShaft], highest: float) -> list[DiscretisedShaft]:
    """Discretised shafts, valid up to ``highest`` rad/s, of shafts that differ in their springs only."""
    first = lines[0].cut(highest)
    index = first.nodes.searchsorted(lines[0].nodes)
    springs = [spread(first.nodes.size, index, line.node_stiffness) for line in lines[1:]]
    return [first, *(first.on_springs(stiffness) for stiffness in springs)]
