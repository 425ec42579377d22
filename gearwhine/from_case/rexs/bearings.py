"""Bearings of a case as components of a REXS model: rolling bearings and concept bearings between two sides."""

from __future__ import annotations

import numpy as np

from gearwhine.case import Case
from gearwhine.case.bearings import Bearing, RollingCatalogue, RollingGeometry, RollingStiffness, StopStiffness
from gearwhine.exchange.rexs.bearings import (
    CLEARANCES,
    DOUBLE_ROW,
    ELEMENTS,
    ONE_WAY,
    SENSES,
    SPRUNG_BOTH_WAYS,
    TYPES,
)
from gearwhine.exchange.rexs.model import Attribute
from gearwhine.from_case.rexs.shafts import Shafts
from gearwhine.from_case.rexs.sheet import Sheet, plain, quantities, quantity

_NAMED = {kind: name for name, kind in reversed(TYPES.items())}
_NAMED[DOUBLE_ROW] = _NAMED["angular-contact"]
"""`bearing_type` of each type of the case, the first of the import's names for it."""
_KIND_OF = {element: kind for kind, element in reversed(ELEMENTS.items())}
_SAME = 1e-9  # part by which stiffness may differ and is one number
_HELD = ("name", "rotor", "at", "seat", "stiffness", "speeds")


def add_bearings(case: Case, shafts: Shafts) -> dict[str, int]:
    """Add the bearings; return their numbers by name."""
    found = {}
    speed = 0.0 if case.operation is None else case.operation.speed
    for bearing in case.bearing:
        sheet, about = shafts.sheet, f'bearing "{bearing.name}"'
        if isinstance(bearing.stiffness, StopStiffness):
            sheet.notes.left_out(about, "a stop")
            continue
        shaft, at = shafts.place(bearing.rotor, bearing.at)
        attributes = {"u_coordinate_on_shaft_inner_side": quantity(at, "m")}
        seat = shafts.casing
        if bearing.seat in shafts.pieces:
            rotors = {rotor.name: rotor for rotor in case.rotor}
            z = rotors[bearing.rotor].start + bearing.at - rotors[bearing.seat].start
            seat, there = shafts.place(bearing.seat, z)
            attributes |= {"u_coordinate_on_shaft_outer_side": quantity(there, "m")}
        elif bearing.seat != "ground":
            sheet.notes.changed(about, "its seat in the housing is the casing")
        if bearing.rolling is not None:
            number = _add_rolling(bearing.name, bearing.rolling, attributes, shafts, about)
        else:
            springs = _springs(bearing, speed, sheet, about)
            number = sheet.add("concept_bearing", bearing.name, attributes | springs)
        sheet.relate("side", assembly=number, inner_part=shaft, outer_part=seat)
        sheet.left_out(about, bearing, _HELD)
        found[bearing.name] = number
    return found


def _springs(bearing: Bearing, speed: float, sheet: Sheet, about: str) -> dict[str, Attribute]:
    """Return the springs of a bearing: one radial, one axial and one tilt stiffness."""
    assert not isinstance(bearing.stiffness, RollingStiffness | StopStiffness)
    entries = np.asarray(bearing.stiffness.build(), dtype=float)
    if bearing.speeds is not None:
        speeds = np.asarray(bearing.speeds)
        flat = entries.reshape(len(speeds), -1)
        entries = np.array([np.interp(abs(speed), speeds, row) for row in flat.T]).reshape(entries.shape[1:])
        sheet.notes.changed(about, "its stiffness over speed is that of the operating speed")
    radial, axial, tilt = _mean(entries, 0), 0.0, 0.0
    held = np.diag([radial, radial])
    if entries.shape == (5, 5):
        axial, tilt = float(entries[2, 2]), _mean(entries, 3)
        held = np.diag([radial, radial, axial, tilt, tilt])
    if np.any(np.abs(entries - held) > _SAME * np.max(np.abs(entries), initial=0.0)):
        sheet.notes.changed(about, "its stiffness is the mean of x and y, without what couples directions")
    attributes = {
        "radial_force_absorption": plain(radial != 0.0),
        "axial_force_absorption": plain("both_directions" if axial else "no_direction"),
        **quantities({"radial_stiffness": radial, "axial_stiffness": axial}, "N/m"),
    }
    return attributes | ({"bending_stiffness": quantity(tilt, "N*m/rad")} if tilt else {})


def _mean(entries: np.ndarray, first: int) -> float:
    return 0.5 * float(entries[first, first] + entries[first + 1, first + 1])


def _add_rolling(
    name: str,
    rolling: RollingGeometry | RollingCatalogue,
    attributes: dict[str, Attribute],
    shafts: Shafts,
    about: str,
) -> int:
    """Add a rolling bearing, by its elements or by its main dimensions."""
    sheet = shafts.sheet
    row: dict[str, Attribute] = {}
    element: dict[str, Attribute] = {}
    if isinstance(rolling, RollingGeometry):
        detail = "rolling_bearing_with_detailed_geometry"
        kind = _KIND_OF[rolling.element]
        if rolling.element == "ball" and rolling.contact_angle > 0.0:
            kind = "angular-contact"
        row = {
            "number_of_rolling_elements": plain(rolling.count),
            **quantities(
                {
                    "reference_diameter": rolling.pitch_diameter,
                    "raceway_radius_of_inner_ring": _radius(rolling.inner_groove, rolling),
                    "raceway_radius_of_outer_ring": _radius(rolling.outer_groove, rolling),
                    "significant_contact_length_inner_ring": rolling.element_length,
                },
                "m",
            ),
        }
        sizes = {
            "diameter_of_rolling_element": rolling.element_diameter,
            "length_of_rolling_element": rolling.element_length,
        }
        element = quantities(sizes, "m")
        angle: float | None = rolling.contact_angle
        static = None
        held = ("element", "count", "element_diameter", "element_length", "pitch_diameter", "contact_angle")
        sheet.left_out(about, rolling, (*held, "inner_groove", "outer_groove", *_MOUNTED), "rolling.")
    else:
        detail, catalogue = "rolling_bearing_with_catalog_geometry", rolling.catalogue
        kind = str(catalogue.type)
        sizes = {
            "inner_diameter": catalogue.bore,
            "outer_diameter": catalogue.outer_diameter,
            "width": catalogue.width,
        }
        attributes |= quantities(sizes, "m")
        if catalogue.axial_factor is not None:
            attributes[f"axial_factor_y_{2 if kind == 'tapered-roller' else 1}"] = plain(catalogue.axial_factor)
        angle, static = catalogue.contact_angle, rolling.static_rating
        sheet.left_out(about, rolling, ("catalogue", "static_rating", *_MOUNTED), "rolling.")
    if angle:
        row["pressure_angle"] = quantity(angle, "rad")
    attributes["bearing_type"] = plain(_NAMED[kind])
    attributes |= _mounting(rolling, kind, static)
    number = sheet.add(detail, name, attributes)
    along = "positive" if rolling.carries == "+z" else "negative"
    senses = () if rolling.arrangement == "single" else SENSES.get(rolling.arrangement, (along, along))
    rows = [row | {"axial_force_absorption_of_row": plain(sense)} for sense in senses] or [row]
    for place, one in enumerate(filter(None, rows), start=1):
        of_row = sheet.add("rolling_bearing_row", attributes=one)
        sheet.relate_in_order("ordered_assembly", place, assembly=number, part=of_row)
        if element:
            of_element = sheet.add("rolling_element", attributes=element)
            sheet.relate_in_order("ordered_assembly", 1, assembly=of_row, part=of_element)
    return number


def _radius(groove: float | None, rolling: RollingGeometry) -> float | None:
    return None if groove is None else groove * rolling.element_diameter


_MOUNTED = ("clearance", "preload", "axial_offset", "floating", "carries", "arrangement", "spacing", "dynamic_rating")


def _mounting(rolling: RollingGeometry | RollingCatalogue, kind: str, static: float | None) -> dict[str, Attribute]:
    """Return clearance, preload, sense of thrust and ratings of a rolling bearing."""
    sense = 1.0 if rolling.carries == "+z" else -1.0
    attributes = quantities({CLEARANCES[0]: rolling.clearance or None}, "m", "mum")
    ratings = {"radial_dynamic_load_rating": rolling.dynamic_rating, "radial_static_load_rating": static}
    attributes |= quantities(ratings, "N", "kN")
    is_single = rolling.arrangement == "single"
    spring = sense * rolling.preload if is_single and kind in SPRUNG_BOTH_WAYS else rolling.preload
    attributes |= quantities({"preload_force": spring or None}, "N")
    # Of one row that carries one way the distance is along its own sense.
    moved = rolling.axial_offset if kind in ONE_WAY else sense * rolling.axial_offset
    attributes |= quantities({"preload_distance": moved or None}, "m", "mum")
    flanged = kind != "cylindrical-roller" or rolling.flanges == "both"
    absorbed = "both_directions" if flanged and not rolling.floating else "no_direction"
    if (is_single and kind in ONE_WAY) or rolling.flanges == "one":
        absorbed = "positive" if sense > 0.0 else "negative"
    attributes["axial_force_absorption"] = plain(absorbed)
    if kind == DOUBLE_ROW or not is_single:
        attributes["number_of_bearing_rows"] = plain(2)
        attributes |= quantities({"distance_between_bearing_rows": rolling.spacing}, "m")
    return attributes
