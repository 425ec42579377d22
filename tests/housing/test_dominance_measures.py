"""Strengths of modes by hand."""

import numpy as np
import pytest

from gearwhine.housing.modes.dominance import Dominance, dominance


def test_strength_of_two_modes_by_hand() -> None:
    """Mode 1: seats move (3, 4) and (0, 0), skin (1, 7). Mode 2: at rest at the seats."""
    frequencies = np.array([10.0, 20.0])
    seats = np.array([[[3.0, 4.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 0.0]]])
    skin = np.array([[1.0, -7.0], [2.0, 2.0]])
    strength = dominance(frequencies, seats, skin)
    acceleration = np.sqrt((25.0 + 0.0) / 2) * np.sqrt((1.0 + 49.0) / 2)
    np.testing.assert_allclose(strength.acceleration, [acceleration, 0.0])
    np.testing.assert_allclose(strength.velocity, [acceleration / 10.0, 0.0])
    np.testing.assert_allclose(strength.absolute, [(5 + 0) / 2 * (1 + 7) / 2, 0.0])


def test_rigid_modes_have_no_velocity_strength_rather_than_an_infinite_one() -> None:
    strength = dominance(np.array([0.0]), np.ones((1, 1, 2)), np.ones((1, 1)))
    assert strength.velocity[0] == 0.0
    assert np.isfinite(strength.acceleration).all()


def test_strength_ignores_the_signs_of_the_shapes() -> None:
    generator = np.random.default_rng(6)
    frequencies, seats, skin = (
        np.arange(1.0, 4.0),
        generator.standard_normal((3, 4, 2)),
        generator.standard_normal((3, 9)),
    )
    one, other = dominance(frequencies, seats, skin), dominance(frequencies, -seats, -skin)
    assert np.array_equal(one.acceleration, other.acceleration)
    assert np.array_equal(one.absolute, other.absolute)


def _strengths(**changes: np.ndarray) -> Dominance:
    values = {"acceleration": np.array([5.0, 1.0, 9.0, 4.0, 8.0, 99.0])}
    values |= {"velocity": values["acceleration"], "absolute": values["acceleration"]}
    return Dominance(**(values | changes), frequencies=np.array([10.0, 20.0, 30.0, 40.0, 50.0, 60.0]))


def test_strongest_within_the_band_in_order_of_frequency() -> None:
    strengths = _strengths()
    assert strengths.strongest(3, (10.0, 50.0)).tolist() == [0, 2, 4]
    assert strengths.strongest(3, (15.0, 50.0)).tolist() == [2, 3, 4]
    assert strengths.strongest(9, (15.0, 45.0)).tolist() == [1, 2, 3]
    assert strengths.strongest(2, (70.0, 80.0)).size == 0


def test_gap_is_the_logarithm_of_last_chosen_to_first_left_out() -> None:
    strengths = _strengths()
    assert strengths.gap(3, (10.0, 50.0)) == pytest.approx(np.log(5.0 / 4.0))
    assert strengths.gap(2, (15.0, 50.0)) == pytest.approx(np.log(8.0 / 4.0))
    assert strengths.gap(5, (10.0, 50.0)) == np.inf


def test_measures_agree_only_where_all_three_choose_the_same() -> None:
    assert _strengths().measures_agree(3, (10.0, 50.0))
    swapped = np.array([3.0, 1.0, 9.0, 4.0, 8.0, 99.0])
    assert not _strengths(velocity=swapped).measures_agree(3, (10.0, 50.0))
    assert not _strengths(absolute=swapped).measures_agree(3, (10.0, 50.0))
    assert _strengths(velocity=swapped).measures_agree(2, (10.0, 50.0))
