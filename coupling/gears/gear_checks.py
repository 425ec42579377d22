"""What a gear must be to be made at all, each failure with a name and what to change."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from coupling.gears.errors import GearError, PointedToothError, ThinTipError, UndercutError, require_finite
from coupling.gears.faults import Spall

if TYPE_CHECKING:
    from coupling.gears.geometry import Gear

_STEEPEST_HELIX = math.radians(60.0)


def check_numbers(gear: Gear) -> None:
    """Raise `GearError` for a number outside its range, each by itself."""
    label = f"gear {gear.name!r}: "
    if type(gear.teeth) is not int or gear.teeth < 5:
        raise GearError(f"{label}teeth must be a whole number of at least 5, got {gear.teeth!r}")
    for quantity in ("module", "face_width", "addendum", "dedendum", "youngs_modulus", "density"):
        require_finite(label + quantity, getattr(gear, quantity), minimum=0.0, strict=True)
    for quantity in ("bore", "eccentricity", "tooth_thinning"):
        require_finite(label + quantity, getattr(gear, quantity), minimum=0.0)
    for quantity in ("profile_shift", "eccentricity_phase", "helix_angle"):
        require_finite(label + quantity, getattr(gear, quantity))
    for quantity in ("rim_thickness", "web_thickness"):
        if getattr(gear, quantity) is not None:
            require_finite(label + quantity, getattr(gear, quantity), minimum=0.0, strict=True)
    if gear.root_radius is not None:
        require_finite(f"{label}root_radius", gear.root_radius, minimum=0.0)
    if gear.pitch_deviations and len(gear.pitch_deviations) != gear.teeth:
        raise GearError(
            f"{label}pitch_deviations must be one for each of {gear.teeth} teeth, got {len(gear.pitch_deviations)}"
        )
    for tooth, deviation in enumerate(gear.pitch_deviations):
        require_finite(f"{label}pitch_deviations[{tooth}]", deviation)
    if not 0.0 <= gear.poisson_ratio < 0.5:
        raise GearError(f"{label}poisson_ratio must be in 0 ... 0.5, got {gear.poisson_ratio!r}")
    if not math.radians(5.0) <= gear.pressure_angle <= math.radians(45.0):
        raise GearError(f"{label}pressure_angle must be 5 to 45 degrees in rad, got {gear.pressure_angle!r} rad")
    if abs(gear.helix_angle) > _STEEPEST_HELIX:
        raise GearError(f"{label}helix_angle must be -60 to 60 degrees in rad, got {gear.helix_angle!r} rad")


def check_tooth(gear: Gear) -> None:
    """Raise `GearError` or one of its kinds for teeth that no rack cuts, or no body carries."""
    _check_body(gear)
    _check_rack(gear)
    _check_foot(gear)
    _check_tip(gear)


def require_tip_thickness(gear: Gear, least: float = 0.2) -> None:
    """Raise `ThinTipError` where a tooth's tip is too thin to be hardened or to carry load.

    Parameters
    ----------
    gear : Gear
    least : float
        Least normal thickness of the tip, in modules; 0.2 is customary for ground and through-hardened teeth, 0.4 for
        case-hardened ones.
    """
    thickness = 2.0 * gear.tip_half_angle * gear.tip_radius * math.cos(gear.helix_angle_at(gear.tip_radius))
    if thickness < least * gear.module:
        raise ThinTipError(
            f"gear {gear.name!r}: the teeth are {thickness * 1e3:.4g} mm thick at the tip, "
            f"{thickness / gear.module:.3g} modules; at least {least:g} modules are wanted. "
            f"Reduce profile_shift ({gear.profile_shift:g}) or addendum ({gear.addendum:g})"
        )


def _check_body(gear: Gear) -> None:
    label = f"gear {gear.name!r}: "
    if gear.root_circle_radius <= 0.5 * gear.bore:
        raise GearError(
            f"{label}the bore ({gear.bore * 1e3:.4g} mm) must be smaller than the root circle "
            f"({2e3 * gear.root_circle_radius:.4g} mm)"
        )
    inside = gear.rim_inner_radius
    if inside is not None and inside <= 0.5 * gear.bore:
        raise GearError(
            f"{label}rim_thickness {gear.rim_thickness!r} m leaves no room between rim and bore; at most "
            f"{(gear.root_circle_radius - 0.5 * gear.bore) * 1e3:.4g} mm, or none for a disc without a rim"
        )
    if gear.web_thickness is not None and inside is None:
        raise GearError(f"{label}web_thickness needs a rim_thickness: a disc without a rim is as wide as its face")
    if gear.web_thickness is not None and gear.web_thickness > gear.face_width:
        raise GearError(
            f"{label}web_thickness {gear.web_thickness * 1e3:.4g} mm must be at most the face width, "
            f"{gear.face_width * 1e3:.4g} mm"
        )


def _check_rack(gear: Gear) -> None:
    label = f"gear {gear.name!r}: "
    full = gear.full_rack_tip_radius
    if full < 0.0:
        raise PointedToothError(
            f"{label}the rack's own teeth are pointed: dedendum {gear.dedendum:g} is too much for "
            f"{math.degrees(gear.pressure_angle):.4g} degrees"
        )
    if gear.root_radius is not None and gear.root_radius > full * (1.0 + 1e-12):
        raise GearError(
            f"{label}root_radius {gear.root_radius * 1e3:.4g} mm does not fit the rack's tip; "
            f"at most {full * 1e3:.4g} mm"
        )
    if gear.rack_corner_arc.depth <= 0.0:
        raise GearError(
            f"{label}profile_shift {gear.profile_shift:g} lifts the rack's corner above the pitch line; "
            f"at most {gear.dedendum - gear.rack_tip_radius / gear.module:.4g} here"
        )


def _check_foot(gear: Gear) -> None:
    label = f"gear {gear.name!r}: "
    if gear.is_undercut and not gear.allow_undercut:
        least = gear.least_generating_shift + gear.profile_shift - gear.generating_shift
        raise UndercutError(
            f"{label}{gear.teeth} teeth at profile_shift {gear.profile_shift:g} are undercut; "
            f"a profile_shift of {least:.4g} or more avoids it, allow_undercut takes the teeth as they are"
        )
    if gear.is_undercut:
        gamma = np.linspace(gear.fillet_end, math.pi / 2.0, 65)
        neck = 2.0 * float(np.min(gear.rack_corner_arc.trochoid(gear.pitch_radius, gamma).half_thickness))
        if neck <= 0.0:
            raise UndercutError(f"{label}the rack cuts the teeth off at their feet; raise profile_shift")
    if gear.tip_radius <= gear.form_radius:
        raise GearError(f"{label}the tip circle lies below the start of the involute; raise the addendum")


def _check_tip(gear: Gear) -> None:
    label = f"gear {gear.name!r}: "
    if gear.tip_half_angle <= 0.0:
        raise PointedToothError(
            f"{label}the teeth are pointed below the tip circle; reduce profile_shift "
            f"({gear.profile_shift:g}) or addendum ({gear.addendum:g})"
        )


def check_flanks(gear: Gear) -> None:
    """Raise `GearError` for modifications that begin off the flank, and faults on teeth that are not there."""
    label = f"gear {gear.name!r}: "
    tip, form = gear.roll_angle(gear.tip_radius), gear.roll_angle(gear.form_radius)
    if gear.tip_relief is not None:
        start = gear.tip_relief.start(tip, gear.base_radius)
        if not 0.0 <= start < tip:
            raise GearError(
                f"{label}tip relief must start below the tip's roll angle of {math.degrees(tip):.4g} degrees "
                f"and on the involute, got {math.degrees(start):.4g} degrees"
            )
    if gear.root_relief is not None:
        start = gear.root_relief.start(form, gear.base_radius)
        if not form < start <= tip:
            raise GearError(
                f"{label}root relief must start between the roll angles of the form circle and the tip, "
                f"{math.degrees(form):.4g} and {math.degrees(tip):.4g} degrees, "
                f"got {math.degrees(start):.4g} degrees"
            )
    for fault in gear.faults:
        if fault.tooth is not None and fault.tooth >= gear.teeth:
            raise GearError(f"{label}a fault is on tooth {fault.tooth}; the teeth are numbered 0 to {gear.teeth - 1}")
        if isinstance(fault, Spall) and not (fault.start_roll_angle < tip and fault.end_roll_angle > form):
            raise GearError(
                f"{label}a spall must lie on the flank, between the roll angles of the form circle and the tip, "
                f"{math.degrees(form):.4g} and {math.degrees(tip):.4g} degrees, got "
                f"{math.degrees(fault.start_roll_angle):.4g} to {math.degrees(fault.end_roll_angle):.4g} degrees"
            )
