"""Varied cases, `[variation]`: distributions of keys, correlations between them, and limits of what follows.

A distribution's numbers are quantities of the key that it varies: texts with a unit, or plain numbers in SI. They are
kept as they stand, since only the key says what they measure.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import AfterValidator, Field, StrictBool, model_validator

from gearwhine.case import units
from gearwhine.case.fields import MOST_ENTRIES, CaseFile, Name, Quantity, Table, Whole, wrong
from gearwhine.case.measured import Amount, KeyPath
from gearwhine.case.operation import Speeds, listed

if TYPE_CHECKING:
    from gearwhine.numerics.distributions import Distribution


Factor = Annotated[float, Quantity(units.RATIO)]
Weight = Annotated[float, Quantity(units.RATIO, at_least=0.0)]

KINDS = ("normal", "uniform", "triangular", "values", "file", "class", "fit")
"""Keys of which a distribution has exactly one."""
_ATTRIBUTES = {"class": "tolerance_class"}
_NAMED = {"deviation": "standard deviation", "mode": "most likely value", "low": "low end", "high": "high end"}
_LISTED = 6  # values that are named in words
_BELONGS_TO = {"within": "normal", "weights": "values", "column": "file", "size": "fit"}


class Varied(Table):
    """`[variation.vary]`: distribution of a key; exactly one of `normal`, `uniform`, `triangular`, `values`, `file`,
    `class` and `fit`.
    """  # noqa: D205 - the one sentence takes two lines

    normal: tuple[Amount, Amount] | None = None
    """Mean and standard deviation."""
    within: tuple[Amount, Amount] | None = None
    """Ends of the range that `normal` is cut to. Default: it is whole."""
    uniform: tuple[Amount, Amount] | None = None
    """Low and high end, all between equally likely."""
    triangular: tuple[Amount, Amount, Amount] | None = None
    """Low end, most likely value and high end."""
    values: Annotated[tuple[str | bool | int | float, ...], Field(min_length=1, max_length=1000)] | None = None
    """Some values: quantities, numbers or words."""
    weights: Annotated[tuple[Weight, ...], Field(max_length=1000)] = ()
    """Weight of each of the `values`. Default: all are alike."""
    file: CaseFile | None = None
    """Table of measured values (CSV), in SI or in the unit that stands in brackets behind the name of the column."""
    column: Annotated[str, Field(max_length=200)] = ""
    """Name of the column. Default: the only one."""
    tolerance_class: Annotated[int, Whole(1, 11)] | None = Field(default=None, alias="class")
    """Flank tolerance class of ISO 1328-1:2013, of a key of the errors of a gear: `pitch`, `runout`, `profile.slope`,
    `profile.form` and `helix.slope`. Slopes are normal with a third of their tolerance as standard deviation, cut at
    it; runout and form are of Rayleigh's distribution, all but 0.27 % within theirs, and cut there."""
    fit: Annotated[str, Field(max_length=10)] | None = None
    """Tolerance zone of ISO 286-1 about the length that the case has, such as "H7" or "k6": normal about the middle of
    the zone, its ends three standard deviations away, cut there."""
    size: Amount | None = None
    """Nominal size of a `fit` whose key is a deviation itself, as an interference: that of a shaft (a zone of a small
    letter) grows by the shaft's deviation, that of a housing (a capital one) falls by the bore's. Default: the key is
    the length."""
    factor: dict[Name, Factor] = Field(default={}, max_length=100)
    """Factor of entries that move together, by the name of the entry or its whole key path. Default: 1."""
    independent: StrictBool = False
    """Whether each entry of a key with `*` has a value of its own. Default: all have one."""

    @model_validator(mode="after")
    def _one_kind(self) -> Varied:
        given = [kind for kind in KINDS if getattr(self, _ATTRIBUTES.get(kind, kind)) is not None]
        if len(given) != 1:
            raise wrong(f"exactly one of {', '.join(map(repr, KINDS[:-1]))} and {KINDS[-1]!r}")
        for key, kind in _BELONGS_TO.items():
            if getattr(self, key) not in (None, (), "") and kind != given[0]:
                raise wrong(f"none without {kind!r}", key)
        if self.factor and self.independent:
            raise wrong("none beside independent = true: a factor is of entries that move together", "factor")
        return self

    @property
    def kind(self) -> str:
        """Kind of the distribution, as its key says it."""
        return next(kind for kind in KINDS if getattr(self, _ATTRIBUTES.get(kind, kind)) is not None)

    @property
    def words(self) -> str:
        """The distribution as the case gives it, in words: ``class 7``, ``normal 12 um ± 2 um``."""
        if self.tolerance_class is not None or self.fit is not None:
            return f"{self.kind} {self.fit or self.tolerance_class}"
        if self.normal is not None:
            cut = "" if self.within is None else f", within {self.within[0]} to {self.within[1]}"
            return f"normal {self.normal[0]} ± {self.normal[1]}{cut}"
        if self.values is not None:
            return ", ".join(map(str, self.values[:_LISTED])) + (", …" if len(self.values) > _LISTED else "")
        if self.file is not None:
            return f"measured, {self.file.name}" + (f", {self.column}" if self.column else "")
        return f"{self.kind} {' to '.join(map(str, self.uniform or self.triangular or ()))}"


class Correlation(Table):
    """`[[variation.correlation]]`: correlation of two varied keys."""

    keys: tuple[KeyPath, KeyPath]
    """The two keys, as they stand in `[variation.vary]`; of an `independent` one a single entry's."""
    coefficient: Annotated[float, Quantity(units.RATIO, at_least=-1.0, at_most=1.0)]
    """Correlation of the normal scores of the two."""


class Limit(Table):
    """`[variation.limit]`: range of a quantity within which a gearbox is good, in the unit at the end of its name."""

    at_most: Annotated[float, Quantity(units.RATIO)] | None = None
    """Largest value. One of this and `at_least`, or both."""
    at_least: Annotated[float, Quantity(units.RATIO)] | None = None
    """Least value. One of this and `at_most`, or both."""

    @model_validator(mode="after")
    def _has_an_end(self) -> Limit:
        if self.at_most is None and self.at_least is None:
            raise wrong("'at_most', 'at_least' or both")
        if self.at_most is not None and self.at_least is not None and self.at_most < self.at_least:
            raise wrong(f"a number of at least {self.at_least:g}, the least value", "at_most")
        return self

    def holds(self, value: float) -> bool:
        """Whether a value is within the range."""
        low = -math.inf if self.at_least is None else self.at_least
        high = math.inf if self.at_most is None else self.at_most
        return low <= value <= high


AnalysisName = Literal["gears", "load", "rotors", "mass", "modes", "lines", "sound", "motion"]


def _each_once(names: tuple[AnalysisName, ...]) -> tuple[AnalysisName, ...]:
    if not names or len(set(names)) < len(names):
        raise wrong("one analysis or more, each once")
    return names


Analyses = Annotated[tuple[AnalysisName, ...], AfterValidator(_each_once)]
QuantityPatterns = Annotated[tuple[Annotated[str, Field(min_length=1, max_length=200)], ...], Field(max_length=1000)]
MOST_SAMPLES = 10_000_000
MOST_KEYS = 500


class Variation(Table):
    """`[variation]`: gearboxes that differ as production makes them."""

    samples: Annotated[int, Whole(1, MOST_SAMPLES)] = 256
    """Number of gearboxes; powers of two cover the distributions most evenly."""
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 1
    """Seed of the samples. The same seed gives the same samples, the first ones whatever their number."""
    analyses: Analyses | None = None
    """What is found of each gearbox: "gears" (transmission error, mesh stiffness), "load" (operating point), "rotors"
    (critical speeds), "mass" (gears, shafts, housing), "modes" (natural frequencies of the machine under load), "lines"
    (levels at sensors by the linear machine under load), "sound" (sound power of its mesh harmonics, as `[acoustics]`
    says) and "motion" (levels at sensors by the transient). Default: gears, load and lines, as far as the case has
    them."""
    quantities: QuantityPatterns = ()
    """Names of the quantities that are found, `*` for any part of a name, such as
    "gear_pair.*.transmission_error_peak_to_peak_m"; what they do not need is not computed. Default: all of the
    analyses."""
    speed: Speeds | None = None
    """Speeds of "lines" and "sound", a range or a list. Default: those of `[sweep]`, else that of operation."""
    vary: dict[KeyPath, Varied] = Field(default={}, max_length=MOST_KEYS)
    """Distribution by key path; `*` stands for every entry."""
    correlation: tuple[Correlation, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Correlations between the keys. Default: none."""
    limit: dict[Annotated[str, Field(max_length=200)], Limit] = Field(default={}, max_length=1000)
    """Limits by the name of a quantity, such as "sensor.top.level_db"."""

    @property
    def speeds(self) -> tuple[float, ...]:
        """The speeds [rad/s]; none where they are those of the case."""
        return () if self.speed is None else listed(self.speed)

    @model_validator(mode="after")
    def _pairs_are_correlated_once(self) -> Variation:
        pairs = set[frozenset[str]]()
        for number, one in enumerate(self.correlation):
            pair = frozenset(one.keys)
            if len(pair) < 2 or pair in pairs:
                raise wrong("two different keys, and each pair once", "correlation", number, "keys")
            pairs.add(pair)
        return self


def built_distribution(varied: Varied) -> tuple[Distribution, str] | None:
    """Return a distribution whose numbers stand in the case, in the unit of its first number; None of another kind.

    Raises
    ------
    ValueError
        Where numbers do not measure the same, or are none that a distribution can have; the message is what was
        expected.
    """
    from gearwhine.numerics.distributions import DistributionError, Normal, Triangular, Uniform

    given = getattr(varied, varied.kind) if varied.kind in ("normal", "uniform", "triangular") else None
    if given is None:
        return None
    numbers, unit = in_one_unit((*given, *(varied.within or ())))
    count = len(given)
    kinds = {"normal": Normal, "uniform": Uniform, "triangular": Triangular}
    try:
        return kinds[varied.kind](*numbers[:count], *numbers[count:]), unit
    except DistributionError as error:
        words = [
            f"{one.expected} as {_NAMED.get(one.attribute, one.attribute)}, got {one.value:g}" for one in error.findings
        ]
        raise ValueError("; ".join(words) + (f", all in {unit}" if unit else "")) from None


def in_one_unit(amounts: tuple[float | str, ...]) -> tuple[list[float], str]:
    """Return amounts as numbers in the unit of the first, empty for plain numbers.

    Raises
    ------
    ValueError
        Where they do not measure the same.
    """
    parts = [(amount, "") if isinstance(amount, float) else units.split_quantity(amount) for amount in amounts]
    numbers, unit = list[float](), ""
    for place, part in enumerate(parts):
        number, own = part or (math.nan, "?")
        unit = own if place == 0 else unit
        ratio = units.unit_ratio(own, unit)
        if ratio is None:
            raise ValueError(
                f"numbers that measure the same as {amounts[0]!r}, with a unit each, got {amounts[place]!r}"
            )
        numbers.append(float(number) * float(ratio))
    return numbers, unit
