r"""Normal section of helical teeth: spur gears with the same teeth, and quantities in their normal section.

A helical tooth is treated in its normal section, by the virtual number of teeth: it bends in the plane normal to its
flank. There it is the tooth of a spur gear of the normal module with ``z_n = z / (cos^2 beta_b cos beta)`` teeth (ISO
21771), and the contact is at ``rho_n = rho_t / cos beta_b`` from that gear's base circle, so at the same fraction of
the flank from its foot to its tip. With the load ``F_t / cos beta_b`` on the length ``b / cos beta_b``, and the
deflection seen in the transverse plane as ``delta_n / cos beta_b``, the compliance along the transverse line of action
is

    c_t = c_n / cos beta_b,

c_n that of the virtual spur gears of the same face width: ISO 6336-1's own factor cos beta. Whole numbers of teeth on
both sides of z_n are interpolated, so that a spur gear is the limit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.numerics.arrays import FloatArray

OverRadii = Callable[..., FloatArray]
"""Function of one array of radii for each of some points of the flank; the shapes broadcast."""
Compliance = Callable[..., FloatArray]
"""Function of one array of positions or radii for each load that gives a compliance [m/N]; the shapes broadcast."""


def normal_section_gears(gear: Gear) -> tuple[tuple[Gear, float], ...]:
    """Spur gears with the teeth of a helical gear's normal section, and their weights, which sum to 1."""
    below = math.floor(gear.virtual_teeth)
    above = gear.virtual_teeth - below
    weights = ((below, 1.0 - above), (below + 1, above))
    return tuple((_spur(gear, teeth), weight) for teeth, weight in weights if weight > 0.0)


def transverse_compliance(gear: Gear, solve: Callable[[Gear], Compliance]) -> Compliance:
    """Compliance of teeth along the transverse line of action, from that of the spur gears of their normal section.

    Parameters
    ----------
    gear : Gear
        Spur or helical.
    solve : callable
        Maps a spur gear to its teeth's compliance [m/N] as a function of the radii of the loads [m].

    Returns
    -------
    callable
        Maps transverse radii [m] of the same loads to ``c_n / cos(beta_b)`` [m/N].
    """
    if gear.helix_angle == 0.0:
        return solve(gear)
    normal = in_normal_section(gear, solve)
    return lambda *radii: np.asarray(normal(*radii) / math.cos(gear.base_helix_angle), dtype=np.float64)


def in_normal_section(gear: Gear, solve: Callable[[Gear], OverRadii]) -> OverRadii:
    """Quantity of teeth in their normal section, interpolated between spur gears.

    Parameters
    ----------
    gear : Gear
        Spur or helical.
    solve : callable
        Maps a spur gear to a quantity of its teeth as a function of radii [m].

    Returns
    -------
    callable
        Maps transverse radii [m] of the same points of the flank to that quantity.
    """
    if gear.helix_angle == 0.0:
        return solve(gear)
    sections = [(weight, solve(spur), _spur_radius(gear, spur)) for spur, weight in normal_section_gears(gear)]

    def quantity(*radii: FloatArray) -> FloatArray:
        total: FloatArray = np.zeros(np.broadcast_shapes(*(radius.shape for radius in radii)))
        for weight, of_spur, spur_radius in sections:
            total = total + weight * of_spur(*map(spur_radius, radii))
        return total

    return quantity


def largest_section(gear: Gear) -> tuple[Gear, Callable[[FloatArray], FloatArray]]:
    """Spur gear of the largest weight, and the map of transverse radii to its radii [m]."""
    if gear.helix_angle == 0.0:
        return gear, lambda radius: radius
    spur = max(normal_section_gears(gear), key=lambda section: section[1])[0]
    return spur, _spur_radius(gear, spur)


def _spur_radius(gear: Gear, spur: Gear) -> Callable[[FloatArray], FloatArray]:
    """Map of transverse radii to radii at the same fraction of the spur gear's flank [m]."""
    low, high = _reach(gear, np.array([gear.form_radius, gear.tip_radius]))
    foot, tip = _reach(spur, np.array([spur.form_radius, spur.tip_radius]))

    def spur_radius(radius: FloatArray) -> FloatArray:
        share = (_reach(gear, radius) - low) / (high - low)
        return np.asarray(gear.sign * np.hypot(spur.base_radius, foot + share * (tip - foot)), dtype=np.float64)

    return spur_radius


def _reach(gear: Gear, radius: FloatArray) -> FloatArray:
    """Distance of a flank's point from the base circle along the line of action [m]."""
    return np.asarray(np.sqrt(np.maximum(0.0, radius**2 - gear.base_radius**2)), dtype=np.float64)


def _spur(gear: Gear, teeth: int) -> Gear:
    return replace(
        gear.sound,
        teeth=teeth,
        helix_angle=0.0,
        # The body under the teeth is scaled: bore and rim keep their share of the radius.
        bore=gear.bore * teeth / gear.teeth * math.cos(gear.helix_angle),
        allow_undercut=True,
    )
