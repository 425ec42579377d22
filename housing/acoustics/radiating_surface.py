"""Radiating surface: flat triangles with the outward normal, on which the sound field is solved."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.nearest_point import closest_on_triangles
from gearwhine.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class RadiatingSurface:
    """Triangles of a radiating surface.

    Attributes
    ----------
    points : ndarray, shape (n_points, 3)
        Vertices [m].
    triangles : ndarray of int, shape (n_triangles, 3)
        Vertices of each, counter-clockwise seen from the air.

    Raises
    ------
    HousingError
        Where a triangle has no area, or a vertex belongs to none.
    """

    points: FloatArray
    triangles: IntArray

    def __post_init__(self) -> None:
        """Refuse triangles without area and vertices without a triangle."""
        if len(self.triangles) == 0:
            raise HousingError("the radiating surface has no triangles")
        worst = int(np.argmin(self.areas / self.lengths**2))
        if self.areas[worst] < 1e-6 * self.lengths[worst] ** 2:
            raise HousingError(
                f"triangle {worst + 1} of the radiating surface has no area: {1e6 * self.areas[worst]:.3g} mm² "
                f"at a longest edge of {1e3 * self.lengths[worst]:.3g} mm"
            )
        unused = np.setdiff1d(np.arange(len(self.points)), self.triangles)
        if len(unused):
            raise HousingError(f"point {unused[0] + 1} of the radiating surface is a corner of no triangle")

    @cached_property
    def corners(self) -> FloatArray:
        """Places of each triangle's corners [m], shape (n_triangles, 3, 3)."""
        return self.points[self.triangles]

    @cached_property
    def _cross(self) -> FloatArray:
        first, second, third = np.moveaxis(self.corners, 1, 0)
        return np.cross(second - first, third - first)

    @cached_property
    def areas(self) -> FloatArray:
        """Area of each triangle [m²]."""
        return np.asarray(0.5 * np.linalg.norm(self._cross, axis=1))

    @cached_property
    def normals(self) -> FloatArray:
        """Outward unit normal of each triangle, shape (n_triangles, 3)."""
        return np.asarray(self._cross / np.linalg.norm(self._cross, axis=1, keepdims=True))

    @cached_property
    def lengths(self) -> FloatArray:
        """Longest edge of each triangle [m]."""
        return np.asarray(np.linalg.norm(self.corners - np.roll(self.corners, 1, axis=1), axis=2).max(axis=1))

    @cached_property
    def rounding(self) -> float:
        """Distance that counts as none [m]: a part in 1e9 of the extent or of the largest coordinate."""
        return 1e-9 * float(max(np.ptp(self.points, axis=0).max(), np.abs(self.points).max()))

    @property
    def area(self) -> float:
        """Area of the surface [m²]."""
        return float(self.areas.sum())

    @cached_property
    def volume(self) -> float:
        """Volume that a closed surface holds [m³], by the divergence theorem."""
        return float(np.einsum("ej,ej->", self.corners.mean(axis=1), self._cross) / 6.0)

    @cached_property
    def open_edges(self) -> IntArray:
        """Edges that are not passed once in each sense, shape (n, 2): none where the surface is closed."""
        ends = np.concatenate([self.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
        edges, owner = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
        sense = np.bincount(owner.ravel(), np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0), len(edges))
        return np.asarray(edges[sense != 0.0])

    def require_closed(self) -> None:
        """Refuse a surface that is open or turned inside out.

        Raises
        ------
        HousingError
            With the place of the first open edge.
        """
        if len(self.open_edges):
            x, y, z = 1e3 * self.points[self.open_edges[0]].mean(axis=0)
            raise HousingError(
                f"the radiating surface is not closed: {len(self.open_edges)} open edges, the first at "
                f"({x:.4g}, {y:.4g}, {z:.4g}) mm; boundary elements need a closed surface"
            )
        if self.volume <= 0.0:
            raise HousingError("the normals of the radiating surface point inward: its volume is negative")

    def part(self, chosen: npt.NDArray[np.bool_]) -> "RadiatingSurface":
        """Surface of the chosen triangles alone, with their vertices in the same order."""
        used, triangles = np.unique(self.triangles[chosen], return_inverse=True)
        return RadiatingSurface(self.points[used], triangles.reshape(-1, 3).astype(np.int64))

    def nearer_than(self, points: FloatArray, part: float) -> tuple[IntArray, IntArray, FloatArray]:
        """Find points that lie nearer to a triangle than a part, at most 0.4, of its longest edge.

        Returns
        -------
        points, triangles : ndarray of int, shape (n,)
            Numbers of both, in the order of the points.
        distances : ndarray, shape (n,)
            Between them [m].
        """
        columns = [(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0))]
        centers = self.corners.mean(axis=1)
        for start in range(0, len(points), 64):
            some = points[start : start + 64]
            apart = np.linalg.norm(some[:, None] - centers, axis=2)
            row, triangle = np.nonzero(apart < 1.1 * self.lengths)  # corners lie within 2/3 of an edge of the centre
            shares, _ = closest_on_triangles(self.corners[triangle], some[row])
            away = np.linalg.norm(np.einsum("pa,paj->pj", shares, self.corners[triangle]) - some[row], axis=1)
            near = away < part * self.lengths[triangle]
            columns.append((start + row[near], triangle[near], away[near]))
        numbers, triangles, distances = (np.concatenate(one) for one in zip(*columns, strict=True))
        return numbers, triangles, distances

    def highest_frequency(self, speed_of_sound: float, elements: float = 6.0) -> float:
        """Highest frequency that the triangles resolve [Hz]: `elements` mean edges a wavelength."""
        mean = np.linalg.norm(self.corners - np.roll(self.corners, 1, axis=1), axis=2).mean(axis=1)
        return float(speed_of_sound / (elements * np.quantile(mean, 0.95)))
