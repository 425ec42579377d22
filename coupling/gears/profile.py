"""Tooth profile: involute flank and the true trochoid of the root fillet.

Coordinates are the tooth's own: `height` along its axis from the gear's centre, `half_thickness` across.
Each curve has a parameter in which it is smooth, so that integrals over the tooth converge fast:

flank
    the angle ``tau`` between the flank's normal and the direction across the tooth, i.e. the angle of a
    load there.  With ``psi`` the half angle of the tooth on the base circle ``rb`` and roll angle
    ``tau + psi``:  half_thickness = rb ((tau + psi) cos(tau) - sin(tau)),
    height = rb ((tau + psi) sin(tau) + cos(tau)).
fillet
    the angle ``gamma`` between the rack's pitch line and the common normal of rack and gear, see
    :mod:`coupling.gears.rack`.  It runs from pi/2 (bottom of the space) to `Gear.fillet_end` (start of the
    involute), which is the transverse pressure angle but for undercut teeth.

All of it is in the transverse plane; tip relief, a few micrometres, is not drawn.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.gears.geometry import Gear

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ProfilePoints:
    """Points of one side of a tooth, and the derivative of their height.

    Attributes
    ----------
    height, half_thickness : ndarray
        Coordinates along and across the tooth [m].
    height_rate : ndarray
        Derivative of `height` by the curve's parameter [m/rad].
    """

    height: FloatArray
    half_thickness: FloatArray
    height_rate: FloatArray

    @property
    def radius(self) -> FloatArray:
        """Distance from the gear's centre [m]."""
        return np.hypot(self.height, self.half_thickness)


def load_angle(gear: Gear, radius: FloatArray) -> FloatArray:
    """Angle of the flank's normal to the direction across the tooth, at `radius`.

    Parameters
    ----------
    gear : Gear
    radius : ndarray
        Radii on the involute [m].

    Returns
    -------
    ndarray
        ``tan(a) - psi`` with ``a`` the profile's pressure angle there [rad].
    """
    roll = np.sqrt(np.maximum(0.0, (radius / gear.base_radius) ** 2 - 1.0))
    return np.asarray(roll - gear.base_half_angle, dtype=np.float64)


def flank_points(gear: Gear, angle: FloatArray) -> ProfilePoints:
    """Flank of a tooth at load angles `angle` [rad], any shape."""
    rb = gear.base_radius
    roll = angle + gear.base_half_angle
    sine, cosine = np.sin(angle), np.cos(angle)
    return ProfilePoints(
        height=rb * (roll * sine + cosine),
        half_thickness=rb * (roll * cosine - sine),
        height_rate=rb * roll * cosine,
    )


def fillet_points(gear: Gear, gamma: FloatArray) -> ProfilePoints:
    """Root fillet of a tooth at `gamma` [rad], from pi/2 (root circle) down to `Gear.fillet_end`."""
    return ProfilePoints(*gear.rack_corner_arc.trochoid(gear.pitch_radius, gamma))


def root_half_angle(gear: Gear) -> float:
    """Half the angle a tooth spans on the root circle, where the trochoid meets it [rad]."""
    return gear.rack_corner[1] / gear.pitch_radius


def tooth_side(gear: Gear, points: int) -> tuple[FloatArray, FloatArray]:
    """Half thickness and height [m] of one side of a tooth, from the root circle to the tip, (2 * points - 1,) each.

    `points` are those on each curve, fillet and flank.
    """
    fillet = fillet_points(gear, np.linspace(math.pi / 2.0, gear.fillet_end, points))
    angles = load_angle(gear, np.array([gear.form_radius, gear.tip_radius]))
    flank = flank_points(gear, np.linspace(angles[0], angles[1], points))
    across = np.concatenate([fillet.half_thickness, flank.half_thickness[1:]])
    return across, np.concatenate([fillet.height, flank.height[1:]])


def tooth_outline(gear: Gear, points: int = 60) -> FloatArray:
    """Outline of one tooth about its own axis, root to tip to root.

    Parameters
    ----------
    gear : Gear
    points : int
        Points on each curve (fillet, flank) of a side.

    Returns
    -------
    ndarray, shape (4 * points - 2, 2)
        Coordinates across and along the tooth [m]; left side upward, then right side downward.

    See Also
    --------
    coupling.gears.outline.gear_outline : all teeth, at any rotation and place.
    """
    across, along = tooth_side(gear, points)
    left = np.column_stack([-across, along])
    right = np.column_stack([across, along])[::-1]
    return np.vstack([left, right])
