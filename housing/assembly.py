"""Stiffness and mass of an elastic solid, assembled by blocks of 3 x 3 between pairs of nodes.

A displacement field takes the scalar shape functions N_a three times over, so all that an element contributes
is in the products of their gradients,

    G[a j, b l] = ∫ ∂_j N_a ∂_l N_b dV,        m[a, b] = ρ ∫ N_a N_b dV,

from which Hooke's law for an isotropic solid with Lamé's constants λ, μ makes

    K[a i, b k] = λ G[a i, b k] + μ G[a k, b i] + μ δ_ik Σ_j G[a j, b j],        M[a i, b k] = δ_ik m[a, b].

scikit-fem gives the element and its quadrature. K is summed into one 3 x 3 block for each pair of nodes that
share an element (the pairs are found once, by sorting), and M is the scalar mass on the same pairs, M = m ⊗ I₃.
Degree of freedom 3 n + i is component i of node n.
"""

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError
from housing.material import Material
from housing.matrices import Matrices
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]

_CHUNK = 4096  # elements at a time: bounds the working memory to some 100 MB


def assemble(mesh: Mesh, material: Material) -> Matrices:
    """Assemble the stiffness and the consistent mass of the free solid.

    Straight elements are integrated exactly: to degree 2 (p - 1) for the stiffness and 2 p for the mass, with p
    the order of the elements. Elements with a curved side take the same points on their isoparametric mapping.

    Raises
    ------
    HousingError
        Where a node belongs to no element, or an element's curved sides fold it.
    """
    unused = int(np.count_nonzero(np.bincount(mesh.cells.ravel(), minlength=len(mesh.points)) == 0))
    if unused:
        raise HousingError(f"{unused} of the mesh's {len(mesh.points)} nodes belong to no element; leave them out")
    n_nodes, per_element = len(mesh.points), mesh.cells.shape[1]
    rows = np.repeat(mesh.cells, per_element, axis=1).ravel()
    columns = np.tile(mesh.cells, per_element).ravel()
    keys, slots = np.unique(rows * n_nodes + columns, return_inverse=True)
    slots = slots.reshape(len(mesh.cells), -1)

    lam, mu = material.lame
    blocks = np.zeros((3, 3, len(keys)))
    scalar_mass = np.zeros(len(keys))
    for start in range(0, len(mesh.cells), _CHUNK):
        cells = mesh.cells[start : start + _CHUNK]
        slot = slots[start : start + _CHUNK].ravel()
        products = _gradient_products(mesh, cells)
        trace = mu * (products[:, :, 0, :, 0] + products[:, :, 1, :, 1] + products[:, :, 2, :, 2])
        for i in range(3):
            for k in range(3):
                element = lam * products[:, :, i, :, k] + mu * products[:, :, k, :, i]
                if i == k:
                    element = element + trace
                blocks[i, k] += np.bincount(slot, element.ravel(), minlength=len(keys))
        scalar_mass += np.bincount(slot, material.density * _shape_products(mesh, cells).ravel(), minlength=len(keys))

    row, column = np.divmod(keys, n_nodes)
    pointer = np.searchsorted(row, np.arange(n_nodes + 1)).astype(np.int32)
    return Matrices(
        pointer=pointer,
        neighbors=column.astype(np.int32),
        blocks=np.ascontiguousarray(np.moveaxis(blocks, 2, 0)),
        node_mass=scalar_mass,
    )


def _gradient_products(mesh: Mesh, cells: npt.NDArray[np.int64]) -> FloatArray:
    """G of some elements [m], shape (n_cells, n_shape, 3, n_shape, 3)."""
    _, reference, weights = _shape_functions(mesh.order, degree=2 * (mesh.order - 1))
    jacobian = np.einsum("eai,qaj->eqij", mesh.points[cells], reference, optimize=True)
    scale = np.sqrt(_point_volumes(jacobian, weights))
    gradients = np.einsum("qaj,eqji->eqai", reference, np.linalg.inv(jacobian), optimize=True)
    rooted = (gradients * scale[:, :, None, None]).reshape(*scale.shape, -1)
    products = rooted.transpose(0, 2, 1) @ rooted
    n_shape = cells.shape[1]
    return np.asarray(products.reshape(-1, n_shape, 3, n_shape, 3))


def _shape_products(mesh: Mesh, cells: npt.NDArray[np.int64]) -> FloatArray:
    """∫ N_a N_b dV of some elements [m³], shape (n_cells, n_shape, n_shape)."""
    values, reference, weights = _shape_functions(mesh.order, degree=2 * mesh.order)
    jacobian = np.einsum("eai,qaj->eqij", mesh.points[cells], reference, optimize=True)
    volumes = _point_volumes(jacobian, weights)
    outer = np.einsum("qa,qb->qab", values, values).reshape(len(weights), -1)
    return np.asarray((volumes @ outer).reshape(len(cells), values.shape[1], -1))


def _point_volumes(jacobian: FloatArray, weights: FloatArray) -> FloatArray:
    """Volume that each quadrature point stands for [m³], shape (n_cells, n_points)."""
    determinant = np.linalg.det(jacobian)
    folded = int(np.count_nonzero((determinant <= 0.0).any(axis=1)))
    if folded:
        raise HousingError(
            f"{folded} elements are folded by their curved sides: refine the mesh where it is curved, or use order 1"
        )
    return np.asarray(weights * determinant)


def _shape_functions(order: int, degree: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """scikit-fem's tetrahedron at its quadrature points.

    Returns
    -------
    values : ndarray, shape (n_points, n_shape)
    gradients : ndarray, shape (n_points, n_shape, 3)
        By the reference coordinates.
    weights : ndarray, shape (n_points,)
    """
    from skfem import ElementTetP1, ElementTetP2
    from skfem.quadrature import get_quadrature

    element = ElementTetP1() if order == 1 else ElementTetP2()
    points, weights = get_quadrature(element.refdom, max(degree, 1))
    pairs = [element.lbasis(points, number) for number in range(len(element.doflocs))]
    values = np.array([np.broadcast_to(value, weights.shape) for value, _ in pairs]).T
    gradients = np.array([np.broadcast_to(gradient, points.shape) for _, gradient in pairs]).transpose(2, 0, 1)
    return values, gradients, np.asarray(weights)
