"""Measured data of a modal test: geometry, modes and responses; files; alignment, identification, planning.

- :class:`MeasuredGeometry`, :class:`MeasuredModes`, :class:`MeasuredResponses`, together :class:`SurveyData`.
- :func:`read_survey`, :func:`write_survey` -- universal files (through pyuff) and tables (CSV).
- :func:`align_landmarks`, :func:`align_to_surface` -- the survey's frame in the model's, as an :class:`Alignment`.
- :func:`identify_modes` -- modes from responses, by a :class:`StabilityRule`.
- :func:`map_survey` -- the survey on the model's surface, as a :class:`MappedSurvey`.
- :func:`candidate_points`, :func:`plan_survey`, :func:`planned_geometry` -- sensor placement, as a :class:`SurveyPlan`.
"""

from housing.measured.alignment import Alignment, align_landmarks, align_to_surface
from housing.measured.geometry import MeasuredGeometry
from housing.measured.identification import IdentifiedModes, identify_modes
from housing.measured.mapping import MappedSurvey, map_survey
from housing.measured.modes import MeasuredModes
from housing.measured.outer_surface import outer_facets
from housing.measured.planning import SurveyPlan, candidate_points, plan_survey, planned_geometry
from housing.measured.responses import MeasuredResponses, Motion
from housing.measured.rigid_fit import RigidMotion
from housing.measured.stable_poles import StabilityRule
from housing.measured.survey_data import SurveyData
from housing.measured.survey_file import read_survey, write_survey
from housing.measured.tables import read_table, write_table
from housing.measured.universal_reading import read_universal
from housing.measured.universal_writing import write_universal

__all__ = [
    "Alignment",
    "IdentifiedModes",
    "MappedSurvey",
    "MeasuredGeometry",
    "MeasuredModes",
    "MeasuredResponses",
    "Motion",
    "RigidMotion",
    "StabilityRule",
    "SurveyData",
    "SurveyPlan",
    "align_landmarks",
    "align_to_surface",
    "candidate_points",
    "identify_modes",
    "map_survey",
    "outer_facets",
    "plan_survey",
    "planned_geometry",
    "read_survey",
    "read_table",
    "read_universal",
    "write_survey",
    "write_table",
    "write_universal",
]
