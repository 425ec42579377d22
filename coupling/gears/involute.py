"""Involute function and its inverse."""

from __future__ import annotations

import math

from coupling.gears.errors import GearError


def involute(angle: float) -> float:
    """Involute function ``inv(a) = tan(a) - a`` of a pressure angle in rad."""
    return math.tan(angle) - angle


def inverse_involute(value: float) -> float:
    """Pressure angle [rad] whose involute function is `value` (>= 0), by Newton's iteration.

    Raises
    ------
    GearError
        For a negative or non-finite value.
    """
    if not (math.isfinite(value) and value >= 0.0):
        raise GearError(f"the involute function is never {value!r}; expected a finite number of at least 0")
    # inv(a) ~ a^3/3 for small angles; for large ones tan(a) ~ value.  Newton from above converges always,
    # since inv is convex.
    angle = min(math.cbrt(3.0 * value), math.atan(value + math.pi / 2.0))
    for _ in range(60):
        tangent = math.tan(angle)
        if tangent == 0.0:
            return 0.0
        step = (tangent - angle - value) / tangent**2
        angle -= step
        if abs(step) <= 1e-16 + 4e-16 * abs(angle):
            break
    return angle
