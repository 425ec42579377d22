"""Signature of a machine in motion: the names of the lines in its spectra, and the transfer paths behind them."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.coupling import signals as signature
from gearwhine.coupling.analyses.recording import Signals
from gearwhine.coupling.analyses.transient import SolvedTransient
from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.linear.carriers.carrier_sidebands import forced_sidebands
from gearwhine.coupling.linear.complex_modes import CoupledModes
from gearwhine.coupling.linear.excitation_orders import excited_shaft_orders, in_carrier
from gearwhine.coupling.signals.peaks import SpectralPeaks
from gearwhine.coupling.signals.spectrum import Spectrum, Window, at_time_zero
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_TWO_PI = 2.0 * np.pi
_HARMONICS = 3  # harmonics of each mesh whose sidebands are taken
_MOST_REPORTED = 5  # number of modes, and of bearings, reported of each line
_FAINT_SIDEBAND_RATIO = 1e-6  # sidebands below this part of their carrier are rounding


@dataclass(frozen=True)
class Contribution:
    """A part of a line.

    Attributes
    ----------
    name : str
    value : complex
        Amplitude of acceleration [m/s²].
    share : float
        Part of the line in phase with it, so that shares add up to 1; negative where it works against the line.
    mode : int or None
        Number of the housing mode, from 1.
    """

    name: str
    value: complex
    share: float
    mode: int | None = None


@dataclass(frozen=True)
class TracedLine:
    """A line of a sensor, with its name and its contributions.

    Attributes
    ----------
    frequency : float
        Frequency [Hz].
    value : complex
        Amplitude [m/s²] and phase of the cosine at t = 0. Of a long record the root mean square over its stretches,
        as its parts are averaged over them.
    named : gearwhine.coupling.signals.LineName
    modes : tuple of Contribution
        Contributions of every housing mode and of the local compliance, largest share first; they add up to the line.
    bearings : tuple of Contribution
        Contributions of every bearing on the housing, largest share first.
    free : Contribution
        Part of the line that is not of the bearings' forces: free vibration that has not died away, and errors of the
        time integration.
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
    def listed_modes(self) -> tuple[Contribution, ...]:
        """The modes with most of the line."""
        return self.modes[:_MOST_REPORTED]

    @property
    def listed_bearings(self) -> tuple[Contribution, ...]:
        """The bearings with most of the line."""
        return self.bearings[:_MOST_REPORTED]


@dataclass(frozen=True)
class LineTable:
    """Lines of all sensors with their parts, NaN where a sensor has fewer.

    Complex numbers stand along the last axis, real part first [m/s²].

    Attributes
    ----------
    ranks : ndarray, shape (k,)
        Rank of the line, highest first.
    modes : list of str
        Housing modes in the order of their numbers, the local compliance last.
    bearings : list of str
        Bearings that forces come through.
    frequency : ndarray, shape (s, k)
        Frequency of the sensor's line [Hz].
    names : ndarray of str, shape (s, k)
        What the line is.
    value : ndarray, shape (s, k, 2)
        Complex amplitude of the sensor's line.
    by_mode : ndarray, shape (s, k, m, 2)
        Part of a housing mode in the line: the parts add up to it.
    by_bearing : ndarray, shape (s, k, b, 2)
        Part of a bearing's force in the line.
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
    """Sidebands of a gear mesh by the rotation of a shaft, or of two of equal speed, that modulates it.

    Of a mesh on a turning carrier these are the gears' rotations relative to it, and its own. A shaft that nothing
    excites modulates nothing, and a line of a simpler cause, as a harmonic of another mesh, is no sideband: pairs with
    one are left out.
    """

    mesh: str
    shafts: tuple[str, ...]
    pairs: tuple[signature.Sideband, ...]


@dataclass(frozen=True)
class SolvedSignature:
    """Lines and sidebands.

    Attributes
    ----------
    lines : dict of str to tuple of TracedLine
        Lines of each sensor, highest first.
    force_lines : dict of str to tuple of gearwhine.coupling.signals.LineName
        Names of the lines of each mesh's force on its loaded flanks, by pair, in the order of its peaks.
    sidebands : dict of str to tuple of ShaftSidebands
        Sidebands of each sensor, of a long record in its last stretch.
    force_sidebands : dict of str to tuple of ShaftSidebands
        Sidebands of each mesh's force on its loaded flanks, by pair.
    bearing_spectra : dict of str to Spectrum
        Spectra of the forces in all directions that a bearing holds, shape (d, m), of a long record of its last
        stretch.
    modes : CoupledModes
        Coupled modes that names refer to.
    housing : Spectrum or None
        Spectra of the accelerations of the housing's modes, shape (n_modes, m) [m √kg / s²], of a long record of its
        last stretch; None without a housing.
    record_start : float
        Time from which phases of the spectra count [s]; those of `lines` count from t = 0.
    """

    lines: dict[str, tuple[TracedLine, ...]]
    force_lines: dict[str, tuple[signature.LineName, ...]]
    sidebands: dict[str, tuple[ShaftSidebands, ...]]
    force_sidebands: dict[str, tuple[ShaftSidebands, ...]]
    bearing_spectra: dict[str, Spectrum]
    modes: CoupledModes
    housing: Spectrum | None = None
    record_start: float = 0.0

    def clear_sidebands(self, sidebands: tuple[ShaftSidebands, ...]) -> list[tuple[ShaftSidebands, signature.Sideband]]:
        """Return the sidebands above rounding, of carriers that exist."""
        return [
            (of_shaft, pair)
            for of_shaft in sidebands
            for pair in of_shaft.pairs
            if max(pair.lower, pair.upper) > _FAINT_SIDEBAND_RATIO * pair.carrier_amplitude
        ]

    def bearing_amplitudes(self, solved: SolvedTransient) -> dict[str, FloatArray]:
        """Peak amplitudes of each bearing's load along x, y, z and about x, y, (5, m); zero where nothing holds."""
        amplitudes = {}
        for name, spectrum in self.bearing_spectra.items():
            amplitudes[name] = np.zeros((5, len(spectrum.frequencies)))
            amplitudes[name][list(solved.histories.bearing_axes[name])] = spectrum.amplitude
        return amplitudes

    def housing_lines(self, limit: float) -> tuple[FloatArray, ComplexArray, str] | None:
        """Frequencies [Hz] up to a limit, the lines of the housing's modes there at t = 0, and their window."""
        if self.housing is None:
            return None
        below = self.housing.frequencies <= limit * (1.0 + 1e-9)
        frequencies = self.housing.frequencies[below]
        lines = at_time_zero(self.housing.lines[:, below], frequencies, self.record_start)
        return frequencies, lines, self.housing.window

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
    solved : SolvedTransient
    modes : CoupledModes
        Modes of the coupled system.
    housing_frequencies : ndarray, shape (n_modes,), or None
        Natural frequencies of the housing's modes [Hz], where there is one.
    """
    histories, contacts = solved.histories, solved.machine.system.contacts
    pressed = [contacts[number].name for number in solved.machine.loaded_contacts]
    interval = float(histories.times[1] - histories.times[0])
    window = solved.record.sampling.window
    frequencies = np.zeros(0) if housing_frequencies is None else housing_frequencies
    last, lines = _stretch_spectra(solved, solved.signals), {}
    if solved.sensor_spectra:
        peak_lines = _peak_lines(solved, last)
        lines = {name: _traced(solved, name, at, modes, frequencies) for name, at in peak_lines.items()}
    return SolvedSignature(
        lines=lines,
        force_lines={
            name: tuple(_named(solved, solved.force_spectra[name], solved.force_peaks(name), modes)) for name in pressed
        },
        sidebands={
            name: _sidebands(solved, signal, interval, window) for name, signal in histories.sensor_acceleration.items()
        },
        force_sidebands={
            name: _sidebands(solved, histories.mesh_force[name], interval, window, only=pair)
            for pair, name in enumerate(pressed)
        },
        bearing_spectra={name: last.bearings[name] for name in histories.bearing_reaction},
        modes=modes,
        housing=last.housing,
        record_start=solved.record_start,
    )


@dataclass(frozen=True)
class _StretchSpectra:
    """Spectra of one stretch of the record.

    Attributes
    ----------
    sensors : dict of str to Spectrum
    housing : Spectrum or None
        Accelerations of the housing's modes, shape (n_modes, m).
    bearings : dict of str to Spectrum
        Forces in all directions of a bearing or another connector on the housing, shape (d, m).
    """

    sensors: dict[str, Spectrum]
    housing: Spectrum | None
    bearings: dict[str, Spectrum]


def _stretch_spectra(solved: SolvedTransient, signals: Signals) -> _StretchSpectra:
    def of(values: FloatArray) -> Spectrum:
        return solved.record.spectrum(values, solved.trusted_limit)

    histories, modal = signals.histories, signals.modal.housing_acceleration
    return _StretchSpectra(
        {name: of(signal) for name, signal in histories.sensor_acceleration.items()},
        of(np.ascontiguousarray(modal.T)) if modal.shape[1] else None,
        {name: of(np.ascontiguousarray(force.T)) for name, force in histories.forces_on_housing.items()},
    )


@dataclass(frozen=True)
class _PeakLines:
    """Lines at the p peaks of a sensor.

    Attributes
    ----------
    peaks : SpectralPeaks
    value : ndarray of complex, shape (p,)
        Lines of the sensor.
    housing : ndarray of complex, shape (p, n_modes)
        Lines of the housing's modes.
    bearings : dict of str to ndarray of complex, shape (p, d)
        Lines of the bearings' forces.
    """

    peaks: SpectralPeaks
    value: ComplexArray
    housing: ComplexArray
    bearings: dict[str, ComplexArray]


def _peak_lines(solved: SolvedTransient, last: _StretchSpectra) -> dict[str, _PeakLines]:
    """Lines of each sensor at its peaks, and of modes and bearing forces there, of all stretches together.

    A sensor's line a has the root mean square amplitude A over the stretches, and the phase φ of its mean. A line x of
    another signal counts with its part in the line: by the cross-spectrum with the line, averaged over the stretches,

        x = <x_s a_s*> / <a_s a_s*> A e^{iφ},

    which is linear in x. So parts of the line that add up in each stretch add up to A e^{iφ}, and their shares are
    Re <x_s a_s*> / <a_s a_s*>. Of a single stretch x is its own line. Phases φ are those at t = 0.
    """
    assert last.housing is not None
    peaks = {name: solved.sensor_peaks(name) for name in solved.sensor_spectra}
    counts = [len(last.housing.amplitude), *(len(spectrum.amplitude) for spectrum in last.bearings.values())]
    sums = {name: np.zeros((sum(counts), len(at)), dtype=np.complex128) for name, at in peaks.items()}
    squares = {name: np.zeros(len(at)) for name, at in peaks.items()}
    stretches: Iterable[_StretchSpectra] = (last,)
    if solved.record.sampling.is_long:
        stretches = (_stretch_spectra(solved, signals) for signals in solved.record.stretches())
    for stretch in stretches:
        assert stretch.housing is not None
        others = np.concatenate([stretch.housing.lines, *(forces.lines for forces in stretch.bearings.values())])
        for name, at in peaks.items():
            own = at.of(stretch.sensors[name].lines)
            sums[name] += at.of(others) * own.conj()
            squares[name] += np.abs(own) ** 2
    found = {}
    for name, at in peaks.items():
        phase = np.angle(at.of(solved.sensor_spectra[name].lines))
        value = at_time_zero(at.amplitudes * np.exp(1j * phase), at.frequencies, solved.record_start)
        housing, *bearings = np.split((sums[name] / squares[name] * value).T, np.cumsum(counts[:-1]), axis=1)
        found[name] = _PeakLines(at, value, housing, dict(zip(last.bearings, bearings, strict=True)))
    return found


def _traced(
    solved: SolvedTransient, sensor: str, lines: _PeakLines, modes: CoupledModes, frequencies: FloatArray
) -> tuple[TracedLine, ...]:
    spectrum, machine = solved.sensor_spectra[sensor], solved.machine
    assert machine.housing is not None
    values = lines.value
    by_mode = signature.mode_parts(machine.housing, sensor, lines.housing, values)
    angular = _TWO_PI * lines.peaks.frequencies
    paths = signature.housing_paths(machine, angular, lines.bearings).at(sensor)
    free = values - paths.total
    mode_names = [f"housing mode {i} ({hz:.0f} Hz)" for i, hz in enumerate(frequencies.tolist(), start=1)]
    mode_names.append("local compliance")
    numbers = [*range(1, len(frequencies) + 1), None]
    names = _named(solved, spectrum, lines.peaks, modes)
    return tuple(
        TracedLine(
            frequency=frequency,
            value=complex(values[i]),
            named=names[i],
            modes=_ranked(mode_names, by_mode[i], complex(values[i]), numbers),
            bearings=_ranked(list(paths.bearings), paths.by_bearing[i], complex(values[i])),
            free=_ranked(["free vibration"], free[i : i + 1], complex(values[i]))[0],
        )
        for i, frequency in enumerate(lines.peaks.frequencies.tolist())
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
    solved: SolvedTransient, spectrum: Spectrum, peaks: SpectralPeaks, modes: CoupledModes
) -> list[signature.LineName]:
    # A free vibration dies away within the record: its line is as wide as the spacing where others are exact.
    near = (0.02 if spectrum.window == "uniform" else 0.5 + 1e-6) * spectrum.spacing
    return signature.line_names(solved.machine, peaks.frequencies.tolist(), peaks.resolution, modes, near=near)


def _sidebands(
    solved: SolvedTransient, signal: FloatArray, interval: float, window: Window, *, only: int | None = None
) -> tuple[ShaftSidebands, ...]:
    machine, of_shafts = solved.machine, []
    length, apart = signal.size * interval, 1.0 if window == "uniform" else 2.0
    modulating = {*excited_shaft_orders(machine)}
    modulating.update(carrier for one in forced_sidebands(machine) for carrier, _ in one.turns)
    for pair, (mesh, contact) in enumerate(zip(machine.meshes, machine.system.contacts, strict=False)):
        if contact.mesh_frequency == 0.0 or only not in (None, pair):
            continue
        carriers = [
            n * contact.mesh_frequency
            for n in range(1, _HARMONICS + 1)
            if n * contact.mesh_frequency <= solved.trusted_limit * (1 + 1e-9)
        ]
        together: dict[float, list[str]] = {}
        frame = 0.0 if mesh.carrier is None else machine.speeds[mesh.carrier]
        turns = {in_carrier(one.rotor, mesh, frame): machine.speeds[one.rotor] for one in (mesh.driver, mesh.driven)}
        rates = {name: abs(speed - frame) / _TWO_PI for name, speed in turns.items()}
        if frame != 0.0 and mesh.carrier is not None:
            rates[mesh.carrier] = abs(frame) / _TWO_PI
        rotors = {name: one.rotor for name, one in zip(turns, (mesh.driver, mesh.driven), strict=True)}
        for name, rate in rates.items():
            if modulating & {name, rotors.get(name, name)}:
                together.setdefault(round(rate, 9), []).append(name)
        for shafts in together.values():
            turning = rates[shafts[0]]
            if turning * length >= apart:
                pairs = signature.sidebands(signal, interval, carriers, turning, window=window)
                own = _of_no_simpler_cause(machine, pairs, 0.5 * apart / length)
                of_shafts.append(ShaftSidebands(contact.name, tuple(shafts), own))
    return tuple(of_shafts)


def _of_no_simpler_cause(
    machine: CoupledMachine, pairs: list[signature.Sideband], within: float
) -> tuple[signature.Sideband, ...]:
    """Pairs neither line of which is within a distance [Hz] of a mesh harmonic or another excitation."""
    at = [pair.carrier + sign * pair.distance for pair in pairs for sign in (-1.0, 1.0)]
    simpler = [line.kind in ("mesh", "shaft", "load", "bearing") for line in signature.line_names(machine, at, within)]
    return tuple(pair for pair, *lines in zip(pairs, simpler[::2], simpler[1::2], strict=True) if not any(lines))
