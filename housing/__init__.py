"""Housing: finite-element model, natural modes proved complete, correlation with measured modes, pictures.

- :class:`Housing` -- mesh, materials, fixtures, seats and sensors in one description; its :meth:`~Housing.modes` are
  certified :class:`HousingModes`.
- :class:`Material`; :class:`Support`, :class:`Mount` and :class:`Joint` (with a :class:`Bushing`), :class:`LumpedMass`,
  each on a :class:`Patch` -- fixtures; :func:`bolted_joint`, :func:`cover_joints` -- preloaded bolts.
- :class:`Seat`, :class:`Sensor` -- the ports at which the rest of the machine meets it.
- :func:`assemble`, :func:`attach_fixtures` -- stiffness and mass of the solid, and of the solid with its fixtures.
- :func:`solve_modes` -- its natural modes (:class:`ModeSet`) with a :class:`Certificate`, by block Lanczos or scipy's
  ``eigsh``; :func:`modal_damping` -- their damping by dashpots.
- :func:`add_residual_modes` -- residual attachment modes, which make the static compliance at ports exact.
- :func:`receptance`, :func:`effective_mass` -- frequency response between ports, and effective modal masses.
- :func:`health_report` -- mass, rigid motions, grounding, orthogonality, static error: each with its bound.
- :func:`write_modes`, :func:`read_modes` -- a solved housing on file.
- :func:`compare_by_dominance`, :func:`compare_by_shapes` -- correlation of model and measured modes.

Further sub-modules: ``housing.correlation`` (assurance criteria), ``housing.measured`` (files of measured modes and
responses, identification, alignment), ``housing.updating`` (model updating); pictures, animations and 3D models of mode
shapes, which are not imported here because they bring VTK.
"""

from housing.assembly import assemble
from housing.attachments import Fixture, attach_fixtures
from housing.bolts import BoltedJoint, bolted_joint
from housing.bushings import GLOBAL_AXES, Axial, Bushing, Joint, Mount, axes_along
from housing.certificate import Certificate
from housing.correlation import (
    Comparison,
    ModePair,
    PairingRule,
    ShapeCorrelation,
    compare_by_dominance,
    compare_by_shapes,
)
from housing.damping import damping_ratios, modal_damping
from housing.dominance import Dominance, dominance
from housing.effective_mass import EffectiveMass, effective_mass
from housing.enclosure import enclosed_volume
from housing.errors import (
    FactorizationError,
    HealthError,
    HousingError,
    IncompleteModesError,
    MeasuredDataError,
    ModeFileError,
    ReductionError,
)
from housing.factorization import Factorization, Factorizer
from housing.grounding import Grounding, SupportHold
from housing.health import HealthLine, HealthReport, health_report
from housing.labelled import LabelledArray, content_key
from housing.lumped_mass import NO_INERTIA, LumpedMass
from housing.mass import MassProperties, mass_properties
from housing.material import Material
from housing.matrices import Matrices
from housing.mesh_arrays import mesh_digest
from housing.mode_file import read_modes, write_modes
from housing.mode_record import ModeRecord, with_sensors
from housing.model import RESPONSE_ORDERS, Housing, HousingModes, bearing_port, cover_joints
from housing.modes import ModeSet, solve_modes
from housing.node_blocks import Additions, NodeBlocks
from housing.patches import Patch, patch_center, patch_matrix, point_matrix
from housing.port_attachments import add_residual_modes
from housing.ports import Seat, Sensor, SensorPort, seat_matrix, sensor_port
from housing.receptance import Selection, receptance, residues, select_modes
from housing.reduction import ResidualModes, StaticProof
from housing.response_span import leading_residual_modes
from housing.rigid import RigidBody, rigid_body, rigid_motions
from housing.supports import Support, fixed_freedoms
from housing.survey import SURVEY_COUNTS, Survey, survey_grid

__all__ = [
    "GLOBAL_AXES",
    "NO_INERTIA",
    "RESPONSE_ORDERS",
    "SURVEY_COUNTS",
    "Additions",
    "Axial",
    "BoltedJoint",
    "Bushing",
    "Certificate",
    "Comparison",
    "Dominance",
    "EffectiveMass",
    "Factorization",
    "FactorizationError",
    "Factorizer",
    "Fixture",
    "Grounding",
    "HealthError",
    "HealthLine",
    "HealthReport",
    "Housing",
    "HousingError",
    "HousingModes",
    "IncompleteModesError",
    "Joint",
    "LabelledArray",
    "LumpedMass",
    "MassProperties",
    "Material",
    "Matrices",
    "MeasuredDataError",
    "ModeFileError",
    "ModePair",
    "ModeRecord",
    "ModeSet",
    "Mount",
    "NodeBlocks",
    "PairingRule",
    "Patch",
    "ReductionError",
    "ResidualModes",
    "RigidBody",
    "Seat",
    "Selection",
    "Sensor",
    "SensorPort",
    "ShapeCorrelation",
    "StaticProof",
    "Support",
    "SupportHold",
    "Survey",
    "add_residual_modes",
    "assemble",
    "attach_fixtures",
    "axes_along",
    "bearing_port",
    "bolted_joint",
    "compare_by_dominance",
    "compare_by_shapes",
    "content_key",
    "cover_joints",
    "damping_ratios",
    "dominance",
    "effective_mass",
    "enclosed_volume",
    "fixed_freedoms",
    "health_report",
    "leading_residual_modes",
    "mass_properties",
    "mesh_digest",
    "modal_damping",
    "patch_center",
    "patch_matrix",
    "point_matrix",
    "read_modes",
    "receptance",
    "residues",
    "rigid_body",
    "rigid_motions",
    "seat_matrix",
    "select_modes",
    "sensor_port",
    "solve_modes",
    "survey_grid",
    "with_sensors",
    "write_modes",
]
