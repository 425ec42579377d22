"""Grid of a sweep: a combination of the swept values, of a case or of a machine of Python, and its outcome."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from gearwhine.solutions import Failure
from gearwhine.sweep.points import GridPoint
from gearwhine.sweep.solution import PointResult

AnyPoint = TypeVar("AnyPoint", bound=GridPoint, covariant=True)


@dataclass(frozen=True)
class SweptPoint(Generic[AnyPoint]):
    """A point with its outcome, and whether that comes from an earlier run."""

    point: AnyPoint
    outcome: PointResult | Failure
    resumed: bool = False
