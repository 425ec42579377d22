"""Rotors and gears of a case as library objects, with the materials that their entries name."""

import coupling.gears
import rotors
from gearwhine.case import Case
from gearwhine.case import Gear as GivenGear
from gearwhine.case import Rotor as GivenRotor


def build_gear(case: Case, given: GivenGear) -> coupling.gears.Gear:
    """A gear of the case; see :meth:`gearwhine.case.Gear.build`."""
    return given.build(case.material_of_gear(given))


def gear_inertia(case: Case, given: GivenGear) -> tuple[float, float, float]:
    """Mass [kg], polar and diametral inertia [kg m²] of a gear of the case: as given, or from the geometry."""
    return given.inertia(case.material_of_gear(given))


def build_rotor(case: Case, given: GivenRotor) -> rotors.Rotor:
    """A rotor of the case, its gears on it as discs."""
    bare = given.build(case.material)
    discs = list(bare.discs)
    for gear in case.gear:
        if gear.rotor == given.name and gear.at is not None:
            inertia = gear_inertia(case, gear)
            if any(inertia):
                discs.append(rotors.Disc(gear.at, *inertia))
    return rotors.Rotor(bare.name, bare.segments, discs, bare.mass_model)
