"""Internal gears with their pinions, and how far the outlines of two gears stand in each other."""

import math

import numpy as np
import numpy.typing as npt
from matplotlib.path import Path
from scipy.spatial import cKDTree

from gearwhine.coupling.gears import Gear, GearPairGeometry
from gearwhine.coupling.gears.geometry.profile import gear_outline, meshing_rotations
from gearwhine.numerics.arrays import FloatArray

ALPHA = math.radians(20.0)


def pinion(teeth: int = 20, **changes: object) -> Gear:
    return Gear(
        **{"name": "pinion", "module": 2e-3, "pressure_angle": ALPHA, "face_width": 20e-3, "teeth": teeth, **changes}
    )  # type: ignore[arg-type]


def ring(teeth: int = -60, **changes: object) -> Gear:
    """Ring with teeth low enough for pinions of 20 teeth."""
    return pinion(teeth, **{"name": "ring", "addendum": 0.75, **changes})


def placed_outlines(
    pair: GearPairGeometry, phase: float, sense: int, line: float, closing: float = 0.0, points: int = 30
) -> tuple[FloatArray, FloatArray]:
    """Outlines (n, 2) of ring and pinion in mesh, the driven gear turned against the driver by `closing` of δ [m]."""
    rotations = list(meshing_rotations(pair, phase, centre_line_angle=line, sense=sense))
    rotations[1] += pair.flank_sense(sense) * closing / pair.driven.base_radius
    distance = pair.working_centre_distance
    centres = (0.0, 0.0), (distance * math.cos(line), distance * math.sin(line))
    driver, driven = (
        gear_outline(gear, rotation, centre, points=points)
        for gear, rotation, centre in zip((pair.driver, pair.driven), rotations, centres, strict=True)
    )
    return (driver, driven) if pair.driver.is_internal else (driven, driver)


def depth_of_overlap(ring: FloatArray, pinion: FloatArray) -> float:
    """Depth [m] to which a pinion's corners stand in the ring's teeth, or the ring's in the pinion's; 0 where apart."""
    middle = pinion.mean(axis=0)
    near = ring[np.hypot(*(ring - middle).T) < np.hypot(*(pinion - middle).T).max()]
    depths = [0.0]
    for points, polygon, within in ((pinion, ring, False), (near, pinion, True)):
        # Few points seem to be on the wrong side by the nearest corner, and for these all sides count.
        suspects = points[_seem_inside(points, polygon) == within]
        buried = suspects[Path(polygon).contains_points(suspects) == within]
        depths.append(float(_distance(buried, polygon).max(initial=0.0)))
    return max(depths)


def gap_between(ring: FloatArray, pinion: FloatArray) -> float:
    """Least distance of the corners of a pinion's outline from its ring [m]."""
    return float(_distance(pinion, ring).min())


def _seem_inside(points: FloatArray, polygon: FloatArray) -> npt.NDArray[np.bool_]:
    """Whether points (n, 2) are inside a counter-clockwise polygon, by its edges at the corner nearest to each."""
    nearest = cKDTree(polygon).query(points)[1]
    corner = polygon[nearest]
    before, after = corner - polygon[nearest - 1], polygon[(nearest + 1) % len(polygon)] - corner
    left = [
        edge[:, 0] * out[:, 1] - edge[:, 1] * out[:, 0] > 0.0 for edge in (before, after) for out in (points - corner,)
    ]
    convex = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > 0.0
    return np.asarray(np.where(convex, left[0] & left[1], left[0] | left[1]))


def _distance(points: FloatArray, polygon: FloatArray) -> FloatArray:
    """Distance of points (n, 2) from the edges at the corner of a polygon that is nearest to each [m]."""
    nearest = cKDTree(polygon).query(points)[1]
    distances = []
    for step in (-1, 1):
        corner = polygon[nearest]
        edge = polygon[(nearest + step) % len(polygon)] - corner
        out = points - corner
        along = np.clip((out * edge).sum(axis=1) / np.maximum((edge**2).sum(axis=1), 1e-30), 0.0, 1.0)
        distances.append(np.hypot(*(out - along[:, None] * edge).T))
    return np.minimum(*distances)
