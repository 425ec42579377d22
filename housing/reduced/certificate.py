"""Certificate of a reduced housing: what its matrices prove about themselves."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.housing.reduced.matrices import MASSLESS, ReducedMatrices, scaled

FloatArray = npt.NDArray[np.float64]

RIGID_STRAIN = 1e-5
"""Largest strain energy of a free rigid motion, over that of its node motions one by one."""


@dataclass(frozen=True)
class ReducedCertificate:
    """What is proved of reduced matrices.

    Attributes
    ----------
    least_mass_eigenvalue, least_stiffness_eigenvalue : float
        Least eigenvalues of the matrices with a diagonal of ones.
    massless_count : int
        Number of coordinates without mass, which respond statically.
    rigid_strain : ndarray, shape (6,)
        Strain energy Rᵀ K R of the rigid motions along and about x, y, z through the nodes' centre, each over the sum
        of |K_ij R_i R_j|; zero of a motion that is free.
    rigid_mass : ndarray, shape (6, 6)
        Rᵀ M R of the rigid motions through the origin: mass [kg], static moment [kg m] and inertia [kg m²].
    """

    least_mass_eigenvalue: float
    least_stiffness_eigenvalue: float
    massless_count: int
    rigid_strain: FloatArray
    rigid_mass: FloatArray

    @property
    def free_motions(self) -> int:
        """Number of rigid motions that the matrices do not resist."""
        return int((self.rigid_strain <= RIGID_STRAIN).sum())

    @property
    def is_free(self) -> bool:
        """Whether all six rigid motions are free, so that nothing inside the matrices holds the housing."""
        return self.free_motions == 6

    @property
    def mass(self) -> float:
        """Mass by its translations, the mean of the three [kg]; exact of a free housing."""
        return float(np.diag(self.rigid_mass)[:3].mean())


def rigid_motions(matrices: ReducedMatrices, positions: dict[int, tuple[float, float, float]]) -> FloatArray:
    """Rigid motions along and about x, y, z through the origin, internal coordinates at rest, shape (n, 6).

    Parameters
    ----------
    matrices : ReducedMatrices
    positions : dict of int to tuple of float
        Place of each node [m].
    """
    motions = np.zeros((matrices.size, 6))
    for row, (node, axis) in enumerate(matrices.coordinates):
        if axis == 0:
            continue
        motions[row, axis - 1] = 1.0
        if axis <= 3:
            x, y, z = positions[node]
            # Displacement θ × r of a rotation θ.
            motions[row, 3:] = ((0.0, z, -y), (-z, 0.0, x), (y, -x, 0.0))[axis - 1]
    return motions


def certify(matrices: ReducedMatrices, positions: dict[int, tuple[float, float, float]]) -> ReducedCertificate:
    """Certify reduced matrices whose nodes have these places [m]."""
    motions = rigid_motions(matrices, positions)
    center = np.mean(list(positions.values()), axis=0)
    about_center = rigid_motions(matrices, {node: tuple(np.subtract(at, center)) for node, at in positions.items()})
    strain = np.einsum("ia,ij,ja->a", about_center, matrices.stiffness, about_center)
    sizes = np.einsum("ia,ij,ja->a", np.abs(about_center), np.abs(matrices.stiffness), np.abs(about_center))
    mass_eigenvalues = np.linalg.eigvalsh(scaled(matrices.mass))
    return ReducedCertificate(
        float(mass_eigenvalues[0]),
        float(np.linalg.eigvalsh(scaled(matrices.stiffness))[0]),
        int((mass_eigenvalues < MASSLESS).sum()),
        np.abs(strain) / np.maximum(sizes, 1e-300),
        np.asarray(motions.T @ matrices.mass @ motions),
    )
