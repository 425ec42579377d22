"""Rigid registration by least squares: points to points (Kabsch), and points to planes."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.errors import MeasuredDataError

FloatArray = npt.NDArray[np.float64]

_ON_A_LINE = 1e-6  # second largest spread of points as a part of the largest, below which they turn about their line


@dataclass(frozen=True)
class RigidMotion:
    """From one frame to another: x' = R x + t.

    Attributes
    ----------
    rotation : ndarray, shape (3, 3)
    translation : ndarray, shape (3,)
        [m].
    """

    rotation: FloatArray
    translation: FloatArray

    def place(self, points: FloatArray) -> FloatArray:
        """Move points of shape (n, 3) [m]."""
        return np.asarray(points @ self.rotation.T + self.translation)

    def turn(self, directions: FloatArray) -> FloatArray:
        """Rotate directions of shape (n, 3)."""
        return np.asarray(directions @ self.rotation.T)

    @property
    def angle_degrees(self) -> float:
        """Angle of the rotation [degrees]."""
        return float(np.rad2deg(np.arccos(np.clip((np.trace(self.rotation) - 1.0) / 2.0, -1.0, 1.0))))


AT_REST = RigidMotion(np.eye(3), np.zeros(3))


def fit_points(points: FloatArray, targets: FloatArray) -> tuple[RigidMotion, float]:
    """The rigid motion that brings points nearest to their targets, and the scale of a similarity transformation.

    Minimises Σ |R x + t - y|²: with U S Vᵀ the singular value decomposition of Σ (y - ȳ)(x - x̄)ᵀ, R = U D Vᵀ where
    D = diag(1, 1, det U Vᵀ) keeps it a rotation. The scale that would minimise Σ |s R x + t - y|² is
    tr(S D) / Σ |x - x̄|²; it is not applied, but detects wrong units. W. Kabsch, *Acta Cryst.* A32, 1976;
    S. Umeyama, *IEEE Trans. PAMI* 13, 1991.

    Parameters
    ----------
    points, targets : ndarray, shape (n, 3)

    Raises
    ------
    MeasuredDataError
        Where there are fewer than three points, or they lie on one line, so that the rotation about it is undetermined.
    """
    middle, goal = points.mean(axis=0), targets.mean(axis=0)
    for name, spread in (("points", points - middle), ("places", targets - goal)):
        sizes = np.linalg.svd(spread, compute_uv=False)
        if len(points) < 3 or not sizes[1] > _ON_A_LINE * sizes[0]:
            raise MeasuredDataError(
                f"the {len(points)} {name} to align by lie on one line; expected three or more that span a triangle"
            )
    left, sizes, right = np.linalg.svd((targets - goal).T @ (points - middle))
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    rotation = (left * signs) @ right
    scale = float(sizes @ signs / ((points - middle) ** 2).sum())
    return RigidMotion(rotation, goal - rotation @ middle), scale


def small_motion(points: FloatArray, targets: FloatArray, normals: FloatArray) -> tuple[RigidMotion, FloatArray]:
    """The small rigid motion that brings points nearest to planes, and how firmly the planes determine it.

    Minimises Σ (n · (x + r × (x - x̄) + d - y))², linear in d and r (Y. Chen, G. Medioni, *Image and Vision Computing*
    10, 1992); the rotation by r is then made exact.

    Returns
    -------
    motion : RigidMotion
    firmness : ndarray, shape (6,)
        Ascending singular values of the problem over the square root of the number of points, lengths as parts of the
        points' radius: near 0 where the points can move without leaving the planes.
    """
    middle = points.mean(axis=0)
    arms = points - middle
    radius = float(np.sqrt((arms**2).sum(axis=1).mean()))
    matrix = np.concatenate([normals, np.cross(arms, normals) / radius], axis=1)
    gaps = np.einsum("pi,pi->p", targets - points, normals)
    solution, _, _, sizes = np.linalg.lstsq(matrix, gaps, rcond=1e-6)
    vector = solution[3:] / radius
    angle = float(np.linalg.norm(vector))
    rotation = np.eye(3)
    if angle > 0.0:
        x, y, z = vector / angle
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        rotation = rotation + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    firmness = np.zeros(6)
    firmness[: len(sizes)] = sizes
    return RigidMotion(rotation, middle + solution[:3] - rotation @ middle), np.sort(firmness) / np.sqrt(len(points))
