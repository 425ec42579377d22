"""Modal damping: damping of the housing's modes by dashpots, mounts and joints."""

import numpy as np
import numpy.typing as npt

from housing.matrices import Matrices
from housing.modes import ModeSet

FloatArray = npt.NDArray[np.float64]


def modal_damping(modes: ModeSet, matrices: Matrices) -> FloatArray:
    """Φᵀ C Φ: dashpots, and mounts and joints that damp, in the coordinates of mass-normalised modes.

    With the modes' own ratios ζ the equation of motion is q'' + (diag(2ζω) + Φᵀ C Φ) q' + diag(ω²) q = f. A dashpot
    acts at one place and so couples the modes: the matrix is full. Residual modes, where the mode set has them, follow
    the modes.

    Returns
    -------
    ndarray, shape (n, n)
        n modes and residual modes [1/s], symmetric, positive semidefinite.
    """
    shapes = modes.shapes.reshape(len(modes.shapes), -1)
    if modes.residual_modes is not None:
        shapes = np.vstack([shapes, modes.residual_modes.shapes.reshape(-1, shapes.shape[1])])
    full = shapes @ (matrices.damping @ shapes.T)
    return np.asarray(0.5 * (full + full.T))


def damping_ratios(frequencies: FloatArray, ratios: FloatArray, damping: FloatArray) -> FloatArray:
    """Each mode's own ratio and its share of the modal damping matrix, ζ + (Φᵀ C Φ)_ii / 2ω.

    Parameters
    ----------
    frequencies : ndarray, shape (n_modes,)
        ω [rad/s]; a rigid-body mode has none, so its ratio stays as it is.
    ratios : ndarray, shape (n_modes,)
        ζ, parts of critical.
    damping : ndarray, shape (n, n)
        Φᵀ C Φ [1/s], the modes first.

    Returns
    -------
    ndarray, shape (n_modes,)
    """
    elastic = frequencies > 0.0
    added = np.zeros_like(ratios)
    added[elastic] = damping.diagonal()[: len(ratios)][elastic] / (2.0 * frequencies[elastic])
    return np.asarray(ratios + added)
