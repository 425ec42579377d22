"""Model updating: named parameters of a housing's model fitted to its measured modes, and validation of the fit.

- :class:`Parameter` -- a number of the model with its range and prior.
- :class:`ModelSensitivity`, :func:`modal_sensitivities` -- exact sensitivities of the modes.
- :class:`Surrogate` -- the modes of neighbouring designs.
- :class:`Target`, :func:`measure` -- measured modes, and the misfit of a design (:class:`Misfit`).
- :func:`search` -- the fit from one start by full solutions (:data:`Solve`).
- :class:`MeshBias` -- correction of a coarse mesh by a fine one.
- :func:`multistart_search` -- many starts on a coarse mesh, judged on the fine one; :func:`polish` -- its final steps.
- :func:`posterior` -- uncertainty of the parameters (:class:`Posterior`).
- :class:`Procedure` -- the whole search on one mesh; :func:`leave_one_out` -- leave-one-out cross-validation;
  :func:`null_fits` -- fits to random frequencies.
"""

from gearwhine.housing.updating.cross_validation import LeftOutMode as LeftOutMode
from gearwhine.housing.updating.cross_validation import NullFit as NullFit
from gearwhine.housing.updating.cross_validation import Procedure as Procedure
from gearwhine.housing.updating.cross_validation import leave_one_out as leave_one_out
from gearwhine.housing.updating.cross_validation import null_fits as null_fits
from gearwhine.housing.updating.mesh_bias import MeshBias as MeshBias
from gearwhine.housing.updating.misfit import UNPAIRED as UNPAIRED
from gearwhine.housing.updating.misfit import Misfit as Misfit
from gearwhine.housing.updating.misfit import ModeCount as ModeCount
from gearwhine.housing.updating.misfit import Target as Target
from gearwhine.housing.updating.misfit import measure as measure
from gearwhine.housing.updating.multistart import Each as Each
from gearwhine.housing.updating.multistart import Meshes as Meshes
from gearwhine.housing.updating.multistart import MultistartResult as MultistartResult
from gearwhine.housing.updating.multistart import multistart_search as multistart_search
from gearwhine.housing.updating.multistart import polish as polish
from gearwhine.housing.updating.multistart import serial_map as serial_map
from gearwhine.housing.updating.parameters import Parameter as Parameter
from gearwhine.housing.updating.parameters import Posterior as Posterior
from gearwhine.housing.updating.parameters import posterior as posterior
from gearwhine.housing.updating.parameters import values_at as values_at
from gearwhine.housing.updating.sensitivities import ModelSensitivity as ModelSensitivity
from gearwhine.housing.updating.sensitivities import modal_sensitivities as modal_sensitivities
from gearwhine.housing.updating.surrogate import ModalState as ModalState
from gearwhine.housing.updating.surrogate import Surrogate as Surrogate
from gearwhine.housing.updating.trust_region import Effort as Effort
from gearwhine.housing.updating.trust_region import SearchResult as SearchResult
from gearwhine.housing.updating.trust_region import Solve as Solve
from gearwhine.housing.updating.trust_region import Step as Step
from gearwhine.housing.updating.trust_region import search as search
