"""Continuation of the periodic motion over speed, through folds, by Keller's pseudo-arclength method: response curve.

A response curve is a branch of periodic motions over speed, with its bifurcations. Where contact is lost several
motions exist at one speed, and the branch of motions turns back in speed at folds: there a machine that is run up or
down jumps.

Away from folds the speed is given: the polynomial through the last motions predicts the next one, and the monodromy of
the prediction corrects it; the exact monodromy of the corrected motion decides its stability. The order of the
polynomial is the one that would have predicted the last motion best, and the step follows from its error.

Where that does not converge, the branch is followed along its own length s (pseudo-arclength): with the tangent
(x', p') of the states x and the speed p, a step ds along it is corrected by Newton's method on

    [ A    r_p ] [Δx]     [ r                                 ]
    [ x'ᵀ  p'  ] [Δp] = - [ x'ᵀ (x - x₀) + p' (p - p₀) - ds ],     r = closure errors of all segments,

which is regular at folds; A is cyclic in the segments, see :mod:`coupling.periodic.orbit`. r_p is a finite
difference.

- H. B. Keller, "Numerical solution of bifurcation and nonlinear eigenvalue problems", *Applications of Bifurcation
  Theory*, 1977.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError, PeriodicError
from coupling.machine.coupled_system import CoupledSystem
from coupling.periodic.branch import Branch, Point, interpolation
from coupling.periodic.response import BranchMotion, PeriodicResponse, motion_summary
from coupling.periodic.shooting import integrated_again, periodic_response, problem, response_near

FloatArray = npt.NDArray[np.float64]
Ending = Literal["end", "start", "lost", "points", "tries"]
Event = Literal["fold", "period doubling", "Neimark-Sacker", "branch point"]


@dataclass(frozen=True)
class Bifurcation:
    """Bifurcation: a fold of the branch, or a change of its stability.

    Attributes
    ----------
    index : int
        Index of the bifurcation's point on the curve.
    kind : str
        ``fold`` where the branch turns back and a real machine jumps; ``period doubling`` where a multiplier passes
        -1, ``Neimark-Sacker`` where a pair leaves the unit circle, ``branch point`` where one passes +1 on a branch
        that goes on.
    speed : float
        Speed in the unit of the curve.
    """

    index: int
    kind: Event
    speed: float


@dataclass(frozen=True, eq=False)
class ResponseCurve:
    """A branch of periodic motions, p points in the order in which they were followed; c contacts.

    Attributes
    ----------
    speeds : ndarray, shape (p,)
        Speeds in the unit of ``system_at``.
    responses : tuple of BranchMotion
        Summary of each motion; :meth:`motion` computes its course over time.
    bifurcations : tuple of Bifurcation
    ending : str
        ``end`` where the branch reached the given speed, ``start`` where it came back to its start; ``lost`` where no
        next point was found, ``points`` and ``tries`` at the largest number of these.
    aim : float
        Speed to which the branch was to be followed.
    """

    speeds: FloatArray
    responses: tuple[BranchMotion, ...]
    bifurcations: tuple[Bifurcation, ...]
    system_at: Callable[[float], CoupledSystem] = field(repr=False)
    periods: int = 1
    ending: Ending = "end"
    aim: float = np.nan

    @property
    def account(self) -> str:
        """Followed range and ending of the branch, in a sentence; speeds in the curve's own unit."""
        return self.told()

    def told(self, unit: float = 1.0, name: str = "") -> str:
        """Return the response curve with speeds divided by a named unit."""
        start, last, aim = (value / unit for value in (self.speeds[0], self.speeds[-1], self.aim))
        name = name and f" {name}"
        way = f"followed from {start:.6g} to {last:.6g}{name}: {len(self.speeds)} points, {len(self.folds)} folds"
        if self.ending == "end":
            return way
        sense = np.sign(self.aim - self.speeds[0])
        farthest = self.speeds[0] + sense * (sense * (self.speeds - self.speeds[0])).max()
        why = {
            "start": "the branch came back to where it began",
            "lost": "no next motion was found however near: the flanks may begin to graze there, or the motion ends",
            "points": "as many points as were allowed",
            "tries": "as many tries as were allowed",
        }[self.ending]
        return f"{way}; {why}. Between {farthest / unit:.6g} and {aim:.6g}{name} nothing was followed"

    @property
    def folds(self) -> tuple[Bifurcation, ...]:
        """Folds, at which the branch turns back in speed."""
        return tuple(event for event in self.bifurcations if event.kind == "fold")

    @property
    def stable(self) -> npt.NDArray[np.bool_]:
        """Whether each motion is stable, shape (p,)."""
        return np.array([response.stable for response in self.responses])

    @property
    def rms_compression(self) -> FloatArray:
        """Root mean square of every contact's compression about its mean [m], shape (p, c)."""
        return np.array([response.rms_compression for response in self.responses])

    @property
    def peak_force(self) -> FloatArray:
        """Largest force of every contact [N], shape (p, c)."""
        return np.array([response.peak_force for response in self.responses])

    @property
    def contact_loss(self) -> FloatArray:
        """Part of the period that the flanks of every contact are apart, shape (p, c)."""
        return np.array([response.contact_loss for response in self.responses])

    def motion(self, index: int) -> PeriodicResponse:
        """Integrate the periodic motion of a point again, from the starts of its segments."""
        branch_motion = self.responses[index]
        return integrated_again(
            self.system_at(float(self.speeds[index])), self._period(branch_motion.period), branch_motion
        )

    def at(self, speed: float, tolerance: float = 1e-8) -> list[PeriodicResponse]:
        """Every motion of the branch at a speed, in the branch's order.

        Raises
        ------
        CouplingError
            Where the branch does not come to this speed.
        PeriodicError
            Where a motion between two points is not found from them, or the tolerance is not met.
        """
        away = self.speeds - speed
        motions = [(float(i), self.motion(int(i))) for i in np.flatnonzero(away == 0.0)]
        for i in np.flatnonzero(away[:-1] * away[1:] < 0.0):
            part = away[i] / (away[i] - away[i + 1])
            motions.append((i + part, self._between(int(i), part, speed, tolerance)))
        if not motions:
            raise CouplingError(
                f"no motion at {speed:g}: the branch was followed from {self.speeds.min():g} to {self.speeds.max():g}"
            )
        return [response for _, response in sorted(motions, key=lambda one: one[0])]

    def _between(self, index: int, part: float, speed: float, tolerance: float) -> PeriodicResponse:
        """Solve for the motion at a speed that is a part of the way from one point to the next."""
        before, after = self.responses[index], self.responses[index + 1]
        # Rates are compared in their own period.
        length = 1.0 / (1.0 / before.period + part * (1.0 / after.period - 1.0 / before.period))
        q = (1.0 - part) * before.displacements + part * after.displacements
        v = ((1.0 - part) * before.velocities * before.period + part * after.velocities * after.period) / length
        level = max(before.level, after.level)
        return response_near(self.system_at(speed), self._period(length), (q, v), level, tolerance)

    def _period(self, length: float) -> float | None:
        return None if self.periods == 1 else length


_COARSER = 2  # number of levels below that of the first motion, whose monodromy is proved too
_KEPT = 5  # number of points that predict the next point
_MISSED = 3e-3  # target error of a prediction, relative to a motion
_ASIDE = 1.2e-2  # largest error of a prediction, beyond which it leads to another branch
_FARTHEST = 0.3  # largest relative change of a motion by a step along the branch
_SHARPEST_TURN = 0.9  # least cosine between tangents of neighbouring points along the branch
_SMOOTH = 0.97  # cosine beyond which the next step is longer
_FEW = 4  # largest number of corrections with which the next step is longer
_FAILURES = 3  # failed steps at given speed, each half as long, before pseudo-arclength steps
_SMALL = 0.05  # part of the largest step below which pseudo-arclength steps begin
_SHORTEST = 1e-4  # part of the largest step below which the branch is lost
_LOCATIONS = 30  # largest number of steps in the location of a bifurcation
_LOCATED = 1e-5  # tolerance of a located point over the step; the speed of a fold errs by its square


Seen = Callable[[float, PeriodicResponse], None]


class _Follower:
    """Continuation along a branch. Positions are parts of the speed range, 0 at its start and 1 at its end."""

    def __init__(
        self, branch: Branch, first: Point, start: float, end: float, points: int, most_tries: int, seen: Seen
    ) -> None:
        self.branch, self.start, self.end = branch, start, end
        self.largest, self.most_tries, self.tries = 1.0 / (points - 1), most_tries, 0
        self.speeds: list[float] = []
        self.motions: list[BranchMotion] = []
        self.events: list[Bifurcation] = []
        self.seen = seen
        self.recent = [first]  # since the speed last turned
        self.sense, self.stride, self.order = 1.0, 0.3 * self.largest, 1
        self.failures, self.by_arclength, self.ds = 0, False, 0.0
        self._keep(first)

    def position(self, speed: float) -> float:
        """Position of a speed in the range."""
        return (speed - self.start) / (self.end - self.start)

    def speed(self, position: float) -> float:
        """Speed at a position."""
        if position in (0.0, 1.0):
            return self.end if position == 1.0 else self.start
        return self.start + position * (self.end - self.start)

    def follow(self, most_points: int, progress: Callable[[float], None]) -> Ending:
        """Continue step by step, to an end of the range or of the branch."""
        while True:
            if len(self.speeds) >= most_points:
                return "points"
            if self.tries >= self.most_tries:
                return "tries"
            if self.by_arclength and self.ds < _SHORTEST * self.largest:
                return "lost"
            self.tries += 1
            point = self._along() if self.by_arclength else self._at_given_speed()
            if point is None:
                continue
            position = self.position(point.speed)
            progress(min(max(position, 0.0), 1.0))
            if position in (0.0, 1.0):
                return "end" if position == 1.0 else "start"

    def _at_given_speed(self) -> Point | None:
        """Take a continuation step at a given speed."""
        last = self.recent[-1]
        among = self.recent[-1 - self.order :]
        position = self.position(last.speed) + self.sense * self.stride
        level = self.branch.level
        point = self.branch.hold(among, self.speed(min(max(position, 0.0), 1.0)), self._within(last))
        if point is None:
            if self.branch.level <= level:
                self._failed()
            return None
        missed = max(point.missed / self._motion(point), 1e-12)
        self._accept(point, False)
        self.failures = 0
        grown = (_MISSED / missed) ** (1.0 / (1 + len(among)))
        self.stride = min(self.stride * min(max(grown, 0.5), 2.0), self.largest)
        return point

    def _failed(self) -> None:
        """Shorten the continuation step, or change to pseudo-arclength."""
        self.stride *= 0.5
        self.order = min(self.order, 1)
        self.failures += 1
        if self.failures == _FAILURES or self.stride < _SMALL * self.largest:
            last = self.recent[-1]
            try:
                pace = abs(last.tangent[1])
            except (PeriodicError, np.linalg.LinAlgError):
                # There is no neighbouring motion, or a fold: only shorter steps are left.
                pace = 1.0
            self.by_arclength, self.failures = True, 0
            self.ds = min(self.stride / max(pace, 1e-9), _FARTHEST * self._motion(last))

    def _along(self) -> Point | None:
        """Take a pseudo-arclength step along the branch."""
        last = self.recent[-1]
        forwards = 1.0 if last.towards is not None else self.sense * np.sign(self.end - self.start)
        level = self.branch.level
        point = self.branch.along(last, forwards * self.ds)
        if point is None and self.branch.level > level:
            return None
        turn = 0.0 if point is None else forwards * _cosine(last, point)
        if point is None or turn < _SHARPEST_TURN:
            self.ds *= 0.5
            return None
        position = self.position(point.speed)
        if not 0.0 < position < 1.0:
            point = self.branch.hold(self.recent[-2:], self.end if position >= 1.0 else self.start, self._within(last))
            if point is None:
                self.ds *= 0.5
                return None
        gone = abs(self.position(point.speed) - self.position(last.speed))
        is_fold = self._accept(point, True)
        if turn > _SMOOTH and point.corrections <= _FEW:
            self.ds *= 1.5
        self.ds = min(self.ds, _FARTHEST * self._motion(point))
        if not is_fold and gone > max(self.stride, _SMALL * self.largest) and len(self.recent) > 2:
            self.by_arclength, self.order = False, 1
            self.stride = min(gone, self.largest)
        return point

    def _accept(self, point: Point, along: bool) -> bool:
        """Add a point to the branch, after any bifurcation before it; returns whether the branch turned."""
        last = self.recent[-1]
        forwards = np.sign(self.end - self.start)
        is_fold = False
        if along and point.towards is not None:
            sense = float(np.sign(point.tangent[1]) * forwards)
            is_fold = sense != self.sense
            self.sense = sense
        event, between = self._event(last, point, is_fold, along)
        if event is not None and between is not None:
            self.events.append(Bifurcation(len(self.speeds), event, float(between.speed)))
            self._keep(between)
        self._keep(point)
        # The bifurcation before it was located with the elements of this point.
        self.branch.accept(point.response.error)
        if is_fold:
            self.recent = [point]
            return True
        if not along:
            self.order = self._best_order(point)
        self.recent = [*self.recent, point][-_KEPT:]
        return False

    def _keep(self, point: Point) -> None:
        """Add the summary of a point to the curve; its whole motion is dropped with the next points."""
        self.seen(point.speed, point.response)
        self.speeds.append(point.speed)
        self.motions.append(motion_summary(point.response, point.ready.segments))

    def _best_order(self, latest: Point) -> int:
        """Order of the polynomial through the last points that would have predicted ``latest`` best."""
        at = np.array([point.speed for point in self.recent])
        best, least = 1, np.inf
        for order in range(1, len(self.recent)):
            weights = interpolation(at[-1 - order :], latest.speed)
            states = np.tensordot(weights, [point.states for point in self.recent[-1 - order :]], 1)
            missed = self.branch.distance(states, latest.states)
            if missed < least:
                best, least = order, missed
        return best

    def _motion(self, point: Point) -> float:
        """Size of a motion about its mean, in the branch's unit."""
        moving = self.branch.distance(point.states, point.states.mean(axis=0)) if len(point.states) > 1 else 0.0
        return max(moving, 1.0)

    def _within(self, point: Point) -> float:
        """Largest correction of a prediction from a point."""
        return _ASIDE * self._motion(point)

    def _event(self, before: Point, after: Point, is_fold: bool, along: bool) -> tuple[Event | None, Point | None]:
        """Bifurcation between two points, and its location."""
        few, many = sorted((before.response.floquet.growing, after.response.floquet.growing))
        if not is_fold and few == many:
            return None, None

        def test(point: Point) -> float:
            if is_fold:
                return point.tangent[1]
            return float(np.abs(point.response.floquet.values[many - 1]) - 1.0)

        forwards = 1.0
        if is_fold and before.towards is None:
            forwards = float(np.sign(before.tangent[1] * -after.tangent[1]))
        whole = self.ds if along else 1.0
        low, high = 0.0, whole
        at_low, at_high = forwards * test(before) if is_fold else test(before), test(after)
        best = after
        if at_low * at_high < 0.0:
            for turn in range(_LOCATIONS):
                # False position, and bisection every third time so that no side is kept for ever.
                part = 0.5 if turn % 3 == 2 else at_low / (at_low - at_high)
                middle = low + min(max(part, 0.01), 0.99) * (high - low)
                self.tries += 1
                level = self.branch.level
                if along:
                    sense = forwards if is_fold or before.towards is not None else np.sign(after.speed - before.speed)
                    point = self.branch.along(before, sense * middle)
                else:
                    speed = before.speed + middle * (after.speed - before.speed)
                    point = self.branch.hold([*self.recent[-3:-1], after, before], speed, self._within(before))
                if point is None:
                    if self.branch.level > level:
                        continue  # again with finer elements
                    break
                best, value = point, test(point)
                if value == 0.0 or high - low <= _LOCATED * whole or abs(value) < 1e-8:
                    break
                if value * at_low < 0.0:
                    high, at_high = middle, value
                else:
                    low, at_low = middle, value
        if is_fold:
            return "fold", best
        crossing = best.response.floquet.values[many - 1]
        if abs(crossing.imag) > 1e-6:
            return "Neimark-Sacker", best
        return ("period doubling" if crossing.real < 0.0 else "branch point"), best


def response_curve(
    system_at: Callable[[float], CoupledSystem],
    start: float,
    end: float,
    *,
    first: tuple[FloatArray, FloatArray] | PeriodicResponse | None = None,
    points: int = 100,
    most_points: int = 2000,
    most_tries: int = 3000,
    periods: int = 1,
    tolerance: float = 1e-6,
    progress: Callable[[float], None] = lambda fraction: None,
    seen: Seen = lambda speed, response: None,
) -> ResponseCurve:
    """Follow the periodic motion from one speed to another, through folds.

    Parameters
    ----------
    system_at : callable
        The machine at a speed, in any unit: gyroscopic terms, unbalance, bearings and mesh rates may all follow it.
    start, end : float
        Speeds between which the branch is followed; ``end`` may be the lower.
    first : tuple of ndarray, or PeriodicResponse, optional
        Start of the search for the first motion, see ``start`` of :func:`periodic_response`.
    points : int
        Number of points on a straight branch; more are taken where it turns.
    most_points, most_tries : int
        Largest numbers of points and of attempted steps.
    periods : int
        Period of the motion in periods of the excitation: 2 follows a motion of twice the excitation's period.
    tolerance : float
        Largest change of the state after a period by a halving of the elements, relative.
    progress : callable
        Called with the part of the speed range that has been reached, from 0 to 1.
    seen : callable
        Called with the speed and the whole motion of every point of the curve, in its order: the curve keeps only a
        summary of each.

    Returns
    -------
    ResponseCurve
        Curve whose first point is at ``start`` and whose last is at ``end``, unless the branch comes back to ``start``
        or is lost: see its ``ending``, and its ``account`` in words.

    Raises
    ------
    CouplingError
        Where the speeds are the same.
    PeriodicError
        Where no first motion is found, or none beside it.
    """
    span = end - start
    if not (np.isfinite(span) and span != 0.0 and points > 1 and min(most_points - 1, most_tries, periods) > 0):
        raise CouplingError(f"a branch from {start} to {end} in {points} points; expected a range and some points")
    begin = system_at(start)
    period = None if periods == 1 else periods * problem(begin).period
    solved = periodic_response(begin, period=period, start=first, tolerance=tolerance)
    ready = problem(begin, period)
    q, v = solved.at_nodes(ready.segments)
    still = ready.part.mean
    moving = np.concatenate([q[:, ready.kept] - still, v[:, ready.kept] / ready.part.rate_unit], axis=1)
    unit = np.sqrt(np.mean(np.sum(moving**2, axis=1)))
    unit = max(float(unit), 0.1 * float(np.linalg.norm(still))) or 1.0
    branch = Branch(system_at, periods, abs(span), max(solved.level - 1 - _COARSER, 0), tolerance, unit)
    follower = _Follower(branch, branch.first(solved, start), start, end, points, most_tries, seen)
    ending = follower.follow(most_points, progress)
    if len(follower.speeds) == 1:
        raise PeriodicError(
            f"the branch is lost at a speed of {start:g}, where it begins: the flanks may begin to graze there, or the "
            "motion ends; start anew on its other side"
        )
    return ResponseCurve(
        speeds=np.array(follower.speeds),
        responses=tuple(follower.motions),
        bifurcations=tuple(follower.events),
        system_at=system_at,
        periods=periods,
        ending=ending,
        aim=end,
    )


def _cosine(point: Point, other: Point) -> float:
    (states, speed), (others, pace) = point.tangent, other.tangent
    return float(np.sum(states * others)) / len(states) + speed * pace
