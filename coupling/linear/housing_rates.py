"""Derivatives of a housing's reduced model by parameters: stiffness, mass, damping, and the motions of its ports.

Modal damping of the ratios ζ follows the modes: C = g(A) with g(ω²) = 2ζω and A the projected M⁻¹K, so that

    dC_ab = [(g_a - g_b) dK_ab + (ω_a² g_b - ω_b² g_a) dM_ab] / (ω_a² - ω_b²),

which for one ratio is 2ζ (dK_ab + ω_a ω_b dM_ab) / (ω_a + ω_b).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwhine.numerics.arrays import FloatArray

# Relative difference of eigenvalues below which they count as one in a divided difference.
_EQUAL_EIGENVALUE_DIFFERENCE = 1e-6


@dataclass(frozen=True, eq=False)
class HousingRates:
    """Derivatives of a housing of h coordinates by p parameters.

    Attributes
    ----------
    frequencies, ratios : ndarray, shape (h,)
        ω [rad/s] and ζ of the coordinates.
    stiffness, mass : ndarray, shape (p, h, h)
        dK [1/s²] and dM [1] per unit of each parameter.
    bearings : sequence of mapping of str to ndarray, shape (5, h)
        Change of the seats' motions at bearings, for each parameter; a bearing without a change may be absent.
    sensors : sequence of mapping of str to ndarray, shape (h,)
        Change of the sensors' motions, for each parameter; a sensor without a change may be absent.
    static : sequence of mapping of str to ndarray, shape (5,)
        Change of the seats' motions at bearings in the static displacement field, for each parameter [m, rad].
    powers : sequence of mapping of float to float
        Change of the sound power [W] at ω [rad/s] in the line's motion by the points of the housing that the radiating
        surface moves with, for each parameter; a frequency without a change may be absent.
    """

    frequencies: FloatArray
    ratios: FloatArray
    stiffness: FloatArray
    mass: FloatArray
    bearings: Sequence[Mapping[str, FloatArray]]
    sensors: Sequence[Mapping[str, FloatArray]]
    static: Sequence[Mapping[str, FloatArray]]
    powers: Sequence[Mapping[float, float]]

    @cached_property
    def damping(self) -> FloatArray:
        """Derivatives of the modal damping matrix [1/s], shape (p, h, h)."""
        omega, ratios = self.frequencies, self.ratios
        values, gains = omega**2, 2.0 * ratios * omega
        apart = values[:, None] - values[None, :]
        alike = np.abs(apart) <= _EQUAL_EIGENVALUE_DIFFERENCE * np.maximum(values[:, None], values[None, :])
        distance = np.where(alike, 1.0, apart)
        total = omega[:, None] + omega[None, :]
        equal = (ratios[:, None] + ratios[None, :]) / np.where(total > 0.0, total, np.inf)
        by_stiffness = np.where(alike, equal, (gains[:, None] - gains[None, :]) / distance)
        crossed = values[:, None] * gains[None, :] - values[None, :] * gains[:, None]
        by_mass = np.where(alike, equal * omega[:, None] * omega[None, :], crossed / distance)
        return np.asarray(by_stiffness * self.stiffness + by_mass * self.mass)
