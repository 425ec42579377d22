"""The steady state directly: periodic motions, their stability, and how they change with speed.

- :func:`periodic_response` -- the motion that repeats with the excitation, stable or not, as a
  :class:`PeriodicResponse` with its Floquet multipliers.
- :func:`response_curve` -- how it changes with speed, through folds, as a :class:`ResponseCurve`.
- :func:`common_period` -- after which time all that drives a machine repeats.

numba is imported only when a response is computed.
"""

from coupling.periodic.base_period import common_period
from coupling.periodic.continuation import response_curve
from coupling.periodic.floquet import FloquetMultipliers
from coupling.periodic.response import PeriodicRecord, PeriodicResponse
from coupling.periodic.response_curve import Bifurcation, ResponseCurve
from coupling.periodic.shooting import periodic_response

__all__ = [
    "Bifurcation",
    "FloquetMultipliers",
    "PeriodicRecord",
    "PeriodicResponse",
    "ResponseCurve",
    "common_period",
    "periodic_response",
    "response_curve",
]
