"""Tooth compliance models: potential energy method, elastic ring, Cornell (1981), Weber-Banaschek (1953).

**Potential energy method** (Ma et al. 2014) with Sainsot's gear body and Yang & Sun's contact: the tooth is a beam on
the root circle (:mod:`gearwhine.coupling.gears.stiffness.beam`, in plane stress), the body a ring held at its bore
(:mod:`gearwhine.coupling.gears.stiffness.foundation`); the rim's share is that of
:mod:`gearwhine.coupling.gears.stiffness.ring_body`.

**Elastic ring model**: the potential energy method with the tooth as a beam on an exact elastic ring.

Sainsot, Velex & Duverger (2004) solved the same ring.  Their printed polynomials give what its root arc does *at its
middle* under a linear normal and a constant shear traction, in plane strain with ``nu = 0.3``: a test finds L, P and
P Q so, within 4 %.
The load's lever on the root circle is often taken to the loaded point of the flank, as in the published case of Ma et
al. (2014), not to where the line of action crosses the tooth's axis.  The middle of the arc rotates a third more than
the work of the load asks for, and the longer lever adds to it: tooth and body come out up to 30 % too soft against a
finite-element model.  Here

* the tooth is a beam on the root circle, plane sections, with the same integrals
  (:mod:`gearwhine.coupling.gears.stiffness.beam`), from the height of the root circle up: what lies between the circle
  and its chord belongs to the body;
* its root section is the rigid arc that plane sections make it, and the body is the ring under that arc
  (:mod:`gearwhine.coupling.gears.stiffness.ring_body`), loaded in full equilibrium with the load on the flank.

No number is fitted.  Against finite elements (tests/validation) the model is -2 to +8 % off, most where the load is
near the root and the tooth is no beam; neighbouring teeth, which stiffen the root by some 2 %, are left out. The cross
compliance of the next tooth is `gearwhine.coupling.gears.stiffness.ring_body.neighbour_compliance`.

**Cornell's tooth model** (1981): a cantilever on an effective fillet section, and O'Donnell's foundation.

R. W. Cornell, "Compliance and stress sensitivity of spur gear teeth", J. Mech. Design 103 (1981).  The beam's part is
that of :mod:`gearwhine.coupling.gears.stiffness.beam` from the effective fillet section up to the load, which stands
where the fillet's tangent leans by 75 degrees from the tooth's axis.  The body is a half plane under the bending
moment, shear and thrust of that section (O'Donnell, J. Appl. Mechanics 27, 1960).  With ``l`` the lever from the
section to where the line of action crosses the axis, and ``h`` the section's thickness:

    plane stress  cos(beta)^2 / (E b) (16.67/pi (l/h)^2 + 2 (1 - nu) l/h + 1.534 (1 + tan(beta)^2 / (2.4 (1 + nu))))
    plane strain  cos(beta)^2 (1 - nu^2) / (E b)
                  (16.67/pi (l/h)^2 + 2 (1 - nu - 2 nu^2)/(1 - nu^2) l/h + 1.534 (1 + tan(beta)^2 / (2.4 (1 + nu))))

A tooth is wide, in plane strain, where its face is more than five thicknesses at the reference circle.  The contact is
Weber's (:mod:`gearwhine.coupling.gears.stiffness.hertz`).

The paper itself was not at hand: the equations are in the form in which NASA's gear dynamics reports quote them, and
the effective fillet angle is O'Donnell's fixed one, where Cornell derives it from the tooth.  A half plane knows no
torque on a ring: the twist of the body is not in this model.

**Weber-Banaschek tooth model** (1953): exact energies of tooth and half plane, the origin of ISO 6336's stiffness.

C. Weber and K. Banaschek, *Formaenderung und Profilruecknahme bei gerad- und schraegverzahnten Raedern*, Schriftenreihe
Antriebstechnik 11, 1953.  Everything is in plane strain.  With ``y`` along the tooth's axis from its root section, the
line of action crossing it at ``y_p``, thickness ``d(y)`` and root thickness ``s``, per unit load:

    tooth   cos(beta)^2 (1 - nu^2) / (E b)
            (12 int (y_p - y)^2 / d^3 dy + (2.4 / (1 - nu) + tan(beta)^2) int dy / d)
    body    cos(beta)^2 (1 - nu^2) / (E b)
            (18/pi (y_p/s)^2 + 2 (1 - 2 nu)/(1 - nu) y_p/s + 4.8/pi (1 + (1 - nu)/2.4 tan(beta)^2))

which for ``nu = 0.3`` is usually printed with the rounded numbers 10.92, 3.1 (1 + 0.294 tan(beta)^2) and
5.2, 1, 1.4 (1 + 0.294 tan(beta)^2).  The tooth is :mod:`gearwhine.coupling.gears.stiffness.beam` in plane strain, from
the root circle.  The body's constants are those of a half plane under a linear normal and a parabolic shear
traction, by the work they do; a test finds them again.  The contact is Weber's
(:mod:`gearwhine.coupling.gears.stiffness.hertz`).

The book was not at hand: the form is that of later papers that quote it, its constants read as functions of ``nu`` by
the half plane they come from.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from typing import ClassVar

import numpy as np

from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.profile import fillet_points, flank_points, load_angle
from gearwhine.coupling.gears.stiffness.beam import (
    ROOT_CIRCLE,
    PlaneState,
    axis_crossing,
    beam_compliance,
    foot_at_height,
    foot_at_slope,
)
from gearwhine.coupling.gears.stiffness.compliant_teeth import (
    CompliantTeeth,
    ContactModel,
    SharedBody,
    SolvedTooth,
    ToothCompliance,
)
from gearwhine.coupling.gears.stiffness.foundation import RootSection, foundation_compliance
from gearwhine.coupling.gears.stiffness.ring_body import rim_compliance, ring_compliance
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True)
class PotentialEnergyStiffness(CompliantTeeth):
    """Energy method with Sainsot's body and Yang & Sun's contact, as published by Ma et al. (2014).

    Parameters
    ----------
    root_section : {"ma2014", "trochoid"}
        See `gearwhine.coupling.gears.stiffness.foundation.root_section_angle`.
    contact, force
        See `CompliantTeeth`.
    """

    name: ClassVar[str] = "potential-energy"
    root_section: RootSection = "ma2014"
    contact: ContactModel = field(default="yang-sun", kw_only=True)

    def shared_body(self, gear: Gear) -> SharedBody:
        """See `CompliantTeeth`."""
        return SharedBody("plane-stress", twists=True)

    def solve_tooth(self, gear: Gear) -> SolvedTooth:
        """See `CompliantTeeth`."""
        rim = rim_compliance(gear)
        # Sainsot's constants are of discs: internal teeth stand on their exact ring instead.
        disc = partial(foundation_compliance, gear, root_section=self.root_section)
        body = ring_compliance(gear) if gear.is_internal else disc

        def tooth(radius: FloatArray) -> ToothCompliance:
            return ToothCompliance(*beam_compliance(gear, radius), foundation=body(radius), rim=rim(radius))

        return tooth


@dataclass(frozen=True)
class ElasticRingStiffness(CompliantTeeth):
    """Energy method on an exact elastic ring, with Weber's contact.

    Parameters
    ----------
    state : {"plane-stress", "plane-strain"}
        Plane stress for a face of a few tooth thicknesses, plane strain for a wide one.
    contact, force
        See `CompliantTeeth`.
    """

    name: ClassVar[str] = "elastic-ring"
    state: PlaneState = "plane-stress"

    def shared_body(self, gear: Gear) -> SharedBody:
        """See `CompliantTeeth`."""
        return SharedBody(self.state, twists=True)

    def solve_tooth(self, gear: Gear) -> SolvedTooth:
        """See `CompliantTeeth`."""
        foot = foot_at_height(gear, gear.root_circle_radius)
        ring, rim = ring_compliance(gear, self.state), rim_compliance(gear, self.state)

        def tooth(radius: FloatArray) -> ToothCompliance:
            beam = beam_compliance(gear, radius, foot, self.state)
            return ToothCompliance(*beam, foundation=ring(radius), rim=rim(radius))

        return tooth


EFFECTIVE_FILLET_ANGLE = math.radians(75.0)
"""Lean of the fillet's tangent at the effective section [rad] (O'Donnell)."""
_WIDE_FACE_THICKNESSES = 5.0


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
    return "plane-strain" if gear.face_width > _WIDE_FACE_THICKNESSES * thickness else "plane-stress"


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
