"""The housing: from a mesh to modes that are proved complete, ports, comparison with measured modes, pictures.

What the room offers:

- :class:`Material`, :func:`assemble` -- stiffness and mass (:class:`Matrices`) of a meshed solid.
- :class:`Support`, :func:`fixed_freedoms` -- what holds it; :class:`Mount`, :class:`Joint`, :class:`LumpedMass`, each
  on a :class:`Patch` -- what else is fastened to it; :func:`attach` -- the matrices with all of these.
- :func:`bolted_joint` -- the springs that a preloaded bolt and the parts under its head stand for.
- :func:`rigid_body` -- mass, centre of gravity and inertia of the whole (:class:`RigidBody`).
- :func:`solve_modes` -- its natural modes (:class:`ModeSet`) with a :class:`Certificate`; :func:`modal_damping` -- what
  dashpots do to them.
- :class:`Seat`, :func:`seat_matrix`, :class:`Sensor`, :func:`sensor_port` -- where the rest of the machine meets it.
- :func:`survey_grid`, :func:`dominance`, :func:`compare_by_dominance` -- model against measured modes.
- ``housing.pictures`` -- mode shapes off-screen; not imported here, because it brings VTK.
"""

from housing.assembly import assemble
from housing.attachments import Attachment, attach
from housing.bolts import BoltedJoint, bolted_joint
from housing.bushings import GLOBAL_AXES, Axial, Bushing, Joint, Mount, axes_along
from housing.comparison import Comparison, ModePair, compare_by_dominance
from housing.damping import damping_ratios, modal_damping
from housing.dominance import Dominance, dominance
from housing.errors import FactorizationError, HousingError, IncompleteModesError
from housing.factorization import Factorization, Factorizer
from housing.lumped_mass import NO_INERTIA, LumpedMass
from housing.material import Material
from housing.matrices import Matrices
from housing.modes import Certificate, ModeSet, solve_modes
from housing.node_blocks import Additions, NodeBlocks
from housing.patches import Patch, patch_center, patch_matrix, point_matrix
from housing.ports import Seat, Sensor, SensorPort, seat_matrix, sensor_port
from housing.rigid import RigidBody, rigid_body, rigid_motions
from housing.supports import Support, fixed_freedoms
from housing.survey import SURVEY_COUNTS, Survey, survey_grid

__all__ = [
    "GLOBAL_AXES",
    "NO_INERTIA",
    "SURVEY_COUNTS",
    "Additions",
    "Attachment",
    "Axial",
    "BoltedJoint",
    "Bushing",
    "Certificate",
    "Comparison",
    "Dominance",
    "Factorization",
    "FactorizationError",
    "Factorizer",
    "HousingError",
    "IncompleteModesError",
    "Joint",
    "LumpedMass",
    "Material",
    "Matrices",
    "ModePair",
    "ModeSet",
    "Mount",
    "NodeBlocks",
    "Patch",
    "RigidBody",
    "Seat",
    "Sensor",
    "SensorPort",
    "Support",
    "Survey",
    "assemble",
    "attach",
    "axes_along",
    "bolted_joint",
    "compare_by_dominance",
    "damping_ratios",
    "dominance",
    "fixed_freedoms",
    "modal_damping",
    "patch_center",
    "patch_matrix",
    "point_matrix",
    "rigid_body",
    "rigid_motions",
    "seat_matrix",
    "sensor_port",
    "solve_modes",
    "survey_grid",
]
