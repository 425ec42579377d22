"""The steady state directly: periodic motions, their stability, and how they change with speed.

- :func:`periodic_response` -- the motion that repeats with the excitation, stable or not, as a
  :class:`PeriodicResponse` with its Floquet multipliers.
- :func:`response_curve` -- how it changes with speed, through folds, as a :class:`ResponseCurve`.
- :func:`superposed_response` -- where the excitations have no short common period, the sum of each one's own motion, as
  a :class:`SuperposedResponse` with the force that it neglects.
- :func:`common_period` -- after which time all that drives a machine repeats.

numba is imported only when a response is computed.
"""

from coupling.periodic.base_period import common_period
from coupling.periodic.continuation import response_curve
from coupling.periodic.floquet import FloquetMultipliers
from coupling.periodic.response import PeriodicRecord, PeriodicResponse
from coupling.periodic.response_curve import Bifurcation, ResponseCurve
from coupling.periodic.shooting import periodic_response
from coupling.periodic.superposition import (
    LONGEST_COMMON_PERIOD,
    ExcitationGroup,
    GroupMotion,
    SuperposedResponse,
    common_cycles,
    excitation_groups,
    superposed_response,
)

__all__ = [
    "LONGEST_COMMON_PERIOD",
    "Bifurcation",
    "ExcitationGroup",
    "FloquetMultipliers",
    "GroupMotion",
    "PeriodicRecord",
    "PeriodicResponse",
    "ResponseCurve",
    "SuperposedResponse",
    "common_cycles",
    "common_period",
    "excitation_groups",
    "periodic_response",
    "response_curve",
    "superposed_response",
]
