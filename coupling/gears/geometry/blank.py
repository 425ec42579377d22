"""Mass and moments of inertia of a gear blank around its shaft.

A gear without a bore is made from its shaft. The core of its blank is part of the mass of the shaft; the mass of the
gear is what lies outside: from the shaft's radius r_s(z), or the inside r_i of a ring of the blank where that is
larger, to the ring's outside r_o. With z from the middle of the face and ρ the density of the gear,

    m = ρ π ∫ (r_o² − r²) dz,    I_p = ρ π/2 ∫ (r_o⁴ − r⁴) dz,    r = min(max(r_i, r_s), r_o),

and the diametral moment is ``I_p / 2 + ∫ z² dm``, about the centre of mass.
"""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from gearwhine.coupling.gears.geometry.gear import Gear, Inertia

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(3)  # exact for the quartics of a cone


class CoreLength(NamedTuple):
    """A length of shaft under a gear, a cylinder or a cone.

    Attributes
    ----------
    start, end : float
        Places of its ends from the middle of the face [m].
    start_radius, end_radius : float
        Outer radii of the shaft there [m]; 0 where it has no mass.
    """

    start: float
    end: float
    start_radius: float
    end_radius: float


class BlankAroundShaft(NamedTuple):
    """Part of a blank outside its shaft: place of the centre of mass from the middle of the face [m], and inertia."""

    centre: float
    inertia: Inertia


def blank_around(gear: Gear, core: Iterable[CoreLength]) -> BlankAroundShaft:
    """Part of a gear's blank that lies outside its shaft.

    Parameters
    ----------
    gear : Gear
    core : iterable of CoreLength
        Lengths of the shaft that together reach over the face, none over another.
    """
    lengths = tuple(core)
    mass = first = second = polar = 0.0
    for width, outer, inner in gear.blank_rings:
        for start, end, start_radius, end_radius in lengths:
            low, high = max(start, -0.5 * width), min(end, 0.5 * width)
            if low >= high:
                continue
            z = 0.5 * (low + high) + 0.5 * (high - low) * _NODES
            shaft = start_radius + (end_radius - start_radius) * (z - start) / (end - start)
            inside = np.clip(shaft, inner, outer)
            per_area = 0.5 * (high - low) * _WEIGHTS * gear.density * math.pi
            masses = per_area * (outer**2 - inside**2)
            mass += float(masses.sum())
            first += float(masses @ z)
            second += float(masses @ z**2)
            polar += float(0.5 * per_area @ (outer**4 - inside**4))
    centre = first / mass if mass > 0.0 else 0.0
    return BlankAroundShaft(centre, Inertia(mass, polar, 0.5 * polar + second - mass * centre**2))
