"""Rigid-body motions of a meshed body, and what its mass matrix says of mass, centre of gravity and inertia."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse

FloatArray = npt.NDArray[np.float64]

RIGID_MOTIONS = ("x", "y", "z", "rotation x", "rotation y", "rotation z")


def rigid_fields(points: FloatArray, center: FloatArray) -> FloatArray:
    """Nodal displacements of the six rigid motions, shape (6, 3 n_nodes).

    Unit translations along x, y, z, then small rotations about axes through ``center`` [m], shape (3,), by one
    radian: e_i x (p - center).
    """
    axes = np.eye(3)
    arms = points - center
    translations = [np.tile(axis, len(points)) for axis in axes]
    return np.array(translations + [np.cross(axis, arms).ravel() for axis in axes])


@dataclass(frozen=True)
class RigidBody:
    """A body's mass properties as its mass matrix M has them.

    Attributes
    ----------
    mass : float
        [kg], the mean of the three translations'.
    center : ndarray, shape (3,)
        Centre of gravity [m].
    inertia : ndarray, shape (3, 3)
        About the centre of gravity [kg m²]: the products of inertia stand off the diagonal with a minus sign.
    irregularity : float
        Largest entry of Rᵀ M R about the centre of gravity that no rigid body has — unequal translational masses,
        translations coupled with each other or with rotations — as a part of the mass, with rotations measured at the
        radius of gyration.
    """

    mass: float
    center: FloatArray
    inertia: FloatArray
    irregularity: float


def rigid_body(mass: sparse.csr_array, points: FloatArray) -> RigidBody:
    """Mass properties from a mass matrix of shape (3 n_nodes, 3 n_nodes) and its nodes [m], shape (n_nodes, 3)."""
    origin = points.mean(axis=0)
    fields = rigid_fields(points, origin)
    matrix = fields @ (mass @ fields.T)
    total = float(np.trace(matrix[:3, :3]) / 3.0)
    # ∫ρ (e_j x r)_i dV = m (e_j x c)_i, so that the block of translations by rotations is m [c]ᵀ of a cross product.
    coupling = 0.5 * (matrix[:3, 3:] - matrix[:3, 3:].T) / total
    offset = np.array([coupling[1, 2], coupling[2, 0], coupling[0, 1]])
    center = origin + offset
    fields = rigid_fields(points, center)
    matrix = fields @ (mass @ fields.T)
    gyration = float(np.sqrt(np.trace(matrix[3:, 3:]) / total))
    foreign = matrix.copy()
    foreign[:3, :3] -= total * np.eye(3)
    foreign[3:, 3:] = 0.0
    foreign[:3, 3:] /= gyration
    foreign[3:, :3] /= gyration
    return RigidBody(total, center, np.asarray(matrix[3:, 3:]), float(np.abs(foreign).max() / total))
