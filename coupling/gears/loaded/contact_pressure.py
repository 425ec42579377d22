r"""Hertzian contact pressure of two flanks: line contact at every position of the path of contact.

In the normal section the flanks are cylinders for the narrow strip in which they touch. With ``xi_k, xi_i`` the
distances of the contact from the two tangent points of the line of action, in the transverse plane, and beta_b the
base helix angle, their radii of curvature are ``xi / cos(beta_b)``, and those of the contact

    1/rho = cos(beta_b) (1/xi_k + 1/xi_i),        1/E* = (1 - nu_k^2)/E_k + (1 - nu_i^2)/E_i.

Under a load q per length of the contact line the largest pressure, in the middle of the strip, is (H. Hertz, J. reine
angew. Math. 92, 1881; K. L. Johnson, Contact Mechanics, 1985, section 4.2)

    p = sqrt(q E* / (pi rho)).

The normal load of a helical tooth is its transverse one over ``cos(beta_b)``, and its contact line is the face over
the same: q is the transverse load per face width. At the pitch point this is ISO 6336-2's nominal pressure,
``Z_H Z_E sqrt(F_t (u + 1) / (d_1 b u))``.

Beyond the path of contact a corner touches, and within a strip's width of its ends an edge does. An edge has no radius
of its own: the formula would give the pressure of the flanks, not of the edge, which depends on its rounding and soon
falls by wear. So pressure is given on the path alone; a load beyond it has the pressure NaN.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears.contact.contact_law import ToothContact
from gearwhine.coupling.gears.errors import GearError
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.coupling.gears.loaded.transmission_error import LoadedMesh
from gearwhine.numerics.arrays import FloatArray

_PATH_END_ROUNDING = 1e-12
"""Distance beyond the ends within which a position counts as on the path [base pitches]."""


def contact_modulus(pair: GearPairGeometry) -> float:
    """Modulus E* of the contact of two flanks [Pa]."""
    return 1.0 / sum((1.0 - gear.poisson_ratio**2) / gear.youngs_modulus for gear in (pair.driver, pair.driven))


def contact_curvature_radius(pair: GearPairGeometry, position: npt.ArrayLike) -> FloatArray:
    """Relative radius of curvature rho of the flanks in the normal section [m], at `position` in base pitches.

    0 where contact reaches a base circle, on which an involute begins with no radius; NaN off the path of contact.
    """
    at = np.asarray(position, dtype=np.float64)
    on_path = (at >= -_PATH_END_ROUNDING) & (at <= pair.contact_ratio + _PATH_END_ROUNDING)
    driver = pair.driver.base_radius * pair.driver_roll_angle(at)
    driven = pair.driven.base_radius * pair.driven_roll_angle(at)
    # The two distances add up to that of the tangent points; of an internal pair one is negative, and their sum.
    sum_of_both = pair.tangent_distance
    lengths = np.maximum(math.copysign(1.0, sum_of_both) * driver * driven, 0.0)
    radius = lengths / (abs(sum_of_both) * math.cos(pair.driver.base_helix_angle))
    return np.where(on_path, radius, np.nan)


def contact_pressure(pair: GearPairGeometry, position: npt.ArrayLike, line_load: npt.ArrayLike) -> FloatArray:
    """Largest Hertzian pressure across a contact line [Pa].

    Parameters
    ----------
    pair : GearPairGeometry
    position : array_like
        Positions along the path of contact [base pitches].
    line_load : array_like
        Transverse load per face width there [N/m], at least 0; broadcast with `position`.

    Returns
    -------
    ndarray
        0 without load, infinite under load on a base circle, NaN under load off the path of contact.

    Raises
    ------
    GearError
        For a negative or non-finite load.
    """
    load = np.asarray(line_load, dtype=np.float64)
    if not np.all(np.isfinite(load) & (load >= 0.0)):
        worst = load[~(np.isfinite(load) & (load >= 0.0))].flat[0]
        raise GearError(f"{pair.label}: contact pressure needs loads per width of at least 0 N/m, got {float(worst)!r}")
    radius = contact_curvature_radius(pair, position)
    with np.errstate(divide="ignore", invalid="ignore"):
        pressure = np.sqrt(load * contact_modulus(pair) / (np.pi * radius))
    return np.where(load > 0.0, pressure, 0.0)


def mesh_pressure(pair: GearPairGeometry, contact: ToothContact, mesh: LoadedMesh) -> FloatArray:
    """Largest pressure across the contact line of every pair of a loaded mesh [Pa].

    Parameters
    ----------
    pair : GearPairGeometry
        Gear pair with the face widths over which the load spreads.
    contact : ToothContact
        Contact law with the face slices of the line loads.
    mesh : LoadedMesh

    Returns
    -------
    ndarray, shape (n, m) or (n, m, s)
        Pressure of each pair at each phase; for an uneven load, of every slice of its face.
    """
    if contact.faces is None or mesh.line_loads is None:
        return contact_pressure(pair, mesh.positions, mesh.pair_forces / pair.face_width)
    # Rounding of the equilibrium may leave a tiny negative load on a slice that just touches.
    loads = np.maximum(mesh.line_loads, 0.0)
    return contact_pressure(pair, mesh.positions[..., None] + contact.faces.shift, loads)
