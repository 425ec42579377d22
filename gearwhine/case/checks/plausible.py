"""Findings of the library's parts, mapped to the keys of a case: what its machine cannot be, or hardly is.

The parts check themselves: a gear its flanks, a disc its inertia, a pair its backlash, and
:mod:`gearwhine.coupling.description.solids` the places of all of them. Here they are made of a case's tables, and each
finding's part and attribute become a key. A finding that is a warning can be accepted by the case, see `Case.unusual`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

from gearwhine.case.acoustics import Acoustics
from gearwhine.case.bearings import Bearing
from gearwhine.case.box import Box
from gearwhine.case.checks.keys_of_attributes import key_in_gear, placed
from gearwhine.case.errors import LOOK_UP, UNSAID, Finding, Location, key_of, label_of, look_up, show_value
from gearwhine.case.gears import Gear, GearPair
from gearwhine.case.housing import Housing, Material, Seat
from gearwhine.case.measured import Measured
from gearwhine.case.model import Case
from gearwhine.case.overrides import ListPlace, parse_key_path
from gearwhine.case.rotors import Rotor
from gearwhine.case.units import to_rpm

if TYPE_CHECKING:
    from gearwhine.case.parts import Parts
    from gearwhine.case.planetary import Planetary
    from gearwhine.coupling.description.solids import Wall
    from gearwhine.coupling.gears import Gear as BuiltGear
    from gearwhine.coupling.gears.loaded.gear_pair import GearPair as BuiltPair
    from gearwhine.numerics.findings import Finding as PartFinding


def library_findings(case: Case) -> Iterator[Finding]:
    """Yield what the parts of a case find of themselves and of each other."""
    materials = list(_of_materials(case.material))
    yield from materials
    if not all(finding.warns for finding in materials):
        return  # nothing can be made of them
    if case.housing is not None:
        yield from _of_housing(case.housing)
    if case.measured is not None:
        yield from _of_measured(case.measured, None if case.housing is None else case.housing.frequency_limit)
    if case.acoustics is not None:
        yield from _of_acoustics(case.acoustics, None if case.housing is None else case.housing.frequency_limit)
    if case.operation is not None:
        yield from _of_speed(case.operation.speed)
    if case.operation is not None and case.operation.gravity is not None:
        from gearwhine.coupling.description.arrangement import gravity_findings

        for finding in gravity_findings(case.operation.gravity):
            yield placed(("operation",), finding)
    if case.gear or case.rotor:
        yield from _of_gears(case.gear, case.parts.gears)
        yield from _of_pairs(case.parts)
    if case.rotor:
        yield from _of_sets(case.planetary, case.parts)
        yield from _of_machine(case)


def overload(case: Case) -> str:
    """Return in a sentence that teeth do not bear the load of an operation; empty where they do."""
    found = (finding for finding in library_findings(case) if finding.location == ("operation", "torque"))
    return next((f"operation.torque: expected {finding.expected}" for finding in found), "")


def case_warnings(unusual: Iterable[str], findings: Iterable[Finding], document: object) -> list[str]:
    """Return a sentence on each finding that is a warning and that the case does not accept by ``unusual``."""
    accepted = [steps for steps in map(parse_key_path, unusual) if steps is not None]
    sentences = []
    for finding in findings:
        if not finding.warns or any(_within(finding.location, steps, document) for steps in accepted):
            continue
        key, label = key_of(finding.location), label_of(document, finding.location)
        place = f"{key} ({label})" if label else key
        value = look_up(document, finding.location) if finding.value is LOOK_UP else finding.value
        got = "" if value is UNSAID else f", got {show_value(value)}"
        accept = f"unusual = [{json.dumps(key, ensure_ascii=False)}] at the head of the case accepts it"
        sentences.append(f"{place}: expected {finding.expected}{got}; where it is meant, {accept}")
    return list(dict.fromkeys(sentences))


def _within(location: Location, steps: tuple[str, ...], document: object) -> bool:
    """Whether a location is at a key path or below it; entries of a list go by number, name or `*`."""
    here: object = document
    for step, wanted in zip(location, steps, strict=False):
        here = look_up(here, (step,))
        name = look_up(here, ("name",)) if isinstance(step, int) else step
        if wanted not in ("*", str(step), str(step) if isinstance(wanted, ListPlace) else name):
            return False
    return len(steps) <= len(location)


def _of_materials(materials: Mapping[str, Material]) -> Iterator[Finding]:
    from gearwhine.numerics.materials import material_findings

    for name, material in materials.items():
        numbers = material.youngs_modulus, material.poisson_ratio, material.density
        for finding in material_findings(("material", name), *numbers):
            yield placed(("material", name), finding)


_MAINS_SPEED = 3600.0 * math.pi / 30.0
"""Speed of two poles at 60 Hz [rad/s], which motors at the mains do not exceed."""


def _of_speed(speed: float) -> Iterator[Finding]:
    """Yield a speed that is a whole number of rad/s and fast: a number of rpm without its unit.

    Speeds in rpm or in turns a second are no whole numbers of rad/s.
    """
    if speed.is_integer() and abs(speed) > _MAINS_SPEED:
        expected = (
            f"a speed with its unit: a plain number is in rad/s, and {speed:.0f} rad/s are {to_rpm(speed):.0f} rpm; is "
            f"'{speed:.0f} rpm' meant?"
        )
        yield Finding(("operation", "speed"), expected, UNSAID, warns=True)


_MOST_DAMPED = 0.1
_LEAST_MEASURED = 0.05  # part of the housing's range below which not all measured modes lie
_WIDEST_GAP = 50.0  # ratio of neighbouring measured frequencies of one unit
_LOWEST_LIMIT = 10.0
"""Limit of a housing's modes from which a unit may be forgotten [Hz]."""


def _of_measured(measured: Measured, limit_hz: float | None) -> Iterator[Finding]:
    """Yield measured frequencies that look like those of another unit, by the housing's range and by each other."""
    frequencies = measured.frequencies_hz
    if not frequencies:
        return
    least = _LOWEST_LIMIT if limit_hz is None else _LEAST_MEASURED * limit_hz
    range_ = "below which housings have no modes" if limit_hz is None else "a part of housing.frequency_limit"
    place = ("measured", "frequencies" if measured.frequencies is not None else "file")
    if frequencies[-1] < least:
        expected = f"modes up to {least:.4g} Hz or more, {range_}; the highest is {frequencies[-1]:.4g} Hz: is it kHz?"
        yield Finding(place, expected, warns=True)
    for low, high in pairwise(frequencies):
        if high > _WIDEST_GAP * low:
            expected = f"all frequencies in one unit; {high:.4g} Hz follows {low:.4g} Hz: is that kHz?"
            yield Finding(place, expected, warns=True)


def _of_housing(housing: Housing) -> Iterator[Finding]:
    """Yield a limit of the modes and a damping that no housing has."""
    limit = housing.frequency_limit
    if limit is not None and limit < _LOWEST_LIMIT:
        expected = f"at least {_LOWEST_LIMIT:g} Hz, below which housings have no modes; a plain number is in Hz"
        yield Finding(("housing", "frequency_limit"), expected, warns=True)
    ratio = housing.damping_ratio
    if isinstance(ratio, float) and ratio > _MOST_DAMPED:
        expected = "at most 0.1: welded, cast and bolted housings have 0.001 to 0.05"
        yield Finding(("housing", "damping_ratio"), expected, warns=True)


_LOWEST_SOUND = 0.05
"""Part of the limit of the housing's modes below which the end of the sound is unlikely."""


def _of_acoustics(acoustics: Acoustics, limit: float | None) -> Iterator[Finding]:
    """Yield a medium that is no gas, and a sound that ends far below the limit of the housing's modes [Hz]."""
    for finding in acoustics.build().findings:
        yield placed(("acoustics",), finding)
    highest = acoustics.highest_frequency
    if highest is not None and limit is not None and highest < _LOWEST_SOUND * limit:
        expected = f"a frequency near that of the housing's modes, {limit:g} Hz: nothing above it is heard"
        yield Finding(("acoustics", "highest_frequency"), expected, warns=True)


def _of_gears(tables: Sequence[Gear], gears: Mapping[str, BuiltGear]) -> Iterator[Finding]:
    for index, gear in enumerate(tables):
        for finding in gears[gear.name].findings:
            if finding.attribute not in ("youngs_modulus", "density", "poisson_ratio"):
                yield placed(("gear", index), finding, key_in_gear(gear, finding.attribute))


def _of_sets(sets: Sequence[Planetary], parts: Parts) -> Iterator[Finding]:
    """Yield findings of planetary sets, and of the rotors that are their carriers and planets."""
    from gearwhine.coupling.errors import CouplingError
    from gearwhine.rotors.errors import RotorError

    numbers = {one.name: index for index, one in enumerate(sets)}
    try:
        findings = list(parts.set_findings()) if numbers else []
    except (CouplingError, RotorError):
        return  # shafts that cannot be built are findings of their own
    for finding in findings:
        found = placed(("planetary", numbers[finding.part[1]]), finding)
        yield replace(found, value=UNSAID) if finding.attribute == "planets" else found


def _of_machine(case: Case) -> Iterator[Finding]:
    """Yield findings of the machine's parts at their places."""
    from gearwhine.coupling.errors import CouplingError
    from gearwhine.rotors.errors import RotorError

    densities = [finding for index, rotor in enumerate(case.rotor) for finding in _of_densities(index, rotor)]
    yield from densities
    try:
        places = list(_place_findings(case.parts, case.housing))
    except (CouplingError, RotorError):
        # What else cannot be built is refused by the check that builds it, with its own words.
        yield from (found for index, rotor in enumerate(case.rotor) for found in _of_discs(index, rotor, case.material))
        yield from (found for index, bearing in enumerate(case.bearing) for found in _of_elements(index, bearing))
        return
    yield from (found for index, one in enumerate(case.bearing) if one.fault for found in _of_elements(index, one))
    if not all(finding.warns for finding in densities):
        return
    numbers: dict[str, dict[str, int]] = {
        "gear": {gear.name: index for index, gear in enumerate(case.gear)},
        "shaft": {rotor.name: index for index, rotor in enumerate(case.rotor)},
        "bearing": {bearing.name: index for index, bearing in enumerate(case.bearing)},
    }
    for finding in places:
        kind, name = finding.part
        if kind == "force":
            yield placed(("operation",), finding)
            continue
        table = "rotor" if kind == "shaft" else kind
        if name not in numbers[kind]:
            continue  # of a rotor's own file
        location: Location = (table, numbers[kind][name])
        if kind == "bearing" and finding.attribute == "rolling":
            found = placed(location, finding, ("stiffness", "rolling"))
            # A rotor of a file may have no journals; one of the case is drawn as it is.
            of_file = case.rotor_named(case.bearing[numbers[kind][name]].rotor).file is not None
            yield replace(found, warns=found.warns or of_file)
        elif kind == "shaft" and finding.attribute.startswith("discs") and case.rotor[numbers[kind][name]].file:
            yield placed(location, finding, ())
        else:
            yield placed(location, finding)


def _place_findings(parts: Parts, housing: Housing | None) -> Iterator[PartFinding]:
    from gearwhine.coupling.description.parts import rim_findings
    from gearwhine.coupling.description.solids import (
        force_findings,
        machine_findings,
        placed_solids,
        unbalance_findings,
        wall_findings,
    )

    shafts, gears, bearings = parts.shafts, parts.shaft_gears, parts.unloaded_bearings
    meshing = [frozenset((pair.driver, pair.driven)) for pair in parts.gear_pair]
    seats = {} if housing is None else {seat.name: seat.diameter for seat in housing.seat}
    yield from machine_findings(shafts, gears, bearings, meshing, seats)
    for shaft, rotor in zip(shafts, parts.rotors, strict=True):
        tip = max((mounted.gear.outer_radius for mounted in parts.gears_on(shaft.name)), default=0.0)
        yield from unbalance_findings(shaft, rotor, tip)
    rings = {} if housing is None else {seat.name: seat.ring_orders for seat in housing.seat if seat.ring_orders}
    for shaft in shafts:
        yield from rim_findings(shaft, parts.gears_on(shaft.name), rings, meshing)
    by_name = {shaft.name: shaft.rotor for shaft in shafts}
    for place, force in enumerate(() if parts.operation is None else parts.operation.force):
        yield from force_findings(force.build(), by_name[force.rotor], place)
    if housing is not None and housing.box is not None:
        # A rotor on the ground beside a housing may stand anywhere.
        inside = {mounted.rotor for mounted in bearings if mounted.seat is not None}
        solids = [solid for solid in placed_solids(shafts, gears, bearings) if solid.shaft in inside]
        yield from wall_findings(solids, _walls(housing.box, housing.seat))


def _walls(box: Box, seats: Sequence[Seat]) -> list[Wall]:
    """Return the walls of a box, the end walls with their seats."""
    from gearwhine.coupling.description.solids import Wall

    walls, low, high = box.walls, box.lower, box.upper
    bores = {
        side: [
            (seat.center[0], seat.center[1], 0.5 * seat.diameter)
            for seat in seats
            if (seat.center[2] > 0.0) == (side == "front")
        ]
        for side in ("back", "front")
    }
    return [
        Wall("left", low, (low[0] + walls.left, high[1], high[2])),
        Wall("right", (high[0] - walls.right, low[1], low[2]), high),
        Wall("bottom", low, (high[0], low[1] + walls.bottom, high[2])),
        Wall("top", (low[0], high[1] - walls.top, low[2]), high),
        Wall("back", low, (high[0], high[1], low[2] + walls.back), bores["back"]),
        Wall("front", (low[0], low[1], high[2] - walls.front), high, bores["front"]),
    ]


def _of_densities(index: int, rotor: Rotor) -> Iterator[Finding]:
    """Yield discs of a density that no solid has."""
    from gearwhine.numerics.materials import material_findings

    for place, disc in enumerate(rotor.discs):
        density = getattr(disc, "density", None)
        for finding in material_findings(("disc", ""), 207e9, 0.3, density) if density is not None else ():
            yield placed(("rotor", index, "discs", place), finding)


def _of_discs(index: int, rotor: Rotor, materials: Mapping[str, Material]) -> Iterator[Finding]:
    """Yield discs that no body is."""
    from gearwhine.rotors.errors import RotorError

    for place, disc in enumerate(rotor.discs):
        try:
            disc.build(rotor, materials)
        except RotorError as error:
            for finding in error.findings:
                yield placed(("rotor", index, "discs", place), finding)


def _of_elements(index: int, entry: Bearing) -> Iterator[Finding]:
    """Yield a rolling bearing that cannot be built, and spalls that it cannot have."""
    from gearwhine.rotors.errors import RotorError
    from gearwhine.rotors.rolling_bearings import require_possible

    if entry.rolling is None:
        return
    try:
        rolling = entry.rolling.build(entry.name)
    except RotorError as error:
        expected = f"a bearing that can be built; {error}"
        yield Finding(("bearing", index, "stiffness", "rolling"), expected, UNSAID)
        return
    for number, fault in enumerate(entry.fault):
        try:
            require_possible(fault.build(), rolling)
        except RotorError as error:
            yield Finding(("bearing", index, "fault", number), f"a fault that the bearing can have; {error}", UNSAID)


def _of_pairs(parts: Parts) -> Iterator[Finding]:
    """Yield findings of gear pairs, and of their load and speed in operation."""
    from gearwhine.coupling.gears.loaded.gear_pair import operation_findings

    rows = zip(parts.gear_pair, parts.pair_geometries, parts.pair_torques, parts.mesh_speeds, strict=True)
    for index, (pair, geometry, torque, speed) in enumerate(rows):
        for finding in _built_pair(pair).findings(geometry):
            of_case = finding.attribute in type(pair).model_fields
            found = placed(("gear_pair", index), finding, None if of_case else ())
            if not of_case and finding.attribute:
                expected = f"a {finding.attribute.replace('_', ' ')} of {finding.expected}"
                found = replace(found, expected=expected, value=float(f"{finding.value:.4g}"))
            yield found
        for finding in operation_findings(geometry, torque, speed or 0.0) if geometry.has_face else ():
            yield placed(("operation",), finding)


def _built_pair(pair: GearPair) -> BuiltPair:
    """Return a pair without its stiffness, whose file is not read yet."""
    from gearwhine.coupling.gears.loaded.gear_pair import GearPair as BuiltPair

    angle = pair.misalignment if isinstance(pair.misalignment, float | int) else None
    return BuiltPair(
        pair.driver, pair.driven, damping_ratio=pair.damping_ratio, backlash=pair.backlash, misalignment=angle
    )
