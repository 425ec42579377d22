"""What a tooth and the body under it yield to a load on the flank: the common result of all tooth models.

A tooth model is a function of a gear and radii on its flank.  The models here and beside differ in where the tooth
ends and the body begins, and in how the body gives way:

* `potential_energy`: the whole outline down to the root circle, Sainsot's body (Ma et al. 2014).
* `coupling.gears.elastic_ring.elastic_ring`: the same tooth, on an exact elastic ring.
* `coupling.gears.cornell.cornell`: an effective fillet, O'Donnell's half plane.
* `coupling.gears.weber_banaschek.weber_banaschek`: Weber's tooth on Weber's half plane.

The flattening where two flanks press on each other is not of one tooth: :mod:`coupling.gears.hertz`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from coupling.gears.beam_compliance import beam_compliance
from coupling.gears.foundation import RootSection, foundation_compliance
from coupling.gears.geometry import Gear
from coupling.gears.rim import solved_rim

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ToothCompliance:
    """What a tooth and the body under it yield, per unit load along the line of action [m/N].

    Attributes
    ----------
    bending, shear, axial, foundation : ndarray
        Of the tooth as a beam, and of the body it stands on; all of the shape of the radii asked for.
    rim : ndarray
        What a rim on a thinner web yields more than a body of the teeth's full width.
    """

    bending: FloatArray
    shear: FloatArray
    axial: FloatArray
    foundation: FloatArray
    rim: FloatArray = field(default_factory=lambda: np.zeros(()))

    @property
    def total(self) -> FloatArray:
        """All parts together [m/N]."""
        return self.bending + self.shear + self.axial + self.foundation + self.rim


ToothModel = Callable[[Gear, FloatArray], ToothCompliance]
"""A tooth model: from a gear and radii on its flank [m] to the compliance of a tooth there."""
SolvedTooth = Callable[[FloatArray], ToothCompliance]
"""One tooth, all solved that does not depend on the load: from radii on its flank [m] to its compliance."""


def potential_energy(gear: Gear, radius: FloatArray, root_section: RootSection = "ma2014") -> ToothCompliance:
    """Tooth compliance by the energy method, and Sainsot's for the body.

    The tooth is a beam on the root circle (:mod:`coupling.gears.beam_compliance`, in plane stress), the body a ring
    held at its bore (:mod:`coupling.gears.foundation`); the rim's share is that of :mod:`coupling.gears.rim`.

    Parameters
    ----------
    gear : Gear
    radius : ndarray
        Radii of the loaded points [m], from the form radius to the tip.
    root_section : {"ma2014", "trochoid"}
        See `coupling.gears.foundation.root_section_angle`.

    Returns
    -------
    ToothCompliance
        Arrays of the shape of `radius`.

    Raises
    ------
    GearError
        For a radius off the involute flank.
    StiffnessModelError
        For a body outside the range of Sainsot's formula.
    """
    return solved_potential_energy(gear, root_section)(radius)


def solved_potential_energy(gear: Gear, root_section: RootSection = "ma2014") -> SolvedTooth:
    """`potential_energy` of one tooth, for any radii."""
    rim = solved_rim(gear)

    def tooth(radius: FloatArray) -> ToothCompliance:
        radius = np.asarray(radius, dtype=np.float64)
        foundation = foundation_compliance(gear, radius, root_section)
        return ToothCompliance(*beam_compliance(gear, radius), foundation=foundation, rim=rim(radius))

    return tooth
