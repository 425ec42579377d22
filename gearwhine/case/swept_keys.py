"""Swept keys: the speeds of ``[sweep]``, and ``--over key.path=from:to:n`` or ``=a,b,c``.

Keys with commas between move together, and ``*`` stands for every entry: ``--over bearing.*.stiffness.xx,
bearing.*.stiffness.yy=1e7:1e9:5``. A key with a factor behind it, ``KEY*-1``, takes the values times that: ``--over
"gear.pinion.helix_angle, gear.wheel.helix_angle*-1=12 deg:16 deg:5"`` keeps the gears of a pair of opposite hand.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from typing import Any

from gearwhine.case import units
from gearwhine.case.analysis_speeds import with_sense_of
from gearwhine.case.errors import NOTHING, CaseError, Problem, key_of
from gearwhine.case.fields import MOST_ENTRIES
from gearwhine.case.model import Case, case_document
from gearwhine.case.overrides import matching_places, parse_key_path

SPEED_KEY = "operation.speed"

_EXPECTED = "key.path=from:to:n or key.path=a,b,c, such as operation.torque='10 N*m:100 N*m:10'"
_DIGITS = 12  # digits of a value between two ends
_BRACKETS = {"[": "]", "{": "}", "(": ")"}


@dataclass(frozen=True)
class SweptKey:
    """A key of the case and the values that it takes in turn.

    Attributes
    ----------
    key : str
        Key path, as ``--set`` takes it; several with commas between.
    texts : tuple of str
        Values as ``--set`` takes them.
    values : tuple of float or tuple of str
        Values as numbers in ``unit``; the texts themselves where they are no numbers of one kind.
    unit : str
        Unit of the first value; empty for plain numbers and texts.
    """

    key: str
    texts: tuple[str, ...]
    values: tuple[float, ...] | tuple[str, ...]
    unit: str = ""

    @property
    def is_numeric(self) -> bool:
        """Whether the values are numbers."""
        return not isinstance(self.values[0], str)

    @property
    def keys(self) -> tuple[str, ...]:
        """The key paths that move together."""
        return tuple(key for key, _ in self._factors)

    @property
    def overrides(self) -> tuple[tuple[str, ...], ...]:
        """``key.path=value`` of every key, for each value."""
        return tuple(
            tuple(f"{key}={text if factor == 1 else _times(text, factor)}" for key, factor in self._factors)
            for text in self.texts
        )

    @property
    def _factors(self) -> tuple[tuple[str, Decimal], ...]:
        """Key paths with the factors by which they take the values."""
        return tuple(map(_with_factor, _divided(self.key, ",")))


def swept_keys(case: Case, over: Sequence[str]) -> tuple[SweptKey, ...]:
    """Return the keys of a sweep, the slowest first: the speeds of ``[sweep]``, then each ``--over``.

    An ``--over`` of the speed itself takes the place of ``[sweep]``.

    Raises
    ------
    CaseError
        Where a text is no ``--over``, a key is swept twice, by itself or with a table that holds it, or there are no
        points or too many.
    """
    keys, problems = list[SweptKey](), list[Problem]()
    for text in over:
        try:
            keys.append(parse_over(text))
        except CaseError as error:
            problems += error.problems
    paths, document = list[tuple[str, ...]](), case_document(case)
    of_table = parse_key_path(SPEED_KEY) or ()
    for key in keys:
        key_paths = [path for path_text in key.keys for path in _paths(document, path_text)]
        if not key_paths:
            problems.append(Problem("--over", key.key, "a path with * that some entries of the case have"))
        if len(set(key_paths)) < len(key_paths) or set(key_paths) & set(paths):
            problems.append(Problem("--over", key.key, "each key once"))
        swept = [*paths, *key_paths, *([of_table] if case.sweep is not None else [])]
        if held := next(((path, other) for path in key_paths for other in swept if _holds(path, other)), None):
            whole, part = sorted(map(key_of, held), key=len)
            expected = f"keys of which none holds another: {part}, which is swept too, is a part of {whole}"
            problems.append(Problem("--over", key.key, expected))
        paths += key_paths
    if case.sweep is not None and of_table not in paths:
        keys.insert(0, _speeds(with_sense_of(case.operation, case.sweep.speeds)))
    if not keys and not problems:
        expected = "speeds such as speed = { from = '1500 rpm', to = '6000 rpm', step = '250 rpm' }, or --over: "
        problems.append(Problem("sweep", NOTHING, f"{expected}{_EXPECTED}"))
    count = math.prod(len(key.texts) for key in keys)
    if count > MOST_ENTRIES:
        problems.append(Problem("--over", f"{count} points", f"at most {MOST_ENTRIES} points in all"))
    if problems:
        raise CaseError(problems)
    return tuple(keys)


def _holds(path: tuple[str, ...], other: tuple[str, ...]) -> bool:
    """Whether one of two different key paths leads to a table or list that holds the other key."""
    common = min(len(path), len(other))
    return len(path) != len(other) and path[:common] == other[:common]


def _paths(document: Mapping[str, Any], key: str) -> list[tuple[str, ...]]:
    """Return the paths that a key stands for; entries of lists that have names are given by their numbers."""
    steps = parse_key_path(key) or ()
    paths = [parse_key_path(key_of(place)) or () for place in matching_places(document, steps)]
    return paths if paths or "*" in steps else [steps]


def parse_over(text: str) -> SweptKey:
    """Read ``key.path=from:to:n``, ``n`` values evenly spaced with both ends, or ``key.path=a,b,c``.

    Ends and entries may have units, of their own each where they measure the same; commas and colons within quotes and
    brackets divide nothing.

    Raises
    ------
    CaseError
    """
    key, equals, values = text.partition("=")
    key = ",".join(part.strip() for part in _divided(key, ","))
    factors = dict(map(_with_factor, _divided(key, ",")))
    if not equals or not all(map(parse_key_path, factors)) or not values.strip():
        raise _wrong(text, _EXPECTED)
    if all(factor != 1 for factor in factors.values()):
        raise _wrong(text, "one key at least without a factor, which has the values as they stand")
    ends = _divided(values, ":")
    multiplied = any(factor != 1 for factor in factors.values())
    if len(ends) == 1 and multiplied and _in_one_unit(_divided(values, ",")) is None:
        raise _wrong(text, "numbers that measure the same as values of keys with factors")
    if len(ends) == 1:
        return _listed(text, key, _divided(values, ","))
    if len(ends) != 3:
        raise _wrong(text, _EXPECTED)
    if not ends[2].isdecimal() or not 2 <= int(ends[2][:6]) <= MOST_ENTRIES:
        raise _wrong(text, f"a number of values from 2 to {MOST_ENTRIES} after the second colon")
    numbers = _in_one_unit(ends[:2])
    if numbers is None or numbers[0][0] == numbers[0][1]:
        raise _wrong(text, "two different ends that measure the same, such as 10 N*m:100 N*m:10")
    (low, high), unit = numbers
    count = int(ends[2])
    with localcontext() as context:
        context.prec = 28
        inner = [low + (high - low) * step / (count - 1) for step in range(1, count - 1)]
    spaced = [low, *(_rounded(number) for number in inner), high]
    return SweptKey(key, tuple(_written(number, unit) for number in spaced), tuple(map(float, spaced)), unit)


def _listed(text: str, key: str, entries: list[str]) -> SweptKey:
    if not all(entries) or len(set(entries)) < len(entries):
        raise _wrong(text, "values with commas between, each of them once")
    numbers = _in_one_unit(entries)
    if numbers is None:
        return SweptKey(key, tuple(entries), tuple(entries))
    if len(set(numbers[0])) < len(entries):
        raise _wrong(text, "values that differ")
    return SweptKey(key, tuple(entries), tuple(map(float, numbers[0])), numbers[1])


def _speeds(speeds: Iterable[float]) -> SweptKey:
    """Return the speeds of ``[sweep]`` [rad/s] as a key in rpm, exact as they are in the case."""
    values = tuple(speed + 0.0 for speed in speeds)  # no standstill of -0 rpm
    texts = tuple(str(units.format_quantity(speed, units.SPEED)) for speed in values)
    return SweptKey(SPEED_KEY, texts, tuple(float(f"{speed * 30.0 / math.pi:.12g}") for speed in values), "rpm")


def _in_one_unit(texts: Sequence[str]) -> tuple[list[Decimal], str] | None:
    """Return numbers in the unit of the first; None where they are no numbers, or not of one kind."""
    numbers, unit = list[Decimal](), None
    for text in texts:
        parts = units.split_quantity(text)
        if parts is None:
            return None
        unit = parts[1] if unit is None else unit
        ratio = units.unit_ratio(parts[1], unit)
        if ratio is None:
            return None
        numbers.append(parts[0] if ratio == 1 else _rounded(parts[0] * ratio))
    return (numbers, unit) if unit is not None else None


def _rounded(number: Decimal) -> Decimal:
    with localcontext() as context:
        context.prec = _DIGITS
        return (+number).normalize()


def _written(number: Decimal, unit: str) -> str:
    """Write a value as ``--set`` takes it: a whole number without a point, so that it may be a number of teeth."""
    whole = number == number.to_integral_value() and abs(number) < Decimal(10) ** _DIGITS
    digits = f"{int(number)}" if whole else f"{number:f}" if abs(number) > Decimal("1e-6") else f"{float(number)!r}"
    return f"{digits} {unit}" if unit else digits


def _with_factor(text: str) -> tuple[str, Decimal]:
    """Split ``KEY*FACTOR`` into key path and factor, which is 1 where none stands there."""
    found = re.fullmatch(r"(.*[^.\s])\s*\*\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)", text)
    return (text, Decimal(1)) if found is None else (found[1], Decimal(found[2]))


def _times(text: str, factor: Decimal) -> str:
    """Return a value with its unit times a factor."""
    parts = units.split_quantity(text)
    assert parts is not None
    return _written(_rounded(parts[0] * factor), parts[1])


def _divided(text: str, mark: str) -> list[str]:
    """Split a text at the marks that stand outside quotes and brackets."""
    parts, open_marks = [""], list[str]()
    for letter in text:
        if open_marks and letter == open_marks[-1]:
            open_marks.pop()
        elif letter in "\"'" and (not open_marks or open_marks[-1] not in "\"'"):
            open_marks.append(letter)
        elif letter in _BRACKETS and (not open_marks or open_marks[-1] not in "\"'"):
            open_marks.append(_BRACKETS[letter])
        elif letter == mark and not open_marks:
            parts.append("")
            continue
        parts[-1] += letter
    return [part.strip() for part in parts]


def _wrong(text: str, expected: str) -> CaseError:
    return CaseError([Problem("--over", text, expected)])
