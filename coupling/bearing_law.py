r"""Nonlinear bearing laws: rolling elements with clearance, and gaps that close.

A law turns the deflections δ of the shaft against its seat (x, y, z and the rotations about x and y) into the forces of
the shaft on the seat; :mod:`coupling.bearing_kernels` is its compiled form.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from rotors.rolling import RollingState

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RollingLaw:
    """Hertzian force of every rolling element, with the clearance, as the cage carries the elements round.

    The elements have no inertia. The compliance of the bearing depends on the cage angle, so it varies with the
    element-passing frequency.

    Attributes
    ----------
    state : RollingState
        The bearing at its mean load: start of the search for equilibrium, and position of the ring along directions
        in which the shaft cannot move.
    cage_angle : float
        Azimuth of the first element of every row at t = 0 [rad].
    """

    state: RollingState
    cage_angle: float = 0.0

    @property
    def reference(self) -> FloatArray:
        """Displacement at the mean load [m, rad], shape (5,)."""
        return self.state.displacement


@dataclass(frozen=True)
class GapLaw:
    """Radial gap law of a ring around the shaft: beyond the gap the force is F (penetration / depth)^n.

    Attributes
    ----------
    force : float
        F, at a penetration of ``depth`` [N].
    depth : float
        Penetration beyond the gap at which the force is F [m].
    exponent : float
        n, at least 1.
    gap : float
        Radial [m]; 0 for a spring of this law without one.
    """

    force: float
    depth: float
    exponent: float = 1.0
    gap: float = 0.0

    def __post_init__(self) -> None:
        for what in ("force", "depth"):
            value = getattr(self, what)
            if not (math.isfinite(value) and value > 0.0):
                raise CouplingError(f"{what} of a gap's law of {value!r}; expected a positive number")
        if not (math.isfinite(self.exponent) and self.exponent >= 1.0):
            raise CouplingError(f"exponent of a gap's law of {self.exponent!r}; expected 1 or more")
        if not (math.isfinite(self.gap) and self.gap >= 0.0):
            raise CouplingError(f"gap of {self.gap!r} m; expected 0 or more")

    @property
    def reference(self) -> FloatArray:
        """Displacement at which the search for equilibrium begins: the centre, shape (5,)."""
        return np.zeros(5)

    def tangent(self, load: npt.ArrayLike) -> FloatArray:
        """Tangent stiffness over x, y [N/m] under a radial load (2,) [N]; zero without a load.

        With F the load's size and r = gap + depth (F / force)^(1/n) the shaft's radial position: n F / (r - gap) along
        the load, F / r across it.
        """
        push = np.asarray(load, dtype=np.float64)
        size = float(np.hypot(*push))
        if size == 0.0:
            return np.zeros((2, 2)) if self.gap > 0.0 or self.exponent > 1.0 else self.force / self.depth * np.eye(2)
        beyond = self.depth * (size / self.force) ** (1.0 / self.exponent)
        along = np.outer(push, push) / size**2
        across = size / (self.gap + beyond)
        return np.asarray(self.exponent * size / beyond * along + across * (np.eye(2) - along))


BearingLaw = RollingLaw | GapLaw
