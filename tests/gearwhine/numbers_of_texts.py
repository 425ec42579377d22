"""Every number with a unit in the texts of a result is a number of its document, in that unit, to the digits shown.

Sentences and tables are composed from the document by hand, for the terminal, the report and its first page. Whatever
result a test makes, its texts are composed here and read back: a factor, a unit or a sign that is wrong in one of them
leaves a number which the document does not have.
"""

import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from math import hypot
from typing import Any, NamedTuple

import pytest
from shown_units import SHOWN, dimension_of

from gearwhine.output.sections import Section, Table

_UNITS = SHOWN | {"dB(A)": ("dB", 1.0)}
_NUMBER = r"(?<![\w.,/-])[-+]?\d+(?:\.\d+)?(?:e[+-]?\d+)?"
_NAMES = "|".join(sorted(map(re.escape, _UNITS), key=len, reverse=True))
# A unit may stand behind the second of two numbers.
_WITH_UNIT = re.compile(rf"({_NUMBER})(?=(?:(?: to | and | ± ){_NUMBER})? ?({_NAMES})(?![\w/·*²(°-]))")
_BOUNDS = re.compile(r"(above|below|within|beyond|less than|up to|by|±) $")
"""Words before a number of the settings, or of the sentence itself, which need not be in the document."""
_OF_SENTENCES = re.compile(
    r"95 % (interval|of)|1 µm (at|of|alone)|100 %|% of critical|failed: |dB (with|re) |20 µPa|1 pW|damping|falls to"
)
_OF_MANY = ("optimise", "vary", "detect", "sweep")
"""Commands whose numbers have the units of the case's keys, which their names do not say."""


class Shown(NamedTuple):
    """A number of a text: the text, the number's words and its unit."""

    text: str
    number: str
    unit: str


def leaves(value: Any, path: str = "") -> Iterator[tuple[str, float]]:
    """Numbers of a document by their paths, and the lengths of vectors."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from leaves(inner, f"{path}.{key}")
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from leaves(inner, path)
        numbers = [one for one in value if isinstance(one, float)]
        if len(numbers) == len(value) and len(value) in (2, 3, 5):
            yield from ((path, hypot(*numbers[:count])) for count in (2, 3))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path, float(value)


def shown_in(section: Section) -> Iterator[Shown]:
    """Numbers with units in the sentences and tables of a section."""
    for item in section.content:
        if isinstance(item, Table):
            yield from shown_in_table(item)
        elif not _OF_SENTENCES.search(str(item)):
            yield from shown_in_text(str(item))
    for inner in section.inner:
        yield from shown_in(inner)


def shown_in_text(text: str) -> Iterator[Shown]:
    """Numbers with units in a text."""
    for found in _WITH_UNIT.finditer(text):
        if not _BOUNDS.search(text[: found.start()]):
            yield Shown(text, found[1], found[2])


def shown_in_table(table: Table) -> Iterator[Shown]:
    """Numbers in cells, in the unit behind them or else in that of the heading."""
    columns, rows = table.filled()
    for place, column in enumerate(columns):
        heading = column.heading.replace("\n", " ")
        unit = heading.rpartition("[")[2].partition("]")[0].split(",")[0].removesuffix(" rms").split(" re ")[0]
        for row in rows:
            text = f"{heading}: {row[place]}"
            if own := list(shown_in_text(row[place])):
                yield from own
            elif "[" in heading and unit in _UNITS:
                yield from (Shown(text, number, unit) for number in re.findall(_NUMBER, row[place]))


def foreign_numbers(document: Mapping[str, Any], sections: Iterable[Section]) -> list[Shown]:
    """Numbers of texts that the document does not have."""
    known: defaultdict[str, list[float]] = defaultdict(list)
    for path, value in leaves(document):
        dimension, factor = _unit_of(path)
        known[dimension].append(factor * value)
    return [one for section in sections for one in shown_in(section) if not _is_known(one, known)]


@cache
def _unit_of(path: str) -> tuple[str, float]:
    """Dimension of a number at a path, and the factor to the unit of the table."""
    if ".seconds" in path:
        return "s", 1.0
    if path.endswith(".stiffness"):
        return "N/m", 1.0
    if path.endswith("_deg"):
        return "rad", SHOWN["°"][1]
    dimension = dimension_of(path[1:])
    return ("%", 100.0 if dimension is None else 1.0) if dimension in (None, "percent") else (dimension, 1.0)


def _is_known(one: Shown, known: defaultdict[str, list[float]]) -> bool:
    dimension, size = _UNITS[one.unit]
    mantissa, _, exponent = one.number.partition("e")
    step = size * 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    value = size * float(one.number)
    if "⌀" in one.text:
        value, step = 0.5 * value, 0.5 * step
    if dimension == "rpm":  # of either sense
        value = abs(value)
        return any(abs(value - abs(other)) <= 0.51 * step + 1e-9 * value for other in known[dimension])
    return any(abs(value - other) <= 0.51 * step + 1e-9 * abs(value) for other in known[dimension])


@cache
def _composers() -> dict[str, list[Callable[[Any], Iterable[Section]]]]:
    """Functions that compose the texts of each command."""
    from gearwhine.cli.study_commands import STUDY_COMMANDS, _sections
    from gearwhine.results import chapters_of

    return {
        entry.name: [chapters_of, *(_sections(place) for place in (entry.sections, entry.longer[1]) if place)]
        for entry in STUDY_COMMANDS
        if entry.name not in _OF_MANY
    }


@contextmanager
def numbers_held() -> Iterator[None]:
    """Compose and read the texts of every result that is made."""
    result = import_module("gearwhine.analyses.result").Result
    as_made = result.__post_init__

    def read_back(self: Any) -> None:
        as_made(self)
        document = {"command": self.command} | self.document
        for compose in _composers().get(self.command, ()):
            foreign = foreign_numbers(document, compose(document))
            assert not foreign, f"{self.command}: not in the document: {foreign}"

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(result, "__post_init__", read_back)
        yield
