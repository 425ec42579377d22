"""What a solved housing says of itself: its health report, effective masses and static error, as the command's JSON."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import sparse

import housing as room
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

DIRECTIONS = ("x", "y", "z", "rotation_x", "rotation_y", "rotation_z")
SELECTION_TOLERANCE = 0.05  # of the largest receptance between bearings and sensors, for the modes worth keeping

_HERTZ = 2.0 * np.pi


def housing_checks(
    mesh: Mesh,
    unsupported: room.Matrices,
    supported: room.Matrices,
    supports: Sequence[room.Support],
    modes: room.ModeSet,
    density: float,
) -> dict[str, Any]:
    """Health report and effective masses, for the documents and for whatever keeps the modes.

    Raises
    ------
    housing.HealthError
        Where the model fails a check without which its numbers are wrong.
    """
    volume, center = room.enclosed(mesh)
    health = room.health_report(mesh, unsupported, supported, supports, modes, mass=density * volume, center=center)
    health.require()
    masses = room.effective_mass(supported, mesh.points, room.fixed_freedoms(mesh, supports), modes)
    return {"health": _health_document(health), "effective_mass": _mass_document(masses)}


def static_error_document(modes: room.ModeSet, loaded: dict[str, sparse.csr_array]) -> dict[str, Any] | None:
    """How far the static compliance where the machine bears on the housing is from exact; None without such places."""
    attached = modes.attachments
    if attached is None:
        return None
    missing = attached.proof.missing_parts.reshape(-1, 2).max(axis=1)
    return {
        "without_attachments": float(missing.max()),
        "with_attachments": attached.proof.error,
        "attachments": len(attached.frequencies),
        "without_attachments_at": dict(zip(loaded, missing.tolist(), strict=True)),
    }


def selection_document(
    modes: room.ModeSet,
    damping_ratios: FloatArray,
    loaded: dict[str, sparse.csr_array],
    sensors: dict[str, room.SensorPort],
) -> dict[str, Any] | None:
    """Which modes carry the motion from the bearings to the sensors; None where there are not both."""
    if not loaded or not sensors or not (damping_ratios > 0.0).all():
        return None
    forces = sparse.csr_array(sparse.vstack(list(loaded.values()), format="csr"))
    motions = sparse.csr_array(sparse.vstack([sensor.matrix for sensor in sensors.values()], format="csr"))
    # From just above rest, where a free housing has no receptance.
    limit = modes.certificate.limit
    chosen = room.select_modes(modes, damping_ratios, forces, motions, (0.01 * limit, limit), SELECTION_TOLERANCE)
    return {
        "from": list(loaded),
        "to": list(sensors),
        "band_hz": [edge / _HERTZ for edge in chosen.band],
        "tolerance": chosen.tolerance,
        "keep": (chosen.kept + 1).tolist(),
        "ranking": (chosen.ranking + 1).tolist(),
        "strength_m_per_n": chosen.strength.tolist(),
        "error_left": chosen.error_left.tolist(),
    }


def _health_document(health: room.HealthReport) -> dict[str, Any]:
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


def _mass_document(masses: room.EffectiveMass) -> dict[str, Any]:
    return {
        "directions": list(DIRECTIONS),
        "fractions": masses.fractions.tolist(),
        "captured": masses.captured.tolist(),
        "missing": masses.missing.tolist(),
        "held_by_supports": (1.0 - masses.free / masses.total).tolist(),
    }
