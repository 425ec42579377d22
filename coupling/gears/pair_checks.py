"""What two gears must be to run together, each failure with a name and what to change."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from coupling.gears.errors import InterferenceError, MismatchedGearsError, NoContactError

if TYPE_CHECKING:
    from coupling.gears.geometry import Gear
    from coupling.gears.pair_geometry import GearPairGeometry

# What printed sizes are rounded to (module 3.175 mm for 8 teeth per inch, printed as 3.1748).
_ROUNDED = 1e-3
# One per cent of a module is what cutting thins a tooth for backlash anyway.
_ALLOWED_JAM = 0.01


def check_match(pair: GearPairGeometry) -> None:
    """Raise `MismatchedGearsError` unless the teeth of one gear fit the spaces of the other."""
    degrees = 180.0 / math.pi
    for quantity, unit, scale in (("module", "mm", 1e3), ("pressure_angle", "degrees", degrees)):
        first, second = getattr(pair.driver, quantity), getattr(pair.driven, quantity)
        if not math.isclose(first, second, rel_tol=_ROUNDED):
            raise MismatchedGearsError(
                f"{pair.label}: both gears need the same {quantity}, "
                f"got {first * scale:.8g} and {second * scale:.8g} {unit}"
            )
    first, second = pair.driver.helix_angle, pair.driven.helix_angle
    if not math.isclose(first, -second, rel_tol=_ROUNDED):
        raise MismatchedGearsError(
            f"{pair.label}: external gears on parallel shafts need equal helix_angle of opposite hands, "
            f"got {first * degrees:+.8g} and {second * degrees:+.8g} degrees"
        )


def check_distance(pair: GearPairGeometry) -> None:
    """Raise `InterferenceError` for a centre distance at which the teeth jam."""
    distance = pair.centre_distance
    if distance is None:
        return
    if not (math.isfinite(distance) and distance > pair.base_radii_sum):
        raise InterferenceError(
            f"{pair.label}: the centre distance must exceed the sum of the base radii, "
            f"{pair.base_radii_sum * 1e3:.6g} mm, got {distance * 1e3:.6g} mm"
        )
    if pair.normal_backlash < -_ALLOWED_JAM * pair.driver.module:
        close = pair.base_radii_sum / math.cos(pair.close_pressure_angle)
        raise InterferenceError(
            f"{pair.label}: the teeth jam at a centre distance of {distance * 1e3:.6g} mm; "
            f"they mesh without backlash at {close * 1e3:.6g} mm"
        )


def check_contact(pair: GearPairGeometry) -> None:
    """Raise where the flanks lose each other, or a tip goes where the other gear has no flank."""
    if pair.contact_ratio < 1.0:
        raise NoContactError(
            f"{pair.label}: the contact ratio is {pair.contact_ratio:.4f}, below 1, at a centre distance of "
            f"{pair.working_centre_distance * 1e3:.6g} mm; bring the shafts closer or lengthen the teeth"
        )
    last = pair.tangent_distance - pair.start_distance - pair.path_length
    for rooted, tip, lowest in ((pair.driver, pair.driven, pair.start_distance), (pair.driven, pair.driver, last)):
        _check_active_profile(pair, rooted, tip, lowest)
        clearance = pair.tip_clearance(tip)
        if clearance < 0.0:
            raise InterferenceError(
                f"{pair.label}: the tip of {tip.name!r} hits the root of {rooted.name!r} by {-clearance * 1e3:.4g} mm"
            )


def _check_active_profile(pair: GearPairGeometry, rooted: Gear, tip: Gear, lowest: float) -> None:
    """Raise where contact would begin `lowest` [m] past the tangent point, below the flank of `rooted`."""
    form = rooted.roll_angle(rooted.form_radius) * rooted.base_radius
    if lowest >= form - 1e-9 * rooted.module:
        return
    start = (
        f"at a radius of {math.hypot(rooted.base_radius, lowest) * 1e3:.6g} mm"
        if lowest >= 0.0
        else f"inside the base circle of {rooted.base_radius * 1e3:.6g} mm"
    )
    raise InterferenceError(
        f"{pair.label}: the tip of {tip.name!r} reaches {(form - lowest) * 1e3:.4g} mm (along the line of action) "
        f"below the involute of {rooted.name!r}: contact would start {start}, the flank above its fillet starts at "
        f"a radius of {rooted.form_radius * 1e3:.6g} mm; reduce the addendum of {tip.name!r} or "
        f"the root_radius of {rooted.name!r}"
    )
