"""Basic rack (ISO 53) that cuts a gear, trochoid of the root fillet that its tip corner cuts, and undercut.

A rack (hob, rack cutter, grinding worm) is straight along its teeth, so its section by the gear's transverse plane
rolls on the gear's pitch circle as a plane figure, and the outline of the gear is the envelope of that section.  For a
helical gear the section is the normal profile (ISO 53) stretched by ``1 / cos(beta)`` along the pitch line: the flanks
stay straight, at the transverse pressure angle ``tan(alpha_t) = tan(alpha_n) / cos(beta)``, and the round corner of
radius ``rho`` becomes an ellipse of half axes ``rho / cos(beta)`` along and ``rho`` across the pitch line.  This is
exact; the finite number of cutting edges of a hob is left out.

The corner's point with the outward normal at ``gamma`` below the pitch line is, from the centre of the ellipse,

    c = rho cos(gamma) / (k cos(beta)^2),   e = rho sin(gamma) / k,   k^2 = (cos(gamma) / cos(beta))^2 + sin(gamma)^2,

c towards the flank and e towards the bottom, with the radius of curvature ``R = rho / (k^3 cos(beta)^2)``.  By the law
of gearing it cuts when its normal passes through the pitch point (Litvin & Fuentes, Gear Geometry and Applied Theory,
2004).  With the centre ``depth`` below the pitch line and ``across`` from the tooth's axis, D = depth + e, the
gear of pitch radius ``r`` has then rotated by ``turn``, and the point is ``reach`` away from the pitch point:

    turn = (across - c + D cot(gamma)) / r,     reach = D / sin(gamma),
    r turn' = (R - reach) / sin(gamma),         reach' = r turn' cos(gamma)      (derivatives by gamma).

Undercut is the case in which the trochoid of the fillet cuts off the involute.

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
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from gearwhine.coupling.gears.geometry.involute import involute
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True)
class BasicRack:
    """The tooth of the generating rack in its normal section.

    Parameters
    ----------
    module, pressure_angle : float
        Normal module [m] and normal pressure angle [rad].
    addendum, dedendum : float
        Addendum and dedendum of the cut gear, in modules: the rack's tooth reaches `dedendum` below its reference line.
    tip_radius : float or None
        Radius of the tip corner [m].  None: the radius that ends the straight flank one addendum below the reference
        line, ``(dedendum - addendum) m / (1 - sin(alpha))``, or the full tip radius where that is smaller.
    helix_angle : float
        Helix angle of the gear [rad].
    """

    module: float
    pressure_angle: float
    addendum: float
    dedendum: float
    tip_radius: float | None = None
    helix_angle: float = 0.0

    @property
    def full_tip_radius(self) -> float:
        """The largest corner radius: one arc from flank to flank of the rack's tooth [m]."""
        half_tip_land = self.module * (math.pi / 4.0 - self.dedendum * math.tan(self.pressure_angle))
        return half_tip_land * math.cos(self.pressure_angle) / (1.0 - math.sin(self.pressure_angle))

    @property
    def corner_radius(self) -> float:
        """Radius of the tip corner in the normal section [m]."""
        if self.tip_radius is not None:
            return self.tip_radius
        from_clearance = (self.dedendum - self.addendum) * self.module / (1.0 - math.sin(self.pressure_angle))
        return max(0.0, min(from_clearance, self.full_tip_radius))

    @property
    def flank_depth(self) -> float:
        """Depth of the end of the straight flank below the rack's reference line [m]."""
        return self.dedendum * self.module - self.corner_radius * (1.0 - math.sin(self.pressure_angle))

    def corner(self, profile_shift: float) -> RackCorner:
        """Return the tip corner in the transverse plane, the rack withdrawn by `profile_shift` modules."""
        depth = self.dedendum * self.module - self.corner_radius
        across = (
            math.pi * self.module / 4.0
            + depth * math.tan(self.pressure_angle)
            + self.corner_radius / math.cos(self.pressure_angle)
        )
        return RackCorner(
            depth=depth - profile_shift * self.module,
            across=across / math.cos(self.helix_angle),
            radius=self.corner_radius,
            helix_angle=self.helix_angle,
        )


class TrochoidPoints(NamedTuple):
    """Points of a fillet in the tooth's coordinates: along its axis from the gear's centre, and across [m]."""

    height: FloatArray
    half_thickness: FloatArray
    height_rate: FloatArray
    """Derivative of `height` by gamma [m/rad]."""


@dataclass(frozen=True)
class RackCorner:
    """The tip corner of a rack in the transverse plane of the gear.

    Attributes
    ----------
    depth, across : float
        Distances of the corner's centre below the gear's pitch line, and from the tooth's axis [m].
    radius : float
        Radius of the corner in the rack's normal section [m].
    helix_angle : float
        [rad]
    """

    depth: float
    across: float
    radius: float
    helix_angle: float

    def trochoid(self, pitch_radius: float, gamma: npt.ArrayLike) -> TrochoidPoints:
        """Trochoid that the corner cuts into a gear.

        Parameters
        ----------
        pitch_radius : float
            Radius of the rolling circle [m].
        gamma : array_like
            Angles of the common normal to the pitch line [rad]: pi/2 at the root circle, the transverse pressure
            angle where the straight flank takes over.

        Returns
        -------
        TrochoidPoints
        """
        gamma = np.asarray(gamma, dtype=np.float64)
        sine, cosine, squared = np.sin(gamma), np.cos(gamma), math.cos(self.helix_angle) ** 2
        stretch = np.sqrt(cosine**2 / squared + sine**2)
        below = self.depth + self.radius * sine / stretch
        curvature_radius = self.radius / (squared * stretch**3)
        reach = below / sine
        # cot(pi/2) is zero, not the 6e-17 that 1 / tan leaves: written so that the root circle is met exactly.
        turn = (self.across - self.radius * cosine / (stretch * squared) + below * (cosine / sine)) / pitch_radius
        rolled_rate = (curvature_radius - reach) / sine
        turn_rate, reach_rate = rolled_rate / pitch_radius, rolled_rate * cosine
        tilt = gamma - turn
        return TrochoidPoints(
            height=pitch_radius * np.cos(turn) - reach * np.sin(tilt),
            half_thickness=pitch_radius * np.sin(turn) - reach * np.cos(tilt),
            height_rate=-pitch_radius * np.sin(turn) * turn_rate
            - reach_rate * np.sin(tilt)
            - reach * np.cos(tilt) * (1.0 - turn_rate),
        )


def fillet_end(corner: RackCorner, pitch_radius: float, pressure_angle: float, base_half_angle: float) -> float:
    """Find the fillet parameter gamma [rad] at which trochoid and involute intersect.

    Parameters
    ----------
    corner : RackCorner
        Tip corner in the transverse plane.
    pitch_radius : float
        [m]
    pressure_angle : float
        Transverse pressure angle [rad].
    base_half_angle : float
        Half the angle of the tooth on the base circle [rad].

    Returns
    -------
    float
        Angle between `pressure_angle` (where nothing is cut off) and pi/2 [rad].
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
