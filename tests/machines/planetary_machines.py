"""Machines with a planetary set of real gears: sun, ring, carrier and planets on short shafts."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearwhine.coupling import Machine
from gearwhine.coupling.description.parts import Shaft, ShaftGear, TorqueSupport
from gearwhine.coupling.description.planet_copies import PlanetCopies, planet_copies
from gearwhine.coupling.description.planetary import PlanetarySet
from gearwhine.coupling.gears import ConstantStiffness, Gear
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
MODULE, WIDTH = 2e-3, 20e-3
AXIS = (0.01, -0.02)


def shaft(name: str, start: float = 0.0, length: float = 0.06, bore: float = 0.0, **where: Any) -> Shaft:
    return Shaft(Rotor(name, [Segment(length, bore + 0.02, bore, STEEL)], []), AXIS, start, **where)


def gear(name: str, on: str, teeth: int, **changes: Any) -> ShaftGear:
    addendum = 0.8 if teeth < 0 else 1.0
    made = Gear(name, teeth, MODULE, math.radians(20.0), WIDTH, **{"addendum": addendum, **changes})
    return ShaftGear(made, on, 0.03)


def bearings(on: str) -> list[MountedBearing]:
    return [
        MountedBearing(Bearing(f"{on} {at}", at, np.diag([1e8, 1e8]), np.zeros((2, 2))), on, None)
        for at in (0.01, 0.05)
    ]


def spring(driver: str, driven: str) -> GearPair:
    return GearPair(driver, driven, stiffness=ConstantStiffness(4e8))


def planets(teeth: int, distance: float, carrier: Shaft, path: Sequence[tuple[str, str]], **how: Any) -> PlanetCopies:
    pairs = [spring(*ends) for ends in path]
    return planet_copies(
        shaft("p"), [gear("p", "p", teeth)], bearings("p"), carrier=carrier, gear_pairs=pairs, distance=distance, **how
    )


def set_parts(sun: int = 24, planet: int = 30, ring: int | None = None, held: str = "r", **how: Any) -> dict[str, Any]:
    """Parts of a machine with one set; sun, ring and carrier are shafts and gears "s", "r" and "c"."""
    teeth = {"s": sun, "r": -(sun + 2 * planet) if ring is None else ring}
    path = how.pop("path", [("s", "p"), ("p", "r")])
    # The ring is in a drum, the carrier beside the gears.
    drum = math.ceil(MODULE * (abs(teeth["r"]) + 12) * 1e3) * 1e-3
    members = [shaft("s"), shaft("r", bore=drum), shaft("c", start=0.1)]
    made = planets(planet, how.pop("distance", 0.5 * MODULE * (sun + planet)), members[2], path, **how)
    return {
        "shafts": [*members, *made.shafts],
        "gears": [gear("s", "s", teeth["s"]), gear("r", "r", teeth["r"]), *made.gears],
        "bearings": [*(one for name in "src" for one in bearings(name)), *made.bearings],
        "gear_pairs": list(made.gear_pairs),
        "planetary_sets": [PlanetarySet("stage", made.gear_names, "c", sun="s", ring="r")],
        "torque_supports": [TorqueSupport(held)],
        "speed": 100.0,
        "torque": 50.0,
    }


def machine(**how: Any) -> Machine:
    return Machine(**set_parts(**how))


def changed(parts: dict[str, Any], kind: str, name: str, **changes: Any) -> dict[str, Any]:
    """Parts of which one, by its kind and name, is changed."""
    return {**parts, kind: [replace(one, **changes) if one.name == name else one for one in parts[kind]]}
