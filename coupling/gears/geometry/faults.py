"""Tooth faults: wear, spalls, missing teeth; cracks are in :mod:`gearwhine.coupling.gears.stiffness.crack`.

A fault changes the pairs that its tooth belongs to: it takes material off the flank, makes the contact softer, or
both. All are given on the gear, by the number of the tooth in the order in which teeth come into mesh. Of a gear with
several mates that is the order of the first pair that it belongs to, and the flank that works there: an idler, as a
planet, touches its next mate with the other flank of the same tooth.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from gearwhine.coupling.gears.errors import GearError, require_finite
from gearwhine.coupling.gears.geometry.gear import Fault, Flank, Gear
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding

NO_CONTACT_GAP = 1.0
"""Gap of a missing tooth [m], wider than any load closes."""
_EDGE = 0.1
"""Part of a spall's length over which its edges rise, as a contact of finite width rides over them."""


@dataclass(frozen=True)
class Wear(Fault):
    """Material worn off the flank.

    Parameters
    ----------
    depth : float
        Largest depth [m].
    tooth : int or None
        Number of the worn tooth; None for all.
    shape : {"sliding", "uniform"}
        Proportional to the sliding: zero at the pitch point and `depth` at the end of the flank farther from it;
        or uniform.
    """

    depth: float
    tooth: int | None = None
    shape: Literal["sliding", "uniform"] = "sliding"

    def __post_init__(self) -> None:
        """Check the tooth number, the depth and the shape."""
        check_tooth_number("wear", self.tooth)
        require_finite("wear depth", self.depth, minimum=0.0)
        if self.shape not in ("sliding", "uniform"):
            raise GearError(f"wear shape must be 'sliding' or 'uniform', got {self.shape!r}")

    def gap(self, gear: Gear, roll_angle: FloatArray, *, pitch_roll_angle: float, face_width: float) -> FloatArray:
        """See `gearwhine.coupling.gears.geometry.gear.Fault`."""
        if self.shape == "uniform":
            return np.full_like(roll_angle, self.depth)
        ends = gear.roll_angle(gear.form_radius), gear.roll_angle(gear.tip_radius)
        farthest = max(abs(end - pitch_roll_angle) for end in ends)
        return np.asarray(self.depth * np.abs(roll_angle - pitch_roll_angle) / farthest, dtype=np.float64)

    def corners(self, gear: Gear, pitch_roll_angle: float) -> tuple[float, ...]:
        """Return the roll angle of the pitch point [rad], where wear in proportion to the sliding has a corner."""
        return () if self.shape == "uniform" else (pitch_roll_angle,)


@dataclass(frozen=True)
class Spall(Fault):
    """A pit in the flank of one tooth, across all of the face or a part of it.

    Across all of the pair's common face the contact drops into it by `depth`. Across a part, the rest carries: the
    flattening of the pair's contact, inversely proportional to the width, becomes ``1 / (1 - width / face_width)`` of
    that of sound flanks. Weber's flattening grows less than that, by some 10 % where half of the face carries, because
    the strip of contact widens too; this is left out. The spall's edges rise over a tenth of its length.

    Parameters
    ----------
    tooth : int
    start_roll_angle, end_roll_angle : float
        Roll angles at which the spall begins and ends [rad].
    depth : float
        Depth of the spall [m].
    width : float or None
        Across the common face [m]; None for all of it.
    flank : {"working", "back"}
        Flank that works in the first pair of the gear, or the one behind it.
    """

    tooth: int
    start_roll_angle: float
    end_roll_angle: float
    depth: float
    width: float | None = None
    flank: Flank = "working"

    def __post_init__(self) -> None:
        """Check the tooth number, the flank and the dimensions."""
        check_tooth_number("spall", self.tooth)
        check_flank("spall", self.flank)
        for quantity in ("start_roll_angle", "end_roll_angle", "depth"):
            require_finite(f"spall {quantity}", getattr(self, quantity), minimum=0.0)
        if not self.end_roll_angle > self.start_roll_angle:
            raise GearError(
                f"spall end_roll_angle must be above start_roll_angle, {self.start_roll_angle!r} rad, "
                f"got {self.end_roll_angle!r} rad"
            )
        if self.width is not None:
            require_finite("spall width", self.width, minimum=0.0)

    def findings(self, gear: Gear, attribute: str) -> Iterator[Finding]:
        """Yield a tooth that the gear does not have, and an end off the flank."""
        yield from super().findings(gear, attribute)
        low, high = sorted((gear.roll_angle(gear.tip_radius), gear.roll_angle(gear.form_radius)))
        off = "start" if self.start_roll_angle >= high else "end" if self.end_roll_angle <= low else ""
        if off:
            ends = "the tip and the form circle" if gear.is_internal else "the form circle and the tip"
            value = getattr(self, f"{off}_roll_angle")
            expected = (
                f"a spall on the flank, between the roll angles of {ends}, {math.degrees(low):.4g} and "
                f"{math.degrees(high):.4g} degrees; it {off}s at {math.degrees(value):.4g} degrees"
            )
            yield Finding(("gear", gear.name), f"{attribute}.{off}_roll_angle", value, expected)

    def gap(self, gear: Gear, roll_angle: FloatArray, *, pitch_roll_angle: float, face_width: float) -> FloatArray:
        """See `gearwhine.coupling.gears.geometry.gear.Fault`."""
        return self.depth * self._inside(roll_angle) if self.across_face(face_width) else np.zeros_like(roll_angle)

    def more_flattening(self, roll_angle: FloatArray, face_width: float) -> FloatArray:
        """See `gearwhine.coupling.gears.geometry.gear.Fault`."""
        if self.across_face(face_width):
            return np.zeros_like(roll_angle)
        part = self._part_of_face(face_width)
        return np.asarray(part / (1.0 - part) * self._inside(roll_angle), dtype=np.float64)

    def corners(self, gear: Gear, pitch_roll_angle: float) -> tuple[float, ...]:
        """Both ends of both edges."""
        return self._edges

    def across_face(self, face_width: float) -> bool:
        """Whether nothing of a common face of this width [m] is left to carry."""
        return self._part_of_face(face_width) >= 1.0

    def _part_of_face(self, face_width: float) -> float:
        return 1.0 if self.width is None else self.width / face_width

    def _inside(self, roll_angle: FloatArray) -> FloatArray:
        return np.interp(roll_angle, self._edges, [0.0, 1.0, 1.0, 0.0])

    @property
    def _edges(self) -> tuple[float, float, float, float]:
        edge = _EDGE * (self.end_roll_angle - self.start_roll_angle)
        return (self.start_roll_angle, self.start_roll_angle + edge, self.end_roll_angle - edge, self.end_roll_angle)


@dataclass(frozen=True)
class MissingTooth(Fault):
    """A broken-off tooth, whose pairs carry no load."""

    tooth: int

    def __post_init__(self) -> None:
        """Check the tooth number."""
        check_tooth_number("missing tooth", self.tooth)

    def gap(self, gear: Gear, roll_angle: FloatArray, *, pitch_roll_angle: float, face_width: float) -> FloatArray:
        """Gap wider than any load closes."""
        return np.full_like(roll_angle, NO_CONTACT_GAP)


def check_tooth_number(name: str, tooth: int | None) -> None:
    """Raise `GearError` unless a fault's tooth is a whole number from 0, or none."""
    if tooth is not None and (type(tooth) is not int or tooth < 0):
        raise GearError(f"{name}: tooth must be a whole number from 0, got {tooth!r}")


def check_flank(name: str, flank: str) -> None:
    """Raise `GearError` unless a fault is on one of the two flanks of its tooth."""
    if flank not in ("working", "back"):
        raise GearError(f"{name}: flank must be 'working' or 'back', got {flank!r}")
