"""Shaft elements between the same two nodes, such as a sleeve on its shaft, as one segment that bends with both.

Their sections stay plane and share one displacement and one rotation at every node, so that with a finer and finer mesh
stiffnesses and masses per length add up:

    EI = Σ E_i I_i,   κGA = Σ κ_i G_i A_i,   GJ = Σ G_i J_i,   ρA = Σ ρ_i A_i,   ρI = Σ ρ_i I_i.

One ring has all of these: its diameters follow from I/A = Σ ρ_i I_i / Σ ρ_i A_i and, where a ring has that, A = Σ A_i,
its moduli and density from the sums. Its EA is then EI / (I/A), which is Σ E_i A_i where all are of one material.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from gearwhine.rotors.errors import RotorError
from gearwhine.rotors.model.material import Section, ShaftMaterial
from gearwhine.rotors.model.segment import Segment

_SAME = 1e-9  # relative difference of diameters that count as one
_SAME_LENGTH = 1e-6


def side_by_side(parts: Sequence[Segment]) -> tuple[Segment, float]:
    """Return the segment that segments of one length make together, and the relative error of its axial stiffness.

    Raises
    ------
    RotorError
        Where lengths differ, or cones are not of one material and nested without a gap.
    """
    length = parts[0].length
    if any(abs(part.length - length) > _SAME_LENGTH * length for part in parts):
        lengths = ", ".join(f"{part.length:g}" for part in parts)
        raise RotorError(f"elements between the same two nodes have lengths {lengths} m; expected one length")
    force = sum(part.axial_force for part in parts)
    sections = [part.section(0.5) for part in parts]
    nested = _nested(parts)
    if nested is not None:
        (outer, inner), (right_outer, right_inner) = nested
        area = sum(section.area for section in sections)
        factor = sum(section.shear_factor * section.area for section in sections) / area
        segment = Segment(length, outer, inner, parts[0].material, factor, axial_force=force)
        if (outer, inner) != (right_outer, right_inner):
            segment = replace(segment, right_outer_diameter=right_outer, right_inner_diameter=right_inner)
        return segment, 0.0
    if any(part.is_conical for part in parts):
        raise RotorError(
            "cones between the same two nodes; expected them to be of one material, each around the other without a gap"
        )
    return _ring(sections, length, force)


def _nested(parts: Sequence[Segment]) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """Outer and inner diameters at both ends of parts of one material around each other; None where they are not."""
    first = parts[0].material
    for part in parts[1:]:
        other = part.material
        values = zip(
            (first.youngs_modulus, first.shear_modulus, first.density),
            (other.youngs_modulus, other.shear_modulus, other.density),
            strict=True,
        )
        if any(abs(one - two) > _SAME * abs(one) for one, two in values):
            return None
    ordered = sorted(parts, key=lambda part: part.outer_diameter)
    for within, around in pairwise(ordered):
        for (outer, _), (_, inner) in zip(within.end_diameters, around.end_diameters, strict=True):
            if abs(outer - inner) > _SAME * outer:
                return None
    left, right = (
        (around[0], within[1])
        for within, around in zip(ordered[0].end_diameters, ordered[-1].end_diameters, strict=True)
    )
    return left, right


def _ring(sections: Sequence[Section], length: float, force: float) -> tuple[Segment, float]:
    bending = sum(section.bending_stiffness for section in sections)
    torsion = sum(section.torsional_stiffness for section in sections)
    shear = sum(section.shear_stiffness for section in sections)
    axial = sum(section.axial_stiffness for section in sections)
    mass = sum(section.mass_per_length for section in sections)
    inertia = 0.5 * sum(section.polar_inertia_per_length for section in sections)
    area = sum(section.area for section in sections)
    ratio = inertia / mass if mass > 0.0 else bending / axial
    # I / A = (D² + d²) / 16 and A = π (D² - d²) / 4; of a light sleeve on a heavy shaft a solid of less area has it.
    inner = math.sqrt(max(8.0 * ratio - 2.0 * area / math.pi, 0.0))
    outer = math.sqrt(16.0 * ratio - inner**2)
    area = math.pi / 4.0 * (outer**2 - inner**2)
    second_moment = ratio * area
    modulus, shear_modulus = bending / second_moment, 0.5 * torsion / second_moment
    material = ShaftMaterial(modulus, shear_modulus, mass / area)
    ring = Segment(length, outer, inner, material, shear / (shear_modulus * area), axial_force=force)
    return ring, modulus * area / axial - 1.0
