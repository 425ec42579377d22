"""Component of a housing that another program has reduced to matrices with interface nodes, and the way back."""

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.components import HousingComponent, SensorPlace
from gearwhine.housing.reduced import NodeSeat, NodeSensor, ReducedHousing, ReducedMatrices

_FIRST_SEAT, _FIRST_SENSOR, _FIRST_INTERNAL = 101, 10001, 100001  # numbers of nodes and of internal coordinates
_DEPENDENT = 1e-10  # part of a motion below which it is one of others
_ALONG = 1e-9  # distance of a direction's component from one, along an axis


def component_of_reduced_housing(housing: ReducedHousing) -> HousingComponent:
    """Make the component of a reduced housing in its own modes, all of them kept.

    Modes above the frequency limit are of the kind ``residual``: their static response counts, their own frequencies
    are those of no housing. The same holds of coordinates without mass.
    """
    modes = housing.modes
    frequencies = modes.all_frequencies
    n, motions = len(frequencies), housing.participation_motions
    return HousingComponent(
        name="housing",
        kinds=("housing",) * modes.known + ("residual",) * (n - modes.known),
        stiffness=np.diag(frequencies**2),
        damping=housing.damping_matrix(),
        gyroscopic=np.zeros((n, n)),
        seats=housing.seat_motions(),
        seat_z={seat.name: seat.center[2] for seat in housing.seats},
        sensors=housing.sensor_motions(),
        participation=None if motions is None else modes.vectors.T @ housing.matrices.mass @ motions,
        seat_axes={seat.name: seat.center[:2] for seat in housing.seats},
        sensor_places={
            sensor.name: SensorPlace(np.array(sensor.position), np.array(sensor.direction))
            for sensor in housing.sensors
        },
        complete_below=housing.limit,
        warnings=tuple(housing.result_warnings),
    )


@dataclass(frozen=True)
class InterfaceMatrices:
    """A housing in the coordinates of Craig and Bampton: motions of nodes, and modes with these held.

    Attributes
    ----------
    matrices : ReducedMatrices
        Supports and damping of the housing included.
    seats : tuple of NodeSeat
    sensors : tuple of NodeSensor
    left_out : tuple of str
        Sensors that are no node: their direction is along no axis, or other nodes move them.
    """

    matrices: ReducedMatrices
    seats: tuple[NodeSeat, ...]
    sensors: tuple[NodeSensor, ...]
    left_out: tuple[str, ...]


def interface_matrices(component: HousingComponent) -> InterfaceMatrices:
    """Reduce a housing to its seats and sensors, without a loss: its own basis in other coordinates.

    With the motions B q of the nodes, q = T (b, η) has B T = (I, 0): the columns of T are the motions N of the modes η
    with the nodes held, and B⁺ less what N takes of it statically. M = Tᵀ T, K = Tᵀ K T and C = Tᵀ C T.

    - R. R. Craig, M. C. C. Bampton, "Coupling of substructures for dynamic analyses", AIAA Journal 6 (1968) 1313.

    Raises
    ------
    CouplingError
        Without seats, or where seats do not move independently of each other.
    """
    if not component.seats:
        raise CouplingError("a housing without seats has no interface; expected at least one seat")
    seats = [
        NodeSeat(name, _FIRST_SEAT + number, (*component.seat_axes[name], component.seat_z[name]))
        for number, name in enumerate(component.seats)
    ]
    coordinates = [(seat.node, axis) for seat in seats for axis in range(1, 7)]
    rows = np.vstack([component.seats[seat.name].T for seat in seats])
    if np.linalg.matrix_rank(rows, tol=_DEPENDENT * float(np.linalg.norm(rows, 2))) < len(rows):
        expected = "a housing with as many modes and static responses as its seats have motions"
        raise CouplingError(f"seats {', '.join(component.seats)} do not move independently; expected {expected}")
    sensors, left_out = list[NodeSensor](), list[str]()
    for number, (name, place) in enumerate(component.sensor_places.items()):
        axis, row = int(np.argmax(np.abs(place.direction))), component.sensors[name]
        alone = row - rows.T @ np.linalg.lstsq(rows.T, row, rcond=None)[0]
        is_along_axis = abs(place.direction[axis]) > 1.0 - _ALONG
        if not is_along_axis or np.linalg.norm(alone) <= _DEPENDENT * np.linalg.norm(row):
            left_out.append(name)
            continue
        node, sense = _FIRST_SENSOR + number, float(np.sign(place.direction[axis]))
        a, b, c = (sense * (axis == one) for one in range(3))
        x, y, z = place.position.tolist()
        sensors.append(NodeSensor(name, node, (x, y, z), (a, b, c)))
        coordinates.append((node, axis + 1))
        rows = np.vstack([rows, sense * row])
    held = linalg.null_space(rows)
    squares, vectors = np.linalg.eigh(held.T @ component.stiffness @ held)
    inner = held @ vectors
    static = np.linalg.pinv(rows)
    resisted = squares > _DEPENDENT * float(np.abs(squares).max(initial=1.0))
    taken = inner[:, resisted].T @ component.stiffness @ static
    static -= inner[:, resisted] @ (taken / squares[resisted, None])
    basis = np.hstack([static, inner])
    coordinates += [(_FIRST_INTERNAL + number, 0) for number in range(inner.shape[1])]
    mass, stiffness, damping = (
        basis.T @ part @ basis for part in (np.eye(component.size), component.stiffness, component.damping)
    )
    return InterfaceMatrices(
        ReducedMatrices(mass, stiffness, tuple(coordinates), damping), tuple(seats), tuple(sensors), tuple(left_out)
    )
