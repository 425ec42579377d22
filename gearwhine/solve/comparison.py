"""Comparison of a solved housing with the measured modes of its case, and the plan of a survey that measures them.

Measured modes are read, aligned, mapped to the model's degrees of freedom, and paired. Measured frequency responses are
compared with the model's at the same points by FRAC. A planned survey has sensors, a hammer position, and files for a
test program.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.case.errors import UNSAID
from gearwhine.case.measured import Measured
from gearwhine.case.measured import Pairing as PairingTable
from gearwhine.housing import HousingError, HousingModes, ModeSet, Support
from gearwhine.housing.correlation import frac, synthesised_responses
from gearwhine.housing.correlation.comparison import (
    Comparison,
    Pairing,
    compare_by_dominance,
    compare_by_frequency,
    compare_by_shapes,
    with_shapes,
)
from gearwhine.housing.correlation.pairing import PairingRule
from gearwhine.housing.measured import (
    Alignment,
    MappedSurvey,
    MeasuredGeometry,
    MeasuredModes,
    MeasuredResponses,
    SurveyData,
    SurveyPlan,
    align_landmarks,
    align_to_surface,
    candidate_points,
    identify_modes,
    map_survey,
    plan_survey,
    planned_geometry,
    write_table,
    write_universal,
)
from gearwhine.meshes import Mesh
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning

FloatArray = npt.NDArray[np.float64]

_TWO_PI = 2.0 * np.pi
_ABOVE = 1.05  # limit of the model's modes over the highest measured frequency, as for dominance
_CLEARER = 0.5  # error as a part of that of random frequencies, above which the nearest modes are no evidence

# Candidate places for each sensor, and the least number of all. With denser candidates the method chooses neighbours,
# which measure the same twice.
_PLACES, _FEWEST = 4, 100
_PLAN_FILES = ("survey.uff", "survey.csv")


def read_measured(case: Case, progress: Progress = silent) -> MeasuredModes:
    """Read the measured modes of a case: listed in it, stored in its file, or identified from the file's responses.

    Raises
    ------
    CaseError
        Where nothing is measured, or the responses hold no modes that are stable.
    """
    require(case, "measured", command="compare")
    measured = case.measured
    assert measured is not None
    if measured.survey is None:
        assert measured.frequencies is not None
        ratios = None if measured.damping_ratios is None else np.array(measured.damping_ratios)
        return MeasuredModes(_TWO_PI * np.array(measured.frequencies), ratios)
    if measured.survey.modes is not None:
        return measured.survey.modes
    assert measured.survey.responses is not None
    progress("finding modes in the measured responses")
    try:
        return identify_modes(measured.survey.responses).modes
    except HousingError as error:
        raise CaseError([Problem("measured.file", UNSAID, f"responses with modes in them; {error}")]) from error


def require_comparable(case: Case) -> None:
    """Refuse a housing whose modes will not be known as far as the measured ones are paired, before it is solved.

    Raises
    ------
    CaseError
        Where `frequency_limit` or `modes` are too low; nothing where the measured modes are not known yet.
    """
    measured, housing = case.measured, case.housing
    if measured is None or housing is None or (highest := _highest_measured_hz(measured)) is None:
        return
    count, expected = highest
    if measured.paired_by == "order":
        if housing.modes is not None and housing.modes < count:
            text = f"at least {count}, as many as are measured: the first of the model is paired with the first of them"
            raise CaseError([Problem("housing.modes", housing.modes, text)])
    elif housing.frequency_limit is not None and housing.frequency_limit < _ABOVE * expected:
        raise CaseError([_low_limit(housing.frequency_limit, _ABOVE * expected)])


def _highest_measured_hz(measured: Measured) -> tuple[int, float] | None:
    """Return the number of measured modes and the highest frequency [Hz]; None where they are yet to be identified."""
    if measured.frequencies is not None:
        return len(measured.frequencies), measured.frequencies[-1]
    modes = None if measured.survey is None else measured.survey.modes
    return None if modes is None else (len(modes.frequencies), float(modes.frequencies[-1]) / _TWO_PI)


def _low_limit(limit: float, highest: float) -> Problem:
    expected = (
        f"at least {highest:.5g} Hz: measured modes are paired with the model's up to there, and these are known only "
        "below the limit"
    )
    return Problem("housing.frequency_limit", f"{limit:.5g} Hz", expected)


def map_measured(case: Case, mesh: Mesh, geometry: MeasuredGeometry) -> MappedSurvey:
    """Put the survey of a case on its housing, aligned as the case says.

    Raises
    ------
    CaseError
        Where it cannot be aligned, or most of its points are far from the surface.
    """
    measured = case.measured
    assert measured is not None
    alignment: Alignment | None = None
    key = "align"
    try:
        if measured.align is True:
            alignment = align_to_surface(mesh, geometry)
        elif measured.align is not False:
            landmarks = {landmark.point: landmark.position for landmark in measured.align.landmarks}
            alignment = align_landmarks(geometry, landmarks)
        key = "file"
        return map_survey(mesh, geometry, alignment=alignment, tolerance=measured.tolerance)
    except HousingError as error:
        raise CaseError([Problem(f"measured.{key}", UNSAID, f"a survey of this housing; {error}")]) from error


def mapped_shapes(solved: HousingModes, survey: MappedSurvey) -> FloatArray:
    """Return the model's modes at the survey's degrees of freedom, mass-normalised, shape (n_modes, n_dofs)."""
    return survey.shapes(solved.modes.shapes)


def compare_housing(case: Case, solved: HousingModes, progress: Progress = silent) -> Comparison:
    """Pair the model's modes with the case's measured ones; see :func:`compare_with_survey`."""
    return compare_with_survey(case, solved, progress)[0]


def compare_with_survey(
    case: Case, solved: HousingModes, progress: Progress = silent
) -> tuple[Comparison, MappedSurvey | None]:
    """Pair the model's modes with the case's measured ones, as `[measured] pairing` says.

    Returns
    -------
    tuple
        The comparison, and the survey on the model; None without a survey.

    Raises
    ------
    CaseError
        Where nothing is measured, the survey does not fit the housing, or the modes cannot be compared.
    gearwhine.housing.HousingError
        Where the model has too few modes in the band.
    """
    measured = read_measured(case, progress)
    assert case.measured is not None
    pairing = case.measured.paired_by
    if measured.geometry is None:
        return pair_modes(solved, measured, pairing=pairing), None
    survey = map_measured(case, solved.mesh, measured.geometry)
    table = case.measured.pairing
    rule = PairingRule(**table.model_dump()) if isinstance(table, PairingTable) else None
    return pair_modes(solved, measured, mapped_shapes(solved, survey), rule, pairing=pairing), survey


def comparison_warnings(comparison: Comparison, modes: ModeSet) -> list[dict[str, Any]]:
    """Warn of measured modes without a partner, and of pairs that are weak evidence or hang on the mesh."""
    warnings = _mesh_dependence(comparison, modes)
    if comparison.unpaired_measured:
        numbers = ", ".join(
            f"{mode.number} ({mode.frequency / _TWO_PI:.5g} Hz)" for mode in comparison.unpaired_measured
        )
        message = f"the model has fewer modes than were measured; without a partner: {numbers}"
        warnings.append(warning("unpaired modes", message, modes=len(comparison.unpaired_measured)))
    if comparison.pairing == "nearest" and comparison.chance_error_percent is not None:
        chance, rms = comparison.chance_error_percent, comparison.rms_error_percent
        message = (
            f"paired by nearest frequencies, which is weak evidence: a frequency at random in the band is "
            f"{chance:.2g} % from a mode of the model (rms), the measured ones are {rms:.2g} %"
        )
        if rms > _CLEARER * chance:
            message += "; such errors do not tell this model from another: measure shapes"
        warnings.append(warning("weak pairing", message, rms_error_percent=rms, chance_error_percent=chance))
    return warnings


def _mesh_dependence(comparison: Comparison, modes: ModeSet) -> list[dict[str, Any]]:
    """Warn of pairs by frequency or dominance whose modes lie closer to others than their errors by the mesh.

    By its estimated error e a mode at f lies between f (1 - e) and f on a fine mesh. Where two of these ranges overlap
    the modes may change places, and in the pairing by nearest frequencies another mode may come nearest.
    """
    errors = modes.discretisation_errors
    if errors is None or comparison.pairing == "shapes":
        return []
    upper = modes.frequencies
    lower = upper * (1.0 - np.minimum(errors, 0.9))
    doubtful = []
    for pair in comparison.pairs:
        mode = pair.mode - 1
        overlap = (lower <= upper[mode]) & (lower[mode] <= upper)
        nearest = int(np.argmin(np.abs(np.log(lower / pair.measured))))
        if overlap.sum() > 1 or (comparison.pairing == "nearest" and nearest != mode):
            doubtful.append(pair.mode)
    if not doubtful:
        return []
    listed = ", ".join(map(str, doubtful))
    message = (
        f"pairs may change with the mesh: model mode{'s' * (len(doubtful) > 1)} {listed} may change places with "
        "neighbours, which lie nearer than the estimated errors by the mesh; a smaller mesh_size tells"
    )
    return [warning("pairs by the mesh", message, modes=doubtful)]


@dataclass(frozen=True)
class ResponseCorrelation:
    """FRAC of every measured response; see :func:`gearwhine.housing.correlation.frac`.

    Attributes
    ----------
    geometry : MeasuredGeometry
        Points and directions of the motions.
    references : MeasuredGeometry
        Points and directions of the forces.
    band : tuple of float
        Frequencies of the first and the last line compared [rad/s].
    n_lines : int
    frac : ndarray, shape (n_dofs, n_references)
        FRAC of each pair; NaN where it was not measured.
    """

    geometry: MeasuredGeometry
    references: MeasuredGeometry
    band: tuple[float, float]
    n_lines: int
    frac: FloatArray

    @property
    def n_measured(self) -> int:
        """Number of responses that were measured."""
        return int(np.count_nonzero(np.isfinite(self.frac)))

    @property
    def mean(self) -> float | None:
        """Mean FRAC of the measured responses; None without any."""
        is_measured = np.isfinite(self.frac)
        return float(self.frac[is_measured].mean()) if is_measured.any() else None


def compare_responses(
    case: Case, solved: HousingModes, survey: MappedSurvey, responses: MeasuredResponses
) -> ResponseCorrelation:
    """Compare the model's responses, with its own damping, with measured ones up to where its modes are complete.

    Parameters
    ----------
    case : Case
    solved : HousingModes
    survey : MappedSurvey
        Degrees of freedom of the motions on the model.
    responses : MeasuredResponses

    Raises
    ------
    gearwhine.housing.HousingError
        Where no two lines are left, a force was applied off the surface, or a mode has no damping at its own frequency.
    """
    limit = solved.modes.certificate.limit
    lines = np.flatnonzero((responses.frequencies > 0.0) & (responses.frequencies <= limit))
    if len(lines) < 2:
        raise HousingError(
            f"the responses have {len(lines)} lines between 0 and {limit / _TWO_PI:.0f} Hz, up to where the model's "
            "modes are known: expected two at least"
        )
    forces = replace(
        responses.geometry, points=responses.reference_points, directions=responses.reference_directions, lines=()
    )
    measured = case.measured
    tolerance = None if measured is None else measured.tolerance
    driven = map_survey(solved.mesh, forces, alignment=survey.alignment, tolerance=tolerance)
    frequencies = responses.frequencies[lines]
    model = synthesised_responses(
        solved.modes, solved.total_damping_ratios, driven.matrix, survey.matrix, frequencies, responses.motion
    )
    return ResponseCorrelation(
        geometry=responses.geometry,
        references=forces,
        band=(float(frequencies[0]), float(frequencies[-1])),
        n_lines=len(lines),
        frac=frac(model, responses.values[:, :, lines]),
    )


def compare_responses_document(
    case: Case, solved: HousingModes, survey: MappedSurvey
) -> ResponseCorrelation | str | None:
    """Correlation of a case's frequency responses, or the reason why there is none; None without measured responses."""
    measured = case.measured
    responses = None if measured is None or measured.survey is None else measured.survey.responses
    if responses is None:
        return None
    try:
        return compare_responses(case, solved, survey, responses)
    except HousingError as error:  # of the responses: the pairs of modes stand without them
        return str(error)


def pair_modes(
    solved: HousingModes,
    measured: MeasuredModes,
    shapes: FloatArray | None = None,
    rule: PairingRule | None = None,
    *,
    pairing: Pairing | None = None,
) -> Comparison:
    """Pair the model's modes with measured ones.

    Parameters
    ----------
    solved : HousingModes
    measured : housing.measured.MeasuredModes
    shapes : ndarray, shape (n_modes, n_dofs), optional
        The model's shapes at the measured degrees of freedom [1/√kg], where ``measured`` has shapes.
    rule : PairingRule, optional
        Rule of the pairing by shape.
    pairing : {"order", "nearest", "dominance", "shapes"}, optional
        By default "shapes" where there are some, else "nearest".

    Raises
    ------
    CaseError
        Where the model's modes are not known as high as the measured ones, or the housing lacks the seats between
        which and the skin modes are dominant.
    gearwhine.housing.HousingError
        Where the model has too few modes in the band, or its shapes do not fit the measured ones.
    """
    pairing = pairing or ("nearest" if measured.shapes is None or shapes is None else "shapes")
    model, highest = solved.modes.frequencies, _ABOVE * float(measured.frequencies[-1])
    if pairing != "order" or np.count_nonzero(model > 0.0) < len(measured.frequencies):
        _require_modes_up_to(solved, highest)
    if pairing == "shapes":
        assert shapes is not None
        return compare_by_shapes(model, shapes, measured, rule=rule, strengths=solved.strengths)
    if pairing == "dominance":
        comparison = _compare_by_dominance(solved, measured.frequencies)
    else:
        comparison = compare_by_frequency(measured.frequencies, model, pairing, strengths=solved.strengths)
    return comparison if shapes is None else with_shapes(comparison, model, shapes, measured)


def _compare_by_dominance(solved: HousingModes, frequencies: FloatArray) -> Comparison:
    if solved.strengths is None:
        raise CaseError(
            [Problem("housing.seat", (), "bearing seats: dominance is the strength between seats and skin")]
        )
    return compare_by_dominance(frequencies, solved.strengths)


def _require_modes_up_to(solved: HousingModes, highest: float) -> None:
    limit = solved.modes.certificate.limit
    if limit < highest:
        raise CaseError([_low_limit(limit / _TWO_PI, highest / _TWO_PI)])


@dataclass(frozen=True)
class PlannedSurvey:
    """Planned survey and its quality.

    Attributes
    ----------
    geometry : MeasuredGeometry
        Sensors, the best first.
    candidates : MeasuredGeometry
    plan : SurveyPlan
    modes : list of int
        Numbers of the modes to separate, from 1.
    frequencies_hz : ndarray, shape (n_modes,)
        Natural frequencies of these modes [Hz].
    """

    geometry: MeasuredGeometry
    candidates: MeasuredGeometry
    plan: SurveyPlan
    modes: list[int]
    frequencies_hz: npt.NDArray[np.float64]


def plan_housing(case: Case, solved: HousingModes, sensors: int, modes: int | None = None) -> PlannedSurvey:
    """Plan a survey of the lowest modes that bend the housing.

    Parameters
    ----------
    case : Case
    solved : HousingModes
    sensors : int
    modes : int, optional
        Number of modes; all that are known where not given. Rigid motions of a free housing are left out.

    Raises
    ------
    CaseError
        Where the sensors cannot separate the modes.
    """
    elastic = np.flatnonzero(solved.modes.frequencies > 0.0)[:modes]
    housing = solved.housing
    seats = [block for seat in housing.seats for block in solved.mesh.surface(seat.name)]
    supports = [fixture for fixture in housing.fixtures if isinstance(fixture, Support)]
    supported = [block for support in supports for block in support.facets(solved.mesh)]
    try:
        candidates = candidate_points(solved.mesh, max(_FEWEST, _PLACES * sensors), without=(*seats, *supported))
        shapes = map_survey(solved.mesh, candidates).shapes(solved.modes.shapes[elastic])
        plan = plan_survey(shapes, sensors)
    except HousingError as error:
        raise CaseError([Problem("--sensors", str(sensors), f"sensors that can be placed; {error}")]) from error
    geometry = planned_geometry(candidates, plan.sensors)
    frequencies = solved.modes.frequencies_hz[elastic]
    return PlannedSurvey(geometry, candidates, plan, (elastic + 1).tolist(), frequencies)


def write_plan(place: Path, planned: PlannedSurvey) -> None:
    """Write the survey plan as a universal file (points, directions, trace lines) and as a table."""
    survey = SurveyData(planned.geometry)
    write_universal(place / _PLAN_FILES[0], survey, points=15)
    write_table(place / _PLAN_FILES[1], survey)
