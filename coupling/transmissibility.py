"""Frequency response of a machine: gear forces, bearing loads and sensors under harmonic excitation.

A transmission error e = e^{iwt} at one mesh presses its contact by δ = dᵀq - e. It drives the coordinates with the load
(k + iwc) d e, and every contact carries F = (k + iwc)(dᵀq - e), the error being its own alone: the dynamic mesh force
by unit error, d.c. limit k of the mesh in series with all that gives way behind it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.contact_state import ContactState, mean_contact
from coupling.errors import CouplingError
from coupling.machine import CoupledMachine
from coupling.modes import CoupledModes
from coupling.receptance import response
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class FrequencyResponse:
    """Complex amplitudes under a harmonic excitation at f frequencies; the signals are the real parts of a e^{iwt}.

    Attributes
    ----------
    excitation : str
        Name of the excitation.
    unit : str
        Unit of the excitation, which has the amplitude 1.
    frequencies : ndarray, shape (f,)
        w [rad/s].
    coordinates : ndarray of complex, shape (f, n)
        Amplitudes of the whole system.
    sensor_acceleration : dict of str to ndarray of complex, shape (f,)
        Along each sensor [m/s²].
    bearing_load : dict of str to ndarray of complex, shape (f, 5)
        Of each shaft on its bearing: forces along x, y, z [N], moments about x and y [N m]; 0 where nothing holds.
    mesh_force : dict of str to ndarray of complex, shape (f,)
        Force along each line of action [N]; contacts that do not touch are left out.
    """

    excitation: str
    unit: str
    frequencies: FloatArray
    coordinates: ComplexArray
    sensor_acceleration: dict[str, ComplexArray]
    bearing_load: dict[str, ComplexArray]
    mesh_force: dict[str, ComplexArray]

    @property
    def bearing_force(self) -> dict[str, ComplexArray]:
        """Force of each shaft on its bearing along x and y [N], shape (f, 2) each."""
        return {name: load[:, :2] for name, load in self.bearing_load.items()}

    def peaks(self, curve: ComplexArray, count: int = 8) -> npt.NDArray[np.int64]:
        """Places along the frequencies at which the size of a curve (f,) has its highest maxima, highest first."""
        size = np.abs(curve)
        tops = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])) + 1
        return np.asarray(tops[np.argsort(-size[tops], kind="stable")][:count])


def mesh_error_response(
    machine: CoupledMachine,
    frequencies: FloatArray,
    *,
    mesh: int = 0,
    contact: ContactState | None = None,
    modes: CoupledModes | None = None,
) -> FrequencyResponse:
    """Response to a unit transmission error along one line of action [1/m].

    Parameters
    ----------
    machine : CoupledMachine
    frequencies : ndarray, shape (f,)
        w > 0 [rad/s].
    mesh : int
        Number of the gear mesh.
    contact : ContactState, optional
        By default the mean contact.
    modes : CoupledModes, optional
        Modes about the same contact, to be superposed; by default the system is solved at every frequency.

    Raises
    ------
    CouplingError
        Where the machine has no such mesh, or it does not touch.
    ModesError
        As :func:`coupling.receptance`.
    """
    if not 0 <= mesh < len(machine.meshes):
        raise CouplingError(f"gear mesh number {mesh} of {len(machine.meshes)}; expected one of those, from 0")
    state = mean_contact(machine.system) if contact is None else contact
    tooth = machine.system.contacts[mesh]
    law = state.stiffness[mesh] + 1j * frequencies * state.damping[mesh]
    if state.stiffness[mesh] == 0.0:
        raise CouplingError(f"{tooth.name} does not touch; expected a contact that carries an error on")
    loads = law[:, None, None] * tooth.direction
    moved = response(machine.system, loads, frequencies, state, modes)[:, 0]
    return _named(machine, state, frequencies, moved, f"transmission error of {tooth.name}", "m", mesh)


def sensor_force_response(
    machine: CoupledMachine,
    frequencies: FloatArray,
    *,
    sensor: str,
    contact: ContactState | None = None,
    modes: CoupledModes | None = None,
) -> FrequencyResponse:
    """Response to a unit force along a sensor [1/N], as of a hammer blow.

    Raises
    ------
    CouplingError
        Where the housing has no such sensor.
    ModesError
        As :func:`coupling.receptance`.
    """
    rows = machine.sensor_rows
    if sensor not in rows:
        raise CouplingError(f"no sensor {sensor!r}; there are: {', '.join(rows) or 'none'}")
    state = mean_contact(machine.system) if contact is None else contact
    loads = np.broadcast_to(rows[sensor], (len(frequencies), 1, machine.system.size))
    moved = response(machine.system, loads, frequencies, state, modes)[:, 0]
    return _named(machine, state, frequencies, moved, f"force at {sensor}", "N")


def unbalance_response(
    machine: CoupledMachine,
    speeds: Sequence[float] | FloatArray,
    *,
    rotor: str,
    contact: ContactState | None = None,
) -> FrequencyResponse:
    """Unbalance response of a rotor with its own unbalances, over the speed of the leading rotor.

    The machine is assembled at each speed: gyroscopic terms and bearings with tables follow.

    Parameters
    ----------
    machine : CoupledMachine
    speeds : sequence of float
        Of the leading rotor [rad/s], none 0.
    rotor : str
    contact : ContactState, optional
        At every speed; by default the mean contact under the machine's load.

    Returns
    -------
    FrequencyResponse
        With w the signed speeds of that rotor: amplitudes rotate with it.

    Raises
    ------
    CouplingError
        Where the rotor has no unbalance, or a speed is 0.
    """
    if not any(one.rotor == rotor and one.moment != 0.0 for one in machine.unbalances):
        raise CouplingError(f"rotor {rotor!r} has no unbalance; expected one")
    turned = [machine.at_speed(float(speed)) for speed in speeds]
    frequencies = np.array([one.speeds[rotor] for one in turned])
    if np.any(frequencies == 0.0):
        raise CouplingError("a speed of 0, where an unbalance has no force; expected others")
    state = mean_contact(turned[0].system) if contact is None else contact
    number = [part.name for part in machine.system.components].index(rotor)
    rows = _rows_of(machine.system, number)
    parts = []
    for one, w in zip(turned, frequencies, strict=True):
        # Other rotors of the same speed have loads of that frequency too, on their own coordinates.
        load = sum(
            (each.amplitude for each in one.system.harmonic_loads if each.frequency == w),
            np.zeros(one.system.size, dtype=np.complex128),
        )
        alone = np.where(rows, load, 0.0)
        moved = response(one.system, alone[None, None, :], np.array([w]), state)[:, 0]
        parts.append(_named(one, state, np.array([w]), moved, f"unbalance of {rotor}", "unbalance as it is"))
    first = parts[0]
    return FrequencyResponse(
        excitation=first.excitation,
        unit=first.unit,
        frequencies=frequencies,
        coordinates=np.concatenate([part.coordinates for part in parts]),
        sensor_acceleration=_joined([part.sensor_acceleration for part in parts]),
        bearing_load=_joined([part.bearing_load for part in parts]),
        mesh_force=_joined([part.mesh_force for part in parts]),
    )


def _rows_of(system: CoupledSystem, number: int) -> npt.NDArray[np.bool_]:
    """Mask of a component's coordinates, shape (n,)."""
    owners = np.repeat(np.arange(len(system.components)), [part.size for part in system.components])
    return np.asarray(owners == number)


def _joined(each: list[dict[str, ComplexArray]]) -> dict[str, ComplexArray]:
    return {name: np.concatenate([one[name] for one in each]) for name in each[0]}


def _named(
    machine: CoupledMachine,
    state: ContactState,
    frequencies: FloatArray,
    moved: ComplexArray,
    excitation: str,
    unit: str,
    erring: int | None = None,
) -> FrequencyResponse:
    """Response at sensors, bearings and meshes from coordinates (f, n); one mesh may have a unit error."""
    system, rate = machine.system, 1j * frequencies
    loads = {}
    for connector in system.linear[: len(machine.bearings)]:
        deflection = moved @ connector.directions
        loads[connector.name] = np.zeros((len(moved), 5), dtype=np.complex128)
        loads[connector.name][:, list(connector.axes or range(deflection.shape[1]))] = (
            deflection @ connector.stiffness.T + (rate[:, None] * deflection) @ connector.damping.T
        )
    pressed = {}
    for number, tooth in enumerate(system.contacts):
        if state.stiffness[number] != 0.0 or state.damping[number] != 0.0:
            compression = moved @ tooth.direction - (1.0 if number == erring else 0.0)
            pressed[tooth.name] = (state.stiffness[number] + rate * state.damping[number]) * compression
    return FrequencyResponse(
        excitation=excitation,
        unit=unit,
        frequencies=np.asarray(frequencies),
        coordinates=moved,
        sensor_acceleration={name: -(frequencies**2) * (moved @ row) for name, row in machine.sensor_rows.items()},
        bearing_load=loads,
        mesh_force=pressed,
    )
