"""Tooth compliance as a beam of varying section: bending, shear and axial compression under a load on the flank.

A unit load at height ``y_o``, half thickness ``x_o`` and load angle ``beta`` bends the tooth with the moment
``cos(beta) (y_o - y) - sin(beta) x_o`` at height ``y``, shears it with ``cos(beta)`` and compresses it with
``sin(beta)``.  Twice the strain energy is the compliance (Yang & Lin 1987; with the fillet, Ma et al. 2014):

    bending  int (cos(beta) (y_o - y) - sin(beta) x_o)^2 / (E' I) dy,   I = (2 x)^3 b / 12
    shear    int 6/5 cos(beta)^2 / (G A) dy,                            A = 2 x b
    axial    int sin(beta)^2 / (E' A) dy

from a foot section in the fillet up its trochoid and the involute to the load.  Both curves are analytic in their
parameters, so Gauss-Legendre quadrature gives all digits with a few dozen points.

A narrow tooth is free to widen where it is compressed: plane stress, ``E' = E``.  In the middle of a wide one the
neighbouring slices forbid it: plane strain, ``E' = E / (1 - nu^2)``.  Shear is the same in both.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Literal, NamedTuple

import numpy as np
from scipy.optimize import brentq

from gearwhine.coupling.gears.errors import GearError
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.pair import ALLOWED_REACH
from gearwhine.coupling.gears.geometry.profile import ProfilePoints, fillet_points, flank_points, load_angle
from gearwhine.numerics.arrays import FloatArray

PlaneState = Literal["plane-stress", "plane-strain"]

ROOT_CIRCLE = math.pi / 2.0
"""Parameter of `fillet_points` of a foot where the trochoid meets the root circle [rad]."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(48)


class BeamCompliance(NamedTuple):
    """Parts of a beam's compliance [m/N], in the shape of the loads' radii."""

    bending: FloatArray
    shear: FloatArray
    axial: FloatArray


def beam_compliance(
    gear: Gear, radius: FloatArray, foot: float = ROOT_CIRCLE, state: PlaneState = "plane-stress"
) -> BeamCompliance:
    """Compliance of a tooth above its foot, along the line of action.

    Parameters
    ----------
    gear : Gear
        A spur gear; pair models of helical gears take their normal section
        (:mod:`gearwhine.coupling.gears.stiffness.compliant_teeth`).
    radius : ndarray
        Radii of the loaded points [m], from the form radius to the tip.
    foot : float
        Parameter of `gearwhine.coupling.gears.geometry.profile.fillet_points` at which the beam is clamped [rad].
    state : {"plane-stress", "plane-strain"}

    Returns
    -------
    BeamCompliance

    Raises
    ------
    GearError
        For a radius off the involute flank, or an unknown state.
    """
    radius = np.asarray(radius, dtype=np.float64)
    _check_on_flank(gear, radius)
    beta = load_angle(gear, radius)[..., None]
    load = flank_points(gear, beta)
    sine, cosine = np.sin(beta), np.cos(beta)
    bending, inverse_thickness = np.zeros(radius.shape), np.zeros(radius.shape)
    for points, climb in tooth_sections(gear, beta, foot, 0.5 + 0.5 * _NODES, 0.5 * _WEIGHTS):
        moment = cosine * (load.height - points.height) - sine * load.half_thickness
        bending = bending + np.sum(climb * moment**2 * 1.5 / points.half_thickness**3, axis=-1)
        inverse_thickness = inverse_thickness + np.sum(climb / (2.0 * points.half_thickness), axis=-1)
    cosine, sine = cosine[..., 0], sine[..., 0]
    modulus, width = plane_modulus(gear, state), gear.face_width
    return BeamCompliance(
        bending=bending / (modulus * width),
        shear=1.2 * cosine**2 * inverse_thickness / (shear_modulus(gear) * width),
        axial=sine**2 * inverse_thickness / (modulus * width),
    )


def tooth_sections(
    gear: Gear, beta: FloatArray, foot: float, nodes: FloatArray, weights: FloatArray
) -> Iterator[tuple[ProfilePoints, FloatArray]]:
    """Sections of the tooth from its foot to the load, for integrals over its height.

    Parameters
    ----------
    gear : Gear
    beta : ndarray, shape (..., 1)
        Load angles [rad].
    foot : float
        Parameter of the fillet at which the beam is clamped [rad].
    nodes, weights : ndarray, shape (n,)
        Quadrature on 0 ... 1, used on the fillet and on the flank.

    Yields
    ------
    points : ProfilePoints
        Sections of the fillet, then of the flank.
    climb : ndarray
        Weights of the sections in an integral over the height [m].
    """
    # On the flank the interval ends at the load, so the points differ from load to load.
    start = load_angle(gear, np.array(gear.form_radius))
    length = np.asarray(gear.fillet_end - foot)
    for points, span in (
        (fillet_points(gear, foot + nodes * length), length),
        (flank_points(gear, start + nodes * (beta - start)), beta - start),
    ):
        yield points, span * weights * points.height_rate


def plane_modulus(gear: Gear, state: PlaneState) -> float:
    """Modulus of a slice stretched in its plane [Pa]: ``E``, or ``E / (1 - nu^2)`` in plane strain."""
    if state not in ("plane-stress", "plane-strain"):
        raise GearError(f"gear {gear.name!r}: state must be 'plane-stress' or 'plane-strain', got {state!r}")
    return gear.youngs_modulus / (1.0 if state == "plane-stress" else 1.0 - gear.poisson_ratio**2)


def shear_modulus(gear: Gear) -> float:
    """``E / (2 (1 + nu))`` [Pa]."""
    return gear.youngs_modulus / (2.0 * (1.0 + gear.poisson_ratio))


def axis_crossing(gear: Gear, radius: FloatArray) -> FloatArray:
    """Height at which the line of action of a load at `radius` crosses the tooth's axis [m]: ``rb / cos(beta)``."""
    return np.asarray(gear.base_radius / np.cos(load_angle(gear, radius)), dtype=np.float64)


def foot_at_height(gear: Gear, height: float) -> float:
    """Fillet parameter [rad] of the section at `height` [m], or the nearer end of the fillet."""

    def above(gamma: float) -> float:
        return float(fillet_points(gear, np.array(gamma)).height) - height

    return _on_fillet(gear, above)


def foot_at_slope(gear: Gear, slope: float) -> float:
    """Fillet parameter [rad] where the fillet leans by `slope` [rad] from the tooth's axis, or the nearer end.

    The tangent there is ``dx/dy = -tan(slope)``; at the foot of the fillet it leans by a right angle less half the
    tooth's angle on the root circle.
    """
    step = 1e-6

    def above(gamma: float) -> float:
        # From the deep end of the fillet upward (gamma falling) the tangent turns toward the axis.
        points = fillet_points(gear, np.array([gamma + step, gamma - step]))
        inward = float(points.half_thickness[0] - points.half_thickness[1])
        return slope - math.atan2(inward, float(points.height[1] - points.height[0]))

    return _on_fillet(gear, above)


def _on_fillet(gear: Gear, above: Callable[[float], float]) -> float:
    """Find the fillet parameter [rad] where `above`, rising from foot to flank, is zero, or the end nearest to it."""
    deep, shallow = ROOT_CIRCLE, gear.fillet_end
    if above(deep) >= 0.0:
        return deep
    if above(shallow) <= 0.0:
        return shallow
    return float(brentq(above, shallow, deep, xtol=1e-13))


def _check_on_flank(gear: Gear, radius: FloatArray) -> None:
    # A mating tip may reach a little below the form circle, where the fillet is as good as the involute.
    low, high = gear.form_radius - ALLOWED_REACH * gear.module, gear.tip_radius + 1e-9 * gear.module
    if radius.size and not (np.all(radius >= low) and np.all(radius <= high)):
        raise GearError(
            f"gear {gear.name!r}: loads act on the flank, radii {low * 1e3:.6g} to {high * 1e3:.6g} mm, "
            f"got {float(np.min(radius)) * 1e3:.6g} to {float(np.max(radius)) * 1e3:.6g} mm"
        )
