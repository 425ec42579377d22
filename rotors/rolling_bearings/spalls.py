r"""Spalls of rolling bearings: material that broke out of a raceway or of an element.

Over a spall of length L along the rolling direction a rolling element is carried by its edges. In the plane of rolling
an edge at the radius p of the damaged body stands at the angle a from the line of centres, and touches the other body,
of radius s. Both bodies then are closer by

    d(a) = p (1 − cos a) + s − sign(s) √(s² − p² sin² a)

than two sound ones that touch, radii positive where convex and negative of the concave outer raceway. At an angle φ of
the spall's middle from the line of centres the nearer edge carries, a = L / (2 |p|) − |φ|; the floor of the spall
carries where that lets the element touch it, d ≤ depth. At the edges d and its slope are zero; in the middle, where the
element leaves one edge and strikes the other, the slope changes its sign.

A raceway of contact radius R and contact angle α is a cone, of the radius R / cos α in the plane of rolling, so that a
turns by cos α of what φ does. A spall of an element turns with it, ½ (D_pw / D) (1 − γ²) Ω against the cage, and
meets both raceways in each turn. The contact is a line or a point: that Hertz's contact has a length of its own, which
bridges the edges a little earlier, is left out, as is the element's inertia.

A cage with a worn or broken pocket lets an element stand out of its place: the bearing yields unevenly as the cage
carries the gap through the loaded zone, once in each of its turns.
"""

import math
from dataclasses import dataclass
from typing import Literal

from gearwhine.rotors.errors import require, require_finite
from gearwhine.rotors.rolling_bearings.frequencies import frequencies_in_seat, pressed_azimuth
from gearwhine.rotors.rolling_bearings.ratings import Row
from gearwhine.rotors.rolling_bearings.roller_rows import LineContactRow
from gearwhine.rotors.rolling_bearings.rolling_bearing import RollingBearing
from gearwhine.rotors.rolling_bearings.slip import NO_SLIP, CageSlip

Place = Literal["outer", "inner", "element"]
_LONGEST = 0.25  # spall over the circumference of the damaged body


@dataclass(frozen=True)
class RollingSpall:
    """A spall of a raceway or of an element.

    Parameters
    ----------
    on : {"outer", "inner", "element"}
        Damaged raceway, or a rolling element.
    length : float
        Length along the rolling direction [m].
    depth : float
        Depth of its floor under the surface [m].
    azimuth : float
        Azimuth of its middle at t = 0 [rad]: on a ring from x towards y, on an element from the line to the inner
        raceway, in the sense in which it turns.
    row : int
        Number of the row, from 0.
    element : int
        Number of the damaged element, from 0 at the cage's angle, counted towards y.
    width : float, optional
        Width across the rolling direction of a spall under the middle of rollers [m]; by default all of their length.
        Of balls it is that of their contact.

    Raises
    ------
    RotorError
        A length or depth that is not positive, or numbers below 0.
    """

    on: Place
    length: float
    depth: float
    azimuth: float = 0.0
    row: int = 0
    element: int = 0
    width: float | None = None

    def __post_init__(self) -> None:
        """Check sizes and numbers."""
        require(self.on in ("outer", "inner", "element"), "on of a spall", self.on, "'outer', 'inner' or 'element'")
        require_finite("length of a spall", self.length, positive=True)
        require_finite("depth of a spall", self.depth, positive=True)
        require_finite("azimuth of a spall", self.azimuth)
        if self.width is not None:
            require_finite("width of a spall", self.width, positive=True)
        for name in ("row", "element"):
            place = getattr(self, name)
            is_number = isinstance(place, int) and place >= 0
            require(is_number, f"{name} of a spall", place, "a whole number from 0")

    @property
    def part(self) -> str:
        """Damaged part."""
        return "rolling element" if self.on == "element" else f"{self.on} raceway"

    def tone(self, row: Row, speed: float, slip: CageSlip = NO_SLIP) -> float:
        """Frequency at which the spall of a row is struck [rad/s], with one ring turning at ``speed`` in its seat."""
        # A cage that lags behind is passed more often by the ring that turns, and less often by the one at rest.
        if self.on != "element" and (self.on == "outer") == row.outer_turns:
            return row.count * abs(speed - (1.0 - slip.mean) * row.cage_speed(speed))
        return (1.0 - slip.mean) * frequencies_in_seat(row, speed).named()[self.part]


@dataclass(frozen=True)
class CageFault:
    """A pocket of the cage that is worn or broken, so that its element stands out of its place.

    Parameters
    ----------
    length : float
        Way by which the element is ahead of its place along the pitch circle [m].
    row : int
        Number of the row, from 0.
    element : int
        Number of the element, from 0 at the cage's angle, counted towards y.

    Raises
    ------
    RotorError
        A length that is not positive, or numbers below 0.
    """

    length: float
    row: int = 0
    element: int = 0

    def __post_init__(self) -> None:
        """Check length and numbers."""
        require_finite("length of a cage's fault", self.length, positive=True)
        for name in ("row", "element"):
            place = getattr(self, name)
            is_number = isinstance(place, int) and place >= 0
            require(is_number, f"{name} of a cage's fault", place, "a whole number from 0")

    @property
    def part(self) -> str:
        """Damaged part."""
        return "cage"

    def tone(self, row: Row, speed: float, slip: CageSlip = NO_SLIP) -> float:
        """Frequency of the cage of a row [rad/s], with one ring turning at ``speed`` in its seat."""
        return (1.0 - slip.mean) * abs(row.cage_speed(speed))

    def shift(self, bearing: RollingBearing) -> float:
        """Angle by which the element is ahead of its place [rad].

        Raises
        ------
        RotorError
            A row or an element that the bearing does not have, or elements that would touch.
        """
        row = _faulty_row(self, bearing, "a cage's fault")
        room = math.pi * row.pitch_diameter / row.count - row.element_diameter
        expected = f"less than {room:.4g} m, the gap to the next element"
        require(self.length < room, f"length of a cage's fault of {bearing.name}", self.length, expected)
        return 2.0 * self.length / row.pitch_diameter


BearingDamage = RollingSpall | CageFault


def _faulty_row(fault: BearingDamage, bearing: RollingBearing, kind: str) -> Row:
    """Return the damaged row; the bearing has to have it, and its element."""
    rows = bearing.rows
    require(fault.row < len(rows), f"row of {kind} of {bearing.name}", fault.row, f"one of {len(rows)}, from 0")
    row = rows[fault.row]
    expected = f"one of {row.count}, from 0"
    require(fault.element < row.count, f"element of {kind} of {bearing.name}", fault.element, expected)
    return row


@dataclass(frozen=True)
class SpallContact:
    """One raceway's contact with a spall, as the time-stepping kernels take it.

    Attributes
    ----------
    element : int
        Number of the damaged element; -1 of a raceway, which all elements pass.
    azimuth, rate : float
        Angle of the spall at t = 0 [rad], and its rate [rad/s]: against the seat, by
        :func:`gearwhine.rotors.rolling_bearings.frequencies.pressed_azimuth`; of an element against its line to the
        raceway.
    half : float
        Half the angle of the spall [rad].
    damaged, other : float
        Radii of the damaged and of the other body in the plane of rolling [m], negative where concave.
    slope : float
        Angle a over the angle of the spall: cos α of a raceway, 1 of an element.
    depth, share : float
        Depth [m], and width of the spall over the length of the rollers, at most 1.
    """

    element: int
    azimuth: float
    rate: float
    half: float
    damaged: float
    other: float
    slope: float
    depth: float
    share: float

    def drop(self, angle: float) -> float:
        """Return by how much the bodies are closer with the spall's middle at an angle from the line of centres [m]."""
        inside = self.half - abs(math.remainder(angle, 2.0 * math.pi))
        if inside <= 0.0:
            return 0.0
        edge = self.slope * inside
        across = self.damaged * math.sin(edge)
        if abs(across) >= abs(self.other):
            return self.depth
        root = math.copysign(math.sqrt(self.other**2 - across**2), self.other)
        return min(self.depth, 2.0 * self.damaged * math.sin(0.5 * edge) ** 2 + across**2 / (self.other + root))


def spall_contacts(spall: RollingSpall, bearing: RollingBearing, speed: float) -> tuple[SpallContact, ...]:
    """Return the contacts of a spall: one of a raceway, two of an element.

    Parameters
    ----------
    spall : RollingSpall
    bearing : RollingBearing
    speed : float
        Signed speed of the ring that turns, relative to the seat [rad/s].

    Raises
    ------
    RotorError
        A row or an element that the bearing does not have, or a spall as long as a quarter of its body's circumference.
    """
    row = _faulty_row(spall, bearing, "a spall")
    radius, cosine = 0.5 * row.element_diameter, math.cos(row.contact_angle)
    share = 1.0
    if spall.width is not None:
        require(isinstance(row, LineContactRow), f"width of a spall of {bearing.name}", spall.width, "none under balls")
        share = min(spall.width / row.length, 1.0) if isinstance(row, LineContactRow) else 1.0
    middle = 0.5 * row.pitch_diameter
    # Radii of the raceways where the elements touch them, and in the plane of rolling.
    inner, outer = middle - radius * cosine, middle + radius * cosine
    curvature = {"inner": inner / cosine, "outer": -outer / cosine}
    contact = {"inner": inner, "outer": outer, "element": radius}[spall.on]
    longest = _LONGEST * 2.0 * math.pi * contact
    expected = f"at most {longest:.4g} m, a quarter of the circumference of the damaged body"
    require(spall.length <= longest, f"length of a spall of {bearing.name}", spall.length, expected)
    half = 0.5 * spall.length / contact
    if spall.on != "element":
        rate = speed if (spall.on == "outer") == row.outer_turns else 0.0
        damaged, azimuth = curvature[spall.on], pressed_azimuth(row, spall.azimuth)
        return (SpallContact(-1, azimuth, rate, half, damaged, radius, cosine, spall.depth, share),)
    spin, depth = frequencies_in_seat(row, speed).spin, spall.depth
    return tuple(
        SpallContact(spall.element, spall.azimuth + turned, spin, half, radius, curvature[ring], 1.0, depth, share)
        for ring, turned in (("inner", 0.0), ("outer", math.pi))
    )


def require_possible(fault: BearingDamage, bearing: RollingBearing) -> None:
    """Require that a bearing can have a fault.

    Raises
    ------
    RotorError
    """
    if isinstance(fault, CageFault):
        fault.shift(bearing)
    else:
        spall_contacts(fault, bearing, 0.0)
