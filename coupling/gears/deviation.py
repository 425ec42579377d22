"""How far a pair of flanks is short of the perfect involute along its path of contact."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from coupling.gears import piecewise
from coupling.gears.geometry import Gear
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.piecewise import PiecewiseCubic

FloatArray = npt.NDArray[np.float64]


def tip_relief_deviation(geometry: GearPairGeometry, length: float | None = None) -> PiecewiseCubic:
    """Gap that the tip reliefs of both gears leave a pair, over [0, contact ratio] [m].

    Linear in roll angle, so linear in position: exact straight lines with knots where a relief begins.

    Parameters
    ----------
    geometry : GearPairGeometry
    length : float or None
        End of the range in base pitches; None for the contact ratio.
    """
    end = geometry.contact_ratio if length is None else length
    starts = [
        locate(gear.tip_relief.start_roll_angle)
        for gear, locate in (
            (geometry.driver, geometry.driver_position),
            (geometry.driven, geometry.driven_position),
        )
        if gear.tip_relief is not None
    ]
    # A relief that starts within rounding of an end has no room for a knot of its own.
    inner = {start for start in starts if 1e-9 < start < end - 1e-9}
    knots = np.array(sorted({0.0, end} | inner))
    knots = knots[np.concatenate([[True], np.diff(knots) > 1e-9])]
    gap = _relief(geometry.driver, geometry.driver_roll_angle(knots))
    return piecewise.polyline(knots, gap + _relief(geometry.driven, geometry.driven_roll_angle(knots)))


def _relief(gear: Gear, roll_angle: FloatArray) -> FloatArray:
    """Depth of a gear's tip relief [m] at roll angles [rad]."""
    relief = gear.tip_relief
    if relief is None:
        return np.zeros_like(roll_angle)
    span = gear.roll_angle(gear.tip_radius) - relief.start_roll_angle
    return np.asarray(relief.amount * np.maximum(0.0, (roll_angle - relief.start_roll_angle) / span))
