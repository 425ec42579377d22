"""Coefficients over speed: one quantity, or a list with one for each speed of a table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import core_schema

from gearwhine.case.fields import MOST_ENTRIES, Quantity, wrong

Coefficient = float | tuple[float, ...]
"""A constant, or one value for each of some speeds."""


@dataclass(frozen=True)
class OverSpeed:
    """Validates a quantity, or a list with one for each speed of a table; to stand in `Annotated`."""

    each: Quantity

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        """Schema for pydantic: validation and serialisation of this field."""
        writer = core_schema.plain_serializer_function_ser_schema(self.write, when_used="json")
        return core_schema.no_info_plain_validator_function(self.validate, serialization=writer)

    @property
    def expected(self) -> str:
        """Expected value, in words."""
        return self.each.expected

    def write(self, given: Coefficient) -> str | float | list[str | float]:
        """Return the quantity, or each of the list, as text with its unit."""
        return [self.each.write(number) for number in given] if isinstance(given, tuple) else self.each.write(given)

    def validate(self, value: object) -> Coefficient:
        """Return the quantity or quantities in SI, or raise pydantic's error with what was expected and where."""
        if isinstance(value, (list, tuple)):
            if len(value) > MOST_ENTRIES:
                raise wrong(f"at most {MOST_ENTRIES} entries")
            return tuple(self.each.validate_at(entry, place) for place, entry in enumerate(value))
        return self.each.validate(value)
