"""Lines of a motion that drive the housing: the bearings' forces at each frequency, and the housing's motion by them.

The lines of a steady state are the harmonics of its period; where motions are superposed, the complex amplitudes of
lines at one frequency are added. The lines of a record of whole periods are its spectral lines; those of another record
are its tones, see :mod:`gearwhine.coupling.signals.tones`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.coupling import CoupledMachine, amplitude_spectrum
from gearwhine.coupling.analyses.steady_state import SolvedSteady
from gearwhine.coupling.analyses.transient import SolvedTransient
from gearwhine.coupling.linear.excitation_orders import excitation_lines
from gearwhine.coupling.signals.line_names import LineName, line_names
from gearwhine.coupling.signals.spectrum import Spectrum, at_time_zero
from gearwhine.coupling.signals.tones import hann_tones
from gearwhine.coupling.signals.transfer_paths import HousingPaths, housing_paths
from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.result_warnings import ResultWarning, warning

_TWO_PI = 2.0 * np.pi
_EXACT = 0.02  # distance of a record's exact line from the frequency of its cause, over the spacing of lines
_PERIODIC = 1e-6  # rounding of the frequency of a line of a periodic motion, over the spacing of lines
_FOUND = 0.5  # distance of a tone between the lines from the frequency of its cause, over their spacing
_FORCES = 3  # number of forces: a bearing's axes are x, y, z and the rotations about x and y
_FAINT = 1e-6  # part of the largest line's estimated power below which a line is left out
_NAMED = 12  # largest number of lines that are named as left out
_WORTH_NAMING = 1e-3  # part of the estimated power from which a line is named as left out
_HARMONICS = (1, 2, 3)  # harmonics of each mesh that are named where they are above the limit

AUDIBLE = 20.0
"""Lowest frequency of a sound [Hz]."""


@dataclass(frozen=True)
class MotionLines:
    """Spectral lines of the forces of a machine's bearings.

    Attributes
    ----------
    frequencies : ndarray, shape (l,)
        Frequencies above 0, ascending, each once [Hz].
    forces : mapping of str to ndarray of complex, shape (l, d)
        Forces and moments of each bearing on the housing [N, N m], with their phases at t = 0.
    tolerance : float
        Distance of a line from the frequency of its cause, for its name [Hz].
    """

    frequencies: FloatArray
    forces: Mapping[str, ComplexArray]
    tolerance: float

    def between(self, low: float, high: float) -> "MotionLines":
        """Return the lines from one frequency to another [Hz]."""
        inside = (self.frequencies >= low) & (self.frequencies <= high * (1.0 + 1e-9))
        forces = {name: force[inside] for name, force in self.forces.items()}
        return MotionLines(self.frequencies[inside], forces, self.tolerance)

    def at_time_zero(self, start: float) -> "MotionLines":
        """Return the lines with their phases at t = 0, where they are those at the start of a record [s]."""
        forces = {name: at_time_zero(force.T, self.frequencies, start).T for name, force in self.forces.items()}
        return MotionLines(self.frequencies, forces, self.tolerance)

    def paths(self, machine: CoupledMachine) -> HousingPaths:
        """Motion of the housing by each bearing's force.

        See :func:`gearwhine.coupling.signals.transfer_paths.housing_paths`.
        """
        return housing_paths(machine, _TWO_PI * self.frequencies, self.forces)

    def rates(self, paths: HousingPaths) -> ComplexArray:
        """Rates of the housing's coordinates by each bearing, shape (l, b, n)."""
        return np.asarray(paths.acceleration / (1j * paths.frequencies[:, None, None]))


@dataclass(frozen=True)
class LeftOut:
    """Line of a motion whose sound is not solved.

    Attributes
    ----------
    name : str
    frequency_hz : float
    share : float or None
        Part of all lines' power by the estimate; None beyond the frequency below which the modes are complete.
    """

    name: str
    frequency_hz: float
    share: float | None


def without_lines(*, base_moves: bool, speed_changes: bool) -> str:
    """Return why a motion has no lines that drive the housing by its bearings alone; empty where it has.

    The sound of a moving base is unknown at microphones, too: the base drives the housing by its inertia.
    """
    if base_moves:
        return "the base moves, which drives the housing beside its bearings (operation.base)"
    if speed_changes:
        return "the speed changes, so that the record has no steady lines (transient.run)"
    return ""


def left_out_warnings(*, base_moves: bool, speed_changes: bool) -> list[ResultWarning]:
    """Return the warning that the sound of a motion's lines is left out, and why; none where it is not."""
    why = without_lines(base_moves=base_moves, speed_changes=speed_changes)
    subject = "the sound of the motion" if base_moves else "the sound of lines"
    return [warning("sound_left_out", f"{subject} is left out: {why}")] if why else []


def lines_of_steady(solved: SolvedSteady, limit: float) -> MotionLines:
    """Lines of a periodic motion up to a limit [Hz], or of the sum of all motions that are superposed."""
    lines = []
    for motion in solved.motions[: 1 if solved.superposed is None else None]:
        spectra = {
            name: amplitude_spectrum(
                motion.group.weight * np.ascontiguousarray(force.T), motion.response.period / len(force)
            )
            for name, force in motion.histories.forces_on_housing.items()
        }
        lines.append(_lines_of(spectra, _PERIODIC / motion.response.period))
    return superposed_lines(lines).between(np.finfo(float).tiny, limit)


def superposed_lines(motions: "list[MotionLines]") -> MotionLines:
    """Add the lines of motions that are superposed: those at one frequency are one line, the sum of their forces.

    Parameters
    ----------
    motions : list of MotionLines
        One or more motions of the same bearings, with phases at the same time.
    """
    if len(motions) == 1:
        return motions[0]
    frequencies = np.concatenate([motion.frequencies for motion in motions])
    order = np.argsort(frequencies, kind="stable")
    ascending = frequencies[order]
    tolerance = min(motion.tolerance for motion in motions)
    starts = np.flatnonzero(np.diff(ascending, prepend=-np.inf) > tolerance)
    forces = {
        name: np.add.reduceat(np.concatenate([motion.forces[name] for motion in motions])[order], starts, axis=0)
        for name in motions[0].forces
    }
    return MotionLines(ascending[starts], forces, tolerance)


def lines_of_run(solved: SolvedTransient, limit: float) -> MotionLines:
    """Lines of a transient's record at steady speed up to a limit [Hz]; none where no bearing stands in the housing.

    The lines of a record without whole periods are tones between its spectral lines; their frequencies are those of the
    forces along x, y and z of all bearings together.
    """
    histories = solved.histories
    spectra = {
        name: solved.record.spectrum(np.ascontiguousarray(force.T), max(limit, solved.trusted_limit))
        for name, force in histories.forces_on_housing.items()
    }
    if not spectra:
        return MotionLines(np.zeros(0), {}, _EXACT)
    spacing = next(iter(spectra.values())).spacing
    if solved.record.sampling.window == "uniform":
        lines = _lines_of(spectra, _EXACT * spacing)
    else:
        lines = tones_of(spectra, histories.bearing_axes)
    return lines.between(np.finfo(float).tiny, limit).at_time_zero(solved.record_start)


def tones_of(spectra: Mapping[str, Spectrum], axes: Mapping[str, tuple[int, ...]]) -> MotionLines:
    """Tones of the bearings' forces under Hann's window.

    Parameters
    ----------
    spectra : mapping of str to Spectrum
        Spectra of each bearing's forces and moments, shape (d, m).
    axes : mapping of str to tuple of int
        Axis of each of them: 0 to 2 for forces, 3 and 4 for moments. Other connectors on the housing have none; they
        have the tones of the bearings.
    """
    first = next(iter(spectra.values()))
    together = Spectrum(
        first.frequencies,
        np.concatenate([spectrum.amplitude for spectrum in spectra.values()]),
        np.concatenate([spectrum.phase for spectrum in spectra.values()]),
        first.window,
    )
    weights: list[float] = []
    for name, spectrum in spectra.items():
        weights += [float(axis < _FORCES) for axis in axes[name]] if name in axes else [0.0] * len(spectrum.amplitude)
    tones = hann_tones(together, weights)
    ends = np.cumsum([len(spectrum.amplitude) for spectrum in spectra.values()])[:-1]
    parts = np.split(tones.amplitudes, ends)
    forces = {name: np.asarray(part.T) for name, part in zip(spectra, parts, strict=True)}
    return MotionLines(tones.frequencies, forces, _FOUND * first.spacing)


def _lines_of(spectra: Mapping[str, Spectrum], tolerance: float) -> MotionLines:
    """Lines of a record of whole periods."""
    if not spectra:
        return MotionLines(np.zeros(0), {}, tolerance)
    forces = {name: np.asarray(spectrum.lines[:, 1:].T) for name, spectrum in spectra.items()}
    return MotionLines(next(iter(spectra.values())).frequencies[1:], forces, tolerance)


def strongest_lines(acoustics: Acoustics, solved: SolvedTransient) -> tuple[FloatArray, FloatArray, list[LineName]]:
    """Return the strongest lines of a motion at steady speed on a base at rest.

    Returns
    -------
    frequencies : ndarray, shape (l,)
        Frequencies [Hz].
    rates : ndarray, shape (l, n, 2)
        Real and imaginary parts of the rates of the housing's coordinates.
    names : list of LineName
    """
    limit = acoustics.highest_frequency or solved.trusted_limit
    motion = lines_of_run(solved, limit).between(AUDIBLE, limit)
    if solved.machine.housing is None or not len(motion.frequencies):
        return np.zeros(0), np.zeros((0, 0, 2)), []
    rates = motion.rates(motion.paths(solved.machine)).sum(axis=1)
    # The surface is not known here: a body of a square metre stands for it.
    efficiency = pulsating_efficiency(motion.frequencies, 1.0, acoustics.speed_of_sound)
    estimate = (np.abs(rates) ** 2).sum(axis=1) * efficiency
    chosen = np.sort(np.argsort(-estimate, kind="stable")[: acoustics.lines])
    names = line_names(solved.machine, motion.frequencies[chosen].tolist(), motion.tolerance)
    return motion.frequencies[chosen], np.stack([rates[chosen].real, rates[chosen].imag], axis=-1), names


def pulsating_efficiency(frequencies: FloatArray, area: float, speed_of_sound: float) -> FloatArray:
    """Radiation efficiency (k a)² / (1 + (k a)²) of a pulsating sphere of an area [m²], an estimate for any body.

    F. Fahy and P. Gardonio, Sound and Structural Vibration, 2nd ed., Academic Press, 2007, section 3.2.
    """
    squared = (_TWO_PI * frequencies / speed_of_sound) ** 2 * area / (4.0 * np.pi)
    return np.asarray(squared / (1.0 + squared))


def loud_lines(frequencies: FloatArray, estimate: FloatArray, limit: float, most: int) -> npt.NDArray[np.intp]:
    """Return the numbers of the lines up to a limit [Hz] with most power by an estimate, `most` of them, ascending."""
    low = np.flatnonzero(frequencies <= limit * (1.0 + 1e-9))
    strongest = low[np.argsort(-estimate[low], kind="stable")[:most]]
    return np.sort(strongest[estimate[strongest] > _FAINT * estimate[low].max(initial=0.0)])


def left_out_lines(
    machine: CoupledMachine,
    motion: MotionLines,
    estimate: FloatArray,
    chosen: npt.NDArray[np.intp],
    limit: float,
    complete_below: float,
) -> tuple[LeftOut, ...]:
    """Return the strongest lines that are not solved, and the low harmonics of each mesh above the limit [Hz]."""
    shares = estimate / max(float(estimate.sum()), np.finfo(float).tiny)
    rest = np.setdiff1d(np.arange(len(shares)), chosen)
    rest = rest[np.argsort(-shares[rest], kind="stable")][:_NAMED]
    rest = rest[shares[rest] >= _WORTH_NAMING]
    names = line_names(machine, motion.frequencies[rest].tolist(), motion.tolerance, None)
    left_out = [
        LeftOut(name.name, float(motion.frequencies[number]), float(shares[number]))
        for name, number in zip(names, rest.tolist(), strict=True)
    ]
    turning_hz = abs(machine.speeds[machine.leading_rotor]) / _TWO_PI
    for line in excitation_lines(machine, shaft_orders=(), mesh_harmonics=_HARMONICS):
        hertz = line.order * turning_hz
        if hertz <= limit * (1.0 + 1e-9) or any(
            abs(line.frequency_hz - hertz) <= motion.tolerance for line in left_out
        ):
            continue
        at_line = np.abs(motion.frequencies - hertz) <= motion.tolerance
        left_out.append(
            LeftOut(line.name, hertz, float(shares[at_line].sum()) if hertz <= complete_below * (1.0 + 1e-9) else None)
        )
    return tuple(left_out)
