"""Integration over parts of the surface, and the surface point nearest to a place."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class SurfaceQuadrature:
    """Quadrature points on a set of facets.

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


def surface_quadrature(mesh: Mesh, facets: IntArray) -> SurfaceQuadrature:
    """Points and areas on facets, exact to degree 4 on flat ones (the product of two quadratic fields)."""
    values, gradients, weights = _triangle_functions(facets.shape[1])
    nodes = mesh.points[facets]
    tangents = np.einsum("fai,qaj->fqij", nodes, gradients)
    normal = np.cross(tangents[..., 0], tangents[..., 1])
    return SurfaceQuadrature(
        facets=facets,
        shape_values=values,
        points=np.einsum("fai,qa->fqi", nodes, values),
        areas=np.linalg.norm(normal, axis=2) * weights,
    )


def facets_in_box(mesh: Mesh, low: FloatArray, high: FloatArray) -> IntArray:
    """Boundary facets whose corners all lie in the box from ``low`` to ``high`` [m].

    Raises
    ------
    HousingError
        Where there is none.
    """
    boundary = mesh.boundary
    inside = np.all((mesh.points >= low) & (mesh.points <= high), axis=1)
    facets = boundary[inside[boundary[:, :3]].all(axis=1)]
    if len(facets) == 0:
        raise HousingError(
            f"no facet of the surface lies in the box from {_triple(low)} to {_triple(high)} m; "
            f"the housing spans {_triple(mesh.bounds[0])} to {_triple(mesh.bounds[1])} m"
        )
    return np.asarray(facets)


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


def surface_point(mesh: Mesh, facets: IntArray, place: FloatArray, *, along: FloatArray | None = None) -> SurfacePoint:
    """The point of some boundary facets nearest to a place.

    Parameters
    ----------
    mesh : Mesh
    facets : ndarray of int, shape (n_facets, n_shape)
        Outward facets to search.
    place : ndarray, shape (3,)
        [m].
    along : ndarray, shape (3,), optional
        A unit vector; distances are then taken across it only, so that the place is projected along it.
    """
    corners = mesh.points[facets[:, :3]]
    target = place
    if along is not None:
        corners = corners - (corners @ along)[..., None] * along
        target = place - (place @ along) * along
    coordinates, distance = _closest_on_triangles(corners, target)
    best = int(np.argmin(distance))
    nodes = facets[best]
    weights = _triangle_shape(len(nodes), coordinates[best])
    a, b, c = mesh.points[nodes[:3]]
    normal = np.cross(b - a, c - a)
    return SurfacePoint(
        nodes=nodes,
        weights=weights,
        position=weights @ mesh.points[nodes],
        normal=normal / np.linalg.norm(normal),
    )


def facet_normals(mesh: Mesh, facets: IntArray) -> FloatArray:
    """Outward unit normals of boundary facets by their corners, shape (n_facets, 3)."""
    a, b, c = np.moveaxis(mesh.points[facets[:, :3]], 1, 0)
    normals = np.cross(b - a, c - a)
    return np.asarray(normals / np.linalg.norm(normals, axis=1)[:, None])


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


def _triangle_functions(n_shape: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    from skfem import ElementTriP1, ElementTriP2
    from skfem.quadrature import get_quadrature

    element = ElementTriP1() if n_shape == 3 else ElementTriP2()
    points, weights = get_quadrature(element.refdom, 4)
    pairs = [element.lbasis(points, number) for number in range(n_shape)]
    values = np.array([np.broadcast_to(value, weights.shape) for value, _ in pairs]).T
    gradients = np.array([np.broadcast_to(gradient, points.shape) for _, gradient in pairs]).transpose(2, 0, 1)
    return values, gradients, np.asarray(weights)


def _triangle_shape(n_shape: int, barycentric: FloatArray) -> FloatArray:
    """Shape functions of the triangle at barycentric coordinates, in our node order."""
    from skfem import ElementTriP1, ElementTriP2

    element = ElementTriP1() if n_shape == 3 else ElementTriP2()
    point = barycentric[1:, None]
    return np.array([float(np.asarray(element.lbasis(point, number)[0]).item()) for number in range(n_shape)])


def _triple(values: FloatArray) -> str:
    return "(" + ", ".join(f"{value:g}" for value in values) + ")"
