"""Analyses of a machine, from a case or from Python: each result with its documents, arrays, figures and warnings."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.analyses.result import Result
from gearwhine.analyses.run_solution import RunSolution
from gearwhine.case import Case
from gearwhine.coupling import CoupledMachine, CouplingError, Machine, coupled_modes
from gearwhine.coupling import stability as coupled_stability
from gearwhine.coupling.analyses.gear_pairs import PairAnalysis, analyse_machine, default_aims, solve_over_torques
from gearwhine.coupling.analyses.loaded_machine import LoadedMachine, load_machine, point_of_flanks
from gearwhine.coupling.analyses.modes_and_responses import (
    MESH_HARMONICS,
    SolvedSystem,
    machine_warnings,
    solve_system,
    unstable_modes_warnings,
)
from gearwhine.coupling.analyses.motion import MachineMotion, solve_motion
from gearwhine.coupling.analyses.motion_warnings import beyond_limit_warnings, parted_flank_warnings, settling_warnings
from gearwhine.coupling.analyses.operation_warnings import (
    bearing_load_warnings,
    constant_speed_warnings,
    unbalanced_torque_warnings,
)
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.analyses.run_up import (
    OrderTracking,
    run_signature_warnings,
)
from gearwhine.coupling.analyses.shafts_alone import solve_shafts
from gearwhine.coupling.analyses.steady_state import SolvedSteady, solve_steady
from gearwhine.coupling.analyses.transient import (
    mean_bearing_forces,
)
from gearwhine.coupling.description.excitation import Run
from gearwhine.coupling.errors import AcousticsError
from gearwhine.coupling.gears.loaded.optimal_relief import ReliefAim
from gearwhine.coupling.load_analysis.load_warnings import find_load, load_warnings, sensitivity_warnings
from gearwhine.coupling.load_analysis.ranking import rank_parts
from gearwhine.coupling.load_analysis.solved_load import SolvedLoad, solve_load
from gearwhine.coupling.statics.mean_mesh import mean_contact
from gearwhine.mode_pictures import draw_sound_pictures
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.output.dataset import Labels, labelled, labels_of
from gearwhine.output.quantity import add_warnings, joined
from gearwhine.results.gears import GEARS, gears_document
from gearwhine.results.housing import HOUSING, origin_document
from gearwhine.results.operating_point import LOAD, LOAD_OPTIONS, LOAD_SAME, load_document, load_part
from gearwhine.results.rotors import ROTORS, rotors_document
from gearwhine.results.run import (
    run_signature_document,
    transient_document,
)
from gearwhine.results.sensor_line_estimates import add_mechanisms, add_uncertainty
from gearwhine.results.sound import SOUND, sound_document
from gearwhine.results.steady_state import STEADY, STEADY_OPTIONS, STEADY_SAME, steady_document
from gearwhine.results.system import SYSTEM, SYSTEM_OPTIONS, SYSTEM_SAME, system_document
from gearwhine.rotors.analyses.solved_rotor import SolvedRotor
from gearwhine.rotors.rolling_bearings.speed_factor import centrifugal_warnings
from gearwhine.solve.damping import damping_document, damping_warnings
from gearwhine.solve.gear_bodies import gear_body_document

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearwhine.coupling.sound.acoustics import Acoustics
    from gearwhine.coupling.sound.solution import SolvedSound
    from gearwhine.figures.rotors.assembly import RotorAssembly
    from gearwhine.housing.modes.housing_field import HousingField
    from gearwhine.solve.housing_modes import SolvedHousing


@dataclass(frozen=True)
class MachineUnderLoad:
    """A machine assembled about its operating point, with what its results say beside their own numbers.

    Attributes
    ----------
    title : str
    loaded : LoadedMachine
    load : SolvedLoad or None
        Its operating point; None where nothing loads it, or none is found.
    warnings : sequence of dict
        Warnings of the operating point.
    case : Case or None
        The case that describes it; None where Python does.
    housing : SolvedHousing or None
        The solved housing of the case.
    """

    title: str
    loaded: LoadedMachine
    load: SolvedLoad | None
    warnings: Sequence[ResultWarning]
    case: Case | None = None
    housing: SolvedHousing | None = None

    @property
    def coupled(self) -> CoupledMachine:
        """The coupled system and its parts."""
        return self.loaded.coupled

    @property
    def labels(self) -> Labels:
        """Labels of its files."""
        return Labels(self.title, self.coupled.speed) if self.case is None else labels_of(self.case)

    def add_to(self, document: dict[str, Any], progress: Progress) -> None:
        """Add the operating point, its warnings and the errors of the modal basis to a document of the machine."""
        progress("comparing with another modal basis")
        add_uncertainty(document, self.loaded.basis_error, document["trusted_below_hz"])
        progress("mechanisms of the lines, and their bands by damping")
        add_mechanisms(document, self.loaded.mechanisms)
        self.add_parts_to(document)

    def add_parts_to(self, document: dict[str, Any]) -> None:
        """Add the damping, the bodies of the gears, the operating point and its warnings to a document."""
        if self.case is not None:
            document["damping"] = damping_document(self.case)
            add_warnings(document, damping_warnings(self.case))
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


def machine_under_load(
    machine: Machine, title: str = "", run: Run | None = None, progress: Progress = silent
) -> MachineUnderLoad:
    """Find the operating point of a machine where something loads it, and assemble the machine about that.

    Raises
    ------
    gearwhine.coupling.CouplingError, gearwhine.coupling.EquilibriumNotFoundError
        Where the loads drive a motion that nothing holds, or no equilibrium is found.
    """
    load, warnings = find_load(machine, progress) if machine.is_loaded else (None, [])
    loaded = load_machine(machine, None if load is None else load.point, run, progress)
    return MachineUnderLoad(title, loaded, load, warnings)


def rotors(
    machine: Machine,
    title: str = "",
    *,
    speeds: Sequence[float] = (),
    progress: Progress = silent,
    **settings: Any,
) -> Result[tuple[SolvedRotor, ...]]:
    """Find modes, whirl, critical speeds and responses of each shaft of a machine, alone on rigid seats.

    The parameters are those of :func:`gearwhine.coupling.analyses.shafts_alone.solve_shafts`.
    """
    solved = solve_shafts(machine, speeds, progress, **settings)

    def assemblies() -> list[RotorAssembly]:
        from gearwhine.figures.rotors import shaft_assembly

        return [shaft_assembly(machine, one.rotor.name, one.bearings) for one in solved]

    return solved_rotors(solved, Labels(title, machine.speed), assemblies)


def solved_rotors(
    solved: tuple[SolvedRotor, ...], labels: Labels, assemblies: Callable[[], Sequence[RotorAssembly]]
) -> Result[tuple[SolvedRotor, ...]]:
    """Return the result of solved rotors; ``assemblies`` says how they are drawn."""
    document = rotors_document(solved)
    for rotor in solved:
        fast = [(name, state.bearing, rotor.operation or 0.0) for name, state in rotor.rolling.items()]
        loads = {name: max(float(row.outer_load.max()) for row in state.rows) for name, state in rotor.rolling.items()}
        add_warnings(document, centrifugal_warnings(fast, loads))

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_rotors

        return draw_rotors(solved, assemblies(), progress)

    return Result(
        "rotors",
        None,
        solved,
        document,
        _arrays=lambda: labelled(labels, (ROTORS, solved)),
        _figures=figures,
        _title=labels.title,
    )


def gears(
    machine: Machine, title: str = "", *, aims: Sequence[ReliefAim] = (), progress: Progress = silent
) -> Result[tuple[PairAnalysis, ...]]:
    """Analyse each gear pair of a machine: mesh stiffness, transmission error, load sharing, pressure, best tip relief.

    Parameters
    ----------
    machine : Machine
    title : str
    aims : sequence of ReliefAim, optional
        Objective of the best relief of each pair; by default those of
        :func:`gearwhine.coupling.analyses.gear_pairs.default_aims`.
    progress : callable

    Raises
    ------
    gearwhine.coupling.CouplingError, gearwhine.coupling.gears.GearError
        Where the machine has no gear pairs, there are more or fewer aims than pairs, or a pair cannot be solved.
    """
    if not machine.gear_pairs:
        raise CouplingError("gears: expected a machine with a gear pair")
    require_aims(aims, len(machine.gear_pairs))
    point = point_of_flanks(machine, progress)
    analysed = analyse_machine(machine, point, progress)
    chosen = aims or default_aims(machine, point, [pair.solved for pair in analysed], progress)
    analysed = tuple(replace(pair, aim_given=bool(aims)) for pair in analysed)
    seats = None if point is None or machine.housing is None else "housing"
    return analysed_gears(solve_over_torques(analysed, progress, chosen), Labels(title, machine.speed), seats)


def require_aims(aims: Sequence[ReliefAim], pairs: int) -> None:
    """Refuse more or fewer aims than pairs; none are the default.

    Raises
    ------
    gearwhine.coupling.CouplingError
    """
    if aims and len(aims) != pairs:
        raise CouplingError(f"gears: expected an aim for each of the {pairs} gear pairs, got {len(aims)}")


def analysed_gears(
    pairs: tuple[PairAnalysis, ...], labels: Labels, seats: str | None
) -> Result[tuple[PairAnalysis, ...]]:
    """Return the result of analysed gear pairs; ``seats`` says what holds the bearings where misalignment is found."""
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

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_gear_pairs

        return draw_gear_pairs(pairs, progress)

    return Result(
        "gears",
        None,
        pairs,
        document,
        _arrays=lambda: labelled(labels, (GEARS, pairs)),
        _figures=figures,
        _title=labels.title,
    )


def operating_point(
    machine: Machine,
    title: str = "",
    *,
    over_torque: bool = False,
    sensitivity: bool = False,
    line: str | None = None,
    acoustics: Acoustics | None = None,
    run: Run | None = None,
    progress: Progress = silent,
) -> Result[SolvedLoad]:
    """Find the static equilibrium of a machine: bearing loads, deflections, misalignment and load of the gear faces.

    ``sensitivity`` or a ``line`` rank its bearings and the faces of its housing; the parameters are those of
    :func:`gearwhine.coupling.load_analysis.solved_load.solve_load` and
    :func:`gearwhine.coupling.load_analysis.ranking.solve_load_sensitivity`.
    """
    solved = solve_load(machine, progress, over_torque=over_torque, over_hunting_period=True)
    warnings = load_warnings(solved)
    if sensitivity or line is not None:
        ranking = rank_parts(machine, solved.point, acoustics=acoustics, run=run, line=line, progress=progress)
        solved, warnings = replace(solved, sensitivity=ranking), [*warnings, *sensitivity_warnings(ranking)]
    document = load_document(title, solved)
    add_warnings(document, warnings)

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_load

        return draw_load(solved)

    return Result(
        "load",
        None,
        solved,
        document,
        _arrays=lambda: labelled(Labels(title, machine.speed), (LOAD, solved)),
        _figures=figures,
        _options=(LOAD_OPTIONS, LOAD_SAME),
        _title=title,
    )


def system(
    machine: MachineUnderLoad,
    *,
    mesh_phase: float | None = None,
    over_speed: Sequence[float] = (),
    sidebands: int = 0,
    mesh_harmonics: int = MESH_HARMONICS,
    progress: Progress = silent,
) -> Result[SolvedSystem]:
    """Find the complex natural modes of a coupled machine, and what reaches bearings and sensors.

    The parameters are those of :func:`gearwhine.coupling.analyses.modes_and_responses.solve_system`.
    """
    solved = solve_system(
        machine.coupled,
        progress,
        mesh_phase=mesh_phase,
        over_speed=over_speed,
        sidebands=sidebands,
        mesh_harmonics=mesh_harmonics,
    )
    document = system_document(solved, machine.housing)
    add_warnings(document, unstable_modes_warnings(solved.stability))
    machine.add_to(document, progress)

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_system

        yield from draw_system(solved)
        yield from machine.figures()

    return Result(
        "system",
        machine.case,
        solved,
        joined(document, origin_document(machine.housing)),
        _arrays=lambda: labelled(machine.labels, (HOUSING, machine.housing), (LOAD, machine.load), (SYSTEM, solved)),
        _figures=figures,
        _housing=machine.housing,
        _options=(SYSTEM_OPTIONS, SYSTEM_SAME),
        _title=machine.title,
    )


def steady(
    machine: MachineUnderLoad,
    *,
    over_speed: tuple[float, float] | None = None,
    points: int = 100,
    exact: bool = False,
    change: Callable[[SolvedSteady], SolvedSteady] = lambda solved: solved,
    progress: Progress = silent,
) -> Result[SolvedSteady]:
    """Find the periodic motion of a machine at its speed, its stability, and its branch over speed.

    ``change`` adds what is known beside the solution; the other parameters are those of
    :func:`gearwhine.coupling.analyses.steady_state.solve_steady`.
    """
    solved = change(solve_steady(machine.coupled, progress, over_speed=over_speed, points=points, exact=exact))
    document = steady_document(machine.title, solved)
    add_warnings(document, [*constant_speed_warnings(machine.loaded.machine), *machine_warnings(machine.coupled)])
    add_warnings(document, parted_flank_warnings(machine.coupled, solved.contact_loss))
    machine.add_to(document, progress)

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_steady

        yield from draw_steady(machine.title, solved)
        yield from machine.figures()

    return Result(
        "steady",
        machine.case,
        solved,
        joined(document, origin_document(machine.housing)),
        _arrays=lambda: labelled(machine.labels, (HOUSING, machine.housing), (LOAD, machine.load), (STEADY, solved)),
        _figures=figures,
        _housing=machine.housing,
        _options=(STEADY_OPTIONS, STEADY_SAME),
        _title=machine.title,
    )


def add_motion(
    document: dict[str, Any], machine: LoadedMachine, motion: MachineMotion, known: Sequence[ResultWarning]
) -> dict[str, Any]:
    """Return a document with a motion's numbers, warnings and error estimates; ``known`` are warnings of the load."""
    transient, signature, along = motion.transient, motion.signature, motion.run_signature
    document = joined(document, transient_document(transient, signature, along))
    forces = mean_bearing_forces(transient)
    add_warnings(document, bearing_load_warnings(machine.machine.bearings, forces, known=known))
    add_warnings(document, beyond_limit_warnings(transient))
    add_warnings(document, parted_flank_warnings(transient.machine, transient.result.contact_loss))
    if signature is not None:
        add_warnings(document, settling_warnings(transient, signature))
    add_uncertainty(document, machine.basis_error, transient.trusted_limit)
    add_mechanisms(document, machine.mechanisms, transient.line_tolerance_hz)
    add_warnings(document, run_signature_warnings(transient, motion.tracking))
    add_warnings(document, unbalanced_torque_warnings(machine.machine, machine.run))
    if along is not None:
        document["run_signature"] = run_signature_document(along)
    return document


def modes_of_run(machine: MachineUnderLoad, progress: Progress = silent) -> tuple[SolvedSystem, dict[str, Any]]:
    """Find the modes and responses of a machine, and the part of a run's document that they are."""
    progress("comparing with another modal basis")
    basis, mechanisms = machine.loaded.basis_error, machine.loaded.mechanisms
    solved = solve_system(machine.coupled, progress)
    document: dict[str, Any] = {"system": system_document(solved, machine.housing)}
    add_warnings(document, unstable_modes_warnings(solved.stability))
    add_uncertainty(document["system"], basis, document["system"]["trusted_below_hz"])
    add_mechanisms(document["system"], mechanisms)
    machine.add_parts_to(document)
    return solved, document


def run(
    described: Machine,
    machine: MachineUnderLoad,
    rotors: tuple[SolvedRotor, ...],
    plan: TransientPlan | None = None,
    tracking: OrderTracking | None = None,
    progress: Progress = silent,
) -> Result[RunSolution]:
    """Find everything of a machine: gears, operating point, modes and responses, and its motion, beside its rotors.

    ``machine`` is the described one under load, assembled for the run of ``plan``; without a plan there is no motion.
    """
    start = time.perf_counter()
    point = None if machine.load is None else machine.load.point
    pairs = analyse_machine(described, point, progress, pairs=machine.loaded.pairs)
    document = {"title": machine.title} | rotors_document(rotors)
    if pairs:
        document = joined(document, gears_document(pairs))
    system, of_system = modes_of_run(machine, progress)
    document, motion = joined(document, of_system), None
    if plan is not None:
        motion = solve_motion(machine.loaded, plan, tracking or OrderTracking(), system.modes, progress)
        document = add_motion(document, machine.loaded, motion, machine.warnings)
    document["seconds"] = {"total": time.perf_counter() - start}
    solved = RunSolution(rotors, pairs, system=system, load=machine.load).with_motion(motion)
    return Result(
        "run",
        None,
        solved,
        document,
        _arrays=lambda: solved.arrays(machine.labels),
        _figures=partial(solved.figures, machine.title),
        _title=machine.title,
    )


def simulate(
    machine: MachineUnderLoad,
    plan: TransientPlan,
    tracking: OrderTracking | None = None,
    progress: Progress = silent,
) -> Result[RunSolution]:
    """Integrate the motion of a machine that is assembled for the run of a plan."""
    system = machine.coupled.system
    modes = coupled_modes(system, mean_contact(system))
    motion = solve_motion(machine.loaded, plan, tracking or OrderTracking(), modes, progress)
    document = add_motion({"title": machine.title}, machine.loaded, motion, machine.warnings)
    add_warnings(document, [*machine.warnings, *unstable_modes_warnings(coupled_stability(modes))])
    if machine.load is not None:
        document["load"] = load_part(machine.load)
    solved = RunSolution(housing=machine.housing, load=machine.load).with_motion(motion)
    return Result(
        "simulate",
        machine.case,
        solved,
        document,
        _arrays=lambda: solved.arrays(machine.labels),
        _figures=partial(solved.figures, machine.title),
        _housing=machine.housing,
        _title=machine.title,
    )


@dataclass(frozen=True)
class RadiatingHousing:
    """A housing whose sound is sought, with what the results say beside their own numbers.

    Attributes
    ----------
    field : HousingField
    acoustics : Acoustics
    labels : Labels
        Labels of the files.
    up : sequence of float
        Unit vector that points upwards in pictures.
    case : Case or None
        The case that describes it; None where Python does.
    solved : SolvedHousing or None
        The solved housing of the case.
    """

    field: HousingField
    acoustics: Acoustics
    labels: Labels
    up: Sequence[float]
    case: Case | None = None
    solved: SolvedHousing | None = None


def radiating_housing(machine: Machine, acoustics: Acoustics, title: str = "") -> RadiatingHousing:
    """Return the housing of a machine of Python, checked for its sound.

    Raises
    ------
    gearwhine.coupling.errors.AcousticsError
        Where the machine has no housing with a mesh, or the acoustics do not fit it.
    """
    from gearwhine.coupling.sound.acoustics_checks import require_acoustics

    component = machine.housing_component
    field = None if component is None else component.displacement_field
    if field is None:
        has = "no housing" if component is None else "a reduced housing, of motions at its seats and sensors alone"
        raise AcousticsError(
            "the sound of a machine: expected a housing with its mesh and the mode shapes on it, as "
            f"gearwhine.Housing.modes() gives; the machine has {has}"
        )
    require_acoustics(acoustics, field.mesh, field.widest_bore, acoustics.limit_hz(field))
    weight = np.zeros(3) if machine.gravity is None else np.array(machine.gravity)
    up = -weight / np.linalg.norm(weight) if weight.any() else np.array([0.0, 1.0, 0.0])
    return RadiatingHousing(field, acoustics, Labels(title, machine.speed), tuple(up.tolist()))


def sound(
    housing: RadiatingHousing,
    machine: MachineUnderLoad | None,
    warnings: Sequence[ResultWarning] = (),
    progress: Progress = silent,
) -> Result[SolvedSound]:
    """Find the sound that a housing radiates: of its modes, and of the lines of the steady motion of a machine in it.

    Parameters
    ----------
    housing : RadiatingHousing
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
    from gearwhine.coupling.sound.solution import solve_sound

    field, acoustics, coupled, motion = housing.field, housing.acoustics, None, None
    if machine is not None:
        coupled = machine.coupled
        motion = lines_of_steady(solve_steady(coupled, progress), acoustics.estimated_below_hz(field))
        warnings = [*warnings, *machine.warnings]
    solved = solve_sound(acoustics, field, motion, coupled, progress)
    title = housing.labels.title
    document = {"title": title} | sound_document(solved)
    add_warnings(document, [*solved.warnings(), *warnings])

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_sound

        progress("drawing the sound")
        yield from draw_sound(title, solved)

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        return {"warnings": draw_sound_pictures(solved, place, progress, housing.up)} if pictures else {}

    return Result(
        "sound",
        housing.case,
        solved,
        joined(document, {} if housing.solved is None else origin_document(housing.solved)),
        _arrays=lambda: labelled(housing.labels, (HOUSING, housing.solved), (SOUND, solved)),
        _figures=figures,
        _files=files,
        _housing=housing.solved,
        _title=title,
    )
