"""Gear pair on parallel shafts, external or internal: centre distance, backlash, path of contact, contact ratio.

Everything is in the transverse plane, where a pair of helical gears is a pair of spur gears whose phase moves along
the face.  Position along the path of contact is counted in base pitches: a pair of teeth comes into contact at
``s = 0`` (the driven gear's tip meets the driver's root) and leaves at ``s = contact_ratio`` (the driver's tip).  The
dimensionless phase ``p = z_k theta_k / (2 pi)`` counts mesh periods; at phase ``p`` the pairs in contact are at
``s = frac(p) + j``, j = 0, 1, ... while ``s < contact_ratio``.  The pair that enters at phase n joins tooth
``n mod z_k`` of the driver and ``n mod z_i`` of the driven gear.

With base radii ``rb_k, rb_i``, centre distance ``a`` and working pressure angle ``w``, the distance of the
contact from the driver's tangent point is ``xi_k = xi_0 + s p_b`` with
``xi_0 = a sin(w) - sqrt(r_a,i^2 - rb_i^2)``, and ``xi_i = a sin(w) - xi_k`` from the driven's.

Two gears mesh without backlash at the transverse pressure angle ``w`` of (ISO 21771)

    inv(w) = inv(alpha_t) + 2 tan(alpha_n) (x_k + x_i) / (z_k + z_i),

at the centre distance ``a = (rb_k + rb_i) / cos(w)``; from it follow profile shifts for a centre distance.

**Internal pairs.** One of the two gears may be internal, with negative teeth and radii (ISO 21771). Then the centre
distance, and the distance of the tangent points, are negative, and every equation holds as it stands. The unit vector
from the driver's centre to the driven's over the *signed* distance points from the shafts to the pitch point where the
driver is the pinion, and away from it where the driver is the ring: ``r_w`` along it is the pitch point in both.
Distances xi and base radii of a ring are negative, its roll angles positive. Its flank point of roll angle ``u`` moves
with ``rb omega``, so a driver of either kind pushes along the sense ``s = sign(omega_k z_k)`` (`flank_sense`).

Where the teeth would meet off the path of contact is in :mod:`gearwhine.coupling.gears.geometry.interference`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears.errors import (
    GearError,
    InterferenceError,
    MismatchedGearsError,
    NoContactError,
    require_finite,
)
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.interference import (
    addendum_without_fouling,
    fouling_clearance,
    radial_clearance,
)
from gearwhine.coupling.gears.geometry.involute import inverse_involute, involute
from gearwhine.numerics.arrays import FloatArray, IntArray
from gearwhine.numerics.findings import Finding
from gearwhine.numerics.own_copies import unchecked

PRINTED_ROUNDING = 1e-3
"""Relative rounding of printed sizes, as of a module of 3.175 mm (8 teeth per inch) printed as 3.1748. Module, pressure
angle and helix angle of a pair agree within it, and a backlash of less, in modules, is none."""
_DECAY_LENGTH = 1.25
"""λ = √(T/k_b) over the module: 1.2 to 1.3 for the tooth models and solid gears of 18 to 120 teeth."""
_SAME_WIDTH = 1e-9
_POINT = 0.01
"""Part of a nominal face over which teeth touch whose face width is not known: its tilt stiffness is 1e-4 of that."""
# One per cent of a module: as much as cutting thins a tooth for backlash.
_ALLOWED_JAM = 0.01
# Reach of a tip below the form circle, along the line of action in modules. The fillet leaves the involute as a tangent
# of it, by less than the square of the reach over twice the fillet's radius of some 0.4 modules: 1e-4 modules.
ALLOWED_REACH = 0.01


def turning_sense(speed: float) -> int:
    """Return the sense of rotation by a signed speed, 1 or -1.

    A shaft at rest keeps the sense that it would turn in as the sign of its zero: the speed 0.0 of a train times a
    negative ratio is -0.0.
    """
    return int(math.copysign(1.0, speed))


def mesh_frequency(speed: float, teeth: int) -> float:
    """Tooth-mesh frequency [Hz] of a gear with this number of teeth, at a speed [rad/s]; both of either sign."""
    return abs(speed) * abs(teeth) / (2.0 * math.pi)


def signed_distance(driver: Gear, driven: Gear, apart: float) -> float:
    """Centre distance of two gears from the distance of their axes [m]: negative with an internal gear (ISO 21771)."""
    return -apart if driver.is_internal or driven.is_internal else apart


def pair_label(driver: str, driven: str) -> str:
    """Name of a gear pair in messages, by the names of its gears."""
    return f"gear pair {driver!r} -> {driven!r}"


@dataclass(frozen=True)
class ToothNumbering:
    """Numbers of a gear's teeth in one of its meshes, by which it meets every mate with the same faulty tooth.

    Attributes
    ----------
    first : int
        The gear's own number of the tooth that the mesh counts as its tooth 0, which touches at phase 0.
    step : int
        1; -1 where the teeth enter the mesh in the order opposite to that in which they are numbered.
    same_flank : bool
        Whether the mesh works on the flanks of the gear's first pair: an idler, as a planet between sun and ring, has
        one mesh on either side of its teeth.
    """

    first: int = 0
    step: Literal[1, -1] = 1
    same_flank: bool = True

    def of(self, number: IntArray) -> IntArray:
        """Return the gear's numbers of the teeth that the mesh counts so, whole turns not taken off."""
        return np.asarray(self.first + self.step * number)


@dataclass(frozen=True)
class GearPairGeometry:
    """A driver and a driven gear on parallel shafts.

    Parameters
    ----------
    driver, driven : Gear
        At most one of them internal.
    centre_distance : float or None
        Distance of the shafts [m], negative of an internal pair (ISO 21771); None for the distance without backlash of
        teeth that are not thinned, so that any `tooth_thinning` becomes backlash.
    axial_offset : float
        Place of the middle of the driven gear's face along z from that of the driver's [m].
    numbering : tuple of ToothNumbering
        Numbers of the driver's and of the driven teeth in this mesh.

    Raises
    ------
    MismatchedGearsError
        Unequal module, pressure angle or helix angle, or helices whose hands do not fit: opposite ones of external
        gears, equal ones with an internal gear; two internal gears.
    InterferenceError
        Contact below the involute's start on either gear, a tip in the other's root, teeth thicker than their
        spaces, or tips that foul each other beyond the path of contact of an internal pair.
    NoContactError
        Total contact ratio below one, which of spur gears is the transverse one.
    """

    driver: Gear
    driven: Gear
    centre_distance: float | None = None
    axial_offset: float = 0.0
    numbering: tuple[ToothNumbering, ToothNumbering] = (ToothNumbering(), ToothNumbering())

    def __post_init__(self) -> None:
        """Check that the gears match and meet, the centre distance and the contact ratio."""
        _check_match(self)
        _check_faces(self)
        _check_distance(self)
        _check_contact(self)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is unlikely of the pair: contact ratios, an internal pair that can be mounted along its axes alone."""
        return (*_ratio_findings(self), *_mounting_findings(self))

    # ---------------------------------------------------------- working values

    @property
    def is_internal(self) -> bool:
        """Whether one of the gears is internal."""
        return self.driver.is_internal or self.driven.is_internal

    @property
    def pinion_and_ring(self) -> tuple[Gear, Gear]:
        """The external and the internal gear of an internal pair."""
        return (self.driven, self.driver) if self.driver.is_internal else (self.driver, self.driven)

    def flank_sense(self, sense: int) -> int:
        """Sense s along which the driver pushes, where it turns counter-clockwise (sense 1) or clockwise (-1).

        That of its rotation, and of an internal driver the opposite: ``s R_k omega_k`` is positive.
        """
        if sense not in (1, -1):
            raise GearError(f"{self.label}: sense must be +1 or -1, got {sense!r}")
        return sense * self.driver.sign

    @property
    def label(self) -> str:
        """Name of the pair in messages."""
        return pair_label(self.driver.name, self.driven.name)

    @property
    def ratio(self) -> float:
        """Gear ratio, teeth of the driven over teeth of the driver: speeds divide by it. Negative of internal pairs."""
        return self.driven.teeth / self.driver.teeth

    @cached_property
    def base_pitch(self) -> float:
        """Distance between neighbouring pairs along the line of action [m]."""
        return self.driver.base_pitch

    @property
    def face_width(self) -> float:
        """Width of the common face, on which the pair carries [m]; next to none where one is not known."""
        left, right = self._common_face
        return (right - left) * (1.0 if self.has_face else _POINT)

    @property
    def has_face(self) -> bool:
        """Whether the width of both faces is known."""
        return self.driver.has_face and self.driven.has_face

    @property
    def _common_face(self) -> tuple[float, float]:
        """Ends of the common face along z from the middle of the driver's face [m]."""
        ends = [
            (middle - 0.5 * gear.face_width, middle + 0.5 * gear.face_width)
            for gear, middle in ((self.driver, 0.0), (self.driven, self.axial_offset))
        ]
        return max(left for left, _ in ends), min(right for _, right in ends)

    @cached_property
    def common_middles(self) -> tuple[float, float]:
        """Place of the middle of the common face along z, from the middles of the driver's and the driven face [m]."""
        middle = 0.5 * sum(self._common_face)
        return middle, middle - self.axial_offset

    @cached_property
    def sound(self) -> GearPairGeometry:
        """The pair with involute flanks, without modifications, deviations and faults of its teeth."""
        driver, driven = self.driver.sound, self.driven.sound
        if driver is self.driver and driven is self.driven:
            return self
        return unchecked(self, driver=driver, driven=driven)

    @cached_property
    def carrying_gears(self) -> tuple[Gear, Gear]:
        """Driver and driven gear, each with its effective face width for the load on the common face.

        Teeth beside the common face of width b support those in it: as a foundation with shear coupling
        (:mod:`gearwhine.coupling.gears.contact.face_slices`), whose deflection decays over the length λ. Overhangs o at
        both ends make a tooth under an even load on b as stiff as one of the width

            b / (1 - Σ w / b),        w = λ/2 (1 - exp(-2 o / λ)).
        """
        return self._carrying(self.driver, self.common_middles[0]), self._carrying(self.driven, self.common_middles[1])

    def _carrying(self, gear: Gear, middle: float) -> Gear:
        """Gear of the effective face width, by the place of the middle of the common face [m]."""
        beside = 0.5 * (gear.face_width - self.face_width)
        if beside < _SAME_WIDTH * gear.face_width:
            return gear
        decay = _DECAY_LENGTH * gear.module
        overhangs = (beside + middle, beside - middle)
        gain = sum(-0.5 * decay * math.expm1(-2.0 * max(overhang, 0.0) / decay) for overhang in overhangs)
        # Of a face that is narrower than the decay the ends are not independent.
        width = min(gear.face_width, self.face_width / (1.0 - min(gain / self.face_width, 0.5)))
        web = gear.web_thickness
        hub = None if gear.hub_diameter is None else gear.hub_width or gear.face_width
        return replace(gear, face_width=width, web_thickness=None if web is None else min(web, width), hub_width=hub)

    @cached_property
    def backlash_free_pressure_angle(self) -> float:
        """Transverse pressure angle [rad] of the mesh without backlash, thinning included.

        ``inv(w) = inv(alpha_t) + 2 tan(alpha_n) (x_k + x_i) / (z_k + z_i)``, x the generating shifts.
        """
        return backlash_free_pressure_angle(self.driver, self.driven, thinned=True)

    @cached_property
    def working_centre_distance(self) -> float:
        """Working centre distance of the shafts, negative of an internal pair [m]."""
        if self.centre_distance is not None:
            return self.centre_distance
        return self.base_radii_sum / math.cos(self.working_pressure_angle)

    @cached_property
    def working_pressure_angle(self) -> float:
        """Transverse working pressure angle, of the line of action to the common tangent of the pitch circles [rad]."""
        if self.centre_distance is None:
            return backlash_free_pressure_angle(self.driver, self.driven)
        return math.acos(self.base_radii_sum / self.centre_distance)

    @property
    def working_pitch_radii(self) -> tuple[float, float]:
        """Working pitch radii of driver and driven gear, which roll on each other, signed as the gears' [m]."""
        cosine = math.cos(self.working_pressure_angle)
        return self.driver.base_radius / cosine, self.driven.base_radius / cosine

    @property
    def working_helix_angle(self) -> float:
        """Helix angle of the driver on its working pitch cylinder [rad], ``tan(beta_w) = tan(beta_b) / cos(w)``."""
        return math.atan(math.tan(self.driver.base_helix_angle) / math.cos(self.working_pressure_angle))

    @property
    def backlash(self) -> float:
        """Backlash: gap of the back flanks along their line of action, in the transverse plane [m].

        By centre distance and tooth thicknesses it is ``2 (rb_k + rb_i) (inv(w) - inv(w_close))``; negative where the
        teeth would jam.
        """
        return (
            2.0
            * self.base_radii_sum
            * (involute(self.working_pressure_angle) - involute(self.backlash_free_pressure_angle))
        )

    @property
    def designed_backlash(self) -> float | None:
        """The backlash where the design has one; None below `PRINTED_ROUNDING` modules.

        Nominal gears at their nominal distance have teeth as thick as the spaces, without an allowance for backlash.
        """
        return self.backlash if self.backlash > PRINTED_ROUNDING * self.driver.module else None

    @property
    def normal_backlash(self) -> float:
        """Normal backlash, the shortest distance of the back flanks [m]: ``backlash cos(beta_b)``."""
        return self.backlash * math.cos(self.driver.base_helix_angle)

    @property
    def circumferential_backlash(self) -> float:
        """Circumferential backlash, on the working pitch circles [m]: ``backlash / cos(w)``."""
        return self.backlash / math.cos(self.working_pressure_angle)

    def tip_clearance(self, gear: Gear) -> float:
        """Tip clearance between the tip circle of `gear`, one of the two, and the other's root circle [m]."""
        other = self.driven if gear is self.driver else self.driver
        return self.working_centre_distance - gear.tip_radius - other.root_circle_radius

    # --------------------------------------------------------- path of contact

    @cached_property
    def path_length(self) -> float:
        """Length of the path of contact [m]."""
        return tip_reach(self.driver) + tip_reach(self.driven) - self.tangent_distance

    @cached_property
    def contact_ratio(self) -> float:
        """Transverse contact ratio, the mean number of pairs in contact in one plane: path over base pitch."""
        return self.path_length / self.base_pitch

    @property
    def overlap_ratio(self) -> float:
        """Overlap ratio of helical teeth, ``b sin(beta) / (pi m_n)``."""
        return self.face_width * abs(math.sin(self.driver.helix_angle)) / (math.pi * self.driver.module)

    @property
    def total_contact_ratio(self) -> float:
        """Total contact ratio, transverse and overlap: the mean number of pairs that touch somewhere along the face."""
        return self.contact_ratio + self.overlap_ratio

    @property
    def pitch_point_position(self) -> float:
        """Position of the pitch point on the path of contact, in base pitches."""
        to_pitch_point = self.driver.base_radius * math.tan(self.working_pressure_angle)
        return (to_pitch_point - self.start_distance) / self.base_pitch

    @property
    def back_flank_offset(self) -> float:
        """Phase ``b`` such that the back flanks' pairs are at ``s = frac(b - p) + j``, in 0 ... 1.

        The back flanks are the mirror image of the working ones in the line of centres, running backwards:
        they touch the driver's tip first.  A tooth whose working flank is at ``xi`` has its back flank at
        ``2 rb_k (w + psi_k) - xi``, ``psi_k`` half its angle on the base circle.
        """
        return self._back_flank_shift % 1.0

    def mating_teeth(self, number: npt.ArrayLike) -> tuple[IntArray, IntArray]:
        """Mating teeth of driver and driven gear in the pairs that enter at whole phases `number`."""
        n = np.asarray(number, dtype=np.int64)
        return self._teeth(n, n)

    def mating_back_teeth(self, number: npt.ArrayLike) -> tuple[IntArray, IntArray]:
        """Mating teeth of the back flanks in the pairs that enter at whole phases `number` of the back flanks.

        With B the offset before its whole periods are dropped, the back flank of driver tooth n is at
        ``s = B - p + n`` and so belongs to the pair that enters at ``-n - floor(B)`` of ``frac(B) - p``.  Its mate is
        the driven tooth that follows, n + 1: n itself is on the other side.
        """
        n = -np.asarray(number, dtype=np.int64) - math.floor(self._back_flank_shift)
        return self._teeth(n, n + 1)

    def _teeth(self, driver: IntArray, driven: IntArray) -> tuple[IntArray, IntArray]:
        """Return the gears' own numbers of the teeth that the mesh counts so."""
        first, second = self.numbering
        return first.of(driver) % self.driver.tooth_count, second.of(driven) % self.driven.tooth_count

    def line_of_action_angle(self, centre_line_angle: float, sense: int = 1) -> float:
        """Angle from x of the unit vector along which the driver pushes the driven gear [rad].

        ``psi + s (pi/2 - w)``, with `centre_line_angle` psi the angle of the line from the driver's centre to
        the driven's, of an internal pair from the driven's to the driver's, and s the `flank_sense` of `sense`: +1
        where the driver turns counter-clockwise, -1 where clockwise.
        """
        return centre_line_angle + self.flank_sense(sense) * (math.pi / 2.0 - self.working_pressure_angle)

    def driver_roll_angle(self, position: npt.ArrayLike) -> FloatArray:
        """Roll angle of the driver's contact point [rad] at `position` in base pitches."""
        return self._driver_distance(position) / self.driver.base_radius

    def driven_roll_angle(self, position: npt.ArrayLike) -> FloatArray:
        """Roll angle of the driven gear's contact point [rad] at `position` in base pitches."""
        return (self.tangent_distance - self._driver_distance(position)) / self.driven.base_radius

    def driver_radius(self, position: npt.ArrayLike) -> FloatArray:
        """Distance of the contact from the driver's centre [m], signed, at `position` in base pitches."""
        return self.driver.base_radius * np.sqrt(1.0 + self.driver_roll_angle(position) ** 2)

    def driven_radius(self, position: npt.ArrayLike) -> FloatArray:
        """Distance of the contact from the driven gear's centre [m], signed, at `position` in base pitches."""
        return self.driven.base_radius * np.sqrt(1.0 + self.driven_roll_angle(position) ** 2)

    def driver_position(self, roll_angle: float) -> float:
        """Position in base pitches where the driver's contact point has `roll_angle` [rad]."""
        return (roll_angle * self.driver.base_radius - self.start_distance) / self.base_pitch

    def driven_position(self, roll_angle: float) -> float:
        """Position in base pitches where the driven gear's contact point has `roll_angle` [rad]."""
        distance = self.tangent_distance - roll_angle * self.driven.base_radius
        return (distance - self.start_distance) / self.base_pitch

    # ----------------------------------------------------- along the line of action

    @cached_property
    def base_radii_sum(self) -> float:
        """Sum of the base radii [m]."""
        return self.driver.base_radius + self.driven.base_radius

    @cached_property
    def tangent_distance(self) -> float:
        """Distance of the driven gear's tangent point of the line of action from the driver's, along the push [m]."""
        return self.base_radii_sum * math.tan(self.working_pressure_angle)

    @property
    def _back_flank_shift(self) -> float:
        """Sum of the positions of a driver tooth's working and back flanks when it enters at phase 0 [base pitches]."""
        sum_of_distances = 2.0 * self.driver.base_radius * (self.working_pressure_angle + self.driver.base_half_angle)
        return (sum_of_distances - 2.0 * self.start_distance) / self.base_pitch

    @cached_property
    def start_distance(self) -> float:
        """Distance of the start of contact from the driver's tangent point, along the push [m]."""
        return self.tangent_distance - tip_reach(self.driven)

    def _driver_distance(self, position: npt.ArrayLike) -> FloatArray:
        return self.start_distance + self.base_pitch * np.asarray(position, dtype=np.float64)


def tip_reach(gear: Gear) -> float:
    """Distance from a gear's tangent point to where its tip circle cuts the line of action, signed as its radii [m]."""
    return gear.sign * math.sqrt(gear.tip_radius**2 - gear.base_radius**2)


def mismatched_sizes(
    driver: tuple[float, float, float], driven: tuple[float, float, float], *, internal: bool = False
) -> tuple[Literal["module", "pressure_angle", "helix_angle"], ...]:
    """Sizes in which the teeth of a driver and a driven gear do not fit each other.

    Parameters
    ----------
    driver, driven : tuple of float
        Normal module [m], normal pressure angle [rad] and helix angle [rad].
    internal : bool
        Whether one of the gears is internal.

    Returns
    -------
    tuple of str
        Modules and pressure angles that differ by more than the rounding of printed sizes, helix angles that are not
        equal and of opposite hands, of an internal pair of one hand.
    """
    pairs = zip(driver, (driven[0], driven[1], driven[2] if internal else -driven[2]), strict=True)
    names: tuple[Literal["module", "pressure_angle", "helix_angle"], ...] = ("module", "pressure_angle", "helix_angle")
    return tuple(
        name
        for name, (first, second) in zip(names, pairs, strict=True)
        if not math.isclose(first, second, rel_tol=PRINTED_ROUNDING)
    )


def _check_match(pair: GearPairGeometry) -> None:
    """Raise `MismatchedGearsError` unless the teeth of one gear fit the spaces of the other."""
    if pair.driver.is_internal and pair.driven.is_internal:
        raise MismatchedGearsError(
            f"{pair.label}: both gears are internal, of {pair.driver.teeth} and {pair.driven.teeth} teeth; an internal "
            "gear meshes with an external one"
        )
    if pair.is_internal and pair.driver.teeth + pair.driven.teeth >= 0:
        pinion, ring = pair.pinion_and_ring
        raise MismatchedGearsError(
            f"{pair.label}: the internal gear {ring.name!r} of {ring.tooth_count} teeth does not reach around "
            f"{pinion.name!r} of {pinion.teeth}; it needs more, by some 8 to 12 with teeth of full height"
        )
    degrees = 180.0 / math.pi
    sizes = [(gear.module, gear.pressure_angle, gear.helix_angle) for gear in (pair.driver, pair.driven)]
    for quantity in mismatched_sizes(*sizes, internal=pair.is_internal):
        scale, unit = (1e3, "mm") if quantity == "module" else (degrees, "degrees")
        first, second = (scale * getattr(gear, quantity) for gear in (pair.driver, pair.driven))
        if quantity == "helix_angle" and pair.is_internal:
            raise MismatchedGearsError(
                f"{pair.label}: an internal gear and its pinion on parallel shafts need equal helix_angle of one hand, "
                f"got {first:+.8g} and {second:+.8g} degrees"
            )
        if quantity == "helix_angle":
            raise MismatchedGearsError(
                f"{pair.label}: external gears on parallel shafts need equal helix_angle of opposite hands, "
                f"got {first:+.8g} and {second:+.8g} degrees"
            )
        raise MismatchedGearsError(
            f"{pair.label}: both gears need the same {quantity}, got {first:.8g} and {second:.8g} {unit}"
        )


def _check_faces(pair: GearPairGeometry) -> None:
    require_finite(f"{pair.label}: axial_offset", pair.axial_offset)
    if pair.face_width <= 0.0:
        raise NoContactError(
            f"{pair.label}: the faces do not meet; they are {1e3 * abs(pair.axial_offset):.6g} mm apart along z, "
            f"expected less than {500.0 * (pair.driver.face_width + pair.driven.face_width):.6g} mm"
        )


def _check_distance(pair: GearPairGeometry) -> None:
    """Raise for a centre distance at which the teeth jam, or lose contact, that mesh at another."""
    distance = pair.centre_distance
    if distance is None:
        return
    close = pair.base_radii_sum / math.cos(pair.backlash_free_pressure_angle)
    where = (
        f"at a centre distance of {pair.driven.sign * pair.driver.sign * distance * 1e3:.6g} mm; they mesh without "
        f"backlash at {abs(close) * 1e3:.6g} mm"
    )
    if pair.is_internal:
        _check_internal_distance(pair, distance, close, where)
    elif not (math.isfinite(distance) and distance > pair.base_radii_sum):
        raise InterferenceError(
            f"{pair.label}: the gears do not fit {where}; it has to exceed the sum of the base radii, "
            f"{pair.base_radii_sum * 1e3:.6g} mm"
        )
    if pair.normal_backlash < -_ALLOWED_JAM * pair.driver.module:
        raise InterferenceError(f"{pair.label}: the teeth jam {where}")
    if _loses_contact(pair):
        GearPairGeometry(pair.driver, pair.driven)  # raises for teeth that mesh at no distance
        raise NoContactError(f"{pair.label}: the teeth lose contact {where}")


def _check_internal_distance(pair: GearPairGeometry, distance: float, close: float, where: str) -> None:
    """Raise for the distance of an internal pair that is not negative, or shorter than the base circles leave."""
    if not (math.isfinite(distance) and distance < 0.0):
        raise GearError(
            f"{pair.label}: centre_distance of an internal pair is negative (ISO 21771), that of these gears "
            f"{close * 1e3:.6g} mm without backlash; got {distance * 1e3:.6g} mm"
        )
    if distance >= pair.base_radii_sum:
        raise InterferenceError(
            f"{pair.label}: the gears do not fit {where}, which exceeds the difference of the base radii, "
            f"{-pair.base_radii_sum * 1e3:.6g} mm"
        )


def _loses_contact(pair: GearPairGeometry) -> bool:
    """Whether no teeth touch at some phase: a total contact ratio below one, or flanks that meet nowhere.

    Helical teeth whose transverse contact ratio is below one carry all the time if the next pair enters at one end of
    the face before the last one leaves at the other (ISO 21771: the total contact ratio is the sum of both).
    """
    return pair.path_length <= 0.0 or pair.total_contact_ratio < 1.0


def _check_contact(pair: GearPairGeometry) -> None:
    """Raise where the contact ratio is below one, or a tip reaches below the other gear's flank or into its root."""
    if _loses_contact(pair):
        kind = "total contact ratio" if pair.driver.helix_angle else "contact ratio"
        remedy = "lengthen the teeth or widen the faces" if pair.driver.helix_angle else "lengthen the teeth"
        raise NoContactError(
            f"{pair.label}: the {kind} is {pair.total_contact_ratio:.4f}, below 1, without backlash at a centre "
            f"distance of {abs(pair.working_centre_distance) * 1e3:.6g} mm; {remedy}"
        )
    last = pair.tangent_distance - pair.start_distance - pair.path_length
    for rooted, tip, lowest in ((pair.driver, pair.driven, pair.start_distance), (pair.driven, pair.driver, last)):
        _check_active_profile(pair, rooted, tip, lowest)
        clearance = pair.tip_clearance(tip)
        if clearance < 0.0:
            raise InterferenceError(
                f"{pair.label}: the tip of {tip.name!r} hits the root of {rooted.name!r} by {-clearance * 1e3:.4g} mm"
            )
    if pair.is_internal:
        _check_fouling(pair)


def _check_fouling(pair: GearPairGeometry) -> None:
    """Raise where the teeth of an internal pair foul each other beyond the path of contact."""
    pinion, ring = pair.pinion_and_ring
    clearance = fouling_clearance(pinion, ring, pair.working_centre_distance)
    if clearance >= 0.0:
        return
    addendum = addendum_without_fouling(pinion, ring, pair.working_centre_distance)
    shorter = "" if addendum is None else f"an addendum of {ring.name!r} of at most {addendum:.4g}, or "
    raise InterferenceError(
        f"{pair.label}: the tips of the teeth foul each other by {-clearance * 1e3:.4g} mm where the tip circles "
        f"cross, beyond the path of contact, with {ring.tooth_count - pinion.teeth} teeth between {pinion.teeth} and "
        f"{ring.tooth_count}; {shorter}a greater difference avoids it"
    )


_MOST_IN_CONTACT = 20.0
"""Total contact ratio beyond which a face is unlikely wide."""


def _ratio_findings(pair: GearPairGeometry) -> Iterator[Finding]:
    """Yield contact ratios that gears hardly have."""
    part = ("gear pair", f"{pair.driver.name} -> {pair.driven.name}")
    if pair.contact_ratio < 1.0:
        expected = (
            "1 or more: the teeth carry by their overlap alone, so that misalignment may take them out of contact"
        )
        yield Finding(part, "contact_ratio", pair.contact_ratio, expected, "warning")
    if pair.total_contact_ratio > _MOST_IN_CONTACT:
        expected = f"at most {_MOST_IN_CONTACT:g} pairs in contact at once"
        yield Finding(part, "total_contact_ratio", pair.total_contact_ratio, expected, "warning")


def _mounting_findings(pair: GearPairGeometry) -> Iterator[Finding]:
    """Yield a pinion that does not pass between the tips of its ring's teeth."""
    if not pair.is_internal:
        return
    clearance = radial_clearance(*pair.pinion_and_ring, pair.working_centre_distance)
    if clearance < 0.0:
        overlap = f"the teeth overlap by {-clearance * 1e3:.4g} mm on the way"
        expected = f"to be mounted along the axes: pushed in radially, {overlap}"
        yield Finding(("gear pair", f"{pair.driver.name} -> {pair.driven.name}"), "", None, expected, "warning")


def _check_active_profile(pair: GearPairGeometry, rooted: Gear, tip: Gear, lowest: float) -> None:
    """Raise where contact would begin `lowest` [m] past the tangent point, below the flank of `rooted`."""
    form = rooted.roll_angle(rooted.form_radius) * rooted.base_radius
    if lowest >= form - ALLOWED_REACH * rooted.module:
        return
    start = (
        f"at a radius of {math.hypot(rooted.base_radius, lowest) * 1e3:.6g} mm"
        if lowest >= 0.0 or rooted.is_internal
        else f"inside the base circle of {rooted.base_radius * 1e3:.6g} mm"
    )
    raise InterferenceError(
        f"{pair.label}: the tip of {tip.name!r} reaches {(form - lowest) * 1e3:.4g} mm (along the line of action) "
        f"below the involute of {rooted.name!r}: contact would start {start}, the flank above its fillet starts at "
        f"a radius of {abs(rooted.form_radius) * 1e3:.6g} mm; reduce the addendum of {tip.name!r} or "
        f"the root_radius of {rooted.name!r}"
    )


def backlash_free_pressure_angle(driver: Gear, driven: Gear, *, thinned: bool = False) -> float:
    """Transverse pressure angle at which two gears mesh without backlash [rad].

    Parameters
    ----------
    driver, driven : Gear
    thinned : bool
        Whether to take the tooth thinning into account.

    Raises
    ------
    InterferenceError
        For teeth too thin to mesh without backlash at any distance.
    """
    gears = (driver, driven)
    shift = sum(gear.generating_shift if thinned else gear.profile_shift for gear in gears)
    normal, transverse = driver.pressure_angle, driver.transverse_pressure_angle
    value = involute(transverse) + 2.0 * math.tan(normal) * shift / (driver.teeth + driven.teeth)
    if value < 0.0:
        raise InterferenceError(
            f"{pair_label(driver.name, driven.name)}: with profile shifts that sum to {shift:.4g} the teeth do not "
            "close at any distance"
        )
    return inverse_involute(value)


def profile_shift_sum(driver: Gear, driven: Gear, centre_distance: float) -> float:
    """Sum of the profile shifts with which two gears mesh without backlash at a distance.

    Parameters
    ----------
    driver, driven : Gear
        The gears; their profile shifts do not matter.
    centre_distance : float
        [m]

    Returns
    -------
    float
        ``(z_k + z_i) (inv(w) - inv(alpha_t)) / (2 tan(alpha_n))``, in normal modules.

    Raises
    ------
    InterferenceError
        For a distance below the sum of the base radii.
    """
    base = driver.base_radius + driven.base_radius
    require_finite("centre_distance", centre_distance)
    if base < 0.0 and not centre_distance < base:
        raise InterferenceError(
            f"{pair_label(driver.name, driven.name)}: the centre distance of an internal pair must be below the sum of "
            f"the base radii, {base * 1e3:.6g} mm, got {centre_distance * 1e3:.6g} mm"
        )
    if centre_distance <= base and base > 0.0:
        raise InterferenceError(
            f"{pair_label(driver.name, driven.name)}: the centre distance must exceed the sum of the base radii, "
            f"{base * 1e3:.6g} mm, got {centre_distance * 1e3:.6g} mm"
        )
    opening = involute(math.acos(base / centre_distance)) - involute(driver.transverse_pressure_angle)
    return (driver.teeth + driven.teeth) * opening / (2.0 * math.tan(driver.pressure_angle))
