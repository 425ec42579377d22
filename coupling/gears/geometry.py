"""One spur gear: tooth proportions, the radii that follow, and the inertia of its blank.

The tooth is what a basic rack generates.  With module ``m``, ``z`` teeth, pressure angle ``alpha`` and
profile shift ``x`` (positive outward), all in the transverse plane (ISO 53, ISO 21771):

    pitch radius  r  = m z / 2                  tip radius   r_a = r + (h_a + x) m
    base radius   rb = r cos(alpha)             root radius  r_f = r - (h_f - x) m

The rack's tip corners are rounded; the flank is an involute down to the form radius, where the
corner's trochoid takes over (see :mod:`coupling.gears.profile`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from coupling.gears.errors import GearError, PointedToothError, UndercutError, require_finite
from coupling.gears.faults import Fault
from coupling.gears.flank_errors import HelixDeviation, ProfileDeviation
from coupling.gears.involute import involute
from coupling.gears.modifications import RootRelief, TipRelief

STEEL_YOUNGS_MODULUS = 207e9
STEEL_POISSON_RATIO = 0.3
STEEL_DENSITY = 7850.0


def module_from_base_radius(base_radius: float, teeth: int, pressure_angle: float) -> float:
    """Module [m] of a gear known by its base radius [m], ``2 rb / (z cos(alpha))``, angle in rad."""
    require_finite("base_radius", base_radius, minimum=0.0, strict=True)
    require_finite("teeth", teeth, minimum=0.0, strict=True)
    return 2.0 * base_radius / (teeth * math.cos(pressure_angle))


@dataclass(frozen=True)
class Gear:
    """A spur gear.

    Parameters
    ----------
    name : str
        What messages call it.
    teeth : int
        Number of teeth, at least 5.
    module : float
        Module [m].
    pressure_angle : float
        Pressure angle of the basic rack [rad].
    face_width : float
        Width of the teeth along the shaft [m].
    profile_shift : float
        Profile shift coefficient, in modules, positive outward.
    addendum, dedendum : float
        Addendum of the gear and of the basic rack that cuts it (so the gear's dedendum), in modules.
    root_radius : float or None
        Tip corner radius of the rack [m].  None: the radius that ends the rack's straight flank one
        addendum below its reference line, ``(dedendum - addendum) m / (1 - sin(alpha))``, or the full
        tip radius where that is smaller.
    bore : float
        Diameter of the bore [m]; 0 for a gear in one piece with its shaft.
    youngs_modulus, poisson_ratio, density : float
        Material [Pa], [-], [kg/m^3].
    tip_relief : TipRelief or None
    root_relief : RootRelief or None
        Profile modifications.
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
    profile_deviation : ProfileDeviation or None
        How the profile of all flanks differs from its design.
    helix_deviation : HelixDeviation or None
        How all flanks differ from it across the face.
    faults : tuple of Fault
        Damaged teeth (:mod:`coupling.gears.faults`).

    Raises
    ------
    GearError
        For a value outside its range; `UndercutError` where the rack cuts below the involute's start,
        `PointedToothError` where the flanks meet before the tip circle.
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
    root_relief: RootRelief | None = None
    eccentricity: float = 0.0
    eccentricity_phase: float = 0.0
    pitch_deviations: tuple[float, ...] = ()
    profile_deviation: ProfileDeviation | None = None
    helix_deviation: HelixDeviation | None = None
    faults: tuple[Fault, ...] = ()

    def __post_init__(self) -> None:
        self._check_numbers()
        self._check_tooth()

    # ------------------------------------------------------------------ radii

    @property
    def pitch_radius(self) -> float:
        """Reference radius ``m z / 2`` [m]."""
        return 0.5 * self.module * self.teeth

    @property
    def base_radius(self) -> float:
        """Radius of the circle the involute unwinds from [m]."""
        return self.pitch_radius * math.cos(self.pressure_angle)

    @property
    def tip_radius(self) -> float:
        """Outer radius [m]."""
        return self.pitch_radius + (self.addendum + self.profile_shift) * self.module

    @property
    def root_circle_radius(self) -> float:
        """Radius of the bottom of the tooth space [m]."""
        return self.pitch_radius - (self.dedendum - self.profile_shift) * self.module

    @property
    def base_pitch(self) -> float:
        """Distance between neighbouring flanks along the line of action [m]."""
        return 2.0 * math.pi * self.base_radius / self.teeth

    @property
    def form_radius(self) -> float:
        """Radius where the fillet's trochoid ends and the involute begins [m]."""
        sine = math.sin(self.pressure_angle)
        from_tangent = self.pitch_radius * sine - self._flank_depth / sine
        return math.hypot(self.base_radius, from_tangent)

    # ------------------------------------------------------------- rack corner

    @property
    def rack_tip_radius(self) -> float:
        """Corner radius of the generating rack [m]."""
        if self.root_radius is not None:
            return self.root_radius
        from_clearance = (self.dedendum - self.addendum) * self.module / (1.0 - math.sin(self.pressure_angle))
        return max(0.0, min(from_clearance, self.full_rack_tip_radius))

    @property
    def full_rack_tip_radius(self) -> float:
        """The largest corner radius: one arc from flank to flank of the rack's tooth [m]."""
        half_tip_land = self.module * (math.pi / 4.0 - self.dedendum * math.tan(self.pressure_angle))
        return half_tip_land * math.cos(self.pressure_angle) / (1.0 - math.sin(self.pressure_angle))

    @property
    def rack_corner(self) -> tuple[float, float]:
        """Centre of the rack's corner arc [m]: depth below the gear's pitch line, distance from the tooth's axis."""
        depth_in_rack = self.dedendum * self.module - self.rack_tip_radius
        across = (
            math.pi * self.module / 4.0
            + depth_in_rack * math.tan(self.pressure_angle)
            + self.rack_tip_radius / math.cos(self.pressure_angle)
        )
        return depth_in_rack - self.profile_shift * self.module, across

    @property
    def _flank_depth(self) -> float:
        """Depth of the end of the rack's straight flank below the gear's pitch line [m]."""
        return self.rack_corner[0] + self.rack_tip_radius * math.sin(self.pressure_angle)

    # ------------------------------------------------------------------ angles

    @property
    def base_half_angle(self) -> float:
        """Half the angle a tooth spans on the base circle [rad]."""
        at_pitch = (math.pi / 2.0 + 2.0 * self.profile_shift * math.tan(self.pressure_angle)) / self.teeth
        return at_pitch + involute(self.pressure_angle)

    @property
    def tip_half_angle(self) -> float:
        """Half the angle a tooth spans on the tip circle [rad]."""
        return self.base_half_angle - involute(math.acos(self.base_radius / self.tip_radius))

    def roll_angle(self, radius: float) -> float:
        """Roll angle [rad] of the flank point at `radius` [m], ``sqrt((r / rb)^2 - 1)``."""
        return math.sqrt(max(0.0, (radius / self.base_radius) ** 2 - 1.0))

    # ----------------------------------------------------------------- inertia

    @property
    def mass(self) -> float:
        """Mass of a disc of the pitch diameter, less the bore [kg]."""
        return self.density * self.face_width * math.pi * (self.pitch_radius**2 - 0.25 * self.bore**2)

    @property
    def polar_inertia(self) -> float:
        """Moment of inertia of that disc about the shaft [kg m^2]."""
        return 0.5 * self.mass * (self.pitch_radius**2 + 0.25 * self.bore**2)

    @property
    def diametral_inertia(self) -> float:
        """Moment of inertia of that disc about a diameter through its middle [kg m^2]."""
        return 0.5 * self.polar_inertia + self.mass * self.face_width**2 / 12.0

    # ------------------------------------------------------------------ checks

    def _check_numbers(self) -> None:
        label = f"gear {self.name!r}: "
        if type(self.teeth) is not int or self.teeth < 5:
            raise GearError(f"{label}teeth must be a whole number of at least 5, got {self.teeth!r}")
        for quantity in ("module", "face_width", "addendum", "dedendum", "youngs_modulus", "density"):
            require_finite(label + quantity, getattr(self, quantity), minimum=0.0, strict=True)
        for quantity in ("bore", "eccentricity"):
            require_finite(label + quantity, getattr(self, quantity), minimum=0.0)
        for quantity in ("profile_shift", "eccentricity_phase"):
            require_finite(label + quantity, getattr(self, quantity))
        if self.pitch_deviations and len(self.pitch_deviations) != self.teeth:
            raise GearError(
                f"{label}pitch_deviations must be one for each of {self.teeth} teeth, got {len(self.pitch_deviations)}"
            )
        for tooth, deviation in enumerate(self.pitch_deviations):
            require_finite(f"{label}pitch_deviations[{tooth}]", deviation)
        if not 0.0 <= self.poisson_ratio < 0.5:
            raise GearError(f"{label}poisson_ratio must be in 0 ... 0.5, got {self.poisson_ratio!r}")
        if not math.radians(5.0) <= self.pressure_angle <= math.radians(45.0):
            raise GearError(f"{label}pressure_angle must be 5 to 45 degrees in rad, got {self.pressure_angle!r} rad")

    def _check_tooth(self) -> None:
        label = f"gear {self.name!r}: "
        if self.root_circle_radius <= 0.5 * self.bore:
            raise GearError(
                f"{label}the bore ({self.bore * 1e3:.4g} mm) must be smaller than the root circle "
                f"({2e3 * self.root_circle_radius:.4g} mm)"
            )
        if self.full_rack_tip_radius < 0.0:
            raise PointedToothError(
                f"{label}the rack's own teeth are pointed: dedendum {self.dedendum:g} is too much for "
                f"{math.degrees(self.pressure_angle):.4g} degrees"
            )
        if self.root_radius is not None:
            require_finite(f"{label}root_radius", self.root_radius, minimum=0.0)
            if self.root_radius > self.full_rack_tip_radius * (1.0 + 1e-12):
                raise GearError(
                    f"{label}root_radius {self.root_radius * 1e3:.4g} mm does not fit the rack's tip; "
                    f"at most {self.full_rack_tip_radius * 1e3:.4g} mm"
                )
        if self.rack_corner[0] <= 0.0:
            raise GearError(
                f"{label}profile_shift {self.profile_shift:g} lifts the rack's corner above the pitch line; "
                f"at most {self.dedendum - self.rack_tip_radius / self.module:.4g} here"
            )
        deepest = self.pitch_radius * math.sin(self.pressure_angle) ** 2
        if self._flank_depth > deepest * (1.0 + 1e-12):
            least = self.profile_shift + (self._flank_depth - deepest) / self.module
            raise UndercutError(
                f"{label}{self.teeth} teeth at profile_shift {self.profile_shift:g} are undercut; "
                f"a profile_shift of {least:.4g} or more avoids it"
            )
        if self.tip_radius <= self.form_radius:
            raise GearError(f"{label}the tip circle lies below the start of the involute; raise the addendum")
        if self.tip_half_angle <= 0.0:
            raise PointedToothError(
                f"{label}the teeth are pointed below the tip circle; reduce profile_shift "
                f"({self.profile_shift:g}) or addendum ({self.addendum:g})"
            )
        self._check_flanks()

    def _check_flanks(self) -> None:
        label = f"gear {self.name!r}: "
        tip, form = self.roll_angle(self.tip_radius), self.roll_angle(self.form_radius)
        if self.tip_relief is not None:
            start = self.tip_relief.start(tip, self.base_radius)
            if not 0.0 <= start < tip:
                raise GearError(
                    f"{label}tip relief must start below the tip's roll angle of {math.degrees(tip):.4g} degrees "
                    f"and on the involute, got {math.degrees(start):.4g} degrees"
                )
        if self.root_relief is not None:
            start = self.root_relief.start(form, self.base_radius)
            if not form < start <= tip:
                raise GearError(
                    f"{label}root relief must start between the roll angles of the form circle and the tip, "
                    f"{math.degrees(form):.4g} and {math.degrees(tip):.4g} degrees, "
                    f"got {math.degrees(start):.4g} degrees"
                )
        for fault in self.faults:
            if fault.tooth is not None and fault.tooth >= self.teeth:
                raise GearError(
                    f"{label}a fault is on tooth {fault.tooth}; the teeth are numbered 0 to {self.teeth - 1}"
                )
