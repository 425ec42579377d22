"""The signature of a machine in motion: what the lines of its spectra are, and where they come from."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import coupling as room
from coupling import signature
from gearwhine.stages.transient import SolvedTransient, force_peaks, sensor_peaks

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_HERTZ = 2.0 * np.pi
_HARMONICS = 3  # of each mesh whose sidebands are looked at
_TOLD = 5  # modes, and bearings, of each line
_FAINT = 1e-6  # sidebands below this part of their carrier are rounding


@dataclass(frozen=True)
class Contribution:
    """A part of a line.

    Attributes
    ----------
    name : str
    value : complex
        Amplitude of acceleration [m/s²].
    share : float
        Of the line: the part in phase with it, so that shares add up to 1. Negative where it works against the line.
    mode : int or None
        Number of the housing mode, from 1.
    """

    name: str
    value: complex
    share: float
    mode: int | None = None


@dataclass(frozen=True)
class TracedLine:
    """A line of a sensor, what it is and where it comes from.

    Attributes
    ----------
    frequency : float
        [Hz].
    value : complex
        Amplitude [m/s²] and phase at the start of the record.
    named : coupling.signature.LineName
    modes : tuple of Contribution
        Every housing mode and what their local compliance leaves, largest first: they add up to the line.
    bearings : tuple of Contribution
        Every bearing on the housing, largest first.
    free : Contribution
        What the line has beyond what the bearings' forces account for: free vibration that has not died away, and
        errors of the steps in time.
    """

    frequency: float
    value: complex
    named: signature.LineName
    modes: tuple[Contribution, ...]
    bearings: tuple[Contribution, ...]
    free: Contribution


@dataclass(frozen=True)
class ShaftSidebands:
    """Sidebands of a gear mesh by the turning of a shaft, or of two that turn equally fast."""

    mesh: str
    shafts: tuple[str, ...]
    pairs: tuple[signature.Sideband, ...]


@dataclass(frozen=True)
class SolvedSignature:
    """Lines and sidebands.

    Attributes
    ----------
    lines : dict of str to tuple of TracedLine
        Of each sensor, highest first.
    force_lines : dict of str to tuple of coupling.signature.LineName
        Of each mesh's force, in the order of its peaks.
    sidebands : dict of str to tuple of ShaftSidebands
        Of each sensor.
    force_sidebands : dict of str to tuple of ShaftSidebands
        Of each mesh's force.
    bearing_spectra : dict of str to coupling.Spectrum
        Of the forces in all directions that a bearing holds, shape (d, m).
    modes : coupling.CoupledModes
        That names refer to.
    housing : coupling.Spectrum or None
        Of the accelerations of the housing's modes [m √kg / s²], shape (n_modes, m), where there are any.
    """

    lines: dict[str, tuple[TracedLine, ...]]
    force_lines: dict[str, tuple[signature.LineName, ...]]
    sidebands: dict[str, tuple[ShaftSidebands, ...]]
    force_sidebands: dict[str, tuple[ShaftSidebands, ...]]
    bearing_spectra: dict[str, room.Spectrum]
    modes: room.CoupledModes
    housing: room.Spectrum | None = None


def solve_signature(
    solved: SolvedTransient, modes: room.CoupledModes, housing_frequencies: FloatArray | None
) -> SolvedSignature:
    """Name the lines of sensors and gear meshes, and trace those of the sensors to bearings and housing modes.

    Parameters
    ----------
    solved
        The transient.
    modes
        Of the coupled system.
    housing_frequencies
        Of the housing's modes [Hz], where there is one.
    """
    histories, drives = solved.histories, [c.name for c in solved.machine.system.contacts if c.drives]
    interval = float(histories.times[1] - histories.times[0])
    window, limit = solved.record.sampling.window, solved.trusted_limit
    ties = {
        name: solved.record.spectrum(np.ascontiguousarray(force.T), limit)
        for name, force in histories.tie_force.items()
    }
    frequencies = np.zeros(0) if housing_frequencies is None else housing_frequencies
    modal, lines = None, {}
    if solved.modal.housing_acceleration.shape[1]:
        modal = solved.record.spectrum(np.ascontiguousarray(solved.modal.housing_acceleration.T), limit)
    if solved.sensor_spectra:
        assert modal is not None
        lines = {name: _traced(solved, name, modal, ties, modes, frequencies) for name in solved.sensor_spectra}
    return SolvedSignature(
        lines=lines,
        force_lines={
            name: tuple(_named(solved, solved.force_spectra[name], force_peaks(solved.force_spectra[name]), modes))
            for name in drives
        },
        sidebands={
            name: _sidebands(solved, signal, interval, window) for name, signal in histories.sensor_acceleration.items()
        },
        force_sidebands={
            name: _sidebands(solved, histories.mesh_force[name], interval, window, only=name) for name in drives
        },
        bearing_spectra=ties,
        modes=modes,
        housing=modal,
    )


def add_signature(document: dict[str, Any], solved: SolvedTransient, found: SolvedSignature) -> None:
    """Add to the transient's document what its lines are, levels, sidebands, and the bearings' forces."""
    for sensor in document["sensors"]:
        for row, line in zip(sensor["peaks"], found.lines[sensor["name"]], strict=True):
            row |= _name_document(line.named, found.modes)
            row["phase_rad"] = float(np.angle(line.value))
            row["level_db"] = float(signature.decibels(abs(line.value)))
            row["contributions"] = {
                "housing_modes": [_contribution(part) for part in line.modes[:_TOLD]],
                "bearings": [_contribution(part) for part in line.bearings[:_TOLD]],
                "free_vibration": _contribution(line.free),
            }
        sensor["sidebands"] = _sidebands_document(found.sidebands[sensor["name"]], "m_per_s2")
    names = list(found.force_lines)
    for name, pair in zip(names, document["gear_pairs"], strict=True):
        for row, named in zip(pair["force_peaks"], found.force_lines[name], strict=True):
            row |= _name_document(named, found.modes)
        pair["sidebands"] = _sidebands_document(found.force_sidebands[name], "n")
    document["bearings"] = []
    for name, load in solved.histories.bearing_load.items():
        parts = room.signal_parts(load.T)
        mean, rms = parts.mean.tolist(), parts.rms.tolist()
        # Forces along x, y, z and moments about x and y.
        document["bearings"].append(
            {
                "name": name,
                "mean_force_n": mean[:3],
                "rms_force_n": rms[:3],
                "mean_moment_n_m": mean[3:],
                "rms_moment_n_m": rms[3:],
            }
        )
    document["gears"] = []
    for name, motion in solved.histories.gear_motion.items():
        parts = room.signal_parts(motion[:, :2].T)
        document["gears"].append(
            {"name": name, "mean_displacement_m": parts.mean.tolist(), "peak_displacement_m": parts.peak.tolist()}
        )
    document["conventions"] = {
        "amplitude": "peak: a sine a sin(2 pi f t) has the amplitude a",
        "rms": "without the mean, up to trusted_below_hz",
        "level_db": "20 lg of the rms value of the line over 1e-6 m/s2 (ISO 1683)",
        "share": "part of the line in phase with it; shares of modes, and of bearings with free vibration, add up to 1",
    }


def _traced(
    solved: SolvedTransient,
    sensor: str,
    modal: room.Spectrum,
    ties: dict[str, room.Spectrum],
    modes: room.CoupledModes,
    frequencies: FloatArray,
) -> tuple[TracedLine, ...]:
    spectrum, machine = solved.sensor_spectra[sensor], solved.machine
    assert machine.housing is not None
    peaks = sensor_peaks(solved, sensor)
    places = np.searchsorted(spectrum.frequencies, [peak.frequency for peak in peaks]).astype(int)
    at = spectrum.frequencies[places]
    # Of a long record the peaks are those of its averaged spectrum, the parts those of its last stretch.
    values = solved.record.spectrum(solved.histories.sensor_acceleration[sensor], solved.trusted_limit).lines[places]
    by_mode = signature.mode_parts(machine.housing, sensor, modal.lines[:, places].T, values)
    forces = {name: tie.lines[:, places].T for name, tie in ties.items()}
    paths = signature.housing_paths(machine, _HERTZ * at, forces).at(sensor)
    free = values - paths.total
    mode_names = [f"housing mode {i} ({hz:.0f} Hz)" for i, hz in enumerate(frequencies.tolist(), start=1)]
    mode_names.append("local compliance")
    numbers = [*range(1, len(frequencies) + 1), None]
    names = _named(solved, spectrum, peaks, modes)
    return tuple(
        TracedLine(
            frequency=peak.frequency,
            value=complex(values[i]),
            named=names[i],
            modes=_ranked(mode_names, by_mode[i], complex(values[i]), numbers),
            bearings=_ranked(list(paths.bearings), paths.by_bearing[i], complex(values[i])),
            free=_ranked(["free vibration"], free[i : i + 1], complex(values[i]))[0],
        )
        for i, peak in enumerate(peaks)
    )


def _ranked(
    names: list[str], values: ComplexArray, line: complex, numbers: list[int | None] | None = None
) -> tuple[Contribution, ...]:
    shares = (values / line).real
    return tuple(
        Contribution(names[i], complex(values[i]), float(shares[i]), None if numbers is None else numbers[i])
        for i in np.argsort(-np.abs(values), kind="stable").tolist()
    )


def _named(
    solved: SolvedTransient, spectrum: room.Spectrum, peaks: list[room.Peak], modes: room.CoupledModes
) -> list[signature.LineName]:
    # Whole periods put every line exactly where it belongs; otherwise it may be half a spacing off.
    tolerance = (0.02 if spectrum.window == "uniform" else 0.5 + 1e-6) * spectrum.spacing
    return signature.line_names(solved.machine, [peak.frequency for peak in peaks], tolerance, modes)


def _sidebands(
    solved: SolvedTransient, signal: FloatArray, interval: float, window: room.Window, *, only: str | None = None
) -> tuple[ShaftSidebands, ...]:
    machine, found = solved.machine, []
    length = signal.size * interval
    for mesh, contact in zip(machine.meshes, machine.system.contacts, strict=False):
        if contact.rate == 0.0 or only not in (None, contact.name):
            continue
        carriers = [
            n * contact.rate for n in range(1, _HARMONICS + 1) if n * contact.rate <= solved.trusted_limit * (1 + 1e-9)
        ]
        together: dict[float, list[str]] = {}
        for rotor in (mesh.driver.rotor, mesh.driven.rotor):
            together.setdefault(round(abs(machine.speeds[rotor]) / _HERTZ, 9), []).append(rotor)
        for shafts in together.values():
            turning = abs(machine.speeds[shafts[0]]) / _HERTZ
            if turning * length >= (1.0 if window == "uniform" else 2.0):
                pairs = signature.sidebands(signal, interval, carriers, turning, window=window)
                found.append(ShaftSidebands(contact.name, tuple(shafts), tuple(pairs)))
    return tuple(found)


def _name_document(named: signature.LineName, modes: room.CoupledModes) -> dict[str, Any]:
    near = None
    if named.mode is not None:
        near = {
            "number": named.mode + 1,
            "kind": modes.kinds[named.mode],
            "where": modes.where[named.mode],
            "frequency_hz": float(modes.frequencies_hz[named.mode]),
        }
    return {"name": named.name, "kind": named.kind, "order": named.order, "near_mode": near}


def _contribution(part: Contribution) -> dict[str, Any]:
    document: dict[str, Any] = {
        "name": part.name,
        "amplitude_m_per_s2": abs(part.value),
        "phase_rad": float(np.angle(part.value)),
        "share": part.share,
    }
    return document if part.mode is None else document | {"number": part.mode}


def _sidebands_document(found: tuple[ShaftSidebands, ...], unit: str) -> list[dict[str, Any]]:
    """Sidebands above rounding, of carriers that are there."""
    return [
        {
            "gear_pair": one.mesh,
            "shafts": list(one.shafts),
            "carrier_hz": pair.carrier,
            "number": pair.number,
            "distance_hz": pair.distance,
            f"carrier_amplitude_{unit}": pair.carrier_amplitude,
            f"lower_amplitude_{unit}": pair.lower,
            f"upper_amplitude_{unit}": pair.upper,
            "amplitude_modulation": pair.amplitude_modulation,
            "phase_modulation_rad": pair.phase_modulation,
        }
        for one in found
        for pair in one.pairs
        if max(pair.lower, pair.upper) > _FAINT * pair.carrier_amplitude
    ]
