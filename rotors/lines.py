"""A shaft between its stations, before it is cut into pieces short enough for a frequency.

Pieces are so short that none, clamped at both ends, has a natural frequency of its own below the highest asked.
For a Timoshenko piece of length h, clamped ends give by Wirtinger's inequality ‖x‖ ≤ (h/π)‖x'‖,
‖β‖ ≤ (h/π)‖β'‖ and ‖x'‖ ≤ ‖x' − β‖ + (h/π)‖β'‖, so that its strain energy, that of an axial force P included,
exceeds its kinetic energy for every field when, with u = (h/π)² and C = max(−P, 0),

    2 (ρA ω² u + C) < κGA    and    2 (ρA ω² u + C) u + ρI ω² u < EI,

with the least stiffness and the largest inertia of the piece; of a rod, when ρA ω² u < EA. This removes the
term J₀ from the Wittrick–Williams count and bounds the growth of any transfer matrix.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .chain import Chain, spread
from .errors import RotorError
from .profile import restricted
from .timoshenko import PieceTable

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

# Pieces are this many times shorter than the inequalities demand: the series then stay below |λ²| = 5.
PIECE_MARGIN = 2.0
MOST_PIECES = 50_000


@dataclass(frozen=True)
class Line:
    """Spans between stations, in scaled units; n is 2 for bending and 1 for a rod.

    Attributes
    ----------
    label
        What messages call it.
    nodes
        (s + 1,): ends of the spans, m.
    is_station
        (s + 1,): which of them are stations, rather than cuts of a cone.
    kind, start, end, lengths
        (s,): of every span its kind, the fractions of that kind's own span it covers, and its length, m.
    coefficients, uniform
        (k, 6 or 2, j) and (k,): of the kinds, as in `rotors.timoshenko.PieceTable`.
    stiffness, inertia, force
        (k, n), (k, n) and (k,): their least stiffness, their largest inertia, and axial force, per length in SI.
    node_inertia, node_stiffness
        (s + 1, n); and ``node_polar`` (s + 1,).
    length_unit, displacement_unit
        As in `rotors.chain.Chain`.
    """

    label: str
    nodes: FloatArray
    is_station: npt.NDArray[np.bool_]
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
        """How many modes there are: infinite with distributed mass, else the inertias that can move."""
        if bool(self.inertia.any()):
            return np.inf
        return int(np.count_nonzero((self.node_inertia > 0.0) & ~np.isinf(self.node_stiffness)))

    def likely_frequency(self, count: int) -> float:
        """About the ``count``-th natural frequency, rad/s: of the bare shaft by its wave number, or a scale."""
        flexible, heavy = self.stiffness[self.kind, -1], self.inertia[self.kind, 0]
        if bool(heavy.any()):
            power = 0.25 if self.stiffness.shape[1] == 2 else 0.5
            return float(((count + 0.5) * np.pi / (self.lengths @ (heavy / flexible) ** power)) ** (0.5 / power))
        # In the chain's units stiffness is about one.
        return float(np.pi / np.sqrt(max(self.node_inertia[:, 0].sum(), 1e-300)))

    def cut(self, highest: float) -> Chain:
        """Chain good up to ``highest`` rad/s.

        Raises
        ------
        RotorError
            It takes too many pieces.
        """
        longest = self._longest(highest)[self.kind]
        pieces = np.maximum(np.ceil(PIECE_MARGIN * self.lengths / longest), 1.0)
        if pieces.sum() > MOST_PIECES:
            raise RotorError(
                f"{self.label}: a limit of {highest:g} rad/s needs {pieces.sum():.0f} pieces of shaft, "
                f"more than {MOST_PIECES}; expected a lower frequency limit or fewer modes"
            )
        counts = pieces.astype(np.intp)
        lengths, kind, start, end, nodes = self.lengths, self.kind, self.start, self.end, self.nodes
        if int(counts.sum()) > counts.size:
            span = np.repeat(np.arange(counts.size), counts)
            within = np.arange(span.size) - np.repeat(np.cumsum(counts) - counts, counts)
            lengths, kind = (lengths / counts)[span], kind[span]
            part = (end - start) / counts
            start = start[span] + within * part[span]
            end = start + part[span]
            nodes = np.append(nodes[span] + within * (np.diff(nodes) / counts)[span], nodes[-1])
        table, element = piece_table(self.coefficients, self.uniform, kind, start, end, lengths / self.length_unit)
        return Chain(
            nodes=nodes,
            table=table,
            element=element,
            node_inertia=spread(nodes, self.nodes, self.node_inertia),
            node_stiffness=spread(nodes, self.nodes, self.node_stiffness),
            node_polar=spread(nodes, self.nodes, self.node_polar),
            length_unit=self.length_unit,
            displacement_unit=self.displacement_unit,
            highest=highest,
            is_station=spread(nodes, self.nodes, self.is_station.astype(np.float64)) > 0.0,
        )

    def _longest(self, highest: float) -> FloatArray:
        """Longest piece of every kind, m, (k,)."""
        squared = highest**2
        with np.errstate(divide="ignore"):
            if self.stiffness.shape[1] == 1:
                return np.asarray(np.pi * np.sqrt(self.stiffness[:, 0] / (squared * self.inertia[:, 0])))
            shear, bending = self.stiffness[:, 0], self.stiffness[:, 1]
            mass, rotary = squared * self.inertia[:, 0], squared * self.inertia[:, 1]
            # Tension counts as compression does: the fields it makes grow as fast.
            linear = rotary + 2.0 * np.abs(self.force)
            by_bending = 2.0 * bending / (linear + np.sqrt(linear**2 + 8.0 * mass * bending))
            by_shear = (0.5 * shear - np.maximum(-self.force, 0.0)) / mass
            return np.asarray(np.pi * np.sqrt(np.minimum(by_shear, by_bending)))


def piece_table(
    coefficients: FloatArray,
    uniform: npt.NDArray[np.bool_],
    kind: IntArray,
    start: FloatArray,
    end: FloatArray,
    lengths: FloatArray,
) -> tuple[PieceTable, IntArray]:
    """The different ones among pieces (p,) of some kinds, and which of them each piece is."""
    centre = np.where(uniform[kind], 0.0, start + end - 1.0)
    known: dict[tuple[int, float, float], int] = {}
    keys = zip(kind.tolist(), centre.tolist(), lengths.tolist(), strict=True)
    element = np.array([known.setdefault(key, len(known)) for key in keys], dtype=np.intp)
    first = np.unique(element, return_index=True)[1]
    chosen = kind[first]
    given = coefficients[chosen]
    if coefficients.shape[2] > 1:
        half = np.where(uniform[chosen], 1.0, (end - start)[first])
        given = restricted(given, centre[first], half)
    return PieceTable(lengths[first], given), element
