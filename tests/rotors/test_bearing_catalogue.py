"""Insides estimated from main dimensions and ratings, and characteristic frequencies of rows."""

import math

import numpy as np
import pytest

from gearwhine.rotors import RotorError
from gearwhine.rotors.rolling_bearings import (
    BallRow,
    FourPointRow,
    TaperedRollerRow,
    catalogue_bearing,
    catalogue_row,
    characteristic_frequencies,
    dynamic_rating,
    rolling_equilibrium,
    static_rating,
)

SIZE = (30e-3, 62e-3, 17.25e-3)


@pytest.mark.parametrize(
    "kind", ["deep-groove", "angular-contact", "four-point", "cylindrical-roller", "tapered-roller"]
)
def test_ratings_that_are_given_are_met(kind: str) -> None:
    """C₀ exactly; C alone exactly; the count of balls follows C where the usual one is more than 10 % from it."""
    usual = catalogue_row(kind, *SIZE)  # type: ignore[arg-type]
    for factor in (0.9, 1.15):
        static = catalogue_row(kind, *SIZE, static=factor * static_rating(usual))  # type: ignore[arg-type]
        assert static_rating(static) == pytest.approx(factor * static_rating(usual), rel=1e-9)
        dynamic = catalogue_row(kind, *SIZE, dynamic=factor * dynamic_rating(usual))  # type: ignore[arg-type]
        assert dynamic_rating(dynamic) == pytest.approx(factor * dynamic_rating(usual), rel=1e-9)
        assert dynamic.count == static.count == usual.count
        assert dynamic.estimated
    both = catalogue_row(kind, *SIZE, static=static_rating(usual), dynamic=1.05 * dynamic_rating(usual))  # type: ignore[arg-type]
    assert both.count == usual.count


def test_ratings_of_a_pair_are_those_of_its_equal_rows() -> None:
    """C₀ of two is twice that of one (ISO 76), C of two rows of balls 2^0.7 times that of one (ISO 281)."""
    usual = catalogue_row("angular-contact", *SIZE)
    assert isinstance(usual, BallRow)
    fewer = BallRow(usual.count - 2, 1.2 * usual.ball_diameter, usual.pitch_diameter, usual.contact_angle)
    ratings = {"static": static_rating(fewer), "dynamic": dynamic_rating(fewer)}
    one = catalogue_row("angular-contact", *SIZE, **ratings)
    ratings = {"static": 2.0 * ratings["static"], "dynamic": 2.0**0.7 * ratings["dynamic"]}
    assert catalogue_row("angular-contact", *SIZE, **ratings, bearings=2) == one


def test_balls_are_counted_by_both_ratings() -> None:
    """Built with one ball less and larger, and recovered from its two ratings where they tell it apart."""
    usual = catalogue_row("angular-contact", *SIZE)
    assert isinstance(usual, BallRow)
    larger = BallRow(usual.count - 2, 1.2 * usual.ball_diameter, usual.pitch_diameter, usual.contact_angle)
    found = catalogue_row("angular-contact", *SIZE, static=static_rating(larger), dynamic=1.1 * dynamic_rating(larger))
    assert isinstance(found, BallRow)
    assert found.count == larger.count
    assert found.ball_diameter == pytest.approx(larger.ball_diameter, rel=1e-9)


@pytest.mark.parametrize(
    "kind", ["spherical-roller", "self-aligning-ball", "double-row-angular-contact", "tapered-roller", "four-point"]
)
def test_a_whole_bearing_carries_load(kind: str) -> None:
    bearing = catalogue_bearing(kind, 40e-3, 80e-3, 30e-3)  # type: ignore[arg-type]
    assert bearing.estimated
    assert len(bearing.rows) == (1 if kind in ("tapered-roller", "four-point") else 2)
    state = rolling_equilibrium(bearing, [1000.0, 0.0, 800.0, 0.0, 0.0], held={"rx": 0.0, "ry": 0.0})
    if len(bearing.rows) == 2:
        assert {row.direction for row in bearing.rows} == {1, -1}
    assert (state.loose == ("rx", "ry")) == (kind == "spherical-roller")
    if kind in ("spherical-roller", "self-aligning-ball"):
        # The centre of the contact lines has moved with the ring.
        assert abs(state.load[4]) <= np.linalg.norm(state.displacement[:3]) * np.linalg.norm(state.load[:3])


def test_impossible_catalogues_are_named() -> None:
    with pytest.raises(RotorError, match="type of bearing is 'needle'; expected one of 'deep-groove'"):
        catalogue_row("needle", *SIZE)  # type: ignore[arg-type]
    with pytest.raises(RotorError, match=r"contact angle of a deep-groove bearing is 0.3; expected none"):
        catalogue_row("deep-groove", *SIZE, contact_angle=0.3)
    with pytest.raises(RotorError, match=r"static rating of a deep-groove bearing of 30 × 62 × 17.25 mm is 100000 N"):
        catalogue_row("deep-groove", *SIZE, static=1e5)
    with pytest.raises(RotorError, match=r"static rating of a tapered-roller .* expected about 4.39e\+04 N"):
        catalogue_row("tapered-roller", *SIZE, static=9e4)
    with pytest.raises(RotorError, match=r"dynamic rating is -1\.0"):
        catalogue_row("deep-groove", *SIZE, dynamic=-1.0)
    assert isinstance(catalogue_row("four-point", *SIZE), FourPointRow)


def test_rolling_without_sliding_has_these_frequencies() -> None:
    """Velocities of the raceways at the contacts, with rings that both turn, and the cage's as their mean."""
    row, inner, outer = BallRow(9, 12e-3, 60e-3, math.radians(25.0)), 100.0, -30.0
    found = characteristic_frequencies(row, inner, outer_speed=outer)
    arm = 0.5 * 12e-3 * math.cos(math.radians(25.0))
    inside, outside = inner * (30e-3 - arm), outer * (30e-3 + arm)
    assert found.cage == pytest.approx(0.5 * (inside + outside) / 30e-3)
    assert found.outer_pass == pytest.approx(9 * abs(found.cage - outer))
    assert found.inner_pass == pytest.approx(9 * abs(inner - found.cage))
    # In the cage's frame the inner raceway runs over the ball, whose surface there is 12 mm / 2 from its axis.
    assert found.spin == pytest.approx(abs(inner - found.cage) * (30e-3 - arm) / 6e-3)
    assert found.outer_pass + found.inner_pass == pytest.approx(9 * 130.0)
    assert list(found.named()) == ["cage", "outer raceway", "inner raceway", "rolling element"]


def test_cage_speed_is_the_cage_s_frequency() -> None:
    for row in (BallRow(9, 12e-3, 60e-3, 0.4), TaperedRollerRow(17, 9e-3, 14e-3, 61e-3, angle=0.25)):
        assert characteristic_frequencies(row, -250.0).cage == pytest.approx(row.cage_speed(-250.0))


def test_a_tapered_roller_rolls_about_the_apex_of_all_cones() -> None:
    """Speeds of cone and cup at the contact lines' middles, by their distances from the bearing's axis."""
    row, speed = TaperedRollerRow(17, 9e-3, 14e-3, 61e-3, angle=0.25), 100.0
    axis = row.angle - row.roller_angle
    inside, outside = (30.5e-3 + side * 4.5e-3 * math.cos(axis) for side in (-1.0, 1.0))
    cage = speed * inside / (inside + outside)
    assert characteristic_frequencies(row, speed).outer_pass == pytest.approx(17 * cage, rel=1e-12)
