"""Rotor analyses of a case, `[rotor_analysis]`. Attributes are named as the keys and are in SI."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, model_validator

from gearwhine.case import units
from gearwhine.case.base_motion import Acceleration
from gearwhine.case.fields import (
    Angle,
    DampingRatio,
    LengthFromZero,
    Name,
    PositiveFrequency,
    PositiveStiffness,
    Quantity,
    Table,
    Whole,
    wrong,
)
from gearwhine.case.running import Speeds

MOST_PROBES = 100
MOST_ORDERS = 20

STANDARD_GRAVITY = 9.80665
"""The standard acceleration of free fall [m/s²]."""


class StiffnessMap(Table):
    """Bearing stiffnesses from `start` (key `from`) to `to` [N/m], both included, in `points` equal ratios.

    At each, the lowest `modes` critical speeds of forward or backward `whirl`.
    """

    model_config = ConfigDict(serialize_by_alias=True)

    start: PositiveStiffness = Field(alias="from")
    to: PositiveStiffness
    points: Annotated[int, Whole(2, 1000)] = 30
    modes: Annotated[int, Whole(1, 50)] = 4
    whirl: Literal["forward", "backward"] = "forward"

    @model_validator(mode="after")
    def _ascends(self) -> StiffnessMap:
        if self.to <= self.start:
            raise wrong(f"a stiffness above 'from', {self.start:g} N/m", "to")
        return self

    @property
    def stiffnesses(self) -> tuple[float, ...]:
        """Every stiffness of the map [N/m], ascending."""
        step = (self.to / self.start) ** (1.0 / (self.points - 1))
        return (*(self.start * step**place for place in range(self.points - 1)), self.to)


class Probe(Table):
    """A sensor of the shaft's displacement at a station [m from the rotor's left end], at an angle from x [rad]."""

    name: Name
    rotor: Name
    at: LengthFromZero
    angle: Angle = 0.0


class UnbalanceResponse(Table):
    """Speeds of the response to unbalance and bow (None: over the Campbell diagram's, finer), and what reads it."""

    speed: Speeds | None = None
    probes: tuple[Probe, ...] = Field(default=(), max_length=MOST_PROBES)


class FrequencyRange(Table):
    """Frequencies from `start` (key `from`) to `to` [Hz], both included, in `points` equal steps."""

    model_config = ConfigDict(serialize_by_alias=True)

    start: PositiveFrequency = Field(alias="from")
    to: PositiveFrequency
    points: Annotated[int, Whole(2, 100_000)] = 400

    @model_validator(mode="after")
    def _ascends(self) -> FrequencyRange:
        if self.to <= self.start:
            raise wrong(f"a frequency above 'from', {self.start:g} Hz", "to")
        return self

    @property
    def frequencies(self) -> tuple[float, ...]:
        """Every frequency of the range [Hz], ascending."""
        step = (self.to - self.start) / (self.points - 1)
        return (*(self.start + step * place for place in range(self.points - 1)), self.to)


class HarmonicTorque(Table):
    """A torque [N m] about the axis of a rotor at a station [m], that swings ahead by a phase [rad]."""

    rotor: Name
    at: LengthFromZero
    amplitude: Annotated[float, Quantity(units.TORQUE, above=0.0)]
    phase: Angle = 0.0


class TorsionSpring(Table):
    """Torsional support of a rotor at a station [m] against the ground: stiffness [N m/rad], damping [N m s/rad]."""

    rotor: Name
    at: LengthFromZero
    stiffness: Annotated[float, Quantity(units.TILT_STIFFNESS, at_least=0.0)] = 0.0
    damping: Annotated[float, Quantity(units.TILT_DAMPING, at_least=0.0)] = 0.0


class TorsionProbe(Table):
    """A station [m from the rotor's left end] at which angle and torque are wanted."""

    name: Name
    rotor: Name
    at: LengthFromZero


class TorsionalAnalysis(Table):
    """Steady answer of each rotor's torsion to torques that swing at a frequency.

    Without `frequency`, up to beyond the third elastic mode. `damping_ratio` is that of the shafts (None: each rotor's
    own). Without probes, one stands at each torque and one at either end.
    """

    torques: tuple[HarmonicTorque, ...] = Field(min_length=1, max_length=MOST_PROBES)
    frequency: FrequencyRange | None = None
    damping_ratio: DampingRatio | None = None
    springs: tuple[TorsionSpring, ...] = Field(default=(), max_length=MOST_PROBES)
    probes: tuple[TorsionProbe, ...] = Field(default=(), max_length=MOST_PROBES)


class RotorAnalysis(Table):
    """`[rotor_analysis]`: speeds of the first driver's rotor, and what is wanted beside the modes.

    `orders` are the multiples of the speed of rotation that the Campbell diagram shows with their critical speeds;
    that of once a revolution is always among them. `modes` is how many lateral ones (None: 12, or all of a small lumped
    rotor). Without `speed` the Campbell diagram has the speeds of `[sweep]`, else those up to one and a half times the
    speed of operation. `gravity` is an acceleration along x, y, z [m/s²].
    """

    speed: Speeds | None = None
    modes: Annotated[int, Whole(1, 200)] | None = None
    orders: tuple[Annotated[float, Quantity(units.RATIO, above=0.0, at_most=1000.0)], ...] = Field(
        default=(), max_length=MOST_ORDERS
    )
    stiffness_map: StiffnessMap | None = None
    torsional_response: TorsionalAnalysis | None = None
    unbalance_response: UnbalanceResponse = UnbalanceResponse()
    gravity: tuple[Acceleration, Acceleration, Acceleration] = (0.0, -STANDARD_GRAVITY, 0.0)
