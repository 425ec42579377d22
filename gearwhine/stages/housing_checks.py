"""What a solved housing says of itself: its health report, effective masses and static error, as the command's JSON."""

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import sparse

import housing as room
from gearwhine.case import Case
from gearwhine.stages.attachments import build_attachments
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]

DIRECTIONS = ("x", "y", "z", "rotation_x", "rotation_y", "rotation_z")
# Responses of the discarded modes at each motion that a bearing loads: at rest, at the limit, and its derivative there.
ATTACHMENT_ORDERS = 3
SELECTION_TOLERANCE = 0.05  # of the largest receptance between bearings and sensors, for the modes worth keeping

_HERTZ = 2.0 * np.pi


def bearing_places(case: Case) -> dict[str, tuple[str, float]]:
    """Where the machine bears on the housing: by bearing, its seat and how far beyond the seat's centre it sits [m].

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


def bearing_port(seat: sparse.csr_array, arm: float) -> sparse.csr_array:
    """A seat's motions x, y, z and rotations about x and y at a distance from its centre [m], shape (5, 3 n_nodes).

    Any bearing can load these; none loads the rotation about z, in which the shaft turns.
    """
    # A rotation about y moves a point above the centre towards +x, one about x towards -y.
    turned = sparse.diags_array([arm, -arm], dtype=np.float64) @ seat[[4, 3]]
    return sparse.csr_array(sparse.vstack([seat[[0, 1]] + turned, seat[[2, 3, 4]]]))


def housing_checks(
    case: Case,
    mesh: Mesh,
    bare: room.Matrices,
    whole: room.Matrices,
    modes: room.ModeSet,
    solid: room.MassProperties,
) -> dict[str, Any]:
    """Health report, effective masses and the solid's mass, for the documents and for whatever keeps the modes.

    Parameters
    ----------
    case : Case
    mesh : Mesh
    bare, whole : housing.Matrices
        Of the solid alone, and with all that is fastened to it.
    modes : housing.ModeSet
        Of the latter.
    solid : housing.MassProperties
        Of the solid, from its elements.

    Raises
    ------
    housing.HealthError
        Where the model fails a check without which its numbers are wrong.
    """
    assert case.housing is not None
    mass, center = solid.mass, solid.center
    if not case.housing.region:
        # Of one material, what its boundary encloses says the same without any of the elements inside.
        volume, center = room.enclosed(mesh)
        mass = case.material[case.housing.material].density * volume
    fastened = sum(entry.mass for entry in case.housing.mass)
    grounds = [one for _, _, one in build_attachments(case) if isinstance(one, room.Support | room.Mount)]
    health = room.health_report(
        mesh,
        bare,
        whole,
        grounds,
        modes,
        mass=mass + fastened,
        # The centre of what is fastened is not the geometry's to know.
        center=None if fastened else center,
    )
    health.require()
    masses = room.effective_mass(whole, mesh.points, modes)
    return {
        "health": _health_document(health),
        "effective_mass": _mass_document(masses),
        "solid": {"mass_kg": solid.mass, "center_of_mass_m": solid.center.tolist()},
    }


def static_error_document(modes: room.ModeSet, loaded: dict[str, sparse.csr_array]) -> dict[str, Any] | None:
    """How far the static compliance where the machine bears on the housing is from exact; None without such places."""
    attached = modes.attachments
    if attached is None:
        return None
    missing = attached.proof.missing_parts.reshape(len(loaded), -1)
    return {
        "without_attachments": float(missing.max()),
        "with_attachments": attached.proof.error,
        "attachments": len(attached.frequencies),
        "without_attachments_at": dict(zip(loaded, missing.max(axis=1).tolist(), strict=True)),
        "directions": list(DIRECTIONS[:5]),
        "without_attachments_along": dict(zip(loaded, missing.tolist(), strict=True)),
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
    # Forces across the shafts alone: receptances by moments have another unit, and no common scale with these.
    forces = sparse.csr_array(sparse.vstack([motions[:2] for motions in loaded.values()], format="csr"))
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
