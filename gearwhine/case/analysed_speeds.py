"""Speeds of rotor analyses: whirl, Campbell diagram and response, as given in the case or by default.

All are speeds of the rotor itself [rad/s], positive counter-clockwise from +z.
"""

from __future__ import annotations

import math

from gearwhine.case.model import Case
from gearwhine.case.motion import speed_ratios
from gearwhine.case.running import listed

BEYOND_OPERATION = 1.5
"""How far a Campbell diagram goes where no speeds are given, over the speed of operation."""

CAMPBELL_STEPS = 50
RESPONSE_STEPS = 300


def whirl_speeds(case: Case, rotor: str) -> tuple[float, ...]:
    """Return the speed of operation, then those of the sweep."""
    given = () if case.operation is None else (case.operation.speed,)
    return _turned(case, rotor, (*given, *(case.sweep.speeds if case.sweep else ())))


def campbell_speeds(case: Case, rotor: str) -> tuple[float, ...]:
    """Return the speeds of the Campbell diagram: as given, else the sweep's, else up to beyond operation, else none.

    Ascending, each once; those of a rotor that turns clockwise are negative.
    """
    return tuple(sorted(set(_diagram_speeds(case, rotor))))


def _diagram_speeds(case: Case, rotor: str) -> tuple[float, ...]:
    analysis = case.rotor_analysis
    if analysis is not None and analysis.speed is not None:
        return _turned(case, rotor, listed(analysis.speed))
    if case.sweep is not None:
        return _turned(case, rotor, case.sweep.speeds)
    if case.operation is None or case.operation.speed == 0.0:
        return ()
    (highest,) = _turned(case, rotor, (BEYOND_OPERATION * case.operation.speed,))
    low, high = table_range(case, rotor)
    if low >= abs(highest):
        return ()
    return _evenly(math.copysign(low, highest), math.copysign(min(high, abs(highest)), highest), CAMPBELL_STEPS)


def response_speeds(case: Case, rotor: str) -> tuple[float, ...]:
    """Return the speeds of the unbalance response: as given, else the range of the Campbell diagram in finer steps.

    From the slowest to the fastest, each once.
    """
    analysis = case.rotor_analysis
    if analysis is not None and analysis.unbalance_response.speed is not None:
        return tuple(sorted(set(_turned(case, rotor, listed(analysis.unbalance_response.speed))), key=abs))
    speeds = campbell_speeds(case, rotor)
    if len(speeds) < 2:
        return speeds
    return _evenly(min(speeds, key=abs), max(speeds, key=abs), RESPONSE_STEPS)


def table_range(case: Case, rotor: str) -> tuple[float, float]:
    """Return the lowest and the highest speed that the tables of all of a rotor's bearings hold, without their sense.

    Zero and infinity for bearings without tables.
    """
    tables = [bearing.speeds for bearing in case.bearing if bearing.rotor == rotor and bearing.speeds is not None]
    return max((table[0] for table in tables), default=0.0), min((table[-1] for table in tables), default=math.inf)


def _turned(case: Case, rotor: str, speeds: tuple[float, ...]) -> tuple[float, ...]:
    """Return speeds of the first driver's rotor as those of another; a rotor that nothing turns stands still."""
    ratio = float(speed_ratios(case).get(rotor, 0.0))
    return tuple(ratio * speed for speed in speeds)


def _evenly(first: float, last: float, steps: int) -> tuple[float, ...]:
    return (*(first + (last - first) * step / steps for step in range(steps)), last)
