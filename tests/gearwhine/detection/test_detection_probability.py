"""Thresholds and probabilities of detection of values whose distribution is known."""

import math

import numpy as np
import pytest
from scipy import stats

from gearwhine.numerics.detection_probability import (
    DetectionError,
    detection,
    hit_miss,
    least_healthy,
    signal_response,
    threshold,
)

Z = {level: float(stats.norm.ppf(level)) for level in (0.9, 0.95, 0.99)}


def test_thresholds_of_many_known_values_are_their_quantiles() -> None:
    healthy = np.random.default_rng(1).normal(5.0, 2.0, 200_000)
    expected = 5.0 + 2.0 * Z[0.99]
    for law in ("normal", "order"):
        found = threshold(healthy, 0.01, law)
        assert found.value == pytest.approx(expected, abs=0.04)
        assert found.low < expected < found.high
        assert found.false_alarm_low < 0.01 < found.false_alarm_high
    lognormal = threshold(np.exp(healthy[:5000]), 0.01, "log-normal")
    assert math.log(lognormal.value) == pytest.approx(threshold(healthy[:5000], 0.01, "normal").value, rel=1e-12)
    assert lognormal.fits
    assert not threshold(np.exp(healthy[:5000]), 0.01, "normal").fits


def test_the_interval_of_a_normal_threshold_is_that_of_printed_tolerance_factors() -> None:
    """One-sided factors of Natrella (NBS Handbook 91, 1963, table A-7) of 10 and 20 values at 95 %."""
    for count, part, factor in ((10, 0.90, 2.355), (10, 0.99, 3.981), (20, 0.99, 3.295)):
        values = np.random.default_rng(count).normal(size=count)
        bound = stats.nct.ppf(0.95, count - 1, stats.norm.ppf(part) * math.sqrt(count)) / math.sqrt(count)
        assert bound == pytest.approx(factor, abs=2e-3)
        found = threshold(values, 1.0 - part, "normal")
        # The interval of 95 % has its ends at 2.5 and 97.5 %: the factor of 95 % is inside.
        assert found.value < values.mean() + factor * values.std(ddof=1) < found.high


def test_intervals_cover_the_truth_as_often_as_they_say() -> None:
    rng = np.random.default_rng(2)
    draws = rng.normal(size=(700, 30))
    inside = false_alarms = 0
    for values in draws:
        found = threshold(values, 0.05, "normal")
        inside += found.low < Z[0.95] < found.high
        false_alarms += found.false_alarm_low < stats.norm.sf(found.value) < found.false_alarm_high
    assert inside / 700 == pytest.approx(0.95, abs=0.02)
    assert false_alarms / 700 == pytest.approx(0.95, abs=0.02)


@pytest.mark.parametrize("draw", ["normal", "exponential"])
def test_order_statistics_hold_whatever_the_distribution(draw: str) -> None:
    """The k-th highest of n is exceeded with the probability k/(n + 1), of any distribution."""
    rng = np.random.default_rng(3)
    of = {"normal": stats.norm, "exponential": stats.expon}[draw]
    rates, inside, bounded = [], 0, 0
    for values in of.rvs(size=(600, 119), random_state=rng):
        found = threshold(values, 0.05, "order")
        assert found.value == np.sort(values)[-6]
        rates.append(of.sf(found.value))
        inside += found.false_alarm_low < rates[-1] < found.false_alarm_high
        bounded += found.low < of.isf(0.05) < found.high
        assert math.isfinite(found.high)
    assert np.mean(rates) == pytest.approx(6.0 / 120.0, abs=0.003)
    assert inside / 600 == pytest.approx(0.95, abs=0.023)
    # Ranks are whole numbers: the interval of the quantile covers more.
    assert 0.94 < bounded / 600 < 0.995


def test_few_healthy_values_are_refused_with_the_number_that_it_takes() -> None:
    assert least_healthy(0.01, "order") == 99
    assert least_healthy(0.05, "order") == 19
    values = np.random.default_rng(4).normal(size=99)
    assert threshold(values, 0.01, "order").value == values.max()
    for short, law, needed in ((values[:98], "order", "99 or more"), (values[:9], "normal", "10 or more")):
        with pytest.raises(DetectionError, match=needed):
            threshold(short, 0.01, law)
    for odd, law, said in ((np.ones(20), "normal", "scatter"), (values, "log-normal", "positive")):
        with pytest.raises(DetectionError, match=said):
            threshold(odd, 0.01, law)
    with pytest.raises(DetectionError, match="between 0 and"):
        threshold(values, 0.5, "order")


def _linear(count: int, seed: int = 5) -> tuple[np.ndarray, np.ndarray]:
    """Responses 1 + 2 a + 0.5 ε to sizes from 0.5 to 3."""
    sizes = np.tile(np.linspace(0.5, 3.0, 6), count)
    return sizes, 1.0 + 2.0 * sizes + 0.5 * np.random.default_rng(seed).normal(size=sizes.size)


def test_a_linear_response_with_known_noise_has_its_a90() -> None:
    """POD = Φ((1 + 2 a - 4) / 0.5) is 0.9 at a = (3 + 0.5 · 1.2816) / 2."""
    sizes, responses = _linear(20_000)
    line = signal_response(sizes, responses, 4.0, log_size=False)
    a90 = 0.5 * (3.0 + 0.5 * Z[0.9])
    assert line.probability(a90) == pytest.approx(0.9, abs=0.003)
    assert line.probability(1.5) == pytest.approx(0.5, abs=0.005)
    healthy = threshold(np.random.default_rng(6).normal(4.0 - Z[0.99], 1.0, 200_000), 0.01, "normal")
    found = detection(sizes, responses, healthy)
    assert found.method == "signal response"
    assert found.a90 == pytest.approx(a90, abs=0.01)
    assert found.a90_95 == pytest.approx(a90, abs=0.01)
    assert [share.size for share in found.shares] == pytest.approx(np.linspace(0.5, 3.0, 6))
    assert sum(share.total for share in found.shares) == sizes.size


def test_the_bound_of_a_response_is_the_handbooks_for_many_values() -> None:
    """MIL-HDBK-1823A, appendix G: a90/95 = a90 + 1.645 times its deviation, by the delta method from β0, β1 and τ."""
    sizes, responses = _linear(60, seed=7)
    line = signal_response(sizes, responses, 4.0, log_size=False)
    slope, tau, n = float(line.coefficients[1]), line.deviation, sizes.size
    mu, sigma = (4.0 - float(line.coefficients[0])) / slope, tau / slope
    to_mu_sigma = np.array([[-1.0 / slope, -mu / slope, 0.0], [0.0, -sigma / slope, 1.0 / slope]])
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = tau**2 * line.inverse
    covariance[2, 2] = tau**2 / (2.0 * n)
    of_size = to_mu_sigma @ covariance @ to_mu_sigma.T
    weights = np.array([1.0, Z[0.9]])
    handbook = mu + Z[0.9] * sigma + Z[0.95] * math.sqrt(weights @ of_size @ weights)
    assert line.bound(handbook, 0.95) == pytest.approx(0.9, abs=0.003)


def test_the_bound_of_a_response_is_below_the_truth_as_often_as_it_says() -> None:
    true = 0.5 * (3.0 + 0.5 * Z[0.9])
    below = 0
    for seed in range(1500):
        line = signal_response(*_linear(2, seed=100 + seed), 4.0, log_size=False)
        below += line.bound(true, 0.95) < 0.9
    assert below / 1500 == pytest.approx(0.95, abs=0.017)


def test_a_response_in_powers_is_a_line_of_logarithms() -> None:
    sizes = np.tile(np.linspace(0.5, 3.0, 6), 50)
    responses = 0.1 * sizes**3 * np.exp(0.2 * np.random.default_rng(8).normal(size=sizes.size))
    line = signal_response(sizes, responses, 0.5, log_response=True)
    assert line.log_size
    assert line.coefficients[1] == pytest.approx(3.0, abs=0.1)
    assert line.is_sound
    bent = signal_response(sizes, responses, 0.5, log_size=False)
    assert not bent.is_sound
    # A scatter that grows with the size is none of a line of one scatter, and one of its logarithms.
    uneven = sizes * (1.0 + 0.2 * np.random.default_rng(11).normal(size=sizes.size))
    assert not signal_response(sizes, uneven, 1.0, log_size=False).is_sound
    assert signal_response(sizes, uneven, 1.0, log_size=True, log_response=True).is_sound
    falling = signal_response(sizes, 7.0 - 2.0 * sizes + 0.1 * np.sin(40.0 * sizes * np.arange(300)), 4.0)
    assert not falling.is_sound


def test_hits_and_misses_of_a_logistic_curve_have_its_coefficients() -> None:
    rng = np.random.default_rng(9)
    sizes = np.tile(np.linspace(0.5, 3.0, 11), 2000)
    found = rng.random(sizes.size) < 1.0 / (1.0 + np.exp(6.0 - 4.0 * sizes))
    curve = hit_miss(sizes, found)
    assert curve.coefficients == pytest.approx([-6.0, 4.0], abs=0.3)
    a90 = (6.0 + math.log(9.0)) / 4.0
    assert curve.probability(a90) == pytest.approx(0.9, abs=0.006)
    assert curve.bound(a90, 0.95) == pytest.approx(0.9, abs=0.015)
    assert curve.bound(a90, 0.95) < curve.probability(a90) < curve.bound(a90, 0.05)


def test_hits_and_misses_of_two_sizes_have_the_penalised_shares() -> None:
    """Firth's penalty adds half a hit and half a miss at each of two sizes: the shares are (k + 1/2)/(n + 1)."""
    curve = hit_miss(np.repeat([1.0, 2.0], 8), np.repeat([0.0, 1.0], 8))
    assert curve.probability(1.0) == pytest.approx(0.5 / 9.0, rel=1e-8)
    assert curve.probability(2.0) == pytest.approx(8.5 / 9.0, rel=1e-8)
    with pytest.raises(DetectionError, match="two sizes"):
        hit_miss(np.ones(5), np.ones(5))


def test_faults_that_no_threshold_finds_have_no_a90() -> None:
    rng = np.random.default_rng(10)
    healthy = threshold(rng.normal(size=500), 0.01, "normal")
    sizes = np.tile(np.linspace(0.5, 3.0, 6), 20)
    unseen = detection(sizes, rng.normal(size=sizes.size), healthy)
    assert unseen.method == "hit or miss"
    assert (unseen.a90, unseen.a90_95) == (None, None)
    # Seen by a step at 1.75: no line, and hits and misses have a90 there.
    step = detection(sizes, np.where(sizes > 1.75, 50.0, 0.0) + rng.normal(size=sizes.size), healthy)
    assert step.method == "hit or miss"
    assert step.a90 is not None
    assert step.a90_95 is not None
    assert 1.5 < step.a90 < step.a90_95 < 2.5
    assert [share.found for share in step.shares[3:]] == [20, 20, 20]
    assert step.shares[-1].interval == pytest.approx((0.025 ** (1.0 / 20.0), 1.0))
    # Φ((1 + 2 · 1.6 - 4) / 0.5) = 0.66 of the largest ones are seen.
    small = np.tile(np.linspace(0.5, 1.6, 6), 100)
    line = 1.0 + 2.0 * small + 0.5 * rng.normal(size=small.size)
    rare = detection(small, line, threshold(rng.normal(4.0 - Z[0.99], 1.0, 100_000), 0.01, "normal"))
    assert rare.curve.probability(1.6) == pytest.approx(0.66, abs=0.05)
    assert (rare.a90, rare.a90_95) == (None, None)
    # Seen at every size: the smallest one is enough.
    seen = detection(sizes, 50.0 + 5.0 * sizes + rng.normal(size=sizes.size), healthy)
    assert (seen.a90, seen.a90_95) == (0.5, 0.5)
