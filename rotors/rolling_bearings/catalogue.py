"""Estimate of the inside of a rolling bearing from its main dimensions and, where known, its load ratings.

Catalogues print bore d, outer diameter D and width B, but not the internal geometry. The pitch circle lies near the
middle, (d + D)/2. Design practice (Changsen 1991; the bounds of Gupta, Tiwari and Nair, Mechanism and Machine Theory
42, 2007) makes a ball 0.24 to 0.35 of D − d, and lets as many into a deep-groove bearing as an arc of 186° or so takes
when the rings are pushed apart (Conrad), Z = 1 + φ / (2 asin(D_w / D_pw)). Here: 0.3 and 186°, which meets sizes 6205,
6208 and 6305 to a ball and their printed static ratings to 9 %. Other bearings fill their pitch circle but for the
cage: `_INSIDES` has the element's diameter over D − d, the pitch of the elements over their diameter, and the length of
a roller's contact over B. Two rows share the width. Grooves are 0.52 and 0.53 of the ball, ISO 281's limits, 0.53
inside of self-aligning ones.

**With ratings.** The static rating depends on Z D² of balls and on Z L D of rollers. With C₀ given, a roller has the
length that meets it, and balls the diameter. The dynamic rating grows with the same product but for a small power of
the diameter, so a few per cent between makers would move a diameter by ten. Beside C₀ it only chooses among the counts
of balls within two of the usual one, where that one misses it by more than 10 %; alone it scales the diameter of balls
or the length of rollers.

All of this is an estimate, and every row says so (`estimated`). Stiffness goes as Z^{2/3} D_w^{1/3} (Krämer), so a ball
too many of nine moves it by 7 %.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, get_args

from scipy.optimize import brentq

from gearwhine.rotors.errors import RotorError, require, require_finite
from gearwhine.rotors.rolling_bearings.ratings import Row, dynamic_rating, static_rating
from gearwhine.rotors.rolling_bearings.roller_rows import RollerRow, SphericalRollerRow, TaperedRollerRow
from gearwhine.rotors.rolling_bearings.rolling_bearing import Arrangement, RollingBearing, paired, preload_offset
from gearwhine.rotors.rolling_bearings.rows import BallRow, FourPointRow, spherical_groove

CatalogueType = Literal[
    "deep-groove",
    "angular-contact",
    "double-row-angular-contact",
    "four-point",
    "self-aligning-ball",
    "cylindrical-roller",
    "tapered-roller",
    "spherical-roller",
]


@dataclass(frozen=True)
class _Inside:
    """Usual inside of a type: diameter over D − d, pitch over diameter, length over B, rows, angle in degrees."""

    diameter: float
    pitch: float
    length: float = 0.0
    rows: int = 1
    angle: float | None = None


_INSIDES: dict[str, _Inside] = {
    "deep-groove": _Inside(0.3, 0.0),
    "angular-contact": _Inside(0.3, 1.15, angle=40.0),
    "double-row-angular-contact": _Inside(0.28, 1.2, rows=2, angle=30.0),
    "four-point": _Inside(0.3, 1.15, angle=35.0),
    "self-aligning-ball": _Inside(0.245, 1.3, rows=2, angle=10.0),
    "cylindrical-roller": _Inside(0.275, 1.2, 0.55),
    "tapered-roller": _Inside(0.26, 1.12, 0.58, angle=14.0),
    "spherical-roller": _Inside(0.25, 1.1, 0.33, rows=2, angle=10.5),
}
AXIAL_FACTORS = {"tapered-roller": 0.4, "spherical-roller": 0.45}
"""Product of tan α and the factor Y of tapered or Y₁ of spherical rollers (ISO 281)."""
_LARGEST = 5.0
"""Outer diameter that no bearing of a catalogue has [m]; slewing rings, which are larger, are not among its types."""
_CONRAD = math.radians(186.0)
# Largest length of a roller's contact over the width, two rows together.
_LONGEST_ROLLER_CONTACT = 0.95
# Largest logarithm of the dynamic rating over the printed one with which the usual count is kept.
_NEAR_RATING_LOGARITHM = 0.1


def catalogue_row(
    kind: CatalogueType,
    bore: float,
    outer_diameter: float,
    width: float,
    *,
    contact_angle: float | None = None,
    axial_factor: float | None = None,
    clearance: float = 0.0,
    dynamic: float | None = None,
    static: float | None = None,
    bearings: int = 1,
) -> Row:
    """Estimate one row of a bearing from its main dimensions and ratings; the module gives the sources.

    Parameters
    ----------
    kind : CatalogueType
        One of `CatalogueType`; `catalogue_bearing` has all rows of it.
    bore, outer_diameter, width : float
        Main dimensions [m]; for tapered rollers the whole width T.
    contact_angle : float, optional
        Contact angle of types that have one [rad]; a usual one where none is given. For tapered and spherical rollers
        and self-aligning balls tan α = e/1.5 with the catalogue's e.
    axial_factor : float, optional
        Factor Y of tapered or Y₁ of spherical rollers in place of the angle: cot α = Y/0.4 or Y₁/0.45 (ISO 281).
    clearance : float
        Diametral clearance in operation [m]; catalogues print the larger value before mounting.
    dynamic, static : float, optional
        Ratings C and C₀ of the whole bearing as printed [N]; of ``bearings`` equal ones side by side together.
    bearings : int
        Number of bearings that the ratings are of: 2 for a pair, whose rows share the load (ISO 76, ISO 281).

    Raises
    ------
    RotorError
        Impossible dimensions, a contact angle that does not fit the type, or ratings that no inside of this size has.
    """
    expected = ", ".join(map(repr, get_args(CatalogueType)))
    require(kind in tuple(_INSIDES), "type of bearing", kind, f"one of {expected}")
    inside = _INSIDES[kind]
    rows_rated = inside.rows * bearings
    require_finite("bore", bore, positive=True)
    require_finite("bearing width", width, positive=True)
    require_finite("outer diameter", outer_diameter)
    hint = f"at most {_LARGEST:g} m, as the largest rolling bearings have; are {outer_diameter:g} mm meant?"
    require(outer_diameter <= _LARGEST, "outer diameter", outer_diameter, hint)
    height = outer_diameter - bore
    require(height > 0.0, "outer diameter", outer_diameter, f"more than the bore, {bore:g} m")
    for label, rating in (("dynamic rating", dynamic), ("static rating", static)):
        if rating is not None:
            require_finite(label, rating, positive=True)
    angled = contact_angle is None or contact_angle == 0.0 or inside.angle is not None
    require(angled, f"contact angle of a {kind} bearing", contact_angle, "none: its contacts are radial")
    angle = math.radians(inside.angle or 0.0) if contact_angle is None else contact_angle
    if axial_factor is not None:
        require(kind in AXIAL_FACTORS, f"axial factor of a {kind} bearing", axial_factor, "none: rollers have one")
        require(contact_angle is None, "axial factor", axial_factor, "none beside a contact angle")
        require_finite("axial factor", axial_factor, positive=True)
        angle = math.atan(AXIAL_FACTORS[kind] / axial_factor)
    pitch, diameter = 0.5 * (bore + outer_diameter), inside.diameter * height
    if not inside.length:
        fits = diameter * min(inside.rows, 1.5) <= width
        require(fits, "bearing width", width, f"at least {diameter:g} m, the diameter of a ball between these rings")

    def make(count: int, ball: float, length: float) -> Row:
        return _row(kind, count, ball, length, pitch, angle, clearance)

    usual = _conrad(pitch, diameter) if not inside.pitch else _filling(pitch, diameter, inside.pitch)
    if dynamic is None and static is None:
        return make(usual, diameter, inside.length * width)
    rated: Callable[[Row], float]
    if static is not None:
        wanted, rated = static, lambda row: rows_rated * static_rating(row)
    else:
        assert dynamic is not None
        wanted, rated = dynamic, lambda row: dynamic_rating(row, rows_rated)
    rows = []
    choosable = static is not None and dynamic is not None and not inside.length
    for count in range(max(usual - 2, 3), usual + 3) if choosable else (usual,):
        row = _fitted(make, count, diameter, inside.length * width, pitch, wanted, rated)
        if row is not None and (
            not isinstance(row, _ROLLERS) or row.length * inside.rows <= _LONGEST_ROLLER_CONTACT * width
        ):
            rows.append(row)
    if not rows:
        name = "static" if static is not None else "dynamic"
        typical = rated(make(usual, diameter, inside.length * width))
        raise RotorError(
            f"{name} rating of a {kind} bearing of {1e3 * bore:g} × {1e3 * outer_diameter:g} × {1e3 * width:g} mm is "
            f"{wanted:g} N; expected about {typical:.3g} N, as elements that fit between its rings have"
        )
    if dynamic is None or len(rows) == 1:
        return rows[0]

    def missed(row: Row) -> float:
        return abs(math.log(dynamic_rating(row, rows_rated) / dynamic))

    near = [row for row in rows if missed(row) <= _NEAR_RATING_LOGARITHM]
    return min(near, key=lambda row: abs(row.count - usual)) if near else min(rows, key=missed)


def catalogue_bearing(
    kind: CatalogueType,
    bore: float,
    outer_diameter: float,
    width: float,
    *,
    contact_angle: float | None = None,
    axial_factor: float | None = None,
    clearance: float = 0.0,
    dynamic: float | None = None,
    static: float | None = None,
    carries: Literal["+z", "-z"] = "+z",
    preload: float = 0.0,
    axial_offset: float = 0.0,
    arrangement: Literal["single"] | Arrangement = "single",
    spacing: float | None = None,
    floating: bool = False,
    outer_turns: bool = False,
    name: str = "rolling bearing",
) -> RollingBearing:
    """Estimate a whole bearing, its rows in their places; parameters as of `catalogue_row` and `bearing_of_row`.

    Its lives are by ``dynamic``, the catalogue's C, where it is given, and not by C of the estimated inside, which it
    improves beside ``static`` only. Ratings are of both bearings of an arrangement.

    Parameters
    ----------
    outer_turns : bool
        Whether the outer ring turns with the shaft, as in a planet on its pin.
    """
    row = catalogue_row(
        kind,
        bore,
        outer_diameter,
        width,
        contact_angle=contact_angle,
        axial_factor=axial_factor,
        clearance=clearance,
        dynamic=None if static is None else dynamic,
        static=static,
        bearings=1 if arrangement == "single" else 2,
    )
    return bearing_of_row(
        kind,
        replace(row, outer_turns=outer_turns),
        width,
        carries=carries,
        preload=preload,
        axial_offset=axial_offset,
        arrangement=arrangement,
        spacing=spacing,
        floating=floating,
        dynamic=dynamic,
        name=name,
    )


def bearing_of_row(
    kind: CatalogueType,
    row: Row,
    width: float = 0.0,
    *,
    carries: Literal["+z", "-z"] = "+z",
    preload: float = 0.0,
    axial_offset: float = 0.0,
    arrangement: Literal["single"] | Arrangement = "single",
    spacing: float | None = None,
    floating: bool = False,
    dynamic: float | None = None,
    name: str = "rolling bearing",
) -> RollingBearing:
    """Make a whole bearing of one of its rows, with its preload.

    Parameters
    ----------
    kind : CatalogueType
        Type, which says how many rows there are.
    row : Row
        One row.
    width : float
        Width of the bearing [m], by which two rows on common rings stand apart.
    carries : {"+z", "-z"}
        Sense of the thrust of the shaft that a row in angular contact carries. "+z" at the left end and "-z" at the
        right one are back to back (O), the other way round face to face (X), where the inner rings turn. Two opposed
        rows carry both.
    preload : float
        Force of a spring on the shaft along ``carries``, of two opposed rows the force between them [N].
    axial_offset : float
        Displacement of the ring on the shaft along ``carries`` at assembly: a preload against another bearing [m].
    arrangement : {"single", "back to back", "face to face", "tandem"}
        One such bearing, or two.
    spacing : float, optional
        Distance of the centres of two bearings' rows [m].
    floating : bool
        Whether the other ring slides in its seat.
    dynamic : float, optional
        Rating C of the whole bearing, of both in an arrangement [N].
    name : str
        Name in messages.

    Raises
    ------
    RotorError
        What does not fit the type or each other.
    """
    require(carries in ("+z", "-z"), "carries", carries, "'+z' or '-z'")
    require_finite("preload", preload, minimum=0.0)
    require_finite("axial offset", axial_offset)
    held = axial_offset == 0.0 or row.has_axial_stiffness
    require(held, "axial offset", axial_offset, "none: its rollers carry no axial load")
    sense = 1 if carries == "+z" else -1
    if arrangement == "single":
        require(spacing is None, "spacing", spacing, "none of a single bearing")
        rows = standing_rows(kind, row, width)
    else:
        by_itself = len(standing_rows(kind, row, width)) == 2 or kind in ("four-point", "cylindrical-roller")
        require(not by_itself, "arrangement", arrangement, f"'single' of a {kind} bearing")
        require(axial_offset == 0.0, "axial offset", axial_offset, "none: two rows have the preload between them")
        require(spacing is not None, "spacing", spacing, "the distance of the two rows")
        rows = tuple(paired(row, arrangement, spacing or 0.0).rows)
    spring, pressed = sense * preload, 0.0
    if len({one.direction for one in rows}) == 2:
        # Opposed rows hold their preload between them, by equal offsets.
        spring, pressed = 0.0, preload_offset(row, preload) if preload > 0.0 else 0.0
    else:
        rows = tuple(one.facing(sense) for one in rows)
    # The ring on the shaft carries all rows along: its displacement is an offset towards some and away from others.
    moved = sense * axial_offset
    rows = tuple(replace(one, axial_offset=pressed + one.direction * moved) for one in rows)
    return RollingBearing(rows, spring, name, floating, dynamic)


def standing_rows(kind: CatalogueType, row: Row, width: float) -> tuple[Row, ...]:
    """All rows of a bearing of this type that is ``width`` [m] wide, from one of them."""
    if kind == "spherical-roller":
        return row.facing(1), row.facing(-1)
    if kind == "self-aligning-ball":
        # The contact lines meet in the bearing's centre.
        return tuple(paired(row, "face to face", row.pitch_diameter * math.tan(row.contact_angle)).rows)
    if kind == "double-row-angular-contact":
        return tuple(paired(row, "back to back", max(0.5 * width, 1.05 * row.element_diameter)).rows)
    return (row,)


_ROLLERS = (RollerRow, TaperedRollerRow, SphericalRollerRow)


def _row(kind: str, count: int, diameter: float, length: float, pitch: float, angle: float, clearance: float) -> Row:
    if kind == "cylindrical-roller":
        return RollerRow(count, diameter, length, pitch, clearance, estimated=True)
    if kind == "tapered-roller":
        return TaperedRollerRow(count, diameter, length, pitch, clearance, angle=angle, estimated=True)
    if kind == "spherical-roller":
        return SphericalRollerRow(count, diameter, length, pitch, clearance, angle=angle, estimated=True)
    if kind == "deep-groove":
        return BallRow(count, diameter, pitch, clearance=clearance, estimated=True)
    if kind == "four-point":
        return FourPointRow(count, diameter, pitch, angle, clearance=clearance, estimated=True)
    if kind == "self-aligning-ball":
        sphere = spherical_groove(diameter, pitch, angle)
        return BallRow(count, diameter, pitch, angle, 0.53, sphere, clearance, estimated=True)
    # The outer groove has one shoulder only, so balls touch it on the side of their contact angle.
    limits = (0.0, 0.5 * math.pi)
    return BallRow(count, diameter, pitch, angle, clearance=clearance, groove_limits=limits, estimated=True)


def _fitted(
    make: Callable[[int, float, float], Row],
    count: int,
    diameter: float,
    length: float,
    pitch: float,
    wanted: float,
    rated: Callable[[Row], float],
) -> Row | None:
    """Row of ``count`` elements with the wanted rating, by the length of its rollers or the diameter of its balls."""
    if count * math.asin(min(diameter / pitch, 1.0)) >= math.pi:
        return None
    low, high = (0.2, 5.0) if length else (0.7, min(1.4, 0.999 * pitch * math.sin(math.pi / count) / diameter))

    def scaled(factor: float) -> Row:
        return make(count, diameter, factor * length) if length else make(count, factor * diameter, 0.0)

    def excess(factor: float) -> float:
        return rated(scaled(factor)) - wanted

    if high <= low or excess(low) > 0.0 or excess(high) < 0.0:
        return None
    return scaled(float(brentq(excess, low, high, xtol=1e-12)))


def _conrad(pitch: float, ball: float) -> int:
    return max(round(1.0 + _CONRAD / (2.0 * math.asin(ball / pitch))), 3)


def _filling(pitch: float, diameter: float, per_element: float) -> int:
    return max(math.floor(math.pi * pitch / (diameter * per_element)), 3)
