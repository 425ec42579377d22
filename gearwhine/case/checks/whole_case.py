"""Checks across the tables of a case: names and provenance; all checks of a case in turn, its warnings.

A name belongs to one entry, and a reference finds its entry. Names are read from the document itself, so an entry in
which something else is wrong still counts. `[provenance]` gives the origin of numbers: published, nominal or found.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

from gearwhine.case.bearings import Bearing, RollingStiffness
from gearwhine.case.checks.acoustics import check_acoustics
from gearwhine.case.checks.housing import check_box, check_housing_form
from gearwhine.case.checks.machine import check_bearings, check_gears, check_running, check_shafts
from gearwhine.case.checks.measured import check_measured
from gearwhine.case.checks.plausible import case_warnings, library_findings
from gearwhine.case.errors import NOTHING, UNSAID, Finding, Location, key_of, look_up, show_value
from gearwhine.case.model import Case, Draft, case_document
from gearwhine.case.overrides import parse_key_path, place_in_list
from gearwhine.case.planetary import held_members
from gearwhine.numerics.names import did_you_mean, twin_of

_PROBES = ("rotor_analysis", "unbalance_response", "probes")
_TORSION = ("rotor_analysis", "torsional_response")
_TORSION_PROBES = (*_TORSION, "probes")
_KEYS_OF_NAMED_PARTS = (
    ("rotor",),
    ("bearing",),
    ("gear",),
    ("planetary",),
    ("housing", "seat"),
    ("housing", "support"),
    ("housing", "mount"),
    ("housing", "joint"),
    ("housing", "mass"),
    ("housing", "sensor"),
    ("housing", "region"),
    ("acoustics", "microphone"),
    _PROBES,
    _TORSION_PROBES,
)


def check_names(draft: Draft) -> Iterator[Finding]:
    """Yield duplicate names, names that are taken and names that lead nowhere."""
    yield from _check_unique(draft)
    yield from _check_materials(draft)
    rotors, gears, seats = draft.names("rotor"), draft.names("gear"), draft.names("housing", "seat")
    for index, rotor in draft.raw_entries("rotor"):
        if rotor.get("name") == "housing":
            yield Finding(("rotor", index, "name"), "another name than 'housing', which stands for the housing itself")
        yield from _check_reference(rotor, ("rotor", index, "carrier"), "rotor", rotors)
    for index, one in draft.raw_entries("planetary"):
        for key, kind, names in (("carrier", "rotor", rotors), ("sun", "gear", gears), ("ring", "gear", gears)):
            yield from _check_reference(one, ("planetary", index, key), kind, names)
        planets = one.get("planets")
        for place, name in enumerate(planets if isinstance(planets, (list, tuple)) else ()):
            yield from _check_reference({place: name}, ("planetary", index, "planets", place), "gear", gears)
        fixed = one.get("fixed")
        if isinstance(fixed, Mapping):
            at = ("planetary", index, "fixed")
            yield from _check_reference(fixed, (*at, "member"), "gear or rotor", (*gears, *rotors))
            yield from _check_reference(fixed, (*at, "seat"), "seat", seats)
        else:
            yield from _check_reference(one, ("planetary", index, "fixed"), "gear or rotor", (*gears, *rotors))
    for index, one in draft.raw_entries("torque_support"):
        yield from _check_reference(one, ("torque_support", index, "member"), "gear or rotor", (*gears, *rotors))
        yield from _check_reference(one, ("torque_support", index, "seat"), "seat", seats)
    for index, bearing in draft.raw_entries("bearing"):
        yield from _check_reference(bearing, ("bearing", index, "rotor"), "rotor", rotors)
        yield from _check_reference(bearing, ("bearing", index, "seat"), "seat", (*seats, "ground", *rotors))
    for index, gear in draft.raw_entries("gear"):
        yield from _check_reference(gear, ("gear", index, "rotor"), "rotor", rotors)
        if rotors and "rotor" not in gear:
            yield Finding(("gear", index, "rotor"), _one_of("rotor", rotors), NOTHING)
    for index, pair in draft.raw_entries("gear_pair"):
        for key in ("driver", "driven"):
            yield from _check_reference(pair, ("gear_pair", index, key), "gear", gears)
        sensors = draft.names("housing", "sensor")
        yield from _check_reference(
            pair.get("relief_aim"), ("gear_pair", index, "relief_aim", "sensor"), "sensor", sensors
        )
    for keys in (_PROBES, _TORSION_PROBES, (*_TORSION, "torques"), (*_TORSION, "springs")):
        for index, entry in draft.raw_entries(*keys):
            yield from _check_reference(entry, (*keys, index, "rotor"), "rotor", rotors)
    for index, output in draft.raw_entries("operation", "output"):
        shafts = rotors or gears
        yield from _check_reference(output, ("operation", "output", index, "rotor"), "rotor", shafts)
    yield from _check_reference(draft.document.get("operation"), ("operation", "rotor"), "rotor", rotors)
    for index, drive in draft.raw_entries("operation", "drive"):
        yield from _check_reference(drive, ("operation", "drive", index, "rotor"), "rotor", rotors)
    for index, force in draft.raw_entries("operation", "force"):
        yield from _check_reference(force, ("operation", "force", index, "rotor"), "rotor", rotors)


def _check_materials(draft: Draft) -> Iterator[Finding]:
    """Yield materials that are referred to but missing, and those that a solid cannot have."""
    table = draft.document.get("material")
    materials = [name for name in table if isinstance(name, str)] if isinstance(table, Mapping) else []
    housing = draft.document.get("housing")
    if isinstance(housing, Mapping):
        yield from _check_reference(housing, ("housing", "material"), "material", materials)
    for index, region in draft.raw_entries("housing", "region"):
        yield from _check_reference(region, ("housing", "region", index, "material"), "material", materials)
    bolts = ("box", "cover", "bolts")
    yield from _check_reference(look_up(housing, bolts), ("housing", *bolts, "material"), "material", materials)
    for kind in ("rotor", "gear"):
        for index, entry in draft.raw_entries(kind):
            yield from _check_reference(entry, (kind, index, "material"), "material", materials)
            yield from _check_reference(entry.get("pin"), (kind, index, "pin", "material"), "material", materials)
            for part in ("segments", "discs"):
                pieces = entry.get(part)
                for place, piece in enumerate(pieces if isinstance(pieces, (list, tuple)) else ()):
                    yield from _check_reference(piece, (kind, index, part, place, "material"), "material", materials)


def _check_reference(entry: object, location: Location, kind: str, names: Iterable[str]) -> Iterator[Finding]:
    """Yield a finding where the name at the end of a location is not among the names there are."""
    name = look_up(entry, location[-1:])
    if isinstance(name, str) and name not in (names := tuple(names)):
        twin = f"; {kind} names look like it: {_CHARACTERS}" if twin_of(name, names) else did_you_mean(name, names)
        yield Finding(location, _one_of(kind, names) + twin)


def _one_of(kind: str, names: Iterable[str]) -> str:
    listed = ", ".join(show_value(name) for name in list(names)[:20])
    return f"the name of a {kind} of this case ({listed or 'there is none'})"


def _check_unique(draft: Draft) -> Iterator[Finding]:
    """Yield the second and later uses of a name among entries of one kind, and names that look like another one."""
    for keys in _KEYS_OF_NAMED_PARTS:
        first: dict[str, int] = {}
        for index, entry in draft.raw_entries(*keys):
            name = entry.get("name")
            if not isinstance(name, str):
                continue
            twin = twin_of(name, first)
            if first.setdefault(name, index) != index:
                first_use = key_of((*keys, first[name]))
                yield Finding((*keys, index, "name"), f"a name of its own ({first_use} has this one)")
            elif twin is not None:
                first_use = key_of((*keys, first[twin]))
                yield Finding(
                    (*keys, index, "name"), f"a name that does not look like that of {first_use}: {_CHARACTERS}"
                )
    table = draft.document.get("material")
    materials = [name for name in table if isinstance(name, str)] if isinstance(table, Mapping) else []
    for place, name in enumerate(materials):
        twin = twin_of(name, materials[:place])
        if twin is not None:
            yield Finding(
                ("material", name), f"a name that does not look like that of another one: {_CHARACTERS}", UNSAID
            )


_CHARACTERS = "both are written with other characters, such as Cyrillic letters or accents apart from theirs"


def _names_by_case(document: Mapping[str, Any]) -> Iterator[str]:
    """Yield a sentence on names of one kind that differ in capitals alone."""
    for keys in (*_KEYS_OF_NAMED_PARTS, ("material",)):
        entries = look_up(document, keys)
        if isinstance(entries, list):
            entries = [entry["name"] for entry in entries if "name" in entry]
        names: list[str] = list(entries) if isinstance(entries, (list, Mapping)) else []
        for place, name in enumerate(names):
            alike = (other for other in names[:place] if other != name and other.casefold() == name.casefold())
            if (twin := next(alike, None)) is not None:
                yield f'{".".join(keys)}: the names "{twin}" and "{name}" differ in capitals alone'


ORIGINS = ("published", "nominal", "found")
"""Where a number may come from."""


def check_provenance(draft: Draft) -> Iterator[Finding]:
    """Yield entries that name no origin, and keys that are not in the case."""
    table = draft.document.get("provenance")
    for key, value in table.items() if isinstance(table, Mapping) else ():
        location = ("provenance", key)
        if isinstance(value, str) and value.partition(":")[0].strip() not in ORIGINS:
            yield Finding(location, "'published', 'nominal' or 'found', with text after a colon if wanted")
        steps = parse_key_path(key) if isinstance(key, str) else None
        if steps is None or not _values_at(draft.document, steps):
            yield Finding(location, "as a key the path of something in this case ('*' stands for any entry)")


def without_changed(
    document: dict[str, Any], before: Mapping[str, Any], changed: Collection[Location]
) -> dict[str, Any]:
    """Return a document without the provenance of values that overrides change or remove.

    A number from the command line is not the published one. Entries that an override itself sets stay.

    Parameters
    ----------
    document, before : mapping
        The case with and without the overrides.
    changed : collection of locations
        Locations that the overrides set.
    """
    table = document.get("provenance")
    if not isinstance(table, dict) or ("provenance",) in changed:
        return document
    unchanged = {}
    for key, value in table.items():
        steps = parse_key_path(key)
        if steps is None or ("provenance", key) in changed or _values_at(document, steps) == _values_at(before, steps):
            unchanged[key] = value
    return {**document, "provenance": unchanged}


def _values_at(document: object, steps: tuple[str, ...]) -> list[object]:
    """Return everything that a key path, with wildcards, leads to."""
    level = [document]
    for step in steps:
        level = [inner for outer in level for inner in _inside(outer, step)]
    return level


def _inside(outer: object, step: str) -> list[object]:
    """Return what one step leads to from a table or list."""
    if isinstance(outer, Mapping):
        return list(outer.values()) if step == "*" else [outer[step]] if step in outer else []
    if isinstance(outer, (list, tuple)):
        place = None if step == "*" else place_in_list(list(outer), step)
        return list(outer) if step == "*" else [outer[place]] if place is not None else []
    return []


def check(draft: Draft) -> Iterator[Finding]:
    """Yield all findings across the readable tables of a case."""
    yield from check_names(draft)
    yield from check_housing_form(draft)
    yield from check_box(draft)
    yield from check_shafts(draft)
    yield from check_bearings(draft)
    yield from check_gears(draft)
    yield from check_running(draft)
    yield from check_acoustics(draft)
    yield from check_measured(draft)
    yield from check_provenance(draft)


def warnings_of(case: Case) -> tuple[str, ...]:
    """Return a sentence on each choice in a valid case that is allowed but implausible."""
    warnings = []
    housing = case.housing
    either = housing or case.reduced_housing
    if either is not None and case.transient is not None and not either.sensor:
        warnings.append("[housing] has no [[housing.sensor]]: the transient will show no acceleration of the housing")
    if either is not None and case.rotor and all(bearing.grounded for bearing in case.bearing):
        warnings.append("no bearing stands in a seat of [housing]: rotors and housing do not feel each other")
    if housing is not None and not housing.support and not housing.mount:
        warnings.append("[housing] has no [[housing.support]] and no [[housing.mount]]: it floats freely")
    elif housing is not None and not (any(s.holds for s in housing.support) or any(m.holds for m in housing.mount)):
        warnings.append("[housing] stands on dashpots alone: it is not held and creeps away under load")
    if case.operation is not None and case.operation.torque > 0.0 and not case.gear_pair and not case.operation.output:
        warnings.append("operation.torque has nothing to work against: there are no gear pairs and no outputs")
    for bearing in case.bearing:
        if bearing.pedestal is not None and bearing.pedestal.mass == 0.0:
            warnings.append(f'bearing "{bearing.name}": its pedestal has no mass: `rotors` alone takes it')
    held = held_members(case.planetary, case.torque_support)
    on_bolts = {one.place(case.gear)[0] for one in held if one.bolts is not None}
    for rotor in case.rotor:
        coefficients = [rotor.shear_coefficient, *(getattr(part, "shear_coefficient", None) for part in rotor.segments)]
        above = [value for value in coefficients if isinstance(value, float) and value > 1.0]
        if above:
            stated = f"a shear coefficient of {above[0]:g}, above 1"
            warnings.append(
                f'rotor "{rotor.name}": {stated}: round sections have 0.5 to 0.93; is its reciprocal meant?'
            )
        if rotor.saved is not None:
            warnings += [f'rotor "{rotor.name}": {remark}' for remark in rotor.saved.warnings]
        is_held = rotor.name in on_bolts or (rotor.saved is not None and bool(rotor.saved.bearings))
        if not is_held and not any(bearing.rotor == rotor.name for bearing in case.bearing):
            warnings.append(f'rotor "{rotor.name}" has no [[bearing]]: it floats freely')
    if either is not None:
        warnings += _seat_warnings(case.bearing)
    if case.reduced_housing is not None:
        warnings += [
            f"[{table}] has no effect: [housing.reduced] has no shapes, so that there is no {purpose}"
            for table, purpose in (("acoustics", "sound"), ("update", "fit"))
            if getattr(case, table) is not None
        ]
    document = case_document(case)
    warnings += _names_by_case(document)
    if any(isinstance(bearing.stiffness, RollingStiffness) for bearing in case.bearing):
        warnings += [text for location in case.parts.axial_locations for text in location.warnings]
    warnings += case_warnings(case.unusual, library_findings(case), document)
    return tuple(warnings)


def _seat_warnings(bearings: Sequence[Bearing]) -> list[str]:
    """Return a sentence on bearings without a `seat` beside others that stand in the housing."""
    loose = [bearing.name for bearing in bearings if "seat" not in bearing.model_fields_set]
    if not loose or all(bearing.grounded for bearing in bearings):
        return []
    names = ", ".join(f'"{name}"' for name in loose)
    verb = "has no 'seat': it stands" if len(loose) == 1 else "have no 'seat': they stand"
    return [
        f"bearing{'s' * (len(loose) > 1)} {names} {verb} on the ground, not in [housing]; give the name of a "
        '[[housing.seat]], or seat = "ground" where that is meant'
    ]
