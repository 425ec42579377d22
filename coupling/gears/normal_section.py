r"""The teeth of a helical gear in their normal section: spur gears of virtual teeth.

A helical tooth bends in the plane normal to its flank. There it is the tooth of a spur gear of the normal module with
``z_n = z / (cos^2 beta_b cos beta)`` teeth (ISO 21771), and the contact is at ``rho_n = rho_t / cos beta_b`` from that
gear's base circle, so at the same part of the flank from its foot to its tip. With the load ``F_t / cos beta_b`` on
the length ``b / cos beta_b``, and the deflection seen in the transverse plane as ``delta_n / cos beta_b``, the
compliance along the transverse line of action is

    c_t = c_n / cos beta_b,

c_n that of the virtual spur gears of the same face width: ISO 6336-1's own factor cos beta. Whole numbers of teeth on
both sides of z_n are interpolated, so that a spur gear is the limit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from coupling.gears.geometry import Gear
from coupling.gears.rim import CrossCompliance

FloatArray = npt.NDArray[np.float64]
Compliance = Callable[[FloatArray], FloatArray]


def normal_section_gears(gear: Gear) -> tuple[tuple[Gear, float], ...]:
    """Spur gears with the teeth of a helical gear's normal section, and their weights, which sum to 1."""
    below = math.floor(gear.virtual_teeth)
    above = gear.virtual_teeth - below
    weights = ((below, 1.0 - above), (below + 1, above))
    return tuple((_spur(gear, teeth), weight) for teeth, weight in weights if weight > 0.0)


def by_normal_section(gear: Gear, solve: Callable[[Gear], Compliance]) -> Compliance:
    """Compliance c_n of one helical tooth [m/N] by transverse radii [m], where `solve` gives that of a spur gear's."""
    sections = [(weight, solve(spur), _mapped(gear, spur)) for spur, weight in normal_section_gears(gear)]

    def compliance(radius: FloatArray) -> FloatArray:
        total = np.zeros_like(radius)
        for weight, tooth, mapped in sections:
            total = total + weight * tooth(mapped(radius))
        return np.asarray(total, dtype=np.float64)

    return compliance


def cross_by_normal_section(gear: Gear, solve: Callable[[Gear], CrossCompliance]) -> CrossCompliance:
    """The same of two neighbouring teeth: what a load on one moves the other [m/N], by the radii of both loads [m]."""
    sections = [(weight, solve(spur), _mapped(gear, spur)) for spur, weight in normal_section_gears(gear)]

    def compliance(behind: FloatArray, ahead: FloatArray) -> FloatArray:
        total = np.zeros(np.broadcast_shapes(behind.shape, ahead.shape))
        for weight, teeth, mapped in sections:
            total = total + weight * teeth(mapped(behind), mapped(ahead))
        return np.asarray(total, dtype=np.float64)

    return compliance


def _mapped(gear: Gear, spur: Gear) -> Compliance:
    """From transverse radii to those at the same part of the spur gear's flank [m]."""
    low, high = _reach(gear, np.array([gear.form_radius, gear.tip_radius]))
    foot, tip = _reach(spur, np.array([spur.form_radius, spur.tip_radius]))

    def mapped(radius: FloatArray) -> FloatArray:
        share = (_reach(gear, radius) - low) / (high - low)
        return np.asarray(np.hypot(spur.base_radius, foot + share * (tip - foot)), dtype=np.float64)

    return mapped


def _reach(gear: Gear, radius: FloatArray) -> FloatArray:
    """Distance of a flank's point from the base circle along the line of action [m]."""
    return np.asarray(np.sqrt(np.maximum(0.0, radius**2 - gear.base_radius**2)), dtype=np.float64)


def _spur(gear: Gear, teeth: int) -> Gear:
    return replace(
        gear,
        teeth=teeth,
        helix_angle=0.0,
        # The same body under the teeth: bore and rim keep their share of the radius.
        bore=gear.bore * teeth / gear.teeth * math.cos(gear.helix_angle),
        pitch_deviations=(),
        faults=(),
        tip_relief=None,
        root_relief=None,
        profile_deviation=None,
        helix_deviation=None,
        allow_undercut=True,
    )
