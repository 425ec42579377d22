"""Directions in a case: an axis by its letter, or a vector of any length."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Tag

from gearwhine.case.fields import PlainNumber, wrong

UnitVector = tuple[float, float, float]


def _direction_form(value: Any) -> str:
    return "~list" if isinstance(value, (list, tuple)) else "~axis"


def _has_length(vector: UnitVector) -> UnitVector:
    if not 1e-100 < math.hypot(*vector) < 1e100:
        raise wrong("a vector with a direction")
    return vector


Vector = Annotated[tuple[PlainNumber, PlainNumber, PlainNumber], AfterValidator(_has_length)]
"""A vector of some length."""

Direction = Annotated[
    Annotated[Literal["x", "y", "z"], Tag("~axis")] | Annotated[Vector, Tag("~list")],
    Discriminator(_direction_form),
]
"""'x', 'y', 'z' or a vector of some length."""


def unit_vector(direction: str | UnitVector) -> UnitVector:
    """Return a direction as a unit vector."""
    if isinstance(direction, str):
        return (float(direction == "x"), float(direction == "y"), float(direction == "z"))
    x, y, z = direction
    length = math.hypot(x, y, z)
    return (x / length, y / length, z / length)
