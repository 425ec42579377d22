"""A case's document as TOML in which comments say what was assumed."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from gearwhine.exchange.rexs.notes import Path

_LONGEST_COMMENT = 300


def toml_text(document: Mapping[str, Any], comments: Iterable[tuple[Path, str]], heading: Sequence[str] = ()) -> str:
    """Return a document as TOML.

    Parameters
    ----------
    document : mapping
        Tables and lists of tables at the top level; what is within these stands on one line each.
    comments : iterable of (path, str)
        Comments, each above the key that it is about, or above its table where the key is not there.
    heading : sequence of str
        Lines of a comment at the top.
    """
    by_path: dict[Path, list[str]] = {}
    for path, text in comments:
        by_path.setdefault(_shown_path(document, path), []).append(text)
    lines = [_comment(line) for line in heading]
    if lines:
        lines.append("")
    values = {key: value for key, value in document.items() if not _is_table(value)}
    lines += _pairs(values, (), by_path)
    for key, value in document.items():
        if isinstance(value, Mapping) and all(isinstance(one, Mapping) for one in value.values()) and value:
            for name, table in value.items():
                lines += _table(f"[{key}.{_key(name)}]", table, (key, name), by_path)
        elif isinstance(value, Mapping):
            lines += _table(f"[{key}]", value, (key,), by_path)
        elif _is_table(value):
            for place, table in enumerate(value):
                lines += _table(f"[[{key}]]", table, (key, place), by_path)
    return "\n".join(lines) + "\n"


def _is_table(value: Any) -> bool:
    """Whether a value stands under a heading of its own."""
    return isinstance(value, Mapping) or (isinstance(value, list) and bool(value) and isinstance(value[0], Mapping))


def _shown_path(document: Mapping[str, Any], path: Path) -> Path:
    """Return the path of the line on which a comment can stand: of a key of a table, else of the table."""
    if not path or path[0] not in document:
        return ()
    outer = document[str(path[0])]
    depth = 2 if isinstance(outer, list) or _has_tables(outer) else 1
    value: Any = document
    for step in path[:depth]:
        try:
            value = value[step]
        except (KeyError, IndexError, TypeError):
            return ()
    return path[: depth + 1] if len(path) > depth and path[depth] in value else path[:depth]


def _has_tables(value: Any) -> bool:
    return isinstance(value, Mapping) and bool(value) and all(isinstance(one, Mapping) for one in value.values())


def _table(heading: str, table: Mapping[str, Any], path: Path, comments: Mapping[Path, list[str]]) -> Iterator[str]:
    yield ""
    yield from (_comment(text) for text in comments.get(path, ()))
    yield heading
    yield from _pairs(table, path, comments)


def _pairs(table: Mapping[str, Any], path: Path, comments: Mapping[Path, list[str]]) -> Iterator[str]:
    for key, value in table.items():
        yield from (_comment(text) for text in comments.get((*path, key), ()))
        yield f"{_key(key)} = {_value(value, spread=True)}"


def _comment(text: str) -> str:
    words = " ".join(text.split())
    shown = "".join(letter if letter.isprintable() else "?" for letter in words)
    return f"# {shown[:_LONGEST_COMMENT]}".rstrip()


def _key(name: str) -> str:
    bare = name != "" and name.isascii() and all(letter.isalnum() or letter in "_-" for letter in name)
    return name if bare else _text(name)


def _text(text: str) -> str:
    """Return a text in quotes; one of several lines as it stands, between three of them."""
    plain = all(letter.isprintable() or letter == "\n" for letter in text)
    if "\n" in text and plain and "'''" not in text and not text.endswith("'"):
        return f"'''\n{text}'''"
    return json.dumps(text, ensure_ascii=False)


def _value(value: Any, *, spread: bool = False) -> str:
    """Return a value on one line; a list of tables with a line for each."""
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {_value(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, list | tuple):
        if spread and _is_table(list(value)):
            return "[\n" + "".join(f"    {_value(inner)},\n" for inner in value) + "]"
        return "[" + ", ".join(_value(inner) for inner in value) + "]"
    return repr(value)
