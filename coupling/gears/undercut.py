"""Undercut: where the trochoid of the fillet cuts off the involute.

A rack whose straight flank reaches deeper than ``r sin(alpha_t)^2`` below the pitch line swings its corner through the
foot of the involute.  Trochoid and involute then no longer touch; they cross, and the flank begins at the crossing: the
point of equal radius ``R`` and equal half angle,

    atan(half_thickness / height) = psi - inv(acos(rb / R)),

psi half the angle of the tooth on the base circle.  The trochoid's radius falls all the way from the end of the rack's
flank to the root circle, so the crossing lies between that end (where the corner follows the flank on the far branch of
the involute, outside the tooth) and the trochoid's place on the base circle (inside).
"""

from __future__ import annotations

import math

from scipy.optimize import brentq

from coupling.gears.involute import involute
from coupling.gears.rack import RackCorner


def fillet_end(corner: RackCorner, pitch_radius: float, pressure_angle: float, base_half_angle: float) -> float:
    """The fillet's parameter gamma [rad] where trochoid and involute cross.

    Parameters
    ----------
    corner : RackCorner
        In the transverse plane.
    pitch_radius : float
        [m]
    pressure_angle : float
        Transverse pressure angle [rad].
    base_half_angle : float
        Half the angle of the tooth on the base circle [rad].

    Returns
    -------
    float
        Between `pressure_angle` (where nothing is cut off) and pi/2.
    """
    base_radius = pitch_radius * math.cos(pressure_angle)

    def above_base(gamma: float) -> float:
        height, across, _ = corner.trochoid(pitch_radius, gamma)
        return math.hypot(height, across) - base_radius

    def outside_tooth(gamma: float) -> float:
        height, across, _ = corner.trochoid(pitch_radius, gamma)
        ratio = min(1.0, base_radius / math.hypot(height, across))
        return math.atan2(across, height) - base_half_angle + involute(math.acos(ratio))

    if above_base(pressure_angle) <= 0.0:
        return pressure_angle
    at_base = float(brentq(above_base, pressure_angle, math.pi / 2.0, xtol=1e-15))
    # Within rounding of the limit of undercut the two ends are one.
    if outside_tooth(pressure_angle) <= 0.0 or outside_tooth(at_base) >= 0.0:
        return pressure_angle
    return float(brentq(outside_tooth, pressure_angle, at_base, xtol=1e-15))
