"""Model updating: named parameters of a housing's model fitted to its measured modes, and validation of the fit.

- :class:`Parameter` -- a number of the model with its range and prior.
- :class:`ModelRate`, :func:`modal_rates` -- exact sensitivities of the modes.
- :class:`Surrogate` -- the modes of neighbouring designs.
- :class:`Target`, :func:`measure` -- measured modes, and the misfit of a design (:class:`Misfit`).
- :func:`search` -- the fit from one start by full solutions (:data:`Solve`).
- :class:`MeshBias` -- correction of a coarse mesh by a fine one.
- :func:`race` -- many starts on a coarse mesh, judged on the fine one; :func:`polish` -- its final steps.
- :func:`posterior` -- uncertainty of the parameters (:class:`Posterior`).
- :class:`Procedure` -- the whole search on one mesh; :func:`hold_back` -- leave-one-out cross-validation;
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
from housing.updating.race import Raced as Raced
from housing.updating.race import one_by_one as one_by_one
from housing.updating.race import polish as polish
from housing.updating.race import race as race
from housing.updating.rates import ModelRate as ModelRate
from housing.updating.rates import modal_rates as modal_rates
from housing.updating.search import Effort as Effort
from housing.updating.search import Found as Found
from housing.updating.search import Solve as Solve
from housing.updating.search import Step as Step
from housing.updating.search import search as search
from housing.updating.surrogate import ModalState as ModalState
from housing.updating.surrogate import Surrogate as Surrogate
from housing.updating.worth import HeldBack as HeldBack
from housing.updating.worth import NullFit as NullFit
from housing.updating.worth import Procedure as Procedure
from housing.updating.worth import hold_back as hold_back
from housing.updating.worth import null_fits as null_fits
