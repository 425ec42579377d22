"""The contact law: kernels against the law written out, tip relief, events, damping."""

import math
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from gearwhine.coupling.gears import (
    ConstantStiffness,
    Gear,
    GearError,
    GearPairGeometry,
    PotentialEnergyStiffness,
    SquareStiffness,
    TableStiffness,
    TipRelief,
    ToothContact,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.contact.tooth_force_kernels import ranked_penetration, tooth_force, tooth_force_history
from gearwhine.coupling.gears.contact.tooth_pair import pair_deviation
from gearwhine.coupling.gears.loaded.gear_pair import equivalent_mass, mesh_damping

ALPHA = math.radians(20.0)
DEGREE = math.radians(1.0)
DRIVER = Gear("pinion", 28, 3.175e-3, ALPHA, 6.35e-3, tip_relief=TipRelief(0.023e-3, 24.0 * DEGREE))
DRIVEN = replace(DRIVER, name="wheel", tip_relief=TipRelief(0.025e-3, 24.0 * DEGREE))
PAIR = GearPairGeometry(DRIVER, DRIVEN)
CONTACT = tooth_contact(PAIR, PotentialEnergyStiffness(), damping=120.0)


def loaded_pairs(alone: np.ndarray, gaps: np.ndarray, delta: float, shared: float) -> tuple[np.ndarray, float, float]:
    """Forces, tangent and energy by the compliance matrix of the pairs: the one set that pushes and is not pushed."""
    compliance = np.full((gaps.size, gaps.size), shared)
    np.fill_diagonal(compliance, 1.0 / alone)
    for size in range(gaps.size, 0, -1):
        for chosen in map(list, combinations(range(gaps.size), size)):
            within = np.ix_(chosen, chosen)
            pushed = np.linalg.solve(compliance[within], delta - gaps[chosen])
            forces = np.zeros(gaps.size)
            forces[chosen] = pushed
            apart = delta - gaps - compliance @ forces <= 1e-18
            if np.all(pushed > 0.0) and np.all(apart | (forces > 0.0)):
                tangent = float(np.linalg.inv(compliance[within]).sum())
                return forces, tangent, float(0.5 * forces @ compliance @ forces)
    return np.zeros(gaps.size), 0.0, 0.0


def test_kernel_is_the_law() -> None:
    rng = np.random.default_rng(11)
    phases, compressions = rng.uniform(-3.0, 5.0, 300), rng.uniform(-1e-5, 6e-5, 300)
    rates = rng.normal(0.0, 0.05, 300)
    history = tooth_force_history(phases, compressions, rates, *CONTACT.kernel_arguments)
    for phase, delta, rate, row in zip(phases, compressions, rates, history, strict=True):
        places = [phase % 1.0 + pair for pair in range(3) if phase % 1.0 + pair < PAIR.contact_ratio]
        gaps = np.array([float(CONTACT.deviation(position)) for position in places])
        alone = np.array([float(CONTACT.stiffness(position)) for position in places])
        forces, tangent, energy = loaded_pairs(alone, gaps, delta, CONTACT.shared_compliance)
        touching = int(np.sum(forces > 0.0))
        force = forces.sum() + 120.0 * rate * (touching > 0)
        expected = [force, tangent, 120.0 * (touching > 0), energy]
        # The stiffness behind the shared compliance is a table that is right to 1e-9.
        np.testing.assert_allclose(row[:4], expected, rtol=1e-8, atol=1e-12)
        assert row[5] == touching


@pytest.mark.parametrize("shared", [0.0, 1e-9, 4e-9])
def test_pairs_share_a_compliance_as_one_matrix(shared: float) -> None:
    """Three pairs of a contact ratio of 2.6, their forces by trying every set that may touch."""
    eps = 2.6
    contact = ToothContact(
        eps,
        piecewise.quadratic(1.2e8, 2e8, 1.5e8, eps),
        piecewise.polyline(np.array([0.0, 0.9, eps]), np.array([7e-6, 0.0, 4e-6])),
        shared_compliance=shared,
    )
    phases = np.linspace(0.01, 0.98, 14)
    for delta in (1e-6, 3e-6, 8e-6, 30e-6):
        found = contact.pair_forces(phases, np.full(phases.size, delta))
        for phase, row in zip(phases, found, strict=True):
            places = phase + np.arange(3)
            places = places[places < eps]
            forces, tangent, energy = loaded_pairs(contact.stiffness(places), contact.deviation(places), delta, shared)
            np.testing.assert_allclose(row[: places.size], forces, rtol=1e-7, atol=1e-9)
            law = tooth_force(phase, delta, 0.0, *contact.kernel_arguments)
            np.testing.assert_allclose(law[:2] + law[3:4], [forces.sum(), tangent, energy], rtol=1e-7, atol=1e-14)
            for rank in range(1, 4):
                assert (ranked_penetration(phase, delta, *contact.kernel_arguments, rank) > 0.0) == (law[5] >= rank)
            # Under that load the mesh is back where it was, as soft as the law says.
            if forces.sum() > 0.0:
                mesh = loaded_transmission_error(contact, float(forces.sum()), [phase])
                assert mesh.transmission_error[0] == pytest.approx(delta, rel=1e-8)
                assert mesh.tangent_stiffness[0] == pytest.approx(tangent, rel=1e-7)


def test_a_pair_must_yield_more_than_it_shares() -> None:
    with pytest.raises(GearError, match="cannot share"):
        replace(CONTACT, shared_compliance=1.0 / CONTACT.stiffness.mean)
    with pytest.raises(GearError, match="shared_compliance must be at least 0"):
        replace(CONTACT, shared_compliance=-1e-9)


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
    for event in (contact.back_flank_offset - phase for phase in contact.event_phases):
        before, after = (
            tooth_force(contact.back_flank_offset - phase, 1e-5, 0.0, *contact.kernel_arguments)[5]
            for phase in (event - 1e-6, event + 1e-6)
        )
        assert {before, after} == {1, 2}


def test_square_mesh_with_a_printed_contact_ratio() -> None:
    contact = tooth_contact(PAIR, SquareStiffness(1e8, contact_ratio=1.6))
    assert contact.unloaded_mean_mesh_stiffness == pytest.approx(1.6e8)
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


def test_damping_fades_in_over_its_depth() -> None:
    depth, rate, phase = 4e-6, 0.03, 0.8  # one pair in contact, beyond the reliefs
    fading = CONTACT.with_damping(CONTACT.damping, depth).kernel_arguments
    elastic = CONTACT.with_damping(0.0).kernel_arguments
    gap = float(CONTACT.pairs(phase).deviation.min())
    # The depth is of the flanks that are pressed together, behind what the bodies of the gears take.
    depth_of_mesh = depth / (1.0 - CONTACT.shared_compliance * float(CONTACT.stiffness(phase)))
    for part, share in ((0.0, 0.0), (1e-9, 1e-9), (0.25, 0.25), (1.0, 1.0), (3.0, 1.0)):
        delta = gap + part * depth_of_mesh
        viscous = tooth_force(phase, delta, rate, *fading)[0] - tooth_force(phase, delta, rate, *elastic)[0]
        assert viscous == pytest.approx(share * CONTACT.damping * rate, rel=1e-6, abs=1e-9)
    # Its tangent while it fades.
    delta, step = gap + 0.4 * depth_of_mesh, 1e-11
    _, tangent, damping, *_ = tooth_force(phase, delta, rate, *fading)
    ahead, behind = (tooth_force(phase, delta + side * step, rate, *fading)[0] for side in (1.0, -1.0))
    assert tangent == pytest.approx((ahead - behind) / (2 * step), rel=1e-4)
    assert damping == pytest.approx(0.4 * CONTACT.damping)
