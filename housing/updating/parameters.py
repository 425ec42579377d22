"""Parameters of model updating: the range and prior of each, and their posterior, the uncertainty after the data.

A fit works in coordinates z in which the prior is a unit normal distribution: z = ln(p / nominal) / ln(1 + spread /
nominal) for positive parameters such as thicknesses, stiffnesses and densities, and z = (p - nominal) / spread for all
others. So steps of springs and walls are commensurate, and a thickness cannot become negative.

About the design of least misfit, with S the slopes of the residuals by the coordinates z in units of the noise,

    A = Sᵀ S,      C = (I + A)⁻¹,

A is the information of the data, the unit matrix that of the prior and C the posterior covariance of z (Gauss's
approximation; Beck and Katafygiotis 1998). An eigenvector of A is a combination of parameters; its eigenvalue is the
data's information on it in units of the prior's: below one, the prior knows more. The bounds are left out of account,
so that a parameter at its bound is less uncertain than stated.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.updating.misfit import Misfit, Target, residuals
from gearwhine.housing.updating.surrogate import Neighbour
from gearwhine.numerics.arrays import FloatArray

_CONFOUNDED = 0.7  # correlation from which the data determine a combination of two parameters only


@dataclass(frozen=True)
class Parameter:
    """A parameter of the model that is fitted.

    Attributes
    ----------
    name : str
    low, high : float
        Bounds of the parameter.
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


@dataclass(frozen=True)
class Posterior:
    """The parameters after the data, in coordinates z of a unit prior.

    Attributes
    ----------
    coordinates : ndarray, shape (n,)
        z of the design.
    covariance : ndarray, shape (n, n)
        C.
    information : ndarray, shape (n,)
        Eigenvalues of A, descending.
    directions : ndarray, shape (n, n)
        Eigenvectors of A, a row each.
    slopes : ndarray, shape (n_modes, n)
        d ln ω of every elastic mode of the design.
    """

    coordinates: FloatArray
    covariance: FloatArray
    information: FloatArray
    directions: FloatArray
    slopes: FloatArray

    @property
    def deviations(self) -> FloatArray:
        """Standard deviation of each coordinate, shape (n,); that of the prior is 1."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def correlations(self) -> FloatArray:
        """Correlation coefficients, shape (n, n)."""
        scale = 1.0 / self.deviations
        return np.asarray(scale[:, None] * self.covariance * scale)

    @property
    def n_learned(self) -> int:
        """Combinations of parameters of which the data know more than the prior."""
        return int(np.count_nonzero(self.information > 1.0))

    @property
    def confounded(self) -> list[tuple[int, int, float]]:
        """Pairs of parameters of which the data determine a combination only; with correlations, strongest first."""
        table = self.correlations
        rows, columns = np.triu_indices(len(table), 1)
        strong = [
            (int(i), int(j), float(table[i, j]))
            for i, j in zip(rows, columns, strict=True)
            if abs(table[i, j]) > _CONFOUNDED
        ]
        return sorted(strong, key=lambda entry: -abs(entry[2]))

    def frequency_deviations(self) -> FloatArray:
        """Relative standard deviation of each elastic frequency due to the parameters, shape (n_modes,)."""
        return np.asarray(np.sqrt(np.einsum("mi,ij,mj->m", self.slopes, self.covariance, self.slopes)))

    def distance(self, coordinates: FloatArray) -> float:
        """Squared distance of other coordinates in units of the posterior: χ² of n degrees of freedom."""
        apart = coordinates - self.coordinates
        return float(apart @ np.linalg.solve(self.covariance, apart))

    def values(self, parameters: Sequence[Parameter]) -> list[tuple[float, float]]:
        """Value and standard deviation of each parameter, in its own unit."""
        return [
            (parameter.value(z), parameter.deviation(z, deviation))
            for parameter, z, deviation in zip(parameters, self.coordinates, self.deviations, strict=True)
        ]


def posterior(target: Target, misfit: Misfit, coordinates: FloatArray, near: Neighbour) -> Posterior:
    """Compute the posterior of the parameters about a design.

    Parameters
    ----------
    target : Target
    misfit : Misfit
        Misfit of the design.
    coordinates : ndarray, shape (n,)
    near : Neighbour
        The design's own modes with their slopes.
    """
    slopes = residuals(target, misfit, near)[1]
    information = slopes.T @ slopes
    values, vectors = np.linalg.eigh(information)
    covariance = (vectors / (1.0 + values)) @ vectors.T
    return Posterior(coordinates, covariance, np.maximum(values[::-1], 0.0), vectors.T[::-1], near.slopes.T)
