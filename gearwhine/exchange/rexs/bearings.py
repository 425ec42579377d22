"""Bearings of a REXS file as `[[bearing]]`: rolling bearings by geometry or catalogue, and springs.

They stand on the ground, as the case has no housing; those of planets on their carrier, others between two shafts.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from gearwhine.exchange.rexs.catalogue import MainDimensions, dimensions_of, dimensions_on_shaft
from gearwhine.exchange.rexs.errors import wrong
from gearwhine.exchange.rexs.gear_unit import BEARINGS, Connection, GearUnit
from gearwhine.exchange.rexs.model import Component
from gearwhine.exchange.rexs.placement import along
from gearwhine.exchange.rexs.quantities import deg, mm, of, plain, um
from gearwhine.exchange.rexs.shafts import RIGID_RADIAL, RIGID_TILT, Bodies, Body

DOUBLE_ROW = "double-row-angular-contact"
TYPES = {
    "radial_grooved_ball_bearing": "deep-groove",
    "angular_contact_ball_bearing": "angular-contact",
    "four_point_contact_ball_bearing": "four-point",
    "radial_self_aligning_ball_bearing": "self-aligning-ball",
    "radial_self-aligning_ball_bearing": "self-aligning-ball",
    "radial_roller_bearing": "cylindrical-roller",
    "radial_needle_roller_bearing": "cylindrical-roller",
    "radial_tapered_roller_bearing": "tapered-roller",
    "radial_self_aligning_roller_bearing": "spherical-roller",
    "radial_spherical_roller_bearing": "spherical-roller",
    "double_row_angular_contact_bearing": DOUBLE_ROW,
}
"""Type of a catalogue bearing by `bearing_type`; a later one of a type is its name in other versions.

The schema's balls in angular contact are :data:`DOUBLE_ROW` where they have two rows on common rings.
"""
ELEMENTS = {
    "deep-groove": "ball",
    "angular-contact": "ball",
    "four-point": "four-point-ball",
    "self-aligning-ball": "self-aligning-ball",
    "cylindrical-roller": "roller",
    "tapered-roller": "tapered-roller",
    "spherical-roller": "spherical-roller",
}
"""Rolling element of each type."""
_ANGLED = ("angular-contact", DOUBLE_ROW, "four-point", "tapered-roller", "self-aligning-ball", "spherical-roller")
ONE_WAY = ("angular-contact", "tapered-roller")
SPRUNG_BOTH_WAYS = ("deep-groove", "four-point")
"""Types of one row that carries thrust both ways: the sign of a preload says which way a spring presses it."""
SENSES = {"back to back": ("positive", "negative"), "face to face": ("negative", "positive")}
"""Sense in which each of two opposed rows carries thrust, by their arrangement."""
CLEARANCES = (
    "operating_radial_bearing_clearance",
    "mounted_radial_bearing_clearance",
    "radial_bearing_clearance",
    "radial_backlash",
)
_NO_VALUE = 1e-9


@dataclass(frozen=True)
class Mounted:
    """A bearing on the body that turns in it, and the body or the ground that it sits on.

    Attributes
    ----------
    connection : Connection
    shaft : Component
        Shaft on which it sits, whose coordinate gives its station.
    body : Body
        What turns in it.
    seat : Body or None
        Carrier or other shaft on which it stands; None: the ground.
    """

    connection: Connection
    shaft: Component
    body: Body
    seat: Body | None

    @property
    def component(self) -> Component:
        """The bearing."""
        return self.connection.component


def find_bearings(
    unit: GearUnit, bodies: Bodies, carriers: dict[Body, Body], standing: Iterable[Body]
) -> list[Mounted]:
    """Return the bearings, with what turns in each.

    Parameters
    ----------
    unit, bodies
    carriers : dict of Body to Body
        Carrier of the body of each planet.
    standing : iterable of Body
        Bodies that are held and carry no gears, such as fixed axles: part of the ground.
    """
    fixed = set(standing)
    found, places = [], set[int]()
    for connection in unit.connections(BEARINGS):
        component = connection.component
        places.add(component.number)
        shafts = [(side, bodies.of(side)) for side in connection.sides if side is not None]
        turning = [(side, body) for side, body in shafts if body is not None and body not in fixed]
        if not turning:
            unit.notes.left_out(component.label, "no shaft of the case turns in it")
            continue
        planets = [(side, body) for side, body in turning if body in carriers]
        if planets:
            side, body = planets[0]
            others = [other for _, other in shafts if other is not None and other is not body]
            if others and others[0] is not carriers[body]:
                text = f'it stands on the carrier "{carriers[body].name}", not on "{others[0].name}"'
                unit.notes.changed(component.label, text)
            found.append(Mounted(connection, side, body, carriers[body]))
            continue
        (side, body), *further = turning
        around = further[0][1] if further else None
        if around is body:
            unit.notes.left_out(component.label, "both of its sides are one body")
            continue
        found.append(Mounted(connection, side, body, around))
    for component in unit.model.of_kind(*BEARINGS):
        if component.number not in places:
            unit.notes.left_out(component.label, "no relation says between which parts it stands")
    return found


def bearing_table(unit: GearUnit, mounted: Mounted, place: int) -> dict[str, Any] | None:
    """Return the `[[bearing]]` of a bearing; None for one that holds nothing.

    Raises
    ------
    RexsError
        Where its place is not on its shaft, or a value is none.
    """
    component = mounted.component
    z = _height(unit, mounted)
    stiffness = _rolling(unit, mounted, z, place) if component.kind.startswith("rolling") else None
    if stiffness is None:
        stiffness = _springs(unit, component, place)
    if stiffness is None:
        unit.notes.left_out(component.label, "it holds its shaft in no direction")
        return None
    return {
        "name": unit.names.of(component),
        "rotor": mounted.body.name,
        "at": mounted.body.station(z, component.label),
        "seat": "ground" if mounted.seat is None else mounted.seat.name,
        "stiffness": stiffness,
    }


def _height(unit: GearUnit, mounted: Mounted) -> float:
    """Return z of the middle of a bearing [m]."""
    at = mounted.connection.station(mounted.shaft)
    if at is not None:
        return unit.height(mounted.shaft, at)
    if mounted.component.has("support_vector"):
        return float(unit.placement(mounted.component).origin[2])
    raise wrong(mounted.component.label, "its place on its shaft, u_coordinate_on_shaft_inner_side or support_vector")


def support_table(unit: GearUnit, body: Body, coupling: Connection, place: int) -> dict[str, Any] | None:
    """Return the `[[bearing]]` by which a coupling to the casing holds a body; None for one that holds nothing."""
    side = next(one for one in coupling.sides if one is not None and one.kind != "gear_casing")
    stiffness = _springs(unit, coupling.component, place)
    if stiffness is None:
        return None
    at = coupling.station(side)
    z = unit.height(side, at) if at is not None else float(unit.placement(coupling.component).origin[2])
    return {
        "name": unit.names.of(coupling.component),
        "rotor": body.name,
        "at": body.station(z, coupling.component.label),
        "seat": "ground",
        "stiffness": stiffness,
    }


def _springs(unit: GearUnit, component: Component, place: int) -> dict[str, Any] | None:
    """Return a bearing's springs; None where it has none."""
    at = ("bearing", place, "stiffness")
    radial_held = component.flag("radial_force_absorption")
    axial = component.text("axial_force_absorption")
    radial = 0.0 if radial_held is False else _spring(unit, component, "radial_stiffness", "N/m", RIGID_RADIAL, *at)
    held_axially = axial != "no_direction" and (
        component.kind not in BEARINGS or component.has("axial_force_absorption")
    )
    lengthwise = _spring(unit, component, "axial_stiffness", "N/m", RIGID_RADIAL, *at) if held_axially else 0.0
    if axial in ("positive", "negative") and lengthwise > 0.0:
        unit.notes.changed(component.label, "a spring holds its shaft axially in both senses, not in one", *at)
    tilt = 0.0
    if component.has("bending_stiffness"):
        tilt = _spring(unit, component, "bending_stiffness", "N*m/rad", RIGID_TILT, *at)
    if radial == lengthwise == tilt == 0.0:
        return None
    if lengthwise == tilt == 0.0:
        return {"xx": of(radial, "N/m"), "yy": of(radial, "N/m")}
    diagonal = [
        *(of(value, "N/m") if value else 0 for value in (radial, radial, lengthwise)),
        *(of(value, "N*m/rad") if value else 0 for value in (tilt, tilt)),
    ]
    return {"matrix": [[diagonal[row] if row == column else 0 for column in range(5)] for row in range(5)]}


def _spring(unit: GearUnit, component: Component, name: str, measure: str, rigid: float, *at: str | int) -> float:
    """Return one stiffness: at most that of a rigid connection, which one stands for that has no value."""
    value = component.number_of(name, measure)
    if value is None:
        unit.notes.assumed(component.label, f"no {name}: rigid, {rigid:.0e} {measure}", *at)
        return rigid
    if value < 0.0:
        raise wrong(f"{component.label}: {name}", f"a stiffness of 0 {measure} or more", value)
    if value > rigid:
        unit.notes.changed(component.label, f"{name} of {value:.1e} {measure}: rigid, {rigid:.0e} {measure}", *at)
        return rigid
    return value


def _rolling(unit: GearUnit, mounted: Mounted, z: float, place: int) -> dict[str, Any] | None:
    """Return a rolling bearing; None for one whose type the case does not have."""
    component = mounted.component
    named = component.text("bearing_type")
    kind = TYPES.get(named)
    if kind is None:
        shown = named or "no type"
        unit.notes.changed(component.label, f"{shown}: springs in its place", "bearing", place, "stiffness")
        return None
    rows = unit.model.parts_of(component.number, "rolling_bearing_row")
    is_apart = component.positive("distance_between_bearing_rows", "m") is not None
    if kind == "angular-contact" and _row_count(component, rows) == 2 and not is_apart:
        kind = kind if _sense(component, rows) in ("positive", "negative") else DOUBLE_ROW
    geometry = _geometry(unit, component, kind, rows)
    rolling = geometry if geometry is not None else _by_catalogue(unit, mounted, kind, rows, z, place)
    rolling |= _mounting(unit, mounted, kind, rows, place)
    return {"rolling": rolling}


def _geometry(unit: GearUnit, component: Component, kind: str, rows: list[Component]) -> dict[str, Any] | None:
    """Return the inside of a bearing by its first row and the elements in it; None where the file has it not."""
    if not rows or kind not in ELEMENTS:
        return None
    row = rows[0]
    elements = unit.model.parts_of(row.number, "rolling_element")
    count = row.whole("number_of_rolling_elements") or len(elements)
    pitch = row.positive(("reference_diameter_rolling_bearing", "reference_diameter"), "m")
    diameter = elements[0].positive("diameter_of_rolling_element", "m") if elements else None
    if count < 3 or pitch is None or diameter is None or diameter >= pitch:
        if component.kind == "rolling_bearing_with_detailed_geometry":
            unit.notes.changed(component.label, "its rows lack elements or sizes: estimated from its main dimensions")
        return None
    table: dict[str, Any] = {
        "element": ELEMENTS[kind],
        "count": count,
        "element_diameter": mm(diameter),
        "pitch_diameter": mm(pitch),
    }
    if kind.endswith("roller"):
        length = row.positive(("significant_contact_length_inner_ring", "significant_width_inner"), "m")
        length = length or elements[0].positive("length_of_rolling_element", "m")
        if length is None:
            return None
        table["element_length"] = mm(length)
    else:
        for key, names in (
            ("inner_groove", ("raceway_radius_of_inner_ring", "running_path_radius_of_inner_ring")),
            ("outer_groove", ("raceway_radius_of_outer_ring", "running_path_radius_of_outer_ring")),
        ):
            radius = row.number_of(names, "m")
            if (
                radius is not None
                and 0.5 < abs(radius) / diameter <= 1.0
                and not (kind == "self-aligning-ball" and key == "outer_groove")
            ):
                table[key] = plain(abs(radius) / diameter)
    angle = abs(row.number_of("pressure_angle", "rad") or 0.0)
    if kind in _ANGLED and angle > 0.0:
        table["contact_angle"] = deg(angle)
    elif kind in ("four-point", "tapered-roller", "self-aligning-ball"):
        return None
    return table


def _by_catalogue(
    unit: GearUnit, mounted: Mounted, kind: str, rows: list[Component], z: float, place: int
) -> dict[str, Any]:
    """Return a bearing by its main dimensions, and its ratings."""
    component = mounted.component
    sizes = [component.positive(name, "m") for name in ("inner_diameter", "outer_diameter", "width")]
    bore, outer, width = sizes
    if bore is None or outer is None or width is None or outer <= bore:
        bore, outer, width = _main_dimensions(unit, mounted, z, place)
    catalogue: dict[str, Any] = {"type": kind, "bore": mm(bore), "outer_diameter": mm(outer), "width": mm(width)}
    angle = abs(rows[0].number_of("pressure_angle", "rad") or 0.0) if rows else 0.0
    factor = component.positive("axial_factor_y_2" if kind == "tapered-roller" else "axial_factor_y_1")
    if kind in _ANGLED and angle > 0.0:
        catalogue["contact_angle"] = deg(angle)
    elif kind in ("tapered-roller", "spherical-roller") and factor is not None:
        catalogue["axial_factor"] = plain(factor)
    return {"catalogue": catalogue}


def _main_dimensions(unit: GearUnit, mounted: Mounted, z: float, place: int) -> MainDimensions:
    """Return the main dimensions that the file does not have: by the designation, else by the shaft."""
    component = mounted.component
    designation = component.text("catalogue_designation", "name") or component.name
    found = dimensions_of(designation)
    at = ("bearing", place, "stiffness")
    if found is not None:
        sizes = " x ".join(f"{size * 1e3:g}" for size in found)
        unit.notes.assumed(component.label, f"no main dimensions: {sizes} mm, of {designation} by ISO 15 and 355", *at)
        return found
    bore = mounted.body.diameter_at(z)
    if bore <= 0.0:
        raise wrong(component.label, "inner_diameter, outer_diameter and width")
    found = dimensions_on_shaft(bore)
    sizes = " x ".join(f"{size * 1e3:.4g}" for size in found)
    text = f"no main dimensions: {sizes} mm, of diameter series 2 on its shaft; look up those of {designation or 'it'}"
    unit.notes.assumed(component.label, text, *at)
    return found


def _mounting(unit: GearUnit, mounted: Mounted, kind: str, rows: list[Component], place: int) -> dict[str, Any]:
    """Return clearance, preload, sense of thrust and ratings of a bearing."""
    component, notes = mounted.component, unit.notes
    at = ("bearing", place, "stiffness")
    table: dict[str, Any] = {}
    # The clearance of one row before mounting is not that in which it is set against another one.
    clearances = CLEARANCES[:2] if kind in ONE_WAY else CLEARANCES
    clearance = next((name for name in clearances if component.has(name)), None)
    if clearance is not None:
        value = component.number_of(clearance, "m") or 0.0
        if abs(value) > _NO_VALUE:
            table["clearance"] = um(value)
        if clearance == "radial_bearing_clearance":
            notes.changed(component.label, "its clearance before mounting is taken for that in operation", *at)
    dynamic = component.positive(("radial_dynamic_load_rating", "dynamic_capacity"), "N")
    static = component.positive(("radial_static_load_rating", "static_capacity"), "N")
    if dynamic is not None:
        table["dynamic_rating"] = of(dynamic / 1e3, "kN")
    if static is not None and _geometry(unit, component, kind, rows) is None:
        table["static_rating"] = of(static / 1e3, "kN")
    sense = _sense(component, rows)
    is_pair = kind == "deep-groove" and _row_count(component, rows) == 2
    if kind in ONE_WAY or (is_pair and component.positive("distance_between_bearing_rows", "m") is not None):
        table |= _thrust(unit, mounted, sense, rows, place)
    elif sense == "no_direction" and kind != "cylindrical-roller":
        table["floating"] = True
    elif sense in ("positive", "negative") and kind != "cylindrical-roller":
        notes.changed(component.label, "it locates its shaft in both senses, not in one", *at)
    elif sense in ("positive", "negative", "both_directions") and kind == "cylindrical-roller":
        notes.changed(component.label, "rollers without flanges, which take no thrust", *at)
    force = component.number_of(("preload_force", "initial_load"), "N") or 0.0
    is_backward = force < 0.0 and kind in SPRUNG_BOTH_WAYS and "arrangement" not in table
    if is_backward:
        force, table["carries"] = -force, "-z"
    distance = component.number_of(("preload_distance", "initial_load_shift"), "m") or 0.0
    if kind != "cylindrical-roller" and not table.get("floating"):
        if force > 0.0:
            table["preload"] = of(force, "N")
        if abs(distance) > _NO_VALUE and "arrangement" not in table:
            table["axial_offset"] = um(-distance if is_backward else distance)
    for name in ("misalignment_in_v_direction", "misalignment_in_w_direction"):
        if abs(component.number_of(name, "m") or 0.0) > _NO_VALUE:
            notes.left_out(f"{component.label}: {name}", "seats of a case on the ground have no offset")
    return table


def _thrust(unit: GearUnit, mounted: Mounted, sense: str, rows: list[Component], place: int) -> dict[str, Any]:
    """Return the sense in which a bearing of angled elements carries thrust, or the arrangement of its two rows."""
    component = mounted.component
    spacing = component.positive("distance_between_bearing_rows", "m")
    # A component on a shaft may have an axis of its own, which may point the other way.
    ahead = along(unit.placement(component if component.has("u_axis_vector") else mounted.shaft)) > 0
    forward = "positive" if ahead else "negative"
    if _row_count(component, rows) == 2 and spacing is not None:
        senses = tuple(row.text("axial_force_absorption_of_row") for row in rows)
        table: dict[str, Any] = {"spacing": mm(spacing)}
        if senses in (("positive", "positive"), ("negative", "negative")):
            return table | {"arrangement": "tandem", "carries": "+z" if senses[0] == forward else "-z"}
        opposed = next((name for name, pair in SENSES.items() if pair == senses), None)
        if opposed is None:
            unit.notes.assumed(component.label, "its two rows stand back to back", "bearing", place, "stiffness")
        return table | {"arrangement": opposed or "back to back"}
    if sense in ("positive", "negative"):
        return {"carries": "+z" if sense == forward else "-z"}
    text = "no sense of its thrust: it carries +z, away from the left end"
    unit.notes.assumed(component.label, text, "bearing", place, "stiffness")
    return {"carries": "+z"}


def _row_count(component: Component, rows: list[Component]) -> int:
    return component.whole("number_of_bearing_rows") or len(rows) or 1


def _sense(component: Component, rows: list[Component]) -> str:
    """Return the sense in which a bearing carries thrust, as the file names it."""
    sense = component.text("axial_force_absorption")
    return sense or (rows[0].text("axial_force_absorption_of_row") if rows else "")
