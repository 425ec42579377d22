"""Recorded transient of a machine: time integration in blocks; histories of sensors, gears and bearings, spectra."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.analyses.recording import (
    RECORD_BYTES,
    Arrays,
    Blocks,
    Sampling,
    Signals,
    TransientPlan,
    TransientRecord,
    block_arrays,
    record_spectra,
    sampling,
)
from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.speed_profile import FreeRun, SpeedProfile
from gearwhine.coupling.signals.peaks import SpectralPeaks, spectral_peaks
from gearwhine.coupling.signals.spectrum import SignalParts, Spectrum, amplitude_spectrum, signal_parts
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
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.source_digest import installed, source_digest

_TWO_PI = 2.0 * np.pi
_HARMONICS = 4.0  # mesh harmonics that count where no housing limits the model
_LIBRARIES = ("gearwhine", "numpy", "scipy", "numba", "llvmlite")


@dataclass(frozen=True)
class SolvedTransient:
    """The machine in motion.

    Attributes
    ----------
    machine : gearwhine.coupling.CoupledMachine
    method : str
        The method of time integration, "newmark" or "exact".
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
    plan : TransientPlan
        What was integrated and recorded.
    """

    machine: CoupledMachine
    method: str
    result: TransientFigures
    record: TransientRecord
    signals: Signals
    sensor_spectra: dict[str, Spectrum]
    force_spectra: dict[str, Spectrum]
    trusted_limit: float
    plan: TransientPlan

    @property
    def free_run(self) -> bool:
        """Whether the speed follows from the motor and the load."""
        return isinstance(self.plan.run, FreeRun)

    @property
    def speed(self) -> float:
        """Nominal speed of the first driver's shaft [rad/s]."""
        return self.machine.speed

    @property
    def speed_profile(self) -> SpeedProfile | None:
        """Speed over time; None where it is the nominal one all along."""
        return self.machine.speed_profile

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
        if self.speed_profile is None:
            return 0.0
        return float(self.speed_profile.at(self.speed_profile.times[-1])[0][0]) * abs(self.speed) / _TWO_PI

    @property
    def accelerating_torque(self) -> tuple[float, float]:
        """Least and largest torque that accelerates the train over a run, at the first driver's rotor [N m].

        It comes on top of the torque that the load takes, and is below zero where the train slows down.
        """
        if self.speed_profile is None:
            return 0.0, 0.0
        times = self.speed_profile.times
        gains = self.speed_profile.at(times[:-1] if times.size > 1 else times)[2] * abs(self.speed)
        return self.machine.train_inertia * float(gains.min()), self.machine.train_inertia * float(gains.max())

    @property
    def averages(self) -> int:
        """Number of stretches over which the spectra were averaged."""
        return next(
            (spectrum.averages for spectrum in [*self.sensor_spectra.values(), *self.force_spectra.values()]), 1
        )

    def sensor_rms(self, sensor: str) -> float:
        """RMS acceleration of a sensor up to where the housing's modes are complete: beyond, none is its own [m/s²].

        Of a record in memory it is that of all its samples, which no window weighs.
        """
        if self.record.sampling.is_long:
            return float(self.sensor_spectra[sensor].rms(self.trusted_limit))
        whole = amplitude_spectrum(self.histories.sensor_acceleration[sensor], self.record.sampling.interval)
        return float(whole.rms(self.trusted_limit))

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


def has_traced_lines(machine: CoupledMachine) -> bool:
    """Whether lines of the sensors are traced to their origin.

    Lines have names, and parts that add up, where speeds are steady and the ground is at rest.
    """
    return machine.speed_profile is None and machine.loads.base is None


def solve_transient(
    machine: CoupledMachine,
    plan: TransientPlan,
    progress: Progress = silent,
    *,
    keep: Callable[[str], Blocks] | None = None,
    record_bytes: int = RECORD_BYTES,
    samples_per_block: int | None = None,
) -> SolvedTransient:
    """Integrate the machine's motion through the revolutions or the run of a plan, and take the spectra of its record.

    Where the record holds whole turns of every shaft and whole periods of every excitation, the spectra are taken as
    they are, each line exact; otherwise, and over a run, under Hann's window. A run is sampled for its highest speed,
    and ``discard`` counts revolutions as they are turned. A record that is too long for memory is filtered and stored
    at fewer samples, see :mod:`gearwhine.coupling.analyses.recording`.

    Parameters
    ----------
    machine : CoupledMachine
        Assembled for the run of the plan.
    plan : TransientPlan
    progress : callable
    keep : callable, optional
        Returns the blocks stored under a key of the integration's inputs; the integration continues after them. By
        default all blocks are held in memory.
    record_bytes, samples_per_block : int
        Size of the longest record stored as sampled, and approximate number of samples between checkpoints.

    Raises
    ------
    gearwhine.coupling.CouplingError
        Where the machine stands still, is assembled for no such run, or is discarded over more than it turns.
    gearwhine.coupling.TransientError
        Where the motion cannot be followed or its energies do not balance.
    """
    if machine.speed == 0.0:
        raise CouplingError("a machine that stands still has no revolutions; expected a speed")
    if (machine.speed_profile is None) != (plan.run is None):
        raise CouplingError("a machine assembled at another speed over time than that of its transient's plan")
    profile = machine.speed_profile
    fastest = 1.0 if profile is None else max(1.0, float(profile.speed_ratios.max()))
    limit = _trusted_limit(machine, fastest)
    modal, traced = plan.modal_coordinates, has_traced_lines(machine)
    outputs = with_modal_rows(machine, transient_outputs(machine), modal, housing=traced)

    def named(result: MotionRecord) -> Signals:
        return Signals(coupled_histories(machine, result), modal_record(machine, result, modal, housing=traced))

    nothing = named(empty_record(machine, outputs))
    rows = sum(map(len, (outputs.displacement, outputs.velocity, outputs.acceleration)))
    rows += 2 * len(machine.system.contacts)
    signals = nothing.columns.shape[1]
    chosen = sampling(machine, plan, limit, signals, rows, largest=record_bytes, block=samples_per_block)
    progress("preparing the time stepper")
    integration = (machine.system, chosen.settings, outputs)
    start = starting_state(machine, plan)
    key = integration_key(
        *integration, speed_profile=profile, initial=start, samples_per_block=chosen.samples_per_block
    )
    blocks: Blocks = _InMemory()
    if keep is not None:
        blocks = keep(_with_code(fingerprint(key, machine.loads.base), chosen))
    last = blocks[len(blocks) - 1] if len(blocks) else None
    filter_state = nothing.columns if last is None else last["held"]
    integrated = integrate_blocks(
        *integration,
        speed_profile=profile,
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
    method = integration_method(machine.system, chosen.settings, profile or SpeedProfile.steady())
    return SolvedTransient(machine, method, figures, record, stretch, of_sensors, of_meshes, limit, plan)


def _with_code(key: str, chosen: Sampling) -> str:
    """Return the key of a time integration and its stored data, for this code and processor: no other rounds alike."""
    from llvmlite import binding

    return content_key(
        {
            "integration": key,
            "stored": [chosen.decimation.factor, len(chosen.decimation.taps)],
            "versions": {name: installed(name) for name in _LIBRARIES},
            "source": source_digest("gearwhine.numerics", "gearwhine.rotors", "gearwhine.coupling"),
            "processor": [binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten()],
        }
    )


class _InMemory(list[Arrays]):
    """Record in memory, without files to resume from."""


def starting_state(machine: CoupledMachine, plan: TransientPlan) -> tuple[FloatArray, FloatArray] | None:
    """Coordinates and rates that a plan starts from; None: static equilibrium under the load.

    A train that turns unloaded has straight, untwisted shafts and teeth that just touch: all coordinates are zero.
    """
    if plan.start == "equilibrium":
        return None
    return np.zeros(machine.system.size), np.zeros(machine.system.size)


def mean_bearing_forces(solved: SolvedTransient) -> dict[str, FloatArray]:
    """Mean force of the shaft on each bearing over the last stretch of the record: x, y, z [N], shape (3,)."""
    return {name: load[:, :3].mean(axis=0) for name, load in solved.histories.bearing_load.items()}


def _trusted_limit(machine: CoupledMachine, fastest: float) -> float:
    """Return the limit up to which the housing's modes are complete [Hz]; without a housing, that of the gears.

    Only the first is one of trust: the second is how far a record and its pictures go.
    """
    if machine.complete_below_hz is not None:
        return machine.complete_below_hz
    meshes = [fastest * abs(contact.mesh_frequency) for contact in machine.system.contacts]
    return _HARMONICS * max(meshes, default=1000.0)
