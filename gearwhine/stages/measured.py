"""Measured modes of a case: read, aligned with the model, and mapped to its degrees of freedom."""

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
