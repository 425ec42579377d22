"""Tooth thickness, and its measurement: base tangent length (span), dimension over or between balls.

On the cylinder of radius ``r_y`` a tooth spans the half angle ``psi - inv(alpha_y)`` with ``cos(alpha_y) = rb / r_y``
and psi its half angle on the base circle; normal to the helix it is thinner by ``cos(beta_y)``.  All values include the
thinning; formulas after ISO 21771.

Radii of an internal gear are negative, and the equations hold as they stand; lengths that are measured are positive.
Its span is over spaces, which are bounded as the teeth of an external gear, and its balls are measured between.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwhine.coupling.gears.errors import GearError, require_finite
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.involute import inverse_involute, involute

CUSTOMARY_BALL = 1.728
"""Diameter of measuring balls and wires in modules: for external gears by the American custom."""
CUSTOMARY_INTERNAL_BALL = 1.65
"""Diameter of measuring balls and wires in modules: for internal gears of 20 degrees, which touch near mid-flank."""


@dataclass(frozen=True)
class SpanMeasurement:
    """Base tangent length over some teeth.

    Attributes
    ----------
    teeth : int
        Number of teeth between the anvils, of an internal gear of spaces.
    length : float
        Base tangent length [m].
    contact_radius : float
        Radius at which the anvils touch, signed as the gear's [m].
    """

    teeth: int
    length: float
    contact_radius: float


@dataclass(frozen=True)
class BallMeasurement:
    """Dimension over two balls in opposite spaces, of an internal gear between them.

    Attributes
    ----------
    diameter : float
        Diameter of a ball [m].
    length : float
        Dimension over the balls, of an internal gear between them [m].
    centre_radius, contact_radius : float
        Radii of the balls' centres, and of their contact with the flanks, signed as the gear's [m].
    """

    diameter: float
    length: float
    centre_radius: float
    contact_radius: float


def half_angle(gear: Gear, radius: float) -> float:
    """Half the angle that a tooth spans at `radius` [m], on the involute or its continuation [rad]; both signed."""
    if not (math.isfinite(radius) and gear.sign * radius >= abs(gear.base_radius)):
        raise GearError(
            f"gear {gear.name!r}: there is no involute below the base circle of {gear.base_radius * 1e3:.6g} mm, "
            f"got a radius of {radius * 1e3:.6g} mm"
        )
    return gear.base_half_angle - involute(math.acos(gear.base_radius / radius))


def tooth_thickness(gear: Gear, radius: float) -> float:
    """Thickness along the arc of `radius`, in the transverse plane [m]."""
    return 2.0 * radius * half_angle(gear, radius)


def normal_tooth_thickness(gear: Gear, radius: float) -> float:
    """Thickness at `radius` normal to the helix, ``tooth_thickness cos(beta_y)`` [m]."""
    return tooth_thickness(gear, radius) * math.cos(gear.helix_angle_at(radius))


def span_measurement(gear: Gear, teeth: int | None = None) -> SpanMeasurement:
    """Compute the base tangent length over k teeth, ``W_k = (k - 1) p_bn + s_bn`` (normal base pitch and thickness).

    That of an internal spur gear is over k spaces, with their width ``p_b - s_b`` on the base circle.

    Parameters
    ----------
    gear : Gear
    teeth : int or None
        k; None for the number whose anvils touch closest to the middle of the flanks' height.

    Raises
    ------
    GearError
        Where the anvils do not touch the involute, or a helix runs out of the face between them; of a helical internal
        gear.
    """
    single = 2.0 * gear.base_radius * gear.base_half_angle
    if gear.is_internal:
        single = gear.base_pitch - single
        if gear.helix_angle != 0.0:
            raise GearError(f"gear {gear.name!r}: a helical internal gear has no span; measure it between balls")
    if teeth is None:
        middle = 0.5 * (gear.form_radius + gear.tip_radius)
        wanted = 2.0 * abs(gear.base_radius) * gear.roll_angle(middle)
        teeth = max(1, round((wanted - single) / gear.base_pitch) + 1)
    if type(teeth) is not int or not 1 <= teeth <= gear.tooth_count:
        raise GearError(f"gear {gear.name!r}: a span is over 1 to {gear.tooth_count} teeth, got {teeth!r}")
    across = (teeth - 1) * gear.base_pitch + single
    helix = gear.base_helix_angle
    length = across * math.cos(helix)
    # In the plane tangent to the base cylinder the two helices are lines, `across` apart in the transverse direction.
    touch = gear.sign * math.hypot(gear.base_radius, 0.5 * length * math.cos(helix))
    _require_on_flank(gear, touch, f"a span over {teeth} teeth")
    if abs(length * math.sin(helix)) > gear.face_width:
        raise GearError(
            f"gear {gear.name!r}: a span over {teeth} teeth needs a face width of at least "
            f"{abs(length * math.sin(helix)) * 1e3:.4g} mm"
        )
    return SpanMeasurement(teeth, length, touch)


def over_balls(gear: Gear, diameter: float | None = None) -> BallMeasurement:
    """Dimension over two balls; over two pins too, of a spur gear or a helical one with an even number of teeth.

    Of an internal gear it is the dimension between two balls, or between two pins of a spur one.

    A ball of diameter D that touches both flanks of a space has its centre where the involute of the flanks shifted by
    half of it, measured along the base circle, meets the middle of the space:

        inv(alpha_K) = D / (2 rb cos(beta_b)) - pi / z + psi,     r_K = rb / cos(alpha_K)
        M = 2 r_K + D (even z),     2 r_K cos(pi / (2 z)) + D (odd z)

    With the negative radii of an internal gear M is minus the dimension between the balls.

    Parameters
    ----------
    gear : Gear
    diameter : float or None
        Diameter of the balls [m]; None for 1.728 modules, of an internal gear for 1.65.

    Raises
    ------
    GearError
        For balls that do not touch both flanks of a space, stand below the tips, or touch the root.
    """
    customary = CUSTOMARY_INTERNAL_BALL if gear.is_internal else CUSTOMARY_BALL
    diameter = customary * gear.module if diameter is None else diameter
    require_finite(f"gear {gear.name!r}: ball diameter", diameter, minimum=0.0, strict=True)
    helix = math.cos(gear.base_helix_angle)
    value = diameter / (2.0 * gear.base_radius * helix) - math.pi / gear.teeth + gear.base_half_angle
    if value < 0.0:
        raise GearError(f"gear {gear.name!r}: balls of {diameter * 1e3:.4g} mm lie on the root; take larger ones")
    angle = inverse_involute(value)
    centre = gear.base_radius / math.cos(angle)
    roll_length = gear.base_radius * math.tan(angle) - 0.5 * diameter * helix
    ball = f"a ball of {diameter * 1e3:.4g} mm"
    # Below the tangent point the normal would meet the far branch of the involute.
    touch = gear.sign * math.hypot(gear.base_radius, roll_length) if gear.sign * roll_length >= 0.0 else 0.0
    _require_on_flank(gear, touch, ball)
    if centre + 0.5 * diameter <= gear.tip_radius:
        raise GearError(f"gear {gear.name!r}: {ball} stands below the tips; take larger ones")
    if centre - 0.5 * diameter <= gear.root_circle_radius:
        raise GearError(f"gear {gear.name!r}: {ball} lies on the root; take larger ones")
    spread = 1.0 if gear.teeth % 2 == 0 else math.cos(math.pi / (2.0 * gear.teeth))
    return BallMeasurement(diameter, abs(2.0 * centre * spread + diameter), centre, touch)


def _require_on_flank(gear: Gear, radius: float, ball: str) -> None:
    if not gear.form_radius <= radius <= gear.tip_radius:
        raise GearError(
            f"gear {gear.name!r}: {ball} does not touch the flank, which runs from "
            f"{abs(gear.form_radius) * 1e3:.6g} to {abs(gear.tip_radius) * 1e3:.6g} mm radius"
        )
