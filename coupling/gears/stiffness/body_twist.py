r"""Twist of a gear's body between hub and rim, with its inertia: two torsional ports by Guyan's static condensation.

The body is the ring or the rings between the circle a where it is held and the root circle b
(:mod:`coupling.gears.stiffness.ring_body`). Under a torque that goes from one circle to the other the rotation of the
circle of radius r, as a part of that of the root circle against the held one, is

    s(r) = ∫_a^r dr / (w r³) / ∫_a^b dr / (w r³),

w the width of the ring at r: (1/a² - 1/r²) / (1/a² - 1/b²) for one ring. The teeth turn with the root circle, s = 1.
With the rotations θ(r) = θ_hub + s φ, φ that of the rim against the hub, the strain energy is ½ k φ², k the exact
static stiffness, and the kinetic energy

    ½ J θ_hub'² + S θ_hub' φ' + ½ J_r φ'²,        S = ∫ s dJ,        J_r = ∫ s² dJ,

the polar inertia J being that of the blank. In terms of hub and rim this is the consistent matrix (Guyan 1965)
[J - 2 S + J_r, S - J_r; S - J_r, J_r], whose sum is J. The first natural frequency of a ring that is held at a is
then too high by 0.3 per cent for a thin ring and by 2 per cent for a bore of a seventh of the root circle.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from coupling.gears.geometry.gear import Gear
from coupling.gears.stiffness.foundation import held_radius
from coupling.gears.stiffness.ring_body import body_rings


class RimShares(NamedTuple):
    """Parts of a gear's polar inertia that the rotation of its rim against the hub moves.

    Attributes
    ----------
    coupling : float
        S / J, the part that turns with the rim when the hub stands still, in its angular momentum.
    rim : float
        J_r / J, the part in its kinetic energy.
    """

    coupling: float
    rim: float


def rim_shares(gear: Gear) -> RimShares:
    """Parts S / J and J_r / J of the polar inertia of a gear's blank; of a gear in one piece with its shaft both are 1.

    Raises
    ------
    StiffnessModelError
        For a web that begins inside the bore's circle.
    """
    if held_radius(gear) is None:
        return RimShares(1.0, 1.0)
    root, rings = gear.root_circle_radius, body_rings(gear)
    softness = [(ring.inner**-2 - ring.outer**-2) / ring.width for ring in rings]
    # Inertias over 2 π ρ, radii in root circle radii; the teeth first.
    toothed = 0.25 * gear.face_width * ((gear.pitch_radius / root) ** 4 - 1.0)
    whole = coupling = rim = toothed
    before = 0.0
    for ring, own in zip(rings, softness, strict=True):
        a, b = ring.inner, ring.outer
        # s = p - q / r² on this ring.
        q = 1.0 / (ring.width * sum(softness))
        p = before / sum(softness) + q / a**2
        fourth, square = 0.25 * (b**4 - a**4), 0.5 * (b**2 - a**2)
        whole += ring.width * fourth
        coupling += ring.width * (p * fourth - q * square)
        rim += ring.width * (p**2 * fourth - 2.0 * p * q * square + q**2 * math.log(b / a))
        before += own
    return RimShares(coupling / whole, rim / whole)
