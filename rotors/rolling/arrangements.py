"""Bearing arrangements: double-row and paired ball bearings, back to back, face to face or in tandem."""

import math
from dataclasses import replace
from typing import Literal

from scipy.optimize import brentq

from rotors.errors import require, require_finite

from .ball_row import BallRow
from .rolling_bearing import RollingBearing

Arrangement = Literal["back to back", "face to face", "tandem"]

# Directions of the left and the right row. Contact lines of (1, −1) run apart towards the axis: stiff against tilting.
_DIRECTIONS: dict[str, tuple[int, int]] = {"back to back": (1, -1), "face to face": (-1, 1), "tandem": (1, 1)}


def paired(
    row: BallRow, arrangement: Arrangement, spacing: float, *, preload: float = 0.0, name: str = "paired bearing"
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
        A spacing that is not positive, a negative preload, or a preload in tandem, where no row opposes it.
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


def preload_offset(row: BallRow, preload: float) -> float:
    """Axial offset (m) at which a centred row presses with the axial force ``preload`` (N) along its direction.

    With v = (A cos α − s/2, A sin α + e) that is the root of Z K (|v| − A)^{3/2} sin α' = F, sin α' = v_z/|v|; the left
    side grows with e.
    """
    require_finite("preload of a row", preload, positive=True)
    scale = row.groove_distance
    highest = scale
    while row.axial_force(highest) < preload:
        highest *= 2.0
    lowest = -scale * math.sin(row.contact_angle)
    return float(brentq(lambda e: row.axial_force(e) - preload, lowest, highest, xtol=1e-15 * scale, rtol=8.9e-16))
