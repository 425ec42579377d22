"""Case errors: problems by key path, value and expectation, and the one exception that carries them all."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

Location = tuple[str | int, ...]
"""Where a value stands in a case file: table keys and list indices from the top."""


class _Nothing:
    """Value of a missing key."""

    def __repr__(self) -> str:
        return "nothing"


NOTHING = _Nothing()
"""Value of a missing key."""

UNSAID = object()
"""Value that a message leaves out: a whole entry, or the relation of two entries."""

_short = reprlib.Repr()
_short.maxstring = _short.maxother = 80
_short.maxlong = 40
_short.maxlevel = 3


def show_value(value: object) -> str:
    """Return a value as an error message shows it: short, on one line, whatever it is."""
    if isinstance(value, Mapping):
        listed = ", ".join(show_value(key)[1:-1] for key in list(value)[:8])
        return f"a table with {listed}{', …' if len(value) > 8 else ''}" if value else "an empty table"
    try:
        text = _short.repr(value)
    except ValueError:  # an integer of more digits than Python is willing to print
        text = "an integer of thousands of digits"
    return " ".join(text.split())


def key_of(location: Location) -> str:
    """Write a location as a key path, such as ``rotor[0].segments[1].length``."""
    text = ""
    for step in location:
        if isinstance(step, int):
            text += f"[{step}]"
        else:
            bare = step != "" and all(c.isalnum() or c in "_-*" for c in step)
            text += ("." if text else "") + (step if bare else show_value(step))
    return text or "the case"


_LONGEST_SHOWN = 200  # characters of a key path or of a change


@dataclass(frozen=True)
class Problem:
    """One thing wrong in a case.

    Attributes
    ----------
    key : str
        Key path, such as ``rotor[0].segments[1].length``.
    value
        Value there: ``NOTHING`` where the key is missing, ``UNSAID`` where no single value is at fault.
    expected : str
        Expected value, to be read after "expected".
    label : str
        Name of the entry of the key, such as ``rotor "input"``; empty where it has none.
    source : str
        The file, or the ``--set`` that gives the value.
    note : str
        Dimension of the value, where it is not obvious, such as ``mass``.
    """

    key: str
    value: object = field(hash=False)
    expected: str
    label: str = ""
    source: str = ""
    note: str = ""

    @property
    def message(self) -> str:
        """Expectation and value, without the key path."""
        if self.value is UNSAID:
            return f"expected {self.expected}"
        note = f" ({self.note})" if self.note else ""
        return f"expected {self.expected}, got {show_value(self.value)}{note}"

    def __str__(self) -> str:
        """Return the file, the key path with its label, and the message."""
        key, source = _shortened(self.key), _shortened(self.source)
        place = f"{key} ({self.label})" if self.label else key
        return f"{source}: {place}: {self.message}" if source else f"{place}: {self.message}"


def _shortened(text: str) -> str:
    """Return a text whole, or where it is long its beginning and its end."""
    if len(text) <= _LONGEST_SHOWN:
        return text
    half = _LONGEST_SHOWN // 2
    return f"{text[:half]} … {text[-half:]}"


class CaseError(ValueError):
    """The case is wrong; every problem found is in it.

    Attributes
    ----------
    problems : tuple of Problem
        All problems of the case.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


class Refusal:
    """Problems of several checks, which are refused together: ``with refusal: check()`` collects those of a check."""

    def __init__(self) -> None:
        self.problems: dict[Problem, None] = {}

    def __enter__(self) -> None:
        """Begin a check."""

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> bool:
        """Keep the problems of a check that has failed."""
        if isinstance(error, CaseError):
            self.add(*error.problems)
        return isinstance(error, CaseError)

    def add(self, *problems: Problem) -> None:
        """Keep problems."""
        self.problems |= dict.fromkeys(problems)

    def require_none(self, source: str = "") -> None:
        """Refuse what has been found, in the file `source` where a problem names no other.

        Raises
        ------
        CaseError
        """
        if self.problems:
            raise CaseError([replace(problem, source=problem.source or source) for problem in self.problems])


LOOK_UP = _Nothing()


@dataclass(frozen=True)
class Finding:
    """An error at a location, before it is written as a `Problem`, or a doubt.

    Attributes
    ----------
    location : Location
        Location of the error; its value is looked up in the case unless `value` is given.
    expected : str
        Expected value.
    note : str
        Dimension of the value, where it is not obvious.
    warns : bool
        Whether the value is unlikely rather than wrong.
    """

    location: Location
    expected: str
    value: object = field(default=LOOK_UP, hash=False)
    note: str = ""
    warns: bool = False


def look_up(document: object, location: Location) -> object:
    """Return the value at a location of nested tables and lists; ``NOTHING`` where there is none.

    A table that stands for a list of one is its first entry.
    """
    for step in location:
        if step == 0 and isinstance(document, Mapping):
            continue
        in_table = isinstance(document, Mapping) and step in document
        in_list = isinstance(document, (list, tuple)) and isinstance(step, int) and 0 <= step < len(document)
        if not (in_table or in_list):
            return NOTHING
        document = document[step]  # type: ignore[index]  # one of the two, by the line above
    return document


def label_of(document: object, location: Location) -> str:
    """Name the entry that a location is in by its own name, such as ``rotor "input"``; else nothing."""
    for depth, step in enumerate(location):
        if isinstance(step, int):
            entry = look_up(document, location[: depth + 1])
            if isinstance(entry, Mapping):
                if isinstance(entry.get("name"), str):
                    return f"{location[depth - 1]} {_quoted(entry['name'])}"
                if isinstance(entry.get("driver"), str) and isinstance(entry.get("driven"), str):
                    return f"{_quoted(entry['driver'])} to {_quoted(entry['driven'])}"
            return ""
    return ""


def _quoted(name: str) -> str:
    return '"' + show_value(name)[1:-1] + '"'


def problem_of(finding: Finding, document: object, source: str = "") -> Problem:
    """Put a finding in words: its key path, the entry's own name and the value that stands there."""
    value = look_up(document, finding.location) if finding.value is LOOK_UP else finding.value
    label = label_of(document, finding.location)
    return Problem(key_of(finding.location), value, finding.expected, label, source, finding.note)
