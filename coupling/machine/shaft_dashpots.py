"""Dashpots of flexible shaft couplings, and of a shaft's material: internal damping, which rotates with the shaft.

A coupling of length L yields by the sway of its right end over its left one, δ = u_r - u_l - L (φ_l + φ_r)/2 across the
axis, by the tilt φ_r - φ_l, and along and about the axis by the differences of its ends. Dashpots resist their
velocities in the rotating shaft. Across the axis that is, in the frame at rest and at a speed Ω,

    f = c (δ' + Ω (δ_y, -δ_x)),

damping and a circulatory stiffness: internal damping, which feeds forward whirl above its natural frequency (Genta,
Dynamics of Rotating Systems, 2005, section 4.4). A shaft of viscoelastic material, σ = E (ε + η ε'), has c = η k
in each of its free modes (Zorzi & Nelson, J. Eng. Power 99, 71, 1977).
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.machine.components import RotorComponent
from gearwhine.coupling.machine.connectors import LinearConnector, SpeedTable
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True)
class ShaftDashpots:
    """Dashpots of a flexible coupling in a rotor.

    Attributes
    ----------
    name, rotor : str
    left, right : float
        Ends of the coupling, from the rotor's left end [m].
    lateral, axial : float
        Damping coefficients [N s/m].
    tilt, torsional : float
        Damping coefficients [N m s/rad].
    """

    name: str
    rotor: str
    left: float
    right: float
    lateral: float = 0.0
    tilt: float = 0.0
    torsional: float = 0.0
    axial: float = 0.0


def shaft_dashpots(
    dashpots: ShaftDashpots, rotor: RotorComponent, speed: float, speed_range: tuple[float, float] = (1.0, 1.0)
) -> tuple[FloatArray, LinearConnector]:
    """Deflections of a coupling by its rotor's coordinates, shape (6, m), and the law of its dashpots as a connector.

    Parameters
    ----------
    speed : float
        Ω, signed [rad/s].
    speed_range : tuple of float
        Lowest and highest speed of the run, as parts of Ω: the circulatory stiffness is proportional to the speed.
    """
    left, right = rotor.motions(dashpots.left), rotor.motions(dashpots.right)
    middle = 0.5 * (dashpots.right - dashpots.left) * (left[3:] + right[3:])
    # A tilt about y moves what is further along z to +x, one about x to -y.
    sway = right[:2] - left[:2] - np.array([middle[1], -middle[0]])
    tilt = right[3:] - left[3:]
    turn = rotor.rotation(dashpots.right) - rotor.rotation(dashpots.left)
    rows = np.vstack([sway, tilt, turn[None], right[2:3] - left[2:3]])
    damping = np.diag(
        [dashpots.lateral, dashpots.lateral, dashpots.tilt, dashpots.tilt, dashpots.torsional, dashpots.axial]
    )
    pairs = [(0, 1, dashpots.lateral), (2, 3, dashpots.tilt)]
    return rows, _rotating(dashpots.name, rows.T, damping, pairs, speed, speed_range)


def internal_damping(rotor: RotorComponent, speed: float, speed_range: tuple[float, float]) -> LinearConnector:
    """Law of the damping of a shaft's material over the coordinates of its rotor that deform it, as a connector.

    Parameters
    ----------
    rotor : RotorComponent
    speed : float
        Ω, signed [rad/s].
    speed_range : tuple of float
        Lowest and highest speed of the run, as parts of Ω.
    """
    damped = np.flatnonzero(rotor.internal_damping)
    values = rotor.internal_damping[damped]
    own = {int(number): place for place, number in enumerate(damped)}
    pairs = [
        (place, own[number + rotor.plane_size], float(values[place]))
        for number, place in own.items()
        if number < rotor.plane_size
    ]
    name = f"internal damping of {rotor.name}"
    return _rotating(name, np.eye(rotor.size)[:, damped], np.diag(values), pairs, speed, speed_range)


def _rotating(
    name: str,
    directions: FloatArray,
    damping: FloatArray,
    pairs: Iterable[tuple[int, int, float]],
    speed: float,
    speed_range: tuple[float, float],
) -> LinearConnector:
    """Dashpots as a connector; ``pairs`` are directions along x and y with the damping that rotates."""
    circulating = np.zeros_like(damping)
    for x, y, value in pairs:
        circulating[x, y], circulating[y, x] = speed * value, -speed * value
    table = None
    if speed_range[0] != speed_range[1] and np.any(circulating):
        ends = np.array(speed_range)
        table = SpeedTable(ends, ends[:, None, None] * circulating, np.stack([damping, damping]))
    return LinearConnector(name, directions, circulating, damping, over_speed=table)
