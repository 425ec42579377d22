"""Pitch deviations and faulty teeth: differences between the tooth pairs of the hunting period.

The pitch gap of a pair is the gap that the pitch deviations of two mating teeth leave between their flanks.

A tooth that is ahead by ``f`` along the arc of the working pitch circle has rotated by ``f / r_w`` and its flank
has moved by ``rb f / r_w = f cos(w)`` along the line of action, w the working pressure angle.  With the driver's
tooth m and the driven gear's tooth n the pair's gap is

    d(s) + f_pair,    f_pair = -(f_k[m] + f_i[n]) cos(w),

constant while the pair is in contact.  The back flanks of the same teeth are behind where the working ones are
ahead: there the sign is opposite, and other teeth mate (`GearPairGeometry.mating_back_teeth`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears.geometry.gear import Fault, Gear
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry, IntArray

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
        Gap f_pair of the pair that enters at phase n, at n mod h [m].  h is the least common multiple of the numbers
        of teeth; of one gear's alone where the other's teeth are all alike; 0 where the teeth of both are alike.
    """
    return -_lead(geometry, *geometry.mating_teeth(hunting_numbers(geometry)))


def back_flank_pitch_gaps(geometry: GearPairGeometry) -> FloatArray:
    """Return the gap of each pair of back flanks [m], by the pair's phase of entering, ``back_flank_offset - p``."""
    return _lead(geometry, *geometry.mating_back_teeth(hunting_numbers(geometry)))


def hunting_numbers(geometry: GearPairGeometry) -> IntArray:
    """Numbers 0, 1, ... of the pairs over the hunting period, after which the same teeth meet again.

    Only gears whose teeth differ count; empty where the teeth of both are alike.
    """
    differing = [
        gear.tooth_count
        for gear in (geometry.driver, geometry.driven)
        if any(gear.pitch_deviations) or any(fault.tooth is not None for fault in gear.faults)
    ]
    return np.arange(math.lcm(*differing) if differing else 0)


def _lead(geometry: GearPairGeometry, driver_teeth: IntArray, driven_teeth: IntArray) -> FloatArray:
    """Lead of the working flanks of pairs of teeth along the line of action [m]."""
    lead = _deviations(geometry.driver)[driver_teeth] + _deviations(geometry.driven)[driven_teeth]
    return np.asarray(lead * math.cos(geometry.working_pressure_angle), dtype=np.float64)


def _deviations(gear: Gear) -> FloatArray:
    return np.array(gear.pitch_deviations or (0.0,) * gear.tooth_count, dtype=np.float64)


PairFaults = tuple[tuple[Fault, ...], tuple[Fault, ...]]


@dataclass(frozen=True, eq=False)
class PairVariants:
    """Variants of tooth pair in a mesh, by the faults of their teeth.

    Attributes
    ----------
    faults : tuple
        Faults of the driver's and of the driven tooth, for every variant; the first variant has sound teeth.
    of_pair, of_back_pair : ndarray of int, shape (h,)
        Variant of the pair that enters at phase n, at n mod h, on the working and on the back flanks; empty where all
        teeth are alike.
    """

    faults: tuple[PairFaults, ...]
    of_pair: IntArray
    of_back_pair: IntArray


def pair_variants(geometry: GearPairGeometry) -> PairVariants:
    """Faults of every pair of teeth over the hunting period."""
    everywhere: PairFaults = (_faults_of(geometry.driver, None), _faults_of(geometry.driven, None))
    variants: dict[tuple[int, int], int] = {(-1, -1): 0}
    faults = [everywhere]
    damaged = [{fault.tooth for fault in gear.faults} - {None} for gear in (geometry.driver, geometry.driven)]

    def kinds_of(driver_teeth: IntArray, driven_teeth: IntArray) -> IntArray:
        variant_of_pair = np.zeros(driver_teeth.size, dtype=np.int64)
        for n, teeth in enumerate(zip(driver_teeth.tolist(), driven_teeth.tolist(), strict=True)):
            key = tuple(tooth if tooth in bad else -1 for tooth, bad in zip(teeth, damaged, strict=True))
            pair = (key[0], key[1])
            if pair not in variants:
                variants[pair] = len(faults)
                faults.append((_faults_of(geometry.driver, pair[0]), _faults_of(geometry.driven, pair[1])))
            variant_of_pair[n] = variants[pair]
        return variant_of_pair

    numbers = hunting_numbers(geometry)
    of_pair = kinds_of(*geometry.mating_teeth(numbers))
    of_back_pair = kinds_of(*geometry.mating_back_teeth(numbers))
    return PairVariants(tuple(faults), of_pair, of_back_pair)


def _faults_of(gear: Gear, tooth: int | None) -> tuple[Fault, ...]:
    """Faults of a tooth, including those of all teeth; None or -1 stands for a sound tooth."""
    return tuple(fault for fault in gear.faults if fault.tooth is None or fault.tooth == tooth)
