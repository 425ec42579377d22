"""Integration over parts of the surface, and the surface point nearest to a place."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError
from meshes import ElementBlock, Facets, Mesh
from meshes.shapes import quadrature, shape_functions

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class SurfaceQuadrature:
    """Quadrature points on facets of one kind.

    Attributes
    ----------
    facets : ndarray of int, shape (n_facets, n_shape)
        Nodes of each facet.
    shape_values : ndarray, shape (n_points, n_shape)
        Shape functions at the points, the same on each facet.
    points : ndarray, shape (n_facets, n_points, 3)
        Places [m].
    areas : ndarray, shape (n_facets, n_points)
        Area that each point stands for [m²].
    """

    facets: IntArray
    shape_values: FloatArray
    points: FloatArray
    areas: FloatArray

    @property
    def area(self) -> float:
        """Area of all facets [m²]."""
        return float(self.areas.sum())


def surface_quadrature(mesh: Mesh, facets: Facets) -> tuple[SurfaceQuadrature, ...]:
    """Points and areas on facets, one set for each block of a kind.

    Exact for the product of two fields of the elements' order on flat facets whose opposite sides are parallel.
    """
    return tuple(_block_quadrature(mesh, block) for block in facets)


def _block_quadrature(mesh: Mesh, block: ElementBlock) -> SurfaceQuadrature:
    places, weights = quadrature(block.kind, 4)
    values, gradients = shape_functions(block.kind, places)
    nodes = mesh.points[block.nodes]
    tangents = np.einsum("fai,qaj->fqij", nodes, gradients, optimize=True)
    normal = np.cross(tangents[..., 0], tangents[..., 1])
    return SurfaceQuadrature(
        facets=block.nodes,
        shape_values=values,
        points=np.einsum("fai,qa->fqi", nodes, values, optimize=True),
        areas=np.linalg.norm(normal, axis=2) * weights,
    )


@dataclass(frozen=True)
class SurfacePoint:
    """A point of the surface, held by the shape functions of its facet.

    Attributes
    ----------
    nodes : ndarray of int, shape (n_shape,)
    weights : ndarray, shape (n_shape,)
        Shape functions there; they sum to one.
    position : ndarray, shape (3,)
        [m].
    normal : ndarray, shape (3,)
        Outward unit normal.
    """

    nodes: IntArray
    weights: FloatArray
    position: FloatArray
    normal: FloatArray


def surface_point(mesh: Mesh, facets: Facets, place: FloatArray, *, along: FloatArray | None = None) -> SurfacePoint:
    """The point of some boundary facets nearest to a place.

    The nearest facet is told by the plane triangles between its corners; on it, the nearest point of its true,
    curved or twisted, shape is taken.

    Parameters
    ----------
    mesh : Mesh
    facets : tuple of ElementBlock
        Outward facets to search.
    place : ndarray, shape (3,)
        [m].
    along : ndarray, shape (3,), optional
        A unit vector; distances are then taken across it only, so that the place is projected along it.

    Raises
    ------
    HousingError
        Where there are no facets.
    """
    across = np.eye(3) if along is None else np.eye(3) - np.outer(along, along)
    nearest: tuple[float, ElementBlock, int, FloatArray] | None = None
    for block in facets:
        for triangle in _CORNER_TRIANGLES[block.of.n_corners] if len(block) else ():
            corners = mesh.points[block.nodes[:, triangle]] @ across
            shares, distance = _closest_on_triangles(corners, across @ place)
            best = int(np.argmin(distance))
            if nearest is None or distance[best] < nearest[0]:
                start = shares[best] @ np.array(block.of.places)[list(triangle)]
                nearest = (float(distance[best]), block, best, start)
    if nearest is None:
        raise HousingError("there are no facets to find a point on")
    _, block, member, start = nearest
    nodes = block.nodes[member]
    coordinates = _closest_on_facet(mesh.points[nodes] @ across, block, start, across @ place)
    values, gradients = shape_functions(block.kind, coordinates[:, None])
    tangents = mesh.points[nodes].T @ gradients[0]
    normal = np.cross(tangents[:, 0], tangents[:, 1])
    return SurfacePoint(
        nodes=nodes,
        weights=values[0],
        position=values[0] @ mesh.points[nodes],
        normal=normal / np.linalg.norm(normal),
    )


# Plane triangles between the corners of a facet.
_CORNER_TRIANGLES = {3: ((0, 1, 2),), 4: ((0, 1, 2), (0, 2, 3))}
_STEPS = 20


def _closest_on_facet(nodes: FloatArray, block: ElementBlock, start: FloatArray, target: FloatArray) -> FloatArray:
    """Reference coordinates of the facet's point nearest to the target, by Gauss-Newton steps from a first guess.

    Only steps that come nearer are taken, shortened where they must be, and none that leaves the facet: on a flat
    facet the first guess is already the answer, and on a curved one no step makes it worse.
    """
    here = start
    gap = _gap(nodes, block, here, target)
    for _ in range(_STEPS):
        values, gradients = shape_functions(block.kind, here[:, None])
        tangents = nodes.T @ gradients[0]
        step = np.linalg.lstsq(tangents, target - values[0] @ nodes, rcond=1e-10)[0]
        for shortening in (1.0, 0.5, 0.25, 0.125):
            trial = _clipped(here + shortening * step, block)
            trial_gap = _gap(nodes, block, trial, target)
            if trial_gap < gap * (1.0 - 1e-12):
                here, gap = trial, trial_gap
                break
        else:
            break
    return here


def _gap(nodes: FloatArray, block: ElementBlock, coordinates: FloatArray, target: FloatArray) -> float:
    values, _ = shape_functions(block.kind, coordinates[:, None])
    return float(np.linalg.norm(values[0] @ nodes - target))


def _clipped(coordinates: FloatArray, block: ElementBlock) -> FloatArray:
    """The nearest reference coordinates within the facet."""
    if block.of.n_corners == 4:
        return np.clip(coordinates, 0.0, 1.0)
    excess = coordinates.sum() - 1.0
    if excess > 0.0:
        coordinates = coordinates - excess / 2.0
    u = float(np.clip(coordinates[0], 0.0, 1.0))
    return np.array([u, np.clip(coordinates[1], 0.0, 1.0 - u)])


def _closest_on_triangles(corners: FloatArray, place: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Barycentric coordinates of the nearest point of each triangle, and its distance.

    Triangles that a projection made flat (zero area) are measured by their edges.
    """
    a, edge_1, edge_2 = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    g11, g12, g22 = (edge_1**2).sum(1), (edge_1 * edge_2).sum(1), (edge_2**2).sum(1)
    h1, h2 = ((place - a) * edge_1).sum(1), ((place - a) * edge_2).sum(1)
    determinant = g11 * g22 - g12**2
    flat = determinant <= 1e-12 * g11 * g22
    safe = np.where(flat, 1.0, determinant)
    u, v = (g22 * h1 - g12 * h2) / safe, (g11 * h2 - g12 * h1) / safe
    best = np.stack([1.0 - u - v, u, v], axis=1)
    inside = ~flat & (best >= 0.0).all(axis=1)
    distance = np.where(inside, np.linalg.norm((best[..., None] * corners).sum(1) - place, axis=1), np.inf)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        edge = corners[:, j] - corners[:, i]
        length = np.maximum((edge**2).sum(1), 1e-300)
        t = np.clip(((place - corners[:, i]) * edge).sum(1) / length, 0.0, 1.0)
        gap = np.linalg.norm(corners[:, i] + t[:, None] * edge - place, axis=1)
        closer = gap < distance
        distance = np.where(closer, gap, distance)
        candidate = np.zeros_like(best)
        candidate[:, i], candidate[:, j] = 1.0 - t, t
        best = np.where(closer[:, None], candidate, best)
    return best, distance
