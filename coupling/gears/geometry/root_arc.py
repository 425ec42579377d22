"""Root fillet of an internal gear: a circular arc between the flank and the root circle.

An internal gear is shaped, skived, broached, eroded or ground. The trochoid of its fillet depends on that tool, which
the drawing of a gear does not tell, while it does tell the radius of the fillet. So the fillet is the arc of that
radius which touches the involute and the root circle; a broached, eroded or form-ground ring has exactly this. In place
of the depth to which a tool generates the flank, the place where the arc leaves the flank is the form circle.

Radii are signed as those of the gear (ISO 21771: negative of an internal gear). The flank's normal touches the base
circle; from there the flank is ``rb u`` away along it (u the roll angle), and the centre of an arc of radius ``rho`` in
the space beside the tooth ``rb u + rho``. It lies ``r_f + rho`` from the gear's centre, r_f the root circle's radius:

    u_c^2 = ((r_f + rho) / rb)^2 - 1,        u_form = u_c - rho / rb,

and its direction from the gear's centre is ``chi = psi - u_form + atan(u_c)`` from the tooth's axis, psi the half angle
of the tooth on the base circle. The arc's outward normal turns from chi, at the root circle, to
``pi / 2 - (u_form - psi)``, on the flank. With gamma = pi/2 at the root circle, as on a trochoid, it is
``chi + pi / 2 - gamma``, and gamma ends at ``atan(u_c)``, the pressure angle on the circle of the arc's centre.

The fillet is in the transverse plane, of helical gears too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from gearwhine.coupling.gears.geometry.rack import TrochoidPoints


@dataclass(frozen=True)
class RootArc:
    """Root fillet of an internal gear.

    Parameters
    ----------
    base_radius, root_circle_radius : float
        Signed radii of the gear [m].
    base_half_angle : float
        Half the angle that a tooth spans on the base circle, signed as the gear's [rad].
    radius : float
        Radius of the arc [m], at most ``|root_circle_radius| - |base_radius|``.
    """

    base_radius: float
    root_circle_radius: float
    base_half_angle: float
    radius: float

    @property
    def centre_roll_angle(self) -> float:
        """Roll angle u_c on the circle of the arc's centre [rad]."""
        return math.sqrt(max(0.0, ((self.root_circle_radius + self.radius) / self.base_radius) ** 2 - 1.0))

    @property
    def form_roll_angle(self) -> float:
        """Roll angle of the flank at which the arc begins [rad]."""
        return self.centre_roll_angle - self.radius / self.base_radius

    @property
    def form_radius(self) -> float:
        """Radius of the form circle, at which the arc leaves the flank, signed [m]."""
        return self.base_radius * math.hypot(1.0, self.form_roll_angle)

    @property
    def end(self) -> float:
        """The parameter gamma of `points` at which the flank begins [rad]."""
        return math.atan(self.centre_roll_angle)

    @property
    def centre_angle(self) -> float:
        """Half the angle that a tooth spans on the root circle, between the ends of its arcs, signed [rad]."""
        return self.base_half_angle - self.form_roll_angle + self.end

    def points(self, gamma: npt.ArrayLike) -> TrochoidPoints:
        """Points of the arc at gamma [rad], from pi/2 on the root circle down to `end` on the flank."""
        normal = self.centre_angle + math.pi / 2.0 - np.asarray(gamma, dtype=np.float64)
        out = self.root_circle_radius + self.radius
        return TrochoidPoints(
            height=out * math.cos(self.centre_angle) - self.radius * np.cos(normal),
            half_thickness=out * math.sin(self.centre_angle) - self.radius * np.sin(normal),
            height_rate=-self.radius * np.sin(normal),
        )


def full_arc_radius(base_radius: float, root_circle_radius: float, base_half_angle: float, teeth: int) -> float:
    """Radius of the largest fillet [m]: one arc from flank to flank, or the one that ends on the base circle.

    Negative where the flanks of a space meet before they reach the root circle.
    """

    def beside_middle(radius: float) -> float:
        return abs(math.pi / teeth) - abs(
            RootArc(base_radius, root_circle_radius, base_half_angle, radius).centre_angle
        )

    most = abs(root_circle_radius) - abs(base_radius)
    if beside_middle(0.0) <= 0.0:
        return -1.0
    if beside_middle(most) >= 0.0:
        return most
    return float(brentq(beside_middle, 0.0, most, xtol=1e-15))
