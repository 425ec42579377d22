"""Elastic ring model: the potential energy method with the tooth as a beam on an exact elastic ring.

Sainsot, Velex & Duverger (2004) solved the same ring.  Their printed polynomials give what its root arc does *at its
middle* under a linear normal and a constant shear traction, in plane strain with ``nu = 0.3``: a test finds L, P and
P Q so, within 4 %.
The load's lever on the root circle is often taken to the loaded point of the flank, as in the published case of Ma et
al. (2014), not to where the line of action crosses the tooth's axis.  The middle of the arc rotates a third more than
the work of the load asks for, and the longer lever adds to it: tooth and body come out up to 30 % too soft against a
finite-element model.  Here

* the tooth is a beam on the root circle, plane sections, with the same integrals
  (:mod:`coupling.gears.beam_compliance`), from the height of the root circle up: what lies between the circle and
  its chord belongs to the body;
* its root section is the rigid arc that plane sections make it, and the body is the ring under that arc
  (:mod:`coupling.gears.rim`), loaded in full equilibrium with the load on the flank.

No number is fitted.  Against finite elements (tests/validation) the model is -2 to +8 % off, most where the load is
near the root and the tooth is no beam; neighbouring teeth, which stiffen the root by some 2 %, are left out. The cross
compliance of the next tooth is `coupling.gears.rim.neighbour_compliance`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from coupling.gears.beam_compliance import PlaneState, beam_compliance, foot_at_height
from coupling.gears.compliant_teeth import CompliantTeeth, SharedBody, SolvedTooth, ToothCompliance
from coupling.gears.geometry import Gear
from coupling.gears.rim import rim_compliance, ring_compliance

FloatArray = npt.NDArray[np.float64]


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
