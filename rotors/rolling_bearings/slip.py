r"""Slip of the cage of a rolling bearing: it lags behind pure rolling, and its speed varies at random.

Elements roll on the ring at rest and slide a little on the one that turns: the cage turns at (1 − s) of its speed of
pure rolling against the seat, and so do the elements about their axes. From the passing of one element to the next, a
time T on the mean, it turns by 2π/Z (1 + σ ξ), the ξ independent with a standard deviation of 1, so that the variance
of its angle grows with time, by (2π σ/Z)² in each T (J. Antoni and R. B. Randall, "A stochastic model for simulation
and diagnostics of rolling element bearings with localized faults", J. Vib. Acoust. 125 (2003) 282-289). The k-th
multiple of the strikes is then no line, but of the shape

    S(f) ∝ 1 / (1 + (f − k/T)² / b²),    b = π k² σ² / T,

which at high multiples is as wide as they are apart. Measured bearings slip by 1 to 2 %.
"""

import math
import zlib
from dataclasses import dataclass

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.errors import require, require_finite

MOST_SLIP, MOST_SCATTER = 0.5, 0.1
_PASSES = 2**14  # of elements, after which the same changes of the speed return


@dataclass(frozen=True)
class CageSlip:
    """Slip of a bearing's cage.

    Parameters
    ----------
    mean : float
        Mean part s of the speed of pure rolling by which the cage lags.
    scatter : float
        Standard deviation σ of the angle that the cage turns by from one element's passing to the next, over its mean.
    seed : int
        Seed of the random changes, which differ between bearings and rows all the same.

    Raises
    ------
    RotorError
        A mean or scatter below 0 or above `MOST_SLIP` and `MOST_SCATTER`, or a seed that is no whole number from 0.
    """

    mean: float = 0.0
    scatter: float = 0.0
    seed: int = 1

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name, most in (("mean", MOST_SLIP), ("scatter", MOST_SCATTER)):
            value = getattr(self, name)
            require_finite(f"{name} of a slip", value)
            require(0.0 <= value <= most, f"{name} of a slip", value, f"0 to {most:g}")
        seed: object = self.seed
        require(isinstance(seed, int) and seed >= 0, "seed of a slip", seed, "a whole number from 0")

    def deviations(self, name: str, row: int) -> FloatArray:
        """Angle of a row's cage beyond its mean at the passing of each element, (n + 1,), over that between elements.

        Without scatter there are none, (1,). After these n passes the same changes return.
        """
        if self.scatter == 0.0:
            return np.zeros(1)
        generator = np.random.default_rng([self.seed, zlib.crc32(name.encode()), row])
        return np.concatenate([[0.0], np.cumsum(self.scatter * generator.normal(size=_PASSES))])

    def half_width(self, passes: float) -> float:
        """Half-width b of the first multiple of a frequency at which elements pass a place of the ring at rest."""
        return math.pi * self.scatter**2 * passes


NO_SLIP = CageSlip()
"""Pure rolling."""
