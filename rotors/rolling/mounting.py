"""Linear bearing from a loaded rolling bearing, and Krämer's stiffness formulas for a first estimate."""

import math

import numpy as np
import numpy.typing as npt

from rotors.bearing import Bearing
from rotors.errors import EquilibriumError, require_count, require_finite

from .state import RollingState


def linearised_bearing(state: RollingState, name: str, at: float, *, damping: npt.ArrayLike | None = None) -> Bearing:
    """The linear bearing of a rolling bearing about its equilibrium.

    Parameters
    ----------
    state
        From `rolling_equilibrium`.
    name, at
        Name of the bearing in messages, and place of its centre, m from the rotor's left end.
    damping
        (2, 2) or (5, 5), N·s/m and its like; zero if not given, as contact mechanics gives none.

    Raises
    ------
    EquilibriumError
        Clearance leaves the shaft loose in x or y at this load.
    RotorError
        As `Bearing`.
    """
    loose = [direction for direction in state.loose if direction in ("x", "y")]
    if loose:
        raise EquilibriumError(
            f"{state.bearing.name} leaves the shaft loose in {' and '.join(loose)} under {state.load.tolist()}; "
            "expected a load, a preload or less clearance, so that its elements hold the shaft all around"
        )
    damped = np.zeros((2, 2)) if damping is None else np.asarray(damping, dtype=np.float64)
    return Bearing(name, at, state.stiffness, damped)


def kramer_ball_stiffness(count: int, ball_diameter: float, load: float, contact_angle: float = 0.0) -> float:
    """Radial stiffness (N/m) in the direction of a radial load (N) by Krämer's formula, for a first estimate.

    k = 13e6 Z^{2/3} d^{1/3} F^{1/3} cos^{5/3} α in N and m (Krämer 1993, after Friswell et al. 2010, chapter 5): no
    clearance, grooves as usual.
    """
    _require_formula("balls", count, ball_diameter, load)
    return float(13e6 * (count**2 * ball_diameter * load) ** (1 / 3) * math.cos(contact_angle) ** (5 / 3))


def kramer_roller_stiffness(count: int, length: float, load: float, contact_angle: float = 0.0) -> float:
    """The same of rollers: k = 1.0e9 Z^{0.9} l^{0.8} F^{0.1} cos^{1.9} α, in N and m."""
    _require_formula("rollers", count, length, load)
    return float(1.0e9 * count**0.9 * length**0.8 * load**0.1 * math.cos(contact_angle) ** 1.9)


def _require_formula(what: str, count: int, size: float, load: float) -> None:
    require_count(f"count of {what}", count)
    require_finite(f"size of {what}", size, positive=True)
    require_finite(f"load on {what}", load, minimum=0.0)
