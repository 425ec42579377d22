"""The gear train: which shaft turns how fast against the first driver's, and which way."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from gearwhine.case.gears import Gear, GearPair


def shaft_of(gear: Gear) -> str:
    """Return the name of what a gear turns with: its rotor; the gear itself in a case without rotors."""
    return gear.rotor if gear.rotor is not None else gear.name


@dataclass(frozen=True)
class Clash:
    """A gear pair that closes a loop and contradicts it.

    Attributes
    ----------
    pair
        Place in the list of pairs.
    driven
        The shaft that would have to turn at two speeds.
    ratio, other
        Its speed over the first driver's by the other pairs, and by this one.
    """

    pair: int
    driven: str
    ratio: Fraction
    other: Fraction


@dataclass(frozen=True)
class Train:
    """Speed ratios of a gear train.

    Attributes
    ----------
    ratios
        From each shaft that the first driver turns to its speed over that of the first driver, signed.
    clashes
        Pairs that contradict the others.
    drivers
        Shafts that drive in some pair.
    """

    ratios: Mapping[str, Fraction]
    clashes: tuple[Clash, ...]
    drivers: frozenset[str]

    @property
    def last(self) -> tuple[str, ...]:
        """The turned shafts that drive no other, where the power leaves by default."""
        return tuple(shaft for shaft in self.ratios if shaft not in self.drivers)


def gear_train(gears: Iterable[Gear], pairs: Iterable[tuple[int, GearPair]]) -> Train:
    """Follow tooth ratios from the first pair's driver through all pairs.

    External gears: the driven shaft turns at -z_driver / z_driven times the driver's speed.

    Parameters
    ----------
    gears
        All gears.
    pairs
        Pairs with their place in the list; those whose gears are missing or on one shaft are passed over.
    """
    by_name = {gear.name: gear for gear in gears}
    known = [
        (place, by_name[pair.driver], by_name[pair.driven])
        for place, pair in pairs
        if pair.driver in by_name
        and pair.driven in by_name
        and shaft_of(by_name[pair.driver]) != shaft_of(by_name[pair.driven])
    ]
    if not known:
        return Train({}, (), frozenset())
    ratios = {shaft_of(known[0][1]): Fraction(1)}
    clashes: dict[int, Clash] = {}
    waiting = known
    while waiting:
        left = []
        for place, driver, driven in waiting:
            gearing = Fraction(-driver.teeth, driven.teeth)
            first, second = shaft_of(driver), shaft_of(driven)
            if first in ratios and second in ratios:
                if ratios[second] != ratios[first] * gearing:
                    clashes[place] = Clash(place, second, ratios[second], ratios[first] * gearing)
            elif first in ratios:
                ratios[second] = ratios[first] * gearing
            elif second in ratios:
                ratios[first] = ratios[second] / gearing
            else:
                left.append((place, driver, driven))
        if len(left) == len(waiting):
            break
        waiting = left
    drivers = frozenset(shaft_of(driver) for _, driver, _ in known)
    return Train(ratios, tuple(clashes[place] for place in sorted(clashes)), drivers)
