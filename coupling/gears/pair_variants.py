"""Pitch deviations and faulty teeth: how the pairs of teeth of the hunting period differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.gears.geometry import Fault, Gear
from coupling.gears.pair_geometry import GearPairGeometry, IntArray
from coupling.gears.pitch_gaps import hunting_numbers

PairFaults = tuple[tuple[Fault, ...], tuple[Fault, ...]]


@dataclass(frozen=True, eq=False)
class PairVariants:
    """Kinds of tooth pairs in a mesh, by the faults of their teeth.

    Attributes
    ----------
    faults : tuple
        Of every kind, the driver's tooth's and the driven's; the first kind is that of sound teeth.
    of_pair, of_back_pair : ndarray of int, shape (h,)
        Kind of the pair that enters at phase n, at n mod h, on the working and on the idle flanks; empty where all
        teeth are alike.
    """

    faults: tuple[PairFaults, ...]
    of_pair: IntArray
    of_back_pair: IntArray


def pair_variants(geometry: GearPairGeometry) -> PairVariants:
    """Faults of every pair of teeth over the hunting period."""
    everywhere: PairFaults = (_faults_of(geometry.driver, None), _faults_of(geometry.driven, None))
    kinds: dict[tuple[int, int], int] = {(-1, -1): 0}
    faults = [everywhere]
    damaged = [{fault.tooth for fault in gear.faults} - {None} for gear in (geometry.driver, geometry.driven)]

    def kinds_of(driver_teeth: IntArray, driven_teeth: IntArray) -> IntArray:
        found = np.zeros(driver_teeth.size, dtype=np.int64)
        for n, teeth in enumerate(zip(driver_teeth.tolist(), driven_teeth.tolist(), strict=True)):
            key = tuple(tooth if tooth in bad else -1 for tooth, bad in zip(teeth, damaged, strict=True))
            pair = (key[0], key[1])
            if pair not in kinds:
                kinds[pair] = len(faults)
                faults.append((_faults_of(geometry.driver, pair[0]), _faults_of(geometry.driven, pair[1])))
            found[n] = kinds[pair]
        return found

    numbers = hunting_numbers(geometry)
    of_pair = kinds_of(*geometry.mating_teeth(numbers))
    of_back_pair = kinds_of(*geometry.mating_back_teeth(numbers))
    return PairVariants(tuple(faults), of_pair, of_back_pair)


def _faults_of(gear: Gear, tooth: int | None) -> tuple[Fault, ...]:
    """Faults of a tooth, with those of all teeth; of a sound one for None or -1."""
    return tuple(fault for fault in gear.faults if fault.tooth is None or fault.tooth == tooth)
