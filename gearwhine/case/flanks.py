"""Flank modifications, manufacturing errors and faults of a `[[gear]]`; each builds its object of `coupling.gears`."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, field_validator, model_validator

from gearwhine.case import units
from gearwhine.case.fields import Angle, LengthFromZero, PositiveLength, Quantity, Table, Whole, wrong

if TYPE_CHECKING:
    import coupling.gears

Deviation = Annotated[float, Quantity(units.LENGTH, at_least=-1e-3, at_most=1e-3)]
RollAngle = Annotated[float, Quantity(units.ANGLE, at_least=0.0, at_most=2.0 * math.pi)]
Waves = Annotated[float, Quantity(units.RATIO, at_least=0.0, at_most=100.0)]


class Relief(Table):
    """Tip or root relief: its depth where the flank ends [m], and where it begins.

    By the roll angle [rad] or by the length along the line of action from the flank's end [m].
    """

    amount: LengthFromZero
    start_roll_angle: Annotated[float, Quantity(units.ANGLE, above=0.0, at_most=2.0 * math.pi)] | None = None
    length: PositiveLength | None = None
    shape: Literal["linear", "parabolic"] = "linear"

    @model_validator(mode="after")
    def _one_start(self) -> Relief:
        if (self.start_roll_angle is None) == (self.length is None):
            raise wrong("exactly one of 'start_roll_angle' and 'length'")
        return self

    def build_tip_relief(self) -> coupling.gears.TipRelief:
        """The relief as one of a tip."""
        from coupling.gears import TipRelief

        return TipRelief(**self.model_dump())

    def build_root_relief(self) -> coupling.gears.RootRelief:
        """The relief as one of a root."""
        from coupling.gears import RootRelief

        return RootRelief(**self.model_dump())


class ProfileErrors(Table):
    """Deviations along the profile [m], positive where there is too much material, as an inspection reports them.

    `slope` from the foot to the tip, `form` the height of `waves` waves, `crowning` what is taken off at both ends;
    `table`: rows of roll angle and deviation.
    """

    slope: Deviation = 0.0
    form: LengthFromZero = 0.0
    waves: Waves = 3.0
    phase: Angle = 0.0
    crowning: Deviation = 0.0
    table: Annotated[tuple[tuple[RollAngle, Deviation], ...], Field(max_length=2000)] = ()

    @field_validator("table", mode="after")
    @classmethod
    def _ascending(cls, rows: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        if len(rows) == 1 or any(after[0] <= before[0] for before, after in itertools.pairwise(rows)):
            raise wrong("two rows or more of a roll angle and a deviation, the roll angles increasing")
        return rows

    def build(self) -> coupling.gears.ProfileDeviation:
        """The deviation of the profile."""
        from coupling.gears import ProfileDeviation

        return ProfileDeviation(**self.model_dump())


class HelixErrors(Table):
    """Deviations across the face [m], positive where there is too much material.

    `slope` from the end of smaller z to the other, `crowning` what is taken off at both ends, `end_relief` the same
    over an `end_relief_length`.
    """

    slope: Deviation = 0.0
    crowning: Deviation = 0.0
    end_relief: LengthFromZero = 0.0
    end_relief_length: LengthFromZero = 0.0

    @model_validator(mode="after")
    def _relief_has_length(self) -> HelixErrors:
        if self.end_relief > 0.0 and self.end_relief_length == 0.0:
            raise wrong("the length of the end relief", "end_relief_length")
        return self

    def build(self) -> coupling.gears.HelixDeviation:
        """The deviation across the face."""
        from coupling.gears import HelixDeviation

        return HelixDeviation(**self.model_dump())


class GearErrors(Table):
    """Manufacturing errors.

    Eccentricity of the teeth [m], or the runout that it shows, twice as much, and its angle from x at rest [rad];
    `pitch`: how far each tooth's working flank stands ahead of its ideal place along the pitch circle [m], tooth by
    tooth as they come into mesh (cumulative), or `spacing`: from its predecessor to each tooth; `profile` and `helix`
    of all flanks.
    """

    eccentricity: LengthFromZero = 0.0
    runout: LengthFromZero = 0.0
    phase: Angle = 0.0
    pitch: Annotated[tuple[Deviation, ...], Field(max_length=2000)] = ()
    spacing: Annotated[tuple[Deviation, ...], Field(max_length=2000)] = ()
    profile: ProfileErrors | None = None
    helix: HelixErrors | None = None

    @model_validator(mode="after")
    def _said_once(self) -> GearErrors:
        if self.eccentricity > 0.0 and self.runout > 0.0:
            raise wrong("eccentricity or runout, which is twice as much", "runout")
        if self.pitch and self.spacing:
            raise wrong("'pitch', cumulative, or 'spacing' from tooth to tooth", "spacing")
        return self

    @property
    def offset(self) -> float:
        """Eccentricity, however it is given [m]."""
        return self.eccentricity or 0.5 * self.runout

    @property
    def cumulative_pitch(self) -> tuple[float, ...]:
        """Deviation of each tooth from its ideal place [m], of zero mean where it follows from `spacing`."""
        if not self.spacing:
            return self.pitch
        # What is left over after a turn is nobody's: pitches sum to the circle.
        closing = sum(self.spacing) / len(self.spacing)
        places = [0.0]
        for step in self.spacing[1:]:
            places.append(places[-1] + step - closing)
        mean = sum(places) / len(places)
        return tuple(place - mean for place in places)


_KEYS_OF_FAULTS = {
    "wear": (("depth",), ("tooth", "shape")),
    "spall": (("tooth", "depth", "start_roll_angle", "end_roll_angle"), ("width",)),
    "crack": (("tooth", "depth"), ("angle",)),
    "missing-tooth": (("tooth",), ()),
}
"""Keys that a kind of fault needs, and further ones that it takes."""


class Fault(Table):
    """A damaged tooth, numbered from 0 as the teeth come into mesh.

    `wear` by `depth`, of one tooth or of all, in proportion to the sliding or uniform; `spall` by `depth` between two
    roll angles, across the face or a `width` of it; `crack` of a `depth` at an `angle` to the tooth's axis;
    `missing-tooth`.
    """

    kind: Literal["wear", "spall", "crack", "missing-tooth"]
    tooth: Annotated[int, Whole(0, 1999)] | None = None
    depth: LengthFromZero | None = None
    shape: Literal["sliding", "uniform"] = "sliding"
    start_roll_angle: RollAngle | None = None
    end_roll_angle: RollAngle | None = None
    width: PositiveLength | None = None
    angle: Annotated[float, Quantity(units.ANGLE, above=0.0, at_most=math.pi / 2.0)] = math.radians(70.0)

    @model_validator(mode="after")
    def _has_what_it_needs(self) -> Fault:
        needed, optional = _KEYS_OF_FAULTS[self.kind]
        for key in needed:
            if getattr(self, key) is None:
                raise wrong(f"'{key}' of a fault of kind {self.kind!r}", key)
        for key, field in type(self).model_fields.items():
            if key not in ("kind", *needed, *optional) and getattr(self, key) != field.default:
                raise wrong(f"no '{key}' of a fault of kind {self.kind!r}", key)
        if self.kind == "spall":
            assert self.start_roll_angle is not None
            assert self.end_roll_angle is not None
            if self.end_roll_angle <= self.start_roll_angle:
                raise wrong("a roll angle beyond start_roll_angle", "end_roll_angle")
        return self

    def build(self) -> coupling.gears.Fault:
        """The fault of this kind."""
        from coupling.gears import MissingTooth, Spall, ToothCrack, Wear

        kinds = {"wear": Wear, "spall": Spall, "crack": ToothCrack, "missing-tooth": MissingTooth}
        needed, optional = _KEYS_OF_FAULTS[self.kind]
        made: coupling.gears.Fault = kinds[self.kind](**{key: getattr(self, key) for key in (*needed, *optional)})
        return made
