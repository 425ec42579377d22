"""Updating: named parameters of a housing's model fitted to its measured modes, and what the fit is worth.

- :class:`Parameter` -- a number of the model with its range and prior; :class:`ModelRate`, :func:`modal_rates` -- what it
  does to the modes, exactly; :class:`Surrogate` -- the modes of a design's neighbours.
- :class:`Target`, :func:`measure` -- what was measured and how far a design is from it (:class:`Misfit`).
- :func:`search` -- the fit, by true solves (:data:`Solve`) of :class:`Design`.
"""

from housing.updating.misfit import UNPAIRED, Misfit, ModeCount, Target, measure
from housing.updating.parameters import Parameter, coordinate_bounds, values_at
from housing.updating.rates import ModalRates, ModelRate, modal_rates
from housing.updating.search import Design, Effort, Found, Solve, Step, search, search_surrogate
from housing.updating.surrogate import ModalState, Neighbour, Surrogate

__all__ = [
    "UNPAIRED",
    "Design",
    "Effort",
    "Found",
    "Misfit",
    "ModalRates",
    "ModalState",
    "ModeCount",
    "ModelRate",
    "Neighbour",
    "Parameter",
    "Solve",
    "Step",
    "Surrogate",
    "Target",
    "coordinate_bounds",
    "measure",
    "modal_rates",
    "search",
    "search_surrogate",
    "values_at",
]
