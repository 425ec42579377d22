"""Optimised designs: the best, the Pareto front, convergence, and the bounds and limits that hold the best back."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.distributions import Discrete
from gearwhine.optimisation.design import AS_WRITTEN, DesignInput
from gearwhine.optimisation.goals import Goals, LimitEnd, Worse
from gearwhine.optimisation.search import FAILED, Ended, balanced, excess_of, pareto_front
from gearwhine.optimisation.verification import Verification
from gearwhine.solutions import Failure
from gearwhine.variation.inputs import Input

MOST_SHOWN = 20
"""Largest number of designs of a front that are written as cases."""
_AT_END = 1e-3  # part of a range or of a limit within which a value is at its end


@dataclass(frozen=True, eq=False)
class Design:
    """A design that has been tried.

    Attributes
    ----------
    point : ndarray, shape (d,)
    sides : mapping of str to tuple of float
        Low and high side of each quantity; twice its value without scatter. Empty of a design that failed.
    aims : ndarray, shape (aims,)
        Values of the aims in their units.
    minimised : ndarray, shape (a,)
        What the search makes least.
    excesses : ndarray, shape (l,)
        Excesses over the limits in their scales.
    failure : Failure or None
    """

    point: FloatArray
    sides: Worse
    aims: FloatArray
    minimised: FloatArray
    excesses: FloatArray
    failure: Failure | None = None

    @property
    def excess(self) -> float:
        """Sum of the excesses over the limits; 0 of a design within all."""
        return excess_of(self.minimised, self.excesses)

    @property
    def merit(self) -> tuple[float, float]:
        """Order of designs by one aim: the excess, then the aim."""
        return self.excess, float(self.minimised[0]) if self.excess < FAILED else math.inf


@dataclass(frozen=True, eq=False)
class Optimised:
    """An optimisation with every design that was tried.

    Attributes
    ----------
    inputs : tuple of DesignInput
    goals : Goals
    method : str
        Method of the search, in words.
    start : Design
        The case as it is written, which need not be within the bounds.
    written : tuple of str
        Value of each input in the case, as it is shown; empty where it has none.
    designs : tuple of Design
        In the order of their trial.
    ended : str
        Why the search ended: "budget", "converged" or "complete".
    gearboxes : int
        Gearboxes about each design.
    resumed : int
        Evaluations that an earlier run had found.
    verification : Verification or None
    """

    inputs: tuple[DesignInput, ...]
    goals: Goals
    method: str
    start: Design
    written: tuple[str, ...]
    designs: tuple[Design, ...]
    ended: Ended
    gearboxes: int = 1
    resumed: int = 0
    verification: Verification | None = None

    @cached_property
    def failures(self) -> dict[int, Failure]:
        """Designs without a result by number."""
        return {number: one.failure for number, one in enumerate(self.designs) if one.failure is not None}

    @cached_property
    def within(self) -> list[int]:
        """Numbers of the designs within all limits."""
        return [number for number, one in enumerate(self.designs) if one.excess == 0.0]

    @cached_property
    def front(self) -> list[int]:
        """Numbers of the designs within all limits that no other beats in all aims, by the first aim."""
        if not self.within:
            return []
        return [
            self.within[place] for place in pareto_front(np.array([self.designs[n].minimised for n in self.within]))
        ]

    @cached_property
    def chosen(self) -> dict[int, str]:
        """Designs to look at, by number, with what each is; the first is the best, or the one that fits all aims best.

        Empty where no design could be evaluated.
        """
        solved = [number for number, one in enumerate(self.designs) if one.failure is None and one.excess < FAILED]
        if not solved:
            return {}
        if not self.front:
            return {min(solved, key=lambda number: self.designs[number].merit): "nearest to the limits"}
        if self.goals.count == 1:
            return {self.front[0]: "best"}
        minimised = np.array([self.designs[number].minimised for number in self.front])
        chosen = {self.front[balanced(minimised)]: "balanced"}
        for place, goal in enumerate(self.goals.aims):
            number = self.front[int(np.argmin(minimised[:, place]))]
            chosen.setdefault(number, f"{'least' if goal.sign > 0.0 else 'most'} {goal.name}")
        return chosen

    @property
    def cases(self) -> dict[str, int]:
        """Designs that are written as cases, by the name of the file; none of machines of Python."""
        if not self.chosen or not any(one.tolerance for one in self.inputs):
            return {}
        best = {f"{'best' if self.front else 'nearest'}.toml": next(iter(self.chosen))}
        if self.goals.count == 1 or not self.front:
            return best
        places = np.unique(np.linspace(0, len(self.front) - 1, min(len(self.front), MOST_SHOWN)).astype(int))
        return best | {f"front-{rank}.toml": self.front[place] for rank, place in enumerate(places.tolist(), start=1)}

    @property
    def best(self) -> Design | None:
        """Best design, of several aims the balanced one; the nearest to the limits where none is within them."""
        return self.designs[next(iter(self.chosen))] if self.chosen else None

    def shown_value(self, place: int, design: Design) -> str:
        """Return the value of an input in a design, as it is shown."""
        one, at = self.inputs[place], float(design.point[place])
        if at == AS_WRITTEN:
            return self.written[place]
        return _shown(one, one.value(at))

    def shown_along(self, place: int, along: Input, design: Design) -> str:
        """Return the value in a design of a key that changes in step with an input; empty where it is as written."""
        at = float(design.point[place])
        return "" if at == AS_WRITTEN else _shown(along, along.value(at))

    @property
    def at_bounds(self) -> dict[str, str]:
        """Inputs of the best design at an end of their range or of a list that rises or falls, each with which."""
        if self.best is None:
            return {}
        ends = dict[str, str]()
        for one, at in zip(self.inputs, self.best.point.tolist(), strict=True):
            if isinstance(one.law, Discrete):
                listed = () if one.words or at == AS_WRITTEN else tuple(one.law.values)
                if len(listed) > 1 and listed in (tuple(sorted(listed)), tuple(sorted(listed, reverse=True))):
                    value = one.value(at)
                    ends |= {one.name: "last of its list"} if value == listed[-1] else {}
                    ends |= {one.name: "first of its list"} if value == listed[0] else {}
            elif at <= _AT_END or at >= 1.0 - _AT_END:
                ends[one.name] = "least" if at <= _AT_END else "largest"
        return ends

    @property
    def missed(self) -> list[tuple[LimitEnd, float]]:
        """Limits that the best design misses, each with the value there."""
        best = self.best
        if best is None:
            return []
        return [(one, one.value(best.sides)) for one in self.goals.limits if one.excess(best.sides) > 0.0]

    @property
    def active_limits(self) -> list[LimitEnd]:
        """Limits that hold the best design back."""
        best = self.best
        if best is None:
            return []
        return [one for one in self.goals.limits if -_AT_END < one.excess(best.sides) <= 0.0]

    def values(self) -> FloatArray:
        """Values of the inputs of each design, shape (n, d)."""
        rows = [[one.value(float(at)) for one, at in zip(self.inputs, d.point, strict=True)] for d in self.designs]
        return np.array(rows).reshape(len(self.designs), len(self.inputs))


def _shown(one: Input, value: float) -> str:
    """Return a value of an input with its unit, or the word that it stands for."""
    return one.words[round(value)] if one.words else f"{value:.6g} {one.unit}".strip()


def design_of(point: FloatArray, found: Sequence[Mapping[str, float]], failure: Failure | None, goals: Goals) -> Design:
    """Return a design with its aims and excesses by the quantities of its gearboxes."""
    sides = {} if failure is not None else goals.sides(found)
    return Design(point, sides, goals.values(sides), goals.minimised(sides), goals.excesses(sides), failure)
