"""Speeds of the analyses of a rotor, as given in a case or by default: of whirl, diagrams and responses.

They are its own [rad/s], positive counter-clockwise from +z.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction

from gearwhine.case.model import Case
from gearwhine.case.operation import Operation, listed
from gearwhine.numerics.speed_ranges import campbell_speeds, response_speeds


def with_sense_of(operation: Operation | None, speeds: Iterable[float]) -> tuple[float, ...]:
    """Return speeds of the first driver's rotor [rad/s] in the sense of the speed of operation, whatever their own.

    Lists and ranges of speeds hold absolute values. Without an operation the speeds stay as they are.
    """
    return tuple(speeds if operation is None else (math.copysign(one, operation.speed) for one in speeds))


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
