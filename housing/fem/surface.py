"""Surface of a housing: integration by quadrature, and its flat faces."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from meshes import ElementBlock, Mesh
from meshes.elements import Facets, facet_centers, facet_normals, pick_facets
from meshes.shape_functions import quadrature, shape_functions

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


_ALIGNED = 1.0 - 1e-5  # cosine between the normals of neighbouring facets of one plane


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
    """

    facets: Facets
    area: float
    center: FloatArray
    normal: FloatArray


def flat_faces(mesh: Mesh) -> list[FlatFace]:
    """Divide a mesh's boundary into flat faces: facets that share edges and lie in one plane; the largest first."""
    boundary, face_of = mesh.boundary, flat_face_numbers(mesh)
    normals, centers = facet_normals(mesh.points, boundary), facet_centers(mesh.points, boundary)
    areas = np.concatenate([part.areas.sum(axis=1) for part in surface_quadrature(mesh, boundary)])
    faces = []
    for number in np.argsort(-np.bincount(face_of, areas), kind="stable").tolist():
        chosen = face_of == number
        area, normal = float(areas[chosen].sum()), areas[chosen] @ normals[chosen]
        center = areas[chosen] @ centers[chosen] / area
        faces.append(FlatFace(pick_facets(boundary, chosen), area, center, normal / np.linalg.norm(normal)))
    return faces


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
    flat = np.einsum("ei,ei->e", normals[first_facet], normals[second_facet]) > _ALIGNED
    joined = sparse.coo_array((np.ones(flat.sum()), (first_facet[flat], second_facet[flat])), shape=(first, first))
    return np.asarray(connected_components(joined, directed=False)[1], dtype=np.int64)
