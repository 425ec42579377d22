"""Updating: named parameters of a housing's model fitted to its measured modes, and what the fit is worth.

- :class:`Parameter` -- a number of the model with its range and prior; :class:`ModelRate`, :func:`modal_rates` -- what
  it does to the modes, exactly; :class:`Surrogate` -- the modes of a design's neighbours.
- :class:`Target`, :func:`measure` -- what was measured and how far a design is from it (:class:`Misfit`).
- :func:`search` -- the fit from one start by true solves (:data:`Solve`) of :class:`Design`; :class:`MeshBias`,
  :func:`debiased` -- a coarse mesh that stands for a fine one; :func:`race` -- from many starts on the one, judged by
  the other, which :func:`polish` ends; :func:`posterior` -- what the data say beside the prior (:class:`Posterior`).
- :class:`Procedure` -- all of that search on one mesh; :func:`hold_back`, :func:`null_fits` -- what the fit is worth by
  it: modes left out and predicted, random frequencies fitted.
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
