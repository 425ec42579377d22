r"""Static sensitivity: gradients of an outcome of a loaded housing by its parameters, from two displacement fields.

The housing carries forces f at ports that move by S u, K u = Sᵀ f + M g, as a part of a machine whose forces depend on
those motions. u are the displacements; λ are the adjoint ones of an outcome y of the machine, its derivatives by forces
on the nodes; f̄ are the adjoint forces at the ports, its derivatives by their motions. For any parameter

    dy/dp = -λᵀ dK u + λᵀ dM g + f · dS λ + f̄ · dS u

(Haug, Choi and Komkov, Design Sensitivity Analysis of Structural Systems, 1986, sections 1.2 and 3.3). Both fields are
static responses to forces at the ports, which residual modes make exact, except that of the housing's own weight. For
material added on the surface, by the thickness h along the outward normal where no tractions act,

    dy = ∫ G h dA,      G = -σ(u) : ε(λ) + ρ g · λ.

In harmonic motion at ω, with complex fields u and μ, inertia takes the place of weight:

    dy = Re ∫ G h dA,      G = -σ(u) : ε(μ) + ω² ρ u · μ,

the material's damping left out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from gearwhine.housing.updating.sensitivities import ModelSensitivity, modal_sensitivities
from gearwhine.meshes import Mesh
from gearwhine.meshes.shape_functions import determinants, inverses, jacobians, shape_functions
from gearwhine.numerics.arrays import ComplexArray, FloatArray

PortRates = Mapping[str, sparse.csr_array]
"""dS of each port that a parameter moves: its motions from the nodes', shape (r, 3 n_nodes)."""


@dataclass(frozen=True, eq=False)
class StaticSensitivity:
    """Displacement fields of a loaded housing and of adjoint states, a of them, and their forces at the ports.

    Attributes
    ----------
    mesh : Mesh
    constants : ndarray, shape (3, n_elements)
        Lamé's λ, μ [Pa] and ρ [kg/m³].
    displacement : ndarray, shape (n_nodes, 3)
        u [m].
    adjoint : ndarray, shape (a, n_nodes, 3)
        λ of each adjoint state [outcome/N].
    forces : mapping of str to ndarray, shape (r,)
        f at each port [N, N m].
    adjoint_forces : mapping of str to ndarray, shape (a, r)
        f̄ at each port [outcome/m, outcome/rad].
    gravity : ndarray, shape (3,)
        g [m/s²].
    """

    mesh: Mesh
    constants: FloatArray
    displacement: FloatArray
    adjoint: FloatArray
    forces: Mapping[str, FloatArray]
    adjoint_forces: Mapping[str, FloatArray]
    gravity: FloatArray

    def by_parameters(self, rates: Sequence[ModelSensitivity], ports: Sequence[PortRates]) -> FloatArray:
        """Differentiate each outcome by parameters of the housing, shape (a, n_parameters).

        Parameters
        ----------
        rates : sequence of ModelSensitivity
            Derivatives of the housing's model by each parameter.
        ports : sequence of PortRates
            Derivatives of the ports.
        """
        weight = np.broadcast_to(self.gravity, self.displacement.shape)
        fields = np.concatenate([np.stack([self.displacement, weight]), self.adjoint])
        sensitivities = modal_sensitivities(self.mesh, self.constants, fields, rates)
        total = sensitivities.mass[:, 1, 2:] - sensitivities.stiffness[:, 0, 2:]
        for row, changes in zip(total, ports, strict=True):
            for name, change in changes.items():
                row += self.forces[name] @ (change @ self.adjoint.reshape(len(self.adjoint), -1).T)
                row += self.adjoint_forces[name] @ (change @ self.displacement.ravel())
        return np.asarray(total.T)

    def surface_density(self) -> FloatArray:
        """G of each adjoint state at the nodes [outcome/m³], shape (a, n_nodes); of use on the surface.

        Gradients of the fields are averaged over the elements at a node, weighted by their volumes there.
        """
        fields = np.concatenate([self.displacement[None], self.adjoint])
        strains, constants = _strains(self.mesh, fields, self.constants)
        strain_density = np.einsum("nij,anij->an", _stress(strains[0], constants), strains[1:], optimize=True)
        return np.asarray(constants[2] * (self.adjoint @ self.gravity) - strain_density)


def harmonic_surface_density(
    mesh: Mesh, constants: FloatArray, motion: ComplexArray, adjoint: ComplexArray, frequency: float
) -> FloatArray:
    """Re G of a harmonic motion at the nodes [outcome/m³], shape (n_nodes,); of use on the surface.

    Parameters
    ----------
    mesh : Mesh
    constants : ndarray, shape (3, n_elements)
        Lamé's λ, μ [Pa] and ρ [kg/m³].
    motion, adjoint : ndarray of complex, shape (n_nodes, 3)
        u [m] and μ [outcome/N].
    frequency : float
        ω [rad/s].
    """
    parts = np.stack([motion.real, motion.imag, adjoint.real, adjoint.imag])
    strains, means = _strains(mesh, parts, constants)
    total = np.zeros(len(mesh.points))
    for part, sign in ((0, 1.0), (1, -1.0)):
        inertia = frequency**2 * means[2] * np.einsum("ni,ni->n", parts[part], parts[part + 2])
        strained = np.einsum("nij,nij->n", _stress(strains[part], means), strains[part + 2])
        total += sign * (inertia - strained)
    return total


def _strains(mesh: Mesh, fields: FloatArray, constants: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Strains of fields at the nodes, shape (n_fields, n_nodes, 3, 3), and the constants there."""
    gradients, means = _nodal_means(mesh, fields, constants)
    return 0.5 * (gradients + gradients.swapaxes(-1, -2)), means


def _stress(strain: FloatArray, constants: FloatArray) -> FloatArray:
    """Stress of strains at the nodes [Pa], shape (n_nodes, 3, 3)."""
    lam, mu, _ = constants
    volume = lam * np.trace(strain, axis1=1, axis2=2)
    return np.asarray(2.0 * mu[:, None, None] * strain + volume[:, None, None] * np.eye(3))


def _nodal_means(mesh: Mesh, fields: FloatArray, constants: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Means over the elements at each node: ∂_j f_i, (n_fields, n_nodes, 3, 3), and constants, (3, n_nodes)."""
    nodes = len(mesh.points)
    gradients, means = np.zeros((len(fields), nodes, 3, 3)), np.zeros((3, nodes))
    weights, first = np.zeros(nodes), 0
    for block in mesh.blocks:
        places = np.array(block.of.places, dtype=np.float64).T
        reference = shape_functions(block.kind, places)[1]
        jacobian = jacobians(mesh.points, block.nodes, reference)
        determinant = determinants(jacobian)
        inverse = inverses(jacobian, determinant)
        block_constants = constants[:, first : first + len(block)]
        first += len(block)
        slopes = np.einsum("kjeq,qak->eqja", inverse, reference, optimize=True)
        at = block.nodes.ravel()
        # Sums over the elements at each node, by their volumes there.
        volumes = sparse.csc_array((determinant.ravel(), at, np.arange(len(at) + 1)), shape=(nodes, len(at)))
        weights += np.asarray(volumes @ np.ones(len(at)))
        means += np.asarray(volumes @ np.repeat(block_constants, block.nodes.shape[1], axis=1).T).T
        by_element = slopes.reshape(len(block), -1, block.nodes.shape[1])
        for gradient, field in zip(gradients, fields, strict=True):
            local = by_element @ field[block.nodes]
            gradient += np.asarray(volumes @ local.reshape(len(at), -1)).reshape(gradient.shape).swapaxes(1, 2)
    weights = np.where(weights > 0.0, weights, 1.0)
    return gradients / weights[:, None, None], means / weights
