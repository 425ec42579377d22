"""Resonances of a sweep's point: coupled modes about the mean contact, and the linear response to mesh errors.

Between two speeds of a sweep a mesh harmonic changes with this response alone, as far as the transmission error is
static: it tells where a peak lies that the points pass by (:mod:`gearwhine.sweep.resolution`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling import CoupledMachine, ModesError, coupled_modes
from coupling.linear.complex_modes import CoupledModes
from coupling.linear.excitation_orders import excitation_lines
from coupling.linear.frequency_response import mesh_error_response, resonance_grid, touching_meshes
from coupling.statics.mean_mesh import mean_contact
from gearwhine.case import Case
from gearwhine.solve.sound.motion_lines import pulsating_efficiency

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

SOUND = "sound"
"""Name of the output of the sound power, beside those of the sensors."""

_TWO_PI = 2.0 * np.pi
_LOWEST_HZ = 20.0
_SMALLEST = 1e-150  # of a response, whose logarithm is taken


@dataclass(frozen=True, eq=False)
class Resonances:
    """Resonances of the coupled machine at one speed, linear about its mean contact.

    Attributes
    ----------
    frequencies : ndarray, shape (m,)
        Damped natural frequencies [Hz], ascending.
    half_widths : ndarray, shape (m,)
        Half of the half-power bandwidth, ζ ω / 2π [Hz].
    names : tuple of str
        Kind and place of each mode in words.
    meshes : tuple of str
        Names of the meshes in contact.
    mesh_orders : ndarray, shape (k,)
        Mesh frequency of each over the speed of the first driver.
    grid : ndarray, shape (f,)
        Frequencies of the response [Hz], ascending; every resonance is resolved.
    outputs : tuple of str
        Sensors, and `SOUND` where the housing radiates.
    response : ndarray, shape (o, k, f)
        Level of each output by a unit transmission error of each mesh [dB]; of the sound the square of the housing's
        velocity times the radiation efficiency of a pulsating sphere.
    mode_rates : ndarray of complex, shape (k, m, n)
        Rates of the housing's coordinates by a unit transmission error of each mesh at each mode's frequency; n is 0
        where the housing does not radiate.
    harmonic_rates : ndarray of complex, shape (k, h, n)
        Such rates at the multiples of each mesh frequency at this speed, 0 above the limit.
    """

    frequencies: FloatArray
    half_widths: FloatArray
    names: tuple[str, ...]
    meshes: tuple[str, ...]
    mesh_orders: FloatArray
    grid: FloatArray
    outputs: tuple[str, ...]
    response: FloatArray
    mode_rates: ComplexArray
    harmonic_rates: ComplexArray


def find_resonances(case: Case, machine: CoupledMachine, limit_hz: float) -> Resonances | None:
    """Find the resonances of a machine up to a frequency; None where it has no mesh, no output, or no proof.

    Parameters
    ----------
    case : Case
        Case of the machine.
    machine : CoupledMachine
        Machine at a steady speed.
    limit_hz : float
        Frequency up to which the housing's modes are complete [Hz].
    """
    steady = (case.transient is None or case.transient.run is None) and (
        case.operation is None or case.operation.base is None
    )
    contact = mean_contact(machine.system)
    touching = touching_meshes(machine, contact)
    heard = case.acoustics is not None and machine.housing is not None
    listens = machine.housing is not None and (machine.housing.sensors or heard)
    if not (steady and touching and listens and limit_hz > _LOWEST_HZ):
        return None
    try:
        modes = coupled_modes(machine.system, contact)
        grid = resonance_grid(modes, _TWO_PI * _LOWEST_HZ, _TWO_PI * limit_hz)
        responses = [
            mesh_error_response(machine, grid, mesh=response, contact=contact, modes=modes) for response in touching
        ]
    except ModesError:
        return None
    outputs: dict[str, list[FloatArray]] = {
        name: [20.0 * _log(np.abs(response.sensor_acceleration[name])) for response in responses]
        for name in responses[0].sensor_acceleration
    }
    if heard:
        assert case.acoustics is not None
        # The surface is not known here: a body of a square metre stands for it, in proportion alone.
        efficiency = pulsating_efficiency(grid / _TWO_PI, 1.0, case.acoustics.speed_of_sound)
        outputs[SOUND] = [
            10.0 * _log((np.abs(_rates(machine, response.coordinates, grid)) ** 2).sum(axis=1) * efficiency)
            for response in responses
        ]
    chosen = _swinging(modes, limit_hz)
    # One line for each mesh, in their order.
    orders = [line.order for line in excitation_lines(machine, shaft_orders=(), mesh_harmonics=(1,))]
    turning_hz = abs(machine.speeds[machine.leading_rotor]) / _TWO_PI
    most = int(limit_hz / (min(orders) * turning_hz))
    size = 0 if machine.housing is None else machine.housing.size

    def rates(hertz: FloatArray, mesh: int) -> ComplexArray:
        moved = mesh_error_response(machine, _TWO_PI * hertz, mesh=mesh, contact=contact, modes=modes)
        return _rates(machine, moved.coordinates, moved.frequencies)

    def harmonics(mesh: int) -> ComplexArray:
        multiples = np.asarray(orders[mesh] * turning_hz * np.arange(1, most + 1), dtype=np.float64)
        inside = multiples[multiples <= limit_hz]
        rates_inside = rates(inside, mesh) if len(inside) else np.zeros((0, size), dtype=np.complex128)
        return np.concatenate([rates_inside, np.zeros((most - len(rates_inside), size), dtype=np.complex128)])

    damped = modes.eigenvalues.imag[chosen] / _TWO_PI
    none = np.zeros((len(touching), len(damped), 0), dtype=np.complex128)
    return Resonances(
        frequencies=damped,
        half_widths=-modes.eigenvalues.real[chosen] / _TWO_PI,
        # The housing stands for its own place.
        names=tuple(
            modes.kinds[number] if modes.kinds[number] == modes.where[number] else modes.labels[number]
            for number in chosen.tolist()
        ),
        meshes=tuple(machine.meshes[number].name for number in touching),
        mesh_orders=np.array([orders[number] for number in touching]),
        grid=grid / _TWO_PI,
        outputs=tuple(outputs),
        response=np.array(list(outputs.values())),
        mode_rates=np.array([rates(damped, number) for number in touching]) if heard else none[:, : len(damped)],
        harmonic_rates=np.array([harmonics(number) for number in touching]) if heard else none[:, :0],
    )


def _swinging(modes: CoupledModes, limit_hz: float) -> npt.NDArray[np.intp]:
    """Return the modes that have a resonance below a frequency, in the order of their damped frequencies."""
    damped = modes.eigenvalues.imag / _TWO_PI
    proper = np.array([kind not in ("residual", "rigid") for kind in modes.kinds]) & (modes.eigenvalues.real < 0.0)
    chosen = np.flatnonzero(proper & (damped > 0.0) & (damped < limit_hz))
    return np.asarray(chosen[np.argsort(damped[chosen], kind="stable")])


def _rates(machine: CoupledMachine, coordinates: ComplexArray, omega: FloatArray) -> ComplexArray:
    """Rates of the housing's coordinates, whose shapes are normalised to the mass, shape (f, n)."""
    assert machine.housing is not None
    housing_rows = machine.rows(machine.housing.name, np.eye(machine.housing.size))
    return np.asarray(1j * omega[:, None] * (coordinates @ housing_rows.T))


def _log(values: FloatArray) -> FloatArray:
    return np.asarray(np.log10(np.maximum(values, _SMALLEST)))
