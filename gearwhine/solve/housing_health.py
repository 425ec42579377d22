"""Checks of a solved housing, cached with its modes: health report, effective masses, mass of the solid."""

from typing import Any

from gearwhine.case import Case
from housing import HealthReport, Housing
from housing.model.material import mass_properties
from housing.modes.effective_mass import EffectiveMass

DIRECTIONS = ("x", "y", "z", "rotation_x", "rotation_y", "rotation_z")


def bearing_places(case: Case) -> dict[str, tuple[str, float]]:
    """Bearing positions on the housing: by bearing, its seat and its distance along z from the seat's centre [m].

    Where no bearing has a seat, each seat stands for one at its centre. The housing's attachments are for these.
    """
    assert case.housing is not None
    centers = {seat.name: seat.center[2] for seat in case.housing.seat}
    places = {
        bearing.name: (bearing.seat, case.rotor_named(bearing.rotor).start + bearing.at - centers[bearing.seat])
        for bearing in case.bearing
        if bearing.seat in centers
    }
    return places or {name: (name, 0.0) for name in centers}


def housing_checks(given: Housing, health: HealthReport, masses: EffectiveMass) -> dict[str, Any]:
    """Health report, effective masses and the solid's mass, for the documents and for whatever keeps the modes."""
    solid = mass_properties(given.mesh, given.material, given.materials)
    return {
        "health": _health_document(health),
        "effective_mass": _mass_document(masses),
        "solid": {"mass_kg": solid.mass, "center_of_mass_m": solid.center.tolist()},
    }


def _health_document(health: HealthReport) -> dict[str, Any]:
    body, held = health.body, health.grounding
    return {
        "ok": health.ok,
        "lines": [
            {
                "name": line.name,
                "value": line.value,
                "bound": line.bound,
                "ok": line.ok,
                "essential": line.essential,
                "why": line.why,
            }
            for line in health.lines
        ],
        "mass_kg": body.mass,
        "center_of_gravity_m": body.center.tolist(),
        "inertia_kg_m2": body.inertia.tolist(),
        "free_motions": held.free_motions,
        "supports": [
            {
                "name": support.name,
                "fixes": support.fixes,
                "stiffness_n_per_m": support.stiffness[:3].tolist(),
                "stiffness_n_m_per_rad": support.stiffness[3:].tolist(),
                "share": dict(zip(DIRECTIONS, support.share.tolist(), strict=True)),
            }
            for support in held.supports
        ],
    }


def _mass_document(masses: EffectiveMass) -> dict[str, Any]:
    return {
        "directions": list(DIRECTIONS),
        "fractions": masses.fractions.tolist(),
        "captured": masses.captured.tolist(),
        "missing": masses.missing.tolist(),
        "held_by_supports": (1.0 - masses.free / masses.total).tolist(),
    }
