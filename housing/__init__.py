"""The housing: from a mesh to modes that are proved complete, ports, comparison with measured modes, pictures.

What the room offers:

- :class:`Material`, :func:`assemble` -- stiffness and mass (:class:`Matrices`) of a meshed solid;
  :func:`mass_properties` -- its mass and centre of mass, from the geometry alone.
- :class:`Support`, :func:`with_springs`, :func:`fixed_freedoms` -- what holds it.
- :func:`solve_modes` -- its natural modes (:class:`ModeSet`) with a :class:`Certificate`.
- :class:`Seat`, :func:`seat_matrix`, :class:`Sensor`, :func:`sensor_port` -- where the rest of the machine meets it.
- :func:`survey_grid`, :func:`dominance`, :func:`compare_by_dominance` -- model against measured modes.
- ``housing.pictures`` -- mode shapes off-screen; not imported here, because it brings VTK.
"""

from housing.assembly import assemble
from housing.comparison import Comparison, ModePair, compare_by_dominance
from housing.dominance import Dominance, dominance
from housing.errors import FactorizationError, HousingError, IncompleteModesError
from housing.factorization import Factorization, Factorizer
from housing.mass import MassProperties, mass_properties
from housing.material import Material
from housing.matrices import Matrices
from housing.modes import Certificate, ModeSet, solve_modes
from housing.ports import Seat, Sensor, SensorPort, seat_matrix, sensor_port
from housing.supports import Support, fixed_freedoms, with_springs
from housing.survey import SURVEY_COUNTS, Survey, survey_grid

__all__ = [
    "SURVEY_COUNTS",
    "Certificate",
    "Comparison",
    "Dominance",
    "Factorization",
    "FactorizationError",
    "Factorizer",
    "HousingError",
    "IncompleteModesError",
    "MassProperties",
    "Material",
    "Matrices",
    "ModePair",
    "ModeSet",
    "Seat",
    "Sensor",
    "SensorPort",
    "Support",
    "Survey",
    "assemble",
    "compare_by_dominance",
    "dominance",
    "fixed_freedoms",
    "mass_properties",
    "seat_matrix",
    "sensor_port",
    "solve_modes",
    "survey_grid",
    "with_springs",
]
