"""What the commands on the housing do: stages, then files, then the document that is printed."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from gearwhine.case import Case, require
from gearwhine.comparison_files import draw_comparison_pictures, write_comparison, write_likeness
from gearwhine.drawings import ModeFormat, check_request, draw_lines, draw_measured, draw_modes
from gearwhine.output import staging
from gearwhine.progress import Progress
from gearwhine.stages import comparison as comparison_stage
from gearwhine.stages import comparison_documents, housing_documents, mesh_health, response_comparison, survey_plan
from gearwhine.stages import geometry as geometry_stage
from gearwhine.stages import housing as housing_stage
from gearwhine.stages import measured as measured_stage
from gearwhine.work.results_folder import kept_in


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

    return kept_in("modes", housing_documents.modes_document(housing, detail=detail), case, folder, write, housing)


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
        write_comparison(place, comparison, geometry)
        draw_comparison_pictures(place, case.title, comparison, housing.modes.frequencies, geometry)
        if likeness is not None:
            write_likeness(place, likeness)

    return kept_in("compare", document | housing_documents.origin_document(housing), case, folder, write, housing)


def survey_case(
    case: Case, sensors: int, modes: int | None, folder: Path, progress: Progress, *, fresh: bool = False
) -> dict[str, Any]:
    """Where to measure the housing's modes, as files that a test program reads."""
    housing = housing_stage.solve_housing(case, progress, command="survey", folder=folder, fresh=fresh)
    progress(f"choosing {sensors} sensors")
    planned = survey_plan.plan_housing(case, housing, sensors, modes)
    document = survey_plan.plan_document(planned, housing) | housing_documents.origin_document(housing)
    return kept_in("survey", document, case, folder, lambda place: survey_plan.write_plan(place, planned), housing)


def update_case(
    case: Case, folder: Path, progress: Progress, *, null: int = 0, held_back: bool = False
) -> dict[str, Any]:
    """The housing's numbers fitted to its measured modes, with the updated case as a file."""
    from gearwhine.stages import update_documents, updating

    solved = updating.update_housing(case, progress, null=null, held_back=held_back)

    def write(place: Path) -> None:
        (place / "updated.toml").write_text(update_documents.updated_case(case, solved), encoding="utf-8")

    return kept_in("update", update_documents.update_document(case, solved), case, folder, write)


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
    document = housing_documents.origin_document(housing)

    def write(place: Path) -> None:
        if which is not None:
            draw_modes(housing, comparison, which, view, mode_format, place, progress)
        if lines:
            document["lines"] = draw_lines(housing, folder, lines, view, mode_format, place, progress)
        if measured:
            draw_measured(case, housing, comparison, survey, view, place)

    return kept_in("render", document, case, folder, write, housing)
