"""Shape functions, quadrature and Jacobians of every kind of element, from scikit-fem, with the nodes in VTK's order.

scikit-fem numbers nodes in its own way; the two orders are matched by the reference coordinates of the nodes. Two
things that scikit-fem lacks are made here: the fifteen-node wedge, and a quadrature for wedges, the product of those
of a triangle and a line.

The Jacobians of the map from the reference element give volumes and first moments of elements.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from gearwhine.meshes.elements import KINDS
from gearwhine.numerics.arrays import FloatArray, IntArray


def shape_functions(kind: str, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shape functions at points of the reference element.

    Parameters
    ----------
    kind : str
    points : ndarray, shape (dimension, n_points)
        Reference coordinates.

    Returns
    -------
    values : ndarray, shape (n_points, n_nodes)
    gradients : ndarray, shape (n_points, n_nodes, dimension)
        Derivatives by the reference coordinates.
    """
    element, order = _element(kind)
    pairs = [element.lbasis(points, number) for number in order]
    shape = (points.shape[1],)
    values = np.array([np.broadcast_to(value, shape) for value, _ in pairs]).T
    gradients = np.array([np.broadcast_to(np.asarray(gradient), points.shape) for _, gradient in pairs])
    return np.ascontiguousarray(values), np.ascontiguousarray(gradients.transpose(2, 0, 1))


@cache
def quadrature(kind: str, degree: int) -> tuple[FloatArray, FloatArray]:
    """Points and weights on the reference element.

    Triangles and tetrahedra are integrated exactly to a total degree, quadrilaterals and hexahedra to that degree in
    each coordinate, wedges to that degree in the triangle and along the axis.

    Returns
    -------
    points : ndarray, shape (dimension, n_points)
    weights : ndarray, shape (n_points,)
        Weights, whose sum is the volume of the reference element.
    """
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefHex, RefLine, RefQuad, RefTet, RefTri

    corners = KINDS[kind].corners
    if corners == "wedge":
        across, across_weights = get_quadrature(RefTri, max(degree, 1))
        along, along_weights = get_quadrature(RefLine, max(degree, 1))
        n_across, n_along = len(across_weights), len(along_weights)
        points = np.vstack([np.repeat(across, n_along, axis=1), np.tile(along, n_across)])
        return points, np.outer(across_weights, along_weights).ravel()
    domain = {"triangle": RefTri, "quad": RefQuad, "tetra": RefTet, "hexahedron": RefHex}[corners]
    points, weights = get_quadrature(domain, max(degree, 1))
    return np.asarray(points), np.asarray(weights)


def reference_element(kind: str) -> Any:
    """scikit-fem's element of a kind; see :func:`node_order` for its numbering.

    Returns
    -------
    skfem.Element
    """
    import skfem

    if kind == "wedge15":
        return _wedge15()
    return {
        "triangle": skfem.ElementTriP1,
        "triangle6": skfem.ElementTriP2,
        "quad": skfem.ElementQuad1,
        "quad8": skfem.ElementQuadS2,
        "quad9": skfem.ElementQuad2,
        "tetra": skfem.ElementTetP1,
        "tetra10": skfem.ElementTetP2,
        "hexahedron": skfem.ElementHex1,
        "hexahedron20": skfem.ElementHexS2,
        "hexahedron27": skfem.ElementHex2,
        "wedge": skfem.ElementWedge1,
    }[kind]()


def node_order(kind: str) -> list[int]:
    """Return the number in scikit-fem's element of each node in VTK's order."""
    return _element(kind)[1]


@cache
def _element(kind: str) -> tuple[Any, list[int]]:
    element, places = reference_element(kind), np.array(KINDS[kind].places)
    apart = np.abs(places[:, None] - np.asarray(element.doflocs)[None]).max(axis=2)
    order = np.argmin(apart, axis=1).tolist()
    assert apart.min(axis=1).max() < 1e-12, kind
    assert sorted(order) == list(range(len(places))), kind
    return element, order


def _wedge15() -> Any:
    """Make the quadratic serendipity wedge as an element in scikit-fem's form, nodes in VTK's order.

    With the triangle's coordinates L = (1 - x - y, x, y), the bottom 1 - z and the top z, its functions are

        corner of the bottom:  L_i (1 - z) (2 L_i - 2 z - 1)        and of the top with z for 1 - z,
        middle on the bottom:  4 L_i L_j (1 - z)                    and of the top with z for 1 - z,
        middle upright:        4 L_i z (1 - z).
    """
    from skfem.element import ElementH1
    from skfem.refdom import RefWedge

    class ElementWedge15(ElementH1):  # type: ignore[misc]
        nodal_dofs = 1
        edge_dofs = 1
        maxdeg = 4
        dofnames = ("u", "u")
        doflocs = np.array(KINDS["wedge15"].places)
        refdom = RefWedge

        def lbasis(self, points: FloatArray, number: int) -> tuple[FloatArray, FloatArray]:
            """Value and gradient of one shape function."""
            x, y, z = points
            flat = (1.0 - x - y, x, y)
            slopes = ((-1.0, -1.0), (1.0, 0.0), (0.0, 1.0))
            top = number in (3, 4, 5, 9, 10, 11)
            height, rise = (z, 1.0) if top else (1.0 - z, -1.0)
            if number < 6:
                share, (by_x, by_y) = flat[number % 3], slopes[number % 3]
                bracket = 2.0 * share + 2.0 * height - 3.0
                by_share = height * (bracket + 2.0 * share)
                by_height = share * (bracket + 2.0 * height)
                return share * height * bracket, np.array([by_share * by_x, by_share * by_y, by_height * rise])
            if number < 12:
                i, j = ((0, 1), (1, 2), (2, 0))[number % 3]
                across = [4.0 * height * (flat[i] * slopes[j][k] + flat[j] * slopes[i][k]) for k in range(2)]
                return 4.0 * flat[i] * flat[j] * height, np.array([*across, 4.0 * flat[i] * flat[j] * rise])
            share, (by_x, by_y) = flat[number % 3], slopes[number % 3]
            bubble = 4.0 * z * (1.0 - z)
            return share * bubble, np.array([bubble * by_x, bubble * by_y, 4.0 * share * (1.0 - 2.0 * z)])

    return ElementWedge15()


def jacobians(points: FloatArray, nodes: IntArray, gradients: FloatArray) -> FloatArray:
    """∂x_i / ∂ξ_j of elements at some reference points.

    Parameters
    ----------
    points : ndarray, shape (n_points, 3)
        Places of the nodes [m].
    nodes : ndarray of int, shape (n_elements, n_nodes)
    gradients : ndarray, shape (n_places, n_nodes, dimension)
        Derivatives of the shape functions by the reference coordinates.

    Returns
    -------
    ndarray, shape (3, dimension, n_elements, n_places)
        Jacobians [m]. The component comes first, so that each one is a plain array over elements and places.
    """
    n_places, n_nodes, dimension = gradients.shape
    flat = gradients.transpose(1, 2, 0).reshape(n_nodes, dimension * n_places)
    coordinates = points[nodes].transpose(2, 0, 1).reshape(3 * len(nodes), n_nodes)
    product = (coordinates @ flat).reshape(3, len(nodes), dimension, n_places)
    return np.ascontiguousarray(product.transpose(0, 2, 1, 3))


def determinants(jacobian: FloatArray) -> FloatArray:
    """Compute the determinants of Jacobians of solids, shape (3, 3, ...) to (...)."""
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
