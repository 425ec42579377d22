"""Nonlinear bearing laws in the time domain: rolling elements with clearance, and gaps that close.

A law turns the deflections δ of the shaft against its seat (x, y, z and the rotations about x and y) into the forces of
the shaft on the seat; :mod:`gearwhine.coupling.connector_forces.bearing_kernels` is its compiled form.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.rolling_bearings import (
    NO_SLIP,
    BearingDamage,
    CageSlip,
    FourPointRow,
    RollerRow,
    RollingState,
    require_possible,
)


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
    spalls : tuple of RollingSpall or CageFault
        Damage of the raceways and elements, over which the elements drop, and of the cage; see
        :mod:`gearwhine.rotors.rolling_bearings.spalls`.
    slip : CageSlip
        Slip of the cage of every row; none by default.

    Raises
    ------
    CouplingError
        Balls in four-point contact, or cylindrical rollers with flanges, which have no law in the time domain.
    gearwhine.rotors.RotorError
        A spall that the bearing cannot have.
    """

    state: RollingState
    cage_angle: float = 0.0
    spalls: tuple[BearingDamage, ...] = ()
    slip: CageSlip = NO_SLIP

    def __post_init__(self) -> None:
        """Require rows whose elements have a law in the time domain, and spalls that they can have."""
        for spall in self.spalls:
            require_possible(spall, self.state.bearing)
        for row in self.state.bearing.rows:
            flanged = isinstance(row, RollerRow) and row.flanges != "none"
            if flanged or isinstance(row, FourPointRow):
                kind = "cylindrical rollers between flanges" if flanged else "balls in four-point contact"
                raise CouplingError(
                    f"{self.state.bearing.name} has {kind}; expected other elements where a law follows each of them: "
                    'linearise it, law = "linear" of a case'
                )

    @property
    def reference(self) -> FloatArray:
        """Displacement at the mean load [m, rad], shape (5,)."""
        return self.state.displacement

    @property
    def floats(self) -> bool:
        """Whether the outer ring slides in its seat along z, without axial force."""
        return self.state.bearing.floating


@dataclass(frozen=True)
class GapLaw:
    """Radial gap law of a ring around the shaft: beyond the gap the force is F (penetration / depth)^n.

    :mod:`gearwhine.coupling.connector_forces.bearing_kernels` has its compiled form.

    Attributes
    ----------
    force : float
        Force F at a penetration of ``depth`` [N].
    depth : float
        Penetration beyond the gap at which the force is F [m].
    exponent : float
        Exponent n, at least 1.
    gap : float
        Radial gap [m]; 0 for a spring of this law without a gap.
    """

    force: float
    depth: float
    exponent: float = 1.0
    gap: float = 0.0

    def __post_init__(self) -> None:
        """Require a positive force and depth, an exponent of 1 or more and no negative gap."""
        for attribute in ("force", "depth"):
            value = getattr(self, attribute)
            if not (math.isfinite(value) and value > 0.0):
                raise CouplingError(f"{attribute} of a gap's law of {value!r}; expected a positive number")
        if not (math.isfinite(self.exponent) and self.exponent >= 1.0):
            raise CouplingError(f"exponent of a gap's law of {self.exponent!r}; expected 1 or more")
        if not (math.isfinite(self.gap) and self.gap >= 0.0):
            raise CouplingError(f"gap of {self.gap!r} m; expected 0 or more")

    @property
    def reference(self) -> FloatArray:
        """Displacement at which the search for equilibrium begins: the centre, shape (5,)."""
        return np.zeros(5)

    def at(self, place: npt.ArrayLike) -> tuple[float, FloatArray, FloatArray]:
        """Energy [J], force of the shaft on the ring (2,) [N] and tangent (2, 2) [N/m] at a radial place (2,) [m]."""
        position = np.asarray(place, dtype=np.float64)
        radius = float(np.hypot(*position))
        beyond = radius - self.gap
        if beyond <= 0.0:
            return 0.0, np.zeros(2), self.tangent(np.zeros(2))
        size, away = self.force * (beyond / self.depth) ** self.exponent, position / radius
        return size * beyond / (self.exponent + 1.0), size * away, self._loaded_tangent(size, beyond, away)

    def tangent(self, load: npt.ArrayLike) -> FloatArray:
        """Tangent stiffness over x, y [N/m] under a radial load (2,) [N].

        Without a load it is the tangent within the gap: zero, except for a linear spring without a gap.
        """
        push = np.asarray(load, dtype=np.float64)
        size = float(np.hypot(*push))
        if size == 0.0:
            return np.zeros((2, 2)) if self.gap > 0.0 or self.exponent > 1.0 else self.force / self.depth * np.eye(2)
        beyond = self.depth * (size / self.force) ** (1.0 / self.exponent)
        return self._loaded_tangent(size, beyond, push / size)

    def _loaded_tangent(self, size: float, beyond: float, away: FloatArray) -> FloatArray:
        """Tangent at a force F of this size: with r the radial place, n F / (r - gap) along it and F / r across it.

        ``beyond`` is r - gap, ``away`` the unit vector of the place.
        """
        along = np.outer(away, away)
        across = size / (self.gap + beyond)
        return np.asarray(self.exponent * size / beyond * along + across * (np.eye(2) - along))


BearingLaw = RollingLaw | GapLaw
