"""Transient of a case: time integration of the loaded machine; histories of sensors, gears and bearings."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import gearwhine
from gearwhine.case import Case, require
from gearwhine.coupling import CoupledMachine, SpeedProfile
from gearwhine.coupling.signals.peaks import SpectralPeaks, spectral_peaks
from gearwhine.coupling.signals.spectrum import SignalParts, Spectrum, signal_parts
from gearwhine.coupling.time.exponential_collocation import integration_method
from gearwhine.coupling.time.histories import (
    Histories,
    ModalRecord,
    empty_record,
    modal_record,
    transient_outputs,
    with_modal_rows,
)
from gearwhine.coupling.time.histories import histories as coupled_histories
from gearwhine.coupling.time.integration import Checkpoint
from gearwhine.coupling.time.settings import MotionRecord
from gearwhine.coupling.time.transient import (
    TransientFigures,
    fingerprint,
    integrate_blocks,
    integration_key,
    transient_figures,
)
from gearwhine.from_case.driving import driving
from gearwhine.from_case.machine import base_motion
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.output.files import PRESENTATION, installed, source_digest
from gearwhine.progress import Progress, silent
from gearwhine.solve.housing_modes import SolvedHousing
from gearwhine.solve.machine import ReducedHousing, in_space
from gearwhine.solve.transient_record import (
    RECORD_BYTES,
    Arrays,
    Blocks,
    Sampling,
    Signals,
    TransientRecord,
    block_arrays,
    record_spectra,
    sampling,
)

FloatArray = npt.NDArray[np.float64]

_TWO_PI = 2.0 * np.pi
_LIBRARIES = ("numpy", "scipy", "numba", "llvmlite")


@dataclass(frozen=True)
class SolvedTransient:
    """The machine in motion.

    Attributes
    ----------
    machine : gearwhine.coupling.CoupledMachine
    speed : float
        Speed of the first driver's rotor at operation [rad/s].
    method : str
        The method of time integration, "newmark" or "exact".
    turning : SpeedProfile or None
        Speed over time; None where it is the nominal one all along.
    result : TransientFigures
    record : TransientRecord
        Everything recorded, piece by piece.
    signals : Signals
        Recorded signals in memory; of a long record its last stretch.
    sensor_spectra : dict of str to Spectrum
        Acceleration [m/s²]; of a long record averaged over stretches, up to the trusted limit.
    force_spectra : dict of str to Spectrum
        Gear-mesh force [N]; likewise.
    trusted_limit : float
        Highest frequency that the housing's modes carry [Hz].
    """

    machine: CoupledMachine
    speed: float
    method: str
    turning: SpeedProfile | None
    result: TransientFigures
    record: TransientRecord
    signals: Signals
    sensor_spectra: dict[str, Spectrum]
    force_spectra: dict[str, Spectrum]
    trusted_limit: float

    @property
    def record_start(self) -> float:
        """Time of the first sample of the signals in memory [s], from which phases of their spectra count."""
        return float(self.histories.times[0])

    @property
    def histories(self) -> Histories:
        """Histories of the recorded signals."""
        return self.signals.histories

    @property
    def modal(self) -> ModalRecord:
        """Modal coordinates of the recorded signals."""
        return self.signals.modal

    @property
    def steps_per_second(self) -> float | None:
        """Speed of the integration; None where it took no time that a clock shows."""
        return self.result.steps / self.result.seconds if self.result.seconds > 0.0 else None

    @property
    def revolutions(self) -> float:
        """Turns of the first driver's rotor over a run; zero at steady speed."""
        if self.turning is None:
            return 0.0
        return float(self.turning.at(self.turning.times[-1])[0][0]) * abs(self.speed) / _TWO_PI

    @property
    def accelerating_torque(self) -> tuple[float, float]:
        """Least and largest torque that accelerates the train over a run, at the first driver's rotor [N m].

        It comes on top of the torque that the load takes, and is below zero where the train slows down.
        """
        if self.turning is None:
            return 0.0, 0.0
        times = self.turning.times
        gains = self.turning.at(times[:-1] if times.size > 1 else times)[2] * abs(self.speed)
        return self.machine.train_inertia * float(gains.min()), self.machine.train_inertia * float(gains.max())

    @property
    def averages(self) -> int:
        """Number of stretches over which the spectra were averaged."""
        return next(
            (spectrum.averages for spectrum in [*self.sensor_spectra.values(), *self.force_spectra.values()]), 1
        )

    def sensor_rms(self, sensor: str) -> float:
        """RMS acceleration of a sensor up to where the housing's modes are complete: beyond, none is its own [m/s²]."""
        return float(self.sensor_spectra[sensor].rms(self.trusted_limit))

    def sensor_peaks(self, sensor: str) -> SpectralPeaks:
        """Return the reported spectral peaks of a sensor, highest first."""
        return spectral_peaks(self.sensor_spectra[sensor], count=20, limit=self.trusted_limit, floor=1e-5)

    @property
    def line_tolerance_hz(self) -> float:
        """Distance within which the frequencies of the sensors' lines are known [Hz]."""
        peaks = [self.sensor_peaks(name).resolution for name in self.sensor_spectra]
        return max((float(resolution.max()) for resolution in peaks if resolution.size), default=0.0)

    def force_peaks(self, contact: str) -> SpectralPeaks:
        """Return the reported spectral peaks of a gear-mesh force, highest first."""
        return spectral_peaks(self.force_spectra[contact], count=8)

    def back_flanks(self, pair: int) -> int | None:
        """Return the number of the contact of a gear pair's back flanks; None where they cannot meet."""
        meshes = self.machine.meshes
        if meshes[pair].backlash is None:
            return None
        return len(meshes) + sum(mesh.backlash is not None for mesh in meshes[:pair])

    def back_flank_peak(self, pair: int) -> float | None:
        """Return the largest force on the back flanks of a gear pair [N]; None where they cannot meet."""
        contact = self.back_flanks(pair)
        return None if contact is None else float(self.result.peak_force[contact])

    def bearing_parts(self) -> list[tuple[str, SignalParts]]:
        """Mean and alternating part of each bearing's load: forces along x, y, z [N], moments about x, y [N m]."""
        return [(name, signal_parts(load.T)) for name, load in self.histories.bearing_load.items()]

    def gear_parts(self) -> list[tuple[str, SignalParts]]:
        """Mean and alternating part of the displacement of each gear's centre along x and y [m]."""
        return [(name, signal_parts(motion[:, :2].T)) for name, motion in self.histories.gear_motion.items()]

    def modal_spectrum(self) -> tuple[list[str], Spectrum] | None:
        """Names and spectra of the modal coordinates; None where none is recorded."""
        named = self.modal.coordinates
        if not named:
            return None
        return list(named), self.record.spectrum(np.array(list(named.values())), self.trusted_limit)


def has_traced_lines(case: Case) -> bool:
    """Whether lines of the sensors are traced to their origin.

    Lines have names, and parts that add up, where speeds are steady and the ground is at rest.
    """
    assert case.operation is not None
    assert case.transient is not None
    return case.transient.run is None and case.operation.base is None


def solve_transient(
    case: Case,
    machine: CoupledMachine,
    mesh_frequencies: tuple[float, ...],
    progress: Progress = silent,
    *,
    housing: SolvedHousing | ReducedHousing | None = None,
    keep: Callable[[str], Blocks] | None = None,
    record_bytes: int = RECORD_BYTES,
    samples_per_block: int | None = None,
) -> SolvedTransient:
    """Integrate the machine's motion through the case's revolutions or run, and take the spectra of its record.

    Where the record holds whole turns of every shaft and whole periods of every excitation, the spectra are taken as
    they are, each line exact; otherwise, and over a run, under Hann's window. A run is sampled for its highest speed,
    and ``discard`` counts revolutions as they are turned. A record that is too long for memory
    is filtered and stored at fewer samples, see :mod:`gearwhine.solve.transient_record`.

    Parameters
    ----------
    keep : callable, optional
        Returns the blocks stored under a key of the integration's inputs; the integration continues after them. By
        default all blocks are held in memory.
    record_bytes, samples_per_block : int
        Size of the longest record stored as sampled, and approximate number of samples between checkpoints.

    Raises
    ------
    gearwhine.coupling.TransientError
        Where the motion cannot be followed or its energies do not balance.
    """
    require(case, "operation", "transient", command="run")
    assert case.transient is not None
    assert case.operation is not None
    turning = driving(case, machine.rotors).turning
    fastest = 1.0 if turning is None else max(1.0, float(turning.speed_ratios.max()))
    limit = _trusted_limit(housing, tuple(fastest * frequency for frequency in mesh_frequencies))
    modal, traced = case.transient.modal_coordinates, has_traced_lines(case)
    outputs = with_modal_rows(machine, transient_outputs(machine), modal, housing=traced)

    base = base_motion(case)

    def named(result: MotionRecord) -> Signals:
        relative = coupled_histories(machine, result, turning)
        return Signals(in_space(relative, housing, base), modal_record(machine, result, modal, housing=traced))

    nothing = named(empty_record(machine, outputs))
    rows = sum(map(len, (outputs.displacement, outputs.velocity, outputs.acceleration)))
    rows += 2 * len(machine.system.contacts)
    signals = nothing.columns.shape[1]
    chosen = sampling(
        case, machine.system, turning, limit, signals, rows, largest=record_bytes, block=samples_per_block
    )
    progress("preparing the time stepper")
    integration = (machine.system, chosen.settings, outputs)
    start = starting_state(case, machine)
    key = integration_key(*integration, turning=turning, initial=start, samples_per_block=chosen.samples_per_block)
    blocks: Blocks = _InMemory()
    if keep is not None:
        blocks = keep(_with_code(fingerprint(key, base), chosen))
    last = blocks[len(blocks) - 1] if len(blocks) else None
    filter_state = nothing.columns if last is None else last["held"]
    integrated = integrate_blocks(
        *integration,
        turning=turning,
        initial=start,
        after=None if last is None else Checkpoint.from_arrays(last),
        samples_per_block=chosen.samples_per_block,
        progress=lambda fraction: progress("marching through the transient", fraction),
    )
    for block in integrated:
        columns, filter_state = chosen.decimation.through(filter_state, named(block).columns)
        blocks.append(block_arrays(columns, filter_state, block.after))
    record = TransientRecord(chosen, blocks, nothing)
    figures = transient_figures(chosen.settings, record.end)
    stretch = record.last_stretch()
    of_sensors, of_meshes = record_spectra(record, stretch.histories, limit)
    method = integration_method(machine.system, chosen.settings, turning or SpeedProfile.steady())
    return SolvedTransient(
        machine, case.operation.speed, method, turning, figures, record, stretch, of_sensors, of_meshes, limit
    )


def _with_code(key: str, chosen: Sampling) -> str:
    """Return the key of a time integration and its stored data, for this code and processor: no other rounds alike."""
    from llvmlite import binding

    return content_key(
        {
            "integration": key,
            "stored": [chosen.decimation.factor, len(chosen.decimation.taps)],
            "versions": {"gearwhine": gearwhine.__version__} | {name: installed(name) for name in _LIBRARIES},
            "source": source_digest("gearwhine.coupling", "gearwhine", without=PRESENTATION),
            "processor": [binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten()],
        }
    )


class _InMemory(list[Arrays]):
    """Record in memory, without files to resume from."""


def starting_state(case: Case, machine: CoupledMachine) -> tuple[FloatArray, FloatArray] | None:
    """Coordinates and rates that the case starts from; None: static equilibrium under its load.

    A train that turns unloaded has straight, untwisted shafts and teeth that just touch: all coordinates are zero.
    """
    assert case.transient is not None
    if case.transient.start == "equilibrium":
        return None
    return np.zeros(machine.system.size), np.zeros(machine.system.size)


def mean_bearing_forces(solved: SolvedTransient) -> dict[str, FloatArray]:
    """Mean force of the shaft on each bearing over the last stretch of the record: x, y, z [N], shape (3,)."""
    return {name: load[:, :3].mean(axis=0) for name, load in solved.histories.bearing_load.items()}


def _trusted_limit(housing: SolvedHousing | ReducedHousing | None, mesh_frequencies: tuple[float, ...]) -> float:
    """Return the limit up to which the housing's modes are complete [Hz]; without a housing, that of the gears."""
    if housing is not None:
        return housing.trusted_limit_hz
    return 4.0 * max(mesh_frequencies, default=1000.0)
