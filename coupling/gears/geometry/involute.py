"""Involute function ``inv(a) = tan(a) - a`` and its inverse; normal module from base radius or diametral pitch."""

from __future__ import annotations

import math

from gearwhine.coupling.gears.errors import GearError, require_finite


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


def module_from_base_radius(base_radius: float, teeth: int, pressure_angle: float, helix_angle: float = 0.0) -> float:
    """Compute the normal module [m] from the base radius [m], ``2 rb cos(beta) / (z cos(alpha_t))``; angles in rad."""
    require_finite("base_radius", base_radius, minimum=0.0, strict=True)
    require_finite("teeth", teeth, minimum=0.0, strict=True)
    transverse = math.atan2(math.tan(pressure_angle), math.cos(helix_angle))
    return 2.0 * base_radius * math.cos(helix_angle) / (teeth * math.cos(transverse))


def module_from_diametral_pitch(diametral_pitch: float) -> float:
    """Compute the normal module [m] from the normal diametral pitch [1/m], teeth per length of diameter: ``1 / P``.

    Eight teeth per inch are ``8 / 0.0254`` per metre, a module of 3.175 mm.
    """
    require_finite("diametral_pitch", diametral_pitch, minimum=0.0, strict=True)
    return 1.0 / diametral_pitch
