"""Gear, external or internal, spur or helical: tooth proportions, radii and angles, mass and inertia.

The tooth is what a basic rack generates (ISO 53, ISO 21771).  Module ``m``, pressure angle ``alpha``, profile shift
``x`` (positive outward) and the heights are those of the rack's normal section; rotation,
contact and drawings are in the transverse plane.  With ``z`` teeth and helix angle ``beta`` on the reference cylinder:

    transverse module          m_t = m / cos(beta)             tan(alpha_t) = tan(alpha) / cos(beta)
    reference radius           r = m_t z / 2                   tip radius   r_a = r + (h_a + x) m
    base radius                rb = r cos(alpha_t)             root radius  r_f = r - (h_f - x_E) m
    base helix angle           sin(beta_b) = sin(beta) cos(alpha)
    equivalent teeth           z_n = z / (cos(beta_b)^2 cos(beta))

A spur gear is ``beta = 0``.  An internal gear (ring gear) has a negative number of teeth, and with it all its radii are
negative (ISO 21771): each of these equations holds for it as it stands.  Its teeth point inward, so that its tip circle
is the smallest, ``|r_a| = |r| - (h_a + x) m``, and a positive profile shift makes its teeth thicker too.  A radius as a
length is ``abs()`` of it.

A tooth made thinner for backlash is cut by the same rack, ``thinning / (2 tan(alpha))``
deeper: flank, fillet and root follow the generating shift ``x_E = x - thinning / (2 m tan(alpha))``, the tip does not.

The rack's tip corners are rounded; the flank of an external gear is an involute down to the form radius, where the
corner's trochoid takes over (see :mod:`gearwhine.coupling.gears.geometry.rack`,
:mod:`gearwhine.coupling.gears.geometry.profile`).

Mass and moments of inertia are those of the gear blank, the body that carries the teeth. The teeth count as a ring out
to the reference circle, where they fill half the circumference. A gear without a rim is a disc as wide as its face,
down to its bore. An internal gear is a ring from its reference circle to the outside of its rim. A gear with a rim is a
ring of the full width down to the inside of the rim, and a web of its own thickness in the middle of the face from
there to the bore; without a web the ring is alone, and its carrier is given as a disc of the rotor. A disc without a
bore reaches down to the axis; on a shaft its core is part of the shaft
(:mod:`gearwhine.coupling.gears.geometry.blank`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from gearwhine.coupling.gears.errors import GearError, PointedToothError, ThinTipError, UndercutError
from gearwhine.coupling.gears.geometry.involute import involute
from gearwhine.coupling.gears.geometry.modifications import HelixDeviation, ProfileDeviation, RootRelief, TipRelief
from gearwhine.coupling.gears.geometry.rack import BasicRack, RackCorner, fillet_end
from gearwhine.coupling.gears.geometry.ring_support import RingSupport
from gearwhine.coupling.gears.geometry.root_arc import RootArc, full_arc_radius
from gearwhine.housing.material import STEEL
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import (
    FINITE,
    Finding,
    Instance,
    Number,
    Rule,
    Text,
    attribute_findings,
    in_mm,
    kind_findings,
    refuse,
)
from gearwhine.numerics.materials import material_findings
from gearwhine.numerics.own_copies import keep_tuples, unchecked

_STEEPEST_HELIX = math.radians(60.0)
_STIFF_RIM = 3.5
"""Thickness of a ring's rim, in modules, from which on ISO 6336-3 takes it as stiff (Y_B = 1)."""


class Inertia(NamedTuple):
    """Mass [kg] and moments of inertia about the shaft and about a diameter through the middle [kg m^2]."""

    mass: float
    polar: float
    diametral: float


def hollow_disc(density: float, width: float, outer_radius: float, inner_radius: float) -> Inertia:
    """Inertia of a disc with a hole, from lengths [m] and density [kg/m^3]."""
    mass = density * width * math.pi * (outer_radius**2 - inner_radius**2)
    polar = 0.5 * mass * (outer_radius**2 + inner_radius**2)
    return Inertia(mass, polar, 0.5 * polar + mass * width**2 / 12.0)


class BlankRing(NamedTuple):
    """A ring of a gear's blank: width, outer and inner radius [m]."""

    width: float
    outer_radius: float
    inner_radius: float


Flank = Literal["working", "back"]
"""Side of a tooth: the flank that works in the first pair that its gear belongs to, or the one behind it."""


class Fault:
    """Damage of one tooth, or of all teeth of a gear; each kind replaces what it changes of a sound tooth."""

    tooth: int | None
    """Number of the tooth; None for all of them."""
    flank: Flank | None = None
    """Flank of the tooth, the one that works in the gear's first pair or its back; None for both."""

    def findings(self, gear: Gear, attribute: str) -> Iterator[Finding]:
        """Yield what no tooth of this gear has, or hardly one, at an attribute of the gear such as ``faults.0``."""
        if self.tooth is not None and self.tooth >= gear.tooth_count:
            expected = f"a tooth from 0 to {gear.tooth_count - 1}"
            yield Finding(("gear", gear.name), f"{attribute}.tooth", self.tooth, expected)

    def gap(self, gear: Gear, roll_angle: FloatArray, *, pitch_roll_angle: float, face_width: float) -> FloatArray:
        """Material off the flank [m] at roll angles [rad].

        `pitch_roll_angle` is the working pitch point's, `face_width` that of the pair's common face [m].
        """
        return np.zeros_like(roll_angle)

    def extra_compliance(self, gear: Gear, roll_angle: FloatArray) -> FloatArray:
        """Additional compliance over a sound tooth [m/N], for loads at roll angles [rad]; without the contact."""
        return np.zeros_like(roll_angle)

    def more_flattening(self, roll_angle: FloatArray, face_width: float) -> FloatArray:
        """Growth of the flattening of the pair's contact at roll angles [rad], over that of sound flanks.

        `face_width` is that of the pair's common face [m].
        """
        return np.zeros_like(roll_angle)

    def corners(self, gear: Gear, pitch_roll_angle: float) -> tuple[float, ...]:
        """Roll angles at which gap or compliance has a corner [rad]."""
        return ()


@dataclass(frozen=True)
class Gear:
    """A spur or helical gear with external or internal teeth.

    Parameters
    ----------
    name : str
        Name in messages.
    teeth : int
        Number of teeth, at least 5; negative of an internal gear, whose radii are negative then (ISO 21771).
    module : float
        Normal module [m].
    pressure_angle : float
        Normal pressure angle, of the basic rack [rad].
    face_width : float
        Width of the teeth along the shaft [m]; see ``has_face``.
    profile_shift : float
        Profile shift coefficient, in normal modules, positive outward; of an internal gear inward. A positive one makes
        the teeth thicker.
    addendum, dedendum : float
        Addendum of the gear and of the basic rack that cuts it (so the gear's dedendum), in normal modules.
    root_radius : float or None
        Tip corner radius of the rack in its normal section [m], which shapes the root fillet.  None: the radius that
        ends the rack's straight flank one addendum below its reference line, ``(dedendum - addendum) m / (1 -
        sin(alpha))``, or the full tip radius where that is smaller.  Of an internal gear the radius of the root
        fillet itself, in the transverse plane (:mod:`gearwhine.coupling.gears.geometry.root_arc`).
    bore : float
        Diameter of the bore [m]; 0 for a gear made from its shaft, which then has the mass of the core
        (:mod:`gearwhine.coupling.gears.geometry.blank`).
    youngs_modulus, poisson_ratio, density : float
        Material [Pa], [-], [kg/m^3]; steel where not given.
    tip_relief : TipRelief or None
    root_relief : RootRelief or None
        Profile modifications.
    eccentricity, eccentricity_phase : float
        Distance from the shaft line to the gear's centre [m], and the angle of that offset from x at
        zero rotation [rad].
    pitch_deviations : tuple of float
        Index (cumulative pitch) deviation of each tooth: its distance from the ideal place, along the arc of the
        working pitch circle [m].  One for each tooth in the order in which they come into mesh, tooth 0 at
        phase 0; none for a perfect pitch.  Positive where the working flank stands ahead, so that it touches
        early: a driver's tooth displaced in the sense of its rotation, a driven gear's against it.  The whole
        tooth is displaced, so its back flank is behind by as much.  Of a gear with several mates numbers, order and
        signs are those of the first pair that it belongs to.
    profile_deviation : ProfileDeviation or None
        Deviation of the profile of all flanks from its design.
    helix_deviation : HelixDeviation or None
        Deviation of all flanks from their design across the face.
    faults : tuple of Fault
        Damaged teeth (:mod:`gearwhine.coupling.gears.geometry.faults`).
    helix_angle : float
        Helix angle on the reference cylinder [rad], positive for a right-hand helix; 0 for a spur gear. An internal
        gear meshes with an external one of the same hand.
    rim_thickness : float or None
        Thickness from the root circle to the inside of the rim [m]; None for a disc without a rim.  Of an internal
        gear that from the root circle to the outside of the ring; None for 3.5 modules.
    web_thickness : float or None
        Width of the disc between rim and hub [m]; None for a rim alone.
    hub_diameter : float or None
        Outer diameter of the hub around the bore [m]; None for a web that begins at the bore.
    hub_width : float or None
        Width of the hub [m]; None for that of the face.
    ring_support : RingSupport or None
        What holds the outside of an internal gear's rim; None for a clamped one.
    tooth_thinning : float
        Reduction of the tooth thickness below that of the profile shift, for backlash: in the normal section, along
        the reference circle [m].
    allow_undercut : bool
        Whether to accept a gear whose rack cuts away the foot of the involute; its flank then begins where trochoid
        and involute cross.
    has_face : bool
        Whether the face width is known. Else it is nominal, and the teeth touch in one point in its middle.

    Raises
    ------
    GearError
        For a value outside its range; `UndercutError` where the rack cuts below the involute's start and that is
        not allowed, `PointedToothError` where the flanks meet before the tip circle.
    """

    name: str
    teeth: int
    module: float
    pressure_angle: float
    face_width: float
    profile_shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    root_radius: float | None = None
    bore: float = 0.0
    youngs_modulus: float = STEEL.youngs_modulus
    poisson_ratio: float = STEEL.poisson_ratio
    density: float = STEEL.density
    tip_relief: TipRelief | None = None
    root_relief: RootRelief | None = None
    eccentricity: float = 0.0
    eccentricity_phase: float = 0.0
    pitch_deviations: tuple[float, ...] = ()
    profile_deviation: ProfileDeviation | None = None
    helix_deviation: HelixDeviation | None = None
    faults: tuple[Fault, ...] = ()
    helix_angle: float = 0.0
    rim_thickness: float | None = None
    web_thickness: float | None = None
    tooth_thinning: float = 0.0
    allow_undercut: bool = False
    hub_diameter: float | None = None
    hub_width: float | None = None
    ring_support: RingSupport | None = None
    has_face: bool = True

    def __post_init__(self) -> None:
        """Check the dimensions, the body, the rack, the flank and the modifications."""
        keep_tuples(self, "pitch_deviations", "faults")
        if isinstance(self.teeth, np.integer):
            object.__setattr__(self, "teeth", int(self.teeth))
        refuse(_attribute_findings(self), GearError)
        refuse(_body_findings(self), GearError)
        _check_rack(self)
        _check_flank(self)
        _check_modifications(self)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Deviations larger than the teeth, and what is unlikely of sizes, deviations and material."""
        material = material_findings(("gear", self.name), self.youngs_modulus, self.poisson_ratio, self.density)
        faults = (found for n, fault in enumerate(self.faults) for found in fault.findings(self, f"faults.{n}"))
        return (*_deviation_findings(self), *_size_findings(self), *material, *faults)

    @cached_property
    def sound(self) -> Gear:
        """The gear with involute flanks, without modifications, deviations and faults of its teeth."""
        of_flanks = (self.tip_relief, self.root_relief, self.profile_deviation, self.helix_deviation)
        if not (any(of_flanks) or self.pitch_deviations or self.faults or self.eccentricity):
            return self
        return unchecked(
            self,
            eccentricity=0.0,
            eccentricity_phase=0.0,
            pitch_deviations=(),
            faults=(),
            tip_relief=None,
            root_relief=None,
            profile_deviation=None,
            helix_deviation=None,
        )

    # ----------------------------------------------------- external or internal

    @property
    def is_internal(self) -> bool:
        """Whether the teeth point inward, as those of a ring gear."""
        return self.teeth < 0

    @property
    def sign(self) -> int:
        """Sign of the number of teeth and of the radii: 1 of an external gear, -1 of an internal one."""
        return -1 if self.is_internal else 1

    @property
    def tooth_count(self) -> int:
        """Number of teeth without its sign."""
        return abs(self.teeth)

    # ------------------------------------------------------- transverse plane

    @property
    def transverse_module(self) -> float:
        """Transverse module [m]: reference diameter over number of teeth."""
        return self.module / math.cos(self.helix_angle)

    @property
    def transverse_pressure_angle(self) -> float:
        """Transverse pressure angle on the reference circle [rad]."""
        if self.helix_angle == 0.0:
            return self.pressure_angle  # equal to the last bit
        return math.atan(math.tan(self.pressure_angle) / math.cos(self.helix_angle))

    @cached_property
    def pitch_radius(self) -> float:
        """Reference radius ``m_t z / 2`` [m]."""
        return 0.5 * self.transverse_module * self.teeth

    @cached_property
    def base_radius(self) -> float:
        """Base circle radius, of the circle from which the involute unwinds [m]."""
        return self.pitch_radius * math.cos(self.transverse_pressure_angle)

    @cached_property
    def tip_radius(self) -> float:
        """Tip circle radius [m]."""
        return self.pitch_radius + (self.addendum + self.profile_shift) * self.module

    @property
    def root_circle_radius(self) -> float:
        """Root circle radius [m]."""
        return self.pitch_radius - (self.dedendum - self.generating_shift) * self.module

    @cached_property
    def base_pitch(self) -> float:
        """Transverse base pitch: distance of neighbouring flanks along the line of action [m]."""
        return 2.0 * math.pi * self.base_radius / self.teeth

    @cached_property
    def form_radius(self) -> float:
        """Form circle radius, at which the fillet ends and the involute begins [m]."""
        if self.is_internal:
            return self.root_arc.form_radius
        if self.is_undercut:
            height, across, _ = self.rack_corner_arc.trochoid(self.pitch_radius, self.fillet_end)
            return math.hypot(height, across)
        sine = math.sin(self.transverse_pressure_angle)
        return math.hypot(self.base_radius, self.pitch_radius * sine - self._flank_depth / sine)

    # ------------------------------------------------------------------- helix

    @property
    def base_helix_angle(self) -> float:
        """Helix angle on the base cylinder [rad], signed as `helix_angle`."""
        return math.asin(math.sin(self.helix_angle) * math.cos(self.pressure_angle))

    @property
    def lead(self) -> float:
        """Lead of the helix [m], negative for a left-hand one; infinite for a spur gear."""
        return self.tooth_count * self.axial_pitch

    @property
    def axial_pitch(self) -> float:
        """Axial pitch of neighbouring teeth [m], signed as `helix_angle`; infinite for a spur gear."""
        return math.inf if self.helix_angle == 0.0 else math.pi * self.module / math.sin(self.helix_angle)

    @property
    def virtual_teeth(self) -> float:
        """Virtual number of teeth, of the spur gear of the normal section: ``z / (cos(beta_b)^2 cos(beta))``."""
        return self.teeth / (math.cos(self.base_helix_angle) ** 2 * math.cos(self.helix_angle))

    def turn_along(self, z: float) -> float:
        """Rotation about z of the teeth at z from the middle of the face [rad]; positive for a right hand at z > 0."""
        return 2.0 * math.pi * z / self.lead

    def helix_angle_at(self, radius: float) -> float:
        """Helix angle [rad] on the cylinder of `radius` [m]: ``tan(beta_y) = tan(beta) r_y / r``."""
        return math.atan(math.tan(self.helix_angle) * radius / self.pitch_radius)

    # ---------------------------------------------------------- generating rack

    @property
    def generating_shift(self) -> float:
        """Generating profile shift ``x_E``, of the rack that cuts the teeth with their thinning, in modules."""
        return self.profile_shift - self.tooth_thinning / (2.0 * self.module * math.tan(self.pressure_angle))

    @property
    def rack(self) -> BasicRack:
        """The rack that generates the teeth of an external gear, and is the reference profile of an internal one."""
        return BasicRack(
            self.module, self.pressure_angle, self.addendum, self.dedendum, self.root_radius, self.helix_angle
        )

    @property
    def rack_tip_radius(self) -> float:
        """Corner radius of the generating rack, in its normal section; of an internal gear that of its root arc [m]."""
        return self.root_arc.radius if self.is_internal else self.rack.corner_radius

    @property
    def full_rack_tip_radius(self) -> float:
        """The largest `rack_tip_radius`: one arc from flank to flank of the rack's tooth, or of a ring's space [m]."""
        if self.is_internal:
            return full_arc_radius(self.base_radius, self.root_circle_radius, self.base_half_angle, self.teeth)
        return self.rack.full_tip_radius

    @cached_property
    def root_arc(self) -> RootArc:
        """Root fillet of an internal gear, from its flank to its root circle."""
        radius = self.root_radius
        if radius is None:
            from_clearance = (self.dedendum - self.addendum) * self.module / (1.0 - math.sin(self.pressure_angle))
            radius = max(0.0, min(from_clearance, self.full_rack_tip_radius))
        return RootArc(self.base_radius, self.root_circle_radius, self.base_half_angle, radius)

    @property
    def rack_corner_arc(self) -> RackCorner:
        """The rack's corner as it rolls in the transverse plane."""
        return self.rack.corner(self.generating_shift)

    @property
    def rack_corner(self) -> tuple[float, float]:
        """Centre of the rack's corner arc [m]: depth below the gear's pitch line, distance from the tooth's axis."""
        corner = self.rack_corner_arc
        return corner.depth, corner.across

    @property
    def least_generating_shift(self) -> float:
        """The generating shift below which the rack undercuts the teeth, in modules."""
        return (self.rack.flank_depth - self._deepest_flank) / self.module

    @property
    def is_undercut(self) -> bool:
        """Whether the rack cuts away the foot of the involute; an internal gear has none."""
        return not self.is_internal and self._flank_depth > self._deepest_flank * (1.0 + 1e-12)

    @property
    def fillet_end(self) -> float:
        """The parameter of `coupling.gears.geometry.profile.fillet_points` where the involute begins [rad]."""
        if self.is_internal:
            return self.root_arc.end
        if not self.is_undercut:
            return self.transverse_pressure_angle
        return fillet_end(self.rack_corner_arc, self.pitch_radius, self.transverse_pressure_angle, self.base_half_angle)

    @property
    def _flank_depth(self) -> float:
        """Depth of the end of the rack's straight flank below the gear's pitch line [m]."""
        return self.rack.flank_depth - self.generating_shift * self.module

    @property
    def _deepest_flank(self) -> float:
        """Depth of the tangent point of line of action and base circle below the pitch line [m]."""
        return self.pitch_radius * math.sin(self.transverse_pressure_angle) ** 2

    # ------------------------------------------------------------------ angles

    @cached_property
    def base_half_angle(self) -> float:
        """Half the angle a tooth spans on the base circle [rad], signed: a radius times an angle is a thickness."""
        at_pitch = (math.pi / 2.0 + 2.0 * self.generating_shift * math.tan(self.pressure_angle)) / self.teeth
        return at_pitch + involute(self.transverse_pressure_angle)

    @property
    def tip_half_angle(self) -> float:
        """Half the angle a tooth spans on the tip circle, signed as `base_half_angle` [rad]."""
        return self.base_half_angle - involute(math.acos(self.base_radius / self.tip_radius))

    def roll_angle(self, radius: float) -> float:
        """Roll angle [rad] of the flank point at `radius` [m], ``sqrt((r / rb)^2 - 1)``."""
        return math.sqrt(max(0.0, (radius / self.base_radius) ** 2 - 1.0))

    # -------------------------------------------------------------------- body

    @property
    def rim_inner_radius(self) -> float | None:
        """Radius of the inside of the rim [m]; None for a gear without one, and for an internal gear."""
        if self.is_internal or self.rim_thickness is None:
            return None
        return self.root_circle_radius - self.rim_thickness

    @property
    def rim_outer_radius(self) -> float | None:
        """Radius of the outside of an internal gear's rim, negative as its other radii [m]; None for external gears."""
        if not self.is_internal:
            return None
        thickness = _STIFF_RIM * self.module if self.rim_thickness is None else self.rim_thickness
        return self.root_circle_radius - thickness

    @property
    def outer_radius(self) -> float:
        """Radius of the whole body as a length [m]: of the tip circle, of an internal gear of the rim's outside."""
        return self.tip_radius if self.rim_outer_radius is None else -self.rim_outer_radius

    @property
    def blank_rings(self) -> tuple[BlankRing, ...]:
        """Rings of the blank, one inside the other, their middles in the middle of the face."""
        if self.is_internal:
            return (BlankRing(self.face_width, self.outer_radius, -self.pitch_radius),)
        bore_radius, inside = 0.5 * self.bore, self.rim_inner_radius
        if inside is None:
            return (BlankRing(self.face_width, self.pitch_radius, bore_radius),)
        rim = BlankRing(self.face_width, self.pitch_radius, inside)
        if self.web_thickness is None:
            return (rim,)
        if self.hub_diameter is None:
            return rim, BlankRing(self.web_thickness, inside, bore_radius)
        hub = BlankRing(self.hub_width or self.face_width, 0.5 * self.hub_diameter, bore_radius)
        return rim, BlankRing(self.web_thickness, inside, hub.outer_radius), hub

    @property
    def inertia(self) -> Inertia:
        """Mass and moments of inertia of the blank; of a gear without a bore down to the axis."""
        rings = [hollow_disc(self.density, *ring) for ring in self.blank_rings]
        return Inertia(*(sum(of_rings) for of_rings in zip(*rings, strict=True)))

    @property
    def mass(self) -> float:
        """Mass of the blank [kg]."""
        return self.inertia.mass

    @property
    def polar_inertia(self) -> float:
        """Moment of inertia of the blank about the shaft [kg m^2]."""
        return self.inertia.polar

    @property
    def diametral_inertia(self) -> float:
        """Moment of inertia of the blank about a diameter through its middle [kg m^2]."""
        return self.inertia.diametral


def require_tip_thickness(gear: Gear, least: float = 0.2) -> None:
    """Raise `ThinTipError` where a tooth's tip is too thin to be hardened or to carry load.

    Parameters
    ----------
    gear : Gear
    least : float
        Least normal thickness of the tip, in modules; 0.2 is customary for ground and through-hardened teeth, 0.4 for
        case-hardened ones.
    """
    thickness = 2.0 * gear.tip_half_angle * gear.tip_radius * math.cos(gear.helix_angle_at(gear.tip_radius))
    if thickness < least * gear.module:
        raise ThinTipError(
            f"gear {gear.name!r}: the teeth are {thickness * 1e3:.4g} mm thick at the tip, "
            f"{thickness / gear.module:.3g} modules; at least {least:g} modules are wanted. "
            f"Reduce profile_shift ({gear.profile_shift:g}) or addendum ({gear.addendum:g})"
        )


_RULES: dict[str, Rule] = {
    "name": Text(),
    "module": Number(above=0.0, at_most=1.0, unit="m"),  # a value in mm is refused as such
    **dict.fromkeys(("face_width", "addendum", "dedendum", "youngs_modulus", "density"), Number(above=0.0)),
    **dict.fromkeys(("bore", "eccentricity", "tooth_thinning"), Number(at_least=0.0)),
    **dict.fromkeys(("rim_thickness", "web_thickness", "hub_diameter", "hub_width"), Number(above=0.0, optional=True)),
    **dict.fromkeys(("profile_shift", "eccentricity_phase"), FINITE),
    "root_radius": Number(at_least=0.0, optional=True),
    "poisson_ratio": Number(at_least=0.0, below=0.5),
    "pressure_angle": Number(at_least=math.radians(5.0), at_most=math.radians(45.0), unit="rad"),
    "helix_angle": Number(at_least=-_STEEPEST_HELIX, at_most=_STEEPEST_HELIX, unit="rad"),
    "pitch_deviations": Instance(tuple, "numbers, one for each tooth"),
    "tip_relief": Instance(TipRelief, "a TipRelief, or None", optional=True),
    "root_relief": Instance(RootRelief, "a RootRelief, or None", optional=True),
}


def _attribute_findings(gear: Gear) -> Iterator[Finding]:
    """Yield attributes outside their ranges, each by itself."""
    part = ("gear", str(gear.name))
    yield from attribute_findings(part, gear, **_RULES)
    yield from kind_findings(part, gear, faults=Fault)
    deviations: object = gear.pitch_deviations
    numbers = deviations if isinstance(deviations, tuple) else ()
    if type(gear.teeth) is not int or abs(gear.teeth) < 5:
        yield Finding(part, "teeth", gear.teeth, "a whole number of at least 5, negative of an internal gear")
    elif len(numbers) not in (0, gear.tooth_count):
        yield Finding(part, "pitch_deviations", numbers, f"one deviation for each of {gear.tooth_count} teeth, or none")
    for tooth, deviation in enumerate(numbers):
        if not FINITE.accepts(deviation):
            yield Finding(part, f"pitch_deviations.{tooth}", deviation, FINITE.expected)


def _body_findings(gear: Gear) -> Iterator[Finding]:
    """Yield sizes of bore, rim, web and hub that do not fit into each other."""
    part = ("gear", gear.name)
    if gear.is_internal:
        for attribute in ("bore", "web_thickness", "hub_diameter", "hub_width"):
            if value := getattr(gear, attribute):
                yield Finding(part, attribute, value, "none of an internal gear, a ring outside its teeth, with a rim")
        if gear.ring_support is not None:
            yield from gear.ring_support.fit_findings(gear.name, gear.outer_radius)
        return
    if gear.ring_support is not None:
        expected = f"none of an external gear; a ring has a negative number of teeth, teeth = {-gear.teeth}"
        yield Finding(part, "ring_support", gear.ring_support.kind, expected)
    root, inside, web = gear.root_circle_radius, gear.rim_inner_radius, gear.web_thickness
    if root <= 0.5 * gear.bore:
        yield Finding(part, "bore", gear.bore, f"a bore smaller than the root circle, {in_mm(2.0 * root)}")
    elif inside is not None and inside <= 0.5 * gear.bore:
        expected = f"room between rim and bore: a rim below {in_mm(root - 0.5 * gear.bore)}, or none for a plain disc"
        yield Finding(part, "rim_thickness", gear.rim_thickness, expected)
    if web is not None and inside is None:
        yield Finding(part, "web_thickness", web, "no web, or a rim around it: else it is a plain disc")
    if web is not None and web > gear.face_width:
        yield Finding(part, "web_thickness", web, f"at most the face width, {in_mm(gear.face_width)}")
    if gear.hub_diameter is not None:
        if web is None or inside is None:
            yield Finding(part, "hub_diameter", gear.hub_diameter, "no hub, or a web around it")
        elif not 0.0 < gear.bore < gear.hub_diameter < 2.0 * inside:
            expected = f"between a bore, {in_mm(gear.bore)}, and the inside of the rim, {in_mm(2.0 * inside)}"
            yield Finding(part, "hub_diameter", gear.hub_diameter, expected)
    if gear.hub_width is not None and (gear.hub_diameter is None or gear.hub_width < (web or 0.0)):
        expected = "the width of a hub with a hub_diameter, at least that of the web"
        yield Finding(part, "hub_width", gear.hub_width, expected)


def _refuse(gear: Gear, attribute: str, value: object, expected: str, error: type[GearError] = GearError) -> None:
    """Refuse a gear for an attribute that does not fit the others."""
    refuse([Finding(("gear", gear.name), attribute, value, expected)], error)


def _check_rack(gear: Gear) -> None:
    """Raise `GearError` or `PointedToothError` where no rack has the proportions."""
    if gear.is_internal:
        _check_ring(gear)
        return
    full = gear.full_rack_tip_radius
    if full < 0.0:
        angle = math.degrees(gear.pressure_angle)
        expected = f"less: the rack's own teeth are pointed with a pressure angle of {angle:.4g} degrees"
        _refuse(gear, "dedendum", gear.dedendum, expected, PointedToothError)
    if gear.root_radius is not None and gear.root_radius > full * (1.0 + 1e-12):
        _refuse(gear, "root_radius", gear.root_radius, f"at most {full * 1e3:.4g} mm, which fits the rack's tip")
    if gear.generating_shift > gear.dedendum:
        most = gear.dedendum + gear.profile_shift - gear.generating_shift
        expected = f"at most {most:.4g}, with which the rack's teeth reach the pitch line on which they roll"
        _refuse(gear, "profile_shift", gear.profile_shift, expected)


def _check_ring(gear: Gear) -> None:
    """Raise `GearError` or `PointedToothError` where an internal gear has no involute from root to tip."""
    if gear.tip_radius > gear.base_radius:
        most = (gear.base_radius - gear.pitch_radius) / gear.module - gear.profile_shift
        per_tooth = (gear.pitch_radius - gear.base_radius) / gear.teeth
        least = math.ceil((gear.addendum + gear.profile_shift) * gear.module / per_tooth)
        expected = (
            f"at most {most:.4g}, a smaller profile_shift ({gear.profile_shift:g}), or {least} teeth or more: the tip "
            f"circle of {-2e3 * gear.tip_radius:.6g} mm lies inside the base circle of "
            f"{-2e3 * gear.base_radius:.6g} mm, where an internal gear has no involute"
        )
        _refuse(gear, "addendum", gear.addendum, expected)
    full = gear.full_rack_tip_radius if gear.root_circle_radius < gear.base_radius else -1.0
    if full < 0.0:
        expected = (
            f"less, or a larger profile_shift ({gear.profile_shift:g}): the flanks of a space meet before the root "
            f"circle of {-2e3 * gear.root_circle_radius:.6g} mm"
        )
        _refuse(gear, "dedendum", gear.dedendum, expected, PointedToothError)
    if gear.root_radius is not None and gear.root_radius > full * (1.0 + 1e-12):
        _refuse(gear, "root_radius", gear.root_radius, f"at most {full * 1e3:.4g} mm, which fits the root of a space")


def _check_flank(gear: Gear) -> None:
    """Raise `GearError`, `UndercutError` or `PointedToothError` where the teeth have no flank from foot to tip."""
    if gear.is_undercut and not gear.allow_undercut:
        least = gear.least_generating_shift + gear.profile_shift - gear.generating_shift
        expected = (
            f"{least:.4g} or more, with which {gear.teeth} teeth are not undercut; "
            "allow_undercut takes the teeth as they are"
        )
        _refuse(gear, "profile_shift", gear.profile_shift, expected, UndercutError)
    if gear.is_undercut:
        gamma = np.linspace(gear.fillet_end, math.pi / 2.0, 65)
        neck = 2.0 * float(np.min(gear.rack_corner_arc.trochoid(gear.pitch_radius, gamma).half_thickness))
        if neck <= 0.0:
            expected = "more: the rack cuts the teeth off at their feet"
            _refuse(gear, "profile_shift", gear.profile_shift, expected, UndercutError)
    if gear.tip_radius <= gear.form_radius:
        _refuse(gear, "addendum", gear.addendum, "more: the tip circle lies below the start of the involute")
    if gear.sign * gear.tip_half_angle <= 0.0:
        expected = (
            f"less, or a smaller profile_shift ({gear.profile_shift:g}): the teeth are pointed below the tip circle"
        )
        _refuse(gear, "addendum", gear.addendum, expected, PointedToothError)


def _check_modifications(gear: Gear) -> None:
    """Raise `GearError` for modifications that begin off the flank, and for deviations and faults that no tooth has."""
    tip, form = gear.roll_angle(gear.tip_radius), gear.roll_angle(gear.form_radius)
    if gear.tip_relief is not None:
        start = gear.tip_relief.start(tip, gear.base_radius)
        if gear.is_internal and not tip < start <= form:
            expected = f"a start between the roll angles of the tip and the form circle, {_degrees(tip, form)}"
            _refuse_start(gear, "tip_relief", start, expected)
        if not gear.is_internal and not 0.0 <= start < tip:
            expected = f"a start on the involute, below the tip's roll angle of {math.degrees(tip):.4g} degrees"
            _refuse_start(gear, "tip_relief", start, expected)
    if gear.root_relief is not None:
        start = gear.root_relief.start(form, gear.base_radius)
        if not gear.sign * form < gear.sign * start <= gear.sign * tip:
            expected = f"a start between the roll angles of the form circle and the tip, {_degrees(form, tip)}"
            _refuse_start(gear, "root_relief", start, expected)
    refuse(gear.findings, GearError)


def _degrees(low: float, high: float) -> str:
    return f"{math.degrees(low):.4g} and {math.degrees(high):.4g} degrees"


def _refuse_start(gear: Gear, name: Literal["tip_relief", "root_relief"], start: float, expected: str) -> None:
    """Refuse a gear for a relief that does not begin on the flank, by the attribute that gives its start."""
    relief = getattr(gear, name)
    attribute = "start_roll_angle" if relief.length is None else "length"
    expected += f"; it is {math.degrees(start):.4g} degrees"
    _refuse(gear, f"{name}.{attribute}", getattr(relief, attribute), expected)


_LARGEST_DEVIATION = 0.25
"""Deviation of a flank beyond which it is larger than the tooth can hold, in modules: the tip clearance of ISO 53."""
_LARGE_DEVIATION = 0.05
"""Deviation of a flank that is unlikely, in modules: relief has 0.01 to 0.03, errors of quality 12 have 0.03."""


def _deviation_findings(gear: Gear) -> Iterator[Finding]:
    """Yield modifications and errors of the flanks that are larger than the teeth, or unlikely."""
    part = ("gear", gear.name)
    deviations: list[tuple[str, float]] = [("eccentricity", gear.eccentricity)]
    for attribute in ("tip_relief", "root_relief", "profile_deviation", "helix_deviation"):
        of_flank = getattr(gear, attribute)
        for name in ("amount", "slope", "form", "crowning", "end_relief"):
            if of_flank is not None and hasattr(of_flank, name):
                deviations.append((f"{attribute}.{name}", getattr(of_flank, name)))
    if gear.pitch_deviations:
        deviations.append(("pitch_deviations", max(gear.pitch_deviations, key=abs)))
    for name, value in deviations:
        if abs(value) > _LARGEST_DEVIATION * gear.module:
            expected = f"at most a quarter of the module, {1e3 * _LARGEST_DEVIATION * gear.module:.4g} mm"
            yield Finding(part, name, value, f"{expected}: a tooth has no room for more")
        elif abs(value) > _LARGE_DEVIATION * gear.module:
            expected = f"at most {1e3 * _LARGE_DEVIATION * gear.module:.4g} mm, a twentieth of the module"
            yield Finding(part, name, value, f"{expected}, as gears have it", "warning")


_PLAUSIBLE_WIDTHS = (1.0, 60.0)
"""Face widths of gears, in modules."""
_PLAUSIBLE_MODULES = (5e-5, 50e-3)
"""Modules of gears, from watches to mills [m]."""


def _size_findings(gear: Gear) -> Iterator[Finding]:
    """Yield sizes that gears hardly have."""
    part = ("gear", gear.name)
    low, high = _PLAUSIBLE_MODULES
    if not low <= gear.module <= high:
        expected = f"a module of {1e3 * low:g} to {1e3 * high:g} mm, as gears have"
        yield Finding(part, "module", gear.module, expected, "warning")
    low, high = (each * gear.module for each in _PLAUSIBLE_WIDTHS)
    if gear.has_face and not low <= gear.face_width <= high:
        expected = f"a face of 1 to 60 modules, {1e3 * low:.4g} to {1e3 * high:.4g} mm, as gears have"
        yield Finding(part, "face_width", gear.face_width, expected, "warning")
