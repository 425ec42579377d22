"""Checks across the tables of a case: provenance; all checks of a case in turn, its warnings.

`[provenance]` gives the origin of numbers: published, nominal or found.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from gearwhine.case.bearings import Bearing
from gearwhine.case.checks.acoustics import check_acoustics
from gearwhine.case.checks.housing import check_box, check_housing_form
from gearwhine.case.checks.machine import check_bearings, check_gears, check_running, check_shafts
from gearwhine.case.checks.measured import check_measured
from gearwhine.case.checks.names import check_names, names_by_case
from gearwhine.case.checks.plausible import case_warnings, library_findings
from gearwhine.case.errors import Finding, Location
from gearwhine.case.model import Case, Draft, case_document
from gearwhine.case.overrides import parse_key_path, place_in_list
from gearwhine.case.planetary import held_members

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
    warnings += names_by_case(document)
    if any(bearing.rolling is not None for bearing in case.bearing):
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
