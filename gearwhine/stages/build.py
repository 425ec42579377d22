"""The parts of a case as the rooms' own inputs: gears, rotors, bearings."""

import numpy as np
import numpy.typing as npt

import coupling.gears as gear_room
import rotors as rotor_room
from gearwhine.case import (
    Case,
    CaseError,
    CouplingSegment,
    Disc,
    Pedestal,
    Problem,
    RadialDamping,
    RadialStiffness,
    RollingStiffness,
    RoundDisc,
    Segment,
)
from gearwhine.case import Gear as GivenGear
from gearwhine.case import Rotor as GivenRotor
from gearwhine.case.shafts import PedestalDamping, PedestalStiffness

FloatArray = npt.NDArray[np.float64]


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
    discs = build_discs(case, given)
    for gear in case.gear:
        if gear.rotor == given.name and gear.at is not None:
            mass, polar, diametral = gear_inertia(case, gear)
            if mass or polar or diametral:
                discs.append(rotor_room.Disc(gear.at, mass, polar, diametral))
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


def build_bearings(case: Case, rotor: str) -> tuple[rotor_room.Bearing, ...]:
    """The bearings of one rotor, in the order of the file; first those of the rotor's own file.

    A bearing of the case takes the place of one of the same name in the rotor's file.

    Raises
    ------
    CaseError
        For stiffness given in a form that comes in a later version.
    """
    saved = case.rotor_named(rotor).saved
    replaced = {given.name for given in case.bearing if given.rotor == rotor}
    bearings = [bearing for bearing in (saved.bearings if saved else ()) if bearing.name not in replaced]
    for index, given in enumerate(case.bearing):
        if given.rotor != rotor:
            continue
        stiffness, damping = given.stiffness, given.damping
        if not isinstance(stiffness, RadialStiffness) or not isinstance(damping, RadialDamping):
            form = "rolling" if isinstance(stiffness, RollingStiffness) else "matrix"
            expected = "{ xx, yy, xy, yx }: bearings by 5x5 matrix or rolling geometry come in a later version"
            raise CaseError([Problem(f"bearing[{index}].stiffness", form, expected, label=f'bearing "{given.name}"')])
        bearings.append(
            rotor_room.Bearing(
                given.name,
                given.at,
                _radial(stiffness),
                _radial(damping),
                None if given.speeds is None else np.array(given.speeds),
                None if given.pedestal is None else _pedestal(given.pedestal),
            )
        )
    return tuple(bearings)


def _radial(given: RadialStiffness | RadialDamping | PedestalStiffness | PedestalDamping) -> FloatArray:
    """The matrix over x, y, (2, 2), or with lists in it one for each speed, (s, 2, 2)."""
    entries = np.broadcast_arrays(given.xx, given.xy, given.yx, given.yy)
    return np.stack(entries, axis=-1).reshape(*entries[0].shape, 2, 2)


def _pedestal(given: Pedestal) -> rotor_room.Pedestal:
    return rotor_room.Pedestal(_radial(given.stiffness), _radial(given.damping), given.mass)


def _gear_material(case: Case, given: GivenGear) -> str | None:
    if given.material is not None:
        return given.material
    return case.rotor_named(given.rotor).material if given.rotor is not None else None
