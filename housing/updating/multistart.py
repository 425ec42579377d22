"""Multistart search by successive halving: many starts on a coarse mesh, the better half continued on a fine one.

The choice of dominant modes gives the misfit many local minima, and a search from one start ends in the nearest. So the
search begins from many starts, round by round, and the better half of each round continues (successive halving:
Jamieson and Talwalkar 2016). In the first round every start has a few solutions on the coarse mesh, with the mesh's
bias corrected (:mod:`gearwhine.housing.updating.mesh_bias`). A bias learned at one design is wrong by per cents some
standard deviations away where walls are thin, so that the other rounds use the fine mesh itself. Penalties grow from
round to round. The search ends where a design meets the target on the fine mesh, or with its last round.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, Protocol

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.updating.mesh_bias import Debiased, MeshBias, debiased
from gearwhine.housing.updating.misfit import Misfit, Target, is_met, measure
from gearwhine.housing.updating.parameters import Parameter, coordinate_bounds
from gearwhine.housing.updating.surrogate import ModalState, Surrogate
from gearwhine.housing.updating.trust_region import AnyDesign, Effort, SearchResult, Solve, Step, descend, search
from gearwhine.numerics.arrays import FloatArray

_DRAWN = 8  # draws from the prior for each start that is solved
_DESCENT = 25  # steps of each draw on the surrogate
_LEAST_START_DISTANCE = 0.5  # least distance of two starts, as a part of a draw's usual distance from nominal
_NEVER_PARTED = (4, 2)  # least number of searches that continue into each round on the fine mesh
FIRMNESS = (0.4, 1.0, 3.0)  # firmness of the penalties in each round, the first on the coarse mesh
TRUST = (0.25, 0.15, 0.1)  # trust radius in each round
_FINE_SOLVES = (3, 5)  # full solutions of each runner in the rounds on the fine mesh
_STARTS = 16  # starts on the surrogate
_POLISHED = 6  # final full solutions where the target is not met
_REFINED = 0.05  # trust region of the final solutions


class Each(Protocol):
    """A map of work over tasks, parallel or not, that yields the results in the tasks' order as they come."""

    def __call__(self, work: Callable[[Any], Any], tasks: Sequence[Any]) -> Iterable[Any]:
        """Yield the results of the work."""


def serial_map(work: Callable[[Any], Any], tasks: Sequence[Any]) -> Iterator[Any]:
    """Map work over tasks one after the other; a serial :class:`Each`."""
    return map(work, tasks)


@dataclass(frozen=True)
class Meshes(Generic[AnyDesign]):
    """Solvers on both meshes of a multistart search.

    Attributes
    ----------
    coarse : callable
        See :data:`gearwhine.housing.updating.Solve`.
    fine : callable
        Solver on the fine mesh, which is made anew at each design; None where there is one mesh only.
    light : callable
        Reduces a design of the fine mesh for the next round, so that it is not solved again.
    """

    coarse: Solve[AnyDesign]
    fine: Solve[AnyDesign] | None
    light: Callable[[AnyDesign], AnyDesign] = lambda design: design

    def judge(self, coordinates: FloatArray, near: AnyDesign | None = None) -> AnyDesign:
        """Solve a design on the fine mesh, or on the only one."""
        return (self.coarse if self.fine is None else self.fine)(coordinates, None)


@dataclass(frozen=True)
class Runner(Generic[AnyDesign]):
    """State of one of the searches.

    Attributes
    ----------
    number : int
    coordinates : ndarray, shape (n_parameters,)
    judged : ModalState, or None
        Modes of the fine mesh at these coordinates; None where it was not solved yet.
    design : Design, or None
        The fine mesh's design at these coordinates, reduced, where the last round was run on it.
    """

    number: int
    coordinates: FloatArray
    judged: ModalState | None = None
    design: AnyDesign | None = None


@dataclass(frozen=True)
class MultistartResult(Generic[AnyDesign]):
    """Result of a multistart search.

    Attributes
    ----------
    coordinates : ndarray, shape (n_parameters,)
        Coordinates of the best design on the fine mesh.
    misfit : Misfit
        Misfit of that design.
    is_met : bool
        Whether it meets the target.
    steps : tuple of Step
        Every solve of all searches.
    seen : tuple of ndarray
        Coordinates of every design solved on the fine mesh.
    design : Design, or None
        The best design on the fine mesh, where it was found there.
    """

    coordinates: FloatArray
    misfit: Misfit
    is_met: bool
    steps: tuple[Step, ...]
    seen: tuple[FloatArray, ...]
    design: AnyDesign | None = None


Ran = tuple[Runner[AnyDesign], float, tuple[Step, ...]]


@dataclass(frozen=True)
class _Run(Generic[AnyDesign]):
    """Task of a worker: one search in one round."""

    meshes: Meshes[AnyDesign]
    target: Target
    parameters: tuple[Parameter, ...]
    effort: Effort
    bias: MeshBias | None
    on_fine: bool

    def __call__(self, runner: Runner[AnyDesign]) -> Ran[AnyDesign]:
        """Return the search's new state, its misfit, and its steps; the misfit is infinite where no model is valid."""
        solve = self.meshes.judge if self.on_fine else self.meshes.coarse
        try:
            begin = solve(runner.coordinates, None) if runner.design is None else runner.design
        except HousingError:
            return runner, np.inf, ()
        effort = replace(self.effort, seed=self.effort.seed + runner.number)
        searched = search(debiased(solve, self.bias), self.target, self.parameters, Debiased(begin, self.bias), effort)
        ended = replace(runner, coordinates=searched.design.coordinates, judged=None)
        if self.on_fine:
            ended = replace(ended, judged=searched.design.state, design=self.meshes.light(searched.design.design))
        return ended, searched.misfit.value, searched.steps


def multistart_search(
    meshes: Meshes[AnyDesign],
    target: Target,
    parameters: Sequence[Parameter],
    start: AnyDesign,
    judged: ModalState | None,
    effort: Effort,
    count: int,
    each: Each = serial_map,
    progress: Callable[[str], None] = lambda message: None,
) -> MultistartResult[AnyDesign]:
    """Search from a start and from the best of some draws of the prior.

    Parameters
    ----------
    meshes : Meshes
    target : Target
    parameters : sequence of Parameter
    start : Design
        Start design, solved on the coarse mesh.
    judged : ModalState, or None
        Modes of the start on the fine mesh; None where there is one mesh only.
    effort : Effort
        Effort; its solves are those of all searches in the round on the coarse mesh.
    count : int
        Number of starts, the given one among them.
    each : callable
        See :class:`Each`: the result does not depend on the number of workers.
    progress : callable
    """
    bias = None if judged is None else MeshBias.between(start.state, judged)
    soft = replace(target, firmness=FIRMNESS[0])
    points = [start.coordinates]
    if count > 1:
        progress(f"bringing {_DRAWN * (count - 1)} draws of the prior down")
    points += _drawn(Debiased(start, bias).surrogate(), soft, parameters, count - 1, effort.seed, each)
    runners = [Runner[AnyDesign](number, point) for number, point in enumerate(points)]
    first = replace(runners[0], judged=judged)
    if judged is None:
        first = replace(first, judged=start.state, design=start)
    best = _better(None, target, first, lambda message: None)
    going = _going(count)
    steps = list[Step]()
    for index, number in enumerate(going):
        on_fine = index > 0
        if best.is_met:
            break
        solves = _FINE_SOLVES[index - 1] if on_fine else max(1, effort.solves // count)
        round_effort = replace(effort, solves=solves, trust=TRUST[index], starts=_STARTS)
        weighed, off = replace(target, firmness=FIRMNESS[index]), None if on_fine else bias
        run = _Run(meshes, weighed, tuple(parameters), round_effort, off, on_fine)
        ran = sorted(each(run, runners[:number]), key=lambda row: row[1])
        steps += [step for *_, own_steps in ran for step in own_steps]
        misfits = ", ".join(f"{value:.4g}" for _, value, _ in ran)
        progress(f"round {index + 1} of {len(going)}: {len(ran)} searches, misfits {misfits}")
        runners = [runner for runner, value, _ in ran if np.isfinite(value)]
        if on_fine:
            best = _best(best, target, runners, progress)
            if not any(step.accepted for *_, own_steps in ran for step in own_steps):
                break
    return replace(best, steps=tuple(steps))


def polish(
    solve: Solve[AnyDesign],
    best: MultistartResult[AnyDesign],
    target: Target,
    parameters: Sequence[Parameter],
    effort: Effort,
    progress: Callable[[str], None] = lambda message: None,
) -> SearchResult[AnyDesign]:
    """Continue from the best design of a multistart search with firm penalties until the target is met.

    Where the search has met the target already, its design is the result.

    Parameters
    ----------
    solve : callable
        Solves a design on the fine mesh. Each design is meshed anew, so that no property of a morphed mesh enters the
        result.
    best : MultistartResult
        Result of :func:`multistart_search`.
    target, parameters, effort, progress
        See :func:`multistart_search`.
    """
    firm = replace(target, firmness=FIRMNESS[-1])
    polish_effort = replace(effort, solves=0 if best.is_met else _POLISHED, trust=_REFINED)
    begin = solve(best.coordinates, None) if best.design is None else best.design

    def is_enough(design: AnyDesign) -> bool:
        return is_met(target, measure(firm, design.state, design.coordinates, strict=True))

    return search(lambda point, _: solve(point, None), firm, parameters, begin, polish_effort, progress, is_enough)


def _best(
    best: MultistartResult[AnyDesign],
    target: Target,
    runners: Sequence[Runner[AnyDesign]],
    progress: Callable[[str], None],
) -> MultistartResult[AnyDesign]:
    """Return the best of the previous best and of the searches solved on the fine mesh."""
    for runner in runners:
        best = _better(best, target, runner, progress)
    return best


def _better(
    best: MultistartResult[AnyDesign] | None, target: Target, runner: Runner[AnyDesign], progress: Callable[[str], None]
) -> MultistartResult[AnyDesign]:
    """Return the better of the previous best and of one search on the fine mesh, by the penalties of the last round."""
    assert runner.judged is not None
    misfit = measure(replace(target, firmness=FIRMNESS[-1]), runner.judged, runner.coordinates, strict=True)
    met = is_met(target, misfit)
    progress(
        f"search {runner.number + 1} on the fine mesh: misfit {misfit.value:.4g}, rms {misfit.rms_percent:.2f} %, "
        f"{misfit.in_words}"
        f"{': all that is asked for' if met else ''}"
    )
    seen = (*(() if best is None else best.seen), runner.coordinates)
    if best is None or (met, -misfit.value) > (best.is_met, -best.misfit.value):
        return MultistartResult(runner.coordinates, misfit, met, (), seen, runner.design)
    return replace(best, seen=seen)


def _going(count: int) -> list[int]:
    """Return the number of searches in each round."""
    going = [count]
    for few in _NEVER_PARTED:
        going.append(min(going[-1], max(few, (going[-1] + 1) // 2)))
    return going


@dataclass(frozen=True)
class _Descent:
    """Descent from a draw of the prior on a surrogate: end point and misfit."""

    surrogate: Surrogate
    target: Target
    bounds: FloatArray

    def __call__(self, drawn: FloatArray) -> tuple[FloatArray, float]:
        return descend(self.surrogate, self.target, drawn, self.bounds, _DESCENT)


def _drawn(
    surrogate: Surrogate, target: Target, parameters: Sequence[Parameter], count: int, seed: int, each: Each
) -> list[FloatArray]:
    """Coordinates of the best distinct designs that descents on a surrogate reach from draws of the prior."""
    if not count:
        return []
    bounds, generator = coordinate_bounds(parameters), np.random.default_rng(seed)
    draws = np.clip(generator.normal(size=(_DRAWN * count, bounds.shape[1])), *bounds)
    ends = each(_Descent(surrogate, target, bounds), list(draws))
    apart = [surrogate.center]
    for point, _ in sorted(ends, key=lambda end: end[1]):
        if all(np.linalg.norm(point - other) > _LEAST_START_DISTANCE * np.sqrt(len(point)) for other in apart):
            apart.append(point)
    return apart[1 : count + 1]
