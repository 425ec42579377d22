"""Search for the best points of the unit cube by aims and limits, each point tried once and their number bounded.

One aim: differential evolution (Storn and Price 1997) with Lampinen's rule for limits, by scipy, finds the region in
half of the trials; then the trust-region method COBYQA (Ragonneau 2022), by scipy, goes on from the best point, which
takes quadratic models of aim and limits in place of gradients, then from others far from it while trials are left.
Several aims: NSGA-II (Deb, Pratap, Agarwal and Meyarivan 2002), by pymoo, whose crowding spreads the points over the
Pareto front. A space of few discrete points is tried whole.

A coordinate with n discrete values has them at (i + 1/2) / n.
"""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from gearwhine.failures import MissingExtraError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.sampling import sobol_points

if TYPE_CHECKING:
    import numpy.typing as npt

Ended = Literal["budget", "converged", "complete"]
_GLOBAL_SHARE = 0.5  # part of the trials of one aim before the trust region
_LEAST_POPULATION, _EACH_DIMENSION, _LARGEST_POPULATION = 8, 4, 60
_PARETO_GENERATIONS = 8  # generations that the trials should be enough for
_STALE = 20  # generations without a new point after which a search has ended
_FIRST_RADIUS, _LAST_RADIUS = 0.1, 1e-4  # of the trust region in the unit cube
_NEAR = 0.15  # distance within which a second local search would find the same
_MOST_STARTS = 6
_INSIDE = 1e-6  # distance that the trust region keeps from limits, in the scale of the limit
FAILED = 1e6
"""Excess of a point that cannot be evaluated."""


@dataclass(frozen=True)
class Space:
    """Coordinates of points.

    Attributes
    ----------
    counts : tuple of int
        Number of discrete values of each coordinate; 0 of a continuous one.
    """

    counts: tuple[int, ...]

    @property
    def continuous(self) -> npt.NDArray[np.bool_]:
        """Mask of the continuous coordinates, shape (d,)."""
        return np.asarray(np.array(self.counts) == 0)

    def snapped(self, points: FloatArray) -> FloatArray:
        """Points with the coordinates of discrete values in their places, shape (n, d)."""
        counts = np.array(self.counts)
        places = np.clip(np.floor(points * np.maximum(counts, 1)), 0, np.maximum(counts - 1, 0))
        return np.where(counts == 0, np.clip(points, 0.0, 1.0), (places + 0.5) / np.maximum(counts, 1))

    def grid(self, levels: Sequence[int]) -> FloatArray:
        """Every combination of values and levels, the last coordinate the fastest, shape (n, d)."""
        axes = [
            (np.arange(count) + 0.5) / count if count else np.linspace(0.0, 1.0, level)
            for count, level in zip(self.counts, levels, strict=True)
        ]
        return np.array(list(itertools.product(*axes)), dtype=np.float64)


class BudgetSpentError(Exception):
    """All trials are spent; a search ends by it."""


class Trials:
    """Points that are tried, each once, in the order of their first trial.

    Parameters
    ----------
    space : Space
    find : callable
        Returns of new points (n, d) their aims to minimise (n, a) and excesses over limits (n, l), scaled, not above
        zero where a limit holds; both NaN of points that cannot be evaluated.
    budget : int
        Largest number of points.

    Attributes
    ----------
    points : list of ndarray, shape (d,)
    aims, excesses : list of ndarray, shape (a,), (l,)
    """

    def __init__(self, space: Space, find: Callable[[FloatArray], tuple[FloatArray, FloatArray]], budget: int) -> None:
        self.space, self.budget, self._find = space, budget, find
        self.points, self.aims, self.excesses = list[FloatArray](), list[FloatArray](), list[FloatArray]()
        self._numbers = dict[bytes, int]()

    @property
    def left(self) -> int:
        """Number of points that may still be tried."""
        return self.budget - len(self.points)

    def of(self, points: FloatArray) -> list[int]:
        """Return the numbers of points (n, d), which are tried where they are new.

        Raises
        ------
        BudgetSpentError
            Where more are new than may be tried; the first of them have been.
        """
        snapped = self.space.snapped(np.atleast_2d(points)) + 0.0
        keys = [row.tobytes() for row in snapped]
        new = {key: row for key, row in zip(keys, snapped, strict=True) if key not in self._numbers}
        tried = list(new.items())[: self.left]
        if tried:
            aims, excesses = self._find(np.array([row for _, row in tried]))
            for (key, row), aim, excess in zip(tried, aims, excesses, strict=True):
                self._numbers[key] = len(self.points)
                self.points.append(row)
                self.aims.append(aim)
                self.excesses.append(excess)
        if len(tried) < len(new):
            raise BudgetSpentError
        return [self._numbers[key] for key in keys]

    def excess(self, number: int) -> float:
        """Sum of the excesses of a point over its limits; `FAILED` of one that cannot be evaluated."""
        return excess_of(self.aims[number], self.excesses[number])

    def ranked(self) -> list[int]:
        """Numbers of all points by one aim, the best first: within the limits by the aim, then by the excess."""
        return sorted(range(len(self.points)), key=lambda number: (self.excess(number), float(self.aims[number][0])))


def excess_of(aims: FloatArray, excesses: FloatArray) -> float:
    """Sum of the excesses of a point over its limits; `FAILED` of one that cannot be evaluated."""
    if not (np.all(np.isfinite(aims)) and np.all(np.isfinite(excesses))):
        return FAILED
    return float(np.sum(np.maximum(excesses, 0.0)))


def first_points(space: Space, size: int, start: FloatArray | None, seed: int) -> FloatArray:
    """Return points that a search begins with: the start, where it is in the space, and a Sobol' sequence."""
    points = space.snapped(sobol_points(size, len(space.counts), seed))
    return points if start is None else np.vstack([space.snapped(start[None]), points[:-1]])


def population(space: Space) -> int:
    """Return the number of points of a generation of one aim."""
    return min(max(_LEAST_POPULATION, _EACH_DIMENSION * len(space.counts)), _LARGEST_POPULATION)


def search(trials: Trials, start: FloatArray | None, seed: int, aims: int) -> Ended:
    """Search for the best points by one aim, or for the Pareto front of several.

    Parameters
    ----------
    trials : Trials
        Takes every point.
    start : ndarray, shape (d,), or None
        Point that a search begins with.
    seed : int
    aims : int
        Number of aims.

    Returns
    -------
    str
        Why the search ended: "budget", "converged", or "complete" where every point of the space has been tried.

    Raises
    ------
    MissingExtraError
        Where several aims need pymoo, which is not installed.
    """
    counts = trials.space.counts
    try:
        if all(counts) and math.prod(counts) <= trials.budget:
            return tried_whole(trials, [1] * len(counts))
        if aims > 1:
            _pareto_search(trials, start, seed, aims)
        else:
            _differential_evolution(trials, start, seed)
            _trust_regions(trials)
    except BudgetSpentError:
        return "budget"
    return "converged" if trials.left else "budget"


def tried_whole(trials: Trials, levels: Sequence[int]) -> Ended:
    """Try every combination of values and levels."""
    trials.of(trials.space.grid(levels))
    return "complete"


def _differential_evolution(trials: Trials, start: FloatArray | None, seed: int) -> None:
    """Evolve a population by one aim, with discrete coordinates by the numbers of their values."""
    from scipy import optimize

    space = trials.space
    counts, continuous = np.array(space.counts), space.continuous
    share = trials.budget if not continuous.any() else math.ceil(_GLOBAL_SHARE * trials.budget)
    scale = np.where(continuous, 1.0, counts)

    def numbers(x: FloatArray) -> list[int]:
        return trials.of(((x.T + np.where(continuous, 0.0, 0.5)) / scale).reshape(-1, len(counts)))

    def aim(x: FloatArray, /) -> FloatArray:
        return np.array([float(trials.aims[number][0]) for number in numbers(x)])

    def excess(x: FloatArray) -> FloatArray:
        return np.array([[trials.excess(number) for number in numbers(x)]])

    tried = [0]

    def ends(x: FloatArray, convergence: Any) -> Any:
        tried.append(len(trials.points))
        return len(trials.points) >= share or tried[-1] == tried[max(0, len(tried) - 1 - _STALE)]

    first = first_points(space, population(space), start, seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of a population without any point within the limits
        optimize.differential_evolution(
            aim,  # type: ignore[arg-type]  # the stubs do not know that it is of many points
            optimize.Bounds(np.zeros(len(counts)), np.where(continuous, 1.0, counts - 1.0)),
            init=np.where(continuous, first, np.floor(first * scale)),
            integrality=~continuous,
            constraints=optimize.NonlinearConstraint(excess, -np.inf, 0.0),
            vectorized=True,
            updating="deferred",
            polish=False,
            maxiter=10_000,
            tol=1e-4,
            seed=seed,
            callback=ends,
        )


def _trust_regions(trials: Trials) -> None:
    """Search about the best points, far from each other, with the discrete coordinates of each."""
    continuous = trials.space.continuous
    if not continuous.any() or not trials.points:
        return
    starts = list[FloatArray]()
    while len(starts) < _MOST_STARTS and trials.left:
        ranked = (trials.points[number] for number in trials.ranked() if trials.excess(number) < FAILED)
        begin = next((point for point in ranked if all(_are_far(point, one, continuous) for one in starts)), None)
        if begin is None:
            return
        found = _trust_region(trials, begin)
        starts += [begin, found]


def _are_far(first: FloatArray, second: FloatArray, continuous: npt.NDArray[np.bool_]) -> bool:
    apart = np.abs(first - second)
    return bool(np.any(apart[~continuous] > 0.0) or np.max(apart[continuous]) > _NEAR)


def _trust_region(trials: Trials, begin: FloatArray) -> FloatArray:
    """Search about a point; return where it has led."""
    from scipy import optimize

    continuous = trials.space.continuous
    (number,) = trials.of(begin)
    scale = float(np.ptp([aims[0] for aims in trials.aims if np.isfinite(aims[0])])) or 1.0
    origin, limits = float(trials.aims[number][0]), trials.excesses[number].size

    def tried(x: FloatArray) -> int:
        point = begin.copy()
        point[continuous] = x
        return trials.of(point)[0]

    def aim(x: FloatArray) -> float:
        value = (float(trials.aims[tried(x)][0]) - origin) / scale
        return value if math.isfinite(value) else 1.0

    def excesses(x: FloatArray) -> FloatArray:
        values = trials.excesses[tried(x)]
        return np.where(np.isfinite(values), values, 1.0)

    constraints = [optimize.NonlinearConstraint(excesses, -np.inf, -_INSIDE)] if limits else []
    found = optimize.minimize(
        aim,
        begin[continuous],
        method="COBYQA",
        bounds=optimize.Bounds(np.zeros(continuous.sum()), np.ones(continuous.sum())),
        constraints=constraints,
        options={
            "initial_tr_radius": _FIRST_RADIUS,
            "final_tr_radius": _LAST_RADIUS,
            "feasibility_tol": 0.1 * _INSIDE,
            "maxfev": 20 * trials.left,
        },
    )
    end = begin.copy()
    end[continuous] = np.clip(found.x, 0.0, 1.0)
    return end


def require_pareto_library() -> None:
    """Refuse several aims where pymoo is not installed.

    Raises
    ------
    MissingExtraError
    """
    if find_spec("pymoo") is None:
        raise MissingExtraError(
            "several aims need pymoo, which is not installed: pip install 'gearwhine[optimise]'; or give each aim a "
            "weight, so that their weighted sum is the aim"
        )


def _pareto_search(trials: Trials, start: FloatArray | None, seed: int, aims: int) -> None:
    """Evolve a population towards the Pareto front."""
    require_pareto_library()
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.evaluator import Evaluator
    from pymoo.core.problem import Problem
    from pymoo.core.termination import NoTermination
    from pymoo.problems.static import StaticProblem

    space = trials.space
    dimensions = len(space.counts)
    size = min(max(trials.budget // _PARETO_GENERATIONS, _LEAST_POPULATION), _LARGEST_POPULATION)
    problem = Problem(n_var=dimensions, n_obj=aims, n_ieq_constr=1, xl=0.0, xu=1.0)
    algorithm: Any = NSGA2(pop_size=size, sampling=first_points(space, size, start, seed))
    algorithm.setup(problem, termination=NoTermination(), seed=seed)
    stale = 0
    while trials.left and stale < _STALE:
        before = len(trials.points)
        offspring = algorithm.ask()
        if offspring is None or not len(offspring):
            return
        snapped = space.snapped(np.array(offspring.get("X"), dtype=np.float64))
        offspring.set("X", snapped)
        numbers = trials.of(snapped)
        found = np.array([trials.aims[number] for number in numbers])
        excess = np.array([[trials.excess(number)] for number in numbers])
        # Points beyond limits are ranked by their excess alone; a number stands for aims that are not known.
        found = np.where(np.isfinite(found), found, 0.0)
        Evaluator().eval(StaticProblem(problem, F=found, G=excess), offspring)
        algorithm.tell(infills=offspring)
        stale = stale + 1 if len(trials.points) == before else 0


def pareto_front(aims: FloatArray) -> list[int]:
    """Return the numbers of the points that no other one beats in all aims, by the first aim; equal ones once.

    Parameters
    ----------
    aims : ndarray, shape (n, a)
        To be minimised.
    """
    front = list[int]()
    for number in np.lexsort(aims.T[::-1]).tolist():
        # In this order none that comes later can beat one that stands before.
        if not any(np.all(aims[one] <= aims[number]) for one in front):
            front.append(number)
    return front


def balanced(aims: FloatArray) -> int:
    """Return the number of the point of a front that is nearest to the best of all aims, each over its range.

    Parameters
    ----------
    aims : ndarray, shape (n, a)
        Of the points of the front, to be minimised.
    """
    low, wide = aims.min(axis=0), np.ptp(aims, axis=0)
    return int(np.argmin(np.linalg.norm((aims - low) / np.where(wide > 0.0, wide, 1.0), axis=1)))
