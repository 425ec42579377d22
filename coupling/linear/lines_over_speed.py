r"""Lines of sensors over speed: mesh harmonics of a machine that is linear about one operating point.

The mean load and with it stiffness, transmission error and load shuttling of the meshes stay as the speed changes; the
frequencies of the harmonics and the gyroscopic terms follow it, as do bearings with tables over speed. At the part s of
the nominal speed the motion of the harmonic of frequency s ω_n is

    (K(s) + i s ω_n C(s) - s² ω_n² I) q_n = f_n,      C(s) = C + (s - 1) G,

f_n as of :mod:`gearwhine.coupling.linear.mesh_harmonics`: one assembled machine gives all speeds. The mesh stiffness
that varies changes these lines (:mod:`gearwhine.coupling.linear.parametric_stiffness`), and between them lie those of
pitch deviations, runout and damage, :mod:`gearwhine.coupling.linear.unequal_teeth`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel, causes_in_words
from gearwhine.coupling.linear.unequal_teeth import DampedMachine, lines_of_meshes
from gearwhine.coupling.statics.mean_mesh import linear_matrices
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.progress import Progress, silent

_PLACES = 8  # of a carrier in a turn
_ONE_FREQUENCY = 1e-9
"""Relative difference of frequencies that are one."""


@dataclass(frozen=True, eq=False)
class LinesOverSpeed:
    """Mesh harmonics at the sensors over speed.

    Attributes
    ----------
    speeds : ndarray, shape (s,)
        Signed speeds of the first driver's shaft [rad/s].
    orders : ndarray, shape (l,)
        Frequency of each line over the speed.
    causes : tuple of str
        Mesh harmonics that drive each line, in words.
    sensors : tuple of str
    amplitudes : ndarray, shape (o, s, l)
        Peak amplitudes of acceleration [m/s²]; NaN above the limit.
    between : ndarray, shape (o, s)
        Root mean square of all lines between these, of what differs between teeth [m/s²].
    rates : ndarray of complex, shape (s, l, h)
        Rates of the housing's coordinates by each line; zero above the limit, and none where they are not asked for.
    rates_between : tuple of (ndarray, ndarray of complex), shapes (k,) and (k, h)
        At each speed the frequencies of the lines between these [rad/s], and the rates by them.
    """

    speeds: FloatArray
    orders: FloatArray
    causes: tuple[str, ...]
    sensors: tuple[str, ...]
    amplitudes: FloatArray
    between: FloatArray
    rates: ComplexArray
    rates_between: tuple[tuple[FloatArray, ComplexArray], ...]

    def housing_lines(self, place: int) -> tuple[FloatArray, ComplexArray]:
        """Frequencies of all lines at a speed [rad/s], (l,), and the rates of the housing's coordinates, (l, h)."""
        frequencies, rates = self.rates_between[place]
        mesh = self.orders * abs(self.speeds[place])
        return np.concatenate([mesh, frequencies]), np.concatenate([self.rates[place], rates])

    @property
    def rms(self) -> FloatArray:
        """Root mean square of all lines together at each sensor and speed [m/s²], shape (o, s)."""
        return np.asarray(np.hypot(_rms(self.amplitudes), self.between))


def _rms(amplitudes: FloatArray) -> FloatArray:
    """Root mean square of lines together, along the last axis, by their peak amplitudes."""
    return np.asarray(np.sqrt(0.5 * np.nansum(amplitudes**2, axis=-1)))


def sensor_rms(machine: CoupledMachine, limit: float) -> FloatArray:
    """Root mean square at each sensor of all lines of the teeth up to a limit [rad/s], shape (o,) [m/s²].

    Of a machine with turning carriers these are the mesh harmonics with their sidebands, and what differs between
    teeth as of `_frozen_lines`.
    """
    if not machine.system.turns:
        return np.asarray(lines_over_speed(machine, [machine.speed], limit).rms[:, 0])
    model = MeshHarmonicModel(machine)
    lines = model.responses(limit)
    moved = np.array([line.frequency**2 * line.motion for line in lines]).reshape(-1, machine.system.size)
    rows = np.array(list(machine.sensor_rows.values())).reshape(-1, machine.system.size)
    between = [one.between[:, 0] ** 2 for one in _frozen_lines(model, limit)]
    return np.asarray(np.hypot(_rms(np.abs(rows @ moved.T)), np.sqrt(np.mean(between, axis=0) if between else 0.0)))


def housing_rates(machine: CoupledMachine, limit: float) -> tuple[FloatArray, ComplexArray]:
    """Frequencies of the lines of the teeth up to a limit [rad/s], and the rates of the housing's coordinates by each.

    Of a machine with turning carriers these are the mesh harmonics with their sidebands, and what differs between teeth
    as of `_frozen_lines`, a line for each place of the carriers. The arrays have the shapes (l,) and (l, h).
    """
    if not machine.system.turns:
        return lines_over_speed(machine, [machine.speed], limit, of_housing=True).housing_lines(0)
    model = MeshHarmonicModel(machine)
    lines = model.responses(limit)
    rows = _housing_rows(machine)
    rates = [1j * line.frequency * (rows @ line.motion) for line in lines]
    still = [one.rates_between[0] for one in _frozen_lines(model, limit, of_housing=True)]
    frequencies = [np.array([line.frequency for line in lines]), *(frequency for frequency, _ in still)]
    every = [np.array(rates).reshape(-1, len(rows)), *(part / np.sqrt(len(still)) for _, part in still)]
    return np.concatenate(frequencies), np.concatenate(every)


def _frozen_lines(model: MeshHarmonicModel, limit: float, *, of_housing: bool = False) -> list["LinesOverSpeed"]:
    """Lines of a machine with turning carriers frozen at places all round; none where no teeth differ.

    Carriers turn slowly beside the lines, which are hundreds for each mesh: the power of a line and its sidebands
    together is the mean over the places, by Parseval's equation, but for what a resonance rises within m f.
    """
    machine = model.machine
    contacts = machine.system.contacts
    differing = [n for n in model.loaded if contacts[n].contact.hunting_period > 1 or np.any(contacts[n].errors[:, :2])]
    if not differing:
        return []
    period = 2.0 * np.pi / min(map(abs, machine.system.turning_rates))
    places = np.arange(_PLACES) * period / _PLACES
    return [_solved_lines(model.frozen(float(time)), [machine.speed], limit, of_housing) for time in places]


def _housing_rows(machine: CoupledMachine) -> FloatArray:
    """Motions of the housing's coordinates by those of the system, shape (h, n)."""
    housing = machine.housing
    if housing is None:
        return np.zeros((0, machine.system.size))
    return machine.rows(housing.name, np.eye(housing.size))


def lines_over_speed(
    machine: CoupledMachine,
    speeds: Sequence[float],
    limit: float,
    *,
    of_housing: bool = False,
    progress: Progress = silent,
) -> LinesOverSpeed:
    """Solve the mesh harmonics at the sensors of a machine at some speeds.

    Parameters
    ----------
    machine : CoupledMachine
        Assembled about its operating point.
    speeds : sequence of float
        Signed speeds of the first driver's shaft, in the sense of the machine's [rad/s].
    limit : float
        Highest frequency [rad/s].
    of_housing : bool
        Whether the rates of the housing's coordinates are wanted, too, which its sound needs.
    progress : callable

    Raises
    ------
    CouplingError
        Where the machine stands still, a speed is 0 or of the other sense, or directions turn with a carrier: their
        sidebands are not these lines.
    """
    if machine.system.turns:
        raise CouplingError("lines over speed: directions turn with a carrier; expected a machine without such")
    return _solved_lines(MeshHarmonicModel(machine), speeds, limit, of_housing, progress)


def _solved_lines(
    model: MeshHarmonicModel, speeds: Sequence[float], limit: float, of_housing: bool, progress: Progress = silent
) -> LinesOverSpeed:
    """Solve as `lines_over_speed` does, the machine of a model whose directions stand."""
    machine = model.machine
    system, nominal = machine.system, machine.speed
    ratios = [speed / nominal for speed in speeds] if nominal != 0.0 else []
    if not ratios or min(ratios) <= 0.0:
        raise CouplingError(f"lines over speed: speeds of {list(speeds)} rad/s beside {nominal:g}; expected one sense")
    highest = limit / min(ratios)
    meshes = model.varying_meshes(highest)
    further = model.loads(highest + max((mesh.rate * mesh.reach for mesh in meshes), default=0.0))
    loads = [load for load in further if load.frequency <= highest * (1.0 + 1e-9)]
    stiffness, damping = linear_matrices(system, model.contact)
    here = system.connector_matrices()
    rows = np.array(list(machine.sensor_rows.values())).reshape(-1, system.size)
    amplitudes = np.full((len(rows), len(ratios), len(loads)), np.nan)
    between = np.zeros(amplitudes.shape[:2])
    moves = _housing_rows(machine) if of_housing else np.zeros((0, system.size))
    rates, outputs = np.zeros((len(ratios), len(loads), len(moves)), dtype=np.complex128), np.vstack([rows, moves])
    rates_between = []
    for place, ratio in enumerate(ratios):
        progress("lines of the sensors over speed", place / len(ratios))
        there = system.connector_matrices(ratio)
        held = stiffness + (there[0] - here[0])
        resisted = damping + (ratio - 1.0) * system.gyroscopic + (there[1] - here[1])
        linear = DampedMachine(held, resisted)
        motions = [linear.motion(ratio * load.frequency, load.load) for load in further]
        harmonics = {cause: motion for load, motion in zip(further, motions, strict=True) for cause in load.causes}
        lines = lines_of_meshes(
            [mesh.up_to(limit, ratio) for mesh in meshes],
            model.contact,
            system.contact_directions,
            outputs,
            linear,
            harmonics,
            ratio=ratio,
            limit=limit,
        )
        apart = np.ones(lines.frequency.size, dtype=bool)
        for number, (load, motion) in enumerate(zip(loads, motions, strict=False)):
            w = ratio * load.frequency
            if w <= limit * (1.0 + 1e-9):
                moved = sum((lines.by_stiffness[cause] for cause in load.causes), -(w**2) * (outputs @ motion))
                # Teeth of another mesh that differ have a line here where an order of their shaft meets the harmonic.
                met = np.abs(lines.frequency - w) <= _ONE_FREQUENCY * w
                moved = moved + lines.between[:, met].sum(axis=1)
                apart &= ~met
                amplitudes[:, place, number] = np.abs(moved[: len(rows)])
                rates[place, number] = moved[len(rows) :] / (1j * w)
        frequency, accelerations = lines.frequency[apart], lines.between[:, apart]
        between[:, place] = np.sqrt(0.5 * np.sum(np.abs(accelerations[: len(rows)]) ** 2, axis=1))
        rates_between.append((frequency, (accelerations[len(rows) :] / (1j * frequency)).T))
    orders = np.array([load.frequency for load in loads]) / abs(nominal)
    causes = tuple(" and ".join(causes_in_words(machine, load.causes)) for load in loads)
    given = np.array(speeds, dtype=np.float64)
    names = tuple(machine.sensor_rows)
    return LinesOverSpeed(given, orders, causes, names, amplitudes, between, rates, tuple(rates_between))
