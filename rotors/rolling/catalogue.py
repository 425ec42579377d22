"""Internal geometry of a rolling bearing estimated from its catalogue dimensions.

Catalogues print bore d, outer diameter D and width B, but not the internal geometry. The pitch circle lies near the
middle, (d + D)/2. Design practice (Changsen 1991; the bounds of Gupta, Tiwari and Nair, Mechanism and Machine Theory
42, 2007) makes a ball 0.24 to 0.35 of D − d, and lets as many into a deep-groove bearing as an arc of 186° or so takes
when the rings are pushed apart (Conrad), Z = 1 + φ / (2 asin(D_w / D_pw)). Here: 0.3 and 186°, which meets sizes 6205,
6208 and 6305 to a ball and their printed static ratings to 9 %. Bearings assembled with a counterbore fill their pitch
circle but for the cage: Z balls or rollers with 15 % or 20 % of air between them. A cylindrical roller has 0.275 (D −
d) and a contact as long as 0.55 B, which meets the static ratings of NU 205, 208 and 210 to 5 %. Grooves are .52 and
.53 of the ball, ISO 281's limits.

All of this is an estimate. Stiffness goes as Z^{2/3} D_w^{1/3} (Krämer), so a ball too many of nine moves it by 7 %.
"""

import math
from typing import Literal

from rotors.errors import require, require_finite

from .ball_row import BallRow
from .roller_row import RollerRow
from .rolling_bearing import Row

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
    """Internal geometry of a bearing estimated from its main dimensions; the module gives the sources.

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
    balls carries 5/(Z cos α) of a radial load. Rollers: 44 (1 − D/D_pw) Z L D, in N and mm.
    """
    if isinstance(row, BallRow):
        return row.inner_contact.load_at_pressure(_RATING_PRESSURE) * row.count * math.cos(row.contact_angle) / 5.0
    slender = 1.0 - row.roller_diameter / row.pitch_diameter
    return 44e6 * slender * row.count * row.length * row.roller_diameter


def _conrad(pitch: float, ball: float) -> int:
    return max(round(1.0 + _CONRAD / (2.0 * math.asin(ball / pitch))), 3)


def _filling(pitch: float, diameter: float, per_element: float) -> int:
    return max(math.floor(math.pi * pitch / (diameter * per_element)), 3)
