"""Sensitivities of modes to parameters: derivatives of stiffness and mass in modal coordinates, without assembly.

A parameter moves nodes, changes the elements' material, or changes fixtures. With nodes that move at
the velocity V = dX/dp the gradient of a field that they carry changes by d(∂_j u_i) = -∂_l u_i ∂_j V_l and the volume
by div V, so that for two modes φ_a, φ_b of the stress σ = λ tr ε I + 2 μ ε

    dK_ab = ∫ σ(φ_a) : T_b + σ(φ_b) : T_a dV,      T_b = ½ div V ∇φ_b - ∇φ_b ∇V,
    dM_ab = ∫ ρ φ_a · φ_b div V dV,

(the velocity form of shape sensitivities: Haug, Choi and Komkov 1986, chapter 3). With the elements' own quadrature
these are the exact derivatives of the assembled matrices.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse

from housing.errors import HousingError
from housing.updating.rate_integrals import Changes, add_part, parts
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ModelSensitivity:
    """Derivatives of a model by a parameter; None where it has no influence.

    Attributes
    ----------
    velocity : ndarray, shape (n_nodes, 3), optional
        Velocity of the nodes [m].
    constants : ndarray, shape (3, n_elements), optional
        Rates of λ, μ [Pa] and ρ [kg/m³] of each element.
    stiffness, mass : scipy.sparse array, shape (3 n_nodes, 3 n_nodes), optional
        Rates of the fixtures' matrices.
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
        """Derivatives of the shapes, c_ab of dφ_b = Σ_a φ_a c_ab, shape (n_parameters, n_modes, n_modes).

        c_ab = φ_aᵀ (dK - λ_b dM) φ_b / (λ_b - λ_a) and c_bb = -½ φ_bᵀ dM φ_b (Fox and Kapoor 1968). Contributions of
        modes above those at hand are missing. For multiple modes that separate it has no meaning.
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
    mesh: Mesh, constants: FloatArray, shapes: FloatArray, rates: Sequence[ModelSensitivity]
) -> ModalSensitivities:
    """Compute the derivatives of modal stiffness and mass by each parameter.

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
            stiffness[number] += _seen(rate.stiffness, flat)
        if rate.mass is not None:
            mass[number] += _seen(rate.mass, flat)
    changes = [Changes(rate.velocity, rate.constants) for rate in rates]
    by_node = np.ascontiguousarray(shapes.transpose(1, 2, 0))
    for part in parts(mesh, n, changes):
        add_part(mesh, part, constants, by_node, changes, stiffness, mass)
    return ModalSensitivities(0.5 * (stiffness + stiffness.transpose(0, 2, 1)), 0.5 * (mass + mass.transpose(0, 2, 1)))


def _seen(rate: sparse.csr_array, flat: FloatArray) -> FloatArray:
    """Φᵀ dA Φ of a fixture's matrix, which has few nodes."""
    rows = np.flatnonzero(np.diff(rate.indptr))
    return np.asarray(flat[rows].T @ (rate[rows] @ flat)) if len(rows) else np.zeros((flat.shape[1],) * 2)
