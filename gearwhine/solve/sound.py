"""Sound of a case: radiation efficiency of the housing's modes, and the sound of the lines of a motion.

The bearings' forces move the housing at each line; :func:`coupling.signals.transfer_paths.housing_paths` gives the
motion by each bearing, exactly, and :class:`housing.acoustics.radiation.HousingRadiation` its sound.
"""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from coupling import CoupledMachine, amplitude_spectrum
from coupling.signals.excitation import line_names
from coupling.signals.transfer_paths import housing_paths
from gearwhine.case import Case, CaseError, Problem
from gearwhine.output.quantity import warning
from gearwhine.progress import Progress, silent
from gearwhine.solve.housing_modes import SolvedHousing
from gearwhine.solve.microphones import MicrophoneHistories, microphone_histories, solve_transfer
from gearwhine.solve.signature import SolvedSignature
from gearwhine.solve.steady_state import SolvedSteady
from gearwhine.solve.transient import SolvedTransient
from housing import HousingError
from housing.acoustics.medium import HardPlane, Medium
from housing.acoustics.radiation import HousingRadiation, RadiatedSound, require_balances
from housing.acoustics.sound_levels import (
    a_weighting,
    measurement_box,
    power_level,
    pressure_level,
    sum_of_levels,
    third_octave_bands,
)
from housing.errors import TriangleSizeError
from housing.fem.surface import flat_faces
from meshes.elements import pick_facets

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_TWO_PI = 2.0 * np.pi
_WORKERS = 2
_FAINT = 1e-6  # part of the largest line's estimated power below which a line is left out

AUDIBLE = 20.0
"""Lowest frequency of a sound [Hz]."""

_HOLES = 1.1  # of the widest seat, that are closed by default
_ROUGH = 0.06  # relative error of an interpolation, half a decibel


@dataclass(frozen=True)
class SoundLine:
    """Sound of one spectral line.

    Attributes
    ----------
    frequency_hz : float
    name : str
        Name of the line, such as ``2x mesh``.
    order : float
        Over the speed of the first driver's rotor.
    sound : RadiatedSound
    microphones : ndarray of complex, shape (n_microphones,)
        Sound pressure [Pa].
    """

    frequency_hz: float
    name: str
    order: float
    sound: RadiatedSound
    microphones: ComplexArray

    @property
    def level_db(self) -> float:
        """Sound power level re 1 pW [dB]."""
        return float(power_level(self.sound.power))

    @property
    def level_db_a(self) -> float:
        """A-weighted [dB(A)]."""
        return self.level_db + float(a_weighting(self.frequency_hz))

    @cached_property
    def equivalent_db(self) -> float:
        """Level of the equivalent radiated power [dB], an estimate."""
        sound = self.sound
        return float(power_level(sound.medium.impedance * sound.area * sound.mean_square_velocity))


@dataclass(frozen=True)
class ModeSound:
    """Sound of one housing mode at its natural frequency.

    Attributes
    ----------
    number : int
        From 1.
    frequency_hz : float
    radiation_efficiency : float
        σ.
    by_face : dict of str to float
        Part of each face in the power.
    """

    number: int
    frequency_hz: float
    radiation_efficiency: float
    by_face: dict[str, float]


@dataclass(frozen=True)
class SolvedSound:
    """Sound of a case.

    Attributes
    ----------
    radiation : HousingRadiation
    modes : tuple of ModeSound
    lines : tuple of SoundLine
        Ascending in frequency; empty without a motion.
    mode_frequencies : ndarray, shape (n_modes,)
        Natural frequencies of the housing's modes [Hz].
    bearings : tuple of str
        That the motions of each line's sound stand for.
    covered : float
        Part of all lines' power that these lines hold, by the equivalent power times a pulsating sphere's efficiency.
    microphones : dict of str to ndarray, shape (3,)
        Positions [m].
    box_area : float or None
        Of the measurement surface of ISO 3744 that the last nine microphones stand on [m²].
    limit_hz : float
        Highest frequency of the sound.
    histories : MicrophoneHistories or None
        Sound pressure over time at the microphones.
    """

    radiation: HousingRadiation
    modes: tuple[ModeSound, ...]
    lines: tuple[SoundLine, ...]
    mode_frequencies: FloatArray
    bearings: tuple[str, ...]
    covered: float
    microphones: dict[str, FloatArray]
    box_area: float | None
    limit_hz: float
    histories: MicrophoneHistories | None = None

    @property
    def total_db(self) -> float:
        """Sound power level of all lines [dB]."""
        return sum_of_levels(line.level_db for line in self.lines)

    @property
    def total_db_a(self) -> float:
        """A-weighted sound power level of all lines [dB(A)]."""
        return sum_of_levels(line.level_db_a for line in self.lines)

    @cached_property
    def bands(self) -> tuple[FloatArray, FloatArray]:
        """Nominal frequencies of third octaves [Hz] and their sound power levels [dB]."""
        nominal, powers = third_octave_bands(
            np.array([line.frequency_hz for line in self.lines]), np.array([line.sound.power for line in self.lines])
        )
        return nominal, power_level(powers)

    def microphone_levels(self, *, weighted: bool = False) -> dict[str, float]:
        """Sound pressure level of all lines at each microphone [dB], or A-weighted [dB(A)]."""
        return {
            name: sum_of_levels(
                float(pressure_level(line.microphones[place]))
                + (float(a_weighting(line.frequency_hz)) if weighted else 0.0)
                for line in self.lines
            )
            for place, name in enumerate(self.microphones)
        }

    @property
    def box_level_db(self) -> float | None:
        """Sound power level by the mean pressure on the box of microphones [dB], ISO 3744:2010, equation 6."""
        if self.box_area is None or not self.lines:
            return None
        levels = list(self.microphone_levels().values())[-9:]
        return float(sum_of_levels(levels) + 10.0 * np.log10(self.box_area / 9.0))

    @property
    def by_face(self) -> dict[str, float]:
        """Power of all lines through each face [W], the largest first."""
        total: dict[str, float] = {}
        for line in self.lines:
            for face, power in line.sound.by_face.items():
                total[face] = total.get(face, 0.0) + power
        return dict(sorted(total.items(), key=lambda entry: -entry[1]))

    def warnings(self) -> list[dict[str, Any]]:
        """Warnings of solutions that are doubtful."""
        found = []
        for line in self.lines:
            if line.sound.doubt is not None:
                leak = line.sound.interior_residual
                found.append(
                    warning(
                        "interior_pressure",
                        f"the sound at {line.frequency_hz:.1f} Hz is doubtful: {line.sound.doubt}",
                        frequency_hz=line.frequency_hz,
                        relative=leak if np.isfinite(leak) else None,
                    )
                )
        if self.histories is not None and self.histories.error > _ROUGH:
            found.append(
                warning(
                    "microphone_interpolation",
                    f"sound pressure over time is doubtful: the transfer to the microphones is interpolated over "
                    f"frequency with an error of {100.0 * self.histories.error:.2g} %",
                    relative=self.histories.error,
                )
            )
        return found


@dataclass(frozen=True)
class MotionLines:
    """Spectral lines of the forces of a machine's bearings.

    Attributes
    ----------
    frequencies : ndarray, shape (l,)
        [Hz], above 0.
    forces : mapping of str to ndarray of complex, shape (l, d)
        Of each bearing on the housing [N, N m].
    tolerance : float
        Half a spacing of lines, for their names [Hz].
    """

    frequencies: FloatArray
    forces: Mapping[str, ComplexArray]
    tolerance: float


def lines_of_steady(solved: SolvedSteady, limit: float) -> list[MotionLines]:
    """Lines of a periodic motion up to a limit [Hz], or of all motions that are superposed."""
    found = []
    for motion in solved.motions[: 1 if solved.superposed is None else None]:
        spectra = {
            name: amplitude_spectrum(np.ascontiguousarray(force.T), motion.response.period / len(force))
            for name, force in motion.histories.bearing_reaction.items()
        }
        frequencies = next(iter(spectra.values())).frequencies
        kept = (frequencies > 0.0) & (frequencies <= limit * (1.0 + 1e-9))
        forces = {name: spectrum.lines[:, kept].T for name, spectrum in spectra.items()}
        found.append(MotionLines(frequencies[kept], forces, 0.02 / motion.response.period))
    return found


def lines_of_run(signature: SolvedSignature, limit: float) -> list[MotionLines]:
    """Lines of a transient's record up to a limit [Hz]."""
    spectra = signature.bearing_spectra
    if not spectra:
        return []
    first = next(iter(spectra.values()))
    kept = (first.frequencies > 0.0) & (first.frequencies <= limit * (1.0 + 1e-9))
    forces = {name: spectrum.lines[:, kept].T for name, spectrum in spectra.items()}
    return [MotionLines(first.frequencies[kept], forces, (0.02 if first.window == "uniform" else 0.5) * first.spacing)]


def build_radiation(case: Case, housing: SolvedHousing, progress: Progress = silent) -> HousingRadiation:
    """Make the radiating surface of a case's housing, with its modes and residual modes.

    Raises
    ------
    CaseError
        Where the housing cannot be wrapped as the case says, its triangles are too large or too many, or a face is not
        there or not flat.
    """
    assert case.acoustics is not None
    given = case.acoustics
    shapes = housing.modes.shapes
    if housing.modes.residual_modes is not None:
        shapes = np.concatenate([shapes, housing.modes.residual_modes.shapes])
    medium = Medium(given.density, given.speed_of_sound)
    for key in ("still", "faces"):
        for place, name in enumerate(getattr(given, key)):
            if name not in housing.mesh.surfaces:
                known = ", ".join(housing.mesh.surfaces)
                raise CaseError([Problem(f"acoustics.{key}[{place}]", name, f"a surface of the housing ({known})")])
    if given.method == "rayleigh":
        progress("the flat faces that radiate")
        faces = {}
        for place, name in enumerate(given.faces):
            faces[name] = _flat_face(housing, name, place)
        return HousingRadiation.of_faces(housing.mesh, shapes, faces, medium=medium)
    limit = highest_frequency(case, housing)
    edge = given.mesh_size or given.speed_of_sound / (6.0 * limit)
    progress(f"wrapping the housing in triangles of {1e3 * edge:.3g} mm")
    seats = [seat.diameter for seat in case.housing.seat if seat.diameter] if case.housing is not None else []
    holes = given.close_holes or _HOLES * max(seats, default=edge)
    floor = None if given.floor is None else HardPlane(np.array([0.0, given.floor, 0.0]), np.array([0.0, 1.0, 0.0]))
    try:
        return HousingRadiation.of_surface(
            housing.mesh,
            shapes,
            edge=edge,
            close_holes=holes,
            method=given.method,
            medium=medium,
            floor=floor,
            still=given.still,
            natural_modes=len(housing.modes.shapes),
            highest_frequency=limit,
        )
    except TriangleSizeError as error:
        raise CaseError([Problem("acoustics.mesh_size", f"{1e3 * edge:.4g} mm", f"another edge; {error}")]) from error
    except HousingError as error:
        raise CaseError([Problem("acoustics", given.method, f"a housing that can be wrapped; {error}")]) from error


def _flat_face(housing: SolvedHousing, name: str, place: int) -> Any:
    surface = housing.mesh.surfaces[name]
    wanted = {tuple(sorted(nodes)) for block in surface for nodes in block.nodes.tolist()}
    for face in flat_faces(housing.mesh):
        own = [tuple(sorted(nodes)) for block in face.facets for nodes in block.nodes.tolist()]
        if wanted & set(own):
            chosen = np.array([nodes in wanted for nodes in own])
            if len(wanted) > chosen.sum():
                break
            return type(face)(pick_facets(face.facets, chosen), face.area, face.center, face.normal)
    raise CaseError([Problem(f"acoustics.faces[{place}]", name, "a flat surface, for Rayleigh's integral")])


def highest_frequency(case: Case, housing: SolvedHousing) -> float:
    """Return the highest frequency of a case's sound [Hz]: as given, else where the modes are complete."""
    assert case.acoustics is not None
    return case.acoustics.highest_frequency or housing.trusted_limit_hz


def microphones_of(case: Case, housing: SolvedHousing) -> tuple[dict[str, FloatArray], float | None]:
    """Positions of a case's microphones [m], and the area of the box that the last nine stand on [m²]."""
    assert case.acoustics is not None
    found = {one.name: np.array(one.position) for one in case.acoustics.microphone}
    if case.acoustics.microphone_box is None:
        return found, None
    low, high = housing.mesh.bounds
    positions, area = measurement_box(low, high, case.acoustics.microphone_box)
    return found | {f"box {number}": place for number, place in enumerate(positions, start=1)}, area


def solve_sound(
    case: Case,
    housing: SolvedHousing,
    motions: Sequence[MotionLines] = (),
    machine: CoupledMachine | None = None,
    progress: Progress = silent,
    *,
    of_modes: bool = True,
) -> SolvedSound:
    """Solve for the sound of a housing's modes and of the lines of a motion that matter.

    Parameters
    ----------
    case : Case
        With `[acoustics]`.
    housing : SolvedHousing
    motions : sequence of MotionLines
        Of the machine; superposed.
    machine : CoupledMachine, optional
        That moves.
    progress : callable
    of_modes : bool
        Whether the radiation efficiency of each mode is wanted, too.

    Raises
    ------
    CaseError
        Where the radiating surface cannot be made, or a microphone is inside it or under the floor.
    housing.HousingError
        Where a solution's powers through the surface and in the far field differ by more than 10 %.
    """
    assert case.acoustics is not None
    radiation = build_radiation(case, housing, progress)
    limit = highest_frequency(case, housing)
    positions, area = microphones_of(case, housing)
    places = np.array(list(positions.values())).reshape(-1, 3)
    _require_free(radiation, positions)

    def of_mode(number: int) -> ModeSound:
        rates = np.zeros((radiation.modal[0].shape[1], 1))
        rates[number] = 1.0
        hertz = float(housing.modes.frequencies_hz[number])
        sound = radiation.solve(hertz, rates)
        require_balances([sound], alone=True)
        power = sound.power
        shares = {face: part / power for face, part in sound.by_face.items()} if power > 0.0 else {}
        return ModeSound(number + 1, hertz, sound.radiation_efficiency, shares)

    numbers = [n for n, hz in enumerate(housing.modes.frequencies_hz) if 1.0 < hz <= limit] if of_modes else []
    modes = solved_in_order(of_mode, numbers, "sound of the housing's modes", progress)

    chosen: list[tuple[float, ComplexArray, float]] = []
    bearings: tuple[str, ...] = ()
    covered, total = 0.0, 0.0
    for motion in motions:
        assert machine is not None
        kept = (motion.frequencies >= AUDIBLE) & (motion.frequencies <= limit * (1.0 + 1e-9))
        frequencies = motion.frequencies[kept]
        forces = {name: force[kept] for name, force in motion.forces.items()}
        paths = housing_paths(machine, _TWO_PI * frequencies, forces)
        bearings = paths.bearings
        rates = paths.acceleration / (1j * _TWO_PI * frequencies[:, None, None])
        estimate = radiation.equivalent_power(rates.sum(axis=1).T) * pulsating_efficiency(
            frequencies, radiation.area, radiation.medium.speed_of_sound
        )
        total += float(estimate.sum())
        chosen += [(float(estimate[i]), rates[i].T, float(frequencies[i])) for i in range(len(frequencies))]
    chosen.sort(key=lambda one: -one[0])
    largest = chosen[0][0] if chosen else 0.0
    chosen = [one for one in chosen[: case.acoustics.lines] if one[0] > _FAINT * largest]
    covered = sum(one[0] for one in chosen) / total if total > 0.0 else 0.0
    chosen.sort(key=lambda one: one[2])
    tolerance = max((motion.tolerance for motion in motions), default=0.0)
    names = line_names(machine, [one[2] for one in chosen], tolerance, None) if machine is not None else []

    def of_line(place: int) -> SoundLine:
        _, rates, hertz = chosen[place]
        sound = radiation.solve(hertz, rates)
        heard = sound.pressure_at(places) if len(places) else np.zeros(0, dtype=np.complex128)
        return SoundLine(hertz, names[place].name, names[place].order, sound, heard)

    lines = solved_in_order(of_line, range(len(chosen)), "sound of the lines", progress)
    require_balances([line.sound for line in lines])
    return SolvedSound(radiation, modes, lines, housing.modes.frequencies_hz, bearings, covered, positions, area, limit)


def with_histories(solved: SolvedSound, transient: SolvedTransient, progress: Progress = silent) -> SolvedSound:
    """Add the sound pressure over time at the microphones, of the record of a transient at once.

    Parameters
    ----------
    solved : SolvedSound
        Without microphones it is returned as it is.
    transient : SolvedTransient
        Of a long record the last stretch is taken.
    """
    places = np.array(list(solved.microphones.values()))
    if not len(places):
        return solved
    transfer = solve_transfer(solved.radiation, places, AUDIBLE, solved.limit_hz, progress)
    histories = transient.histories
    repeats = transient.turning is None and transient.record.sampling.window == "uniform"
    heard = microphone_histories(
        transient.machine, transfer, histories.times, histories.bearing_reaction, repeats=repeats
    )
    return replace(solved, histories=heard)


def strongest_lines(case: Case, solved: SolvedTransient) -> tuple[FloatArray, FloatArray]:
    """Return the frequencies of a motion's strongest lines and the rates of the housing's coordinates there.

    Returns
    -------
    frequencies : ndarray, shape (l,)
        [Hz]
    rates : ndarray, shape (l, n, 2)
        Real and imaginary part.
    """
    assert case.acoustics is not None
    reactions = solved.histories.bearing_reaction
    if solved.machine.housing is None or not reactions:
        return np.zeros(0), np.zeros((0, 0, 2))
    spectra = {
        name: solved.record.spectrum(np.ascontiguousarray(force.T), solved.trusted_limit)
        for name, force in reactions.items()
    }
    lines = next(iter(spectra.values())).frequencies
    limit = case.acoustics.highest_frequency or solved.trusted_limit
    kept = (lines >= AUDIBLE) & (lines <= limit * (1.0 + 1e-9))
    forces = {name: one.lines[:, kept].T for name, one in spectra.items()}
    paths = housing_paths(solved.machine, _TWO_PI * lines[kept], forces)
    rates = paths.acceleration.sum(axis=1) / (1j * _TWO_PI * lines[kept, None])
    # The surface is not known here: a body of a square metre stands for it.
    estimate = (np.abs(rates) ** 2).sum(axis=1) * pulsating_efficiency(lines[kept], 1.0, case.acoustics.speed_of_sound)
    chosen = np.sort(np.argsort(-estimate, kind="stable")[: case.acoustics.lines])
    return lines[kept][chosen], np.stack([rates[chosen].real, rates[chosen].imag], axis=-1)


def pulsating_efficiency(frequencies: FloatArray, area: float, speed_of_sound: float) -> FloatArray:
    """Radiation efficiency (k a)² / (1 + (k a)²) of a pulsating sphere of an area [m²], an estimate for any body.

    F. Fahy and P. Gardonio, Sound and Structural Vibration, 2nd ed., Academic Press, 2007, section 3.2.
    """
    squared = (_TWO_PI * frequencies / speed_of_sound) ** 2 * area / (4.0 * np.pi)
    return np.asarray(squared / (1.0 + squared))


def solved_in_order(
    solve: Callable[[int], Any], numbers: Sequence[int], what: str, progress: Progress
) -> tuple[Any, ...]:
    """Solve one after the other on two threads, in their order, under the progress."""
    found = []
    with ThreadPoolExecutor(_WORKERS) as pool:
        for done, one in enumerate(pool.map(solve, numbers), start=1):
            found.append(one)
            progress(what, done / len(numbers))
    return tuple(found)


def _require_free(radiation: HousingRadiation, positions: Mapping[str, FloatArray]) -> None:
    """Refuse microphones inside or on the housing, or behind the plane, before the work."""
    for name, place in positions.items():
        try:
            radiation.require_in_air(place[None])
        except HousingError as error:
            raise CaseError(
                [Problem(f"acoustics.microphone {name!r}", place.tolist(), f"a point in the air; {error}")]
            ) from error
