r"""Hertzian contact compliance of two flanks: Yang & Sun's constant, and Weber's load-dependent law.

Two cylinders loaded against each other by the force F touch on a strip of half width (Hertz)

    a = sqrt(4 F rho eta / (pi b)),   eta = (1 - nu_k^2)/E_k + (1 - nu_i^2)/E_i,   1/rho = 1/rho_k + 1/rho_i

Each surface sinks against a point of its body at the depth t under it (Weber & Banaschek 1953; Johnson, *Contact
Mechanics*, section 5.6) by

    delta = 2 F (1 - nu^2) / (pi E b) * (ln(2 t / a) - nu / (2 (1 - nu)))

In plane problems the approach of far points is unbounded: a depth must be chosen.  It is the tooth's axis on the line
of action, ``t = x / cos(beta)``, in the normal section of helical teeth, because tooth models give the axis' motion; in
a finite-element model the two add up (tests/validation).  With the load the strip widens: the stiffness ``dF/d delta``
grows with the logarithm of F, from nothing at first touch.

The constant of Yang & Sun (1985), ``pi E b / (4 (1 - nu^2))`` for equal materials, has neither load nor depth.  It is
some three times stiffer than Weber's law at common loads.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears.errors import GearError
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.coupling.gears.geometry.profile import flank_points, load_angle
from gearwhine.coupling.gears.stiffness.normal_section import in_normal_section
from gearwhine.numerics.arrays import FloatArray


def hertz_compliance(geometry: GearPairGeometry) -> float:
    """Flattening of two loaded flanks, per unit load [m/N].

    ``2 eta / (pi b)``, b the common face; for equal materials ``4 (1 - nu^2) / (pi E b)``, the load-independent form
    of Yang & Sun (1985).
    """
    yielding = sum((1.0 - gear.poisson_ratio**2) / gear.youngs_modulus for gear in (geometry.driver, geometry.driven))
    return 2.0 * yielding / (math.pi * geometry.face_width)


@dataclass(frozen=True, eq=False)
class LineContact:
    """Contact of two flanks at n positions along their path, by Weber's law.

    Attributes
    ----------
    curvature_radius : ndarray, shape (n,)
        Relative radius of curvature rho [m].
    depths : ndarray, shape (2, n)
        Depths from the surface to the axis of the driver's and the driven gear's tooth, along the line of action [m].
    yielding : ndarray, shape (2,)
        Values ``(1 - nu^2) / E`` of both gears [1/Pa].
    poisson_ratios : ndarray, shape (2,)
    width : float
        Width of the common face [m].
    """

    curvature_radius: FloatArray
    depths: FloatArray
    yielding: FloatArray
    poisson_ratios: FloatArray
    width: float

    def half_width(self, force: npt.ArrayLike) -> FloatArray:
        """Half the width of the strip of contact under `force` [N], in m."""
        line_load = _positive(force) / self.width
        return np.asarray(
            np.sqrt(4.0 * line_load * self.curvature_radius * self.yielding.sum() / math.pi), dtype=np.float64
        )

    def approach(self, force: npt.ArrayLike) -> FloatArray:
        """Approach of the axes of the two teeth by the flattening alone [m], under `force` [N]."""
        return _positive(force) * self.secant_compliance(force)

    def secant_compliance(self, force: npt.ArrayLike) -> FloatArray:
        """Approach over force [m/N]."""
        strip = self.half_width(force)
        if np.any(2.0 * strip > self.depths):
            raise GearError(
                f"contact of flanks: under {float(np.max(force)):.6g} N the strip of contact is "
                f"{2e3 * strip.max():.3g} mm wide, more than the tooth behind it is thick "
                f"({1e3 * self.depths.min():.3g} mm); lower the load"
            )
        nu = self.poisson_ratios[:, None]
        parts = np.log(2.0 * self.depths / strip) - 0.5 * nu / (1.0 - nu)
        return np.asarray(2.0 / (math.pi * self.width) * (self.yielding @ parts), dtype=np.float64)


def line_contact(geometry: GearPairGeometry, position: npt.ArrayLike) -> LineContact:
    """Compute the line contact of a tooth pair at positions along the path of contact.

    Parameters
    ----------
    geometry : GearPairGeometry
    position : array_like, shape (n,)
        Base pitches.

    Returns
    -------
    LineContact
    """
    at = np.atleast_1d(np.asarray(position, dtype=np.float64))
    gears = (geometry.driver, geometry.driven)
    radii = (geometry.driver_radius(at), geometry.driven_radius(at))
    # A flank's radius of curvature is the length of the line of action to its base circle; none at its very start.
    # Those of a concave flank, of an internal gear, are negative.
    curvatures = [
        gear.sign / np.maximum(np.sqrt(np.maximum(radius**2 - gear.base_radius**2, 0.0)), 1e-6 * gear.module)
        for gear, radius in zip(gears, radii, strict=True)
    ]
    depths = [in_normal_section(gear, _depth)(radius) for gear, radius in zip(gears, radii, strict=True)]
    return LineContact(
        # In the normal section of helical teeth the flanks are flatter.
        curvature_radius=1.0 / (curvatures[0] + curvatures[1]) / math.cos(geometry.driver.base_helix_angle),
        depths=np.array(depths),
        yielding=np.array([(1.0 - gear.poisson_ratio**2) / gear.youngs_modulus for gear in gears]),
        poisson_ratios=np.array([gear.poisson_ratio for gear in gears]),
        width=geometry.face_width,
    )


def _depth(gear: Gear) -> Callable[[FloatArray], FloatArray]:
    """Depth of a spur gear's tooth axis under its flank, along the line of action [m], by the radius [m]."""

    def depth(radius: FloatArray) -> FloatArray:
        beta = load_angle(gear, radius)
        return np.asarray(flank_points(gear, beta).half_thickness / np.cos(beta), dtype=np.float64)

    return depth


def _positive(force: npt.ArrayLike) -> FloatArray:
    load = np.asarray(force, dtype=np.float64)
    if not np.all(np.isfinite(load) & (load > 0.0)):
        raise GearError(f"contact of flanks: the force must be above 0 N, got {np.min(load):.6g}")
    return load
