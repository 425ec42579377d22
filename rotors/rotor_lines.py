"""Lines and chains of a rotor: its bending in one plane, its torsion, its axial motion."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from .axis_spring import AxisSpring
from .bearing import RadialSupport
from .chain import Chain
from .lines import Line, piece_table
from .lumped import station_inertias
from .profile import AXIAL, BENDING, TORSION
from .shaft import Rotor, merged_positions, station_index

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
RodMotion = Literal["torsion", "axial"]


def bending_line(rotor: Rotor, supports: Sequence[RadialSupport] = ()) -> Line:
    """A rotor's bending in one plane."""
    for support in supports:
        rotor.require_on_shaft(f"rotor {rotor.name!r} support", support.at)
    profile = rotor.profile
    length, bending = rotor.length, profile.extremes[:, 1]
    force = float(np.exp(np.log(bending[profile.kind]).mean())) / length**2
    distributed = float(rotor.mass_model == "distributed")
    line, inertias = _spans(rotor, [support.at for support in supports])
    stiffness = np.zeros((line[0].size, 2))
    for support in supports:
        stiffness[station_index(line[0], support.at)] += support.stiffness, support.tilt_stiffness
    per_node = np.array([length / force, 1.0 / (force * length)])
    units = [force, force * length**2, distributed * length**2 / force, distributed / force, 1.0, 1.0 / force]
    return Line(
        f"rotor {rotor.name!r}",
        *line,
        coefficients=profile.coefficients[:, BENDING] * np.array(units)[:, None],
        uniform=profile.uniform,
        stiffness=profile.extremes[:, :2],
        inertia=distributed * profile.extremes[:, 2:4],
        force=profile.extremes[:, 4],
        node_inertia=inertias[:, :2] * per_node,
        node_stiffness=stiffness * per_node,
        node_polar=inertias[:, 2] * per_node[1],
        length_unit=length,
        displacement_unit=np.array([length, 1.0]) / np.sqrt(force * length),
    )


def bending_chain(rotor: Rotor, supports: Sequence[RadialSupport], highest: float) -> Chain:
    """Chain of a rotor's bending in one plane, good up to ``highest`` rad/s."""
    return bending_line(rotor, supports).cut(highest)


def rod_line(rotor: Rotor, springs: Sequence[AxisSpring], motion: RodMotion) -> Line:
    """A rotor's torsion, or its axial motion."""
    for spring in springs:
        rotor.require_on_shaft(f"rotor {rotor.name!r} spring", spring.at)
    profile = rotor.profile
    rows, inertia_column = (TORSION, 2) if motion == "torsion" else (AXIAL, 0)
    length, given = rotor.length, profile.coefficients[:, rows]
    # Compliance at the middle stands for that of a tapering span.
    force = float(np.exp(-np.log(given[profile.kind, 0, 0]).mean())) / length
    distributed = float(rotor.mass_model == "distributed")
    line, inertias = _spans(rotor, [spring.at for spring in springs])
    stiffness = np.zeros((line[0].size, 1))
    for spring in springs:
        stiffness[station_index(line[0], spring.at)] += spring.stiffness
    sides = np.array([-1.0, 0.0, 1.0])[:, None] ** np.arange(given.shape[2])
    values = np.einsum("kfj,sj->ksf", given, sides)
    return Line(
        f"rotor {rotor.name!r}",
        *line,
        coefficients=given * np.array([force * length, distributed * length / force])[:, None],
        uniform=profile.uniform,
        stiffness=1.0 / values[:, :, :1].max(axis=1),
        inertia=distributed * values[:, :, 1:].max(axis=1),
        force=np.zeros(given.shape[0]),
        node_inertia=inertias[:, inertia_column, None] / force,
        node_stiffness=stiffness / force,
        node_polar=np.zeros(line[0].size),
        length_unit=length,
        displacement_unit=np.array([1.0 / np.sqrt(force)]),
    )


def axial_chain_on(rotor: Rotor, bending: Chain) -> Chain:
    """Chain of a rotor's axial motion with the nodes, and the units of length and force, of a chain of its bending.

    It has no springs, and carries at its nodes the mass that the bending chain does.
    """
    profile, unit = rotor.profile, float(bending.displacement_unit[0])
    # Displacement unit² is length unit / force unit; scaled compliance is compliance times force unit.
    force = bending.length_unit / unit**2
    distributed = float(rotor.mass_model == "distributed")
    scale = np.array([force, distributed * bending.length_unit**2 / force])
    span, start, end = _covered(profile.edges, bending.nodes)
    table, element = piece_table(
        profile.coefficients[:, AXIAL] * scale[:, None],
        profile.uniform,
        profile.kind[span],
        start,
        end,
        bending.lengths,
    )
    return Chain(
        nodes=bending.nodes,
        table=table,
        element=element,
        node_inertia=bending.node_inertia[:, :1],
        node_stiffness=np.zeros((bending.nodes.size, 1)),
        node_polar=np.zeros(bending.nodes.size),
        length_unit=bending.length_unit,
        displacement_unit=bending.displacement_unit[:1],
        highest=bending.highest,
        is_station=bending.is_station,
    )


Spans = tuple[FloatArray, npt.NDArray[np.bool_], IntArray, FloatArray, FloatArray, FloatArray]


def _spans(rotor: Rotor, places: Sequence[float]) -> tuple[Spans, FloatArray]:
    """The first six fields of a line after its label, and the inertias at its nodes (s + 1, 3)."""
    profile = rotor.profile
    others = [*(disc.at for disc in rotor.discs), *places]
    nodes = merged_positions(profile.edges, others)
    is_station = np.ones(nodes.size, dtype=np.bool_)
    if profile.edges.size > rotor.joints.size:
        stations = merged_positions(rotor.joints, others)
        is_station = np.abs(nodes[:, None] - stations).min(axis=1) == 0.0
    span, start, end = _covered(profile.edges, nodes)
    whole = (start == 0.0) & (end == 1.0)
    lengths = np.where(whole, profile.lengths[span], np.diff(nodes))
    return (nodes, is_station, profile.kind[span], start, end, lengths), station_inertias(rotor, nodes)


def _covered(edges: FloatArray, nodes: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Span that holds each interval between nodes, and the fractions of it between which it lies, each (s,)."""
    span = np.clip(np.searchsorted(edges, 0.5 * (nodes[1:] + nodes[:-1])) - 1, 0, edges.size - 2)
    left, width = edges[span], edges[span + 1] - edges[span]
    return span, (nodes[:-1] - left) / width, (nodes[1:] - left) / width
