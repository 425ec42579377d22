"""Continuous and discretised shafts of a rotor: bending in one plane, torsion, axial motion."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.model.bearing import AxisSpring, RadialSupport
from gearwhine.rotors.model.profile import AXIAL, BENDING, TORSION
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.transfer_matrix.discretised_shaft import ContinuousShaft, DiscretisedShaft

RodMotion = Literal["torsion", "axial"]


def free_bending_shaft(rotor: Rotor) -> ContinuousShaft:
    """Assemble the continuous shaft of a rotor's bending in one plane without supports."""
    profile, length = rotor.profile, rotor.length
    stiffness = profile.bounds[:, :2]
    force = profile.mean_bending_stiffness / length**2
    distributed = float(rotor.mass_model == "distributed")
    units = [force, force * length**2, distributed * length**2 / force, distributed / force, 1.0, 1.0 / force]
    per_node = np.array([length / force, 1.0 / (force * length)])
    inertias = rotor.spans.inertias
    return _continuous_shaft(
        rotor,
        coefficients=profile.coefficients[:, BENDING] * np.array(units)[:, None],
        stiffness=stiffness,
        inertia=distributed * profile.bounds[:, 2:4],
        force=profile.bounds[:, 4],
        node_inertia=inertias[:, :2] * per_node,
        node_polar=inertias[:, 2] * per_node[1],
        displacement_unit=np.array([length, 1.0]) / np.sqrt(force * length),
    )


def free_rod_shaft(rotor: Rotor, motion: RodMotion) -> ContinuousShaft:
    """Assemble the continuous shaft of a rotor's torsion, or its axial motion, without supports."""
    rows, inertia_column = (TORSION, 2) if motion == "torsion" else (AXIAL, 0)
    profile = rotor.profile
    coefficients = profile.coefficients[:, rows]
    # Compliance at the middle stands for that of a tapering span.
    force = float(np.exp(-np.log(coefficients[profile.section_of_span, 0, 0]).mean())) / rotor.length
    distributed = float(rotor.mass_model == "distributed")
    sides = np.array([-1.0, 0.0, 1.0])[:, None] ** np.arange(coefficients.shape[2])
    values = np.einsum("kfj,sj->ksf", coefficients, sides)
    units = [force * rotor.length, distributed * rotor.length / force]
    return _continuous_shaft(
        rotor,
        coefficients=coefficients * np.array(units)[:, None],
        stiffness=1.0 / values[:, :, :1].max(axis=1),
        inertia=distributed * values[:, :, 1:].max(axis=1),
        force=np.zeros(coefficients.shape[0]),
        node_inertia=rotor.spans.inertias[:, inertia_column, None] / force,
        node_polar=np.zeros(rotor.spans.nodes.size),
        displacement_unit=np.array([1.0 / np.sqrt(force)]),
    )


def _continuous_shaft(
    rotor: Rotor,
    *,
    coefficients: FloatArray,
    stiffness: FloatArray,
    inertia: FloatArray,
    force: FloatArray,
    node_inertia: FloatArray,
    node_polar: FloatArray,
    displacement_unit: FloatArray,
) -> ContinuousShaft:
    spans = rotor.spans
    return ContinuousShaft(
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


def bending_shaft(rotor: Rotor, supports: Sequence[RadialSupport] = ()) -> ContinuousShaft:
    """Assemble the continuous shaft of a rotor's bending in one plane on springs."""
    return bending_shafts(rotor, [supports])[0]


def bending_shafts(rotor: Rotor, planes: Sequence[Sequence[RadialSupport]]) -> list[ContinuousShaft]:
    """Assemble the continuous shafts of a rotor's bending in several planes, whose springs stand at the same places."""
    places = [support.at for support in planes[0]]
    for place in places:
        rotor.require_on_shaft(f"rotor {rotor.name!r} support", place)
    free = free_bending_shaft(rotor)
    # A displacement unit squared is the reciprocal of a unit of stiffness.
    shift, tilt = (free.displacement_unit**2).tolist()
    springs = [
        [(support.stiffness * shift, support.tilt_stiffness * tilt) for support in supports] for supports in planes
    ]
    return free.held(places, *springs)


def discretised_bending_shaft(rotor: Rotor, supports: Sequence[RadialSupport], highest: float) -> DiscretisedShaft:
    """Discretise a rotor's bending in one plane on springs for frequencies up to ``highest`` rad/s."""
    return bending_shaft(rotor, supports).cut(highest)


def rod_shaft(rotor: Rotor, springs: Sequence[AxisSpring], motion: RodMotion) -> ContinuousShaft:
    """Assemble the continuous shaft of a rotor's torsion, or its axial motion, on springs."""
    for spring in springs:
        rotor.require_on_shaft(f"rotor {rotor.name!r} spring", spring.at)
    free = free_rod_shaft(rotor, motion)
    unit = float(free.displacement_unit[0]) ** 2
    return free.held([spring.at for spring in springs], [(spring.stiffness * unit,) for spring in springs])[0]


def axial_shaft_on(rotor: Rotor, bending: DiscretisedShaft) -> DiscretisedShaft:
    """Discretise a rotor's axial motion with the nodes and the units of length and force of its bending.

    It has no springs, and the same nodal masses as the bending shaft.
    """
    free = free_rod_shaft(rotor, "axial").with_nodes(bending.nodes)
    # A displacement unit squared is the reciprocal of a unit of stiffness, by which compliance and inertia are scaled.
    ratio = float(free.displacement_unit[0] / bending.displacement_unit[0]) ** 2
    continuous_shaft = replace(
        free,
        coefficients=free.coefficients * np.array([ratio, 1.0 / ratio])[:, None],
        node_inertia=free.node_inertia / ratio,
        displacement_unit=bending.displacement_unit[:1],
    )
    return continuous_shaft.in_elements(np.ones(bending.element.size, dtype=np.intp), bending.highest)
