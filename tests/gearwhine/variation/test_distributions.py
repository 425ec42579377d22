"""Distributions against scipy's, and correlated points against the closed form of their rank correlation."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from gearwhine.numerics.distributions import (
    Discrete,
    Distribution,
    DistributionError,
    Measured,
    Normal,
    Rayleigh,
    Triangular,
    Uniform,
    correlated,
)
from gearwhine.numerics.sampling import sobol_points

STEPS = np.linspace(0.001, 0.999, 333)


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        (Normal(3.0, 0.5), stats.norm(3.0, 0.5)),
        (Normal(3.0, 0.5, 2.6, 4.5), stats.truncnorm(-0.8, 3.0, 3.0, 0.5)),
        (Normal(0.0, 1.0, 1.5), stats.truncnorm(1.5, math.inf, 0.0, 1.0)),
        (Uniform(-2.0, 5.0), stats.uniform(-2.0, 7.0)),
        (Triangular(1.0, 1.5, 4.0), stats.triang(0.5 / 3.0, 1.0, 3.0)),
        (Triangular(1.0, 1.0, 4.0), stats.triang(0.0, 1.0, 3.0)),
        (Rayleigh(2.0), stats.rayleigh(0.0, 2.0)),
    ],
)
def test_quantiles_are_those_of_the_textbook(ours: Distribution, theirs: stats.rv_continuous) -> None:
    assert np.allclose(ours.quantile(STEPS), theirs.ppf(STEPS), rtol=1e-10, atol=1e-10)


def test_a_cut_rayleigh_distribution_has_the_whole_ones_density_inside() -> None:
    whole, inside = stats.rayleigh(0.0, 2.0), stats.rayleigh(0.0, 2.0).cdf(3.0)
    values = Rayleigh(2.0, 3.0).quantile(STEPS)
    assert np.allclose(whole.cdf(values) / inside, STEPS, atol=1e-12)
    assert values.max() < 3.0


@given(
    st.lists(st.tuples(st.floats(-1e6, 1e6), st.floats(0.1, 10.0)), min_size=1, max_size=8),
    st.floats(1e-9, 1.0 - 1e-9),
)
def test_a_discrete_value_is_the_first_up_to_which_the_weights_reach_the_probability(
    rows: list[tuple[float, float]], probability: float
) -> None:
    values, weights = (list(column) for column in zip(*rows, strict=True))
    found = float(Discrete(values, weights).quantile(np.array([probability]))[0])
    reached = np.cumsum(weights) / np.sum(weights)
    assert found in [value for value, end in zip(values, reached, strict=True) if end >= probability - 1e-12]


def test_discrete_values_come_as_often_as_their_weights() -> None:
    drawn = Discrete([1.0, 2.0, 5.0], [1.0, 2.0, 5.0]).quantile((np.arange(8000) + 0.5) / 8000.0)
    assert [int((drawn == value).sum()) for value in (1.0, 2.0, 5.0)] == [1000, 2000, 5000]


def test_measured_values_are_never_left_and_keep_their_order() -> None:
    law = Measured([4.0, 1.0, 2.0, 2.5])
    assert np.allclose(law.quantile(np.array([1e-12, 1.0 / 3.0, 0.5, 1.0 - 1e-12])), [1.0, 2.0, 2.25, 4.0])


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (lambda: Normal(0.0, 0.0), "above 0"),
        (lambda: Normal(math.nan, 1.0), "finite"),
        (lambda: Normal("1 mm", 1.0), "mean is '1 mm'; expected a finite number"),  # type: ignore[arg-type]
        (lambda: Normal(0.0, 1.0, high=math.nan), "high is nan; expected a finite number"),
        (lambda: Normal(0.0, 1.0, 2.0, 1.0), "above the low end 2"),
        (lambda: Normal(0.0, 1.0, 40.0, 41.0), "near the mean 0"),
        (lambda: Uniform(2.0, 2.0), "above the low end 2"),
        (lambda: Triangular(0.0, 3.0, 2.0), "from 0 to 2"),
        (lambda: Rayleigh(-1.0), "above 0"),
        (lambda: Discrete([]), "one value or more"),
        (lambda: Discrete([1.0], [0.0]), "not all 0"),
        (lambda: Discrete([1.0, 2.0], [-1.0, 2.0]), "at least 0"),
        (lambda: Measured([1.0]), "two values"),
    ],
)
def test_impossible_distributions_are_refused(made: object, said: str) -> None:
    with pytest.raises(DistributionError, match=said):
        made()  # type: ignore[operator]


def test_correlated_points_stay_uniform_and_have_the_rank_correlation_of_normal_scores() -> None:
    """The rank correlation of normal scores correlated by r is 6/π asin(r/2)."""
    matrix = np.array([[1.0, 0.7, 0.0], [0.7, 1.0, -0.4], [0.0, -0.4, 1.0]])
    points = correlated(sobol_points(2**14, 3, 5), matrix)
    found = stats.spearmanr(points).statistic
    assert np.allclose(found, 6.0 / np.pi * np.arcsin(0.5 * matrix), atol=5e-3)
    for column in points.T:
        assert stats.kstest(column, "uniform").statistic < 5e-3


def test_perfect_correlation_is_taken_and_an_impossible_matrix_is_not() -> None:
    first, second = correlated(sobol_points(64, 2, 1), np.ones((2, 2))).T
    assert np.allclose(first, second, atol=1e-12)
    impossible = np.array([[1.0, 0.9, -0.9], [0.9, 1.0, 0.9], [-0.9, 0.9, 1.0]])
    with pytest.raises(DistributionError, match="least eigenvalue"):
        correlated(sobol_points(4, 3, 1), impossible)
