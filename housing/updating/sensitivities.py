"""Modal sensitivities: derivatives of stiffness and mass by the parameters in modal coordinates, without assembly.

A parameter moves nodes, changes the elements' material, or changes fixtures. With nodes that move at
the velocity V = dX/dp the gradient of a field that they carry changes by d(∂_j u_i) = -∂_l u_i ∂_j V_l and the volume
by div V, so that for two modes φ_a, φ_b of the stress σ = λ tr ε I + 2 μ ε

    dK_ab = ∫ σ(φ_a) : T_b + σ(φ_b) : T_a dV,      T_b = ½ div V ∇φ_b - ∇φ_b ∇V,
    dM_ab = ∫ ρ φ_a · φ_b div V dV,

(the velocity form of shape sensitivities: Haug, Choi and Komkov 1986, chapter 3). With the elements' own quadrature
these are the exact derivatives of the assembled matrices.

Most of the work is in products of all modes with all modes, once for each parameter. So elements are grouped by the
parameters that concern them, σ : T is summed over the six components of the symmetric σ, and where div V is constant
within straight elements their modal masses are computed once and scaled for every parameter.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.assembly import stiffness_degree, straight_elements
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import ElementKind
from gearwhine.meshes.shape_functions import determinants, inverses, jacobians, quadrature, shape_functions
from gearwhine.numerics.arrays import BoolArray, FloatArray, IntArray

_WORKING_SET = 2**19  # numbers in the modes' gradients of one chunk: 4 MB, that a core keeps at hand
_EQUAL_VELOCITY_SHARE = 1e-10  # part of the largest velocity: nodes of an element that differ by less move as one
_EVEN_DIVERGENCE_SHARE = 1e-11  # part of the largest divergence below which its changes within elements are none

_PAIRS = ((0, 1), (1, 2), (2, 0))  # components of the shears, after the three stretches


@dataclass(frozen=True)
class Changes:
    """Changes of the elements by one parameter, in the elements' order.

    Attributes
    ----------
    velocity : ndarray, shape (n_nodes, 3), or None
        Velocity of the nodes [m] per unit of the parameter.
    constants : ndarray, shape (3, n_elements), or None
        Derivatives of λ, μ [Pa] and ρ [kg/m³].
    """

    velocity: FloatArray | None
    constants: FloatArray | None

    def concerned(self, nodes: IntArray, elements: IntArray) -> BoolArray:
        """Whether the parameter strains each element or changes its material, shape (n_elements,)."""
        either = np.zeros(len(nodes), dtype=bool)
        if self.velocity is not None:
            moved = self.velocity[nodes]
            apart = np.abs(moved - moved[:, :1]).max(axis=(1, 2))
            either |= apart > _EQUAL_VELOCITY_SHARE * np.abs(self.velocity).max(initial=0.0)
        if self.constants is not None:
            either |= self.constants[:, elements].any(axis=0)
        return either


@dataclass(frozen=True)
class Part:
    """Some elements of one kind, all affine or not.

    Attributes
    ----------
    kind : ElementKind
    elements : ndarray of int, shape (n,)
        Numbers of the elements over all blocks.
    nodes : ndarray of int, shape (n, n_nodes)
    affine : bool
    spans : tuple of (int, slice)
        Each parameter that concerns some of the elements, and the range of these elements.
    """

    kind: ElementKind
    elements: IntArray
    nodes: IntArray
    affine: bool
    spans: tuple[tuple[int, slice], ...]


def parts(mesh: Mesh, n_modes: int, changes: Sequence[Changes]) -> Iterator[Part]:
    """Yield the elements on which some parameter acts, in parts."""
    first = 0
    for block in mesh.blocks:
        straight = straight_elements(mesh.points, block)
        every = first + np.arange(len(block))
        concerned = np.array([change.concerned(block.nodes, every) for change in changes])
        for affine in (True, False):
            members = np.flatnonzero((straight == affine) & concerned.any(axis=0))
            if not len(members):
                continue
            members = members[np.lexsort(concerned[:, members])]
            points = len(quadrature(block.kind, stiffness_degree(block.of, affine=affine))[1])
            step = max(1, _WORKING_SET // (9 * n_modes * points))
            for start in range(0, len(members), step):
                chosen = members[start : start + step]
                spans = tuple(
                    (number, slice(int(places[0]), int(places[-1]) + 1))
                    for number, row in enumerate(concerned[:, chosen])
                    if len(places := np.flatnonzero(row))
                )
                yield Part(block.of, first + chosen, block.nodes[chosen], affine, spans)
        first += len(block)


@dataclass(frozen=True)
class _Places:
    """The quadrature points of a part's stiffness.

    Attributes
    ----------
    slopes : ndarray, shape (n_elements, n_points, 3, n_nodes)
        ∂_j N_a [1/m].
    volumes : ndarray, shape (n_elements, n_points)
        det J times the weight [m³].
    """

    slopes: FloatArray
    volumes: FloatArray

    @classmethod
    def of(cls, mesh: Mesh, part: Part, degree: int) -> "_Places":
        places, weights = quadrature(part.kind.name, degree)
        reference = shape_functions(part.kind.name, places)[1]
        jacobian = jacobians(mesh.points, part.nodes, reference)
        determinant = determinants(jacobian)
        inverse = inverses(jacobian, determinant)
        slopes = np.einsum("kjeq,qak->eqja", inverse, reference, optimize=True)
        return cls(np.ascontiguousarray(slopes), determinant * weights)

    def gradients(self, fields: FloatArray, span: slice = slice(None)) -> FloatArray:
        """∂_j f_i of nodal fields (n, n_nodes, m) of the elements of a span, shape (n, n_points, 3, m)."""
        slopes = self.slopes[span]
        n, points, _, nodes = slopes.shape
        return np.asarray((slopes.reshape(n, -1, nodes) @ fields).reshape(n, points, 3, -1))


def add_part(
    mesh: Mesh,
    part: Part,
    constants: FloatArray,
    by_node: FloatArray,
    changes: Sequence[Changes],
    stiffness: FloatArray,
    mass: FloatArray,
) -> None:
    """Add a part's Φᵀ dK Φ and Φᵀ dM Φ by each parameter.

    Parameters
    ----------
    mesh : Mesh
    part : Part
    constants : ndarray, shape (3, n_elements)
        λ, μ [Pa] and ρ [kg/m³].
    by_node : ndarray, shape (n_nodes, 3, n_modes)
        The modes.
    changes : sequence of Changes
    stiffness, mass : ndarray, shape (n_parameters, n_modes, n_modes)
    """
    places = _Places.of(mesh, part, stiffness_degree(part.kind, affine=part.affine))
    n_modes = by_node.shape[2]
    fields = by_node[part.nodes].reshape(*part.nodes.shape, 3 * n_modes)
    moving: dict[int, FloatArray] = {}
    for number, span in part.spans:
        velocity = changes[number].velocity
        if velocity is not None:
            moving[number] = places.gradients(velocity[part.nodes[span]], span)
    _add_stiffness(part, places, fields, constants, changes, moving, stiffness)
    divergences = {number: np.einsum("eqjj->eq", gradients) for number, gradients in moving.items()}
    if part.affine and all(_is_even(divergence) for divergence in divergences.values()):
        _add_even_mass(part, places, fields, constants, changes, divergences, mass)
    else:
        _add_mass(mesh, part, fields, constants, changes, mass)


def _add_stiffness(
    part: Part,
    places: _Places,
    fields: FloatArray,
    constants: FloatArray,
    changes: Sequence[Changes],
    moving: dict[int, FloatArray],
    stiffness: FloatArray,
) -> None:
    """Add stiffness derivatives by one product of all stresses with the parameter's changes of the gradients."""
    n_modes = stiffness.shape[1]
    gradients = places.gradients(fields).reshape(*places.volumes.shape, 3, 3, n_modes)  # ..., j, i of ∂_j φ_i, mode
    strains = np.empty((*places.volumes.shape, 6, n_modes))
    for i in range(3):
        strains[:, :, i] = gradients[:, :, i, i]
    for place, (i, j) in enumerate(_PAIRS):
        np.add(gradients[:, :, i, j], gradients[:, :, j, i], out=strains[:, :, 3 + place])
    stresses = _stresses(strains, places.volumes, *constants[:2, part.elements])
    for number, span in part.spans:
        constant_changes = changes[number].constants
        if constant_changes is not None and constant_changes[:2, part.elements[span]].any():
            stress = _stresses(strains[span], places.volumes[span], *constant_changes[:2, part.elements[span]])
            stiffness[number] += stress.reshape(-1, n_modes).T @ strains[span].reshape(-1, n_modes)
        if number in moving:
            tilt = _tilt(moving[number])
            tilted = tilt @ gradients[span].reshape(-1, *places.volumes.shape[1:], 9, n_modes)
            half = stresses[span].reshape(-1, n_modes).T @ tilted.reshape(-1, n_modes)
            stiffness[number] += half + half.T


def _stresses(strains: FloatArray, volumes: FloatArray, lam: FloatArray, mu: FloatArray) -> FloatArray:
    """σ dV of strains, shears as the sums of both gradients, of the same shape (n_elements, n_points, 6, n_modes)."""
    shear = mu[:, None] * volumes
    stress = np.asarray(strains * shear[:, :, None, None])
    stress[:, :, :3] *= 2.0
    stress[:, :, :3] += ((lam[:, None] * volumes)[..., None] * strains[:, :, :3].sum(axis=2))[:, :, None]
    return stress


def _tilt(velocities: FloatArray) -> FloatArray:
    """Matrix from ∇φ to the six strains of T = ½ div V ∇φ - ∇φ ∇V, by ∂_j V_l, shape (n, n_points, 6, 9).

    The stress is symmetric, so that the shears are T_ik + T_ki.
    """
    factor = 0.5 * np.einsum("eqjj->eq", velocities)[..., None, None] * np.eye(3) - velocities
    tilt = np.zeros((*factor.shape[:2], 6, 3, 3))  # component; j, i of ∂_j φ_i
    for i in range(3):
        tilt[:, :, i, :, i] = factor[:, :, i]
    for place, (i, k) in enumerate(_PAIRS):
        tilt[:, :, 3 + place, :, i] = factor[:, :, k]
        tilt[:, :, 3 + place, :, k] = factor[:, :, i]
    return tilt.reshape(*factor.shape[:2], 6, 9)


def _is_even(divergence: FloatArray) -> bool:
    """Whether div V is the same at all points of each element."""
    return bool(np.ptp(divergence, axis=1).max() <= _EVEN_DIVERGENCE_SHARE * np.abs(divergence).max())


def _add_even_mass(
    part: Part,
    places: _Places,
    fields: FloatArray,
    constants: FloatArray,
    changes: Sequence[Changes],
    divergences: dict[int, FloatArray],
    mass: FloatArray,
) -> None:
    """Add mass derivatives of straight elements with constant div V by scaling each element's modal mass."""
    points, weights = quadrature(part.kind.name, 2 * part.kind.order)
    values = shape_functions(part.kind.name, points)[0]
    n, n_modes = len(part.elements), mass.shape[1]
    # For density 1: Nᵀ N over the reference element as Rᵀ R, and the size of the element.
    unit = values.T @ (weights[:, None] * values) / weights.sum()
    turned = (np.linalg.cholesky(unit).T @ fields).reshape(n, -1, n_modes)
    modal = (turned.transpose(0, 2, 1) @ turned).reshape(n, -1)
    volumes = places.volumes.sum(axis=1)
    amounts = np.zeros((len(part.spans), n))
    for row, (number, span) in zip(amounts, part.spans, strict=True):
        if number in divergences:
            row[span] += constants[2, part.elements[span]] * divergences[number][:, 0]
        constant_changes = changes[number].constants
        if constant_changes is not None:
            row[span] += constant_changes[2, part.elements[span]]
    numbers = [number for number, _ in part.spans]
    mass[numbers] += ((amounts * volumes) @ modal).reshape(-1, n_modes, n_modes)


def _add_mass(
    mesh: Mesh,
    part: Part,
    fields: FloatArray,
    constants: FloatArray,
    changes: Sequence[Changes],
    mass: FloatArray,
) -> None:
    """Add mass derivatives of any elements by quadratic forms of the modes in scalar mass rates."""
    degree = 2 * part.kind.order
    places, n_modes = _Places.of(mesh, part, degree), mass.shape[1]
    values = shape_functions(part.kind.name, quadrature(part.kind.name, degree)[0])[0]
    for number, span in part.spans:
        change, elements = changes[number], part.elements[span]
        amount = np.zeros_like(places.volumes[span])
        if change.velocity is not None:
            velocities = places.gradients(change.velocity[part.nodes[span]], span)
            amount += constants[2, elements, None] * np.einsum("eqjj->eq", velocities)
        if change.constants is not None:
            amount += change.constants[2, elements, None]
        if not amount.any():
            continue
        amount *= places.volumes[span]
        products = np.einsum("eq,qa,qb->eab", amount, values, values, optimize=True)
        local = fields[span]
        mass[number] += local.reshape(-1, n_modes).T @ (products @ local).reshape(-1, n_modes)


@dataclass(frozen=True)
class ModelSensitivity:
    """Derivatives of a model by a parameter; None where it has no influence.

    Attributes
    ----------
    velocity : ndarray, shape (n_nodes, 3), optional
        Velocity of the nodes [m].
    constants : ndarray, shape (3, n_elements), optional
        Derivatives of λ, μ [Pa] and ρ [kg/m³] of each element.
    stiffness, mass : scipy.sparse array, shape (3 n_nodes, 3 n_nodes), optional
        Derivatives of the fixtures' matrices.
    """

    velocity: FloatArray | None = None
    constants: FloatArray | None = None
    stiffness: sparse.csr_array | None = None
    mass: sparse.csr_array | None = None


@dataclass(frozen=True)
class ModalSensitivities:
    """Derivatives of modal stiffness and mass by each of some parameters.

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
        """Return the derivatives of the shapes, c_ab of dφ_b = Σ_a φ_a c_ab, shape (n_parameters, n_modes, n_modes).

        c_ab = φ_aᵀ (dK - λ_b dM) φ_b / (λ_b - λ_a) and c_bb = -½ φ_bᵀ dM φ_b (Fox and Kapoor 1968). Contributions of
        modes above those at hand are missing. The result has no meaning for multiple modes that separate.
        """
        eigenvalues = frequencies**2
        apart = eigenvalues[None, :] - eigenvalues[:, None]
        n = len(eigenvalues)
        with np.errstate(divide="ignore", invalid="ignore"):
            mixed = (self.stiffness - eigenvalues * self.mass) / apart
        diagonal = np.arange(n)
        mixed[:, diagonal, diagonal] = -0.5 * self.mass[:, diagonal, diagonal]
        return np.asarray(mixed)


def modal_sensitivities(
    mesh: Mesh,
    constants: FloatArray,
    shapes: FloatArray,
    rates: Sequence[ModelSensitivity],
    report: Callable[[float], None] = lambda fraction: None,
) -> ModalSensitivities:
    """Compute the derivatives of modal stiffness and mass by each parameter.

    Parameters
    ----------
    mesh : Mesh
    constants : ndarray, shape (3, n_elements)
        λ, μ [Pa] and ρ [kg/m³].
    shapes : ndarray, shape (n_modes, n_nodes, 3)
        Mass-normalised shapes [1/√kg].
    rates : sequence of ModelSensitivity
    report : callable
        Called with the completed fraction.

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
            stiffness[number] += _seen(rate.stiffness, flat)
        if rate.mass is not None:
            mass[number] += _seen(rate.mass, flat)
    changes = [Changes(rate.velocity, rate.constants) for rate in rates]
    by_node = np.ascontiguousarray(shapes.transpose(1, 2, 0))
    every = list(parts(mesh, n, changes))
    for place, part in enumerate(every):
        report(place / len(every))
        add_part(mesh, part, constants, by_node, changes, stiffness, mass)
    return ModalSensitivities(0.5 * (stiffness + stiffness.transpose(0, 2, 1)), 0.5 * (mass + mass.transpose(0, 2, 1)))


def _seen(rate: sparse.csr_array, flat: FloatArray) -> FloatArray:
    """Project the matrix of a fixture, which has few nodes, on the modes: Φᵀ dA Φ."""
    rows = np.flatnonzero(np.diff(rate.indptr))
    return np.asarray(flat[rows].T @ (rate[rows] @ flat)) if len(rows) else np.zeros((flat.shape[1],) * 2)
