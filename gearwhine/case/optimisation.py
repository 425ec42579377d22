"""Design optimisation of a case, `[optimisation]`: designed keys, aims and limits of what follows from them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StrictBool, field_validator, model_validator

from gearwhine.case import units
from gearwhine.case.fields import Name, Quantity, Table, Whole, wrong
from gearwhine.case.measured import Amount, KeyPath
from gearwhine.case.operation import Speeds, listed
from gearwhine.case.variation import MOST_KEYS, Analyses, Factor, Limit, QuantityPatterns

QuantityName = Annotated[str, Field(max_length=200)]
Choices = Annotated[tuple[str | bool | int | float, ...], Field(min_length=1, max_length=1000)]
Method = Literal["search", "grid"]
MOST_EVALUATIONS = 1_000_000
MOST_AIMS = 10


class DesignKey(Table):
    """`[optimisation.design]`: values that a key may have; a `range` or a list of `values`."""

    range: tuple[Amount, Amount] | None = None
    """Least and largest value."""
    values: Choices | None = None
    """All values: quantities, numbers, numbers of teeth, words such as types of bearings."""
    levels: Annotated[int, Whole(2, 10_000)] = 5
    """Number of values of a `range`, its ends among them, that a grid takes."""
    along: dict[KeyPath, Choices] = Field(default={}, alias="with", max_length=100)
    """Keys that change in step with the `values`: a list of as many values by key path."""
    factor: dict[Name, Factor] = Field(default={}, max_length=100)
    """Factor of entries that move together, by the name of the entry or its whole key path. Default: 1."""
    independent: StrictBool = False
    """Whether each entry of a key with `*` has a value of its own. Default: all have one."""

    @model_validator(mode="after")
    def _one_kind(self) -> DesignKey:
        if (self.range is None) == (self.values is None):
            raise wrong("either 'range' or 'values'")
        if self.values is not None and len(set(map(repr, self.values))) < len(self.values):
            raise wrong("each value once", "values")
        if self.along and self.values is None:
            raise wrong("none beside a range: they change in step with 'values'", "with")
        if self.along and self.independent:
            raise wrong("none beside independent = true", "with")
        for key, values in self.along.items():
            if len(values) != len(self.values or ()):
                raise wrong(f"{len(self.values or ())} values, one for each of 'values'", "with", key)
        if self.factor and self.independent:
            raise wrong("none beside independent = true: a factor is of entries that move together", "factor")
        return self


class Aim(Table):
    """`[optimisation.aim]`: a quantity that is to be as small or as large as can be."""

    sense: Literal["least", "most"]
    """Whether less or more is better."""
    weight: Annotated[float, Quantity(units.RATIO, above=0.0)] | None = None
    """Worth of one unit of the quantity beside the other aims: with weights on all, their weighted sum is the aim.
    Default: none; several aims without weights have a Pareto front."""


class Robust(Table):
    """`[optimisation.robust]`: each design is judged by gearboxes that scatter about it as `[variation]` says.

    Aims and limits take the side of the scatter that is worse: of a quantity to be small its mean and some standard
    deviations more, or its quantile; of one to be large as much less. Names such as "mean of sensor.top.level_db" and
    "yield" take one statistic.
    """

    samples: Annotated[int, Whole(2, 100_000)] = 16
    """Number of gearboxes about each design."""
    deviations: Annotated[float, Quantity(units.RATIO, at_least=0.0)] | None = None
    """Standard deviations from the mean. This or `quantile`. Default: 2 without a `quantile`."""
    quantile: Annotated[float, Quantity(units.RATIO, above=0.5, below=1.0)] | None = None
    """Part of the gearboxes that are no worse."""

    @model_validator(mode="after")
    def _one_measure(self) -> Robust:
        if self.deviations is not None and self.quantile is not None:
            raise wrong("either 'deviations' or 'quantile'")
        return self

    @property
    def reach(self) -> float:
        """Standard deviations from the mean, where there is no quantile."""
        return 2.0 if self.deviations is None else self.deviations


class Optimisation(Table):
    """`[optimisation]`: which design is best."""

    method: Method = "search"
    """"search", for one aim by differential evolution and a trust region, for several by NSGA-II; or "grid", every
    combination of the values and levels."""
    evaluations: Annotated[int, Whole(1, MOST_EVALUATIONS)] = 100
    """Largest number of designs that a search tries."""
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 1
    """Seed of the search. The same seed gives the same designs."""
    analyses: Analyses | None = None
    """What is found of each design, as in `[variation]`. Default: what aims and limits name."""
    quantities: QuantityPatterns = ()
    """Names of the quantities that are found beside those of aims and limits, as in `[variation]`; what they do not
    need is not computed. Default: all of the analyses."""
    speed: Speeds | None = None
    """Speeds of levels at sensors and of the sound, a range or a list. Default: those of `[sweep]`, else that of
    operation."""
    design: dict[KeyPath, DesignKey] = Field(default={}, max_length=MOST_KEYS)
    """Values by key path; `*` stands for every entry."""
    aim: dict[QuantityName, Aim] = Field(default={}, max_length=MOST_AIMS)
    """Aims by the name of a quantity. With `*` in the name the worst of the quantities is meant. With `[optimisation.
    robust]` also "mean of", "standard deviation of" or "quantile 0.95 of" a quantity over the gearboxes about a design,
    and "yield", the part of them within all of `[variation.limit]`."""
    limit: dict[QuantityName, Limit] = Field(default={}, max_length=1000)
    """Limits by the name of a quantity, or of a statistic as of aims. With `*` in the name each of the quantities has
    it."""
    robust: Robust | None = None
    """Scatter about each design. Default: none."""
    verify: StrictBool = True
    """Whether the transient of the start and of the proposed designs is solved at the end."""

    @property
    def speeds(self) -> tuple[float, ...]:
        """The speeds [rad/s]; none where they are those of the case."""
        return () if self.speed is None else listed(self.speed)

    @field_validator("aim", mode="after")
    @classmethod
    def _weights_on_all_or_none(cls, aims: dict[str, Aim]) -> dict[str, Aim]:
        weighted = [name for name, aim in aims.items() if aim.weight is not None]
        if weighted and len(weighted) < len(aims):
            missing = next(name for name in aims if name not in weighted)
            raise wrong("a weight beside those of the other aims, or none on all", missing, "weight")
        return aims
