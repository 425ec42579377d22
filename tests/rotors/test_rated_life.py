"""Rated life of rolling bearings against ISO 281's equations and factors, worked by hand."""

import math

import pytest

from rotors.rolling_bearings import BallRow, RollerRow, RollingBearing, RollingState, paired, rolling_equilibrium
from rotors.rolling_bearings.life import equivalent_load, rated_revolutions

BALLS = {"count": 9, "ball_diameter": 12.7e-3, "pitch_diameter": 60e-3}


def under(row: BallRow | RollerRow, x: float, z: float = 0.0) -> RollingState:
    return rolling_equilibrium(RollingBearing([row]), [x, 0.0, z, 0.0, 0.0])


def test_a_pure_radial_load_is_the_equivalent_one() -> None:
    """(35100 / 3510)³ = 1000 million revolutions."""
    state = under(BallRow(**BALLS), 3510.0)
    assert equivalent_load(state) == pytest.approx(3510.0)
    assert rated_revolutions(state, 35100.0) == pytest.approx(1e9)


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


def test_what_the_table_does_not_hold_has_no_life() -> None:
    steep = BallRow(**BALLS, contact_angle=math.radians(15.0))
    assert rated_revolutions(under(steep, 1000.0, 500.0), 35100.0) is None
    two = paired(BallRow(**BALLS, contact_angle=math.radians(40.0)), "back to back", 20e-3, preload=400.0)
    assert equivalent_load(rolling_equilibrium(two, [1000.0, 0.0, 0.0, 0.0, 0.0])) is None
    too_much = 7.0 * 9 * 12.7**2
    assert equivalent_load(under(BallRow(**BALLS), 0.0, too_much)) is None
