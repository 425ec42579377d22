"""Bolted joint: stiffness of a preloaded bolt and of the parts that it clamps, as springs between two patches.

While the preload holds, bolt and clamped parts deflect together: their stiffnesses add. Sources: Budynas and Nisbett,
"Shigley's Mechanical Engineering Design", 9th ed., sections 8-4 and 8-5 (bolt, Eq. 8-17; cone of pressure of half
angle 30° after Rötscher, Eq. 8-20); ISO 261 and ISO 898-1 (coarse threads and their stress area). Across the axis no
formula is as settled. The cone is replaced by the hollow cylinder of the same length and axial stiffness (the
"substitute cylinder" of VDI 2230), whose shear, bending and twist are elementary; friction is taken to hold without
slip.
"""

import math
from dataclasses import dataclass

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.material import Material
from gearwhine.housing.model.bushings import Axial

_TAN = math.tan(math.radians(30.0))
_HEAD = 1.5  # diameter of the head's bearing face over that of the bolt

# ISO 261, coarse series: nominal diameter and pitch [mm].
_COARSE_DIAMETERS = (3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 30, 36, 42, 48, 56, 64)
_COARSE_PITCHES = (0.5, 0.7, 0.8, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0)


@dataclass(frozen=True)
class BoltedJoint:
    """Stiffnesses of a bolt and of the parts that it clamps.

    Attributes
    ----------
    bolt, clamped : float
        Axial stiffness of each [N/m].
    stiffness : Axial
        Stiffness of both together, in all directions.
    """

    bolt: float
    clamped: float
    stiffness: Axial


def stress_area(diameter: float) -> float:
    """Stress area of a metric coarse thread [m²]: π/4 (d - 0.9382 p)² (ISO 898-1), pitches in between interpolated."""
    pitch = 1e-3 * float(np.interp(1e3 * diameter, _COARSE_DIAMETERS, _COARSE_PITCHES))
    return math.pi / 4 * (diameter - 0.9382 * pitch) ** 2


def bolt_stiffness(
    diameter: float, grip: float, youngs_modulus: float, *, shank: float = 0.0, thread_area: float | None = None
) -> float:
    """Axial stiffness of a bolt [N/m]: E A_d A_t / (A_d l_t + A_t l_d) (Shigley Eq. 8-17).

    Parameters
    ----------
    diameter : float
        Nominal, d [m].
    grip : float
        Length that stretches, l_d + l_t [m].
    youngs_modulus : float
        Young's modulus [Pa].
    shank : float
        Unthreaded part of the grip, l_d [m].
    thread_area : float, optional
        Stress area of the thread, A_t [m²]; by default that of a metric coarse one.
    """
    threaded = grip - shank
    flexibility = shank / (math.pi / 4 * diameter**2) + threaded / (thread_area or stress_area(diameter))
    return youngs_modulus / flexibility


def frustum_stiffness(
    thickness: float, small_diameter: float, hole: float, youngs_modulus: float, *, outer: float = math.inf
) -> float:
    """Axial stiffness of a cone of pressure [N/m] (Shigley Eq. 8-19), cut off where the part ends.

    k = π E d tan α / ln[(2 t tan α + D - d)(D + d) / ((2 t tan α + D + d)(D - d))], α = 30°

    Parameters
    ----------
    thickness : float
        Height of the cone, t [m].
    small_diameter, hole : float
        D at its top, and d of the hole along its axis [m].
    youngs_modulus : float
        Young's modulus [Pa].
    outer : float
        Largest diameter within the part [m]; from there on it is a cylinder.
    """
    cone = min(thickness, max(outer - small_diameter, 0.0) / (2 * _TAN))
    wide = small_diameter + 2 * cone * _TAN
    ratio = (wide - hole) * (small_diameter + hole) / ((wide + hole) * (small_diameter - hole))
    flexibility = math.log(ratio) / (math.pi * hole * _TAN)
    flexibility += (thickness - cone) / (math.pi / 4 * (wide**2 - hole**2))
    return youngs_modulus / flexibility


def _cone_flexibility(
    diameter: float, height: float, layers: tuple[tuple[float, Material], ...], outer: float
) -> float:
    """Axial flexibility of a cone of pressure through layers, from under the head on [m/N]: pieces in series."""
    flexibility, depth = 0.0, 0.0
    for length, material in layers:
        piece = min(length, height - depth)
        if piece > 0.0:
            wide = min(_HEAD * diameter + 2 * depth * _TAN, max(outer, _HEAD * diameter))
            flexibility += 1.0 / frustum_stiffness(piece, wide, diameter, material.youngs_modulus, outer=outer)
            depth += piece
    return flexibility


def bolted_joint(
    diameter: float,
    grip: float,
    parts: Material,
    bolt: Material | None = None,
    *,
    cover: tuple[Material, float] | None = None,
    outer: float = math.inf,
) -> BoltedJoint:
    """Compute the stiffness of a bolt through two parts, a cone of pressure from each end to the middle of the grip.

    Parameters
    ----------
    diameter : float
        Nominal diameter [m].
    grip : float
        Length of bolt between head and nut or thread [m]; for a screw in a tapped hole the cover and half of the
        engaged depth (Shigley, Table 8-7).
    parts, bolt : Material
        Materials; the bolt's is that of the parts where not given.
    cover : tuple of Material and float, optional
        Material of the part at one end and its length in the grip [m], where it is another one: the cones are cut where
        the materials meet, and their pieces are springs in series (Shigley, Example 8-2).
    outer : float
        Diameter around the bolt that the parts fill [m]; at least the head's, 1.5 of the bolt's.

    Raises
    ------
    HousingError
        Where a length is not positive, the cover is as long as the grip, or the parts are narrower than the head.
    """
    if not (diameter > 0.0 and grip > 0.0):
        raise HousingError(f"a bolt of {diameter} m diameter and {grip} m grip: both must be positive")
    if outer < _HEAD * diameter * (1.0 - 1e-9):
        raise HousingError(
            f"a bolt of {1e3 * diameter:g} mm on parts {1e3 * outer:g} mm wide: its head needs {_HEAD:g} times its "
            "diameter"
        )
    steel = parts if bolt is None else bolt
    first, length = (parts, grip / 2) if cover is None else cover
    if not 0.0 < length < grip:
        raise HousingError(f"a cover of {length} m in a grip of {grip} m: expected a part of it")
    layers = ((length, first), (grip - length, parts))
    # One layer after the other: moduli of one part that deflects as much.
    modulus = grip / sum(part / material.youngs_modulus for part, material in layers)
    shear = grip / sum(part / material.shear_modulus for part, material in layers)
    bolt_only = bolt_stiffness(diameter, grip, steel.youngs_modulus)
    clamped = 1.0 / (
        _cone_flexibility(diameter, grip / 2, layers, outer)
        + _cone_flexibility(diameter, grip / 2, layers[::-1], outer)
    )
    area = clamped * grip / modulus
    width = math.sqrt(4 * area / math.pi + diameter**2)
    bending, bolt_bending = math.pi / 64 * (width**4 - diameter**4), math.pi / 64 * diameter**4
    return BoltedJoint(
        bolt=bolt_only,
        clamped=clamped,
        stiffness=Axial(
            axial=bolt_only + clamped,
            # The bolt itself is clamped at both ends, and adds little.
            shear=shear * area / grip + 12 * steel.youngs_modulus * bolt_bending / grip**3,
            tilting=(modulus * bending + steel.youngs_modulus * bolt_bending) / grip,
            torsional=2 * (shear * bending + steel.shear_modulus * bolt_bending) / grip,
        ),
    )
