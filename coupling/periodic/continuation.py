"""How the periodic motion changes with speed: its branch, followed through folds.

Where contact is lost several motions exist at one speed, and the branch of motions turns back in speed at folds: there
a machine that is run up or down jumps. The branch is followed along its own length s (Keller's pseudo-arclength): with
the tangent (x', p') of the state x and the speed p, a step ds along it is corrected by Newton's method on

    [ M - I   r_p ] [Δx]     [ r                                 ]
    [ x'ᵀ     p'  ] [Δp] = - [ x'ᵀ (x - x₀) + p' (p - p₀) - ds ],     r = x(T) - x(0),

which is regular at folds. States are counted in a typical motion and speeds in the range asked for, r_p is a finite
difference, and the step follows the number of corrections and the turn of the tangent.

Away from folds the correction holds the speed that the tangent predicts: one machine serves the whole correction, its
M as long as the closure falls fast, and what M costs over a long period is paid once or twice.

- H. B. Keller, "Numerical solution of bifurcation and nonlinear eigenvalue problems", *Applications of Bifurcation
  Theory*, 1977.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError, PeriodicError
from coupling.periodic.orbit import Pass, one_pass
from coupling.periodic.response import PeriodicResponse
from coupling.periodic.response_curve import Bifurcation, Event, ResponseCurve
from coupling.periodic.shooting import Problem, periodic_response, problem, response_of
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]

_CORRECTIONS = 8
_FEW = 7  # of them, after which the next step may be longer
_CLOSED = 1e-10  # closure relative to the motion
_DIFFERENCE = 1e-7  # of the speed range, for the derivative by speed: flanks may begin to graze within a hair of it
_STEEP = 0.05  # part of a tangent along the speed below which a fold may be near
_LEVEL = 0.2  # and beyond which none is
_FALLING = 0.3  # by which a correction has to lower the closure for M to serve again
_MOST_HELD = 14  # corrections, most of them without M
_ASIDE = 0.3  # part of a step by which a correction may move it: beyond, it is on its way to another branch
_COARSER = 2  # levels below that of the first motion, which proves its monodromy too
_FARTHEST = 0.3  # part of the motion by which a step may change it ...
_STILL = 0.1  # ... motions below this part of the first one count as that
_SHARPEST_TURN = 0.9  # least cosine between tangents of neighbouring points where a fold may be near ...
_SHARPEST_HELD = 0.6  # ... and elsewhere: the correction itself says whether the prediction was good
_TURNING = 0.8  # cosine below which the next step is shorter by as much
_SHORTEST = 1e-3  # of the largest step, below which the branch is lost
_LOCATIONS = 30  # steps in the location of a fold or a loss of stability
_LOCATED = 1e-5  # of a step: the speed of a fold errs by the square


@dataclass(frozen=True, eq=False)
class _Point:
    """A motion on the branch: the state on all followed coordinates in its own units, its tangent, its proof."""

    ready: Problem
    state: FloatArray
    speed: float
    found: Pass
    state_tangent: FloatArray
    speed_tangent: float
    response: PeriodicResponse


class _Branch:
    """What stays the same along a branch, and one step of it."""

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

    def ready(self, speed: float, like: Problem | None) -> Problem:
        system = self.system_at(speed)
        period = None if self.periods == 1 else self.periods * problem(system, like=like).period
        return problem(system, period, like)

    def first(self, response: PeriodicResponse, speed: float, ahead: float) -> _Point:
        """The point of a motion that is known, its tangent towards a side of the speed."""
        ready = self.ready(speed, None)
        q, v = response.displacement[ready.kept], response.velocity[ready.kept]
        state = np.concatenate([q, v / ready.part.rate_unit])
        zero = np.zeros(len(state))
        while True:
            level = self.level
            point = self._correct(ready, state, speed, zero, ahead, state, speed, 0.0)
            if point is not None:
                return point
            if self.level == level:
                raise PeriodicError(
                    f"the motion at {speed:g} does not hold with the elements that the branch is followed by"
                )

    def step(self, origin: _Point, ds: float, *, hold: bool = True) -> _Point | None:
        """The point of the branch a length further; None where the corrections do not come to an end.

        Where the speed may be held, the length is that of the prediction.
        """
        state = origin.state + ds * self.unit * origin.state_tangent
        speed = origin.speed + ds * self.span * origin.speed_tangent
        try:
            ready = self.ready(speed, origin.ready)
            if hold and abs(origin.speed_tangent) > _STEEP:
                level = self.level
                point = self._hold(ready, state, speed, origin, ds)
                # Far from folds a shorter step is cheaper than one whose every correction moves the speed.
                if point is not None or self.level > level or abs(origin.speed_tangent) > _LEVEL:
                    return point
            tangent = (origin.state_tangent, origin.speed_tangent)
            return self._correct(ready, state, speed, *tangent, origin.state, origin.speed, ds)
        except PeriodicError:
            return None

    def _hold(self, ready: Problem, state: FloatArray, speed: float, origin: _Point, ds: float) -> _Point | None:
        """A prediction corrected at its speed."""
        lift, elements = _lift(ready), ready.elements(self.level)
        predicted = lift.T @ state - _own(ready)
        # The last point's M first; one of its own where that does not bring the closure down.
        among = lift.T @ _lift(origin.ready)
        monodromy, fresh = among @ origin.found.monodromy @ among.T, False
        found = one_pass(ready.part, ready.contacts, elements, predicted, varied=False)
        best, turns = float(np.linalg.norm(found.closure)), 0
        while best > _CLOSED * ready.scale(found.start):
            if turns == _MOST_HELD:
                return None
            turns += 1
            start = found.start - np.linalg.solve(monodromy - np.eye(len(predicted)), found.closure)
            near = float(np.linalg.norm(start - predicted)) < _ASIDE * abs(ds) * self.unit
            there = one_pass(ready.part, ready.contacts, elements, start, varied=False) if near else found
            missing = float(np.linalg.norm(there.closure))
            if missing <= _FALLING * best:
                found, best, fresh = there, missing, False
                continue
            if fresh:
                return None
            if missing < best:
                found, best = there, missing
            found, fresh = one_pass(ready.part, ready.contacts, elements, found.start), True
            monodromy = found.monodromy
        if not fresh:
            found = one_pass(ready.part, ready.contacts, elements, found.start)
        state = lift @ (found.start + _own(ready))
        by_speed = self._by_speed(ready, state, speed, lift @ found.closure)
        matrix = self._bordered(ready, found, by_speed, origin.state_tangent, origin.speed_tangent)
        return self._proved(ready, state, speed, found, *_tangent(ready, matrix), turns)

    def _bordered(
        self, ready: Problem, found: Pass, by_speed: FloatArray, along: FloatArray, along_speed: float
    ) -> FloatArray:
        """The matrix of a correction along the branch, shape (2 N + 1, 2 N + 1)."""
        lift, size = _lift(ready), len(found.start)
        matrix = np.zeros((size + 1, size + 1))
        matrix[:size, :size] = found.monodromy - np.eye(size)
        matrix[:size, size] = lift.T @ by_speed * (self.span / self.unit)
        matrix[size, :size], matrix[size, size] = lift.T @ along, along_speed
        return matrix

    def _correct(
        self,
        ready: Problem,
        state: FloatArray,
        speed: float,
        along: FloatArray,
        along_speed: float,
        origin: FloatArray,
        origin_speed: float,
        ds: float,
    ) -> _Point | None:
        by_speed: FloatArray | None = None
        for turn in range(_CORRECTIONS):
            lift = _lift(ready)
            elements = ready.elements(self.level)
            start = lift.T @ state - _own(ready)
            found = one_pass(ready.part, ready.contacts, elements, start)
            closure = lift @ found.closure
            if by_speed is None:
                by_speed = self._by_speed(ready, state, speed, closure)
            behind = float(along @ (state - origin)) / self.unit
            behind += along_speed * (speed - origin_speed) / self.span - ds
            size = len(start)
            matrix = self._bordered(ready, found, by_speed, along, along_speed)
            closed = np.linalg.norm(closure) <= _CLOSED * ready.scale(start)
            if closed and turn > 0 and abs(behind) < 1e-9:
                return self._proved(ready, state, speed, found, *_tangent(ready, matrix), turn)
            right = -np.concatenate([lift.T @ closure / self.unit, [behind]])
            move = np.linalg.solve(matrix, right)
            if not np.all(np.isfinite(move)) or np.linalg.norm(move) > 10.0:
                return None
            state = state + self.unit * (lift @ move[:size])
            speed = speed + self.span * float(move[size])
            ready = self.ready(speed, ready)
        return None

    def _by_speed(self, ready: Problem, state: FloatArray, speed: float, closure: FloatArray) -> FloatArray:
        """Derivative of the closure by speed, the state held."""
        change = _DIFFERENCE * self.span
        other = self.ready(speed + change, ready)
        lift = _lift(other)
        start = lift.T @ state - _own(other)
        there = one_pass(other.part, other.contacts, other.elements(self.level), start, varied=False)
        return np.asarray((lift @ there.closure - closure) / change)

    def _proved(
        self,
        ready: Problem,
        state: FloatArray,
        speed: float,
        found: Pass,
        tangent: FloatArray,
        speed_tangent: float,
        corrections: int,
    ) -> _Point | None:
        """A corrected point, where elements half as large agree; else finer ones from here on."""
        finer = one_pass(ready.part, ready.contacts, ready.elements(self.level + 1), found.start, varied=False)
        error = float(np.linalg.norm(finer.end - found.end)) / ready.scale(found.start)
        if error > self.tolerance:
            self.level += 1
            return None
        response = response_of(ready, found, self.level, error, corrections)
        return _Point(ready, state, speed, found, tangent, speed_tangent, response)


def response_curve(
    system_at: Callable[[float], CoupledSystem],
    start: float,
    end: float,
    *,
    first: tuple[FloatArray, FloatArray] | PeriodicResponse | None = None,
    points: int = 100,
    most_points: int = 2000,
    periods: int = 1,
    tolerance: float = 1e-6,
    progress: Callable[[float], None] = lambda fraction: None,
) -> ResponseCurve:
    """Follow the periodic motion from one speed to another, through folds.

    Parameters
    ----------
    system_at : callable
        The machine at a speed, in any unit: gyroscopic terms, unbalance, bearings and mesh rates may all follow it.
    start, end : float
        Speeds between which the branch is followed; ``end`` may be the lower.
    first : tuple of ndarray, or PeriodicResponse, optional
        To search the first motion from, as ``start`` of :func:`periodic_response`.
    points : int
        On a branch that runs straight; more are taken where it turns.
    most_points : int
        After which the branch is left.
    periods : int
        In which the motion repeats: 2 follows a motion of twice the excitation's period.
    tolerance : float
        By which a halving of the elements may move the state after a period, relative.
    progress : callable
        Told the part of the speed range that has been reached, from 0 to 1.

    Returns
    -------
    ResponseCurve
        Its first point is at ``start``, its last at ``end``, unless the branch comes back to ``start`` before.

    Raises
    ------
    CouplingError
        Where the speeds are the same.
    PeriodicError
        Where the branch is lost.
    """
    span = end - start
    if not (np.isfinite(span) and span != 0.0 and points > 1 and most_points > 1 and periods > 0):
        raise CouplingError(f"a branch from {start} to {end} in {points} points; expected a range and some points")
    begin = system_at(start)
    period = None if periods == 1 else periods * problem(begin).period
    known = periodic_response(begin, period=period, start=first, tolerance=tolerance)
    ready = problem(begin, period)
    moving = np.concatenate([known.displacement[ready.kept], known.velocity[ready.kept] / ready.part.rate_unit])
    still = np.concatenate([ready.part.mean, np.zeros(len(ready.part.mean))])
    unit = max(float(np.linalg.norm(moving - still)), 0.1 * float(np.linalg.norm(still))) or 1.0
    branch = _Branch(system_at, periods, abs(span), max(known.level - 1 - _COARSER, 0), tolerance, unit)
    here = branch.first(known, start, np.sign(span))
    passed, events = [here], []
    largest = 1.0 / (points - 1)
    ds = _longest(branch, here, largest)
    while len(passed) < most_points:
        level = branch.level
        there = branch.step(here, ds)
        if there is None and branch.level > level:
            continue
        turn = 0.0 if there is None else _cosine(here, there)
        near_fold = there is not None and min(abs(here.speed_tangent), abs(there.speed_tangent)) <= _STEEP
        if there is None or turn < (_SHARPEST_TURN if near_fold else _SHARPEST_HELD):
            if ds > _SHORTEST * largest:
                ds *= 0.5
                continue
            if there is None:
                raise PeriodicError(
                    f"the branch is lost at a speed of {here.speed:g}, after {len(passed)} points: the flanks may "
                    "begin to graze there, or the motion ends; start anew on its other side"
                )
        left = (there.speed - end) * span > 0.0
        back = (there.speed - start) * span < 0.0
        if left or back:
            there = _arrive(branch, here, ds, end if left else start)
            if there is None:
                ds *= 0.5
                continue
        event, between = _event(branch, here, there, ds)
        if event is not None and between is not None:
            events.append(Bifurcation(len(passed), event, between.speed))
            passed.append(between)
        passed.append(there)
        here = there
        progress(min(max((there.speed - start) / span, 0.0), 1.0))
        if left or back:
            break
        if there.response.newton_steps <= _FEW and turn > (0.97 if near_fold else 0.9):
            ds *= 1.5
        elif turn < _TURNING:
            ds *= _TURNING
        ds = min(ds, _longest(branch, here, largest))
    return ResponseCurve(
        speeds=np.array([point.speed for point in passed]),
        responses=tuple(point.response for point in passed),
        bifurcations=tuple(events),
        system_at=system_at,
        periods=periods,
    )


def _lift(ready: Problem) -> FloatArray:
    """States on all followed coordinates from those that something resists, shape (2 k, 2 N)."""
    k, half = ready.part.basis.shape
    lift = np.zeros((2 * k, 2 * half))
    lift[:k, :half] = lift[k:, half:] = ready.part.basis
    return lift


def _tangent(ready: Problem, matrix: FloatArray) -> tuple[FloatArray, float]:
    """Along the branch, by the matrix of a correction that is done."""
    size = len(matrix) - 1
    tangent = np.linalg.solve(matrix, np.eye(size + 1)[size])
    tangent /= np.linalg.norm(tangent)
    return _lift(ready) @ tangent[:size], float(tangent[size])


def _own(ready: Problem) -> FloatArray:
    """The reference's own response at t = 0 among these states, shape (2 N,)."""
    return -ready.part.state(np.zeros(len(ready.part.mean)), np.zeros(len(ready.part.mean)))


def _cosine(one: _Point, other: _Point) -> float:
    return float(one.state_tangent @ other.state_tangent) + one.speed_tangent * other.speed_tangent


def _longest(branch: _Branch, here: _Point, largest: float) -> float:
    """A step that moves neither the speed nor the motion too far."""
    half = len(here.state) // 2
    moved = float(np.linalg.norm(here.state[:half] - here.ready.part.mean))
    motion = max(moved, float(np.linalg.norm(here.state[half:])), _STILL * branch.unit)
    by_speed = largest / max(abs(here.speed_tangent), 1e-9)
    by_motion = _FARTHEST * motion / branch.unit / max(float(np.linalg.norm(here.state_tangent)), 1e-9)
    return min(by_speed, by_motion)


def _arrive(branch: _Branch, here: _Point, ds: float, speed: float) -> _Point | None:
    """The point at a speed within the next step."""
    low, high = 0.0, ds
    below, above = here.speed - speed, None
    point = branch.step(here, ds)
    for _ in range(_LOCATIONS):
        if point is None:
            return None
        above = point.speed - speed
        if abs(above) <= 1e-12 * branch.span:
            return point
        if above * below < 0.0:
            part = below / (below - above)
            high = ds
        else:
            low, below = ds, above
            part = 0.5
        guess = low + part * (high - low)
        # Newton's step along the branch is sharper near the end.
        slope = point.speed_tangent * branch.span
        newton = ds - above / slope if slope != 0.0 else guess
        ds = newton if abs(newton - ds) < 0.5 * (high - low) else guess
        point = branch.step(here, ds)
    return point


def _event(branch: _Branch, here: _Point, there: _Point, ds: float) -> tuple[Event | None, _Point | None]:
    """What happens between two points, and where."""
    turned = here.speed_tangent * there.speed_tangent < 0.0
    few, many = sorted((here.response.floquet.growing, there.response.floquet.growing))
    if not turned and few == many:
        return None, None

    def test(point: _Point) -> float:
        if turned:
            return point.speed_tangent
        return float(np.abs(point.response.floquet.values[many - 1]) - 1.0)

    low, high, at_low, at_high = 0.0, ds, test(here), test(there)
    best = there
    if at_low * at_high < 0.0:
        for turn in range(_LOCATIONS):
            # False position, and bisection every third time so that no side is kept for ever.
            part = 0.5 if turn % 3 == 2 else at_low / (at_low - at_high)
            middle = low + min(max(part, 0.01), 0.99) * (high - low)
            point = branch.step(here, middle, hold=False)
            if point is None:
                break
            best, value = point, test(point)
            if value == 0.0 or high - low <= _LOCATED * ds or abs(value) < 1e-8:
                break
            if value * at_low < 0.0:
                high, at_high = middle, value
            else:
                low, at_low = middle, value
    if turned:
        return "fold", best
    crossing = best.response.floquet.values[many - 1]
    if abs(crossing.imag) > 1e-6:
        return "Neimark-Sacker", best
    return ("period doubling" if crossing.real < 0.0 else "branch point"), best
