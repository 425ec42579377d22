"""Path of contact: its named points (SAP, LPSTC, pitch point, HPSTC, EAP), and the specific sliding.

With the distances ``xi_k, xi_i`` of the contact from the two tangent points, the flanks' points move along the tangent
of the flanks with ``omega_k xi_k`` and ``omega_i xi_i``.  The specific sliding of a flank is the difference over its
own speed (Niemann & Winter, Maschinenelemente II):

    zeta_k = 1 - (z_k xi_i) / (z_i xi_k),      zeta_i = 1 - (z_i xi_k) / (z_k xi_i),

zero at the pitch point, and negative, the greater wear, towards the roots.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.gears.pair_geometry import GearPairGeometry

FloatArray = npt.NDArray[np.float64]

POINTS_OF_CONTACT: tuple[str, ...] = ("SAP", "LPSTC", "pitch point", "HPSTC", "EAP")
"""Of the driver: start of active profile, lowest point of single tooth contact, pitch point, highest point of single
tooth contact, end of active profile.  The driven gear's start is the driver's end, and so on."""


@dataclass(frozen=True, eq=False)
class PathOfContact:
    """The points `POINTS_OF_CONTACT`, one entry of each array for each.

    Attributes
    ----------
    position : ndarray, shape (5,)
        Along the path [base pitches].
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
    """The named points of a pair's path of contact.

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
