"""Checks of provenance, `[provenance]`: the origin of numbers as published, nominal or found."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from gearwhine.case.draft import Draft
from gearwhine.case.overrides import parse_key_path, place_in_list
from gearwhine.case.problems import Finding, Location

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
    """Return a document without the provenance of values that overrides have changed or taken away.

    A number that came from the command line is not the published one. Entries that an override has itself set stay.

    Parameters
    ----------
    document, before
        The case with and without the overrides.
    changed
        The locations that they have set.
    """
    table = document.get("provenance")
    if not isinstance(table, dict) or ("provenance",) in changed:
        return document
    kept = {}
    for key, value in table.items():
        steps = parse_key_path(key)
        if steps is None or ("provenance", key) in changed or _values_at(document, steps) == _values_at(before, steps):
            kept[key] = value
    return {**document, "provenance": kept}


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
