"""Gears and gear pairs as the commands' JSON: shape, contact, mesh stiffness and transmission error."""

from collections.abc import Callable
from typing import Any

import numpy as np

import coupling.gears as room
from gearwhine.case import Case, mesh_frequencies, pair_torques
from gearwhine.stages.gears import SolvedPair, pair_geometries

_UNSOLVED = "mesh stiffness and transmission error of helical gears come with a later version"


def gears_document(case: Case, solved: tuple[SolvedPair, ...]) -> dict[str, Any]:
    """Every gear pair of the case as the command's JSON, those that were solved with their stiffness."""
    by_names = {(pair.given.driver, pair.given.driven): pair for pair in solved}
    rows, warnings = [], []
    for row, geometry in zip(pairs_document(case), pair_geometries(case), strict=True):
        row["geometry"] = geometry_document(geometry)
        warnings += doubts(geometry)
        pair = by_names.get((row["driver"], row["driven"]))
        rows.append(row | (_unsolved() if pair is None else _solved(pair)))
    return {"pairs": rows} | ({"warnings": warnings} if warnings else {})


def pairs_document(case: Case) -> list[dict[str, Any]]:
    """What every gear pair of the case is by arithmetic alone."""
    number = len(case.gear_pair)
    frequencies = mesh_frequencies(case) if case.operation is not None else (None,) * number
    torques = pair_torques(case) if case.operation is not None else (None,) * number
    rows = []
    for pair, geometry, frequency, torque in zip(
        case.gear_pair, pair_geometries(case), frequencies, torques, strict=True
    ):
        rows.append(
            {
                "driver": pair.driver,
                "driven": pair.driven,
                "model": pair.stiffness.model,
                "ratio": geometry.ratio,
                "contact_ratio": geometry.contact_ratio,
                "overlap_ratio": geometry.overlap_ratio,
                "total_contact_ratio": geometry.total_contact_ratio,
                "centre_distance_m": geometry.working_centre_distance,
                "working_pressure_angle_deg": _degrees(geometry.working_pressure_angle),
                "backlash_m": {
                    "circumferential": geometry.circumferential_backlash,
                    "normal": geometry.normal_backlash,
                },
                "mesh_frequency_hz": frequency,
                "mean_force_n": None if torque is None else abs(torque) / geometry.driver.base_radius,
            }
        )
    return rows


def geometry_document(geometry: room.GearPairGeometry) -> dict[str, Any]:
    """The shape of both gears, and the named points of their path of contact."""
    path = room.path_of_contact(geometry)
    points = [
        {
            "point": name,
            "position": float(path.position[place]),
            "driver_roll_angle_deg": _degrees(path.driver_roll_angle[place]),
            "driven_roll_angle_deg": _degrees(path.driven_roll_angle[place]),
            "driver_radius_m": float(path.driver_radius[place]),
            "driven_radius_m": float(path.driven_radius[place]),
            "driver_specific_sliding": float(path.driver_sliding[place]),
            "driven_specific_sliding": float(path.driven_sliding[place]),
        }
        for place, name in enumerate(room.POINTS_OF_CONTACT)
    ]
    gears = [
        gear_document(gear) | {"tip_clearance_m": geometry.tip_clearance(gear)}
        for gear in (geometry.driver, geometry.driven)
    ]
    return {"gears": gears, "path_of_contact": points}


def gear_document(gear: room.Gear) -> dict[str, Any]:
    """One gear's teeth: their sizes, and what a shop measures on them."""
    return {
        "name": gear.name,
        "teeth": gear.teeth,
        "virtual_teeth": gear.virtual_teeth,
        "module_m": gear.module,
        "pressure_angle_deg": _degrees(gear.pressure_angle),
        "helix_angle_deg": _degrees(gear.helix_angle),
        "profile_shift": gear.profile_shift,
        "lead_m": None if gear.helix_angle == 0.0 else gear.lead,
        "reference_diameter_m": 2.0 * gear.pitch_radius,
        "base_diameter_m": 2.0 * gear.base_radius,
        "tip_diameter_m": 2.0 * gear.tip_radius,
        "root_diameter_m": 2.0 * gear.root_circle_radius,
        "form_diameter_m": 2.0 * gear.form_radius,
        "rack_tip_radius_m": gear.rack_tip_radius,
        "undercut": gear.is_undercut,
        "tip_thickness_m": room.normal_tooth_thickness(gear, gear.tip_radius),
        "span": _measured(lambda: room.span_measurement(gear), "teeth", "length"),
        "over_balls": _measured(lambda: room.over_balls(gear), "diameter", "length"),
    }


def doubts(geometry: room.GearPairGeometry) -> list[dict[str, str]]:
    """Warnings of what runs but is not as it should be."""
    found = []
    for gear in (geometry.driver, geometry.driven):
        try:
            room.require_tip_thickness(gear)
        except room.ThinTipError as error:
            found.append({"name": "thin tip", "message": str(error)})
        if gear.is_undercut:
            message = (
                f"gear {gear.name!r}: the teeth are undercut, their flanks begin at a diameter of "
                f"{2e3 * gear.form_radius:.6g} mm; a profile_shift of "
                f"{gear.least_generating_shift + gear.profile_shift - gear.generating_shift:.4g} avoids it"
            )
            found.append({"name": "undercut", "message": message})
    return found


def _measured(measure: Callable[[], object], count: str, length: str) -> dict[str, Any] | None:
    """A measurement, or nothing where the teeth cannot be measured so."""
    try:
        found = measure()
    except room.GearError:
        return None
    size = getattr(found, count)
    return {count if isinstance(size, int) else f"{count}_m": size, f"{length}_m": getattr(found, length)}


def _unsolved() -> dict[str, Any]:
    return {"stiffness_n_per_m": None, "transmission_error_m": None, "note": _UNSOLVED}


def _solved(pair: SolvedPair) -> dict[str, Any]:
    """Mesh stiffness and static transmission error over a mesh period."""
    phases = pair.static.phases
    stiffness = room.mesh_stiffness(pair.contact, phases)
    hunting = pair.hunting
    return {
        "mean_force_n": pair.static.force,
        "stiffness_n_per_m": {
            "mean": pair.contact.mean_stiffness,
            "min": float(stiffness.min()),
            "max": float(stiffness.max()),
        },
        "transmission_error_m": _error(pair.static) | {"over_hunting_period": hunting and _error(hunting)},
        "roll_angle_rad": (2.0 * np.pi * phases / pair.geometry.driver.teeth).tolist(),
        "stiffness": stiffness.tolist(),
        "loaded_stiffness": pair.static.tangent_stiffness.tolist(),
        "transmission_error": pair.static.transmission_error.tolist(),
    }


def _error(static: room.StaticMesh) -> dict[str, Any]:
    return {"mean": static.mean_transmission_error, "peak_to_peak": static.peak_to_peak_transmission_error}


def _degrees(angle: float) -> float:
    return float(np.degrees(angle))
