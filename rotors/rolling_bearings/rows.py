"""Ball and roller rows of a rolling bearing, by their geometry: elements, grooves, raceways and contact constants.

The elements of a row must fit side by side on the pitch circle.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from rotors.errors import require, require_count, require_finite
from rotors.rolling_bearings.hertz import STEEL, ContactElasticity, PointContact, in_series, point_contact


def require_space(what: str, count: int, diameter: float, pitch_diameter: float) -> None:
    """Raise `RotorError` unless three or more elements fit side by side on the pitch circle; diameters in m."""
    require_count(f"count of {what}s", count)
    require(count >= 3, f"count of {what}s", count, "three or more")
    require_finite(f"{what} diameter", diameter, positive=True)
    require_finite("pitch diameter", pitch_diameter, positive=True)
    room = pitch_diameter * math.sin(math.pi / count)
    require(diameter < room, f"{what} diameter", diameter, f"less than {room:g} m, the room that {count} {what}s have")


RIGHT_ANGLE = math.pi / 2.0


@dataclass(frozen=True)
class BallRow:
    """One row of balls between two grooves.

    Parameters
    ----------
    count
        Balls, three or more.
    ball_diameter, pitch_diameter
        D and the diameter of the balls' centres, m.
    contact_angle
        Nominal, without clearance, rad; 0 for deep grooves.
    inner_groove, outer_groove
        Groove radius over ball diameter, above 0.5.
    clearance
        Diametral, m; negative is an interference.
    axial_offset
        Axial displacement of the inner groove at assembly along the row's direction, m: a preload against another row.
    position
        Of the balls' centres from the bearing's centre along z, m.
    direction
        1 or −1.
    groove_limits
        Contact angles between which there is a groove, in the row's direction, rad: its shoulders.
    elasticity
        Steel unless given.

    Raises
    ------
    RotorError
        Invalid geometry, such as balls that do not fit on the pitch circle.
    """

    count: int
    ball_diameter: float
    pitch_diameter: float
    contact_angle: float = 0.0
    inner_groove: float = 0.52
    outer_groove: float = 0.53
    clearance: float = 0.0
    axial_offset: float = 0.0
    position: float = 0.0
    direction: int = 1
    groove_limits: tuple[float, float] = (-RIGHT_ANGLE, RIGHT_ANGLE)
    elasticity: ContactElasticity = STEEL

    def __post_init__(self) -> None:
        """Check that the balls fit on the pitch circle, and angles, grooves, clearance and direction."""
        require_space("ball", self.count, self.ball_diameter, self.pitch_diameter)
        within = 0.0 <= self.contact_angle < RIGHT_ANGLE
        require(within, "contact angle", self.contact_angle, "an angle from 0 to below a right angle, rad")
        for what in ("inner_groove", "outer_groove"):
            ratio = getattr(self, what)
            require(0.5 < ratio <= 1.0, what, ratio, "a groove radius over 0.5 and up to 1 of the ball's diameter")
        for what in ("clearance", "axial_offset", "position"):
            require_finite(what.replace("_", " "), getattr(self, what))
        widest = 2.0 * self.groove_distance * math.cos(self.contact_angle)
        require(
            self.clearance < widest, "clearance", self.clearance, f"less than {widest:g} m, which its grooves leave"
        )
        require(self.direction in (1, -1), "direction of a row", self.direction, "1 or -1")
        low, high = self.groove_limits
        ordered = -RIGHT_ANGLE <= low <= self.contact_angle <= high <= RIGHT_ANGLE
        require(
            ordered, "groove limits", self.groove_limits, "two angles within right angles, around the contact angle"
        )

    @property
    def element_diameter(self) -> float:
        """Of the balls, m."""
        return self.ball_diameter

    @property
    def groove_distance(self) -> float:
        """A: between the centres of the grooves' curvature with a ball that just touches both, m."""
        return (self.inner_groove + self.outer_groove - 1.0) * self.ball_diameter

    @property
    def groove_offset(self) -> tuple[float, float]:
        """v₀ = (A cos α − s/2, σ (A sin α + e)): from the outer to the inner groove's centre, radial and axial, m."""
        radial = self.groove_distance * math.cos(self.contact_angle) - 0.5 * self.clearance
        axial = self.groove_distance * math.sin(self.contact_angle) + self.axial_offset
        return radial, self.direction * axial

    @property
    def groove_excess(self) -> float:
        """|v₀|² − A² by its terms, m²: |v₀| − A itself would lose the digits that A has and the approach has not."""
        distance, offset, angle = self.groove_distance, self.axial_offset, self.contact_angle
        radial = 0.25 * self.clearance**2 - distance * self.clearance * math.cos(angle)
        return radial + 2.0 * distance * offset * math.sin(angle) + offset**2

    @property
    def inner_groove_centre(self) -> tuple[float, float]:
        """Radius of the inner groove's centres of curvature, and their place along z, m."""
        arm = (self.inner_groove - 0.5) * self.ball_diameter
        radius = 0.5 * self.pitch_diameter + arm * math.cos(self.contact_angle)
        return radius, self.position + self.direction * arm * math.sin(self.contact_angle)

    def cage_speed(self, speed: float) -> float:
        """Speed of the cage with the inner ring turning at ``speed`` and the outer at rest, ½ (1 − γ) Ω, rad/s.

        γ = D cos α / D_pw, of pure rolling at the nominal contact angle (Harris and Kotzalas 2006).
        """
        return 0.5 * (1.0 - self._gamma) * speed

    def facing(self, direction: int) -> "BallRow":
        """Return the same row with another direction."""
        return replace(self, direction=direction)

    @property
    def free_contact_angle(self) -> float:
        """Contact angle after the inner ring has taken up the clearance along the row's direction, rad."""
        radial = math.cos(self.contact_angle) - 0.5 * self.clearance / self.groove_distance
        return math.acos(min(radial, 1.0))

    @cached_property
    def inner_contact(self) -> PointContact:
        """A ball in the inner groove: curvatures 2/D and γ/(1 − γ) · 2/D along, 2/D and −1/(f D) across."""
        return self._contact(self.inner_groove, self._gamma / (1.0 - self._gamma))

    @cached_property
    def outer_contact(self) -> PointContact:
        """A ball in the outer groove: curvatures 2/D and −γ/(1 + γ) · 2/D along, 2/D and −1/(f D) across."""
        return self._contact(self.outer_groove, -self._gamma / (1.0 + self._gamma))

    @cached_property
    def stiffness(self) -> float:
        """Of one ball between both grooves, Q = K δ^{3/2}, N/m^{3/2}."""
        return in_series(self.inner_contact, self.outer_contact)

    def centrifugal_force(self, speed: float) -> float:
        """On one ball with the inner ring turning at ``speed`` (rad/s) and the outer at rest, N.

        m (D_pw / 2) ω² with the cage's speed ω (Harris and Kotzalas 2006).
        """
        mass = self.elasticity.element_density * math.pi / 6.0 * self.ball_diameter**3
        return mass * 0.5 * self.pitch_diameter * self.cage_speed(speed) ** 2

    def axial_force(self, axial_offset: float) -> float:
        """Force (N) along the row's direction that moves a centred inner ring by ``axial_offset`` (m)."""
        angle = self.contact_angle
        radial = self.groove_distance * math.cos(angle) - 0.5 * self.clearance
        axial = self.groove_distance * math.sin(angle) + axial_offset
        distance = math.hypot(radial, axial)
        approach = max(distance - self.groove_distance, 0.0)
        return float(self.count * self.stiffness * approach**1.5 * axial / distance)

    @property
    def _gamma(self) -> float:
        return self.ball_diameter * math.cos(self.contact_angle) / self.pitch_diameter

    def _contact(self, groove: float, along: float) -> PointContact:
        across = (2.0 - 1.0 / groove) / self.ball_diameter
        return point_contact(across, 2.0 * (1.0 + along) / self.ball_diameter, self.elasticity.contact_modulus)


FloatArray = npt.NDArray[np.float64]

Profile = Literal["straight", "logarithmic"]
# ISO 16281's line contact of both raceways in series: q = 35 948 L^{8/9} δ^{10/9} in N and mm.
_PALMGREN_STEEL = 35948.0 * 1000.0 ** (8.0 / 9.0) * 1000.0 ** (10.0 / 9.0)


@dataclass(frozen=True)
class RollerRow:
    """One row of cylindrical rollers, which carry no axial load.

    Parameters
    ----------
    count
        Rollers, three or more.
    roller_diameter, length, pitch_diameter
        D, the effective length L of contact and the diameter of the rollers' centres, m.
    clearance
        Diametral, m; negative is an interference.
    profile
        ``"straight"``, or ``"logarithmic"`` as ISO 16281 takes it where nothing else is known.
    slices
        Number of laminae of a roller; ISO 16281 requires 30 or more.
    position
        Of the rollers' middles from the bearing's centre along z, m.
    elasticity
        Steel unless given.

    Raises
    ------
    RotorError
        Invalid geometry, such as rollers that do not fit on the pitch circle.
    """

    count: int
    roller_diameter: float
    length: float
    pitch_diameter: float
    clearance: float = 0.0
    profile: Profile = "logarithmic"
    slices: int = 31
    position: float = 0.0
    elasticity: ContactElasticity = STEEL

    def __post_init__(self) -> None:
        """Check that the rollers fit on the pitch circle, and length, slices, profile and clearance."""
        require_space("roller", self.count, self.roller_diameter, self.pitch_diameter)
        require_finite("roller length", self.length, positive=True)
        require_count("count of slices", self.slices)
        known = self.profile in ("straight", "logarithmic")
        require(known, "roller profile", self.profile, "'straight' or 'logarithmic'")
        for what in ("clearance", "position"):
            require_finite(what, getattr(self, what))

    @property
    def element_diameter(self) -> float:
        """Of the rollers, m."""
        return self.roller_diameter

    def cage_speed(self, speed: float) -> float:
        """Speed of the cage with the inner ring turning at ``speed`` and the outer at rest, ½ (1 − D/D_pw) Ω, rad/s."""
        return 0.5 * (1.0 - self.roller_diameter / self.pitch_diameter) * speed

    @property
    def stiffness(self) -> float:
        """Contact constant c of one straight roller between both raceways, Q = c δ^{10/9}, N/m^{10/9}.

        35 948 L^{8/9} in N and mm (Palmgren; ISO 16281), for the steel that `ContactElasticity` holds by default, and
        in proportion to E* for others: Palmgren's δ goes as (1/E*)^{0.9}.
        """
        relative = self.elasticity.contact_modulus / STEEL.contact_modulus
        return float(_PALMGREN_STEEL * self.length ** (8.0 / 9.0) * relative)

    @property
    def slice_places(self) -> FloatArray:
        """Middles of the slices from the roller's middle, (slices,), m."""
        return self.length * ((np.arange(self.slices) + 0.5) / self.slices - 0.5)

    @property
    def slice_drops(self) -> FloatArray:
        """Profile drop P at each slice, (slices,), m.

        ISO 16281: P = 0.00035 D ln[1 / (1 − (2x/L)²)] for L ≤ 2.5 D; for longer rollers the middle is straight and
        P = 0.0005 D ln[1 / (1 − ((2|x| − L + 2.5 D) / 2.5 D)²)] at its ends.
        """
        if self.profile == "straight":
            return np.zeros(self.slices)
        x, span = np.abs(self.slice_places), 2.5 * self.roller_diameter
        if self.length <= span:
            return np.asarray(-0.00035 * self.roller_diameter * np.log1p(-((2.0 * x / self.length) ** 2)))
        into_end = np.maximum(2.0 * x - self.length + span, 0.0) / span
        return np.asarray(-0.0005 * self.roller_diameter * np.log1p(-(into_end**2)))
