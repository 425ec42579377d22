"""Deflection of one tooth under a load on its flank, by the energy method on its true outline.

The tooth is a cantilever of varying section standing on the root circle.  A unit load at height ``y_o``,
half thickness ``x_o`` and load angle ``beta`` bends it with the moment
``cos(beta) (y_o - y) - sin(beta) x_o`` at height ``y``, shears it with ``cos(beta)`` and compresses it with
``sin(beta)``.  Twice the strain energy is the compliance (Yang & Lin 1987; with the fillet, Ma et al. 2014):

    bending  int (cos(beta) (y_o - y) - sin(beta) x_o)^2 / (E I) dy,   I = (2 x)^3 b / 12
    shear    int 6/5 cos(beta)^2 / (G A) dy,                           A = 2 x b
    axial    int sin(beta)^2 / (E A) dy

from the root circle over the trochoid and up the involute to the load.  Both curves are analytic in their
parameters, so Gauss-Legendre quadrature gives all digits with a few dozen points.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.gears.errors import GearError
from coupling.gears.foundation import RootSection, foundation_compliance
from coupling.gears.geometry import Gear
from coupling.gears.profile import ProfilePoints, fillet_points, flank_points, load_angle

FloatArray = npt.NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(48)


@dataclass(frozen=True, eq=False)
class ToothCompliance:
    """What a tooth and the body under it yield, per unit load along the line of action [m/N].

    Attributes
    ----------
    bending, shear, axial, foundation : ndarray
        The parts, all of the shape of the radii asked for.
    """

    bending: FloatArray
    shear: FloatArray
    axial: FloatArray
    foundation: FloatArray

    @property
    def total(self) -> FloatArray:
        """All parts together [m/N]."""
        return self.bending + self.shear + self.axial + self.foundation


ToothModel = Callable[[Gear, FloatArray], ToothCompliance]
"""A tooth model: from a gear and radii on its flank [m] to the compliance of a tooth there."""


def potential_energy(gear: Gear, radius: FloatArray, root_section: RootSection = "ma2014") -> ToothCompliance:
    """Tooth compliance by the energy method, and Sainsot's for the body.

    Parameters
    ----------
    gear : Gear
    radius : ndarray
        Radii of the loaded points [m], from the form radius to the tip.
    root_section : {"ma2014", "trochoid"}
        See `coupling.gears.foundation.root_section_angle`.

    Returns
    -------
    ToothCompliance
        Arrays of the shape of `radius`.

    Raises
    ------
    GearError
        For a radius off the involute flank.
    """
    radius = np.asarray(radius, dtype=np.float64)
    _check_on_flank(gear, radius)
    beta = load_angle(gear, radius)[..., None]
    load = flank_points(gear, beta)

    middle, half = _interval(math.pi / 2.0, gear.pressure_angle)
    fillet = fillet_points(gear, middle + half * _NODES)
    # On the flank the interval ends at the load, so the points differ from load to load.
    start = load_angle(gear, np.array(gear.form_radius))
    middle_angle, half_angle = 0.5 * (beta + start), 0.5 * (beta - start)
    flank = flank_points(gear, middle_angle + half_angle * _NODES)

    sine, cosine = np.sin(beta), np.cos(beta)
    modulus, width = gear.youngs_modulus, gear.face_width
    shear_modulus = modulus / (2.0 * (1.0 + gear.poisson_ratio))
    bending, inverse_thickness = np.zeros(radius.shape), np.zeros(radius.shape)
    for points, half_length in ((fillet, half), (flank, half_angle)):
        climb = half_length * _WEIGHTS * points.height_rate
        bending = bending + _bending_integral(points, climb, load, sine, cosine)
        inverse_thickness = inverse_thickness + np.sum(climb / (2.0 * points.half_thickness), axis=-1)
    cosine, sine = cosine[..., 0], sine[..., 0]
    return ToothCompliance(
        bending=bending / (modulus * width),
        shear=1.2 * cosine**2 * inverse_thickness / (shear_modulus * width),
        axial=sine**2 * inverse_thickness / (modulus * width),
        foundation=foundation_compliance(gear, radius, root_section),
    )


def hertz_compliance(driver: Gear, driven: Gear) -> float:
    """Flattening of two flanks pressed together, per unit load [m/N].

    ``2 ((1 - nu_k^2)/E_k + (1 - nu_i^2)/E_i) / (pi b)``, b the narrower face; for equal materials
    ``4 (1 - nu^2) / (pi E b)``, the load-independent form of Yang & Sun (1985).
    """
    yielding = sum((1.0 - gear.poisson_ratio**2) / gear.youngs_modulus for gear in (driver, driven))
    return 2.0 * yielding / (math.pi * min(driver.face_width, driven.face_width))


def _bending_integral(
    points: ProfilePoints, climb: FloatArray, load: ProfilePoints, sine: FloatArray, cosine: FloatArray
) -> FloatArray:
    """Bending compliance times E b: the integral of moment^2 / (2 x^3 / 3) over height."""
    moment = cosine * (load.height - points.height) - sine * load.half_thickness
    return np.asarray(np.sum(climb * moment**2 * 1.5 / points.half_thickness**3, axis=-1), dtype=np.float64)


def _interval(first: float, last: float) -> tuple[float, float]:
    return 0.5 * (first + last), 0.5 * (last - first)


def _check_on_flank(gear: Gear, radius: FloatArray) -> None:
    slack = 1e-9 * gear.module
    low, high = gear.form_radius - slack, gear.tip_radius + slack
    if radius.size and not (np.all(radius >= low) and np.all(radius <= high)):
        raise GearError(
            f"gear {gear.name!r}: loads act on the flank, radii {low * 1e3:.6g} to {high * 1e3:.6g} mm, "
            f"got {float(np.min(radius)) * 1e3:.6g} to {float(np.max(radius)) * 1e3:.6g} mm"
        )
