"""Sobol' indices of functions whose indices are known in closed form."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.numerics.sampling import MOST_POINTS, index_points, sobol_points
from gearwhine.numerics.sobol_indices import sobol_indices

FloatArray = npt.NDArray[np.float64]


def _each(count: int) -> tuple[tuple[int, ...], ...]:
    return tuple((number,) for number in range(count))


def _ishigami(u: FloatArray) -> FloatArray:
    x = np.pi * (2.0 * u - 1.0)
    return np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def _ishigami_indices() -> tuple[FloatArray, FloatArray]:
    """Ishigami & Homma (1990), a = 7, b = 0.1: parts of the variance."""
    a, b = 7.0, 0.1
    first = 0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2
    second, together = a**2 / 8.0, b**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    whole = first + second + together
    return np.array([first, second, 0.0]) / whole, np.array([first + together, second, together]) / whole


_G = np.array([0.0, 1.0, 4.5, 9.0, 99.0])


def _g_function(u: FloatArray) -> FloatArray:
    return np.asarray(np.prod((np.abs(4.0 * u - 2.0) + _G) / (1.0 + _G), axis=1))


def _g_indices() -> tuple[FloatArray, FloatArray]:
    """Sobol's g-function: V_i = 1 / (3 (1 + a_i)²), V = Π (1 + V_i) - 1."""
    own = 1.0 / (3.0 * (1.0 + _G) ** 2)
    whole = np.prod(1.0 + own) - 1.0
    total = own * np.array([np.prod(np.delete(1.0 + own, number)) for number in range(len(own))])
    return own / whole, total / whole


@pytest.mark.parametrize(
    ("function", "expected"), [(_ishigami, _ishigami_indices()), (_g_function, _g_indices())], ids=["ishigami", "g"]
)
def test_indices_of_known_functions_are_within_their_intervals(
    function: Callable[[FloatArray], FloatArray], expected: tuple[FloatArray, FloatArray]
) -> None:
    design = index_points(2**12, _each(len(expected[0])), 1)
    found = sobol_indices(design, function(design.points))
    assert found is not None
    for index, interval, known in zip(
        (found.first, found.total), (found.first_interval, found.total_interval), expected, strict=True
    ):
        assert np.all((interval[:, 0] <= known) & (known <= interval[:, 1]))
        assert np.abs(index - known).max() < 0.02
        assert np.ptp(interval, axis=1).max() < 0.2


def test_intervals_hold_the_index_as_often_as_they_say() -> None:
    """A sum of three inputs: first and total are alike, 1/14, 4/14 and 9/14."""
    known, held = np.array([1.0, 4.0, 9.0]) / 14.0, []
    for seed in range(60):
        design = index_points(64, _each(3), seed)
        found = sobol_indices(design, (2.0 * design.points - 1.0) @ [1.0, 2.0, 3.0], seed=seed)
        assert found is not None
        held.append((found.total_interval[:, 0] <= known) & (known <= found.total_interval[:, 1]))
    assert np.mean(held) > 0.9


def test_an_input_of_two_coordinates_has_the_part_of_both() -> None:
    design = index_points(2**11, ((0, 1), (2,)), 3)
    found = sobol_indices(design, (2.0 * design.points - 1.0) @ [1.0, 2.0, 3.0])
    assert found is not None
    assert np.allclose(found.total, np.array([5.0, 9.0]) / 14.0, atol=0.03)


def test_rows_with_a_missing_value_are_left_out_and_nothing_is_told_of_what_does_not_vary() -> None:
    design = index_points(256, _each(2), 1)
    values = design.points @ np.array([1.0, 2.0])
    part = values.copy()
    part[5] = np.nan
    found = sobol_indices(design, part)
    assert found is not None
    assert found.rows == 255
    assert sobol_indices(design, np.ones_like(values)) is None
    assert sobol_indices(design, np.full_like(values, np.nan)) is None


def test_a_sequence_goes_on_where_a_shorter_one_ends_and_another_seed_is_another() -> None:
    assert np.array_equal(sobol_points(100, 4, 7)[:30], sobol_points(30, 4, 7))
    assert np.array_equal(index_points(20, _each(2), 7).points[:40], index_points(10, _each(2), 7).points)
    assert not np.array_equal(sobol_points(30, 4, 7), sobol_points(30, 4, 8))
    points = sobol_points(2**12, 4, 7)
    assert points.min() >= 0.5 / MOST_POINTS
    assert points.max() < 1.0
    # Each power of two fills equal cells alike, which random points do not.
    assert np.array_equal(np.bincount((points[:, 1] * 64).astype(int)), np.full(64, 64))
