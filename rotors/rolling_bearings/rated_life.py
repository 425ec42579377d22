"""Rated lives of rolling bearings: L10 of ISO 281 and L10r of ISO/TS 16281, by the maker's rating or the geometry's.

Under loads that change, each for an even part of the revolutions, parts of the life add up (Palmgren 1924, Miner 1945):
1/L = mean(1/L_i), and the equivalent load is P = mean(P_i^p)^(1/p).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearwhine.rotors.rolling_bearings.equilibrium import RollingState
from gearwhine.rotors.rolling_bearings.life import (
    equivalent_load,
    life_exponent,
    rated_revolutions,
    reference_revolutions,
)

_HOUR = 3600.0


@dataclass(frozen=True, eq=False)
class BearingLife:
    """Ratings and lives of a rolling bearing under its load.

    Attributes
    ----------
    state : RollingState
    speed : float or None
        Speed of its shaft in operation [rad/s]; None or 0 where it has no life in hours.
    over_turn : tuple of RollingState
        The bearing under each of the loads that it has for even parts of the time; none where its load is constant.
    """

    state: RollingState
    speed: float | None
    over_turn: tuple[RollingState, ...] = ()

    @property
    def rating(self) -> float:
        """Dynamic rating C [N]: by its maker, else of the geometry by ISO 281."""
        return self.state.bearing.dynamic_rating

    @property
    def rating_from(self) -> str:
        """Source of the rating: "case" where it is given, by a case or in Python, else "geometry"."""
        return "geometry" if self.state.bearing.catalogue_rating is None else "case"

    @property
    def equivalent_load(self) -> float | None:
        """Equivalent dynamic load P by ISO 281 [N]; None where it is not defined."""
        loads = [equivalent_load(state) for state in self._states]
        power = life_exponent(self.state.bearing)
        known = [load**power for load in loads if load is not None]
        return float(np.mean(known) ** (1.0 / power)) if len(known) == len(loads) else None

    @property
    def life(self) -> float | None:
        """Basic rating life L10 by ISO 281 at the speed of operation [h]; None where it is not defined."""
        return self._hours(rated_revolutions)

    @property
    def reference_life(self) -> float | None:
        """Basic reference rating life L10r by ISO/TS 16281 of the elements' loads, at the speed of operation [h]."""
        return self._hours(reference_revolutions)

    def _hours(self, life: Callable[[RollingState, float], float | None]) -> float | None:
        if not self.speed:
            return None
        revolutions = [life(state, self.rating) for state in self._states]
        known = [1.0 / of_state for of_state in revolutions if of_state is not None]
        if len(known) < len(revolutions):
            return None
        used = float(np.mean(known)) * abs(self.speed) * _HOUR / (2.0 * math.pi)
        return 1.0 / used if used > 0.0 else math.inf

    @property
    def _states(self) -> tuple[RollingState, ...]:
        return self.over_turn or (self.state,)
