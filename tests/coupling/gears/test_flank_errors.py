"""Deviations and faults of flanks: what each takes off, which pairs it concerns, and what the mesh makes of it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling.gears import (
    ConstantStiffness,
    Gear,
    GearError,
    GearPairGeometry,
    HelixDeviation,
    MissingTooth,
    PotentialEnergyStiffness,
    ProfileDeviation,
    RootRelief,
    Spall,
    SquareStiffness,
    TipRelief,
    Wear,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force
from gearwhine.coupling.gears.contact.tooth_pair import flank_gap
from gearwhine.coupling.gears.loaded.transmission_error import hunting_period_mesh
from gearwhine.coupling.gears.stiffness.hertz import hertz_compliance

ALPHA = math.radians(20.0)
PINION = Gear("pinion", 20, 3e-3, ALPHA, 10e-3, profile_shift=0.2)
WHEEL = Gear("wheel", 31, 3e-3, ALPHA, 10e-3)
MODEL = PotentialEnergyStiffness()
FORM, TIP = PINION.roll_angle(PINION.form_radius), PINION.roll_angle(PINION.tip_radius)
MIDDLE = 0.5 * (FORM + TIP)


def gap(gear: Gear, *rolls: float) -> list[float]:
    return flank_gap(gear, np.array(rolls)).tolist()


def test_reliefs_by_angle_and_by_length_are_the_same() -> None:
    length = 2e-3
    for by_length, by_angle in (
        (
            replace(PINION, tip_relief=TipRelief(1e-5, length=length)),
            replace(PINION, tip_relief=TipRelief(1e-5, TIP - length / PINION.base_radius)),
        ),
        (
            replace(PINION, root_relief=RootRelief(1e-5, length=length)),
            replace(PINION, root_relief=RootRelief(1e-5, FORM + length / PINION.base_radius)),
        ),
    ):
        rolls = np.linspace(FORM, TIP, 41)
        np.testing.assert_allclose(flank_gap(by_length, rolls), flank_gap(by_angle, rolls), atol=1e-18)
    assert gap(replace(PINION, tip_relief=TipRelief(1e-5, length=length)), FORM, TIP) == [0.0, pytest.approx(1e-5)]
    assert gap(replace(PINION, root_relief=RootRelief(1e-5, length=length)), FORM, TIP) == [pytest.approx(1e-5), 0.0]


def test_parabolic_relief_has_a_quarter_of_its_depth_half_way() -> None:
    gear = replace(PINION, tip_relief=TipRelief(1e-5, MIDDLE, shape="parabolic"))
    assert gap(gear, MIDDLE, 0.5 * (MIDDLE + TIP), TIP) == pytest.approx([0.0, 0.25e-5, 1e-5], abs=1e-20)


def test_profile_deviation_is_what_an_inspection_reports() -> None:
    slope = replace(PINION, profile_deviation=ProfileDeviation(slope=8e-6))
    foot, tip = gap(slope, FORM, TIP)
    assert foot - tip == pytest.approx(8e-6)  # the tip stands out, so less is missing there
    waves = flank_gap(replace(PINION, profile_deviation=ProfileDeviation(form=6e-6)), np.linspace(FORM, TIP, 2001))
    assert float(np.ptp(waves)) == pytest.approx(6e-6, rel=1e-4)
    crowned = replace(PINION, profile_deviation=ProfileDeviation(crowning=5e-6))
    assert gap(crowned, FORM, MIDDLE, TIP) == pytest.approx([5e-6, 0.0, 5e-6], abs=1e-18)
    measured = replace(PINION, profile_deviation=ProfileDeviation(table=((FORM, 1e-6), (MIDDLE, 2e-6), (TIP, -4e-6))))
    assert gap(measured, FORM, 0.5 * (MIDDLE + TIP)) == pytest.approx([-1e-6, 1e-6])


def test_a_table_of_tip_relief_is_tip_relief() -> None:
    start = FORM + 0.7 * (TIP - FORM)
    by_table = ProfileDeviation(table=((FORM, 0.0), (start, 0.0), (TIP, -15e-6)))
    errors = [
        loaded_transmission_error(tooth_contact(GearPairGeometry(gear, WHEEL), MODEL), 3000.0, np.linspace(0, 1, 301))
        for gear in (replace(PINION, profile_deviation=by_table), replace(PINION, tip_relief=TipRelief(15e-6, start)))
    ]
    np.testing.assert_allclose(errors[0].transmission_error, errors[1].transmission_error, atol=1e-12)


def test_helix_deviation_across_the_face() -> None:
    deviation = HelixDeviation(slope=4e-6, crowning=3e-6, end_relief=5e-6, end_relief_length=1e-3)
    z = np.array([-5e-3, -4.5e-3, 0.0, 5e-3])
    expected = [-2e-6 - 3e-6 - 5e-6, -1.8e-6 - 3e-6 * 0.81 - 2.5e-6, 0.0, 2e-6 - 3e-6 - 5e-6]
    np.testing.assert_allclose(deviation.at(z, 10e-3), expected, atol=1e-18)
    assert HelixDeviation().is_straight
    assert not deviation.is_straight


def test_uniform_wear_of_all_teeth_is_a_shift() -> None:
    phases = np.linspace(0.0, 1.0, 101)
    new, worn = (
        loaded_transmission_error(tooth_contact(GearPairGeometry(gear, WHEEL), MODEL), 2000.0, phases)
        for gear in (PINION, replace(PINION, faults=(Wear(7e-6, shape="uniform"),)))
    )
    np.testing.assert_allclose(worn.transmission_error, new.transmission_error + 7e-6, rtol=1e-9)


def test_sliding_wear_spares_the_pitch_point() -> None:
    pair = GearPairGeometry(replace(PINION, faults=(Wear(9e-6),)), WHEEL)
    contact = tooth_contact(pair, MODEL)
    assert float(contact.deviation(pair.pitch_point_position)) == pytest.approx(0.0, abs=1e-12)
    roll = pair.driver_roll_angle(0.0)
    pitch = math.tan(pair.working_pressure_angle)
    farthest = max(TIP - pitch, pitch - FORM)
    assert float(contact.deviation(0.0)) == pytest.approx(9e-6 * abs(float(roll) - pitch) / farthest)


def test_a_missing_tooth_leaves_the_load_to_its_neighbours() -> None:
    pair = GearPairGeometry(replace(PINION, faults=(MissingTooth(3),)), WHEEL)
    contact = tooth_contact(pair, MODEL, corner_contact=True)
    assert contact.hunting_period == 20
    phases = np.arange(0.0, 20.0, 0.01) + 0.003
    mesh = loaded_transmission_error(contact, 500.0, phases)
    number = np.floor(phases)[:, None] - np.floor(mesh.positions)
    np.testing.assert_array_equal(mesh.pair_forces[number % 20 == 3], 0.0)
    sound = loaded_transmission_error(
        tooth_contact(GearPairGeometry(PINION, WHEEL), MODEL, corner_contact=True), 500.0, phases
    )
    apart = np.abs(mesh.transmission_error - sound.transmission_error) > 1e-12
    assert apart.any()
    assert set(np.floor(phases[apart]).tolist()) <= {2.0, 3.0, 4.0}


def test_spall_across_the_face_is_a_pit_in_the_motion() -> None:
    spall = Spall(5, MIDDLE - 0.05, MIDDLE + 0.05, 20e-6)
    pair = GearPairGeometry(replace(PINION, faults=(spall,)), WHEEL)
    contact = tooth_contact(pair, MODEL)
    position = pair.driver_position(MIDDLE)
    assert contact.variants[0].deviation(position) == pytest.approx(20e-6)
    assert float(contact.deviation(position)) == 0.0
    law = contact.kernel_arguments
    for tooth, expected in ((4, 0.0), (5, 20e-6), (25, 20e-6)):
        alone = [tooth_force(tooth + position, delta, 0.0, *law)[5] for delta in (expected - 1e-9, expected + 1e-9)]
        others = 0 if expected == 0.0 else alone[0]
        assert alone[1] == others + 1


def test_spall_across_a_part_of_the_face_softens_the_contact() -> None:
    spall = Spall(0, MIDDLE - 0.05, MIDDLE + 0.05, 20e-6, width=4e-3)
    pair = GearPairGeometry(replace(PINION, faults=(spall,)), WHEEL)
    contact = tooth_contact(pair, MODEL)
    position = pair.driver_position(MIDDLE)
    more = 1.0 / contact.variants[0].stiffness(position) - 1.0 / contact.stiffness(position)
    # Six tenths of the face carry: the flattening is ten sixths.
    assert more == pytest.approx((10.0 / 6.0 - 1.0) * hertz_compliance(GearPairGeometry(PINION, WHEEL)), rel=1e-7)


def test_a_spall_softens_the_contact_of_its_pair() -> None:
    """Of both materials, on the common face, in the normal section of helical teeth: 2 η / (π b cos β_b)."""
    beta, alpha = math.radians(20.0), ALPHA
    spall = Spall(0, MIDDLE - 0.05, MIDDLE + 0.05, 20e-6, width=2e-3)
    pinion = replace(PINION, helix_angle=beta, faults=(spall,))
    wheel = replace(WHEEL, helix_angle=-beta, face_width=8e-3, youngs_modulus=70e9, poisson_ratio=0.33)
    pair = GearPairGeometry(pinion, wheel)
    position = pair.driver_position(MIDDLE)
    whole = 2.0 * (0.91 / PINION.youngs_modulus + (1.0 - 0.33**2) / 70e9) / (math.pi * 8e-3)
    whole /= math.cos(math.asin(math.sin(beta) * math.cos(alpha)))
    for model in (MODEL, SquareStiffness(1e8)):
        contact = tooth_contact(pair, model)
        more = 1.0 / contact.variants[0].stiffness(position) - 1.0 / contact.stiffness(position)
        assert more == pytest.approx((8.0 / 6.0 - 1.0) * whole, rel=1e-6)
    # Nothing of the narrower face is left.
    across = replace(pair, driver=replace(pinion, faults=(replace(spall, width=9e-3),)))
    assert tooth_contact(across, MODEL).variants[0].deviation(position) == pytest.approx(20e-6)


def test_a_spall_softens_webers_contact_as_much_as_it_narrows_it() -> None:
    """Between a spall's pair and its sound twin stands Weber's δ/F of equal materials, times 2/3."""
    spall = Spall(0, MIDDLE - 0.05, MIDDLE + 0.05, 20e-6, width=4e-3)
    pair = GearPairGeometry(replace(PINION, faults=(spall,)), WHEEL)
    load = 3000.0
    contact = tooth_contact(pair, PotentialEnergyStiffness(contact="weber", force=load))
    position = pair.driver_position(MIDDLE)
    more = 1.0 / contact.variants[0].stiffness(position) - 1.0 / contact.stiffness(position)
    along = MIDDLE * PINION.base_radius
    curvature = 1.0 / along + 1.0 / (pair.tangent_distance - along)
    yielding = 0.91 / PINION.youngs_modulus
    strip = math.sqrt(8.0 * load * yielding / (math.pi * 10e-3 * curvature))
    sinking = 0.0
    for gear, roll in ((PINION, MIDDLE), (WHEEL, (pair.tangent_distance - along) / WHEEL.base_radius)):
        # Along the normal, at the angle τ to the tooth's width, from the flank to the axis.
        tilt = roll - gear.base_half_angle
        depth = gear.base_radius * (roll - math.tan(tilt))
        sinking += 2.0 * yielding / (math.pi * 10e-3) * (math.log(2.0 * depth / strip) - 0.15 / 0.7)
    assert more == pytest.approx((10.0 / 6.0 - 1.0) * sinking, rel=1e-6)


def test_both_damaged_teeth_meet_once_in_the_hunting_period() -> None:
    pair = GearPairGeometry(
        replace(PINION, faults=(Wear(5e-6, 2, "uniform"),)), replace(WHEEL, faults=(Wear(3e-6, 4, "uniform"),))
    )
    contact = tooth_contact(pair, MODEL)
    assert contact.hunting_period == 620
    depths = [0.0, *(float(kind.deviation(0.5)) for kind in contact.variants)]
    seen = np.array(depths)[contact.pair_variants]
    expected = [5e-6 * (n % 20 == 2) + 3e-6 * (n % 31 == 4) for n in range(620)]
    np.testing.assert_allclose(seen, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: TipRelief(1e-5), "tip relief: expected exactly one of 'start_roll_angle' and 'length'"),
        (lambda: TipRelief(1e-5, 0.3, 1e-3), "exactly one"),
        (lambda: TipRelief(1e-5, 0.3, shape="cubic"), "linear, parabolic"),  # type: ignore[arg-type]
        (lambda: replace(PINION, tip_relief=TipRelief(1e-5, TIP + 0.01)), "below the tip's roll angle"),
        (
            lambda: replace(PINION, tip_relief=TipRelief(1e-5, length=0.1)),
            "tip_relief.length is 0.1; .*below the tip's roll angle",
        ),
        (
            lambda: replace(PINION, root_relief=RootRelief(1e-5, FORM - 0.01)),
            "root_relief.start_roll_angle is .*; expected a start between",
        ),
        (lambda: replace(PINION, faults=(MissingTooth(20),)), r"faults\[0\].tooth is 20; expected a tooth from 0 to"),
        (lambda: MissingTooth(-1), "whole number from 0"),
        (lambda: Spall(1, 0.3, 0.2, 1e-5), "end_roll_angle must be above"),
        (lambda: Wear(1e-5, shape="round"), "'sliding' or 'uniform'"),  # type: ignore[arg-type]
        (lambda: ProfileDeviation(table=((0.2, 0.0),)), "two rows or more"),
        (lambda: ProfileDeviation(table=((0.2, 0.0), (0.1, 0.0))), "roll angles increasing"),
        (lambda: ProfileDeviation(form=-1e-6), "form is -1e-06; expected .* of at least 0 m"),
        (lambda: HelixDeviation(end_relief=1e-6), "end_relief_length is 0; expected the length"),
        (
            lambda: tooth_contact(
                GearPairGeometry(replace(PINION, faults=(MissingTooth(1),)), WHEEL), ConstantStiffness(1e8)
            ),
            "whole mesh as one spring",
        ),
        (
            lambda: tooth_contact(GearPairGeometry(replace(PINION, faults=(MissingTooth(1),)), WHEEL), MODEL),
            "where a tooth is missing",
        ),
    ],
)
def test_impossible_flanks_say_why(make: object, words: str) -> None:
    assert callable(make)
    with pytest.raises(GearError, match=words):
        make()


def test_a_spall_beside_the_flank_is_refused() -> None:
    with pytest.raises(
        GearError,
        match=r"faults\[0\].start_roll_angle is 1.745.*expected a spall on .*starts at 100 degrees",
    ):
        replace(PINION, faults=(Spall(0, math.radians(100.0), math.radians(120.0), 20e-6),))


@pytest.mark.parametrize("uneven", [False, True])
def test_a_gap_in_the_teeth_wider_than_any_pair_reaches_is_refused(uneven: bool) -> None:
    """One missing tooth leaves its neighbours two base pitches apart, which they bridge; three leave four."""
    for missing, bridged in ((3,), True), ((3, 4, 5), False):
        pair = GearPairGeometry(replace(PINION, faults=tuple(MissingTooth(tooth) for tooth in missing)), WHEEL)
        faces = face_slices(pair, misalignment=1e-4, count=5) if uneven else None
        contact = tooth_contact(pair, PotentialEnergyStiffness(), corner_contact=True, faces=faces)
        if bridged:
            assert hunting_period_mesh(contact, 1000.0).transmission_error.max() < 1e-3
            continue
        with pytest.raises(GearError, match=r"no teeth meet at phase \d"):
            hunting_period_mesh(contact, 1000.0)
