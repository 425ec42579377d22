"""Effective modal mass, and modal damping by dashpots, mounts and joints.

The effective mass is the share of each mode in the housing's mass under rigid motion of the ground. For a ground that
moves rigidly, u = q + R s(t), the free degrees of freedom f are driven by -(M R)_f s'', R over all degrees of freedom:
the fixed ones s move with the ground and pull by the consistent mass, (M R)_f = M_ff R_f + M_fs R_s. In the mode r that
is the participation factor L_r = φ_rᵀ M R, and with φᵀ M φ = 1 its square is the mass of the oscillator of the mode's
frequency that exerts the same force on the ground. Over all modes of the free degrees of freedom

    Σ_r L_r² = (M R)_fᵀ M_ff⁻¹ (M R)_f = Rᵀ M R - R_sᵀ (M_ss - M_sf M_ff⁻¹ M_fs) R_s,

by completeness, so that the share of the discarded modes is known. A free body's rigid modes carry all of Rᵀ M R;
elastic modes are M-orthogonal to R and carry none. The last term is the mass of the fixed patches that is in no mode.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import linalg

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.matrices import FreeMass, Matrices
from gearwhine.housing.model.patches import rigid_body, rigid_motions
from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.numerics.arrays import FloatArray

_TOLERANCE = 1e-12  # relative residual of M_ff x = (M R)_f
_ITERATIONS = 2000  # far more than the well conditioned mass takes


def modal_damping(modes: ModeSet, matrices: Matrices) -> FloatArray:
    """Φᵀ C Φ: dashpots, and mounts and joints that damp, in the coordinates of mass-normalised modes.

    With the modes' own ratios ζ the equation of motion is q'' + (diag(2ζω) + Φᵀ C Φ) q' + diag(ω²) q = f. A dashpot
    acts at one place and so couples the modes: the matrix is full. Residual modes, where the mode set has them, follow
    the modes.

    Returns
    -------
    ndarray, shape (n, n)
        Matrix of n modes and residual modes [1/s], symmetric, positive semidefinite.
    """
    shapes = modes.shapes.reshape(len(modes.shapes), -1)
    if modes.residual_modes is not None:
        shapes = np.vstack([shapes, modes.residual_modes.shapes.reshape(-1, shapes.shape[1])])
    full = shapes @ (matrices.damping @ shapes.T)
    return np.asarray(0.5 * (full + full.T))


def damping_ratios(frequencies: FloatArray, ratios: FloatArray, damping: FloatArray | None) -> FloatArray:
    """Each mode's own ratio and its share of the modal damping matrix, ζ + (Φᵀ C Φ)_ii / 2ω.

    Parameters
    ----------
    frequencies : ndarray, shape (n_modes,)
        ω [rad/s]; a rigid-body mode has none, so its ratio stays as it is.
    ratios : ndarray, shape (n_modes,)
        ζ, parts of critical.
    damping : ndarray, shape (n, n), or None
        Φᵀ C Φ [1/s], the modes first; None without dashpots.

    Returns
    -------
    ndarray, shape (n_modes,)
    """
    if damping is None:
        return ratios
    elastic = frequencies > 0.0
    added = np.zeros_like(ratios)
    added[elastic] = damping.diagonal()[: len(ratios)][elastic] / (2.0 * frequencies[elastic])
    return np.asarray(ratios + added)


@dataclass(frozen=True)
class EffectiveMass:
    """Effective mass along x, y, z [kg] and about axes along them through the centre of gravity [kg m²].

    Attributes
    ----------
    participation : ndarray, shape (n_modes, 6)
        L [√kg, √(kg m²)].
    total : ndarray, shape (6,)
        Mass of the whole body.
    free : ndarray, shape (6,)
        Sum of the effective masses over all modes: the whole less what the fixed patches carry themselves.
    center : ndarray, shape (3,)
        Centre of gravity [m].
    """

    participation: FloatArray
    total: FloatArray
    free: FloatArray
    center: FloatArray

    @property
    def mass(self) -> FloatArray:
        """Effective mass of each mode, L² [kg, kg m²], shape (n_modes, 6)."""
        return self.participation**2

    @property
    def fractions(self) -> FloatArray:
        """Effective mass of each mode as a part of the whole body's, shape (n_modes, 6)."""
        return np.asarray(self.mass / self.total)

    @property
    def captured(self) -> FloatArray:
        """Effective mass of all modes together as a part of the whole body's, shape (6,)."""
        return np.asarray(self.mass.sum(axis=0) / self.total)

    @property
    def missing(self) -> FloatArray:
        """Effective mass of the modes above the limit as a part of the whole body's, shape (6,)."""
        return np.asarray((self.free - self.mass.sum(axis=0)) / self.total)


def effective_mass(matrices: Matrices, points: FloatArray, modes: ModeSet) -> EffectiveMass:
    """Participation factors and effective masses for the six rigid motions of the ground.

    Parameters
    ----------
    matrices : Matrices
        Matrices of n_nodes nodes, with supports.
    points : ndarray, shape (n_nodes, 3)
        Places of the nodes [m].
    modes : ModeSet
        Modes of these matrices.

    Raises
    ------
    HousingError
        Where the sum over all modes is not found to twelve digits.
    """
    center = rigid_body(points, matrices).center
    fields = rigid_motions(points, center).reshape(-1, 6)
    moved = matrices.mass_operator @ fields
    total = np.einsum("ij,ij->j", fields, moved)
    return EffectiveMass(
        participation=np.asarray(modes.shapes.reshape(len(modes.shapes), -1) @ moved),
        total=total,
        free=_over_all_modes(matrices, moved) if len(matrices.fixed) else total,
        center=center,
    )


def _over_all_modes(matrices: Matrices, moved: FloatArray) -> FloatArray:
    """Sum of L² over all modes, the diagonal of (M R)_fᵀ M_ff⁻¹ (M R)_f, by conjugate gradients, shape (6,)."""
    free = np.setdiff1d(np.arange(len(moved)), matrices.fixed)
    mass, diagonal = FreeMass(matrices, free), matrices.mass_diagonal()[free]
    operator = linalg.LinearOperator(mass.shape, matvec=mass.__matmul__, dtype=np.float64)
    scaled = linalg.LinearOperator(mass.shape, matvec=lambda vector: vector / diagonal, dtype=np.float64)
    sums = []
    for column in moved[free].T:
        solution, failed = linalg.cg(operator, column, rtol=_TOLERANCE, maxiter=_ITERATIONS, M=scaled)
        if failed:
            raise HousingError(f"effective masses: M x = M R is not solved to {_TOLERANCE:g} in {_ITERATIONS} steps")
        sums.append(column @ solution)
    return np.array(sums)
