"""Keyword cards of an Abaqus or CalculiX input deck."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from meshes.errors import GeometryError

_DEPTH = 20  # of files that include files
_COMMA = re.compile(r',(?=(?:[^"]*"[^"]*")*[^"]*$)')  # outside of quotes


@dataclass(frozen=True)
class Card:
    """A keyword with its parameters, both upper case, and its lines of data.

    Attributes
    ----------
    keyword : str
        Such as ``ELSET``.
    parameters : dict of str to str
        Values without quotes; empty where a parameter has none.
    lines : list of list of str
        Items of each line; a comma at its end makes no item.
    """

    keyword: str
    parameters: dict[str, str]
    lines: list[list[str]]


def read_cards(path: Path) -> Iterator[Card]:
    """The keywords of a file and of those it includes, comments left out.

    Raises
    ------
    GeometryError
        Where an included file is missing, or a file includes itself.
    """
    yield from _cards(path, 0)


def _cards(path: Path, depth: int) -> Iterator[Card]:
    if depth > _DEPTH:
        raise GeometryError(f"mesh file {path} is included {_DEPTH} files deep; does it include itself?")
    card: Card | None = None
    pending = ""
    for raw in path.read_text(encoding="utf-8", errors="replace").splitlines():
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if line.startswith("*") or pending:
            pending += line
            if pending.endswith(","):  # the keyword goes on in the next line
                continue
            if card is not None:
                yield from _resolved(card, path, depth)
            card, pending = _card(pending), ""
        elif card is not None:
            card.lines.append(_items(line))
    if card is not None:
        yield from _resolved(card, path, depth)


def _resolved(card: Card, path: Path, depth: int) -> Iterator[Card]:
    """The card itself, or those of the file that it includes."""
    if card.keyword != "INCLUDE":
        yield card
        return
    name = card.parameters.get("INPUT", "")
    other = path.parent / name
    if not name or not other.is_file():
        raise GeometryError(f"mesh file {path} includes {name!r}: no such file")
    yield from _cards(other, depth + 1)


def _card(line: str) -> Card:
    word, *rest = _items(line[1:])
    pairs = [part.partition("=") for part in rest]
    return Card(word.upper(), {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}, [])


def _items(line: str) -> list[str]:
    return [item.strip().strip('"') for item in _COMMA.split(line.rstrip().removesuffix(","))]
