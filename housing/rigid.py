"""Rigid body: rigid motions of points, and mass, centre of gravity and inertia from a mass matrix."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.matrices import Matrices

FloatArray = npt.NDArray[np.float64]


def rigid_motions(points: FloatArray, center: FloatArray) -> FloatArray:
    """The displacement R r of points in the rigid motion r: translation + rotation x (x - centre).

    Parameters
    ----------
    points : ndarray, shape (..., 3)
        [m].
    center : ndarray, shape (3,)
        [m].

    Returns
    -------
    ndarray, shape (..., 3, 6)
        Columns: translations along x, y, z, rotations about x, y, z through the centre.
    """
    x, y, z = np.moveaxis(points - center, -1, 0)
    motions = np.zeros((*points.shape, 6))
    motions[..., :3] = np.eye(3)
    motions[..., 0, 4], motions[..., 0, 5] = z, -y
    motions[..., 1, 3], motions[..., 1, 5] = -z, x
    motions[..., 2, 3], motions[..., 2, 4] = y, -x
    return motions


@dataclass(frozen=True)
class RigidBody:
    """Mass, centre of gravity and inertia of a body.

    Attributes
    ----------
    mass : float
        [kg].
    center : ndarray, shape (3,)
        Centre of gravity [m].
    inertia : ndarray, shape (3, 3)
        Inertia tensor ∫ (|r|² I - r rᵀ) dm about the centre of gravity [kg m²].
    """

    mass: float
    center: FloatArray
    inertia: FloatArray

    def matrix(self, about: FloatArray) -> FloatArray:
        """M₆ [kg, kg m, kg m²] about a point [m], shape (6, 6): ½ ṙᵀ M₆ ṙ is the kinetic energy of a rigid motion r."""
        at_center = np.zeros((6, 6))
        at_center[:3, :3], at_center[3:, 3:] = self.mass * np.eye(3), self.inertia
        motion = np.eye(6)
        motion[:3] = rigid_motions(self.center, about)
        return np.asarray(motion.T @ at_center @ motion)


def rigid_body(points: FloatArray, matrices: Matrices) -> RigidBody:
    """Mass, centre of gravity and inertia of a housing with all its attached masses, from its mass matrix.

    M₆ = Rᵀ M R with the rigid field R of the nodes, which isoparametric elements hold exactly.

    Parameters
    ----------
    points : ndarray, shape (n_nodes, 3)
        The nodes [m].
    matrices : Matrices
    """
    middle = points.mean(axis=0)
    field = rigid_motions(points, middle).reshape(-1, 6)
    whole = field.T @ (matrices.mass @ field)
    mass = float(np.trace(whole[:3, :3])) / 3.0
    # The off-diagonal block is -m [arm]x, the matrix of the cross product with the arm from the middle to the centre.
    moment = 0.5 * (whole[:3, 3:] - whole[:3, 3:].T)
    arm = np.array([moment[1, 2], moment[2, 0], moment[0, 1]]) / mass
    inertia = whole[3:, 3:] - mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return RigidBody(mass, middle + arm, 0.5 * (inertia + inertia.T))
