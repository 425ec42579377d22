"""Measured modes of a case: read, aligned with the model, and mapped to its degrees of freedom."""

from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.case.problems import UNSAID
from gearwhine.progress import Progress, silent
from gearwhine.stages.housing import SolvedHousing
from housing import HousingError
from housing.measured import (
    Alignment,
    MappedSurvey,
    MeasuredGeometry,
    MeasuredModes,
    align_landmarks,
    align_to_surface,
    identify_modes,
    map_survey,
)
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi


def read_measured(case: Case, progress: Progress = silent) -> MeasuredModes:
    """The measured modes of a case: listed in it, read from its file, or found in the file's responses.

    Raises
    ------
    CaseError
        Where nothing is measured, or the responses hold no modes that are stable.
    """
    require(case, "measured", command="compare")
    given = case.measured
    assert given is not None
    if given.survey is None:
        assert given.frequencies is not None
        ratios = None if given.damping_ratios is None else np.array(given.damping_ratios)
        return MeasuredModes(_HERTZ * np.array(given.frequencies), ratios)
    if given.survey.modes is not None:
        return given.survey.modes
    assert given.survey.responses is not None
    progress("finding modes in the measured responses")
    try:
        return identify_modes(given.survey.responses).modes
    except HousingError as error:
        raise CaseError([Problem("measured.file", UNSAID, f"responses with modes in them; {error}")]) from error


def map_measured(case: Case, mesh: Mesh, geometry: MeasuredGeometry) -> MappedSurvey:
    """Put the survey of a case on its housing, aligned as the case says.

    Raises
    ------
    CaseError
        Where it cannot be aligned, or most of its points are far from the surface.
    """
    given = case.measured
    assert given is not None
    alignment: Alignment | None = None
    key = "align"
    try:
        if given.align is True:
            alignment = align_to_surface(mesh, geometry)
        elif given.align is not False:
            landmarks = {landmark.point: landmark.position for landmark in given.align.landmarks}
            alignment = align_landmarks(geometry, landmarks)
        key = "file"
        return map_survey(mesh, geometry, alignment=alignment, tolerance=given.tolerance)
    except HousingError as error:
        raise CaseError([Problem(f"measured.{key}", UNSAID, f"a survey of this housing; {error}")]) from error


def mapped_shapes(solved: SolvedHousing, survey: MappedSurvey) -> FloatArray:
    """The model's modes at the survey's degrees of freedom, mass-normalised, shape (n_modes, n_dofs)."""
    return survey.shapes(solved.modes.shapes)


def measured_document(case: Case) -> dict[str, Any]:
    """Measured modes of a case, before anything is solved."""
    given = case.measured
    assert given is not None
    if given.survey is None:
        return {"frequencies_hz": list(given.frequencies or ())}
    survey = given.survey
    document: dict[str, Any] = {"file": str(given.file), "remarks": list(survey.remarks)}
    if survey.modes is not None:
        ratios = survey.modes.damping_ratios
        document["frequencies_hz"] = (survey.modes.frequencies / _HERTZ).tolist()
        document["damping_ratios"] = None if ratios is None else ratios.tolist()
        document["complex"] = survey.modes.shapes is not None and bool(np.any(np.nan_to_num(survey.modes.shapes).imag))
    if survey.geometry is not None:
        points = survey.geometry.positions
        document |= {
            "points": len(points),
            "degrees_of_freedom": len(survey.geometry.points),
            "extent_m": np.ptp(points, axis=0).tolist(),
            "align": given.align if isinstance(given.align, bool) else "landmarks",
        }
    if survey.responses is not None:
        lines = survey.responses.frequencies / _HERTZ
        document["responses"] = {
            "of": survey.responses.motion,
            "references": len(survey.responses.reference_points),
            "lines": len(lines),
            "from_hz": float(lines[0]),
            "to_hz": float(lines[-1]),
        }
    return document


def survey_document(survey: MappedSurvey) -> dict[str, Any]:
    """Alignment of a survey with the model, as the command's JSON."""
    document: dict[str, Any] = {
        "points": len(survey.distances),
        "degrees_of_freedom": survey.matrix.shape[0],
        "rms_distance_m": survey.rms_distance,
        "worst_distance_m": float(survey.distances.max()),
        "worst_point": survey.geometry.labels[int(np.argmax(survey.distances))],
        "tolerance_m": survey.tolerance,
        "far_points": list(survey.far),
    }
    if (alignment := survey.alignment) is not None:
        document["alignment"] = {
            "by": alignment.by,
            "rotation": alignment.motion.rotation.tolist(),
            "translation_m": alignment.motion.translation.tolist(),
            "turned_degrees": alignment.motion.angle_degrees,
            "rms_m": alignment.rms,
            "largest_m": alignment.largest,
            "other_positions": len(alignment.others),
            "remarks": list(alignment.remarks),
        }
    return document
