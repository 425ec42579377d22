"""The energy method without its two shortcuts: the tooth as a beam on an exact elastic ring.

Sainsot, Velex & Duverger (2004) solved the same ring.  Their printed polynomials give what its root arc does *at its
middle* under a linear normal and a constant shear traction, in plane strain with ``nu = 0.3``: a test finds L, P and
P Q so, within 4 %.
The load's lever on the root circle is often taken to the loaded point of the flank, as in the published case of Ma et
al. (2014), not to where the line of action crosses the tooth's axis.  The middle of the arc turns a third more than
the work of the load asks for, and the longer lever adds to it: tooth and body come out up to 30 % too soft against a
finite-element model.  Here

* the tooth is a beam on the root circle, plane sections, with the same integrals
  (:mod:`coupling.gears.beam_compliance`), from the height of the root circle up: what lies between the circle and
  its chord belongs to the body;
* its root section is the rigid arc that plane sections make it, and the body is the ring under that arc
  (:mod:`coupling.gears.rim`), loaded in full equilibrium with the load on the flank.

No number is fitted.  Against finite elements (tests/validation) the model is -2 to +8 % off, most where the load is
near the root and the tooth is no beam; neighbouring teeth, which stiffen the root by some 2 %, are left out. What a
load moves the next tooth is `coupling.gears.rim.neighbour_compliance`.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from coupling.gears.beam_compliance import PlaneState, beam_compliance, foot_at_height
from coupling.gears.geometry import Gear
from coupling.gears.rim import solved_rim, solved_ring
from coupling.gears.tooth_compliance import SolvedTooth, ToothCompliance

FloatArray = npt.NDArray[np.float64]


def elastic_ring(gear: Gear, radius: FloatArray, state: PlaneState = "plane-stress") -> ToothCompliance:
    """Tooth compliance by the energy method on an exact elastic ring.

    Parameters
    ----------
    gear : Gear
    radius : ndarray
        Radii of the loaded points [m], from the form radius to the tip.
    state : {"plane-stress", "plane-strain"}
        Plane stress for a face of a few tooth thicknesses, plane strain for a wide one.

    Returns
    -------
    ToothCompliance
        Arrays of the shape of `radius`.

    Raises
    ------
    GearError
        For a radius off the involute flank.
    """
    return solved_elastic_ring(gear, state)(radius)


def solved_elastic_ring(gear: Gear, state: PlaneState = "plane-stress") -> SolvedTooth:
    """`elastic_ring` of one tooth, for any radii."""
    foot = foot_at_height(gear, gear.root_circle_radius)
    ring, rim = solved_ring(gear, state), solved_rim(gear, state)

    def tooth(radius: FloatArray) -> ToothCompliance:
        radius = np.asarray(radius, dtype=np.float64)
        beam = beam_compliance(gear, radius, foot, state)
        return ToothCompliance(*beam, foundation=ring(radius), rim=rim(radius))

    return tooth
