"""Analyses of the housing: its mesh, its natural modes, and these beside measured ones."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.analyses.result import Result
from gearwhine.case import Case, CaseError, require
from gearwhine.case.model import housing_table
from gearwhine.from_case.fixtures import build_fixtures
from gearwhine.from_case.mesh import build_mesh, material_of
from gearwhine.from_case.mesh_health import allowed_defects
from gearwhine.housing import HousingError, HousingModes
from gearwhine.housing.correlation.comparison import Comparison
from gearwhine.housing.model_warnings import defect_warnings, resolution_warnings
from gearwhine.meshes import Mesh
from gearwhine.mode_pictures import ModeFormat, check_request, draw_lines, draw_measured, draw_modes
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.output.dataset import LabelledArrays, arrays_of, file_attributes, labelled, labels_of
from gearwhine.output.quantity import add_warnings, joined
from gearwhine.results.comparison import (
    COMPARISON,
    comparison_document,
    responses_document,
    survey_document,
    write_comparison,
    write_response_correlation,
)
from gearwhine.results.housing import HOUSING, modes_document, origin_document, write_shapes
from gearwhine.solve.comparison import (
    ResponseCorrelation,
    compare_responses_document,
    compare_with_survey,
    comparison_warnings,
    plan_housing,
    require_comparable,
    write_plan,
)
from gearwhine.solve.housing_modes import solve_housing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearwhine.solve.comparison import PlannedSurvey
    from gearwhine.solve.updating import SolvedUpdate


def mesh(case: Case, *, suffix: str = "msh", progress: Progress = silent) -> Result[Mesh]:
    """Mesh the housing.

    Parameters
    ----------
    case : Case
    suffix : {"msh", "vtu", "vtk", "inp", "med", "xdmf"}
        Format of the mesh file that the result writes.
    progress : callable

    Raises
    ------
    CaseError
        Where the housing cannot be meshed.
    """
    from gearwhine.meshes import write_mesh
    from gearwhine.results.mesh import mesh_document

    table = housing_table(case, "mesh")
    progress("meshing the housing")
    remarks: list[str] = []
    meshed = build_mesh(table, case.material, case.input_files, remarks.append)
    defects = allowed_defects(table, build_fixtures(table, case.material), meshed)
    warnings = [warning("geometry", remark) for remark in remarks] + defect_warnings(defects)
    warnings += resolution_warnings(meshed, material_of(case.material, table.material), table.frequency_limit)

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        write_mesh(meshed, place / f"mesh.{suffix}")
        return {}

    return Result("mesh", case, meshed, mesh_document(meshed, warnings), _files=files)


def modes(
    case: Case,
    *,
    detail: bool = False,
    housing: HousingModes | None = None,
    folder: Path | None = None,
    fresh: bool = False,
    progress: Progress = silent,
) -> Result[HousingModes]:
    """Find the natural modes of the housing, certified complete.

    Parameters
    ----------
    case : Case
    detail : bool
        Whether to report effective masses, supports, and the modes that carry the bearings' forces as well.
    housing : HousingModes, optional
        Solved housing, where it exists already.
    folder : path, optional
        Results folder, whose modes of the same housing are read in place of solving.
    fresh : bool
        Whether to solve the modes even where they are cached.
    progress : callable

    Raises
    ------
    CaseError, gearwhine.housing.HousingError
        Where the case cannot be solved as it stands.
    gearwhine.housing.IncompleteModesError, gearwhine.housing.ReductionError, gearwhine.housing.HealthError
        Where the modes fail their proofs.
    """
    solved = _solved(case, "modes", housing, folder, progress, fresh=fresh)

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        write_shapes(place / "modes.vtu", solved)
        return {}

    return Result(
        "modes",
        case,
        solved,
        modes_document(solved, detail=detail),
        _arrays=lambda: labelled(labels_of(case), (HOUSING, solved)),
        _files=files,
        _housing=solved,
    )


def compare(
    case: Case,
    *,
    housing: HousingModes | None = None,
    folder: Path | None = None,
    fresh: bool = False,
    progress: Progress = silent,
) -> Result[Comparison]:
    """Compare the housing's natural modes with measured ones.

    Parameters
    ----------
    case : Case
        Case with `[measured]`.
    housing, folder, fresh, progress
        As :func:`modes`.

    Raises
    ------
    CaseError, gearwhine.housing.HousingError
        Where the case has nothing measured, or its modes are not known as high as the measured ones.
    """
    require(case, "housing", "measured", command="compare")
    require_comparable(case)
    solved = _solved(case, "compare", housing, folder, progress, fresh=fresh)
    comparison, survey = compare_with_survey(case, solved, progress)
    document = comparison_document(comparison, solved)
    likeness = None
    if survey is not None:
        document["survey"] = survey_document(survey)
        progress("comparing responses")
        likeness = compare_responses_document(case, solved, survey)
        document |= {} if likeness is None else {"responses": responses_document(likeness)}
    add_warnings(document, comparison_warnings(comparison, solved.modes))
    geometry = None if survey is None else survey.geometry

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        write_comparison(place, comparison, geometry)
        if isinstance(likeness, ResponseCorrelation):
            write_response_correlation(place, likeness)
        return {}

    def figures(progress: Progress) -> "Iterator[tuple[str, Figure]]":
        from gearwhine.figures import draw_comparison_figures

        return draw_comparison_figures(case.title, comparison, solved.modes.frequencies, geometry)

    return Result(
        "compare",
        case,
        comparison,
        joined(document, origin_document(solved)),
        _arrays=lambda: LabelledArrays(arrays_of(COMPARISON, comparison), {}, file_attributes(labels_of(case))),
        _figures=figures,
        _files=files,
        _housing=solved,
        _data_file="comparison.nc",
    )


def survey(
    case: Case,
    *,
    sensors: int,
    modes: int | None = None,
    housing: HousingModes | None = None,
    folder: Path | None = None,
    fresh: bool = False,
    progress: Progress = silent,
) -> "Result[PlannedSurvey]":
    """Choose where to measure the housing's modes.

    Parameters
    ----------
    case : Case
    sensors : int
        Number of sensors, each along the normal of the surface.
    modes : int, optional
        Number of the lowest modes to separate; by default all that are known.
    housing, folder, fresh, progress
        As :func:`modes`.

    Raises
    ------
    CaseError
        Where the sensors cannot separate the modes.
    """
    from gearwhine.results.survey import plan_document

    solved = _solved(case, "survey", housing, folder, progress, fresh=fresh)
    progress(f"choosing {sensors} sensors")
    planned = plan_housing(case, solved, sensors, modes)

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        write_plan(place, planned)
        return {}

    return Result("survey", case, planned, plan_document(planned, solved), _files=files, _housing=solved)


def update(
    case: Case, *, null: int = 0, held_back: bool = False, progress: Progress = silent
) -> "Result[SolvedUpdate]":
    """Fit the parameters of `[update]` to the measured modes.

    Parameters
    ----------
    case : Case
    null : int
        Number of random sets of frequencies that are fitted as well, as a test of the null hypothesis.
    held_back : bool
        Whether to fit without each measured mode in turn, and predict that one.
    progress : callable

    Raises
    ------
    CaseError, gearwhine.housing.HousingError
        Where the case has nothing to fit, or its housing cannot be solved.
    """
    from gearwhine.results.update import update_arrays, update_document
    from gearwhine.solve import updating
    from gearwhine.solve.updating import updated_case

    solved = updating.update_housing(case, progress, null=null, held_back=held_back)
    document = update_document(case, solved)
    add_warnings(document, updating.noise_warnings(solved.misfit_after, solved.target.noise))

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        (place / "updated.toml").write_text(updated_case(case, solved), encoding="utf-8")
        return {}

    return Result(
        "update",
        case,
        solved,
        document,
        _arrays=lambda: update_arrays(case, solved),
        _files=files,
        _data_file="update.nc",
    )


def render(
    case: Case,
    modes: str | None = None,
    *,
    view: str = "auto",
    mode_format: ModeFormat = "png",
    lines: Sequence[float] = (),
    measured: bool = False,
    housing: HousingModes | None = None,
    folder: Path | None = None,
    fresh: bool = False,
    progress: Progress = silent,
) -> Result[HousingModes]:
    """Draw mode shapes, the housing's motion at lines of a run, or measured shapes beside the model's.

    Parameters
    ----------
    case : Case
    modes : str, optional
        ``dominant`` (by default, unless something else is asked for), ``all``, or numbers such as ``1,4,9``.
    view : str
        One of :data:`gearwhine.housing.pictures.views.VIEWS`; "auto" is for each shape the corner that shows most of
        its motion.
    mode_format : {"png", "glb", "gif", "mp4"}
        Pictures, models that move, or films; the result writes them.
    lines : sequence of float
        Frequencies of the run in ``folder`` [Hz].
    measured : bool
        Whether to draw measured shapes.
    housing, folder, fresh, progress
        As :func:`modes`.

    Raises
    ------
    CaseError
        Where something is asked for that cannot be drawn.
    gearwhine.housing.errors.RendererUnavailableError, gearwhine.housing.errors.EncoderUnavailableError
        Where no renderer or encoder is available.
    """
    modes = modes or (None if lines or measured else "dominant")
    check_request(case, modes, mode_format, lines, measured=measured)
    if measured:
        require_comparable(case)
    solved = _solved(case, "render", housing, folder, progress, fresh=fresh)
    comparison, survey = None, None
    if case.measured is not None:
        try:
            comparison, survey = compare_with_survey(case, solved, progress)
        except (CaseError, HousingError):
            if measured:
                raise  # else the modes are drawn without their measured partners
    document = origin_document(solved)

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        drawn: dict[str, Any] = {}
        if modes is not None:
            draw_modes(solved, comparison, modes, view, mode_format, place, progress)
        if lines and folder is not None:
            drawn["lines"] = draw_lines(solved, folder, lines, view, mode_format, place, progress)
        if measured:
            draw_measured(case, solved, comparison, survey, view, place)
        return drawn

    return Result("render", case, solved, document, _files=files, _housing=solved)


def _solved(
    case: Case, command: str, housing: HousingModes | None, folder: Path | None, progress: Progress, *, fresh: bool
) -> HousingModes:
    if housing is not None:
        return housing
    return solve_housing(case, progress, command=command, folder=folder, fresh=fresh)
