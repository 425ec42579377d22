"""Characteristic frequencies of rolling bearings: cage, passing of the elements over either raceway, and their spin.

With rings that turn at Ω_i and Ω_o and elements that roll without sliding, γ = D cos α / D_pw (Harris and Kotzalas,
Rolling Bearing Analysis, 5th ed., Essential Concepts, chapter 10):

    cage            ½ [(1 − γ) Ω_i + (1 + γ) Ω_o]                  fundamental train, FTF
    outer raceway   ½ Z (1 − γ) |Ω_i − Ω_o|                        ball pass, BPFO
    inner raceway   ½ Z (1 + γ) |Ω_i − Ω_o|                        BPFI
    element         ½ (D_pw/D) (1 − γ²) |Ω_i − Ω_o|                spin about its own axis, BSF

α is the contact angle, nominal or under load, and of tapered rollers the angle of their axis. A damaged element strikes
once on either raceway in each turn of its own, at 2 BSF.
"""

import math
from dataclasses import dataclass

from gearwhine.rotors.errors import require_finite
from gearwhine.rotors.rolling_bearings.ratings import Row
from gearwhine.rotors.rolling_bearings.rows import BallRow


@dataclass(frozen=True)
class CharacteristicFrequencies:
    """Angular frequencies of a row [rad/s].

    Attributes
    ----------
    cage : float
        Cage frequency FTF, with the sign of the rotation.
    outer_pass, inner_pass : float
        Frequencies BPFO and BPFI at which elements pass a point of the raceway.
    spin : float
        Spin BSF of an element about its own axis.
    """

    cage: float
    outer_pass: float
    inner_pass: float
    spin: float

    def named(self) -> dict[str, float]:
        """Return positive frequencies by their usual names, with the strikes of a damaged element [rad/s]."""
        return {
            "cage": abs(self.cage),
            "outer raceway": self.outer_pass,
            "inner raceway": self.inner_pass,
            "rolling element": 2.0 * self.spin,
        }


def characteristic_frequencies(
    row: Row, speed: float, *, outer_speed: float = 0.0, contact_angle: float | None = None
) -> CharacteristicFrequencies:
    """Characteristic frequencies of a row.

    Parameters
    ----------
    row : Row
        Row, described by its geometry.
    speed, outer_speed : float
        Signed speeds of the inner and of the outer ring [rad/s].
    contact_angle : float, optional
        Contact angle of balls under load [rad]; by default the nominal one.

    Raises
    ------
    RotorError
        A speed or an angle that is not finite.
    """
    require_finite("speed of the inner ring", speed)
    require_finite("speed of the outer ring", outer_speed)
    gamma = row.gamma
    if contact_angle is not None:
        require_finite("contact angle", contact_angle)
        if isinstance(row, BallRow):
            gamma = row.ball_diameter * math.cos(contact_angle) / row.pitch_diameter
    between = abs(speed - outer_speed)
    return CharacteristicFrequencies(
        cage=0.5 * ((1.0 - gamma) * speed + (1.0 + gamma) * outer_speed),
        outer_pass=0.5 * row.count * (1.0 - gamma) * between,
        inner_pass=0.5 * row.count * (1.0 + gamma) * between,
        spin=0.5 * row.pitch_diameter / row.element_diameter * (1.0 - gamma**2) * between,
    )


def pressed_azimuth(row: Row, azimuth: float) -> float:
    """Azimuth by which the displacement of the ring that turns presses the elements at an azimuth together [rad].

    An inner ring that moves along x presses the elements at x. An outer one, as of a planet, presses those opposite, on
    its pin.
    """
    return azimuth + math.pi if row.outer_turns else azimuth


def frequencies_in_seat(row: Row, speed: float) -> CharacteristicFrequencies:
    """Characteristic frequencies of a row with one ring at rest in its seat.

    Parameters
    ----------
    row : Row
        By its ``outer_turns`` the inner or the outer ring turns.
    speed : float
        Signed speed of that ring, relative to the seat, as of a planet to its carrier [rad/s].
    """
    inner, outer = (0.0, speed) if row.outer_turns else (speed, 0.0)
    return characteristic_frequencies(row, inner, outer_speed=outer)
