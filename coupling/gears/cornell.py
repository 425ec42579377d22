"""Cornell's tooth model (1981): a cantilever on an effective fillet section, and O'Donnell's foundation.

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
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from coupling.gears.beam_compliance import PlaneState, axis_crossing, beam_compliance, foot_at_slope
from coupling.gears.compliant_teeth import CompliantTeeth, SharedBody, SolvedTooth, ToothCompliance
from coupling.gears.geometry import Gear
from coupling.gears.profile import fillet_points, flank_points, load_angle
from coupling.gears.rim import rim_compliance

FloatArray = npt.NDArray[np.float64]

EFFECTIVE_FILLET_ANGLE = math.radians(75.0)
"""Lean of the fillet's tangent at the effective section [rad] (O'Donnell)."""
_WIDE = 5.0


@dataclass(frozen=True)
class CornellStiffness(CompliantTeeth):
    """Cornell's tooth (1981), with Weber's contact.

    Parameters
    ----------
    state : {"plane-stress", "plane-strain"} or None
        None for `cornell_state`.
    contact, force
        See `CompliantTeeth`.
    """

    name: ClassVar[str] = "cornell"
    state: PlaneState | None = None

    def shared_body(self, gear: Gear) -> SharedBody:
        """See `CompliantTeeth`."""
        return SharedBody(self.state or cornell_state(gear), twists=False)

    def solve_tooth(self, gear: Gear) -> SolvedTooth:
        """See `CompliantTeeth`."""
        state = self.state or cornell_state(gear)
        foot = foot_at_slope(gear, EFFECTIVE_FILLET_ANGLE)
        section = fillet_points(gear, np.array(foot))
        nu = gear.poisson_ratio
        coupling, plane = 2.0 * (1.0 - nu), 1.0
        if state == "plane-strain":
            coupling, plane = 2.0 * (1.0 - nu - 2.0 * nu**2) / (1.0 - nu**2), 1.0 - nu**2
        rim = rim_compliance(gear, state)

        def tooth(radius: FloatArray) -> ToothCompliance:
            beta = load_angle(gear, radius)
            lever = (axis_crossing(gear, radius) - section.height) / (2.0 * section.half_thickness)
            thrust = np.tan(beta) ** 2 / (2.4 * (1.0 + nu))
            shape = 16.67 / math.pi * lever**2 + coupling * lever + 1.534 * (1.0 + thrust)
            foundation = np.cos(beta) ** 2 * plane * shape / (gear.youngs_modulus * gear.face_width)
            return ToothCompliance(*beam_compliance(gear, radius, foot, state), foundation=foundation, rim=rim(radius))

        return tooth


def cornell_state(gear: Gear) -> PlaneState:
    """Plane strain for a face wider than five tooth thicknesses at the reference circle, else plane stress."""
    thickness = 2.0 * float(flank_points(gear, load_angle(gear, np.array(gear.pitch_radius))).half_thickness)
    return "plane-strain" if gear.face_width > _WIDE * thickness else "plane-stress"
