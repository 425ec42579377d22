"""Profile modifications: tip relief and root relief, material taken off the flank on purpose.

Depths are normal to the flank, so along the line of action, and grow with the roll angle from nothing where the
relief begins to the full amount where the flank ends: in proportion (``"linear"``) or with the square of it
(``"parabolic"``), which leaves no corner in the profile.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from coupling.gears.errors import GearError, require_finite

FloatArray = npt.NDArray[np.float64]
ReliefShape = Literal["linear", "parabolic"]

_POWER = {"linear": 1, "parabolic": 2}


@dataclass(frozen=True)
class TipRelief:
    """Material taken off the flank near the tip.

    Parameters
    ----------
    amount : float
        Depth at the tip, normal to the flank [m].
    start_roll_angle : float or None
        Roll angle where the relief begins [rad]; zero roll is the base circle.
    length : float or None
        In its place: distance from the tip to the start of the relief, along the line of action [m].
    shape : {"linear", "parabolic"}

    Raises
    ------
    GearError
        Unless exactly one of `start_roll_angle` and `length` is given, and all are finite and not negative.
    """

    amount: float
    start_roll_angle: float | None = None
    length: float | None = None
    shape: ReliefShape = "linear"

    def __post_init__(self) -> None:
        _check("tip relief", self)

    def start(self, tip_roll_angle: float, base_radius: float) -> float:
        """Roll angle where the relief begins [rad], on a gear of given roll angle at the tip and base radius [m]."""
        if self.start_roll_angle is not None:
            return self.start_roll_angle
        assert self.length is not None
        return tip_roll_angle - self.length / base_radius

    def depth(self, roll_angle: FloatArray, tip_roll_angle: float, base_radius: float) -> FloatArray:
        """Material taken off [m] at roll angles [rad]."""
        start = self.start(tip_roll_angle, base_radius)
        return _depth(self, (roll_angle - start) / (tip_roll_angle - start))


@dataclass(frozen=True)
class RootRelief:
    """Material taken off the flank near its foot; parameters as for `TipRelief`.

    The full `amount` is reached at the form circle, where the involute begins, and `length` is counted from there.
    """

    amount: float
    start_roll_angle: float | None = None
    length: float | None = None
    shape: ReliefShape = "linear"

    def __post_init__(self) -> None:
        _check("root relief", self)

    def start(self, form_roll_angle: float, base_radius: float) -> float:
        """Roll angle where the relief begins [rad], on a gear of given roll angle at the form circle."""
        if self.start_roll_angle is not None:
            return self.start_roll_angle
        assert self.length is not None
        return form_roll_angle + self.length / base_radius

    def depth(self, roll_angle: FloatArray, form_roll_angle: float, base_radius: float) -> FloatArray:
        """Material taken off [m] at roll angles [rad]."""
        start = self.start(form_roll_angle, base_radius)
        return _depth(self, (start - roll_angle) / (start - form_roll_angle))


def _depth(relief: TipRelief | RootRelief, part: FloatArray) -> FloatArray:
    return np.asarray(relief.amount * np.maximum(0.0, part) ** _POWER[relief.shape], dtype=np.float64)


def _check(name: str, relief: TipRelief | RootRelief) -> None:
    require_finite(f"{name} amount", relief.amount, minimum=0.0)
    if (relief.start_roll_angle is None) == (relief.length is None):
        raise GearError(f"{name}: exactly one of start_roll_angle and length is needed")
    if relief.start_roll_angle is not None:
        require_finite(f"{name} start_roll_angle", relief.start_roll_angle, minimum=0.0)
    if relief.length is not None:
        require_finite(f"{name} length", relief.length, minimum=0.0, strict=True)
    if relief.shape not in _POWER:
        raise GearError(f"{name} shape must be one of {', '.join(_POWER)}, got {relief.shape!r}")
