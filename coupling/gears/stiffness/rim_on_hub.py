r"""Rim of a gear on its hub: stiffness and inertia of its rotation and of its shift across the shaft.

The body is the ring or the rings between the circle a where it is held and the root circle b
(:mod:`gearwhine.coupling.gears.stiffness.ring_body`). What it yields between the two circles as a whole is strained
near the bore, while its inertia is near the rim. With the static shape of each motion as the only one in dynamics (the
static condensation of Guyan 1965) the rim is a rigid body on a spring, and energy and inertia are consistent.

*Rotation.* Under a torque from hub to rim the circle of radius r turns by the part

    s(r) = ∫_a^r dr / (w r³) / ∫_a^b dr / (w r³)

of the root circle's rotation φ against the held one, w the width of the ring at r: (1/a² - 1/r²) / (1/a² - 1/b²) for
one ring. With θ(r) = θ_hub + s φ the strain energy is ½ k φ², k the exact static stiffness, and the kinetic energy

    ½ J θ_hub'² + S θ_hub' φ' + ½ J_r φ'²,        S = ∫ s dJ,        J_r = ∫ s² dJ,

J being the polar inertia of the blank. In terms of hub and rim the matrix is [J - 2 S + J_r, S - J_r; S - J_r, J_r],
whose sum is J.

*Shift.* Tractions p (cos t, -sin t) on the root circle have a resultant force along t = 0 and no other. The ring moves
by (U(r) cos t, V(r) sin t), wave 1 of the plane ring, and its root circle as a whole by w = (U - V)/2. With U and V of
w = 1 and the mass m of the blank, S = ∫ ½ (U - V) dm and M_r = ∫ ½ (U² + V²) dm take the places of S and J_r. What a
single tooth moves the root circle beyond w, the rim's own deformation, stays with the teeth.

The teeth move with the root circle.

An internal gear is held at its outside; a and b are then outside and root circle. What its support yields moves the
ring as a whole, s = 1, in proportion to its part of the compliance.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.stiffness.beam import PlaneState
from gearwhine.coupling.gears.stiffness.elastic_ring import ring_motions, root_motion
from gearwhine.coupling.gears.stiffness.foundation import held_radius
from gearwhine.coupling.gears.stiffness.ring_body import body_rings, kolosov, ring_section, twist_compliance
from gearwhine.coupling.gears.stiffness.toothed_ring import ring_flexibility

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_RIGID_MOTION_TRACTIONS = np.array(
    [1.0, -1.0]
)  # tractions, or displacements, of a rigid motion of a circle along t = 0


class RimShares(NamedTuple):
    """Parts of a gear's inertia, polar or mass, that a motion of its rim against the hub has.

    Attributes
    ----------
    coupling : float
        S / J or S / m: the part in the momentum of the rim's motion.
    rim : float
        J_r / J or M_r / m: the part in its kinetic energy.
    """

    coupling: float
    rim: float


def rotation_shares(gear: Gear) -> RimShares:
    """Parts S / J and J_r / J of the polar inertia of a gear's blank; of a gear in one piece with its shaft both are 1.

    Raises
    ------
    StiffnessModelError
        For a web that begins inside the bore's circle.
    """
    if held_radius(gear) is None:
        return RimShares(1.0, 1.0)
    root, rings = abs(gear.root_circle_radius), body_rings(gear)
    softness = [(ring.held**-2 - ring.loaded**-2) / ring.width for ring in rings]
    # Inertias over 2 π ρ, radii in root circle radii; the teeth first.
    sign = gear.sign
    toothed = sign * 0.25 * gear.face_width * ((gear.pitch_radius / root) ** 4 - 1.0)
    whole = coupling = rim = toothed
    before = 0.0
    for ring, ring_softness in zip(rings, softness, strict=True):
        a, b = ring.held, ring.loaded
        # s = p - q / r² on this ring.
        q = 1.0 / (ring.width * sum(softness))
        p = before / sum(softness) + q / a**2
        fourth, square = sign * 0.25 * (b**4 - a**4), sign * 0.5 * (b**2 - a**2)
        whole += ring.width * fourth
        coupling += ring.width * (p * fourth - q * square)
        rim += ring.width * (p**2 * fourth - 2.0 * p * q * square + sign * q**2 * math.log(b / a))
        before += ring_softness
    shares = RimShares(coupling / whole, rim / whole)
    if gear.ring_support is None:
        return shares
    return _with_support(shares, 1.0 - twist_compliance(gear, supported=False) / twist_compliance(gear))


def shift_shares(gear: Gear, state: PlaneState) -> RimShares:
    """Parts S / m and M_r / m of the mass of a gear's blank; of a gear in one piece with its shaft both are 1.

    Raises
    ------
    StiffnessModelError
        For a web that begins inside the bore's circle.
    """
    return _shift_shares(gear.sound, state)


@lru_cache(maxsize=64)  # gears of one drawing differ in their flanks alone
def _shift_shares(gear: Gear, state: PlaneState) -> RimShares:
    if held_radius(gear) is None:
        return RimShares(1.0, 1.0)
    root, rings = abs(gear.root_circle_radius), body_rings(gear)
    places = [ring.held + 0.5 * (ring.loaded - ring.held) * (1.0 + _NODES) for ring in rings]
    fields = ring_motions(rings, 1, kolosov(gear, state), _RIGID_MOTION_TRACTIONS, places)
    at_root = root_motion(rings, 1, kolosov(gear, state), _RIGID_MOTION_TRACTIONS)
    shift = 0.5 * float(_RIGID_MOTION_TRACTIONS @ at_root)
    # Masses over π ρ, radii in root circle radii; the teeth first.
    sign = gear.sign
    whole = coupling = sign * gear.face_width * ((gear.pitch_radius / root) ** 2 - 1.0)
    rim = 0.5 * whole * float(at_root @ at_root) / shift**2
    for ring, radius, field in zip(rings, places, fields, strict=True):
        mass = sign * ring.width * (ring.loaded - ring.held) * _WEIGHTS * radius
        whole += float(mass.sum())
        coupling += float(mass @ (field @ _RIGID_MOTION_TRACTIONS)) * 0.5 / shift
        rim += float(mass @ (field**2).sum(axis=1)) * 0.5 / shift**2
    shares = RimShares(coupling / whole, rim / whole)
    if gear.ring_support is None:
        return shares
    clamped = shift_compliance(gear, state, supported=False)
    return _with_support(shares, 1.0 - clamped / shift_compliance(gear, state))


def _with_support(shares: RimShares, support: float) -> RimShares:
    """Shares of a ring whose support has this part of its compliance: so far it moves as a whole, s = 1."""
    coupling = support + (1.0 - support) * shares.coupling
    rim = support**2 + 2.0 * support * (1.0 - support) * shares.coupling + (1.0 - support) ** 2 * shares.rim
    return RimShares(coupling, rim)


def shift_compliance(gear: Gear, state: PlaneState, *, supported: bool = True) -> float:
    """Shift of a spur gear's rim on its hub under a force across the shaft [m/N]; 0 in one piece with its shaft.

    Of an internal gear it is that of the ring with its teeth and, unless it is not counted, its support, in the
    transverse section.
    """
    if held_radius(gear) is None:
        return 0.0
    if gear.is_internal:
        section = ring_section(gear, state, supported=supported)
        return ring_flexibility(section).shift / (gear.youngs_modulus * gear.face_width)
    rings, nu = body_rings(gear), gear.poisson_ratio
    at_root = root_motion(rings, 1, kolosov(gear, state), _RIGID_MOTION_TRACTIONS)
    # Times 2 mu, under a traction of 1 whose resultant is 2 pi times the width; E / (2 mu) = 1 + nu.
    shift = 0.5 * float(_RIGID_MOTION_TRACTIONS @ at_root)
    return (1.0 + nu) * shift / (2.0 * math.pi * gear.youngs_modulus * gear.face_width)
