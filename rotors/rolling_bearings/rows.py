"""Rows of balls of a rolling bearing, by their geometry: balls, grooves and contact constants.

The elements of a row must fit side by side on the pitch circle. Balls of a `BallRow` touch one arc of either ring,
those of a `FourPointRow` up to two: each of its rings is ground with two arcs whose centres are a shim apart, a Gothic
arch. In a self-aligning bearing the outer groove is a sphere about the bearing's centre (`spherical_groove`).
"""

import math
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Self

from gearwhine.rotors.errors import require, require_count, require_finite
from gearwhine.rotors.rolling_bearings.hertz import STEEL, ContactElasticity, PointContact, in_series, point_contact


def require_space(label: str, count: int, diameter: float, pitch_diameter: float) -> None:
    """Raise `RotorError` unless three or more elements fit side by side on the pitch circle; diameters in m."""
    require_count(f"count of {label}s", count)
    require(count >= 3, f"count of {label}s", count, "three or more")
    require_finite(f"{label} diameter", diameter, positive=True)
    require_finite("pitch diameter", pitch_diameter, positive=True)
    room = pitch_diameter * math.sin(math.pi / count)
    require(
        diameter < room, f"{label} diameter", diameter, f"less than {room:g} m, the room that {count} {label}s have"
    )


RIGHT_ANGLE = math.pi / 2.0


@dataclass(frozen=True)
class BallRow:
    """One row of balls between two grooves.

    Parameters
    ----------
    count : int
        Number of balls, three or more.
    ball_diameter, pitch_diameter : float
        Diameter D of the balls, and diameter of the circle of their centres [m].
    contact_angle : float
        Nominal contact angle, without clearance [rad]; 0 for deep grooves.
    inner_groove, outer_groove : float
        Groove radius over ball diameter, above 0.5 and up to 1; of an outer ring up to `spherical_groove`.
    clearance : float
        Diametral clearance [m]; negative is an interference.
    axial_offset : float
        Axial displacement of the inner groove at assembly along the row's direction [m]: a preload against another row.
    position : float
        Position of the balls' centres from the bearing's centre along z [m].
    direction : int
        Direction of the row, 1 or −1.
    groove_limits : tuple of float
        Contact angles between which there is a groove, in the row's direction [rad]: its shoulders.
    elasticity : ContactElasticity
        Elasticity of the contacts; steel unless given.
    estimated : bool
        Whether the geometry is an estimate (`gearwhine.rotors.rolling_bearings.catalogue`).
    outer_turns : bool
        Whether the outer ring turns, as in a planet on its pin, and the inner one is at rest.

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
    estimated: bool = False
    outer_turns: bool = False

    def __post_init__(self) -> None:
        """Check that the balls fit on the pitch circle, and angles, grooves, clearance and direction."""
        require_space("ball", self.count, self.ball_diameter, self.pitch_diameter)
        within = 0.0 <= self.contact_angle < RIGHT_ANGLE
        require(within, "contact angle", self.contact_angle, "an angle from 0 to below a right angle, rad")
        widest = max(1.0, 1.001 * spherical_groove(self.ball_diameter, self.pitch_diameter, self.contact_angle))
        for attribute, most in (("inner_groove", 1.0), ("outer_groove", widest)):
            ratio = getattr(self, attribute)
            require(
                0.5 < ratio <= most,
                attribute,
                ratio,
                f"a groove radius over 0.5 and up to {most:.4g} of the ball's diameter",
            )
        for attribute in ("clearance", "axial_offset", "position"):
            require_finite(attribute.replace("_", " "), getattr(self, attribute))
        room = 2.0 * self.groove_distance * math.cos(self.contact_angle)
        require(self.clearance < room, "clearance", self.clearance, f"less than {room:g} m, which its grooves leave")
        require(self.direction in (1, -1), "direction of a row", self.direction, "1 or -1")
        low, high = self.groove_limits
        ordered = -RIGHT_ANGLE <= low <= self.contact_angle <= high <= RIGHT_ANGLE
        require(
            ordered, "groove limits", self.groove_limits, "two angles within right angles, around the contact angle"
        )

    @property
    def element_diameter(self) -> float:
        """Diameter of the balls [m]."""
        return self.ball_diameter

    @property
    def width(self) -> float:
        """Width of the balls along the axis [m]."""
        return self.ball_diameter

    @property
    def groove_distance(self) -> float:
        """Distance A of the centres of the grooves' curvature with a ball that just touches both [m]."""
        return (self.inner_groove + self.outer_groove - 1.0) * self.ball_diameter

    @property
    def groove_offset(self) -> tuple[float, float]:
        """v₀ = (A cos α − s/2, σ (A sin α + e)): from the outer to the inner groove's centre, radial and axial [m]."""
        radial = self.groove_distance * math.cos(self.contact_angle) - 0.5 * self.clearance
        axial = self.groove_distance * math.sin(self.contact_angle) + self.axial_offset
        return radial, self.direction * axial

    @property
    def groove_excess(self) -> float:
        """Difference |v₀|² − A² by its terms [m²]: |v₀| − A would lose digits."""
        distance, offset, angle = self.groove_distance, self.axial_offset, self.contact_angle
        radial = 0.25 * self.clearance**2 - distance * self.clearance * math.cos(angle)
        return radial + 2.0 * distance * offset * math.sin(angle) + offset**2

    @property
    def inner_direction(self) -> int:
        """Direction in which a push of the inner ring along z loads the row: opposite where the outer ring turns."""
        return -self.direction if self.outer_turns else self.direction

    @property
    def inner_groove_centre(self) -> tuple[float, float]:
        """Radius of the inner groove's centres of curvature, and their place along z [m].

        The radius is negative where the outer ring turns: it tilts the grooves opposite to what it presses.
        """
        arm = (self.inner_groove - 0.5) * self.ball_diameter
        radius = 0.5 * self.pitch_diameter + arm * math.cos(self.contact_angle)
        place = self.position + self.inner_direction * arm * math.sin(self.contact_angle)
        return -radius if self.outer_turns else radius, place

    @property
    def has_axial_stiffness(self) -> bool:
        """Whether the row carries axial load: always."""
        return True

    @property
    def thrust_senses(self) -> frozenset[int]:
        """Senses along z of the axial loads that the row carries: both without a contact angle, else its direction.

        Balls in angular contact have a shoulder on one side only.
        """
        return frozenset((1, -1)) if self.contact_angle == 0.0 else frozenset((self.direction,))

    @property
    def self_aligning(self) -> bool:
        """Whether the outer groove is the sphere about the bearing's centre."""
        sphere = spherical_groove(self.ball_diameter, self.pitch_diameter, self.contact_angle)
        return self.outer_groove >= 0.999 * sphere

    @property
    def slack_offset(self) -> float:
        """Axial offset at which a centred row carries no axial force [m]."""
        return -self.groove_distance * math.sin(self.contact_angle)

    def cage_speed(self, speed: float) -> float:
        """Speed of the cage with a ring turning at ``speed`` and the other at rest [rad/s].

        ½ (1 − γ) Ω where the inner ring turns, ½ (1 + γ) Ω where the outer one does; γ = D cos α / D_pw, of pure
        rolling at the nominal contact angle (Harris and Kotzalas 2006).
        """
        return 0.5 * (1.0 + self.gamma if self.outer_turns else 1.0 - self.gamma) * speed

    def facing(self, direction: int) -> Self:
        """Return the same row with another direction."""
        return replace(self, direction=direction)

    @cached_property
    def inner_contact(self) -> PointContact:
        """A ball in the inner groove: curvatures 2/D and γ/(1 − γ) · 2/D along, 2/D and −1/(f D) across."""
        return self._contact(self.inner_groove, self.gamma / (1.0 - self.gamma))

    @cached_property
    def outer_contact(self) -> PointContact:
        """A ball in the outer groove: curvatures 2/D and −γ/(1 + γ) · 2/D along, 2/D and −1/(f D) across."""
        return self._contact(self.outer_groove, -self.gamma / (1.0 + self.gamma))

    @cached_property
    def stiffness(self) -> float:
        """Contact constant K of one ball between both grooves, Q = K δ^{3/2} [N/m^{3/2}]."""
        return in_series(self.inner_contact, self.outer_contact)

    def centrifugal_force(self, speed: float) -> float:
        """Centrifugal force on one ball with a ring turning at ``speed`` (in rad/s) and the other at rest [N].

        m (D_pw / 2) ω² with the cage's speed ω (Harris and Kotzalas 2006).
        """
        mass = self.elasticity.element_density * math.pi / 6.0 * self.ball_diameter**3
        return mass * 0.5 * self.pitch_diameter * self.cage_speed(speed) ** 2

    def axial_force(self, axial_offset: float) -> float:
        """Force [N] along the row's direction that moves a centred inner ring by ``axial_offset`` [m]."""
        angle = self.contact_angle
        radial = self.groove_distance * math.cos(angle) - 0.5 * self.clearance
        axial = self.groove_distance * math.sin(angle) + axial_offset
        distance = math.hypot(radial, axial)
        approach = max(distance - self.groove_distance, 0.0)
        return float(self.count * self.stiffness * approach**1.5 * axial / distance)

    @property
    def gamma(self) -> float:
        """γ = D cos α / D_pw."""
        return self.ball_diameter * math.cos(self.contact_angle) / self.pitch_diameter

    def _contact(self, groove: float, along: float) -> PointContact:
        curvatures = (2.0 - 1.0 / groove) / self.ball_diameter, 2.0 * (1.0 + along) / self.ball_diameter
        # A sphere has the same curvature along and across, but for rounding.
        return point_contact(min(curvatures), max(curvatures), self.elasticity.contact_modulus)


def spherical_groove(ball_diameter: float, pitch_diameter: float, contact_angle: float) -> float:
    """Outer groove of a self-aligning bearing, the sphere about its centre: its radius over the ball's diameter.

    The contact lines meet in the centre of the bearing, so the radius is D_pw / (2 cos α) + D/2.
    """
    return 0.5 + 0.5 * pitch_diameter / (ball_diameter * math.cos(contact_angle))


@dataclass(frozen=True)
class FourPointRow(BallRow):
    """One row of balls in four-point contact: either ring has two arcs, and the row carries axial load both ways.

    Parameters as of `BallRow`. ``contact_angle`` is the one at which a ball touches all four arcs without clearance,
    the shim angle; the arcs' centres of a ring are a shim (2f − 1) D sin α apart.

    Raises
    ------
    RotorError
        As `BallRow`, and a contact angle of zero, with which the arcs of a ring are one.
    """

    def __post_init__(self) -> None:
        """Check as of any balls, and that there are two arcs."""
        super().__post_init__()
        require(self.contact_angle > 0.0, "contact angle of four-point balls", self.contact_angle, "more than 0")

    @property
    def thrust_senses(self) -> frozenset[int]:
        """Senses along z of the axial loads that the row carries: both, on either diagonal."""
        return frozenset((1, -1))

    @property
    def arcs(self) -> tuple[BallRow, BallRow]:
        """Rows that the ball makes with the arcs of one diagonal alone: loaded by +z along the row, and by −z."""
        arguments = {field.name: getattr(self, field.name) for field in fields(BallRow)}
        arguments["groove_limits"] = (-RIGHT_ANGLE, RIGHT_ANGLE)
        return BallRow(**arguments), BallRow(
            **arguments | {"direction": -self.direction, "axial_offset": -self.axial_offset}
        )
