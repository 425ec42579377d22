"""Sound of a machine: radiation efficiency of the housing's modes, and the sound of the lines of a motion.

The bearings' forces move the housing at each line (:mod:`gearwhine.coupling.sound.motion_lines`);
:func:`gearwhine.coupling.signals.transfer_paths.housing_paths` gives the motion by each bearing, exactly, and
:class:`gearwhine.housing.acoustics.radiation.HousingRadiation` its sound.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from gearwhine.coupling import CoupledMachine
from gearwhine.coupling.analyses.transient import SolvedTransient
from gearwhine.coupling.errors import AcousticsError
from gearwhine.coupling.linear.line_mechanisms import MECHANISMS, LineMechanisms
from gearwhine.coupling.signals.line_names import line_names
from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.coupling.sound.acoustics_checks import (
    acoustics_warnings,
    microphone_findings,
    radiating_faces,
    surface_findings,
    unwrapped,
)
from gearwhine.coupling.sound.microphones import MicrophoneHistories, microphone_histories
from gearwhine.coupling.sound.motion_lines import (
    AUDIBLE,
    LeftOut,
    MotionLines,
    left_out_lines,
    loud_lines,
    pulsating_efficiency,
)
from gearwhine.coupling.sound.proofs import (
    gathered,
    interior_pressure,
    known_source,
    known_source_at,
    microphone_doubts,
    power_balance_db,
    require_proofs,
)
from gearwhine.housing import HousingError
from gearwhine.housing.acoustics.known_source import SourceError
from gearwhine.housing.acoustics.modal_radiation import ModalRadiation
from gearwhine.housing.acoustics.radiation import COUNTS, HousingRadiation, RadiatedSound, counting
from gearwhine.housing.acoustics.sound_levels import (
    BOX_MICROPHONES,
    a_weighting,
    power_level,
    pressure_level,
    sum_of_levels,
    third_octave_bands,
)
from gearwhine.housing.modes.housing_field import HousingField
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.findings import refuse
from gearwhine.numerics.progress import Progress, in_order, silent
from gearwhine.numerics.result_warnings import ResultWarning, warning

Span = Callable[[HousingRadiation, FloatArray, tuple[float, float], Progress], HousingRadiation]

_TWO_PI = 2.0 * np.pi
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
        Frequency over the speed of the first driver's rotor.
    sound : RadiatedSound
    microphones : ndarray of complex, shape (n_microphones,)
        Sound pressure [Pa].
    microphone_errors : ndarray or None, shape (n_microphones,)
        Error of known sources there, see :func:`gearwhine.coupling.sound.proofs.known_source_at`.
    mechanism_powers : dict of str to float
        Equivalent radiated power of the motion by each mechanism alone [W], linear about the mean load, see
        :mod:`gearwhine.coupling.linear.line_mechanisms`.
    """

    frequency_hz: float
    name: str
    order: float
    sound: RadiatedSound
    microphones: ComplexArray
    microphone_errors: FloatArray | None = None
    mechanism_powers: dict[str, float] = field(default_factory=dict)

    @property
    def level_db(self) -> float:
        """Sound power level re 1 pW [dB]."""
        return float(power_level(self.sound.power))

    @property
    def level_db_a(self) -> float:
        """A-weighted sound power level [dB(A)]."""
        return self.level_db + float(a_weighting(self.frequency_hz))

    @cached_property
    def equivalent_db(self) -> float:
        """Level of the equivalent radiated power [dB], an estimate."""
        return float(power_level(self.sound.equivalent_power))

    @property
    def power_balance_db(self) -> float | None:
        """Proof, see :func:`gearwhine.coupling.sound.proofs.power_balance_db`."""
        return power_balance_db(self.sound)

    @property
    def interior_pressure(self) -> float | None:
        """Proof, see :func:`gearwhine.coupling.sound.proofs.interior_pressure`."""
        return interior_pressure(self.sound)

    @property
    def known_source(self) -> SourceError | None:
        """Proof, see :func:`gearwhine.coupling.sound.proofs.known_source`."""
        return known_source(self.sound)


@dataclass(frozen=True)
class ModeSound:
    """Sound of one housing mode at its natural frequency.

    Attributes
    ----------
    number : int
        Number of the mode, from 1.
    frequency_hz : float
    radiation_efficiency : float
        Radiation efficiency σ.
    face_shares : dict of str to float
        Power through each face relative to the sound power, the largest first.
    power_balance_db, interior_pressure : float or None
        Proofs, see :func:`power_balance_db` and :func:`interior_pressure`.
    known_source : SourceError or None
        Proof, see :func:`known_source`.
    """

    number: int
    frequency_hz: float
    radiation_efficiency: float
    face_shares: dict[str, float]
    power_balance_db: float | None = None
    interior_pressure: float | None = None
    known_source: SourceError | None = None


@dataclass(frozen=True)
class SoundOfModes:
    """Sound of a housing's modes, each at its natural frequency; it depends on the housing and the air alone.

    Attributes
    ----------
    modes : tuple of ModeSound
    warnings : tuple of dict
        Warnings of doubtful solutions.
    """

    modes: tuple[ModeSound, ...] = ()
    warnings: tuple[ResultWarning, ...] = ()


@dataclass(frozen=True)
class SolvedSound:
    """Sound of a housing: of its modes, and of the lines of a motion.

    Attributes
    ----------
    radiation : HousingRadiation
    of_modes : SoundOfModes
    lines : tuple of SoundLine
        Ascending in frequency; empty without a motion.
    mode_frequencies : ndarray, shape (n_modes,)
        Natural frequencies of the housing's modes [Hz].
    bearings : tuple of str
        Bearings, in the order of the motions of each line's sound.
    covered : float
        Part of all lines' power that these lines hold, by the equivalent power times a pulsating sphere's efficiency.
    left_out : tuple of LeftOut
        Strongest lines that are not solved, and low mesh harmonics above `limit_hz`.
    microphones : dict of str to ndarray, shape (3,)
        Positions [m].
    box_area : float or None
        Area of the measurement surface of ISO 3744 that the last `BOX_MICROPHONES` stand on [m²].
    limit_hz : float
        Highest frequency of the sound [Hz].
    told : tuple of dict
        Warnings of the acoustics and of doubtful solutions of lines.
    histories : MicrophoneHistories or None
        Sound pressure over time at the microphones.
    """

    radiation: HousingRadiation
    of_modes: SoundOfModes
    lines: tuple[SoundLine, ...]
    mode_frequencies: FloatArray
    bearings: tuple[str, ...]
    covered: float
    microphones: dict[str, FloatArray]
    box_area: float | None
    limit_hz: float
    left_out: tuple[LeftOut, ...] = ()
    told: tuple[ResultWarning, ...] = ()
    histories: MicrophoneHistories | None = None

    @property
    def modes(self) -> tuple[ModeSound, ...]:
        """Sound of the housing's modes."""
        return self.of_modes.modes

    @property
    def places(self) -> FloatArray:
        """Positions of the microphones [m], shape (n_microphones, 3)."""
        return np.array(list(self.microphones.values())).reshape(-1, 3)

    @property
    def total_db(self) -> float:
        """Sound power level of all lines [dB]."""
        return sum_of_levels(line.level_db for line in self.lines)

    @property
    def total_db_a(self) -> float:
        """A-weighted sound power level of all lines [dB(A)]."""
        return sum_of_levels(line.level_db_a for line in self.lines)

    @cached_property
    def bands(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Nominal frequencies of third octaves [Hz] and their sound power levels [dB] and [dB(A)].

        Each line is weighted at its own frequency, so that the bands sum to `total_db_a`.
        """
        frequencies = np.array([line.frequency_hz for line in self.lines])
        powers = np.array([line.sound.power for line in self.lines])
        nominal, sums = third_octave_bands(frequencies, powers)
        _, weighted = third_octave_bands(frequencies, powers * 10.0 ** (0.1 * a_weighting(frequencies)))
        return nominal, power_level(sums), power_level(weighted)

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
    def box_microphones(self) -> tuple[str, ...]:
        """Names of the microphones on the measurement surface of ISO 3744; empty without one."""
        return () if self.box_area is None else tuple(self.microphones)[-BOX_MICROPHONES:]

    @property
    def box_level_db(self) -> float | None:
        """Sound power level by the mean pressure on the box of microphones [dB], ISO 3744:2010, equation 6."""
        if self.box_area is None or not self.lines:
            return None
        levels = self.microphone_levels()
        total = sum_of_levels(levels[name] for name in self.box_microphones)
        return float(total + 10.0 * np.log10(self.box_area / BOX_MICROPHONES))

    @property
    def by_face(self) -> dict[str, float]:
        """Power of all lines through each face [W], the largest first."""
        total: dict[str, float] = {}
        for line in self.lines:
            for face, power in line.sound.by_face.items():
                total[face] = total.get(face, 0.0) + power
        return dict(sorted(total.items(), key=lambda entry: -entry[1]))

    @property
    def power_balance_db(self) -> float | None:
        """Power balance of the line or mode where it is worst, of those that count [dB]; None of an estimate."""
        balances = [sound.power_balance_db for sound in self._counted if sound.power_balance_db is not None]
        return max(balances, key=abs, default=None)

    @property
    def interior_pressure(self) -> float | None:
        """Pressure inside, of the line or mode where it is largest, of those that count; None without an inside."""
        pressures = [sound.interior_pressure for sound in self._counted if sound.interior_pressure is not None]
        return max(pressures, default=None)

    @property
    def known_source(self) -> SourceError | None:
        """Error of known sources, of the line or mode where it is largest, of those that count; None without one."""
        errors = [sound.known_source for sound in self._counted if sound.known_source is not None]
        return max(errors, key=lambda error: error.largest, default=None)

    @property
    def microphone_errors(self) -> dict[str, float]:
        """Error of known sources at each microphone, the largest of all lines and of the sound over time.

        Empty where there is no such proof.
        """
        errors = [line.microphone_errors for line in self.lines if line.microphone_errors is not None]
        if self.histories is not None and self.radiation.method == "boundary-elements":
            errors.append(self.histories.source_errors)
        largest = np.max(errors, axis=0).tolist() if errors else []
        return {
            name: error for name, error in zip(self.microphones, largest, strict=bool(errors)) if np.isfinite(error)
        }

    @property
    def _counted(self) -> "list[SoundLine | ModeSound]":
        counted = {id(sound) for sound in counting([line.sound for line in self.lines])}
        lines = [line for line in self.lines if id(line.sound) in counted]
        return [*lines, *(mode for mode in self.modes if mode.radiation_efficiency > COUNTS)]

    def warnings(self) -> list[ResultWarning]:
        """Warnings of solutions that are doubtful."""
        entries = [*self.of_modes.warnings, *self.told]
        if self.histories is not None and self.histories.error > _ROUGH:
            entries.append(
                warning(
                    "microphone_interpolation",
                    f"sound pressure over time is doubtful: the transfer to the microphones is interpolated over "
                    f"frequency with an error of {100.0 * self.histories.error:.2g} %",
                    relative=self.histories.error,
                )
            )
        return gathered([*entries, *self._microphone_doubts()])

    def _microphone_doubts(self) -> list[ResultWarning]:
        """Warnings of microphones at which known sources are off, of lines that count and of the sound over time."""
        counted = {id(sound) for sound in counting([line.sound for line in self.lines])}
        entries: list[ResultWarning] = []
        for line in self.lines:
            if line.microphone_errors is not None and id(line.sound) in counted:
                errors = dict(zip(self.microphones, line.microphone_errors.tolist(), strict=True))
                entries += microphone_doubts(line.frequency_hz, errors)
        if self.histories is not None and self.radiation.method == "boundary-elements":
            errors = dict(zip(self.microphones, self.histories.source_errors.tolist(), strict=True))
            entries += microphone_doubts(self.histories.source_frequency_hz, errors)
        return entries


def build_radiation(acoustics: Acoustics, housing: HousingField, progress: Progress = silent) -> HousingRadiation:
    """Make the radiating surface of a housing, with its modes and residual modes.

    Raises
    ------
    AcousticsError
        Where the housing cannot be wrapped as the acoustics say, its triangles are too large or too many, or a face is
        not there or not flat.
    """
    refuse(surface_findings(acoustics, housing.mesh), AcousticsError)
    if acoustics.method == "rayleigh":
        progress("the flat faces that radiate")
        faces = radiating_faces(acoustics, housing.mesh)
        return HousingRadiation.of_faces(housing.mesh, housing.shapes, faces, medium=acoustics.medium)
    limit = acoustics.limit_hz(housing)
    edge = acoustics.edge(limit)
    work = f"wrapping the housing in triangles of {1e3 * edge:.3g} mm"
    progress(work)
    try:
        return HousingRadiation.of_surface(
            housing.mesh,
            housing.shapes,
            edge=edge,
            close_holes=acoustics.closed_holes(edge, housing.widest_bore),
            resting_caps=acoustics.caps == "rest",
            method=acoustics.method,
            medium=acoustics.medium,
            floor=acoustics.floor_plane,
            still=acoustics.still,
            natural_modes=len(housing.modes.shapes),
            highest_frequency=limit,
            progress=lambda step, fraction=None: progress(f"{work}: {step}", fraction),
        )
    except HousingError as error:
        refuse([unwrapped(acoustics, edge, error)], AcousticsError)
        raise


def _mode_frequencies(housing: HousingField, limit_hz: float) -> list[float]:
    """Natural frequencies up to a limit of the modes that are no motion as a rigid body [Hz]."""
    return [hz for hz in housing.modes.frequencies_hz.tolist() if 1.0 < hz <= limit_hz]


def sound_of_modes(
    radiation: HousingRadiation, housing: HousingField, limit_hz: float, progress: Progress = silent
) -> SoundOfModes:
    """Solve for the sound of a housing's modes up to a frequency, each at its natural frequency.

    Raises
    ------
    gearwhine.housing.HousingError
        As :func:`solve_sound`.
    """

    def of_mode(number: int) -> tuple[ModeSound, RadiatedSound]:
        rates = np.zeros((radiation.modal[0].shape[1], 1))
        rates[number] = 1.0
        hertz = float(housing.modes.frequencies_hz[number])
        sound = radiation.solve(hertz, rates)
        power = sound.power
        shares = {face: part / power for face, part in sound.by_face.items()} if power > 0.0 else {}
        proofs = power_balance_db(sound), interior_pressure(sound), known_source(sound)
        return ModeSound(number + 1, hertz, sound.radiation_efficiency, shares, *proofs), sound

    sounding = _mode_frequencies(housing, limit_hz)
    numbers = [n for n, hz in enumerate(housing.modes.frequencies_hz.tolist()) if hz in sounding]
    modes, warnings = [], []
    for mode, sound in in_order(of_mode, numbers, "sound of the housing's modes", progress):
        modes.append(mode)
        warnings += require_proofs([sound], f"housing mode {mode.number}", alone=True)
    return SoundOfModes(tuple(modes), tuple(warnings))


def solve_sound(
    acoustics: Acoustics,
    housing: HousingField,
    motion: MotionLines | None = None,
    machine: CoupledMachine | None = None,
    progress: Progress = silent,
    *,
    of_modes: SoundOfModes | None = None,
    span: Span = HousingRadiation.spanned,
) -> SolvedSound:
    """Solve for the sound of a housing's modes and of the lines of a motion that matter.

    Parameters
    ----------
    acoustics : Acoustics
    housing : HousingField
    motion : MotionLines, optional
        Lines of the machine's motion, up to :meth:`Acoustics.estimated_below_hz` so that lines left out can be
        reported.
    machine : CoupledMachine, optional
        Machine that moves.
    progress : callable
    of_modes : SoundOfModes, optional
        Sound of the housing's modes where that is solved already.
    span : callable
        :meth:`gearwhine.housing.acoustics.radiation.HousingRadiation.spanned`, or what keeps its solutions.

    Raises
    ------
    AcousticsError
        Where the radiating surface cannot be made, or a microphone is inside it or under the floor.
    gearwhine.housing.HousingError
        Where a solution fails its proofs, see
        :meth:`gearwhine.housing.acoustics.radiation.RadiatedSound.require_proofs`.
    """
    radiation = build_radiation(acoustics, housing, progress)
    limit = acoustics.limit_hz(housing)
    positions, area = acoustics.microphones(housing.mesh.bounds)
    # Before the work; all of them.
    refuse(microphone_findings(acoustics, positions, radiation.require_in_air), AcousticsError)
    warnings = acoustics_warnings(acoustics, housing.mesh.bounds, housing.complete_below_hz)
    if motion is not None:
        motion = motion.between(AUDIBLE, np.inf)
    moves = motion is not None and machine is not None and len(motion.frequencies) > 0
    wanted = [] if of_modes is not None else _mode_frequencies(housing, limit)
    if motion is not None and machine is not None and moves:
        paths = motion.paths(machine)
        rates = motion.rates(paths)
        estimate = radiation.equivalent_power(rates.sum(axis=1).T) * pulsating_efficiency(
            motion.frequencies, radiation.area, radiation.medium.speed_of_sound
        )
        chosen = loud_lines(motion.frequencies, estimate, limit, acoustics.lines)
        wanted = [*wanted, *motion.frequencies[chosen].tolist()]
    radiation = span(radiation, np.array(wanted), (AUDIBLE, limit), progress)
    if of_modes is None:
        of_modes = sound_of_modes(radiation, housing, limit, progress)
    solved = SolvedSound(
        radiation, of_modes, (), housing.modes.frequencies_hz, (), 0.0, positions, area, limit, told=tuple(warnings)
    )
    if motion is None or machine is None or not moves:
        return solved

    names = line_names(machine, motion.frequencies[chosen].tolist(), motion.tolerance, None)
    mechanisms = LineMechanisms(machine)

    def of_line(place: int) -> SoundLine:
        number, hertz = chosen[place], float(motion.frequencies[chosen[place]])
        sound = radiation.solve(hertz, rates[number].T)
        _ = sound.resistance  # the far field's integral, on this thread beside that of another line
        heard = sound.pressure_at(solved.places) if positions else np.zeros(0, dtype=np.complex128)
        powers = _mechanism_powers(mechanisms, radiation, _TWO_PI * hertz, _TWO_PI * motion.tolerance)
        return SoundLine(
            hertz, names[place].name, names[place].order, sound, heard, known_source_at(sound, solved.places), powers
        )

    lines = in_order(of_line, range(len(chosen)), "sound of the lines", progress)
    warnings += require_proofs([line.sound for line in lines])
    total = float(estimate.sum())
    return replace(
        solved,
        lines=lines,
        bearings=paths.bearings,
        covered=float(estimate[chosen].sum()) / total if total > 0.0 else 0.0,
        left_out=left_out_lines(machine, motion, estimate, chosen, limit, acoustics.estimated_below_hz(housing)),
        told=tuple(warnings),
    )


def _mechanism_powers(
    mechanisms: LineMechanisms, radiation: HousingRadiation, frequency: float, within: float
) -> dict[str, float]:
    """Equivalent radiated power of the housing's motion by each mechanism at a line [rad/s], by name [W]."""
    housing = mechanisms.machine.housing
    assert housing is not None
    rows = mechanisms.machine.rows(housing.name, np.eye(housing.size))
    powers: dict[str, float] = {}
    for at, motions in mechanisms.motions(frequency, within):
        rates = 1j * at * rows @ np.stack([*motions.values()], axis=1)
        for name, power in zip(motions, radiation.equivalent_power(rates).tolist(), strict=True):
            powers[name] = powers.get(name, 0.0) + power
    return {name: powers[name] for name in MECHANISMS if name in powers}


def with_histories(solved: SolvedSound, transient: SolvedTransient, transfer: ModalRadiation) -> SolvedSound:
    """Add the sound pressure over time at the microphones, of the record of a transient at once.

    Parameters
    ----------
    solved : SolvedSound
        Sound with microphones.
    transient : SolvedTransient
        Motion of the machine on a base at rest; the last stretch of a long record is taken.
    transfer : ModalRadiation
        Radiation with the microphones as its points, from `AUDIBLE` up to the sound's limit.
    """
    histories = transient.histories
    repeats = transient.speed_profile is None and transient.record.sampling.window == "uniform"
    heard = microphone_histories(
        transient.machine, transfer, histories.times, histories.forces_on_housing, repeats=repeats
    )
    return replace(solved, histories=heard)
