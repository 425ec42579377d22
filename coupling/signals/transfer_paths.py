"""Transfer path analysis: contributions of bearings and housing modes to a sensor's spectral lines.

The rotors act on the housing by the forces of its connectors alone: bearings, supports of torque, and meshes of a ring
whose rim moves with its bore (`housing_connections`). With the force f of a connector on its other side, by the
convention of :mod:`gearwhine.coupling.machine.connectors`, a line of frequency w has

    a(w) = - w² (K - w² + iwC)⁻¹ Σ_b (-D_b f_b(w)),

K, C and D the housing's own: a sum over bearings, coordinate by coordinate. A sensor's line is r a with its row r, so
it is a table of bearings by modes whose every sum is exact in steady motion: transfer path analysis with forces and
receptances that are known rather than measured (Plunt 2005; van der Seijs, de Klerk & Rixen 2016). The *rest* of a
record is free vibration that has not decayed, and the error of the time integration.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.numerics.arrays import ComplexArray, FloatArray


@dataclass(frozen=True)
class SensorPaths:
    """Contributions to a sensor's lines, complex amplitudes of acceleration [m/s²]; l lines, b bearings, m modes.

    Attributes
    ----------
    sensor : str
    bearings : tuple of str
    table : ndarray of complex, shape (l, b, m + 1)
        Contribution of each bearing through each housing mode, and last through the residual compliance.
    """

    sensor: str
    bearings: tuple[str, ...]
    table: ComplexArray

    @property
    def by_bearing(self) -> ComplexArray:
        """Contributions of the bearings, shape (l, b)."""
        return np.asarray(self.table.sum(axis=2))

    @property
    def by_mode(self) -> ComplexArray:
        """Contributions of the modes, shape (l, m + 1), the residual compliance last."""
        return np.asarray(self.table.sum(axis=1))

    @property
    def total(self) -> ComplexArray:
        """Sum of all contributions, shape (l,)."""
        return np.asarray(self.table.sum(axis=(1, 2)))


@dataclass(frozen=True)
class HousingPaths:
    """Response of the housing's coordinates to the bearing forces at l frequencies.

    Attributes
    ----------
    frequencies : ndarray, shape (l,)
        w [rad/s].
    bearings : tuple of str
        Bearings and other connectors on the housing, b of them.
    modes : int
        Number m of the n coordinates that are modes; the others are residual compliance.
    acceleration : ndarray of complex, shape (l, b, n)
        Acceleration of the housing's coordinates by each bearing's force.
    sensors : mapping of str to ndarray, shape (n,)
        Rows of the sensors.
    """

    frequencies: FloatArray
    bearings: tuple[str, ...]
    modes: int
    acceleration: ComplexArray
    sensors: Mapping[str, FloatArray]

    def at(self, sensor: str) -> SensorPaths:
        """Contributions to a sensor's lines.

        Raises
        ------
        CouplingError
            Where there is no such sensor.
        """
        if sensor not in self.sensors:
            raise CouplingError(f"no sensor {sensor!r}; there are: {', '.join(self.sensors) or 'none'}")
        parts = self.acceleration * self.sensors[sensor]
        local = parts[..., self.modes :].sum(axis=2, keepdims=True)
        return SensorPaths(sensor, self.bearings, np.concatenate([parts[..., : self.modes], local], axis=2))


def mode_parts(housing: HousingComponent, sensor: str, modal: ComplexArray, lines: ComplexArray) -> ComplexArray:
    """Contributions of recorded housing modes to a sensor's lines, free vibration included, shape (l, m + 1).

    The last part is that of the residual compliance: the line less the parts of the modes. The parts add up to the
    line.

    Parameters
    ----------
    housing : HousingComponent
    sensor : str
    modal : ndarray of complex, shape (l, m)
        Complex amplitudes of the modes' accelerations [m √kg / s²].
    lines : ndarray of complex, shape (l,)
        Complex amplitudes of the sensor's acceleration [m/s²].
    """
    parts = modal * housing.sensors[sensor][: modal.shape[1]]
    return np.concatenate([parts, (lines - parts.sum(axis=1))[:, None]], axis=1)


@dataclass(frozen=True, eq=False)
class HousingConnection:
    """A connector on the housing.

    Attributes
    ----------
    name : str
    directions : ndarray, shape (n, d)
        Constant motions of the housing's coordinates along which forces act: those of a bearing or a support, and of a
        mesh that circles in its ring D(0) - Σ A, then A and B of each part that turns.
    rates : tuple of float
        Rates of turning w of these parts at the nominal speed [rad/s].
    contact : int or None
        Number of the tooth contact; None for a linear connector.
    """

    name: str
    directions: FloatArray
    rates: tuple[float, ...] = ()
    contact: int | None = None

    def of_mesh(self, force: FloatArray, nominal_time: FloatArray) -> FloatArray:
        """Split the force of a mesh over time, shape (s,), into those along the constant directions, (s, d)."""
        parts = [np.ones_like(force)]
        for rate in self.rates:
            parts += [np.cos(rate * nominal_time), np.sin(rate * nominal_time)]
        return np.asarray(force[:, None] * np.stack(parts, axis=1))


def housing_connections(machine: CoupledMachine) -> tuple[HousingConnection, ...]:
    """Bearings, supports of torque and meshes by which the machine acts on its housing; none without one."""
    if machine.housing is None:
        return ()
    names = [component.name for component in machine.system.components]
    start = sum(part.size for part in machine.system.components[: names.index(machine.housing.name)])
    own = slice(start, start + machine.housing.size)
    found = [
        HousingConnection(one.name, one.directions[own]) for one in machine.system.linear if np.any(one.directions[own])
    ]
    for number, contact in enumerate(machine.system.contacts):
        turning = [part for part in contact.turning if np.any(part.cosine[own]) or np.any(part.sine[own])]
        columns = [contact.direction[:, None], *(half for part in turning for half in (part.cosine, part.sine))]
        columns[0] = columns[0] - sum((part.cosine for part in turning), np.zeros_like(columns[0]))
        directions = np.hstack(columns)[own]
        if np.any(directions):
            rates = tuple(part.rate for part in turning)
            found.append(HousingConnection(contact.name, directions, rates, number))
    return tuple(found)


def housing_paths(machine: CoupledMachine, frequencies: FloatArray, forces: Mapping[str, ComplexArray]) -> HousingPaths:
    """Response of the housing to the forces of its connectors, path by path.

    Parameters
    ----------
    machine : CoupledMachine
        Machine with a housing.
    frequencies : ndarray, shape (l,)
        w [rad/s], above 0.
    forces : mapping of str to ndarray of complex, shape (l, d)
        Complex amplitudes of the force of each of the :func:`housing_connections` in its d directions [N, N m]: that of
        the shaft on its bearing. Others are ignored.

    Raises
    ------
    CouplingError
        Without a housing, for a frequency that is not above 0, or where the force of a bearing on the housing is
        missing or of another shape.
    """
    if machine.housing is None:
        raise CouplingError("no housing; expected one whose bearings are paths")
    if np.any(frequencies <= 0.0):
        raise CouplingError("a frequency of 0 or below; the mean has no vibration to be traced")
    housing = machine.housing
    loads, bearings = [], []
    for connector in housing_connections(machine):
        directions = connector.directions
        shape = (len(frequencies), directions.shape[1])
        if connector.name not in forces or forces[connector.name].shape != shape:
            given_shape = forces[connector.name].shape if connector.name in forces else "none"
            raise CouplingError(f"{connector.name}: forces of shape {given_shape}; expected {shape}")
        loads.append(-forces[connector.name] @ directions.T)
        bearings.append(connector.name)
    pushing = np.array(loads).reshape(len(bearings), len(frequencies), housing.size).transpose(1, 2, 0)
    dynamic = housing.stiffness - frequencies[:, None, None] ** 2 * np.eye(housing.size)
    moved = np.linalg.solve(dynamic + 1j * frequencies[:, None, None] * housing.damping, pushing)
    return HousingPaths(
        frequencies=np.asarray(frequencies),
        bearings=tuple(bearings),
        modes=sum(kind == "housing" for kind in housing.kinds),
        acceleration=-(frequencies[:, None, None] ** 2) * moved.transpose(0, 2, 1),
        sensors=housing.sensors,
    )
