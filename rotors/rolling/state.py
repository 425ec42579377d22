"""State of a rolling bearing under a load: displacement, tangent stiffness, element loads."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from .energy import ElementLoads
from .rolling_bearing import RollingBearing

FloatArray = npt.NDArray[np.float64]

COORDINATES = ("x", "y", "z", "rx", "ry")
"""The inner ring's displacement against the outer: along x, y, z, and rotations about x and y."""

# Stiffness below this part of the largest, rotations taken at the pitch circle, is none.
_NO_STIFFNESS = 1e-9
# Share of a coordinate in such a motion above which it is not held.
_TAKES_PART = 1e-6


@dataclass(frozen=True)
class RollingState:
    """A rolling bearing in equilibrium. Arrays of five are over `COORDINATES`: m and rad, N and N·m.

    Attributes
    ----------
    bearing
        What was loaded.
    displacement
        (5,): of the inner ring against the outer.
    load
        (5,): on the inner ring from outside, what holds the held coordinates included and the preload's spring not.
    reaction
        (5,): what the elements put on the outer ring; ``load`` and the spring's force together, but for the residual.
    stiffness
        (5, 5): tangent, symmetric and positive semidefinite; ∂reaction/∂displacement.
    rows
        What the elements of each row carry.
    speed
        Of the inner ring, rad/s.
    residual
        Largest force out of balance over the sum of the loads at work.
    iterations
        Newton steps taken.
    """

    bearing: RollingBearing
    displacement: FloatArray
    load: FloatArray
    reaction: FloatArray
    stiffness: FloatArray
    rows: tuple[ElementLoads, ...] = field(repr=False)
    speed: float
    residual: float
    iterations: int

    @property
    def loaded(self) -> int:
        """How many elements of all rows press on the inner ring."""
        return sum(row.loaded for row in self.rows)

    @property
    def peak_pressure(self) -> float:
        """Greatest contact pressure, Pa."""
        return max(row.peak_pressure for row in self.rows)

    @property
    def even_stiffness(self) -> FloatArray:
        """The stiffness with rotations as motions of the pitch circle and moments as forces there, (5, 5), N/m."""
        size = np.array([1.0, 1.0, 1.0, self.bearing.reach, self.bearing.reach])
        return np.asarray(self.stiffness / np.outer(size, size))

    @property
    def loose(self) -> tuple[str, ...]:
        """Coordinates that take part in motions which nothing resists, because of play or by the bearing's kind."""
        values, vectors = np.linalg.eigh(self.even_stiffness)
        free = vectors[:, values <= _NO_STIFFNESS * max(values[-1], 1.0)]
        weight = (free**2).sum(axis=1)
        return tuple(name for name, part in zip(COORDINATES, weight.tolist(), strict=True) if part > _TAKES_PART)
