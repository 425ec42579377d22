"""Acoustic medium around a housing, and a hard plane that mirrors the sound."""

from dataclasses import dataclass

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_TWO_PI = 2.0 * np.pi


@dataclass(frozen=True)
class Medium:
    """Acoustic medium.

    Attributes
    ----------
    density : float
        ρ [kg/m³].
    speed_of_sound : float
        c [m/s].

    Raises
    ------
    HousingError
        Where one of them is not positive.
    """

    density: float
    speed_of_sound: float

    def __post_init__(self) -> None:
        """Refuse a medium without density or speed of sound."""
        for name, value in (("density", self.density), ("speed of sound", self.speed_of_sound)):
            if not (np.isfinite(value) and value > 0.0):
                raise HousingError(f"a {name} of {value:g}; expected a positive number")

    @property
    def impedance(self) -> float:
        """Characteristic impedance ρ c [Pa s/m]."""
        return self.density * self.speed_of_sound

    def wavenumber(self, frequency_hz: float) -> float:
        """Wavenumber k = ω / c [rad/m]."""
        return _TWO_PI * frequency_hz / self.speed_of_sound

    def flux(self, frequency_hz: float, velocity: ComplexArray) -> ComplexArray:
        """Return the normal derivative ∂p/∂n = −i ω ρ v of the pressure [Pa/m] by the normal velocity v [m/s]."""
        return -1j * self.wavenumber(frequency_hz) * self.impedance * velocity


AIR = Medium(density=1.204, speed_of_sound=343.2)
"""Dry air at 20 °C and 101.325 kPa."""


@dataclass(frozen=True)
class HardPlane:
    """A rigid plane, as a floor or a baffle, that mirrors the sound.

    Attributes
    ----------
    point : ndarray, shape (3,)
        A point of the plane [m].
    normal : ndarray, shape (3,)
        Unit normal into the air.
    """

    point: FloatArray
    normal: FloatArray

    def height(self, points: FloatArray) -> FloatArray:
        """Distance of points from the plane, positive in the air [m]."""
        return np.asarray((points - self.point) @ self.normal)

    def mirror(self, points: FloatArray) -> FloatArray:
        """Mirror images of points [m], shape (n, 3)."""
        return points - 2.0 * np.outer(self.height(points), self.normal)
