"""Discretisation error of each mode's frequency, estimated from its own stress field by stress recovery.

Finite elements make a mode too stiff: with the error e = φ_h - φ of a mode of unit modal mass and its energy a(e, e),
the eigenvalue exceeds the exact one by λ_h - λ = a(e, e) - λ |e|²_M (Strang and Fix 1973, section 6.3), whose second
term is of higher order. The energy is that of the stresses' error, and in place of the unknown stresses a recovered
field σ* stands, which is continuous and nearer to them than the elements' own σ_h (Zienkiewicz and Zhu 1987,
International Journal for Numerical Methods in Engineering 24, 337-357):

    η² = ∫ (σ* - σ_h) : C⁻¹ : (σ* - σ_h) dV / λ_h,        λ ≈ (1 - η²) λ_h.

The recovery takes σ_h at the points of the reduced quadrature, where it is most accurate and free of the parasitic
shear of elements that bend (Hinton and Campbell 1974, same journal 8, 461-480; Barlow 1976, 10, 243-251), extends it to
the nodes, and takes the mean over the elements of one material there. On the free surface it then removes the traction,
which is known to be zero: both tractions at an edge that points outward, none at an inner edge, where stresses are
singular. Walls with one element through the thickness have all their nodes on the surface, and live on this.

The estimate is the relative error ω_h / ω - 1 with a factor of safety on its logarithm, ln(ω_h / ω) = - s/2 ln(1 - η²).
It covers the displacement field alone. The error of geometry, of bores that are polygons, is not in it.
"""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.housing.fem.matrices import Matrices
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import ElementBlock, facet_centers, facet_normals
from gearwhine.meshes.shape_functions import determinants, inverses, jacobians, quadrature, shape_functions
from gearwhine.numerics.arrays import FloatArray, IntArray

SAFETY = 1.5
"""Factor of safety s of the estimate.

Beside refined meshes of thin boxes, rings, blocks and a casting the bare estimate
has 0.8 to 1.5 of the true error in the median over a mesh's modes, whatever the elements."""

_LARGEST_ERROR_SHARE = 0.999  # largest η²: beyond it the logarithm says no more than "nothing of this mode is right"
_EDGE = 0.15  # mean of (n · t)² over facets about a node from which its surface has two normals: a kink of 45°
_WORKING_SET = 2**18  # numbers in the stresses of one chunk: 2 MB
_NODAL_STRESSES = 2**24  # numbers in the nodal stresses of the modes treated at once: 128 MB
_STRESS_COMPONENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))  # components of a stress as rows and columns


def discretisation_errors(
    mesh: Mesh,
    constants: FloatArray,
    frequencies: FloatArray,
    shapes: FloatArray,
    *,
    loaded: IntArray | None = None,
) -> FloatArray:
    """Estimate the relative error ω_h / ω - 1 of each natural frequency by the mesh.

    Parameters
    ----------
    mesh : Mesh
    constants : ndarray, shape (3, n_elements)
        λ, μ [Pa] and ρ [kg/m³] of each element, see :func:`gearwhine.housing.material.element_constants`.
    frequencies : ndarray, shape (n_modes,)
        ω_h [rad/s].
    shapes : ndarray, shape (n_modes, n_nodes, 3)
        Mode shapes of unit modal mass [1/√kg].
    loaded : ndarray of int, optional
        Nodes on which supports or other fixtures act, and where the surface therefore bears a traction.

    Returns
    -------
    ndarray, shape (n_modes,)
        Estimates with the factor of safety :data:`SAFETY`; 0 for rigid modes.
    """
    elastic = np.flatnonzero(frequencies > 0.0)
    share = np.zeros(len(frequencies))
    groups = np.unique(constants[:2], axis=1, return_inverse=True)[1].ravel()
    free = _free_surface(mesh, loaded)
    step = max(1, _NODAL_STRESSES // (6 * len(mesh.points)))
    for start in range(0, len(elastic), step):
        chosen = elastic[start : start + step]
        # Components in one row for each node, so that one product gives the gradients of all modes.
        motions = np.ascontiguousarray(shapes[chosen].transpose(1, 2, 0)).reshape(len(mesh.points), -1)
        energy = np.zeros(len(chosen))
        for group in range(int(groups.max()) + 1):
            lam, mu = constants[:2, np.argmax(groups == group)]
            blocks = tuple(_members(mesh, groups == group))
            recovered = _nodal_stresses(mesh.points, blocks, motions, (lam, mu))
            _remove_tractions(recovered, *free)
            energy += _energy_of_error(mesh.points, blocks, motions, recovered, (lam, mu))
        share[chosen] = energy / frequencies[chosen] ** 2
    return np.asarray(np.expm1(-0.5 * SAFETY * np.log1p(-np.minimum(share, _LARGEST_ERROR_SHARE))))


def fixture_nodes(free: Matrices, whole: Matrices) -> IntArray:
    """Nodes on which fixtures act, by the matrices without and with them, ascending."""
    stiffer = whole.blocks[whole.pointer[:-1]] != free.blocks[free.pointer[:-1]]
    parts = [whole.fixed // 3, np.flatnonzero(stiffer.any(axis=(1, 2))), whole.attached_mass.rows]
    return np.unique(np.concatenate(parts))


def _members(mesh: Mesh, chosen: npt.NDArray[np.bool_]) -> Iterator[ElementBlock]:
    for block, members in zip(mesh.blocks, np.split(chosen, mesh.block_ends), strict=True):
        if members.any():
            yield ElementBlock(block.kind, block.nodes[members])


def _chunks(block: ElementBlock, n_points: int, n_modes: int) -> Iterator[IntArray]:
    step = max(16, _WORKING_SET // (9 * n_points * n_modes))
    for start in range(0, len(block), step):
        yield block.nodes[start : start + step]


def _stresses(
    points: FloatArray, nodes: IntArray, reference: FloatArray, motions: FloatArray, lame: tuple[float, float]
) -> tuple[FloatArray, FloatArray]:
    """Stresses of elements at points of the reference element, shape (n_elements, n_points, 6, n_modes), and det J."""
    lam, mu = lame
    jacobian = jacobians(points, nodes, reference)
    determinant = determinants(jacobian)
    inverse = inverses(jacobian, determinant)
    slopes = np.empty((*determinant.shape, 3, nodes.shape[1]))
    for i in range(3):
        slopes[:, :, i] = sum(inverse[j, i][:, :, None] * reference[:, :, j] for j in range(3))
    n, q = determinant.shape
    gradients = (slopes.reshape(n, 3 * q, -1) @ motions[nodes]).reshape(n, q, 3, 3, -1)
    stresses = np.empty((n, q, 6, gradients.shape[-1]))
    for place, (i, j) in enumerate(_STRESS_COMPONENTS):
        np.add(gradients[:, :, i, j], gradients[:, :, j, i], out=stresses[:, :, place])
    stresses *= mu
    stresses[:, :, :3] += (0.5 * lam / mu) * stresses[:, :, :3].sum(axis=2, keepdims=True)
    return stresses, determinant


def _nodal_stresses(
    points: FloatArray, blocks: tuple[ElementBlock, ...], motions: FloatArray, lame: tuple[float, float]
) -> FloatArray:
    """Mean at each node of the stresses that its elements have there, shape (n_nodes, 6, n_modes)."""
    n_modes = motions.shape[1] // 3
    total = np.zeros((len(points), 6 * n_modes))
    count: FloatArray = np.zeros(len(points))
    for block in blocks:
        places, weights = quadrature(block.kind, block.of.order)
        reference = shape_functions(block.kind, places)[1]
        # By the functions of order 1: what the few points determine, and no more.
        linear = shape_functions(block.of.corners, places)[0]
        extension = shape_functions(block.of.corners, np.array(block.of.places).T)[0] @ np.linalg.pinv(linear)
        for nodes in _chunks(block, len(weights), n_modes):
            sampled = _stresses(points, nodes, reference, motions, lame)[0]
            nodal = (extension @ sampled.reshape(*sampled.shape[:2], -1)).reshape(nodes.size, -1)
            members, place = np.unique(nodes, return_inverse=True)
            gather = sparse.csr_array((np.ones(nodes.size), (place.ravel(), np.arange(nodes.size))))
            total[members] += gather @ nodal
            count[members] += np.bincount(place.ravel())
    total /= np.maximum(count, 1.0)[:, None]
    return total.reshape(len(points), 6, n_modes)


def _free_surface(mesh: Mesh, loaded: IntArray | None) -> tuple[IntArray, FloatArray]:
    """Nodes of the free surface, and the projection of each on the directions along the surface there, (n, 3, 3)."""
    facets = mesh.boundary
    normals, centers = facet_normals(mesh.points, facets), facet_centers(mesh.points, facets)
    rows = np.concatenate([block.nodes.ravel() for block in facets])
    widths = np.concatenate([np.full(len(block), block.of.n_nodes) for block in facets])
    facet = np.repeat(np.arange(len(normals)), widths)
    about = sparse.csr_array((np.ones(len(rows)), (rows, facet)), shape=(len(mesh.points), len(normals)))
    count: FloatArray = np.bincount(rows, minlength=len(mesh.points)).astype(np.float64)
    on_surface = count > 0
    if loaded is not None:
        on_surface[loaded] = False
    nodes = np.flatnonzero(on_surface)
    about = sparse.csr_array(sparse.diags_array(1.0 / count[nodes]) @ about[nodes])
    squares = np.asarray(about @ (normals[:, :, None] * normals[:, None]).reshape(-1, 9)).reshape(-1, 3, 3)
    values, directions = np.linalg.eigh(squares)
    is_normal = values >= _EDGE
    # The facets about an outer edge lie below its mean normal, those about an inner edge above it.
    rise = (np.asarray(about @ normals) * (np.asarray(about @ centers) - mesh.points[nodes])).sum(axis=1)
    keep = (is_normal.sum(axis=1) == 1) | (rise < 0.0)
    along = directions * ~is_normal[:, None]
    return nodes[keep], np.asarray(along[keep] @ directions[keep].transpose(0, 2, 1))


def _remove_tractions(stresses: FloatArray, nodes: IntArray, projection: FloatArray) -> None:
    """Replace the stresses of some nodes by P σ P, P their projection along the surface."""
    n_modes = stresses.shape[2]
    step = max(1, _WORKING_SET // (9 * n_modes))
    for start in range(0, len(nodes), step):
        members, along = nodes[start : start + step], projection[start : start + step]
        full = np.empty((len(members), 3, 3, n_modes))
        for place, (i, j) in enumerate(_STRESS_COMPONENTS):
            full[:, i, j] = full[:, j, i] = stresses[members, place]
        half = along @ full.reshape(len(members), 3, -1)
        both = along @ half.reshape(len(members), 3, 3, n_modes).transpose(0, 2, 1, 3).reshape(len(members), 3, -1)
        full = both.reshape(len(members), 3, 3, n_modes)
        for place, (i, j) in enumerate(_STRESS_COMPONENTS):
            stresses[members, place] = full[:, i, j]


def _energy_of_error(
    points: FloatArray,
    blocks: tuple[ElementBlock, ...],
    motions: FloatArray,
    recovered: FloatArray,
    lame: tuple[float, float],
) -> FloatArray:
    """∫ (σ* - σ_h) : C⁻¹ : (σ* - σ_h) dV of each mode, with σ* between the nodes as the motion is, shape (n_modes,)."""
    lam, mu = lame
    energy = np.zeros(recovered.shape[2])
    nodal = recovered.reshape(len(points), -1)
    for block in blocks:
        places, weights = quadrature(block.kind, 2 * block.of.order)
        values, reference = shape_functions(block.kind, places)
        for nodes in _chunks(block, len(weights), len(energy)):
            error, determinant = _stresses(points, nodes, reference, motions, lame)
            error -= (values @ nodal[nodes]).reshape(error.shape)
            trace = error[:, :, :3].sum(axis=2)
            error *= error
            density = error[:, :, :3].sum(axis=2) + 2.0 * error[:, :, 3:].sum(axis=2)
            density -= (lam / (3.0 * lam + 2.0 * mu)) * trace**2
            energy += (determinant * weights).ravel() @ density.reshape(-1, len(energy)) / (2.0 * mu)
    return energy
