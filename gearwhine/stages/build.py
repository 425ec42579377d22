"""The parts of a case as the rooms' own inputs: gears and rotors."""

from dataclasses import replace

import coupling.gears as gear_room
import rotors as rotor_room
from gearwhine.case import Case, CouplingSegment, Disc, Fault, RoundDisc, Segment
from gearwhine.case import Gear as GivenGear
from gearwhine.case import Rotor as GivenRotor


def build_gear(case: Case, given: GivenGear) -> gear_room.Gear:
    """A gear of the case as the gear room's.

    A gear known by its base radius alone has the module that gives it, and a nominal width where none is given.
    """
    module = _module(given)
    gear = gear_room.Gear(
        name=given.name,
        teeth=given.teeth,
        module=module,
        pressure_angle=given.pressure_angle,
        face_width=given.face_width if given.face_width is not None else 10.0 * module,
        profile_shift=given.profile_shift,
        addendum=given.addendum,
        dedendum=given.dedendum,
        root_radius=given.root_radius,
        bore=given.bore,
        tip_relief=_tip_relief(given),
        root_relief=None if given.root_relief is None else gear_room.RootRelief(**given.root_relief.model_dump()),
        eccentricity=given.errors.offset,
        eccentricity_phase=given.errors.phase,
        pitch_deviations=given.errors.cumulative_pitch,
        profile_deviation=_profile_deviation(given),
        helix_deviation=_helix_deviation(given),
        faults=tuple(_fault(fault) for fault in given.fault),
        helix_angle=given.helix_angle,
        rim_thickness=given.rim,
        web_thickness=given.web,
        tooth_thinning=given.tooth_thinning,
        allow_undercut=given.allow_undercut,
    )
    if (name := _gear_material(case, given)) is None:
        return gear
    material = case.material[name]
    return replace(
        gear,
        youngs_modulus=material.youngs_modulus,
        poisson_ratio=material.poisson_ratio,
        density=material.density,
    )


def _tip_relief(given: GivenGear) -> gear_room.TipRelief | None:
    return None if given.tip_relief is None else gear_room.TipRelief(**given.tip_relief.model_dump())


def _profile_deviation(given: GivenGear) -> gear_room.ProfileDeviation | None:
    errors = given.errors.profile
    return None if errors is None else gear_room.ProfileDeviation(**errors.model_dump())


def _helix_deviation(given: GivenGear) -> gear_room.HelixDeviation | None:
    errors = given.errors.helix
    return None if errors is None else gear_room.HelixDeviation(**errors.model_dump())


def _fault(given: Fault) -> gear_room.Fault:
    if given.kind == "wear":
        assert given.depth is not None
        return gear_room.Wear(given.depth, given.tooth, given.shape)
    assert given.tooth is not None
    if given.kind == "missing-tooth":
        return gear_room.MissingTooth(given.tooth)
    assert given.depth is not None
    if given.kind == "crack":
        return gear_room.ToothCrack(given.tooth, given.depth, given.angle)
    assert given.start_roll_angle is not None
    assert given.end_roll_angle is not None
    return gear_room.Spall(given.tooth, given.start_roll_angle, given.end_roll_angle, given.depth, given.width)


def _module(given: GivenGear) -> float:
    """Normal module of a gear [m], however its size is given."""
    if given.module is not None:
        return given.module
    if given.diametral_pitch is not None:
        return gear_room.module_from_diametral_pitch(given.diametral_pitch)
    assert given.base_radius is not None
    return gear_room.module_from_base_radius(given.base_radius, given.teeth, given.pressure_angle, given.helix_angle)


def gear_inertia(case: Case, given: GivenGear) -> tuple[float, float, float]:
    """Mass [kg], polar and diametral inertia [kg m²]: as given, or from the geometry."""
    if given.mass is not None and given.polar_inertia is not None and given.diametral_inertia is not None:
        return given.mass, given.polar_inertia, given.diametral_inertia
    gear = build_gear(case, given)
    return gear.mass, gear.polar_inertia, gear.diametral_inertia


def build_rotor(case: Case, given: GivenRotor) -> rotor_room.Rotor:
    """A rotor of the case, its gears on it as discs."""
    bare = build_shaft(case, given)
    discs = list(bare.discs)
    for gear in case.gear:
        if gear.rotor == given.name and gear.at is not None:
            mass, polar, diametral = gear_inertia(case, gear)
            if mass or polar or diametral:
                discs.append(rotor_room.Disc(gear.at, mass, polar, diametral))
    return rotor_room.Rotor(bare.name, bare.segments, discs, bare.mass_model)


def build_shaft(case: Case, given: GivenRotor) -> rotor_room.Rotor:
    """A rotor of the case without its gears."""
    discs = build_discs(case, given)
    if given.saved is not None:
        of_file = given.saved.rotor
        return rotor_room.Rotor(given.name, of_file.segments, [*of_file.discs, *discs], given.mass)
    segments = [_segment(case, given, segment) for segment in given.segments]
    return rotor_room.Rotor(given.name, segments, discs, given.mass)


def _segment(
    case: Case, rotor: GivenRotor, given: Segment | CouplingSegment
) -> rotor_room.Segment | rotor_room.Coupling:
    if isinstance(given, CouplingSegment):
        return rotor_room.Coupling(given.length, **given.coupling.model_dump())
    steel = case.material[_material(given.material, rotor)]
    return rotor_room.Segment(
        length=given.length,
        outer_diameter=given.diameter,
        inner_diameter=given.bore,
        material=rotor_room.ShaftMaterial(steel.youngs_modulus, steel.shear_modulus, steel.density),
        shear_coefficient=given.shear_coefficient or rotor.shear_coefficient,
        right_outer_diameter=given.right_diameter,
        right_inner_diameter=given.right_bore,
        axial_force=rotor.axial_force if given.axial_force is None else given.axial_force,
    )


def _material(own: str | None, rotor: GivenRotor) -> str:
    """The name of a part's material: its own, or the rotor's."""
    name = own or rotor.material
    assert name is not None
    return name


def build_discs(case: Case, given: GivenRotor) -> list[rotor_room.Disc]:
    """The discs of a rotor without its gears, in the order of the file."""
    return [_disc(case, given, disc) for disc in given.discs]


def _disc(case: Case, rotor: GivenRotor, given: Disc | RoundDisc) -> rotor_room.Disc:
    if isinstance(given, Disc):
        return rotor_room.Disc(given.at, given.mass, given.polar_inertia, given.diametral_inertia)
    density = given.density or case.material[_material(given.material, rotor)].density
    return rotor_room.Disc.from_dimensions(given.at, given.width, given.diameter, given.bore, density)


def _gear_material(case: Case, given: GivenGear) -> str | None:
    if given.material is not None:
        return given.material
    return case.rotor_named(given.rotor).material if given.rotor is not None else None
