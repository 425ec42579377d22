"""Gear bodies as torsional springs between shaft and rim: their stiffness, inertia, and which of them motion resolves.

The twist of a gear's body is strained near its bore, while most of its polar inertia is near the rim: it lies between
the shaft and the teeth with their inertia, and not between the teeth of two gears. In motion the rotation of the rim
against the hub is a coordinate of the shaft's component (:func:`coupling.machine.components.rotor_component`), and the
law of the contact loses that part of the compliance which pairs of teeth share. Springs in series have the same
deflection in either place, so the static equilibrium of one pair of gears is that of the complete contact law.

A gear that several pairs share has one rim, which all of them turn: an idler passes its torque on without a twist, and
paths that part at a gear feel its twist alike. Its spring is the stiffest that one of its pairs has by the width of the
common face, and what is left stays in the others' contact laws. The static machine has such rims too
(:class:`coupling.statics.static_model.StaticRim`).

The twist stays in the contact law where a body has no inertia of its own at its place, so that there is nothing beside
the shaft that it could move. Of a gear in one pair it stays there also where the rim on a hub at rest vibrates far
above the frequencies of the shaft's modes: it responds statically in any place then. The frequency f of a mesh mode
errs by about half of (f / f_rim)² of itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, sqrt

from coupling.gears import Gear
from coupling.gears.stiffness.body_twist import rim_shares

STATIC_BEYOND = 10.0
"""Frequency of the rim on a hub at rest, over the limit of the shaft's modes, above which its twist is static."""


@dataclass(frozen=True)
class GearBody:
    """The body of a gear between its hub, which turns with the shaft, and its rim.

    Attributes
    ----------
    gear : str
        Name of the gear.
    at : float
        Station of the hub, from the left end of the shaft [m].
    stiffness : float
        Torsional stiffness between hub and rim [N m].
    coupling_inertia : float
        S = ∫ s dJ [kg m²], see :mod:`coupling.gears.stiffness.body_twist`.
    rim_inertia : float
        J_r = ∫ s² dJ [kg m²].
    """

    gear: str
    at: float
    stiffness: float
    coupling_inertia: float
    rim_inertia: float

    @property
    def frequency_hz(self) -> float:
        """Natural frequency of the rim on a hub at rest [Hz]."""
        return sqrt(self.stiffness / self.rim_inertia) / (2.0 * pi)


def gear_body(gear: Gear, at: float, inertia: float, stiffness: float, frequency_limit: float) -> GearBody | None:
    """Make the body of a gear; None where its twist is static.

    Parameters
    ----------
    gear : Gear
    at : float
        Station of the hub, from the left end of the shaft [m].
    inertia : float
        Polar inertia of the body beside that of the shaft [kg m²], distributed as that of the gear's geometry is.
    stiffness : float
        Torsional stiffness between hub and rim [N m]; infinite for a body that does not twist.
    frequency_limit : float
        Limit of the shaft's modes [rad/s]; infinite to have the rim as a coordinate at any frequency.
    """
    highest = STATIC_BEYOND * frequency_limit
    # No rim has more than the inertia of its body.
    if inertia <= 0.0 or stiffness >= highest**2 * inertia:
        return None
    shares = rim_shares(gear)
    body = GearBody(gear.name, at, stiffness, shares.coupling * inertia, shares.rim * inertia)
    return body if stiffness < highest**2 * body.rim_inertia else None


def stiffest(twists: Sequence[tuple[float, float]]) -> float:
    """Stiffness between hub and rim [N m] by base radius [m] and twist [m/N] of each pair; infinite for no twist."""
    return max((radius**2 / twist if twist > 0.0 else float("inf") for radius, twist in twists), default=float("inf"))
