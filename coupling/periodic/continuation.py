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

which is regular at folds; A is cyclic in the segments, see :mod:`gearwhine.coupling.periodic.orbit`. r_p is a finite
difference.

A range of speeds that this does not cover is followed from other starts: beyond a place where the branch is lost or
climbs a resonance that nothing damps, which has no top; from the end of the range; and from the middle of what is left.
Each start begins a piece of the curve, which ends where it meets a piece that is there. What no piece covers is a gap.

- H. B. Keller, "Numerical solution of bifurcation and nonlinear eigenvalue problems", *Applications of Bifurcation
  Theory*, 1977.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Literal

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError, PeriodicError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.periodic.branch import Branch, Point, interpolation
from gearwhine.coupling.periodic.response import BranchMotion, PeriodicResponse, motion_summary
from gearwhine.coupling.periodic.settling import SettledMotion, settled_response
from gearwhine.coupling.periodic.shooting import integrated_again, periodic_response, problem, response_near

FloatArray = npt.NDArray[np.float64]
Ending = Literal["end", "start", "joined", "steep", "lost", "points", "tries"]
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
    """Branches of periodic motions, p points in the order in which they were followed; c contacts.

    Attributes
    ----------
    speeds : ndarray, shape (p,)
        Speeds in the unit of ``system_at``.
    responses : tuple of BranchMotion or SettledMotion
        Summary of each motion; :meth:`motion` computes its course over time. Where carriers turn, the motions.
    bifurcations : tuple of Bifurcation
    pieces : tuple of int
        Index of the first point of each piece, 0 first: between two pieces nothing is followed.
    endings : tuple of str
        Ending of each piece: ``end`` and ``start`` at the speeds of the range, ``joined`` where it met another piece;
        ``steep`` where the motion grows without a top at one speed, ``lost`` where no next point was found, ``points``
        and ``tries`` at the largest number of these.
    begin, aim : float
        Speeds between which motions were to be followed.
    """

    speeds: FloatArray
    responses: tuple[BranchMotion | SettledMotion, ...]
    bifurcations: tuple[Bifurcation, ...]
    system_at: Callable[[float], CoupledSystem] = field(repr=False)
    periods: int = 1
    endings: tuple[Ending, ...] = ("end",)
    begin: float = np.nan
    aim: float = np.nan
    pieces: tuple[int, ...] = (0,)

    @property
    def ending(self) -> Ending:
        """``end`` where motions are followed over the whole range, else the ending of the first piece."""
        return "end" if not self.gaps else self.endings[0]

    @property
    def gaps(self) -> tuple[tuple[float, float], ...]:
        """Ranges of speed over which no motion is followed, from the lower to the higher speed, ascending."""
        return _gaps(self.begin, self.aim, [self.speeds[piece] for piece in self.slices])

    @property
    def slices(self) -> tuple[slice, ...]:
        """Points of each piece."""
        return tuple(slice(*ends) for ends in pairwise([*self.pieces, len(self.speeds)]))

    @property
    def piece_numbers(self) -> npt.NDArray[np.int64]:
        """Number of each point's piece, from 1, shape (p,)."""
        return np.searchsorted(self.pieces, np.arange(len(self.speeds)), side="right")

    @property
    def account(self) -> str:
        """Followed range and ending of the branch, in a sentence; speeds in the curve's own unit."""
        return self.description()

    def description(self, unit: float = 1.0, name: str = "") -> str:
        """Return the response curve with speeds divided by a named unit."""
        name = name and f" {name}"
        words = []
        for number, (piece, ending) in enumerate(zip(self.slices[:_TOLD], self.endings, strict=False)):
            speeds = self.speeds[piece] / unit
            begun = "followed" if number == 0 else "begun anew and followed"
            folds = sum(piece.start <= fold.index < piece.stop for fold in self.folds)
            text = f"{begun} from {speeds[0]:.6g} to {speeds[-1]:.6g}{name}: "
            text += f"{_counted(len(speeds), 'point')}, {_counted(folds, 'fold')}"
            words.append(text if ending == "end" else f"{text}; {_WHY[ending]}")
        if len(self.pieces) > _TOLD:
            words.append(f"{_counted(len(self.pieces) - _TOLD, 'more piece')} with {len(self.speeds)} points in all")
        if gaps := self.gaps:
            widest = sorted(sorted(gaps, key=lambda gap: gap[0] - gap[1])[:_TOLD])
            ranges = ", ".join(f"between {low / unit:.6g} and {high / unit:.6g}" for low, high in widest)
            more = f", nor in {_counted(len(gaps) - _TOLD, 'narrower range')}" if len(gaps) > _TOLD else ""
            words.append(f"Nothing was followed {ranges}{name}{more}")
        return ". ".join(words)

    @property
    def settled(self) -> bool:
        """Whether the motions are settled in time, speed by speed, as where carriers turn."""
        return any(isinstance(response, SettledMotion) for response in self.responses)

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

    def motion(self, index: int) -> PeriodicResponse | SettledMotion:
        """Integrate the periodic motion of a point again, from the starts of its segments."""
        branch_motion = self.responses[index]
        if isinstance(branch_motion, SettledMotion):
            return branch_motion
        return integrated_again(
            self.system_at(float(self.speeds[index])), self._period(branch_motion.period), branch_motion
        )

    def at(self, speed: float, tolerance: float = 1e-8) -> list[PeriodicResponse | SettledMotion]:
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
        within = np.ones(max(len(away) - 1, 0), dtype=np.bool_)
        within[[first - 1 for first in self.pieces[1:]]] = False
        for i in np.flatnonzero((away[:-1] * away[1:] < 0.0) & within):
            part = away[i] / (away[i] - away[i + 1])
            motions.append((i + part, self._between(int(i), part, speed, tolerance)))
        if not motions:
            raise CouplingError(
                f"no motion at {speed:g}: the branch was followed from {self.speeds.min():g} to {self.speeds.max():g}"
            )
        return [response for _, response in sorted(motions, key=lambda one: one[0])]

    def passes(self, speed: float) -> bool:
        """Whether a piece comes to a speed."""
        return any(self.speeds[piece].min() <= speed <= self.speeds[piece].max() for piece in self.slices)

    def _between(self, index: int, part: float, speed: float, tolerance: float) -> PeriodicResponse | SettledMotion:
        """Solve for the motion at a speed that is a part of the way from one point to the next."""
        before, after = self.responses[index], self.responses[index + 1]
        if isinstance(before, SettledMotion) or isinstance(after, SettledMotion):
            return settled_response(self.system_at(speed), near=before if isinstance(before, SettledMotion) else None)
        # Rates are compared in their own period.
        length = 1.0 / (1.0 / before.period + part * (1.0 / after.period - 1.0 / before.period))
        q = (1.0 - part) * before.displacements + part * after.displacements
        v = ((1.0 - part) * before.velocities * before.period + part * after.velocities * after.period) / length
        level = max(before.level, after.level)
        return response_near(self.system_at(speed), self._period(length), (q, v), level, tolerance)

    def _period(self, length: float) -> float | None:
        return None if self.periods == 1 else length


_WHY: dict[Ending, str] = {
    "start": "the branch came back to where the range begins",
    "joined": "it met a branch that is followed already",
    "steep": "the motion grows without a top at one speed, a resonance that next to nothing damps",
    "lost": "no next motion was found however near: the flanks may begin to graze there, or the motion ends",
    "points": "as many points as were allowed",
    "tries": "as many tries as were allowed",
}
_TOLD = 4  # number of pieces, and of gaps, that are told one by one
_SAME_SPEED = 1e-9  # width of a gap over the range below which it is rounding


def _counted(number: int, what: str) -> str:
    return f"{number} {what}" + ("" if number == 1 else "s")


def _gaps(begin: float, aim: float, pieces: Sequence[FloatArray]) -> tuple[tuple[float, float], ...]:
    """Ranges between two speeds that no piece spans, ascending."""
    reached, last = min(begin, aim), max(begin, aim)
    least = _SAME_SPEED * (last - reached)
    gaps: list[tuple[float, float]] = []
    for low, high in sorted((float(piece.min()), float(piece.max())) for piece in pieces):
        if low > reached + least:
            gaps.append((reached, low))
        reached = max(reached, high)
    return (*gaps, (reached, last)) if last > reached + least else tuple(gaps)


_COARSER = 2  # number of levels below that of the first motion, whose monodromy is proved too
_KEPT = 5  # number of points that predict the next point
_MISSED = 3e-3  # target error of a prediction, relative to a motion
_ASIDE = 1.2e-2  # largest error of a prediction, beyond which it leads to another branch
_FARTHEST = 0.3  # largest relative change of a motion by a step along the branch
_SHARPEST_TURN = 0.9  # least cosine between tangents of neighbouring points along the branch
_LONGER_STEP_COSINE = 0.97  # cosine beyond which the next step is longer
_DOUBLE_STEP_COSINE = 0.999  # cosine beyond which it is twice as long
_MOST_CORRECTIONS_OF_A_LONGER_STEP = 4  # largest number of corrections with which the next step is longer
_FAILURES = 3  # failed steps at given speed, each half as long, before pseudo-arclength steps
_ARCLENGTH_STEP_SHARE = 0.05  # part of the largest step below which pseudo-arclength steps begin
_SHORTEST_STEP_SHARE = 1e-4  # part of the largest step below which the branch is lost
_MIRRORED = (2.0, 4.0, 8.0)  # distances of a step over a resonance, over that before it
_BESIDE = 0.1  # largest relative change of a motion by such a step
# Distance of such multipliers from the unit circle over their angle, below which nothing damps them: the inverse of the
# height of the resonance over what the motion has of it already.
_RESONANCE_DAMPING = 3e-3
_NEAR_ONE = 1.0  # largest of these angles [rad]
_SAME_ANGLE = 4  # digits of angles that are the same: planes of one shaft
_RESONANCE_STEP_SHARE = 1e-3  # part of the largest step down to which steps at given speed come near a resonance
_STANDING = 1e-2  # change of speed over the largest step below which the branch stands at one speed
_CLIMBED = 0.3  # relative change of a motion at one speed beyond which it climbs without a top
_FEWEST_CLIMBING = 6  # number of points along the branch before that is said
_LARGEST_BEND_SHARE = 0.05  # part of the way between two points that the branch may bend aside
_SKIPS = (0.1, 0.3, 1.0, 3.0)  # widths beyond which a lost branch is looked for again, in largest steps
_INSIDE = (0.5, 0.25, 0.75)  # parts of a gap at which a motion is looked for
_MOST_PIECES = 80
_MOST_SEARCHES = 32  # largest number of searches that find no motion
_LOCATIONS = 30  # largest number of steps in the location of a bifurcation
_LOCATED = 1e-5  # tolerance of a located point over the step; the speed of a fold errs by its square


Seen = Callable[[float, PeriodicResponse], None]


class _Follower:
    """Continuation along a branch. Positions are parts of the speed range, 0 at its start and 1 at its end."""

    def __init__(self, first: Point, start: float, end: float, points: int, seen: Seen, sense: float = 1.0) -> None:
        self.branch, self.start, self.end = first.branch, start, end
        self.largest, self.tries = 1.0 / (points - 1), 0
        self.speeds: list[float] = []
        self.motions: list[BranchMotion] = []
        self.events: list[Bifurcation] = []
        self.seen = seen
        self.recent = [first]  # since the speed last turned
        self.sense, self.stride, self.order = sense, 0.3 * self.largest, 1
        self.failures, self.by_arclength, self.ds = 0, False, 0.0
        self.breaks: list[int] = []  # points behind resonances that were stepped over
        # Points along the branch since the speed last moved, the change of the motion over them, and the point before.
        self.pending: list[tuple[Point, Event | None]] = [(first, None)]
        self.climbed, self.before = 0.0, first
        self._flush()

    def position(self, speed: float) -> float:
        """Position of a speed in the range."""
        return (speed - self.start) / (self.end - self.start)

    def speed(self, position: float) -> float:
        """Speed at a position."""
        if position in (0.0, 1.0):
            return self.end if position == 1.0 else self.start
        return self.start + position * (self.end - self.start)

    def follow(
        self,
        most_points: int,
        most_tries: int,
        progress: Callable[[float], None],
        others: "Sequence[_Follower]" = (),
    ) -> Ending:
        """Continue step by step, to an end of the range, of the branch, or of what others have not followed."""
        ending = self._followed(most_points, most_tries, progress, others)
        if ending != "steep":
            self._flush()
        return ending

    def _followed(
        self, most_points: int, most_tries: int, progress: Callable[[float], None], others: "Sequence[_Follower]"
    ) -> Ending:
        while True:
            if len(self.speeds) + len(self.pending) >= most_points:
                return "points"
            if self.tries >= most_tries:
                return "tries"
            if self.by_arclength and self.ds < _SHORTEST_STEP_SHARE * self.largest:
                return "lost"
            if self.climbed > _CLIMBED and len(self.pending) > _FEWEST_CLIMBING:
                return "steep"
            self.tries += 1
            last = self.recent[-1]
            point = self._along() if self.by_arclength else self._at_given_speed()
            if point is None:
                continue
            position = self.position(point.speed)
            progress(min(max(position, 0.0), 1.0))
            if position in (0.0, 1.0):
                return "end" if position == 1.0 else "start"
            if any(other.has(point) and other.has(last) for other in others):
                return "joined"

    def _at_given_speed(self) -> Point | None:
        """Take a continuation step at a given speed."""
        last = self.recent[-1]
        among = self.recent[-1 - self.order :]
        position = self.position(last.speed) + self.sense * self.stride
        level = self.branch.level
        point = self.branch.hold(among, self.speed(min(max(position, 0.0), 1.0)), self._within(last))
        if point is None:
            if self.branch.level > level:
                return None
            point = self._over_resonance()
            if point is None:
                self._failed()
            return point
        missed = max(point.missed / self._motion(point), 1e-12)
        self._accept(point, False)
        self.failures = 0
        grown = (_MISSED / missed) ** (1.0 / (1 + len(among)))
        self.stride = min(self.stride * min(max(grown, 0.5), 2.0), self.largest)
        return point

    def _over_resonance(self) -> Point | None:
        """Step over a resonance that nothing damps, where the motion has no bound; None where there is none ahead.

        A pair of multipliers e^{±iα} passes 1 there, α falling evenly with the speed. The motion is found again as far
        behind the resonance as it stands before it; between both lies a gap.
        """
        if len(self.recent) < 2:
            return None
        last = self.recent[-1]
        before, here = (self.position(point.speed) for point in self.recent[-2:])
        for former, angle in zip(*(_undamped_angles(point) for point in self.recent[-2:]), strict=False):
            ahead = (here - before) * angle / (former - angle) if former > angle else np.inf
            for times in _MIRRORED:
                position = here + times * ahead
                if not 0.0 < position < 1.0 or abs(times * ahead) > self.largest:
                    break
                point = self.branch.near(last, self.speed(position), _BESIDE * self._motion(last))
                if point is not None:
                    self._flush()
                    self.breaks.append(len(self.speeds))
                    self.pending.append((point, None))
                    self._flush()
                    self.recent, self.order, self.failures = [point], 1, 0
                    self.stride, self.climbed, self.before = abs(ahead), 0.0, point
                    return point
        return None

    def _failed(self) -> None:
        """Shorten the continuation step, or change to pseudo-arclength."""
        self.stride *= 0.5
        self.order = min(self.order, 1)
        self.failures += 1
        last = self.recent[-1]
        # Steps at given speed come near a resonance that nothing damps; along the branch they climb it.
        rises = bool(_undamped_angles(last))
        if self.stride < (_RESONANCE_STEP_SHARE if rises else _ARCLENGTH_STEP_SHARE) * self.largest or (
            not rises and self.failures == _FAILURES
        ):
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
        if turn > _LONGER_STEP_COSINE and point.corrections <= _MOST_CORRECTIONS_OF_A_LONGER_STEP:
            self.ds *= 2.0 if turn > _DOUBLE_STEP_COSINE else 1.5
        self.ds = min(self.ds, _FARTHEST * self._motion(point))
        if not is_fold and gone > max(self.stride, _ARCLENGTH_STEP_SHARE * self.largest) and len(self.recent) > 2:
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
            self.pending.append((between, event))
        self.pending.append((point, None))
        self.climbed += self.branch.distance(point.states, last.states) / self._motion(point)
        moved = abs(self.position(point.speed) - self.position(self.before.speed))
        if not along or is_fold or moved > _STANDING * self.largest:
            self._flush()
            self.climbed, self.before = 0.0, point
        # The bifurcation before it was located with the elements of this point.
        self.branch.accept(point.response.error)
        if is_fold:
            self.recent = [point]
            return True
        if not along:
            self.order = self._best_order(point)
        self.recent = [*self.recent, point][-_KEPT:]
        return False

    def _flush(self) -> None:
        """Add the summaries of the pending points to the curve; the whole motions are dropped with the next points."""
        for point, event in self.pending:
            if event is not None:
                self.events.append(Bifurcation(len(self.speeds), event, float(point.speed)))
            self.seen(point.speed, point.response)
            self.speeds.append(point.speed)
            self.motions.append(motion_summary(point.response, point.ready.segments))
        self.pending = []

    @property
    def pieces(self) -> list[FloatArray]:
        """Speeds of the points between the places that were stepped over."""
        return np.split(np.array(self.speeds), self.breaks)

    def has(self, point: Point) -> bool:
        """Whether another follower's point lies on this branch: between two points, as near as predictions are."""
        away = np.array(self.speeds) - point.speed
        between = np.flatnonzero(away[:-1] * away[1:] <= 0.0)
        if not between.size:
            return False
        q, v = point.response.at_nodes(point.ready.segments)
        here = np.concatenate([q, v * point.response.period], axis=1)
        size = float(np.linalg.norm(here - here.mean(axis=0))) or float(np.linalg.norm(here))
        for i in between:
            before, after = (
                np.concatenate([one.displacements, one.velocities * one.period], axis=1)
                for one in self.motions[i : i + 2]
            )
            part = away[i] / (away[i] - away[i + 1]) if away[i] != away[i + 1] else 0.0
            aside = np.linalg.norm(before + part * (after - before) - here)
            if aside < _ASIDE * size + _LARGEST_BEND_SHARE * np.linalg.norm(after - before):
                return True
        return False

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
        Start of the search for the first motion, see ``start`` of :func:`periodic_response`; with it only the branch of
        that motion is followed.
    points : int
        Number of points on a straight branch; more are taken where it turns.
    most_points, most_tries : int
        Largest numbers of points and of attempted steps.
    periods : int
        Period of the motion in periods of the excitation: 2 follows a motion of twice the excitation's period, and only
        the branch of the first one.
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
        Curve whose first point is at ``start``. Where its branch does not reach ``end`` there are further pieces; what
        none of them covers is in ``gaps``, and ``account`` says it in words.

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
    pieces = _Pieces(system_at, start, end, points, (most_points, most_tries), periods, tolerance, progress, seen)
    if first is not None or periods > 1:
        pieces.follow(pieces.begun(start, 1.0, first), beyond=False)
    else:
        pieces.cover()
    followers = pieces.followers
    if all(len(follower.speeds) == 1 for follower in followers):
        raise PeriodicError(
            f"the branch is lost at a speed of {start:g}, where it begins: the flanks may begin to graze there, or the "
            "motion ends; start anew on its other side"
        )
    firsts = np.cumsum([0, *(len(follower.speeds) for follower in followers)]).tolist()
    pieces_of: list[int] = []
    endings: list[Ending] = []
    steep: Ending = "steep"
    for begun, follower, ending in zip(firsts, followers, pieces.endings, strict=False):
        pieces_of += [begun, *(begun + number for number in follower.breaks)]
        endings += [steep] * len(follower.breaks) + [ending]
    return ResponseCurve(
        speeds=np.concatenate([follower.speeds for follower in followers]),
        responses=tuple(motion for follower in followers for motion in follower.motions),
        bifurcations=tuple(
            replace(event, index=begun + event.index)
            for begun, follower in zip(firsts, followers, strict=False)
            for event in follower.events
        ),
        system_at=system_at,
        periods=periods,
        endings=tuple(endings),
        begin=start,
        aim=end,
        pieces=tuple(pieces_of),
    )


class _Pieces:
    """Pieces of a response curve, each with its ending, that are to cover a range of speeds."""

    def __init__(
        self,
        system_at: Callable[[float], CoupledSystem],
        start: float,
        end: float,
        points: int,
        most: tuple[int, int],
        periods: int,
        tolerance: float,
        progress: Callable[[float], None],
        seen: Seen,
    ) -> None:
        self.system_at, self.start, self.end, self.points = system_at, start, end, points
        self.most_points, self.most_tries = most
        self.periods, self.tolerance, self.progress, self.seen = periods, tolerance, progress, seen
        self.followers: list[_Follower] = []
        self.endings: list[Ending] = []
        self.failed = 0

    def cover(self) -> None:
        """Follow the range from its start, from its end, and from within what is left.

        Raises
        ------
        PeriodicError
            Where no motion is found at either end.
        """
        try:
            self.follow(self.begun(self.start, 1.0))
        except PeriodicError as error:
            try:
                self.follow(self.begun(self.end, -1.0))
            except PeriodicError:
                raise error from None
        tried: set[float] = set()
        while self.room and (speed := self._untried(tried)) is not None:
            tried.add(speed)
            follower = self.sought(speed, -1.0)
            if follower is None:
                continue
            seed = follower.recent[-1]
            self.follow(follower)
            if speed not in (self.start, self.end) and self.room:
                self.follow(_Follower(seed, self.start, self.end, self.points, self.seen))

    @property
    def room(self) -> bool:
        """Whether the numbers of points, tries, pieces and vain searches leave room for another piece."""
        return (
            self._left(self.most_points, [len(one.speeds) for one in self.followers]) > 1
            and self._left(self.most_tries, [one.tries for one in self.followers]) > 0
            and len(self.followers) < _MOST_PIECES
            and self.failed < _MOST_SEARCHES
        )

    @staticmethod
    def _left(most: int, used: list[int]) -> int:
        return most - sum(used)

    def _gaps(self) -> tuple[tuple[float, float], ...]:
        return _gaps(self.start, self.end, [piece for one in self.followers for piece in one.pieces])

    def _untried(self, tried: set[float]) -> float | None:
        """Return a speed at which to look for a motion: the end of the range, else within the widest gap."""
        least = abs(self.end - self.start) / (self.points - 1)
        for low, high in sorted(self._gaps(), key=lambda gap: gap[0] - gap[1]):
            ends = [end for end in (self.end, self.start) if end in (low, high)]
            inside = [low + part * (high - low) for part in _INSIDE if high - low > least]
            for speed in [*ends, *inside]:
                if speed not in tried:
                    return speed
        return None

    def begun(
        self, speed: float, sense: float, near: tuple[FloatArray, FloatArray] | PeriodicResponse | None = None
    ) -> _Follower:
        """Return a follower of the motion that is found at a speed."""
        begin = self.system_at(speed)
        period = None if self.periods == 1 else self.periods * problem(begin).period
        solved = periodic_response(begin, period=period, start=near, tolerance=self.tolerance)
        ready = problem(begin, period)
        q, v = solved.at_nodes(ready.segments)
        still = ready.part.mean
        moving = np.concatenate([q[:, ready.kept] - still, v[:, ready.kept] / ready.part.rate_unit], axis=1)
        unit = np.sqrt(np.mean(np.sum(moving**2, axis=1)))
        unit = max(float(unit), 0.1 * float(np.linalg.norm(still))) or 1.0
        level, span = max(solved.level - 1 - _COARSER, 0), abs(self.end - self.start)
        branch = Branch(self.system_at, self.periods, span, level, self.tolerance, unit)
        return _Follower(branch.first(solved, speed), self.start, self.end, self.points, self.seen, sense)

    def sought(self, speed: float, sense: float, near: tuple[FloatArray, FloatArray] | None = None) -> _Follower | None:
        """Return a follower of a motion at a speed, where one is found."""
        try:
            return self.begun(speed, sense, near)
        except PeriodicError:
            self.failed += 1
            return None

    def follow(self, follower: _Follower | None, *, beyond: bool = True) -> None:
        """Follow a piece to its end, and the pieces beyond the places where it is lost."""
        while follower is not None:
            others, points, tries = tuple(self.followers), self.most_points, self.most_tries
            points = self._left(points, [len(one.speeds) for one in others])
            tries = self._left(tries, [one.tries for one in others])
            self.followers.append(follower)
            self.endings.append(follower.follow(points, tries, self.progress, others))
            lost = beyond and self.endings[-1] in ("lost", "steep") and self.room
            follower = self._beyond(follower) if lost else None

    def _beyond(self, lost: _Follower) -> _Follower | None:
        """Return a follower of the motion on the other side of a place where the branch is lost, in a gap."""
        last = lost.before
        near = last.response.at_nodes(last.ready.segments)
        for skip in _SKIPS:
            position = lost.position(last.speed) + lost.sense * skip * lost.largest
            speed = lost.speed(min(max(position, 0.0), 1.0))
            if not any(low <= speed <= high for low, high in self._gaps()) or not self.room:
                return None
            found = self.sought(speed, lost.sense, near)
            if found is not None or position in (0.0, 1.0):
                return found
        return None


def _undamped_angles(point: Point) -> list[float]:
    """Angles of undamped pairs of multipliers e^{±iα} near 1, ascending and each once [rad]."""
    values = point.response.floquet.values
    angles = np.angle(values)
    near = angles[(angles > 0.0) & (angles < _NEAR_ONE) & (np.abs(np.abs(values) - 1.0) < _RESONANCE_DAMPING * angles)]
    return sorted(set(np.round(near, _SAME_ANGLE).tolist()))


def _cosine(point: Point, other: Point) -> float:
    (states, speed), (others, pace) = point.tangent, other.tangent
    return float(np.sum(states * others)) / len(states) + speed * pace
