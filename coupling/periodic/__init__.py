"""Periodic response: the steady state by shooting, its Floquet multipliers, and its continuation over speed.

- :func:`periodic_response` -- the motion with the period of the excitation, stable or not, as a
  :class:`PeriodicResponse` with its Floquet multipliers.
- :func:`settled_response` -- the same of a machine whose carriers turn, by integration in time, as a
  :class:`SettledMotion`.
- :func:`response_curve` -- its branch over speed, through folds, as a :class:`ResponseCurve`.
- :func:`superposed_response` -- for excitations without a short common period, the sum of the motions of each, as a
  :class:`SuperposedResponse` with the force that it neglects.
- :func:`common_period` -- the period of all excitations of a machine.

numba is imported only when a response is computed.
"""

from gearwhine.coupling.periodic.continuation import Bifurcation, ResponseCurve, response_curve
from gearwhine.coupling.periodic.response import FloquetMultipliers, PeriodicResponse
from gearwhine.coupling.periodic.settling import SettledMotion, circles, settled_response
from gearwhine.coupling.periodic.shooting import common_period, periodic_response
from gearwhine.coupling.periodic.superposition import (
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
    "PeriodicResponse",
    "ResponseCurve",
    "SettledMotion",
    "SuperposedResponse",
    "circles",
    "common_cycles",
    "common_period",
    "excitation_groups",
    "periodic_response",
    "response_curve",
    "settled_response",
    "superposed_response",
]
