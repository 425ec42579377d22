"""Gear train of a case: pairs of shafts with their tooth numbers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gearwhine.case.gears import Gear, GearPair

if TYPE_CHECKING:
    from coupling.gear_train import GearTrain


def shaft_of(gear: Gear) -> str:
    """Return the name of what a gear turns with: its rotor; the gear itself in a case without rotors."""
    return gear.rotor if gear.rotor is not None else gear.name


def readable_pairs(gears: Iterable[Gear], pairs: Iterable[tuple[int, GearPair]]) -> list[tuple[int, Gear, Gear]]:
    """Return driver and driven gear of each pair with its place in the list.

    Pairs whose gears are missing or on one shaft are passed over.
    """
    by_name = {gear.name: gear for gear in gears}
    return [
        (place, by_name[pair.driver], by_name[pair.driven])
        for place, pair in pairs
        if pair.driver in by_name
        and pair.driven in by_name
        and shaft_of(by_name[pair.driver]) != shaft_of(by_name[pair.driven])
    ]


def train_of_pairs(pairs: Iterable[tuple[int, Gear, Gear]]) -> GearTrain:
    """Return the gear train of pairs, see :func:`readable_pairs`."""
    # The package brings numpy and scipy: only a case with gear pairs waits for them.
    from coupling.gear_train import GearedShafts, gear_train

    return gear_train(
        GearedShafts(shaft_of(driver), shaft_of(driven), (driver.teeth, driven.teeth)) for _, driver, driven in pairs
    )
