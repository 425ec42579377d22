"""Time histories of a transient or a periodic response, by name of sensor, gear, bearing, gear pair and mode.

`histories` gives the signals of sensors, gears, bearings and gear pairs, `modal_record` the modal coordinates of rotors
and housing in a coupled motion.

A component's own coordinates are those of the shaft freed of its bearings. The modes of NASA TM-101442, Eqs. 7 to 10,
are those on averaged supports: x = Σ A_i φ_i, y = Σ B_i φ_i, and for torsion θ = Σ D_i φ_t,i (Eq. 11) of the free
shaft. Both span the same motions. With the component's lateral coordinates q, whose shapes are the columns of Φᵀ V,

    A = V q,    V = `RotorComponent.plane_basis`, orthogonal,

so a row of V, at the position of the rotor's coordinates, is a row of :class:`gearwhine.coupling.TransientOutputs`. The
housing's coordinates are those of its modes.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.connector_forces.kernel_arrays import bearing_arrays
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.connectors import LinearConnector, NonlinearConnector
from gearwhine.coupling.machine.mounted_parts import MountedGear
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.machine.tooth_friction import friction_of
from gearwhine.coupling.signals.transfer_paths import housing_connections
from gearwhine.coupling.time.settings import MotionRecord, TransientOutputs
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True)
class Histories:
    """Time histories at even spacing, s samples.

    Attributes
    ----------
    times : ndarray, shape (s,)
        Times [s].
    sensor_acceleration : dict of str to ndarray, shape (s,)
        Along each sensor [m/s²].
    gear_motion : dict of str to ndarray, shape (s, 3)
        x, y [m] of each gear's centre, and its rotation relative to the nominal one [rad].
    bearing_reaction : dict of str to ndarray, shape (s, d)
        Force of each shaft on its bearing in every held direction, x and y first [N, N m].
    mesh_force : dict of str to ndarray, shape (s,)
        Force along the line of action [N], drive flanks and back flanks apart.
    mesh_compression : dict of str to ndarray, shape (s,)
        Compression of each mesh [m].
    mesh_friction : dict of str to ndarray, shape (s, 2)
        Friction of each contact: force across the line of action [N], and power loss from the nominal
        rotation [W]; see :func:`gearwhine.coupling.machine.tooth_friction.friction_of`.
    bearing_axes : dict of str to tuple of int
        Axes of the columns of each ``bearing_reaction``: x, y, z and the rotations about x and y, 0 to 4.
    housing_reaction : dict of str to ndarray, shape (s, d)
        Forces on the housing beside those of bearings, along the directions of its
        :func:`gearwhine.coupling.signals.transfer_paths.housing_connections`: of supports of torque [N m], and of
        meshes on a ring whose rim moves with its bore [N].
    """

    times: FloatArray
    sensor_acceleration: dict[str, FloatArray]
    gear_motion: dict[str, FloatArray]
    bearing_reaction: dict[str, FloatArray]
    mesh_force: dict[str, FloatArray]
    mesh_compression: dict[str, FloatArray]
    mesh_friction: dict[str, FloatArray]
    bearing_axes: dict[str, tuple[int, ...]] = field(default_factory=dict)
    housing_reaction: dict[str, FloatArray] = field(default_factory=dict)

    @property
    def forces_on_housing(self) -> dict[str, FloatArray]:
        """Forces of the bearings and of all other connectors on the housing, shape (s, d) each [N, N m]."""
        return self.bearing_reaction | self.housing_reaction

    @property
    def bearing_force(self) -> dict[str, FloatArray]:
        """Force of each shaft on its bearing along x and y [N], shape (s, 2) each."""
        return {name: force[:, :2] for name, force in self.bearing_reaction.items()}

    @property
    def bearing_load(self) -> dict[str, FloatArray]:
        """The shaft's load on each bearing, shape (s, 5): forces along x, y, z [N], moments about x, y [N m].

        Components that a bearing does not hold are zero.
        """
        loads = {}
        for name, force in self.bearing_reaction.items():
            loads[name] = np.zeros((len(force), 5))
            loads[name][:, list(self.bearing_axes.get(name, range(force.shape[1])))] = force
        return loads

    @property
    def columns(self) -> FloatArray:
        """All signals as columns, shape (s, k)."""
        count = len(self.times)
        signals = [signal for name in _GROUPS for signal in getattr(self, name).values()]
        parts = [signal.reshape(count, math.prod(signal.shape[1:])) for signal in signals]
        return np.concatenate([np.empty((count, 0)), *parts], axis=1)

    def with_columns(self, times: FloatArray, columns: FloatArray) -> "Histories":
        """Return the same signals with other samples, from columns as in :attr:`columns`."""
        groups: list[dict[str, FloatArray]] = []
        column = 0
        for name in _GROUPS:
            groups.append({})
            for signal, old in getattr(self, name).items():
                width = math.prod(old.shape[1:])
                groups[-1][signal] = columns[:, column : column + width].reshape(len(times), *old.shape[1:])
                column += width
        signals: dict[str, Any] = dict(zip(_GROUPS, groups, strict=True))
        return replace(self, times=times, **signals)


_GROUPS = tuple(field.name for field in fields(Histories) if field.name not in ("times", "bearing_axes"))


@dataclass(frozen=True)
class HistoryQuantity:
    """One quantity of a record, declared once: every file, table and figure reads this.

    Attributes
    ----------
    name : str
        Name of the variable.
    dimensions : tuple of str
        Dimensions of the signals, then ``time``.
    of : callable
        Values of each signal of a record by its name, time along their first axis.
    unit : str
    what : str
        Long name.
    """

    name: str
    dimensions: tuple[str, ...]
    of: Callable[[Any], Mapping[str, FloatArray]]
    unit: str
    what: str

    def coordinates(self, signals: Sequence[str]) -> dict[str, tuple[Any, Any, dict[str, Any]]]:
        """Labels along the dimensions: the names of the signals, and x and y."""
        coordinates: dict[str, tuple[Any, Any, dict[str, Any]]] = {
            self.dimensions[0]: (self.dimensions[0], list(signals), {})
        }
        for axis in ("axis", "moment_axis"):
            if axis in self.dimensions:
                coordinates[axis] = (axis, ["x", "y"], {})
        return coordinates


HISTORY_QUANTITIES = (
    HistoryQuantity(
        "sensor_acceleration",
        ("sensor", "time"),
        lambda found: found.sensor_acceleration,
        "m/s2",
        "acceleration along the sensor",
    ),
    HistoryQuantity(
        "bearing_force",
        ("bearing", "time", "axis"),
        lambda found: found.bearing_force,
        "N",
        "force of the shaft on its bearing",
    ),
    HistoryQuantity(
        "bearing_axial_force",
        ("bearing", "time"),
        lambda found: {name: load[:, 2] for name, load in found.bearing_load.items()},
        "N",
        "force of the shaft on its bearing along z",
    ),
    HistoryQuantity(
        "bearing_moment",
        ("bearing", "time", "moment_axis"),
        lambda found: {name: load[:, 3:] for name, load in found.bearing_load.items()},
        "N m",
        "moment of the shaft on its bearing about x and y",
    ),
    HistoryQuantity(
        "mesh_force",
        ("contact", "time"),
        lambda found: found.mesh_force,
        "N",
        "gear-mesh force along the line of action",
    ),
    HistoryQuantity(
        "mesh_compression",
        ("contact", "time"),
        lambda found: found.mesh_compression,
        "m",
        "compression of the mesh along the line of action",
    ),
    HistoryQuantity(
        "friction_force",
        ("friction_contact", "time"),
        lambda found: {name: friction[:, 0] for name, friction in found.mesh_friction.items()},
        "N",
        "friction between the teeth, across the line of action",
    ),
    HistoryQuantity(
        "friction_power",
        ("friction_contact", "time"),
        lambda found: {name: friction[:, 1] for name, friction in found.mesh_friction.items()},
        "W",
        "power that friction between the teeth takes from the nominal rotation",
    ),
    HistoryQuantity(
        "gear_displacement",
        ("gear", "time", "axis"),
        lambda found: {name: motion[:, :2] for name, motion in found.gear_motion.items()},
        "m",
        "motion of the gear's centre",
    ),
    HistoryQuantity(
        "gear_rotation",
        ("gear", "time"),
        lambda found: {name: motion[:, 2] for name, motion in found.gear_motion.items()},
        "rad",
        "rotation of the gear beside the steady one",
    ),
)


def transient_outputs(machine: CoupledMachine) -> TransientOutputs:
    """Output rows of a machine, which :func:`histories` names."""
    system = machine.system
    moved = [np.zeros((0, system.size))]
    for gear in _gears(machine):
        rotor = next(rotor for rotor in machine.rotors if rotor.name == gear.rotor)
        rows = rotor.rim_section(gear.name, gear.at)[[0, 1, 5]]
        moved.append(machine.rows(rotor.name, rows))
    deflections = np.vstack([moved[0], *(_deflection_rows(connector) for connector in _recorded(machine))])
    return TransientOutputs(
        displacement=np.vstack([*moved, deflections]),
        velocity=deflections,
        acceleration=np.array([*machine.sensor_rows.values()]).reshape(-1, system.size),
    )


def empty_record(machine: CoupledMachine, outputs: TransientOutputs) -> MotionRecord:
    """Empty record of a transient with these outputs: names and widths of the signals before the first sample."""
    contacts = len(machine.system.contacts)
    widths = *(len(rows) for rows in (outputs.displacement, outputs.velocity, outputs.acceleration)), contacts, contacts
    return MotionRecord(np.zeros(0), *(np.zeros((0, width)) for width in widths))


def histories(machine: CoupledMachine, result: MotionRecord) -> Histories:
    """Time histories by name of a transient or a periodic response with :func:`transient_outputs`.

    Sensors show motion in space, as accelerometers do: where the base moves it is added.
    """
    gears = _gears(machine)
    deflections = result.displacement[:, 3 * len(gears) :]
    nominal_time, rates, _ = (machine.speed_profile or SpeedProfile.steady()).at(result.times)
    nonlinear = {connector.name: connector for connector in machine.system.nonlinear}
    forces = {}
    column = 0
    for connector in _recorded(machine):
        columns = slice(column, column + len(_deflection_rows(connector)))
        column = columns.stop
        moved, moving = deflections[:, columns], result.velocity[:, columns]
        if connector.turning:
            moved, moving = _turned_deflections(connector, moved, moving, nominal_time, rates)
        forces[connector.name] = _force(connector, moved, moving, rates)
        if connector.name in nonlinear:
            forces[connector.name] += _beside_linear(connector, nonlinear[connector.name], moved, nominal_time)
    bearings = [connector.name for connector in _bearings(machine)]
    on_housing = {name: force for name, force in forces.items() if name not in bearings}
    for one in housing_connections(machine):
        if one.contact is not None:
            on_housing[one.name] = one.of_mesh(result.force[:, one.contact], nominal_time)
    sensors = _in_space(machine, result)
    contacts = [contact.name for contact in machine.system.contacts]
    return Histories(
        times=result.times,
        sensor_acceleration=sensors,
        gear_motion={gear.name: result.displacement[:, 3 * i : 3 * i + 3] for i, gear in enumerate(gears)},
        bearing_reaction={name: forces[name] for name in bearings},
        mesh_force={name: result.force[:, i] for i, name in enumerate(contacts)},
        mesh_compression={name: result.compression[:, i] for i, name in enumerate(contacts)},
        mesh_friction={
            contact.name: friction_of(contact, nominal_time, rates, result.compression[:, i], result.force[:, i])
            for i, contact in enumerate(machine.system.contacts)
            if contact.sliding is not None
        },
        bearing_axes={connector.name: connector.axes for connector in _bearings(machine)},
        housing_reaction=on_housing,
    )


def _deflection_rows(connector: LinearConnector) -> FloatArray:
    """Rows of a bearing's deflections; where it turns, those of D(0) - Σ A, then A and B of each part."""
    parts = connector.turning
    still = sum((-part.cosine for part in parts), connector.directions)
    return np.asarray(np.hstack([still, *(half for part in parts for half in (part.cosine, part.sine))]).T)


def _turned_deflections(
    connector: LinearConnector,
    displacement: FloatArray,
    velocity: FloatArray,
    nominal_time: FloatArray,
    speed_ratios: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Deflections D(s)ᵀq of a bearing that turns and their rates D(s)ᵀq' + s' D'(s)ᵀq, shapes (s, d).

    Displacement and velocity are those of the rows of its parts.
    """
    d = connector.directions.shape[1]
    moved, moving = displacement[:, :d], velocity[:, :d]
    for number, part in enumerate(connector.turning):
        a, b = slice((2 * number + 1) * d, (2 * number + 2) * d), slice((2 * number + 2) * d, (2 * number + 3) * d)
        angle = part.rate * nominal_time[:, None]
        cosine, sine, rate = np.cos(angle), np.sin(angle), part.rate * speed_ratios[:, None]
        moved = moved + displacement[:, a] * cosine + displacement[:, b] * sine
        moving = moving + velocity[:, a] * cosine + velocity[:, b] * sine
        moving = moving + rate * (displacement[:, b] * cosine - displacement[:, a] * sine)
    return moved, moving


def _in_space(machine: CoupledMachine, result: MotionRecord) -> dict[str, FloatArray]:
    """Acceleration of each sensor, that of the base included [m/s²]."""
    housing, base = machine.housing, machine.loads.base
    if housing is None:
        return {}
    sensors = {name: result.acceleration[:, i] for i, name in enumerate(housing.sensors)}
    if base is None:
        return sensors
    for name, place in housing.sensor_places.items():
        sensors[name] = sensors[name] + base.acceleration_at(place.position, place.direction, result.times)
    return sensors


def _gears(machine: CoupledMachine) -> list[MountedGear]:
    """Every gear of the meshes, once, in order."""
    gears = [gear for mesh in machine.meshes for gear in (mesh.driver, mesh.driven)]
    return list({gear.name: gear for gear in gears}.values())


def _bearings(machine: CoupledMachine) -> tuple[LinearConnector, ...]:
    return machine.system.linear[: len(machine.bearings)]


def _recorded(machine: CoupledMachine) -> tuple[LinearConnector, ...]:
    """Linear connectors whose forces are recorded: the bearings, then others on the housing."""
    on_housing = {one.name for one in housing_connections(machine)}
    others = machine.system.linear[len(machine.bearings) :]
    return (*_bearings(machine), *(connector for connector in others if connector.name in on_housing))


def _beside_linear(
    linear: LinearConnector, connector: NonlinearConnector, deflection: FloatArray, nominal_time: FloatArray
) -> FloatArray:
    """Nonlinear part of a bearing's force, less that of its tangent, shape (s, d)."""
    from gearwhine.coupling.connector_forces.bearing_kernels import bearing_history

    # Directions in which nothing can move have no part in it.
    moving = np.flatnonzero(np.any(linear.directions != 0.0, axis=0))
    force = np.zeros_like(deflection)
    deflection_of_law = np.ascontiguousarray(deflection[:, moving])
    force[:, moving] = (
        bearing_history(bearing_arrays([connector]), 0, nominal_time, deflection_of_law)
        - deflection_of_law @ connector.stiffness.T
    )
    return force


def _force(connector: LinearConnector, deflection: FloatArray, velocity: FloatArray, rates: FloatArray) -> FloatArray:
    """Linear force of a bearing in every held direction, shape (s, d), at the relative speed of each sample."""
    table = connector.over_speed
    force = np.zeros_like(deflection) if connector.offset is None else np.tile(connector.offset, (len(deflection), 1))
    if table is None:
        return np.asarray(force + deflection @ connector.stiffness.T + velocity @ connector.damping.T)
    for row in range(len(table.speed_ratios)):
        # Weight of each speed of the table in the linear interpolation.
        share = np.interp(rates, table.speed_ratios, np.eye(len(table.speed_ratios))[row])
        weighted = np.flatnonzero(share)
        push = deflection[weighted] @ table.stiffness[row].T + velocity[weighted] @ table.damping[row].T
        force[weighted] += share[weighted, None] * push
    return force


@dataclass(frozen=True)
class ModalRows:
    """Output rows of a rotor's modal coordinates over the n coordinates of the machine.

    Coordinates are in m √kg (lateral) and rad √(kg m²) (torsional): a shape is per unit modal mass.

    Attributes
    ----------
    x, y : ndarray, shape (m, n)
        Rows of A_i and B_i of the bending modes on averaged supports, ascending, without attachment vectors.
    torsion : ndarray, shape (t, n)
        Rows of D_i of the torsional modes of the free shaft with its gears' bodies, the rigid rotation first, without
        attachment vectors.
    """

    x: FloatArray
    y: FloatArray
    torsion: FloatArray


def modal_rows(machine: CoupledMachine, rotor: str) -> ModalRows:
    """Output rows of the modal coordinates of one rotor, for ``TransientOutputs.displacement``.

    Raises
    ------
    CouplingError
        Where no rotor has the name.
    """
    part = next((part for part in machine.rotors if part.name == rotor), None)
    if part is None:
        names = ", ".join(part.name for part in machine.rotors)
        raise CouplingError(f"no rotor is named {rotor!r}; there are: {names}")
    lateral, torsional = part.modal.lateral, part.modal.torsional
    planar, twisting = lateral.certificate.found, torsional.certificate.found
    identity = np.eye(part.size)
    x, y = (
        part.plane_basis[:planar] @ identity[plane * part.plane_size : (plane + 1) * part.plane_size]
        for plane in (0, 1)
    )
    torsion = identity[2 * part.plane_size : 2 * part.plane_size + twisting]
    return ModalRows(*(machine.rows(rotor, rows) for rows in (x, y, torsion)))


@dataclass(frozen=True)
class ModalRecord:
    """Modal motion on record at even spacing, s samples.

    Attributes
    ----------
    coordinates : dict of str to ndarray, shape (s,)
        Coordinates such as ``input: torsion 1`` [rad √(kg m²)], ``input: bending 1, x``, ``housing: mode 1`` [m √kg].
    housing_acceleration : ndarray, shape (s, m)
        Accelerations of all modes of the housing [m √kg / s²].
    """

    coordinates: dict[str, FloatArray]
    housing_acceleration: FloatArray

    @property
    def columns(self) -> FloatArray:
        """All signals as columns, shape (s, k)."""
        moved = [coordinate[:, None] for coordinate in self.coordinates.values()]
        return np.concatenate([*moved, self.housing_acceleration], axis=1)

    def with_columns(self, columns: FloatArray) -> "ModalRecord":
        """Return the same signals with other samples, from columns as in :attr:`columns`."""
        coordinates = {name: columns[:, i] for i, name in enumerate(self.coordinates)}
        return ModalRecord(coordinates, columns[:, len(coordinates) :])


def with_modal_rows(
    machine: CoupledMachine, outputs: TransientOutputs, count: int = 0, *, housing: bool = True
) -> TransientOutputs:
    """Append outputs: accelerations of the housing's modes and the first modal coordinates of each part.

    Parameters
    ----------
    machine : CoupledMachine
    outputs : TransientOutputs
    count : int
        Number of modes of each kind of a rotor, and of the housing, whose displacement is recorded.
    housing : bool
        Whether the accelerations of the housing's modes are recorded.
    """
    accelerations = _housing_rows(machine)[: None if housing else 0]
    rows = np.array(list(_coordinate_rows(machine, count).values())).reshape(-1, machine.system.size)
    return replace(
        outputs,
        displacement=np.concatenate([outputs.displacement, rows]),
        acceleration=np.concatenate([outputs.acceleration, accelerations]),
    )


def modal_record(machine: CoupledMachine, result: MotionRecord, count: int = 0, *, housing: bool = True) -> ModalRecord:
    """Modal motion by name from the record of a transient with :func:`with_modal_rows`."""
    names = list(_coordinate_rows(machine, count))
    moved = result.displacement[:, result.displacement.shape[1] - len(names) :]
    first = result.acceleration.shape[1] - (len(_housing_rows(machine)) if housing else 0)
    return ModalRecord({name: moved[:, i] for i, name in enumerate(names)}, result.acceleration[:, first:])


def _coordinate_rows(machine: CoupledMachine, count: int) -> dict[str, FloatArray]:
    """Return the first rows of each kind of each part, by name."""
    if count == 0:
        return {}
    named = {}
    for rotor in machine.rotors:
        rows = modal_rows(machine, rotor.name)
        for number, row in enumerate(rows.torsion[:count], start=1):
            named[f"{rotor.name}: torsion {number}"] = row
        for axis, plane in (("x", rows.x), ("y", rows.y)):
            for number, row in enumerate(plane[:count], start=1):
                named[f"{rotor.name}: bending {number}, {axis}"] = row
    if machine.housing is not None:
        for number, row in enumerate(_housing_rows(machine)[:count], start=1):
            named[f"{machine.housing.name}: mode {number}"] = row
    return named


def _housing_rows(machine: CoupledMachine) -> FloatArray:
    """Rows of the housing's modes, without its residual attachments, shape (m, n)."""
    if machine.housing is None:
        return np.zeros((0, machine.system.size))
    modes = sum(kind == "housing" for kind in machine.housing.kinds)
    return machine.rows(machine.housing.name, np.eye(machine.housing.size)[:modes])
