"""Rolling bearing: rows of balls or rollers that share their rings, arrangements, and estimates from a catalogue.

The inner ring moves by q = (x, y, z, rotation about x, rotation about y) against the outer, taken at the bearing's
centre. A row's own direction is +1 where pushing the inner ring towards +z loads its contacts, −1 where −z does.
Double-row and paired ball bearings stand back to back, face to face or in tandem.

Catalogues print bore d, outer diameter D and width B, but not the internal geometry, which is estimated. The pitch
circle lies near the middle, (d + D)/2. Design practice (Changsen 1991; the bounds of Gupta, Tiwari and Nair, Mechanism
and Machine Theory 42, 2007) makes a ball 0.24 to 0.35 of D − d, and lets as many into a deep-groove bearing as an arc
of 186° or so takes when the rings are pushed apart (Conrad), Z = 1 + φ / (2 asin(D_w / D_pw)). Here: 0.3 and 186°,
which meets sizes 6205, 6208 and 6305 to a ball and their printed static ratings to 9 %. Bearings assembled with a
counterbore fill their pitch circle but for the cage: Z balls or rollers with 15 % or 20 % of air between them. A
cylindrical roller has 0.275 (D − d) and a contact as long as 0.55 B, which meets the static ratings of NU 205, 208 and
210 to 5 %. Grooves are .52 and .53 of the ball, ISO 281's limits.

All of this is an estimate. Stiffness goes as Z^{2/3} D_w^{1/3} (Krämer), so a ball too many of nine moves it by 7 %.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from scipy.optimize import brentq

from rotors.errors import RotorError, require, require_finite
from rotors.rolling_bearings.roller_rows import LineContactRow, RollerRow
from rotors.rolling_bearings.rows import BallRow

Row = BallRow | LineContactRow


@dataclass(frozen=True)
class RollingBearing:
    """A rolling bearing: one row or several that share their rings.

    Parameters
    ----------
    rows
        At least one.
    axial_preload
        A constant force of a spring on the inner ring along z, N.
    name
        Name in messages.

    Raises
    ------
    RotorError
        No rows, a preload that is not finite, or one on rollers without flanges, which have no axial stiffness.
    """

    rows: Sequence[Row]
    axial_preload: float = 0.0
    name: str = "rolling bearing"

    def __post_init__(self) -> None:
        """Check for at least one row, and that a preloaded bearing has axial stiffness; keep a tuple."""
        object.__setattr__(self, "rows", tuple(self.rows))
        if not self.rows:
            raise RotorError(f"{self.name} has no rows; expected at least one")
        require_finite(f"axial preload of {self.name}", self.axial_preload)
        held = self.axial_preload == 0.0 or self.has_axial_stiffness
        require(
            held,
            f"axial preload of {self.name}",
            self.axial_preload,
            "none: cylindrical rollers carry no axial load without flanges",
        )

    @property
    def force_scale(self) -> float:
        """E* D² of the smallest element, a force far above its capacity, N."""
        return min(row.elasticity.contact_modulus * row.element_diameter**2 for row in self.rows)

    @property
    def largest_element(self) -> float:
        """Largest diameter of an element, m."""
        return max(row.element_diameter for row in self.rows)

    @property
    def has_axial_stiffness(self) -> bool:
        """Whether any row carries an axial load."""
        return any(row.has_axial_stiffness for row in self.rows)

    @property
    def reach(self) -> float:
        """Half the largest pitch diameter, by which rotations are scaled to displacements of the contacts, m."""
        return 0.5 * max(row.pitch_diameter for row in self.rows)


Arrangement = Literal["back to back", "face to face", "tandem"]

# Directions of the left and the right row. Contact lines of (1, −1) run apart towards the axis: stiff against tilting.
_DIRECTIONS: dict[str, tuple[int, int]] = {"back to back": (1, -1), "face to face": (-1, 1), "tandem": (1, 1)}


def paired(
    row: Row, arrangement: Arrangement, spacing: float, *, preload: float = 0.0, name: str = "paired bearing"
) -> RollingBearing:
    """Two equal rows, on the same rings or on rings clamped together.

    Parameters
    ----------
    row
        One of them; its own position and direction are replaced.
    arrangement
        ``"back to back"`` (O: contact lines meet the axis outside the pair), ``"face to face"`` (X: inside) or
        ``"tandem"`` (both carry loads towards +z).
    spacing
        Between the centres of the rows' balls, m.
    preload
        Axial force with which the rows press each other when nothing else loads them, N.

    Raises
    ------
    RotorError
        A spacing that is not positive, a negative preload, or a preload in tandem, where no row opposes it, or of rows
        without axial stiffness.
    """
    known = arrangement in _DIRECTIONS
    require(known, "arrangement", arrangement, f"one of {', '.join(map(repr, _DIRECTIONS))}")
    require_finite("spacing of the rows", spacing, positive=True)
    require_finite("preload of the rows", preload, minimum=0.0)
    left, right = _DIRECTIONS[arrangement]
    opposed = preload == 0.0 or left != right
    require(opposed, "preload of rows in tandem", preload, "none: give the bearing an axial_preload")
    offset = row.axial_offset if preload == 0.0 else preload_offset(row, preload)
    rows = (
        replace(row, position=-0.5 * spacing, direction=left, axial_offset=offset),
        replace(row, position=0.5 * spacing, direction=right, axial_offset=offset),
    )
    return RollingBearing(rows, name=name)


def preload_offset(row: Row, preload: float) -> float:
    """Axial offset (m) at which a centred row presses with the axial force ``preload`` (N) along its direction.

    The root e of the row's `axial_force`, which grows with e: of balls, with v = (A cos α − s/2, A sin α + e),
    Z K (|v| − A)^{3/2} sin α' = F, sin α' = v_z/|v|; of rollers Z c/n Σ_k δ_k^{10/9} sin α = F.

    Raises
    ------
    RotorError
        A preload that is not positive, or a row that carries no axial load.
    """
    require_finite("preload of a row", preload, positive=True)
    require(row.has_axial_stiffness, "preload of a row", preload, "none: its rollers carry no axial load")
    lowest, scale = row.slack_offset, 0.01 * row.element_diameter
    width = scale
    while row.axial_force(lowest + width) < preload:
        width *= 2.0
    return float(
        brentq(lambda e: row.axial_force(e) - preload, lowest, lowest + width, xtol=1e-14 * scale, rtol=8.9e-16)
    )


CatalogueType = Literal["deep-groove", "angular-contact", "cylindrical-roller"]

_BALL, _ROLLER = 0.3, 0.275
_CONRAD = math.radians(186.0)
_BALL_PITCH, _ROLLER_PITCH = 1.15, 1.2
_ROLLER_LENGTH = 0.55
_ANGULAR_CONTACT = math.radians(40.0)
# ISO 76: pressure at which the worst element is pressed in by 1e-4 of its diameter.
_RATING_PRESSURE = 4.2e9


def catalogue_row(
    kind: CatalogueType,
    bore: float,
    outer_diameter: float,
    width: float,
    *,
    contact_angle: float | None = None,
    clearance: float = 0.0,
) -> Row:
    """Estimate the internal geometry of a bearing from its main dimensions; the module gives the sources.

    Parameters
    ----------
    kind
        ``"deep-groove"``, ``"angular-contact"`` or ``"cylindrical-roller"``.
    bore, outer_diameter, width
        m.
    contact_angle
        Of angular-contact balls, rad; 40° where none is given. Others have none.
    clearance
        Diametral clearance in operation, m; catalogues print the larger value before mounting.

    Raises
    ------
    RotorError
        Impossible dimensions, or a contact angle that does not fit the type.
    """
    known = kind in ("deep-groove", "angular-contact", "cylindrical-roller")
    require(known, "type of bearing", kind, "'deep-groove', 'angular-contact' or 'cylindrical-roller'")
    require_finite("bore", bore, positive=True)
    require_finite("bearing width", width, positive=True)
    require_finite("outer diameter", outer_diameter)
    height = outer_diameter - bore
    require(height > 0.0, "outer diameter", outer_diameter, f"more than the bore, {bore:g} m")
    pitch = 0.5 * (bore + outer_diameter)
    needed = (_ROLLER if kind == "cylindrical-roller" else _BALL) * height
    fits = kind == "cylindrical-roller" or needed <= width
    require(fits, "bearing width", width, f"at least {needed:g} m, the diameter of a ball between these rings")
    angled = contact_angle is None or contact_angle == 0.0 or kind == "angular-contact"
    require(angled, f"contact angle of a {kind} bearing", contact_angle, "none: only angular-contact bearings have one")
    if kind == "cylindrical-roller":
        roller = _ROLLER * height
        count = _filling(pitch, roller, _ROLLER_PITCH)
        return RollerRow(count, roller, _ROLLER_LENGTH * width, pitch, clearance)
    ball = _BALL * height
    if kind == "deep-groove":
        return BallRow(_conrad(pitch, ball), ball, pitch, clearance=clearance)
    angle = _ANGULAR_CONTACT if contact_angle is None else contact_angle
    # The outer groove has one shoulder only, so balls touch it on the side of their contact angle.
    limits = (0.0, 0.5 * math.pi)
    return BallRow(_filling(pitch, ball, _BALL_PITCH), ball, pitch, angle, clearance=clearance, groove_limits=limits)


def static_rating(row: Row) -> float:
    """Radial static load rating C₀ (N) of one row after ISO 76, for a check of a row against a catalogue.

    Balls: the load under which Hertz's greatest pressure reaches 4 200 MPa at the inner ring, where the worst of Z
    balls carries 5/(Z cos α) of a radial load. Rollers: 44 (1 − γ) Z L D cos α, in N and mm.
    """
    if isinstance(row, BallRow):
        return row.inner_contact.load_at_pressure(_RATING_PRESSURE) * row.count * math.cos(row.contact_angle) / 5.0
    across = row.count * row.length * row.roller_diameter * math.cos(row.contact_angle)
    return 44e6 * (1.0 - row.gamma) * across


def _conrad(pitch: float, ball: float) -> int:
    return max(round(1.0 + _CONRAD / (2.0 * math.asin(ball / pitch))), 3)


def _filling(pitch: float, diameter: float, per_element: float) -> int:
    return max(math.floor(math.pi * pitch / (diameter * per_element)), 3)
