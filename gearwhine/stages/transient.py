"""The transient of a case: the machine turning under load, and what its sensors, gears and bearings show."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

import coupling as room
from gearwhine.case import Case, CaseError, Problem, Transient, require, rotor_speeds
from gearwhine.progress import Progress, silent
from gearwhine.stages.driving import driving
from gearwhine.stages.housing import SolvedHousing
from gearwhine.stages.machine import HousingInMachine, base_motion

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi

# Samples per second over the highest frequency of interest. Stepwise changes of the mesh force have harmonics without
# end; sampled so finely, little of them folds back, and the spectra of whole periods need no filter.
_OVERSAMPLING = 100.0


@dataclass(frozen=True)
class SolvedTransient:
    """The machine in motion.

    Attributes
    ----------
    machine : coupling.Machine
    turning : coupling.Turning or None
        Speed over time; None where it is the nominal one all along.
    result : coupling.TransientResult
    histories : coupling.Histories
        Of the recorded revolutions.
    sensor_spectra : dict of str to coupling.Spectrum
        Acceleration [m/s²].
    force_spectra : dict of str to coupling.Spectrum
        Gear-mesh force [N].
    trusted_limit : float
        Highest frequency that the housing's modes carry [Hz].
    modal : coupling.ModalRecord
        Of the recorded revolutions.
    """

    machine: room.Machine
    turning: room.Turning | None
    result: room.TransientResult
    histories: room.Histories
    sensor_spectra: dict[str, room.Spectrum]
    force_spectra: dict[str, room.Spectrum]
    trusted_limit: float
    modal: room.ModalRecord


def solve_transient(
    case: Case,
    machine: room.Machine,
    mesh_frequencies: tuple[float, ...],
    progress: Progress = silent,
    *,
    housing: SolvedHousing | HousingInMachine | None = None,
) -> SolvedTransient:
    """March the machine through the case's revolutions, or its run, and take the spectra of what is not discarded.

    The record holds whole revolutions of the first driver. Where every shaft then turns a whole number of times
    the spectra are taken as they are, each line exact; otherwise, and over a run, under Hann's window. A run is sampled
    for its highest speed, and ``discard`` counts revolutions as they are turned.

    Raises
    ------
    coupling.TransientError
        Where the motion cannot be followed or its energies do not balance.
    """
    require(case, "operation", "transient", command="run")
    assert case.operation is not None
    assert case.transient is not None
    given = case.transient
    driven = driving(case, machine.rotors)
    fastest = driven.rates[1] if driven.turning is None else float(driven.turning.rates.max())
    nominal = _HERTZ / abs(case.operation.speed)
    period = nominal / fastest
    limit = _trusted_limit(housing, tuple(fastest * frequency for frequency in mesh_frequencies))
    per_revolution = _samples_per_revolution(period, limit, given.points_per_revolution)
    settings = room.TransientSettings(
        duration=_duration(given, nominal),
        record_from=_record_from(given, nominal, driven.turning),
        sample_interval=period / per_revolution,
        largest_step=nominal / given.points_per_revolution,
        tolerance=given.tolerance,
    )
    progress("compiling the time stepper (the first time takes longer)")
    result = room.simulate(
        machine.system,
        settings,
        room.with_modal_rows(machine, room.transient_outputs(machine), given.modal_coordinates),
        initial=starting_state(case, machine),
        turning=driven.turning,
        progress=lambda fraction: progress("marching through the transient", fraction),
    )
    named = room.histories(machine, result, driven.turning)
    base = base_motion(case)
    if base is not None and housing is not None:
        # What an accelerometer shows is the motion in space.
        absolute = {
            name: named.sensor_acceleration[name] + base.acceleration_at(port.position, port.direction, named.times)
            for name, port in housing.sensors.items()
        }
        named = replace(named, sensor_acceleration=absolute)
    window = _window(case)
    interval = settings.sample_interval
    return SolvedTransient(
        machine=machine,
        turning=driven.turning,
        result=result,
        histories=named,
        sensor_spectra={
            name: room.amplitude_spectrum(signal, interval, window)
            for name, signal in named.sensor_acceleration.items()
        },
        force_spectra={
            name: room.amplitude_spectrum(signal, interval, window) for name, signal in named.mesh_force.items()
        },
        trusted_limit=limit,
        modal=room.modal_record(machine, result, given.modal_coordinates),
    )


def starting_state(case: Case, machine: room.Machine) -> tuple[FloatArray, FloatArray] | None:
    """Coordinates and rates that the case starts from; None: static equilibrium under its load.

    A train that turns unloaded has straight, untwisted shafts and teeth that just touch: all coordinates are zero.
    """
    assert case.transient is not None
    if case.transient.start == "equilibrium":
        return None
    return np.zeros(machine.system.size), np.zeros(machine.system.size)


def transient_document(case: Case, solved: SolvedTransient) -> dict[str, Any]:
    """The transient as the command's JSON."""
    assert case.operation is not None
    result = solved.result
    drives = len(solved.machine.meshes)
    pairs = []
    for number, mesh in enumerate(solved.machine.meshes):
        spectrum = solved.force_spectra[solved.machine.system.contacts[number].name]
        pairs.append(
            {
                "driver": mesh.driver.name,
                "driven": mesh.driven.name,
                "mean_force_n": float(result.mean_force[number]),
                "peak_force_n": float(result.peak_force[number]),
                "contact_loss_fraction": float(result.contact_loss[number]),
                "back_flank_peak_force_n": _back_flank_peak(solved, number, drives),
                "force_peaks": [
                    {"frequency_hz": peak.frequency, "amplitude_n": peak.amplitude} for peak in force_peaks(spectrum)
                ],
            }
        )
    return {
        "speed_rpm": case.operation.speed * 60.0 / _HERTZ,
        "run": _run_document(case, solved.turning),
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


def _duration(given: Transient, period: float) -> float:
    """[s]."""
    if given.run is not None:
        return given.run.duration
    assert given.revolutions is not None
    return given.revolutions * period


def _record_from(given: Transient, period: float, turning: room.Turning | None) -> float:
    """When the discarded revolutions are done [s].

    Raises
    ------
    CaseError
        Where a run does not turn so far.
    """
    if turning is None or given.discard == 0.0:
        return given.discard * period
    time = float(turning.times_of(np.array([given.discard * period]))[0])
    if not time < _duration(given, period):
        turned = float(turning.at(_duration(given, period))[0][0]) / period
        expected = f"fewer revolutions than the {turned:g} that the run turns"
        raise CaseError([Problem("transient.discard", given.discard, expected)])
    return time


def sensor_peaks(solved: SolvedTransient, sensor: str) -> list[room.Peak]:
    """The lines of a sensor that are told of, highest first."""
    return room.spectrum_peaks(solved.sensor_spectra[sensor], count=20, limit=solved.trusted_limit, floor=1e-5)


def force_peaks(spectrum: room.Spectrum) -> list[room.Peak]:
    """The lines of a gear-mesh force that are told of, highest first."""
    return room.spectrum_peaks(spectrum, count=8)


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


def _samples_per_revolution(period: float, limit: float, floor: int) -> int:
    """The power of two that samples the frequencies of interest well and meets the case's floor."""
    return int(2 ** np.ceil(np.log2(max(floor, _OVERSAMPLING * limit * period))))


def _window(case: Case) -> room.Window:
    assert case.transient is not None
    if case.transient.revolutions is None:
        return "hann"
    recorded = case.transient.revolutions - case.transient.discard
    turns = [recorded * abs(ratio) for ratio in rotor_speeds(case, 1.0).values()]
    return "uniform" if all(abs(turn - round(turn)) < 1e-9 for turn in turns) else "hann"
