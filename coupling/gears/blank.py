"""Gear blank: mass and moments of inertia of the body that carries the teeth.

The teeth count as a ring out to the reference circle, where they fill half the circumference.  A gear without a rim is
a disc as wide as its face, down to its bore.  A gear with a rim is a ring of the full width down to the inside of the
rim, and a web of its own thickness in the middle of the face from there to the bore; without a web the ring is
alone, and its carrier is given as a disc of the rotor.
"""

import math
from typing import NamedTuple


class Inertia(NamedTuple):
    """Mass [kg] and moments of inertia about the shaft and about a diameter through the middle [kg m^2]."""

    mass: float
    polar: float
    diametral: float


def hollow_disc(density: float, width: float, outer_radius: float, inner_radius: float) -> Inertia:
    """Inertia of a disc with a hole, lengths in m and density in kg/m^3."""
    mass = density * width * math.pi * (outer_radius**2 - inner_radius**2)
    polar = 0.5 * mass * (outer_radius**2 + inner_radius**2)
    return Inertia(mass, polar, 0.5 * polar + mass * width**2 / 12.0)
