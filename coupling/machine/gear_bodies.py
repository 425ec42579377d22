"""Gear bodies between shaft and rim: stiffness, inertia, and which motions of the rims are coordinates.

What a gear's body yields as a whole is strained near its bore, while most of its inertia is near the rim: it lies
between the shaft and the teeth with their inertia, and not between the teeth of two gears. In motion the rotation of
the rim against the hub, and its shift across the shaft, are coordinates of the shaft's component
(:func:`coupling.machine.components.rotor_component`), and the law of the contact loses that part of the compliance
which pairs of teeth share. Springs in series have the same deflection in either place, so the static equilibrium of one
pair of gears is that of the complete contact law.

A gear that several pairs share has one rim, which all of them move: an idler passes its torque on without a twist, and
paths that part at a gear feel its twist alike. Its springs are the stiffest that one of its pairs has by the width of
the common face, and what is left stays in the others' contact laws. The static machine has such rims, too
(:func:`coupling.statics.operating_point_search.solve_operating_point`).

The spring stays in the contact law where a body has no inertia of its own at its place, so that there is nothing beside
the shaft that it could move. Of a gear in one pair it stays there also where the rim on a hub at rest vibrates far
above the frequencies of the shaft's modes: it responds statically in any place then. The frequency f of a mesh mode
errs by about half of (f / f_rim)² of itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, pi, sqrt

from coupling.gears.stiffness.rim_on_hub import RimShares

STATIC_BEYOND = 10.0
"""Frequency of the rim on a hub at rest, over the limit of the shaft's modes, above which its spring is static."""


@dataclass(frozen=True)
class RimSpring:
    """A motion of a rim on its hub: rotation about the shaft, or shift across it.

    Attributes
    ----------
    stiffness : float
        [N m] of a rotation, [N/m] of a shift.
    coupling_inertia : float
        S [kg m²] or [kg], see :mod:`coupling.gears.stiffness.rim_on_hub`.
    rim_inertia : float
        J_r [kg m²] or M_r [kg].
    """

    stiffness: float
    coupling_inertia: float
    rim_inertia: float

    @property
    def frequency_hz(self) -> float:
        """Natural frequency of the rim on a hub at rest [Hz]."""
        return sqrt(self.stiffness / self.rim_inertia) / (2.0 * pi)


@dataclass(frozen=True)
class GearBody:
    """The body of a gear between its hub, which moves with the shaft, and its rim.

    Attributes
    ----------
    gear : str
        Name of the gear.
    at : float
        Station of the hub, from the left end of the shaft [m].
    twist, shift : RimSpring or None
        Rotation about the shaft, and shift along any direction across it; None where it is static.
    """

    gear: str
    at: float
    twist: RimSpring | None
    shift: RimSpring | None

    def compliance(self, base_radius: float) -> float:
        """Motion of the teeth by that of the rim on the hub, along the line of action [m/N]."""
        twist = 0.0 if self.twist is None else base_radius**2 / self.twist.stiffness
        return twist + (0.0 if self.shift is None else 1.0 / self.shift.stiffness)


def rim_spring(stiffness: float, inertia: float, shares: RimShares, frequency_limit: float) -> RimSpring | None:
    """Make the spring of a rim; None where it is static.

    Parameters
    ----------
    stiffness : float
        Stiffness between hub and rim [N m] or [N/m]; infinite for a rim that does not move.
    inertia : float
        Polar inertia [kg m²] or mass [kg] of the body beside those of the shaft, distributed as by its geometry.
    shares : RimShares
    frequency_limit : float
        Limit of the shaft's modes [rad/s]; infinite to have the rim as a coordinate at any frequency.
    """
    if inertia <= 0.0 or stiffness == inf or stiffness >= (STATIC_BEYOND * frequency_limit) ** 2 * shares.rim * inertia:
        return None
    return RimSpring(stiffness, shares.coupling * inertia, shares.rim * inertia)


def stiffest(compliances: Sequence[float]) -> float:
    """Stiffness of the stiffest of some springs by their compliances; infinite where one is zero, or without any."""
    return inf if min(compliances, default=0.0) <= 0.0 else 1.0 / min(compliances)
