"""Modal test of a reduced housing: measured modes beside those of its matrices, at nodes and recovered points.

The shapes of a reduced housing are known at its interface nodes and at points with recovery rows. A measured point
takes the nearest of these; measured motions without one are left out.
"""

from dataclasses import replace

import numpy as np

from gearwhine.housing.correlation.comparison import (
    Comparison,
    Pairing,
    compare_by_frequency,
    compare_by_shapes,
    with_shapes,
)
from gearwhine.housing.errors import HousingError
from gearwhine.housing.measured import MeasuredModes, align_landmarks
from gearwhine.housing.modal_test import ABOVE_HIGHEST_MEASURED, ComparedTest, ModalTest, needed_limit
from gearwhine.housing.reduced import ReducedHousing
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, refuse

_TWO_PI = 2.0 * np.pi
NEAR = 0.02
"""Distance of a measured point from the one whose motion it takes, over the extent of all, unless one is given."""

_FEWEST = 2  # motions of which two shapes can be told apart


def compare_reduced(housing: ReducedHousing, test: ModalTest) -> ComparedTest:
    """Pair the modes of a reduced housing with measured ones.

    Parameters
    ----------
    housing : ReducedHousing
    test : ModalTest
        Its points stand in the frame of the housing, or are aligned by landmarks.

    Raises
    ------
    HousingError
        Where the limit of the matrices is below the measured modes, the points are to be aligned on a surface or
        paired by dominance, or too few of them are near points whose motions are known.
    """
    measured = test.modes
    modes, known = housing.modes, housing.modes.known
    frequencies = modes.frequencies[:known]
    highest = ABOVE_HIGHEST_MEASURED * float(measured.frequencies[-1])
    pairing = test.pairing or ("nearest" if measured.shapes is None else "shapes")
    if pairing == "dominance":
        expected = "'shapes', 'nearest' or 'order': the skin of a reduced housing is not known"
        refuse([Finding(("modal test", ""), "pairing", "dominance", expected)], HousingError)
    if pairing != "order" and housing.limit < highest:
        expected = needed_limit(highest / _TWO_PI)
        refuse([Finding(("housing", ""), "below_hz", housing.trusted_limit_hz, expected)], HousingError)
    responses = None if test.responses is None else "responses are compared with those of a mesh alone"
    if measured.geometry is None or measured.shapes is None:
        return ComparedTest(test, _by_frequency(pairing, measured, frequencies), responses=responses)
    at_points, motions = _at_known_points(housing, test)
    shapes = np.einsum("din,nm,di->md", motions, modes.vectors[:, :known], _directions(at_points))
    if pairing == "shapes":
        comparison = compare_by_shapes(frequencies, shapes, at_points, rule=test.rule)
    else:
        comparison = with_shapes(_by_frequency(pairing, measured, frequencies), frequencies, shapes, at_points)
    return ComparedTest(replace(test, modes=at_points), comparison, responses=responses)


def _by_frequency(pairing: Pairing, measured: MeasuredModes, frequencies: FloatArray) -> Comparison:
    return compare_by_frequency(measured.frequencies, frequencies, "order" if pairing == "order" else "nearest")


def _directions(measured: MeasuredModes) -> FloatArray:
    assert measured.geometry is not None
    return measured.geometry.directions


def _at_known_points(housing: ReducedHousing, test: ModalTest) -> tuple[MeasuredModes, FloatArray]:
    """Return the measured modes at points whose motions are known, in the housing's frame, and their rows (d, 3, n)."""
    measured = test.modes
    geometry, shapes = measured.geometry, measured.shapes
    assert geometry is not None
    assert shapes is not None
    if isinstance(test.align, str):
        expected = "landmarks, or points in the frame of the matrices: there is no surface to align on"
        refuse([Finding(("modal test", ""), "align", test.align, expected)], HousingError)
    elif test.align is not None:
        motion = align_landmarks(geometry, dict(test.align)).motion
        geometry = replace(
            geometry, positions=motion.place(geometry.positions), directions=motion.turn(geometry.directions)
        )
    known = housing.points
    apart = np.linalg.norm(geometry.positions[:, None] - known.positions[None], axis=2)
    if not apart.size:
        expected = "recovery rows, or nodes with a seat, a support or a sensor: of no point the motion is known"
        refuse([Finding(("modal test", ""), "modes", None, expected)], HousingError)
    extent = float(np.ptp(np.vstack([known.positions, geometry.positions]), axis=0).max())
    tolerance = NEAR * extent if test.tolerance is None else test.tolerance
    is_near = (apart.min(axis=1) <= tolerance)[geometry.points]
    if int(is_near.sum()) < _FEWEST:
        nearest = 1e3 * float(apart.min())
        expected = (
            f"points within {1e3 * tolerance:.3g} mm of nodes and recovered points of the housing, in its frame; the "
            f"nearest is {nearest:.3g} mm off"
        )
        refuse([Finding(("modal test", ""), "modes", None, expected)], HousingError)
    kept = replace(geometry, points=geometry.points[is_near], directions=geometry.directions[is_near])
    rows = known.rows[apart.argmin(axis=1)[kept.points]]
    return replace(measured, geometry=kept, shapes=shapes[:, is_near]), rows
