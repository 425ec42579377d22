"""Measuring points of a modal survey, and the directions measured at each."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_UNIT = 1e-6  # largest deviation of a unit vector's length from one: files carry six digits


@dataclass(frozen=True)
class MeasuredGeometry:
    """The points of a survey and its measured degrees of freedom, each one direction at one point.

    Attributes
    ----------
    labels : tuple of str
        Name or number of each point, each once.
    positions : ndarray, shape (n_points, 3)
        In the survey's own frame [m].
    points : ndarray of int, shape (n_dofs,)
        Point of each degree of freedom.
    directions : ndarray, shape (n_dofs, 3)
        Unit vector of each, in the survey's own frame; local directions are resolved when a file is read.
    lines : tuple of tuple of int
        Points joined by a line where the survey is drawn.

    Raises
    ------
    HousingError
        Where shapes do not fit together, a label stands twice, or a direction is not a unit vector.
    """

    labels: tuple[str, ...]
    positions: FloatArray
    points: IntArray
    directions: FloatArray
    lines: tuple[tuple[int, ...], ...] = ()

    def __post_init__(self) -> None:
        n_points, n_dofs = len(self.labels), len(self.points)
        if self.positions.shape != (n_points, 3) or self.directions.shape != (n_dofs, 3):
            raise HousingError(
                f"{n_points} labels and {n_dofs} degrees of freedom, but positions of shape {self.positions.shape} and "
                f"directions of shape {self.directions.shape}"
            )
        if len(set(self.labels)) < n_points:
            twice = next(label for label in self.labels if self.labels.count(label) > 1)
            raise HousingError(f"the point {twice!r} stands twice in the survey; each point needs its own label")
        if n_dofs and (self.points.min() < 0 or self.points.max() >= n_points):
            raise HousingError(f"a degree of freedom of the survey names a point outside its {n_points} points")
        lengths = np.linalg.norm(self.directions, axis=1)
        if np.any(np.abs(lengths - 1.0) > _UNIT):
            worst = int(np.argmax(np.abs(lengths - 1.0)))
            raise HousingError(f"direction {worst} of the survey has length {lengths[worst]:g}; expected a unit vector")
