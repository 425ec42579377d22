"""Keyword cards of the input decks of Abaqus and CalculiX, with those of the files that a deck includes."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from gearwhine.meshes.errors import GeometryError

_DEPTH = 20  # levels of files that include files
_INCLUDE, _INPUT = "INCLUDE", "INPUT"
KEYWORDS_READ = {"NODE", "ELEMENT", "NSET", "ELSET", "SURFACE"}
"""Keywords that are read here, whose lines of data may stand in a file of their own."""

_COMMA = re.compile(r',(?=(?:[^"]*"[^"]*")*[^"]*$)')  # outside of quotes


@dataclass(frozen=True)
class Card:
    """A keyword with its parameters, both upper case, and its lines of data.

    Attributes
    ----------
    keyword : str
        Keyword, such as ``ELSET``.
    parameters : dict of str to str
        Values without quotes; empty where a parameter has none.
    lines : list of list of str
        Items of each line; a comma at its end makes no item.
    place : str
        File and line, for messages.
    """

    keyword: str
    parameters: dict[str, str]
    lines: list[list[str]]
    place: str


def read_cards(path: Path) -> Iterator[Card]:
    """Yield the keyword cards of a file and of those it includes, without comments.

    Raises
    ------
    GeometryError
        Where an included file or one of data is missing, or a file includes itself.
    """
    yield from _cards(path, 0)


def included_files(path: Path) -> Iterator[Path]:
    """Yield the files that a file itself includes or takes lines of data from, whether they exist or not."""
    # Most decks include nothing and are long: their cards are made only where the word is in them.
    if _INPUT.encode() in path.read_bytes().upper():
        yield from (_included(card, path) for card in _own_cards(path) if _takes_file(card))


def _cards(path: Path, depth: int) -> Iterator[Card]:
    if depth > _DEPTH:
        raise GeometryError(f"mesh file {path} is included {_DEPTH} files deep; does it include itself?")
    for card in _own_cards(path):
        yield from _resolved(card, path, depth)


def _own_cards(path: Path) -> Iterator[Card]:
    """Yield the cards of a file itself, INCLUDE among them."""
    card: Card | None = None
    pending = ""
    for number, raw in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), start=1):
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if line.startswith("*") or pending:
            pending += line
            if pending.endswith(","):  # the keyword goes on in the next line
                continue
            if card is not None:
                yield card
            card, pending = _card(pending, f"mesh file {path}, line {number}"), ""
        elif card is not None:
            card.lines.append(_items(line))
    if card is not None:
        yield card


def _resolved(card: Card, path: Path, depth: int) -> Iterator[Card]:
    """Yield the card itself, with its lines of data from another file, or the cards of the file that it includes."""
    if not _takes_file(card):
        yield card
        return
    other = _included(card, path)
    if not other.is_file():
        raise GeometryError(f"mesh file {path} includes {card.parameters.get(_INPUT, '')!r}: no such file")
    if card.keyword == _INCLUDE:
        yield from _cards(other, depth + 1)
        return
    for raw in other.read_text(encoding="utf-8", errors="replace").splitlines():
        line = raw.strip()
        if line.startswith("*") and not line.startswith("**"):
            raise GeometryError(f"{card.place}: {other} has a keyword, {line!r}; expected lines of data alone")
        if line and not line.startswith("**"):
            card.lines.append(_items(line))
    yield card


def _takes_file(card: Card) -> bool:
    return card.keyword == _INCLUDE or (card.keyword in KEYWORDS_READ and _INPUT in card.parameters)


def _included(card: Card, path: Path) -> Path:
    """Return the file that a card names, relative to the file that it stands in; its folder where it names none."""
    return path.parent / card.parameters.get(_INPUT, "")


def _card(line: str, place: str) -> Card:
    word, *rest = _items(line[1:])
    pairs = [part.partition("=") for part in rest]
    parameters = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
    return Card(" ".join(word.upper().split()), parameters, [], place)


def _items(line: str) -> list[str]:
    return [item.strip().strip('"') for item in _COMMA.split(line.rstrip().removesuffix(","))]
