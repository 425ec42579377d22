"""Names of a case: each belongs to one entry, and a reference finds its entry.

Keys that refer to an entry say so where they are declared (:class:`gearwhine.case.fields.Reference`). Names are read
from the document itself, so an entry in which something else is wrong still counts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Any

from gearwhine.case.errors import NOTHING, UNSAID, Finding, Location, key_of, look_up, show_value
from gearwhine.case.fields import Reference, Table, meaning_of_field
from gearwhine.case.model import Case, Draft
from gearwhine.numerics.names import did_you_mean, twin_of

_NAMED_PARTS = (
    *("rotor", "bearing", "gear", "planetary", "acoustics.microphone", "rotor_analysis.unbalance_response.probes"),
    *("rotor_analysis.torsional_response.probes", "housing.seat", "housing.support", "housing.mount", "housing.joint"),
    *("housing.mass", "housing.sensor", "housing.region"),
)
"""Paths of the lists whose entries have names of their own."""
_KEYS_OF_NAMED_PARTS = tuple(tuple(path.split(".")) for path in _NAMED_PARTS)


def check_names(draft: Draft) -> Iterator[Finding]:
    """Yield duplicate names, names that are taken and names that lead nowhere."""
    yield from _check_unique(draft)
    rotors = draft.names("rotor")
    for index, rotor in draft.raw_entries("rotor"):
        if rotor.get("name") == "housing":
            yield Finding(("rotor", index, "name"), "another name than 'housing', which stands for the housing itself")
    # Forms of one table have keys in common.
    for location, reference, name in dict.fromkeys(_references(Case, draft.document, ())):
        names = _names_of(draft, reference.to) or _names_of(draft, reference.otherwise)
        if name not in names:
            looks_alike = f"; {reference.kind} names look like it: {_CHARACTERS}" if twin_of(name, names) else ""
            yield Finding(location, _one_of(reference.kind, names) + (looks_alike or did_you_mean(name, names)))
    for index, gear in draft.raw_entries("gear"):
        if rotors and "rotor" not in gear:
            yield Finding(("gear", index, "rotor"), _one_of("rotor", rotors), NOTHING)


def _names_of(draft: Draft, places: Iterable[str]) -> tuple[str, ...]:
    """Return the names that a reference may have."""
    names: list[str] = []
    for place in places:
        if place.startswith("'"):
            names.append(place.strip("'"))
        elif isinstance(table := draft.document.get(place), Mapping):
            names += [name for name in table if isinstance(name, str)]
        else:
            names += draft.names(*place.split("."))
    return tuple(names)


def _references(
    table: type[Table], entry: Mapping[str, Any], at: Location
) -> Iterator[tuple[Location, Reference, str]]:
    """Yield each name in a table, as it stands in the document, that refers to an entry of the case."""
    for key, references, tables in _keys_with_references(table):
        if (value := entry.get(key)) is None:
            continue
        listed = isinstance(value, (list, tuple))
        for place, one in enumerate(value) if listed else ((0, value),):
            location = (*at, key, place) if listed else (*at, key)
            if isinstance(one, str):
                yield from ((location, reference, one) for reference in references)
            elif isinstance(one, Mapping):
                for inner in tables:
                    yield from _references(inner, one, location)


@cache
def _keys_with_references(
    table: type[Table],
) -> tuple[tuple[str, tuple[Reference, ...], tuple[type[Table], ...]], ...]:
    """Return the keys of a table that may refer to entries: what each refers to, and the tables in it."""
    found = []
    for name, field in table.model_fields.items():
        meaning = tuple(meaning_of_field(field))
        references = tuple(part for part in meaning if isinstance(part, Reference))
        tables = tuple(part for part in meaning if isinstance(part, type) and issubclass(part, Table))
        if references or tables:
            found.append((field.alias or name, references, tables))
    return tuple(found)


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


def names_by_case(document: Mapping[str, Any]) -> Iterator[str]:
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
