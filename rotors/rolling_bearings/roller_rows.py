"""Rows of cylindrical, tapered and spherical rollers of a rolling bearing, by their geometry.

A roller is cut into slices along its line of contact. Slice k of the roller at the azimuth ψ is pressed between the
raceways by

    δ_jk = cos α (x cos ψ + y sin ψ) + σ z sin α + l_k (θ_y cos ψ − θ_x sin ψ) + g − 2 P(x_k)

with σ the row's direction, α the contact angle at the outer ring, g = e sin α − ½ s cos α of axial offset e and
diametral clearance s, P the profile, and l_k the arm of the slice's contact normal about the bearing's centre. It
carries c/n δ^{10/9} (`LineContactRow.stiffness`).

**Cylindrical.** α = 0 and l_k = z_m + x_k, z_m the middle of the rollers: a roller tilts by half of what the rings do,
so that either raceway sees half of each slice's approach (ISO 16281).

**Tapered.** The normals of the two raceways make the angle 2β of the roller's cone, so the raceways squeeze the roller
with 2 Q sin β onto the rib of the inner ring, in the direction of the roller's axis a. With p, φ the roller's motion
and its tilt in its plane, W, Θ those of the inner ring at the roller's middle, and x' the place along the contact line
from the foot of the roller's middle,

    δ_i = n_i·(W − p) + (Θ − φ) x',   δ_o = n_o·p + φ x',   a·(p − W) = 0,   n_{i,o} = t cos β ± a sin β.

The rib keeps the roller on the inner ring: a·p = a·W. Then δ_i + δ_o = n_o·W + Θ x' in every slice, whatever p·t and φ
are, and both raceways being alike they share it equally, which balances the roller's forces along and across its axis
and its moment: the energy is that of slices along the *outer* raceway's normal, with

    l_k = z_m cos α − σ (½ D_pw sin α + ½ D sin β + x_k),   tan β = (D / D_pw) sin(α − β).

The last is the condition of pure rolling: all cones have one apex on the axis. The rib is rigid and its force is taken
in the roller's axis; friction there is left out.

**Spherical.** The outer raceway is a sphere about the bearing's centre, so that every contact normal passes through it:
l_k = z_m cos α, with z_m the sphere's centre. The ring tilts freely. Barrel and raceways have contour radii r < R, so
that P = x²/2 (1/r − 1/R), R = D_pw / (2 cos α) + D/2.

**Centrifugal force** F_c. Every slice bears its own part of it, f along the outer normal: the outer raceway carries q +
f of the inner one's q, with both approaches in δ. At the rib of a tapered roller it adds F_c sin(α − β).

Skew of rollers, friction, gyroscopic moments and bending of the rings are left out.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np
from scipy.optimize import brentq

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.errors import require, require_count, require_finite
from gearwhine.rotors.rolling_bearings.hertz import STEEL, ContactElasticity
from gearwhine.rotors.rolling_bearings.rows import RIGHT_ANGLE, require_space

Profile = Literal["straight", "logarithmic"]
# ISO 16281's line contact of both raceways in series: q = 35 948 L^{8/9} δ^{10/9} in N and mm.
_PALMGREN_STEEL = 35948.0 * 1000.0 ** (8.0 / 9.0) * 1000.0 ** (10.0 / 9.0)

_MOST_SLENDER = 15.0  # length of a roller over its diameter: needles have up to 10


@dataclass(frozen=True)
class LineContactRow:
    """Common base of rows of rollers: see `RollerRow`, `TaperedRollerRow` and `SphericalRollerRow`."""

    count: int
    roller_diameter: float
    length: float
    pitch_diameter: float
    clearance: float = 0.0
    profile: Profile = "logarithmic"
    slices: int = 31
    position: float = 0.0
    elasticity: ContactElasticity = STEEL
    axial_offset: float = 0.0
    direction: int = 1
    estimated: bool = False
    outer_turns: bool = False

    def __post_init__(self) -> None:
        """Check that the rollers fit on the pitch circle, and length, slices, profile, places and direction."""
        require_space("roller", self.count, self.roller_diameter, self.pitch_diameter)
        require_finite("roller length", self.length, positive=True)
        most = _MOST_SLENDER * self.roller_diameter
        require(self.length <= most, "roller length", self.length, f"at most {most:.4g} m, of a needle so thick")
        require_count("count of slices", self.slices)
        is_known = self.profile in ("straight", "logarithmic")
        require(is_known, "roller profile", self.profile, "'straight' or 'logarithmic'")
        for attribute in ("clearance", "position", "axial_offset"):
            require_finite(attribute.replace("_", " "), getattr(self, attribute))
        require(self.direction in (1, -1), "direction of a row", self.direction, "1 or -1")

    @property
    def contact_angle(self) -> float:
        """α, at the outer ring [rad]."""
        return 0.0

    @property
    def roller_angle(self) -> float:
        """β, half the angle of the roller's cone [rad]."""
        return 0.0

    @property
    def inner_direction(self) -> int:
        """See :attr:`gearwhine.rotors.rolling_bearings.rows.BallRow.inner_direction`."""
        return -self.direction if self.outer_turns else self.direction

    @property
    def tilt_arms(self) -> FloatArray:
        """l_k: arm of each slice's contact normal about the bearing's centre, (slices,) [m]."""
        return np.asarray(self.position + self.slice_places)

    @property
    def element_diameter(self) -> float:
        """Diameter of the rollers in their middle [m]."""
        return self.roller_diameter

    @property
    def width(self) -> float:
        """Width of the rollers along the axis [m]."""
        return self.length * math.cos(self.contact_angle)

    @property
    def has_axial_stiffness(self) -> bool:
        """Whether the row carries axial load."""
        return self.contact_angle > 0.0

    @property
    def thrust_senses(self) -> frozenset[int]:
        """Senses along z of the axial loads that the row carries: its direction, where it carries any."""
        return frozenset((self.direction,)) if self.has_axial_stiffness else frozenset()

    @property
    def free_approach(self) -> float:
        """G = e sin α − ½ s cos α: approach of the rings before any displacement [m]."""
        return self.axial_offset * math.sin(self.contact_angle) - 0.5 * self.clearance * math.cos(self.contact_angle)

    @property
    def slack_offset(self) -> float:
        """Axial offset beyond which the rollers of a centred row touch [m]."""
        return 0.5 * self.clearance / math.tan(self.contact_angle)

    @property
    def gamma(self) -> float:
        """γ = D cos(α − β) / D_pw, with the angle of the roller's axis."""
        return self.roller_diameter * math.cos(self.contact_angle - self.roller_angle) / self.pitch_diameter

    def cage_speed(self, speed: float) -> float:
        """Speed of the cage with a ring turning at ``speed``, the inner or where it ``outer_turns`` the outer [rad/s].

        See :meth:`gearwhine.rotors.rolling_bearings.rows.BallRow.cage_speed`.
        """
        return 0.5 * (1.0 + self.gamma if self.outer_turns else 1.0 - self.gamma) * speed

    def centrifugal_force(self, speed: float) -> float:
        """Centrifugal force on a roller, a cylinder of D and L, with a ring turning at ``speed`` rad/s [N]."""
        mass = self.elasticity.element_density * math.pi / 4.0 * self.roller_diameter**2 * self.length
        return mass * 0.5 * self.pitch_diameter * self.cage_speed(speed) ** 2

    def facing(self, direction: int) -> Self:
        """Return the same row with another direction."""
        return replace(self, direction=direction)

    def axial_force(self, axial_offset: float) -> float:
        """Force [N] along the row's direction that moves a centred inner ring by ``axial_offset`` [m]."""
        free = replace(self, axial_offset=axial_offset).free_approach
        deep = np.maximum(free - 2.0 * self.slice_drops, 0.0)
        load = self.stiffness / self.slices * float((deep ** (10.0 / 9.0)).sum())
        return self.count * load * math.sin(self.contact_angle)

    @property
    def stiffness(self) -> float:
        """Contact constant c of one straight roller between both raceways, Q = c δ^{10/9} [N/m^{10/9}].

        35 948 L^{8/9} in N and mm (Palmgren; ISO 16281), for the steel that `ContactElasticity` holds by default, and
        in proportion to E* for others: Palmgren's δ goes as (1/E*)^{0.9}.
        """
        relative = self.elasticity.contact_modulus / STEEL.contact_modulus
        return float(_PALMGREN_STEEL * self.length ** (8.0 / 9.0) * relative)

    @property
    def slice_places(self) -> FloatArray:
        """Middles of the slices from the roller's middle, (slices,) [m]."""
        return self.length * ((np.arange(self.slices) + 0.5) / self.slices - 0.5)

    @property
    def slice_drops(self) -> FloatArray:
        """Profile drop P at each slice, (slices,) [m].

        ISO/TS 16281:2008, Eqs. 42–44: P = 0.00035 D ln[1 / (1 − (2x/L)²)] for L ≤ 2.5 D; the middle of longer rollers
        is straight, and P = 0.0005 D ln[1 / (1 − ((2|x| − L + 2.5 D) / 2.5 D)²)] at its ends.
        """
        if self.profile == "straight":
            return np.zeros(self.slices)
        x, span = np.abs(self.slice_places), 2.5 * self.roller_diameter
        if self.length <= span:
            return np.asarray(-0.00035 * self.roller_diameter * np.log1p(-((2.0 * x / self.length) ** 2)))
        into_end = np.maximum(2.0 * x - self.length + span, 0.0) / span
        return np.asarray(-0.0005 * self.roller_diameter * np.log1p(-(into_end**2)))


Flanges = Literal["none", "one", "both"]


@dataclass(frozen=True)
class RollerRow(LineContactRow):
    """One row of cylindrical rollers, which carry axial load only by flanges.

    Parameters
    ----------
    count : int
        Number of rollers, three or more.
    roller_diameter, length, pitch_diameter : float
        Diameter D, effective length L of contact, and diameter of the circle of the rollers' centres [m].
    clearance : float
        Diametral clearance [m]; negative is an interference.
    profile : str
        ``"straight"``, or ``"logarithmic"`` as ISO 16281 takes it where nothing else is known.
    slices : int
        Number of laminae of a roller; ISO 16281 requires 30 or more.
    position : float
        Position of the rollers' middles from the bearing's centre along z [m].
    elasticity : ContactElasticity
        Elasticity of the contacts; steel unless given.
    axial_offset : float
        Axial displacement of the inner ring at assembly along the row's direction [m].
    direction : int
        Direction, 1 or −1, of the axial load that one flange carries.
    estimated : bool
        Whether the geometry is an estimate (`gearwhine.rotors.rolling_bearings.catalogue`).
    flanges : Flanges
        ``"none"`` (NU, N: no axial load), ``"one"`` (NJ: in the row's direction) or ``"both"`` (NUP).
    flange_stiffness : float
        Stiffness of one roller between the flanges of both rings [N/m]. The energy is ½ k Σ δ² with the approach δ of
        the flanges at the pitch circle; the couple that tilts a roller between its flanges is left out.
    axial_clearance : float
        Axial play of the inner ring, m, half of it to either side.

    Raises
    ------
    RotorError
        Invalid geometry, such as rollers that do not fit on the pitch circle; flanges without stiffness or the reverse.
    """

    flanges: Flanges = "none"
    flange_stiffness: float = 0.0
    axial_clearance: float = 0.0

    def __post_init__(self) -> None:
        """Check as of any rollers, and that flanges have a stiffness."""
        super().__post_init__()
        require(self.flanges in ("none", "one", "both"), "flanges", self.flanges, "'none', 'one' or 'both'")
        require_finite("axial clearance", self.axial_clearance, minimum=0.0)
        if self.flanges == "none":
            require(self.flange_stiffness == 0.0, "flange stiffness", self.flange_stiffness, "none without flanges")
        else:
            require_finite("flange stiffness", self.flange_stiffness, positive=True)

    @property
    def has_axial_stiffness(self) -> bool:
        """Whether the row has flanges."""
        return self.flanges != "none"

    @property
    def thrust_senses(self) -> frozenset[int]:
        """Senses along z of the axial loads that the flanges carry."""
        return frozenset((1, -1)) if self.flanges == "both" else super().thrust_senses

    @property
    def slack_offset(self) -> float:
        """Axial offset beyond which the flange along the row's direction is touched [m]."""
        return 0.5 * self.axial_clearance

    def axial_force(self, axial_offset: float) -> float:
        """Force [N] along the row's direction that moves a centred inner ring by ``axial_offset`` [m]."""
        return self.count * self.flange_stiffness * max(axial_offset - 0.5 * self.axial_clearance, 0.0)


@dataclass(frozen=True)
class TaperedRollerRow(LineContactRow):
    """One row of tapered rollers, which carries radial load and, in its direction, axial load.

    Parameters as of `RollerRow`, without flanges, and

    Parameters
    ----------
    angle : float
        Contact angle α: half the angle of the outer raceway's cone [rad].

    Raises
    ------
    RotorError
        Invalid geometry, such as a contact angle that is not between 0 and a right angle.
    """

    angle: float = math.radians(15.0)

    def __post_init__(self) -> None:
        """Check as of any rollers, and the contact angle."""
        super().__post_init__()
        within = 0.0 < self.angle < RIGHT_ANGLE
        require(within, "contact angle", self.angle, "an angle above 0 and below a right angle, rad")

    @property
    def contact_angle(self) -> float:
        """α, at the outer ring [rad]."""
        return self.angle

    @cached_property
    def roller_angle(self) -> float:
        """β, half the angle of the roller's cone, rad, the root of tan β = (D / D_pw) sin(α − β)."""
        slender = self.roller_diameter / self.pitch_diameter

        def excess(angle: float) -> float:
            return math.tan(angle) - slender * math.sin(self.angle - angle)

        return float(brentq(excess, 0.0, self.angle, xtol=1e-15))

    @property
    def tilt_arms(self) -> FloatArray:
        """l_k = z_m cos α − σ (½ D_pw sin α + ½ D sin β + x_k), σ of the inner ring, (slices,) [m]."""
        foot = 0.5 * self.pitch_diameter * math.sin(self.angle)
        foot += 0.5 * self.roller_diameter * math.sin(self.roller_angle)
        return np.asarray(self.position * math.cos(self.angle) - self.inner_direction * (foot + self.slice_places))

    @property
    def slice_drops(self) -> FloatArray:
        """Profile drop P at each slice, (slices,) [m]: 0.00045 D ln[1 / (1 − (2x/L)²)] if logarithmic.

        ISO/TS 16281:2008, after Nguyen-Schäfer, Computational Tapered and Cylinder Roller Bearings, 2019, Eq. 1.8.
        """
        if self.profile == "straight":
            return np.zeros(self.slices)
        return np.asarray(-0.00045 * self.roller_diameter * np.log1p(-((2.0 * self.slice_places / self.length) ** 2)))


@dataclass(frozen=True)
class SphericalRollerRow(LineContactRow):
    """One of usually two rows of barrel rollers in a spherical outer raceway: no moment about the bearing's centre.

    Parameters as of `RollerRow`, without flanges and profile, and

    Parameters
    ----------
    angle : float
        Contact angle α, rad, the angle of the rollers' middles seen from the bearing's centre.
    osculation : float
        Contour radius of the rollers over that of the raceways, below 1.

    Raises
    ------
    RotorError
        Invalid geometry.
    """

    angle: float = math.radians(10.0)
    osculation: float = 0.98

    def __post_init__(self) -> None:
        """Check as of any rollers, and contact angle and osculation."""
        super().__post_init__()
        within = 0.0 <= self.angle < RIGHT_ANGLE
        require(within, "contact angle", self.angle, "an angle from 0 to below a right angle, rad")
        require(0.0 < self.osculation < 1.0, "osculation", self.osculation, "a number above 0 and below 1")

    @property
    def contact_angle(self) -> float:
        """α [rad]."""
        return self.angle

    @property
    def tilt_arms(self) -> FloatArray:
        """l_k = z_m cos α, (slices,) [m]."""
        return np.full(self.slices, self.position * math.cos(self.angle))

    @property
    def raceway_radius(self) -> float:
        """Radius R of the outer sphere, and of the contour of both raceways [m]."""
        return 0.5 * self.pitch_diameter / math.cos(self.angle) + 0.5 * self.roller_diameter

    @property
    def slice_drops(self) -> FloatArray:
        """Profile drop P = x²/2 (1/r − 1/R) at each slice, (slices,) [m]."""
        return np.asarray(0.5 * self.slice_places**2 * (1.0 / self.osculation - 1.0) / self.raceway_radius)
