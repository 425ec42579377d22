"""Rated lives of rolling bearings: L10 of ISO 281 and L10r of ISO/TS 16281, by the maker's rating or the geometry's.

Loads P_k that follow each other for as many revolutions each, as those of a planet over a turn of its carrier, wear a
bearing by Miner's rule: 1/L = Σ 1/L_k / n, for which ISO 281 has the equivalent load P = (Σ P_k^p / n)^{1/p}.
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
from gearwhine.rotors.rolling_bearings.ratings import dynamic_rating

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
        States that follow each other for as many revolutions each; none where the load stays that of ``state``.
    """

    state: RollingState
    speed: float | None
    over_turn: tuple[RollingState, ...] = ()

    @property
    def rating(self) -> float:
        """Dynamic rating C [N]: by its maker, else of the geometry by ISO 281."""
        bearing = self.state.bearing
        if bearing.catalogue_rating is not None:
            return bearing.catalogue_rating
        return dynamic_rating(bearing.rows[0], len(bearing.rows))

    @property
    def rating_from(self) -> str:
        """Source of the rating: "case" where it is given, by a case or in Python, else "geometry"."""
        return "geometry" if self.state.bearing.catalogue_rating is None else "case"

    @property
    def equivalent_load(self) -> float | None:
        """Equivalent dynamic load P by ISO 281 [N]; None where it is not defined."""
        loads = [equivalent_load(state) for state in self.over_turn or (self.state,)]
        defined = np.array([load for load in loads if load is not None])
        power = life_exponent(self.state)
        return None if defined.size < len(loads) else float(np.mean(defined**power) ** (1.0 / power))

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
        lives = [life(state, self.rating) for state in self.over_turn or (self.state,)]
        wear = [1.0 / revolutions for revolutions in lives if revolutions is not None]
        if len(wear) < len(lives):
            return None
        return math.inf if not any(wear) else 2.0 * math.pi / (float(np.mean(wear)) * abs(self.speed) * _HOUR)
