"""Torques over time and speed, torque ripple, and the speed profile of a run. All in SI, speeds in rad/s."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated

from pydantic import ConfigDict, Field, model_validator

from gearwhine.case import units
from gearwhine.case.fields import MOST_ENTRIES, Angle, PositiveFrequency, Quantity, SpeedFromZero, Table, wrong

if TYPE_CHECKING:
    import coupling

Time = Annotated[float, Quantity(units.TIME, at_least=0.0, at_most=1e6)]
PositiveTime = Annotated[float, Quantity(units.TIME, above=0.0, at_most=1e6)]
SignedTorque = Annotated[float, Quantity(units.TORQUE)]
Order = Annotated[float, Quantity(units.RATIO, above=0.0, at_most=1e4)]


class TorqueLine(Table):
    """A torque over the speed of the first driver's rotor [N m over rad/s]: linear between, constant beyond."""

    speed: tuple[SpeedFromZero, ...] = Field(min_length=2, max_length=MOST_ENTRIES)
    torque: tuple[SignedTorque, ...] = Field(max_length=MOST_ENTRIES)

    @model_validator(mode="after")
    def _a_line(self) -> TorqueLine:
        _check_table("speed", self.speed, "torque", self.torque)
        return self


class TorqueHistory(Table):
    """Torque added over time [N m over s]: linear between the times, constant beyond."""

    time: tuple[Time, ...] = Field(min_length=1, max_length=MOST_ENTRIES)
    torque: tuple[SignedTorque, ...] = Field(max_length=MOST_ENTRIES)

    @model_validator(mode="after")
    def _a_line(self) -> TorqueHistory:
        _check_table("time", self.time, "torque", self.torque)
        return self

    def build(self, rotor: str, at: float, factor: float) -> coupling.TorqueHistory:
        """The history, times a factor, on a rotor at a station [m]."""
        from numpy import array

        from coupling import TorqueHistory as BuiltHistory

        return BuiltHistory(rotor, at, array(self.time), factor * array(self.torque))


class TorqueRipple(Table):
    """Harmonic ripple of a torque: amplitude [N m], phase [rad], and an order of its shaft or a frequency [Hz]."""

    amplitude: SignedTorque
    phase: Angle = 0.0
    order: Order | None = None
    frequency: PositiveFrequency | None = None

    @model_validator(mode="after")
    def _one_pace(self) -> TorqueRipple:
        if (self.order is None) == (self.frequency is None):
            raise wrong("either an 'order' of the shaft's rotation or a 'frequency'", "order")
        return self

    def build(self, rotor: str, at: float, sense: float) -> coupling.TorqueRipple:
        """The ripple on a rotor at a station [m], in the sense of the torque that it is about."""
        from coupling import TorqueRipple as BuiltRipple

        frequency = None if self.frequency is None else 2.0 * math.pi * self.frequency
        amplitude = math.copysign(self.amplitude, sense * self.amplitude)
        return BuiltRipple(rotor, at, amplitude, self.phase, self.order, frequency)


class Run(Table):
    """`[transient.run]`: how the speed of the first driver's rotor varies, in the sense of `[operation] speed`.

    From `start` (key `from`) to `to` in `time` [s]; or by `speeds` at `times`; or free from `start` on for `time`, the
    motor against the load.
    """

    model_config = ConfigDict(serialize_by_alias=True)

    start: SpeedFromZero | None = Field(default=None, alias="from")
    to: SpeedFromZero | None = None
    time: PositiveTime | None = None
    times: tuple[Time, ...] = Field(default=(), max_length=MOST_ENTRIES)
    speeds: tuple[SpeedFromZero, ...] = Field(default=(), max_length=MOST_ENTRIES)

    @model_validator(mode="after")
    def _one_form(self) -> Run:
        if not (self.times or self.speeds):
            for key, value, what in (("from", self.start, "a speed to start from"), ("time", self.time, "a time")):
                if value is None:
                    raise wrong(f"{what}, or a table of 'times' and 'speeds'", key)
            if self.to == 0.0 == self.start:
                raise wrong("a speed other than zero at one end", "to")
            return self
        for key, value in (("from", self.start), ("to", self.to), ("time", self.time)):
            if value is not None:
                raise wrong("no such key beside 'times' and 'speeds'", key)
        _check_table("times", self.times, "speeds", self.speeds)
        if len(self.times) < 2 or self.times[0] != 0.0:
            raise wrong("two times or more, the first of them 0 s", "times")
        if not any(self.speeds):
            raise wrong("a speed other than zero", "speeds")
        return self

    @property
    def free(self) -> bool:
        """Whether the speed follows from the motor and the load."""
        return not self.times and self.to is None

    @property
    def duration(self) -> float:
        """[s]."""
        return self.times[-1] if self.time is None else self.time

    @property
    def line(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Times [s] and speeds [rad/s] between which the speed is linear; of a free run its start alone."""
        if self.times:
            return self.times, self.speeds
        assert self.start is not None
        if self.to is None:
            return (0.0,), (self.start,)
        return (0.0, self.duration), (self.start, self.to)


def _check_table(key: str, places: tuple[float, ...], other: str, values: tuple[float, ...]) -> None:
    """Raise for a table that does not ascend, or whose lists differ in length."""
    if len(values) != len(places):
        raise wrong(f"one value for each entry of '{key}', {len(places)} (there are {len(values)})", other)
    if any(after <= before for before, after in pairwise(places)):
        raise wrong("entries that ascend", key)
