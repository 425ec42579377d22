"""Model updating: named parameters of a housing's model fitted to its measured modes, and validation of the fit.

- :class:`Parameter` -- a number of the model with its range and prior.
- :class:`ModelRate`, :func:`modal_rates` -- exact sensitivities of the modes.
- :class:`Surrogate` -- the modes of neighbouring designs.
- :class:`Target`, :func:`measure` -- measured modes, and the misfit of a design (:class:`Misfit`).
- :func:`search` -- the fit from one start by full solutions (:data:`Solve`) of :class:`Design`.
- :class:`MeshBias`, :func:`debiased` -- correction of a coarse mesh by a fine one.
- :func:`race` -- multistart search on the coarse mesh, judged on the fine one; :func:`polish` -- its final steps.
- :func:`posterior` -- uncertainty of the parameters (:class:`Posterior`).
- :class:`Procedure` -- the whole search on one mesh; :func:`hold_back` -- leave-one-out cross-validation;
  :func:`null_fits` -- fits to random frequencies.
"""

from housing.updating.bias import Debiased, MeshBias, debiased
from housing.updating.misfit import UNPAIRED, Misfit, ModeCount, Target, is_met, measure, residuals
from housing.updating.parameters import Parameter, coordinate_bounds, values_at
from housing.updating.posterior import Posterior, posterior
from housing.updating.race import Each, Meshes, Raced, one_by_one, polish, race
from housing.updating.rates import ModalRates, ModelRate, modal_rates
from housing.updating.search import Design, Effort, Found, Solve, Step, search, search_surrogate
from housing.updating.surrogate import ModalState, Neighbour, Surrogate
from housing.updating.worth import HeldBack, NullFit, Procedure, hold_back, null_fits, random_frequencies

__all__ = [
    "UNPAIRED",
    "Debiased",
    "Design",
    "Each",
    "Effort",
    "Found",
    "HeldBack",
    "MeshBias",
    "Meshes",
    "Misfit",
    "ModalRates",
    "ModalState",
    "ModeCount",
    "ModelRate",
    "Neighbour",
    "NullFit",
    "Parameter",
    "Posterior",
    "Procedure",
    "Raced",
    "Solve",
    "Step",
    "Surrogate",
    "Target",
    "coordinate_bounds",
    "debiased",
    "hold_back",
    "is_met",
    "measure",
    "modal_rates",
    "null_fits",
    "one_by_one",
    "polish",
    "posterior",
    "race",
    "random_frequencies",
    "residuals",
    "search",
    "search_surrogate",
    "values_at",
]
