"""Mesh damping: damping coefficient of a gear mesh from a damping ratio."""

from __future__ import annotations

import math

from coupling.gears.errors import GearError


def equivalent_mass(
    driver_inertia: float, driven_inertia: float, driver_base_radius: float, driven_base_radius: float
) -> float:
    """Equivalent mass of the two gears rotating against each other, along the line of action [kg].

    ``J_k J_i / (J_k R_i^2 + J_i R_k^2)``, inertias [kg m^2], base radii [m].

    Raises
    ------
    GearError
        Unless all four are positive.
    """
    given = (driver_inertia, driven_inertia, driver_base_radius, driven_base_radius)
    if not all(math.isfinite(value) and value > 0.0 for value in given):
        raise GearError(f"equivalent mass: inertias and base radii must be above 0, got {given}")
    return (
        driver_inertia
        * driven_inertia
        / (driver_inertia * driven_base_radius**2 + driven_inertia * driver_base_radius**2)
    )


def mesh_damping(ratio: float, mean_mesh_stiffness: float, equivalent_mass: float) -> float:
    """Damping coefficient of the mesh, ``2 ratio sqrt(k m)`` [N s/m].

    Parameters
    ----------
    ratio : float
        Fraction of critical damping of the two gears rotating against each other.
    mean_mesh_stiffness : float
        Mean mesh stiffness [N/m].
    equivalent_mass : float
        See `equivalent_mass` [kg].
    """
    if not (ratio >= 0.0 and mean_mesh_stiffness > 0.0 and equivalent_mass > 0.0):
        raise GearError(
            "mesh damping: ratio must be at least 0, stiffness and mass above 0, "
            f"got {ratio!r}, {mean_mesh_stiffness!r}, {equivalent_mass!r}"
        )
    return 2.0 * ratio * math.sqrt(mean_mesh_stiffness * equivalent_mass)
