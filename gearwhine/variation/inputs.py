"""Varied inputs of a case: each takes some coordinates of a sample's point and changes keys of the case."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from gearwhine.case import CaseError, CaseSource, Problem, case_document
from gearwhine.case.errors import NOTHING, UNSAID, Location, Refusal, key_of, look_up
from gearwhine.case.input_files import InputFiles
from gearwhine.case.overrides import matching_places, parse_key_path
from gearwhine.case.units import si_amount, split_quantity
from gearwhine.case.variation import Variation, Varied, built_distribution, in_one_unit
from gearwhine.coupling.gears.errors import GearError
from gearwhine.coupling.gears.geometry.accuracy import FlankTolerances, flank_tolerances, random_pitch_deviations
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.distributions import (
    Discrete,
    Distribution,
    DistributionError,
    Measured,
    Normal,
    Rayleigh,
    widened,
)
from gearwhine.numerics.names import did_you_mean
from gearwhine.numerics.tolerance_zones import ToleranceZoneError, limit_deviations

_THIRD = 3.0  # standard deviations from the middle of a tolerance to its end
_RAYLEIGH_END = np.sqrt(-2.0 * np.log(0.0027))
"""End of Rayleigh's distribution beyond which as small a part lies, in its scales."""
_MICROMETRES, _MILLIMETRES = 1e6, 1e3
_SEEDS = 2**31
_LARGEST_TABLE = 20_000_000  # bytes
_OF_NO_GEARBOX = frozenset({"title", "notes", "provenance", "measured", "variation", "optimisation", "detection"})
"""Keys of the top level that no gearbox follows from."""


@dataclass(frozen=True)
class Pitches:
    """Pitch deviations of all teeth of a gear in a tolerance class, which a coordinate draws.

    Attributes
    ----------
    tolerances : FlankTolerances
    teeth : int
    """

    tolerances: FlankTolerances
    teeth: int

    def drawn(self, coordinate: float) -> tuple[float, ...]:
        """Cumulative pitch deviations [m]."""
        return random_pitch_deviations(self.tolerances, self.teeth, int(coordinate * _SEEDS))

    def widened(self, factor: float) -> Pitches:
        """Return deviations with all tolerances wider by a factor."""
        wider = {name: factor * size for name, size in asdict(self.tolerances).items()}
        return replace(self, tolerances=FlankTolerances(**wider))


@dataclass(frozen=True)
class Input:
    """A varied quantity: its distribution, and the keys that take its values.

    Attributes
    ----------
    name : str
        Key path as the case names it; with an entry's own where each has a value of its own.
    law : Distribution or Pitches
    unit : str
        Unit of the values; empty for plain numbers, in SI.
    words : tuple of str
        Texts that a value stands for by its number; empty where it is one itself.
    keys : tuple of (str, float)
        Key paths, and the factor by which each takes the value.
    tolerance : str
        The distribution as the case gives it, such as ``class 7``; empty where Python does.
    """

    name: str
    law: Distribution | Pitches
    unit: str
    words: tuple[str, ...]
    keys: tuple[tuple[str, float], ...]
    tolerance: str = ""

    def value(self, coordinate: float) -> float:
        """Value at a coordinate in (0, 1): in the unit, the number of a word, or the range of pitch deviations [m]."""
        if isinstance(self.law, Pitches):
            return float(np.ptp(self.law.drawn(coordinate)))
        return float(self.law.quantile(np.array([coordinate]))[0])

    def widened(self, factor: float) -> Input | None:
        """Return the input with a distribution that is wider by a factor; None of values without a tolerance."""
        law = self.law.widened(factor) if isinstance(self.law, Pitches) else widened(self.law, factor)
        return None if law is None else replace(self, law=law)

    def text(self, value: float) -> str:
        """Value as it is written into the case where it is no pitch deviation."""
        if self.words:
            return self.words[round(value)]
        return f"{value!r} {self.unit}" if self.unit else repr(value)

    def overrides(self, coordinate: float) -> Iterator[str]:
        """Yield the ``key.path=value`` of every key at a coordinate."""
        if isinstance(self.law, Pitches):
            listed = ", ".join(map(repr, self.law.drawn(coordinate)))
            yield from (f"{key}=[{listed}]" for key, _ in self.keys)
            return
        yield from self.overrides_of(self.value(coordinate))

    def overrides_of(self, value: float) -> Iterator[str]:
        """Yield the ``key.path=value`` of every key by a value."""
        for key, factor in self.keys:
            yield f"{key}={self.text(value if self.words else factor * value)}"


Wider = Sequence["Input | None"]
"""Each input with a wider distribution, None where it can have none; empty in a study without."""


def inputs_at(inputs: Sequence[Input], point: FloatArray, wider: Wider = ()) -> Iterator[tuple[Input, float]]:
    """Yield each input with its coordinate at a point of the unit cube, shape (d,).

    In a study of wider inputs a point is (d + 1,): the number of its wider input, from 1, or 0, is behind.
    """
    number = int(point[-1]) - 1 if wider else -1
    for place, (one, coordinate) in enumerate(zip(inputs, point[: len(inputs)].tolist(), strict=True)):
        yield (wider[place] if place == number else None) or one, coordinate


def values_at(inputs: Sequence[Input], points: FloatArray, wider: Wider = ()) -> FloatArray:
    """Values of inputs at points of the unit cube, shape (n, d)."""
    return np.array([[one.value(at) for one, at in inputs_at(inputs, point, wider)] for point in points])


def varied_inputs(source: CaseSource, variation: Variation) -> tuple[Input, ...]:
    """Return the inputs of a variation, in its order.

    A `*` stands for every entry that takes the key, whether it has it already or not.

    Parameters
    ----------
    source : CaseSource
        Content of the case whose keys are varied.
    variation : Variation

    Raises
    ------
    CaseError
        With every key that leads nowhere, and every distribution that cannot be.
    """
    return inputs_of(source, variation.vary, ("variation", "vary"))


def inputs_of(
    source: CaseSource, vary: Mapping[str, Varied], table: Location, refusal: Refusal | None = None
) -> tuple[Input, ...]:
    """Return the inputs of the distributions of a table of the case, by key path; see :func:`varied_inputs`.

    With a ``refusal`` the problems are kept in it, and the inputs are those of the other keys.
    """
    inputs, found, keys = list[Input](), Refusal() if refusal is None else refusal, _Keys(source)
    for key, varied in vary.items():
        try:
            inputs += keys.inputs(key, varied)
        except _CannotVaryError as error:
            found.add(Problem(key_of((*table, key, *error.at)), error.value, error.expected))
    taken: dict[str, str] = {}
    for one in inputs:
        for path, _ in one.keys:
            if path in taken:
                expected = f"each key once: {path} is varied by {taken[path]!r}, too"
                found.add(Problem(key_of((*table, one.name)), UNSAID, expected))
            taken[path] = one.name
    if refusal is None:
        found.require_none()
    return tuple(inputs)


def refusals(source: CaseSource, texts: Sequence[str]) -> tuple[list[Problem], list[Problem]]:
    """Return why a case does not take changes: problems of the changed keys, and those that follow at others."""
    try:
        source.changed_case(texts)
    except CaseError as error:
        changes = [f"--set {text}" for text in texts]
        of_keys = [problem for problem in error.problems if problem.source in changes]
        return of_keys, [problem for problem in error.problems if problem not in of_keys]
    return [], []


class _CannotVaryError(Exception):
    def __init__(self, expected: str, *at: str | int, value: object = UNSAID) -> None:
        self.expected, self.at, self.value = expected, at, value


_Law = tuple[Distribution | Pitches, str, tuple[str, ...]]
"""A distribution, its unit and its words."""


class _Keys:
    """Keys of a case, as its variation names them."""

    def __init__(self, source: CaseSource) -> None:
        case = source.changed_case()
        self._source, self._document, self._files = source, case_document(case), case.input_files
        self._gears = [case.parts.gears[table.name] for table in case.gear]

    def inputs(self, key: str, varied: Varied) -> Iterator[Input]:
        """Yield the inputs of a varied key: one, or one for each entry where these are independent."""
        document = self._document
        places = _places(document, key)
        if any(place[0] in _OF_NO_GEARBOX for place in places):
            raise _CannotVaryError("a key that a gearbox follows from")
        there = [place for place in places if look_up(document, place) is not NOTHING]
        if len(places) > 1:
            # Entries without the key have it from now on, where they take it.
            one = Input("", *self._law((there or places)[0], varied), ((key_of((there or places)[0]), 1.0),))
            text = next(one.overrides(0.5)).partition("=")[2]
            refusals = {place: self._refusal(f"{key_of(place)}={text}") for place in places if place not in there}
            places = [place for place in places if refusals.get(place) is None]
            if not places:
                raise _CannotVaryError(
                    f"a key that some entries of the case take; none has it, and {refusals.popitem()[1]}"
                )
        if not places:
            raise _CannotVaryError("a key that some entries of the case take")
        names = [name for place in places for name in _names(document, place)]
        if unknown := sorted(set(varied.factor) - set(names)):
            hint = did_you_mean(unknown[0], names)
            raise _CannotVaryError(f"names of entries that {key!r} leads to{hint}", "factor", value=unknown[0])
        if varied.independent:
            for place in places:
                name = key_of(_named_place(document, place))
                yield Input(name, *self._law(place, varied), ((name, 1.0),), varied.words)
            return
        if (varied.kind == "class" or (varied.fit and varied.size is None)) and len(places) > 1:
            raise _CannotVaryError(
                f"independent = true beside {varied.kind!r}: each of the {len(places)} entries has a size of its own"
            )
        keys = tuple((key_of(_named_place(document, place)), _factor(document, place, varied)) for place in places)
        yield Input(key, *self._law(places[0], varied), keys, varied.words)

    def _refusal(self, override: str) -> str | None:
        """Return why the case does not take a value at a key; None where it does."""
        try:
            self._source.changed_case([override])
        except CaseError as error:
            return str(replace(error.problems[0], source=""))
        return None

    def _law(self, place: Location, varied: Varied) -> _Law:
        """Return the law of a key; what it cannot be is said of it."""
        try:
            if (built := built_distribution(varied)) is not None:
                return (*built, ())
            if varied.file is not None:
                return (*_of_file(varied.file, varied.column, self._files), ())
            if varied.fit is not None:
                return (*_of_fit(look_up(self._document, place), varied, key_of(place)), ())
            if varied.tolerance_class is not None:
                law = self._of_class(varied.tolerance_class, place)
                return law, "m" if isinstance(law, Pitches) else "um", ()
            return _of_values(varied.values or (), varied.weights)
        except (ValueError, DistributionError, ToleranceZoneError, GearError) as error:
            findings = getattr(error, "findings", ())
            text = "; ".join(finding.expected for finding in findings) or str(error)
            at = "weights" if any(finding.attribute == "weights" for finding in findings) else varied.kind
            raise _CannotVaryError(text, at, value=list(varied.weights) if at == "weights" else UNSAID) from None

    def _of_class(self, tolerance_class: int, place: Location) -> Distribution | Pitches:
        """Return the distribution of an error of a gear in a tolerance class [µm], of pitches [m]."""
        error = tuple(place[3:])
        if place[:1] != ("gear",) or place[2:3] != ("errors",):
            raise ValueError(f"a key of the errors of a gear: gear.NAME.errors. and {_OF_CLASS}")
        gear = self._gears[int(place[1])]
        tolerances = flank_tolerances(gear, tolerance_class)
        if error == ("pitch",):
            return Pitches(tolerances, abs(gear.teeth))
        slopes: dict[Location, float] = {
            ("profile", "slope"): tolerances.profile_slope,
            ("helix", "slope"): tolerances.helix_slope,
        }
        sizes: dict[Location, float] = {("runout",): tolerances.runout, ("profile", "form"): tolerances.profile_form}
        if error in slopes:
            slope = _MICROMETRES * slopes[error]
            return Normal(0.0, slope / _THIRD, -slope, slope)
        if error in sizes:
            size = _MICROMETRES * sizes[error]
            return Rayleigh(size / float(_RAYLEIGH_END), size)
        raise ValueError(f"one of the errors {_OF_CLASS}")


_OF_CLASS = "pitch, runout, profile.slope, profile.form or helix.slope"


def _of_values(values: Sequence[Any], weights: Sequence[float]) -> tuple[Discrete, str, tuple[str, ...]]:
    plain = [float(one) if isinstance(one, int) and not isinstance(one, bool) else one for one in values]
    if all(isinstance(one, float) or (isinstance(one, str) and split_quantity(one)) for one in plain):
        whole = all(isinstance(one, int) for one in values)
        numbers, unit = in_one_unit(tuple(plain))
        if not whole:
            return Discrete(numbers, weights), unit, ()
    # Whole numbers stay such, as numbers of teeth must.
    words = tuple(one if isinstance(one, str) else _toml(one) for one in values)
    return Discrete([float(number) for number in range(len(words))], weights), "", words


def _toml(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        return repr(value)
    raise ValueError("quantities, numbers, words or truth values")


def _of_file(path: Path, column: str, files: InputFiles) -> tuple[Measured, str]:
    """Return the distribution of a column of a table, and its unit."""
    if path.stat().st_size > _LARGEST_TABLE:
        raise ValueError(f"a table of at most {_LARGEST_TABLE // 10**6} MB")
    rows: list[tuple[int, list[str]]] = files.read(path, _rows_of)
    if len(rows) < 3:
        raise ValueError(f"a name in the first line of {path.name}, and two values or more below")
    heads = [head.strip() for head in rows[0][1]]
    names = [re.sub(r"\s*\[[^\]]*\]$", "", head) for head in heads]
    if any(_is_number(head) for head in heads):
        raise ValueError(f"names of the columns in the first line of {path.name}, which has {', '.join(heads)}")
    if column and names.count(column) > 1:
        raise ValueError(f"one column {column!r} in {path.name}, which has {names.count(column)}")
    if column and column not in names:
        raise ValueError(f"a table with the column {column!r}; it has {', '.join(names)}{did_you_mean(column, names)}")
    if not column and len(heads) != 1:
        raise ValueError(f"the name of one of the {len(heads)} columns, 'column': {', '.join(names)}")
    place = names.index(column) if column else 0
    unit = (re.search(r"\[([^\]]*)\]$", heads[place]) or ["", ""])[1]
    if unit and split_quantity(f"1 {unit}") is None:
        raise ValueError(f"a known unit in brackets behind {names[place]!r}; {unit!r} is none")
    for line, row in rows[1:]:
        if len(row) <= place or not _is_number(row[place]):
            raise ValueError(f"a finite number in line {line} of {path.name}, column {names[place]!r}")
    return Measured([float(row[place]) for _, row in rows[1:]]), unit


def _is_number(cell: str) -> bool:
    """Whether a cell of a table is a finite number."""
    try:
        return math.isfinite(float(cell))
    except ValueError:
        return False


def _rows_of(path: Path) -> list[tuple[int, list[str]]]:
    """Return the rows of a table that are not empty, each with the number of its line."""
    with path.open(encoding="utf-8-sig", newline="") as stream:
        table = csv.reader(stream)
        try:
            return [(table.line_num, row) for row in table if any(cell.strip() for cell in row)]
        except (UnicodeDecodeError, csv.Error):
            raise ValueError(f"a table of text in UTF-8; {path.name} is none") from None


def _of_fit(written: object, varied: Varied, key: str) -> tuple[Normal, str]:
    """Return the distribution of a length in a tolerance zone, or of an interference by one of its two parts [mm]."""
    zone, nominal = varied.fit or "", si_amount(written)
    if varied.size is None:
        if nominal is None or nominal <= 0.0:
            expected = "a key with a length in the case, about which the zone lies, or the nominal 'size' of an"
            raise ValueError(f"{expected} interference; {key} has none")
        deviations = limit_deviations(zone, nominal)
    else:
        size = si_amount(varied.size)
        if size is None or size <= 0.0:
            raise ValueError(f"a length above 0 with its unit as the nominal 'size' of {key}")
        if not key.endswith("interference"):
            raise ValueError(f"no 'size' of {key}, which is no interference of two parts")
        nominal, deviations = nominal or 0.0, limit_deviations(zone, size)
        if zone[:1].isupper():
            deviations = -deviations[1], -deviations[0]
    low, high = (_MILLIMETRES * (nominal + deviation) for deviation in deviations)
    return Normal(0.5 * (low + high), 0.5 * (high - low) / _THIRD, low, high), "mm"


def _places(document: Mapping[str, Any], key: str) -> list[Location]:
    """Return the places of a key in the case, with `*` expanded, also in entries that do not have it yet."""
    steps = parse_key_path(key) or ()
    after = max((number for number, step in enumerate(steps, start=1) if step == "*"), default=0)
    places = list[Location]()
    for entry in matching_places(document, steps[:after]):
        inside = look_up(document, entry)
        # A table that the case does not have at all is no place: its name may be wrong.
        found = list(matching_places(inside, steps[after:])) or _new_places(inside, steps[after:], least=not entry)
        places += [(*entry, *place) for place in found]
    if not places:
        raise _CannotVaryError(f"a key path that leads to something in the case{_hint(document, steps)}")
    return places


def _hint(document: Mapping[str, Any], steps: Sequence[str]) -> str:
    """Return the name that was meant at the first step that leads nowhere, if one is near."""
    for length in range(1, len(steps) + 1):
        if not any(True for _ in matching_places(document, steps[:length])):
            around = [look_up(document, place) for place in matching_places(document, steps[: length - 1])]
            names = [name for one in around for name in _names_in(one)]
            if "*" in steps[length - 1] != "*":
                return f"; '*' stands for a whole name, not for a part as in '{steps[length - 1]}'"
            return did_you_mean(steps[length - 1], names)
    return ""


def _names_in(value: object) -> list[str]:
    """Return the keys of a table, or the names of a list's entries."""
    if isinstance(value, Mapping):
        return [str(key) for key in value]
    entries = value if isinstance(value, list) else []
    return [str(entry["name"]) for entry in entries if isinstance(entry, Mapping) and "name" in entry]


def _new_places(inside: object, steps: Sequence[str], least: int) -> list[Location]:
    """Return the place of a key that nothing has yet, such as an error of a gear, below at least some of its steps."""
    for length in range(len(steps) - 1, least - 1, -1):
        for found in matching_places(inside, steps[:length]):
            return [(*found, *steps[length:])] if isinstance(look_up(inside, found), Mapping) else []
    return []


def _named_place(document: Mapping[str, Any], place: Location) -> Location:
    """Return a place with the names of list entries in place of their numbers."""
    named: list[str | int] = []
    for depth, step in enumerate(place):
        entry = look_up(document, place[: depth + 1])
        named.append(
            entry["name"] if isinstance(step, int) and isinstance(entry, Mapping) and "name" in entry else step
        )
    return tuple(named)


def _names(document: Mapping[str, Any], place: Location) -> list[str]:
    """Return the names by which a factor can mean a place: of the entries that hold it, and its whole path."""
    named = _named_place(document, place)
    of_entries = (str(step) for step, own in zip(named, place, strict=True) if step != own)
    return [*of_entries, key_of(named), key_of(place)]


def _factor(document: Mapping[str, Any], place: Location, varied: Varied) -> float:
    return next((varied.factor[name] for name in _names(document, place) if name in varied.factor), 1.0)


def correlation_matrix(inputs: Sequence[Input], variation: Variation) -> FloatArray | None:
    """Return the correlation of the inputs' normal scores, shape (d, d); None where they are independent.

    Raises
    ------
    CaseError
        Where a key is not varied or has several values, or the coefficients cannot be together.
    """
    if not variation.correlation:
        return None
    from gearwhine.numerics.distributions import correlation_findings

    refusal, names, matrix = Refusal(), [one.name for one in inputs], np.eye(len(inputs))
    for number, pair in enumerate(variation.correlation):
        for place, key in enumerate(pair.keys):
            if key not in names and (key not in variation.vary or variation.vary[key].independent):
                expected = "a key of [variation.vary] with one value, or an entry of an independent one"
                expected += did_you_mean(key, names)
                refusal.add(Problem(f"variation.correlation[{number}].keys[{place}]", key, expected))
        if all(key in names for key in pair.keys):  # others are refused themselves
            first, second = (names.index(key) for key in pair.keys)
            matrix[first, second] = matrix[second, first] = pair.coefficient
    refusal.require_none()
    if findings := list(correlation_findings(matrix)):
        raise CaseError([Problem("variation.correlation", UNSAID, finding.expected) for finding in findings])
    return matrix
