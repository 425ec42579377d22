"""Sweep of a machine of Python over speed, in one process: its motion at every speed, one after the other."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

from gearwhine.case import SPEED_KEY, SweptKey
from gearwhine.case.units import to_rpm
from gearwhine.coupling import CouplingError, Machine
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.load_analysis.load_warnings import find_load
from gearwhine.numerics.findings import FINITE
from gearwhine.numerics.progress import Progress, silent
from gearwhine.solutions import Failure, failure_of
from gearwhine.sweep.grid import SweptPoint
from gearwhine.sweep.points import GridPoint
from gearwhine.sweep.solution import PointResult, solve_motion_of_point


def sweep_speeds(
    machine: Machine, speeds: Sequence[float], plan: TransientPlan, progress: Progress = silent
) -> tuple[tuple[SweptKey], tuple[SweptPoint[GridPoint], ...]]:
    """Integrate the motion of a machine at each of several speeds.

    Parameters
    ----------
    machine : Machine
    speeds : sequence of float
        Signed speeds of the first driver's shaft [rad/s].
    plan : TransientPlan
    progress : callable

    Returns
    -------
    tuple of SweptKey
        The speed, as the swept key of a case.
    tuple of SweptPoint
        Outcomes; a speed at which the motion cannot be followed has its failure.

    Raises
    ------
    gearwhine.coupling.CouplingError
        Where there is no speed, or one is zero or not finite.
    """
    if not speeds or not all(FINITE.accepts(speed) and speed != 0.0 for speed in speeds):
        raise CouplingError(f"sweep: speeds are {list(speeds)!r}; expected finite speeds other than 0 [rad/s]")
    rpms = tuple(float(f"{to_rpm(speed):.12g}") for speed in speeds)
    texts = tuple(f"{rpm:.12g} rpm" for rpm in rpms)
    swept = []
    for number, (speed, text) in enumerate(zip(speeds, texts, strict=True)):
        progress(f"sweep: {number} of {len(speeds)} points", number / len(speeds))
        swept.append(SweptPoint(GridPoint((number,), (text,), speed, ""), _outcome(machine, speed, plan)))
    return (SweptKey(SPEED_KEY, texts, rpms, "rpm"),), tuple(swept)


def _outcome(machine: Machine, speed: float, plan: TransientPlan) -> PointResult | Failure:
    begin = time.perf_counter()
    try:
        turning = replace(machine, speed=speed)
        load, warnings = find_load(turning) if turning.is_loaded else (None, [])
        return solve_motion_of_point(turning, load, warnings, plan, begin)
    except Exception as error:
        return failure_of(error)
