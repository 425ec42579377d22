"""Jacobians of the map from the reference element; volumes and first moments of elements."""

from dataclasses import dataclass

import numpy as np

from meshes.elements import KINDS, FloatArray, IntArray
from meshes.shapes import quadrature, shape_functions


def jacobians(points: FloatArray, nodes: IntArray, gradients: FloatArray) -> FloatArray:
    """∂x_i / ∂ξ_j of elements at some reference points.

    Parameters
    ----------
    points : ndarray, shape (n_points, 3)
        [m].
    nodes : ndarray of int, shape (n_elements, n_nodes)
    gradients : ndarray, shape (n_places, n_nodes, dimension)
        Of the shape functions, by the reference coordinates.

    Returns
    -------
    ndarray, shape (3, dimension, n_elements, n_places)
        [m]. The component comes first, so that each one is a plain array over elements and places.
    """
    n_places, n_nodes, dimension = gradients.shape
    flat = gradients.transpose(1, 2, 0).reshape(n_nodes, dimension * n_places)
    coordinates = points[nodes].transpose(2, 0, 1).reshape(3 * len(nodes), n_nodes)
    product = (coordinates @ flat).reshape(3, len(nodes), dimension, n_places)
    return np.ascontiguousarray(product.transpose(0, 2, 1, 3))


def determinants(jacobian: FloatArray) -> FloatArray:
    """Determinants of Jacobians of solids, shape (3, 3, ...) to (...)."""
    a, b, c = jacobian
    return np.asarray(
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


def inverses(jacobian: FloatArray, determinant: FloatArray) -> FloatArray:
    """Inverses of Jacobians of solids, by their cofactors: ∂ξ_j / ∂x_i, shape (3, 3, ...) with j first."""
    inverse = np.empty_like(jacobian)
    for i in range(3):
        for j in range(3):
            (r, s), (t, u) = ((i + 1) % 3, (i + 2) % 3), ((j + 1) % 3, (j + 2) % 3)
            inverse[j, i] = jacobian[r, t] * jacobian[s, u] - jacobian[r, u] * jacobian[s, t]
    inverse /= determinant
    return inverse


def volumes(points: FloatArray, nodes: IntArray, kind: str) -> FloatArray:
    """Signed volume of solid elements [m³], shape (n_elements,).

    Exact for straight edges; with curved edges of order 2 the integrand is a polynomial of degree 3 in a tetrahedron
    and 5 in each coordinate of a brick, and that too is integrated exactly.
    """
    return element_moments(points, nodes, kind).volume


@dataclass(frozen=True)
class Moments:
    """Volume [m³], shape (n,), and volume times centroid [m⁴], shape (n, 3), of elements."""

    volume: FloatArray
    first: FloatArray


def element_moments(points: FloatArray, nodes: IntArray, kind: str) -> Moments:
    """Signed volume and first moment of solid elements."""
    # det J has degree 3 (p - 1) in a tetrahedron and at most 3 p - 1 in each coordinate otherwise, and x has p.
    p = KINDS[kind].order
    degree = 3 * (p - 1) + p if KINDS[kind].corners == "tetra" else 4 * p - 1
    places, weights = quadrature(kind, degree)
    values, gradients = shape_functions(kind, places)
    volume, first = np.empty(len(nodes)), np.empty((len(nodes), 3))
    for start in range(0, len(nodes), _CHUNK):
        part = nodes[start : start + _CHUNK]
        shares = determinants(jacobians(points, part, gradients)) * weights
        volume[start : start + _CHUNK] = shares.sum(axis=1)
        first[start : start + _CHUNK] = np.einsum("ea,eai->ei", shares @ values, points[part])
    return Moments(volume, first)


_CHUNK = 4096  # elements at a time: bounds the working memory
