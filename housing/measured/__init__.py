"""Measured data of a modal test: geometry, modes and responses; files; alignment, identification, planning.

- :class:`MeasuredGeometry`, :class:`MeasuredModes`, :class:`MeasuredResponses`, together :class:`SurveyData`.
- :func:`read_survey`, :func:`write_survey` -- universal files (through pyuff) and tables (CSV).
- :func:`align_landmarks`, :func:`align_to_surface` -- the survey's frame in the model's, as an :class:`Alignment`.
- :func:`identify_modes` -- modes from responses, by a :class:`StabilityRule`.
- :func:`map_survey` -- the survey on the model's surface, as a :class:`MappedSurvey`.
- :func:`candidate_points`, :func:`plan_survey`, :func:`planned_geometry` -- sensor placement, as a :class:`SurveyPlan`.
"""

from gearwhine.housing.fem.outer_facets import outer_facets as outer_facets
from gearwhine.housing.measured.alignment import Alignment as Alignment
from gearwhine.housing.measured.alignment import MappedSurvey as MappedSurvey
from gearwhine.housing.measured.alignment import RigidMotion as RigidMotion
from gearwhine.housing.measured.alignment import align_landmarks as align_landmarks
from gearwhine.housing.measured.alignment import align_to_surface as align_to_surface
from gearwhine.housing.measured.alignment import map_survey as map_survey
from gearwhine.housing.measured.identification import IdentifiedModes as IdentifiedModes
from gearwhine.housing.measured.identification import StabilityRule as StabilityRule
from gearwhine.housing.measured.identification import identify_modes as identify_modes
from gearwhine.housing.measured.survey_data import MeasuredGeometry as MeasuredGeometry
from gearwhine.housing.measured.survey_data import MeasuredModes as MeasuredModes
from gearwhine.housing.measured.survey_data import MeasuredResponses as MeasuredResponses
from gearwhine.housing.measured.survey_data import Motion as Motion
from gearwhine.housing.measured.survey_data import SurveyData as SurveyData
from gearwhine.housing.measured.survey_files import read_survey as read_survey
from gearwhine.housing.measured.survey_files import read_table as read_table
from gearwhine.housing.measured.survey_files import write_survey as write_survey
from gearwhine.housing.measured.survey_files import write_table as write_table
from gearwhine.housing.measured.survey_planning import SurveyPlan as SurveyPlan
from gearwhine.housing.measured.survey_planning import candidate_points as candidate_points
from gearwhine.housing.measured.survey_planning import plan_survey as plan_survey
from gearwhine.housing.measured.survey_planning import planned_geometry as planned_geometry
from gearwhine.housing.measured.universal_reading import read_universal as read_universal
from gearwhine.housing.measured.universal_writing import write_universal as write_universal
