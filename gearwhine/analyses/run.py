"""The whole run of a case: every analysis that the case asks for, and the transient."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.analyses.machine import loaded_case
from gearwhine.analyses.of_machine import add_motion, modes_of_run
from gearwhine.analyses.result import Result
from gearwhine.analyses.run_solution import RunSolution
from gearwhine.case import Case, require
from gearwhine.case.checks.plausible import overload
from gearwhine.coupling.analyses.motion import solve_motion
from gearwhine.coupling.errors import TransientError
from gearwhine.from_case.machine import require_machine, solve_gears
from gearwhine.mode_pictures import draw_load_pictures, draw_modes, draw_operating_shapes, draw_sound_pictures
from gearwhine.numerics.progress import Progress, silent
from gearwhine.output import staging
from gearwhine.output.checkpoints import stored_record
from gearwhine.output.dataset import labels_of
from gearwhine.output.files import MODE_CACHE_FILE
from gearwhine.output.quantity import add_warnings, joined
from gearwhine.results.comparison import comparison_document, write_comparison
from gearwhine.results.gears import gears_document
from gearwhine.results.housing import modes_document, origin_document, write_shapes
from gearwhine.results.motion import leading_lines
from gearwhine.results.rotors import rotors_document
from gearwhine.results.run import (
    SOUND_LEFT_OUT,
)
from gearwhine.results.sound import sound_document
from gearwhine.solve.acoustics import acoustics_of, check_before_modes, is_in_run, refused_by_key, sound_left_out
from gearwhine.solve.comparison import compare_housing, comparison_warnings, require_comparable
from gearwhine.solve.gear_pairs import analyse_pairs
from gearwhine.solve.housing_modes import solve_housing, write_mode_cache
from gearwhine.solve.machine import plan_of, tracking_of
from gearwhine.solve.operating_shapes import highest_lines
from gearwhine.solve.rotors import solve_rotors

if TYPE_CHECKING:
    from gearwhine.coupling.analyses.recording import TransientPlan
    from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
    from gearwhine.solve.housing_modes import SolvedHousing

_DRAWN_LINES = 6  # operating shapes of a run


def run(
    case: Case,
    *,
    plan: TransientPlan | None = None,
    housing: SolvedHousing | None = None,
    folder: Path | None = None,
    fresh: bool = False,
    pictures: bool = True,
    until_written: ExitStack | None = None,
    progress: Progress = silent,
) -> Result[RunSolution]:
    """Do everything that the case asks for: rotors, gears, housing, comparison, load, coupled modes, transient.

    Parameters
    ----------
    case : Case
    plan : TransientPlan, optional
        Stretch of the motion over time, in place of that of `[transient]`.
    housing : SolvedHousing, optional
        Solved housing, where it exists already.
    folder : path, optional
        Results folder: modes of the same housing cached there are read, and the blocks of the transient are stored
        there, so that a run that dies continues from there when it is started again.
    fresh : bool
        Whether to begin anew where there is such a folder.
    pictures : bool
        Whether modes are to be drawn: a missing renderer then raises before the work.
    until_written : ExitStack, optional
        Closed by the caller when the results are written; the blocks of the transient are stored until then.
    progress : callable

    Raises
    ------
    CaseError, gearwhine.housing.HousingError, gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError
        Where the case cannot be solved as it stands.
    gearwhine.housing.errors.RendererUnavailableError
        Where modes are to be drawn and no renderer is available.
    """
    if plan is None and case.transient is not None:
        plan = plan_of(case)
    if plan is not None:
        require(case, "rotor", "operation", command="run")
    require_machine(case)
    require_comparable(case)
    if case.housing is not None and pictures:
        _require_renderer()
    start = time.perf_counter()
    seconds: dict[str, float] = {}
    document: dict[str, Any] = {"title": case.title}

    def timed(name: str, begin: float) -> None:
        seconds[name] = time.perf_counter() - begin

    begin = time.perf_counter()
    rotors = solve_rotors(case, progress) if case.rotor else ()
    timed("rotors_and_gears", begin)
    begin = time.perf_counter()
    if housing is None and case.housing is not None:
        before = check_before_modes(case) if is_in_run(case) else None
        housing = solve_housing(case, progress, folder=folder, fresh=fresh, before=before)
    timed("housing", begin)
    begin = time.perf_counter()
    course = None if plan is None else plan.run
    loaded = loaded_case(case, housing, course, progress) if case.rotor and case.operation else None
    timed("load", begin)
    begin = time.perf_counter()
    pairs: tuple[LoadedGearPair, ...] = ()
    if loaded is not None:
        pairs = loaded.loaded.pairs
    elif case.gear_pair:
        pairs = solve_gears(case, progress)
    load = None if loaded is None else loaded.load
    analysed = analyse_pairs(case, pairs, None if load is None else load.point)
    seconds["rotors_and_gears"] += time.perf_counter() - begin
    if rotors:
        document = joined(document, rotors_document(rotors))
    if pairs:
        document = joined(document, gears_document(analysed))
    comparison = None
    if housing is not None:
        document["housing"] = modes_document(housing)
        document = joined(document, origin_document(housing))
        if case.measured is not None:
            comparison = compare_housing(case, housing, progress)
            document["compare"] = comparison_document(comparison, housing)
            add_warnings(document, comparison_warnings(comparison, housing.modes))

    system, motion = None, None
    if loaded is not None:
        begin = time.perf_counter()
        system, of_system = modes_of_run(loaded, progress)
        document = joined(document, of_system)
        timed("system", begin)
    if loaded is not None and system is not None and plan is not None:
        if folder is not None and housing is not None and not housing.source_holds:
            # Modes are cached before the results, so that a resumed long transient need not solve them again.
            with staging(folder) as place:
                write_mode_cache(place, housing)
            housing = replace(housing, source=folder / MODE_CACHE_FILE, source_holds=True)
        begin = time.perf_counter()
        keep = None
        if folder is not None and until_written is not None:
            keep = partial(_checkpoints, folder, until_written, fresh=fresh)
        try:
            motion = solve_motion(loaded.loaded, plan, tracking_of(case), system.modes, progress, keep=keep)
        except TransientError as error:
            # Under a load that no tooth bears the advice of the integration is beside the point.
            if told := overload(case):
                raise TransientError(f"{told}; no motion under this load is found") from error
            raise
        document = add_motion(document, loaded.loaded, motion, loaded.warnings)
        timed("transient", begin)
        seconds["time_stepping"] = motion.transient.result.seconds
    transient = None if motion is None else motion.transient

    sound = None
    if case.acoustics is not None and not is_in_run(case):
        document["sound_not_solved"] = SOUND_LEFT_OUT
    if is_in_run(case) and housing is not None:
        from gearwhine.coupling.sound.motion_lines import AUDIBLE, lines_of_run
        from gearwhine.coupling.sound.solution import solve_sound, with_histories
        from gearwhine.solve.kept_radiation import kept_radiation

        begin = time.perf_counter()
        acoustics, field = acoustics_of(case), housing.displacement_field
        lines, without = None, []
        if transient is not None and not (without := sound_left_out(case)):
            lines = lines_of_run(transient, acoustics.estimated_below_hz(field))
        machine = None if loaded is None else loaded.coupled
        with refused_by_key(acoustics):
            sound = solve_sound(acoustics, field, lines, machine, progress)
        # A moving base drives the housing beside its bearings.
        if transient is not None and sound.microphones and case.operation is not None and case.operation.base is None:
            between = AUDIBLE, sound.limit_hz
            transfer, housing = kept_radiation(acoustics, housing, sound.radiation, sound.places, between, progress)
            sound = with_histories(sound, transient, transfer)
        document["sound"] = sound_document(sound)
        add_warnings(document, [*without, *sound.warnings()])
        timed("sound", begin)

    seconds["total"] = time.perf_counter() - start
    document["seconds"] = seconds
    solved = RunSolution(rotors, analysed, housing, comparison, system, load=load, sound=sound).with_motion(motion)

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        if solved.housing is None:
            return {}
        write_shapes(place / "modes.vtu", solved.housing)
        if comparison is not None:
            write_comparison(place, comparison)
        if not pictures:
            return {}
        from gearwhine.drawing_process import one_process

        with one_process():
            # The tables of lines name modes, and the report links their pictures.
            lines_told = leading_lines(document.get("sensors", ()), "peaks")
            named = {row["by_mode"] for row in lines_told if row["by_mode"] is not None}
            draw_modes(solved.housing, comparison, "dominant", "auto", "png", place, progress, named)
            if load is not None:
                draw_load_pictures(solved.housing, load, place, progress)
            if solved.sound is not None:
                draw_sound_pictures(solved.sound, place, progress, solved.housing.up)
            if solved.transient is not None and solved.signature is not None:
                lines = highest_lines(solved.signature, solved.transient.trusted_limit, _DRAWN_LINES)
                if lines:
                    draw_operating_shapes(solved.housing, lines, "auto", "png", place, progress)
        return {}

    return Result(
        "run",
        case,
        solved,
        document,
        _arrays=lambda: solved.arrays(labels_of(case)),
        _figures=partial(solved.figures, case.title),
        _files=files,
        _housing=housing,
        _started=start,
    )


def simulate(
    case: Case,
    *,
    plan: TransientPlan | None = None,
    housing: SolvedHousing | None = None,
    folder: Path | None = None,
    progress: Progress = silent,
) -> Result[RunSolution]:
    """Integrate the motion of a case's machine in time: its transient.

    Parameters
    ----------
    case : Case
        Case with `[transient]`, unless a plan is given.
    plan, housing, folder, progress
        As :func:`run`.

    Raises
    ------
    CaseError, gearwhine.housing.HousingError, gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError
        Where the case cannot be solved as it stands.
    gearwhine.coupling.TransientError
        Where the motion cannot be followed or its energies do not balance.
    """
    require(case, "rotor", "operation", *(["transient"] if plan is None else []), command="simulate")
    only = case.model_copy(update={"measured": None})
    result = run(only, plan=plan, housing=housing, folder=folder, pictures=False, progress=progress)
    return replace(result, command="simulate", case=case)


def run_into(
    case: Case,
    folder: Path,
    *,
    housing: SolvedHousing | None = None,
    fresh: bool = False,
    pictures: bool = True,
    progress: Progress = silent,
) -> Result[RunSolution]:
    """Do everything that the case asks for and write it; the blocks of the transient are stored until then.

    The parameters are those of :func:`run`.
    """
    with ExitStack() as until_written:
        result = run(
            case,
            housing=housing,
            folder=folder,
            fresh=fresh,
            pictures=pictures,
            until_written=until_written,
            progress=progress,
        )
        return result.stored(folder, pictures=pictures, progress=progress)


def _require_renderer() -> None:
    from gearwhine.housing.errors import RendererUnavailableError
    from gearwhine.housing.pictures.scene import find_renderer

    try:
        find_renderer()
    except RendererUnavailableError as error:
        raise RendererUnavailableError(f"{error}\nor do without pictures: --no-pictures") from error


def _checkpoints(folder: Path, until_written: ExitStack, key: str, *, fresh: bool) -> Any:
    return until_written.enter_context(stored_record(folder, key, fresh=fresh))
