"""Branch of periodic motions over speed: corrector steps at a given speed, and by pseudo-arclength.

States are total motions at the nodes of the period, on all coordinates that are followed, rates in the fastest drive's:
shape (K, 2 k). They are relative to a typical motion, and speeds relative to the speed range.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from coupling.errors import PeriodicError
from coupling.machine.coupled_system import CoupledSystem
from coupling.periodic.orbit import Elements, PeriodMotion, integrate_period
from coupling.periodic.response import PeriodicResponse
from coupling.periodic.shooting import Problem, problem, response_of

FloatArray = npt.NDArray[np.float64]

_CORRECTIONS = 8
_CLOSED = 1e-10  # closure relative to the motion
_HIGHEST = 4  # halvings of the elements beyond those that a branch began with
# Points after which coarser ones are tried again: twice as many after each failure.
_PATIENCE, _LONGEST_PATIENCE = 3, 48
_LOWEST = 1  # halvings: with fewer, multipliers err by more than the states
_TOO_GOOD = 3e-3  # part of the tolerance: elements twice as large err tens to hundreds of times as much
_DIFFERENCE = 1e-7  # of the speed range, for the derivative by speed: flanks may begin to graze within a hair of it


@dataclass(frozen=True, eq=False)
class Point:
    """A periodic motion on the branch.

    Attributes
    ----------
    ready : Problem
    states : ndarray, shape (K, 2 k)
    speed : float
    found : PeriodMotion
        With the pieces of the monodromy.
    response : PeriodicResponse
        With its proof.
    corrections : int
    missed : float
        Distance of the prediction.
    branch : Branch
    towards : tuple of ndarray and float, optional
        Direction of the step to this point, states and speed; by default that of rising speed.
    change : ndarray, optional
        Derivative of the closure errors by speed, where it is known, shape (K, 2 N).
    """

    ready: Problem
    states: FloatArray
    speed: float
    found: PeriodMotion
    response: PeriodicResponse
    corrections: int
    missed: float
    branch: "Branch"
    towards: tuple[FloatArray, float] | None = None
    change: FloatArray | None = None

    @cached_property
    def tangent(self) -> tuple[FloatArray, float]:
        """Tangent of the branch: states and speed in their units, of norm 1."""
        branch, found = self.branch, self.found
        change = self.change
        if change is None:
            change = branch.by_speed(self.ready, self.states, self.speed, found, self.response.level)
        zero, up = np.zeros_like(found.misses), lift(self.ready)
        along, pace = (zero, 1.0) if self.towards is None else (self.towards[0] @ up / len(zero), self.towards[1])
        by_speed = change * (branch.span / branch.unit)
        moves, speed = found.bordered_correction(zero, by_speed, along, pace, 1.0)
        states = moves @ up.T
        length = np.sqrt(np.mean(np.sum(states**2, axis=1)) + speed**2)
        return states / length, speed / length


class Branch:
    """Corrector of the branch: settings that hold along it, and its steps."""

    def __init__(
        self,
        system_at: Callable[[float], CoupledSystem],
        periods: int,
        span: float,
        level: int,
        tolerance: float,
        unit: float,
    ) -> None:
        self.system_at, self.periods, self.span = system_at, periods, span
        self.level, self.tolerance, self.unit = level, tolerance, unit
        self.lowest, self.highest = min(level, _LOWEST), level + _HIGHEST
        self.calm, self.patience = 0, _PATIENCE

    def _raise(self) -> None:
        """Finer elements from here on; past a flank that grazes only shorter steps lead."""
        if self.level < self.highest:
            self.level += 1
            self.patience = min(2 * self.patience, _LONGEST_PATIENCE) if self.calm < self.patience else _PATIENCE
            self.calm = 0

    def accept(self, error: float) -> None:
        """Count an accepted point; after some of them, or one of very small error, coarser elements are tried again."""
        self.calm += 1
        if self.level > self.lowest and (self.calm >= self.patience or error < _TOO_GOOD * self.tolerance):
            self.level -= 1
            self.calm = 0

    def ready(self, speed: float, like: Problem | None) -> Problem:
        """Shooting problem of the machine at a speed."""
        system = self.system_at(speed)
        period = None if self.periods == 1 else self.periods * problem(system, like=like).period
        return problem(system, period, like)

    def distance(self, one: FloatArray, other: FloatArray) -> float:
        """Distance between the states of two motions, in the branch's unit."""
        return float(np.sqrt(np.mean(np.sum((one - other) ** 2, axis=1)))) / self.unit

    def first(self, response: PeriodicResponse, speed: float) -> Point:
        """Point of a known motion."""
        ready = self.ready(speed, None)
        q, v = response.at_nodes(ready.segments)
        states = np.concatenate([q[:, ready.kept], v[:, ready.kept] / ready.part.rate_unit], axis=1)
        while True:
            level = self.level
            point = self._close(ready, states, speed, np.inf)
            if point is not None:
                return point
            if self.level == level:
                raise PeriodicError(
                    f"the motion at {speed:g} does not hold with the elements that the branch is followed by"
                )

    def hold(self, among: Sequence[Point], speed: float, within: float) -> Point | None:
        """Point at a given speed, predicted by the polynomial through others; None where it is not found near there.

        The step begins at the last of them. A correction by more than ``within``, in the branch's unit, would lead to
        another branch.
        """
        here = among[-1]
        try:
            ready = self.ready(speed, here.ready)
            if len(among) == 1:
                along, pace = here.tangent
                states = here.states + (self.unit * (speed - here.speed) / (self.span * pace)) * along
                return self._close(ready, states, speed, within)
            weights = interpolation(np.array([point.speed for point in among]), speed)
            return self._close(ready, np.tensordot(weights, [point.states for point in among], 1), speed, within)
        except (PeriodicError, np.linalg.LinAlgError):
            return None

    def _close(self, ready: Problem, predicted: FloatArray, speed: float, within: float) -> Point | None:
        """Correct a prediction at its speed.

        Between changes of contact the closure errors are nearly linear in the states: two corrections by the
        prediction's own monodromy close most motions, where those of other speeds take many.
        """
        elements, begin = ready.elements(self.level), below(ready, predicted)
        limit = within * self.unit * np.sqrt(len(predicted))
        starts, before = begin, np.inf
        linear: PeriodMotion | None = None
        for turn in range(_CORRECTIONS):
            # After the first correction the same pieces serve once more, and the last ones are exact.
            found = integrate_period(ready.part, ready.contacts, elements, starts, varied=turn != 1)
            closed = found.missing <= _CLOSED * ready.scale(found.start)
            if closed and turn == 1:
                found = integrate_period(ready.part, ready.contacts, elements, starts)
            if closed:
                return self._proved(ready, above(ready, starts), speed, found, turn, predicted)
            if found.missing > before:
                return None
            before = found.missing
            if linear is None or turn != 1:
                linear = found
            starts = starts + linear.correction(found.misses)
            if not float(np.linalg.norm(starts - begin)) < limit:
                return None
        return None

    def along(self, here: Point, ds: float) -> Point | None:
        """Point a length ``ds`` along the branch; None where the corrections do not converge.

        A negative length goes against the tangent; the tangent of the point found goes with the step.
        """
        try:
            along, pace = here.tangent
            if ds < 0.0:
                along, pace, ds = -along, -pace, -ds
            predicted = here.states + ds * self.unit * along
            speed = here.speed + ds * self.span * pace
            return self._correct(here, predicted, speed, along, pace, ds)
        except (PeriodicError, np.linalg.LinAlgError):
            return None

    def _correct(
        self, here: Point, predicted: FloatArray, speed: float, along: FloatArray, pace: float, ds: float
    ) -> Point | None:
        states, count = predicted, len(predicted)
        ready = self.ready(speed, here.ready)
        by_speed: FloatArray | None = None
        before = np.inf
        for turn in range(_CORRECTIONS):
            elements = ready.elements(self.level)
            found = integrate_period(ready.part, ready.contacts, elements, below(ready, states))
            if by_speed is None:
                by_speed = self.by_speed(ready, states, speed, found, self.level) @ lift(ready).T
            behind = float(np.sum(along * (states - here.states))) / (count * self.unit)
            behind += pace * (speed - here.speed) / self.span - ds
            if turn > 0 and abs(behind) < 1e-9 and found.missing <= _CLOSED * ready.scale(found.start):
                return self._proved(ready, states, speed, found, turn, predicted, (along, pace), by_speed @ lift(ready))
            if found.missing > 10.0 * before:
                return None
            before = found.missing
            moves, change = found.bordered_correction(
                found.misses / self.unit,
                by_speed @ lift(ready) * (self.span / self.unit),
                along @ lift(ready) / count,
                pace,
                -behind,
            )
            if not np.all(np.isfinite(moves)) or np.linalg.norm(moves) > 10.0 * np.sqrt(count):
                return None
            states = states + self.unit * (moves @ lift(ready).T)
            speed = speed + self.span * change
            ready = self.ready(speed, ready)
        return None

    def by_speed(self, ready: Problem, states: FloatArray, speed: float, found: PeriodMotion, level: int) -> FloatArray:
        """Differentiate the closure errors by speed, the states held, shape (K, 2 N).

        The elements are those of ``found``: the error of others would differ, over a tiny difference of speed.
        """
        change = _DIFFERENCE * self.span
        other = self.ready(speed + change, ready)
        start = below(other, states)
        there = integrate_period(other.part, other.contacts, other.elements(level), start, varied=False)
        return np.asarray((there.misses @ (lift(other).T @ lift(ready)) - found.misses) / change)

    def _proved(
        self,
        ready: Problem,
        states: FloatArray,
        speed: float,
        found: PeriodMotion,
        corrections: int,
        predicted: FloatArray,
        towards: tuple[FloatArray, float] | None = None,
        change: FloatArray | None = None,
    ) -> Point | None:
        """Verify a corrected point with elements half as large; else return None and refine from here on."""
        elements: Elements = ready.elements(self.level + 1)
        finer = integrate_period(ready.part, ready.contacts, elements, found.starts, varied=False)
        error = float(np.linalg.norm(finer.ends - found.ends)) / ready.scale(found.start)
        if error > self.tolerance:
            self._raise()
            return None
        response = response_of(ready, found, self.level, error, corrections)
        missed = self.distance(states, predicted)
        return Point(ready, states, speed, found, response, corrections, missed, self, towards, change)


def interpolation(at: FloatArray, where: float) -> FloatArray:
    """Weights of the Lagrange interpolation from values at some places to another."""
    apart = at[:, None] - at[None, :] + np.eye(len(at))
    others = np.where(np.eye(len(at), dtype=bool), 1.0, where - at[None, :])
    return np.asarray(others.prod(axis=1) / apart.prod(axis=1))


def lift(ready: Problem) -> FloatArray:
    """Lift of states without rigid-body motions to all condensed coordinates, shape (2 k, 2 N)."""
    k, half = ready.part.basis.shape
    found = np.zeros((2 * k, 2 * half))
    found[:k, :half] = found[k:, half:] = ready.part.basis
    return found


def below(ready: Problem, states: FloatArray) -> FloatArray:
    """States relative to the reference's own response, from total motions, shape (K, 2 N)."""
    return np.asarray(states @ lift(ready) - _own(ready))


def above(ready: Problem, starts: FloatArray) -> FloatArray:
    """Total motions from states relative to the reference, shape (K, 2 k)."""
    return np.asarray((starts + _own(ready)) @ lift(ready).T)


def _own(ready: Problem) -> FloatArray:
    """Return the linear reference's response at the nodes among these states, shape (K, 2 N)."""
    still = np.zeros(len(ready.part.mean))
    return np.array([-ready.part.state(still, still, time) for time in ready.nodes])
