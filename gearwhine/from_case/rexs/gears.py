"""Gears of a case, their pairs and planetary sets as components of a REXS model."""

from __future__ import annotations

import math
from collections.abc import Sequence

from gearwhine.case import Case, CaseError, Problem
from gearwhine.case.gears import Gear, Relief, distance_of_axes
from gearwhine.case.planetary import HeldMember
from gearwhine.coupling.gears import Gear as BuiltGear
from gearwhine.exchange.rexs.gears import CORNERS, SHIFTS
from gearwhine.exchange.rexs.model import Attribute
from gearwhine.from_case.rexs.shafts import Shafts
from gearwhine.from_case.rexs.sheet import Sheet, plain, quantities, quantity

_BODY = (("rim", "gear_body_rim_thickness"), ("web", "gear_body_web_thickness"))
_HELD = (
    *("name", "rotor", "at", "teeth", "internal", "module", "diametral_pitch", "base_radius", "face_width"),
    *("pressure_angle", "helix_angle", "profile_shift", "addendum", "dedendum", "root_radius", "tooth_thinning"),
    *("allow_undercut", "bore", "rim", "web", "tip_relief", "root_relief", "material", "errors"),
)
_INERTIA = ("mass", "polar_inertia", "diametral_inertia")


def add_gears(case: Case, shafts: Shafts) -> dict[str, int]:
    """Add the gears; return their numbers by name.

    Raises
    ------
    CaseError
        Where a gear has no face width.
    """
    wide = [(gear, gear.face_width) for gear in case.gear if gear.face_width is not None]
    problems = [
        Problem(f"gear[{place}].face_width", gear.name, "a face width, which every gear of a REXS file has")
        for place, gear in enumerate(case.gear)
        if gear.face_width is None
    ]
    if problems:
        raise CaseError(problems)
    return {gear.name: _add_gear(gear, width, case.parts.gears[gear.name], shafts) for gear, width in wide}


def _add_gear(gear: Gear, face_width: float, built: BuiltGear, shafts: Shafts) -> int:
    sheet, about = shafts.sheet, f'gear "{gear.name}"'
    assert gear.rotor is not None
    assert gear.at is not None
    shaft, at = shafts.place(gear.rotor, gear.at)
    attributes = {
        "number_of_teeth": plain(abs(gear.teeth)),
        **quantities(
            {
                "normal_module": built.module,
                "face_width": face_width,
                "u_coordinate_on_shaft": at,
                "tip_diameter": 2.0 * abs(built.tip_radius),
                "root_diameter": 2.0 * abs(built.root_circle_radius),
                "inner_diameter": gear.bore or None,
            },
            "m",
        ),
        "helix_angle_reference_diameter": quantity(gear.helix_angle, "rad"),
    }
    if gear.tooth_thinning:
        # The shorter span, along the base tangent, of teeth that are thinner along the reference circle.
        span = -gear.tooth_thinning * math.cos(gear.pressure_angle)
        names = ("upper_backlash_allowance_referenced_to_span", "lower_backlash_allowance_referenced_to_span")
        attributes |= quantities(dict.fromkeys(names, span), "m", "mum")
    number = sheet.part(shaft, "ring_gear" if gear.teeth < 0 else "cylindrical_gear", gear.name, attributes)
    if gear.material is not None:
        sheet.relate("reference", origin=number, referenced=shafts.materials[gear.material])
    body = quantities({name: getattr(gear, key) for key, name in _BODY}, "m")
    if body:
        sheet.part(number, "gear_body", attributes=body)
    _add_flanks(gear, number, sheet, about)
    if any(getattr(gear, key) is not None for key in _INERTIA):
        sheet.notes.left_out(about, "mass and moments of inertia, which follow from the geometry")
    sheet.left_out(about, gear, (*_HELD, *_INERTIA))
    return number


def _add_flanks(gear: Gear, number: int, sheet: Sheet, about: str) -> None:
    """Add both flanks, their modifications, and the rack whose corner shapes the fillet."""
    attributes = {
        "normal_pressure_angle": quantity(gear.pressure_angle, "rad"),
        SHIFTS[0]: plain(gear.profile_shift),
    }
    flanks = [sheet.add("cylindrical_gear_flank", f"{gear.name}, {side}", attributes) for side in ("left", "right")]
    sheet.relate("flank", gear=number, left=flanks[0], right=flanks[1])
    found = [
        sheet.add(kind, attributes=_relief(relief, kind, gear))
        for kind, relief in (("tip_relief", gear.tip_relief), ("root_relief", gear.root_relief))
        if relief is not None and relief.amount > 0.0
    ]
    profile, helix = gear.errors.profile, gear.errors.helix
    if profile is not None and profile.crowning:
        names = ("profile_crowning_at_root", "profile_crowning_at_tip")
        found.append(sheet.add("profile_crowning", attributes=_both(names, profile.crowning)))
    if helix is not None and helix.crowning:
        names = ("helix_crowning_amount_datum_face", "helix_crowning_amount_non_datum_face")
        found.append(sheet.add("helix_crowning", attributes=_both(names, helix.crowning)))
    if helix is not None and helix.end_relief > 0.0:
        for face in ("datum_face", "non_datum_face"):
            ends = {f"end_relief_depth_{face}": helix.end_relief, f"end_relief_length_{face}": helix.end_relief_length}
            found.append(sheet.add(f"end_relief_{face}", attributes=quantities(ends, "m")))
    for flank in flanks:
        for modification in found:
            sheet.relate("reference", origin=flank, referenced=modification)
    if gear.root_radius is not None:
        if gear.teeth > 0 and gear.root_radius > 0.0:
            tool = {
                CORNERS[0]: quantity(gear.root_radius, "m"),
                "normal_pressure_angle": quantity(gear.pressure_angle, "rad"),
            }
            rack, settings = sheet.add("rack_shaped_tool", gear.name, tool), "cylindrical_gear_manufacturing_settings"
            setting = sheet.add(settings, gear.name)
            for flank in flanks:
                roles = {"workpiece": flank, "tool": rack, "manufacturing_settings": setting}
                sheet.relate_in_order("manufacturing_step", 1, **roles)
        else:
            sheet.notes.left_out(about, "root_radius")
    sheet.left_out(about, gear.errors, ("profile", "helix"), "errors.")
    if profile is not None:
        shape = () if profile.form else ("waves", "phase")
        sheet.left_out(about, profile, ("crowning", *shape), "errors.profile.")
    if helix is not None:
        sheet.left_out(about, helix, ("crowning", "end_relief", "end_relief_length"), "errors.helix.")


def _both(names: tuple[str, str], amount: float) -> dict[str, Attribute]:
    """Return an amount at both ends."""
    return quantities(dict.fromkeys(names, amount), "m")


def _relief(relief: Relief, kind: str, gear: Gear) -> dict[str, Attribute]:
    """Return a relief by its depth, and the circle or the length at which it begins."""
    attributes = {f"{kind}_depth": quantity(relief.amount, "m"), "shape_of_relief": plain(relief.shape)}
    if relief.length is not None:
        return attributes | {f"{kind}_datum_length": quantity(relief.length, "m")}
    assert relief.start_roll_angle is not None
    size = gear.base_radius
    if size is None:
        module = gear.module if gear.module is not None else 0.0254 / (gear.diametral_pitch or 1.0)
        transverse = math.atan(math.tan(gear.pressure_angle) / math.cos(gear.helix_angle))
        size = 0.5 * abs(gear.teeth) * module / math.cos(gear.helix_angle) * math.cos(transverse)
    # From the base circle a roll angle phi of the involute leads to the radius r_b sqrt(1 + phi²).
    diameter = 2.0 * size * math.hypot(1.0, relief.start_roll_angle)
    return attributes | {f"{kind}_datum_diameter": quantity(diameter, "m")}


def add_stages(case: Case, shafts: Shafts, gears: dict[str, int]) -> None:
    """Add the gear pairs as stages, and the planetary sets with their carriers."""
    sheet, found = shafts.sheet, {}
    tables = {gear.name: gear for gear in case.gear}
    axes = {rotor.name: rotor.axis for rotor in case.rotor}
    for pair in case.gear_pair:
        driver, driven = tables[pair.driver], tables[pair.driven]
        lengths = {"center_distance": distance_of_axes(axes[str(driver.rotor)], axes[str(driven.rotor)])}
        if pair.backlash is not None:
            # From the line of action, in the transverse plane, to the normal of the flanks, by the base helix angle.
            normal = pair.backlash * math.sqrt(
                1.0 - (math.sin(driver.helix_angle) * math.cos(driver.pressure_angle)) ** 2
            )
            lengths |= {"minimum_normal_backlash": normal, "maximum_normal_backlash": normal}
        name = f"{pair.driver} - {pair.driven}"
        found[pair.driver, pair.driven] = stage = sheet.add("cylindrical_stage", name, quantities(lengths, "m"))
        sheet.relate("stage", stage=stage, gear_1=gears[pair.driver], gear_2=gears[pair.driven])
        held = ("driver", "driven", "backlash", "centre_distance", "relief_aim")
        sheet.left_out(f'gear pair "{name}"', pair, held)
    carriers: dict[str, int] = {}
    for one in case.planetary:
        stage = sheet.part(shafts.unit, "planetary_stage", one.name)
        carrier = carriers.get(one.carrier)
        if carrier is None:
            carrier = carriers[one.carrier] = sheet.add("planet_carrier", one.carrier)
            for piece in shafts.pieces[one.carrier]:
                sheet.relate("assembly", assembly=carrier, part=piece.number)
        sheet.relate("assembly", assembly=stage, part=carrier)
        for rotor in dict.fromkeys(str(tables[name].rotor) for name in one.planets):
            sheet.relate("planet_shaft", planetary_stage=stage, shaft=shafts.first(rotor))
        for central in (one.sun, one.ring):
            if central is not None:
                sheet.relate("central_shaft", planetary_stage=stage, shaft=shafts.first(str(tables[central].rotor)))
        sheet.left_out(
            f'planetary "{one.name}"', one, ("name", "sun", "ring", "planets", "carrier", "count", "angles", "fixed")
        )
        for gears_in_mesh, number in list(found.items()):
            if set(gears_in_mesh) & set(one.planets):
                sheet.relate("assembly", assembly=stage, part=number)
                del found[gears_in_mesh]
        if one.fixed is not None:
            _add_torque_support(case.gear, one.fixed, shafts, f"{one.name}, fixed", f'planetary "{one.name}"', "fixed.")
    for number in found.values():
        sheet.relate("assembly", assembly=shafts.unit, part=number)
    for support in case.torque_support:
        words = f'torque support of "{support.member}"'
        _add_torque_support(case.gear, support, shafts, words, words)


def _add_torque_support(
    gears: Sequence[Gear], held: HeldMember, shafts: Shafts, name: str, where: str, key: str = ""
) -> None:
    """Add the coupling to the casing that holds a member from turning, and in no other way."""
    rotor, at = held.place(gears)
    shaft, along = shafts.place(rotor, at)
    attributes = {
        "u_coordinate_on_shaft_inner_side": quantity(along, "m"),
        **quantities({"radial_stiffness": 0.0, "axial_stiffness": 0.0}, "N/m"),
        **quantities({"rotational_stiffness": held.stiffness}, "N*m/rad"),
    }
    number = shafts.sheet.add("coupling", name, attributes)
    shafts.sheet.relate("side", assembly=number, inner_part=shaft, outer_part=shafts.casing)
    shafts.sheet.left_out(where, held, ("member", "stiffness", "at"), key)
