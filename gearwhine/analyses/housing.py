"""Analyses of the housing: its mesh, its natural modes, and these beside measured ones."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.analyses.origin import Origin
from gearwhine.analyses.result import Result
from gearwhine.case import Case
from gearwhine.case.model import housing_table
from gearwhine.from_case.fixtures import build_fixtures
from gearwhine.from_case.mesh import build_mesh, material_of
from gearwhine.from_case.mesh_health import allowed_defects
from gearwhine.housing import HousingModes
from gearwhine.housing.correlation.comparison import Comparison
from gearwhine.housing.measured import MeasuredGeometry
from gearwhine.housing.modal_test import ComparedTest, PlannedSurvey, ResponseCorrelation, comparison_warnings
from gearwhine.housing.model_warnings import defect_warnings, resolution_warnings
from gearwhine.meshes import Mesh
from gearwhine.mode_pictures import ModeFormat, draw_lines, draw_measured, draw_modes
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.output.quantity import add_warnings
from gearwhine.results.comparison import (
    COMPARISON,
    comparison_document,
    responses_document,
    survey_document,
    write_comparison,
    write_response_correlation,
)
from gearwhine.results.housing import HOUSING, modes_document, write_shapes
from gearwhine.solve.comparison import write_plan

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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


def modes_result(housing: HousingModes, origin: Origin, *, detail: bool = False) -> Result[HousingModes]:
    """Return the result of the natural modes of a housing, certified complete.

    Parameters
    ----------
    housing : HousingModes
    origin : Origin
    detail : bool
        Whether to report effective masses, supports, and the modes that carry the bearings' forces as well.
    """

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        write_shapes(place / "modes.vtu", housing)
        return {}

    document = modes_document(housing, detail=detail)
    return replace(origin, housing=housing).result("modes", housing, document, (HOUSING, housing), files=files)


def compare_result(housing: HousingModes, compared: ComparedTest, origin: Origin) -> Result[Comparison]:
    """Return the result of measured modes and responses beside those of a housing."""
    comparison, survey, likeness = compared.comparison, compared.survey, compared.responses
    document = comparison_document(comparison, housing)
    if survey is not None:
        document["survey"] = survey_document(survey)
    document |= {} if likeness is None else {"responses": responses_document(likeness)}
    add_warnings(document, comparison_warnings(comparison, housing.modes, compared.test.modes))
    geometry = None if survey is None else survey.geometry
    origin = replace(origin, housing=housing)
    return comparison_result(origin, comparison, document, housing.modes.frequencies, geometry, likeness)


def comparison_result(
    origin: Origin,
    comparison: Comparison,
    document: dict[str, Any],
    frequencies: FloatArray,
    geometry: MeasuredGeometry | None,
    likeness: ResponseCorrelation | str | None = None,
) -> Result[Comparison]:
    """Return the result of measured modes beside those of a housing.

    Parameters
    ----------
    origin : Origin
    comparison : Comparison
    document : dict
    frequencies : ndarray, shape (n,)
        Circular frequencies of the housing's modes [rad/s].
    geometry : MeasuredGeometry or None
        Geometry of the survey.
    likeness : ResponseCorrelation or str, optional
        Correlation of the responses, which is written as a table, or the reason why there is none.
    """

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        write_comparison(place, comparison, geometry)
        if isinstance(likeness, ResponseCorrelation):
            write_response_correlation(place, likeness)
        return {}

    def figures(progress: Progress) -> "Iterator[tuple[str, Figure]]":
        from gearwhine.figures import draw_comparison_figures

        return draw_comparison_figures(origin.title, comparison, frequencies, geometry)

    arrays, data_file = (COMPARISON, comparison), "comparison.nc"
    return origin.result("compare", comparison, document, arrays, figures=figures, files=files, data_file=data_file)


def survey_result(housing: HousingModes, planned: PlannedSurvey, origin: Origin) -> Result[PlannedSurvey]:
    """Return the result of a survey that is planned for a housing."""
    from gearwhine.results.survey import plan_document

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        write_plan(place, planned)
        return {}

    return replace(origin, housing=housing).result("survey", planned, plan_document(planned, housing), files=files)


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
        (place / "updated.toml").write_text(updated_case(solved), encoding="utf-8")
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
    housing: HousingModes,
    origin: Origin,
    modes: str | None,
    *,
    view: str,
    mode_format: ModeFormat,
    compared: ComparedTest | None = None,
    lines: Sequence[float] = (),
    measured: bool = False,
    folder: Path | None = None,
    progress: Progress = silent,
) -> Result[HousingModes]:
    """Draw mode shapes, the housing's motion at lines of a run, or measured shapes beside the model's.

    Parameters
    ----------
    housing : HousingModes
    origin : Origin
    modes : str or None
        ``dominant``, ``all``, or numbers such as ``1,4,9``; None for none.
    view : str
        One of :data:`gearwhine.housing.pictures.views.VIEWS`; "auto" is for each shape the corner that shows most of
        its motion.
    mode_format : {"png", "glb", "gif", "mp4"}
        Pictures, models that move, or films; the result writes them.
    compared : ComparedTest, optional
        Measured partners of the modes.
    lines : sequence of float
        Frequencies of the run in ``folder`` [Hz].
    measured : bool
        Whether to draw measured shapes.
    folder : path, optional
        Results folder of the run.
    progress : callable

    Raises
    ------
    CaseError
        Where something is asked for that cannot be drawn.
    gearwhine.housing.errors.RendererUnavailableError, gearwhine.housing.errors.EncoderUnavailableError
        Where no renderer or encoder is available.
    """

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        drawn: dict[str, Any] = {}
        if modes is not None:
            comparison = None if compared is None else compared.comparison
            draw_modes(housing, comparison, modes, view, mode_format, place, progress)
        if lines and folder is not None:
            drawn["lines"] = draw_lines(housing, folder, lines, view, mode_format, place, progress)
        if measured:
            draw_measured(origin.title, housing, compared, view, place)
        return drawn

    return replace(origin, housing=housing).result("render", housing, {}, files=files)
