r"""Detection of a fault by an indicator: threshold from healthy values, probability of detection over the fault's size.

**Threshold.** Of n healthy values the k-th highest, k = ⌊(n + 1) α⌋, is exceeded by a further healthy one with the
probability k / (n + 1), whatever their distribution (Wilks 1941); the false-alarm rate itself is of the beta
distribution B(k, n + 1 - k). It takes n + 1 ≥ 1/α values. A normal distribution, of the values or of their logarithms,
takes fewer: x̄ + z s, z = Φ⁻¹(1 - α). With Student's noncentral t, the bounds of the quantile are
x̄ + s t'_γ(n - 1, z √n) / √n. The test of Shapiro and Wilk says whether the values look normal.

**Signal response** ("â versus a", Berens 1989; MIL-HDBK-1823A, 2009, chapter 9 and appendix G). With x the size or its
logarithm, y the indicator or its logarithm and the threshold y_t,

    y = β0 + β1 x + ε,  ε of standard deviation τ,    POD = Φ((x - μ) / σ),    μ = (y_t - β0) / β1,   σ = τ / β1.

The margin m = (β0 + β1 x - y_t) / τ has an estimate m̂, for which m̂ / √h is of the noncentral t distribution with n - 2
degrees of freedom and the parameter m / √h, h = xᵀ (Xᵀ X)⁻¹ x: bounds of the POD are exact where the model is, in place
of the handbook's asymptotic ones. The threshold counts as given.

**Hit or miss**. The POD is logistic in x, ln(p / (1 - p)) = β0 + β1 x, fitted with the penalty of Firth (1993), which
keeps it finite where all small faults are missed and all large ones found; its bounds are those of Wald.

a90 is the size of a POD of 0.9, a90/95 the one where the lower one-sided 95 % bound of the POD is 0.9.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt
from scipy import optimize, special, stats

from gearwhine.numerics.arrays import FloatArray

Law = Literal["order", "normal", "log-normal"]
LAWS: tuple[str, ...] = get_args(Law)
CONFIDENCE = 0.95
LEAST_FITTED = 10
"""Fewest healthy values that a distribution is fitted to."""
LEAST_SIGNIFICANCE = 0.01
"""Probability of chance below which values do not follow a model: a normal distribution, a straight line."""
_DETECTED = 0.9
_GRID = 201
_LEAST_RESPONSES = 4
_LEAST_REPEATS = 2
_NODES = 80
_FAR = 9.0  # standard deviations beyond which a normal distribution has nothing
_MOST_ROUNDS = 100
_MOST_TESTED = 5000  # values that the test of Shapiro and Wilk is tabulated for


class DetectionError(ValueError):
    """Values from which no threshold or no probability follows."""


def least_healthy(false_alarm: float, law: Law) -> int:
    """Return the fewest healthy values that a threshold at a false-alarm rate takes."""
    return math.ceil(1.0 / false_alarm - 1.0 - 1e-9) if law == "order" else LEAST_FITTED


@dataclass(frozen=True)
class Threshold:
    """Value of an indicator above which a gearbox counts as faulty.

    Attributes
    ----------
    value : float
    low, high : float
        95 % interval of the quantile that it stands for; infinite where the samples do not bound it.
    false_alarm_low, false_alarm_high : float
        95 % interval of the false-alarm rate that the value has.
    law : {"order", "normal", "log-normal"}
    goodness : float or None
        Probability by chance of values that look less normal (Shapiro and Wilk 1965); None of order statistics.
    """

    value: float
    low: float
    high: float
    false_alarm_low: float
    false_alarm_high: float
    law: Law
    goodness: float | None = None

    @property
    def fits(self) -> bool:
        """Whether the healthy values do not contradict the distribution."""
        return self.goodness is None or self.goodness >= LEAST_SIGNIFICANCE


def threshold(healthy: FloatArray, false_alarm: float, law: Law = "log-normal") -> Threshold:
    """Return the threshold that healthy values give at a false-alarm rate.

    Parameters
    ----------
    healthy : ndarray, shape (n,)
    false_alarm : float
        Probability that a healthy gearbox is above it.
    law : {"order", "normal", "log-normal"}

    Raises
    ------
    DetectionError
        Where there are too few values for the rate, or no distribution fits them at all.
    """
    values = np.asarray(healthy, dtype=np.float64)
    count = len(values)
    if not 0.0 < false_alarm < 0.5 or law not in LAWS:
        raise DetectionError(f"a false-alarm rate of {false_alarm:g} by {law!r}; expected one between 0 and 0.5")
    if not np.all(np.isfinite(values)) or count < least_healthy(false_alarm, law):
        needed = least_healthy(false_alarm, law)
        raise DetectionError(
            f"{int(np.isfinite(values).sum())} healthy values; a false-alarm rate of {false_alarm:g} by {law!r} takes "
            f"{needed} or more"
        )
    if law == "order":
        return _by_order(np.sort(values), false_alarm)
    if law == "log-normal" and values.min() <= 0.0:
        raise DetectionError(f"a healthy value of {values.min():g}; a log-normal distribution takes positive ones")
    return _by_normal(np.log(values) if law == "log-normal" else values, false_alarm, law)


def _by_order(values: FloatArray, false_alarm: float) -> Threshold:
    count = len(values)
    rank = math.floor((count + 1) * false_alarm + 1e-9)
    tail = 0.5 * (1.0 - CONFIDENCE)
    # Of n values as many as a binomial number are below the quantile.
    below = stats.binom(count, 1.0 - false_alarm)
    first, last = int(below.ppf(tail)), int(below.ppf(1.0 - tail)) + 1
    rate = stats.beta(rank, count + 1 - rank)
    return Threshold(
        value=float(values[count - rank]),
        low=float(values[first - 1]) if first >= 1 else -math.inf,
        high=float(values[last - 1]) if last <= count else math.inf,
        false_alarm_low=float(rate.ppf(tail)),
        false_alarm_high=float(rate.ppf(1.0 - tail)),
        law="order",
    )


def _by_normal(values: FloatArray, false_alarm: float, law: Law) -> Threshold:
    count, mean, deviation = len(values), float(values.mean()), float(values.std(ddof=1))
    if not deviation > 1e-12 * abs(mean):
        raise DetectionError(f"healthy values that are all {mean:g}; expected scatter: a variation, or sensor noise")
    z, root, tail = float(stats.norm.isf(false_alarm)), math.sqrt(count), 0.5 * (1.0 - CONFIDENCE)
    # A bound of the quantile at a level, and quantiles that the threshold is below and above.
    low, high = (
        mean + deviation * _noncentral_t_quantile(level, count - 1, z * root) / root for level in (tail, 1.0 - tail)
    )
    least, most = (_noncentrality(z * root, count - 1, level) / root for level in (1.0 - tail, tail))
    back = np.exp if law == "log-normal" else float
    return Threshold(
        value=float(back(mean + z * deviation)),
        low=float(back(low)),
        high=float(back(high)),
        false_alarm_low=float(stats.norm.sf(most)),
        false_alarm_high=float(stats.norm.sf(least)),
        law=law,
        goodness=float(stats.shapiro(values[:_MOST_TESTED]).pvalue),
    )


@lru_cache(maxsize=64)
def _chi_quadrature(freedom: int) -> tuple[FloatArray, FloatArray]:
    """Quantiles of √(χ²/ν) with their weights, for means over it."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    return np.sqrt(stats.chi2.ppf(0.5 * (nodes + 1.0), freedom) / freedom), 0.5 * weights


def _noncentral_t(value: float, freedom: int, parameter: float) -> float:
    """Distribution function of Student's noncentral t: the mean of Φ(t w - δ) over w = √(χ²/ν)."""
    scale, weights = _chi_quadrature(freedom)
    return float(weights @ special.ndtr(value * scale - parameter))


def _noncentral_t_quantile(level: float, freedom: int, parameter: float) -> float:
    reach = (abs(parameter) + _FAR) / float(_chi_quadrature(freedom)[0][0])
    return float(optimize.brentq(lambda t: _noncentral_t(t, freedom, parameter) - level, -reach, reach))


def _noncentrality(value: float, freedom: int, level: float) -> float:
    """Parameter with which a value has a level of the distribution function, which falls as the parameter rises."""
    ends = value * _chi_quadrature(freedom)[0][[0, -1]]
    return float(
        optimize.brentq(lambda d: _noncentral_t(value, freedom, d) - level, ends.min() - _FAR, ends.max() + _FAR)
    )


@dataclass(frozen=True)
class Share:
    """Part of the faulty gearboxes of one size that are found, with its 95 % interval (Clopper and Pearson 1934)."""

    size: float
    found: int
    total: int

    @cached_property
    def interval(self) -> tuple[float, float]:
        """Ends of the interval."""
        bounds = stats.binomtest(self.found, self.total).proportion_ci(CONFIDENCE, method="exact")
        return float(bounds.low), float(bounds.high)


@dataclass(frozen=True, eq=False)
class SignalResponse:
    """Straight line of an indicator over the size of a fault, and the probability of detection that follows.

    Attributes
    ----------
    coefficients : ndarray, shape (2,)
        β0 and β1.
    deviation : float
        Standard deviation τ about the line, with n - 2 degrees of freedom.
    inverse : ndarray, shape (2, 2)
        (Xᵀ X)⁻¹.
    freedom : int
        n - 2.
    limit : float
        Threshold y_t, as the line has it.
    log_size, log_response : bool
        Whether the line is one of the logarithms.
    lack_of_fit : float or None
        Probability by chance of means of equal sizes that lie farther from the line (F-test); None without repeats.
    unequal_scatter : float or None
        Probability by chance of scatters of the sizes that differ more (Brown and Forsythe 1974); None without
        repeats.
    slope_significance : float
        Probability by chance of a line that rises more steeply.
    likelihood : float
        Logarithm of the likelihood of the responses themselves, but for a constant.
    """

    coefficients: FloatArray
    deviation: float
    inverse: FloatArray
    freedom: int
    limit: float
    log_size: bool
    log_response: bool
    lack_of_fit: float | None
    unequal_scatter: float | None
    slope_significance: float
    likelihood: float = 0.0

    @property
    def is_sound(self) -> bool:
        """Whether the line rises, and the values do not contradict it or its even scatter."""
        tests = (self.lack_of_fit, self.unequal_scatter)
        holds = all(test is None or test >= LEAST_SIGNIFICANCE for test in tests)
        return holds and self.slope_significance < LEAST_SIGNIFICANCE

    def _row(self, size: float) -> FloatArray:
        return np.array([1.0, math.log(size) if self.log_size else size])

    def margin(self, size: float) -> float:
        """Estimate of the margin m at a size."""
        return float((self._row(size) @ self.coefficients - self.limit) / self.deviation)

    def probability(self, size: float) -> float:
        """Probability of detection at a size."""
        return float(stats.norm.cdf(self.margin(size)))

    def bound(self, size: float, level: float) -> float:
        """Bound that the probability of detection is above with a probability ``level``."""
        row = self._row(size)
        spread = math.sqrt(float(row @ self.inverse @ row))
        least = spread * _noncentrality(self.margin(size) / spread, self.freedom, level)
        return float(stats.norm.cdf(least))


def signal_response(
    sizes: FloatArray, responses: FloatArray, limit: float, *, log_response: bool = False, log_size: bool | None = None
) -> SignalResponse:
    """Fit a straight line to the responses to faults of some sizes.

    Parameters
    ----------
    sizes, responses : ndarray, shape (n,)
    limit : float
        Threshold of the response.
    log_response : bool
        Fit the logarithm of the responses.
    log_size : bool, optional
        Fit over the logarithm of the sizes; by default over what leaves the smaller scatter.

    Raises
    ------
    DetectionError
        Where there are fewer than four values, or two sizes.
    """
    x, y = np.asarray(sizes, dtype=np.float64), np.asarray(responses, dtype=np.float64)
    if len(y) < _LEAST_RESPONSES or len(np.unique(x)) < 2:
        raise DetectionError(f"{len(y)} responses to {len(np.unique(x))} sizes; expected four or more, to two or more")
    positive = y > 0.0 if log_response else np.ones(len(y), dtype=bool)
    if not (np.all(x > 0.0) and np.all(positive) and np.all(np.isfinite(y)) and (limit > 0.0 or not log_response)):
        raise DetectionError("sizes or responses that are not positive, of which there are no logarithms")
    if log_size is None:
        both = [signal_response(x, y, limit, log_response=log_response, log_size=choice) for choice in (False, True)]
        return min(both, key=lambda one: one.deviation)
    values = np.log(y) if log_response else y
    columns = np.column_stack([np.ones(len(x)), np.log(x) if log_size else x])
    inverse = np.linalg.inv(columns.T @ columns)
    coefficients = inverse @ columns.T @ values
    rest = values - columns @ coefficients
    freedom = len(values) - 2
    squares = float(rest @ rest)
    deviation = math.sqrt(squares / freedom)
    if deviation <= 1e-12 * float(np.abs(values).max()):
        raise DetectionError("responses without scatter; expected a variation, or sensor noise")
    slope = float(coefficients[1]) / (deviation * math.sqrt(float(inverse[1, 1])))
    return SignalResponse(
        coefficients,
        deviation,
        inverse,
        freedom,
        math.log(limit) if log_response else limit,
        log_size,
        log_response,
        _lack_of_fit(x, values, squares),
        _unequal_scatter(x, values),
        float(stats.t.sf(slope, freedom)),
        # A density of logarithms is one of the responses over these.
        -0.5 * len(values) * math.log(squares / len(values)) - (float(values.sum()) if log_response else 0.0),
    )


def _lack_of_fit(sizes: FloatArray, values: FloatArray, squares: float) -> float | None:
    """Probability of the F-test of the means of equal sizes against the line; None without repeats."""
    groups = [values[sizes == size] for size in np.unique(sizes)]
    pure = float(sum(np.sum((group - group.mean()) ** 2) for group in groups))
    between, within = len(groups) - 2, len(values) - len(groups)
    if between < 1 or within < 1 or pure <= 0.0:
        return None
    return float(stats.f.sf((squares - pure) / between / (pure / within), between, within))


def _unequal_scatter(sizes: FloatArray, values: FloatArray) -> float | None:
    """Probability of the test of Brown and Forsythe of the scatters of equal sizes; None without repeats."""
    groups = [values[sizes == size] for size in np.unique(sizes)]
    repeated = [group for group in groups if len(group) > _LEAST_REPEATS]
    if len(repeated) < 2 or not any(np.ptp(group) > 0.0 for group in repeated):
        return None
    return float(stats.levene(*repeated, center="median").pvalue)


@dataclass(frozen=True, eq=False)
class HitMiss:
    """Logistic probability of detection over the size of a fault.

    Attributes
    ----------
    coefficients : ndarray, shape (2,)
        β0 and β1.
    covariance : ndarray, shape (2, 2)
    log_size : bool
        Whether x is the logarithm of the size.
    likelihood : float
        Logarithm of the penalised likelihood.
    """

    coefficients: FloatArray
    covariance: FloatArray
    log_size: bool
    likelihood: float

    @property
    def is_sound(self) -> bool:
        """Whether the probability rises with the size."""
        return bool(self.coefficients[1] > 0.0)

    def _row(self, size: float) -> FloatArray:
        return np.array([1.0, math.log(size) if self.log_size else size])

    def probability(self, size: float) -> float:
        """Probability of detection at a size."""
        return _logistic(float(self._row(size) @ self.coefficients))

    def bound(self, size: float, level: float) -> float:
        """Bound that the probability of detection is above with a probability ``level``."""
        row = self._row(size)
        spread = math.sqrt(float(row @ self.covariance @ row))
        return _logistic(float(row @ self.coefficients) - float(stats.norm.ppf(level)) * spread)


def _logistic(value: float) -> float:
    return 0.5 * (1.0 + math.tanh(0.5 * value))


def hit_miss(sizes: FloatArray, found: npt.ArrayLike, *, log_size: bool = False) -> HitMiss:
    """Fit a logistic curve to hits and misses, by the likelihood with Firth's penalty.

    The score is Σ (y_i - p_i + h_i (1/2 - p_i)) x_i, h_i the leverages of the weighted regression (Heinze and Schemper
    2002).

    Raises
    ------
    DetectionError
        Where there are fewer than two sizes.
    """
    x, hits = np.asarray(sizes, dtype=np.float64), np.asarray(found, dtype=np.float64)
    if len(np.unique(x)) < 2:
        raise DetectionError("hits and misses of one size; expected two sizes or more")
    x = np.log(x) if log_size else x
    centre, width = float(x.mean()), float(x.std())
    columns = np.column_stack([np.ones(len(x)), (x - centre) / width])

    def penalised(beta: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        eta = columns @ beta
        p = 0.5 * (1.0 + np.tanh(0.5 * eta))
        information = columns.T @ (columns * (p * (1.0 - p))[:, None])
        value = float(np.sum(hits * eta - np.logaddexp(0.0, eta))) + 0.5 * float(np.linalg.slogdet(information)[1])
        inverse = np.linalg.inv(information)
        leverage = p * (1.0 - p) * np.einsum("ij,jk,ik->i", columns, inverse, columns)
        return value, np.asarray(columns.T @ (hits - p + leverage * (0.5 - p))), np.asarray(inverse)

    beta = np.zeros(2)
    value, score, inverse = penalised(beta)
    for _ in range(_MOST_ROUNDS):
        step = inverse @ score
        step *= min(1.0, 2.0 / float(np.abs(step).max(initial=1e-300)))
        new = penalised(beta + step)
        while new[0] < value and np.abs(step).max() > 1e-12:
            step = 0.5 * step
            new = penalised(beta + step)
        beta = beta + step
        value, score, inverse = new
        if np.abs(step).max() < 1e-10:
            break
    back = np.array([[1.0, -centre / width], [0.0, 1.0 / width]])
    return HitMiss(back @ beta, back @ inverse @ back.T, log_size, value)


Curve = SignalResponse | HitMiss


@dataclass(frozen=True, eq=False)
class Detection:
    """Probability of detection of a fault over its size.

    Attributes
    ----------
    method : {"signal response", "hit or miss"}
    curve : SignalResponse or HitMiss
    shares : tuple of Share
        Part that is found of each size.
    a90, a90_95 : float or None
        Size of a probability of 0.9, and of its lower 95 % bound; None where no size between the smallest and the
        largest has it. At most the smallest size where it has it already.
    """

    method: Literal["signal response", "hit or miss"]
    curve: Curve
    shares: tuple[Share, ...]
    a90: float | None
    a90_95: float | None

    @property
    def is_contradicted(self) -> bool:
        """Whether the hits of a size from a90 on exclude the probability of 0.9 that the curve has there."""
        return self.a90 is not None and any(
            share.size >= self.a90 and share.interval[1] < _DETECTED for share in self.shares
        )


def detection(sizes: FloatArray, responses: FloatArray, limit: Threshold) -> Detection:
    """Find the probability of detection over the size of a fault from the responses to faults of some sizes.

    By the line of the responses or of their logarithms where they follow one that rises, by the more likely one; else
    by hits and misses.

    Parameters
    ----------
    sizes, responses : ndarray, shape (n,)
    limit : Threshold

    Raises
    ------
    DetectionError
        Where there are too few responses.
    """
    x, y = np.asarray(sizes, dtype=np.float64), np.asarray(responses, dtype=np.float64)
    shares = tuple(Share(float(a), int(np.sum(y[x == a] > limit.value)), int(np.sum(x == a))) for a in np.unique(x))
    forms = (False, True) if limit.value > 0.0 and np.all(y > 0.0) else (False,)
    lines = [signal_response(x, y, limit.value, log_response=form) for form in forms if len(y) >= _LEAST_RESPONSES]
    if sound := [line for line in lines if line.is_sound]:
        line = max(sound, key=lambda one: one.likelihood)
        return Detection("signal response", line, shares, *_sizes(line, x))
    curves = [hit_miss(x, y > limit.value, log_size=choice) for choice in (False, True)]
    curve = max(curves, key=lambda one: one.likelihood)
    return Detection("hit or miss", curve, shares, *_sizes(curve, x))


def _sizes(curve: Curve, sizes: FloatArray) -> tuple[float | None, float | None]:
    """Return a90 and a90/95 within the sizes."""
    low, high = float(sizes.min()), float(sizes.max())
    if not curve.is_sound:
        return None, None
    return (
        _crossing(curve.probability, low, high),
        _crossing(lambda size: curve.bound(size, CONFIDENCE), low, high),
    )


def _crossing(probability: Callable[[float], float], low: float, high: float) -> float | None:
    """Return the least size from which a probability stays at 0.9 or more up to the largest; None without one."""
    if probability(high) < _DETECTED:
        return None
    grid = np.linspace(low, high, _GRID)
    place = len(grid) - 1
    while place > 0 and probability(float(grid[place - 1])) >= _DETECTED:
        place -= 1
    if place == 0:
        return low
    return float(optimize.brentq(lambda a: probability(a) - _DETECTED, grid[place - 1], grid[place], xtol=1e-12))
