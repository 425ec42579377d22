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

from housing.updating.bias import MeshBias as MeshBias
from housing.updating.misfit import UNPAIRED as UNPAIRED
from housing.updating.misfit import Misfit as Misfit
from housing.updating.misfit import ModeCount as ModeCount
from housing.updating.misfit import Target as Target
from housing.updating.misfit import measure as measure
from housing.updating.parameters import Parameter as Parameter
from housing.updating.parameters import values_at as values_at
from housing.updating.posterior import Posterior as Posterior
from housing.updating.posterior import posterior as posterior
from housing.updating.race import Each as Each
from housing.updating.race import Meshes as Meshes
from housing.updating.race import MultistartResult as MultistartResult
from housing.updating.race import multistart_search as multistart_search
from housing.updating.race import polish as polish
from housing.updating.race import serial_map as serial_map
from housing.updating.rates import ModelSensitivity as ModelSensitivity
from housing.updating.rates import modal_sensitivities as modal_sensitivities
from housing.updating.search import Effort as Effort
from housing.updating.search import SearchResult as SearchResult
from housing.updating.search import Solve as Solve
from housing.updating.search import Step as Step
from housing.updating.search import search as search
from housing.updating.surrogate import ModalState as ModalState
from housing.updating.surrogate import Surrogate as Surrogate
from housing.updating.worth import LeftOutMode as LeftOutMode
from housing.updating.worth import NullFit as NullFit
from housing.updating.worth import Procedure as Procedure
from housing.updating.worth import leave_one_out as leave_one_out
from housing.updating.worth import null_fits as null_fits
