"""Checks of the `[provenance]` table: which numbers are published, nominal or found."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from gearwhine.case.draft import Draft
from gearwhine.case.overrides import parse_key_path, place_in_list
from gearwhine.case.problems import Finding

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
        if steps is None or not _leads_somewhere(draft.document, steps):
            yield Finding(location, "as a key the path of something in this case ('*' stands for any entry)")


def _leads_somewhere(document: object, steps: tuple[str, ...]) -> bool:
    """Tell whether a key path, with wildcards, leads to anything."""
    if not steps:
        return True
    step, rest = steps[0], steps[1:]
    if isinstance(document, Mapping):
        inside = list(document.values()) if step == "*" else [document[step]] if step in document else []
    elif isinstance(document, (list, tuple)):
        place = None if step == "*" else place_in_list(list(document), step)
        inside = list(document) if step == "*" else [document[place]] if place is not None else []
    else:
        return False
    return any(_leads_somewhere(entry, rest) for entry in inside)
