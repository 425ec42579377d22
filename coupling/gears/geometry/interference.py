"""Interference of an internal gear with its pinion off the path of contact: fouling of the tips, radial mounting.

**Fouling** (trochoidal interference, overlap of the tip edges). Beyond the end of contact the pinion's tooth leaves the
space of the ring sideways. Where the two tip circles cross, its tip must not have caught up with the tip of the tooth
that it has driven. With the lengths of radii and centre distance a, the crossing is at the angles

    cos(theta_1) = (r_a2^2 - r_a1^2 - a^2) / (2 a r_a1),      cos(theta_2) = (r_a2^2 + a^2 - r_a1^2) / (2 a r_a2)

from the line of centres about the pinion's and the ring's centre. When the pinion's tip corner, which in contact at the
pitch point is ``inv(alpha_a1) - inv(w)`` behind it, is there, the ring's has an arc

    r_a2 ((theta_1 + inv(alpha_a1) - inv(w)) z_1 / z_2 + inv(w) - inv(alpha_a2) - theta_2)

of clearance (J. R. Colbourne, The Geometry of Involute Gears, 1987, ch. 12; DIN 3993). Contact on the other side of the
teeth is its mirror image, with the backlash besides.

**Radial mounting.** A pinion that is pushed into its ring along the line of centres must pass with all its teeth
between the tips of the ring's: at no height may its flank be further from that line than the ring's tip corner over
which it goes (Colbourne, the same chapter; a shaper cutter is fed so too). It may enter with a tooth or a space on the
line. A pair without this clearance is mounted along its axes.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.involute import involute

_FLANK_POINTS = 41


def fouling_clearance(pinion: Gear, ring: Gear, distance: float, tip_radius: float | None = None) -> float:
    """Clearance of the tip corners of a pinion and its ring where their tip circles cross, along the ring's [m].

    Parameters
    ----------
    pinion, ring : Gear
    distance : float
        Working centre distance, of either sign [m].
    tip_radius : float, optional
        Tip radius of the ring as a length, in place of its own [m].

    Returns
    -------
    float
        Negative where they foul; infinite where the tip circles do not cross.
    """
    a, outer = abs(distance), pinion.tip_radius
    inner = -ring.tip_radius if tip_radius is None else tip_radius
    base = -ring.base_radius
    working = involute(math.acos((base - pinion.base_radius) / a))
    cosines = (inner**2 - outer**2 - a**2) / (2.0 * a * outer), (inner**2 + a**2 - outer**2) / (2.0 * a * inner)
    if max(map(abs, cosines)) >= 1.0:
        return math.inf
    at_pinion, at_ring = map(math.acos, cosines)
    turned = at_pinion + involute(math.acos(pinion.base_radius / outer)) - working
    ahead = turned * pinion.teeth / ring.tooth_count + working - involute(math.acos(base / inner))
    return inner * (ahead - at_ring)


def addendum_without_fouling(pinion: Gear, ring: Gear, distance: float) -> float | None:
    """Largest addendum of a ring, in modules, with which its teeth do not foul those of a pinion; None for none.

    Parameters
    ----------
    pinion, ring : Gear
    distance : float
        Working centre distance, of either sign [m].
    """
    least, most = -ring.tip_radius, abs(distance) + pinion.tip_radius

    def clearance(tip: float) -> float:
        return fouling_clearance(pinion, ring, distance, tip)

    heights = np.linspace(least, most, 65)[:-1]
    clear = [clearance(tip) >= 0.0 for tip in heights]
    if not any(clear[1:]) or clear[0]:
        return None
    first = clear.index(True)
    tip = float(brentq(clearance, heights[first - 1], heights[first], xtol=1e-12))
    return (-ring.pitch_radius - tip) / ring.module - ring.profile_shift


def radial_clearance(pinion: Gear, ring: Gear, distance: float) -> float:
    """Clearance of a pinion from the tips of its ring's teeth while it is pushed into mesh radially [m].

    Parameters
    ----------
    pinion, ring : Gear
    distance : float
        Working centre distance, of either sign [m].

    Returns
    -------
    float
        Of the better way to enter, with a tooth or with a space on the line of centres; negative where neither passes.
    """
    radius = np.linspace(pinion.form_radius, pinion.tip_radius, _FLANK_POINTS)
    pressure_angle = np.arccos(pinion.base_radius / radius)
    half = pinion.base_half_angle - (np.tan(pressure_angle) - pressure_angle)
    beside = math.pi / ring.tooth_count - abs(ring.tip_half_angle)
    clearances = []
    for first in (0.0, 0.5):  # a tooth on the line, or a space
        tooth = first + np.arange(pinion.teeth // 4 + 1)[:, None]
        pinion_angle = 2.0 * math.pi * tooth / pinion.teeth + half
        ring_angle = 2.0 * math.pi * tooth / ring.tooth_count + beside
        across, height = radius * np.sin(pinion_angle), abs(distance) + radius * np.cos(pinion_angle)
        passed = (height > -ring.tip_radius * np.cos(ring_angle)) & (pinion_angle < 0.5 * math.pi)
        space = -ring.tip_radius * np.sin(ring_angle) - across
        clearances.append(float(np.min(space, initial=math.inf, where=passed)))
    return max(clearances)
