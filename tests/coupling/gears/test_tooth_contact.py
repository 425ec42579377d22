"""The contact law: kernels against the law written out, tip relief, events, damping."""

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from coupling.gears import (
    ConstantStiffness,
    Gear,
    GearError,
    GearPairGeometry,
    PotentialEnergyStiffness,
    SquareStiffness,
    TableStiffness,
    TipRelief,
    ToothContact,
    equivalent_mass,
    mesh_damping,
    pair_deviation,
    piecewise,
    runout_error,
    tooth_contact,
)
from coupling.gears.kernels import tooth_force, tooth_force_history

ALPHA = math.radians(20.0)
DEGREE = math.radians(1.0)
DRIVER = Gear("pinion", 28, 3.175e-3, ALPHA, 6.35e-3, tip_relief=TipRelief(0.023e-3, 24.0 * DEGREE))
DRIVEN = replace(DRIVER, name="wheel", tip_relief=TipRelief(0.025e-3, 24.0 * DEGREE))
PAIR = GearPairGeometry(DRIVER, DRIVEN)
CONTACT = tooth_contact(PAIR, PotentialEnergyStiffness(), damping=120.0)


def test_kernel_is_the_law() -> None:
    rng = np.random.default_rng(11)
    phases, compressions = rng.uniform(-3.0, 5.0, 300), rng.uniform(-1e-5, 6e-5, 300)
    rates = rng.normal(0.0, 0.05, 300)
    history = tooth_force_history(phases, compressions, rates, *CONTACT.kernel_arguments)
    for phase, delta, rate, row in zip(phases, compressions, rates, history, strict=True):
        force = tangent = energy = 0.0
        touching = 0
        for pair in range(3):
            position = phase % 1.0 + pair
            if position < PAIR.contact_ratio:
                k = float(CONTACT.stiffness(position))
                approach = max(0.0, delta - float(CONTACT.deviation(position)))
                force, energy = force + k * approach, energy + 0.5 * k * approach**2
                tangent, touching = tangent + k * (approach > 0.0), touching + (approach > 0.0)
        force += 120.0 * rate * (touching > 0)
        expected = [force, tangent, 120.0 * (touching > 0), energy]
        np.testing.assert_allclose(row[:4], expected, rtol=1e-11, atol=1e-12)
        assert row[5] == touching


def test_no_touch_no_force() -> None:
    assert tooth_force(0.3, -1e-6, 5.0, *CONTACT.kernel_arguments) == (0.0, 0.0, 0.0, 0.0, 0.0, 0)


def test_a_phase_a_hair_below_a_whole_number() -> None:
    below = tooth_force(-1e-18, 2e-5, 0.0, *CONTACT.kernel_arguments)
    assert below == tooth_force(0.0, 2e-5, 0.0, *CONTACT.kernel_arguments)


def test_number_of_pairs_follows_the_contact_ratio() -> None:
    # 1.638: two pairs during the first 0.638 of a period, then one.
    contact = tooth_contact(PAIR, SquareStiffness(1e8))
    contact = replace(contact, deviation=piecewise.constant(0.0, PAIR.contact_ratio))
    counts = [tooth_force(p, 1e-5, 0.0, *contact.kernel_arguments)[5] for p in (0.01, 0.63, 0.64, 0.99)]
    assert counts == [2, 2, 1, 1]


def test_three_pairs_at_once() -> None:
    curve = piecewise.constant(1e8, 2.4)
    contact = ToothContact(2.4, curve, piecewise.constant(0.0, 2.4))
    assert tooth_force(7.3, 1e-5, 0.0, *contact.kernel_arguments)[0] == pytest.approx(3000.0)
    assert tooth_force(7.5, 1e-5, 0.0, *contact.kernel_arguments)[0] == pytest.approx(2000.0)
    assert contact.event_phases == (0.0, pytest.approx(0.4))


def test_constant_mesh_is_a_spring_at_every_phase() -> None:
    contact = tooth_contact(PAIR, ConstantStiffness(1.5e8))
    assert contact.contact_ratio == 1.0
    assert contact.event_phases == ()
    assert contact.corner_phases == ()
    for phase in (-0.2, 0.0, 0.4, 0.999999, 17.0):
        force, tangent, _, energy, slope, touching = tooth_force(phase, 2e-5, 0.0, *contact.kernel_arguments)
        assert (force, tangent, energy, slope, touching) == (
            pytest.approx(3000.0),
            pytest.approx(1.5e8),
            pytest.approx(0.03),
            0.0,
            1,
        )


def test_idle_flanks_run_through_the_same_law_backwards() -> None:
    # Their pairs enter where the mirrored, backward-running phase has a working pair leave, and conversely.
    contact = tooth_contact(PAIR, SquareStiffness(1e8))
    contact = replace(contact, deviation=piecewise.constant(0.0, PAIR.contact_ratio))
    for event in contact.back_flank_event_phases:
        before, after = (
            tooth_force(contact.back_flank_offset - phase, 1e-5, 0.0, *contact.kernel_arguments)[5]
            for phase in (event - 1e-6, event + 1e-6)
        )
        assert {before, after} == {1, 2}


def test_square_mesh_with_a_printed_contact_ratio() -> None:
    contact = tooth_contact(PAIR, SquareStiffness(1e8, contact_ratio=1.6))
    assert contact.mean_stiffness == pytest.approx(1.6e8)
    assert contact.event_phases == (0.0, pytest.approx(0.6))


def test_integers_compile_no_second_kernel() -> None:
    kernel_arguments = replace(CONTACT, damping=120).kernel_arguments
    assert [type(value) for value in kernel_arguments] == [np.ndarray, int]
    assert kernel_arguments[0].dtype == np.float64


def test_whole_mesh_table_steps_where_its_ends_differ() -> None:
    position = np.linspace(0.0, 1.0, 11)
    stepping = tooth_contact(PAIR, TableStiffness(position, 1e8 * (1.0 + position)))
    assert stepping.event_phases == (0.0,)


def test_tip_relief_is_linear_in_roll_angle() -> None:
    gap = pair_deviation(PAIR, 0.0, PAIR.contact_ratio)
    tip = DRIVER.roll_angle(DRIVER.tip_radius)
    for roll in (24.0 * DEGREE, 0.5 * (24.0 * DEGREE + tip), tip):
        share = (roll - 24.0 * DEGREE) / (tip - 24.0 * DEGREE)
        assert float(gap(PAIR.driver_position(roll))) == pytest.approx(0.023e-3 * share, abs=1e-15)
        assert float(gap(PAIR.driven_position(roll))) == pytest.approx(0.025e-3 * share, abs=1e-15)
    assert float(gap(PAIR.pitch_point_position)) == 0.0
    starts = (PAIR.driver_position(24.0 * DEGREE) % 1.0, PAIR.driven_position(24.0 * DEGREE) % 1.0)
    assert CONTACT.corner_phases == pytest.approx(sorted(starts))


@pytest.mark.parametrize("start", [0.0, 2.0, 10.0, 31.0])
def test_reliefs_that_overlap_or_cover_the_flank(start: float) -> None:
    # The sum of two hinges wherever they begin; compared point by point with the definition.
    relief = TipRelief(1e-5, start * DEGREE)
    pair = GearPairGeometry(replace(DRIVER, tip_relief=relief), replace(DRIVEN, tip_relief=relief))
    position = np.linspace(0.0, pair.contact_ratio, 97)
    tip = DRIVER.roll_angle(DRIVER.tip_radius)
    expected = sum(
        1e-5 * np.maximum(0.0, (roll - start * DEGREE) / (tip - start * DEGREE))
        for roll in (pair.driver_roll_angle(position), pair.driven_roll_angle(position))
    )
    np.testing.assert_allclose(pair_deviation(pair, 0.0, pair.contact_ratio)(position), expected, atol=1e-18)


def test_pair_forces_sum_to_the_kernels_force() -> None:
    phases = np.linspace(0.0, 1.0, 31)
    forces = CONTACT.pair_forces(phases, np.full(31, 3e-5))
    total = tooth_force_history(phases, np.full(31, 3e-5), np.zeros(31), *CONTACT.kernel_arguments)[:, 0]
    np.testing.assert_allclose(forces.sum(axis=1), total, rtol=1e-12)


def test_equivalent_mass_and_damping() -> None:
    # Two equal discs on equal base circles: half of J / R^2.
    assert equivalent_mass(2e-3, 2e-3, 0.05, 0.05) == pytest.approx(0.5 * 2e-3 / 0.05**2)
    # A huge wheel stands still: the pinion's own J / R^2.
    assert equivalent_mass(2e-3, 1e9, 0.05, 0.1) == pytest.approx(2e-3 / 0.05**2, rel=1e-9)
    assert mesh_damping(0.05, 4e8, 0.25) == pytest.approx(2.0 * 0.05 * 1e4)
    with pytest.raises(GearError, match="equivalent mass"):
        equivalent_mass(0.0, 1.0, 1.0, 1.0)
    with pytest.raises(GearError, match="mesh damping"):
        mesh_damping(-0.1, 1.0, 1.0)


def test_runout_of_an_eccentric_driver_pushes_once_per_turn() -> None:
    # Offset along the line of action: the gear stands forward by it, so the compression gains it.
    eccentric = replace(DRIVER, eccentricity=1e-5, eccentricity_phase=0.4)
    angle = np.linspace(0.0, 2.0 * math.pi, 9)
    error = runout_error(eccentric, DRIVEN, 0.4, angle, -angle)
    np.testing.assert_allclose(error, -1e-5 * np.cos(angle), atol=1e-20)
    np.testing.assert_allclose(runout_error(DRIVEN, eccentric, 0.4, -angle, angle), -error, atol=1e-20)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"contact_ratio": 0.9}, "contact_ratio must be at least 1"),
        ({"contact_ratio": 1.7}, "stiffness must cover 0 to 1.7"),
        ({"damping": -1.0}, "damping must be at least 0"),
        ({"deviation": piecewise.constant(0.0, 1.0)}, "deviation must cover"),
        ({"stiffness": piecewise.constant(-1.0, PAIR.contact_ratio)}, "must be positive"),
        ({"pair_variants": np.array([0, 1])}, "pair_variants must be 0 to 0, got 1"),
    ],
)
def test_malformed_contacts_say_what_is_wrong(changes: dict[str, object], words: str) -> None:
    with pytest.raises(GearError, match=words):
        replace(CONTACT, **changes)


def test_the_package_loads_without_a_compiler() -> None:
    check = "import sys, coupling.gears; sys.exit(bool({'numba', 'gmsh', 'vtk', 'matplotlib'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", check], check=False).returncode == 0


def test_damping_fades_in_over_its_depth() -> None:
    depth, rate, phase = 4e-6, 0.03, 0.8  # one pair in contact, beyond the reliefs
    fading = CONTACT.with_damping(CONTACT.damping, depth).kernel_arguments
    elastic = CONTACT.with_damping(0.0).kernel_arguments
    gap = float(CONTACT.pairs(phase).deviation.min())
    for part, share in ((0.0, 0.0), (1e-9, 1e-9), (0.25, 0.25), (1.0, 1.0), (3.0, 1.0)):
        delta = gap + part * depth
        viscous = tooth_force(phase, delta, rate, *fading)[0] - tooth_force(phase, delta, rate, *elastic)[0]
        assert viscous == pytest.approx(share * CONTACT.damping * rate, rel=1e-6, abs=1e-9)
    # Its tangent while it fades.
    delta, step = gap + 0.4 * depth, 1e-11
    _, tangent, damping, *_ = tooth_force(phase, delta, rate, *fading)
    ahead, behind = (tooth_force(phase, delta + side * step, rate, *fading)[0] for side in (1.0, -1.0))
    assert tangent == pytest.approx((ahead - behind) / (2 * step), rel=1e-4)
    assert damping == pytest.approx(0.4 * CONTACT.damping)
