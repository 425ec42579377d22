"""Rolling-bearing and gap laws as plain arrays for the compiled kernels."""

from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from coupling.bearing_law import BearingLaw, GapLaw, RollingLaw
from coupling.connector import NonlinearConnector
from coupling.kernel_arrays import BALLS, GAP, ROLLERS, Bearings
from rotors.rolling import BallRow

FloatArray = npt.NDArray[np.float64]

_SHAPE = 7
Row = tuple[int, int, tuple[float, ...], tuple[float, float], FloatArray]


def bearing_arrays(connectors: Sequence[NonlinearConnector]) -> Bearings:
    """Arrays of the laws of some bearings, see :class:`coupling.kernel_arrays.Bearings`."""
    b = len(connectors)
    linear, fixed, preload = np.zeros((b, 5, 5)), np.zeros((b, 5)), np.zeros(b)
    rows: list[Row] = []
    first, first_row = [0], [0]
    for number, connector in enumerate(connectors):
        d = len(connector.axes)
        linear[number, :d, :d] = connector.stiffness
        fixed[number] = connector.law.reference
        if isinstance(connector.law, RollingLaw):
            preload[number] = connector.law.state.bearing.axial_preload
        rows += _rows(connector.law, connector.speed)
        first.append(first[-1] + d)
        first_row.append(len(rows))
    shape, slices = (
        np.zeros((len(rows), _SHAPE)),
        np.zeros((len(rows), max((len(row[4]) for row in rows), default=0), 2)),
    )
    for at, row in enumerate(rows):
        shape[at, : len(row[2])] = row[2]
        slices[at, : len(row[4])] = row[4]
    return Bearings(
        axis=np.array([axis for connector in connectors for axis in connector.axes], dtype=np.int64),
        first=np.array(first, dtype=np.int64),
        linear=linear,
        fixed=fixed,
        preload=preload,
        first_row=np.array(first_row, dtype=np.int64),
        kind=np.array([row[0] for row in rows], dtype=np.int64),
        elements=np.array([row[1] for row in rows], dtype=np.int64),
        shape=shape,
        cage=np.array([row[3] for row in rows], dtype=np.float64).reshape(-1, 2),
        slices=slices,
    )


def _rows(law: BearingLaw, speed: float) -> Iterator[Row]:
    """Kind, count, numbers, cage and slices of every row of a law."""
    none = np.zeros((0, 2))
    if isinstance(law, GapLaw):
        yield GAP, 0, (law.force, law.depth, law.exponent, law.gap), (0.0, 0.0), none
        return
    for row in law.state.bearing.rows:
        cage = law.cage_angle, row.cage_speed(speed)
        if isinstance(row, BallRow):
            yield BALLS, row.count, _ball_shape(row), cage, none
        else:
            place = row.position + row.slice_places
            shape = 0.5 * row.clearance, row.stiffness / row.slices, float(row.slices)
            yield ROLLERS, row.count, shape, cage, np.column_stack([place, 2.0 * row.slice_drops])


def _ball_shape(row: BallRow) -> tuple[float, ...]:
    """A, v₀, |v₀|² − A², the inner centres' radius and place, and K; see `rotors.rolling.ball_contacts`."""
    return row.groove_distance, *row.groove_offset, row.groove_excess, *row.inner_groove_centre, row.stiffness
