"""Results of analyses of a machine, of a case or of Python: what each says of its solution, draws and writes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from gearwhine.analyses.origin import Origin
from gearwhine.analyses.result import Result
from gearwhine.analyses.run_solution import RunSolution
from gearwhine.coupling import CoupledMachine, CouplingError, Machine
from gearwhine.coupling import stability as coupled_stability
from gearwhine.coupling.analyses.condition_record import bearing_tones, condition_record
from gearwhine.coupling.analyses.gear_condition import MachineCondition, machine_condition
from gearwhine.coupling.analyses.gear_pairs import PairAnalysis, solve_over_torques
from gearwhine.coupling.analyses.loaded_machine import LoadedMachine
from gearwhine.coupling.analyses.modes_and_responses import (
    SolvedSystem,
    machine_warnings,
    solve_system,
    unstable_modes_warnings,
)
from gearwhine.coupling.analyses.motion import MachineMotion
from gearwhine.coupling.analyses.motion_warnings import beyond_limit_warnings, parted_flank_warnings, settling_warnings
from gearwhine.coupling.analyses.operation_warnings import (
    bearing_load_warnings,
    constant_speed_warnings,
    unbalanced_torque_warnings,
)
from gearwhine.coupling.analyses.run_up import run_signature_warnings
from gearwhine.coupling.analyses.shafts_alone import planet_warnings
from gearwhine.coupling.analyses.steady_state import SolvedSteady, solve_steady
from gearwhine.coupling.analyses.transient import mean_bearing_forces
from gearwhine.coupling.errors import AcousticsError
from gearwhine.coupling.gears.loaded.optimal_relief import ReliefAim
from gearwhine.coupling.linear.complex_modes import CoupledModes
from gearwhine.coupling.linear.sensor_level import SensorLevel
from gearwhine.coupling.load_analysis.load_warnings import load_warnings, sensitivity_warnings
from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
from gearwhine.housing import HousingModes
from gearwhine.mode_pictures import draw_load_pictures, draw_sound_pictures
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.output.quantity import add_warnings, joined
from gearwhine.results.condition import condition_document
from gearwhine.results.gears import GEARS, gears_document
from gearwhine.results.housing import origin_document
from gearwhine.results.operating_point import LOAD, LOAD_OPTIONS, LOAD_SAME, load_document, load_part
from gearwhine.results.rotors import ROTORS, rotors_document
from gearwhine.results.run import run_signature_document, transient_document
from gearwhine.results.sensor_line_estimates import add_mechanisms, add_uncertainty
from gearwhine.results.sound import SOUND, sound_document
from gearwhine.results.steady_state import STEADY, STEADY_OPTIONS, STEADY_SAME, steady_document
from gearwhine.results.system import SYSTEM, SYSTEM_OPTIONS, SYSTEM_SAME, system_document
from gearwhine.rotors.analyses.solved_rotor import SolvedRotor
from gearwhine.rotors.rolling_bearings.speed_factor import centrifugal_warnings
from gearwhine.solve.damping import damping_document, damping_warnings, part_dampings
from gearwhine.solve.gear_bodies import gear_body_document
from gearwhine.view_names import GearPart

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearwhine.coupling.sound.acoustics import Acoustics
    from gearwhine.coupling.sound.solution import SolvedSound
    from gearwhine.figures.rotors.assembly import RotorAssembly


@dataclass(frozen=True)
class MachineUnderLoad:
    """A machine assembled about its operating point, with what its results say beside their own numbers.

    Attributes
    ----------
    origin : Origin
    loaded : LoadedMachine
    load : SolvedLoad or None
        Its operating point; None where nothing loads it, or none is found.
    warnings : sequence of dict
        Warnings of the operating point.
    """

    origin: Origin
    loaded: LoadedMachine
    load: SolvedLoad | None
    warnings: Sequence[ResultWarning]

    @property
    def coupled(self) -> CoupledMachine:
        """The coupled system and its parts."""
        return self.loaded.coupled

    def add_to(self, document: dict[str, Any], progress: Progress) -> None:
        """Add the operating point, its warnings and the errors of the modal basis to a document of the machine."""
        progress("comparing with another modal basis")
        add_uncertainty(document, self.loaded.basis_error, document["trusted_below_hz"])
        progress("mechanisms of the lines, and their bands by damping")
        add_mechanisms(document, self.loaded.bands)
        self.add_parts_to(document)

    def add_parts_to(self, document: dict[str, Any]) -> None:
        """Add the damping, the bodies of the gears, the operating point and its warnings to a document."""
        if self.origin.case is not None:
            dampings = part_dampings(self.origin.case)
            document["damping"] = damping_document(dampings)
            add_warnings(document, damping_warnings(dampings))
        if bodies := gear_body_document(self.loaded.machine):
            document["gear_bodies"] = bodies
        if self.load is not None:
            document["load"] = load_part(self.load)
        add_warnings(document, self.warnings)

    def figures(self) -> Iterator[tuple[str, Figure]]:
        """Draw the operating point."""
        from gearwhine.figures import draw_load

        if self.load is not None:
            yield from draw_load(self.load)


def rotors_result(
    solved: tuple[SolvedRotor, ...],
    origin: Origin,
    assemblies: Callable[[], Sequence[RotorAssembly]],
    carriers: Mapping[str, str],
) -> Result[tuple[SolvedRotor, ...]]:
    """Return the result of solved rotors; ``assemblies`` says how they are drawn, ``carriers`` has that of planets."""
    document = rotors_document(solved)
    add_warnings(document, planet_warnings(carriers))
    for rotor in solved:
        fast = [(name, state.bearing, rotor.operation or 0.0) for name, state in rotor.rolling.items()]
        loads = {name: max(float(row.outer_load.max()) for row in state.rows) for name, state in rotor.rolling.items()}
        add_warnings(document, centrifugal_warnings(fast, loads))

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_rotors

        return draw_rotors(solved, assemblies(), progress)

    return origin.result("rotors", solved, document, (ROTORS, solved), figures=figures)


def require_aims(aims: Sequence[ReliefAim], pairs: int) -> None:
    """Refuse more or fewer aims than pairs; none are the default.

    Raises
    ------
    gearwhine.coupling.CouplingError
    """
    if aims and len(aims) != pairs:
        raise CouplingError(f"gears: expected an aim for each of the {pairs} gear pairs, got {len(aims)}")


def require_parts(without: Sequence[str], aims: Sequence[ReliefAim]) -> None:
    """Refuse to leave out what is no part of the analysis of gear pairs, or a relief whose aim is given.

    Raises
    ------
    gearwhine.coupling.CouplingError
    """
    known = get_args(GearPart)
    if unknown := [name for name in without if name not in known]:
        raise CouplingError(f"gears: without {unknown[0]!r}; expected any of {', '.join(map(repr, known))}")
    if aims and "relief" in without:
        raise CouplingError("gears: expected aims of the best tip relief, or to be without it, got both")


def gears_result(
    pairs: tuple[PairAnalysis, ...],
    aims: Sequence[ReliefAim],
    without: Sequence[str],
    origin: Origin,
    seats: str | None,
    progress: Progress = silent,
) -> Result[tuple[PairAnalysis, ...]]:
    """Return the result of gear pairs that are analysed under their mean torque, and over torque here.

    Parameters
    ----------
    pairs : tuple of PairAnalysis
    aims : sequence of ReliefAim
        Objective of the best relief of each pair.
    without : sequence of {"harris-map", "relief"}
        Parts that are left out.
    origin : Origin
    seats : str or None
        What holds the bearings where misalignment is found.
    progress : callable
    """
    parts = {"harris_map": "harris-map" not in without, "relief": "relief" not in without}
    pairs = solve_over_torques(pairs, progress, aims, **parts)
    document = gears_document(pairs)
    if seats is not None:
        for pair in document["pairs"]:
            pair["misalignment_seats"] = seats
    if seats == "rigid":
        message = (
            "the misalignment is that of bearings in rigid seats, as this folder has no modes of the housing, and "
            "so is the best tip relief; run, load or modes before gears give it those of the housing"
        )
        add_warnings(document, [warning("rigid seats", message)])
    # All pairs aim at the sensors of one machine.
    levels = [pair.aim for pair in pairs if isinstance(pair.aim, SensorLevel)]
    add_warnings(document, levels[0].warnings if levels else ())

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_gear_pairs

        return draw_gear_pairs(pairs, progress)

    return origin.result("gears", pairs, document, (GEARS, pairs), figures=figures)


def load_result(solved: SolvedLoad, origin: Origin, progress: Progress = silent) -> Result[SolvedLoad]:
    """Return the result of an operating point: bearing loads, deflections, misalignment and load of the gear faces."""
    document = load_document(origin.title, solved)
    add_warnings(document, load_warnings(solved))
    if solved.sensitivity is not None:
        add_warnings(document, sensitivity_warnings(solved.sensitivity))

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_load

        return draw_load(solved)

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        if not pictures or origin.housing is None:
            return {}
        return {"warnings": draw_load_pictures(origin.housing, solved, place, progress)}

    options = (LOAD_OPTIONS, LOAD_SAME)
    return origin.result("load", solved, document, (LOAD, solved), figures=figures, files=files, options=options)


def system_result(machine: MachineUnderLoad, solved: SolvedSystem, progress: Progress = silent) -> Result[SolvedSystem]:
    """Return the result of the modes and responses of a coupled machine, with its operating point."""
    document = system_document(solved, machine.origin.housing)
    add_warnings(document, solved.warnings)
    machine.add_to(document, progress)

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_system

        yield from draw_system(solved)
        yield from machine.figures()

    arrays = (LOAD, machine.load), (SYSTEM, solved)
    options = (SYSTEM_OPTIONS, SYSTEM_SAME)
    return machine.origin.result("system", solved, document, *arrays, figures=figures, options=options)


def steady_result(machine: MachineUnderLoad, solved: SolvedSteady, progress: Progress = silent) -> Result[SolvedSteady]:
    """Return the result of a periodic motion of a machine, with its operating point."""
    title = machine.origin.title
    document = steady_document(title, solved)
    add_warnings(document, [*constant_speed_warnings(machine.loaded.machine), *machine_warnings(machine.coupled)])
    add_warnings(document, parted_flank_warnings(machine.coupled, solved.contact_loss))
    machine.add_to(document, progress)

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_steady

        yield from draw_steady(title, solved)
        yield from machine.figures()

    arrays = (LOAD, machine.load), (STEADY, solved)
    options = (STEADY_OPTIONS, STEADY_SAME)
    return machine.origin.result("steady", solved, document, *arrays, figures=figures, options=options)


def condition_of(machine: MachineUnderLoad, motion: MachineMotion) -> MachineCondition | None:
    """Return the condition indicators of a machine where a part of it is damaged or its plan asks for them."""
    described = machine.loaded.machine
    damaged = any(one.gear.faults for one in described.gears) or any(one.spalls for one in described.bearings)
    if not (motion.transient.plan.indicators or damaged) or not motion.transient.sensor_spectra:
        return None
    return machine_condition(condition_record(motion.transient, bearing_tones(described)))


def motion_document(
    machine: MachineUnderLoad, motion: MachineMotion, condition: MachineCondition | None
) -> dict[str, Any]:
    """Return the document of a motion over time: its numbers, warnings and error estimates."""
    transient, signature, along, loaded = motion.transient, motion.signature, motion.run_signature, machine.loaded
    document = transient_document(transient, signature, along)
    forces = mean_bearing_forces(transient)
    add_warnings(document, bearing_load_warnings(loaded.machine.bearings, forces, known=machine.warnings))
    add_warnings(document, beyond_limit_warnings(transient))
    add_warnings(document, parted_flank_warnings(transient.machine, transient.result.contact_loss))
    if signature is not None:
        add_warnings(document, settling_warnings(transient, signature))
    add_uncertainty(document, loaded.basis_error, transient.trusted_limit)
    add_mechanisms(document, loaded.bands, transient.line_tolerance_hz)
    add_warnings(document, run_signature_warnings(transient, motion.tracking))
    add_warnings(document, unbalanced_torque_warnings(loaded.machine, loaded.run))
    if along is not None:
        document["run_signature"] = run_signature_document(along)
    if condition is not None:
        document["condition"] = condition_document(condition)
    return document


def modes_of_run(machine: MachineUnderLoad, progress: Progress = silent) -> tuple[SolvedSystem, dict[str, Any]]:
    """Find the modes and responses of a machine, and the part of a run's document that they are."""
    progress("comparing with another modal basis")
    basis = machine.loaded.basis_error
    solved = solve_system(machine.coupled, progress)
    document: dict[str, Any] = {"system": system_document(solved, machine.origin.housing)}
    add_warnings(document, solved.warnings)
    add_uncertainty(document["system"], basis, document["system"]["trusted_below_hz"])
    add_mechanisms(document["system"], machine.loaded.bands)
    machine.add_parts_to(document)
    return solved, document


def motion_result(machine: MachineUnderLoad, motion: MachineMotion, modes: CoupledModes) -> Result[RunSolution]:
    """Return the result of a motion over time; ``modes`` are those of the machine, whose instability is told."""
    condition = condition_of(machine, motion)
    document = joined({"title": machine.origin.title}, motion_document(machine, motion, condition))
    add_warnings(document, [*unstable_modes_warnings(coupled_stability(modes)), *modes.warnings])
    machine.add_parts_to(document)
    document = joined(document, origin_document(machine.origin.housing))
    tones = bearing_tones(machine.loaded.machine)
    solved = RunSolution(housing=machine.origin.housing, load=machine.load).with_motion(motion, condition, tones)
    return solved.result("simulate", machine.origin, document)


def radiating_housing(machine: Machine, acoustics: Acoustics) -> HousingModes:
    """Return the housing of a machine, checked for its sound.

    Raises
    ------
    gearwhine.coupling.errors.AcousticsError
        Where the machine has no housing with a mesh, or the acoustics do not fit it.
    """
    from gearwhine.coupling.sound.acoustics_checks import require_acoustics

    housing = machine.housing
    if not isinstance(housing, HousingModes):
        has = "no housing" if housing is None else "a reduced housing, of motions at its seats and sensors alone"
        raise AcousticsError(
            "the sound of a machine: expected a housing with its mesh and the mode shapes on it, as "
            f"gearwhine.Housing.modes() gives; the machine has {has}"
        )
    field = housing.displacement_field
    require_acoustics(acoustics, field.mesh, field.widest_bore, acoustics.limit_hz(field))
    return housing


def sound_result(
    housing: HousingModes,
    acoustics: Acoustics,
    origin: Origin,
    machine: MachineUnderLoad | None,
    warnings: Sequence[ResultWarning] = (),
    progress: Progress = silent,
) -> Result[SolvedSound]:
    """Find the sound that a housing radiates: of its modes, and of the lines of the steady motion of a machine in it.

    Parameters
    ----------
    housing : HousingModes
    acoustics : Acoustics
    origin : Origin
    machine : MachineUnderLoad or None
        None where the sound is that of the modes alone.
    warnings : sequence of dict
        Warnings beside those of the sound and of the operating point.
    progress : callable

    Raises
    ------
    gearwhine.coupling.errors.AcousticsError
        Where the housing cannot be wrapped, or a microphone is inside it or under the floor.
    gearwhine.coupling.PeriodicError
        Where no periodic motion is found.
    gearwhine.housing.HousingError
        Where a solution fails its proofs.
    """
    # The acoustics' kernels are for this analysis alone.
    from gearwhine.coupling.sound.motion_lines import lines_of_steady
    from gearwhine.solve.kept_radiation import sound_of_housing

    field, coupled, motion = housing.displacement_field, None, None
    if machine is not None:
        coupled = machine.coupled
        steady = solve_steady(coupled, progress)
        motion = lines_of_steady(steady, acoustics.estimated_below_hz(field))
        warnings = [*warnings, *machine.warnings, *steady.superposition_warnings()]
    solved, housing = sound_of_housing(acoustics, housing, motion, coupled, progress)
    title = origin.title
    document = {"title": title} | sound_document(solved)
    add_warnings(document, [*solved.warnings(), *warnings])

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_sound

        progress("drawing the sound")
        yield from draw_sound(title, solved)

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        return {"warnings": draw_sound_pictures(solved, place, progress, housing.up)} if pictures else {}

    origin = replace(origin, housing=housing)
    return origin.result("sound", solved, document, (SOUND, solved), figures=figures, files=files)
