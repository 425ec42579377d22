"""Gears of unequal width, or beside each other along z: the common face carries, at its own place on either gear."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solveh_banded

from gearwhine.coupling import Machine, MountedBearing, Shaft, ShaftGear, static_equilibrium
from gearwhine.coupling.gears import (
    Gear,
    GearPair,
    GearPairGeometry,
    HelixDeviation,
    PotentialEnergyStiffness,
    ToothCrack,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices, tooth_coupling
from gearwhine.coupling.gears.errors import NoContactError
from gearwhine.coupling.gears.geometry.profile import meshing_rotations
from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial

STEEL = ShaftMaterial.from_poisson_ratio(2.06e11, 0.3, 7850.0)
PINION = Gear("pinion", 25, 3e-3, math.radians(20.0), 40e-3)
WHEEL = Gear("wheel", 40, 3e-3, math.radians(20.0), 20e-3)
MODEL = PotentialEnergyStiffness()


def test_the_common_face_lies_where_both_gears_are() -> None:
    beside = GearPairGeometry(PINION, WHEEL, axial_offset=14e-3)
    assert beside.face_width == pytest.approx(16e-3)
    assert beside.common_middles == pytest.approx((12e-3, -2e-3))
    whole = GearPairGeometry(PINION, WHEEL, axial_offset=-9e-3)
    assert whole.face_width == pytest.approx(20e-3)
    assert whole.carrying_gears[1] is WHEEL
    with pytest.raises(NoContactError, match="do not meet; they are 31 mm apart along z, expected less than 30"):
        GearPairGeometry(PINION, WHEEL, axial_offset=31e-3)


@pytest.mark.parametrize("beside", [0.5e-3, 1.5e-3, 5e-3, 30e-3])
@pytest.mark.parametrize("common", [12e-3, 40e-3])
def test_teeth_beside_the_common_face_support_it_as_far_as_their_shear_reaches(beside: float, common: float) -> None:
    """A tooth under an even load on part of its face, as a foundation with shear coupling solved by differences."""
    radius = np.array(PINION.pitch_radius)
    per_width = 1.0 / (float(MODEL.tooth(PINION, radius).total) * PINION.face_width)
    shear = tooth_coupling(PINION, float(radius))
    cells = 4000
    width = common + 2.0 * beside
    z = width * ((np.arange(cells) + 0.5) / cells - 0.5)
    step = width / cells
    loaded = np.abs(z) < 0.5 * common
    links = shear / step**2
    bands = np.array([np.full(cells, -links), np.full(cells, per_width + 2.0 * links)])
    bands[1, [0, -1]] -= links
    deflection = solveh_banded(bands, loaded.astype(float))
    effective = common * (1.0 / per_width) / deflection[loaded].mean()
    wide = replace(PINION, face_width=width)
    pair = GearPairGeometry(wide, replace(WHEEL, face_width=common))
    assert pair.carrying_gears[0].face_width == pytest.approx(effective, rel=0.04)


def test_a_much_wider_gear_is_little_stiffer() -> None:
    alike = MODEL.pair_stiffness(GearPairGeometry(replace(PINION, face_width=20e-3), WHEEL)).mean
    wider, widest = (
        MODEL.pair_stiffness(GearPairGeometry(replace(PINION, face_width=width), WHEEL)).mean for width in (40e-3, 0.2)
    )
    assert widest == pytest.approx(wider, rel=1e-3)
    assert alike < wider < 1.1 * alike


def test_a_crack_in_a_wide_gear_softens_it_over_its_effective_width() -> None:
    """The compliance of a crack through the whole face is inversely proportional to the width, as the tooth's is."""
    middle = np.array([0.5 * GearPairGeometry(PINION, WHEEL).contact_ratio])

    def softened(width: float) -> tuple[float, GearPairGeometry]:
        pair = GearPairGeometry(replace(PINION, face_width=width, faults=(ToothCrack(0, 2e-3),)), WHEEL)
        contact = tooth_contact(pair, MODEL)
        return float(1.0 / contact.variants[0].stiffness(middle)[0] - 1.0 / contact.stiffness(middle)[0]), pair

    (alike, _), (wide, pair) = softened(20e-3), softened(40e-3)
    effective = pair.carrying_gears[0].face_width
    assert 22e-3 < effective < 25e-3
    assert wide == pytest.approx(alike * 20e-3 / effective, rel=1e-4)


@pytest.mark.parametrize("offset", [0.0, 4e-3, -9e-3])
def test_a_helix_modification_is_of_the_gears_own_face(offset: float) -> None:
    deviation = HelixDeviation(slope=20e-6, crowning=12e-6, end_relief=30e-6, end_relief_length=8e-3)
    pair = GearPairGeometry(replace(PINION, helix_deviation=deviation), WHEEL, axial_offset=offset)
    slices = face_slices(pair)
    of_pinion = slices.z + offset
    part = of_pinion / 20e-3
    expected = 12e-6 * part**2 - 10e-6 * part
    expected += 30e-6 * np.maximum(0.0, 1.0 - (20e-3 - np.abs(of_pinion)) / 8e-3)
    np.testing.assert_allclose(slices.gap, expected, atol=1e-15)
    assert np.ptp(expected) > 5e-6


def machine(driver: Gear, driven: Gear, offsets: dict[str, float], **operation: float) -> Machine:
    """A driver in the middle of its shaft, and driven gears off that plane on shafts at either side."""
    distance = GearPairGeometry(driver, driven).working_centre_distance
    places = {"A": (0.0, 0.0), "B": (distance, 0.0), "C": (-distance, 0.0)}
    names = ["A", *offsets]
    stiff = np.diag([2e8, 2e8, 1e8, 0.0, 0.0])
    return Machine(
        [Shaft(Rotor(name, [Segment(0.24, 0.04, 0.0, STEEL)]), places[name]) for name in names],
        [
            MountedBearing(Bearing(f"{name}{at}", at, stiff, 1e-6 * stiff), name, None)
            for name in names
            for at in (0.02, 0.22)
        ],
        [
            ShaftGear(driver, "A", 0.12),
            *(ShaftGear(replace(driven, name=name), name, 0.12 + offset) for name, offset in offsets.items()),
        ],
        [GearPair(driver.name, name, misalignment=0.0) for name in offsets],
        **operation,
    )


def test_the_mesh_force_of_motion_acts_at_the_common_face() -> None:
    solved = machine(PINION, WHEEL, {"B": 9e-3}, speed=100.0, torque=200.0)
    system = solved.assembled.system
    q = static_equilibrium(system)
    forces = [bearing.stiffness @ (bearing.directions.T @ q) for bearing in system.linear[:4]]
    force = 200.0 / PINION.base_radius
    for left, right in (forces[:2], forces[2:]):
        assert np.hypot(*left[:2]) == pytest.approx(force * (0.22 - 0.129) / 0.2, rel=1e-6)
        assert np.hypot(*right[:2]) == pytest.approx(force * (0.129 - 0.02) / 0.2, rel=1e-6)


def test_teeth_of_a_helical_pinion_stand_in_both_of_its_meshes() -> None:
    driver = replace(PINION, helix_angle=math.radians(20.0))
    driven = replace(WHEEL, helix_angle=-driver.helix_angle)
    offsets = {"B": 9e-3, "C": -9e-3}
    solved = machine(driver, driven, offsets, speed=100.0, torque=200.0)
    stands = []
    for geometry, contact, line, z in zip(
        solved.pair_geometries, solved.assembled.system.contacts, (0.0, math.pi), offsets.values(), strict=False
    ):
        in_plane = meshing_rotations(geometry, contact.phase, centre_line_angle=line, sense=1)[0]
        stands.append(in_plane - z * math.tan(driver.helix_angle) / driver.pitch_radius)
    pitches = (stands[1] - stands[0]) / (2.0 * math.pi / driver.teeth)
    assert pitches == pytest.approx(round(pitches), abs=1e-9)
