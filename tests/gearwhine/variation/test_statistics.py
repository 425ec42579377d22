"""Parts of the variance that samples explain, of functions whose parts are known in closed form."""

from collections.abc import Callable

import numpy as np
import pytest

from gearwhine.case.variation import Limit
from gearwhine.figures.variation import _distributions
from gearwhine.numerics.sampling import sobol_points
from gearwhine.variation.statistics import QuantityStatistics, Share


def _statistics(values: np.ndarray, inputs: np.ndarray, limit: Limit | None = None) -> QuantityStatistics:
    names = tuple(f"input {number}" for number in range(inputs.shape[1]))
    return QuantityStatistics("a.b_m", float(values[0]), values, inputs, names, None, limit)


def test_what_rises_on_both_sides_is_seen_where_a_rank_correlation_is_blind() -> None:
    """|x + y| of two uniform parts from -1 to 1: each alone has (1/45) / (2/9) of the variance."""
    x = 2.0 * sobol_points(2048, 3, 1) - 1.0
    found = _statistics(np.abs(x[:, 0] + x[:, 1]), x)
    assert set(found.explained) == {"input 0", "input 1"}
    assert list(found.explained.values()) == pytest.approx([0.1, 0.1], abs=0.02)
    assert all(abs(value) < 0.05 for value in found.rank_correlations.values())


def test_a_sum_is_split_by_the_variances_of_its_parts() -> None:
    x = sobol_points(1024, 3, 2)
    found = _statistics(x @ np.array([3.0, 4.0, 0.0]), x)
    assert found.explained["input 0"] == pytest.approx(9.0 / 25.0, abs=0.02)
    assert found.explained["input 1"] == pytest.approx(16.0 / 25.0, abs=0.02)
    assert found.importance() == found.explained


@pytest.mark.parametrize("rises_on", [abs, float], ids=["both sides", "one side"])
def test_coordinates_that_follow_each_other_share_no_part(rises_on: Callable[[float], float]) -> None:
    """32 points of a Sobol' sequence: quarters of its coordinates coincide, and one alone makes the quantity."""
    x = 2.0 * sobol_points(32, 19, 0) - 1.0
    for cause in range(19):
        noise = 0.05 * np.random.default_rng(cause).normal(size=32)
        found = _statistics(np.array([rises_on(value) for value in x[:, cause]]) + noise, x)
        assert max(found.explained, key=lambda name: found.explained[name]) == f"input {cause}"
        assert found.explained[f"input {cause}"] > 0.9
        assert sum(found.explained.values()) <= 1.0


def test_a_part_of_few_samples_has_no_bias_and_a_small_one_stands_beside_a_large_one() -> None:
    """10 x + 2 y with uniform x and y: 25/26 and 1/26; x + y: a half."""
    x = sobol_points(64, 2, 1)
    assert _statistics(x @ np.array([10.0, 2.0]), x).explained["input 1"] == pytest.approx(1.0 / 26.0, abs=0.01)
    rng = np.random.default_rng(1)
    halves = [_statistics(draw.sum(axis=1), draw[:, :1]).explained["input 0"] for draw in rng.random((400, 96, 2))]
    assert np.mean(halves) == pytest.approx(0.5, abs=0.01)


def test_chance_is_hardly_ever_told() -> None:
    rng = np.random.default_rng(4)
    told = sum(len(_statistics(rng.normal(size=64), rng.normal(size=(64, 5))).explained) for _ in range(200))
    # One in a thousand of a thousand.
    assert told < 6


def test_few_samples_or_no_scatter_tell_nothing() -> None:
    x = sobol_points(16, 2, 1)
    assert _statistics(x[:, 0], x).explained == {}
    assert _statistics(np.ones(64), sobol_points(64, 2, 1)).explained == {}
    words = np.array([0.0, 1.0] * 32)
    assert _statistics(words + 0.1 * sobol_points(64, 1, 1)[:, 0], words[:, None]).explained["input 0"] > 0.9


def test_a_share_has_the_exact_interval_of_a_binomial() -> None:
    """9 of 10: 55.5 to 99.7 % (Clopper and Pearson)."""
    share = Share.of(9, 10)
    assert (share.share, share.low, share.high) == pytest.approx((0.9, 0.555, 0.9975), abs=5e-4)
    values = np.array([1.0, 2.0, 3.0, np.nan])
    limited = _statistics(values, np.zeros((4, 1)), Limit(at_least=2.0)).share
    assert limited is not None
    assert limited.share == pytest.approx(2.0 / 3.0)
    assert _statistics(values, np.zeros((4, 1)), Limit(at_least=2.0)).worst == [0, 1, 2]
    assert _statistics(values, np.zeros((4, 1)), Limit(at_most=2.0)).worst == [2, 1, 0]


def test_scatter_by_rounding_has_no_cause_and_one_bar() -> None:
    """A quantity that no input changes, but for the last digits of each solution."""
    x = sobol_points(64, 2, 1)
    found = _statistics(1e-6 * (1.0 + 1e-15 * np.round(3.0 * x[:, 0])), x)
    assert np.ptp(found.values) > 0.0
    assert not found.scatters
    assert found.rank_correlations == found.explained == {}
    figure = _distributions("a case", [found])
    assert [len(axes.patches) for axes in figure.axes] == [1]
    assert _statistics(1e-6 * (1.0 + 1e-7 * x[:, 0]), x).explained["input 0"] > 0.9
