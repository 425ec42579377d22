"""Stability of the coupled modes: growing modes, their growth rates, and the parts that feed energy into them."""

from dataclasses import dataclass

import numpy as np

from coupling.modes import CoupledModes
from coupling.shares import Part

_NEUTRAL = 1e-9  # damping ratios below this are rounding
_ROUNDING = 1e-12  # eigenvalues below this part of the largest are rounding


@dataclass(frozen=True)
class GrowingMode:
    """An unstable mode, which grows from any disturbance until a nonlinearity limits it.

    Attributes
    ----------
    mode : int
        Index among the modes.
    eigenvalue : complex
        λ [1/s]; real for a divergence without oscillation.
    kind, where : str
        As in :class:`coupling.CoupledModes`.
    feeders : tuple of (Part, float)
        Parts that feed energy into it, the strongest first, with their negative parts of the damping ratio. For a
        divergence by negative stiffness, those parts with minus their shares of the strain energy.
    """

    mode: int
    eigenvalue: complex
    kind: str
    where: str
    feeders: tuple[tuple[Part, float], ...]

    @property
    def damping_ratio(self) -> float:
        """-Re λ / |λ|, negative."""
        return float(-self.eigenvalue.real / abs(self.eigenvalue))

    @property
    def doubling_time(self) -> float:
        """Time in which its amplitude doubles [s]."""
        return float(np.log(2.0) / self.eigenvalue.real)


@dataclass(frozen=True)
class Stability:
    """Stability of a set of modes.

    Attributes
    ----------
    growing : tuple of GrowingMode
        The fastest first; none in a stable system.
    least_damped : int or None
        Index of the oscillating mode with the lowest damping ratio.
    """

    growing: tuple[GrowingMode, ...]
    least_damped: int | None

    @property
    def stable(self) -> bool:
        """Whether nothing grows."""
        return not self.growing


def stability(modes: CoupledModes, tolerance: float = _NEUTRAL) -> Stability:
    """Stability of modes by the sign of their damping.

    Parameters
    ----------
    modes : CoupledModes
    tolerance : float
        Damping ratios from -tolerance up are no growth, nor are eigenvalues that are rounding of the largest one.
    """
    ratios = modes.damping_ratios
    # The damping ratio of a rigid-body motion is ±1 however small its eigenvalue.
    still = np.abs(modes.eigenvalues) <= _ROUNDING * np.abs(modes.eigenvalues).max(initial=0.0)
    growing = [_growing(modes, int(i)) for i in np.flatnonzero((ratios < -tolerance) & ~still)]
    swinging = np.flatnonzero(modes.eigenvalues.imag > 0.0)
    return Stability(
        growing=tuple(sorted(growing, key=lambda one: -one.eigenvalue.real)),
        least_damped=int(swinging[np.argmin(ratios[swinging])]) if swinging.size else None,
    )


def _growing(modes: CoupledModes, i: int) -> GrowingMode:
    shares = modes.shares
    swings = modes.eigenvalues[i].imag != 0.0
    # A divergence by negative stiffness is independent of the damping: dashpots only slow it.
    given = shares.damping[i] if swings or shares.stiffness[i] >= 0.0 else -shares.strain[i]
    least = -_NEUTRAL * float(np.abs(given).max(initial=0.0))
    feeders = [(shares.parts[j], float(given[j])) for j in np.argsort(given, kind="stable") if given[j] < least]
    return GrowingMode(i, complex(modes.eigenvalues[i]), modes.kinds[i], modes.where[i], tuple(feeders))
