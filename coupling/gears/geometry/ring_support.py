"""Support of an internal gear's rim: what holds the outside of the ring."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from gearwhine.coupling.gears.errors import GearError, require_finite

RingSupportKind = Literal["clamped", "housing", "springs", "bolts", "pins"]


@dataclass(frozen=True)
class RingSupport:
    """Support of the outside of an internal gear's rim.

    Parameters
    ----------
    kind : {"clamped", "housing", "springs", "bolts", "pins"}
        "clamped": the whole outside stands still. "housing": the same for the ring itself; the outside moves with the
        housing's seat. "springs": an elastic bed all around. "bolts": seats at equal angles that hold the ring against
        motion and rotation. "pins": the same without a moment.
    count : int or None
        Number of bolts or pins, at least 2.
    seat_width : float or None
        Length of one bolt's or pin's seat along the outside of the ring [m].
    radial_stiffness, tangential_stiffness : float or None
        Stiffness of each bolt or pin; of springs the sum of all around the ring [N/m]. None for rigid bolts and pins.
    first : float
        Angle of the first bolt or pin from x [rad].

    Raises
    ------
    GearError
        For an unknown kind, or values that the kind lacks or does not take.
    """

    kind: RingSupportKind = "clamped"
    count: int | None = None
    seat_width: float | None = None
    radial_stiffness: float | None = None
    tangential_stiffness: float | None = None
    first: float = 0.0

    def __post_init__(self) -> None:
        """Check the kind and its values."""
        if self.kind not in get_args(RingSupportKind):
            kinds = ", ".join(get_args(RingSupportKind))
            raise GearError(f"ring support: kind must be one of {kinds}, got {self.kind!r}")
        label = f"ring support by {self.kind}: "
        taken = {
            "springs": ("radial_stiffness", "tangential_stiffness"),
            "bolts": ("count", "seat_width", "radial_stiffness", "tangential_stiffness"),
        }
        taken["pins"] = taken["bolts"]
        needed = {"springs": taken["springs"], "bolts": ("count", "seat_width"), "pins": ("count", "seat_width")}
        for quantity in taken["bolts"]:
            value = getattr(self, quantity)
            if value is None:
                if quantity in needed.get(self.kind, ()):
                    raise GearError(f"{label}{quantity} is missing")
                continue
            if quantity not in taken.get(self.kind, ()):
                raise GearError(f"{label}{quantity} is not of this kind; leave it out")
            require_finite(label + quantity, value, minimum=0.0, strict=True)
        if self.count is not None and (type(self.count) is not int or self.count < 2):
            raise GearError(f"{label}count must be a whole number of at least 2, got {self.count!r}")
        require_finite(label + "first", self.first)

    @property
    def discrete(self) -> bool:
        """Whether the ring is held at single places, so that its compliance varies around it."""
        return self.kind in ("bolts", "pins")

    def require_fit(self, name: str, outer_radius: float) -> None:
        """Raise `GearError` where the seats do not fit on the outside of a ring of this radius [m]."""
        if self.count is not None and self.seat_width is not None:
            most = 2.0 * math.pi * outer_radius / self.count
            if self.seat_width >= most:
                raise GearError(
                    f"gear {name!r}: {self.count} seats of {1e3 * self.seat_width:.4g} mm do not fit around the ring's "
                    f"outside of {2e3 * outer_radius:.6g} mm; below {1e3 * most:.4g} mm each, or springs all around"
                )
