"""Model updating of a case, `[update]`: the fitted parameters, and the modes they are fitted to."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, GetCoreSchemaHandler, StrictBool, model_validator
from pydantic_core import core_schema

from gearwhine.case import units
from gearwhine.case.fields import MOST_ENTRIES, Name, PositiveFrequency, PositiveLength, Quantity, Table, Whole, wrong
from gearwhine.case.overrides import parse_key_path


class _AmountRule:
    """Validates a quantity of any kind, kept as it is written: text with a unit, or a plain number in SI."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.validate)

    def validate(self, value: object) -> str | float:
        if units.si_amount(value) is None:
            raise wrong("a quantity such as '12 mm', or a plain number in SI")
        assert isinstance(value, (str, int, float))
        return value if isinstance(value, str) else float(value)


class _KeyRule:
    """Validates a key path."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.validate)

    def validate(self, value: object) -> str:
        if not isinstance(value, str) or parse_key_path(value) is None:
            raise wrong("a key path of this case, such as 'housing.box.wall.top' ('*' stands for any entry)")
        return value


Amount = Annotated[str | float, _AmountRule()]
KeyPath = Annotated[str, _KeyRule()]


class UpdateParameter(Table):
    """`[[update.parameter]]`: a number that is fitted, at one key path or several that take the same value.

    `range` may not be left. The prior is `nominal` give or take `spread`: by default what the case has, and a third of
    the larger distance from there to an end of the range. With `factor` the keys' own numbers are multiplied by it.
    """

    name: Name
    keys: tuple[KeyPath, ...] = Field(min_length=1, max_length=1000)
    range: tuple[Amount, Amount]
    nominal: Amount | None = None
    spread: Amount | None = None
    factor: StrictBool = False

    @model_validator(mode="after")
    def _of_one_kind(self) -> UpdateParameter:
        given = [("range", self.range[0]), ("range", self.range[1]), ("nominal", self.nominal), ("spread", self.spread)]
        if len({units.kind_of(value) for _, value in given if value is not None}) > 1:
            raise wrong("range, nominal and spread that measure the same", "range")
        low, high = self.bounds
        if not low < high:
            raise wrong("a range that ascends", "range")
        if self.nominal is not None and not low <= units.amount(self.nominal) <= high:
            raise wrong("a nominal value within the range", "nominal")
        if self.spread is not None and units.amount(self.spread) <= 0.0:
            raise wrong("a spread above 0", "spread")
        if self.factor and low <= 0.0:
            raise wrong("factors above 0", "range")
        return self

    @property
    def bounds(self) -> tuple[float, float]:
        """The range in SI."""
        return units.amount(self.range[0]), units.amount(self.range[1])

    @property
    def unit(self) -> str:
        """In which unit it is written; empty for plain numbers."""
        parts = units.split_quantity(self.range[0]) if isinstance(self.range[0], str) else None
        return parts[1] if parts is not None else ""


class ModelModes(Table):
    """Number of model modes below a frequency [Hz]: from `least` to `most`."""

    below: PositiveFrequency
    least: Annotated[int, Whole(0, MOST_ENTRIES)]
    most: Annotated[int, Whole(0, MOST_ENTRIES)]

    @model_validator(mode="after")
    def _ascends(self) -> ModelModes:
        if self.most < self.least:
            raise wrong(f"at least the {self.least} of 'least'", "most")
        return self


class Update(Table):
    """`[update]`: the parameters, how well frequencies were measured, and what else the model has to meet.

    `frequency_noise` is the relative standard deviation of a measured frequency together with what a perfect model
    would still miss; `shape_noise` that of each motion of a measured shape, as a part of the shape's root-mean-square.
    The search is made with elements of `mesh_size` (None: the box's own), whose bias is taken off, and the box's own
    judge. `gap` is the least gap of dominance, `modes` how many are taken along, `solves` how many designs are solved
    on the search's mesh at most, `explore` how many starts there are beside the case's own, and `seed` that of their
    draws and of the random starts on the surrogate.
    """

    parameter: tuple[UpdateParameter, ...] = Field(min_length=1, max_length=200)
    frequency_noise: Annotated[float, Quantity(units.RATIO, above=0.0, below=1.0)] = 0.005
    shape_noise: Annotated[float, Quantity(units.RATIO, above=0.0, below=1.0)] = 0.05
    mesh_size: PositiveLength | None = None
    gap: Annotated[float, Quantity(units.RATIO, at_least=0.0)] = 0.15
    model_modes: ModelModes | None = None
    modes: Annotated[int, Whole(2, 1000)] = 48
    solves: Annotated[int, Whole(1, 10_000)] = 40
    explore: Annotated[int, Whole(0, 10_000)] = 0
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 1

    @model_validator(mode="after")
    def _named_once(self) -> Update:
        names = [parameter.name for parameter in self.parameter]
        for index, name in enumerate(names):
            if name in names[:index]:
                raise wrong("a name of its own for each parameter", "parameter", index, "name")
        return self
