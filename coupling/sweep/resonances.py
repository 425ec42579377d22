"""Resonances of a sweep's point: coupled modes about the mean contact, and the mesh harmonics near them.

Between two speeds of a sweep a mesh harmonic changes as its linear response does: it is driven by the loaded
transmission errors and the load shuttling of all meshes of its order together, with their phases
(:mod:`gearwhine.coupling.linear.mesh_harmonics`), which stay what they are as long as the load does. So the response at
other frequencies than that of the point has the peaks that the points pass by
(:mod:`gearwhine.coupling.sweep.missed_peaks`).

Where directions turn with carriers, each line n f_m + k f_c is one of its own, of the order that it has over the first
driver (:mod:`gearwhine.coupling.linear.carriers.carrier_sidebands`). The modes are those with the carriers frozen, and
the lines are solved about those that are near them, by harmonic balance; about others they are taken as silent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline

from gearwhine.coupling import CoupledMachine, ModesError, coupled_modes
from gearwhine.coupling.gears import GearError
from gearwhine.coupling.linear.complex_modes import CoupledModes
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel, MeshLoad, ResponseParts, causes_in_words
from gearwhine.coupling.linear.modal_superposition import superposed
from gearwhine.coupling.signals.spectrum import decibels
from gearwhine.coupling.sound.motion_lines import pulsating_efficiency
from gearwhine.numerics.arrays import ComplexArray, FloatArray

SOUND = "sound"
"""Name of the output of the sound power, beside those of the sensors."""

PLACES_ABOUT_MODE = np.concatenate([[-2.0], np.linspace(-1.0, 1.0, 21), [2.0]])
"""Places about a mode at which the lines are solved, in half-power half-widths; the first and the last are outside."""

_SOLVED_PLACES = np.array([0, 1, 6, 11, 16, 21, 22])  # places that are solved of a line with turning directions
_NEAR_MODES = 0.2  # relative distance of a mode up to which such a line is solved about it
_TURNING_LINES = 4  # highest of such lines of each output
_TWO_PI = 2.0 * np.pi
_LOWEST_HZ = 20.0
_LOWEST_DB = -1000.0  # level of silence


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
    lines : tuple of str
        Names of the mesh harmonics below the limit at this speed, with all meshes that drive each; where directions
        turn, of the highest ones and their sidebands.
    line_orders : ndarray, shape (l,)
        Frequency of each over the speed of the first driver.
    outputs : tuple of str
        Sensors, and `SOUND` where the housing radiates.
    line_levels : ndarray, shape (o, l)
        Level of each line by the linear response at this speed [dB]: of a sensor that of its rms value re 1 µm/s²; of
        the sound, up to a constant, the square of the housing's velocity times the radiation efficiency of a pulsating
        sphere.
    levels_near : ndarray, shape (o, l, m, p)
        Levels that each line would have at the frequencies of the places `PLACES_ABOUT_MODE` about each mode.
    line_rates : ndarray of complex, shape (l, n)
        Rates of the housing's coordinates in each line at this speed; n is 0 where the housing does not radiate.
    mode_rates : ndarray of complex, shape (l, m, n)
        Rates that each line would have at each mode's frequency.
    """

    frequencies: FloatArray
    half_widths: FloatArray
    names: tuple[str, ...]
    lines: tuple[str, ...]
    line_orders: FloatArray
    outputs: tuple[str, ...]
    line_levels: FloatArray
    levels_near: FloatArray
    line_rates: ComplexArray
    mode_rates: ComplexArray


def find_resonances(
    machine: CoupledMachine, limit_hz: float, *, speed_of_sound: float | None = None
) -> Resonances | None:
    """Find the resonances of a machine at steady speed up to a frequency.

    None where its speed varies or its base moves, and where it has no mesh, no output, or no proof.

    Parameters
    ----------
    machine : CoupledMachine
    limit_hz : float
        Frequency up to which the housing's modes are complete [Hz].
    speed_of_sound : float, optional
        That of the medium into which the housing radiates [m/s]; without one it does not.
    """
    steady = machine.speed_profile is None and machine.loads.base is None
    heard = speed_of_sound is not None and machine.housing is not None
    listens = machine.housing is not None and (machine.housing.sensors or heard)
    if not (steady and listens and limit_hz > _LOWEST_HZ):
        return None
    model = MeshHarmonicModel(machine)
    driven: Sequence[MeshLoad | ResponseParts]
    try:
        modes = coupled_modes(machine.system, model.contact)
        chosen = _swinging(modes, limit_hz)
        damped, widths = modes.eigenvalues.imag[chosen], -modes.eigenvalues.real[chosen]
        if machine.system.turns:
            driven = _highest(machine, model.parts(_TWO_PI * limit_hz))
            lines = [_solve_turning_line(model, line, damped, widths, speed_of_sound) for line in driven]
        else:
            driven = model.loads(_TWO_PI * limit_hz)
            lines = [_solve_line(machine, modes, line, damped, widths, speed_of_sound) for line in driven]
        if not driven:
            return None
    except (GearError, ModesError):
        return None
    return Resonances(
        frequencies=damped / _TWO_PI,
        half_widths=widths / _TWO_PI,
        # The housing stands for its own place.
        names=tuple(
            modes.kinds[number] if modes.kinds[number] == modes.where[number] else modes.labels[number]
            for number in chosen.tolist()
        ),
        lines=tuple(_name(machine, line) for line in driven),
        line_orders=np.array([line.frequency for line in driven]) / abs(machine.speeds[machine.leading_rotor]),
        outputs=(*machine.sensor_rows, *([SOUND] * heard)),
        line_levels=np.array([line.level for line in lines]).T,
        levels_near=np.moveaxis(np.array([line.levels_near for line in lines]), 0, 1),
        line_rates=np.array([line.rates for line in lines]),
        mode_rates=np.array([line.mode_rates for line in lines]),
    )


def _name(machine: CoupledMachine, line: MeshLoad | ResponseParts) -> str:
    """Name a line by the harmonics of all meshes that drive it, as the lines of a motion are named."""
    sidebands = line.sidebands if isinstance(line, ResponseParts) else ()
    return ", ".join(causes_in_words(machine, line.causes, sidebands, of_flanks=False))


class _Line(NamedTuple):
    """Response of the outputs to one line, as in `Resonances`."""

    level: FloatArray
    levels_near: FloatArray
    rates: ComplexArray
    mode_rates: ComplexArray


def _solve_line(
    machine: CoupledMachine,
    modes: CoupledModes,
    line: MeshLoad,
    damped: FloatArray,
    widths: FloatArray,
    speed_of_sound: float | None,
) -> _Line:
    """Solve a line at its own frequency and about each mode [rad/s]."""
    omega, rows = _near(line.frequency, damped, widths), _output_rows(machine, speed_of_sound)
    moved = superposed(modes.pairs, line.load[None, None], omega, rows)[:, 0]
    return _line(machine, omega, moved, len(damped), speed_of_sound)


def _solve_turning_line(
    model: MeshHarmonicModel,
    line: ResponseParts,
    damped: FloatArray,
    widths: FloatArray,
    speed_of_sound: float | None,
) -> _Line:
    """Solve a line of a machine whose directions turn, as `_solve_line` does, about modes that are near it."""
    machine = model.machine
    omega, rows = _near(line.frequency, damped, widths), _output_rows(machine, speed_of_sound)
    moved = np.zeros((len(omega), len(rows)), dtype=np.complex128)
    moved[0] = rows @ line.motion
    places = np.arange(len(damped)) * len(PLACES_ABOUT_MODE) + 1
    for first in places[np.abs(damped / line.frequency - 1.0) <= _NEAR_MODES].tolist():
        solved = omega[first + _SOLVED_PLACES]
        about = slice(first, first + len(PLACES_ABOUT_MODE))
        found = CubicSpline(PLACES_ABOUT_MODE[_SOLVED_PLACES], model.moved_to(line, solved) @ rows.T)
        moved[about] = found(PLACES_ABOUT_MODE)
    return _line(machine, omega, moved, len(damped), speed_of_sound)


def _highest(machine: CoupledMachine, lines: Sequence[ResponseParts]) -> list[ResponseParts]:
    """Return the highest lines of the sensors, and those by which the housing moves most, in their order."""
    assert machine.housing is not None
    rows = [*machine.sensor_rows.values(), *machine.rows(machine.housing.name, np.eye(machine.housing.size))]
    sizes = [line.frequency**2 * np.abs(np.array(rows) @ line.motion) for line in lines]
    sensors = len(machine.sensor_rows)
    heights = np.array([[*size[:sensors], np.linalg.norm(size[sensors:])] for size in sizes]).reshape(-1, sensors + 1)
    kept = {int(place) for column in heights.T for place in np.argsort(-column)[:_TURNING_LINES]}
    return [line for place, line in enumerate(lines) if place in kept]


def _near(frequency: float, damped: FloatArray, widths: FloatArray) -> FloatArray:
    """Return a line's own frequency, and those of the places about each mode, [rad/s]."""
    # Two half-widths below a mode that is nearly overdamped may be below zero.
    near = np.maximum(damped[:, None] + widths[:, None] * PLACES_ABOUT_MODE, _TWO_PI)
    return np.concatenate([[frequency], near.ravel()])


def _output_rows(machine: CoupledMachine, speed_of_sound: float | None) -> FloatArray:
    """Displacements of the sensors, and, where it is heard, of the housing's coordinates, shape (s + h, n)."""
    housing = machine.housing
    assert housing is not None
    sensors = np.array(list(machine.sensor_rows.values())).reshape(-1, machine.system.size)
    coordinates = sensors[:0] if speed_of_sound is None else machine.rows(housing.name, np.eye(housing.size))
    return np.concatenate([sensors, coordinates])


def _line(
    machine: CoupledMachine, omega: FloatArray, moved: ComplexArray, modes: int, speed_of_sound: float | None
) -> _Line:
    """Take the outputs of a line's displacements at its own frequency and about each mode, as of `_output_rows`."""
    sensors, shape = len(machine.sensor_rows), (modes, len(PLACES_ABOUT_MODE))
    levels = decibels(omega[:, None] ** 2 * np.abs(moved[:, :sensors]))
    rates = 1j * omega[:, None] * moved[:, sensors:]
    if speed_of_sound is not None:
        # The surface is not known here: a body of a square metre stands for it, in proportion alone.
        efficiency = pulsating_efficiency(omega / _TWO_PI, 1.0, speed_of_sound)
        with np.errstate(divide="ignore"):
            sound = 10.0 * np.log10((np.abs(rates) ** 2).sum(axis=1) * efficiency)
        levels = np.column_stack([levels, sound])
    levels = np.maximum(levels, _LOWEST_DB)
    at_modes = rates[1:].reshape(*shape, rates.shape[1])[:, len(PLACES_ABOUT_MODE) // 2]
    return _Line(levels[0], levels[1:].T.reshape(levels.shape[1], *shape), rates[0], at_modes)


def _swinging(modes: CoupledModes, limit_hz: float) -> npt.NDArray[np.intp]:
    """Return the modes that have a resonance below a frequency, in the order of their damped frequencies."""
    damped = modes.eigenvalues.imag / _TWO_PI
    proper = np.array([kind not in ("residual", "rigid") for kind in modes.kinds]) & (modes.eigenvalues.real < 0.0)
    chosen = np.flatnonzero(proper & (damped > 0.0) & (damped < limit_hz))
    return np.asarray(chosen[np.argsort(damped[chosen], kind="stable")])
