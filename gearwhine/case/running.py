"""Operation, transient and sweep of a case.

Attributes are named as the keys and are in SI; speeds in rad/s.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator

from gearwhine.case import units
from gearwhine.case.base_motion import Acceleration, Base
from gearwhine.case.fields import (
    MOST_ENTRIES,
    LengthFromZero,
    Name,
    Quantity,
    Speed,
    SpeedFromZero,
    Table,
    Whole,
    wrong,
)
from gearwhine.case.torques import Run, SignedTorque, TorqueHistory, TorqueLine, TorqueRipple


class Output(Table):
    """`[[operation.output]]`: a torque taken off a rotor [N m], at a station [m]; None: its right end.

    `over_time` is added to it, `ripple` swings about it.
    """

    rotor: Name
    torque: SignedTorque
    at: LengthFromZero | None = None
    over_time: TorqueHistory | None = None
    ripple: tuple[TorqueRipple, ...] = Field(default=(), max_length=MOST_ENTRIES)


class Operation(Table):
    """`[operation]`: speed [rad/s] and torque [N m] of the first driver's rotor.

    Positive speeds are counter-clockwise seen from +z. The torque drives in the direction of turning, or brakes where
    it is negative, at station `at` [m] (None: the left end). Without outputs, the rotors that drive no other share the
    power equally.
    `over_time` is added to the torque, and the outputs take it in their proportions unless one has its own; `ripple`
    swings about it. `motor` and `load` are torque over speed of a run whose speed is free: what drives, and what
    the outputs together take, both at the first driver's rotor (without `load`: `torque`, whatever the speed).
    `base` moves the ground; `gravity` is an acceleration along x, y, z [m/s²], None for none.
    """

    speed: Speed
    torque: SignedTorque = 0.0
    at: LengthFromZero | None = None
    over_time: TorqueHistory | None = None
    ripple: tuple[TorqueRipple, ...] = Field(default=(), max_length=MOST_ENTRIES)
    motor: TorqueLine | None = None
    load: TorqueLine | None = None
    base: Base | None = None
    gravity: tuple[Acceleration, Acceleration, Acceleration] | None = None
    output: tuple[Output, ...] = Field(default=(), max_length=1000)


_SHORTEST_RECORD = 0.01  # revolutions


def _half_the_run(data: dict[str, Any]) -> float:
    return float(data.get("revolutions") or 0.0) / 2.0


class Transient(Table):
    """`[transient]`: revolutions of the first driver's rotor, those discarded, and the steps.

    `start`: from static equilibrium under the load, or from turning unloaded, so that the load comes on at once.
    `modal_coordinates`: how many of each part's modes to record in time. `method`: Newmark's steps, the exact march
    between tooth events, or `auto`, the exact one where it applies.

    With a `run` the speed varies over its time, in place of a number of revolutions; then none is discarded by default.
    """

    revolutions: Annotated[float, Quantity(units.RATIO, above=0.0, at_most=1e6)] | None = None
    run: Run | None = None
    discard: Annotated[float, Quantity(units.RATIO, at_least=0.0)] = Field(default_factory=_half_the_run)
    points_per_revolution: Annotated[int, Whole(200, 1_000_000)] = 200
    tolerance: Annotated[float, Quantity(units.RATIO, above=0.0, at_most=0.1)] = 5e-4
    start: Literal["equilibrium", "unloaded"] = "equilibrium"
    method: Literal["newmark", "exact", "auto"] = "newmark"
    modal_coordinates: Annotated[int, Whole(0, 1000)] = 0

    @model_validator(mode="after")
    def _something_left(self) -> Transient:
        if self.run is not None and self.revolutions is not None:
            raise wrong("no number of revolutions beside a 'run', which has its own time", "revolutions")
        if self.revolutions is None:
            if self.run is None:
                raise wrong("a plain number above 0 of revolutions, or a 'run'", "revolutions")
            return self
        if self.discard >= self.revolutions:
            raise wrong(f"fewer revolutions than the {self.revolutions:g} of the run", "discard")
        if self.revolutions - self.discard < _SHORTEST_RECORD:
            told = f"{_SHORTEST_RECORD:g} or more revolutions than 'discard', which are recorded"
            raise wrong(told, "revolutions")
        return self


class SpeedRange(Table):
    """Speeds from `start` (key `from`) to `to` by `step` [rad/s], both ends included."""

    model_config = ConfigDict(serialize_by_alias=True)

    start: SpeedFromZero = Field(alias="from")
    to: SpeedFromZero
    step: Speed

    @model_validator(mode="after")
    def _leads_there(self) -> SpeedRange:
        span = self.to - self.start
        if self.step == 0.0 or span * self.step < 0.0:
            raise wrong("a step that leads from 'from' to 'to'", "step")
        if span / self.step > MOST_ENTRIES:
            raise wrong(f"a step that makes at most {MOST_ENTRIES} speeds", "step")
        return self


def _range_or_list(value: Any) -> str:
    return "~table" if isinstance(value, (dict, Table)) else "~list"


Speeds = Annotated[
    Annotated[SpeedRange, Tag("~table")]
    | Annotated[tuple[SpeedFromZero, ...], Tag("~list"), Field(min_length=1, max_length=MOST_ENTRIES)],
    Discriminator(_range_or_list),
]
"""Speeds as a range or as a list [rad/s]."""


def listed(speeds: SpeedRange | tuple[float, ...]) -> tuple[float, ...]:
    """Return every speed of a range or list [rad/s], in order."""
    if not isinstance(speeds, SpeedRange):
        return speeds
    count = math.floor((speeds.to - speeds.start) / speeds.step + 1e-9) + 1
    return tuple(speeds.start + index * speeds.step for index in range(count))


class Sweep(Table):
    """`[sweep]`: the speeds to go through, as a range or a list."""

    speed: Speeds

    @property
    def speeds(self) -> tuple[float, ...]:
        """Every speed of the sweep [rad/s], in order."""
        return listed(self.speed)
