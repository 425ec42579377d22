"""Housings: natural modes of a meshed solid, certified complete, and their comparison with measured modes.

- :class:`Housing` owns mesh, :class:`Material`, fixtures, :class:`Seat` and :class:`Sensor` entries; its modes come as
  :class:`HousingModes`.
- Fixtures are :class:`Support`, :class:`Mount`, :class:`Joint`, :class:`Bushing` and :class:`LumpedMass`, each on a
  :class:`Patch` of the surface; :func:`bolted_joint` gives the stiffness of a preloaded bolt.
- :func:`assemble` and :func:`attach_fixtures` make stiffness and mass matrices;
  :mod:`gearwhine.housing.fem.factorization` factors them.
- :func:`solve_modes` finds every mode below a limit (:class:`ModeSet`) with its :class:`Certificate`;
  their residual modes make the static compliance at the seats exact.
- :func:`receptance`, :func:`effective_mass`, :func:`modal_damping` and :func:`health_report` evaluate a mode set;
  :func:`read_modes` and :func:`write_modes` keep it on file.
- :func:`compare_by_shapes`, :func:`compare_by_dominance` and :func:`compare_by_frequency` pair model modes with
  measured ones.
- :mod:`gearwhine.housing.reduced` reads housings that another program has reduced to matrices.

Sub-packages and modules, each of which imports only those before it: ``gearwhine.housing.material``,
``gearwhine.housing.fem`` (assembly, factorisation), ``gearwhine.housing.model`` (supports, seats, fixtures),
``gearwhine.housing.modes`` (eigensolver, certificate, residual modes), ``gearwhine.housing.storage`` (NetCDF),
``gearwhine.housing.acoustics`` (radiated sound), ``gearwhine.housing.measured`` (surveys and their files),
``gearwhine.housing.correlation`` (modal assurance criterion and others), ``gearwhine.housing.updating`` (model
updating), ``gearwhine.housing.pictures`` (rendering), ``gearwhine.housing.model_warnings``, and
``gearwhine.housing.housing``: the whole description, and what is known of it once its modes are solved. Upon these
stand ``gearwhine.housing.mesh_refinement`` and ``gearwhine.housing.modal_test``. ``gearwhine.housing.reduced`` stands
beside them, and ``gearwhine.housing.reduced_modal_test`` upon it.
"""

from gearwhine.housing.correlation.comparison import compare_by_dominance as compare_by_dominance
from gearwhine.housing.correlation.comparison import compare_by_frequency as compare_by_frequency
from gearwhine.housing.correlation.comparison import compare_by_shapes as compare_by_shapes
from gearwhine.housing.errors import HousingError as HousingError
from gearwhine.housing.errors import IncompleteModesError as IncompleteModesError
from gearwhine.housing.fem.assembly import assemble as assemble
from gearwhine.housing.housing import Housing as Housing
from gearwhine.housing.housing import HousingModes as HousingModes
from gearwhine.housing.material import STEEL as STEEL
from gearwhine.housing.material import Material as Material
from gearwhine.housing.model.bolted_joints import bolted_joint as bolted_joint
from gearwhine.housing.model.bushings import Bushing as Bushing
from gearwhine.housing.model.bushings import Joint as Joint
from gearwhine.housing.model.bushings import Mount as Mount
from gearwhine.housing.model.cover_bolts import cover_joints as cover_joints
from gearwhine.housing.model.fixtures import LumpedMass as LumpedMass
from gearwhine.housing.model.fixtures import attach_fixtures as attach_fixtures
from gearwhine.housing.model.patches import Patch as Patch
from gearwhine.housing.model.seats import Seat as Seat
from gearwhine.housing.model.seats import Sensor as Sensor
from gearwhine.housing.model.supports import Support as Support
from gearwhine.housing.modes.certificate import Certificate as Certificate
from gearwhine.housing.modes.effective_mass import effective_mass as effective_mass
from gearwhine.housing.modes.effective_mass import modal_damping as modal_damping
from gearwhine.housing.modes.health import HealthReport as HealthReport
from gearwhine.housing.modes.health import health_report as health_report
from gearwhine.housing.modes.natural_modes import ModeSet as ModeSet
from gearwhine.housing.modes.natural_modes import solve_modes as solve_modes
from gearwhine.housing.modes.receptance import receptance as receptance
from gearwhine.housing.storage.mode_file import read_modes as read_modes
from gearwhine.housing.storage.mode_file import write_modes as write_modes
