"""Mesh quality: edge lengths and shape numbers of the elements."""

from dataclasses import dataclass

import numpy as np

from meshes.elements import KINDS, ElementBlock, FloatArray
from meshes.mapping import determinants, jacobians
from meshes.mesh import Mesh
from meshes.shapes import shape_functions

# Edges of a corner tetrahedron of the ideal element, as columns: of a regular tetrahedron, of a cube and of a
# right prism on an equilateral triangle, all of unit edge. A mean ratio does not depend on their size.
_HALF, _ROOT = 0.5, np.sqrt(3.0) / 2.0
_IDEAL = {
    "tetra": np.array([[1.0, _HALF, _HALF], [0.0, _ROOT, _ROOT / 3.0], [0.0, 0.0, np.sqrt(2.0 / 3.0)]]),
    "hexahedron": np.eye(3),
    "wedge": np.array([[1.0, _HALF, 0.0], [0.0, _ROOT, 0.0], [0.0, 0.0, 1.0]]),
}


@dataclass(frozen=True)
class MeshQuality:
    """Sizes and shapes of the elements.

    Attributes
    ----------
    volume : float
        Sum of the elements' volumes between their corners [m³].
    edge_length : tuple of float
        Smallest, median and largest edge [m].
    shape : tuple of float
        Smallest and median shape number; see :func:`shape_numbers`.
    """

    volume: float
    edge_length: tuple[float, float, float]
    shape: tuple[float, float]


def mesh_quality(mesh: Mesh) -> MeshQuality:
    """Measure the elements of a mesh by their corners."""
    edges = np.concatenate([edge_lengths(mesh.points, block).ravel() for block in mesh.blocks])
    shape = shape_numbers(mesh)
    return MeshQuality(
        volume=float(mesh.corner_volumes.sum()),
        edge_length=(float(edges.min()), float(np.median(edges)), float(edges.max())),
        shape=(float(shape.min()), float(np.median(shape))),
    )


def edge_lengths(points: FloatArray, block: ElementBlock) -> FloatArray:
    """Distance between the ends of each edge [m], shape (n_elements, n_edges)."""
    ends = points[block.nodes[:, block.of.edges]]
    return np.asarray(np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2))


def shape_numbers(mesh: Mesh) -> FloatArray:
    """A number for each element's shape, 1 for the ideal and 0 for a flat one, shape (n_elements,).

    The mean ratio 3 det(S)^(2/3) / |S|² (Liu and Joe 1994; Knupp 2001 for bricks and wedges), S the map from the
    ideal element -- regular tetrahedron, cube, prism on an equilateral triangle -- and |S| its Frobenius norm; the
    least over the element's corners, and 0 where the element is inverted at a corner.
    """
    return np.concatenate([_block_shape(mesh.points, block) for block in mesh.blocks])


def _block_shape(points: FloatArray, block: ElementBlock) -> FloatArray:
    corners = block.of.corners
    places = np.array(KINDS[corners].places).T
    if corners == "tetra":
        places = places[:, :1]  # the map is affine, so that one corner is enough
    _, gradients = shape_functions(corners, places)
    jacobian = jacobians(points, block.corners, gradients)
    mapped = np.einsum("ijeq,jk->ikeq", jacobian, np.linalg.inv(_IDEAL[corners]))
    volume = np.maximum(determinants(mapped), 0.0)
    return np.asarray((3.0 * np.cbrt(volume) ** 2 / (mapped**2).sum(axis=(0, 1))).min(axis=1))
