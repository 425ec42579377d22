"""Survey planning on the housing modes: sensors, a hammer position, and files for a test program."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, CaseError, Problem
from gearwhine.from_case.fixtures import build_supports
from gearwhine.solve.housing_modes import SolvedHousing
from housing import HousingError
from housing.measured import (
    MeasuredGeometry,
    SurveyData,
    SurveyPlan,
    candidate_points,
    map_survey,
    plan_survey,
    planned_geometry,
    write_table,
    write_universal,
)

# Places looked at for each sensor, and in all at least: more of them stand closer, and the method takes neighbours,
# which say the same twice.
_PLACES, _FEWEST = 4, 100
_FILES = ("survey.uff", "survey.csv")


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


def plan_housing(case: Case, solved: SolvedHousing, sensors: int, modes: int | None = None) -> PlannedSurvey:
    """Plan a survey of the lowest modes that bend the housing.

    Parameters
    ----------
    case : Case
    solved : SolvedHousing
    sensors : int
    modes : int, optional
        Number of modes; all that are known where not given. Rigid motions of a free housing are left out.

    Raises
    ------
    CaseError
        Where the sensors cannot separate the modes.
    """
    elastic = np.flatnonzero(solved.modes.frequencies > 0.0)[:modes]
    seats = [block for name in solved.seats for block in solved.mesh.surface(name)]
    held = [block for support in build_supports(case) for block in support.facets(solved.mesh)]
    try:
        candidates = candidate_points(solved.mesh, max(_FEWEST, _PLACES * sensors), without=(*seats, *held))
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
    write_universal(place / _FILES[0], survey, points=15)
    write_table(place / _FILES[1], survey)
