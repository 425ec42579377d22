"""Transfer path analysis: contributions of bearings and housing modes to a sensor's spectral lines.

The rotors act on the housing by the bearing forces alone. With the force f of a connector on its other side, by the
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
import numpy.typing as npt

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.components import HousingComponent

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


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
        Bearings on the housing, b of them.
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


def housing_paths(machine: CoupledMachine, frequencies: FloatArray, forces: Mapping[str, ComplexArray]) -> HousingPaths:
    """Response of the housing to the bearing forces, path by path.

    Parameters
    ----------
    machine : CoupledMachine
        Machine with a housing.
    frequencies : ndarray, shape (l,)
        w [rad/s], above 0.
    forces : mapping of str to ndarray of complex, shape (l, d)
        Complex amplitudes of each connector's force in its d directions [N, N m]: that of the shaft on its bearing.
        Connectors without the housing are ignored.

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
    names = [component.name for component in machine.system.components]
    start = sum(part.size for part in machine.system.components[: names.index(housing.name)])
    coordinates = slice(start, start + housing.size)
    loads, bearings = [], []
    for connector in machine.system.linear:
        directions = connector.directions[coordinates]
        if not np.any(directions):
            continue
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
