"""Centre distance of a gear pair from its profile shifts, and profile shifts from a centre distance.

Two gears mesh without backlash at the transverse pressure angle ``w`` of (ISO 21771)

    inv(w) = inv(alpha_t) + 2 tan(alpha_n) (x_k + x_i) / (z_k + z_i),

at the centre distance ``a = (rb_k + rb_i) / cos(w)``.
"""

from __future__ import annotations

import math
from dataclasses import replace

from coupling.gears.errors import InterferenceError, require_finite
from coupling.gears.geometry.gear import Gear
from coupling.gears.geometry.involute import inverse_involute, involute


def backlash_free_pressure_angle(driver: Gear, driven: Gear, *, thinned: bool = False) -> float:
    """Transverse pressure angle at which two gears mesh without backlash [rad].

    Parameters
    ----------
    driver, driven : Gear
    thinned : bool
        Whether to take the tooth thinning into account.

    Raises
    ------
    InterferenceError
        For teeth too thin to mesh without backlash at any distance.
    """
    gears = (driver, driven)
    shift = sum(gear.generating_shift if thinned else gear.profile_shift for gear in gears)
    normal, transverse = driver.pressure_angle, driver.transverse_pressure_angle
    value = involute(transverse) + 2.0 * math.tan(normal) * shift / (driver.teeth + driven.teeth)
    if value < 0.0:
        raise InterferenceError(
            f"gear pair {driver.name!r} -> {driven.name!r}: with profile shifts that sum to {shift:.4g} the teeth do "
            "not close at any distance"
        )
    return inverse_involute(value)


def profile_shift_sum(driver: Gear, driven: Gear, centre_distance: float) -> float:
    """Sum of the profile shifts with which two gears mesh without backlash at a distance.

    Parameters
    ----------
    driver, driven : Gear
        Their own profile shifts do not matter.
    centre_distance : float
        [m]

    Returns
    -------
    float
        ``(z_k + z_i) (inv(w) - inv(alpha_t)) / (2 tan(alpha_n))``, in normal modules.

    Raises
    ------
    InterferenceError
        For a distance below the sum of the base radii.
    """
    base = driver.base_radius + driven.base_radius
    require_finite("centre_distance", centre_distance)
    if centre_distance <= base:
        raise InterferenceError(
            f"gear pair {driver.name!r} -> {driven.name!r}: the centre distance must exceed the sum of the base radii, "
            f"{base * 1e3:.6g} mm, got {centre_distance * 1e3:.6g} mm"
        )
    opening = involute(math.acos(base / centre_distance)) - involute(driver.transverse_pressure_angle)
    return (driver.teeth + driven.teeth) * opening / (2.0 * math.tan(driver.pressure_angle))


def shifted_for_centre_distance(driver: Gear, driven: Gear, centre_distance: float) -> Gear:
    """Driven gear with the profile shift of a pair without backlash at `centre_distance` [m], the driver unchanged.

    Raises
    ------
    GearError
        Where no pair, or no such gear, can be made.
    """
    shift = profile_shift_sum(driver, driven, centre_distance) - driver.profile_shift
    return replace(driven, profile_shift=shift)


def tip_shortening(driver: Gear, driven: Gear, centre_distance: float) -> float:
    """Tip shortening: reduction of both addenda that restores the tip clearance of the basic rack.

    Parameters
    ----------
    driver, driven : Gear
    centre_distance : float
        [m]

    Returns
    -------
    float
        ``x_k + x_i - (a - a_d) / m_n`` in normal modules, a_d the sum of the reference radii; to be taken off both
        `addendum`.  Negative, a lengthening, hardly ever.
    """
    reference = driver.pitch_radius + driven.pitch_radius
    return driver.profile_shift + driven.profile_shift - (centre_distance - reference) / driver.module
