"""Tooth pair: stiffness and profile deviation of a pair of teeth along its path of contact."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from coupling.gears import piecewise
from coupling.gears.corner_contact import LARGEST_GAP, LONGEST_REACH, corner_contact_range, flank_contact_points
from coupling.gears.deviation import SAME_CORNER, pair_deviation
from coupling.gears.errors import GearError
from coupling.gears.faults import MissingTooth
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.pair_variants import PairFaults
from coupling.gears.piecewise import PiecewiseCubic

FloatArray = npt.NDArray[np.float64]

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
    geometry: GearPairGeometry, stiffness: PiecewiseCubic, faults: Sequence[PairFaults], corner_contact: bool
) -> tuple[ToothPairCurves, ...]:
    """Curves of every kind of pair.

    Parameters
    ----------
    geometry : GearPairGeometry
    stiffness : PiecewiseCubic
        Of a pair of sound teeth, from 0 to the contact ratio; or of the whole mesh, from 0 to 1.
    faults : sequence
        Of every kind, the driver's tooth's and the driven's.
    corner_contact : bool
        Whether the curves reach beyond the path of contact, to where corners may touch.

    Raises
    ------
    GearError
        Damaged teeth or corner contact with the stiffness of a whole mesh, which has no single pairs; a missing
        tooth without corner contact.
    """
    length = float(stiffness.knots[-1])
    whole_mesh = length == 1.0 and geometry.contact_ratio != 1.0
    if whole_mesh and (corner_contact or any(any(own) for own in faults)):
        raise GearError(
            f"{geometry.label}: the stiffness model describes the whole mesh as one spring, without single pairs that "
            "could be damaged or meet beyond the path of contact; choose a model of pairs of teeth"
        )
    if corner_contact and not math.isclose(length, geometry.contact_ratio, rel_tol=1e-9):
        raise GearError(
            f"{geometry.label}: corner contact needs the teeth's own contact ratio, {geometry.contact_ratio:.6g}; "
            f"the stiffness model has {length:.6g}"
        )
    broken = any(isinstance(fault, MissingTooth) for kind in faults for own in kind for fault in own)
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
        stiffness = stiffness.on_knots(np.concatenate([[start], stiffness.knots, [end]]))
    return tuple(
        ToothPairCurves(
            _weakened(geometry, stiffness, own),
            piecewise.constant(0.0, length)
            if whole_mesh
            else pair_deviation(geometry, start, end, corner_contact=corner_contact, faults=own),
        )
        for own in faults
    )


def without_shared_compliance(curves: ToothPairCurves, shared: float) -> ToothPairCurves:
    """Remove from a pair's compliance the part C shared with other pairs, `shared` [m/N]: ``1/k' = 1/k - C``."""
    if shared == 0.0:
        return curves
    alone = curves.stiffness

    def without(position: FloatArray) -> FloatArray:
        stiffness = alone(position)
        return np.asarray(stiffness / (1.0 - shared * stiffness), dtype=np.float64)

    largest = float(without(alone.knots).max())
    return replace(curves, stiffness=piecewise.fitted(without, alone.knots, _STIFFNESS_TOLERANCE * largest))


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


def _weakened(geometry: GearPairGeometry, stiffness: PiecewiseCubic, faults: PairFaults) -> PiecewiseCubic:
    """Stiffness of a pair of teeth with faults, whose compliances add to its own."""
    if not any(faults):
        return stiffness
    sides = (
        (geometry.driver, geometry.driver_position, faults[0]),
        (geometry.driven, geometry.driven_position, faults[1]),
    )
    pitch_roll = math.tan(geometry.working_pressure_angle)

    def weakened(position: FloatArray) -> FloatArray:
        places = flank_contact_points(geometry, np.clip(position, 0.0, geometry.contact_ratio))
        compliance = 1.0 / stiffness(position)
        for (gear, _, own), roll in zip(sides, (places.driver_roll_angle, places.driven_roll_angle), strict=True):
            for fault in own:
                compliance = compliance + fault.extra_compliance(gear, roll)
        return np.asarray(1.0 / compliance, dtype=np.float64)

    corners = [locate(roll) for gear, locate, own in sides for f in own for roll in f.corners(gear, pitch_roll)]
    breaks = piecewise.with_corners(stiffness.knots, corners, SAME_CORNER)
    return piecewise.fitted(weakened, breaks, _STIFFNESS_TOLERANCE * stiffness.mean)
