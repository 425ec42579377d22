"""Support of an internal gear's rim: what holds the outside of the ring."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, get_args

from gearwhine.coupling.gears.errors import GearError
from gearwhine.numerics.findings import FINITE, Choice, Finding, Number, attribute_findings, refuse

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
        refuse(self._findings(), GearError)

    def _findings(self) -> Iterator[Finding]:
        """Yield an unknown kind, and values that the kind lacks or does not take."""
        part = ("ring support", "")
        yield from attribute_findings(part, self, kind=Choice(get_args(RingSupportKind)), first=FINITE)
        sizes, stiffness = ("count", "seat_width"), ("radial_stiffness", "tangential_stiffness")
        needed = {"springs": stiffness, "bolts": sizes, "pins": sizes}.get(self.kind, ())
        taken = (*sizes, *stiffness) if self.discrete else needed
        rules = dict.fromkeys((*sizes, *stiffness), Number(above=0.0)) | {"count": Number(at_least=2, whole=True)}
        for attribute, rule in rules.items():
            value = getattr(self, attribute)
            if value is None:
                if attribute in needed:
                    yield Finding(part, attribute, "None", f"a value beside kind = {self.kind!r}")
            elif attribute not in taken:
                yield Finding(part, attribute, value, f"none beside kind = {self.kind!r}")
            elif not rule.accepts(value):
                yield Finding(part, attribute, value, rule.expected)

    @property
    def discrete(self) -> bool:
        """Whether the ring is held at single places, so that its compliance varies around it."""
        return self.kind in ("bolts", "pins")

    def fit_findings(self, gear: str, outer_radius: float) -> Iterator[Finding]:
        """Yield seats that do not fit on the outside of a gear's ring of this radius [m]."""
        if self.count is not None and self.seat_width is not None:
            most = 2.0 * math.pi * outer_radius / self.count
            if self.seat_width >= most:
                expected = (
                    f"below {1e3 * most:.4g} mm, as {self.count} seats stand around the ring's outside of "
                    f"{2e3 * outer_radius:.6g} mm, or springs all around"
                )
                yield Finding(("gear", gear), "ring_support.seat_width", self.seat_width, expected)
