"""Rated life of rolling bearings against ISO 281's equations and factors, worked by hand."""

import math
from dataclasses import replace

import pytest

from gearwhine.rotors.rolling_bearings import (
    BallRow,
    FourPointRow,
    RollerRow,
    RollingBearing,
    RollingState,
    SphericalRollerRow,
    TaperedRollerRow,
    catalogue_bearing,
    dynamic_rating,
    paired,
    rolling_equilibrium,
    spherical_groove,
)
from gearwhine.rotors.rolling_bearings.life import (
    _LARGE_ANGLES,
    _SMALL_ANGLES,
    equivalent_load,
    rated_revolutions,
    reference_revolutions,
)
from gearwhine.rotors.rolling_bearings.rated_life import BearingLife
from gearwhine.rotors.rolling_bearings.ratings import contact_ratings

BALLS = {"count": 9, "ball_diameter": 12.7e-3, "pitch_diameter": 60e-3}


def under(row: BallRow | RollerRow, x: float, z: float = 0.0) -> RollingState:
    return rolling_equilibrium(RollingBearing([row]), [x, 0.0, z, 0.0, 0.0])


def test_a_pure_radial_load_is_the_equivalent_one() -> None:
    """(35100 / 3510)³ = 1000 million revolutions."""
    state = under(BallRow(**BALLS), 3510.0)
    assert equivalent_load(state) == pytest.approx(3510.0)
    assert rated_revolutions(state, 35100.0) == pytest.approx(1e9)


def test_a_bearing_of_the_catalogue_lives_by_the_catalogue_s_rating() -> None:
    """10⁶ (35100 / 3510)³ revolutions at 1000 a minute are 10⁹ / 60000 hours, whatever C the estimated inside has."""
    elements = catalogue_bearing("deep-groove", 35e-3, 80e-3, 21e-3, dynamic=35.1e3, static=19e3)
    assert dynamic_rating(elements.rows[0]) != pytest.approx(35.1e3, rel=0.02)
    life = BearingLife(rolling_equilibrium(elements, [3510.0, 0.0, 0.0, 0.0, 0.0]), 1000.0 * math.pi / 30.0)
    assert life.life == pytest.approx(1e9 / 60e3)
    assert life.rating_from == "case"


def test_loads_over_a_turn_wear_a_bearing_in_turn() -> None:
    """3 kN and 6 kN by turns: 10⁶ (C/P)^p revolutions with P^p = (3^p + 6^p)/2 (kN); none of a load without factors."""
    for row, power in ((BallRow(**BALLS), 3.0), (RollerRow(14, 11e-3, 11e-3, 65e-3), 10.0 / 3.0)):
        states = tuple(under(row, load) for load in (3000.0, 6000.0))
        life, alone = BearingLife(states[0], 1.0, states), [BearingLife(state, 1.0) for state in states]
        mean = (0.5 * (3000.0**power + 6000.0**power)) ** (1.0 / power)
        assert life.equivalent_load == pytest.approx(mean)
        assert life.life == pytest.approx(1e6 * (life.rating / mean) ** power * 2.0 * math.pi / 3600.0)
        wear = [1.0 / one.reference_life for one in alone if one.reference_life]
        assert life.reference_life == pytest.approx(2.0 / sum(wear))
    assert BearingLife(under(BallRow(**BALLS), 0.0), 1.0).life == math.inf
    beyond = under(BallRow(**BALLS), 1000.0, 30000.0)
    unlisted = BearingLife(beyond, 1.0, (under(BallRow(**BALLS), 1000.0), beyond))
    assert unlisted.equivalent_load is unlisted.life is None


def test_rollers_have_the_exponent_ten_thirds() -> None:
    state = under(RollerRow(14, 11e-3, 11e-3, 65e-3), 5000.0)
    assert rated_revolutions(state, 50000.0) == pytest.approx(1e6 * 10.0 ** (10.0 / 3.0))


def test_axial_load_of_angular_contact_counts_from_e_on() -> None:
    """At 40°: e = 1.14, X = 0.35, Y = 0.57."""
    row = BallRow(**BALLS, contact_angle=math.radians(40.0))
    assert equivalent_load(under(row, 1000.0, 1100.0)) == pytest.approx(1000.0)
    assert equivalent_load(under(row, 1000.0, 2000.0)) == pytest.approx(0.35 * 1000.0 + 0.57 * 2000.0)


def test_deep_groove_factors_go_with_the_relative_axial_load() -> None:
    """F_a / (Z D_w²) = 0.689 N/mm²: Y = 1.71; half way to 1.03 it is 1.63."""
    row, area = BallRow(**BALLS), 9 * 12.7**2
    for relative, y in ((0.689, 1.71), (0.8595, 1.63)):
        axial = relative * area
        assert equivalent_load(under(row, axial, axial)) == pytest.approx((0.56 + y) * axial, rel=1e-9)


def test_a_spring_s_preload_is_axial_load_too() -> None:
    row = BallRow(**BALLS, contact_angle=math.radians(40.0)).facing(1)
    state = rolling_equilibrium(RollingBearing([row], axial_preload=1500.0), [1000.0, 0.0, 500.0, 0.0, 0.0])
    assert equivalent_load(state) == pytest.approx(0.35 * 1000.0 + 0.57 * 2000.0)


def test_a_contact_angle_of_15_degrees_goes_with_the_relative_axial_load() -> None:
    """F_a / (Z D²) = 1.03 N/mm²: e = 0.46, X = 0.44, Y = 1.23."""
    axial = 1.03 * 9 * 12.7**2
    row = BallRow(**BALLS, contact_angle=math.radians(15.0))
    assert equivalent_load(under(row, axial, axial)) == pytest.approx((0.44 + 1.23) * axial, rel=1e-9)
    assert equivalent_load(under(row, axial / 0.45, axial)) == pytest.approx(axial / 0.45, rel=1e-9)


def test_two_opposed_rows_count_axial_load_from_the_first() -> None:
    """At 25°: e = 0.68, P = F_r + 0.92 F_a up to it, 0.67 F_r + 1.41 F_a beyond."""
    row = BallRow(**BALLS, contact_angle=math.radians(25.0))
    pair = paired(row, "back to back", 20e-3)
    for axial, expected in ((600.0, 1000.0 + 0.92 * 600.0), (800.0, 670.0 + 1.41 * 800.0)):
        state = rolling_equilibrium(pair, [1000.0, 0.0, axial, 0.0, 0.0])
        assert equivalent_load(state) == pytest.approx(expected, rel=1e-9)
    four = FourPointRow(**BALLS, contact_angle=math.radians(25.0))
    state = rolling_equilibrium(RollingBearing([four]), [1000.0, 0.0, 800.0, 0.0, 0.0])
    assert equivalent_load(state) == pytest.approx(670.0 + 1.41 * 800.0, rel=1e-9)


def test_a_displaced_ring_presses_no_rows_against_each_other() -> None:
    """Offsets of 10 µm towards one row and away from the other: the factors of two opposed rows, as without them."""
    row = BallRow(**BALLS, contact_angle=math.radians(25.0))
    rows = [replace(one, axial_offset=one.direction * 1e-5) for one in paired(row, "back to back", 20e-3).rows]
    state = rolling_equilibrium(RollingBearing(rows), [1000.0, 0.0, 500.0, 0.0, 0.0])
    assert equivalent_load(state) == pytest.approx(1000.0 + 0.92 * 500.0)


def test_two_rows_are_rated_as_one_of_2_to_the_0_7() -> None:
    """Table 3 carries i^0.7 = 1.62 of the second row in its factors: X and Y of two rows are so much those of one."""
    for entries in _LARGE_ANGLES.values():
        _, x, y, _, x_two, y_two = entries
        assert x_two / x == pytest.approx(2.0**0.7, rel=0.02)
        assert y_two / y == pytest.approx(2.0**0.7, rel=0.02)
    for angle in (10.0, 15.0):
        _, x, y_all, _, x_two, y_two_all = _SMALL_ANGLES[angle]
        assert x_two / x == pytest.approx(2.0**0.7, rel=0.02)
        for one, two in zip(y_all, y_two_all, strict=True):
            assert two / one == pytest.approx(2.0**0.7, rel=0.02)
    # Contacts are rated alike whether their row stands alone or beside another; rows of rollers count to the 7/9.
    for row, power in ((BallRow(9, 8e-3, 40e-3), 0.7), (RollerRow(12, 8e-3, 8e-3, 40e-3), 7.0 / 9.0)):
        assert dynamic_rating(row, 2) == pytest.approx(2.0**power * dynamic_rating(row), rel=1e-12)
        both = contact_ratings(row, 2.0**power * 1e4, 2)
        assert both == pytest.approx(contact_ratings(row, 1e4), rel=1e-12)


def test_tapered_rollers_have_the_factors_of_their_angle() -> None:
    """e = 1.5 tan α, X = 0.4, Y = 0.4 cot α of one row; 0.67 and 0.67 cot α of two."""
    angle = math.radians(14.0)
    row = TaperedRollerRow(17, 9e-3, 14e-3, 61e-3, angle=angle)
    state = rolling_equilibrium(RollingBearing([row]), [4000.0, 0.0, 3000.0, 0.0, 0.0])
    assert equivalent_load(state) == pytest.approx(1600.0 + 1200.0 / math.tan(angle))
    spherical = SphericalRollerRow(17, 9e-3, 9e-3, 61e-3, angle=angle)
    both = RollingBearing([spherical.facing(1), spherical.facing(-1)])
    state = rolling_equilibrium(both, [4000.0, 0.0, 800.0, 0.0, 0.0])
    assert equivalent_load(state) == pytest.approx(4000.0 + 0.45 * 800.0 / math.tan(angle))
    balls = BallRow(14, 8e-3, 45e-3, 0.2, outer_groove=spherical_groove(8e-3, 45e-3, 0.2))
    aligning = paired(balls, "face to face", 45e-3 * math.tan(0.2))
    state = rolling_equilibrium(aligning, [500.0, 0.0, 300.0, 0.0, 0.0])
    assert equivalent_load(state) == pytest.approx(0.65 * 500.0 + 0.65 * 300.0 / math.tan(0.2))


def test_half_a_loaded_circle_of_balls_has_the_life_of_iso_281() -> None:
    """0.407 = J_r/J_1 and 0.389 = J_r/J_2 make L10r = (C/P)³ of many balls without clearance.

    The standard's digits leave half a per cent, thrice in the life.
    """
    row = BallRow(200, 0.5e-3, 60e-3)
    state = under(row, 300.0)
    assert reference_revolutions(state, 3000.0) == pytest.approx(1e9, rel=5e-3)
    own = dynamic_rating(row)
    assert reference_revolutions(state) == pytest.approx(reference_revolutions(state, own))


def test_a_turning_outer_ring_has_the_mean_load_of_the_ring_that_turns() -> None:
    """Sjövall's means of the rings change places: J_2/J_1 = 0.407/0.389 of balls, 0.378/0.364 of rollers.

    With the parts 1/(1 + T) and T/(1 + T) of the rings in the sum of ISO/TS 16281, j = J_2/J_1 and the powers p of Q_c
    and r of the sum, the life is [(j^p + T j^-p)/(1 + T)]^-r of that with a turning inner ring.
    """
    balls = 1.044 * (59.5 / 60.5) ** 1.72 * (0.52 / 0.53 * 0.06 / 0.04) ** 0.41
    rollers = 1.038 * (57.0 / 63.0) ** (143.0 / 108.0)
    rows: list[tuple[BallRow | RollerRow, float, float, float, float]] = [
        (BallRow(200, 0.5e-3, 60e-3), balls, 0.407 / 0.389, 10.0 / 3.0, 0.9),
        (RollerRow(60, 3e-3, 7e-3, 60e-3), rollers, 0.378 / 0.364, 4.5, 8.0 / 9.0),
    ]
    for row, ratio, j, power, root in rows:
        lives = [
            reference_revolutions(
                rolling_equilibrium(RollingBearing([one]), [300.0, 0, 0, 0, 0], held={"rx": 0.0, "ry": 0.0}), 3000.0
            )
            for one in (row, replace(row, outer_turns=True))
        ]
        t = ratio**power
        expected = ((j**power + t * j**-power) / (1.0 + t)) ** -root
        assert abs(expected - 1.0) > 0.02
        assert lives[1] / lives[0] == pytest.approx(expected, rel=3e-3)


def test_clearance_and_preload_cost_life() -> None:
    row = BallRow(**BALLS)
    exact = reference_revolutions(under(row, 3000.0), 35100.0)
    loose = reference_revolutions(under(replace(row, clearance=60e-6), 3000.0), 35100.0)
    tight = reference_revolutions(under(replace(row, clearance=-30e-6), 3000.0), 35100.0)
    assert loose < 0.8 * exact
    assert tight < exact
    assert reference_revolutions(under(replace(row, clearance=1e-6), 0.0), 35100.0) == math.inf


def test_even_slices_have_the_closed_form_of_rollers() -> None:
    """L10r = (λν)⁻⁴ (mean f^4.5)^(−8/9) (C/P)⁴ of many straight rollers in line, half of them loaded.

    0.378 and 0.364 are J_r/J_1 and J_r/J_2 of line contacts, whose digits leave 2 % in the life; the f_k are written
    out.
    """
    row = RollerRow(200, 0.5e-3, 7e-3, 60e-3, profile="straight", slices=31)
    state = rolling_equilibrium(RollingBearing([row]), [400.0, 0.0, 0.0, 0.0, 0.0], held={"rx": 0.0, "ry": 0.0})
    parts = [abs(2 * k - 32) / 60 for k in range(1, 32)]
    mean = sum((1.0 if part == 0.0 else 1.0 - 0.01 / math.log(1.985 * part)) ** 4.5 for part in parts) / 31
    expected = 0.83**-4 * mean ** (-8.0 / 9.0) * (4000.0 / 400.0) ** 4
    assert reference_revolutions(state, 4000.0) == pytest.approx(1e6 * expected, rel=2e-2)


def test_tilt_costs_rollers_life() -> None:
    bearing = RollingBearing([RollerRow(14, 11e-3, 11e-3, 65e-3)])
    lives = [
        reference_revolutions(rolling_equilibrium(bearing, [5000.0, 0, 0, 0, 0], held={"rx": 0.0, "ry": tilt}), 5e4)
        for tilt in (0.0, 0.5e-3, 1e-3)
    ]
    assert lives[0] > lives[1] > lives[2]


def test_thrust_on_four_point_balls_wears_one_diagonal() -> None:
    """As the one row of angular contact that the other diagonal leaves, in a bearing of two."""
    row = FourPointRow(**BALLS, contact_angle=math.radians(35.0))
    four = rolling_equilibrium(RollingBearing([row]), [0.0, 0.0, 3000.0, 0.0, 0.0])
    one, other = row.arcs
    pair = rolling_equilibrium(RollingBearing([one, other]), [0.0, 0.0, 3000.0, 0.0, 0.0])
    assert reference_revolutions(four, 40000.0) == pytest.approx(reference_revolutions(pair, 40000.0), rel=1e-6)


def test_what_the_table_does_not_hold_has_no_life() -> None:
    steep = BallRow(**BALLS, contact_angle=math.radians(50.0))
    assert rated_revolutions(under(steep, 1000.0, 1500.0), 35100.0) is None
    two = paired(BallRow(**BALLS, contact_angle=math.radians(40.0)), "back to back", 20e-3, preload=400.0)
    assert equivalent_load(rolling_equilibrium(two, [1000.0, 0.0, 0.0, 0.0, 0.0])) is None
    too_much = 7.0 * 9 * 12.7**2
    assert equivalent_load(under(BallRow(**BALLS), 0.0, too_much)) is None
