"""The shape of gears and how they meet, as the commands' JSON, and what is doubtful about it."""

from contextlib import suppress
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


def geometry_document(geometry: room.GearPairGeometry) -> dict[str, Any]:
    """The shape of both gears, and the named points of their path of contact."""
    gears = [gear_document(geometry, gear) for gear in (geometry.driver, geometry.driven)]
    return {"gears": gears, "path_of_contact": path_document(geometry)}


def gear_document(pair: room.GearPairGeometry, gear: room.Gear, *, wide: bool = True) -> dict[str, Any]:
    """A gear's proportions, and what a shop measures to know them; `wide` where the case gives its face width."""
    document = {
        "name": gear.name,
        "teeth": gear.teeth,
        "virtual_teeth": gear.virtual_teeth,
        "module_m": gear.module,
        "pressure_angle_rad": gear.pressure_angle,
        "helix_angle_rad": gear.helix_angle,
        "lead_m": None if gear.helix_angle == 0.0 else gear.lead,
        "profile_shift": gear.profile_shift,
        "rack_tip_radius_m": gear.rack_tip_radius,
        "undercut": gear.is_undercut,
        "face_width_m": gear.face_width if wide else None,
        "diameters_m": {
            "tip": 2.0 * gear.tip_radius,
            "reference": 2.0 * gear.pitch_radius,
            "base": 2.0 * gear.base_radius,
            "form": 2.0 * gear.form_radius,
            "root": 2.0 * gear.root_circle_radius,
        },
        "normal_thickness_m": {
            "reference": room.normal_tooth_thickness(gear, gear.pitch_radius),
            "tip": room.normal_tooth_thickness(gear, gear.tip_radius),
        },
        "tip_clearance_m": pair.tip_clearance(gear),
        "span": None,
        "over_balls": None,
        "tip_relief": None if gear.tip_relief is None else relief_document(gear, gear.tip_relief),
    }
    # Not every gear can be measured in every way: a face too narrow, teeth too short.
    with suppress(room.GearError):
        span = room.span_measurement(gear)
        document["span"] = {"teeth": span.teeth, "length_m": span.length}
    with suppress(room.GearError):
        balls = room.over_balls(gear)
        document["over_balls"] = {"ball_diameter_m": balls.diameter, "length_m": balls.length}
    return document


def relief_document(gear: room.Gear, relief: room.TipRelief) -> dict[str, Any]:
    """A tip relief, however its start is given."""
    start = relief.start(gear.roll_angle(gear.tip_radius), gear.base_radius)
    return {"amount_m": relief.amount, "start_roll_angle_rad": start, "shape": relief.shape}


def path_document(geometry: room.GearPairGeometry) -> list[dict[str, Any]]:
    """The named points of the path of contact on both gears."""
    path = room.path_of_contact(geometry)
    columns = {
        "position_base_pitches": path.position,
        "driver_roll_angle_rad": path.driver_roll_angle,
        "driven_roll_angle_rad": path.driven_roll_angle,
        "driver_radius_m": path.driver_radius,
        "driven_radius_m": path.driven_radius,
        "driver_specific_sliding": path.driver_sliding,
        "driven_specific_sliding": path.driven_sliding,
    }
    return [
        {"point": point} | {key: float(values[row]) for key, values in columns.items()}
        for row, point in enumerate(room.POINTS_OF_CONTACT)
    ]


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
