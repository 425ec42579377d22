"""Rates at which tooth faults of a planetary set strike, at which its planets pass, and at which the same teeth meet.

A tooth meets each mate of its gear once in a turn of the gear relative to the carrier c. With N planets at speeds f,

    tooth of the sun     N |f_s - f_c|         tooth of the ring     N |f_r - f_c|
    flank of a planet    |f_p - f_c|           planets past a point that stands still     N |f_c|

(McFadden, Mech. Syst. Signal Process. 5 (1991) 127; Feng & Zuo, J. Sound Vib. 331 (2012) 4919). One flank of a planet
touches the sun, the other one the ring: a fault of both flanks, as a missing tooth, strikes twice in the turn. Two
teeth in mesh meet again after lcm(z_1, z_2) mesh periods.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from gearwhine.coupling.description.planetary import PlacedSet


@dataclass(frozen=True)
class ToothFaultRate:
    """Rates of a fault on one tooth of a gear [rad/s].

    Attributes
    ----------
    gear, role : str
        Name of the gear; "sun", "planet" or "ring".
    turn : float
        Speed relative to the carrier, without sense: of one mate.
    working, back : tuple of str
        Mates that the flank that works in the gear's first pair touches, and those of the flank behind it.
    """

    gear: str
    role: str
    turn: float
    working: tuple[str, ...]
    back: tuple[str, ...]

    @property
    def working_rate(self) -> float:
        """Strikes of a fault on the flank that works in the first pair."""
        return len(self.working) * self.turn

    @property
    def back_rate(self) -> float:
        """Strikes of a fault on the flank behind."""
        return len(self.back) * self.turn

    @property
    def tooth_rate(self) -> float:
        """Strikes of a fault of both flanks, as of a missing tooth."""
        return self.working_rate + self.back_rate


def tooth_fault_rates(placed: PlacedSet, speeds: Mapping[str, float]) -> tuple[ToothFaultRate, ...]:
    """Rates of faults on a tooth of every gear of a set, in the order sun, planets, ring.

    Parameters
    ----------
    placed : PlacedSet
    speeds : mapping of str to float
        Signed speed of each shaft [rad/s].
    """
    return tuple(_rates(placed, speeds))


def _rates(placed: PlacedSet, speeds: Mapping[str, float]) -> Iterator[ToothFaultRate]:
    roles = {placed.of.sun: "sun", placed.of.ring: "ring"}
    for gear in placed.of.gears:
        mates = [
            (mesh.driven, True) if mesh.driver == gear else (mesh.driver, False)
            for mesh in sorted(placed.meshes, key=lambda mesh: mesh.number)
            if gear in (mesh.driver, mesh.driven)
        ]
        turn = abs(speeds[placed.shafts[gear]] - speeds[placed.of.carrier])
        # A gear drives with the flank ahead and is driven by the one behind.
        working, back = (
            tuple(mate for mate, drives in mates if (drives == mates[0][1]) is same) for same in (True, False)
        )
        yield ToothFaultRate(gear, roles.get(gear, "planet"), turn, working, back)


def planet_pass_rate(placed: PlacedSet, speeds: Mapping[str, float]) -> float:
    """Rate at which the groups of planets pass a point that stands still, as a sensor on the ring [rad/s]."""
    return len(placed.groups) * abs(speeds[placed.of.carrier])


def same_teeth_rates(placed: PlacedSet, speeds: Mapping[str, float]) -> tuple[float, ...]:
    """Rate at which the same two teeth meet again, of each mesh of the set: the hunting-tooth frequency [rad/s]."""
    return tuple(
        abs(speeds[placed.shafts[mesh.driver]] - speeds[placed.of.carrier]) * abs(mesh.teeth[0]) / math.lcm(*mesh.teeth)
        for mesh in placed.meshes
    )
