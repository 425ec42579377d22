"""The `[rotor_analysis]` table: what `gearwhine rotors` looks at. Attributes are named as the keys and are in SI."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Field, model_validator

from gearwhine.case.base_motion import Acceleration
from gearwhine.case.fields import Angle, LengthFromZero, Name, PositiveStiffness, Table, Whole, wrong
from gearwhine.case.running import Speeds

MOST_PROBES = 100

STANDARD_GRAVITY = 9.80665
"""The standard acceleration of free fall [m/s²]."""


class StiffnessMap(Table):
    """Bearing stiffnesses from `start` (key `from`) to `to` [N/m], both included, in `points` equal ratios."""

    model_config = ConfigDict(serialize_by_alias=True)

    start: PositiveStiffness = Field(alias="from")
    to: PositiveStiffness
    points: Annotated[int, Whole(2, 1000)] = 30

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


class RotorAnalysis(Table):
    """`[rotor_analysis]`: speeds of the first driver's rotor, and what is wanted beside the modes.

    `modes` is how many lateral ones (None: 12, or all of a small lumped rotor). Without `speed` the Campbell diagram
    has the speeds of `[sweep]`, else those up to one and a half times the speed of operation. `gravity` is an
    acceleration along x, y, z [m/s²].
    """

    speed: Speeds | None = None
    modes: Annotated[int, Whole(1, 200)] | None = None
    stiffness_map: StiffnessMap | None = None
    unbalance_response: UnbalanceResponse = UnbalanceResponse()
    gravity: tuple[Acceleration, Acceleration, Acceleration] = (0.0, -STANDARD_GRAVITY, 0.0)
