"""Gears: tooth geometry, tooth stiffness, tooth contact law and loaded transmission error.

The steps, each usable alone:

>>> from coupling.gears import Gear, GearPairGeometry, PotentialEnergyStiffness
>>> from coupling.gears import loaded_transmission_error, tooth_contact
>>> wheel = Gear("wheel", teeth=62, module=2e-3, pressure_angle=0.349066, face_width=20e-3, bore=35e-3)
>>> pair = GearPairGeometry(wheel, wheel)  # path of contact, working angle, backlash
>>> contact = tooth_contact(pair, PotentialEnergyStiffness())  # contact law: k(s), d(s), damping
>>> loaded = loaded_transmission_error(contact, force=2000.0)  # mesh stiffness, sharing
>>> round(pair.contact_ratio, 4)
1.7898

The compiled law is `coupling.gears.kernels.tooth_force`; it alone imports numba and is not imported here.
Positions along the path of contact are in base pitches, phases in mesh periods, everything else in SI.
"""

from coupling.gears.blank import Inertia
from coupling.gears.centre_distance import profile_shift_sum, shifted_for_centre_distance, tip_shortening
from coupling.gears.compliant_teeth import CompliantTeeth, ToothCompliance
from coupling.gears.cornell import CornellStiffness
from coupling.gears.corner_contact import FlankContactPoints, corner_contact_range, flank_contact_points
from coupling.gears.crack import ToothCrack
from coupling.gears.damping import equivalent_mass, mesh_damping
from coupling.gears.deviation import flank_gap, pair_deviation
from coupling.gears.elastic_ring import ElasticRingStiffness
from coupling.gears.errors import (
    ContactAccuracyError,
    GearError,
    InterferenceError,
    MismatchedGearsError,
    NoContactError,
    PointedToothError,
    StiffnessModelError,
    ThinTipError,
    UndercutError,
)
from coupling.gears.face_slices import FaceSlices, face_slices
from coupling.gears.faults import MissingTooth, Spall, Wear
from coupling.gears.flank_errors import HelixDeviation, ProfileDeviation
from coupling.gears.foundation import RootSection, foundation_compliance, within_fitted_range
from coupling.gears.friction import MeshFriction, mesh_friction
from coupling.gears.gear_contact import tooth_contact
from coupling.gears.geometry import Fault, Gear, require_tip_thickness
from coupling.gears.harris_map import HarrisMap, harris_map, transmission_error_harmonics
from coupling.gears.hertz import LineContact, hertz_compliance, line_contact
from coupling.gears.hunting import hunting_period_mesh
from coupling.gears.involute import inverse_involute, involute
from coupling.gears.iso6336 import Iso6336Stiffness, Iso6336Values, iso6336_stiffness
from coupling.gears.modifications import RootRelief, TipRelief
from coupling.gears.optimal_relief import PeakToPeak, ReliefAim, ReliefOptimum, WeightedHarmonics, optimal_tip_relief
from coupling.gears.outline import gear_outline, meshing_rotations, pair_outlines
from coupling.gears.pair_curves import ToothPairCurves
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.path_of_contact import POINTS_OF_CONTACT, PathOfContact, path_of_contact, specific_sliding
from coupling.gears.piecewise import PiecewiseCubic
from coupling.gears.pitch_gaps import back_flank_pitch_gaps, pitch_gaps
from coupling.gears.pressure import (
    contact_curvature_radius,
    contact_modulus,
    contact_pressure,
    mesh_pressure,
)
from coupling.gears.profile import tooth_outline
from coupling.gears.runout import runout_error
from coupling.gears.sliding import SlidingFriction, sliding_friction
from coupling.gears.static import (
    LoadedMesh,
    loaded_transmission_error,
    mesh_period_phases,
    mesh_stiffness,
)
from coupling.gears.stiffness_models import (
    STIFFNESS_MODELS,
    ConstantStiffness,
    SquareStiffness,
    StiffnessModel,
    TableStiffness,
    stiffness_model,
)
from coupling.gears.thickness import (
    BallMeasurement,
    ChordalThickness,
    SpanMeasurement,
    chordal_thickness,
    normal_tooth_thickness,
    over_balls,
    pointed_radius,
    span_measurement,
    tooth_thickness,
)
from coupling.gears.tooth_compliance import PotentialEnergyStiffness
from coupling.gears.tooth_contact import PairStates, ToothContact
from coupling.gears.tooth_size import module_from_base_radius, module_from_diametral_pitch
from coupling.gears.weber_banaschek import WeberBanaschekStiffness

__all__ = [
    "POINTS_OF_CONTACT",
    "STIFFNESS_MODELS",
    "BallMeasurement",
    "ChordalThickness",
    "CompliantTeeth",
    "ConstantStiffness",
    "ContactAccuracyError",
    "CornellStiffness",
    "ElasticRingStiffness",
    "FaceSlices",
    "Fault",
    "FlankContactPoints",
    "Gear",
    "GearError",
    "GearPairGeometry",
    "HarrisMap",
    "HelixDeviation",
    "Inertia",
    "InterferenceError",
    "Iso6336Stiffness",
    "Iso6336Values",
    "LineContact",
    "LoadedMesh",
    "MeshFriction",
    "MismatchedGearsError",
    "MissingTooth",
    "NoContactError",
    "PairStates",
    "PathOfContact",
    "PeakToPeak",
    "PiecewiseCubic",
    "PointedToothError",
    "PotentialEnergyStiffness",
    "ProfileDeviation",
    "ReliefAim",
    "ReliefOptimum",
    "RootRelief",
    "RootSection",
    "SlidingFriction",
    "Spall",
    "SpanMeasurement",
    "SquareStiffness",
    "StiffnessModel",
    "StiffnessModelError",
    "TableStiffness",
    "ThinTipError",
    "TipRelief",
    "ToothCompliance",
    "ToothContact",
    "ToothCrack",
    "ToothPairCurves",
    "UndercutError",
    "Wear",
    "WeberBanaschekStiffness",
    "WeightedHarmonics",
    "back_flank_pitch_gaps",
    "chordal_thickness",
    "contact_curvature_radius",
    "contact_modulus",
    "contact_pressure",
    "corner_contact_range",
    "equivalent_mass",
    "face_slices",
    "flank_contact_points",
    "flank_gap",
    "foundation_compliance",
    "gear_outline",
    "harris_map",
    "hertz_compliance",
    "hunting_period_mesh",
    "inverse_involute",
    "involute",
    "iso6336_stiffness",
    "line_contact",
    "loaded_transmission_error",
    "mesh_damping",
    "mesh_friction",
    "mesh_period_phases",
    "mesh_pressure",
    "mesh_stiffness",
    "meshing_rotations",
    "module_from_base_radius",
    "module_from_diametral_pitch",
    "normal_tooth_thickness",
    "optimal_tip_relief",
    "over_balls",
    "pair_deviation",
    "pair_outlines",
    "path_of_contact",
    "pitch_gaps",
    "pointed_radius",
    "profile_shift_sum",
    "require_tip_thickness",
    "runout_error",
    "shifted_for_centre_distance",
    "sliding_friction",
    "span_measurement",
    "specific_sliding",
    "stiffness_model",
    "tip_shortening",
    "tooth_contact",
    "tooth_outline",
    "tooth_thickness",
    "transmission_error_harmonics",
    "within_fitted_range",
]
