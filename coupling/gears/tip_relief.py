"""Tip relief: material taken off so that a bent tooth is not struck on entering."""

from __future__ import annotations

from dataclasses import dataclass

from coupling.gears.errors import require_finite


@dataclass(frozen=True)
class TipRelief:
    """Material taken off the flank near the tip, growing linearly with roll angle.

    Parameters
    ----------
    amount : float
        Depth at the tip, normal to the flank [m].
    start_roll_angle : float
        Roll angle where the relief begins [rad]; zero roll is the base circle.
    """

    amount: float
    start_roll_angle: float

    def __post_init__(self) -> None:
        require_finite("tip relief amount", self.amount, minimum=0.0)
        require_finite("tip relief start_roll_angle", self.start_roll_angle, minimum=0.0)
