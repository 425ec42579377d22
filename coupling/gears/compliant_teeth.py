"""Stiffness of a pair from what its two teeth and their contact yield: the models that look at the tooth.

The compliances of both teeth and of their contact add up, ``c(s) = c_k(s) + c_i(s) + h(F, s)``, and the stiffness is
its inverse.  Where the contact is Weber's, ``h`` depends on the load F of the pair.  The dynamics need a stiffness that
is a function of position alone; it is then frozen at the load that the model is given, as the secant through it, so
that the deflection under that load is exact and that under others is not.  `PairCompliance.pair_compliance` with a
force is exact at any.  A load that is not given is `REFERENCE_LINE_LOAD` times the face width.

Neighbouring pairs stand on the same two bodies.  A load on one moves the other's flanks, along the line of action, by

    C(s) = c_k(s + 1, s) + c_i(s, s + 1),

c_k and c_i the cross compliances of two neighbouring teeth of each gear (:mod:`coupling.gears.rim`): the twist of the
body about its bore, which both feel in full, and the dent around the root.  As one load moves up its tooth the other
moves down, so that C hardly changes while both touch, by less than 1 %; the law takes its mean for all pairs.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np
import numpy.typing as npt

from coupling.gears import piecewise
from coupling.gears.beam_compliance import PlaneState
from coupling.gears.chebyshev import by_few_values
from coupling.gears.cornell import cornell_state, solved_cornell
from coupling.gears.elastic_ring import solved_elastic_ring
from coupling.gears.errors import StiffnessModelError
from coupling.gears.foundation import RootSection
from coupling.gears.geometry import Gear
from coupling.gears.hertz import hertz_compliance, line_contact
from coupling.gears.normal_section import Compliance, by_normal_section, cross_by_normal_section
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.piecewise import PiecewiseCubic
from coupling.gears.rim import CrossCompliance, neighbour_compliance
from coupling.gears.tooth_compliance import SolvedTooth, ToothCompliance, ToothModel, solved_potential_energy
from coupling.gears.weber_banaschek import solved_weber_banaschek

FloatArray = npt.NDArray[np.float64]

ContactModel = Literal["yang-sun", "weber"]

REFERENCE_LINE_LOAD = 300e3
"""Load per face width at which Weber's contact is taken where none is given [N/m]: within the 100 to 1600 N/mm that the
constants of ISO 6336-1 are for."""


_CROSS_NODES = 4


@dataclass(frozen=True)
class SharedBody:
    """The body that neighbouring teeth of a gear share.

    Attributes
    ----------
    state : {"plane-stress", "plane-strain"}
    turning : bool
        Whether the tooth's own compliance holds the twist of the whole body about its bore: one on a half plane has no
        bore.
    """

    state: PlaneState
    turning: bool


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
    def shared_body(self, gear: Gear) -> SharedBody | None:
        """What neighbouring teeth share of their gear's body; None where it is not known."""

    def shared_compliance(self, geometry: GearPairGeometry) -> float:
        """What pairs of teeth in contact at once yield in common, of both gears [m/N].

        The mean over the positions at which two neighbouring pairs touch. Zero where the model has no body, or where
        the path of contact never holds two pairs.
        """
        both = geometry.contact_ratio - 1.0
        driver, driven = self._neighbours(geometry.driver), self._neighbours(geometry.driven)
        if driver is None or driven is None or both <= 0.0:
            return 0.0
        nodes, weights = np.polynomial.legendre.leggauss(_CROSS_NODES)
        behind = 0.5 * both * (1.0 + nodes)
        ahead = behind + 1.0
        # The driver pushes against its own rotation, so that its next tooth in the sense of the load entered later.
        moved = driver(geometry.driver_radius(ahead), geometry.driver_radius(behind))
        moved = moved + driven(geometry.driven_radius(behind), geometry.driven_radius(ahead))
        return float(0.5 * weights @ moved)

    def _neighbours(self, gear: Gear) -> CrossCompliance | None:
        body = self.shared_body(gear)
        if body is None:
            return None

        def solve(spur: Gear) -> CrossCompliance:
            return neighbour_compliance(spur, body.state, turning=body.turning)

        if gear.helix_angle == 0.0:
            return solve(gear)
        moves = cross_by_normal_section(gear, solve)
        return lambda behind, ahead: moves(behind, ahead) / math.cos(gear.base_helix_angle)

    @abstractmethod
    def solved_tooth(self, gear: Gear) -> SolvedTooth:
        """One tooth, with all that does not depend on the load's radius solved."""

    def tooth(self, gear: Gear, radius: FloatArray) -> ToothCompliance:
        """Compliance of one tooth under a load at `radius` [m]."""
        return self.solved_tooth(gear)(radius)

    def solved_teeth(self, geometry: GearPairGeometry) -> Compliance:
        """Compliance of both teeth without their contact [m/N] by position in base pitches, solved for any."""
        driver, driven = self._one_tooth(geometry.driver), self._one_tooth(geometry.driven)
        return lambda position: driver(geometry.driver_radius(position)) + driven(geometry.driven_radius(position))

    def _one_tooth(self, gear: Gear) -> Compliance:
        def solve(spur: Gear) -> Compliance:
            solved = self.solved_tooth(spur)
            return lambda radius: solved(radius).total

        if gear.helix_angle == 0.0:
            return solve(gear)
        yields = by_normal_section(gear, solve)
        return lambda radius: yields(radius) / math.cos(gear.base_helix_angle)

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
        at = np.asarray(position, dtype=np.float64)
        return self.solved_teeth(geometry)(at) + self.contact_compliance(geometry, at, force)

    def pair_stiffness(self, geometry: GearPairGeometry) -> PiecewiseCubic:
        """Stiffness [N/m] by position; the table is checked against the model to 1e-9."""
        length, teeth = geometry.contact_ratio, self.solved_teeth(geometry)

        def stiffness(position: FloatArray) -> FloatArray:
            yields = teeth(position) + self.contact_compliance(geometry, position)
            return np.asarray(1.0 / yields, dtype=np.float64)

        return piecewise.tabulated(by_few_values(stiffness, length), length)

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
        Another tooth model (gear, radii) -> `ToothCompliance` in place of `potential_energy`; its body is not known,
        so each of its teeth stands on one of its own.
    contact, force
        See `CompliantTeeth`.
    """

    root_section: RootSection = "ma2014"
    tooth_model: ToothModel | None = None
    contact: ContactModel = "yang-sun"
    force: float | None = None

    def __post_init__(self) -> None:
        self._check("potential-energy")

    def shared_body(self, gear: Gear) -> SharedBody | None:
        """See `CompliantTeeth`."""
        return None if self.tooth_model is not None else SharedBody("plane-stress", turning=True)

    def solved_tooth(self, gear: Gear) -> SolvedTooth:
        """One tooth, with all that does not depend on the load's radius solved."""
        if self.tooth_model is not None:
            return partial(self.tooth_model, gear)
        return solved_potential_energy(gear, self.root_section)


@dataclass(frozen=True)
class ElasticRingStiffness(CompliantTeeth):
    """Energy method on an exact elastic ring, with Weber's contact; see :mod:`coupling.gears.elastic_ring`."""

    state: PlaneState = "plane-stress"
    contact: ContactModel = "weber"
    force: float | None = None

    def __post_init__(self) -> None:
        self._check("elastic-ring")

    def shared_body(self, gear: Gear) -> SharedBody | None:
        """See `CompliantTeeth`."""
        return SharedBody(self.state, turning=True)

    def solved_tooth(self, gear: Gear) -> SolvedTooth:
        """One tooth, with all that does not depend on the load's radius solved."""
        return solved_elastic_ring(gear, self.state)


@dataclass(frozen=True)
class CornellStiffness(CompliantTeeth):
    """Cornell (1981), with Weber's contact; see :mod:`coupling.gears.cornell`."""

    state: PlaneState | None = None
    contact: ContactModel = "weber"
    force: float | None = None

    def __post_init__(self) -> None:
        self._check("cornell")

    def shared_body(self, gear: Gear) -> SharedBody | None:
        """See `CompliantTeeth`."""
        return SharedBody(self.state or cornell_state(gear), turning=False)

    def solved_tooth(self, gear: Gear) -> SolvedTooth:
        """One tooth, with all that does not depend on the load's radius solved."""
        return solved_cornell(gear, self.state)


@dataclass(frozen=True)
class WeberBanaschekStiffness(CompliantTeeth):
    """Weber and Banaschek (1953), with Weber's contact; see :mod:`coupling.gears.weber_banaschek`."""

    contact: ContactModel = "weber"
    force: float | None = None

    def __post_init__(self) -> None:
        self._check("weber-banaschek")

    def shared_body(self, gear: Gear) -> SharedBody | None:
        """See `CompliantTeeth`."""
        return SharedBody("plane-stress", turning=False)

    def solved_tooth(self, gear: Gear) -> SolvedTooth:
        """One tooth, with all that does not depend on the load's radius solved."""
        return solved_weber_banaschek(gear)
