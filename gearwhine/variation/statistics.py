"""Statistics of a varied case: distributions of its quantities, what they follow from, and the yield under limits."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import stats

from gearwhine.case.variation import Limit
from gearwhine.numerics.arrays import BoolArray, FloatArray
from gearwhine.numerics.explained_parts import explained_parts
from gearwhine.numerics.sampling import IndexPoints, WidenedPoints
from gearwhine.numerics.sobol_indices import CONFIDENCE, SobolIndices, sobol_indices
from gearwhine.output import file_stems
from gearwhine.output.quantity import unit_of
from gearwhine.solutions import Failure
from gearwhine.variation.inputs import Input
from gearwhine.variation.named_quantities import matches
from gearwhine.variation.quantities import Evaluation
from gearwhine.variation.samples import Outcome

QUANTILES = (0.05, 0.5, 0.95)
"""Probabilities of the quantiles."""
WORST = 3
"""Number of the worst gearboxes of a quantity that are written as cases."""
CHANCE = 0.001
"""Probability by chance of an explained part or a rank correlation above which it is not told."""
_OF_ONE_PERIOD, _OF_ALL_PERIODS = "transmission_error_peak_to_peak_m", "transmission_error_over_hunting_period_m"
_LEADING = ("level_db", "sound_power_db", _OF_ONE_PERIOD)
_LEAST_SPEEDS = 3  # below which every speed is an end
_LEAST_FOR_RANKS = 8  # samples below which no correlation is told
_ROUNDING = 1e-9  # range of values over the largest that solutions to their tolerance may have without any input


@dataclass(frozen=True)
class Share:
    """Part of the gearboxes that are good, with its 95 % interval (Clopper and Pearson 1934).

    Attributes
    ----------
    share, low, high : float
    good, total : int
        Number of the good gearboxes, and of all.
    """

    share: float
    low: float
    high: float
    good: int
    total: int

    @classmethod
    def of(cls, good: int, total: int) -> Share:
        """Return the share of some good ones of all."""
        interval = stats.binomtest(good, total).proportion_ci(CONFIDENCE, method="exact")
        return cls(good / total, float(interval.low), float(interval.high), good, total)


@dataclass(frozen=True)
class Difference:
    """Difference of two parts of the same gearboxes, with its 95 % interval.

    The gearboxes that are good in one way only decide: of n, b are good after and not before, c before and not after.
    The interval is Wald's with half a gearbox added to each cell of the table (Agresti and Min, Stat. Med. 24, 2005).

    Attributes
    ----------
    difference, low, high : float
    """

    difference: float
    low: float
    high: float

    @classmethod
    def of(cls, before: BoolArray, after: BoolArray) -> Difference:
        """Return the part of good ones after a change less that before, of the same gearboxes (n,)."""
        gained, lost = int(np.sum(after & ~before)), int(np.sum(before & ~after))
        total = before.size + 2
        middle = (gained - lost) / total
        variance = ((gained + lost + 1) / total - middle**2) / total
        half = float(stats.norm.ppf(0.5 + 0.5 * CONFIDENCE)) * math.sqrt(variance)
        return cls((gained - lost) / before.size, max(middle - half, -1.0), min(middle + half, 1.0))


@dataclass(frozen=True, eq=False)
class QuantityWidened:
    """A quantity with one wider input beside itself.

    Attributes
    ----------
    name : str
    deviation_before, deviation : float
        Standard deviation over the same gearboxes.
    end_before, end : float
        The quantile at its bad end: of 95 %, of a least value of 5 %.
    """

    name: str
    deviation_before: float
    deviation: float
    end_before: float
    end: float


@dataclass(frozen=True, eq=False)
class WidenedInput:
    """What a wider distribution of an input costs.

    Attributes
    ----------
    name : str
    share : Share or None
        Yield with the wider input; None without limits.
    change : Difference or None
        Its difference from that of the same gearboxes without it.
    quantities : tuple of QuantityWidened
        The quantities that are drawn.
    """

    name: str
    share: Share | None
    change: Difference | None
    quantities: tuple[QuantityWidened, ...]


@dataclass(frozen=True, eq=False)
class QuantityStatistics:
    """Distribution of a quantity over the samples.

    Attributes
    ----------
    name : str
        Name, with the unit at its end.
    nominal : float
        Value of the gearbox without changes.
    values : ndarray, shape (n,)
        Value of each sample; NaN of one that failed or has none.
    inputs : ndarray, shape (n, d)
        Values of the inputs.
    input_names : tuple of str
    indices : SobolIndices or None
    limit : Limit or None
    """

    name: str
    nominal: float
    values: FloatArray
    inputs: FloatArray
    input_names: tuple[str, ...]
    indices: SobolIndices | None = None
    limit: Limit | None = None

    @property
    def unit(self) -> str:
        """Unit of the values."""
        return unit_of(self.name)

    @cached_property
    def found(self) -> FloatArray:
        """Values of the samples that have one."""
        return np.asarray(self.values[np.isfinite(self.values)])

    @property
    def scatters(self) -> bool:
        """Whether the values differ by more than the rounding of a solution that an input does not change."""
        return self.found.size > 1 and float(np.ptp(self.found)) > _ROUNDING * float(np.abs(self.found).max())

    @property
    def mean(self) -> float:
        """Mean over the samples."""
        return float(self.found.mean()) if self.found.size else math.nan

    @property
    def deviation(self) -> float:
        """Standard deviation over the samples."""
        return float(self.found.std(ddof=1)) if self.found.size > 1 else math.nan

    @property
    def quantiles(self) -> dict[str, float]:
        """Quantiles over the samples by their probability."""
        if not self.found.size:
            return dict.fromkeys(map(str, QUANTILES), math.nan)
        return dict(zip(map(str, QUANTILES), np.quantile(self.found, QUANTILES).tolist(), strict=True))

    @property
    def bad_end(self) -> float:
        """Probability of the quantile at the bad end: 0.95, of a least value 0.05."""
        return QUANTILES[0] if self._has_least_value else QUANTILES[-1]

    @property
    def _has_least_value(self) -> bool:
        return self.limit is not None and self.limit.at_most is None

    @cached_property
    def rank_correlations(self) -> dict[str, float]:
        """Rank correlation (Spearman) with each input; none where a few samples or no scatter say nothing."""
        found = np.isfinite(self.values)
        if found.sum() < _LEAST_FOR_RANKS or not self.scatters:
            return {}
        ranks = stats.rankdata(self.values[found])
        correlations = {}
        for name, column in zip(self.input_names, self.inputs[found].T, strict=True):
            of_input = stats.rankdata(column)
            varies = np.ptp(of_input) > 0.0
            correlations[name] = float(np.corrcoef(ranks, of_input)[0, 1]) if varies else 0.0
        return correlations

    @cached_property
    def rank_chances(self) -> dict[str, float]:
        """Probability by chance of each rank correlation or a larger one, either way (Student's t with n - 2)."""
        freedom = self.found.size - 2
        chances = {}
        for name, rank in self.rank_correlations.items():
            squared = min(rank**2, 1.0 - 1e-15)
            chances[name] = float(2.0 * stats.t.sf(math.sqrt(squared * freedom / (1.0 - squared)), freedom))
        return chances

    @property
    def leading_ranks(self) -> dict[str, float]:
        """Rank correlations that are hardly by chance, the largest first; none where indices are found."""
        if self.indices is not None:
            return {}
        proven = [name for name, chance in self.rank_chances.items() if chance < CHANCE]
        ranks = self.rank_correlations
        return {name: ranks[name] for name in sorted(proven, key=lambda name: -abs(ranks[name]))}

    @property
    def share(self) -> Share | None:
        """Part of the gearboxes within the limit; None without one."""
        if self.limit is None or not self.found.size:
            return None
        return Share.of(sum(self.limit.holds(value) for value in self.found.tolist()), self.found.size)

    @property
    def worst(self) -> list[int]:
        """Numbers of the worst samples: the highest, of a least value the lowest."""
        sign = 1.0 if self._has_least_value else -1.0
        order = np.argsort(sign * np.where(np.isfinite(self.values), self.values, sign * math.inf), kind="stable")
        return [int(number) for number in order[: min(WORST, self.found.size)]]

    @cached_property
    def explained(self) -> dict[str, float]:
        """Part of the variance that goes with each input alone, where the samples prove that it is not 0."""
        found = np.isfinite(self.values)
        if not self.scatters:
            return {}
        parts = explained_parts(self.values[found], self.inputs[found], CHANCE)
        return {self.input_names[number]: part for number, part in parts.items()}

    def importance(self) -> dict[str, float]:
        """Return how much each input matters: its total-order index, without these the part that it explains."""
        if self.indices is not None:
            return dict(zip(self.input_names, self.indices.total.tolist(), strict=True))
        return self.explained


@dataclass(frozen=True)
class WorstGearbox:
    """One of the worst gearboxes of a quantity.

    Attributes
    ----------
    name : str
        Name of the quantity.
    rank : int
        1 is the worst.
    number : int
        Number of the sample.
    value : float
    speed : float or None
        Signed speed at which the value is the highest over speed [rad/s]; None of a quantity without speeds.
    file : str or None
        Name of the file with its case; None of a machine of Python.
    """

    name: str
    rank: int
    number: int
    value: float
    speed: float | None
    file: str | None = None


@dataclass(frozen=True, eq=False)
class VariedResult:
    """A varied case with all its samples.

    Attributes
    ----------
    inputs : tuple of Input
    points : ndarray, shape (n, d)
        Point of each sample in the unit cube.
    values : ndarray, shape (n, d)
        Values of the inputs.
    nominal : Evaluation
        The gearbox without changes.
    outcomes : tuple of Evaluation or Failure
    limits : mapping of str to Limit
        By quantity.
    speeds : ndarray, shape (s,)
        Signed speeds of curves [rad/s].
    design : IndexPoints, WidenedPoints or None
        Points of the samples where Sobol' indices are wanted, or what wider inputs cost.
    resumed : int
        Number of samples that an earlier run had found.
    widening : float or None
        Factor by which the distribution of one input in turn is wider.
    """

    inputs: tuple[Input, ...]
    points: FloatArray
    values: FloatArray
    nominal: Evaluation
    outcomes: tuple[Outcome, ...]
    limits: Mapping[str, Limit]
    speeds: FloatArray
    design: IndexPoints | WidenedPoints | None
    resumed: int
    widening: float | None = None

    @cached_property
    def failures(self) -> dict[int, Failure]:
        """Samples without a result by number."""
        return {number: one for number, one in enumerate(self.outcomes) if isinstance(one, Failure)}

    @cached_property
    def representative(self) -> BoolArray:
        """Mask of the samples that stand for the production; the others tell what the scatter follows from."""
        return np.ones(len(self.outcomes), dtype=np.bool_) if self.design is None else self.design.representative

    @cached_property
    def quantities(self) -> tuple[QuantityStatistics, ...]:
        """Every quantity over the samples that stand for the production, in the order of the nominal gearbox."""
        names = dict.fromkeys(self.nominal.numbers)
        for outcome in self.outcomes:
            if isinstance(outcome, Evaluation):
                names |= dict.fromkeys(outcome.numbers)
        chosen = self.representative
        statistics = []
        for name in names:
            values = self.all_values(name)
            indices = sobol_indices(self.design, values) if isinstance(self.design, IndexPoints) else None
            statistics.append(
                QuantityStatistics(
                    name,
                    self.nominal.numbers.get(name, math.nan),
                    np.where(chosen, values, np.nan),
                    self.values,
                    tuple(one.name for one in self.inputs),
                    indices,
                    self.limits.get(name),
                )
            )
        return tuple(statistics)

    def all_values(self, name: str) -> FloatArray:
        """Values of a quantity of all samples, NaN where there is none, shape (n,)."""
        return np.array(
            [one.numbers.get(name, math.nan) if isinstance(one, Evaluation) else math.nan for one in self.outcomes]
        )

    @cached_property
    def worst_gearboxes(self) -> tuple[WorstGearbox, ...]:
        """The worst gearboxes of each headline, the worst first."""
        of_case = any(one.tolerance for one in self.inputs)
        stems = file_stems([one.name for one in self.headlines], "worst-")
        return tuple(
            WorstGearbox(
                one.name,
                rank,
                number,
                float(one.values[number]),
                self.speed_of_highest(one.name, number),
                f"{stem}-{rank}.toml" if of_case else None,
            )
            for one, stem in zip(self.headlines, stems, strict=True)
            for rank, number in enumerate(one.worst, start=1)
        )

    def speed_of_highest(self, name: str, number: int) -> float | None:
        """Signed speed at which a quantity of a sample is the highest over speed [rad/s]; None of another quantity."""
        found = self.outcomes[number]
        curve = found.curves.get(name) if isinstance(found, Evaluation) else None
        if curve is None or len(curve) != len(self.speeds):
            return None
        return float(self.speeds[int(np.argmax(curve))])

    def curve(self, name: str) -> FloatArray:
        """Curve of a quantity of all samples, shape (n, s)."""
        none = np.full(len(self.speeds), math.nan)
        return np.array([one.curves.get(name, none) if isinstance(one, Evaluation) else none for one in self.outcomes])

    @property
    def good(self) -> BoolArray:
        """Mask of the samples within all limits, shape (n,); those without a result are not."""
        held = np.array([isinstance(one, Evaluation) for one in self.outcomes])
        for name, limit in self.limits.items():
            held &= np.array([limit.holds(value) for value in self.all_values(name).tolist()])
        return held

    @cached_property
    def yielded(self) -> Share | None:
        """Part of the gearboxes with a result that are within all limits; None without limits."""
        solved = self.representative & np.array([isinstance(one, Evaluation) for one in self.outcomes])
        if not self.limits or not solved.any():
            return None
        return Share.of(int((self.good & solved).sum()), int(solved.sum()))

    @cached_property
    def widened(self) -> tuple[WidenedInput, ...]:
        """What each wider input costs: the dearest first by the yield, of equal ones by the first quantity."""
        if not isinstance(self.design, WidenedPoints):
            return ()
        split = self.design.split
        solved, solved_wide = split(np.array([isinstance(one, Evaluation) for one in self.outcomes]))
        good, good_wide = split(self.good)
        ends = [(one.name, one.bad_end, *split(self.all_values(one.name))) for one in self.headlines]
        found = []
        for place, number in enumerate(self.design.inputs):
            both = solved & solved_wide[place]
            if not both.any():
                continue
            before, after = good[both], good_wide[place][both]
            quantities = []
            for name, probability, values, values_wide in ends:
                pair = np.array([values, values_wide[place]])
                pair = pair[:, np.all(np.isfinite(pair), axis=0)]
                if pair.shape[1] > 1:
                    deviations, quantiles = pair.std(axis=1, ddof=1), np.quantile(pair, probability, axis=1)
                    row = zip(deviations.tolist(), quantiles.tolist(), strict=True)
                    (deviation, end), (wide_deviation, wide_end) = row
                    quantities.append(QuantityWidened(name, deviation, wide_deviation, end, wide_end))
            share = Share.of(int(after.sum()), after.size) if self.limits else None
            change = Difference.of(before, after) if self.limits else None
            found.append(WidenedInput(self.inputs[number].name, share, change, tuple(quantities)))
        return tuple(sorted(found, key=_cost, reverse=True))

    def at_end_of_speeds(self, name: str) -> float | None:
        """Part of the gearboxes whose level is the highest at an end of the speeds; None without several speeds."""
        curves = self.curve(name)[self.representative]
        found = curves[np.all(np.isfinite(curves), axis=1)]
        if len(self.speeds) < _LEAST_SPEEDS or not len(found):
            return None
        ends = [int(np.argmin(np.abs(self.speeds))), int(np.argmax(np.abs(self.speeds)))]
        return float(np.isin(found.argmax(axis=1), ends).mean())

    @property
    def headlines(self) -> tuple[QuantityStatistics, ...]:
        """Quantities that are drawn: those with a limit, else levels and transmission errors, else all.

        The transmission error is that over the hunting period where teeth differ: its first mesh period has one pair of
        many.
        """
        varying = {one.name: one for one in self.quantities if one.scatters}
        limited = [one for one in varying.values() if one.limit is not None]
        leading = list[QuantityStatistics]()
        for name, one in varying.items():
            if name.endswith(_LEADING):
                whole = varying.get(name.replace(_OF_ONE_PERIOD, _OF_ALL_PERIODS), one)
                leading.append(one if np.array_equal(one.values, whole.values, equal_nan=True) else whole)
        return tuple(limited or leading or varying.values())


def _cost(one: WidenedInput) -> tuple[float, float]:
    """Return what a wider input costs: the loss of yield, and of equal ones the growth of the first deviation."""
    loss = 0.0 if one.change is None else -one.change.difference
    first = one.quantities[0] if one.quantities else None
    return loss, 0.0 if first is None else first.deviation / (first.deviation_before or 1.0)


def known_limits(limits: Mapping[str, Limit], names: Sequence[str]) -> dict[str, Limit]:
    """Return the limit of each quantity that gearboxes have; of a name with ``*`` all that match have it.

    Raises
    ------
    CaseError
        Where a limit is of a quantity that they do not have.
    """
    from gearwhine.case import CaseError, Problem
    from gearwhine.case.errors import UNSAID, key_of
    from gearwhine.numerics.names import one_of

    limited: dict[str, Limit] = {}
    problems = list[Problem]()
    # A quantity that is named has its own limit beside one of a pattern.
    for pattern in sorted(limits, key=lambda name: "*" not in name):
        found = [name for name in names if matches(name, pattern)]
        limited |= dict.fromkeys(found, limits[pattern])
        if not found:
            expected = one_of("a quantity that these gearboxes have", pattern, names)
            problems.append(Problem(key_of(("variation", "limit", pattern)), UNSAID, expected))
    if problems:
        raise CaseError(problems)
    return limited
