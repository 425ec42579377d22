"""Stiffness of a pair from what its two teeth and their contact yield: the models that look at the tooth.

The compliances of both teeth and of their contact add up, ``c(s) = c_k(s) + c_i(s) + h(F, s)``, and the stiffness is
its inverse.  Where the contact is Weber's, ``h`` depends on the load F of the pair.  The dynamics need a stiffness that
is a function of position alone; it is then frozen at the load that the model is given, as the secant through it, so
that the deflection under that load is exact and that under others is not.  `PairCompliance.pair_compliance` with a
force is exact at any.  A load that is not given is `REFERENCE_LINE_LOAD` times the face width.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from coupling.gears import piecewise
from coupling.gears.beam_compliance import PlaneState
from coupling.gears.cornell import cornell
from coupling.gears.elastic_ring import elastic_ring
from coupling.gears.errors import StiffnessModelError
from coupling.gears.foundation import RootSection
from coupling.gears.geometry import Gear
from coupling.gears.hertz import hertz_compliance, line_contact
from coupling.gears.normal_section import by_normal_section
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.piecewise import PiecewiseCubic
from coupling.gears.tooth_compliance import ToothCompliance, ToothModel, potential_energy
from coupling.gears.weber_banaschek import weber_banaschek

FloatArray = npt.NDArray[np.float64]

ContactModel = Literal["yang-sun", "weber"]

REFERENCE_LINE_LOAD = 300e3
"""Load per face width at which Weber's contact is taken where none is given [N/m]: within the 100 to 1600 N/mm that the
constants of ISO 6336-1 are for."""


class CompliantTeeth(ABC):
    """A pair of teeth in series with their contact.

    Attributes
    ----------
    contact : {"yang-sun", "weber"}
        See :mod:`coupling.gears.hertz`.
    force : float or None
        Load of the pair at which Weber's contact is frozen [N]; None for `REFERENCE_LINE_LOAD`.
    """

    contact: ContactModel
    force: float | None

    @abstractmethod
    def tooth(self, gear: Gear, radius: FloatArray) -> ToothCompliance:
        """Compliance of one tooth under a load at `radius` [m]."""

    def teeth_compliance(self, geometry: GearPairGeometry, position: npt.ArrayLike) -> FloatArray:
        """Compliance of both teeth without their contact [m/N] at `position` in base pitches."""
        driver, driven = geometry.driver, geometry.driven
        return self._one_tooth(driver, geometry.driver_radius(position)) + self._one_tooth(
            driven, geometry.driven_radius(position)
        )

    def _one_tooth(self, gear: Gear, radius: FloatArray) -> FloatArray:
        if gear.helix_angle == 0.0:
            return self.tooth(gear, radius).total
        yields = by_normal_section(gear, radius, lambda spur, there: self.tooth(spur, there).total)
        return np.asarray(yields / math.cos(gear.base_helix_angle), dtype=np.float64)

    def contact_compliance(
        self, geometry: GearPairGeometry, position: npt.ArrayLike, force: float | None = None
    ) -> FloatArray:
        """Approach of the flanks over their load [m/N] at `position`, under `force` [N] (None: the model's own)."""
        at = np.asarray(position, dtype=np.float64)
        if self.contact == "yang-sun":
            flattening = hertz_compliance(geometry.driver, geometry.driven)
            return np.full(at.shape, flattening / math.cos(geometry.driver.base_helix_angle))
        load = force if force is not None else self.force
        if load is None:
            load = REFERENCE_LINE_LOAD * geometry.face_width
        approach = line_contact(geometry, at.ravel()).secant_compliance(load).reshape(at.shape)
        return np.asarray(approach / math.cos(geometry.driver.base_helix_angle), dtype=np.float64)

    def pair_compliance(
        self, geometry: GearPairGeometry, position: npt.ArrayLike, force: float | None = None
    ) -> FloatArray:
        """Compliance of one pair [m/N] at `position` in base pitches, without any table.

        Parameters
        ----------
        geometry : GearPairGeometry
        position : array_like
            Base pitches.
        force : float or None
            Load of the pair [N] for a contact that depends on it: the deflection is ``force`` times the compliance.

        Returns
        -------
        ndarray
            Same shape as `position`.
        """
        return self.teeth_compliance(geometry, position) + self.contact_compliance(geometry, position, force)

    def pair_stiffness(self, geometry: GearPairGeometry) -> PiecewiseCubic:
        """Stiffness [N/m] by position; the table is checked against the model to 1e-9."""
        return piecewise.tabulated(
            lambda position: 1.0 / self.pair_compliance(geometry, position), geometry.contact_ratio
        )

    def _check(self, name: str) -> None:
        if self.contact not in ("yang-sun", "weber"):
            raise StiffnessModelError(
                f"stiffness model {name!r}: contact must be 'yang-sun' or 'weber', got {self.contact!r}"
            )
        if self.force is not None and not (math.isfinite(self.force) and self.force > 0.0):
            raise StiffnessModelError(f"stiffness model {name!r}: force must be above 0 N, got {self.force!r}")


@dataclass(frozen=True)
class PotentialEnergyStiffness(CompliantTeeth):
    """Energy method with Sainsot's body and Yang & Sun's contact, as published by Ma et al. (2014).

    Parameters
    ----------
    root_section : {"ma2014", "trochoid"}
        See `coupling.gears.foundation.root_section_angle`; ignored when `tooth_model` is given.
    tooth_model : callable or None
        Another tooth model (gear, radii) -> `ToothCompliance` in place of `potential_energy`.
    contact, force
        See `CompliantTeeth`.
    """

    root_section: RootSection = "ma2014"
    tooth_model: ToothModel | None = None
    contact: ContactModel = "yang-sun"
    force: float | None = None

    def __post_init__(self) -> None:
        self._check("potential-energy")

    def tooth(self, gear: Gear, radius: FloatArray) -> ToothCompliance:
        """Compliance of one tooth under a load at `radius` [m]."""
        if self.tooth_model is not None:
            return self.tooth_model(gear, radius)
        return potential_energy(gear, radius, self.root_section)


@dataclass(frozen=True)
class ElasticRingStiffness(CompliantTeeth):
    """Energy method on an exact elastic ring, with Weber's contact; see :mod:`coupling.gears.elastic_ring`."""

    state: PlaneState = "plane-stress"
    contact: ContactModel = "weber"
    force: float | None = None

    def __post_init__(self) -> None:
        self._check("elastic-ring")

    def tooth(self, gear: Gear, radius: FloatArray) -> ToothCompliance:
        """Compliance of one tooth under a load at `radius` [m]."""
        return elastic_ring(gear, radius, self.state)


@dataclass(frozen=True)
class CornellStiffness(CompliantTeeth):
    """Cornell (1981), with Weber's contact; see :mod:`coupling.gears.cornell`."""

    state: PlaneState | None = None
    contact: ContactModel = "weber"
    force: float | None = None

    def __post_init__(self) -> None:
        self._check("cornell")

    def tooth(self, gear: Gear, radius: FloatArray) -> ToothCompliance:
        """Compliance of one tooth under a load at `radius` [m]."""
        return cornell(gear, radius, self.state)


@dataclass(frozen=True)
class WeberBanaschekStiffness(CompliantTeeth):
    """Weber and Banaschek (1953), with Weber's contact; see :mod:`coupling.gears.weber_banaschek`."""

    contact: ContactModel = "weber"
    force: float | None = None

    def __post_init__(self) -> None:
        self._check("weber-banaschek")

    def tooth(self, gear: Gear, radius: FloatArray) -> ToothCompliance:
        """Compliance of one tooth under a load at `radius` [m]."""
        return weber_banaschek(gear, radius)
