"""Findings: what a part finds wrong or unlikely with itself, and the error that carries those that forbid it.

A part yields its findings; its constructor raises those that are errors, all at once, by :func:`refuse`. Warnings stay
on the object, for whoever shows them. A door, such as the case file, maps part and attribute to its own words.
"""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

Severity = Literal["error", "warning"]
Part = tuple[str, str]
"""Kind and name of a part, such as ``("gear", "pinion")``."""


@dataclass(frozen=True)
class Finding:
    """Something wrong or unlikely about a part.

    Attributes
    ----------
    part : tuple of str
        Kind and name of the part; the name is empty where there is one of the kind.
    attribute : str
        Attribute of the part, with dots to one inside it: ``tip_relief.amount``, ``faults.0.tooth``; empty for the part
        as a whole.
    value
        Value of the attribute in SI; None where no single value is at fault.
    expected : str
        Expected value, to be read after "expected".
    severity : {"error", "warning"}
        An error forbids the part; a warning is of something allowed and unlikely.
    """

    part: Part
    attribute: str
    value: object = field(hash=False)
    expected: str
    severity: Severity = "error"

    @property
    def label(self) -> str:
        """Kind and name of the part, and the attribute as Python writes it: ``faults[0].tooth``."""
        kind, name = self.part
        of = f"{kind} {name!r}" if name else kind
        attribute = re.sub(r"\.(\d+)", r"[\1]", self.attribute)
        return f"{of}: {attribute}" if attribute else of

    def __str__(self) -> str:
        """Return part, attribute, value and expectation as a sentence."""
        if self.value is None:
            return f"{self.label}: expected {self.expected}"
        return f"{self.label} is {_shown(self.value)}; expected {self.expected}"


def _shown(value: object) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


def in_mm(length: float) -> str:
    """Return a length [m] as text in mm, for a message."""
    return f"{length * 1e3:.6g} mm"


class RefusedPartError(ValueError):
    """A part that cannot be.

    Attributes
    ----------
    findings : tuple of Finding
        Everything that forbids the part; empty where the message alone says it.
    """

    findings: tuple[Finding, ...] = ()


class WorkFailedError(RuntimeError):
    """A result that fails its own proof, or something that the computer lacks; the message says what helps."""


def refuse(findings: Iterable[Finding], error: type[RefusedPartError]) -> None:
    """Raise an error with all findings that are errors, if there are any."""
    forbidding = tuple(finding for finding in findings if finding.severity == "error")
    if forbidding:
        refusal = error("\n".join(map(str, forbidding)))
        refusal.findings = forbidding
        raise refusal


@dataclass(frozen=True)
class Number:
    """Rule of a finite number within limits, of which the ends of `above` and `below` are excluded."""

    above: float = -math.inf
    at_least: float = -math.inf
    below: float = math.inf
    at_most: float = math.inf
    optional: bool = False
    unit: str = ""
    whole: bool = False

    @property
    def expected(self) -> str:
        """Expected value, in words."""
        limits = [f"above {self.above:g}"] * (self.above > -math.inf)
        limits += [f"of at least {self.at_least:g}"] * (self.at_least > -math.inf)
        limits += [f"below {self.below:g}"] * (self.below < math.inf)
        limits += [f"of at most {self.at_most:g}"] * (self.at_most < math.inf)
        words = " ".join(
            word
            for word in ("a whole number" if self.whole else "a finite number", " and ".join(limits), self.unit)
            if word
        )
        return f"{words}, or None" if self.optional else words

    def accepts(self, value: object) -> bool:
        """Whether a value is such a number."""
        if value is None:
            return self.optional
        # A float needs none of the checks of abstract types, which cost more than all others.
        if type(value) is not float and (isinstance(value, bool) or not isinstance(value, numbers.Real)):
            return False
        if self.whole and not isinstance(value, numbers.Integral):
            return False
        number = float(value)
        within = self.at_least <= number <= self.at_most and self.above < number < self.below
        return math.isfinite(number) and within


FINITE = Number()


@dataclass(frozen=True)
class Text:
    """Rule of a text that is not empty."""

    optional: bool = False

    @property
    def expected(self) -> str:
        """Expected value, in words."""
        return "a name, or None" if self.optional else "a name"

    def accepts(self, value: object) -> bool:
        """Whether a value is such a text."""
        return self.optional if value is None else isinstance(value, str) and bool(value)


@dataclass(frozen=True)
class Choice:
    """Rule of one of some words."""

    words: tuple[str, ...]

    @property
    def expected(self) -> str:
        """Expected value, in words."""
        return f"one of {', '.join(self.words)}"

    def accepts(self, value: object) -> bool:
        """Whether a value is one of the words."""
        return isinstance(value, str) and value in self.words


@dataclass(frozen=True)
class Instance:
    """Rule of an object of a type, such as a part where a part is expected."""

    kind: type | tuple[type, ...]
    expected: str
    optional: bool = False

    def accepts(self, value: object) -> bool:
        """Whether a value is such an object."""
        return self.optional if value is None else isinstance(value, self.kind)


@dataclass(frozen=True)
class Numbers:
    """Rule of a row of numbers of some length; None for any length."""

    count: int | None = None
    each: Number = FINITE

    @property
    def expected(self) -> str:
        """Expected value, in words."""
        return f"{'' if self.count is None else f'{self.count} '}numbers, each {self.each.expected}"

    def accepts(self, value: object) -> bool:
        """Whether a value is such a row."""
        if isinstance(value, str) or not isinstance(value, Iterable):
            return False
        row = list(value)
        return (self.count is None or len(row) == self.count) and all(map(self.each.accepts, row))


@dataclass(frozen=True)
class Flags:
    """Rule of a row of true or false of some length."""

    count: int

    @property
    def expected(self) -> str:
        """Expected value, in words."""
        return f"{self.count} of true or false"

    def accepts(self, value: object) -> bool:
        """Whether a value is such a row."""
        if isinstance(value, str) or not isinstance(value, Iterable):
            return False
        return [flag in (True, False) for flag in value] == [True] * self.count


Rule = Number | Text | Choice | Instance | Numbers | Flags


def kind_findings(part: Part, owner: object, **kinds: type | tuple[type, ...]) -> Iterator[Finding]:
    """Yield a finding for each entry of a sequence in an attribute that is of another kind than its own."""
    for attribute, kind in kinds.items():
        names = " or ".join(one.__name__ for one in (kind if isinstance(kind, tuple) else (kind,)))
        entries = getattr(owner, attribute)
        if isinstance(entries, str) or not isinstance(entries, Iterable):
            yield Finding(part, attribute, "None" if entries is None else entries, f"a sequence, each a {names}")
            continue
        for place, entry in enumerate(entries):
            if not isinstance(entry, kind):
                yield Finding(part, f"{attribute}.{place}", entry, f"a {names}")


def attribute_findings(part: Part, owner: object, **rules: Rule) -> Iterator[Finding]:
    """Yield a finding for each attribute of an object that breaks its rule."""
    for attribute, rule in rules.items():
        value = getattr(owner, attribute)
        if not rule.accepts(value):
            yield Finding(part, attribute, value if value is not None else "None", rule.expected)


def argument_findings(part: Part, given: Mapping[str, tuple[object, Rule]]) -> Iterator[Finding]:
    """Yield a finding for each argument, by name with its rule, that breaks the rule."""
    for name, (value, rule) in given.items():
        if not rule.accepts(value):
            yield Finding(part, name, value if value is not None else "None", rule.expected)


def table_findings(
    part: Part, owner: object, places: str, values: str, *, least: int = 1, values_are: Number | None = None
) -> Iterator[Finding]:
    """Yield findings of a table in two attributes: places that ascend, a finite value for each.

    Parameters
    ----------
    part : Part
    owner : object
    places, values : str
        Attributes of the places and of the values.
    least : int
        Least number of places.
    values_are : Number, optional
        Rule of each value; any finite number by default.
    """
    row, other = getattr(owner, places), getattr(owner, values)
    findings = list(
        attribute_findings(part, owner, **{places: Numbers(), values: Numbers(each=values_are or Number())})
    )
    if not findings and any(after <= before for before, after in pairwise(row)):
        findings.append(Finding(part, places, row, "numbers that ascend"))
    if not findings and len(row) < least:
        findings.append(Finding(part, places, row, f"{least} numbers or more"))
    if not findings and len(other) != len(row):
        findings.append(Finding(part, values, other, f"one value for each of the {len(row)} {places}"))
    yield from findings
