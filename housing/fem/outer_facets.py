"""Outer facets of a housing: those visible from outside, where sensors and the hammer reach."""

from dataclasses import dataclass

import numpy as np

from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import Facets, facet_centers, facet_normals, pick_facets
from gearwhine.numerics.arrays import FloatArray, IntArray

_CELLS = 80  # cells of a view along the housing's diagonal
_DIRECTIONS = 60  # directions of view
_LEAST_VIEW_COSINE = 0.5  # least cosine between a facet's normal and the direction of a view that counts
_LEAST_VISIBLE_SHARE = 0.25  # least part of the views of a facet in which it is visible; through a bore it is in few
_DEPTH = 3.0  # cells that a facet may lie behind the foremost in its own: slanting neighbours share cells


@dataclass(frozen=True)
class SurfaceSamples:
    """Points spread over facets.

    Attributes
    ----------
    points, normals : ndarray, shape (n, 3)
        Places on the plane triangles between the facets' corners [m], and their outward unit normals.
    spacing : float
        Neighbours are no farther from each other than this [m].
    """

    points: FloatArray
    normals: FloatArray
    spacing: float


def sample_surface(mesh: Mesh, facets: Facets) -> SurfaceSamples:
    """Points on facets, no farther apart than an eightieth of the mesh's diagonal."""
    spacing = float(np.linalg.norm(np.ptp(mesh.points, axis=0))) / _CELLS
    points, normals = [], []
    for block in facets:
        for corners in block.of.corner_triangles:
            triangles = mesh.points[block.nodes[:, corners]]
            edges = np.roll(triangles, -1, axis=1) - triangles
            normal = np.cross(edges[:, 0], edges[:, 1])
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            normal = normal / np.where(length > 0.0, length, 1.0)
            parts = np.ceil(np.linalg.norm(edges, axis=2).max(axis=1) / spacing).astype(np.int64)
            for count in np.unique(parts):
                shares = triangle_middles(int(count))
                chosen = parts == count
                points.append(np.einsum("sc,tci->tsi", shares, triangles[chosen]).reshape(-1, 3))
                normals.append(np.repeat(normal[chosen], len(shares), axis=0))
    return SurfaceSamples(np.concatenate(points), np.concatenate(normals), spacing)


def outer_facets(mesh: Mesh) -> Facets:
    """Return the outer facets: those visible from outside from enough of the directions that they face.

    Points of the surface are sorted into the cells of views from evenly spread directions: a facet whose middle lies
    well behind the foremost point of its cell is hidden. Walls inside a closed housing are hidden but for parts visible
    through bores; those of an open one count as outer.
    """
    boundary = mesh.boundary
    samples = sample_surface(mesh, boundary)
    middles, normals = facet_centers(mesh.points, boundary), facet_normals(mesh.points, boundary)
    faced, seen = np.zeros(len(middles)), np.zeros(len(middles))
    for direction in _even_directions(_DIRECTIONS):
        towards = samples.points[samples.normals @ direction > 0.0]
        cells, middle_cells = _cells(towards, middles, _across(direction), samples.spacing)
        foremost = np.full(max(cells.max(), middle_cells.max()) + 1, -np.inf)
        np.maximum.at(foremost, cells, towards @ direction)
        facing = normals @ direction > _LEAST_VIEW_COSINE
        seen += facing & (middles @ direction > foremost[middle_cells] - _DEPTH * samples.spacing)
        faced += facing
    return pick_facets(boundary, seen >= _LEAST_VISIBLE_SHARE * np.maximum(faced, 1.0))


def _cells(points: FloatArray, others: FloatArray, across: FloatArray, size: float) -> tuple[IntArray, IntArray]:
    """Numbers of the cells of a view that points, and others, fall into."""
    # By columns, each contiguous: to seek the least of rows takes longer than all the rest.
    first, second = ([np.floor(places @ one / size).astype(np.int64) for one in across] for places in (points, others))
    lowest = [min(one.min(), other.min()) for one, other in zip(first, second, strict=True)]
    width = max(first[1].max(), second[1].max()) - lowest[1] + 1
    of_points, of_others = ((u - lowest[0]) * width + (v - lowest[1]) for u, v in (first, second))
    return of_points, of_others


def triangle_middles(count: int) -> FloatArray:
    """Shares of the corners at the middles of the triangles that a triangle is cut into, `count` along each side."""
    upward = [(i + 1 / 3, j + 1 / 3) for i in range(count) for j in range(count - i)]
    downward = [(i + 2 / 3, j + 2 / 3) for i in range(count) for j in range(count - i - 1)]
    u, v = np.array(upward + downward).T / count
    return np.stack([1.0 - u - v, u, v], axis=1)


def _even_directions(count: int) -> FloatArray:
    """Return unit vectors spread evenly over the sphere along a spiral of the golden angle."""
    height = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    radius = np.sqrt(1.0 - height**2)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), height], axis=1)


def _across(direction: FloatArray) -> FloatArray:
    """Two unit vectors perpendicular to a direction and to each other, as rows."""
    helper = np.eye(3)[np.argmin(np.abs(direction))]
    first = np.cross(direction, helper)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(direction, first)])
