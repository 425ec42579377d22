"""Gear body (fillet foundation) compliance under a tooth after Sainsot, Velex & Duverger (2004).

The body is an elastic ring.  With load angle ``beta``, load height ``u`` above the root circle and root
thickness ``S`` along the root circle, the deflection along the load is

    q_f = F cos(beta)^2 / (E b) * (L (u/S)^2 + M (u/S) + P (1 + Q tan(beta)^2))

(J. Mech. Des. 126(4), Eq. 11), with L, M, P, Q polynomials of ``h = r_root / r_bore`` and of the tooth's
half angle ``theta`` on the root circle (their Eq. 12 and Table 1):

    X(h, theta) = A/theta^2 + B h^2 + C h/theta + D/theta + E h + F

Beyond the fitted range, at a small bore in a large wheel (h > 7), the dent is that at h = 7 and the ring's twist
grows as its closed form does.

The ring is held at its bore, so the formula holds two things: the dent around the tooth, and the twist of
the whole ring between bore and root circle, ``rb^2 (1/r_bore^2 - 1/r_root^2) / (4 pi G b)`` along the line
of action, which grows as h^2 and is the reason why P does.  A gear in one piece with its shaft
(``bore = 0``) is not held there, and its twist is that of the shaft: what is left is the dent,
the formula less that twist in closed form.  The dent hardly depends on the bore (within 10 % over the whole
range for 28 teeth and more); it is taken at h = 3, in the middle of the range, where the twist is small.

The formula takes the deflection at the middle of the root arc, and published cases take u to the loaded point of the
flank.  Both make the body too soft: see :mod:`gearwhine.coupling.gears.stiffness.tooth_compliance` for the same ring
without either.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from gearwhine.coupling.gears.errors import StiffnessModelError
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.profile import flank_points, load_angle, root_half_angle
from gearwhine.numerics.arrays import FloatArray

RootSection = Literal["ma2014", "trochoid"]

# Rows L, M, P, Q; columns A ... F.
_COEFFICIENTS = np.array(
    [
        [-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045],
        [60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086],
        [-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236],
        [-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904],
    ]
)

THICKNESS_RANGE = (1.4, 7.0)
"""Range of h that the polynomials were fitted over."""
ANGLE_RANGE = (0.01, 0.12)
"""Range of theta [rad] that the polynomials were fitted over."""
_SOLID_THICKNESS = 3.0
"""The h at which the polynomials are evaluated for a gear without a bore, less the twist."""


def held_radius(gear: Gear) -> float | None:
    """Radius at which the body is held [m]: the bore or the inside of a rim without web; None for neither.

    An internal gear is held at its outside; the radius is negative as its others.
    """
    if gear.is_internal:
        return gear.rim_outer_radius
    if gear.rim_inner_radius is not None and gear.web_thickness is None:
        return gear.rim_inner_radius
    return 0.5 * gear.bore if gear.bore > 0.0 else None


def root_section_angle(gear: Gear, root_section: RootSection) -> float:
    """Half angle of the tooth on the root circle [rad], by the chosen definition.

    Parameters
    ----------
    gear : Gear
    root_section : {"ma2014", "trochoid"}
        "trochoid": where the fillet meets the root circle, exactly.  "ma2014": the formula printed by
        Ma et al. (2014), ``(pi/2 + 2 tan(alpha) (h_a - rho) + 2 rho / cos(alpha)) / z`` with rho in
        modules, evaluated with the *gear's* addendum as published results do.  It leaves out the
        clearance, so its root is 6 % narrower for 62 teeth and its body 3 % softer.

    Raises
    ------
    StiffnessModelError
        For an unknown definition.
    """
    if root_section == "trochoid":
        return root_half_angle(gear)
    if root_section != "ma2014":
        raise StiffnessModelError(f"root_section must be 'ma2014' or 'trochoid', got {root_section!r}")
    corner = gear.rack_tip_radius / gear.module
    alpha = gear.pressure_angle
    spread = 2.0 * math.tan(alpha) * (gear.addendum - corner) + 2.0 * corner / math.cos(alpha)
    return (math.pi / 2.0 + spread) / gear.teeth


def within_fitted_range(gear: Gear, root_section: RootSection) -> bool:
    """Whether Sainsot's polynomials are used inside the range they were fitted over.

    Fewer than about 25 teeth fall outside (theta too large); there the polynomials run on smoothly, since
    all terms in 1/theta fade.
    """
    angle = root_section_angle(gear, root_section)
    ring = THICKNESS_RANGE[0] <= _thickness(gear) <= THICKNESS_RANGE[1]
    return ring and ANGLE_RANGE[0] <= angle <= ANGLE_RANGE[1]


def foundation_compliance(gear: Gear, radius: FloatArray, root_section: RootSection = "ma2014") -> FloatArray:
    """Deflection of the body per unit load along the line of action.

    Parameters
    ----------
    gear : Gear
    radius : ndarray
        Radii of the loaded points [m].
    root_section : {"ma2014", "trochoid"}
        Definition of the tooth's width on the root circle, see `root_section_angle`.

    Returns
    -------
    ndarray
        Compliance [m/N], same shape as `radius`.

    Raises
    ------
    StiffnessModelError
        For a thin ring, see `require_thick_ring`.
    """
    require_thick_ring(gear)
    ring = _thickness(gear)
    thickness = min(ring, THICKNESS_RANGE[1])
    theta = root_section_angle(gear, root_section)
    terms = np.array([theta**-2, thickness**2, thickness / theta, 1.0 / theta, thickness, 1.0])
    quadratic, linear, constant, radial = _COEFFICIENTS @ terms
    beta = load_angle(gear, radius)
    root = gear.root_circle_radius
    relative_height = (flank_points(gear, beta).height - root) / (2.0 * root * theta)
    shape = quadratic * relative_height**2 + linear * relative_height + constant * (1.0 + radial * np.tan(beta) ** 2)
    flexibility = np.cos(beta) ** 2 * shape / (gear.youngs_modulus * gear.face_width)
    if held_radius(gear) is None:
        flexibility = flexibility - _ring_twist(gear, thickness)
    elif ring > thickness:
        flexibility = flexibility + _ring_twist(gear, ring) - _ring_twist(gear, thickness)
    return np.asarray(flexibility, dtype=np.float64)


def require_thick_ring(gear: Gear) -> None:
    """Refuse a ring so thin, root radius over bore radius h below 1.4, that it bends as a rim does.

    Raises
    ------
    StiffnessModelError
        With what to change.
    """
    thickness = _thickness(gear)
    if thickness < THICKNESS_RANGE[0]:
        raise StiffnessModelError(
            f"gear {gear.name!r}: root radius over bore (or rim) radius is {thickness:.3g}; Sainsot's body compliance "
            f"is of rings of at least {THICKNESS_RANGE[0]:g}. Change the bore (0 for a gear in one "
            "piece with its shaft), give a rim its web, or choose a model that takes any ring, as 'elastic-ring'"
        )


def _ring_twist(gear: Gear, thickness: float) -> float:
    """Twist of a ring held at its bore under the torque of a unit load, along the line of action [m/N]."""
    shear_modulus = gear.youngs_modulus / (2.0 * (1.0 + gear.poisson_ratio))
    relative_base = gear.base_radius / gear.root_circle_radius
    return relative_base**2 * (thickness**2 - 1.0) / (4.0 * math.pi * shear_modulus * gear.face_width)


def _thickness(gear: Gear) -> float:
    """Root radius over the radius of the held circle, h; the middle of the fitted range for a gear in one piece."""
    inner_radius = held_radius(gear)
    if inner_radius is None:
        return _SOLID_THICKNESS
    thickness = gear.root_circle_radius / inner_radius
    nearest = min(max(thickness, THICKNESS_RANGE[0]), THICKNESS_RANGE[1])
    # Rounding may put an h of exactly 1.4 or 7 beyond the range.
    return nearest if math.isclose(thickness, nearest, rel_tol=1e-9) else thickness
