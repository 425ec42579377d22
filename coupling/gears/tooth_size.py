"""Normal module of a gear from its base radius or its diametral pitch."""

from __future__ import annotations

import math

from coupling.gears.errors import require_finite


def module_from_base_radius(base_radius: float, teeth: int, pressure_angle: float, helix_angle: float = 0.0) -> float:
    """Normal module [m] of a gear by its base radius [m], ``2 rb cos(beta) / (z cos(alpha_t))``; angles in rad."""
    require_finite("base_radius", base_radius, minimum=0.0, strict=True)
    require_finite("teeth", teeth, minimum=0.0, strict=True)
    transverse = math.atan2(math.tan(pressure_angle), math.cos(helix_angle))
    return 2.0 * base_radius * math.cos(helix_angle) / (teeth * math.cos(transverse))


def module_from_diametral_pitch(diametral_pitch: float) -> float:
    """Normal module [m] of a normal diametral pitch [1/m], teeth per length of diameter: ``1 / P``.

    Eight teeth per inch are ``8 / 0.0254`` per metre, a module of 3.175 mm.
    """
    require_finite("diametral_pitch", diametral_pitch, minimum=0.0, strict=True)
    return 1.0 / diametral_pitch
