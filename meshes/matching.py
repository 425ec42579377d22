"""Conformity of a mesh: neighbouring elements share the nodes of their common edges, and none lies within a facet."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meshes.elements import FloatArray, IntArray, facet_corners
from meshes.mesh import Mesh
from meshes.topology import group_rows

_NEAR = 1e-6  # part of a facet's longest side: nodes nearer than that coincide, or lie in its plane
_CORNER_TRIANGLES = {3: ((0, 1, 2),), 4: ((0, 1, 2), (0, 2, 3))}


@dataclass(frozen=True)
class Touching:
    """Places where the surface touches itself without sharing nodes.

    Attributes
    ----------
    across : ndarray of int
        Corners of the surface at the place of one of another body.
    within : ndarray of int
        Corners of the surface at the place of another one of the same body.
    hanging : ndarray of int
        Hanging nodes: corners of the surface within facets of other elements, at none of their corners.
    between_bodies : bool
        Whether all hanging nodes lie within facets of another body.
    """

    across: IntArray
    within: IntArray
    hanging: IntArray
    between_bodies: bool


def unequal_edges(mesh: Mesh) -> IntArray:
    """Corners of edges that have a middle node in one element and none, or another, in the next, shape (n, 2)."""
    ends, middles = [], []
    for block in mesh.blocks:
        corners, local = block.of.edges, np.array(block.of.places)
        edge = block.nodes[:, corners]
        if block.of.order == 2:
            halfway = local[corners].mean(axis=1)
            middle = np.argmin(np.abs(halfway[:, None] - local[None]).max(axis=2), axis=1)
            middles.append(block.nodes[:, middle].ravel())
        else:
            middles.append(np.full(edge.shape[0] * edge.shape[1], -1))
        ends.append(np.sort(edge.reshape(-1, 2), axis=1))
    together, middle_node = np.concatenate(ends), np.concatenate(middles)
    if len(mesh.blocks) == 1 and mesh.order == 1:
        return np.empty((0, 2), dtype=np.int64)
    number = group_rows(together)
    highest, lowest = np.full(number.max() + 1, -2), np.full(number.max() + 1, len(mesh.points))
    np.maximum.at(highest, number, middle_node)
    np.minimum.at(lowest, number, middle_node)
    _, first = np.unique(number, return_index=True)
    return np.asarray(together[first[highest != lowest]])


def covered_quadrilaterals(mesh: Mesh) -> IntArray:
    """Corners of quadrilaterals of the surface that lie on triangles with the same corners, shape (n, 4)."""
    quads = [block.corners for block in mesh.boundary if block.of.n_corners == 4]
    triangles = [block.corners for block in mesh.boundary if block.of.n_corners == 3]
    if not quads or not triangles:
        return np.empty((0, 4), dtype=np.int64)
    corners, known = np.concatenate(quads), np.sort(np.concatenate(triangles), axis=1)
    halves = np.sort(corners[:, [[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]]], axis=2)
    numbers = group_rows(np.concatenate([known, halves.reshape(-1, 3)]))
    covered = np.isin(numbers[len(known) :], numbers[: len(known)]).reshape(-1, 4).any(axis=1)
    return np.asarray(corners[covered])


def touching_nodes(mesh: Mesh, body: IntArray) -> Touching:
    """Find where parts of the surface lie on each other without sharing nodes.

    Corners alone are compared with facets, which are taken as plane triangles between their corners: where curved
    facets conform, no corner lies within another facet.
    """
    from scipy.spatial import KDTree

    corners = facet_corners(mesh.boundary)
    tree = KDTree(mesh.points[corners])
    of_node = np.zeros(len(mesh.points), dtype=np.int64)
    for block, members in zip(mesh.blocks, np.split(body, mesh.block_ends), strict=True):
        of_node[block.nodes] = members[:, None]
    triangles = np.concatenate(
        [block.nodes[:, triangle] for block in mesh.boundary for triangle in _CORNER_TRIANGLES[block.of.n_corners]]
    )
    places = mesh.points[triangles]
    middle = places.mean(axis=1)
    reach = np.linalg.norm(places - middle[:, None], axis=2).max(axis=1)
    near = tree.query_ball_point(middle, reach * (1.0 + _NEAR))
    lengths = np.array([len(found) for found in near])
    which = np.repeat(np.arange(len(triangles)), lengths)
    node = corners[np.concatenate([np.asarray(found, dtype=np.int64) for found in near])]
    foreign = (triangles[which] != node[:, None]).all(axis=1)
    which, node = which[foreign], node[foreign]
    within, at_corner = _within(places[which], mesh.points[node])
    other = of_node[triangles[which, 0]] != of_node[node]
    # Where a facet's own corner is at the place, the nodes coincide and hang nowhere.
    matched = np.zeros(len(mesh.points), dtype=bool)
    matched[node[at_corner]] = True
    hanging = within & ~at_corner & ~matched[node]
    return Touching(
        across=_places(mesh.points, node[at_corner & other]),
        within=_places(mesh.points, node[at_corner & ~other]),
        hanging=np.unique(node[hanging]),
        between_bodies=bool(other[hanging].all()),
    )


def _places(points: FloatArray, nodes: IntArray) -> IntArray:
    """One node for each place at which some nodes lie."""
    nodes = np.unique(nodes)
    if not len(nodes):
        return nodes
    extent = max(float(np.ptp(points[nodes], axis=0).max()), 1e-300)
    _, first = np.unique(np.round(points[nodes] / (_NEAR * extent)), axis=0, return_index=True)
    return np.asarray(nodes[np.sort(first)])


def _within(triangles: FloatArray, points: FloatArray) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]]:
    """Whether each point lies in its triangle, and whether at a corner of it."""
    a, first, second = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(first, second)
    doubled = np.linalg.norm(normal, axis=1)
    size = np.sqrt(np.maximum((first**2).sum(axis=1), (second**2).sum(axis=1)))
    flat = doubled <= 1e-12 * size**2
    safe = np.where(flat, 1.0, doubled)
    arm = points - a
    height = np.abs((arm * normal).sum(axis=1)) / safe
    u = (np.cross(arm, second) * normal).sum(axis=1) / safe**2
    v = (np.cross(first, arm) * normal).sum(axis=1) / safe**2
    inside = ~flat & (u > -_NEAR) & (v > -_NEAR) & (u + v < 1.0 + _NEAR) & (height < _NEAR * size)
    apart = np.linalg.norm(triangles - points[:, None], axis=2).min(axis=1)
    return inside, apart < _NEAR * size
