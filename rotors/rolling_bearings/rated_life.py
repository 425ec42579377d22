"""Rated lives of rolling bearings: L10 of ISO 281 and L10r of ISO/TS 16281, by the maker's rating or the geometry's."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from gearwhine.rotors.rolling_bearings.equilibrium import RollingState
from gearwhine.rotors.rolling_bearings.life import equivalent_load, rated_revolutions, reference_revolutions

_HOUR = 3600.0


@dataclass(frozen=True, eq=False)
class BearingLife:
    """Ratings and lives of a rolling bearing under its load.

    Attributes
    ----------
    state : RollingState
    speed : float or None
        Speed of its shaft in operation [rad/s]; None or 0 where it has no life in hours.
    """

    state: RollingState
    speed: float | None

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
        return equivalent_load(self.state)

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
        revolutions = life(self.state, self.rating)
        return None if revolutions is None else revolutions * 2.0 * math.pi / (abs(self.speed) * _HOUR)
