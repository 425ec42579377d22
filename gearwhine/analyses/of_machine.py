"""Analyses of a machine, from a case or from Python: each result with its documents, arrays, figures and warnings."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.analyses.result import Result
from gearwhine.case import Case
from gearwhine.coupling import CoupledMachine, Machine, coupled_modes
from gearwhine.coupling import stability as coupled_stability
from gearwhine.coupling.analyses.loaded_machine import LoadedMachine, load_machine
from gearwhine.coupling.analyses.modes_and_responses import MESH_HARMONICS, SolvedSystem, solve_system
from gearwhine.coupling.analyses.recording import Blocks, TransientPlan
from gearwhine.coupling.analyses.run_up import (
    OrderTracking,
    RunSignature,
    run_signature_warnings,
    solve_run_signature,
)
from gearwhine.coupling.analyses.signature import SolvedSignature, solve_signature
from gearwhine.coupling.analyses.steady_state import SolvedSteady, solve_steady
from gearwhine.coupling.analyses.transient import (
    SolvedTransient,
    has_traced_lines,
    mean_bearing_forces,
    solve_transient,
)
from gearwhine.coupling.description.excitation import Run
from gearwhine.coupling.errors import AcousticsError
from gearwhine.coupling.linear.complex_modes import CoupledModes
from gearwhine.coupling.statics.mean_mesh import mean_contact
from gearwhine.mode_pictures import draw_sound_pictures
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning
from gearwhine.output.dataset import Labels, labelled, labels_of
from gearwhine.output.quantity import add_warnings, joined
from gearwhine.results.housing import HOUSING, origin_document
from gearwhine.results.operating_point import LOAD, LOAD_OPTIONS, LOAD_SAME, load_document, load_part
from gearwhine.results.run import (
    RUN_SIGNATURE,
    TRANSIENT,
    HistoryStream,
    TracedTransient,
    run_signature_document,
    transient_document,
)
from gearwhine.results.sound import SOUND, sound_document
from gearwhine.results.steady_state import STEADY, STEADY_OPTIONS, STEADY_SAME, steady_document
from gearwhine.results.system import SYSTEM, SYSTEM_OPTIONS, SYSTEM_SAME, system_document
from gearwhine.solve.damping import damping_document, damping_warnings
from gearwhine.solve.gear_bodies import gear_body_document
from gearwhine.solve.operating_point import SolvedLoad, load_warnings, solve_load
from gearwhine.solve.plausibility import (
    add_mechanisms,
    add_uncertainty,
    bearing_load_warnings,
    beyond_limit_warnings,
    constant_speed_warnings,
    machine_warnings,
    parted_flank_warnings,
    settling_warnings,
    unbalanced_torque_warnings,
    unstable_modes_warnings,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearwhine.coupling.sound.acoustics import Acoustics
    from gearwhine.coupling.sound.solution import SolvedSound
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
        if self.load is not None:
            document["load"] = load_part(self.load)
        add_warnings(document, self.warnings)
        progress("comparing with another modal basis")
        add_uncertainty(document, self.loaded.basis_error, document["trusted_below_hz"])
        progress("mechanisms of the lines, and their bands by damping")
        add_mechanisms(document, self.loaded.mechanisms)
        if self.case is not None:
            document["damping"] = damping_document(self.case)
            add_warnings(document, damping_warnings(self.case))
        if bodies := gear_body_document(self.loaded.machine):
            document["gear_bodies"] = bodies

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
    load = solve_load(machine, progress) if machine.is_loaded else None
    loaded = load_machine(machine, None if load is None else load.point, run, progress)
    return MachineUnderLoad(title, loaded, load, [] if load is None else load_warnings(load))


def operating_point(
    machine: Machine, title: str = "", *, over_torque: bool = False, progress: Progress = silent
) -> Result[SolvedLoad]:
    """Find the static equilibrium of a machine: bearing loads, deflections, misalignment and load of the gear faces.

    The parameters are those of :func:`gearwhine.solve.operating_point.solve_load`.
    """
    solved = solve_load(machine, progress, over_torque=over_torque, over_hunting_period=True)
    document = load_document(title, solved)
    add_warnings(document, load_warnings(solved))

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


@dataclass(frozen=True)
class MachineMotion:
    """Motion of a machine over time, and what is read off its record.

    Attributes
    ----------
    transient : SolvedTransient
    signature : SolvedSignature or None
        Lines of sensors and mesh forces by their origin; None along a run, and where the base moves.
    run_signature : RunSignature or None
        Spectra and orders along a run.
    tracking : OrderTracking
    """

    transient: SolvedTransient
    signature: SolvedSignature | None
    run_signature: RunSignature | None
    tracking: OrderTracking


def solve_motion(
    machine: LoadedMachine,
    plan: TransientPlan,
    tracking: OrderTracking,
    modes: CoupledModes,
    progress: Progress = silent,
    *,
    keep: Callable[[str], Blocks] | None = None,
) -> MachineMotion:
    """Integrate the motion of a machine, and trace the lines and the orders of its record.

    The parameters are those of :func:`gearwhine.coupling.analyses.transient.solve_transient`; ``modes`` are those of
    the coupled system, which lines are named after.
    """
    transient = solve_transient(machine.coupled, plan, progress, keep=keep)
    signature = None
    if has_traced_lines(machine.coupled):
        housing = machine.coupled.housing
        signature = solve_signature(transient, modes, None if housing is None else housing.frequencies_hz)
    return MachineMotion(transient, signature, solve_run_signature(transient, tracking), tracking)


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


def simulate(
    machine: MachineUnderLoad,
    plan: TransientPlan,
    tracking: OrderTracking | None = None,
    progress: Progress = silent,
) -> Result[MachineMotion]:
    """Integrate the motion of a machine that is assembled for the run of a plan."""
    system = machine.coupled.system
    modes = coupled_modes(system, mean_contact(system))
    motion = solve_motion(machine.loaded, plan, tracking or OrderTracking(), modes, progress)
    document = add_motion({"title": machine.title}, machine.loaded, motion, machine.warnings)
    add_warnings(document, [*machine.warnings, *unstable_modes_warnings(coupled_stability(modes))])
    if machine.load is not None:
        document["load"] = load_part(machine.load)
    transient = motion.transient

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_run, draw_transient

        progress("drawing the motion")
        yield from draw_transient(machine.title, transient, motion.signature, machine.housing, None)
        if motion.run_signature is not None:
            yield from draw_run(machine.title, transient, motion.run_signature)
        yield from machine.figures()

    return Result(
        "simulate",
        machine.case,
        motion,
        document,
        _arrays=partial(_motion_arrays, machine, motion),
        _figures=figures,
        _housing=machine.housing,
        _title=machine.title,
    )


def _motion_arrays(machine: MachineUnderLoad, motion: MachineMotion) -> Any:
    return labelled(
        machine.labels,
        (HOUSING, machine.housing),
        (LOAD, machine.load),
        (TRANSIENT, TracedTransient(motion.transient, motion.signature)),
        (RUN_SIGNATURE, motion.run_signature),
        streams=(HistoryStream(motion.transient),),
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

    def files(place: Path, *, pictures: bool) -> None:
        if pictures:
            add_warnings(result.document, draw_sound_pictures(solved, place, progress, housing.up))

    result = Result(
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
    return result
