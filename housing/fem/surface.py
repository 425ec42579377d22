"""Surface of a housing: integration by quadrature, and its flat faces."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from gearwhine.meshes import ElementBlock, Mesh
from gearwhine.meshes.elements import Facets, facet_centers, facet_normals, pick_facets
from gearwhine.meshes.shape_functions import quadrature, shape_functions
from gearwhine.numerics.arrays import FloatArray, IntArray


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


_LEAST_PLANE_COSINE = 1.0 - 1e-5  # cosine between the normals of neighbouring facets of one plane


@dataclass(frozen=True)
class FlatFace:
    """A flat part of a mesh's boundary, in one piece.

    Attributes
    ----------
    facets : tuple of ElementBlock
    area : float
        Area [m²].
    center, normal : ndarray, shape (3,)
        Centroid [m] and outward unit normal.
    name : str
        Name, see :func:`flat_face_names`.
    """

    facets: Facets
    area: float
    center: FloatArray
    normal: FloatArray
    name: str


def flat_faces(mesh: Mesh) -> list[FlatFace]:
    """Divide a mesh's boundary into flat faces: facets that share edges and lie in one plane; the largest first."""
    boundary, face_of = mesh.boundary, flat_face_numbers(mesh)
    normals, centers = facet_normals(mesh.points, boundary), facet_centers(mesh.points, boundary)
    areas, names = _facet_areas(mesh), flat_face_names(mesh)
    faces = []
    for number in np.argsort(-np.bincount(face_of, areas), kind="stable").tolist():
        chosen = face_of == number
        area, normal = float(areas[chosen].sum()), areas[chosen] @ normals[chosen]
        center = areas[chosen] @ centers[chosen] / area
        unit = normal / np.linalg.norm(normal)
        faces.append(FlatFace(pick_facets(boundary, chosen), area, center, unit, names[number].name))
    return faces


def flat_face_of_surface(mesh: Mesh, name: str) -> FlatFace | None:
    """Return a named surface of a mesh as a flat face; None where it is not flat."""
    wanted = {tuple(sorted(nodes)) for block in mesh.surfaces[name] for nodes in block.nodes.tolist()}
    for face in flat_faces(mesh):
        facets = [tuple(sorted(nodes)) for block in face.facets for nodes in block.nodes.tolist()]
        if wanted & set(facets):
            chosen = np.array([nodes in wanted for nodes in facets])
            return None if len(wanted) > chosen.sum() else replace(face, facets=pick_facets(face.facets, chosen))
    return None


def flat_face_numbers(mesh: Mesh) -> IntArray:
    """Find the number of the flat face that each boundary facet belongs to, shape (n_facets,), block after block."""
    boundary = mesh.boundary
    normals = facet_normals(mesh.points, boundary)
    ends, owners, first = [], [], 0
    for block in boundary:
        corners = block.corners
        for side in range(corners.shape[1]):
            ends.append(np.sort(corners[:, [side, (side + 1) % corners.shape[1]]], axis=1))
            owners.append(first + np.arange(len(block)))
        first += len(block)
    edges, owner = np.concatenate(ends), np.concatenate(owners)
    order = np.lexsort(edges.T)
    edges, owner = edges[order], owner[order]
    first_facet, second_facet = (
        owner[part][(edges[1:] == edges[:-1]).all(axis=1)] for part in (slice(None, -1), slice(1, None))
    )
    flat = np.einsum("ei,ei->e", normals[first_facet], normals[second_facet]) > _LEAST_PLANE_COSINE
    joined = sparse.coo_array((np.ones(flat.sum()), (first_facet[flat], second_facet[flat])), shape=(first, first))
    return np.asarray(connected_components(joined, directed=False)[1], dtype=np.int64)


@dataclass(frozen=True)
class FaceName:
    """Name of a flat face, and whether it is that of a surface of the mesh."""

    name: str
    is_surface: bool


def flat_face_names(mesh: Mesh) -> list[FaceName]:
    """Name the flat faces of a mesh's boundary, in the order of :func:`flat_face_numbers`.

    A face has the name of the mesh's surface that holds most of it. Another has its direction and the place of its
    centre, such as ``+y at 0, 10, 0 mm``, or as the inner side of a wall the name of the outer one, such as ``inside of
    bottom at 0, 10, 0 mm``: the same wherever the housing's faces are told.
    """
    numbers, areas = flat_face_numbers(mesh), _facet_areas(mesh)
    whole = np.bincount(numbers, areas)
    normals, centers = (
        np.stack([np.bincount(numbers, areas * part) for part in vectors.T], axis=1)
        for vectors in (facet_normals(mesh.points, mesh.boundary), facet_centers(mesh.points, mesh.boundary))
    )
    names = []
    for normal, center in zip(normals, 1e3 * centers / whole[:, None], strict=True):
        x, y, z = center.round().astype(int).tolist()
        names.append(FaceName(f"{nearest_axis(normal)} at {x}, {y}, {z} mm", is_surface=False))
    for name in mesh.surfaces:
        members = boundary_members(mesh, (name,))
        part = np.bincount(numbers[members], areas[members], len(whole))
        for number in np.flatnonzero(part > 0.5 * whole).tolist():
            names[number] = FaceName(name, is_surface=True)
    outer_faces = _outer_sides(
        mesh, numbers, normals / np.linalg.norm(normals, axis=1)[:, None], centers / whole[:, None]
    )
    for inner, outer in outer_faces.items():
        if not names[inner].is_surface:
            wall = names[outer].name if names[outer].is_surface else f"{nearest_axis(normals[outer])} wall"
            place = names[inner].name.partition(" at ")[2]
            names[inner] = FaceName(f"inside of {wall} at {place}", is_surface=False)
    return names


_OPPOSITE = -0.99  # cosine between the normals of both sides of a wall
_LEAST_WALL = 2e-3  # area of an inner side over the whole surface, at least: the facets of a bore are no walls
_LARGEST_WALL_SLENDERNESS = 0.3  # thickness of a wall over the square root of its inner side's area, at most


def _outer_sides(mesh: Mesh, numbers: IntArray, normals: FloatArray, centers: FloatArray) -> dict[int, int]:
    """Find the outer side of each wall whose inner side is a flat face: face number of the outer by that of the inner.

    The inner side looks towards the middle of the housing and the outer one away from it; of the outer ones behind an
    inner side the nearest counts.
    """
    middle = mesh.bounds.mean(axis=0)
    inwards = np.einsum("fi,fi->f", normals, middle - centers) > 0.0
    facets = facet_centers(mesh.points, mesh.boundary)
    low, high = (np.full((len(normals), 3), sign * np.inf) for sign in (1.0, -1.0))
    np.minimum.at(low, numbers, facets)
    np.maximum.at(high, numbers, facets)
    areas = np.bincount(numbers, _facet_areas(mesh), len(normals))
    outer_faces = {}
    for face in np.flatnonzero(inwards & (areas > _LEAST_WALL * areas.sum())).tolist():
        thickness = (centers[face] - centers) @ normals[face]
        across = np.abs(normals[face]) < 0.5  # axes along the wall
        covers = ((low <= centers[face]) & (centers[face] <= high))[:, across].all(axis=1)
        behind = ~inwards & (normals @ normals[face] < _OPPOSITE) & covers & (thickness > 0.0)
        behind &= thickness < _LARGEST_WALL_SLENDERNESS * np.sqrt(areas[face])
        if behind.any():
            outer_faces[face] = int(np.argmin(np.where(behind, thickness, np.inf)))
    return outer_faces


def _facet_areas(mesh: Mesh) -> FloatArray:
    """Areas of the boundary facets [m²], block after block."""
    return np.concatenate([part.areas.sum(axis=1) for part in surface_quadrature(mesh, mesh.boundary)])


def boundary_members(mesh: Mesh, surfaces: Sequence[str | Facets]) -> IntArray:
    """Numbers of the boundary facets, block after block, that belong to surfaces."""
    wanted = [
        block for surface in surfaces for block in (mesh.surface(surface) if isinstance(surface, str) else surface)
    ]
    members, first = [np.empty(0, dtype=np.int64)], 0
    for block in mesh.boundary:
        corners = np.sort(block.corners, axis=1)
        for other in wanted:
            if other.of.n_corners == corners.shape[1]:
                both = np.concatenate([corners, np.sort(other.corners, axis=1)])
                _, number = np.unique(both, axis=0, return_inverse=True)
                number = number.ravel()
                members.append(first + np.flatnonzero(np.isin(number[: len(corners)], number[len(corners) :])))
        first += len(block)
    return np.unique(np.concatenate(members))


def nearest_axis(normal: FloatArray) -> str:
    """Axis nearest to a normal, as ``+y``."""
    axis = int(np.argmax(np.abs(normal)))
    return f"{'+' if normal[axis] > 0.0 else '-'}{'xyz'[axis]}"
