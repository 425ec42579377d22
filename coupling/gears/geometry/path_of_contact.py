r"""Path of contact: its named points (SAP, LPSTC, pitch point, HPSTC, EAP), specific sliding, and corner contact.

With the distances ``xi_k, xi_i`` of the contact from the two tangent points, the flanks' points move along the tangent
of the flanks with ``omega_k xi_k`` and ``omega_i xi_i``.  The specific sliding of a flank is the difference over its
own speed (Niemann & Winter, Maschinenelemente II):

    zeta_k = 1 - (z_k xi_i) / (z_i xi_k),      zeta_i = 1 - (z_i xi_k) / (z_k xi_i),

zero at the pitch point, and negative, the greater wear, towards the roots.

Corner contact, of the corner of a tip on the mating flank, extends the path before entry and after exit. On the nominal
motion a pair that is not yet at its path of contact is apart by a small gap. A loaded mesh, its gears rotated against
each other by the deflection of the loaded pairs, closes it: the corner of the driven tip touches the driver's flank
early, and the driver's own tip stays late. The force then comes and goes without a step, and the contact ratio grows
with the load.

The gap follows exactly from where the corner is. With the driver's tangent point on the line of action at angle
zero, its flank's point at radius ``rho`` has the polar angle ``xi_k / rb_k - inv(rho)``, xi_k the distance of the
nominal contact from that tangent point; in the same frame rotated by half a turn, the driven gear's tip is at
``xi_i / rb_i - inv(r_a,i)`` about its own centre. The corner lies at a radius ``rho`` and an angle ``theta`` about
the driver's centre; the driver has to rotate by ``theta - xi_k / rb_k + inv(rho)`` to meet it: the gap is that times
rb_k. Leaving is entering with the gears exchanged. It begins with the square of the distance from the path.

Where the gears are large and the gap small, the flank's radius there hardly differs from where the path ends
(Lin, Wang, Oswald and Coy, NASA TM 106174, 1993, treat the same extension of contact by loads).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.numerics.arrays import FloatArray

POINTS_OF_CONTACT: tuple[str, ...] = ("SAP", "LPSTC", "pitch point", "HPSTC", "EAP")
"""Points of the driver: start of active profile, lowest point of single tooth contact, pitch point, highest point of
single tooth contact, end of active profile.  The driven gear's start is the driver's end, and so on."""


@dataclass(frozen=True, eq=False)
class PathOfContact:
    """The points `POINTS_OF_CONTACT`, one entry of each array for each.

    Attributes
    ----------
    position : ndarray, shape (5,)
        Place on the path of contact in base pitches [1].
    driver_roll_angle, driven_roll_angle : ndarray, shape (5,)
        [rad]
    driver_radius, driven_radius : ndarray, shape (5,)
        [m]
    driver_sliding, driven_sliding : ndarray, shape (5,)
        Specific sliding.
    """

    position: FloatArray
    driver_roll_angle: FloatArray
    driven_roll_angle: FloatArray
    driver_radius: FloatArray
    driven_radius: FloatArray
    driver_sliding: FloatArray
    driven_sliding: FloatArray


def path_of_contact(pair: GearPairGeometry) -> PathOfContact:
    """Compute the points `POINTS_OF_CONTACT` of a gear pair's path of contact.

    With a contact ratio of two or more no tooth carries alone: LPSTC and HPSTC are still where the pair before leaves
    (one base pitch before the end) and where the next pair enters (one after the start).
    """
    length = pair.contact_ratio
    position = np.array([0.0, length - 1.0, pair.pitch_point_position, 1.0, length])
    return PathOfContact(
        position,
        pair.driver_roll_angle(position),
        pair.driven_roll_angle(position),
        pair.driver_radius(position),
        pair.driven_radius(position),
        *specific_sliding(pair, position),
    )


def specific_sliding(pair: GearPairGeometry, position: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Specific sliding of the driver's and the driven gear's flank at `position` in base pitches.

    Minus infinity where a flank is touched on its base circle, where it does not move along itself.
    """
    # Roll angles are xi over base radius, and base radii go with the numbers of teeth.
    driver, driven = pair.driver_roll_angle(position), pair.driven_roll_angle(position)
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 - driven / driver), np.asarray(1.0 - driver / driven)


LARGEST_GAP = 0.03
"""Widest gap, in modules, that a load which teeth can carry closes."""
LONGEST_REACH = 0.45
"""Longest range of corner contact beyond either end of the path [base pitches]."""


@dataclass(frozen=True, eq=False)
class FlankContactPoints:
    """Contact points on both flanks at positions on or beyond the path of contact.

    Attributes
    ----------
    driver_roll_angle, driven_roll_angle : ndarray, shape (n,)
        Roll angle of the point on the flank [rad]; that of the tip for the gear whose corner touches.
    gap : ndarray, shape (n,)
        Distance of the points in nominal motion, along the line of action [m]; zero on the path.
    """

    driver_roll_angle: FloatArray
    driven_roll_angle: FloatArray
    gap: FloatArray


def flank_contact_points(geometry: GearPairGeometry, position: npt.ArrayLike) -> FlankContactPoints:
    """Contact points of flanks or corners at `position` in base pitches, on the path of contact and beyond."""
    at = np.atleast_1d(np.asarray(position, dtype=np.float64))
    early = at < 0.0
    late = at > geometry.contact_ratio
    on_path = np.clip(at, 0.0, geometry.contact_ratio)
    driver, driven = geometry.driver_roll_angle(on_path), geometry.driven_roll_angle(on_path)
    gap = np.zeros_like(driver)
    nominal = geometry.driver_roll_angle(at), geometry.driven_roll_angle(at)
    radii = geometry.driver.base_radius, geometry.driven.base_radius
    if np.any(early):
        roll, space = _corner(nominal[0][early], nominal[1][early], *radii, geometry.driven.tip_radius)
        driver[early], gap[early] = roll, space
    if np.any(late):
        roll, space = _corner(nominal[1][late], nominal[0][late], *radii[::-1], geometry.driver.tip_radius)
        driven[late], gap[late] = roll, space
    return FlankContactPoints(driver, driven, gap)


def corner_contact_range(geometry: GearPairGeometry, largest_gap: float = LARGEST_GAP) -> tuple[float, float]:
    """Range of corner contact before and after the path of contact [base pitches], both at least 0.

    It ends where the gap is `largest_gap` modules, at most `LONGEST_REACH`.
    """
    return _corner_contact_range(geometry.sound, largest_gap)


@lru_cache(maxsize=64)  # pairs of one drawing differ in their flanks alone
def _corner_contact_range(geometry: GearPairGeometry, largest_gap: float) -> tuple[float, float]:
    widest = largest_gap * geometry.driver.module

    rolls = (geometry.driver_roll_angle, geometry.driven_roll_angle)
    radii = geometry.driver.base_radius, geometry.driven.base_radius
    tips = geometry.driver.tip_radius, geometry.driven.tip_radius

    def beyond(reach: float, end: float, outward: int) -> float:
        flank, corner = (0, 1)[::-outward]
        at = np.float64(end + outward * reach)
        roll, mating = rolls[flank](at), rolls[corner](at)
        return float(_corner(roll, mating, radii[flank], radii[corner], tips[corner])[1]) - widest

    reaches = []
    for ends in ((0.0, -1), (geometry.contact_ratio, 1)):
        if beyond(LONGEST_REACH, *ends) <= 0.0:
            reaches.append(LONGEST_REACH)
        else:
            reaches.append(float(brentq(beyond, 0.0, LONGEST_REACH, args=ends, xtol=1e-9)))
    return reaches[0], reaches[1]


def _corner(
    roll: FloatArray, mating_roll: FloatArray, base: float, mating_base: float, mating_tip: float
) -> tuple[FloatArray, FloatArray]:
    """Roll angle of the point of the flank that a corner would touch [rad], and the gap [m].

    ``roll``, ``mating_roll``: roll angles of the nominal contact on the flank's gear and on the corner's gear.
    """
    tip_roll = np.sqrt((mating_tip / mating_base) ** 2 - 1.0)
    angle = mating_roll - tip_roll + np.arctan(tip_roll)
    tangent_distance = base * roll + mating_base * mating_roll
    x = base + mating_base - mating_tip * np.cos(angle)
    y = tangent_distance - mating_tip * np.sin(angle)
    squared = x * x + y * y
    touched = np.sqrt(np.maximum(0.0, squared / base**2 - 1.0))
    sign = math.copysign(1.0, base)  # a point at a negative radius is on the other side of the centre
    gap = base * (np.arctan2(sign * y, sign * x) - roll + touched - np.arctan(touched))
    return touched, np.asarray(np.maximum(gap, 0.0), dtype=np.float64)
