"""Recovery of a reduced housing: motions of points by its coordinates, beside those of its interface nodes.

A reduction u = T q has a row of T for each motion of the whole model. Rows of points that were measured, or that have
accelerometers, come back with the matrices as recovery rows: the displacement of a point along x, y and z is R q.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.matrices import UNITS, Coordinate, RowLabels, in_basic_axes
from gearwhine.housing.reduced.matrix_files import read_arrays
from gearwhine.numerics.arrays import FloatArray

MOST_POINTS = 10_000
"""Number of points beyond which a file of recovery rows is refused."""

MOST_ENTRIES = 30_000_000
"""Number of entries of recovery rows beyond which a file is refused: 240 MB."""

ENDINGS = (".npz", ".nc")


@dataclass(frozen=True)
class RecoveredPoints:
    """Points of a reduced housing and their motions.

    Attributes
    ----------
    positions : ndarray, shape (n_points, 3)
        Places [m].
    rows : ndarray, shape (n_points, 3, n)
        Displacement along x, y, z by the coordinates of the matrices in SI.
    """

    positions: FloatArray
    rows: FloatArray


@dataclass(frozen=True)
class RecoveryFile:
    """Recovery rows as a file has them: of the coordinates in its own units and order.

    Attributes
    ----------
    positions : ndarray, shape (n_points, 3)
        Places [m].
    rows : ndarray, shape (n_points, 3, n)
    coordinates : tuple of Coordinate, or None
        Coordinates of the columns, where the file names them.
    """

    positions: FloatArray
    rows: FloatArray
    coordinates: tuple[Coordinate, ...] | None = None

    def points(
        self, coordinates: Sequence[Coordinate], labels: RowLabels | None = None, units: str = "SI"
    ) -> RecoveredPoints:
        """Return the points with rows of the coordinates of reduced matrices in SI.

        With the length L of the units and S = diag(L for a translation, 1 otherwise), u_SI = L R S⁻¹ q_SI.

        Parameters
        ----------
        coordinates : sequence of Coordinate
            Those of the reduced matrices.
        labels : RowLabels, optional
            Coordinates of the columns where the file does not name them; without either they are ``coordinates``.
        units : {"SI", "mm-t-s"}

        Raises
        ------
        HousingError
            Where there are more or fewer columns than coordinates, or some that the matrices do not have.
        """
        rows, given = self.rows, self.coordinates
        if given is None:
            given = tuple(coordinates) if labels is None else labels.coordinates
        if rows.shape[2] != len(given):
            raise HousingError(f"recovery rows of {rows.shape[2]} columns; expected {len(given)}, one each coordinate")
        if self.coordinates is None and labels is not None:
            rows = in_basic_axes(rows, labels)
        place: Mapping[Coordinate, int] = {coordinate: column for column, coordinate in enumerate(given)}
        if missing := [coordinate for coordinate in coordinates if coordinate not in place]:
            node, axis = missing[0]
            raise HousingError(f"recovery rows without a column of component {axis} of node {node}")
        length = UNITS[units][0]
        scale = np.array([1.0 if 1 <= axis <= 3 else length for _, axis in coordinates])
        return RecoveredPoints(self.positions, rows[:, :, [place[one] for one in coordinates]] * scale)


def read_recovery(path: Path) -> RecoveryFile:
    """Read recovery rows: arrays ``positions`` (p, 3) [m], ``recovery`` (3 p, n), and perhaps ``nodes`` and ``axes``.

    The rows are x, y and z of the first point, then those of the next. Columns are named by ``nodes`` and ``axes``, or
    else in the order of the rows of the stiffness.

    Raises
    ------
    HousingError
        Where the file is no archive of NumPy or NetCDF4 file of such arrays, or they do not fit together.
    """
    if path.suffix.lower() not in ENDINGS:
        raise HousingError(f"{path.name}: expected recovery rows in a file that ends in one of {', '.join(ENDINGS)}")
    arrays, coordinates = read_arrays(path, ("positions", "recovery"), MOST_ENTRIES)
    positions, rows = arrays["positions"], arrays["recovery"]
    count = len(positions)
    if positions.shape != (count, 3) or not 0 < count <= MOST_POINTS:
        raise HousingError(f"{path.name}: positions of shape {positions.shape}; expected 1 to {MOST_POINTS} x 3")
    if rows.ndim != 2 or len(rows) != 3 * count:
        raise HousingError(f"{path.name}: recovery of shape {rows.shape}; expected {3 * count} rows, three each point")
    if not (np.isfinite(positions).all() and np.isfinite(rows).all()):
        raise HousingError(f"{path.name}: expected finite numbers")
    if coordinates is not None and len(coordinates) != rows.shape[1]:
        raise HousingError(f"{path.name}: nodes of {len(coordinates)} columns; expected {rows.shape[1]}")
    return RecoveryFile(positions, rows.reshape(count, 3, -1), coordinates)
