"""Skin of a housing as plane triangles between the nodes of its boundary facets: samples and nearest points.

A facet of six nodes becomes four triangles, so that curved facets are followed by their middle nodes. A place is sought
by its own normal too: of a thin wall, the side that looks the same way is meant.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.nearest_point import closest_on_triangles
from gearwhine.housing.fem.outer_facets import triangle_middles
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import KINDS, Facets
from gearwhine.numerics.arrays import FloatArray, IntArray

# Local nodes of the plane triangles that a facet of a kind is split into.
SPLITS: dict[str, tuple[tuple[int, int, int], ...]] = {
    "triangle": ((0, 1, 2),),
    "triangle6": ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    "quad": ((0, 1, 2), (0, 2, 3)),
    "quad8": ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6), (4, 6, 7)),
    "quad9": tuple(
        (ring, following, 8) for ring, following in zip((0, 4, 1, 5, 2, 6, 3, 7), (4, 1, 5, 2, 6, 3, 7, 0), strict=True)
    ),
}
_NEAREST_SAMPLES = 6  # samples whose triangles may hold the nearest point


@dataclass(frozen=True)
class Skin:
    """Plane triangles between the nodes of some facets.

    Attributes
    ----------
    nodes : ndarray of int, shape (n, 3)
        Nodes at the corners of each triangle, counter-clockwise seen from outside.
    corners : ndarray, shape (n, 3, 3)
        Places of the corners [m].
    facet : ndarray of int, shape (n,)
        Facet of each triangle, counted block after block.
    places : ndarray, shape (n, 3, 2)
        Reference coordinates of the corners in the facet.
    """

    nodes: IntArray
    corners: FloatArray
    facet: IntArray
    places: FloatArray

    @cached_property
    def normals(self) -> FloatArray:
        """Outward unit normals, shape (n, 3)."""
        normal = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        return np.asarray(normal / np.where(length > 0.0, length, 1.0))

    def samples(self, spacing: float) -> tuple[FloatArray, IntArray]:
        """Points spread over the triangles.

        Parameters
        ----------
        spacing : float
            Longest edge of the equal parts that each triangle is cut into [m].

        Returns
        -------
        points : ndarray, shape (m, 3)
            Middles of the parts [m].
        owners : ndarray of int, shape (m,)
            Triangle of each middle.
        """
        edges = np.linalg.norm(np.roll(self.corners, -1, axis=1) - self.corners, axis=2)
        parts = np.ceil(edges.max(axis=1) / spacing).astype(np.int64)
        points, owners = [], []
        for count in np.unique(parts).tolist():
            shares = triangle_middles(count)
            chosen = np.flatnonzero(parts == count)
            points.append(np.einsum("sc,tci->tsi", shares, self.corners[chosen]).reshape(-1, 3))
            owners.append(np.repeat(chosen, len(shares)))
        return np.concatenate(points), np.concatenate(owners)

    def nearest(self, places: FloatArray, normals: FloatArray, spacing: float, turned: float) -> "NearestSkin":
        """Find the nearest points of the skin that look the way of the places.

        Parameters
        ----------
        places, normals : ndarray, shape (m, 3)
            Places [m] and their unit normals.
        spacing : float
            Spacing of the samples among which candidates are sought [m].
        turned : float
            Distance that counts as much as a unit difference of the normals [m]: the sum of squares of distance and
            difference is least.
        """
        points, owners = self.samples(spacing)
        tree = cKDTree(np.hstack([points, turned * self.normals[owners]]), balanced_tree=False)
        _, sample_numbers = tree.query(np.hstack([places, turned * normals]), k=min(_NEAREST_SAMPLES, len(points)))
        candidates = owners[np.reshape(sample_numbers, (len(places), -1))]
        shares, gaps = closest_on_triangles(self.corners[candidates], places[:, None])
        feet = np.einsum("mkc,mkci->mki", shares, self.corners[candidates])
        difference = np.linalg.norm(self.normals[candidates] - normals[:, None], axis=2)
        best = np.argmin(gaps**2 + (turned * difference) ** 2, axis=1)
        rows = np.arange(len(places))
        return NearestSkin(candidates[rows, best], shares[rows, best], feet[rows, best], gaps[rows, best])


@dataclass(frozen=True)
class NearestSkin:
    """Nearest points of a skin.

    Attributes
    ----------
    triangles : ndarray of int, shape (m,)
    shares : ndarray, shape (m, 3)
        Barycentric coordinates in them.
    points : ndarray, shape (m, 3)
        Nearest points [m].
    distances : ndarray, shape (m,)
        Distances to them [m].
    """

    triangles: IntArray
    shares: FloatArray
    points: FloatArray
    distances: FloatArray


def skin_of(mesh: Mesh, facets: Facets) -> Skin:
    """Split facets into plane triangles between their nodes.

    Raises
    ------
    HousingError
        Where there are no facets.
    """
    nodes, facet, places, first = [], [], [], 0
    for block in facets:
        split = np.array(SPLITS[block.kind])
        nodes.append(block.nodes[:, split].reshape(-1, 3))
        facet.append(np.repeat(first + np.arange(len(block)), len(split)))
        places.append(np.tile(np.array(KINDS[block.kind].places, dtype=np.float64)[split], (len(block), 1, 1)))
        first += len(block)
    if first == 0:
        raise HousingError("there are no facets; expected those of a housing's skin")
    together = np.concatenate(nodes)
    return Skin(together, mesh.points[together], np.concatenate(facet), np.concatenate(places))
