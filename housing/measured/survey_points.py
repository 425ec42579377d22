"""Points of a universal file, with the three directions of motion of each."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from housing.errors import MeasuredDataError
from housing.measured.geometry import MeasuredGeometry

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class SurveyPoints:
    """The points of a universal file.

    Attributes
    ----------
    labels : tuple of str
    positions : ndarray, shape (n_points, 3)
        [m].
    directions : ndarray, shape (n_points, 3, 3)
        The point's own three directions of motion, as rows.
    lines : tuple of tuple of int
    """

    labels: tuple[str, ...]
    positions: FloatArray
    directions: FloatArray
    lines: tuple[tuple[int, ...], ...]

    def index(self, node: float, where: str) -> int:
        """The place of a node in the list; an error where it is not there."""
        try:
            return self.labels.index(str(int(node)))
        except ValueError:
            raise MeasuredDataError(f"{where} names node {int(node)}, which is not among the survey's points") from None

    def geometry(self, points: list[int], directions: list[FloatArray]) -> MeasuredGeometry:
        """These points with some degrees of freedom."""
        return MeasuredGeometry(
            self.labels,
            self.positions,
            np.array(points, dtype=np.int64),
            np.array(directions, dtype=np.float64).reshape(-1, 3),
            self.lines,
        )
