"""Pitch gap: gap that the pitch deviations of two mating teeth leave between their flanks.

A tooth that is ahead by ``f`` along the arc of the working pitch circle has rotated by ``f / r_w`` and its flank
has moved by ``rb f / r_w = f cos(w)`` along the line of action, w the working pressure angle.  With the driver's
tooth m and the driven gear's tooth n the pair's gap is

    d(s) + f_pair,    f_pair = -(f_k[m] + f_i[n]) cos(w),

constant while the pair is in contact.  The idle flanks of the same teeth are behind where the working ones are
ahead: there the sign is opposite, and other teeth mate (`GearPairGeometry.mating_back_teeth`).
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from coupling.gears.geometry import Gear
from coupling.gears.pair_geometry import GearPairGeometry, IntArray

FloatArray = npt.NDArray[np.float64]


def pitch_gaps(geometry: GearPairGeometry) -> FloatArray:
    """Gap of each pair of working flanks over the hunting period.

    Parameters
    ----------
    geometry : GearPairGeometry
        The `pitch_deviations` of its gears are used.

    Returns
    -------
    ndarray, shape (h,)
        f_pair of the pair that enters at phase n, at n mod h [m].  h is the least common multiple of the numbers
        of teeth; of one gear's alone where the other's teeth are all alike; 0 where the teeth of both are alike.
    """
    return -_lead(geometry, *geometry.mating_teeth(hunting_numbers(geometry)))


def back_flank_pitch_gaps(geometry: GearPairGeometry) -> FloatArray:
    """Return the gap of each pair of idle flanks [m], by its phase of entering, ``back_flank_offset - p``."""
    return _lead(geometry, *geometry.mating_back_teeth(hunting_numbers(geometry)))


def hunting_numbers(geometry: GearPairGeometry) -> IntArray:
    """Numbers 0, 1, ... of the pairs over the hunting period, after which the same teeth meet again.

    Only gears whose teeth differ count; empty where those of neither do.
    """
    differing = [
        gear.teeth
        for gear in (geometry.driver, geometry.driven)
        if any(gear.pitch_deviations) or any(fault.tooth is not None for fault in gear.faults)
    ]
    return np.arange(math.lcm(*differing) if differing else 0)


def _lead(geometry: GearPairGeometry, driver_teeth: IntArray, driven_teeth: IntArray) -> FloatArray:
    """Lead of the working flanks of pairs of teeth along the line of action [m]."""
    lead = _deviations(geometry.driver)[driver_teeth] + _deviations(geometry.driven)[driven_teeth]
    return np.asarray(lead * math.cos(geometry.working_pressure_angle), dtype=np.float64)


def _deviations(gear: Gear) -> FloatArray:
    return np.array(gear.pitch_deviations or (0.0,) * gear.teeth, dtype=np.float64)
