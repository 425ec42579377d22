"""Posterior of the parameters: uncertainty after the data, and parameters that the data cannot separate.

About the design of least misfit, with S the slopes of the residuals by the coordinates z in units of the noise,

    A = Sᵀ S,      C = (I + A)⁻¹,

A is the data's information, the unit matrix that of the prior and C the posterior covariance of z (Gauss's
approximation; Beck and Katafygiotis 1998). An eigenvector of A is a combination of parameters; its eigenvalue is the
data's information on it in units of the prior's: below one, the prior knows more. The bounds are left out of account,
so that a parameter at its bound is less uncertain than stated.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.updating.misfit import Misfit, Target, residuals
from housing.updating.parameters import Parameter
from housing.updating.surrogate import Neighbour

FloatArray = npt.NDArray[np.float64]

_CONFOUNDED = 0.7  # correlation from which the data determine a combination of two parameters only


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
        Their eigenvectors, a row each.
    slopes : ndarray, shape (n_modes, n)
        d ln ω of every mode of the design.
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
        """Relative standard deviation of each model frequency due to the parameters, shape (n_modes,)."""
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
        Of the design.
    coordinates : ndarray, shape (n,)
    near : Neighbour
        The design's own modes with their slopes.
    """
    slopes = residuals(target, misfit, near)[1]
    information = slopes.T @ slopes
    values, vectors = np.linalg.eigh(information)
    covariance = (vectors / (1.0 + values)) @ vectors.T
    return Posterior(coordinates, covariance, np.maximum(values[::-1], 0.0), vectors.T[::-1], near.slopes.T)
