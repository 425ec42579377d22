"""Freshness of results: when they were made, and how their case and input files differ from those of now."""

import tomllib
from collections.abc import Iterator, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

from gearwhine.case.input_files import file_contents
from gearwhine.commands import COMMANDS, Command

_DIFFERENCES = 6  # largest number of keys of the case that are named
_REMARKS = "provenance."  # beginning of keys that give the sources of values, and change no value
_TITLES = ("title", "notes")
_CHOSEN = frozenset(table for command in COMMANDS.values() for table in command.reads)
"""Tables of the case that not all commands read."""


def moment(text: object) -> str:
    """Return an ISO time in words; any other text unchanged."""
    try:
        return datetime.fromisoformat(str(text)).strftime("on %Y-%m-%d at %H:%M:%S %Z").strip()
    except ValueError:
        return f"at {text}"


def stored_case(place: Path) -> Mapping[str, Any] | None:
    """Return the resolved case beside a result; None where it cannot be read."""
    try:
        return tomllib.loads((place / "case.toml").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def mismatches(place: Path, document: Mapping[str, Any], present: Mapping[str, Any] | None) -> list[str]:
    """Return how the case and the input files of a result differ from those of now; empty where they do not."""
    differences = _differences(stored_case(place), present, document)
    return [*differences, *_changed_files(document.get("input_files"))]


def _reads(command: str, key: str) -> bool:
    """Whether a command reads a key of the case; one that is not known reads all."""
    table, declared = key.partition(".")[0], COMMANDS.get(command, Command(command))
    return table not in _TITLES and (table in declared.reads if table in _CHOSEN else table not in declared.unread)


def _has_sound(document: Mapping[str, Any], *cases: Mapping[str, Any]) -> bool:
    """Whether a result has sound, or would have in one of these cases: a run by its keys, `load` by what it ranks."""
    if document.get("command") == "load":
        return "loudest_lines" in document
    settings = [case["acoustics"] for case in cases if "acoustics" in case]
    return document.get("command") not in ("run", "simulate") or any(
        acoustics.get("in_run", acoustics.get("method", "boundary-elements") != "boundary-elements")
        for acoustics in settings
    )


def _differences(
    stored: Mapping[str, Any] | None, present: Mapping[str, Any] | None, document: Mapping[str, Any]
) -> list[str]:
    """Keys that a command reads and in which the case of its result differs from the present one, in one sentence."""
    if stored is None or present is None:
        return []
    before, now = (
        {key: value for key, value in _entries(document) if not key.startswith(_REMARKS)}
        for document in (stored, present)
    )
    changed = (key for key in dict.fromkeys([*before, *now]) if before.get(key) != now.get(key))
    command, has_sound = str(document.get("command", "")), _has_sound(document, stored, present)
    keys = [
        key
        for key in changed
        if (not command or _reads(command, key)) and (has_sound or not key.startswith("acoustics."))
    ]
    tables = dict.fromkeys(key.partition(".")[0] for key in keys if "." in key)
    whole = {
        table: "is absent" if table in stored else "is new"
        for table in tables
        if (table in stored) != (table in present)
    }
    parts = [f"[{table}] {change}" for table, change in whole.items()]
    parts += [
        f"{key} was {before.get(key, 'absent')}, is {now.get(key, 'absent')}"
        for key in keys
        if key.partition(".")[0] not in whole
    ]
    more = len(parts) - _DIFFERENCES
    return [", ".join(parts[:_DIFFERENCES]) + (f", and {more} more" if more > 0 else "")] if parts else []


def _entries(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each number or text of a case with its path of keys; entries of lists by their names."""
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _entries(inner, f"{key}.{name}" if key else name)
    elif isinstance(value, list) and value and all(isinstance(entry, Mapping) for entry in value):
        for place, entry in enumerate(value):
            yield from _entries(entry, f"{key}.{entry.get('name', place)}")
    else:
        yield key, value


def _changed_files(files: object) -> list[str]:
    """Return remarks on input files whose content has changed, or that are gone."""
    if not isinstance(files, Mapping):
        return []
    remarks = []
    for name, content in files.items():
        try:
            changed = file_contents([Path(name)])[str(Path(name))] != content
        except OSError:
            remarks.append(f"{name} cannot be read")
        else:
            if changed:
                remarks.append(f"{name} has changed")
    return remarks
