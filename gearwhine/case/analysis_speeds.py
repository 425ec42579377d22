"""Speeds of analyses over speed, as given in a case or by default: of whirl, diagrams, responses and branches.

Those of a rotor are its own [rad/s], positive counter-clockwise from +z; others are those of the first driver's rotor.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction

from gearwhine.case.errors import NOTHING, UNSAID, CaseError, Problem
from gearwhine.case.model import Case
from gearwhine.case.operation import Operation, Sweep, listed
from gearwhine.numerics.speed_ranges import (
    BEYOND_OPERATION,
    CAMPBELL_STEPS,
    SLOWEST_OF_BRANCH,
    campbell_speeds,
    evenly,
    response_speeds,
)


def with_sense_of(operation: Operation | None, speeds: Iterable[float]) -> tuple[float, ...]:
    """Return speeds of the first driver's rotor [rad/s] in the sense of the speed of operation, whatever their own.

    Lists and ranges of speeds hold absolute values. Without an operation the speeds stay as they are.
    """
    return tuple(speeds) if operation is None else _in_sense(operation.speed, speeds)


def _in_sense(speed: float, speeds: Iterable[float]) -> tuple[float, ...]:
    return tuple(math.copysign(one, speed) for one in speeds)


@dataclass(frozen=True)
class RotorSpeeds:
    """Speeds of a rotor at which its analyses are made [rad/s], negative where it turns clockwise.

    Attributes
    ----------
    whirl : tuple of float
        The speed of operation, then those of the sweep.
    campbell : tuple of float
        Of the Campbell diagram: as given, else the sweep's, else up to beyond operation, else none; ascending.
    response : tuple of float
        Of the unbalance response: as given, else the range of the Campbell diagram in finer steps; from the slowest to
        the fastest.
    """

    whirl: tuple[float, ...]
    campbell: tuple[float, ...]
    response: tuple[float, ...]


def rotor_speeds(case: Case, rotor: str) -> RotorSpeeds:
    """Return the speeds of a rotor's analyses, each once; a rotor outside the train stands still.

    Those of a planet are relative to its carrier.
    """
    ratios, carriers = case.parts.train.ratios, {one.name: one.carrier for one in case.rotor}
    carrier = carriers.get(rotor)
    ratio = float(ratios.get(rotor, Fraction(0)) - (0 if carrier is None else ratios.get(carrier, 0)))

    def of_rotor(speeds: Iterable[float]) -> tuple[float, ...]:
        return tuple(ratio * speed for speed in with_sense_of(case.operation, speeds))

    operation = () if case.operation is None else of_rotor((case.operation.speed,))
    swept = () if case.sweep is None else of_rotor(case.sweep.speeds)
    analysis = case.rotor_analysis
    if analysis is not None and analysis.speed is not None:
        diagram = of_rotor(listed(analysis.speed))
    elif case.sweep is not None:
        diagram = swept
    else:
        diagram = campbell_speeds(operation[0] if operation else None, case.parts.table_range(rotor))
    diagram = tuple(sorted(set(diagram)))
    if analysis is not None and analysis.unbalance_response.speed is not None:
        response = tuple(sorted(set(of_rotor(listed(analysis.unbalance_response.speed))), key=abs))
    else:
        response = response_speeds(diagram)
    return RotorSpeeds((*operation, *swept), diagram, response)


def diagram_speeds(speed: float, sweep: Sweep | None, held: tuple[float, float]) -> tuple[float, ...]:
    """Speeds of the first driver [rad/s] for the diagram: the sweep's, else up to beyond operation; ascending in size.

    ``speed`` is that of operation, and ``held`` the range of speeds, without sense, that the tables of all bearings
    hold.

    Raises
    ------
    CaseError
        For a machine that stands still, whose bearings' tables leave no range, or a sweep of one speed.
    """
    if speed == 0.0:
        raise CaseError([Problem("operation.speed", 0.0, "a speed: a diagram over speed is of a machine that turns")])
    if sweep is not None:
        speeds = sorted({abs(one) for one in sweep.speeds})
        if len(speeds) < 2:
            raise CaseError([Problem("sweep.speed", NOTHING, "two or more speeds for a diagram over speed")])
        return _in_sense(speed, speeds)
    low, high = _range_within(held, 0.0, BEYOND_OPERATION * abs(speed))
    return _in_sense(speed, evenly(low, high, CAMPBELL_STEPS))


def branch_speeds(
    speed: float, sweep: Sweep | None, held: tuple[float, float], *, downwards: bool = False
) -> tuple[float, float]:
    """Return the speeds from which and to which a motion is followed [rad/s]: the sweep's range, or about operation.

    ``speed`` is that of operation, and ``held`` the range of speeds, without sense, that the tables of all bearings
    hold.

    Raises
    ------
    CaseError
        Where the sweep holds no range of speeds above zero, or the bearings' tables leave none.
    """
    if sweep is None:
        low, high = _range_within(held, SLOWEST_OF_BRANCH * abs(speed), BEYOND_OPERATION * abs(speed))
    else:
        speeds = [abs(one) for one in sweep.speeds]
        low, high = min(speeds), max(speeds)
        if not 0.0 < low < high:
            expected = "a range of speeds above zero, over which a motion is followed"
            raise CaseError([Problem("sweep.speed", UNSAID, expected)])
    first, last = _in_sense(speed, (high, low) if downwards else (low, high))
    return first, last


def _range_within(held: tuple[float, float], lowest: float, highest: float) -> tuple[float, float]:
    """Return the part of a range of speeds that the tables of all bearings hold; CaseError where there is none."""
    low, high = max(lowest, held[0]), min(highest, held[1])
    if not low < high:
        raise CaseError(
            [Problem("bearing", NOTHING, "tables over speed with a range in common, for a diagram over speed")]
        )
    return low, high
