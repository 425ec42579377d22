"""A sound case with all tables, broken in places, and what its reader must say of that."""

from __future__ import annotations

import copy
import re
import tomllib
from importlib.resources import files
from typing import Any

import pytest

from gearwhine.case import CaseError, parse_case

GEARBOX = tomllib.loads(files("gearwhine.cases").joinpath("small-gearbox.toml").read_text(encoding="utf-8"))
GONE = object()


def broken(*changes: tuple[str, Any], sound: dict[str, Any] = GEARBOX) -> dict[str, Any]:
    """Return a sound case with values replaced, or taken away, at dotted paths."""
    document = copy.deepcopy(sound)
    for path, value in changes:
        *way, last = [int(step) if step.isdecimal() else step for step in path.split(".")]
        here: Any = document
        for step in way:
            here = here[step]
        if value is GONE:
            del here[last]
        else:
            here[last] = value
    return document


def problems(document: dict[str, Any]) -> list[str]:
    with pytest.raises(CaseError) as caught:
        parse_case(document, source="case.toml")
    return str(caught.value).splitlines()


def check_one_wrong(path: str, value: Any, key: str, expected: str, sound: dict[str, Any] = GEARBOX) -> None:
    """One value of a sound case is wrong: it is named with its place, and what was expected."""
    report = problems(broken((path, value), sound=sound))
    lines = [line for line in report if line.startswith((f"case.toml: {key}:", f"case.toml: {key} ("))]
    assert lines, report
    assert expected in " ".join(lines), lines
    assert "expected" in lines[0], lines
    if isinstance(value, str) and lines[0].startswith(f"case.toml: {key}") and key.endswith(path.split(".")[-1]):
        assert f", got {value!r}" in lines[0], lines
    example = re.search(r"such as '([^']+)'", lines[0])
    if example and key == re.sub(r"\.(\d+)(?=\.|$)", r"[\1]", path):
        accepted = broken((path, example[1]), sound=sound)
        assert said_of(accepted, key) != said_of(broken((path, value), sound=sound), key), (
            f"{example[0]} is refused too"
        )


def said_of(document: dict[str, Any], key: str) -> str:
    """What a case's reader expects at a key; empty where it accepts the value."""
    try:
        parse_case(document, source="case.toml")
    except CaseError as error:
        lines = (
            line for line in str(error).splitlines() if line.startswith((f"case.toml: {key}:", f"case.toml: {key} ("))
        )
        return next(lines, "").partition(", got ")[0]
    return ""


def check_several_wrong(
    changes: list[tuple[str, Any]], key: str, expected: str, sound: dict[str, Any] = GEARBOX
) -> None:
    """Several values do not go together: one line says so."""
    report = problems(broken(*changes, sound=sound))
    assert any(line.startswith(f"case.toml: {key}") and expected in line for line in report), report
