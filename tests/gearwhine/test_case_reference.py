"""The reference of the case file against the case itself: no key is missing there, and none is there that is not."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

from gearwhine.case import Case
from gearwhine.case.fields import Table

REFERENCE = Path(__file__).parents[2] / "docs" / "case-file.md"


def _tables(annotation: Any) -> Iterator[type[Table]]:
    """Every table within an annotation."""
    if isinstance(annotation, type) and issubclass(annotation, Table):
        yield annotation
    for part in get_args(annotation):
        yield from _tables(part)


def _keys(table: type[Table], path: str = "") -> Iterator[str]:
    """Key paths of a table and of all in it."""
    for name, field in table.model_fields.items():
        if name in table.later:
            continue
        key = f"{path}.{field.alias or name}".lstrip(".")
        yield key
        for inner in _tables(field.annotation):
            yield from _keys(inner, key)


def _sections() -> dict[str, set[str]]:
    """For each section that a table has, the words in its code; the top's under the empty name."""
    parts = re.split(r"^#+ (.*)$", REFERENCE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    sections = {"": set(re.findall(r"\w+", " ".join(re.findall(r"`([^`\n]*)`", parts[2]))))}
    for heading, text in zip(parts[3::2], parts[4::2], strict=True):
        if found := re.search(r"`\[+([\w.]+?)(?:\.NAME)?\]+`", heading):
            sections[found[1]] = set(re.findall(r"\w+", " ".join(re.findall(r"`([^`\n]*)`", text))))
    return sections


def test_every_key_of_a_case_is_in_the_section_of_its_table() -> None:
    sections, missing = _sections(), []
    for key in _keys(Case):
        if key in sections:
            continue
        table, _, name = key.rpartition(".")
        section = next(part for part in (*_ancestors(table), "") if part in sections)
        if name not in sections[section]:
            missing.append(f"{key} in [{section}]")
    assert missing == []


def test_every_section_is_of_a_table_that_a_case_has() -> None:
    assert set(_sections()) - {""} <= set(_keys(Case))


def _ancestors(path: str) -> Iterator[str]:
    """The path, and what is above it, nearest first."""
    while path:
        yield path
        path = path.rpartition(".")[0]
