"""Rates of a housing's stiffness and mass with a parameter, seen by its modes, with no matrix assembled.

A parameter moves nodes, changes what elements are made of, or changes what is fastened to them. With nodes that move at
the velocity V = dX/dp the gradient of a field that they carry changes by d(∂_j u_i) = -∂_l u_i ∂_j V_l and the volume
by div V, so that for two modes φ_a, φ_b of the stress σ = λ tr ε I + 2 μ ε

    dK_ab = ∫ σ(φ_a) : T_b + σ(φ_b) : T_a dV,      T_b = ½ div V ∇φ_b - ∇φ_b ∇V,
    dM_ab = ∫ ρ φ_a · φ_b div V dV,

(the velocity form of shape sensitivities: Haug, Choi and Komkov 1986, chapter 3). Taken with the elements' own
quadrature these are the exact derivatives of the assembled matrices, not approximations of them.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse

from housing.assembly import stiffness_degree, straight_elements
from housing.errors import HousingError
from meshes import ElementKind, Mesh
from meshes.mapping import determinants, inverses, jacobians
from meshes.shapes import quadrature, shape_functions

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_WORKING_SET = 2**21  # numbers in the modes' gradients of one chunk: 16 MB


@dataclass(frozen=True)
class ModelRate:
    """What a parameter changes in a model, for each unit of it; None where it does not.

    Attributes
    ----------
    velocity : ndarray, shape (n_nodes, 3), optional
        How fast the nodes move [m].
    constants : ndarray, shape (3, n_elements), optional
        Rates of λ, μ [Pa] and ρ [kg/m³] of each element.
    stiffness, mass : scipy.sparse array, shape (3 n_nodes, 3 n_nodes), optional
        Rates of what is attached.
    """

    velocity: FloatArray | None = None
    constants: FloatArray | None = None
    stiffness: sparse.csr_array | None = None
    mass: sparse.csr_array | None = None


@dataclass(frozen=True)
class ModalRates:
    """Rates of modal stiffness and mass with each of some parameters.

    Attributes
    ----------
    stiffness, mass : ndarray, shape (n_parameters, n_modes, n_modes)
        Φᵀ dK Φ [rad²/s²] and Φᵀ dM Φ [1], for each unit of the parameter.
    """

    stiffness: FloatArray
    mass: FloatArray

    def eigenvalues(self, frequencies: FloatArray) -> FloatArray:
        """dλ = φᵀ (dK - λ dM) φ of single modes [rad²/s²], shape (n_parameters, n_modes)."""
        diagonal = np.arange(len(frequencies))
        return np.asarray(self.stiffness[:, diagonal, diagonal] - frequencies**2 * self.mass[:, diagonal, diagonal])

    def mixtures(self, frequencies: FloatArray) -> FloatArray:
        """How fast each mode takes on the others, dφ_b = Σ_a φ_a c_ab, shape (n_parameters, n_modes, n_modes).

        c_ab = φ_aᵀ (dK - λ_b dM) φ_b / (λ_b - λ_a) and c_bb = -½ φ_bᵀ dM φ_b (Fox and Kapoor 1968): complete where the
        modes are; what modes above those at hand would add is missing. For modes that move apart from a common
        frequency it has no meaning.
        """
        eigenvalues = frequencies**2
        apart = eigenvalues[None, :] - eigenvalues[:, None]
        n = len(eigenvalues)
        with np.errstate(divide="ignore", invalid="ignore"):
            mixed = (self.stiffness - eigenvalues * self.mass) / apart
        diagonal = np.arange(n)
        mixed[:, diagonal, diagonal] = -0.5 * self.mass[:, diagonal, diagonal]
        return np.asarray(mixed)


def modal_rates(mesh: Mesh, constants: FloatArray, shapes: FloatArray, rates: Sequence[ModelRate]) -> ModalRates:
    """What the modes see of each parameter.

    Parameters
    ----------
    mesh : Mesh
    constants : ndarray, shape (3, n_elements)
        λ, μ [Pa] and ρ [kg/m³].
    shapes : ndarray, shape (n_modes, n_nodes, 3)
        Mass-normalised.
    rates : sequence of ModelRate

    Raises
    ------
    HousingError
        Where arrays do not fit the mesh.
    """
    n = len(shapes)
    for rate in rates:
        if rate.velocity is not None and rate.velocity.shape != mesh.points.shape:
            raise HousingError(
                f"velocity of shape {rate.velocity.shape}: expected that of the nodes {mesh.points.shape}"
            )
        if rate.constants is not None and rate.constants.shape != constants.shape:
            raise HousingError(f"constants' rates of shape {rate.constants.shape}: expected {constants.shape}")
    stiffness, mass = np.zeros((len(rates), n, n)), np.zeros((len(rates), n, n))
    flat = shapes.reshape(n, -1).T
    for number, rate in enumerate(rates):
        if rate.stiffness is not None:
            stiffness[number] += flat.T @ (rate.stiffness @ flat)
        if rate.mass is not None:
            mass[number] += flat.T @ (rate.mass @ flat)
    if any(rate.velocity is not None or rate.constants is not None for rate in rates):
        by_node = np.ascontiguousarray(shapes.transpose(1, 2, 0))
        for part in _parts(mesh, n):
            _add_stiffness(mesh, part, constants, by_node, rates, stiffness)
            _add_mass(mesh, part, constants, by_node, rates, mass)
    return ModalRates(0.5 * (stiffness + stiffness.transpose(0, 2, 1)), 0.5 * (mass + mass.transpose(0, 2, 1)))


@dataclass(frozen=True)
class _Part:
    """Some elements of one kind, all affine or not."""

    kind: ElementKind
    elements: IntArray
    nodes: IntArray
    affine: bool


def _parts(mesh: Mesh, n_modes: int) -> Iterator[_Part]:
    first = 0
    for block in mesh.blocks:
        straight = straight_elements(mesh.points, block)
        for affine in (True, False):
            members = np.flatnonzero(straight == affine)
            points = len(quadrature(block.kind, stiffness_degree(block.of, affine=affine))[1])
            step = max(1, _WORKING_SET // (9 * n_modes * points))
            for start in range(0, len(members), step):
                chosen = members[start : start + step]
                yield _Part(block.of, first + chosen, block.nodes[chosen], affine)
        first += len(block)


def _add_stiffness(
    mesh: Mesh,
    part: _Part,
    constants: FloatArray,
    by_node: FloatArray,
    rates: Sequence[ModelRate],
    stiffness: FloatArray,
) -> None:
    """Add the part's Φᵀ dK Φ, by one product of all points' stresses with what the parameter does to gradients."""
    places, weights = quadrature(part.kind.name, stiffness_degree(part.kind, affine=part.affine))
    reference = shape_functions(part.kind.name, places)[1]
    jacobian = jacobians(mesh.points, part.nodes, reference)
    determinant = determinants(jacobian)
    inverse = inverses(jacobian, determinant)
    # ∂_j N_a at each point, shape (n_elements, n_points, 3, n_nodes).
    slopes = np.einsum("kjeq,qak->eqja", inverse, reference, optimize=True)
    n_elements, n_points, _, n_nodes = slopes.shape
    n_modes = by_node.shape[2]
    fields = by_node[part.nodes].reshape(n_elements, n_nodes, 3 * n_modes)
    by_slope = (slopes.reshape(n_elements, -1, n_nodes) @ fields).reshape(n_elements * n_points, 3, 3, n_modes)
    gradients = np.ascontiguousarray(by_slope.transpose(0, 2, 1, 3))  # point, i, j of ∂_j φ_i, mode
    volumes = (determinant * weights).ravel()

    def stresses(lam: FloatArray, mu: FloatArray) -> FloatArray:
        lam, mu = (np.repeat(values, n_points)[:, None, None, None] for values in (lam, mu))
        stress = mu * (gradients + gradients.transpose(0, 2, 1, 3))
        diagonal = np.arange(3)
        stress[:, diagonal, diagonal] += lam[:, 0] * np.einsum("piim->pm", gradients)[:, None]
        stress *= volumes[:, None, None, None]
        return np.asarray(stress.reshape(-1, n_modes))

    own = None
    for number, rate in enumerate(rates):
        if rate.constants is not None:
            lam, mu, _ = rate.constants[:, part.elements]
            if lam.any() or mu.any():
                stiffness[number] += stresses(lam, mu).T @ gradients.reshape(-1, n_modes)
        if rate.velocity is not None and rate.velocity[part.nodes].any():
            own = stresses(*constants[:2, part.elements]) if own is None else own
            # ∂_j V_l as (point, j, l): rows of what multiplies ∇φ from the left, by its second index.
            velocity = (slopes.reshape(n_elements, -1, n_nodes) @ rate.velocity[part.nodes]).reshape(-1, 3, 3)
            factor = 0.5 * np.einsum("pjj->p", velocity)[:, None, None] * np.eye(3) - velocity
            tilted = (factor[:, None] @ gradients).reshape(-1, n_modes)
            half = own.T @ tilted
            stiffness[number] += half + half.T


def _add_mass(
    mesh: Mesh, part: _Part, constants: FloatArray, by_node: FloatArray, rates: Sequence[ModelRate], mass: FloatArray
) -> None:
    concerned = [
        number
        for number, rate in enumerate(rates)
        if (rate.velocity is not None and rate.velocity[part.nodes].any())
        or (rate.constants is not None and rate.constants[2, part.elements].any())
    ]
    if not concerned:
        return
    places, weights = quadrature(part.kind.name, 2 * part.kind.order)
    values, reference = shape_functions(part.kind.name, places)
    jacobian = jacobians(mesh.points, part.nodes, reference)
    determinant = determinants(jacobian)
    inverse = inverses(jacobian, determinant)
    n_modes = by_node.shape[2]
    density = constants[2, part.elements, None]
    nodes = part.nodes
    # Element matrices of scalar mass rates, then the modes' quadratic form: cheaper than the modes at every point.
    local = by_node[nodes].reshape(len(nodes), nodes.shape[1], 3 * n_modes)
    for number in concerned:
        rate = rates[number]
        amount = np.zeros_like(determinant)
        if rate.velocity is not None:
            divergence = np.einsum("kjeq,qak,eaj->eq", inverse, reference, rate.velocity[nodes], optimize=True)
            amount += density * divergence
        if rate.constants is not None:
            amount += rate.constants[2, part.elements, None]
        amount *= determinant * weights
        products = np.einsum("eq,qa,qb->eab", amount, values, values, optimize=True)
        carried = (products @ local).reshape(-1, n_modes)
        mass[number] += local.reshape(-1, n_modes).T @ carried
