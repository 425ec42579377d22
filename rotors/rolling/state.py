"""State of a rolling bearing under a load: displacement, tangent stiffness, element loads."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from .energy import ElementLoads
from .rolling_bearing import RollingBearing

FloatArray = npt.NDArray[np.float64]

COORDINATES = ("x", "y", "z", "rx", "ry")
"""The inner ring's displacement against the outer: along x, y, z, and rotations about x and y."""

# Stiffness below this part of the largest, rotations scaled by the pitch circle, counts as zero.
_NO_STIFFNESS = 1e-9
# Share of a coordinate in such a motion above which it counts as free.
_TAKES_PART = 1e-6


@dataclass(frozen=True)
class RollingState:
    """A rolling bearing in equilibrium. Arrays of five are over `COORDINATES`: m and rad, N and N·m.

    Attributes
    ----------
    bearing
        The bearing.
    displacement
        (5,): of the inner ring against the outer.
    load
        (5,): external load on the inner ring, constraint forces included, the preload spring excluded.
    reaction
        (5,): force of the elements on the outer ring: ``load`` plus the spring's force, up to the residual.
    stiffness
        (5, 5): tangent, symmetric and positive semidefinite; ∂reaction/∂displacement.
    rows
        Element loads of each row.
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
        """Number of loaded elements in all rows."""
        return sum(row.loaded for row in self.rows)

    @property
    def peak_pressure(self) -> float:
        """Greatest contact pressure, Pa."""
        return max(row.peak_pressure for row in self.rows)

    @property
    def even_stiffness(self) -> FloatArray:
        """Stiffness with rotations as displacements of the pitch circle and moments as forces there, (5, 5), N/m."""
        size = np.array([1.0, 1.0, 1.0, self.bearing.reach, self.bearing.reach])
        return np.asarray(self.stiffness / np.outer(size, size))

    @property
    def loose(self) -> tuple[str, ...]:
        """Coordinates of motions without stiffness, because of clearance or of the bearing's type."""
        values, vectors = np.linalg.eigh(self.even_stiffness)
        free = vectors[:, values <= _NO_STIFFNESS * max(values[-1], 1.0)]
        weight = (free**2).sum(axis=1)
        return tuple(name for name, part in zip(COORDINATES, weight.tolist(), strict=True) if part > _TAKES_PART)
