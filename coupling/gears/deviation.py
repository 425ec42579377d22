"""Profile deviation of a tooth pair from perfect involutes, along its path of contact and beyond."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from coupling.gears import piecewise
from coupling.gears.corner_contact import flank_contact_points
from coupling.gears.geometry import Fault, Gear
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.piecewise import PiecewiseCubic

FloatArray = npt.NDArray[np.float64]

TOLERANCE = 1e-13
"""Largest error of the cubics [m]."""
SAME_CORNER = 1e-9
"""Corners nearer to each other than this, in base pitches, are one."""


def flank_gap(gear: Gear, roll_angle: FloatArray) -> FloatArray:
    """Material missing from a gear's flank below the involute [m], at roll angles [rad]; negative for excess."""
    tip, form = gear.roll_angle(gear.tip_radius), gear.roll_angle(gear.form_radius)
    gap = np.zeros_like(roll_angle)
    if gear.tip_relief is not None:
        gap = gap + gear.tip_relief.depth(roll_angle, tip, gear.base_radius)
    if gear.root_relief is not None:
        gap = gap + gear.root_relief.depth(roll_angle, form, gear.base_radius)
    if gear.profile_deviation is not None:
        gap = gap - gear.profile_deviation.at(roll_angle, form, tip)
    return np.asarray(gap, dtype=np.float64)


def pair_deviation(
    geometry: GearPairGeometry,
    start: float,
    end: float,
    *,
    corner_contact: bool = False,
    faults: tuple[tuple[Fault, ...], tuple[Fault, ...]] = ((), ()),
) -> PiecewiseCubic:
    """Gap between the flanks of a pair in nominal motion, over [start, end] in base pitches [m].

    Sum of the gaps of both flanks, by their modifications, deviations and faults; with corner contact also of the gap
    to a corner where the position lies beyond the path of contact.

    Parameters
    ----------
    geometry : GearPairGeometry
    start, end : float
        Positions; 0 and the contact ratio are the ends of the path.
    corner_contact : bool
        Whether corners touch beyond it; else the flanks continue.
    faults : pair of tuples
        Of the driver's tooth and of the driven gear's.
    """
    gears = (geometry.driver, geometry.driven)
    pitch_roll = math.tan(geometry.working_pressure_angle)

    def gap(position: FloatArray) -> FloatArray:
        rolls = geometry.driver_roll_angle(position), geometry.driven_roll_angle(position)
        total = np.zeros_like(position)
        if corner_contact:
            places = flank_contact_points(geometry, position)
            rolls, total = (places.driver_roll_angle, places.driven_roll_angle), places.gap
        for gear, roll, own in zip(gears, rolls, faults, strict=True):
            total = total + flank_gap(gear, roll)
            for fault in own:
                total = total + fault.gap(gear, roll, pitch_roll)
        return np.asarray(total, dtype=np.float64)

    corners = [0.0, geometry.contact_ratio] if corner_contact else []
    for gear, locate, own in zip(gears, (geometry.driver_position, geometry.driven_position), faults, strict=True):
        rolls = [*_corners(gear), *(roll for fault in own for roll in fault.corners(gear, pitch_roll))]
        corners += [locate(roll) for roll in rolls]
    breaks = piecewise.with_corners(np.array([start, end]), corners, SAME_CORNER)
    return piecewise.fitted(gap, breaks, TOLERANCE)


def _corners(gear: Gear) -> list[float]:
    """Roll angles where a gear's profile has corners."""
    corners: list[float] = []
    if gear.tip_relief is not None:
        corners.append(gear.tip_relief.start(gear.roll_angle(gear.tip_radius), gear.base_radius))
    if gear.root_relief is not None:
        corners.append(gear.root_relief.start(gear.roll_angle(gear.form_radius), gear.base_radius))
    if gear.profile_deviation is not None:
        corners += gear.profile_deviation.corners
    return corners
