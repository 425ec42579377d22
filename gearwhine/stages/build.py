"""The parts of a case as the rooms' own inputs: gears and rotors."""

import coupling.gears as gear_room
import rotors as rotor_room
from gearwhine.case import Case
from gearwhine.case import Gear as GivenGear
from gearwhine.case import Rotor as GivenRotor


def build_gear(case: Case, given: GivenGear) -> gear_room.Gear:
    """A gear of the case as the gear room's.

    A gear known by its base radius alone has the module that gives it, and a nominal width where none is given.
    """
    module = given.module
    if module is None:
        assert given.base_radius is not None
        module = gear_room.module_from_base_radius(given.base_radius, given.teeth, given.pressure_angle)
    steel = {} if (material := _gear_material(case, given)) is None else {
        "youngs_modulus": case.material[material].youngs_modulus,
        "poisson_ratio": case.material[material].poisson_ratio,
        "density": case.material[material].density,
    }  # fmt: skip
    return gear_room.Gear(
        name=given.name,
        teeth=given.teeth,
        module=module,
        pressure_angle=given.pressure_angle,
        face_width=given.face_width if given.face_width is not None else 10.0 * module,
        profile_shift=given.profile_shift,
        root_radius=given.root_radius,
        bore=given.bore,
        tip_relief=gear_room.TipRelief(given.tip_relief.amount, given.tip_relief.start_roll_angle)
        if given.tip_relief
        else None,
        eccentricity=given.errors.eccentricity,
        eccentricity_phase=given.errors.phase,
        pitch_deviations=given.errors.pitch,
        **steel,
    )


def gear_inertia(case: Case, given: GivenGear) -> tuple[float, float, float]:
    """Mass [kg], polar and diametral inertia [kg m²]: as given, or from the geometry."""
    if given.mass is not None and given.polar_inertia is not None and given.diametral_inertia is not None:
        return given.mass, given.polar_inertia, given.diametral_inertia
    gear = build_gear(case, given)
    return gear.mass, gear.polar_inertia, gear.diametral_inertia


def build_rotor(case: Case, given: GivenRotor) -> rotor_room.Rotor:
    """A rotor of the case, its gears on it as discs."""
    discs = [rotor_room.Disc(disc.at, disc.mass, disc.polar_inertia, disc.diametral_inertia) for disc in given.discs]
    for gear in case.gear:
        if gear.rotor == given.name and gear.at is not None:
            mass, polar, diametral = gear_inertia(case, gear)
            if mass or polar or diametral:
                discs.append(rotor_room.Disc(gear.at, mass, polar, diametral))
    segments = []
    for segment in given.segments:
        steel = case.material[segment.material or given.material]
        material = rotor_room.ShaftMaterial(steel.youngs_modulus, steel.shear_modulus, steel.density)
        segments.append(
            rotor_room.Segment(segment.length, segment.diameter, segment.bore, material, given.shear_coefficient)
        )
    return rotor_room.Rotor(given.name, segments, discs, given.mass)


def _gear_material(case: Case, given: GivenGear) -> str | None:
    if given.material is not None:
        return given.material
    return case.rotor_named(given.rotor).material if given.rotor is not None else None
