"""Time histories of a transient or a periodic response, by the names of sensors, gears, bearings and gear pairs."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from coupling.bearing_arrays import bearing_arrays
from coupling.connector import LinearConnector, NonlinearConnector
from coupling.machine import CoupledMachine
from coupling.mounted import MountedGear
from coupling.settings import MotionRecord, TransientOutputs
from coupling.sliding import friction_of
from coupling.turning import SpeedProfile

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Histories:
    """Time histories at even spacing, s samples.

    Attributes
    ----------
    times : ndarray, shape (s,)
        [s].
    sensor_acceleration : dict of str to ndarray, shape (s,)
        Along each sensor [m/s²].
    gear_motion : dict of str to ndarray, shape (s, 3)
        x, y [m] of each gear's centre, and its rotation relative to the nominal one [rad].
    tie_force : dict of str to ndarray, shape (s, d)
        Force of each shaft on its bearing in every held direction, x and y first [N, N m].
    mesh_force : dict of str to ndarray, shape (s,)
        Force along the line of action [N], drive flanks and back flanks apart.
    mesh_compression : dict of str to ndarray, shape (s,)
        [m].
    mesh_friction : dict of str to ndarray, shape (s, 2)
        Of every contact with friction: its force across the line of action [N], and its power loss from the nominal
        rotation [W]; see :func:`coupling.sliding.friction_of`.
    tie_axes : dict of str to tuple of int
        Axes of the columns of each ``bearing_reaction``: x, y, z and the rotations about x and y, 0 to 4.
    """

    times: FloatArray
    sensor_acceleration: dict[str, FloatArray]
    gear_motion: dict[str, FloatArray]
    bearing_reaction: dict[str, FloatArray]
    mesh_force: dict[str, FloatArray]
    mesh_compression: dict[str, FloatArray]
    mesh_friction: dict[str, FloatArray]
    bearing_axes: dict[str, tuple[int, ...]] = field(default_factory=dict)

    @property
    def bearing_force(self) -> dict[str, FloatArray]:
        """Force of each shaft on its bearing along x and y [N], shape (s, 2) each."""
        return {name: force[:, :2] for name, force in self.bearing_reaction.items()}

    @property
    def bearing_load(self) -> dict[str, FloatArray]:
        """The shaft's load on each bearing, shape (s, 5): forces along x, y, z [N], moments about x, y [N m].

        Components that a bearing does not hold are zero.
        """
        found = {}
        for name, force in self.bearing_reaction.items():
            found[name] = np.zeros((len(force), 5))
            found[name][:, list(self.bearing_axes.get(name, range(force.shape[1])))] = force
        return found

    @property
    def columns(self) -> FloatArray:
        """All signals as columns, shape (s, k)."""
        count = len(self.times)
        signals = [signal for name in _GROUPS for signal in getattr(self, name).values()]
        parts = [signal.reshape(count, math.prod(signal.shape[1:])) for signal in signals]
        return np.concatenate([np.empty((count, 0)), *parts], axis=1)

    def with_columns(self, times: FloatArray, columns: FloatArray) -> "Histories":
        """The same signals with other samples, from columns as in :attr:`columns`."""
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


_GROUPS = tuple(one.name for one in fields(Histories) if one.name not in ("times", "tie_axes"))


@dataclass(frozen=True)
class Quantity:
    """One quantity of a record, declared once: every file, table and figure reads this.

    Attributes
    ----------
    name : str
        Name of the variable.
    dimensions : tuple of str
        The signals' own first, then ``time``.
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
        found: dict[str, tuple[Any, Any, dict[str, Any]]] = {
            self.dimensions[0]: (self.dimensions[0], list(signals), {})
        }
        for axis in ("axis", "moment_axis"):
            if axis in self.dimensions:
                found[axis] = (axis, ["x", "y"], {})
        return found


HISTORY_QUANTITIES = (
    Quantity(
        "sensor_acceleration",
        ("sensor", "time"),
        lambda found: found.sensor_acceleration,
        "m/s2",
        "acceleration along the sensor",
    ),
    Quantity(
        "bearing_force",
        ("bearing", "time", "axis"),
        lambda found: found.bearing_force,
        "N",
        "force of the shaft on its bearing",
    ),
    Quantity(
        "bearing_axial_force",
        ("bearing", "time"),
        lambda found: {name: load[:, 2] for name, load in found.bearing_load.items()},
        "N",
        "force of the shaft on its bearing along z",
    ),
    Quantity(
        "bearing_moment",
        ("bearing", "time", "moment_axis"),
        lambda found: {name: load[:, 3:] for name, load in found.bearing_load.items()},
        "N m",
        "moment of the shaft on its bearing about x and y",
    ),
    Quantity(
        "mesh_force",
        ("contact", "time"),
        lambda found: found.mesh_force,
        "N",
        "gear-mesh force along the line of action",
    ),
    Quantity(
        "mesh_compression",
        ("contact", "time"),
        lambda found: found.mesh_compression,
        "m",
        "compression of the mesh along the line of action",
    ),
    Quantity(
        "friction_force",
        ("friction_contact", "time"),
        lambda found: {name: friction[:, 0] for name, friction in found.mesh_friction.items()},
        "N",
        "friction between the teeth, across the line of action",
    ),
    Quantity(
        "friction_power",
        ("friction_contact", "time"),
        lambda found: {name: friction[:, 1] for name, friction in found.mesh_friction.items()},
        "W",
        "power that friction between the teeth takes from the nominal rotation",
    ),
    Quantity(
        "gear_displacement",
        ("gear", "time", "axis"),
        lambda found: {name: motion[:, :2] for name, motion in found.gear_motion.items()},
        "m",
        "motion of the gear's centre",
    ),
    Quantity(
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
        rows = np.vstack([rotor.motions(gear.at)[:2], rotor.rotation(gear.at)])
        moved.append(machine.rows(rotor.name, rows))
    deflections = np.vstack([moved[0], *(connector.directions.T for connector in _bearings(machine))])
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


def histories(machine: CoupledMachine, result: MotionRecord, turning: SpeedProfile | None = None) -> Histories:
    """Time histories by name of a transient or a periodic response with :func:`transient_outputs`.

    ``turning`` is the speed over time, by default the nominal one.
    """
    gears = _gears(machine)
    deflections = result.displacement[:, 3 * len(gears) :]
    turned, rates, _ = (turning or SpeedProfile.steady()).at(result.times)
    nonlinear = {connector.name: connector for connector in machine.system.nonlinear}
    forces = {}
    column = 0
    for connector in _bearings(machine):
        columns = slice(column, column + connector.directions.shape[1])
        column = columns.stop
        forces[connector.name] = _force(connector, deflections[:, columns], result.velocity[:, columns], rates)
        if connector.name in nonlinear:
            forces[connector.name] += _beside_linear(
                connector, nonlinear[connector.name], deflections[:, columns], turned
            )
    names = [] if machine.housing is None else list(machine.housing.sensors)
    contacts = [contact.name for contact in machine.system.contacts]
    return Histories(
        times=result.times,
        sensor_acceleration={name: result.acceleration[:, i] for i, name in enumerate(names)},
        gear_motion={gear.name: result.displacement[:, 3 * i : 3 * i + 3] for i, gear in enumerate(gears)},
        bearing_reaction=forces,
        mesh_force={name: result.force[:, i] for i, name in enumerate(contacts)},
        mesh_compression={name: result.compression[:, i] for i, name in enumerate(contacts)},
        mesh_friction={
            contact.name: friction_of(contact, turned, rates, result.compression[:, i], result.force[:, i])
            for i, contact in enumerate(machine.system.contacts)
            if contact.sliding is not None
        },
        bearing_axes={connector.name: connector.axes for connector in _bearings(machine)},
    )


def _gears(machine: CoupledMachine) -> list[MountedGear]:
    """Every gear of the meshes, once, in order."""
    gears = [gear for mesh in machine.meshes for gear in (mesh.driver, mesh.driven)]
    return list({gear.name: gear for gear in gears}.values())


def _bearings(machine: CoupledMachine) -> tuple[LinearConnector, ...]:
    return machine.system.linear[: len(machine.bearings)]


def _beside_linear(
    linear: LinearConnector, connector: NonlinearConnector, deflection: FloatArray, turned: FloatArray
) -> FloatArray:
    """Nonlinear part of a bearing's force beside its tangent's, shape (s, d)."""
    from coupling.bearing_kernels import bearing_history

    # Directions in which nothing can move have no part in it.
    moving = np.flatnonzero(np.any(linear.directions != 0.0, axis=0))
    force = np.zeros_like(deflection)
    own = np.ascontiguousarray(deflection[:, moving])
    force[:, moving] = bearing_history(bearing_arrays([connector]), 0, turned, own) - own @ connector.stiffness.T
    return force


def _force(connector: LinearConnector, deflection: FloatArray, velocity: FloatArray, rates: FloatArray) -> FloatArray:
    """Linear force of a bearing in every held direction, shape (s, d), at the relative speed of each sample."""
    table = connector.over_speed
    if table is None:
        return np.asarray(deflection @ connector.stiffness.T + velocity @ connector.damping.T)
    force = np.zeros_like(deflection)
    for row in range(len(table.rates)):
        # Weight of each speed of the table in the linear interpolation.
        share = np.interp(rates, table.rates, np.eye(len(table.rates))[row])
        held = np.flatnonzero(share)
        push = deflection[held] @ table.stiffness[row].T + velocity[held] @ table.damping[row].T
        force[held] += share[held, None] * push
    return force
