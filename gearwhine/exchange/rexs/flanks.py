"""Flanks of gears of a REXS file: profile shift, pressure angle, and modifications as keys of `[[gear]]`."""

from __future__ import annotations

import math
from typing import Any

from gearwhine.exchange.rexs.gear_unit import GearUnit
from gearwhine.exchange.rexs.model import Component
from gearwhine.exchange.rexs.quantities import deg, um

_FLANKS = ("cylindrical_gear_flank", "flank_geometry")
MODIFICATIONS_LEFT_OUT = {
    "profile_slope": "the schema states no sign of it; give it as `errors.profile.slope` where it is known",
    "helix_slope": "the schema states no sign of it and no face; give it as `errors.helix.slope` where they are known",
    "profile_twist": "flanks of a case are not twisted by design",
    "topographical_modification": "flanks of a case have no topography",
    "triangular_tip_relief": "flanks of a case have no triangular relief",
    "triangular_root_relief": "flanks of a case have no triangular relief",
    "profile_deviation": "measured deviations are not taken",
    "helix_deviation": "measured deviations are not taken",
}
"""Modifications that are noted one by one, and why they are not taken."""
_STRAIGHT = {"linear": "linear", "": "linear"}


def flank_of(unit: GearUnit, gear: Component) -> Component | None:
    """Return the flank whose values a gear takes: the left one, or the only one; None without any."""
    for relation in unit.model.of_relation("flank"):
        if relation.role("gear") != gear.number:
            continue
        left, right = (unit.component(relation.role(side)) for side in ("left", "right"))
        if left is not None and right is not None and _differ(unit, left, right):
            unit.notes.changed(gear.label, f"its flanks differ: both are as the left one, {left.label}")
        return left if left is not None else right
    return next(iter(unit.model.referenced(gear.number, *_FLANKS)), None)


def _differ(unit: GearUnit, left: Component, right: Component) -> bool:
    """Whether two flanks have other values or other kinds of modifications."""

    def shown(flank: Component) -> tuple[Any, ...]:
        numbers = [
            flank.number_of(name, measure)
            for name, measure in (("addendum_modification_coefficient", ""), ("normal_pressure_angle", "rad"))
        ]
        modified = [
            (one.kind, *(sorted((name, str(attribute.value)) for name, attribute in one.attributes.items())))
            for one in _modifications(unit, flank)
        ]
        return (*numbers, *sorted(modified))

    return shown(left) != shown(right)


def _modifications(unit: GearUnit, flank: Component) -> list[Component]:
    kinds = ("tip_relief", "root_relief", "profile_crowning", "helix_crowning", "end_relief_datum_face")
    return unit.model.referenced(flank.number, *kinds, "end_relief_non_datum_face", *MODIFICATIONS_LEFT_OUT)


def modified(unit: GearUnit, flank: Component, base_radius: float, tip_radius: float, *at: str | int) -> dict[str, Any]:
    """Return the modifications of a flank as keys of a gear.

    Parameters
    ----------
    unit, flank
    base_radius, tip_radius : float
        Radii of the gear, positive [m].
    *at : str or int
        Place of the gear in the case.
    """
    table: dict[str, Any] = {}
    profile: dict[str, Any] = {}
    helix: dict[str, Any] = {}
    ends: list[tuple[float, float]] = []
    for one in _modifications(unit, flank):
        if one.kind in ("tip_relief", "root_relief"):
            relief = _relief(unit, one, base_radius, tip_radius)
            if relief is not None:
                table[one.kind] = relief
        elif one.kind == "profile_crowning":
            amount = _mean_amount(unit, one, "profile_crowning_at_root", "profile_crowning_at_tip", *at)
            if amount:
                profile["crowning"] = um(amount)
        elif one.kind == "helix_crowning":
            faces = ("helix_crowning_amount_datum_face", "helix_crowning_amount_non_datum_face")
            amount = _mean_amount(unit, one, *faces, *at)
            if amount:
                helix["crowning"] = um(amount)
        elif one.kind.startswith("end_relief"):
            face = one.kind.removeprefix("end_relief_")
            depth = one.positive(f"end_relief_depth_{face}", "m")
            length = one.positive(f"end_relief_length_{face}", "m")
            if depth is None or length is None:
                unit.notes.left_out(one.label, "it has no depth or no length above 0")
            else:
                ends.append((depth, length))
        else:
            slope = one.number_of(one.kind, "m") if one.kind in ("profile_slope", "helix_slope") else None
            shown = "" if slope is None else f"{um(slope)}: "
            unit.notes.left_out(one.label, shown + MODIFICATIONS_LEFT_OUT[one.kind])
    if len(ends) == 2:
        if ends[0] != ends[1]:
            unit.notes.changed(flank.label, "its end reliefs differ: both ends have their mean", *at, "errors")
        helix["end_relief"] = um(0.5 * (ends[0][0] + ends[1][0]))
        helix["end_relief_length"] = um(0.5 * (ends[0][1] + ends[1][1]))
    elif ends:
        unit.notes.left_out(flank.label, "an end relief at one end alone")
    errors = {key: value for key, value in (("profile", profile), ("helix", helix)) if value}
    return table | ({"errors": errors} if errors else {})


def _mean_amount(unit: GearUnit, one: Component, first: str, second: str, *at: str | int) -> float:
    """Return the mean of a crowning's amounts at both ends [m]."""
    amounts = [value for value in (one.number_of(name, "m") for name in (first, second)) if value is not None]
    if not amounts:
        unit.notes.left_out(one.label, "it has no amount")
        return 0.0
    if max(amounts) - min(amounts) > 1e-9 or len(amounts) == 1:
        unit.notes.changed(one.label, "the same amount at both ends, their mean", *at, "errors")
    return sum(amounts) / len(amounts)


def _relief(unit: GearUnit, one: Component, base_radius: float, tip_radius: float) -> dict[str, Any] | None:
    """Return a tip or root relief by its amount, and the roll angle or the length along the line of action."""
    kind = one.kind
    depth = one.number_of(f"{kind}_depth", "m")
    if depth is None or depth <= 0.0:
        unit.notes.left_out(one.label, "a relief takes material away: it has no depth above 0")
        return None
    table: dict[str, Any] = {"amount": um(depth)}
    diameter = one.positive(f"{kind}_datum_diameter", "m")
    length = one.positive(f"{kind}_datum_length", "m")
    if diameter is not None and diameter > 2.0 * base_radius:
        table["start_roll_angle"] = deg(math.sqrt((0.5 * diameter / base_radius) ** 2 - 1.0))
    elif length is not None:
        table["length"] = um(length)
    else:
        unit.notes.left_out(one.label, f"it has no {kind}_datum_diameter outside the base circle, and no length")
        return None
    shape = one.text("shape_of_relief")
    if shape not in _STRAIGHT:
        table["shape"] = "parabolic"
        if shape != "parabolic":
            unit.notes.changed(one.label, f"a {shape} relief is taken as a parabolic one")
    reference = one.positive(f"{kind}_evaluation_reference", "m")
    if kind == "tip_relief" and reference is not None and abs(reference - 2.0 * tip_radius) > 1e-5:
        unit.notes.changed(one.label, "its depth is taken at the tip circle, not where the file states it")
    return table
