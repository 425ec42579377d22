"""Bundled cases: their names, titles and files."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from importlib.resources.abc import Traversable

_SUFFIX = ".toml"


def bundled_cases() -> dict[str, str]:
    """Return the title of each bundled case by its name, in alphabetical order."""
    titles = {}
    for entry in sorted(_entries(), key=lambda entry: entry.name):
        title = tomllib.loads(entry.read_text(encoding="utf-8")).get("title", "")
        titles[entry.name.removesuffix(_SUFFIX)] = str(title)
    return titles


def bundled_case(name: str) -> Traversable | None:
    """Return the file of a bundled case; None where there is none of that name."""
    return next((entry for entry in _entries() if entry.name == name + _SUFFIX), None)


def bundled_names() -> tuple[str, ...]:
    """Return the names of the bundled cases, in alphabetical order, without reading them."""
    return tuple(sorted(entry.name.removesuffix(_SUFFIX) for entry in _entries()))


def _entries() -> list[Traversable]:
    return [entry for entry in files("gearwhine.cases").iterdir() if entry.name.endswith(_SUFFIX)]
