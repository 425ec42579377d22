"""Tooth pair: stiffness and profile deviation of a pair of teeth along its path of contact.

The profile deviation is the gap that modifications and deviations of both flanks leave between the teeth in nominal
motion, against perfect involutes. Both curves reach along the path of contact and, with corner contact, beyond it; each
variant of pair with faulty teeth has curves of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.errors import GearError
from gearwhine.coupling.gears.geometry.faults import MissingTooth
from gearwhine.coupling.gears.geometry.gear import Fault, Gear
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.coupling.gears.geometry.path_of_contact import (
    LARGEST_GAP,
    LONGEST_REACH,
    corner_contact_range,
    flank_contact_points,
)
from gearwhine.coupling.gears.geometry.pitch_deviations import PairFaults
from gearwhine.coupling.gears.piecewise_cubic import PiecewiseCubic
from gearwhine.numerics.arrays import FloatArray

Flattening = Callable[[FloatArray], FloatArray]
"""Compliance of the contact of two flanks [m/N] by position in base pitches."""

TOLERANCE = 1e-13
"""Largest error of the cubics [m]."""
SAME_CORNER = 1e-9
"""Corners nearer to each other than this, in base pitches, are one."""


def is_whole_mesh(length: float, geometry: GearPairGeometry) -> bool:
    """Whether a stiffness over `length` base pitches is that of the whole mesh over its period, not of one pair."""
    return length == 1.0 and geometry.contact_ratio != 1.0


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


@lru_cache(maxsize=16)  # the contact of a pair in the static machine, and then in motion
def pair_deviation(
    geometry: GearPairGeometry,
    start: float,
    end: float,
    *,
    corner_contact: bool = False,
    faults: tuple[tuple[Fault, ...], tuple[Fault, ...]] = ((), ()),
) -> PiecewiseCubic:
    """Gap between the flanks of a pair in nominal motion, over [start, end] in base pitches [m].

    The gap sums both flanks' modifications, deviations and faults; with corner contact it includes the gap
    to a corner where the position lies beyond the path of contact.

    Parameters
    ----------
    geometry : GearPairGeometry
    start, end : float
        Positions; 0 and the contact ratio are the ends of the path.
    corner_contact : bool
        Whether corners touch beyond it; else the flanks continue.
    faults : pair of tuples
        Faults of the driver's tooth and of the driven gear's.
    """
    gears = (geometry.driver, geometry.driven)
    pitch_roll = math.tan(geometry.working_pressure_angle)

    def gap(position: FloatArray) -> FloatArray:
        rolls = geometry.driver_roll_angle(position), geometry.driven_roll_angle(position)
        total = np.zeros_like(position)
        if corner_contact:
            places = flank_contact_points(geometry, position)
            rolls, total = (places.driver_roll_angle, places.driven_roll_angle), places.gap
        for gear, roll, gear_faults in zip(gears, rolls, faults, strict=True):
            total = total + flank_gap(gear, roll)
            for fault in gear_faults:
                total = total + fault.gap(gear, roll, pitch_roll_angle=pitch_roll, face_width=geometry.face_width)
        return np.asarray(total, dtype=np.float64)

    corners = [0.0, geometry.contact_ratio] if corner_contact else []
    for gear, locate, gear_faults in zip(
        gears, (geometry.driver_position, geometry.driven_position), faults, strict=True
    ):
        rolls = [*_corners(gear), *(roll for fault in gear_faults for roll in fault.corners(gear, pitch_roll))]
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


_SLOPE_JUMP = 1e-5
"""Part of the largest slope below which a jump of slope is an error of the fit."""
_STIFFNESS_TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class ToothPairCurves:
    """Stiffness and profile deviation of a pair of teeth along the path of contact.

    Attributes
    ----------
    stiffness, deviation : PiecewiseCubic
        [N/m] and [m], over one range of positions in base pitches.
    """

    stiffness: PiecewiseCubic
    deviation: PiecewiseCubic


def tooth_pair_curves(
    geometry: GearPairGeometry,
    stiffness: PiecewiseCubic,
    flattening: Flattening,
    faults: Sequence[PairFaults],
    *,
    corner_contact: bool,
) -> tuple[ToothPairCurves, ...]:
    """Curves of every variant of pair.

    Parameters
    ----------
    geometry : GearPairGeometry
    stiffness : PiecewiseCubic
        Stiffness of a pair of sound teeth, from 0 to the contact ratio; or of the whole mesh, from 0 to 1 [N/m].
    flattening : callable
        Maps positions to the compliance of the contact of sound flanks, part of the pair's [m/N].
    faults : sequence
        Faults of the driver's and of the driven tooth, for every variant.
    corner_contact : bool
        Whether the curves reach beyond the path of contact, to where corners may touch.

    Raises
    ------
    GearError
        Damaged teeth or corner contact with the stiffness of a whole mesh, which has no single pairs; a missing
        tooth without corner contact.
    """
    length = float(stiffness.knots[-1])
    whole_mesh = is_whole_mesh(length, geometry)
    if whole_mesh and (corner_contact or any(any(variant_faults) for variant_faults in faults)):
        raise GearError(
            f"{geometry.label}: the stiffness model describes the whole mesh as one spring, without single pairs that "
            "could be damaged or meet beyond the path of contact; choose a model of pairs of teeth"
        )
    if corner_contact and not math.isclose(length, geometry.contact_ratio, rel_tol=1e-9):
        raise GearError(
            f"{geometry.label}: corner contact needs the teeth's own contact ratio, {geometry.contact_ratio:.6g}; "
            f"the stiffness model has {length:.6g}"
        )
    broken = any(
        isinstance(fault, MissingTooth) for variant in faults for variant_faults in variant for fault in variant_faults
    )
    if broken and not (corner_contact and length + 2.0 * LONGEST_REACH > 2.0):
        raise GearError(
            f"{geometry.label}: where a tooth is missing only corners of its neighbours could touch; that needs "
            f"corner_contact, and a contact ratio above {2.0 - 2.0 * LONGEST_REACH:g}"
        )
    start, end = 0.0, length
    if corner_contact:
        # The neighbours of a missing tooth stay in contact for as long as they reach.
        before, beyond = corner_contact_range(geometry, math.inf if broken else LARGEST_GAP)
        start, end = -before, length + beyond
        stiffness = _on_range(stiffness, start, end)
    return tuple(
        ToothPairCurves(
            _weakened(geometry, stiffness, flattening, variant_faults),
            piecewise.constant(0.0, length)
            if whole_mesh
            else pair_deviation(geometry, start, end, corner_contact=corner_contact, faults=variant_faults),
        )
        for variant_faults in faults
    )


@lru_cache(maxsize=64)  # keyed by identity of the curve, so that what is found of it is found once
def _on_range(stiffness: PiecewiseCubic, start: float, end: float) -> PiecewiseCubic:
    """Return a curve on a wider range."""
    return stiffness.on_knots(np.concatenate([[start], stiffness.knots, [end]]))


def without_shared_compliance(curves: ToothPairCurves, shared: float) -> ToothPairCurves:
    """Remove from a pair's compliance the part C shared with other pairs, `shared` [m/N]: ``1/k' = 1/k - C``."""
    return curves if shared == 0.0 else replace(curves, stiffness=_stiffness_alone(curves.stiffness, shared))


@lru_cache(maxsize=16)  # keyed by identity of the curve: contacts of other flanks share it
def _stiffness_alone(stiffness: PiecewiseCubic, shared: float) -> PiecewiseCubic:
    def without(position: FloatArray) -> FloatArray:
        with_shared = stiffness(position)
        return np.asarray(with_shared / (1.0 - shared * with_shared), dtype=np.float64)

    largest = float(without(stiffness.knots).max())
    return piecewise.fitted(without, stiffness.knots, _STIFFNESS_TOLERANCE * largest)


def slope_jumps(curve: PiecewiseCubic) -> FloatArray:
    """Inner knots where the slope of a curve jumps by more than the error of the fit."""
    widths = np.diff(curve.knots)
    after = curve.coefficients[1:, 1] / widths[1:]
    before = (curve.coefficients[:-1] @ np.array([0.0, 1.0, 2.0, 3.0])) / widths[:-1]
    largest = float(np.max(np.abs(after), initial=0.0))
    # Slopes over which the curve changes by less than 1e-9 of its value do not count.
    least = 1e-9 * float(np.abs(curve.coefficients[:, 0]).max())
    jumps = np.abs(after - before) > max(_SLOPE_JUMP * largest, least, 1e-30)
    return np.asarray(curve.knots[1:-1][jumps], dtype=np.float64)


def _weakened(
    geometry: GearPairGeometry, stiffness: PiecewiseCubic, flattening: Flattening, faults: PairFaults
) -> PiecewiseCubic:
    """Stiffness of a pair of teeth with faults, whose compliances add to its own."""
    if not any(faults):
        return stiffness
    driver, driven = geometry.carrying_gears
    sides = ((driver, geometry.driver_position, faults[0]), (driven, geometry.driven_position, faults[1]))
    pitch_roll = math.tan(geometry.working_pressure_angle)

    def weakened(position: FloatArray) -> FloatArray:
        on_path = np.clip(position, 0.0, geometry.contact_ratio)
        places, contact = flank_contact_points(geometry, on_path), flattening(on_path)
        compliance = 1.0 / stiffness(position)
        for (gear, _, gear_faults), roll in zip(
            sides, (places.driver_roll_angle, places.driven_roll_angle), strict=True
        ):
            for fault in gear_faults:
                more = fault.more_flattening(roll, geometry.face_width)
                compliance = compliance + fault.extra_compliance(gear, roll) + more * contact
        return np.asarray(1.0 / compliance, dtype=np.float64)

    corners = [
        locate(roll) for gear, locate, gear_faults in sides for f in gear_faults for roll in f.corners(gear, pitch_roll)
    ]
    breaks = piecewise.with_corners(stiffness.knots, corners, SAME_CORNER)
    return piecewise.fitted(weakened, breaks, _STIFFNESS_TOLERANCE * stiffness.mean)
