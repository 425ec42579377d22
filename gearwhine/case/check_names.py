"""Checks of names: each belongs to one entry, and each reference finds its entry.

Names are read from the document itself, so an entry in which something else is wrong still counts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from gearwhine.case.draft import Draft
from gearwhine.case.problems import NOTHING, Finding, Location, did_you_mean, key_of, look_up, show_value

_PROBES = ("rotor_analysis", "unbalance_response", "probes")
_TORSION = ("rotor_analysis", "torsional_response")
_TORSION_PROBES = (*_TORSION, "probes")
_NAMED = (
    ("rotor",),
    ("bearing",),
    ("gear",),
    ("housing", "seat"),
    ("housing", "support"),
    ("housing", "mount"),
    ("housing", "joint"),
    ("housing", "mass"),
    ("housing", "sensor"),
    ("housing", "region"),
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
    for index, bearing in draft.raw_entries("bearing"):
        yield from _check_reference(bearing, ("bearing", index, "rotor"), "rotor", rotors)
        yield from _check_reference(bearing, ("bearing", index, "seat"), "seat", (*seats, "ground"))
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


def _check_materials(draft: Draft) -> Iterator[Finding]:
    """Yield materials that are referred to and not there, and those that a solid cannot be of."""
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
            for part in ("segments", "discs"):
                pieces = entry.get(part)
                for place, piece in enumerate(pieces if isinstance(pieces, (list, tuple)) else ()):
                    yield from _check_reference(piece, (kind, index, part, place, "material"), "material", materials)


def _check_reference(entry: object, location: Location, kind: str, names: Iterable[str]) -> Iterator[Finding]:
    """Yield a finding where the name at the end of a location is not among the names there are."""
    name = look_up(entry, location[-1:])
    if isinstance(name, str) and name not in (names := tuple(names)):
        yield Finding(location, _one_of(kind, names) + did_you_mean(name, names))


def _one_of(kind: str, names: Iterable[str]) -> str:
    listed = ", ".join(show_value(name) for name in list(names)[:20])
    return f"the name of a {kind} of this case ({listed or 'there is none'})"


def _check_unique(draft: Draft) -> Iterator[Finding]:
    """Yield the second and later uses of a name among entries of one kind."""
    for keys in _NAMED:
        first: dict[str, int] = {}
        for index, entry in draft.raw_entries(*keys):
            name = entry.get("name")
            if isinstance(name, str) and first.setdefault(name, index) != index:
                taken = key_of((*keys, first[name]))
                yield Finding((*keys, index, "name"), f"a name of its own ({taken} has this one)")
