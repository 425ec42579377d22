"""One external gear, spur or helical: tooth proportions, and the radii and angles that follow.

The tooth is what a basic rack generates (ISO 53, ISO 21771).  Module ``m``, pressure angle ``alpha``, profile shift
``x`` (positive outward) and the heights are those of the rack's normal section; everything that turns, touches or is
drawn lives in the transverse plane.  With ``z`` teeth and helix angle ``beta`` on the reference cylinder:

    transverse module          m_t = m / cos(beta)             tan(alpha_t) = tan(alpha) / cos(beta)
    reference radius           r = m_t z / 2                   tip radius   r_a = r + (h_a + x) m
    base radius                rb = r cos(alpha_t)             root radius  r_f = r - (h_f - x_E) m
    base helix angle           sin(beta_b) = sin(beta) cos(alpha)
    equivalent teeth           z_n = z / (cos(beta_b)^2 cos(beta))

A spur gear is ``beta = 0``.  A tooth made thinner for backlash is cut by the same rack, ``thinning / (2 tan(alpha))``
deeper: flank, fillet and root follow the generating shift ``x_E = x - thinning / (2 m tan(alpha))``, the tip does not.

The rack's tip corners are rounded; the flank is an involute down to the form radius, where the corner's trochoid takes
over (see :mod:`coupling.gears.rack`, :mod:`coupling.gears.profile`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from coupling.gears.blank import Inertia, blank_inertia
from coupling.gears.gear_checks import check_numbers, check_tooth
from coupling.gears.involute import involute
from coupling.gears.rack import BasicRack, RackCorner
from coupling.gears.tip_relief import TipRelief
from coupling.gears.undercut import fillet_end

STEEL_YOUNGS_MODULUS = 207e9
STEEL_POISSON_RATIO = 0.3
STEEL_DENSITY = 7850.0


@dataclass(frozen=True)
class Gear:
    """A spur or helical gear with external teeth.

    Parameters
    ----------
    name : str
        What messages call it.
    teeth : int
        Number of teeth, at least 5.
    module : float
        Normal module [m].
    pressure_angle : float
        Normal pressure angle, of the basic rack [rad].
    face_width : float
        Width of the teeth along the shaft [m].
    profile_shift : float
        Profile shift coefficient, in normal modules, positive outward.
    addendum, dedendum : float
        Addendum of the gear and of the basic rack that cuts it (so the gear's dedendum), in normal modules.
    root_radius : float or None
        Tip corner radius of the rack in its normal section [m], which shapes the root fillet.  None: the radius that
        ends the rack's straight flank one addendum below its reference line, ``(dedendum - addendum) m / (1 -
        sin(alpha))``, or the full tip radius where that is smaller.
    bore : float
        Diameter of the bore [m]; 0 for a gear in one piece with its shaft.
    youngs_modulus, poisson_ratio, density : float
        Material [Pa], [-], [kg/m^3].
    tip_relief : TipRelief or None
        Profile modification.
    eccentricity, eccentricity_phase : float
        Distance from the shaft line to the gear's centre [m], and the angle of that offset from x at
        zero rotation [rad].
    pitch_deviations : tuple of float
        Index (cumulative pitch) deviation of each tooth: how far it stands from its ideal place, along the arc of
        the working pitch circle [m].  One for each tooth in the order in which they come into mesh, tooth 0 at
        phase 0; none for a perfect pitch.  Positive where the working flank stands ahead, so that it touches
        early: a driver's tooth displaced in the sense of its rotation, a driven gear's against it.  The whole
        tooth is displaced, so its idle flank is behind by as much.  Each mesh of a gear counts from its own
        tooth 0, and reads the signs for its own working flanks.
    helix_angle : float
        Helix angle on the reference cylinder [rad], positive for a right-hand helix; 0 for a spur gear.
    rim_thickness : float or None
        From the root circle to the inside of the rim [m]; None for a disc without a rim.
    web_thickness : float or None
        Width of the disc between rim and bore [m]; None for a rim alone.
    tooth_thinning : float
        How much thinner a tooth is than its profile shift says, so that there is backlash: in the normal section,
        along the reference circle [m].
    allow_undercut : bool
        Take a gear whose rack cuts away the foot of the involute; its flank then begins where trochoid and involute
        cross.

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
    youngs_modulus: float = STEEL_YOUNGS_MODULUS
    poisson_ratio: float = STEEL_POISSON_RATIO
    density: float = STEEL_DENSITY
    tip_relief: TipRelief | None = None
    eccentricity: float = 0.0
    eccentricity_phase: float = 0.0
    pitch_deviations: tuple[float, ...] = ()
    helix_angle: float = 0.0
    rim_thickness: float | None = None
    web_thickness: float | None = None
    tooth_thinning: float = 0.0
    allow_undercut: bool = False

    def __post_init__(self) -> None:
        check_numbers(self)
        check_tooth(self)

    # ------------------------------------------------------- transverse plane

    @property
    def transverse_module(self) -> float:
        """Diameter of the reference circle over teeth [m]."""
        return self.module / math.cos(self.helix_angle)

    @property
    def transverse_pressure_angle(self) -> float:
        """Pressure angle on the reference circle [rad]."""
        if self.helix_angle == 0.0:
            return self.pressure_angle  # to the last bit
        return math.atan(math.tan(self.pressure_angle) / math.cos(self.helix_angle))

    @property
    def pitch_radius(self) -> float:
        """Reference radius ``m_t z / 2`` [m]."""
        return 0.5 * self.transverse_module * self.teeth

    @property
    def base_radius(self) -> float:
        """Radius of the circle the involute unwinds from [m]."""
        return self.pitch_radius * math.cos(self.transverse_pressure_angle)

    @property
    def tip_radius(self) -> float:
        """Outer radius [m]."""
        return self.pitch_radius + (self.addendum + self.profile_shift) * self.module

    @property
    def root_circle_radius(self) -> float:
        """Radius of the bottom of the tooth space [m]."""
        return self.pitch_radius - (self.dedendum - self.generating_shift) * self.module

    @property
    def base_pitch(self) -> float:
        """Distance between neighbouring flanks along the line of action, in the transverse plane [m]."""
        return 2.0 * math.pi * self.base_radius / self.teeth

    @property
    def form_radius(self) -> float:
        """Radius where the fillet's trochoid ends and the involute begins [m]."""
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
        """Length of shaft over which a tooth turns once round [m], negative for a left hand; infinite for a spur."""
        return self.teeth * self.axial_pitch

    @property
    def axial_pitch(self) -> float:
        """Distance of neighbouring teeth along the shaft [m], signed as `helix_angle`; infinite for a spur."""
        return math.inf if self.helix_angle == 0.0 else math.pi * self.module / math.sin(self.helix_angle)

    @property
    def virtual_teeth(self) -> float:
        """Teeth of the spur gear like this gear's normal section, ``z / (cos(beta_b)^2 cos(beta))``."""
        return self.teeth / (math.cos(self.base_helix_angle) ** 2 * math.cos(self.helix_angle))

    def helix_angle_at(self, radius: float) -> float:
        """Helix angle [rad] on the cylinder of `radius` [m]: ``tan(beta_y) = tan(beta) r_y / r``."""
        return math.atan(math.tan(self.helix_angle) * radius / self.pitch_radius)

    # ---------------------------------------------------------- generating rack

    @property
    def generating_shift(self) -> float:
        """Profile shift ``x_E`` at which the rack stands that cuts the teeth as thin as they are, in modules."""
        return self.profile_shift - self.tooth_thinning / (2.0 * self.module * math.tan(self.pressure_angle))

    @property
    def rack(self) -> BasicRack:
        """The rack that generates the teeth."""
        return BasicRack(
            self.module, self.pressure_angle, self.addendum, self.dedendum, self.root_radius, self.helix_angle
        )

    @property
    def rack_tip_radius(self) -> float:
        """Corner radius of the generating rack, in its normal section [m]."""
        return self.rack.corner_radius

    @property
    def full_rack_tip_radius(self) -> float:
        """The largest corner radius: one arc from flank to flank of the rack's tooth [m]."""
        return self.rack.full_tip_radius

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
        """Whether the rack cuts away the foot of the involute."""
        return self._flank_depth > self._deepest_flank * (1.0 + 1e-12)

    @property
    def fillet_end(self) -> float:
        """The parameter of `coupling.gears.profile.fillet_points` where the involute begins [rad]."""
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

    @property
    def base_half_angle(self) -> float:
        """Half the angle a tooth spans on the base circle [rad]."""
        at_pitch = (math.pi / 2.0 + 2.0 * self.generating_shift * math.tan(self.pressure_angle)) / self.teeth
        return at_pitch + involute(self.transverse_pressure_angle)

    @property
    def tip_half_angle(self) -> float:
        """Half the angle a tooth spans on the tip circle [rad]."""
        return self.base_half_angle - involute(math.acos(self.base_radius / self.tip_radius))

    def roll_angle(self, radius: float) -> float:
        """Roll angle [rad] of the flank point at `radius` [m], ``sqrt((r / rb)^2 - 1)``."""
        return math.sqrt(max(0.0, (radius / self.base_radius) ** 2 - 1.0))

    # -------------------------------------------------------------------- body

    @property
    def rim_inner_radius(self) -> float | None:
        """Radius of the inside of the rim [m]; None for a gear without one."""
        return None if self.rim_thickness is None else self.root_circle_radius - self.rim_thickness

    @property
    def inertia(self) -> Inertia:
        """Mass and moments of inertia of the blank, see :mod:`coupling.gears.blank`."""
        return blank_inertia(self)

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
