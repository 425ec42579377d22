"""The whole run of a case: every analysis that the case asks for, and the transient."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.analyses.of_machine import add_motion, solve_motion
from gearwhine.analyses.result import Result
from gearwhine.case import Case, require
from gearwhine.case.checks.plausible import overload
from gearwhine.coupling.analyses.loaded_machine import load_machine
from gearwhine.coupling.analyses.modes_and_responses import solve_system
from gearwhine.coupling.errors import TransientError
from gearwhine.from_case.gear_pairs import solve_gears
from gearwhine.from_case.machine import require_machine
from gearwhine.mode_pictures import draw_load_pictures, draw_modes, draw_operating_shapes, draw_sound_pictures
from gearwhine.numerics.progress import Progress, silent
from gearwhine.output import staging
from gearwhine.output.checkpoints import stored_record
from gearwhine.output.dataset import LabelledArrays, labelled, labels_of
from gearwhine.output.files import MODE_CACHE_FILE
from gearwhine.output.quantity import add_warnings, joined
from gearwhine.results.comparison import comparison_document, write_comparison
from gearwhine.results.gears import GEARS, gears_document
from gearwhine.results.housing import HOUSING, modes_document, origin_document, write_shapes
from gearwhine.results.motion import leading_lines
from gearwhine.results.operating_point import LOAD, load_part
from gearwhine.results.rotors import ROTORS, rotors_document
from gearwhine.results.run import (
    RUN_SIGNATURE,
    SOUND_LEFT_OUT,
    TRANSIENT,
    HistoryStream,
    TracedTransient,
)
from gearwhine.results.sound import SOUND, sound_document
from gearwhine.results.system import SYSTEM, system_document
from gearwhine.solve.acoustics import acoustics_of, check_before_modes, is_in_run, refused_by_key, sound_left_out
from gearwhine.solve.comparison import compare_housing, comparison_warnings, require_comparable
from gearwhine.solve.damping import damping_document, damping_warnings
from gearwhine.solve.gear_bodies import gear_body_document
from gearwhine.solve.gear_pairs import analyse_pairs
from gearwhine.solve.housing_modes import solve_housing, write_mode_cache
from gearwhine.solve.machine import described_machine, plan_of, reduce_housing, run_of, tracking_of
from gearwhine.solve.operating_point import find_load
from gearwhine.solve.operating_shapes import highest_lines
from gearwhine.solve.plausibility import (
    add_mechanisms,
    add_uncertainty,
    unstable_modes_warnings,
)
from gearwhine.solve.rotors import solve_rotors

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearwhine.coupling.analyses.modes_and_responses import SolvedSystem
    from gearwhine.coupling.analyses.run_up import RunSignature
    from gearwhine.coupling.analyses.signature import SolvedSignature
    from gearwhine.coupling.analyses.transient import SolvedTransient
    from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
    from gearwhine.coupling.sound.solution import SolvedSound
    from gearwhine.housing.correlation import Comparison
    from gearwhine.solve.gear_pairs import PairAnalysis
    from gearwhine.solve.housing_modes import SolvedHousing
    from gearwhine.solve.operating_point import SolvedLoad
    from gearwhine.solve.rotors import SolvedRotor

_DRAWN_LINES = 6  # operating shapes of a run


def run(
    case: Case,
    *,
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
    if case.transient is not None:
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
    described, part, load, loaded, warnings_of_load = None, None, None, None, list[dict[str, Any]]()
    pairs: tuple[LoadedGearPair, ...] = ()
    if case.rotor and case.operation:
        part = None if housing is None else reduce_housing(case, housing, progress)
        described = described_machine(case, part)
        load, warnings_of_load = find_load(case, described, progress)
    timed("load", begin)
    begin = time.perf_counter()
    if described is not None:
        loaded = load_machine(described, None if load is None else load.point, run_of(case), progress)
        pairs = loaded.pairs
    elif case.gear_pair:
        pairs = solve_gears(case, progress)
    analysed = analyse_pairs(case, pairs, None if load is None else load.point)
    timed("rotors_and_gears", begin - seconds["rotors_and_gears"])
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

    transient, system, signature, run_signature, sound, machine = None, None, None, None, None, None
    if loaded is not None and described is not None:
        begin = time.perf_counter()
        progress("comparing with another modal basis")
        machine, mechanisms, basis = loaded.coupled, loaded.mechanisms, loaded.basis_error
        system = solve_system(machine, progress)
        document["system"] = system_document(system, housing)
        add_warnings(document, unstable_modes_warnings(system.stability))
        add_uncertainty(document["system"], basis, document["system"]["trusted_below_hz"])
        add_mechanisms(document["system"], mechanisms)
        document["damping"] = damping_document(case)
        if bodies := gear_body_document(loaded.machine):
            document["gear_bodies"] = bodies
        add_warnings(document, damping_warnings(case))
        timed("system", begin)
        if load is not None:
            document["load"] = load_part(load)
        add_warnings(document, warnings_of_load)
        if case.transient is not None:
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
                motion = solve_motion(loaded, plan_of(case), tracking_of(case), system.modes, progress, keep=keep)
            except TransientError as error:
                # Under a load that no tooth bears the advice of the integration is beside the point.
                if told := overload(case):
                    raise TransientError(f"{told}; no motion under this load is found") from error
                raise
            transient, signature, run_signature = motion.transient, motion.signature, motion.run_signature
            document = add_motion(document, loaded, motion, warnings_of_load)
            timed("transient", begin)
            seconds["time_stepping"] = transient.result.seconds

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
    solved = RunSolution(
        rotors, analysed, housing, comparison, system, transient, signature, run_signature, load, sound
    )

    def files(place: Path, *, pictures: bool) -> None:
        if solved.housing is None:
            return
        write_shapes(place / "modes.vtu", solved.housing)
        if comparison is not None:
            write_comparison(place, comparison)
        if not pictures:
            return
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

    return Result(
        "run",
        case,
        solved,
        document,
        _arrays=partial(run_arrays, case, solved),
        _figures=partial(_figures, case, solved),
        _files=files,
        _housing=housing,
        _started=start,
    )


def simulate(
    case: Case, *, housing: SolvedHousing | None = None, folder: Path | None = None, progress: Progress = silent
) -> Result[RunSolution]:
    """Integrate the motion of a case's machine in time: its transient.

    Parameters
    ----------
    case : Case
        Case with `[transient]`.
    housing, folder, progress
        As :func:`run`.

    Raises
    ------
    CaseError, gearwhine.housing.HousingError, gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError
        Where the case cannot be solved as it stands.
    gearwhine.coupling.TransientError
        Where the motion cannot be followed or its energies do not balance.
    """
    require(case, "rotor", "operation", "transient", command="simulate")
    only = case.model_copy(update={"measured": None})
    result = run(only, housing=housing, folder=folder, pictures=False, progress=progress)
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
        result.write(folder, pictures=pictures, progress=progress)
        return result


def _require_renderer() -> None:
    from gearwhine.housing.errors import RendererUnavailableError
    from gearwhine.housing.pictures.scene import find_renderer

    try:
        find_renderer()
    except RendererUnavailableError as error:
        raise RendererUnavailableError(f"{error}\nor do without pictures: --no-pictures") from error


def _checkpoints(folder: Path, until_written: ExitStack, key: str, *, fresh: bool) -> Any:
    return until_written.enter_context(stored_record(folder, key, fresh=fresh))


@dataclass(frozen=True)
class RunSolution:
    """Solution of a whole run, None or empty where the case does not ask for an analysis."""

    rotors: tuple[SolvedRotor, ...]
    pairs: tuple[PairAnalysis, ...]
    housing: SolvedHousing | None
    comparison: Comparison | None
    system: SolvedSystem | None
    transient: SolvedTransient | None
    signature: SolvedSignature | None
    run_signature: RunSignature | None
    load: SolvedLoad | None = None
    sound: SolvedSound | None = None


def run_arrays(case: Case, solved: RunSolution) -> LabelledArrays:
    """Return the labelled arrays of the analyses that were made."""
    streams = () if solved.transient is None else (HistoryStream(solved.transient),)
    return labelled(
        labels_of(case),
        (HOUSING, solved.housing),
        (ROTORS, solved.rotors),
        (GEARS, solved.pairs),
        (LOAD, solved.load),
        (SYSTEM, solved.system),
        (TRANSIENT, None if solved.transient is None else TracedTransient(solved.transient, solved.signature)),
        (RUN_SIGNATURE, solved.run_signature),
        (SOUND, solved.sound),
        streams=streams,
    )


def _figures(case: Case, solved: RunSolution, progress: Progress) -> Iterator[tuple[str, Figure]]:
    """Draw the figures of the analyses that were made, each with its name."""
    from gearwhine import figures

    if solved.pairs:
        yield from figures.draw_gear_pairs(solved.pairs, progress)
    if solved.load is not None:
        yield from figures.draw_load(solved.load)
    if solved.system is not None:
        progress("drawing the coupled system")
        yield from figures.draw_system(solved.system)
    if solved.transient is not None:
        progress("drawing the motion")
        parts_of_motion = solved.transient, solved.signature, solved.housing, solved.comparison
        yield from figures.draw_transient(case.title, *parts_of_motion)
    if solved.transient is not None and solved.run_signature is not None:
        yield from figures.draw_run(case.title, solved.transient, solved.run_signature)
    if solved.sound is not None:
        progress("drawing the sound")
        yield from figures.draw_sound(case.title, solved.sound)
    if solved.housing is not None and solved.comparison is not None:
        progress("drawing the comparison with measured modes")
        yield from figures.draw_comparison_figures(case.title, solved.comparison, solved.housing.modes.frequencies)
