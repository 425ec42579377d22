"""Pitch deviations: which teeth meet, the gap they leave, the law, and the loaded mesh over the hunting period."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from gearwhine.coupling.gears import (
    ConstantStiffness,
    Gear,
    GearError,
    GearPairGeometry,
    PotentialEnergyStiffness,
    SquareStiffness,
    TipRelief,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force, tooth_force_history
from gearwhine.coupling.gears.geometry.pitch_deviations import back_flank_pitch_gaps, pitch_gaps
from gearwhine.coupling.gears.loaded.transmission_error import mesh_period_phases

ALPHA = math.radians(20.0)
RELIEF = TipRelief(20e-6, math.radians(24.0))
RNG = np.random.default_rng(5)
DRIVER_DEVIATIONS = RNG.uniform(-8e-6, 8e-6, 20)
DRIVEN_DEVIATIONS = RNG.uniform(-8e-6, 8e-6, 30)
PLAIN_DRIVER = Gear("pinion", 20, 3e-3, ALPHA, 10e-3, tip_relief=RELIEF)
PLAIN_DRIVEN = Gear("wheel", 30, 3e-3, ALPHA, 10e-3, tip_relief=RELIEF)
DRIVER = replace(PLAIN_DRIVER, pitch_deviations=tuple(DRIVER_DEVIATIONS.tolist()))
DRIVEN = replace(PLAIN_DRIVEN, pitch_deviations=tuple(DRIVEN_DEVIATIONS.tolist()))
PLAIN_PAIR, PAIR = GearPairGeometry(PLAIN_DRIVER, PLAIN_DRIVEN), GearPairGeometry(DRIVER, DRIVEN)
PLAIN_CONTACT, CONTACT = (tooth_contact(pair, PotentialEnergyStiffness(), 150.0) for pair in (PLAIN_PAIR, PAIR))
PERIOD = 60  # the least common multiple of 20 and 30 teeth
patient = settings(deadline=None)  # the first call of a kernel compiles it


def gap_of(number: int) -> float:
    """Gap of the pair that enters at phase `number`, as it is defined."""
    return -(DRIVER_DEVIATIONS[number % 20] + DRIVEN_DEVIATIONS[number % 30]) * math.cos(ALPHA)


def one_tooth(gear: Gear, tooth: int, deviation: float = 10e-6) -> Gear:
    """A gear that is perfect but for one tooth."""
    return replace(gear, pitch_deviations=tuple(deviation * (n == tooth) for n in range(gear.teeth)))


# ------------------------------------------------------------------------------------------------- the table


def test_gaps_are_those_of_the_teeth_that_meet() -> None:
    np.testing.assert_allclose(pitch_gaps(PAIR), [gap_of(n) for n in range(PERIOD)], rtol=1e-14)
    assert CONTACT.hunting_period == PERIOD


def test_one_imperfect_gear_repeats_with_its_turn() -> None:
    np.testing.assert_allclose(
        pitch_gaps(GearPairGeometry(DRIVER, PLAIN_DRIVEN)), -DRIVER_DEVIATIONS * math.cos(ALPHA), rtol=1e-14
    )
    assert pitch_gaps(GearPairGeometry(PLAIN_DRIVER, DRIVEN)).size == 30


def test_the_line_of_action_sees_the_working_pressure_angle() -> None:
    # Shafts 0.3 mm apart more: cos(w) = a0 cos(alpha) / a.
    distance = PLAIN_PAIR.working_centre_distance
    wide = GearPairGeometry(one_tooth(PLAIN_DRIVER, 3), PLAIN_DRIVEN, distance + 0.3e-3)
    expected = -10e-6 * math.cos(ALPHA) * distance / (distance + 0.3e-3)
    assert pitch_gaps(wide)[3] == pytest.approx(expected, rel=1e-12)


def test_turning_a_tooth_moves_its_flank_as_the_base_circle_unwinds() -> None:
    # A tooth ahead by an arc on the pitch circle has turned by arc / r; its flank moves by rb times that.
    assert pitch_gaps(GearPairGeometry(one_tooth(PLAIN_DRIVER, 3), PLAIN_DRIVEN))[3] == pytest.approx(
        -PLAIN_DRIVER.base_radius * 10e-6 / PLAIN_DRIVER.pitch_radius, rel=1e-12
    )


@pytest.mark.parametrize("shift", [0.0, 0.25])
@pytest.mark.parametrize("tooth", [0, 7, 19])
def test_idle_flanks_of_a_displaced_tooth_are_behind(tooth: int, shift: float) -> None:
    # Along the pitch line the working flanks of driver tooth n are (p - n - s_pitch) pitches past the pitch point,
    # its back flanks a tooth's thickness behind. By symmetry these touch while within -(eps - s_pitch) ... s_pitch.
    driver, driven = replace(PLAIN_DRIVER, profile_shift=shift), replace(PLAIN_DRIVEN, profile_shift=-shift)
    pair = GearPairGeometry(one_tooth(driver, tooth), driven)
    plain = tooth_contact(GearPairGeometry(driver, driven), SquareStiffness(1e8)).back_flanks
    contact = tooth_contact(pair, SquareStiffness(1e8)).back_flanks
    thickness = (0.5 * math.pi + 2.0 * shift * math.tan(ALPHA)) / math.pi  # of the driver, in circular pitches
    s_pitch, eps = pair.pitch_point_position, pair.contact_ratio
    phases = np.arange(0.0, 40.0, 0.0137)
    idle = (phases - tooth - s_pitch - thickness + 10.0) % 20.0 - 10.0
    touches = (idle > -(eps - s_pitch)) & (idle < s_pitch)
    delta = np.full(phases.size, 50e-6)
    shown, ideal = (
        tooth_force_history(law.back_flank_offset - phases, delta, 0.0 * phases, *law.kernel_arguments)[:, 0]
        for law in (contact, plain)
    )
    np.testing.assert_allclose(shown - ideal, np.where(touches, -1e8 * 10e-6 * math.cos(ALPHA), 0.0), atol=1e-6)


def test_idle_flanks_meet_the_driven_tooth_that_follows() -> None:
    # The working flank of driver tooth n drives the driven tooth n; behind it stands the driven tooth n + 1.
    numbers = np.arange(PERIOD)
    drivers, driven = PAIR.mating_back_teeth(numbers)
    both = {(int(k), int(i)) for k, i in zip(drivers, driven, strict=True)}
    assert both == {(n % 20, (n + 1) % 30) for n in range(PERIOD)}
    expected = (DRIVER_DEVIATIONS[drivers] + DRIVEN_DEVIATIONS[driven]) * math.cos(ALPHA)
    np.testing.assert_allclose(back_flank_pitch_gaps(PAIR), expected, rtol=1e-14)


# --------------------------------------------------------------------------------------------------- the law


@patient
@given(st.integers(-100, 200), st.floats(1e-9, 0.999999), st.floats(-3e-5, 8e-5), st.floats(-0.1, 0.1))
def test_law_is_the_sum_over_the_pairs(whole: int, part: float, delta: float, rate: float) -> None:
    phase = whole + part
    if abs(part - PAIR.contact_ratio % 1.0) < 1e-9:
        return  # a pair is just leaving
    law = tooth_force(phase, delta, rate, *CONTACT.kernel_arguments)
    stiffness, gaps = [], []
    for behind in range(3):
        position = phase - whole + behind
        if position < PAIR.contact_ratio:
            k = float(CONTACT.stiffness(position))
            stiffness.append(k / (1.0 - CONTACT.shared_compliance * k))
            gaps.append(float(CONTACT.deviation(position)) + gap_of(whole - behind))
    shared, k_own, gap = CONTACT.shared_compliance, np.array(stiffness), np.array(gaps)

    def too_much(x: float) -> float:
        return float(x + shared * np.sum(k_own * np.maximum(0.0, x - gap)) - delta)

    own = brentq(too_much, delta - 1e-3, delta, xtol=1e-19, rtol=1e-15) if too_much(delta) > 0.0 else delta
    approach = np.maximum(0.0, own - gap)
    touching = int(np.sum(approach > 0.0))
    force, scale = float(k_own @ approach), float(np.sum(k_own) * abs(delta))
    tangent, energy = float(np.sum(k_own[approach > 0.0])), float(0.5 * k_own @ approach**2 + 0.5 * shared * force**2)
    tangent /= 1.0 + shared * tangent
    if touching:
        force += 150.0 * rate
    np.testing.assert_allclose(law[0], force, rtol=1e-8, atol=1e-9 * (1.0 + scale))
    # The stiffness behind the shared compliance is a table that is right to 1e-9.
    np.testing.assert_allclose([law[1], law[3]], [tangent, energy], rtol=1e-8, atol=1e-15)
    assert law[5] == touching


@patient
@given(st.integers(-70, 70), st.floats(0.01, 0.99), st.floats(1e-5, 8e-5))
def test_force_and_parametric_power_are_slopes_of_the_energy(whole: int, part: float, delta: float) -> None:
    # Also across the hand-over, where the pairs change places in the sum but none of them its gap.
    phase, steps = whole + part, (1e-9, 1e-6)
    marks = (0.0, *CONTACT.event_phases, *CONTACT.corner_phases)
    gaps = CONTACT.pairs(phase).deviation
    if min(abs(part - mark) for mark in marks) < 1e-4 or np.any(np.abs(delta - gaps) < 1e-7):
        return
    here = tooth_force(phase, delta, 0.0, *CONTACT.kernel_arguments)
    by_delta, by_phase = (
        [tooth_force(phase + side * dp, delta + side * dd, 0.0, *CONTACT.kernel_arguments)[3] for side in (-1.0, 1.0)]
        for dp, dd in ((0.0, steps[0]), (steps[1], 0.0))
    )
    scale = CONTACT.unloaded_mean_mesh_stiffness * delta
    assert (by_delta[1] - by_delta[0]) / (2.0 * steps[0]) == pytest.approx(here[0], rel=1e-6, abs=1e-6 * scale)
    slope = (by_phase[1] - by_phase[0]) / (2.0 * steps[1])
    assert slope == pytest.approx(here[4], rel=1e-4, abs=1e-4 * scale * delta)


def test_a_pair_keeps_its_gap_while_others_come_and_go() -> None:
    # One tooth stands ahead: with unit square pairs the extra force is its own, and lasts for one contact.
    eps = PLAIN_PAIR.contact_ratio
    contact = tooth_contact(GearPairGeometry(one_tooth(PLAIN_DRIVER, 4), PLAIN_DRIVEN), SquareStiffness(1e8))
    plain = tooth_contact(PLAIN_PAIR, SquareStiffness(1e8))
    phases = np.arange(-21.0, 41.0, 0.0213)
    delta = np.full(phases.size, 1e-4)
    with_it, without = (
        tooth_force_history(phases, delta, 0.0 * phases, *law.kernel_arguments)[:, 0] for law in (contact, plain)
    )
    expected = np.where((phases - 4.0) % 20.0 < eps, 1e8 * 10e-6 * math.cos(ALPHA), 0.0)
    np.testing.assert_allclose(with_it - without, expected, atol=1e-7)


def test_law_repeats_with_the_hunting_period_and_no_sooner() -> None:
    phases = np.arange(0.05, PERIOD, 0.31)
    rows = [
        tooth_force_history(phases + shift, np.full(phases.size, 3e-5), 0.0 * phases, *CONTACT.kernel_arguments)
        for shift in (0.0, PERIOD, -3 * PERIOD, 20, 30)
    ]
    for again in rows[1:3]:
        np.testing.assert_allclose(again, rows[0], rtol=1e-8, atol=1e-8)
    for other in rows[3:]:
        assert np.max(np.abs(other[:, 0] - rows[0][:, 0])) > 100.0


def test_a_phase_a_hair_below_a_whole_number_is_the_next_pairs() -> None:
    hair = tooth_force(-1e-18, 3e-5, 0.0, *CONTACT.kernel_arguments)
    assert hair == tooth_force(0.0, 3e-5, 0.0, *CONTACT.kernel_arguments)
    np.testing.assert_array_equal(CONTACT.pairs(-1e-18).deviation, CONTACT.pairs(0.0).deviation)


def test_no_deviation_is_the_same_to_the_last_bit() -> None:
    zeros = GearPairGeometry(
        replace(PLAIN_DRIVER, pitch_deviations=(0.0,) * 20), replace(PLAIN_DRIVEN, pitch_deviations=(0.0,) * 30)
    )
    contact = tooth_contact(zeros, PotentialEnergyStiffness(), 150.0)
    assert contact.pitch_gaps.size == 0
    assert contact.back_flanks is contact
    assert contact.hunting_period == 1
    phases, delta = RNG.uniform(-50.0, 50.0, 500), RNG.uniform(-1e-5, 8e-5, 500)
    # A table of zeros takes the other way through the kernel.
    written_out = replace(contact, pitch_gaps=np.zeros(PERIOD))
    rows = [
        tooth_force_history(phases, delta, 100.0 * delta, *law.kernel_arguments)
        for law in (PLAIN_CONTACT, contact, written_out)
    ]
    np.testing.assert_array_equal(rows[1], rows[0])
    np.testing.assert_array_equal(rows[2], rows[0])


def test_a_whole_mesh_steps_once_a_period() -> None:
    contact = tooth_contact(PAIR, ConstantStiffness(2e8))
    assert contact.event_phases == (0.0,)
    for phase in (0.4, 7.9, -2.3):
        force = tooth_force(phase, 5e-5, 0.0, *contact.kernel_arguments)[0]
        assert force == pytest.approx(2e8 * (5e-5 - gap_of(math.floor(phase))), rel=1e-12)


# -------------------------------------------------------------------------------------------- the loaded mesh


def test_rigid_gears_follow_the_foremost_pair() -> None:
    # With no compliance to speak of the error is the least gap among the pairs on their path of contact.
    contact = tooth_contact(PAIR, SquareStiffness(1e15))
    phases = mesh_period_phases(contact, points=50, periods=PERIOD)
    found = loaded_transmission_error(contact, 1000.0, phases).transmission_error
    relief = contact.deviation
    expected = []
    for phase in phases:
        whole = math.floor(phase)
        pairs = [(phase - whole + behind, whole - behind) for behind in range(2)]
        expected.append(min(float(relief(s)) + gap_of(n) for s, n in pairs if s < PAIR.contact_ratio))
    np.testing.assert_allclose(found, expected, atol=2e-12)


def test_a_heavy_load_averages_the_pairs() -> None:
    # All pairs touch: the mean over two of them, one's own where it is alone; unrelieved square pairs.
    pair = GearPairGeometry(replace(DRIVER, tip_relief=None), replace(DRIVEN, tip_relief=None))
    contact = tooth_contact(pair, SquareStiffness(1e8))
    mesh = loaded_transmission_error(contact, 1e5, mesh_period_phases(contact, periods=PERIOD))
    expected = []
    for phase in mesh.phases:
        whole = math.floor(phase)
        gaps = [gap_of(whole - b) for b in range(2) if phase - whole + b < pair.contact_ratio]
        expected.append(np.mean(gaps) + 1e5 / (1e8 * len(gaps)))
    np.testing.assert_allclose(mesh.transmission_error, expected, rtol=1e-10)
    np.testing.assert_allclose(mesh.pair_forces.sum(axis=1), 1e5, rtol=1e-12)
    # The mean over all periods, in closed form: alone for 2 - eps, together for eps - 1 of each.
    eps, mean = pair.contact_ratio, float(np.mean([gap_of(n) for n in range(PERIOD)]))
    assert mesh.mean_transmission_error == pytest.approx(mean + 1e-3 * (2.0 - eps) + 0.5e-3 * (eps - 1.0), rel=1e-5)


def test_equilibrium_of_the_dynamic_law() -> None:
    mesh = loaded_transmission_error(CONTACT, 800.0, np.arange(0.02, PERIOD, 0.37))
    history = tooth_force_history(mesh.phases, mesh.transmission_error, 0.0 * mesh.phases, *CONTACT.kernel_arguments)
    np.testing.assert_allclose(history[:, 0], 800.0, rtol=1e-9)


def test_phases_over_several_periods_are_the_one_period_repeated() -> None:
    one, three = (mesh_period_phases(PLAIN_CONTACT, points=40, periods=periods) for periods in (1, 3))
    np.testing.assert_allclose(three, np.concatenate([one, one + 1.0, one + 2.0]), rtol=0.0, atol=1e-15)
    single, triple = (loaded_transmission_error(PLAIN_CONTACT, 800.0, phases) for phases in (one, three))
    assert triple.mean_transmission_error == pytest.approx(single.mean_transmission_error, rel=1e-9)


# ------------------------------------------------------------------------------------------------ wrong input


def test_one_deviation_for_each_tooth() -> None:
    with pytest.raises(GearError, match="expected one deviation for each of 20 teeth, or none"):
        replace(PLAIN_DRIVER, pitch_deviations=(0.0,) * 19)
    with pytest.raises(GearError, match=r"pitch_deviations\[3\] is nan; expected a finite number"):
        replace(PLAIN_DRIVER, pitch_deviations=(0.0,) * 3 + (math.nan,) + (0.0,) * 16)
    with pytest.raises(GearError, match="pitch_gaps must be a row of finite numbers"):
        replace(CONTACT, pitch_gaps=np.zeros((2, 2)))
