"""Tooth models, compliance of one tooth: potential energy method, elastic ring, Cornell, Weber-Banaschek.

Potential energy method (Ma et al. 2014) with Sainsot's gear body and Yang & Sun's contact: the tooth is a beam on the
root circle (:mod:`coupling.gears.beam_compliance`, in plane stress), the body a ring held at its bore
(:mod:`coupling.gears.foundation`); the rim's share is that of :mod:`coupling.gears.rim`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from coupling.gears.beam_compliance import beam_compliance
from coupling.gears.compliant_teeth import CompliantTeeth, ContactModel, SharedBody, SolvedTooth, ToothCompliance
from coupling.gears.foundation import RootSection, foundation_compliance
from coupling.gears.geometry import Gear
from coupling.gears.rim import rim_compliance

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class PotentialEnergyStiffness(CompliantTeeth):
    """Energy method with Sainsot's body and Yang & Sun's contact, as published by Ma et al. (2014).

    Parameters
    ----------
    root_section : {"ma2014", "trochoid"}
        See `coupling.gears.foundation.root_section_angle`.
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

        def tooth(radius: FloatArray) -> ToothCompliance:
            foundation = foundation_compliance(gear, radius, self.root_section)
            return ToothCompliance(*beam_compliance(gear, radius), foundation=foundation, rim=rim(radius))

        return tooth
