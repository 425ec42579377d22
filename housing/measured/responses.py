"""Measured frequency response functions: motions at the survey's degrees of freedom by forces at references."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

from housing.errors import MeasuredDataError
from housing.measured.geometry import MeasuredGeometry

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]

Motion = Literal["displacement", "velocity", "acceleration"]


@dataclass(frozen=True)
class MeasuredResponses:
    """Motion over force, over frequency: receptances, mobilities or accelerances.

    Attributes
    ----------
    geometry : MeasuredGeometry
        The points of the survey and the degrees of freedom whose motion was measured.
    reference_points : ndarray of int, shape (n_references,)
        Point of the geometry at which each force acted.
    reference_directions : ndarray, shape (n_references, 3)
        Unit vector of each force.
    frequencies : ndarray, shape (n_lines,)
        Ascending, not negative [rad/s].
    values : ndarray of complex, shape (n_dofs, n_references, n_lines)
        In m/N, m/(s N) or m/(s² N) by `motion`; NaN where a pair was not measured.
    motion : {"displacement", "velocity", "acceleration"}
        Measured quantity of the motion.

    Raises
    ------
    MeasuredDataError
        Where the arrays do not fit together or the frequencies do not ascend.
    """

    geometry: MeasuredGeometry
    reference_points: IntArray
    reference_directions: FloatArray
    frequencies: FloatArray
    values: ComplexArray
    motion: Motion = "acceleration"

    def __post_init__(self) -> None:
        references, lines = len(self.reference_points), len(self.frequencies)
        expected = (len(self.geometry.points), references, lines)
        if self.values.shape != expected or self.reference_directions.shape != (references, 3):
            raise MeasuredDataError(
                f"responses of shape {self.values.shape} and reference directions of shape "
                f"{self.reference_directions.shape}; expected {expected} and {(references, 3)}"
            )
        if lines < 2 or self.frequencies[0] < 0.0 or not np.all(np.diff(self.frequencies) > 0.0):
            raise MeasuredDataError(f"the {lines} frequencies of the responses must ascend from 0 or above")
        if references and not 0 <= self.reference_points.min() <= self.reference_points.max() < len(
            self.geometry.labels
        ):
            raise MeasuredDataError(f"a force acts at a point outside the survey's {len(self.geometry.labels)} points")
        if np.any(np.isnan(self.values).any(axis=2) != np.isnan(self.values[:, :, 0])):
            raise MeasuredDataError("responses lack values at some frequencies only; expected all or none of a pair")
        if self.motion not in get_args(Motion):
            raise MeasuredDataError(f"responses of {self.motion!r}; expected one of {', '.join(get_args(Motion))}")
