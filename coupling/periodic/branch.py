"""Branch of periodic motions over speed: corrector steps at a given speed, and by pseudo-arclength.

States are total motions at the nodes of the period, on all coordinates that are followed, rates in the fastest drive's:
shape (K, 2 k). They are relative to a typical motion, and speeds relative to the speed range.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import PeriodicError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.periodic.orbit import Elements, PeriodMotion, integrate_period
from gearwhine.coupling.periodic.response import PeriodicResponse
from gearwhine.coupling.periodic.shooting import Problem, problem, response_of

FloatArray = npt.NDArray[np.float64]

_CORRECTIONS = 8
_CLOSED_MOTION_ERROR = 1e-10  # closure relative to the motion
_MOST_HALVINGS = 4  # largest number of halvings of the elements beyond that at the branch's start
# Number of points after which coarser elements are tried again; it doubles after each failure.
_PATIENCE, _LONGEST_PATIENCE = 3, 48
_LEAST_HALVINGS = 1  # least number of halvings: with fewer, multipliers err by more than the states
_TOO_GOOD = 3e-3  # part of the tolerance: elements twice as large err tens to hundreds of times as much
_DIFFERENCE = 1e-7  # step of the derivative by speed over the speed range, short as flanks may begin to graze


@dataclass(frozen=True, eq=False)
class Point:
    """A periodic motion on the branch.

    Attributes
    ----------
    ready : Problem
    states : ndarray, shape (K, 2 k)
    speed : float
    motion : PeriodMotion
        Motion with the monodromy matrices of its segments.
    response : PeriodicResponse
        Response with its proof.
    corrections : int
    missed : float
        Distance of the point from its prediction.
    branch : Branch
    towards : tuple of ndarray and float, optional
        Direction of the step to this point, states and speed; by default that of rising speed.
    change : ndarray, optional
        Derivative of the closure errors by speed, where it is known, shape (K, 2 N).
    """

    ready: Problem
    states: FloatArray
    speed: float
    motion: PeriodMotion
    response: PeriodicResponse
    corrections: int
    missed: float
    branch: "Branch"
    towards: tuple[FloatArray, float] | None = None
    change: FloatArray | None = None

    @cached_property
    def tangent(self) -> tuple[FloatArray, float]:
        """Tangent of the branch: states and speed in their units, of norm 1."""
        branch, motion = self.branch, self.motion
        change = self.change
        if change is None:
            change = branch.by_speed(self.ready, self.states, self.speed, motion, self.response.level)
        zero, up = np.zeros_like(motion.misses), lift(self.ready)
        along, pace = (zero, 1.0) if self.towards is None else (self.towards[0] @ up / len(zero), self.towards[1])
        by_speed = change * (branch.span / branch.unit)
        moves, speed = motion.bordered_correction(zero, by_speed, along, pace, 1.0)
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
        self.lowest, self.highest = min(level, _LEAST_HALVINGS), level + _MOST_HALVINGS
        self.calm, self.patience = 0, _PATIENCE

    def _raise(self) -> None:
        """Refine the elements from here on; only shorter steps lead past a flank that grazes."""
        if self.level < self.highest:
            self.level += 1
            self.patience = min(2 * self.patience, _LONGEST_PATIENCE) if self.calm < self.patience else _PATIENCE
            self.calm = 0

    def accept(self, error: float) -> None:
        """Count an accepted point; after several, or one of very small error, coarser elements are tried again."""
        self.calm += 1
        if self.level > self.lowest and (self.calm >= self.patience or error < _TOO_GOOD * self.tolerance):
            self.level -= 1
            self.calm = 0

    def ready(self, speed: float, like: Problem | None) -> Problem:
        """Shooting problem of the machine at a speed."""
        system = self.system_at(speed)
        period = None if self.periods == 1 else self.periods * problem(system, like=like).period
        return problem(system, period, like)

    def distance(self, states: FloatArray, others: FloatArray) -> float:
        """Distance between the states of two motions, in the branch's unit."""
        return float(np.sqrt(np.mean(np.sum((states - others) ** 2, axis=1)))) / self.unit

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
        """Point at a given speed, predicted by the polynomial through other points; None where none is close to it.

        The step begins at the last point. A correction by more than ``within``, in the branch's unit, would lead to
        another branch.
        """
        last = among[-1]
        try:
            ready = self.ready(speed, last.ready)
            if len(among) == 1:
                along, pace = last.tangent
                states = last.states + (self.unit * (speed - last.speed) / (self.span * pace)) * along
                return self._close(ready, states, speed, within)
            weights = interpolation(np.array([point.speed for point in among]), speed)
            return self._close(ready, np.tensordot(weights, [point.states for point in among], 1), speed, within)
        except (PeriodicError, np.linalg.LinAlgError):
            return None

    def near(self, point: Point, speed: float, within: float) -> Point | None:
        """Point at another speed whose states are those of a given one but for ``within``, in the branch's unit."""
        try:
            return self._close(self.ready(speed, point.ready), point.states, speed, within)
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
            motion = integrate_period(ready.part, ready.contacts, elements, starts, varied=turn != 1)
            closed = motion.missing <= _CLOSED_MOTION_ERROR * ready.scale(motion.start)
            if closed and turn == 1:
                motion = integrate_period(ready.part, ready.contacts, elements, starts)
            if closed:
                return self._proved(ready, above(ready, starts), speed, motion, turn, predicted)
            if motion.missing > before:
                return None
            before = motion.missing
            if linear is None or turn != 1:
                linear = motion
            starts = starts + linear.correction(motion.misses)
            if not float(np.linalg.norm(starts - begin)) < limit:
                return None
        return None

    def along(self, point: Point, ds: float) -> Point | None:
        """Point a length ``ds`` along the branch; None where the corrections do not converge.

        A negative length goes against the tangent; the tangent of the point found goes with the step.
        """
        try:
            along, pace = point.tangent
            if ds < 0.0:
                along, pace, ds = -along, -pace, -ds
            predicted = point.states + ds * self.unit * along
            speed = point.speed + ds * self.span * pace
            return self._correct(point, predicted, speed, along, pace, ds)
        except (PeriodicError, np.linalg.LinAlgError):
            return None

    def _correct(
        self, point: Point, predicted: FloatArray, speed: float, along: FloatArray, pace: float, ds: float
    ) -> Point | None:
        states, count = predicted, len(predicted)
        ready = self.ready(speed, point.ready)
        by_speed: FloatArray | None = None
        before = np.inf
        for turn in range(_CORRECTIONS):
            elements = ready.elements(self.level)
            motion = integrate_period(ready.part, ready.contacts, elements, below(ready, states))
            if by_speed is None:
                by_speed = self.by_speed(ready, states, speed, motion, self.level) @ lift(ready).T
            behind = float(np.sum(along * (states - point.states))) / (count * self.unit)
            behind += pace * (speed - point.speed) / self.span - ds
            if turn > 0 and abs(behind) < 1e-9 and motion.missing <= _CLOSED_MOTION_ERROR * ready.scale(motion.start):
                return self._proved(
                    ready, states, speed, motion, turn, predicted, (along, pace), by_speed @ lift(ready)
                )
            if motion.missing > 10.0 * before:
                return None
            before = motion.missing
            moves, change = motion.bordered_correction(
                motion.misses / self.unit,
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

    def by_speed(
        self, ready: Problem, states: FloatArray, speed: float, motion: PeriodMotion, level: int
    ) -> FloatArray:
        """Differentiate the closure errors by speed, the states held, shape (K, 2 N).

        The elements are those of ``motion``: with other elements, the change of the error would exceed the difference.
        """
        change = _DIFFERENCE * self.span
        other = self.ready(speed + change, ready)
        start = below(other, states)
        stepped = integrate_period(other.part, other.contacts, other.elements(level), start, varied=False)
        return np.asarray((stepped.misses @ (lift(other).T @ lift(ready)) - motion.misses) / change)

    def _proved(
        self,
        ready: Problem,
        states: FloatArray,
        speed: float,
        motion: PeriodMotion,
        corrections: int,
        predicted: FloatArray,
        towards: tuple[FloatArray, float] | None = None,
        change: FloatArray | None = None,
    ) -> Point | None:
        """Verify a corrected point with elements half as large; else return None and refine from here on."""
        elements: Elements = ready.elements(self.level + 1)
        finer = integrate_period(ready.part, ready.contacts, elements, motion.starts, varied=False)
        error = float(np.linalg.norm(finer.ends - motion.ends)) / ready.scale(motion.start)
        if error > self.tolerance:
            self._raise()
            return None
        response = response_of(ready, motion, self.level, error, corrections)
        missed = self.distance(states, predicted)
        return Point(ready, states, speed, motion, response, corrections, missed, self, towards, change)


def interpolation(at: FloatArray, where: float) -> FloatArray:
    """Weights of the Lagrange interpolation from values at some places to another."""
    apart = at[:, None] - at[None, :] + np.eye(len(at))
    others = np.where(np.eye(len(at), dtype=bool), 1.0, where - at[None, :])
    return np.asarray(others.prod(axis=1) / apart.prod(axis=1))


def lift(ready: Problem) -> FloatArray:
    """Lift of states without rigid-body motions to all condensed coordinates, shape (2 k, 2 N)."""
    k, half = ready.part.basis.shape
    matrix = np.zeros((2 * k, 2 * half))
    matrix[:k, :half] = matrix[k:, half:] = ready.part.basis
    return matrix


def below(ready: Problem, states: FloatArray) -> FloatArray:
    """States relative to the reference's own response, from total motions, shape (K, 2 N)."""
    return np.asarray(states @ lift(ready) - _linear_response(ready))


def above(ready: Problem, starts: FloatArray) -> FloatArray:
    """Total motions from states relative to the reference, shape (K, 2 k)."""
    return np.asarray((starts + _linear_response(ready)) @ lift(ready).T)


def _linear_response(ready: Problem) -> FloatArray:
    """Return the linear reference's response at the nodes among these states, shape (K, 2 N)."""
    still = np.zeros(len(ready.part.mean))
    return np.array([-ready.part.state(still, still, time) for time in ready.nodes])
