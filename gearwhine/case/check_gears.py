"""Checks of gear pairs: gears that can mesh, at the distance of their axes, and loops that can turn."""

from __future__ import annotations

import math
from collections.abc import Iterator

from gearwhine.case.check_shafts import LARGEST_OFFSET, millimetres
from gearwhine.case.draft import Draft
from gearwhine.case.gears import Gear, GearPair
from gearwhine.case.problems import NOTHING, UNSAID, Finding
from gearwhine.case.train import known_pairs, shaft_of, train_of_pairs

_LARGEST_WORKING_ANGLE = math.radians(45.0)

_ROUNDED_BASE_RADIUS = 0.01
"""How far the modules of base radii, printed with a few digits, may be apart, as a part of them."""


def check_gears(draft: Draft) -> Iterator[Finding]:
    """Yield gears that cannot be made of anything, pairs that cannot mesh, and loops that lock."""
    seen: dict[frozenset[str], int] = {}
    for index, pair in draft.gear_pairs:
        first = seen.setdefault(frozenset((pair.driver, pair.driven)), index)
        if first != index:
            yield Finding(("gear_pair", index), f"gears that are not yet a pair (gear_pair[{first}] is)", UNSAID)
        driver, driven = draft.gear(pair.driver), draft.gear(pair.driven)
        if driver is None or driven is None:
            continue
        for gear in (driver, driven):
            yield from _check_model(draft, index, pair, gear)
        if _same_teeth(driver, driven):
            yield from _check_place(draft, index, pair, driver, driven)
        else:
            yield from _unequal_teeth(index, driver, driven)
    known = known_pairs([gear for _, gear in draft.gears], draft.gear_pairs)
    for wrong in train_of_pairs(known).contradictions if known else ():
        expected = (
            f'pairs in a loop that can turn; "{wrong.shaft}" would turn at {float(wrong.ratio):.6g} of the first '
            f"driver's speed by the other pairs, and at {float(wrong.other):.6g} by this one"
        )
        yield Finding(("gear_pair", known[wrong.pair][0]), expected, UNSAID)


def _same_teeth(driver: Gear, driven: Gear) -> bool:
    """Tell whether two gears have the same module and pressure angle, and helices of opposite hands."""
    exact = driver.base_radius is None and driven.base_radius is None
    return (
        math.isclose(driver.tooth_module, driven.tooth_module, rel_tol=1e-9 if exact else _ROUNDED_BASE_RADIUS)
        and math.isclose(driver.pressure_angle, driven.pressure_angle, rel_tol=1e-9)
        and math.isclose(driver.helix_angle, -driven.helix_angle, rel_tol=1e-9)
    )


def _unequal_teeth(index: int, driver: Gear, driven: Gear) -> Iterator[Finding]:
    """Yield why two gears have not the same teeth."""
    if not math.isclose(driver.helix_angle, -driven.helix_angle, rel_tol=1e-9):
        angles = [math.degrees(gear.helix_angle) for gear in (driver, driven)]
        expected = f'gears of equal helix angle and opposite hands; "{driver.name}" has {angles[0]:+g} deg, '
        yield Finding(("gear_pair", index, "driven"), expected + f'"{driven.name}" {angles[1]:+g} deg')
    elif driver.pressure_angle == driven.pressure_angle:
        expected = f'gears of one module; "{driver.name}" has {millimetres(driver.tooth_module)}, "{driven.name}" '
        yield Finding(("gear_pair", index, "driven"), expected + millimetres(driven.tooth_module))
    else:
        angles = [math.degrees(gear.pressure_angle) for gear in (driver, driven)]
        expected = f'gears of one pressure angle; "{driver.name}" has {angles[0]:g} deg, "{driven.name}" '
        yield Finding(("gear_pair", index, "driven"), expected + f"{angles[1]:g} deg")


def _check_model(draft: Draft, index: int, pair: GearPair, gear: Gear) -> Iterator[Finding]:
    """Yield what the pair's stiffness model needs of a gear and does not find."""
    model = pair.stiffness.model
    if model in ("constant", "square", "table"):
        return
    location = ("gear_pair", index, "stiffness", "model")
    if gear.face_width is None:
        expected = f'a model that needs no tooth shape: gear "{gear.name}" has no face_width'
        yield Finding(location, expected, model)
    materials = draft.document.get("material")
    if gear.material is None and gear.rotor is None and len(materials if isinstance(materials, dict) else ()) != 1:
        expected = f"a material for gear \"{gear.name}\", as model '{model}' needs one"
        yield Finding(location, expected, NOTHING)


def _check_place(draft: Draft, index: int, pair: GearPair, driver: Gear, driven: Gear) -> Iterator[Finding]:
    """Yield where the gears of a pair are not opposite each other, too close or too far apart."""
    distance = pair.centre_distance
    if driver.rotor is not None and shaft_of(driver) == shaft_of(driven):
        yield Finding(("gear_pair", index, "driven"), f'a gear on another rotor than "{shaft_of(driver)}"')
        return
    rotors = draft.rotor(driver.rotor), draft.rotor(driven.rotor)
    if rotors[0] is not None and rotors[1] is not None:
        apart = math.hypot(rotors[0].axis[0] - rotors[1].axis[0], rotors[0].axis[1] - rotors[1].axis[1])
        if distance is not None and abs(distance - apart) > LARGEST_OFFSET:
            expected = f"the distance of the rotors' axes, {millimetres(apart)}"
            yield Finding(("gear_pair", index, "centre_distance"), expected)
        distance = apart
        shift = rotors[0].start + (driver.at or 0.0) - rotors[1].start - (driven.at or 0.0)
        widths = [gear.face_width for gear in (driver, driven) if gear.face_width is not None]
        reach = min(widths) / 2.0 if widths else LARGEST_OFFSET
        if abs(shift) > reach:
            expected = (
                f"gears in one plane, within half a face width, {millimetres(reach)}; they are "
                f"{millimetres(abs(shift))} apart along z"
            )
            yield Finding(("gear_pair", index, "driven"), expected)
    if distance is not None:
        yield from _check_distance(index, driver, driven, distance)


def _check_distance(index: int, driver: Gear, driven: Gear, distance: float) -> Iterator[Finding]:
    """Yield a centre distance at which the teeth jam, or lose each other.

    The working pressure angle follows from a cos(phi_w) = r_b1 + r_b2. Teeth jam where a tip reaches the other's
    root; they lose each other where the transverse contact ratio
    (sqrt(r_a1² - r_b1²) + sqrt(r_a2² - r_b2²) - a sin(phi_w)) / p_b falls below 1.
    """
    base = driver.base_circle_radius + driven.base_circle_radius
    reference = driver.pitch_radius + driven.pitch_radius
    shown = f"pitch radii of {millimetres(reference)} in all; the axes are {millimetres(distance)} apart"
    too_small = Finding(("gear_pair", index), f"axes further apart: the gears jam ({shown})", UNSAID)
    too_large = Finding(("gear_pair", index), f"axes closer together: the gears lose contact ({shown})", UNSAID)
    if distance <= base:
        yield too_small
        return
    if driver.base_radius is not None or driven.base_radius is not None:
        if math.acos(base / distance) > _LARGEST_WORKING_ANGLE:
            yield too_large
        return
    tips = [gear.tip_radius for gear in (driver, driven)]
    roots = [gear.root_circle_radius for gear in (driver, driven)]
    if max(tips[0] + roots[1], tips[1] + roots[0]) > distance:
        yield too_small
        return
    reaches = [
        math.sqrt(max(tip**2 - gear.base_circle_radius**2, 0.0))
        for tip, gear in zip(tips, (driver, driven), strict=True)
    ]
    base_pitch = 2.0 * math.pi * driver.base_circle_radius / driver.teeth
    if sum(reaches) - math.sqrt(distance**2 - base**2) < base_pitch:
        yield too_large
