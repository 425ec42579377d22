"""Checks of a case's machine: shafts, bearings, gears and operation.

- Shafts: stations on their rotors, and rotor axes against bearing seats.
- Bearings: tables over speed that fit and reach far enough, pedestals on the ground.
- Gears: teeth that can be cut, gears that can mesh on their axes, loops that can turn. The geometry is that of
  :mod:`gearwhine.coupling.gears`; its errors are put in the words of the case file.
- Operation: a train in which every shaft turns, balanced torques, a transient that can be run.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from gearwhine.case.bearings import Bearing, RadialDamping, RadialStiffness, operation_loads
from gearwhine.case.checks.keys_of_attributes import key_in_gear, placed
from gearwhine.case.errors import NOTHING, UNSAID, Finding, Location
from gearwhine.case.gears import Gear, GearPair, distance_of_axes, shaft_of, train_of_pairs
from gearwhine.case.housing import Seat
from gearwhine.case.model import Draft
from gearwhine.case.operation import Operation, listed
from gearwhine.case.rotors import HarmonicTorque, Probe, Rotor, RoundDisc, TorsionProbe, TorsionSpring
from gearwhine.numerics.findings import in_mm

if TYPE_CHECKING:
    from gearwhine.coupling.description.gear_train import GearTrain
    from gearwhine.coupling.gears import Gear as BuiltGear


def check_shafts(draft: Draft) -> Iterator[Finding]:
    """Yield stations beyond the ends of their rotor, bow points in one place, and bearings away from their seats."""
    for index, rotor in draft.rotors:
        stations = {
            "discs": [disc.at for disc in rotor.discs],
            "unbalance": [unbalance.at for unbalance in rotor.unbalance],
            "bow": [bow.at for bow in rotor.bow],
        }
        for kind, places in stations.items():
            for place, at in enumerate(places):
                yield from check_station(rotor, at, ("rotor", index, kind, place, "at"))
        for place, disc in enumerate(rotor.discs):
            if isinstance(disc, RoundDisc) and disc.density is None:
                location = ("rotor", index, "discs", place, "material")
                yield from _check_part_material(rotor, disc.material, disc.at, location)
        yield from _check_bow(index, rotor)
    for keys, entries in _analysed(draft):
        for place, entry in enumerate(entries):
            watched = draft.rotor(entry.rotor)
            if watched is not None:
                yield from check_station(watched, entry.at, ("rotor_analysis", *keys, place, "at"))
    for index, bearing in draft.bearings:
        supported = draft.rotor(bearing.rotor)
        if supported is None:
            continue
        yield from check_station(supported, bearing.at, ("bearing", index, "at"))
        seat = next((seat for _, seat in draft.seats if seat.name == bearing.seat), None)
        if seat is not None:
            yield from _check_seat(draft, index, bearing, supported, seat)
    for index, gear in draft.gears:
        carrier = draft.rotor(gear.rotor)
        if carrier is not None and gear.at is not None:
            yield from check_station(carrier, gear.at, ("gear", index, "at"))
            if gear.face_width is not None or gear.given_inertia is None:
                yield from _check_part_material(carrier, gear.material, gear.at, ("gear", index, "material"))


def _analysed(
    draft: Draft,
) -> Iterator[tuple[tuple[str, str], Sequence[Probe | HarmonicTorque | TorsionSpring | TorsionProbe]]]:
    """Yield the entries that analyses of rotors place at stations, with their keys."""
    if draft.analysis is None:
        return
    yield ("unbalance_response", "probes"), draft.analysis.unbalance_response.probes
    torsion = draft.analysis.torsional_response
    if torsion is not None:
        yield ("torsional_response", "torques"), torsion.torques
        yield ("torsional_response", "springs"), torsion.springs
        yield ("torsional_response", "probes"), torsion.probes


def check_station(rotor: Rotor, at: float, location: Location) -> Iterator[Finding]:
    """Yield a finding where a station lies beyond the right end of its rotor."""
    from gearwhine.rotors.model.shaft import station_findings

    findings = station_findings(("", ""), str(location[-1]), at, rotor.name, rotor.length)
    yield from (placed(location[:-1], finding) for finding in findings)


def _check_part_material(rotor: Rotor, own: str | None, at: float, location: Location) -> Iterator[Finding]:
    """Yield a part on a shaft from a file, without a material of its own, where the shaft does not tell one."""
    if rotor.saved is None or own or rotor.material or at > rotor.length:
        return
    if rotor.material_of(None, at, {}) is None:
        expected = (
            f'the name of a material, here or as material of rotor "{rotor.name}": its file has not one that a solid '
            f"can have at {in_mm(at)}"
        )
        yield Finding(location, expected, NOTHING)


def _check_bow(index: int, rotor: Rotor) -> Iterator[Finding]:
    """Yield a bow of one point, which bends nothing, and points of a bow where another one stands already."""
    if rotor.bow:
        from gearwhine.coupling.description.parts import bow_findings

        places = [point.at for point in rotor.bow]
        findings = bow_findings(("shaft", rotor.name), places, rotor.length)
        yield from (placed(("rotor", index), finding) for finding in findings)


def _check_seat(draft: Draft, index: int, bearing: Bearing, rotor: Rotor, seat: Seat) -> Iterator[Finding]:
    """Yield findings where a rotor's axis or a bearing's place along it misses the seat."""
    from gearwhine.coupling.description.arrangement import SeatPlace, seat_findings

    wall = 0.0
    if draft.box is not None:
        wall = draft.box.walls.front if seat.center[2] > 0.0 else draft.box.walls.back
    boss = seat.boss.length if seat.boss is not None else 0.0
    place = SeatPlace(seat.name, seat.center, 0.5 * seat.diameter + wall + boss)
    part = ("bearing", bearing.name)
    for finding in seat_findings(part, rotor.name, rotor.axis, rotor.start, bearing.at, place):
        if finding.attribute != "at" or bearing.at <= rotor.length:  # beyond the rotor is a finding of its own
            yield placed(("bearing", index), finding)


def _check_planets(draft: Draft) -> Iterator[Finding]:
    """Yield planets without a bearing or held, carriers whose own axis turns with another, and supports off a rotor."""
    from gearwhine.coupling.description.arrangement import pin_findings

    held = [entry.get("rotor") for _, entry in draft.raw_entries("bearing")]
    for location, one in draft.held:
        name, at = one.place([gear for _, gear in draft.gears])
        fixed = draft.rotor(name)
        if fixed is None:
            continue
        if fixed.carrier is not None:
            expected = f'sun, ring or carrier; "{fixed.name}" is a planet, whose axis turns with "{fixed.carrier}"'
            yield Finding(location if location[0] == "planetary" else (*location, "member"), expected)
        if one.at is not None:
            yield from check_station(fixed, at, (*location, "at"))
    for index, rotor in draft.rotors:
        pin = None if rotor.pin is None else rotor.pin.diameter or 0.0
        for finding in pin_findings(("rotor", ""), rotor.carrier, rotor.pin_error, pin, rotor.bores):
            yield placed(("rotor", index), finding)
        if rotor.carrier is None:
            continue
        carrier = draft.rotor(rotor.carrier)
        if carrier is not None and carrier.carrier is not None:
            yield Finding(("rotor", index, "carrier"), "a rotor whose own axis stands still")
        if rotor.name not in held:
            expected = (
                f'a [[bearing]] of rotor "{rotor.name}" on its pin, with seat = "{rotor.carrier}" or without a seat'
            )
            yield Finding(("rotor", index), expected, UNSAID)


def check_bearings(draft: Draft) -> Iterator[Finding]:
    """Yield tables that do not fit their speeds or end too early, pedestals in the housing, and loads that lack."""
    yield from _check_planets(draft)
    ratios = _ratios(draft)
    bearings = [bearing for _, bearing in draft.bearings]
    for index, bearing in draft.bearings:
        yield from _check_tables(index, bearing)
        rotor = draft.rotor(bearing.rotor)
        if rotor is not None and rotor.carrier is not None and bearing.seat != rotor.carrier:
            expected = f'"{rotor.carrier}", the carrier with which the axis of "{rotor.name}" turns'
            yield Finding(("bearing", index, "seat"), expected)
        if bearing.pedestal is not None and not bearing.grounded:
            from gearwhine.coupling.description.arrangement import pedestal_finding

            part = ("bearing", bearing.name)
            yield placed(("bearing", index), pedestal_finding(part, bearing.seat, bearing.pedestal))
        if draft.transient is not None and bearing.pedestal is not None and bearing.pedestal.mass == 0.0:
            yield Finding(("bearing", index, "pedestal", "mass"), "a mass above 0, to be followed in time", NOTHING)
        if bearing.speeds is not None and bearing.rotor in ratios:
            yield from _check_reach(draft, index, bearing, bearing.speeds, abs(float(ratios[bearing.rotor])))
        loaded = _operation_loads(draft, bearing, bearings)
        if bearing.rolling is not None and bearing.lacks_load and not bearing.rolling.pressed and not loaded:
            expected = "{ x, y, z }, the force of the shaft on it: a rolling bearing without preload has no stiffness"
            yield Finding(("bearing", index, "load"), expected, NOTHING)


def _operation_loads(draft: Draft, bearing: Bearing, bearings: Sequence[Bearing]) -> bool:
    """Whether the operation loads a bearing; one that cannot be read may."""
    if draft.operation is None:
        return bool(draft.document.get("operation"))
    geared = bool(draft.document.get("gear_pair"))
    return operation_loads(bearing, bearings, draft.operation.loaded_rotors(draft.names("rotor"), geared=geared))


def _check_tables(index: int, bearing: Bearing) -> Iterator[Finding]:
    """Yield lists of another length than the speeds, and speeds or lists without the other."""
    tabled = False
    for kind in ("stiffness", "damping"):
        table = getattr(bearing, kind)
        if not isinstance(table, RadialStiffness | RadialDamping):
            continue
        for key in ("xx", "yy", "xy", "yx"):
            coefficients = getattr(table, key)
            if not isinstance(coefficients, tuple):
                continue
            tabled = True
            if bearing.speeds is None:
                expected = "one value, or with this list the key 'speeds' of the bearing"
                yield Finding(("bearing", index, kind, key), expected)
            elif len(coefficients) != len(bearing.speeds):
                expected = f"one value for each of the {len(bearing.speeds)} speeds (there are {len(coefficients)})"
                yield Finding(("bearing", index, kind, key), expected)
    if bearing.speeds is not None and not tabled:
        yield Finding(("bearing", index, "speeds"), "a list for each of these speeds in 'stiffness' or 'damping'")


def _check_reach(
    draft: Draft, index: int, bearing: Bearing, table: tuple[float, ...], ratio: float
) -> Iterator[Finding]:
    """Yield a table that does not hold every speed that the case names."""
    from gearwhine.coupling.description.arrangement import table_findings_of_speeds

    needed = [ratio * abs(speed) for speed in _named_speeds(draft)]
    part = ("bearing", bearing.name)
    findings = table_findings_of_speeds(part, bearing.rotor, table, needed)
    yield from (placed(("bearing", index), finding) for finding in findings)


def _named_speeds(draft: Draft) -> list[float]:
    """Return the speeds of the first driver's rotor that a case names."""
    speeds = [] if draft.operation is None else [draft.operation.speed]
    if draft.transient is not None and draft.transient.run is not None:
        speeds += draft.transient.run.line[1]
    speeds += draft.sweep.speeds if draft.sweep is not None else ()
    if draft.analysis is not None:
        for range_or_list in (draft.analysis.speed, draft.analysis.unbalance_response.speed):
            speeds += () if range_or_list is None else listed(range_or_list)
    return speeds


def _ratios(draft: Draft) -> dict[str, Fraction]:
    """Return each rotor's speed over the first driver's; empty where the train is not readable."""
    if draft.broken & {"rotor", "gear", "gear_pair"}:
        return {}
    if not draft.gear_pairs:
        return {name: Fraction(1) for name in draft.names("rotor")}
    return dict(draft.train.ratios) if draft.train is not None else {}


def check_gears(draft: Draft) -> Iterator[Finding]:
    """Yield gears that cannot be cut, pairs that cannot mesh, and loops that lock."""
    if not draft.gears:
        return
    # The package brings numpy and scipy: only a case with gears waits for them.
    from gearwhine.coupling.gears import GearError

    built: dict[str, BuiltGear] = {}
    for index, gear in draft.gears:
        try:
            built.setdefault(gear.name, gear.build())
        except GearError as error:
            for finding in error.findings:
                yield Finding(("gear", index, *key_in_gear(gear, finding.attribute)), finding.expected)
            if not error.findings:
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
        aside = list(_off_carrier(draft, driver, driven))
        yield from aside
        if not unequal and not aside and driver.name in built and driven.name in built:
            yield from _check_pair(draft, index, pair, (driver, driven), (built[driver.name], built[driven.name]))
    train = draft.train
    # Of a rotor that cannot be read it is not known whether it is a planet.
    complete = len(draft.rotors) == len(list(draft.raw_entries("rotor")))
    for wrong in train.contradictions if train is not None and complete else ():
        if wrong.pair is None:
            continue
        index, *gears = draft.readable_pairs[wrong.pair]
        expected = (
            f'pairs in a loop that can turn; "{wrong.shaft}" would turn at {float(wrong.ratio):.6g} of the first '
            f"driver's speed by the other pairs, and at {float(wrong.other):.6g} by this one"
        )
        if train is not None and train.held:
            label = " -> ".join(gear.name for gear in gears)
            expected = f"members that are not held or driven against each other; {train.sentence(wrong, label)}"
        yield Finding(("gear_pair", index), expected, UNSAID)


def _off_carrier(draft: Draft, driver: Gear, driven: Gear) -> Iterator[Finding]:
    """Yield a sun or ring on another axis than that about which its planets turn."""
    from gearwhine.coupling.description.gear_train import LARGEST_OFFSET

    rotors = draft.rotor(driver.rotor), draft.rotor(driven.rotor)
    for one, other in (rotors, rotors[::-1]):
        carrier = None if other is None else draft.rotor(other.carrier)
        if one is None or carrier is None or one.carrier is not None:
            continue
        apart = distance_of_axes(one.axis, carrier.axis)
        if apart > LARGEST_OFFSET:
            index = next(index for index, rotor in draft.rotors if rotor is one)
            expected = (
                f'the axis of carrier "{carrier.name}", about which its planets turn; it is {in_mm(apart)} off it'
            )
            yield Finding(("rotor", index, "axis"), expected)


def _ring_around(draft: Draft, gears: tuple[Gear, Gear]) -> str:
    """Return how many teeth a ring around a sun and this planet has; empty for other gears."""
    for _, one in draft.planetary:
        sun, names = draft.gear(one.sun or ""), {gear.name for gear in gears}
        planet = next((gear for gear in gears if gear.name in one.planets), None)
        if sun is None or planet is None or one.ring not in names:
            continue
        meshes = [{pair.driver, pair.driven} for _, pair in draft.gear_pairs]
        if {sun.name, planet.name} in meshes:
            around = sun.teeth + 2 * planet.teeth
            return (
                f"; sun and planets stand in a ring of {around} teeth, or as few more or less as profile shifts take up"
            )
    return ""


def _check_pair(
    draft: Draft, index: int, pair: GearPair, tables: tuple[Gear, Gear], gears: tuple[BuiltGear, BuiltGear]
) -> Iterator[Finding]:
    """Yield why two gears do not mesh, at any distance or at that of their axes, or are not opposite each other."""
    from gearwhine.coupling.description.gear_train import LARGEST_OFFSET, geometry_on_axes, plane_findings
    from gearwhine.coupling.gears import GearError, GearPairGeometry
    from gearwhine.coupling.gears.errors import StiffnessModelError
    from gearwhine.coupling.gears.geometry.pair import signed_distance
    from gearwhine.coupling.gears.stiffness.models import require_model_fit

    try:
        require_model_fit(pair.stiffness.model, GearPairGeometry(*gears))
    except StiffnessModelError as error:
        location = ("gear_pair", index, "stiffness", "model")
        yield Finding(location, f"a model that covers these gears; {error}", pair.stiffness.model)
    except GearError as error:
        # The error is not one of the distance, which is that without backlash.
        yield Finding(("gear_pair", index), f"gears that can mesh; {error}", UNSAID)
        return
    distance = pair.centre_distance
    if tables[0].rotor is not None and shaft_of(tables[0]) == shaft_of(tables[1]):
        yield Finding(("gear_pair", index, "driven"), f'a gear on another rotor than "{shaft_of(tables[0])}"')
        return
    rotors = draft.rotor(tables[0].rotor), draft.rotor(tables[1].rotor)
    if rotors[0] is not None and rotors[1] is not None:
        apart = distance_of_axes(rotors[0].axis, rotors[1].axis)
        if distance is not None and abs(distance - apart) > LARGEST_OFFSET:
            expected = f"the distance of the rotors' axes, {in_mm(apart)}"
            yield Finding(("gear_pair", index, "centre_distance"), expected)
        places = [rotor.start + (table.at or 0.0) for rotor, table in zip(rotors, tables, strict=True) if rotor]
        for finding in plane_findings(("gear pair", ""), places, gears):
            yield Finding(("gear_pair", index, finding.attribute), finding.expected)
    try:
        if rotors[0] is not None and rotors[1] is not None:
            geometry_on_axes(*gears, (rotors[0].name, rotors[1].name), (rotors[0].axis, rotors[1].axis))
        elif distance is not None:
            GearPairGeometry(*gears, signed_distance(*gears, distance))
    except GearError as error:
        around = _ring_around(draft, tables)
        yield Finding(("gear_pair", index), f"a centre distance that fits; {error}{around}", UNSAID)


def _unequal_teeth(index: int, driver: Gear, driven: Gear) -> Iterator[Finding]:
    """Yield a size in which the teeth of two gears do not fit each other."""
    from gearwhine.coupling.gears.geometry.pair import mismatched_sizes

    modules, pressures, helices = (
        (driver.tooth_module, driven.tooth_module),
        (math.degrees(driver.pressure_angle), math.degrees(driven.pressure_angle)),
        (math.degrees(driver.helix_angle), math.degrees(driven.helix_angle)),
    )
    sizes = ((gear.tooth_module, gear.pressure_angle, gear.helix_angle) for gear in (driver, driven))
    internal = driver.teeth < 0 or driven.teeth < 0
    unequal = mismatched_sizes(*sizes, internal=internal)
    if "helix_angle" in unequal:
        hands = "one hand with an internal gear" if internal else "opposite hands"
        size, values = f"equal helix angle and {hands}", [f"{angle:+g} deg" for angle in helices]
    elif "pressure_angle" in unequal:
        size, values = "one pressure angle", [f"{angle:g} deg" for angle in pressures]
    elif "module" in unequal:
        size, values = "one module", [in_mm(module) for module in modules]
    else:
        return
    expected = f'gears of {size}; "{driver.name}" has {values[0]}, "{driven.name}" {values[1]}'
    yield Finding(("gear_pair", index, "driven"), expected, UNSAID)


def _check_model(draft: Draft, index: int, pair: GearPair, gear: Gear) -> Iterator[Finding]:
    """Yield data that the pair's stiffness model needs of a gear that lacks them."""
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


LARGEST_RATIO = 1e12
"""Speed over the first driver's beyond which a train is a mistake, long before numbers overflow."""


def check_running(draft: Draft) -> Iterator[Finding]:
    """Yield findings that keep a case from running as it is given."""
    document, operation = draft.document, draft.operation
    if all(document.get(key, []) == [] for key in ("housing", "rotor", "gear", "gear_pair")):
        yield Finding((), "at least one of [housing], [[rotor]] and [[gear_pair]]", UNSAID)
    if "transient" in document and "operation" not in document:
        yield Finding(("operation",), "a speed to run the [transient] at", NOTHING)
    if "rotor_analysis" in document and not document.get("rotor"):
        yield Finding(("rotor",), "at least one [[rotor]] for the [rotor_analysis]", NOTHING)
    if operation is None:
        return
    turning = any(key in document for key in ("rotor", "gear"))
    if not turning:
        yield Finding(("operation",), "a [[rotor]] or [[gear]] to turn", NOTHING)
    if "transient" in document and operation.speed == 0.0:
        yield Finding(("operation", "speed"), "a speed other than zero for the [transient]")
    yield from _check_run(draft, operation)
    yield from _check_method(draft, operation)
    if draft.broken & {"rotor", "gear", "gear_pair", "planetary", "torque_support"} or not turning:
        return  # an incomplete train does not define the shafts that it turns
    yield from _check_stations(draft, operation)
    yield from _check_train(draft, operation)


def _check_run(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield a run on a base that tilts, or free without a motor or an output, and torque lines that none follows."""
    run = None if draft.transient is None else draft.transient.run
    if run is not None and operation.base is not None and operation.base.tilts:
        expected = "no turning about x or y during a [transient.run]: gyroscopic moments of a base are for one speed"
        yield Finding(("operation", "base"), expected, UNSAID)
    if run is not None and run.free:
        if operation.motor is None:
            yield Finding(("operation", "motor"), "a torque over speed, which drives the free [transient.run]", NOTHING)
        if not draft.gear_pairs and not operation.output:
            yield Finding(("operation", "output"), "an output, on the rotor that the free run drives", NOTHING)
    elif draft.transient is not None:
        for key in ("motor", "load"):
            if getattr(operation, key) is not None:
                expected = (
                    "a [transient.run] without 'to', whose speed is free to follow it; at a given speed --set "
                    f"operation.{key}= leaves it out"
                )
                yield Finding(("operation", key), expected)


def _check_method(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield parts of the case that exact integration, where it is asked for, does not cover."""
    transient = draft.transient
    if transient is None or transient.method != "exact":
        return
    unknown = [f"friction between the teeth (gear_pair[{i}])" for i, pair in draft.gear_pairs if pair.friction > 0.0]
    unknown += [f"a bearing's own law (bearing[{i}])" for i, bearing in draft.bearings if bearing.follows_own_law]
    unknown += ["a speed that varies (transient.run)"] * (transient.run is not None)
    torques = [operation.over_time, *(output.over_time for output in operation.output)]
    unknown += ["a torque given over time"] * any(torque is not None for torque in torques)
    if unknown:
        yield Finding(("transient", "method"), f"'newmark' or 'auto'; exact integration does not cover {unknown[0]}")


def _check_stations(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield torques and forces beyond the end of their rotor."""
    for place, force in enumerate(operation.force):
        rotor = draft.rotor(force.rotor)
        if rotor is not None:
            yield from check_station(rotor, force.at, ("operation", "force", place, "at"))
    for place, output in enumerate(operation.output):
        rotor = draft.rotor(output.rotor)
        if rotor is not None and output.at is not None:
            yield from check_station(rotor, output.at, ("operation", "output", place, "at"))


def _check_train(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield shafts that nothing turns, and outputs that do not balance the input."""
    shafts = draft.names("rotor") or draft.names("gear")
    train = draft.train
    if any(shaft_of(gear) not in shafts for _, gear in draft.gears) or any(
        draft.gear(name) is None for _, pair in draft.gear_pairs for name in (pair.driver, pair.driven)
    ):
        return  # names that lead nowhere are findings of their own
    ratios = dict.fromkeys(shafts, Fraction(1))
    if draft.gear_pairs:
        ratios = {} if train is None else dict(train.ratios)
    first = next(iter(ratios), None)
    yield from _check_drives(operation, train)
    for index, shaft in enumerate(shafts):
        if shaft not in ratios and not (train is not None and shaft in train.open_shafts):
            kind = "rotor" if draft.rotors else "gear"
            expected = f'a gear pair that turns it: no pair leads here from "{first}", the first driver'
            yield Finding((kind, index, "name"), expected)
    if any(ratio and not 1.0 / LARGEST_RATIO <= abs(ratio) <= LARGEST_RATIO for ratio in ratios.values()):
        expected = f"pairs that gear no shaft up or down more than {LARGEST_RATIO:g} times in all"
        yield Finding(("gear_pair",), expected, UNSAID)
        return
    if train is not None and not train.turns:
        return
    rotor = draft.rotor(first) if draft.gear_pairs else None
    if rotor is not None and operation.at is not None:
        yield from check_station(rotor, operation.at, ("operation", "at"))
    if draft.gear_pairs and first is not None:
        from gearwhine.coupling.description.arrangement import output_elsewhere

        for place, output in enumerate(operation.output):
            if output.rotor == first:
                yield Finding(("operation", "output", place, "rotor"), output_elsewhere(first))
    if any(output.rotor not in ratios for output in operation.output):
        return
    for place, output in enumerate(operation.output):
        if not ratios[output.rotor] or (train is not None and output.rotor in train.planets):
            yield Finding(("operation", "output", place, "rotor"), "a rotor that turns about an axis of its own")
            return
    if _lacks_input(operation):
        expected = (
            "the torque that drives the outputs; where they drive each other, list first a gear_pair whose driver is "
            "on the rotor that gives the power"
        )
        yield Finding(("operation", "torque"), expected)
        return
    if not draft.gear_pairs and len(shafts) > 1:
        yield from _check_each_shaft(draft, operation)
        return
    if train is not None and train.pairs and operation.torque and not operation.output and not train.output_shafts:
        expected = "an output where the torque leaves, as each shaft takes it in, drives one, is held or is a planet"
        yield Finding(("operation", "output"), expected, NOTHING)
        return
    imbalances = list(_check_balance(operation, train or train_of_pairs((), shafts))) if operation.output else []
    yield from imbalances
    if train is not None and not imbalances and all(shaft in ratios for shaft in shafts):
        yield from _check_flow(draft, operation, train)


def _check_drives(operation: Operation, train: GearTrain | None) -> Iterator[Finding]:
    """Yield why the drives of a train do not give the speeds of its shafts, or contradict each other."""
    for place, drive in enumerate(operation.drive):
        if operation.speed == 0.0:
            expected = "no further drive of a case whose first driver stands still: its speed is taken over that one's"
            yield Finding(("operation", "drive", place), expected, UNSAID)
        wrong = next((one for one in train.contradictions if one.shaft == drive.rotor), None) if train else None
        if train is not None and wrong is not None and wrong.pair is None:
            yield Finding(("operation", "drive", place, "rotor"), f"a rotor that is free; {train.sentence(wrong, '')}")
    if train is not None:
        for sentence in train.drive_problems():
            location = (
                ("operation", "rotor") if not train.open_shafts else ("planetary" if train.planets else "gear_pair",)
            )
            yield Finding(location, f"drives that fix every speed; {sentence}", UNSAID)


def _lacks_input(operation: Operation) -> bool:
    """Whether outputs have torques and the input has none."""
    from gearwhine.coupling.description.gear_train import lacks_input

    return lacks_input(operation.torque, [output.build() for output in operation.output])


def _check_balance(operation: Operation, train: GearTrain) -> Iterator[Finding]:
    """Yield outputs that, through the gears, take another power than the input."""
    from gearwhine.coupling.description.gear_train import is_balanced, output_torque

    delivered = output_torque(train, [output.build() for output in operation.output])
    if not is_balanced(operation.torque, delivered):
        expected = (
            f"outputs that balance the input torque of {operation.torque:g} N*m; through the tooth ratios they "
            f"amount to {delivered:g} N*m"
        )
        yield Finding(("operation", "output"), expected, [f"{output.torque:g} N*m" for output in operation.output])


def _check_each_shaft(draft: Draft, operation: Operation) -> Iterator[Finding]:
    """Yield shafts, none geared to another, whose own torques do not balance; the first output's takes the input."""
    if not operation.output:
        return
    from gearwhine.coupling.description.gear_train import imbalances_of_shafts

    kind = "rotor" if draft.rotors else "gear"
    for imbalance in imbalances_of_shafts(operation.torque, [output.build() for output in operation.output]):
        expected = (
            f'torques that balance on {kind} "{imbalance.shaft}", as no gear pair leads to or from it; it takes in '
            f"{imbalance.entering:g} N*m and gives out {imbalance.leaving:g} N*m"
        )
        yield Finding(("operation", "output", imbalance.output), expected, UNSAID)


def _check_flow(draft: Draft, operation: Operation, train: GearTrain) -> Iterator[Finding]:
    """Yield gear pairs whose driven gear drives the driver, and braked ones whose back flanks never meet."""
    from gearwhine.coupling.description.arrangement import BACKLASH_OF_A_BRAKE, POWER_FROM_THE_DRIVER
    from gearwhine.coupling.description.gear_train import carrying_flanks

    names = draft.names("gear")
    if operation.torque == 0.0 or len(set(names)) < len(names):
        return
    # Where torques act along their shafts does not count here.
    torques = train.mean_pair_torques(operation.applied_torques(train, {}), operation.speed)
    flanks = carrying_flanks(torques, operation.torque)
    for (index, pair), flank in zip(draft.gear_pairs, flanks, strict=True):
        if flank == "reversed":
            yield Finding(("gear_pair", index), POWER_FROM_THE_DRIVER, UNSAID)
        elif flank == "back" and pair.backlash is None and not _has_designed_backlash(draft, pair):
            yield Finding(("gear_pair", index, "backlash"), BACKLASH_OF_A_BRAKE, NOTHING)


def _has_designed_backlash(draft: Draft, pair: GearPair) -> bool:
    """Whether tooth thicknesses and centre distance leave a backlash; gears that do not mesh are other findings."""
    from gearwhine.coupling.gears import GearError, GearPairGeometry
    from gearwhine.coupling.gears.geometry.pair import signed_distance

    driver, driven = draft.gear(pair.driver), draft.gear(pair.driven)
    if driver is None or driven is None:
        return True
    rotors = draft.rotor(driver.rotor), draft.rotor(driven.rotor)
    distance = pair.centre_distance
    if rotors[0] is not None and rotors[1] is not None:
        distance = distance_of_axes(rotors[0].axis, rotors[1].axis)
    try:
        gears = driver.build(), driven.build()
        signed = None if distance is None else signed_distance(*gears, distance)
        geometry = GearPairGeometry(*gears, signed)
    except GearError:
        return True
    return geometry.designed_backlash is not None
