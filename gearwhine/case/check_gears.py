"""Checks of gears and gear pairs: teeth that can be cut, gears that can mesh on their axes, loops that can turn.

The geometry is that of :mod:`coupling.gears`; its errors are put in the words of the case file.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from gearwhine.case.check_shafts import millimetres
from gearwhine.case.draft import Draft
from gearwhine.case.gears import Gear, GearPair
from gearwhine.case.problems import NOTHING, UNSAID, Finding
from gearwhine.case.train import shaft_of

if TYPE_CHECKING:
    from coupling.gears import Gear as BuiltGear


def check_gears(draft: Draft) -> Iterator[Finding]:
    """Yield gears that cannot be cut, pairs that cannot mesh, and loops that lock."""
    if not draft.gears:
        return
    # The package brings numpy and scipy: only a case with gears waits for them.
    from coupling.gears import GearError

    built: dict[str, BuiltGear] = {}
    for index, gear in draft.gears:
        try:
            built.setdefault(gear.name, gear.build())
        except GearError as error:
            yield Finding(("gear", index), f"a gear that can be made; {error}", UNSAID)
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
        unequal = list(_unequal_teeth(index, driver, driven))
        yield from unequal
        if not unequal and driver.name in built and driven.name in built:
            yield from _check_pair(draft, index, pair, (driver, driven), (built[driver.name], built[driven.name]))
    for wrong in draft.train.contradictions if draft.train is not None else ():
        expected = (
            f'pairs in a loop that can turn; "{wrong.shaft}" would turn at {float(wrong.ratio):.6g} of the first '
            f"driver's speed by the other pairs, and at {float(wrong.other):.6g} by this one"
        )
        yield Finding(("gear_pair", draft.readable_pairs[wrong.pair][0]), expected, UNSAID)


def _check_pair(
    draft: Draft, index: int, pair: GearPair, given: tuple[Gear, Gear], gears: tuple[BuiltGear, BuiltGear]
) -> Iterator[Finding]:
    """Yield why two gears do not mesh, at any distance or at that of their axes, or are not opposite each other."""
    from coupling.gears import GearError, GearPairGeometry

    try:
        GearPairGeometry(*gears)
    except GearError as error:
        # Not for their distance, which is the one without backlash.
        yield Finding(("gear_pair", index), f"gears that can mesh; {error}", UNSAID)
        return
    distance = pair.centre_distance
    if given[0].rotor is not None and shaft_of(given[0]) == shaft_of(given[1]):
        yield Finding(("gear_pair", index, "driven"), f'a gear on another rotor than "{shaft_of(given[0])}"')
        return
    rotors = draft.rotor(given[0].rotor), draft.rotor(given[1].rotor)
    if rotors[0] is not None and rotors[1] is not None:
        from coupling.gear_train import LARGEST_OFFSET

        apart = math.hypot(rotors[0].axis[0] - rotors[1].axis[0], rotors[0].axis[1] - rotors[1].axis[1])
        if distance is not None and abs(distance - apart) > LARGEST_OFFSET:
            expected = f"the distance of the rotors' axes, {millimetres(apart)}"
            yield Finding(("gear_pair", index, "centre_distance"), expected)
        distance = apart
        shift = rotors[0].start + (given[0].at or 0.0) - rotors[1].start - (given[1].at or 0.0)
        reach = 0.5 * min(gear.face_width for gear in gears)
        if abs(shift) > reach + LARGEST_OFFSET:
            expected = (
                f"gears in one plane, within half a face width, {millimetres(reach)}; they are "
                f"{millimetres(abs(shift))} apart along z"
            )
            yield Finding(("gear_pair", index, "driven"), expected)
    if distance is not None:
        yield from _check_distance(index, gears, distance)


def _check_distance(index: int, gears: tuple[BuiltGear, BuiltGear], distance: float) -> Iterator[Finding]:
    """Yield a centre distance at which teeth jam, or lose each other, that mesh at another."""
    from coupling.gears import GearPairGeometry, InterferenceError, NoContactError

    reference = gears[0].pitch_radius + gears[1].pitch_radius
    shown = f"(pitch radii of {millimetres(reference)} in all; the axes are {millimetres(distance)} apart)"
    try:
        GearPairGeometry(*gears, distance)
    except InterferenceError:
        yield Finding(("gear_pair", index), f"axes further apart: the gears jam {shown}", UNSAID)
    except NoContactError:
        yield Finding(("gear_pair", index), f"axes closer together: the gears lose contact {shown}", UNSAID)


def _unequal_teeth(index: int, driver: Gear, driven: Gear) -> Iterator[Finding]:
    """Yield a size in which the teeth of two gears do not fit each other."""
    from coupling.gears.pair_geometry import mismatched_sizes

    modules, pressures, helices = (
        (driver.tooth_module, driven.tooth_module),
        (math.degrees(driver.pressure_angle), math.degrees(driven.pressure_angle)),
        (math.degrees(driver.helix_angle), math.degrees(driven.helix_angle)),
    )
    sizes = ((gear.tooth_module, gear.pressure_angle, gear.helix_angle) for gear in (driver, driven))
    unequal = mismatched_sizes(*sizes)
    if "helix_angle" in unequal:
        size, shown = "equal helix angle and opposite hands", [f"{angle:+g} deg" for angle in helices]
    elif "pressure_angle" in unequal:
        size, shown = "one pressure angle", [f"{angle:g} deg" for angle in pressures]
    elif "module" in unequal:
        size, shown = "one module", [millimetres(module) for module in modules]
    else:
        return
    expected = f'gears of {size}; "{driver.name}" has {shown[0]}, "{driven.name}" {shown[1]}'
    yield Finding(("gear_pair", index, "driven"), expected)


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
