"""The transient of a case: the machine turning under load, and what its sensors, gears and bearings show."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

import coupling as room
import gearwhine
from coupling.fingerprint import fingerprint
from gearwhine.case import Case, require
from gearwhine.march_files import Arrays, Blocks
from gearwhine.progress import Progress, silent
from gearwhine.stages.contents import installed, source_digest
from gearwhine.stages.driving import driving
from gearwhine.stages.housing import SolvedHousing
from gearwhine.stages.machine import HousingInMachine, base_motion
from gearwhine.stages.march_record import MarchRecord, Signals, block_arrays, record_spectra
from gearwhine.stages.sampling import RECORD_BYTES, Sampling, sampling
from housing.labelled import content_key

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi
_LIBRARIES = ("numpy", "scipy", "numba", "llvmlite")


@dataclass(frozen=True)
class SolvedTransient:
    """The machine in motion.

    Attributes
    ----------
    machine : coupling.CoupledMachine
    method : str
        By which it was marched, "newmark" or "exact".
    turning : coupling.Turning or None
        Speed over time; None where it is the nominal one all along.
    result : coupling.TransientFigures
    record : MarchRecord
        Everything recorded, piece by piece.
    signals : Signals
        The same at once; of a long record its last stretch.
    sensor_spectra : dict of str to coupling.Spectrum
        Acceleration [m/s²]; of a long record averaged over stretches, up to the trusted limit.
    force_spectra : dict of str to coupling.Spectrum
        Gear-mesh force [N]; likewise.
    trusted_limit : float
        Highest frequency that the housing's modes carry [Hz].
    """

    machine: room.CoupledMachine
    method: str
    turning: room.Turning | None
    result: room.TransientFigures
    record: MarchRecord
    signals: Signals
    sensor_spectra: dict[str, room.Spectrum]
    force_spectra: dict[str, room.Spectrum]
    trusted_limit: float

    @property
    def histories(self) -> room.Histories:
        """Of the signals."""
        return self.signals.histories

    @property
    def modal(self) -> room.ModalRecord:
        """Of the signals."""
        return self.signals.modal


def is_traced(case: Case) -> bool:
    """Whether lines of the sensors are traced to their origin.

    Lines have names, and parts that add up, where speeds are steady and the ground is at rest.
    """
    assert case.operation is not None
    assert case.transient is not None
    return case.transient.run is None and case.operation.base is None


def solve_transient(
    case: Case,
    machine: room.CoupledMachine,
    mesh_frequencies: tuple[float, ...],
    progress: Progress = silent,
    *,
    housing: SolvedHousing | HousingInMachine | None = None,
    keep: Callable[[str], Blocks] | None = None,
    record_bytes: int = RECORD_BYTES,
    samples_per_block: int | None = None,
) -> SolvedTransient:
    """March the machine through the case's revolutions, or its run, and take the spectra of what is not discarded.

    The record holds whole revolutions of the first driver. Where every shaft then turns a whole number of times
    the spectra are taken as they are, each line exact; otherwise, and over a run, under Hann's window. A run is sampled
    for its highest speed, and ``discard`` counts revolutions as they are turned. A record that is too long for memory
    is filtered and kept at fewer samples, see :mod:`gearwhine.stages.sampling`.

    Parameters
    ----------
    keep : callable, optional
        Gives the blocks kept under a key of all that the march depends on; the march goes on behind them. By default
        none are kept, and all are held in memory.
    record_bytes, samples_per_block : int
        The longest record kept as sampled, and about how many samples are marched from checkpoint to checkpoint.

    Raises
    ------
    coupling.TransientError
        Where the motion cannot be followed or its energies do not balance.
    """
    require(case, "operation", "transient", command="run")
    assert case.transient is not None
    turning = driving(case, machine.rotors).turning
    fastest = 1.0 if turning is None else max(1.0, float(turning.rates.max()))
    limit = _trusted_limit(housing, tuple(fastest * frequency for frequency in mesh_frequencies))
    modal, traced = case.transient.modal_coordinates, is_traced(case)
    outputs = room.with_modal_rows(machine, room.transient_outputs(machine), modal, housing=traced)

    def named(result: room.Recorded) -> Signals:
        histories = _in_space(case, housing, room.histories(machine, result, turning))
        return Signals(histories, room.modal_record(machine, result, modal, housing=traced))

    nothing = named(room.nothing_recorded(machine, outputs))
    rows = sum(map(len, (outputs.displacement, outputs.velocity, outputs.acceleration)))
    rows += 2 * len(machine.system.contacts)
    signals = nothing.columns.shape[1]
    chosen = sampling(case, turning, limit, signals, rows, largest=record_bytes, block=samples_per_block)
    progress("compiling the time stepper (the first time takes longer)")
    march = (machine.system, chosen.settings, outputs)
    start = starting_state(case, machine)
    key = room.march_key(*march, turning=turning, initial=start, samples_per_block=chosen.samples_per_block)
    blocks: Blocks = _InMemory()
    if keep is not None:
        blocks = keep(_with_code(fingerprint(key, base_motion(case)), chosen))
    last = blocks[len(blocks) - 1] if len(blocks) else None
    held = nothing.columns if last is None else last["held"]
    marched = room.march_blocks(
        *march,
        turning=turning,
        initial=start,
        after=None if last is None else room.Checkpoint.from_arrays(last),
        samples_per_block=chosen.samples_per_block,
        progress=lambda fraction: progress("marching through the transient", fraction),
    )
    for block in marched:
        columns, held = chosen.decimation.through(held, named(block).columns)
        blocks.append(block_arrays(columns, held, block.after))
    record = MarchRecord(chosen, blocks, nothing)
    figures = room.transient_figures(chosen.settings, record.end)
    stretch = record.last_stretch()
    of_sensors, of_meshes = record_spectra(record, stretch.histories, limit)
    method = room.march_method(machine.system, chosen.settings, turning or room.Turning.steady())
    return SolvedTransient(machine, method, turning, figures, record, stretch, of_sensors, of_meshes, limit)


def _in_space(case: Case, housing: SolvedHousing | HousingInMachine | None, named: room.Histories) -> room.Histories:
    """Histories as accelerometers show them: their motion in space, not beside a base that moves."""
    base = base_motion(case)
    if base is None or housing is None:
        return named
    absolute = {
        name: named.sensor_acceleration[name] + base.acceleration_at(port.position, port.direction, named.times)
        for name, port in housing.sensors.items()
    }
    return replace(named, sensor_acceleration=absolute)


def _with_code(key: str, chosen: Sampling) -> str:
    """The key of a march with what is kept of it, by which code, and on which processor: no other rounds alike."""
    from llvmlite import binding

    return content_key(
        {
            "march": key,
            "kept": [chosen.decimation.factor, len(chosen.decimation.taps)],
            "versions": {"gearwhine": gearwhine.__version__} | {name: installed(name) for name in _LIBRARIES},
            "source": source_digest(room, gearwhine),
            "processor": [binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten()],
        }
    )


class _InMemory(list[Arrays]):
    """Blocks that nobody keeps."""


def starting_state(case: Case, machine: room.CoupledMachine) -> tuple[FloatArray, FloatArray] | None:
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


def transient_document(case: Case, solved: SolvedTransient) -> dict[str, Any]:
    """The transient as the command's JSON."""
    assert case.operation is not None
    result = solved.result
    drives = len(solved.machine.meshes)
    pairs = []
    for number, (mesh, pressed) in enumerate(zip(solved.machine.meshes, solved.machine.pressed_contacts, strict=True)):
        spectrum = solved.force_spectra[solved.machine.system.contacts[pressed].name]
        pairs.append(
            {
                "driver": mesh.driver.name,
                "driven": mesh.driven.name,
                "flanks": "drive" if pressed == number else "back",
                "mean_force_n": float(result.mean_force[pressed]),
                "peak_force_n": float(result.peak_force[pressed]),
                "contact_loss_fraction": float(result.contact_loss[pressed]),
                "friction": _friction_document(solved, pressed),
                "back_flank_peak_force_n": _back_flank_peak(solved, number, drives),
                "force_peaks": [
                    {"frequency_hz": peak.frequency, "amplitude_n": peak.amplitude} for peak in force_peaks(spectrum)
                ],
            }
        )
    return {
        "speed_rpm": case.operation.speed * 60.0 / _HERTZ,
        "run": _run_document(case, solved.turning),
        "method": solved.method,
        "steps": result.steps,
        "rejected_steps": result.rejected,
        "smallest_step_s": result.smallest_step,
        "steps_per_second": result.steps / result.seconds if result.seconds > 0.0 else None,
        "energy_error": result.energy.error,
        "energy_j": {
            "change": result.energy.change,
            "loads": result.energy.loads,
            "lost": result.energy.lost,
            "teeth": result.energy.teeth,
            "friction": result.energy.friction,
        },
        "coordinates": solved.machine.system.size,
        "trusted_below_hz": solved.trusted_limit,
        "record": record_document(solved),
        "sensors": [
            {
                "name": name,
                # Up to where the housing's modes are complete: what lies above is not the housing's.
                "rms_m_per_s2": float(spectrum.rms(solved.trusted_limit)),
                "peaks": [
                    {"frequency_hz": peak.frequency, "amplitude_m_per_s2": peak.amplitude}
                    for peak in sensor_peaks(solved, name)
                ],
            }
            for name, spectrum in solved.sensor_spectra.items()
        ],
        "gear_pairs": pairs,
    }


def _run_document(case: Case, turning: room.Turning | None) -> dict[str, Any] | None:
    """Speeds of the first driver's rotor over a run; None at steady speed."""
    if turning is None:
        return None
    assert case.operation is not None
    speeds = case.operation.speed * turning.rates * 60.0 / _HERTZ
    return {
        "from_rpm": float(speeds[0]),
        "to_rpm": float(speeds[-1]),
        "seconds": float(turning.times[-1]),
        "revolutions": float(turning.at(turning.times[-1])[0][0]) * abs(case.operation.speed) / _HERTZ,
    }


def record_document(solved: SolvedTransient) -> dict[str, Any]:
    """How much was recorded, how finely, and what the spectra were taken over."""
    record, spectra = solved.record, [*solved.sensor_spectra.values(), *solved.force_spectra.values()]
    return {
        "samples": record.samples,
        "interval_s": record.sampling.interval,
        "decimation": record.sampling.decimation.factor,
        "spectra": {
            "window": record.sampling.window,
            "samples": min(record.sampling.stretch, record.samples),
            "averages": next((one.averages for one in spectra), 1),
        },
    }


def sensor_peaks(solved: SolvedTransient, sensor: str) -> list[room.Peak]:
    """The lines of a sensor that are told of, highest first."""
    return room.spectrum_peaks(solved.sensor_spectra[sensor], count=20, limit=solved.trusted_limit, floor=1e-5)


def force_peaks(spectrum: room.Spectrum) -> list[room.Peak]:
    """The lines of a gear-mesh force that are told of, highest first."""
    return room.spectrum_peaks(spectrum, count=8)


def _friction_document(solved: SolvedTransient, number: int) -> dict[str, float] | None:
    """Friction of a mesh over the record; None where it has none."""
    found = solved.histories.mesh_friction.get(solved.machine.system.contacts[number].name)
    if found is None:
        return None
    return {
        "mean_power_w": float(found[:, 1].mean()),
        "peak_power_w": float(found[:, 1].max()),
        "peak_force_n": float(np.abs(found[:, 0]).max()),
    }


def _back_flank_peak(solved: SolvedTransient, number: int, drives: int) -> float | None:
    """Largest force on the back flanks of a mesh [N]; None where they cannot meet."""
    meshes = solved.machine.meshes
    if meshes[number].backlash is None:
        return None
    before = sum(mesh.backlash is not None for mesh in meshes[:number])
    return float(solved.result.peak_force[drives + before])


def _trusted_limit(housing: SolvedHousing | HousingInMachine | None, mesh_frequencies: tuple[float, ...]) -> float:
    """Up to where the housing's modes are complete [Hz]; without a housing, what the gears excite."""
    if housing is not None:
        return housing.trusted_limit_hz
    return 4.0 * max(mesh_frequencies, default=1000.0)
