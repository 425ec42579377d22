"""Checks of a solved housing as the JSON of its modes has them: health report and effective masses."""

from typing import Any

from gearwhine.housing import HealthReport
from gearwhine.housing.modes.effective_mass import EffectiveMass

_DIRECTIONS = ("x", "y", "z", "rotation_x", "rotation_y", "rotation_z")


def health_document(health: HealthReport) -> dict[str, Any]:
    """Return a health report as JSON."""
    body, grounding = health.body, health.grounding
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
        "free_motions": grounding.free_motions,
        "supports": [
            {
                "name": support.name,
                "fixes": support.fixes,
                "stiffness_n_per_m": support.stiffness[:3].tolist(),
                "stiffness_n_m_per_rad": support.stiffness[3:].tolist(),
                "share": dict(zip(_DIRECTIONS, support.share.tolist(), strict=True)),
            }
            for support in grounding.supports
        ],
    }


def effective_mass_document(masses: EffectiveMass) -> dict[str, Any]:
    """Return the effective masses of all modes together as JSON."""
    return {
        "directions": list(_DIRECTIONS),
        "captured": masses.captured.tolist(),
        "missing": masses.missing.tolist(),
        "held_by_supports": (1.0 - masses.free / masses.total).tolist(),
    }
