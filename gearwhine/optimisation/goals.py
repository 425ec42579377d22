"""Aims and limits of an optimisation: by the names of quantities, of a design alone or of gearboxes about it.

Over gearboxes about a design a quantity has two sides, and by a name of their own the statistics that are asked for:
``mean of``, ``standard deviation of`` and ``quantile 0.95 of`` a quantity, and the ``yield``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from gearwhine.case import CaseError, Problem
from gearwhine.case.errors import UNSAID, key_of
from gearwhine.case.optimisation import Aim, Robust
from gearwhine.case.variation import Limit
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.names import did_you_mean
from gearwhine.optimisation.search import FAILED
from gearwhine.variation.named_quantities import matches, statistic_of
from gearwhine.variation.statistics import known_limits

NO_AIM = Problem("optimisation.aim", UNSAID, "the name of one quantity or more, each with its sense")
Worse = dict[str, tuple[float, float]]
"""Low and high side of each quantity: of a design alone, and of a statistic, twice its value."""
YIELD = "yield"
"""Name of the part of the gearboxes about a design that are within all limits of `[variation]`."""


@dataclass(frozen=True)
class Goal:
    """An aim and the quantities that it is of.

    Attributes
    ----------
    name : str
        Name of the quantity, as the case has it.
    quantities : tuple of str
        Names of all quantities that are meant; the worst of them counts.
    sign : float
        1 where less is better, -1 where more is.
    weight : float or None
    """

    name: str
    quantities: tuple[str, ...]
    sign: float
    weight: float | None

    def value(self, sides: Worse) -> float:
        """Value of the aim, in the unit of the quantity; NaN where there is none."""
        values = [sides.get(name, (math.nan, math.nan))[self.sign > 0.0] for name in self.quantities]
        return self.sign * float(np.max(self.sign * np.array(values)))


@dataclass(frozen=True)
class LimitEnd:
    """An end of a limit.

    Attributes
    ----------
    name : str
        Name of the quantity.
    end : float
    sign : float
        1 where the quantity is at most the end, -1 where it is at least so much.
    key : str
        Name of the limit, as the case has it.
    """

    name: str
    end: float
    sign: float
    key: str

    def value(self, sides: Worse) -> float:
        """Value of the quantity on the side of the limit; NaN where there is none."""
        return sides.get(self.name, (math.nan, math.nan))[self.sign > 0.0]

    def excess(self, sides: Worse) -> float:
        """Excess over the limit in its scale, not above zero where it holds; that of an infinite life is finite."""
        excess = self.sign * (self.value(sides) - self.end) / (abs(self.end) or 1.0)
        return -FAILED if excess < -FAILED else excess


@dataclass(frozen=True)
class Goals:
    """Aims and limits.

    Attributes
    ----------
    aims : tuple of Goal
    limits : tuple of LimitEnd
    robust : Robust or None
        How the scatter about a design counts.
    good : mapping of str to Limit
        Limits of a good gearbox, by quantity, for the yield.
    """

    aims: tuple[Goal, ...]
    limits: tuple[LimitEnd, ...]
    robust: Robust | None = None
    good: Mapping[str, Limit] = field(default_factory=dict)

    @cached_property
    def statistics(self) -> tuple[str, ...]:
        """Names of the statistics over gearboxes that aims and limits are of."""
        named = [*(name for goal in self.aims for name in goal.quantities), *(limit.name for limit in self.limits)]
        return tuple(dict.fromkeys(name for name in named if is_statistic(name)))

    @property
    def is_weighted(self) -> bool:
        """Whether the weighted sum of all aims is the one aim."""
        return self.aims[0].weight is not None

    @property
    def count(self) -> int:
        """Number of aims that the search has."""
        return 1 if self.is_weighted else len(self.aims)

    def sides(self, found: Sequence[Mapping[str, float]]) -> Worse:
        """Return low and high side of each quantity over the gearboxes of a design."""
        if len(found) == 1:
            return {name: (value, value) for name, value in found[0].items()}
        names = dict.fromkeys(name for numbers in found for name in numbers)
        values = {name: np.array([numbers.get(name, math.nan) for numbers in found]) for name in names}
        sides = {name: self._sides_of(of_name) for name, of_name in values.items()}
        for name in self.statistics:
            found_of = self._yield(values) if name == YIELD else _statistic(*statistic_of(name), values)
            sides[name] = found_of, found_of
        return sides

    def _sides_of(self, values: FloatArray) -> tuple[float, float]:
        robust = self.robust
        if robust is not None and robust.quantile is not None:
            low, high = np.quantile(values, (1.0 - robust.quantile, robust.quantile))
            return float(low), float(high)
        reach = (0.0 if robust is None else robust.reach) * float(values.std(ddof=1))
        return float(values.mean()) - reach, float(values.mean()) + reach

    def _yield(self, values: Mapping[str, FloatArray]) -> float:
        """Part of the gearboxes within all limits of a good one."""
        held = [[limit.holds(value) for value in values[name].tolist()] for name, limit in self.good.items()]
        return float(np.mean(np.all(held, axis=0)))

    def values(self, sides: Worse) -> FloatArray:
        """Values of the aims in their units, shape (aims,)."""
        return np.array([goal.value(sides) for goal in self.aims])

    def minimised(self, sides: Worse) -> FloatArray:
        """Aims with the sign of their sense, or their weighted sum, which a search makes least, shape (a,)."""
        signed = np.array([goal.sign for goal in self.aims]) * self.values(sides)
        if self.is_weighted:
            return np.array([float(np.dot([goal.weight or 0.0 for goal in self.aims], signed))])
        return signed

    def excesses(self, sides: Worse) -> FloatArray:
        """Excesses over the limits, shape (l,)."""
        return np.array([limit.excess(sides) for limit in self.limits])


def is_statistic(name: str) -> bool:
    """Whether an aim or a limit of this name is of a statistic over the gearboxes about a design."""
    return name == YIELD or bool(statistic_of(name)[0])


def _statistic(statistic: str, name: str, values: Mapping[str, FloatArray]) -> float:
    """Return a statistic of a quantity over gearboxes; NaN where one has none."""
    of_name = values.get(name, np.array([math.nan]))
    if statistic == "mean":
        return float(of_name.mean())
    if statistic == "standard deviation":
        return float(of_name.std(ddof=1))
    return float(np.quantile(of_name, float(statistic.rpartition(" ")[2])))


def statistic_problems(
    aims: Mapping[str, Aim], limits: Mapping[str, Limit], robust: Robust | None, good: Mapping[str, Limit]
) -> Iterator[Problem]:
    """Yield statistics without gearboxes about a design, and a yield without limits of a good gearbox."""
    for table, name in (*(("aim", name) for name in aims), *(("limit", name) for name in limits)):
        if is_statistic(name) and robust is None:
            expected = "[optimisation.robust] beside a statistic: gearboxes that scatter about each design"
            yield Problem(key_of(("optimisation", table, name)), UNSAID, expected)
        if name == YIELD and not good:
            yield Problem(
                key_of(("optimisation", table, name)), UNSAID, "limits of a good gearbox in [variation.limit]"
            )


def goals_of(
    aims: Mapping[str, Aim],
    limits: Mapping[str, Limit],
    names: Sequence[str],
    robust: Robust | None = None,
    good: Mapping[str, Limit] | None = None,
) -> Goals:
    """Return the goals by the names of the quantities that gearboxes have; ``good`` are the limits of a yield.

    Raises
    ------
    CaseError
        Where an aim or a limit is of a quantity that the gearboxes do not have.
    """
    problems = list[Problem]()

    def matching(table: str, name: str) -> tuple[str, ...]:
        if name == YIELD:
            return (YIELD,)
        statistic, pattern = statistic_of(name)
        found = tuple(one for one in names if matches(one, pattern))
        if statistic:
            found = tuple(f"{statistic} of {one}" for one in found)
        if not found:
            expected = f"a quantity that these gearboxes have{did_you_mean(name, names)}; there are: {', '.join(names)}"
            problems.append(Problem(key_of(("optimisation", table, name)), UNSAID, expected))
        return found

    good = {} if good is None or YIELD not in (*aims, *limits) else known_limits(good, names)
    goals = [
        Goal(name, matching("aim", name), 1.0 if aim.sense == "least" else -1.0, aim.weight)
        for name, aim in aims.items()
    ]
    ends = [end for name, limit in limits.items() for one in matching("limit", name) for end in _ends(one, name, limit)]
    if problems:
        raise CaseError(problems)
    return Goals(tuple(goals), tuple(ends), robust, good)


def _ends(name: str, key: str, limit: Limit) -> Iterator[LimitEnd]:
    if limit.at_most is not None:
        yield LimitEnd(name, limit.at_most, 1.0, key)
    if limit.at_least is not None:
        yield LimitEnd(name, limit.at_least, -1.0, key)
