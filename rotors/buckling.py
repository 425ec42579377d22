"""Buckling of a shaft under its axial forces, by the Wittrick-Williams root count."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .bearing import RadialSupport
from .errors import require
from .root_count import wittrick_williams_count
from .rotor_lines import bending_shaft
from .segment import Segment
from .shaft import Rotor

# Part of the frequency scale √(stiffness / mass) that stands for standstill: a free shaft's rigid motion is at zero.
STANDSTILL = 1e-9
RELATIVE_WIDTH = 1e-13
MOST_DOUBLINGS = 100
# A shaft that is free to tilt buckles under any compression: a factor below this is zero.
LEAST_FACTOR = 1e-9


def buckling_factor(rotor: Rotor, supports: Sequence[RadialSupport] = ()) -> float:
    """The least factor on all axial forces of a rotor at which it buckles in one plane.

    Compression lowers the natural frequencies. Where one has reached zero the shaft buckles: beyond, the root count at
    standstill exceeds the number of rigid motions.

    Parameters
    ----------
    rotor
        The shaft, with the axial forces of its segments.
    supports
        Springs to ground in this plane.

    Returns
    -------
    float
        To 1e-13 of itself; infinite without compression, zero for a shaft that is free to tilt.

    Raises
    ------
    RotorError
        A support off the shaft; or compression would have to exceed half of the shear stiffness κGA first, which no
        material bears.
    """
    forces = [part.axial_force for part in rotor.segments if isinstance(part, Segment)]
    if min(forces, default=0.0) >= 0.0:
        return np.inf
    low, high = 0.0, 1.0
    for _ in range(MOST_DOUBLINGS):
        if _has_buckled(rotor, supports, high):
            break
        low, high = high, 2.0 * high
    if _has_buckled(rotor, supports, LEAST_FACTOR):
        return 0.0
    while high - low > RELATIVE_WIDTH * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _has_buckled(rotor, supports, middle) else (middle, high)
    return 0.5 * (low + high)


def require_unbuckled(rotor: Rotor, supports: Sequence[RadialSupport]) -> None:
    """Raise `RotorError` with the buckling factor if the rotor's own axial forces buckle it."""
    if rotor.is_compressed:
        buckled = _has_buckled(rotor, supports, 1.0)
        factor = buckling_factor(rotor, supports) if buckled else np.inf
        require(
            not buckled,
            f"rotor {rotor.name!r} axial force",
            min(part.axial_force for part in rotor.segments if isinstance(part, Segment)),
            f"compression that it bears: it buckles at {factor:.6g} times its axial forces",
        )


def _has_buckled(rotor: Rotor, supports: Sequence[RadialSupport], factor: float) -> bool:
    parts = [
        replace(part, axial_force=factor * part.axial_force) if isinstance(part, Segment) else part
        for part in rotor.segments
    ]
    line = bending_shaft(replace(rotor, segments=parts), supports)
    # Every chain of this line has the same scale; the pieces of a standstill are the longest.
    chain = line.cut(STANDSTILL * line.likely_frequency(1))
    return wittrick_williams_count(chain, chain.highest) > int(chain.rigid_shapes.shape[0])
