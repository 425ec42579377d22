"""What each command does: stages, then files, then the document that it prints."""

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.case import (
    Case,
    CaseError,
    Problem,
    bundled_case,
    bundled_cases,
    dump_case,
    mesh_frequencies,
    require,
    swept_keys,
)
from gearwhine.comparison_files import write_comparison, write_likeness
from gearwhine.drawings import ModeFormat, check_request, draw_lines, draw_measured, draw_modes
from gearwhine.march_files import kept_march
from gearwhine.output import SUMMARY, earlier_drawings, finite, json_text, staging
from gearwhine.progress import Progress
from gearwhine.stages import comparison as comparison_stage
from gearwhine.stages import (
    comparison_documents,
    gear_analysis,
    gear_documents,
    gear_torques,
    housing_documents,
    mesh_health,
    response_comparison,
    rotor_documents,
    survey_plan,
)
from gearwhine.stages import gears as gear_stage
from gearwhine.stages import geometry as geometry_stage
from gearwhine.stages import housing as housing_stage
from gearwhine.stages import machine as machine_stage
from gearwhine.stages import measured as measured_stage
from gearwhine.stages import rotors as rotor_stage
from gearwhine.stages import run_up as run_up_stage
from gearwhine.stages import signature as signature_stage
from gearwhine.stages import steady as steady_stage
from gearwhine.stages import system as system_stage
from gearwhine.stages import transient as transient_stage
from gearwhine.stages.kept_modes import MODES_FILE, keep_modes
from gearwhine.stages.system_documents import system_document

if TYPE_CHECKING:
    from gearwhine.stages.housing import SolvedHousing


def run_case(case: Case, folder: Path, progress: Progress, *, fresh: bool = False) -> dict[str, Any]:
    """Everything that the case asks for, and the results folder.

    What is marched of the transient is kept in the folder until the results are written: a run that dies goes on from
    there when it is started again. ``fresh`` starts anew.
    """
    with ExitStack() as until_written:
        return _run_case(case, folder, progress, until_written, fresh=fresh)


def _run_case(case: Case, folder: Path, progress: Progress, until_written: ExitStack, *, fresh: bool) -> dict[str, Any]:
    from gearwhine import figures, results
    from housing.renderer import find_renderer

    if case.transient is not None:
        require(case, "rotor", "operation", command="run")
    if case.housing is not None:
        # Found out before the work, not after it.
        find_renderer()
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
        document |= rotor_documents.rotors_document(rotors)
    if pairs:
        document |= gear_documents.gears_document(analysed)
    comparison = None
    if housing is not None:
        document["housing"] = housing_documents.modes_document(housing)
        document |= housing_documents.origin_document(housing)
        if case.measured is not None:
            comparison = comparison_stage.compare_housing(case, housing, progress)
            document["compare"] = comparison_documents.comparison_document(comparison, housing)

    transient, system, signature, run = None, None, None, None
    if case.rotor and case.operation:
        begin = time.perf_counter()
        machine = machine_stage.build_machine(case, housing, pairs, progress)
        system = system_stage.solve_system(case, machine, housing, progress)
        document["system"] = system_document(case, system, housing)
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
            document |= transient_stage.transient_document(case, transient)
            if transient_stage.is_traced(case):
                frequencies = None if housing is None else housing.modes.frequencies_hz
                signature = signature_stage.solve_signature(transient, system.modes, frequencies)
                signature_stage.add_signature(document, transient, signature)
            run = run_up_stage.solve_run_signature(case, transient)
            if run is not None:
                document["run_signature"] = run_up_stage.run_signature_document(run)
            timed("transient", begin)
            seconds["time_stepping"] = transient.result.seconds

    begin = time.perf_counter()
    with staging(folder, replacing=True) as place:
        progress("writing results")
        (place / "case.toml").write_text(dump_case(case), encoding="utf-8")
        results.write(place / "results.nc", case, housing, rotors, analysed, system, transient, signature, run=run)
        if analysed:
            figures.draw_gear_pairs(place, analysed, progress)
        if system is not None:
            figures.draw_system(place, case, system)
        if transient is not None:
            figures.draw_transient(place, case, transient, signature, housing, comparison)
        if run is not None:
            figures.draw_run(place, case, run, housing)
        if housing is not None:
            results.write_shapes(place / "modes.vtu", housing)
            keep_modes(place, housing)
            draw_modes(housing, comparison, "dominant", "iso", "png", place, progress)
        if housing is not None and comparison is not None:
            write_comparison(place, case.title, comparison, housing.modes.frequencies)
        timed("writing", begin)
        seconds["total"] = time.perf_counter() - start
        document |= {"seconds": seconds, "folder": str(folder), "files": _files(place, housing)}
        (place / SUMMARY).write_text(json_text(finite(document)) + "\n", encoding="utf-8")
    return document


def mesh_case(case: Case, folder: Path, suffix: str, progress: Progress) -> dict[str, Any]:
    """Mesh the housing and write the mesh file."""
    from meshes import mesh_quality, write_mesh

    progress("meshing the housing")
    remarks: list[str] = []
    mesh = geometry_stage.build_mesh(case, remarks.append)
    doubts = mesh_health.examine(case, mesh)
    doubts += mesh_health.doubt_resolution(case, mesh, case.housing.frequency_limit if case.housing else None)
    quality = mesh_quality(mesh)
    name = f"mesh.{suffix}"
    with staging(folder) as place:
        write_mesh(mesh, place / name)
    return {
        "mesh": {"nodes": len(mesh.points), "elements": mesh.n_elements, "dofs": 3 * len(mesh.points)},
        "order": mesh.order,
        "kinds": mesh.kinds,
        "surfaces": {surface: sum(map(len, facets)) for surface, facets in sorted(mesh.surfaces.items())},
        "volumes": {volume: len(members) for volume, members in sorted(mesh.volumes.items())},
        "volume_m3": quality.volume,
        "edge_length_m": dict(zip(("min", "median", "max"), quality.edge_length, strict=True)),
        "shape_number": dict(zip(("min", "median"), quality.shape, strict=True)),
        "bores": geometry_stage.bores_document(mesh),
        "warnings": [mesh_health.doubt("geometry", remark) for remark in remarks]
        + mesh_health.warnings_document(doubts),
        "folder": str(folder),
        "files": [name],
    }


def modes_case(
    case: Case, folder: Path | None, progress: Progress, *, detail: bool = False, fresh: bool = False
) -> dict[str, Any]:
    """The housing's modes; with a folder, also on file: for later commands, as VTU and in a results file."""
    from gearwhine import results

    housing = housing_stage.solve_housing(case, progress, folder=folder, fresh=fresh)

    def write(place: Path) -> None:
        results.write(place / "results.nc", case, housing, (), (), None, None)
        results.write_shapes(place / "modes.vtu", housing)

    return _kept(housing_documents.modes_document(housing, detail=detail), case, folder, write, housing)


def rotors_case(case: Case, folder: Path | None, progress: Progress, *, write_ross: bool = False) -> dict[str, Any]:
    """The rotors; with a folder, also as a results file and pictures, and where asked as files that ROSS loads."""
    from gearwhine import figures, results

    rotors = rotor_stage.solve_rotors(case, progress)
    document = rotor_documents.rotors_document(rotors)

    def write(place: Path) -> None:
        results.write(place / "results.nc", case, None, rotors, (), None, None)
        figures.draw_rotors(place, case, rotors, progress)
        if write_ross:
            remarks = rotor_stage.write_ross_files(place, rotors)
            document["warnings"] = [{"name": "ross", "message": remark} for remark in remarks]

    return _kept(document, case, folder, write)


def gears_case(case: Case, folder: Path | None, progress: Progress) -> dict[str, Any]:
    """The gear pairs, over torques too; with a folder, also as a results file and pictures."""
    pairs = gear_analysis.analyse_pairs(case, gear_stage.solve_gears(case, progress))
    pairs = gear_torques.over_torques(pairs, progress)

    def write(place: Path) -> None:
        from gearwhine import figures, results

        results.write(place / "results.nc", case, None, (), pairs, None, None)
        figures.draw_gear_pairs(place, pairs, progress)

    return _kept(gear_documents.gears_document(pairs), case, folder, write)


def system_case(
    case: Case,
    folder: Path | None,
    progress: Progress,
    *,
    mesh_phase: float | None = None,
    over_speed: bool = False,
    sidebands: int = 0,
    fresh: bool = False,
) -> dict[str, Any]:
    """The coupled modes, over speed too where the case sweeps or it is asked for; with a folder, also as pictures."""
    housing, _, machine = machine_stage.solve_machine(case, progress, folder=folder, fresh=fresh)
    swept = case.sweep is not None and len(case.sweep.speeds) > 1
    solved = system_stage.solve_system(
        case, machine, housing, progress, mesh_phase=mesh_phase, over_speed=over_speed or swept, sidebands=sidebands
    )
    document = system_document(case, solved, housing)

    def write(place: Path) -> None:
        from gearwhine import figures, results

        progress("writing results")
        results.write(place / "results.nc", case, housing, (), (), solved, None)
        figures.draw_system(place, case, solved)

    return _kept(document | housing_documents.origin_document(housing), case, folder, write, housing)


def steady_case(
    case: Case,
    folder: Path | None,
    progress: Progress,
    *,
    over_speed: bool = False,
    downwards: bool = False,
    points: int = 100,
    fresh: bool = False,
) -> dict[str, Any]:
    """The motion that repeats at the speed of operation, and its branch over speed; with a folder, also as pictures."""
    housing, _, machine = machine_stage.solve_machine(case, progress, folder=folder, fresh=fresh)
    solved = steady_stage.solve_steady(
        case, machine, housing, progress, over_speed=over_speed, downwards=downwards, points=points
    )
    document = steady_stage.steady_document(case, solved)

    def write(place: Path) -> None:
        from gearwhine import figures, results

        progress("writing results")
        results.write(place / "results.nc", case, housing, (), (), None, None, steady=solved)
        figures.draw_steady(place, case, solved)

    return _kept(document | housing_documents.origin_document(housing), case, folder, write, housing)


def sweep_case(
    case: Case,
    source: tuple[str, Sequence[str]],
    over: Sequence[str],
    folder: Path,
    progress: Progress,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    fresh: bool = False,
) -> dict[str, Any]:
    """The transient at every point of a sweep, gathered in one file and drawn.

    ``source`` is what the case was read from: the name, and the changes by ``--set``.
    """
    start = time.perf_counter()
    keys = swept_keys(case, over)
    from gearwhine import sweep

    points = sweep.sweep_points(*source, keys)
    count = workers or sweep.default_workers()
    swept = sweep.conduct_sweep(points, folder, progress, workers=count, scheduler=scheduler, fresh=fresh)
    dataset = sweep.gathered(case, keys, swept)
    document = {"title": case.title} | sweep.sweep_document(keys, swept)
    document["workers"] = count if scheduler is None else None

    def write(place: Path) -> None:
        from gearwhine.figures import draw_sweep

        progress("writing results")
        dataset.to_netcdf(place / "sweep.nc", engine="h5netcdf")
        draw_sweep(place, case.title, dataset)
        document["seconds"] = {"total": time.perf_counter() - start}

    return _kept(document, case, folder, write)


def compare_case(case: Case, folder: Path | None, progress: Progress, *, fresh: bool = False) -> dict[str, Any]:
    """Model modes against measured ones."""
    require(case, "housing", "measured", command="compare")
    housing = housing_stage.solve_housing(case, progress, folder=folder, fresh=fresh)
    comparison, survey = comparison_stage.compare_with_survey(case, housing, progress)
    document = comparison_documents.comparison_document(comparison, housing)
    likeness = None
    if survey is not None:
        document["survey"] = measured_stage.survey_document(survey)
        progress("comparing responses")
        likeness, told = response_comparison.responses_beside(case, housing, survey)
        document |= {} if told is None else {"responses": told}

    def write(place: Path) -> None:
        progress("writing results")
        geometry = None if survey is None else survey.geometry
        write_comparison(place, case.title, comparison, housing.modes.frequencies, geometry)
        if likeness is not None:
            write_likeness(place, likeness)

    return _kept(document | housing_documents.origin_document(housing), case, folder, write, housing)


def survey_case(
    case: Case, sensors: int, modes: int | None, folder: Path, progress: Progress, *, fresh: bool = False
) -> dict[str, Any]:
    """Where to measure the housing's modes, as files that a test program reads."""
    housing = housing_stage.solve_housing(case, progress, command="survey", folder=folder, fresh=fresh)
    progress(f"choosing {sensors} sensors")
    planned = survey_plan.plan_housing(case, housing, sensors, modes)
    document = survey_plan.plan_document(planned, housing) | housing_documents.origin_document(housing)
    return _kept(document, case, folder, lambda place: survey_plan.write_plan(place, planned), housing)


def update_case(
    case: Case, folder: Path, progress: Progress, *, null: int = 0, held_back: bool = False
) -> dict[str, Any]:
    """The housing's numbers fitted to its measured modes, with the updated case as a file."""
    from gearwhine.stages import update_documents, updating

    solved = updating.update_housing(case, progress, null=null, held_back=held_back)

    def write(place: Path) -> None:
        (place / "updated.toml").write_text(update_documents.updated_case(case, solved), encoding="utf-8")

    return _kept(update_documents.update_document(case, solved), case, folder, write)


def render_case(
    case: Case,
    folder: Path,
    which: str | None,
    view: str,
    progress: Progress,
    *,
    mode_format: ModeFormat = "png",
    lines: Sequence[float] = (),
    measured: bool = False,
    fresh: bool = False,
) -> dict[str, Any]:
    """Pictures, films or models of mode shapes; of a run's lines; of measured shapes beside the model's.

    Modes are drawn where ``which`` names them or nothing else is asked for.
    """
    which = which or (None if lines or measured else "dominant")
    check_request(case, which, mode_format, lines, measured=measured)
    housing = housing_stage.solve_housing(case, progress, command="render", folder=folder, fresh=fresh)
    comparison, survey = None, None
    if case.measured is not None and (measured or housing.strengths is not None):
        comparison, survey = comparison_stage.compare_with_survey(case, housing, progress)
    document: dict[str, Any] = {}
    with staging(folder) as place:
        if which is not None:
            draw_modes(housing, comparison, which, view, mode_format, place, progress)
        if lines:
            document["lines"] = draw_lines(housing, folder, lines, view, mode_format, place, progress)
        if measured:
            draw_measured(case, housing, comparison, survey, view, place)
        keep_modes(place, housing)
        files = _files(place, housing, summary=False)
    return document | {"folder": str(folder), "files": files, **housing_documents.origin_document(housing)}


def report_case(folder: Path) -> dict[str, Any]:
    """The results in a folder as one HTML page."""
    from gearwhine.report import report_page

    page = report_page(folder)
    with staging(folder) as place:
        (place / "report.html").write_text(page, encoding="utf-8")
    return {"folder": str(folder), "files": ["report.html"]}


def list_examples() -> dict[str, Any]:
    """The bundled cases and their titles."""
    return {"examples": [{"name": name, "title": title} for name, title in bundled_cases().items()]}


def copy_example(name: str | None, folder: Path) -> dict[str, Any]:
    """Copy a bundled case into a folder; a file of that name there is left alone."""
    known = ", ".join(bundled_cases())
    source = bundled_case(name) if name is not None else None
    if source is None:
        raise CaseError([Problem("examples copy", name, f"one of: {known}")])
    target = folder / source.name
    if target.exists():
        raise CaseError([Problem("examples copy", str(target), "a place where no file of that name stands yet")])
    content = source.read_text(encoding="utf-8")
    with staging(folder) as place:
        (place / source.name).write_text(content, encoding="utf-8")
    return {"folder": str(folder), "files": [source.name]}


def _kept(
    document: dict[str, Any],
    case: Case,
    folder: Path | None,
    write: Callable[[Path], None] = lambda place: None,
    housing: "SolvedHousing | None" = None,
) -> dict[str, Any]:
    """The document; where a folder is given, also in it, with the resolved case, the modes and what ``write`` adds."""
    if folder is None:
        return document
    with staging(folder) as place:
        (place / "case.toml").write_text(dump_case(case), encoding="utf-8")
        write(place)
        if housing is not None:
            keep_modes(place, housing)
        files = _files(place, housing)
        document |= {"folder": str(folder), "files": files}
        # Drawings that stay from an earlier run are listed on, so that the next one that draws anew clears them.
        if stay := [name for name in earlier_drawings(folder) if name not in files]:
            document["earlier_drawings"] = stay
        (place / SUMMARY).write_text(json_text(finite(document)) + "\n", encoding="utf-8")
    return document


def _files(place: Path, housing: "SolvedHousing | None", *, summary: bool = True) -> list[str]:
    """The results' files: those staged, the mode file that was read and stays, and the summary last."""
    names = {str(path.relative_to(place)) for path in place.rglob("*") if path.is_file()}
    if housing is not None and housing.source is not None:
        names.add(MODES_FILE)
    return sorted(names) + ([SUMMARY] if summary else [])
