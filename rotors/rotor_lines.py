"""Lines and chains of a rotor: its bending in one plane, its torsion, its axial motion."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from .axis_spring import AxisSpring
from .bearing import RadialSupport
from .chain import Chain
from .lines import Line
from .lumped import station_inertias
from .profile import AXIAL, BENDING, TORSION
from .shaft import Rotor, merged_positions

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
RodMotion = Literal["torsion", "axial"]


@dataclass(frozen=True)
class Spans:
    """A rotor between the places where its section changes or an inertia sits: what all its motions share.

    Attributes
    ----------
    nodes
        (s + 1,): ends of the spans, m.
    kind, start, end, lengths
        (s,): as in `rotors.lines.Line`, the kinds those of the rotor's profile.
    inertias
        (s + 1, 3): mass (kg), diametral and polar moment of inertia (kg·m²) at the nodes.
    """

    nodes: FloatArray
    kind: IntArray
    start: FloatArray
    end: FloatArray
    lengths: FloatArray
    inertias: FloatArray


def spans_of(rotor: Rotor) -> Spans:
    """Spans of a rotor; neighbours of one uniform kind with nothing between them are one.

    A file that gives a plain shaft in sixty elements so costs what the shaft costs. The transfer matrix of a uniform
    span is exact at any length, and what is asked for inside it is found by the exact field.
    """
    profile = rotor.profile
    edges = profile.edges
    nodes = merged_positions(edges, [disc.at for disc in rotor.discs])
    inertias = station_inertias(rotor, nodes)
    span = np.clip(np.searchsorted(edges, 0.5 * (nodes[1:] + nodes[:-1])) - 1, 0, edges.size - 2)
    left, width, kind = edges[span], np.diff(edges)[span], profile.kind[span]
    start, end = (nodes[:-1] - left) / width, (nodes[1:] - left) / width
    lengths = np.where((start == 0.0) & (end == 1.0), profile.lengths[span], np.diff(nodes))
    first = np.ones(kind.size, dtype=np.bool_)
    first[1:] = (kind[1:] != kind[:-1]) | ~profile.uniform[kind[1:]] | inertias[1:-1].any(axis=1)
    if first.all():
        return Spans(nodes, kind, start, end, lengths, inertias)
    index = np.flatnonzero(first)
    kept = np.append(index, nodes.size - 1)
    tapers = ~profile.uniform[kind[index]]
    return Spans(
        nodes=nodes[kept],
        kind=kind[index],
        start=np.where(tapers, start[index], 0.0),
        end=np.where(tapers, end[index], 1.0),
        lengths=np.add.reduceat(lengths, index),
        inertias=inertias[kept],
    )


@dataclass(frozen=True)
class FreeLines:
    """Lines of a rotor without supports, each made when first asked for; a rotor holds its own."""

    rotor: Rotor

    @cached_property
    def bending(self) -> Line:
        """Bending in one plane."""
        rotor, profile = self.rotor, self.rotor.profile
        length, stiffness = rotor.length, profile.extremes[:, :2]
        force = float(np.exp(np.log(stiffness[profile.kind, 1]).mean())) / length**2
        distributed = float(rotor.mass_model == "distributed")
        units = [force, force * length**2, distributed * length**2 / force, distributed / force, 1.0, 1.0 / force]
        per_node = np.array([length / force, 1.0 / (force * length)])
        inertias = self._spans.inertias
        return self._line(
            coefficients=profile.coefficients[:, BENDING] * np.array(units)[:, None],
            stiffness=stiffness,
            inertia=distributed * profile.extremes[:, 2:4],
            force=profile.extremes[:, 4],
            node_inertia=inertias[:, :2] * per_node,
            node_polar=inertias[:, 2] * per_node[1],
            displacement_unit=np.array([length, 1.0]) / np.sqrt(force * length),
        )

    @cached_property
    def torsion(self) -> Line:
        """Torsion."""
        return self._rod(TORSION, 2)

    @cached_property
    def axial(self) -> Line:
        """Axial motion."""
        return self._rod(AXIAL, 0)

    def _rod(self, rows: slice, inertia_column: int) -> Line:
        rotor, profile = self.rotor, self.rotor.profile
        given = profile.coefficients[:, rows]
        # Compliance at the middle stands for that of a tapering span.
        force = float(np.exp(-np.log(given[profile.kind, 0, 0]).mean())) / rotor.length
        distributed = float(rotor.mass_model == "distributed")
        sides = np.array([-1.0, 0.0, 1.0])[:, None] ** np.arange(given.shape[2])
        values = np.einsum("kfj,sj->ksf", given, sides)
        units = [force * rotor.length, distributed * rotor.length / force]
        return self._line(
            coefficients=given * np.array(units)[:, None],
            stiffness=1.0 / values[:, :, :1].max(axis=1),
            inertia=distributed * values[:, :, 1:].max(axis=1),
            force=np.zeros(given.shape[0]),
            node_inertia=self._spans.inertias[:, inertia_column, None] / force,
            node_polar=np.zeros(self._spans.nodes.size),
            displacement_unit=np.array([1.0 / np.sqrt(force)]),
        )

    @cached_property
    def _spans(self) -> "Spans":
        return spans_of(self.rotor)

    def _line(
        self,
        *,
        coefficients: FloatArray,
        stiffness: FloatArray,
        inertia: FloatArray,
        force: FloatArray,
        node_inertia: FloatArray,
        node_polar: FloatArray,
        displacement_unit: FloatArray,
    ) -> Line:
        rotor, spans = self.rotor, self._spans
        return Line(
            label=f"rotor {rotor.name!r}",
            nodes=spans.nodes,
            stations=rotor.stations,
            kind=spans.kind,
            start=spans.start,
            end=spans.end,
            lengths=spans.lengths,
            coefficients=np.ascontiguousarray(coefficients),
            uniform=rotor.profile.uniform,
            stiffness=np.ascontiguousarray(stiffness),
            inertia=inertia,
            force=np.ascontiguousarray(force),
            node_inertia=node_inertia,
            node_stiffness=np.zeros_like(node_inertia),
            node_polar=node_polar,
            length_unit=rotor.length,
            displacement_unit=displacement_unit,
        )


def bending_line(rotor: Rotor, supports: Sequence[RadialSupport] = ()) -> Line:
    """A rotor's bending in one plane on springs."""
    return bending_lines(rotor, [supports])[0]


def bending_lines(rotor: Rotor, planes: Sequence[Sequence[RadialSupport]]) -> list[Line]:
    """A rotor's bending in several planes, whose springs stand at the same places."""
    places = [support.at for support in planes[0]]
    for place in places:
        rotor.require_on_shaft(f"rotor {rotor.name!r} support", place)
    free = rotor.once(FreeLines).bending
    # A displacement unit squared is the reciprocal of a unit of stiffness.
    shift, tilt = (free.displacement_unit**2).tolist()
    springs = [[(one.stiffness * shift, one.tilt_stiffness * tilt) for one in supports] for supports in planes]
    return free.held(places, *springs)


def bending_chain(rotor: Rotor, supports: Sequence[RadialSupport], highest: float) -> Chain:
    """Chain of a rotor's bending in one plane, good up to ``highest`` rad/s."""
    return bending_line(rotor, supports).cut(highest)


def rod_line(rotor: Rotor, springs: Sequence[AxisSpring], motion: RodMotion) -> Line:
    """A rotor's torsion, or its axial motion, on springs."""
    for spring in springs:
        rotor.require_on_shaft(f"rotor {rotor.name!r} spring", spring.at)
    free = rotor.once(FreeLines).torsion if motion == "torsion" else rotor.once(FreeLines).axial
    unit = float(free.displacement_unit[0]) ** 2
    return free.held([spring.at for spring in springs], [(spring.stiffness * unit,) for spring in springs])[0]


def axial_chain_on(rotor: Rotor, bending: Chain) -> Chain:
    """Chain of a rotor's axial motion with the nodes, and the units of length and force, of a chain of its bending.

    It has no springs, and no other mass at its nodes than the bending chain has.
    """
    free = rotor.once(FreeLines).axial.with_nodes(bending.nodes)
    # A displacement unit squared is the reciprocal of a unit of stiffness, by which compliance and inertia are scaled.
    ratio = float(free.displacement_unit[0] / bending.displacement_unit[0]) ** 2
    line = replace(
        free,
        coefficients=free.coefficients * np.array([ratio, 1.0 / ratio])[:, None],
        node_inertia=free.node_inertia / ratio,
        displacement_unit=bending.displacement_unit[:1],
    )
    return line.in_pieces(np.ones(bending.element.size, dtype=np.intp), bending.highest)
