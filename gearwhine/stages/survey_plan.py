"""Survey planning on the housing modes: sensors, a hammer position, and files for a test program."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearwhine.case import Case, CaseError, Problem
from gearwhine.stages.attachments import build_supports
from gearwhine.stages.housing import SolvedHousing
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

_HERTZ = 2.0 * np.pi
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
    modes : ndarray of int
        Numbers of the modes to separate, from 1.
    """

    geometry: MeasuredGeometry
    candidates: MeasuredGeometry
    plan: SurveyPlan
    modes: list[int]


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
    return PlannedSurvey(planned_geometry(candidates, plan.sensors), candidates, plan, (elastic + 1).tolist())


def write_plan(place: Path, planned: PlannedSurvey) -> None:
    """The survey as a universal file (points, directions, trace lines) and as a table."""
    survey = SurveyData(planned.geometry)
    write_universal(place / _FILES[0], survey, points=15)
    write_table(place / _FILES[1], survey)


def plan_document(planned: PlannedSurvey, solved: SolvedHousing) -> dict[str, Any]:
    """The plan as the command's JSON."""
    plan, geometry = planned.plan, planned.geometry
    return {
        "modes": planned.modes,
        "modes_hz": (solved.modes.frequencies_hz[np.array(planned.modes) - 1]).tolist(),
        "candidates": len(planned.candidates.labels),
        "sensors": [
            {
                "point": label,
                "position_m": position.tolist(),
                "direction": direction.tolist(),
                "independence": float(share),
            }
            for label, position, direction, share in zip(
                geometry.labels, geometry.positions, geometry.directions, plan.independence, strict=True
            )
        ],
        "hammer": [
            {
                "position_m": planned.candidates.positions[index].tolist(),
                "direction": planned.candidates.directions[index].tolist(),
                "least_residue": float(residue),
            }
            for index, residue in zip(plan.driving_points, plan.residues, strict=True)
        ],
        "auto_mac_largest": plan.worst_likeness,
        "condition": plan.condition,
    }
