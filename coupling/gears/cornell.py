"""Cornell's tooth, as the NASA sources used it: a cantilever on an effective fillet, and O'Donnell's foundation.

R. W. Cornell, "Compliance and stress sensitivity of spur gear teeth", J. Mech. Design 103 (1981).  The beam's part is
that of :mod:`coupling.gears.beam_compliance` from the effective fillet section up to the load, which stands where the
fillet's tangent leans by 75 degrees from the tooth's axis.  The body is a half plane under the bending moment, shear
and thrust of that section (O'Donnell, J. Appl. Mechanics 27, 1960).  With ``l`` the lever from the section
to where the line of action crosses the axis, and ``h`` the section's thickness:

    plane stress  cos(beta)^2 / (E b) (16.67/pi (l/h)^2 + 2 (1 - nu) l/h + 1.534 (1 + tan(beta)^2 / (2.4 (1 + nu))))
    plane strain  cos(beta)^2 (1 - nu^2) / (E b)
                  (16.67/pi (l/h)^2 + 2 (1 - nu - 2 nu^2)/(1 - nu^2) l/h + 1.534 (1 + tan(beta)^2 / (2.4 (1 + nu))))

A tooth is wide, in plane strain, where its face is more than five thicknesses at the reference circle.  The contact is
Weber's (:mod:`coupling.gears.hertz`).

The paper itself was not at hand: the equations are in the form in which NASA's gear dynamics reports quote them, and
the effective fillet angle is O'Donnell's fixed one, where Cornell derives it from the tooth.  A half plane knows no
torque on a ring: the twist of the body is not in this model.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from coupling.gears.beam_compliance import PlaneState, axis_crossing, beam_compliance, foot_at_slope
from coupling.gears.geometry import Gear
from coupling.gears.profile import fillet_points, flank_points, load_angle
from coupling.gears.rim import solved_rim
from coupling.gears.tooth_compliance import SolvedTooth, ToothCompliance

FloatArray = npt.NDArray[np.float64]

EFFECTIVE_FILLET_ANGLE = math.radians(75.0)
"""Lean of the fillet's tangent at the effective section [rad] (O'Donnell)."""
_WIDE = 5.0


def cornell(gear: Gear, radius: FloatArray, state: PlaneState | None = None) -> ToothCompliance:
    """Tooth compliance after Cornell (1981).

    Parameters
    ----------
    gear : Gear
    radius : ndarray
        Radii of the loaded points [m], from the form radius to the tip.
    state : {"plane-stress", "plane-strain"} or None
        None for `cornell_state`.

    Returns
    -------
    ToothCompliance
        Arrays of the shape of `radius`.

    Raises
    ------
    GearError
        For a radius off the involute flank.
    """
    return solved_cornell(gear, state)(radius)


def solved_cornell(gear: Gear, state: PlaneState | None = None) -> SolvedTooth:
    """`cornell` of one tooth, for any radii."""
    chosen = state or cornell_state(gear)
    foot = foot_at_slope(gear, EFFECTIVE_FILLET_ANGLE)
    section = fillet_points(gear, np.array(foot))
    nu = gear.poisson_ratio
    coupling = 2.0 * (1.0 - nu)
    if chosen == "plane-strain":
        coupling = 2.0 * (1.0 - nu - 2.0 * nu**2) / (1.0 - nu**2)
    plane = 1.0 if chosen == "plane-stress" else 1.0 - nu**2
    rim = solved_rim(gear, chosen)

    def tooth(radius: FloatArray) -> ToothCompliance:
        radius = np.asarray(radius, dtype=np.float64)
        beta = load_angle(gear, radius)
        lever = (axis_crossing(gear, radius) - section.height) / (2.0 * section.half_thickness)
        thrust = np.tan(beta) ** 2 / (2.4 * (1.0 + nu))
        shape = 16.67 / math.pi * lever**2 + coupling * lever + 1.534 * (1.0 + thrust)
        foundation = np.cos(beta) ** 2 * plane * shape / (gear.youngs_modulus * gear.face_width)
        return ToothCompliance(*beam_compliance(gear, radius, foot, chosen), foundation=foundation, rim=rim(radius))

    return tooth


def cornell_state(gear: Gear) -> PlaneState:
    """Plane strain for a face wider than five tooth thicknesses at the reference circle, else plane stress."""
    thickness = 2.0 * float(flank_points(gear, load_angle(gear, np.array(gear.pitch_radius))).half_thickness)
    return "plane-strain" if gear.face_width > _WIDE * thickness else "plane-stress"
