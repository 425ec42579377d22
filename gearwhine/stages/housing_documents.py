"""A solved housing as the commands' JSON: its modes, where they come from."""

from typing import Any

import numpy as np

from gearwhine.stages.housing import SolvedHousing
from gearwhine.stages.housing_checks import selection_document, static_error_document

_HERTZ = 2.0 * np.pi


def modes_document(solved: SolvedHousing, *, detail: bool = False) -> dict[str, Any]:
    """The modes as the command's JSON; in detail also which of them carry the motion from bearings to sensors."""
    certificate = solved.modes.certificate
    strengths = solved.strengths
    masses = solved.checks["effective_mass"]
    document = {
        "modes": [
            {
                "number": number,
                "frequency_hz": float(frequency),
                "damping_ratio": float(damping),
                "strength": None if strengths is None else float(strengths.acceleration[number - 1]),
                "effective_mass": masses["fractions"][number - 1],
            }
            for number, (frequency, damping) in enumerate(
                zip(solved.modes.frequencies_hz, solved.total_damping_ratios, strict=True), start=1
            )
        ],
        "certificate": {
            "limit_hz": certificate.limit / _HERTZ,
            "expected": certificate.expected,
            "found": certificate.found,
            "complete": certificate.complete,
            "max_residual": certificate.max_residual,
            "max_overlap": certificate.max_overlap,
        },
        "mesh": {
            "nodes": len(solved.mesh.points),
            "elements": solved.mesh.n_elements,
            "dofs": 3 * len(solved.mesh.points),
        },
        "mass_kg": solved.mass,
        "center_of_mass_m": solved.checks["health"]["center_of_gravity_m"],
        "attached_mass_kg": solved.attached_mass,
        "effective_mass": {key: value for key, value in masses.items() if key != "fractions"},
        "static_error": static_error_document(solved.modes, solved.loaded),
        "health": solved.checks["health"],
        "solid": solved.checks["solid"],
        "seconds": solved.seconds,
        **origin_document(solved),
    }
    if detail:
        ratios = solved.total_damping_ratios
        document["selection"] = selection_document(solved.modes, ratios, solved.loaded, solved.sensors)
    return document


def origin_document(solved: SolvedHousing | None) -> dict[str, Any]:
    """Where a housing's modes come from, as every command's JSON says it; nothing without a housing."""
    if solved is None:
        return {}
    if solved.source is None:
        return {"reused": False, "warnings": solved.warnings}
    return {
        "reused": True,
        "modes_read_from": str(solved.source),
        "seconds_when_solved": solved.record.notes["seconds"],
        "warnings": solved.warnings,
    }
