"""Pitch deviations and faulty teeth: differences between the tooth pairs of the hunting period.

The pitch gap of a pair is the gap that the pitch deviations of two mating teeth leave between their flanks.

A tooth that is ahead by ``f`` along the arc of the working pitch circle has rotated by ``f / r_w`` and its flank
has moved by ``rb f / r_w = f cos(w)`` along the line of action, w the working pressure angle.  With the driver's
tooth m and the driven gear's tooth n the pair's gap is

    d(s) + f_pair,    f_pair = -(f_k[m] + f_i[n]) cos(w),

constant while the pair is in contact.  The back flanks of the same teeth are behind where the working ones are
ahead: there the sign is opposite, and other teeth mate (`GearPairGeometry.mating_back_teeth`).

A gear with several mates has its deviations and faults by the numbers and the flanks of its first pair. In a mesh that
works on the other flanks, as that of a planet with the ring, its deviations count with the opposite sign
(`gearwhine.coupling.gears.geometry.pair.ToothNumbering`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.gears.geometry.gear import Fault, Flank, Gear
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry, ToothNumbering
from gearwhine.numerics.arrays import FloatArray, IntArray


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
    differing = [gear.tooth_count for gear in (geometry.driver, geometry.driven) if has_different_teeth(gear)]
    return np.arange(math.lcm(*differing) if differing else 0)


def has_different_teeth(gear: Gear) -> bool:
    """Whether teeth of a gear differ, by pitch deviations or faults of single teeth."""
    return any(gear.pitch_deviations) or any(fault.tooth is not None for fault in gear.faults)


def _lead(geometry: GearPairGeometry, driver_teeth: IntArray, driven_teeth: IntArray) -> FloatArray:
    """Lead of the working flanks of pairs of teeth along the line of action [m]."""
    gears = (geometry.driver, geometry.driven)
    leads = [_deviations(gear, mesh) for gear, mesh in zip(gears, geometry.numbering, strict=True)]
    lead = leads[0][driver_teeth] + leads[1][driven_teeth]
    return np.asarray(lead * math.cos(geometry.working_pressure_angle), dtype=np.float64)


def _deviations(gear: Gear, mesh: ToothNumbering) -> FloatArray:
    """Distance of each tooth of a gear from its place [m], positive where the mesh's working flank stands ahead."""
    ahead = 1.0 if mesh.same_flank else -1.0
    return ahead * np.array(gear.pitch_deviations or (0.0,) * gear.tooth_count, dtype=np.float64)


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
    """Faults of every pair of teeth over the hunting period, of those on the flanks that touch."""
    gears = (geometry.driver, geometry.driven)
    sound: PairFaults = (_faults_of(gears[0], None, None), _faults_of(gears[1], None, None))
    variants: dict[PairFaults, int] = {sound: 0}

    def variants_of(teeth: tuple[IntArray, IntArray], *, back: bool) -> IntArray:
        rows = []
        for gear, mesh, numbers in zip(gears, geometry.numbering, teeth, strict=True):
            flank: Flank = "working" if mesh.same_flank is not back else "back"
            damaged = {fault.tooth: _faults_of(gear, fault.tooth, flank) for fault in gear.faults}
            rows.append([damaged.get(tooth, _faults_of(gear, None, None)) for tooth in numbers.tolist()])
        return np.array([variants.setdefault(pair, len(variants)) for pair in zip(*rows, strict=True)], dtype=np.int64)

    numbers = hunting_numbers(geometry)
    if all(fault.tooth is None for gear in gears for fault in gear.faults):
        of_all = np.zeros(numbers.size, dtype=np.int64)
        return PairVariants((sound,), of_all, of_all)
    of_pair = variants_of(geometry.mating_teeth(numbers), back=False)
    of_back_pair = variants_of(geometry.mating_back_teeth(numbers), back=True)
    return PairVariants(tuple(variants), of_pair, of_back_pair)


def _faults_of(gear: Gear, tooth: int | None, flank: Flank | None) -> tuple[Fault, ...]:
    """Faults on a flank of a tooth, those of all teeth included; None stands for a sound tooth."""
    return tuple(
        fault for fault in gear.faults if fault.tooth is None or (fault.tooth == tooth and fault.flank in (None, flank))
    )
