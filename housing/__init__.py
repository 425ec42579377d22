"""The housing: from a mesh to modes that are proved complete, ports, comparison with measured modes, pictures.

What the room offers:

- :class:`Material`, :func:`assemble` -- stiffness and mass (:class:`Matrices`) of a meshed solid.
- :class:`Support`, :func:`with_springs`, :func:`fixed_freedoms` -- what holds it.
- :func:`solve_modes` -- its natural modes (:class:`ModeSet`) with a :class:`Certificate`.
- :class:`Seat`, :func:`seat_matrix`, :class:`Sensor`, :func:`sensor_port` -- where the rest of the machine meets it.
- :func:`attach_ports` -- residual :class:`Attachments`, which make the static compliance at ports exact.
- :func:`receptance`, :func:`select_modes`, :func:`effective_mass` -- what each mode carries between ports, and of mass.
- :func:`health_report` -- mass, rigid motions, grounding, orthogonality, static error: each with its bound.
- :func:`survey_grid`, :func:`dominance`, :func:`compare_by_dominance` -- model against measured modes.
- ``housing.pictures`` -- mode shapes off-screen; not imported here, because it brings VTK.
"""

from housing.assembly import assemble
from housing.comparison import Comparison, ModePair, compare_by_dominance
from housing.dominance import Dominance, dominance
from housing.effective_mass import EffectiveMass, effective_mass
from housing.enclosure import enclosed
from housing.errors import FactorizationError, HealthError, HousingError, IncompleteModesError, ReductionError
from housing.factorization import Factorization, Factorizer
from housing.grounding import Grounding, SupportHold
from housing.health import HealthLine, HealthReport, health_report
from housing.material import Material
from housing.matrices import Matrices
from housing.modes import Certificate, ModeSet, solve_modes
from housing.port_attachments import attach_ports
from housing.ports import Seat, Sensor, SensorPort, seat_matrix, sensor_port
from housing.receptance import Selection, receptance, residues, select_modes
from housing.reduction import Attachments, StaticProof
from housing.rigid import RigidBody, rigid_body, rigid_motions
from housing.supports import Support, fixed_freedoms, with_springs
from housing.survey import SURVEY_COUNTS, Survey, survey_grid

__all__ = [
    "SURVEY_COUNTS",
    "Attachments",
    "Certificate",
    "Comparison",
    "Dominance",
    "EffectiveMass",
    "Factorization",
    "FactorizationError",
    "Factorizer",
    "Grounding",
    "HealthError",
    "HealthLine",
    "HealthReport",
    "HousingError",
    "IncompleteModesError",
    "Material",
    "Matrices",
    "ModePair",
    "ModeSet",
    "ReductionError",
    "RigidBody",
    "Seat",
    "Selection",
    "Sensor",
    "SensorPort",
    "StaticProof",
    "Support",
    "SupportHold",
    "Survey",
    "assemble",
    "attach_ports",
    "compare_by_dominance",
    "dominance",
    "effective_mass",
    "enclosed",
    "fixed_freedoms",
    "health_report",
    "receptance",
    "residues",
    "rigid_body",
    "rigid_motions",
    "seat_matrix",
    "select_modes",
    "sensor_port",
    "solve_modes",
    "survey_grid",
    "with_springs",
]
