"""Likeness of shapes, by closed forms: sampled sines, vectors at known angles, integrals of free motions."""

import numpy as np
import pytest
from scipy.spatial.distance import cosine

from gearwhine.housing import HousingError
from gearwhine.housing.correlation import (
    auto_mac,
    largest_off_diagonal,
    modal_assurance_criterion,
    modal_scale_factor,
)

RANDOM = np.random.default_rng(7)


def _beam(modes: list[int], points: int) -> np.ndarray:
    """Bending modes of a uniform beam on two hinges at evenly spaced points within."""
    x = np.arange(1, points + 1) / (points + 1)
    return np.sin(np.pi * np.outer(modes, x))


def test_sampled_sines_are_orthogonal_up_to_the_number_of_points() -> None:
    assert auto_mac(_beam([1, 2, 3, 4, 5, 6, 7], 7)) == pytest.approx(np.eye(7), abs=1e-14)


def test_modes_beyond_it_are_aliases() -> None:
    """sin(π m x) at x = k/8 is -sin(π (16 - m) x): a survey of seven points cannot tell mode 3 from 13."""
    table = modal_assurance_criterion(_beam([3, 4], 7), _beam([12, 13], 7))
    assert table == pytest.approx(np.array([[0.0, 1.0], [1.0, 0.0]]), abs=1e-13)
    assert largest_off_diagonal(auto_mac(_beam([1, 3, 13], 7))) == pytest.approx(1.0)
    assert largest_off_diagonal(np.ones((1, 1))) == 0.0


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 4, 1.2, np.pi / 2])
def test_it_is_the_squared_cosine(angle: float) -> None:
    turned = np.array([np.cos(angle), np.sin(angle)])
    assert modal_assurance_criterion([1.0, 0.0], 1e-9 * turned) == pytest.approx(np.cos(angle) ** 2, abs=1e-15)


def test_a_turned_pair_of_a_square_plate() -> None:
    """Modes (1, 2) and (2, 1) turned by θ within their plane: cos²θ and sin²θ."""
    x, y = np.meshgrid(np.arange(1, 6) / 6, np.arange(1, 6) / 6)
    pair = np.array([np.sin(np.pi * x) * np.sin(2 * np.pi * y), np.sin(2 * np.pi * x) * np.sin(np.pi * y)]).reshape(
        2, -1
    )
    c, s = np.cos(0.4), np.sin(0.4)
    assert modal_assurance_criterion(pair, np.array([[c, s], [-s, c]]) @ pair) == pytest.approx(
        np.array([[c**2, s**2], [s**2, c**2]])
    )


def test_real_shapes_against_scipy_and_complex_ones_against_least_squares() -> None:
    a, b = RANDOM.normal(size=(2, 3, 11))
    independent = [[(1.0 - cosine(one, other)) ** 2 for other in b] for one in a]
    assert modal_assurance_criterion(a, b) == pytest.approx(np.array(independent), rel=1e-12)
    z, w = a + 1j * RANDOM.normal(size=a.shape), b + 1j * RANDOM.normal(size=b.shape)
    for i, one in enumerate(z):
        for j, other in enumerate(w):
            left = np.linalg.lstsq(other[:, None], one, rcond=None)[1][0]
            assert modal_assurance_criterion(z, w)[i, j] == pytest.approx(1.0 - left / np.vdot(one, one).real)


def test_shapes_are_compared_where_both_were_measured() -> None:
    a, b = RANDOM.normal(size=(2, 4, 9))
    gaps = b + 0j
    gaps[0, :3] = np.nan
    gaps[2, 5] = np.nan
    expected = modal_assurance_criterion(a, b)
    expected[:, 0] = modal_assurance_criterion(a[:, 3:], b[0, 3:])[:, 0]
    expected[:, 2] = modal_assurance_criterion(np.delete(a, 5, axis=1), np.delete(b[2], 5))[:, 0]
    assert modal_assurance_criterion(a, gaps) == pytest.approx(expected, rel=1e-12)
    assert modal_assurance_criterion(gaps, a) == pytest.approx(expected.T, rel=1e-12)


def test_sizes_far_apart_neither_overflow_nor_vanish() -> None:
    a = RANDOM.normal(size=(2, 5))
    assert modal_assurance_criterion(1e200 * a, 1e-200 * a) == pytest.approx(auto_mac(a))


def test_a_shape_of_nothing_is_like_nothing() -> None:
    assert modal_assurance_criterion(np.zeros(3), np.ones(3)) == 0.0


def test_shapes_that_share_no_point_are_of_unknown_likeness() -> None:
    table = modal_assurance_criterion([1.0, np.nan], [[1.0, 1.0], [np.nan, 1.0]])
    assert table[0, 0] == 1.0
    assert np.isnan(table[0, 1])
    assert largest_off_diagonal(np.array([[1.0, np.nan], [np.nan, 1.0]])) == 0.0


def test_scale_factors_bring_shapes_together() -> None:
    a = RANDOM.normal(size=(2, 6))
    given = np.array([[2.0j], [-0.1]]) * a
    given[0, 2] = np.nan
    assert modal_scale_factor(a, given) == pytest.approx(np.array([-0.5j, -10.0]))


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        (np.ones((2, 3)), np.ones((2, 4)), "3 degrees of freedom and the second set's 4"),
        (np.ones((1, 2, 2)), np.ones(2), r"\(1, 2, 2\); expected \(modes, degrees of freedom\)"),
        ([[1.0, np.inf]], [1.0, 1.0], "infinite entry"),
        ([[1.0, 1.0], [np.nan, np.nan]], [1.0, 1.0], "shape 2 was measured at no degree"),
    ],
)
def test_sets_that_do_not_fit_are_refused(first, second, message: str) -> None:
    with pytest.raises(HousingError, match=message):
        modal_assurance_criterion(first, second)
