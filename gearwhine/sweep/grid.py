"""Grid of a sweep: what its results need to know of a point, of a case or of a machine of Python, and its outcome."""

from __future__ import annotations

from typing import Protocol

from gearwhine.sweep.solution import PointFailure, PointResult


class GridPoint(Protocol):
    """Combination of the swept values."""

    @property
    def place(self) -> tuple[int, ...]:
        """Index along each swept key."""
        ...

    @property
    def texts(self) -> tuple[str, ...]:
        """Value of each swept key."""
        ...

    @property
    def speed(self) -> float:
        """Signed speed of the first driver [rad/s]."""
        ...

    @property
    def file(self) -> str:
        """Name of its file; empty where it is not on file."""
        ...


class Solved(Protocol):
    """A point with its outcome, and whether that comes from an earlier run."""

    @property
    def point(self) -> GridPoint:
        """The point."""
        ...

    @property
    def outcome(self) -> PointResult | PointFailure:
        """Motion at the point, or why there is none."""
        ...

    @property
    def resumed(self) -> bool:
        """Whether the outcome comes from an earlier run."""
        ...
