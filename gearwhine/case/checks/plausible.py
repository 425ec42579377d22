"""Findings of the library's parts, mapped to the keys of a case: what its machine cannot be, or hardly is.

The parts check themselves: a gear its flanks, a disc its inertia, a pair its backlash, and
:mod:`gearwhine.coupling.description.solids` the places of all of them. Here they are made of a case's tables, and each
finding's part and attribute become a key. A finding that is a warning can be accepted by the case, see `Case.unusual`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from gearwhine.case.bearings import (
    Bearing,
    MatrixDamping,
    RadialDamping,
    RadialStiffness,
    RollingStiffness,
    StopStiffness,
)
from gearwhine.case.checks.keys_of_attributes import key_in_gear
from gearwhine.case.errors import UNSAID, Finding, Location, key_of, label_of, look_up, show_value
from gearwhine.case.gears import Gear, GearPair, shaft_of
from gearwhine.case.model import Case
from gearwhine.case.overrides import parse_key_path
from gearwhine.case.speeds_and_torques import pair_torques, rotor_speeds

if TYPE_CHECKING:
    from gearwhine.coupling.description.parts import Shaft, ShaftGear
    from gearwhine.coupling.description.solids import Wall
    from gearwhine.coupling.gears import Gear as BuiltGear
    from gearwhine.coupling.machine.mounted_parts import MountedBearing
    from gearwhine.numerics.findings import Finding as PartFinding
    from gearwhine.rotors.rolling_bearings import RollingBearing


@dataclass(frozen=True)
class PlacedFinding:
    """A finding of the library at its place in a case."""

    location: Location
    expected: str
    warns: bool
    from_value: bool
    """Whether the value at the location is what is at fault, not its relation to others."""

    def as_error(self) -> Finding:
        """Return it as an error of the case."""
        return (
            Finding(self.location, self.expected) if self.from_value else Finding(self.location, self.expected, UNSAID)
        )


def library_findings(case: Case) -> Iterator[PlacedFinding]:
    """Yield what the parts of a case find of themselves and of each other."""
    materials = list(_of_materials(case))
    yield from materials
    if not all(finding.warns for finding in materials):
        return  # nothing can be made of them
    yield from _of_housing(case)
    yield from _of_acoustics(case)
    yield from _of_operation(case)
    if case.gear or case.rotor:
        yield from _of_machine(case)


def overload(case: Case) -> str:
    """Return in a sentence that teeth do not bear the load of an operation; empty where they do."""
    found = (finding for finding in library_findings(case) if finding.location == ("operation", "torque"))
    return next((f"operation.torque: expected {finding.expected}" for finding in found), "")


def case_warnings(case: Case, findings: Iterable[PlacedFinding], document: object) -> list[str]:
    """Return a sentence on each finding that is a warning and that the case does not accept."""
    accepted = [steps for steps in map(parse_key_path, case.unusual) if steps is not None]
    sentences = []
    for finding in findings:
        if not finding.warns or any(_within(finding.location, steps, document) for steps in accepted):
            continue
        key, label = key_of(finding.location), label_of(document, finding.location)
        place = f"{key} ({label})" if label else key
        got = f", got {show_value(look_up(document, finding.location))}" if finding.from_value else ""
        sentences.append(f"{place}: expected {finding.expected}{got}; 'unusual' accepts it")
    return list(dict.fromkeys(sentences))


def _within(location: Location, steps: tuple[str, ...], document: object) -> bool:
    """Whether a location is at a key path or below it; entries of a list go by number, name or `*`."""
    here: object = document
    for step, wanted in zip(location, steps, strict=False):
        here = look_up(here, (step,))
        name = look_up(here, ("name",)) if isinstance(step, int) else step
        if wanted not in ("*", str(step), name):
            return False
    return len(steps) <= len(location)


def _placed(location: Location, finding: PartFinding, attribute: Location | None = None) -> PlacedFinding:
    steps = tuple(int(step) if step.isdecimal() else step for step in finding.attribute.split(".") if step)
    within = steps if attribute is None else attribute
    return PlacedFinding(
        (*location, *within), finding.expected, finding.severity == "warning", finding.value is not None
    )


def _of_materials(case: Case) -> Iterator[PlacedFinding]:
    from gearwhine.numerics.materials import material_findings

    for name, material in case.material.items():
        numbers = material.youngs_modulus, material.poisson_ratio, material.density
        for finding in material_findings(("material", name), *numbers):
            yield _placed(("material", name), finding)


_MOST_DAMPED = 0.1


def _of_housing(case: Case) -> Iterator[PlacedFinding]:
    housing = case.housing
    if housing is None:
        return
    yield from _of_masses(case)
    ratio = housing.damping_ratio
    if isinstance(ratio, float) and ratio > _MOST_DAMPED:
        expected = "at most 0.1: welded, cast and bolted housings have 0.001 to 0.05"
        yield PlacedFinding(("housing", "damping_ratio"), expected, True, True)


def _of_masses(case: Case) -> Iterator[PlacedFinding]:
    """Yield masses that cannot be fastened where they are."""
    from gearwhine.housing.errors import HousingError

    assert case.housing is not None
    for index, mass in enumerate(case.housing.mass):
        try:
            mass.build()
        except HousingError as error:
            for finding in error.findings:
                yield _placed(("housing", "mass", index), finding)


_GASES = (0.05, 20.0)
"""Densities of gases around a housing [kg/m³]: a fluid as heavy as a liquid loads the housing, which is left out."""
_SOUND = (100.0, 1400.0)
"""Speeds of sound in gases [m/s]."""


def _of_acoustics(case: Case) -> Iterator[PlacedFinding]:
    acoustics = case.acoustics
    if acoustics is None:
        return
    if not _GASES[0] <= acoustics.density <= _GASES[1]:
        expected = "a density of 0.05 to 20 kg/m^3, of a gas (air: 1.204): a liquid's mass on the walls is left out"
        yield PlacedFinding(("acoustics", "density"), expected, True, True)
    if not _SOUND[0] <= acoustics.speed_of_sound <= _SOUND[1]:
        expected = "a speed of sound of 100 to 1400 m/s, of a gas (air: 343)"
        yield PlacedFinding(("acoustics", "speed_of_sound"), expected, True, True)
    limit = None if case.housing is None else case.housing.frequency_limit
    highest = acoustics.highest_frequency
    if highest is not None and limit is not None and highest < _LOWEST_SOUND * limit:
        expected = f"a frequency near that of the housing's modes, {limit:g} Hz: nothing above it is heard"
        yield PlacedFinding(("acoustics", "highest_frequency"), expected, True, True)


_LOWEST_SOUND = 0.05
_GRAVITY = (0.1, 30.0)
"""Accelerations of free fall, from small moons to Jupiter [m/s²]."""


def _of_operation(case: Case) -> Iterator[PlacedFinding]:
    operation = case.operation
    if operation is None or operation.gravity is None:
        return
    size = math.hypot(*operation.gravity)
    if size and not _GRAVITY[0] <= size <= _GRAVITY[1]:
        expected = "a free fall of 0.1 to 30 m/s^2 (on earth 9.81)"
        yield PlacedFinding(("operation", "gravity"), expected, True, True)


def _of_machine(case: Case) -> Iterator[PlacedFinding]:
    """Yield findings of gears, pairs, bearings and shafts, and of their places."""
    from gearwhine.coupling.errors import CouplingError
    from gearwhine.coupling.gears.errors import GearError
    from gearwhine.rotors.errors import RotorError

    gears = {gear.name: gear.build(_material(case, gear)) for gear in case.gear}
    places = {gear.name: index for index, gear in enumerate(case.gear)}
    for index, gear in enumerate(case.gear):
        for finding in gears[gear.name].findings:
            if finding.attribute not in ("youngs_modulus", "density", "poisson_ratio") and not (
                finding.attribute == "face_width" and gear.face_width is None
            ):
                yield _placed(("gear", index), finding, key_in_gear(gear, finding.attribute))
    yield from _of_pairs(case, gears)
    for index, bearing in enumerate(case.bearing):
        yield from _of_stiffness(index, bearing)
    if not case.rotor:
        return
    parts = [finding for index in range(len(case.rotor)) for finding in _of_discs(case, index)]
    parts += [finding for index in range(len(case.bearing)) for finding in _of_elements(case, index)]
    yield from parts
    if not all(finding.warns for finding in parts):
        return
    try:
        shafts = [_shaft(case, index) for index in range(len(case.rotor))]
        mounted = [_mounted(case, gear, gears[gear.name]) for gear in case.gear if _has_place(gear)]
        bearings = [_bearing(case, index) for index in range(len(case.bearing))]
    except (CouplingError, GearError, RotorError):
        return  # what cannot be built is refused by the check that builds it, with its own words
    numbers: dict[str, dict[str, int]] = {
        "gear": places,
        "shaft": {rotor.name: index for index, rotor in enumerate(case.rotor)},
        "bearing": {bearing.name: index for index, bearing in enumerate(case.bearing)},
    }
    for finding in _place_findings(case, shafts, mounted, bearings):
        kind, name = finding.part
        if kind == "force":
            yield _placed(("operation",), finding)
            continue
        table = "rotor" if kind == "shaft" else kind
        if name not in numbers[kind]:
            continue  # of a rotor's own file
        location: Location = (table, numbers[kind][name])
        if kind == "bearing" and finding.attribute == "rolling":
            placed = _placed(location, finding, ("stiffness", "rolling"))
            # A rotor of a file may have no journals; one of the case is drawn as it is.
            of_file = case.rotor_named(case.bearing[numbers[kind][name]].rotor).file is not None
            yield replace(placed, warns=placed.warns or of_file)
        elif kind == "shaft" and finding.attribute.startswith("discs") and case.rotor[numbers[kind][name]].file:
            yield _placed(location, finding, ())
        else:
            yield _placed(location, finding)


def _place_findings(
    case: Case, shafts: list[Shaft], gears: list[ShaftGear], bearings: list[MountedBearing]
) -> Iterator[PartFinding]:
    from gearwhine.coupling.description.parts import rotor_with_gears
    from gearwhine.coupling.description.solids import (
        force_findings,
        machine_findings,
        placed_solids,
        unbalance_findings,
        wall_findings,
    )

    meshing = [frozenset((pair.driver, pair.driven)) for pair in case.gear_pair]
    seats = {} if case.housing is None else {seat.name: seat.diameter for seat in case.housing.seat}
    yield from machine_findings(shafts, gears, bearings, meshing, seats)
    for shaft in shafts:
        on_shaft = [mounted for mounted in gears if mounted.shaft == shaft.name]
        tip = max((mounted.gear.tip_radius for mounted in on_shaft), default=0.0)
        yield from unbalance_findings(shaft, rotor_with_gears(shaft.rotor, on_shaft), tip)
    rotors = {shaft.name: shaft.rotor for shaft in shafts}
    for place, force in enumerate(() if case.operation is None else case.operation.force):
        yield from force_findings(force.build(), rotors[force.rotor], place)
    if case.housing is not None and case.housing.box is not None:
        # A rotor on the ground beside a housing may stand anywhere.
        inside = {bearing.rotor for bearing in case.bearing if not bearing.grounded}
        solids = [solid for solid in placed_solids(shafts, gears, bearings) if solid.shaft in inside]
        yield from wall_findings(solids, _walls(case))


def _walls(case: Case) -> list[Wall]:
    """Return the walls of the case's box, the end walls with their seats."""
    from gearwhine.coupling.description.solids import Wall

    assert case.housing is not None
    assert case.housing.box is not None
    box = case.housing.box
    walls, low, high = box.walls, box.lower, box.upper
    bores = {
        side: [
            (seat.center[0], seat.center[1], 0.5 * seat.diameter)
            for seat in case.housing.seat
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


def _of_discs(case: Case, index: int) -> Iterator[PlacedFinding]:
    """Yield discs that no body is."""
    from gearwhine.numerics.materials import material_findings
    from gearwhine.rotors.errors import RotorError

    for place, disc in enumerate(case.rotor[index].discs):
        density = getattr(disc, "density", None)
        for finding in material_findings(("disc", ""), 207e9, 0.3, density) if density is not None else ():
            yield _placed(("rotor", index, "discs", place), finding)
        try:
            disc.build(case.rotor[index], case.material)
        except RotorError as error:
            for finding in error.findings:
                yield _placed(("rotor", index, "discs", place), finding)


def _of_elements(case: Case, index: int) -> Iterator[PlacedFinding]:
    """Yield rolling bearings that cannot be built."""
    from gearwhine.rotors.errors import RotorError

    entry = case.bearing[index]
    if not isinstance(entry.stiffness, RollingStiffness):
        return
    try:
        entry.stiffness.rolling.build(entry.name)
    except RotorError as error:
        expected = f"a bearing that can be built; {error}"
        yield PlacedFinding(("bearing", index, "stiffness", "rolling"), expected, False, False)


def _material(case: Case, gear: Gear) -> Any:
    return case.material_of_gear(gear)


def _has_place(gear: Gear) -> bool:
    """Whether a gear of known width stands on a rotor."""
    return gear.rotor is not None and gear.at is not None and gear.face_width is not None


def _shaft(case: Case, index: int) -> Shaft:
    from gearwhine.coupling.description.parts import Shaft

    rotor = case.rotor[index]
    return Shaft(rotor.build(case.material), rotor.axis, rotor.start, rotor.damping_ratio, rotor.build_unbalance())


def _mounted(case: Case, gear: Gear, built: BuiltGear) -> ShaftGear:
    from gearwhine.coupling.description.parts import ShaftGear

    assert gear.rotor is not None
    assert gear.at is not None
    return ShaftGear(built, gear.rotor, gear.at, gear.given_inertia)


def _bearing(case: Case, index: int) -> MountedBearing:
    """Return a bearing with its elements, or with a stiffness of the directions that it holds."""
    import numpy as np

    from gearwhine.coupling.machine.mounted_parts import MountedBearing
    from gearwhine.rotors import Bearing as BuiltBearing

    entry = case.bearing[index]
    seat = None if entry.grounded else entry.seat
    if isinstance(entry.stiffness, RollingStiffness):
        rolling: RollingBearing = entry.stiffness.rolling.build(entry.name)
        return MountedBearing.from_elements(entry.name, entry.at, entry.rotor, seat, rolling)
    stiffness = np.zeros((2, 2)) if isinstance(entry.stiffness, StopStiffness) else entry.stiffness.build()
    table = stiffness.max(axis=0) if stiffness.ndim == 3 else stiffness
    return MountedBearing(BuiltBearing(entry.name, entry.at, table, np.zeros((2, 2))), entry.rotor, seat)


def _of_pairs(case: Case, gears: dict[str, BuiltGear]) -> Iterator[PlacedFinding]:
    """Yield findings of gear pairs, and of their load and speed in operation."""
    from gearwhine.coupling.gears import GearPairGeometry
    from gearwhine.coupling.gears.loaded.gear_pair import operation_findings

    operation = case.operation
    torques = pair_torques(case) if operation is not None else (0.0,) * len(case.gear_pair)
    speeds = rotor_speeds(case) if operation is not None else {}
    for index, (pair, torque) in enumerate(zip(case.gear_pair, torques, strict=True)):
        geometry = GearPairGeometry(gears[pair.driver], gears[pair.driven], case.centre_distance(pair))
        for finding in _built_pair(pair).findings(geometry):
            attribute = finding.attribute if finding.attribute in type(pair).model_fields else ""
            yield _placed(("gear_pair", index), finding, (attribute,) if attribute else ())
        if any(case.gear_named(name).face_width is None for name in (pair.driver, pair.driven)):
            continue
        speed = speeds.get(shaft_of(case.gear_named(pair.driver)), 0.0)
        for finding in operation_findings(geometry, torque, speed):
            yield _placed(("operation",), finding)


def _built_pair(pair: GearPair) -> Any:
    from gearwhine.coupling.gears.loaded.gear_pair import GearPair as BuiltPair

    angle = pair.misalignment if isinstance(pair.misalignment, float | int) else None
    return BuiltPair(
        pair.driver, pair.driven, damping_ratio=pair.damping_ratio, backlash=pair.backlash, misalignment=angle
    )


def _of_stiffness(index: int, bearing: Bearing) -> Iterator[PlacedFinding]:
    """Yield directions in which a bearing does nothing, and negative direct stiffness, of seals and magnets."""
    stiffness, damping = bearing.stiffness, bearing.damping
    if not isinstance(stiffness, RadialStiffness):
        return
    for key in ("xx", "yy"):
        coefficients = [getattr(stiffness, key)]
        values = [value for one in coefficients for value in (one if isinstance(one, tuple) else (one,))]
        location: Location = ("bearing", index, "stiffness", key)
        damps = isinstance(damping, MatrixDamping) or (
            isinstance(damping, RadialDamping) and getattr(damping, key) != 0.0
        )
        if not any(values) and not damps:
            expected = "a stiffness, or a damping beside it: this bearing does nothing in this direction"
            yield PlacedFinding(location, expected, True, True)
        elif min(values) < 0.0:
            expected = "a stiffness that pushes back; a negative one is of seals and magnetic bearings"
            yield PlacedFinding(location, expected, True, True)
