r"""Tooth pair stiffness from the compliances of two teeth and their contact: base of the tooth models, helical too.

The compliances of both teeth and of their contact add up, ``c(s) = c_k(s) + c_i(s) + h(F, s)``, and the stiffness is
its inverse.  Where the contact is Weber's, ``h`` depends on the load F of the pair.  The dynamics need a stiffness that
is a function of position alone; it is then frozen at the load that the model is given, as the secant through it, so
that the deflection is exact under that load and approximate under others.  `CompliantTeeth.pair_compliance` with a
force is exact at any load.  A load that is not given is `REFERENCE_LINE_LOAD` times the face width.

Neighbouring pairs stand on the same two bodies.  A load on one moves the other's flanks, along the line of action, by

    C(s) = c_k(s + 1, s) + c_i(s, s + 1),

c_k and c_i the cross compliances of two neighbouring teeth of each gear
(:mod:`gearwhine.coupling.gears.stiffness.ring_body`): the twist of the body about its bore, which both teeth feel in
full, and the dent around the root.  As one load moves up its tooth the other moves down, so that C varies by less than
1 % while both pairs touch; the law takes its mean for all pairs. Under a load that varies over the face the bodies
yield less (`CompliantTeeth.shared_over_face`).

A new tooth model is one subclass of `CompliantTeeth`: it gives the compliance of one tooth (`solve_tooth`) and, where
neighbouring teeth share a body, that body (`shared_body`).  Its name in cases comes from the list in
:mod:`gearwhine.coupling.gears.stiffness.models`.

The ring of an internal gear is clamped at its outside; what its support yields between bolts, on pins or springs adds
to the compliance of its teeth and of their neighbours, as the mean over the places between two bolts.

Helical teeth are treated in their normal section (:mod:`gearwhine.coupling.gears.stiffness.normal_section`).
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial, wraps
from typing import ClassVar, Literal, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.errors import StiffnessModelError
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.coupling.gears.piecewise_cubic import PiecewiseCubic, chebyshev_interpolant
from gearwhine.coupling.gears.stiffness.beam import PlaneState
from gearwhine.coupling.gears.stiffness.body_over_face import FACE_SHAPES, uneven_shares
from gearwhine.coupling.gears.stiffness.hertz import hertz_compliance, line_contact
from gearwhine.coupling.gears.stiffness.normal_section import Compliance, largest_section, transverse_compliance
from gearwhine.coupling.gears.stiffness.rim_on_hub import shift_compliance
from gearwhine.coupling.gears.stiffness.ring_body import neighbour_compliance, support_compliance, twist_compliance
from gearwhine.numerics.arrays import FloatArray

ContactModel = Literal["yang-sun", "weber"]

REFERENCE_LINE_LOAD = 300e3
"""Load per face width at which Weber's contact is taken where none is given [N/m]: within the 100 to 1600 N/mm that the
constants of ISO 6336-1 are for."""

_PAIRS = 64  # pairs of gears whose teeth are kept
_CROSS_NODES = 4
_PLACES = 24


_Of = TypeVar("_Of")


def _of_sound_teeth(
    solve: Callable[[CompliantTeeth, GearPairGeometry], _Of],
) -> Callable[[CompliantTeeth, GearPairGeometry], _Of]:
    """Solve for the pair with involute flanks, and keep it: pairs that differ in their flanks alone have it in common.

    Gears of one drawing have other flanks in each gearbox, and the same compliance.
    """
    kept = lru_cache(maxsize=_PAIRS)(solve)

    @wraps(solve)
    def of_pair(self: CompliantTeeth, geometry: GearPairGeometry) -> _Of:
        return kept(self, geometry.sound)

    return of_pair


def _at_any_load(
    solve: Callable[[CompliantTeeth, GearPairGeometry], _Of],
) -> Callable[[CompliantTeeth, GearPairGeometry], _Of]:
    """Keep what pairs have in common under any load, as the contact alone depends on that."""
    kept = _of_sound_teeth(solve)

    @wraps(solve)
    def of_pair(self: CompliantTeeth, geometry: GearPairGeometry) -> _Of:
        return kept(self if self.force is None else replace(self, force=None), geometry)

    return of_pair


@dataclass(frozen=True, eq=False)
class ToothCompliance:
    """Compliance of one tooth and the body under it, along the line of action [m/N].

    Attributes
    ----------
    bending, shear, axial, foundation : ndarray
        Compliance of the tooth as a beam, and of the body under it; arrays of the shape of the loads' radii.
    rim : ndarray
        Additional compliance of a rim on a thinner web, compared with a body of the teeth's full width; of an internal
        gear that of its ring's support, compared with a clamped outside.
    """

    bending: FloatArray
    shear: FloatArray
    axial: FloatArray
    foundation: FloatArray
    rim: FloatArray = field(default_factory=lambda: np.zeros(()))

    @property
    def total(self) -> FloatArray:
        """Sum of all parts [m/N]."""
        return self.bending + self.shear + self.axial + self.foundation + self.rim


SolvedTooth = Callable[[FloatArray], ToothCompliance]
"""Compliance of one tooth as a function of radii on its flank [m], the part that is independent of them solved."""


@dataclass(frozen=True)
class SharedBody:
    """The body that neighbouring teeth of a gear share.

    Attributes
    ----------
    state : {"plane-stress", "plane-strain"}
    twists : bool
        Whether the tooth's own compliance includes the twist of the whole body about its bore; a tooth on a half plane
        has no bore.
    """

    state: PlaneState
    twists: bool


class RimCompliance(NamedTuple):
    """Motion of a gear's rim on its hub under a load of its teeth, along the line of action [m/N].

    Attributes
    ----------
    twist, shift : float
        By the rotation about the shaft, and by the motion across it.
    state : {"plane-stress", "plane-strain"}
        State of the body.
    """

    twist: float = 0.0
    shift: float = 0.0
    state: PlaneState = "plane-stress"


@dataclass(frozen=True)
class CompliantTeeth(ABC):
    """A pair of teeth in series with their contact.

    Parameters
    ----------
    contact : {"yang-sun", "weber"}
        Contact compliance, see :mod:`gearwhine.coupling.gears.stiffness.hertz`.
    force : float or None
        Load of the pair at which Weber's contact is frozen [N]; None for `REFERENCE_LINE_LOAD`.

    Raises
    ------
    StiffnessModelError
        For an unknown contact, or a force that is not above 0.
    """

    name: ClassVar[str]
    """Name in cases and messages."""

    contact: ContactModel = field(default="weber", kw_only=True)
    force: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        """Check the contact model and the force."""
        if self.contact not in ("yang-sun", "weber"):
            raise StiffnessModelError(
                f"stiffness model {self.name!r}: contact must be 'yang-sun' or 'weber', got {self.contact!r}"
            )
        if self.force is not None and not (math.isfinite(self.force) and self.force > 0.0):
            raise StiffnessModelError(f"stiffness model {self.name!r}: force must be above 0 N, got {self.force!r}")

    @abstractmethod
    def solve_tooth(self, gear: Gear) -> SolvedTooth:
        """Solve one tooth of a spur gear for loads at any radius from the form circle to the tip."""

    def shared_body(self, gear: Gear) -> SharedBody | None:
        """Body that neighbouring teeth share; None where each tooth has a separate body."""
        return None

    def tooth(self, gear: Gear, radius: npt.ArrayLike) -> ToothCompliance:
        """Compliance of one tooth of a spur gear.

        Parameters
        ----------
        gear : Gear
        radius : array_like
            Radii of the loaded points [m], from the form radius to the tip.

        Returns
        -------
        ToothCompliance
            Arrays of the shape of `radius`.

        Raises
        ------
        GearError
            For a radius off the involute flank.
        StiffnessModelError
            For a body outside the range of the model.
        """
        places = np.asarray(radius, dtype=np.float64)
        tooth = self.solve_tooth(gear)(places)
        if gear.ring_support is None:
            return tooth
        return replace(tooth, rim=self._on_support(gear, lambda radius: tooth.rim)(places))

    def shared_compliance(self, geometry: GearPairGeometry) -> float:
        """Compliance that pairs of teeth in contact at once share, of both gears [m/N].

        The mean over the positions at which two neighbouring pairs touch. Zero where the model has no body, or where
        the path of contact never holds two pairs.
        """
        return sum(self._shared_by_gear(geometry))

    @_at_any_load
    def rim_compliances(self, geometry: GearPairGeometry) -> tuple[RimCompliance, RimCompliance]:
        """Parts of `shared_compliance` by which the rims of the driver and of the driven gear move on their hubs.

        They lie between the shaft and the rim with its inertia (:mod:`gearwhine.coupling.gears.stiffness.rim_on_hub`);
        what else neighbouring teeth share lies between the rim and the teeth.
        """
        compliances = []
        for gear, shared in zip(geometry.carrying_gears, self._shared_by_gear(geometry), strict=True):
            body = self.shared_body(gear)
            if body is None or not body.twists or shared <= 0.0:
                compliances.append(RimCompliance())
                continue
            if gear.is_internal:  # of the transverse section
                twist, shift = twist_compliance(gear), shift_compliance(gear, body.state)
            else:
                twist = _anywhere(gear, twist_compliance)
                shift = _anywhere(gear, partial(shift_compliance, state=body.state))
            twist = min(twist, shared)
            shift = min(shift, shared - twist)
            compliances.append(RimCompliance(twist, shift, body.state))
        return compliances[0], compliances[1]

    @_at_any_load
    def shared_over_face(self, geometry: GearPairGeometry) -> FloatArray:
        """Compliance that pairs share under loads that vary over the face like Legendre's polynomials p_m [m/N].

        A force F spread like p_l over the face, mean p_l² = 1, moves all flanks by ``F C_ml p_m`` of both gears
        (:mod:`gearwhine.coupling.gears.stiffness.body_over_face`).

        Returns
        -------
        ndarray, shape (m, m)
            C_ml for m, l = 1, 2, ...; the compliance under an even load is `shared_compliance`.
        """
        total = np.zeros((FACE_SHAPES, FACE_SHAPES))
        middle = 0.5 * geometry.contact_ratio
        radii = geometry.driver_radius(middle), geometry.driven_radius(middle)
        # What a ring's support yields is plane, of an even load; the tilt of a rim between its bolts is left out.
        shares = self._shared_by_bodies(geometry, supported=False)
        for gear, radius, shared in zip(geometry.carrying_gears, radii, shares, strict=True):
            body = self.shared_body(gear)
            if body is None or shared == 0.0:
                continue
            spur, spur_radius = largest_section(gear)
            at = spur_radius(np.asarray(radius, dtype=np.float64))
            width = geometry.face_width / abs(gear.root_circle_radius)
            total += shared * uneven_shares(spur, float(at), width, twists=body.twists)
        total.flags.writeable = False
        return total

    @_at_any_load
    def _shared_by_gear(self, geometry: GearPairGeometry) -> tuple[float, float]:
        """Parts of the driver's and the driven gear's body in the shared compliance [m/N]."""
        return self._shared_by_bodies(geometry, supported=True)

    def _shared_by_bodies(self, geometry: GearPairGeometry, *, supported: bool) -> tuple[float, float]:
        # Helical teeth with less than one pair in a plane share their bodies along the face: as at a ratio of one.
        both = max(geometry.contact_ratio - 1.0, 0.0)
        driver, driven = (self._neighbours(gear, supported) for gear in geometry.carrying_gears)
        if driver is None or driven is None or (both == 0.0 and geometry.driver.helix_angle == 0.0):
            return 0.0, 0.0
        nodes, weights = np.polynomial.legendre.leggauss(_CROSS_NODES)
        behind = 0.5 * both * (1.0 + nodes)
        ahead = np.minimum(behind + 1.0, geometry.contact_ratio)
        # The driver pushes against its own rotation, so that its next tooth in the sense of the load entered later.
        of_driver = driver(geometry.driver_radius(ahead), geometry.driver_radius(behind))
        of_driven = driven(geometry.driven_radius(behind), geometry.driven_radius(ahead))
        return float(0.5 * weights @ of_driver), float(0.5 * weights @ of_driven)

    def _neighbours(self, gear: Gear, supported: bool) -> Compliance | None:
        body = self.shared_body(gear)
        if body is None:
            return None
        teeth = transverse_compliance(gear, lambda spur: neighbour_compliance(spur, body.state, twists=body.twists))
        if gear.ring_support is None or not supported:
            return teeth
        support = support_compliance(gear, body.state).beside
        return lambda behind, ahead: teeth(behind, ahead) + support(behind, ahead)

    @_at_any_load
    def teeth_compliance(self, geometry: GearPairGeometry) -> Compliance:
        """Compliance of both teeth without their contact [m/N], as a function of the position in base pitches."""

        def total(spur: Gear) -> Compliance:
            tooth = self.solve_tooth(spur)
            return lambda radius: tooth(radius).total

        driver, driven = (
            self._on_support(gear, transverse_compliance(gear, total)) for gear in geometry.carrying_gears
        )
        return lambda position: driver(geometry.driver_radius(position)) + driven(geometry.driven_radius(position))

    def _on_support(self, gear: Gear, teeth: Compliance) -> Compliance:
        """Add the compliance of the support of an internal gear's rim to that of its teeth."""
        if gear.ring_support is None:
            return teeth
        body = self.shared_body(gear)
        support = support_compliance(gear, body.state if body is not None else "plane-stress").own
        return lambda radius: teeth(radius) + support(radius)

    def support_course(self, gear: Gear, radius: float) -> FloatArray:
        """Compliance that the support of an internal gear's ring adds to a clamped one, from bolt to bolt [m/N].

        Parameters
        ----------
        gear : Gear
        radius : float
            Radius of the loaded point [m].

        Returns
        -------
        ndarray, shape (places,)
            At equal steps of the tooth's angle from a bolt in the sense of the load; a single value where nothing
            varies.
        """
        body = self.shared_body(gear)
        state: PlaneState = body.state if body is not None else "plane-stress"
        support = gear.ring_support
        if support is None or support.count is None:
            return np.array([float(support_compliance(gear, state).own(np.array(radius)))])
        places = 2.0 * math.pi / support.count * np.arange(_PLACES) / _PLACES
        return np.array([float(support_compliance(gear, state, place).own(np.array(radius))) for place in places])

    def contact_compliance(
        self, geometry: GearPairGeometry, position: npt.ArrayLike, force: float | None = None
    ) -> FloatArray:
        """Approach of the flanks over their load [m/N] at `position`, under `force` [N] (None: the model's own)."""
        at = np.asarray(position, dtype=np.float64)
        if self.contact == "yang-sun":
            flattening = hertz_compliance(geometry)
            return np.full(at.shape, flattening / math.cos(geometry.driver.base_helix_angle))
        load = force if force is not None else self.force
        if load is None:
            load = REFERENCE_LINE_LOAD * geometry.face_width
        approach = line_contact(geometry, at.ravel()).secant_compliance(load).reshape(at.shape)
        return np.asarray(approach / math.cos(geometry.driver.base_helix_angle), dtype=np.float64)

    @_of_sound_teeth
    def mean_flattening(self, geometry: GearPairGeometry) -> float:
        """Mean of `contact_compliance` over the path of contact, under the model's own load [m/N]."""
        nodes, weights = np.polynomial.legendre.leggauss(_CROSS_NODES)
        along = 0.5 * geometry.contact_ratio * (1.0 + nodes)
        return float(0.5 * weights @ self.contact_compliance(geometry, along))

    def pair_compliance(
        self, geometry: GearPairGeometry, position: npt.ArrayLike, force: float | None = None
    ) -> FloatArray:
        """Compliance of one pair [m/N] at `position` in base pitches, evaluated without a table.

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
        return self.teeth_compliance(geometry)(at) + self.contact_compliance(geometry, at, force)

    @_of_sound_teeth
    def pair_stiffness(self, geometry: GearPairGeometry) -> PiecewiseCubic:
        """Stiffness [N/m] by position; the table is checked against the model to 1e-9."""
        length, teeth = geometry.contact_ratio, self.teeth_compliance(geometry)

        def stiffness(position: FloatArray) -> FloatArray:
            return np.asarray(1.0 / (teeth(position) + self.contact_compliance(geometry, position)), dtype=np.float64)

        return piecewise.tabulated(chebyshev_interpolant(stiffness, length), length)


def _anywhere(gear: Gear, solve: Callable[[Gear], float]) -> float:
    """Compliance of teeth along the transverse line of action [m/N] that is the same for a load at any radius."""

    def constant(spur: Gear) -> Compliance:
        value = solve(spur)
        return lambda radius: np.full(np.shape(radius), value)

    return float(transverse_compliance(gear, constant)(np.asarray(gear.pitch_radius)))
