"""Stiffness and mass of an elastic solid, assembled by blocks of 3 x 3 between pairs of nodes.

Each component of the displacement field has the scalar shape functions N_a, so that the matrices of an element follow
from the products of their gradients,

    G[a j, b l] = ∫ ∂_j N_a ∂_l N_b dV,        m[a, b] = ρ ∫ N_a N_b dV,

from which Hooke's law for an isotropic solid with Lamé's constants λ, μ makes

    K[a i, b k] = λ G[a i, b k] + μ G[a k, b i] + μ δ_ik Σ_j G[a j, b j],        M[a i, b k] = δ_ik m[a, b].

scikit-fem gives the elements and their quadrature (:mod:`gearwhine.meshes.shape_functions`). For each pair of an
element's nodes one order is computed and summed, transposed where it lies below the diagonal, so that K and M are
symmetric to the last bit. The pattern is that of the product Eᵀ E of the elements' incidence E. Degree of freedom 3 n +
i is component i of node n.
"""

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.material import Material, element_constants
from gearwhine.meshes import ElementBlock, Mesh
from gearwhine.meshes.elements import ElementKind
from gearwhine.meshes.shape_functions import determinants, inverses, jacobians, quadrature, shape_functions
from gearwhine.numerics.arrays import FloatArray, IntArray

_WORKING_SET = 2**20  # numbers in the gradient products of one chunk: 8 MB
# Rounding of a middle node's distance from the middle of its edge, as a part of the element.
_STRAIGHT_EDGE_ROUNDING = 1e-9


def assemble(
    mesh: Mesh,
    material: Material,
    materials: Mapping[str, Material] | None = None,
    *,
    threads: int = 2,
    chunk: int | None = None,
) -> Matrices:
    """Assemble the stiffness and the consistent mass of the free solid.

    Parameters
    ----------
    mesh : Mesh
    material : Material
        Material of every element that no entry of ``materials`` covers.
    materials : mapping of str to Material, optional
        The material of each named volume of the mesh.
    threads : int
        Number of threads that compute elements; the result is the same to the last bit for any number.
    chunk : int, optional
        Elements computed at a time, by each thread; by default as many as keep its arrays to a few tens of MB.

    Raises
    ------
    HousingError
        Where a node belongs to no element, an element's curved sides fold it, or volumes with a material of their own
        are unknown or overlap.

    Notes
    -----
    The quadrature is exact for affine elements: in a tetrahedron of order p to degree 2 (p - 1) for the stiffness and
    2 p for the mass; in a brick to degree 2 p in each coordinate, which the product of two gradients has (the shape
    functions have p in each); in a wedge to degree 2 p in the triangle and along the axis. Where sides are curved, or
    opposite faces of a brick not parallel, 1 / det J makes the stiffness's integrand rational, which no rule holds
    exactly. Degree 2 (p - 1) would keep its error below that of the element's own interpolation (Ciarlet and Raviart
    1972), and yet move frequencies by parts of 1e-4 where few elements go round a bore; curved tetrahedra have
    degree 2 p + 1 in the stiffness, which leaves parts of 1e-6.
    """
    if threads < 1 or (chunk is not None and chunk < 1):
        raise HousingError(f"{threads} threads and chunks of {chunk} elements: give at least 1 of both")
    unused = len(mesh.points) - len(mesh.used_nodes)
    if unused:
        raise HousingError(f"{unused} of the mesh's {len(mesh.points)} nodes belong to no element; leave them out")
    constants = element_constants(mesh, material, materials or {})
    pattern = _node_graph(mesh)
    blocks = np.zeros((pattern.nnz, 9))
    node_mass = np.zeros(pattern.nnz)
    try:
        for share in _in_order(
            _chunks(mesh, chunk), lambda part: _contribution(mesh, part, constants, pattern), threads
        ):
            for component, values in enumerate(share.stiffness):
                np.add.at(blocks[:, component], share.slots, values)
            np.add.at(node_mass, share.slots, share.mass)
    except _FoldedError:
        raise _folded(mesh) from None
    whole = blocks.reshape(-1, 3, 3)
    diagonal = whole[pattern.indptr[:-1]]
    whole[pattern.indptr[:-1]] = 0.5 * (diagonal + diagonal.transpose(0, 2, 1))  # symmetric but for rounding
    return Matrices(pattern.indptr.astype(np.int32), pattern.indices.astype(np.int32), whole, node_mass)


class _FoldedError(Exception):
    """An element of a chunk has no positive volume at a quadrature point."""


@dataclass(frozen=True)
class _Chunk:
    """Some elements of one kind, all affine or not: their numbers over all blocks, their nodes."""

    kind: ElementKind
    elements: IntArray
    nodes: IntArray
    affine: bool


@dataclass(frozen=True)
class _Contribution:
    """Contribution of a chunk: slots in the pattern, shape (n,), K by components, shape (9, n), and m, shape (n,)."""

    slots: IntArray
    stiffness: FloatArray
    mass: FloatArray


def _chunks(mesh: Mesh, size: int | None) -> Iterator[_Chunk]:
    first = 0
    for block in mesh.blocks:
        step = size or max(1, _WORKING_SET // (3 * block.of.n_nodes) ** 2)
        straight = straight_elements(mesh.points, block)
        for affine in (True, False):
            members = np.flatnonzero(straight == affine)
            for start in range(0, len(members), step):
                part = members[start : start + step]
                yield _Chunk(block.of, first + part, block.nodes[part], affine)
        first += len(block)


def straight_elements(points: FloatArray, block: ElementBlock) -> npt.NDArray[np.bool_]:
    """Whether each element is an affine tetrahedron: its middle nodes, where it has some, lie half way."""
    if block.of.corners != "tetra":
        return np.zeros(len(block), dtype=bool)
    if block.of.order == 1:
        return np.ones(len(block), dtype=bool)
    places, reference = points[block.nodes], np.array(block.of.places[4:])
    barycentric = np.column_stack([1.0 - reference.sum(axis=1), reference])
    off = np.abs(places[:, 4:] - barycentric @ places[:, :4]).max(axis=(1, 2))
    return np.asarray(off <= _STRAIGHT_EDGE_ROUNDING * np.ptp(places[:, :4], axis=1).max(axis=1))


def stiffness_degree(kind: ElementKind, *, affine: bool) -> int:
    """Return the quadrature degree of the stiffness of elements of a kind; see :func:`assemble`."""
    if kind.corners != "tetra":
        return 2 * kind.order
    # Bent ones have the next rule whose weights are all positive: the rule of degree 4 has a negative one.
    return 2 * (kind.order - 1) if affine else 2 * kind.order + 1


def _in_order(
    chunks: Iterator[_Chunk], compute: Callable[[_Chunk], _Contribution], threads: int
) -> Iterator[_Contribution]:
    """Contributions in the order of the chunks, computed ahead by threads, no further than one for each."""
    if threads == 1:
        yield from map(compute, chunks)
        return
    with ThreadPoolExecutor(threads) as pool:
        ahead: deque[Future[_Contribution]] = deque()
        for chunk in chunks:
            ahead.append(pool.submit(compute, chunk))
            if len(ahead) > threads:
                yield ahead.popleft().result()
        while ahead:
            yield ahead.popleft().result()


def _node_graph(mesh: Mesh) -> sparse.csr_array:
    """Graph of nodes that share an element, upper triangle, rows in order; the value of each entry is its place."""
    incidence = mesh.incidence
    graph = sparse.csr_array(sparse.triu(incidence.T @ incidence, format="csr"))
    graph.sort_indices()
    # Counting from one, since a stored zero would be none.
    places = np.arange(1, graph.nnz + 1, dtype=np.int64)
    return sparse.csr_array((places, graph.indices, graph.indptr), shape=graph.shape)


def _contribution(mesh: Mesh, chunk: _Chunk, constants: FloatArray, pattern: sparse.csr_array) -> _Contribution:
    kind, nodes = chunk.kind, chunk.nodes
    first, second = np.triu_indices(kind.n_nodes)
    products = _gradient_products(mesh, kind, nodes, first, second, stiffness_degree(kind, affine=chunk.affine))
    lam, mu, density = constants[:, chunk.elements, None]
    trace = mu * (products[:, 0] + products[:, 4] + products[:, 8])
    stiffness = np.empty((9, *trace.shape))
    for i in range(3):
        for k in range(3):
            entry = stiffness[3 * i + k]
            np.multiply(products[:, 3 * i + k], lam, out=entry)
            entry += mu * products[:, 3 * k + i]
            if i == k:
                entry += trace
    mass = density * _shape_products(mesh, kind, nodes, first, second)
    rows, columns = nodes[:, first], nodes[:, second]
    below = rows > columns
    for i, k in ((0, 1), (0, 2), (1, 2)):
        upper, lower = stiffness[3 * i + k], stiffness[3 * k + i]
        exchanged = np.where(below, lower, upper)
        np.copyto(lower, upper, where=below)
        upper[:] = exchanged
    slots = pattern[np.minimum(rows, columns).ravel(), np.maximum(rows, columns).ravel()] - 1
    return _Contribution(np.asarray(slots), stiffness.reshape(9, -1), mass.ravel())


def _gradient_products(
    mesh: Mesh, kind: ElementKind, nodes: IntArray, first: IntArray, second: IntArray, degree: int
) -> FloatArray:
    """G[a j, b l] of pairs a, b of some elements [m], shape (n_elements, 9, n_pairs), the second axis j l."""
    places, weights = quadrature(kind.name, degree)
    reference = shape_functions(kind.name, places)[1]
    jacobian = jacobians(mesh.points, nodes, reference)
    determinant = determinants(jacobian)
    scale = np.sqrt(_point_volumes(determinant, weights))
    inverse = inverses(jacobian, determinant)
    # By components first, then as matrices (points, shape functions x components) for one product for each element.
    rooted = np.empty((*scale.shape, kind.n_nodes, 3))
    for i in range(3):
        slope = sum(inverse[j, i][:, :, None] * reference[:, :, j] for j in range(3))
        rooted[..., i] = slope * scale[:, :, None]
    flat = rooted.reshape(*scale.shape, -1)
    products = (flat.transpose(0, 2, 1) @ flat).reshape(len(nodes), -1)
    components = np.arange(3)
    rows = 3 * first + components[:, None, None]
    columns = 3 * second + components[:, None]
    chosen = (rows * (3 * kind.n_nodes) + columns).ravel()
    return np.asarray(products.take(chosen, axis=1).reshape(len(nodes), 9, len(first)))


def _shape_products(mesh: Mesh, kind: ElementKind, nodes: IntArray, first: IntArray, second: IntArray) -> FloatArray:
    """∫ N_a N_b dV of pairs a, b of some elements [m³], shape (n_elements, n_pairs)."""
    places, weights = quadrature(kind.name, 2 * kind.order)
    values, reference = shape_functions(kind.name, places)
    volumes = _point_volumes(determinants(jacobians(mesh.points, nodes, reference)), weights)
    return np.asarray(volumes @ (values[:, first] * values[:, second]))


def _point_volumes(determinant: FloatArray, weights: FloatArray) -> FloatArray:
    """Volume that each quadrature point stands for [m³], shape (n_elements, n_points)."""
    if (determinant <= 0.0).any():
        raise _FoldedError
    return np.asarray(weights * determinant)


def _folded(mesh: Mesh) -> HousingError:
    """Error for a mesh with folded elements."""
    folded = np.concatenate([_folds(mesh, block) for block in mesh.blocks])
    x, y, z = mesh.centers[np.argmax(folded)]
    return HousingError(
        f"{np.count_nonzero(folded)} elements are folded by their curved sides, the first at ({x:.6g}, {y:.6g}, "
        f"{z:.6g}) m: refine the mesh where it is curved, or use order 1"
    )


def _folds(mesh: Mesh, block: ElementBlock) -> npt.NDArray[np.bool_]:
    """Whether each element has a negative volume at a quadrature point of mass or stiffness."""
    folds = np.zeros(len(block), dtype=bool)
    for degree in {2 * block.of.order, stiffness_degree(block.of, affine=False)}:
        reference = shape_functions(block.kind, quadrature(block.kind, degree)[0])[1]
        folds |= (determinants(jacobians(mesh.points, block.nodes, reference)) <= 0.0).any(axis=1)
    return folds
