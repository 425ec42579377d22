"""Signature of a machine in motion: the names of the lines in its spectra, and the transfer paths behind them."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling import signals as signature
from coupling.linear.complex_modes import CoupledModes
from coupling.signals.spectrum import Peak, Spectrum, Window
from gearwhine.solve.transient import SolvedTransient

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_TWO_PI = 2.0 * np.pi
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
    named : coupling.signals.LineName
    modes : tuple of Contribution
        Every housing mode and what their local compliance leaves, largest share first: they add up to the line.
    bearings : tuple of Contribution
        Every bearing on the housing, largest share first.
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

    @property
    def level_db(self) -> float:
        """Level of the line's rms value over 1e-6 m/s² (ISO 1683) [dB]."""
        return float(signature.decibels(abs(self.value)))

    @property
    def told_modes(self) -> tuple[Contribution, ...]:
        """The modes with most of the line."""
        return self.modes[:_TOLD]

    @property
    def told_bearings(self) -> tuple[Contribution, ...]:
        """The bearings with most of the line."""
        return self.bearings[:_TOLD]


@dataclass(frozen=True)
class LineTable:
    """Lines of all sensors with their parts, NaN where a sensor has fewer.

    Complex numbers stand along the last axis, real part first [m/s²].

    Attributes
    ----------
    ranks : ndarray, shape (k,)
    modes, bearings : list of str
        Modes in the order of their numbers, the local compliance last.
    frequency : ndarray, shape (s, k)
        [Hz].
    names : ndarray of str, shape (s, k)
    value : ndarray, shape (s, k, 2)
    by_mode : ndarray, shape (s, k, m, 2)
    by_bearing : ndarray, shape (s, k, b, 2)
    """

    ranks: npt.NDArray[np.int64]
    modes: list[str]
    bearings: list[str]
    frequency: FloatArray
    names: npt.NDArray[np.str_]
    value: FloatArray
    by_mode: FloatArray
    by_bearing: FloatArray


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
    force_lines : dict of str to tuple of coupling.signals.LineName
        Of each mesh's force, in the order of its peaks.
    sidebands : dict of str to tuple of ShaftSidebands
        Of each sensor.
    force_sidebands : dict of str to tuple of ShaftSidebands
        Of each mesh's force.
    bearing_spectra : dict of str to Spectrum
        Of the forces in all directions that a bearing holds, shape (d, m).
    modes : CoupledModes
        That names refer to.
    housing : Spectrum or None
        Of the accelerations of the housing's modes [m √kg / s²], shape (n_modes, m), where there are any.
    """

    lines: dict[str, tuple[TracedLine, ...]]
    force_lines: dict[str, tuple[signature.LineName, ...]]
    sidebands: dict[str, tuple[ShaftSidebands, ...]]
    force_sidebands: dict[str, tuple[ShaftSidebands, ...]]
    bearing_spectra: dict[str, Spectrum]
    modes: CoupledModes
    housing: Spectrum | None = None

    def clear_sidebands(self, found: tuple[ShaftSidebands, ...]) -> list[tuple[ShaftSidebands, signature.Sideband]]:
        """Sidebands above rounding, of carriers that are there."""
        return [
            (one, pair)
            for one in found
            for pair in one.pairs
            if max(pair.lower, pair.upper) > _FAINT * pair.carrier_amplitude
        ]

    def bearing_amplitudes(self, solved: SolvedTransient) -> dict[str, FloatArray]:
        """Peak amplitudes of each bearing's load along x, y, z and about x, y, (5, m); zero where nothing holds."""
        found = {}
        for name, spectrum in self.bearing_spectra.items():
            found[name] = np.zeros((5, len(spectrum.frequencies)))
            found[name][list(solved.histories.bearing_axes[name])] = spectrum.amplitude
        return found

    def housing_lines(self, limit: float) -> tuple[FloatArray, ComplexArray, str] | None:
        """Frequencies [Hz] up to a limit, the lines of the housing's modes there, and their window."""
        if self.housing is None:
            return None
        shown = self.housing.frequencies <= limit * (1.0 + 1e-9)
        return self.housing.frequencies[shown], self.housing.lines[:, shown], self.housing.window

    def line_table(self) -> LineTable | None:
        """Lines of all sensors beside each other; None where there are none."""
        if not any(self.lines.values()):
            return None
        count = max(len(lines) for lines in self.lines.values())
        first = next(line for lines in self.lines.values() for line in lines)
        bearings = [part.name for part in first.bearings]
        modes = [part.name for part in sorted(first.modes, key=lambda part: (part.mode is None, part.mode or 0))]
        shape = (len(self.lines), count)
        frequency, names, value = np.full(shape, np.nan), np.full(shape, "", dtype=object), np.full((*shape, 2), np.nan)
        by_mode, by_bearing = np.full((*shape, len(modes), 2), np.nan), np.full((*shape, len(bearings), 2), np.nan)
        for i, lines in enumerate(self.lines.values()):
            for j, line in enumerate(lines):
                frequency[i, j], names[i, j] = line.frequency, line.named.name
                value[i, j] = line.value.real, line.value.imag
                for table, order, parts in ((by_mode, modes, line.modes), (by_bearing, bearings, line.bearings)):
                    for part in parts:
                        table[i, j, order.index(part.name)] = part.value.real, part.value.imag
        ranks = np.arange(1, count + 1)
        return LineTable(ranks, modes, bearings, frequency, names.astype(str), value, by_mode, by_bearing)


def solve_signature(
    solved: SolvedTransient, modes: CoupledModes, housing_frequencies: FloatArray | None
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
    histories, drives = solved.histories, [c.name for c in solved.machine.system.contacts if c.loaded]
    interval = float(histories.times[1] - histories.times[0])
    window, limit = solved.record.sampling.window, solved.trusted_limit
    ties = {
        name: solved.record.spectrum(np.ascontiguousarray(force.T), limit)
        for name, force in histories.bearing_reaction.items()
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
            name: tuple(_named(solved, solved.force_spectra[name], solved.force_peaks(name), modes)) for name in drives
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


def _traced(
    solved: SolvedTransient,
    sensor: str,
    modal: Spectrum,
    ties: dict[str, Spectrum],
    modes: CoupledModes,
    frequencies: FloatArray,
) -> tuple[TracedLine, ...]:
    spectrum, machine = solved.sensor_spectra[sensor], solved.machine
    assert machine.housing is not None
    peaks = solved.sensor_peaks(sensor)
    places = np.searchsorted(spectrum.frequencies, [peak.frequency for peak in peaks]).astype(int)
    at = spectrum.frequencies[places]
    # Of a long record the peaks are those of its averaged spectrum, the parts those of its last stretch.
    values = solved.record.spectrum(solved.histories.sensor_acceleration[sensor], solved.trusted_limit).lines[places]
    by_mode = signature.mode_parts(machine.housing, sensor, modal.lines[:, places].T, values)
    forces = {name: tie.lines[:, places].T for name, tie in ties.items()}
    paths = signature.housing_paths(machine, _TWO_PI * at, forces).at(sensor)
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
        for i in np.argsort(-np.abs(shares), kind="stable").tolist()
    )


def _named(
    solved: SolvedTransient, spectrum: Spectrum, peaks: list[Peak], modes: CoupledModes
) -> list[signature.LineName]:
    # Whole periods put every line exactly where it belongs; otherwise it may be half a spacing off.
    tolerance = (0.02 if spectrum.window == "uniform" else 0.5 + 1e-6) * spectrum.spacing
    return signature.line_names(solved.machine, [peak.frequency for peak in peaks], tolerance, modes)


def _sidebands(
    solved: SolvedTransient, signal: FloatArray, interval: float, window: Window, *, only: str | None = None
) -> tuple[ShaftSidebands, ...]:
    machine, found = solved.machine, []
    length = signal.size * interval
    for mesh, contact in zip(machine.meshes, machine.system.contacts, strict=False):
        if contact.mesh_frequency == 0.0 or only not in (None, contact.name):
            continue
        carriers = [
            n * contact.mesh_frequency
            for n in range(1, _HARMONICS + 1)
            if n * contact.mesh_frequency <= solved.trusted_limit * (1 + 1e-9)
        ]
        together: dict[float, list[str]] = {}
        for rotor in (mesh.driver.rotor, mesh.driven.rotor):
            together.setdefault(round(abs(machine.speeds[rotor]) / _TWO_PI, 9), []).append(rotor)
        for shafts in together.values():
            turning = abs(machine.speeds[shafts[0]]) / _TWO_PI
            if turning * length >= (1.0 if window == "uniform" else 2.0):
                pairs = signature.sidebands(signal, interval, carriers, turning, window=window)
                found.append(ShaftSidebands(contact.name, tuple(shafts), tuple(pairs)))
    return tuple(found)
