"""What the command ``run`` does: every stage that the case asks for, and all their files."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.case import Case, mesh_frequencies, require
from gearwhine.comparison_files import draw_comparison_pictures, write_comparison
from gearwhine.doubtful import add_warnings, joined
from gearwhine.drawings import draw_modes
from gearwhine.march_files import kept_march
from gearwhine.output import staging
from gearwhine.progress import Progress
from gearwhine.stages import comparison as comparison_stage
from gearwhine.stages import comparison_documents, gear_analysis, gear_documents, housing_documents, rotor_documents
from gearwhine.stages import gears as gear_stage
from gearwhine.stages import housing as housing_stage
from gearwhine.stages import machine as machine_stage
from gearwhine.stages import rotors as rotor_stage
from gearwhine.stages import run_up as run_up_stage
from gearwhine.stages import signature as signature_stage
from gearwhine.stages import system as system_stage
from gearwhine.stages import transient as transient_stage
from gearwhine.stages.bearing_loads import bearing_load_warnings
from gearwhine.stages.housing import keep_modes
from gearwhine.stages.instability import unstable_modes_warnings
from gearwhine.stages.kept_modes import MODES_FILE
from gearwhine.stages.machine import require_machine
from gearwhine.stages.system_documents import system_document
from gearwhine.stages.uncertainty import add_uncertainty
from gearwhine.work.results_folder import kept_in

if TYPE_CHECKING:
    from gearwhine.stages.gear_analysis import PairAnalysis
    from gearwhine.stages.housing import SolvedHousing
    from gearwhine.stages.rotors import SolvedRotor
    from gearwhine.stages.run_up import RunSignature
    from gearwhine.stages.signature import SolvedSignature
    from gearwhine.stages.system import SolvedSystem
    from gearwhine.stages.transient import SolvedTransient
    from housing.correlation import Comparison


def run_case(
    case: Case, folder: Path, progress: Progress, *, fresh: bool = False, pictures: bool = True
) -> dict[str, Any]:
    """Everything that the case asks for, and the results folder.

    What is marched of the transient is kept in the folder until the results are written: a run that dies goes on from
    there when it is started again. ``fresh`` starts anew. Without ``pictures`` nothing is drawn, and no
    renderer is needed.
    """
    with ExitStack() as until_written:
        return _run_case(case, folder, progress, until_written, fresh=fresh, pictures=pictures)


def _run_case(
    case: Case, folder: Path, progress: Progress, until_written: ExitStack, *, fresh: bool, pictures: bool
) -> dict[str, Any]:
    from housing.errors import RendererUnavailableError
    from housing.renderer import find_renderer

    if case.transient is not None:
        require(case, "rotor", "operation", command="run")
    require_machine(case)
    if case.housing is not None and pictures:
        # Found out before the work, not after it.
        try:
            find_renderer()
        except RendererUnavailableError as error:
            raise RendererUnavailableError(f"{error}\nor do without pictures: --no-pictures") from error
    start = time.perf_counter()
    seconds: dict[str, float] = {}
    document: dict[str, Any] = {"title": case.title}

    def timed(name: str, begin: float) -> None:
        seconds[name] = time.perf_counter() - begin

    begin = time.perf_counter()
    rotors = rotor_stage.solve_rotors(case, progress) if case.rotor else ()
    pairs = gear_stage.solve_gears(case, progress) if case.gear_pair else ()
    analysed = gear_analysis.analyse_pairs(case, pairs)
    timed("rotors_and_gears", begin)
    begin = time.perf_counter()
    housing = housing_stage.solve_housing(case, progress, folder=folder, fresh=fresh) if case.housing else None
    timed("housing", begin)
    if rotors:
        document = joined(document, rotor_documents.rotors_document(rotors))
    if pairs:
        document = joined(document, gear_documents.gears_document(analysed))
    comparison = None
    if housing is not None:
        document["housing"] = housing_documents.modes_document(housing)
        document = joined(document, housing_documents.origin_document(housing))
        if case.measured is not None:
            comparison = comparison_stage.compare_housing(case, housing, progress)
            document["compare"] = comparison_documents.comparison_document(comparison, housing)

    transient, system, signature, run = None, None, None, None
    if case.rotor and case.operation:
        begin = time.perf_counter()
        part = None if housing is None else machine_stage.housing_in_machine(case, housing, progress)
        machine = machine_stage.build_machine(case, part, pairs, progress)
        basis = machine_stage.basis_error(case, machine, part, pairs, progress)
        system = system_stage.solve_system(case, machine, housing, progress)
        document["system"] = system_document(case, system, housing)
        add_warnings(document, unstable_modes_warnings(system.stability))
        add_uncertainty(document["system"], basis, document["system"]["trusted_below_hz"])
        timed("system", begin)
        if case.transient is not None:
            if housing is not None and not housing.source_holds:
                # Now, not with the results: who goes on with a long march need not solve them again.
                with staging(folder) as place:
                    keep_modes(place, housing)
                housing = replace(housing, source=folder / MODES_FILE, source_holds=True)
            begin = time.perf_counter()
            transient = transient_stage.solve_transient(
                case,
                machine,
                mesh_frequencies(case),
                progress,
                housing=housing,
                keep=lambda key: until_written.enter_context(kept_march(folder, key, fresh=fresh)),
            )
            document = joined(document, transient_stage.transient_document(case, transient))
            add_warnings(document, bearing_load_warnings(case, transient_stage.mean_bearing_forces(transient)))
            add_uncertainty(document, basis, transient.trusted_limit)
            if transient_stage.is_traced(case):
                frequencies = None if housing is None else housing.modes.frequencies_hz
                signature = signature_stage.solve_signature(transient, system.modes, frequencies)
                signature_stage.add_signature(document, transient, signature)
            run = run_up_stage.solve_run_signature(case, transient)
            add_warnings(document, run_up_stage.run_signature_warnings(case, transient))
            if run is not None:
                document["run_signature"] = run_up_stage.run_signature_document(run)
            timed("transient", begin)
            seconds["time_stepping"] = transient.result.seconds

    begin = time.perf_counter()
    solved = _Solved(rotors, analysed, housing, comparison, system, transient, signature, run)

    def write(place: Path) -> None:
        progress("writing results")
        _write(place, case, solved)
        if pictures:
            _draw(place, case, solved, progress)
        timed("writing", begin)
        seconds["total"] = time.perf_counter() - start
        document["seconds"] = seconds

    return kept_in("run", document, case, folder, write, housing)


@dataclass(frozen=True)
class _Solved:
    """All that a run has found, and None or empty for what the case does not ask for."""

    rotors: tuple[SolvedRotor, ...]
    pairs: tuple[PairAnalysis, ...]
    housing: SolvedHousing | None
    comparison: Comparison | None
    system: SolvedSystem | None
    transient: SolvedTransient | None
    signature: SolvedSignature | None
    run: RunSignature | None


def _write(place: Path, case: Case, solved: _Solved) -> None:
    """The files of results."""
    from gearwhine import results

    results.write(
        place / "results.nc",
        case,
        solved.housing,
        solved.rotors,
        solved.pairs,
        solved.system,
        solved.transient,
        solved.signature,
        run=solved.run,
    )
    if solved.housing is not None:
        results.write_shapes(place / "modes.vtu", solved.housing)
        if solved.comparison is not None:
            write_comparison(place, solved.comparison)


def _draw(place: Path, case: Case, solved: _Solved, progress: Progress) -> None:
    """The pictures of what there is."""
    from gearwhine import figures

    if solved.pairs:
        figures.draw_gear_pairs(place, solved.pairs, progress)
    if solved.system is not None:
        figures.draw_system(place, case, solved.system)
    if solved.transient is not None:
        figures.draw_transient(place, case, solved.transient, solved.signature, solved.housing, solved.comparison)
    if solved.run is not None:
        figures.draw_run(place, case, solved.run, solved.housing)
    if solved.housing is not None:
        if solved.comparison is not None:
            draw_comparison_pictures(place, case.title, solved.comparison, solved.housing.modes.frequencies)
        draw_modes(solved.housing, solved.comparison, "dominant", "iso", "png", place, progress)
