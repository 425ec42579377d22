"""Overrides of a case from the command line: ``--set key.path=value``."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from typing import Any

from gearwhine.case.box import wall_by_face
from gearwhine.case.errors import NOTHING, CaseError, Location, Problem, key_of, look_up
from gearwhine.numerics.names import did_you_mean

_STEP = re.compile(r"""\[(\d{1,9})\]|\.?(?:"([^"]*)"|'([^']*)'|([^.\[\]"']+))""")


class ListPlace(str):
    """Step of a key path in brackets, ``[1]``: the number of a list's entry, whatever entries are called."""

    __slots__ = ()


@lru_cache(maxsize=1024)
def parse_key_path(text: str) -> tuple[str, ...] | None:
    """Split a key path such as ``rotor.input.segments[1].length``; names with dots stand in quotes.

    Returns
    -------
    tuple of str, or None
        The steps; places in brackets are text, too, a `ListPlace`. None where the text is no key path.
    """
    steps, place = [], 0
    while place < len(text):
        match = _STEP.match(text, place)
        if match is None or (place == 0 and text[0] in ".["):
            return None
        place_in_brackets, *names = match.groups()
        steps.append(
            next(name for name in names if name is not None)
            if place_in_brackets is None
            else ListPlace(place_in_brackets)
        )
        place = match.end()
    return tuple(steps) or None


def _name_of(entry: object) -> str | None:
    """Return the own name of a list's entry; of a gear pair driver and driven gear, as quantities are named by them."""
    if not isinstance(entry, dict):
        return None
    if "driver" in entry and "driven" in entry:
        return f"{entry['driver']}-{entry['driven']}"
    return entry.get("name")


def place_in_list(entries: list[Any], step: str) -> int | None:
    """Find a list's entry by its own name or by its number; in brackets by its number alone."""
    for index, entry in enumerate([] if isinstance(step, ListPlace) else entries):
        if _name_of(entry) == step:
            return index
    return int(step) if step.isdecimal() and len(step) < 10 and int(step) < len(entries) else None


def apply_overrides(
    document: dict[str, Any],
    overrides: Iterable[str],
    resolved: Callable[[dict[str, Any]], Mapping[str, Any]] = dict,
) -> tuple[dict[str, Any], dict[Location, str]]:
    """Apply ``key.path=value`` texts to a copy of a document, in order.

    A value is written as in TOML; other text (``10 mm``, ``lumped``) stands for itself. An empty value removes the key.
    Missing keys are added; the models decide whether they are allowed. One thickness of all walls of a box is written
    out for each of them where a path leads to one of them. A step ``*`` stands for every entry of a list or a table,
    and leaves out entries without the key, as written or by default; where no entry of a list has it, all get it.

    Parameters
    ----------
    document : dict
        The case as written.
    overrides : iterable of str
        Texts ``key.path=value``.
    resolved : callable
        Returns a document with its defaults written out, in which ``*`` is expanded.

    Returns
    -------
    document : dict
        The changed copy.
    sources : dict of location to str
        Text that changes each location.

    Raises
    ------
    CaseError
        With a problem for each override that is no override or leads nowhere.
    """
    document, sources, problems = _copied(document), dict[Location, str](), list[Problem]()
    for override in overrides:
        path, equals, value_text = override.partition("=")
        steps = parse_key_path(path.strip())
        if not equals or steps is None:
            problems.append(Problem("--set", override, "key.path=value, such as housing.box.wall=10mm"))
            continue
        try:
            value = _read_value(value_text.strip())
            # A default cannot be removed.
            document = _written_out(document, steps)
            whole = resolved(document) if "*" in steps and value is not NOTHING else document
            places = [
                place for path in _expanded(document, steps, whole, value) for place in _set(document, path, value)
            ]
        except _LeadsNowhereError as stop:
            problems.append(Problem(stop.key, stop.value, stop.expected, source=f"--set {override}"))
        else:
            sources |= dict.fromkeys(places, f"--set {override}")
    if problems:
        raise CaseError(problems)
    return document, sources


def _copied(value: Any) -> Any:
    """Return a copy of tables and lists of a document, whose values are never changed in place."""
    if isinstance(value, dict):
        return {key: _copied(inner) for key, inner in value.items()}
    return [_copied(inner) for inner in value] if isinstance(value, list) else value


_WALL = ("housing", "box", "wall")


def _written_out(document: dict[str, Any], steps: tuple[str, ...]) -> dict[str, Any]:
    """Return a document with a thickness for each wall of a box, where a path leads to one of them."""
    box = look_up(document, _WALL[:-1])
    leads = len(steps) == len(_WALL) + 1 and all(
        step in (wall_step, "*") for step, wall_step in zip(steps, _WALL, strict=False)
    )
    if leads and isinstance(box, dict) and isinstance(box.get("wall"), (int, float, str)):
        box["wall"] = wall_by_face(box["wall"])
    return document


class _LeadsNowhereError(Exception):
    def __init__(self, location: Location, step: str, expected: str) -> None:
        self.key, self.value, self.expected = key_of((*location, step)), step, expected


def _expanded(document: Any, steps: tuple[str, ...], resolved: Any, value: Any) -> list[tuple[str, ...]]:
    """Expand the wildcards of a path to the paths in a document or in the resolved one; a plain path gives itself."""
    if "*" not in steps:
        return [steps]
    found = [place for searched in (resolved, document) for place in matching_places(searched, steps)]
    # Planets that are written once stand many times in the resolved document, the first in the place of the written.
    places = [place for place in found if _is_written(document, place)]
    if not places and value is not NOTHING:
        # A key that no entry of a list has, such as a relief where no gear has one, is a new one for all of them.
        after = len(steps) - steps[::-1].index("*")
        entries = [place for place in matching_places(document, steps[:after]) if isinstance(place[-1], int)]
        places = [(*place, *steps[after:]) for place in entries if steps[after:]]
    paths = list(
        dict.fromkeys(tuple(step if isinstance(step, str) else ListPlace(step) for step in place) for place in places)
    )
    if not paths:
        raise _LeadsNowhereError((), ".".join(steps), "a path with * that some entries of the case have")
    return paths


def _is_written(document: Any, place: Location) -> bool:
    """Whether all entries of lists on the way to a location stand in a document; keys of tables may be new."""
    node = document
    for step in place:
        if isinstance(node, list):
            if not isinstance(step, int) or step >= len(node):
                return False
            node = node[step]
        else:
            node = node.get(step) if isinstance(node, dict) else None
    return True


def matching_places(document: object, steps: Sequence[str], place: Location = ()) -> Iterator[Location]:
    """Yield every location of a document that a key path leads to; ``*`` is each entry of a table or a list."""
    if not steps:
        yield place
        return
    step, *rest = steps
    value = look_up(document, place)
    if isinstance(value, Mapping):
        for key in value if step == "*" else [step] if step in value else []:
            yield from matching_places(document, rest, (*place, key))
    elif isinstance(value, list):
        index = place_in_list(value, step)
        for number in range(len(value)) if step == "*" else [] if index is None else [index]:
            yield from matching_places(document, rest, (*place, number))


# A number with its unit: no TOML, which need not be tried.
_QUANTITY = re.compile(r"[+-]?[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)? [^\W\d_]")


def _read_value(text: str) -> Any:
    """Read a TOML value; other text stands for itself. ``NOTHING`` for an empty text."""
    if not text:
        return NOTHING
    if _QUANTITY.match(text):
        return text
    if text.startswith("["):  # a row of numbers, as of pitch deviations, is JSON too, which is read at once
        with suppress(ValueError, RecursionError):
            row = json.loads(text)
            if all(type(number) is float and math.isfinite(number) for number in row):
                return row
    try:
        read = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return read["value"] if list(read) == ["value"] else text


def _set(document: dict[str, Any], steps: tuple[str, ...], value: Any) -> list[Location]:
    """Set one value in place; return its location, after those of the tables that are created for it."""
    created: list[Location] = []
    node: Any = document
    location: Location = ()
    for depth, step in enumerate(steps):
        last = depth == len(steps) - 1
        if isinstance(node, list):
            index = place_in_list(node, step)
            if index is None:
                names = [name for name in map(_name_of, node) if name is not None]
                alternatives = f" or one of {', '.join(map(repr, names))}" if names else ""
                places = "0, the only place" if len(node) == 1 else f"a place from 0 to {len(node) - 1}"
                places = places if node else "an entry first"
                expected = f"{places}{alternatives}{did_you_mean(step, map(str, names))}"
                raise _LeadsNowhereError(location, step, expected)
            key: str | int = index
        elif isinstance(node, dict):
            key = step
            if key not in node and last and value is NOTHING:
                raise _LeadsNowhereError(location, step, f"a key to take away{did_you_mean(step, map(str, node))}")
            if key not in node and not last:
                node[key] = {}
                created.append((*location, key))
        else:
            raise _LeadsNowhereError(location, step, f"no further key: {key_of(location)} is a value, not a table")
        location = (*location, key)
        if not last:
            node = node[key]
        elif value is NOTHING:
            del node[key]
        else:
            node[key] = value
    return [*created, location]
