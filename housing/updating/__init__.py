"""Updating: named parameters of a housing's model fitted to its measured modes, and what the fit is worth.

- :class:`Parameter` -- a number of the model with its range and prior; :class:`ModelRate`, :func:`modal_rates` -- what
it
  does to the modes, exactly; :class:`Surrogate` -- the modes of a design's neighbours.
- :class:`Target`, :func:`measure` -- what was measured and how far a design is from it (:class:`Misfit`).
- :func:`search`, :func:`explore` -- the fit from one start or from several, by true solves (:data:`Solve`) of
  :class:`Design`; :func:`posterior` -- what the data say beside the prior (:class:`Posterior`).
- :func:`hold_back`, :func:`null_fits` -- what the fit is worth: modes left out and predicted, random frequencies
fitted.
"""

from housing.updating.misfit import UNPAIRED, Misfit, ModeCount, Target, measure, residuals
from housing.updating.parameters import Parameter, coordinate_bounds, values_at
from housing.updating.posterior import Posterior, posterior
from housing.updating.rates import ModalRates, ModelRate, modal_rates
from housing.updating.search import Design, Effort, Found, Solve, Step, explore, search, search_surrogate
from housing.updating.surrogate import ModalState, Neighbour, Surrogate
from housing.updating.worth import HeldBack, NullFit, hold_back, null_fits, random_frequencies

__all__ = [
    "UNPAIRED",
    "Design",
    "Effort",
    "Found",
    "HeldBack",
    "Misfit",
    "ModalRates",
    "ModalState",
    "ModeCount",
    "ModelRate",
    "Neighbour",
    "NullFit",
    "Parameter",
    "Posterior",
    "Solve",
    "Step",
    "Surrogate",
    "Target",
    "coordinate_bounds",
    "explore",
    "hold_back",
    "measure",
    "modal_rates",
    "null_fits",
    "posterior",
    "random_frequencies",
    "residuals",
    "search",
    "search_surrogate",
    "values_at",
]
