"""Base motion of a case, `[operation.base]`: accelerations of the ground. All in SI, frequencies in Hz."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, model_validator

from gearwhine.case import units
from gearwhine.case.fields import MOST_ENTRIES, Angle, Point, PositiveFrequency, Quantity, Table, wrong
from gearwhine.case.torques import Time

if TYPE_CHECKING:
    import coupling

COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")

Acceleration = Annotated[float, Quantity(units.ACCELERATION, at_least=-1e4, at_most=1e4)]
AngularAcceleration = Annotated[float, Quantity(units.ANGULAR_ACCELERATION, at_least=-1e4, at_most=1e4)]
Accelerations = Annotated[tuple[Acceleration, ...], Field(max_length=MOST_ENTRIES)]
AngularAccelerations = Annotated[tuple[AngularAcceleration, ...], Field(max_length=MOST_ENTRIES)]


class BaseHarmonic(Table):
    """Accelerations along and about x, y, z [m/s², rad/s²] that swing at a frequency [Hz], ahead by a phase [rad]."""

    frequency: PositiveFrequency
    x: Acceleration = 0.0
    y: Acceleration = 0.0
    z: Acceleration = 0.0
    rx: AngularAcceleration = 0.0
    ry: AngularAcceleration = 0.0
    rz: AngularAcceleration = 0.0
    phase: Angle = 0.0

    @property
    def amplitudes(self) -> tuple[float, ...]:
        """x, y, z, rx, ry, rz."""
        return tuple(getattr(self, name) for name in COMPONENTS)


class BaseHistory(Table):
    """Accelerations over time [s], a list for each component that moves: linear between, constant beyond."""

    time: tuple[Time, ...] = Field(min_length=1, max_length=MOST_ENTRIES)
    x: Accelerations = ()
    y: Accelerations = ()
    z: Accelerations = ()
    rx: AngularAccelerations = ()
    ry: AngularAccelerations = ()
    rz: AngularAccelerations = ()

    @model_validator(mode="after")
    def _of_one_length(self) -> BaseHistory:
        if any(after <= before for before, after in pairwise(self.time)):
            raise wrong("times that ascend", "time")
        for name in COMPONENTS:
            count = len(getattr(self, name))
            if count not in (0, len(self.time)):
                raise wrong(f"one value for each of the {len(self.time)} times (there are {count})", name)
        return self

    @property
    def rows(self) -> tuple[tuple[float, ...], ...]:
        """Lists of x, y, z, rx, ry, rz, zeros where there is none."""
        return tuple(getattr(self, name) or (0.0,) * len(self.time) for name in COMPONENTS)


class Base(Table):
    """`[operation.base]`: how the ground moves at a point of it [m] and about axes through this point."""

    point: Point = (0.0, 0.0, 0.0)
    harmonic: tuple[BaseHarmonic, ...] = Field(default=(), max_length=MOST_ENTRIES)
    over_time: BaseHistory | None = None

    @property
    def tilts(self) -> bool:
        """Whether it turns about x or y."""
        rows = [one.amplitudes for one in self.harmonic]
        turning = any(row[3] or row[4] for row in rows)
        return turning or (self.over_time is not None and any(map(any, self.over_time.rows[3:5])))

    def build(self) -> coupling.BaseMotion:
        """The motion of the ground."""
        import numpy as np

        from coupling import BaseHarmonic as BuiltHarmonic
        from coupling import BaseHistory as BuiltHistory
        from coupling import BaseMotion

        parts: list[BuiltHarmonic | BuiltHistory] = [
            BuiltHarmonic(2.0 * math.pi * one.frequency, np.array(one.amplitudes) * np.exp(1j * one.phase))
            for one in self.harmonic
        ]
        if self.over_time is not None:
            parts.append(BuiltHistory(np.array(self.over_time.time), np.array(self.over_time.rows).T))
        return BaseMotion(tuple(parts), self.point)
