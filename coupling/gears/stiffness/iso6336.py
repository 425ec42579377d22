"""Tooth stiffness by ISO 6336-1 (2006), clause 9, method B, for spur and helical gears.

The theoretical single stiffness c'_th is one over (Eq. 81, constants of Table 9)

    q' = C1 + C2/z_n1 + C3/z_n2 + C4 x_1 + C5 x_1/z_n1 + C6 x_2 + C7 x_2/z_n2 + C8 x_1^2 + C9 x_2^2

in mm um/N, gear 1 the smaller, ``z_n`` the teeth of the equivalent spur gear; an internal gear 2 has ``1/z_n2 = 0``,
and C_R = 1.  The maximum of a pair is ``c' = c'_th C_M C_R C_B cos(beta)`` with

    C_M = 0.8                                                            from theory to measurement
    C_R = 1 + ln(b_s/b) / (5 exp(s_R / (5 m_n)))                         blank of a web b_s and a rim s_R
    C_B = (1 + 0.5 (1.2 - h_fP/m_n)) (1 - 0.02 (20 - alpha_Pn))          basic rack, alpha_Pn in degrees

where ``b_s/b`` is held within 0.2 ... 1.2 and ``s_R/m_n`` at 1 or more, and C_R is 1 for a disc; of two different
blanks or racks the mean is taken.  Other materials scale by their mean modulus over 206 GPa, specific loads below
100 N/mm by their fourth root.  The mean over the mesh is ``c_gamma = c' (0.75 eps_alpha + 0.25)``, meant for
``eps_alpha`` of 1.2 and more, and helix angles to 30 degrees.

C_R was written from the norm's formula as it is commonly quoted, without its graph; KISSsoft has the same value.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.errors import StiffnessModelError
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.coupling.gears.piecewise_cubic import PiecewiseCubic

_PER_MM_AND_UM = 1e9
"""Factor from N/(mm um) to N/m per metre of face width."""
_STEEL = 206e9
_LIGHT_LOAD = 100e3
"""100 N/mm: below this specific load the stiffness falls with its fourth root [N/m]."""


@dataclass(frozen=True)
class Iso6336Values:
    """Stiffnesses per face width along the line of action [N/m per m].

    Attributes
    ----------
    theoretical : float
        Single stiffness c'_th of the basic tooth shape.
    single_pair : float
        Largest stiffness c' of one pair.
    mesh_mean : float
        Mean stiffness c_gamma_alpha over the mesh.
    """

    theoretical: float
    single_pair: float
    mesh_mean: float


def iso6336_stiffness(geometry: GearPairGeometry, specific_load: float | None = None) -> Iso6336Values:
    """Single and mean mesh stiffness by ISO 6336-1, method B.

    Parameters
    ----------
    geometry : GearPairGeometry
    specific_load : float or None
        F_t K_A / b [N/m]; None for 100 N/mm or more.

    Raises
    ------
    StiffnessModelError
        Outside the norm's range (profile shifts, load not positive).
    """
    pinion, wheel = sorted((geometry.driver, geometry.driven), key=lambda gear: (gear.is_internal, gear.teeth))
    x1, x2 = pinion.profile_shift, wheel.profile_shift
    if not -0.5 <= x1 + x2 <= 2.0:
        raise StiffnessModelError(
            f"{geometry.label}: ISO 6336-1 covers sums of profile shifts from -0.5 to 2, got {x1 + x2:g}"
        )
    z1, z2 = pinion.virtual_teeth, math.inf if wheel.is_internal else wheel.virtual_teeth
    flexibility = (
        0.04723
        + 0.15551 / z1
        + 0.25791 / z2
        - 0.00635 * x1
        - 0.11654 * x1 / z1
        - 0.00193 * x2
        - 0.24188 * x2 / z2
        + 0.00529 * x1**2
        + 0.00182 * x2**2
    )
    theoretical = _PER_MM_AND_UM / flexibility
    dedendum = 0.5 * (pinion.dedendum + wheel.dedendum)
    rack = (1.0 + 0.5 * (1.2 - dedendum)) * (1.0 - 0.02 * (20.0 - math.degrees(pinion.pressure_angle)))
    modulus = 2.0 / (1.0 / pinion.youngs_modulus + 1.0 / wheel.youngs_modulus)
    blank = 0.5 * (blank_factor(pinion) + blank_factor(wheel))
    single = 0.8 * blank * theoretical * rack * math.cos(pinion.helix_angle) * modulus / _STEEL
    if specific_load is not None:
        if not (math.isfinite(specific_load) and specific_load > 0.0):
            raise StiffnessModelError(f"{geometry.label}: specific_load must be above 0, got {specific_load!r} N/m")
        single *= min(1.0, specific_load / _LIGHT_LOAD) ** 0.25
    return Iso6336Values(theoretical, single, single * (0.75 * geometry.contact_ratio + 0.25))


def blank_factor(gear: Gear) -> float:
    """Gear blank factor C_R, 1 for a disc and for a rim alone (which the norm does not cover)."""
    if gear.is_internal or gear.rim_thickness is None or gear.web_thickness is None:
        return 1.0
    web = min(max(gear.web_thickness / gear.face_width, 0.2), 1.2)
    rim = max(gear.rim_thickness / gear.module, 1.0)
    return 1.0 + math.log(web) / (5.0 * math.exp(rim / 5.0))


@dataclass(frozen=True)
class Iso6336Stiffness:
    """ISO 6336-1 method B as a curve: a parabola with the norm's maximum and the norm's mean.

    The norm gives two numbers, c' at the middle of the path and the mean of the mesh
    ``c_gamma = c' (0.75 eps + 0.25)``.  The parabola ``c' (1 - kappa (2 s/eps - 1)^2)`` has both exactly
    with ``kappa = 0.75 (1 - 1/eps)``.

    Parameters
    ----------
    specific_load : float or None
        Tangential load per face width, F_t K_A / b [N/m]; below 100 N/mm the norm lowers the stiffness.
    """

    name: ClassVar[str] = "iso6336"
    specific_load: float | None = None

    def pair_stiffness(self, geometry: GearPairGeometry) -> PiecewiseCubic:
        """Stiffness [N/m] by position."""
        norm = iso6336_stiffness(geometry, specific_load=self.specific_load)
        largest = norm.single_pair * geometry.face_width
        ends = largest * (0.25 + 0.75 / geometry.contact_ratio)
        return piecewise.quadratic(ends, largest, ends, geometry.contact_ratio)
