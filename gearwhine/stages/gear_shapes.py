"""The shape of gears and how they meet: by arithmetic alone, and what is doubtful about it."""

from typing import Any

import numpy as np

import coupling.gears as room
from gearwhine.case import Case, mesh_frequencies, pair_torques
from gearwhine.stages.gears import pair_geometries


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
                "working_pressure_angle_deg": float(np.degrees(geometry.working_pressure_angle)),
                "backlash_m": {
                    "circumferential": geometry.circumferential_backlash,
                    "normal": geometry.normal_backlash,
                },
                "mesh_frequency_hz": frequency,
                "mean_force_n": None if torque is None else abs(torque) / geometry.driver.base_radius,
            }
        )
    return rows


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
