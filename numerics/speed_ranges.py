"""Speeds that analyses over speed take where none are given."""

import math
from collections.abc import Sequence

BEYOND_OPERATION = 1.5
"""End of a Campbell diagram over the speed of operation."""

SLOWEST_OF_BRANCH = 0.5
"""Beginning of a branch of motions over the speed of operation."""

CAMPBELL_STEPS = 50
RESPONSE_STEPS = 300


def evenly(first: float, last: float, steps: int) -> tuple[float, ...]:
    """Return ``steps + 1`` evenly spaced values from first to last, both included."""
    return (*(first + (last - first) * step / steps for step in range(steps)), last)


def campbell_speeds(operation: float | None, held: tuple[float, float] = (0.0, math.inf)) -> tuple[float, ...]:
    """Return signed speeds of a Campbell diagram up to beyond the speed of operation; none without such a speed.

    ``held`` are the lowest and the highest speed, without sense, that the tables of the bearings hold.
    """
    if not operation:
        return ()
    highest, (least, most) = BEYOND_OPERATION * operation, held
    if least >= abs(highest):
        return ()
    return evenly(math.copysign(least, highest), math.copysign(min(most, abs(highest)), highest), CAMPBELL_STEPS)


def response_speeds(diagram: Sequence[float]) -> tuple[float, ...]:
    """Return the range of a Campbell diagram in finer steps, from the slowest to the fastest."""
    if len(diagram) < 2:
        return tuple(diagram)
    return evenly(min(diagram, key=abs), max(diagram, key=abs), RESPONSE_STEPS)
