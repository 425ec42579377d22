"""Notes of an import: what a file does not say and was assumed, what was changed, and what was left out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Literal

Path = tuple[str | int, ...]
"""Place in the document of the case."""


@dataclass(frozen=True)
class Note:
    """A note on a component.

    Attributes
    ----------
    kind : {"assumed", "changed", "left out"}
        What the note is of: a value that the file does not have, one that is not taken as it stands there, or what the
        case has not.
    about : str
        Label of the component, or what else the note is about.
    text : str
        The note, a phrase.
    at : tuple of str or int
        Key of the case that it is about; empty for none.
    """

    kind: Literal["assumed", "changed", "left out"]
    about: str
    text: str
    at: Path = ()

    def __str__(self) -> str:
        """Return the kind, what it is about, and the text."""
        return f"{self.kind}: {self.about}: {self.text}"


@dataclass
class Notes:
    """The notes of an import, each once."""

    _notes: dict[Note, None] = field(default_factory=dict)

    def __iter__(self) -> Iterator[Note]:
        """Go through the notes in the order in which they were made."""
        return iter(self._notes)

    def assumed(self, about: str, text: str, *at: str | int) -> None:
        """Note a value that the file does not have."""
        self._notes[Note("assumed", about, text, at)] = None

    def changed(self, about: str, text: str, *at: str | int) -> None:
        """Note a value that is not taken as it stands in the file."""
        self._notes[Note("changed", about, text, at)] = None

    def left_out(self, about: str, text: str) -> None:
        """Note what the case has not."""
        self._notes[Note("left out", about, text)] = None


def grouped(notes: Iterable[Note]) -> list[tuple[str, str, list[str]]]:
    """Return notes of the same kind and text as one: kind, text, and what all of them are about."""
    found: dict[tuple[str, str], list[str]] = {}
    for note in notes:
        about = found.setdefault((note.kind, note.text), [])
        if note.about not in about:
            about.append(note.about)
    return [(kind, text, about) for (kind, text), about in found.items()]


def in_words(notes: Iterable[Note]) -> list[str]:
    """Return notes as sentences, those of the same kind and text as one."""
    return [f"{kind}: {', '.join(about)}: {text}" for kind, text, about in grouped(notes)]
