"""Gears of a REXS file as `[[gear]]`: teeth, profile shift, tip and root, backlash, body and flanks.

Where a file has no profile shifts they follow from the centre distance of the pair, by (ISO 21771)

    x_1 + x_2 = (z_1 + z_2) (inv(alpha_wt) - inv(alpha_t)) / (2 tan(alpha_n)),

with cos(alpha_wt) = (m_t (z_1 + z_2) / 2) cos(alpha_t) / a; of an internal gear z and of an internal pair a are
negative.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Literal

from gearwhine.coupling.gears import Gear, GearError
from gearwhine.coupling.gears.geometry.involute import involute
from gearwhine.exchange.rexs.errors import wrong
from gearwhine.exchange.rexs.flanks import flank_of, modified
from gearwhine.exchange.rexs.gear_unit import COUPLINGS, GearUnit
from gearwhine.exchange.rexs.materials import Materials
from gearwhine.exchange.rexs.model import Component
from gearwhine.exchange.rexs.quantities import deg, mm, plain, um
from gearwhine.exchange.rexs.shafts import Bodies, Body

GEARS = ("cylindrical_gear", "ring_gear")
SHIFTS = (
    "addendum_modification_coefficient",
    "generated_addendum_modification_coefficient",
    "addendum_modification_coefficient_after_finishing",
)
_CORNER_FACTORS = ("tip_corner_radius_factor_reference_profile", "tip_radius_factor")
CORNERS = ("tip_radius", "tip_corner_radius_reference_profile")
_TOLERANCE_SERIES = (
    "din_3967_deviation_tolerance_series",
    "tooth_thickness_deviation_tolerance_series_din_3967_1978",
)
_USUAL_ADDENDUM, _USUAL_DEDENDUM = 1.0, 1.25
_SHORTEST_ADDENDUM = 0.5  # modules
_HIGHEST_TOOTH = 3.0  # modules, beyond which an addendum or dedendum is no tooth's
_AGREES = 0.02  # modules of profile shift within which a sum is that of a centre distance


@dataclass(eq=False)
class Teeth:
    """A gear with its teeth, signed after ISO 21771 where it is internal.

    Attributes
    ----------
    component, body, z
        The gear, what it sits on, and the height of its middle [m].
    number : int
        Number of teeth, negative of an internal gear.
    module, pressure_angle, helix_angle : float
        Of the normal section [m, rad].
    shift : float or None
        Profile shift in modules; None where the file has none.
    flank, tool : Component or None
    addendum, dedendum : float
        In modules.
    corner : float or None
        Tip corner radius of the rack that generates the teeth [m]; None where the file has none.
    thinning : float
        Thinning along the reference circle [m].
    addendum_is_assumed, is_undercut : bool
    remarks : list
        Kind, text and key of what its `[[gear]]` notes.
    """

    component: Component
    body: Body
    z: float
    number: int
    module: float
    pressure_angle: float
    helix_angle: float
    shift: float | None
    flank: Component | None
    tool: Component | None
    addendum: float = 1.0
    dedendum: float = 1.25
    corner: float | None = None
    thinning: float = 0.0
    addendum_is_assumed: bool = False
    is_undercut: bool = False
    remarks: list[tuple[Literal["assumed", "changed"], str, str]] = field(default_factory=list)

    @property
    def radius(self) -> float:
        """Reference radius, negative of an internal gear [m]."""
        return 0.5 * self.number * self.module / math.cos(self.helix_angle)

    @property
    def transverse_pressure_angle(self) -> float:
        """Pressure angle of the transverse section [rad]."""
        return math.atan(math.tan(self.pressure_angle) / math.cos(self.helix_angle))


@dataclass(frozen=True, eq=False)
class Mesh:
    """Two gears in mesh: the component of their stage, gear 1 and gear 2, and the stated centre distance [m]."""

    stage: Component
    first: Teeth
    second: Teeth
    centre_distance: float | None

    @property
    def axes_apart(self) -> float:
        """Distance of the axes of the two bodies [m]."""
        one, other = self.first.body.axis, self.second.body.axis
        return math.hypot(one[0] - other[0], one[1] - other[1])

    @property
    def shift_sum(self) -> float | None:
        """Sum of the profile shifts at the distance of the axes, without backlash; None where they cannot mesh."""
        one, other = self.first, self.second
        radii = one.radius + other.radius
        angle = one.transverse_pressure_angle
        if radii == 0.0 or self.axes_apart == 0.0:
            return None
        cosine = abs(radii) / self.axes_apart * math.cos(angle)
        if not 0.0 < cosine < 1.0:
            return None
        working = math.acos(cosine)
        teeth = one.number + other.number
        return teeth * (involute(working) - involute(angle)) / (2.0 * math.tan(one.pressure_angle))


def find_teeth(unit: GearUnit, bodies: Bodies) -> dict[int, Teeth]:
    """Return the gears that sit on shafts, by their numbers.

    Raises
    ------
    RexsError
        Where a gear lacks teeth, module or face width, or has such as no gear has.
    """
    found = {}
    for gear in unit.model.of_kind(*GEARS):
        placed = _on_shaft(unit, gear)
        if placed is None:
            unit.notes.left_out(gear.label, "it sits on no shaft")
            continue
        shaft, coordinate = placed
        body = bodies.of(shaft)
        if body is None:
            unit.notes.left_out(gear.label, "its shaft is not taken")
            continue
        found[gear.number] = _teeth(unit, gear, shaft, body, coordinate)
    return found


def _on_shaft(unit: GearUnit, gear: Component) -> tuple[Component, float | None] | None:
    """Return the shaft of a gear, and its coordinate there where a coupling gives it; None where it has no shaft."""
    shaft = unit.model.assembly_of(gear.number, "shaft")
    if shaft is not None:
        return shaft, None
    for connection in unit.connections(COUPLINGS):
        sides = connection.sides
        if any(one is not None and one.number == gear.number for one in sides):
            other = next((one for one in sides if one is not None and one.kind == "shaft"), None)
            if other is not None and unit.is_engaged(connection.component):
                return other, connection.station(other)
    return None


def _teeth(unit: GearUnit, gear: Component, shaft: Component, body: Body, coordinate: float | None) -> Teeth:
    teeth = gear.whole("number_of_teeth")
    if teeth is None:
        raise wrong(gear.label, "the attribute number_of_teeth")
    if not 5 <= abs(teeth) <= 2000:
        raise wrong(f"{gear.label}: number_of_teeth", "a number from 5 to 2000", teeth)
    internal = gear.kind == "ring_gear" or teeth < 0
    module = gear.required("normal_module", "m")
    if not 1e-5 <= module <= 0.2:
        raise wrong(f"{gear.label}: normal_module", "a module from 0.01 to 200 mm", f"{module * 1e3:g} mm")
    helix = gear.number_of("helix_angle_reference_diameter", "rad") or 0.0
    if abs(helix) > math.radians(60.0):
        raise wrong(f"{gear.label}: helix_angle_reference_diameter", "an angle from -60 to 60 degrees", deg(helix))
    flank, tool = flank_of(unit, gear), None
    tool = _tool(unit, gear, flank)
    angle = None
    for one in (flank, tool):
        angle = one.positive("normal_pressure_angle", "rad") if one is not None and angle is None else angle
    if angle is None:
        angle = math.radians(20.0)
        unit.notes.assumed(gear.label, "no normal_pressure_angle: 20 degrees")
    if not math.radians(10.0) <= angle <= math.radians(35.0):
        raise wrong(f"{gear.label}: normal_pressure_angle", "an angle from 10 to 35 degrees", deg(angle))
    shift = None if flank is None else flank.number_of(SHIFTS)
    if shift is None and flank is not None:
        shift = flank.number_of("addendum_modification", "m")
        shift = None if shift is None else shift / module
    z = _height(unit, gear, shaft, coordinate)
    number = -abs(teeth) if internal else abs(teeth)
    return Teeth(gear, body, z, number, module, angle, helix, shift, flank, tool)


def _height(unit: GearUnit, gear: Component, shaft: Component, coordinate: float | None) -> float:
    """Return z of the middle of a gear [m]: its own place, else that on its shaft."""
    if gear.has("support_vector") and shaft.number not in unit.moved:
        return float(unit.placement(gear).origin[2])
    at = gear.number_of("u_coordinate_on_shaft", "m") if coordinate is None else coordinate
    if at is None:
        raise wrong(gear.label, "the attribute u_coordinate_on_shaft or support_vector")
    if unit.model.version == "1.0":  # there it is the left end of the face
        at += 0.5 * (gear.number_of("face_width", "m") or 0.0)
    return unit.height(shaft, at)


def _tool(unit: GearUnit, gear: Component, flank: Component | None) -> Component | None:
    """Return the last rack or cutter that generates a gear; None where the file has none."""
    tools = unit.model.referenced(gear.number, "rack_shaped_tool", "cutter_wheel_tool")
    for relation in unit.model.of_relation("manufacturing_step"):
        tool = unit.component(relation.role("tool"))
        of_flank = flank is not None and relation.role("workpiece") == flank.number
        if of_flank and tool is not None and tool.kind in ("rack_shaped_tool", "cutter_wheel_tool"):
            tools.append(tool)
    return tools[-1] if tools else None


def find_meshes(unit: GearUnit, teeth: dict[int, Teeth]) -> list[Mesh]:
    """Return the pairs of gears in mesh, in the order of the file.

    Raises
    ------
    RexsError
        Where a stage of gears that a case does not have is the only one.
    """
    meshes = []
    for relation in unit.model.of_relation("stage"):
        stage = unit.component(relation.role("stage"))
        if stage is None:
            continue
        if stage.kind != "cylindrical_stage":
            unit.notes.left_out(stage.label, "a case has cylindrical gears on parallel shafts alone")
            continue
        pair = [teeth.get(relation.role(role) or 0) for role in ("gear_1", "gear_2")]
        if pair[0] is None or pair[1] is None:
            unit.notes.left_out(stage.label, "one of its gears is not taken")
        elif pair[0].body is pair[1].body:
            raise wrong(stage.label, "gears on two shafts")
        else:
            meshes.append(Mesh(stage, pair[0], pair[1], stage.positive("center_distance", "m")))
    return meshes


def settle_shifts(unit: GearUnit, meshes: list[Mesh]) -> None:
    """Find the profile shifts that the file does not have, by the distances of the axes, one pair after the other."""
    for mesh in meshes:
        _check_distance(unit, mesh)
        _settle_ring(unit, mesh)
    open_meshes = [mesh for mesh in meshes if None in (mesh.first.shift, mesh.second.shift)]
    while open_meshes:
        # First the pairs in which one gear is known.
        open_meshes.sort(key=lambda mesh: (mesh.first.shift is None) + (mesh.second.shift is None))
        mesh = open_meshes.pop(0)
        one, other = mesh.first, mesh.second
        total = mesh.shift_sum
        if total is None or abs(total) < 1e-6:
            total = 0.0
        if one.shift is None and other.shift is None:
            lacking = [(one, 0.5 * total), (other, 0.5 * total)]
        elif one.shift is None:
            lacking = [(one, total - (other.shift or 0.0))]
        elif other.shift is None:
            lacking = [(other, total - one.shift)]
        else:
            continue
        for gear, shift in lacking:
            gear.shift = plain(shift)
            text = f"no profile shift: {gear.shift:.5g}, by the centre distance of {mesh.stage.label}"
            unit.notes.assumed(gear.component.label, text)


def _check_distance(unit: GearUnit, mesh: Mesh) -> None:
    stated = mesh.centre_distance
    if mesh.axes_apart < 1e-6:
        raise wrong(mesh.stage.label, "gears on axes apart", "two gears on one axis")
    if stated is not None and abs(stated - mesh.axes_apart) > 1e-4 * mesh.axes_apart:
        text = f"center_distance of {mm(stated)}: the axes of its shafts are {mm(mesh.axes_apart)} apart"
        unit.notes.changed(mesh.stage.label, text)


def _settle_ring(unit: GearUnit, mesh: Mesh) -> None:
    """Take the profile shift of a ring with the sign by which it fits, and its helix with the hand of its pinion."""
    ring, pinion = (mesh.first, mesh.second) if mesh.first.number < 0 else (mesh.second, mesh.first)
    if ring.number > 0:
        return
    if ring.helix_angle == -pinion.helix_angle and ring.helix_angle != 0.0:
        ring.helix_angle = pinion.helix_angle
        unit.notes.changed(ring.component.label, "its helix has the hand of the gear that meshes in it")
    total = mesh.shift_sum
    if ring.shift and pinion.shift is not None and total is not None:
        as_it_stands, turned = pinion.shift + ring.shift, pinion.shift - ring.shift
        if abs(as_it_stands - total) > _AGREES and abs(turned - total) < _AGREES:
            ring.shift = -ring.shift
            unit.notes.changed(
                ring.component.label, "its profile shift has the other sign: so it fits its centre distance"
            )


def gear_table(unit: GearUnit, materials: Materials, teeth: Teeth, place: int) -> dict[str, Any]:
    """Return the `[[gear]]` of a gear.

    Raises
    ------
    RexsError
        Where it lacks its face width, or is not on its shaft.
    """
    gear, notes = teeth.component, unit.notes
    width = gear.required("face_width", "m")
    if width <= 0.0:
        raise wrong(f"{gear.label}: face_width", "a width above 0", f"{width * 1e3:g} mm")
    shift = teeth.shift or 0.0
    table: dict[str, Any] = {
        "name": unit.names.of(gear),
        "rotor": teeth.body.name,
        "at": teeth.body.station(teeth.z, gear.label),
        "teeth": teeth.number,
        "module": mm(teeth.module),
        "face_width": mm(width),
        "pressure_angle": deg(teeth.pressure_angle),
        "helix_angle": deg(teeth.helix_angle),
        "profile_shift": plain(shift),
        "addendum": plain(teeth.addendum),
        "dedendum": plain(teeth.dedendum),
    }
    if teeth.corner is not None:
        table["root_radius"] = mm(teeth.corner)
    if teeth.thinning > 0.0:
        table["tooth_thinning"] = um(teeth.thinning)
    if teeth.is_undercut:
        table["allow_undercut"] = True
    for kind, text, key in teeth.remarks:
        (notes.assumed if kind == "assumed" else notes.changed)(gear.label, text, "gear", place, key)
    root = 2.0 * abs(teeth.radius - (table["dedendum"] - shift) * teeth.module)
    table |= _blank(unit, teeth, root, place)
    if teeth.flank is not None:
        base = abs(teeth.radius) * math.cos(teeth.transverse_pressure_angle)
        tip = abs(teeth.radius + (table["addendum"] + shift) * teeth.module)
        table |= modified(unit, teeth.flank, base, tip, "gear", place)
    own = unit.material_of(gear)
    if own is not None:
        table["material"] = materials.name_for(gear)
    if gear.has(*_TOLERANCE_SERIES) and teeth.thinning == 0.0:
        notes.left_out(f"{gear.label}: tolerance series of DIN 3967", "the teeth have their nominal thickness")
    return table


def settle_heights(unit: GearUnit, meshes: list[Mesh]) -> None:
    """Find addendum, dedendum, corner and thinning of the gears in mesh, by what the file has of them.

    An addendum that the file does not have is shortened where a tip would reach below the involute of its mate.
    """
    for teeth in {id(gear): gear for mesh in meshes for gear in (mesh.first, mesh.second)}.values():
        teeth.thinning = _thinning(unit, teeth)
        teeth.corner = _root_radius(teeth)
        teeth.addendum = _addendum(teeth)
        teeth.dedendum = _dedendum(teeth)
        teeth.is_undercut = _is_undercut(teeth)
        if teeth.is_undercut:
            teeth.remarks.append(("changed", "its tool undercuts the teeth, which is accepted", "allow_undercut"))
    for mesh in meshes:
        for tip, rooted in ((mesh.first, mesh.second), (mesh.second, mesh.first)):
            if tip.addendum_is_assumed:
                _shorten(mesh, tip, rooted)


def _built(teeth: Teeth) -> Gear:
    """Return the gear of the library, of any width.

    Raises
    ------
    GearError
        Where there is no such gear.
    """
    return Gear(
        name=str(teeth.component.number),
        teeth=teeth.number,
        module=teeth.module,
        pressure_angle=teeth.pressure_angle,
        face_width=10.0 * teeth.module,
        profile_shift=teeth.shift or 0.0,
        addendum=teeth.addendum,
        dedendum=teeth.dedendum,
        root_radius=teeth.corner,
        helix_angle=teeth.helix_angle,
        tooth_thinning=teeth.thinning,
        allow_undercut=True,
    )


def _is_undercut(teeth: Teeth) -> bool:
    try:
        return _built(teeth).is_undercut
    except (GearError, ValueError):  # the case's own check says what is wrong
        return False


def _shorten(mesh: Mesh, tip: Teeth, rooted: Teeth) -> None:
    """Shorten an assumed addendum where its tip would reach below the involute of its mate.

    The distance of the contact from the tangent point of the mate is a sin(w) less the reach of the tip,
    sqrt(r_a² - r_b²), signed as the radii.
    """
    try:
        mate, gear = _built(rooted), _built(tip)
    except (GearError, ValueError):
        return
    radii = mate.base_radius + gear.base_radius
    if not 0.0 < abs(radii) < mesh.axes_apart:
        return
    distance = math.copysign(mesh.axes_apart, radii)
    tangents = math.copysign(math.sqrt(distance**2 - radii**2), radii)
    reach = tangents - mate.base_radius * mate.roll_angle(mate.form_radius)
    longest = (gear.sign * math.hypot(gear.base_radius, reach) - gear.pitch_radius) / tip.module - gear.profile_shift
    if longest < tip.addendum and longest > _SHORTEST_ADDENDUM:
        tip.addendum = math.floor(longest * 1e4) * 1e-4
        text = f"no tip_diameter: an addendum of {tip.addendum:.4g} modules, where the involute of its mate begins"
        tip.remarks = [remark for remark in tip.remarks if remark[2] != "addendum"]
        tip.remarks.append(("assumed", text, "addendum"))


def _addendum(teeth: Teeth) -> float:
    """Return the addendum in modules, by the tip circle."""
    gear = teeth.component
    sign = 1.0 if teeth.number > 0 else -1.0
    tip = gear.number_of("tip_diameter", "m")
    if tip is not None:
        addendum = (sign * 0.5 * abs(tip) - teeth.radius) / teeth.module - (teeth.shift or 0.0)
        if 0.0 < addendum <= _HIGHEST_TOOTH:
            return addendum
    basic = None if teeth.flank is None else teeth.flank.positive("addendum_coefficient_basic_profile")
    if basic is not None and basic <= _HIGHEST_TOOTH:
        return basic
    teeth.addendum_is_assumed = True
    text = f"no tip_diameter: an addendum of {_USUAL_ADDENDUM:g} modules"
    if tip is not None:
        text = f"a tip_diameter of {mm(tip)} is none of these teeth: an addendum of {_USUAL_ADDENDUM:g} modules"
    teeth.remarks.append(("assumed" if tip is None else "changed", text, "addendum"))
    return _USUAL_ADDENDUM


def _dedendum(teeth: Teeth) -> float:
    """Return the dedendum in modules: by the root circle, else by the tool that generates it."""
    sign = 1.0 if teeth.number > 0 else -1.0
    root = teeth.component.positive("root_diameter", "m")
    generating = (teeth.shift or 0.0) - teeth.thinning / (2.0 * teeth.module * math.tan(teeth.pressure_angle))
    if root is not None:
        dedendum = (teeth.radius - sign * 0.5 * root) / teeth.module + generating
        if 0.0 < dedendum <= _HIGHEST_TOOTH:
            return dedendum
        teeth.remarks.append(("changed", f"a root_diameter of {mm(root)} is none of these teeth", "dedendum"))
    if teeth.tool is not None:
        of_tool = teeth.tool.positive("addendum_coefficient_reference_profile")
        if of_tool is None:
            length = teeth.tool.positive("addendum_reference_profile", "m")
            of_tool = None if length is None else length / teeth.module
        if of_tool is not None and of_tool <= _HIGHEST_TOOTH:
            return of_tool
    text = f"no root_diameter and no tool: a dedendum of {_USUAL_DEDENDUM:g} modules"
    teeth.remarks.append(("assumed", text, "dedendum"))
    return _USUAL_DEDENDUM


def _root_radius(teeth: Teeth) -> float | None:
    """Return the tip corner radius of the rack that generates an external gear [m]; None without one."""
    tool = teeth.tool
    if tool is None or tool.kind != "rack_shaped_tool" or teeth.number < 0:
        return None
    factor = tool.positive(_CORNER_FACTORS)
    return factor * teeth.module if factor is not None else tool.positive(CORNERS, "m")


def _thinning(unit: GearUnit, teeth: Teeth) -> float:
    """Return the thinning of the teeth along the reference circle, by the mean deviation of the span [m]."""
    names = ("upper_backlash_allowance_referenced_to_span", "lower_backlash_allowance_referenced_to_span")
    given = [value for value in (teeth.component.number_of(name, "m") for name in names) if value is not None]
    if not given:
        return 0.0
    mean = -sum(given) / len(given) / math.cos(teeth.pressure_angle)
    if mean < 0.0 or mean > teeth.module:
        unit.notes.left_out(f"{teeth.component.label}: {names[0]}", "it makes no teeth thinner by up to a module")
        return 0.0
    return mean


def _blank(unit: GearUnit, teeth: Teeth, root: float, place: int) -> dict[str, Any]:
    """Return bore, rim and web of an external gear, or the rim of an internal one, within its root circle [m]."""
    gear = teeth.component
    body = next(iter(unit.model.parts_of(gear.number, "gear_body")), None)
    table: dict[str, Any] = {}
    rim = None if body is None else body.positive("gear_body_rim_thickness", "m")
    web = None if body is None else body.positive("gear_body_web_thickness", "m")
    if teeth.number < 0:
        return _ring_blank(unit, teeth, body, rim, root, place)
    bore = gear.positive("inner_diameter", "m")
    bore = bore if bore is not None or body is None else body.positive("inner_diameter", "m")
    if bore is not None and bore < root:
        table["bore"] = mm(bore)
    elif bore is None:
        unit.notes.assumed(gear.label, "no bore: in one piece with its shaft", "gear", place)
    else:
        unit.notes.changed(gear.label, f"a bore of {mm(bore)} is none of this gear: in one piece with its shaft")
    if rim is not None and bore is not None and rim < 0.5 * (root - bore):
        table["rim"] = mm(rim)
        if web is not None:
            table["web"] = mm(web)
    return table


def _ring_blank(
    unit: GearUnit, teeth: Teeth, body: Component | None, rim: float | None, root: float, place: int
) -> dict[str, Any]:
    """Return the rim of an internal gear: its own, else out to the shaft around it."""
    around = None if body is None else body.positive("outer_diameter", "m")
    if rim is None and around is not None and around > root:
        rim = 0.5 * (around - root)
    if rim is None:
        inside = [one.inner for one in teeth.body.sections if one.start <= teeth.z <= one.end]
        bores = [bore for pair in inside for bore in pair if bore > root + teeth.module]
        if bores:
            rim = 0.5 * (min(bores) - root)
            text = f"no rim: {mm(rim)}, out to its shaft"
            unit.notes.assumed(teeth.component.label, text, "gear", place, "rim")
    if rim is None:
        unit.notes.assumed(teeth.component.label, "no rim: 3.5 modules", "gear", place)
        return {}
    return {"rim": mm(rim)}
