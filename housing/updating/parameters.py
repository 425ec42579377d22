"""Parameters of model updating, each with a range and a prior.

A fit works in coordinates z in which the prior is a unit normal distribution: z = ln(p / nominal) / ln(1 + spread /
nominal) for positive parameters such as thicknesses, stiffnesses and densities, and z = (p - nominal) / spread for all
others. So steps of springs and walls are commensurate, and a thickness cannot become negative.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Parameter:
    """A parameter of the model that is fitted.

    Attributes
    ----------
    name : str
    low, high : float
        Bounds.
    nominal : float
        Expected value of the prior.
    spread : float
        Standard deviation of the prior.

    Raises
    ------
    HousingError
        Where the range is empty, the nominal value outside it, or the spread not positive.
    """

    name: str
    low: float
    high: float
    nominal: float
    spread: float

    def __post_init__(self) -> None:
        """Check range, nominal value and spread."""
        if not -np.inf < self.low < self.high < np.inf:
            raise HousingError(
                f"parameter {self.name!r}: range {self.low:g} to {self.high:g}: expected an ascending one"
            )
        if not self.low <= self.nominal <= self.high:
            within = f"{self.low:g} to {self.high:g}"
            raise HousingError(f"parameter {self.name!r}: nominal {self.nominal:g}: expected one within {within}")
        if not 0.0 < self.spread < np.inf:
            raise HousingError(f"parameter {self.name!r}: spread {self.spread:g}: expected one above 0")

    @property
    def is_positive(self) -> bool:
        """Whether its range is positive, so that it is fitted by ratio."""
        return self.low > 0.0

    def coordinate(self, value: float) -> float:
        """Return the coordinate z of a value."""
        if self.is_positive:
            return float(np.log(value / self.nominal) / self._log_spread)
        return (value - self.nominal) / self.spread

    def value(self, coordinate: float) -> float:
        """Return the value at z, within the range."""
        low, high = self.bounds
        inside = min(max(coordinate, low), high)
        if self.is_positive:
            value = self.nominal * float(np.exp(inside * self._log_spread))
        else:
            value = self.nominal + inside * self.spread
        return min(max(value, self.low), self.high)  # the bounds' own rounding aside

    def deviation(self, coordinate: float, step: float) -> float:
        """Change of the value for a small step in z, to first order."""
        return step * (self.value(coordinate) * self._log_spread if self.is_positive else self.spread)

    @property
    def bounds(self) -> tuple[float, float]:
        """Coordinates z of both ends of the range."""
        return self.coordinate(self.low), self.coordinate(self.high)

    @property
    def _log_spread(self) -> float:
        return float(np.log1p(self.spread / self.nominal))


def values_at(parameters: Sequence[Parameter], coordinates: FloatArray) -> FloatArray:
    """Return the values of all parameters at z, shape (n,)."""
    return np.array([parameter.value(z) for parameter, z in zip(parameters, coordinates, strict=True)])


def coordinate_bounds(parameters: Sequence[Parameter]) -> FloatArray:
    """Return the coordinates z of both ends of all ranges, shape (2, n)."""
    return np.array([parameter.bounds for parameter in parameters]).T
