"""The steady state directly: periodic motions, their stability, and how they change with speed.

- :func:`periodic_response` -- the motion that repeats with the excitation, stable or not, as a
  :class:`PeriodicResponse` with its Floquet multipliers.
- :func:`common_period` -- after which time all that drives a machine repeats.

numba is imported only when a response is computed.
"""

from coupling.periodic.base_period import common_period
from coupling.periodic.floquet import FloquetMultipliers
from coupling.periodic.response import PeriodicRecord, PeriodicResponse
from coupling.periodic.shooting import periodic_response

__all__ = [
    "FloquetMultipliers",
    "PeriodicRecord",
    "PeriodicResponse",
    "common_period",
    "periodic_response",
]
