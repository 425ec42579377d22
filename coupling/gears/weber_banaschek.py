"""Weber-Banaschek tooth model (1953): exact energies of tooth and half plane, the root of ISO 6336's stiffness.

C. Weber and K. Banaschek, *Formaenderung und Profilruecknahme bei gerad- und schraegverzahnten Raedern*, Schriftenreihe
Antriebstechnik 11, 1953.  Everything is in plane strain.  With ``y`` along the tooth's axis from its root section, the
line of action crossing it at ``y_p``, thickness ``d(y)`` and root thickness ``s``, per unit load:

    tooth   cos(beta)^2 (1 - nu^2) / (E b)
            (12 int (y_p - y)^2 / d^3 dy + (2.4 / (1 - nu) + tan(beta)^2) int dy / d)
    body    cos(beta)^2 (1 - nu^2) / (E b)
            (18/pi (y_p/s)^2 + 2 (1 - 2 nu)/(1 - nu) y_p/s + 4.8/pi (1 + (1 - nu)/2.4 tan(beta)^2))

which for ``nu = 0.3`` is usually printed with the rounded numbers 10.92, 3.1 (1 + 0.294 tan(beta)^2) and
5.2, 1, 1.4 (1 + 0.294 tan(beta)^2).  The tooth is :mod:`coupling.gears.beam_compliance` in plane strain, from the root
circle.  The body's constants are those of a half plane under a linear normal and a parabolic shear
traction, by the work they do; a test finds them again.  The contact is Weber's (:mod:`coupling.gears.hertz`).

The book was not at hand: the form is that of later papers that quote it, its constants read as functions of ``nu`` by
the half plane they come from.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from coupling.gears.beam_compliance import ROOT_CIRCLE, axis_crossing, beam_compliance
from coupling.gears.compliant_teeth import CompliantTeeth, SharedBody, SolvedTooth, ToothCompliance
from coupling.gears.geometry import Gear
from coupling.gears.profile import fillet_points, load_angle
from coupling.gears.rim import rim_compliance

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class WeberBanaschekStiffness(CompliantTeeth):
    """Weber and Banaschek's tooth (1953), with Weber's contact; parameters as of `CompliantTeeth`."""

    name: ClassVar[str] = "weber-banaschek"

    def shared_body(self, gear: Gear) -> SharedBody:
        """See `CompliantTeeth`."""
        return SharedBody("plane-stress", twists=False)

    def solve_tooth(self, gear: Gear) -> SolvedTooth:
        """See `CompliantTeeth`."""
        section = fillet_points(gear, np.array(ROOT_CIRCLE))
        nu = gear.poisson_ratio
        coupling = 2.0 * (1.0 - 2.0 * nu) / (1.0 - nu)
        rim = rim_compliance(gear, "plane-strain")

        def tooth(radius: FloatArray) -> ToothCompliance:
            beta = load_angle(gear, radius)
            lever = (axis_crossing(gear, radius) - section.height) / (2.0 * section.half_thickness)
            thrust = (1.0 - nu) / 2.4 * np.tan(beta) ** 2
            shape = 18.0 / math.pi * lever**2 + coupling * lever + 4.8 / math.pi * (1.0 + thrust)
            foundation = np.cos(beta) ** 2 * (1.0 - nu**2) * shape / (gear.youngs_modulus * gear.face_width)
            beam = beam_compliance(gear, radius, ROOT_CIRCLE, "plane-strain")
            return ToothCompliance(*beam, foundation=foundation, rim=rim(radius))

        return tooth
