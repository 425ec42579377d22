r"""Shear coupling of neighbouring slices of a tooth across its face.

A tooth whose deflection varies across the face, ``W(z) phi(y)``, is a plate of thickness t(y) held at its foot. phi is
the deflection of a slice as a beam under a load at the middle of the path of contact, with its bending and its shear,
psi the rotation of its sections; both are 1 in the measure of the loaded point's deflection. Where W has a slope, the
plate's normals rotate across the face by ``chi(y) W'`` with the least energy (Mindlin's plate):

    T = min over chi of  int 5/6 G t (phi - chi)^2 + G t^3/12 (psi + chi')^2 dy,        chi = 0 at the foot,

the first part shear across the face, the second twist. T is then the shear force that the face passes on for each unit
of W'. The stiffness of the plate against curvature across the face, of higher order, is left out, and so is the body.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.linalg import solveh_banded

from coupling.gears.beam_compliance import shear_modulus
from coupling.gears.geometry import Gear
from coupling.gears.profile import tooth_side

FloatArray = npt.NDArray[np.float64]

_OUTLINE = 200
_LAYERS = 300


def tooth_coupling(gear: Gear, radius: float) -> float:
    """Shear coupling T of one tooth across its face [N], with the load at `radius` [m]."""
    across, along = tooth_side(gear, _OUTLINE)
    height = along - along[0]
    load = float(np.interp(radius, np.hypot(across, along), height))
    edges = np.linspace(0.0, height[-1], _LAYERS + 1)
    step = edges[1]
    y = 0.5 * (edges[1:] + edges[:-1])
    thickness = 2.0 * np.interp(y, height, across)
    shear = shear_modulus(gear)
    # The slice as a beam: section rotation psi, deflection phi, of a unit load.
    below = y < load
    rotation = _summed(np.where(below, (load - y) * 12.0 / (gear.youngs_modulus * thickness**3), 0.0) * step)
    psi = 0.5 * (rotation[1:] + rotation[:-1])
    deflection = _summed((psi + np.where(below, 1.2 / (shear * thickness), 0.0)) * step)
    unit = float(np.interp(load, edges, deflection))
    phi, psi = 0.5 * (deflection[1:] + deflection[:-1]) / unit, psi / unit
    # Least energy by linear elements for chi, from the foot up: a tridiagonal system.
    across_shear, twist = 5.0 / 6.0 * shear * thickness * step, shear * thickness**3 / 12.0 * step
    diagonal, beside = 0.25 * across_shear + twist / step**2, 0.25 * across_shear - twist / step**2
    right, up = 0.5 * across_shear * phi, twist * psi / step
    bands = np.zeros((2, _LAYERS))
    bands[1] = diagonal + np.append(diagonal[1:], 0.0)
    bands[0, 1:] = beside[1:]
    side = right - up + np.append(right[1:] + up[1:], 0.0)
    chi = solveh_banded(bands, side)
    return float(np.sum(across_shear * phi**2 + twist * psi**2) - side @ chi)


def _summed(values: FloatArray) -> FloatArray:
    """Running sum from zero, (n + 1,)."""
    return np.concatenate([[0.0], np.cumsum(values)])
