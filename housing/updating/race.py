"""A search from many starts on a coarse mesh that a fine one judges, the better half of them going on.

What is asked of a choice of dominant modes parts the designs into basins, and a search from one start ends in the
nearest. So many are begun, heat by heat. In each heat every runner is searched for with a few solves on the coarse
mesh, the mesh's bias taken off (:mod:`housing.updating.bias`); the better half is then solved on the fine mesh, which
judges them and tells the bias at each of them anew. Penalties grow from heat to heat (Jamieson and Talwalkar 2016 on
successive halving). The race ends where a design meets all that is asked for on the fine mesh, or with its last heat.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, Protocol

import numpy as np
import numpy.typing as npt

from housing.errors import HousingError
from housing.updating.bias import Debiased, MeshBias, debiased
from housing.updating.misfit import Misfit, Target, is_met, measure
from housing.updating.parameters import Parameter, coordinate_bounds
from housing.updating.search import AnyDesign, Effort, Solve, Step, descend, search
from housing.updating.surrogate import ModalState, Surrogate

FloatArray = npt.NDArray[np.float64]

_DRAWN = 8  # from the prior for each start that is solved
_DESCENT = 25  # steps of each on the surrogate
_APART = 0.5  # least distance of two starts, as a part of a draw's usual distance from nominal
_HEATS = 6
_LAST = 2  # runners that are never parted
_FIRMNESS = (0.4, 1.0, 3.0)  # of the penalties in the heats, the last in all others
_TRUST = (0.25, 0.15, 0.1)  # likewise
_STARTS = 16  # on the surrogate


class Each(Protocol):
    """Does work on each of some tasks, side by side or not, and returns the results in the tasks' order."""

    def __call__(self, work: Callable[[Any], Any], tasks: Sequence[Any]) -> list[Any]:
        """The results."""


def one_by_one(work: Callable[[Any], Any], tasks: Sequence[Any]) -> list[Any]:
    """The plainest :class:`Each`."""
    return [work(task) for task in tasks]


@dataclass(frozen=True)
class Meshes(Generic[AnyDesign]):
    """Both meshes of a race.

    Attributes
    ----------
    coarse : callable
        See :data:`housing.updating.Solve`.
    fine : callable
        The modes at coordinates on the mesh that judges; None where there is one mesh only.
    """

    coarse: Solve[AnyDesign]
    fine: Callable[[FloatArray], ModalState] | None


@dataclass(frozen=True)
class Runner:
    """Where one of the searches is.

    Attributes
    ----------
    number : int
    coordinates : ndarray, shape (n_parameters,)
    bias : MeshBias, or None
        Of the design where the race began; None where there is one mesh only.
    judged : ModalState, or None
        What the fine mesh has here; None where it has not been asked yet.
    """

    number: int
    coordinates: FloatArray
    bias: MeshBias | None
    judged: ModalState | None = None


@dataclass(frozen=True)
class Raced:
    """How a race has ended.

    Attributes
    ----------
    coordinates : ndarray, shape (n_parameters,)
        Of the best design that the fine mesh has seen.
    misfit : Misfit
        Its own there.
    is_met : bool
        Whether it meets all that is asked for.
    steps : tuple of Step
        Every solve on the coarse mesh.
    seen : tuple of ndarray
        Coordinates of every design that the fine mesh has judged.
    """

    coordinates: FloatArray
    misfit: Misfit
    is_met: bool
    steps: tuple[Step, ...]
    seen: tuple[FloatArray, ...]


@dataclass(frozen=True)
class _Run(Generic[AnyDesign]):
    """One runner's search in one heat: what a worker is told."""

    meshes: Meshes[AnyDesign]
    target: Target
    parameters: tuple[Parameter, ...]
    effort: Effort

    def __call__(self, runner: Runner) -> tuple[Runner, float, tuple[Step, ...]]:
        """The runner where it has come to, its misfit there, and its steps; infinite where nothing is sound there."""
        try:
            begin = self.meshes.coarse(runner.coordinates, None)
        except HousingError:
            return runner, np.inf, ()
        # Learned on this very mesh where the fine one has been here, else what is known from where the race began.
        bias = runner.bias if runner.judged is None else MeshBias.between(begin.state, runner.judged)
        effort = replace(self.effort, seed=self.effort.seed + runner.number)
        found = search(debiased(self.meshes.coarse, bias), self.target, self.parameters, Debiased(begin, bias), effort)
        return replace(runner, coordinates=found.design.coordinates), found.misfit.value, found.steps


@dataclass(frozen=True)
class _Judge(Generic[AnyDesign]):
    """The fine mesh's judgement of a runner."""

    meshes: Meshes[AnyDesign]

    def __call__(self, runner: Runner) -> ModalState | None:
        """What it has there; None where it has nothing sound."""
        try:
            if self.meshes.fine is None:
                return self.meshes.coarse(runner.coordinates, None).state
            return self.meshes.fine(runner.coordinates)
        except HousingError:
            return None


def race(
    meshes: Meshes[AnyDesign],
    target: Target,
    parameters: Sequence[Parameter],
    start: AnyDesign,
    judged: ModalState | None,
    effort: Effort,
    count: int,
    each: Each = one_by_one,
    progress: Callable[[str], None] = lambda message: None,
) -> Raced:
    """Race a start and the best of some draws of the prior.

    Parameters
    ----------
    meshes : Meshes
    target : Target
    parameters : sequence of Parameter
    start : Design
        Solved on the coarse mesh.
    judged : ModalState, or None
        The fine mesh's modes of the same; None where there is one mesh only.
    effort : Effort
        Its solves are those of all runners in all heats.
    count : int
        Runners, the start among them.
    each : callable
        See :class:`Each`: the result does not depend on how many are run side by side.
    progress : callable
    """
    bias = None if judged is None else MeshBias.between(start.state, judged)
    soft = replace(target, firmness=_FIRMNESS[0])
    points = [start.coordinates]
    if count > 1:
        progress(f"bringing {_DRAWN * (count - 1)} draws of the prior down")
    points += _drawn(Debiased(start, bias).surrogate(), soft, parameters, count - 1, effort.seed, each)
    runners = [Runner(number, point, bias) for number, point in enumerate(points)]
    best = _better(None, target, runners[0], start.state if judged is None else judged, lambda message: None)
    going = _going(count)
    solves = max(1, effort.solves // sum(going))
    steps = list[Step]()
    for heat, left in enumerate([*going[1:], going[-1]]):
        firmness, trust = (values[min(heat, len(values) - 1)] for values in (_FIRMNESS, _TRUST))
        own = replace(effort, solves=solves, trust=trust, starts=_STARTS)
        ran = each(_Run(meshes, replace(target, firmness=firmness), tuple(parameters), own), runners)
        ran.sort(key=lambda row: row[1])
        told = ", ".join(f"{value:.4g}" for _, value, _ in ran)
        progress(f"heat {heat + 1} of {_HEATS}: {len(ran)} searches, misfits {told}")
        steps += [step for *_, own_steps in ran for step in own_steps]
        if heat + 1 >= len(_FIRMNESS) and not any(step.accepted for *_, own_steps in ran for step in own_steps):
            break  # and the fine mesh has judged them all
        kept = [runner for runner, value, _ in ran if np.isfinite(value)][:left]
        runners = []
        for runner, state in zip(kept, each(_Judge(meshes), kept), strict=True):
            if state is not None:
                best = _better(best, target, runner, state, progress)
                fine = None if meshes.fine is None else state
                runners.append(replace(runner, judged=fine))
        if best.is_met or not runners:
            break
    return replace(best, steps=tuple(steps))


def _better(
    best: Raced | None, target: Target, runner: Runner, state: ModalState, progress: Callable[[str], None]
) -> Raced:
    """The better of the best so far and of a runner that has been judged."""
    misfit = measure(target, state, runner.coordinates, strict=True)
    met = is_met(target, misfit)
    progress(
        f"search {runner.number + 1} on the fine mesh: misfit {misfit.value:.4g}, rms {misfit.rms_percent:.2f} %, "
        f"max {misfit.max_percent:.2f} %, gap {misfit.gap:.2f}, margin {misfit.margin:.2f}, {misfit.count} modes"
        f"{': all that is asked for' if met else ''}"
    )
    seen = (*(() if best is None else best.seen), runner.coordinates)
    if best is None or (met, -misfit.value) > (best.is_met, -best.misfit.value):
        return Raced(runner.coordinates, misfit, met, (), seen)
    return replace(best, seen=seen)


def _going(count: int) -> list[int]:
    """How many there are in each heat."""
    going = [count]
    while len(going) < _HEATS:
        going.append(min(going[-1], max(_LAST, (going[-1] + 1) // 2)))
    return going


@dataclass(frozen=True)
class _Descent:
    """From a draw of the prior down on a surrogate: where that leads to, and its misfit."""

    surrogate: Surrogate
    target: Target
    bounds: FloatArray

    def __call__(self, drawn: FloatArray) -> tuple[FloatArray, float]:
        return descend(self.surrogate, self.target, drawn, self.bounds, _DESCENT)


def _drawn(
    surrogate: Surrogate, target: Target, parameters: Sequence[Parameter], count: int, seed: int, each: Each
) -> list[FloatArray]:
    """Coordinates of the best designs, apart from each other, that a surrogate leads to from draws of the prior."""
    if not count:
        return []
    bounds, generator = coordinate_bounds(parameters), np.random.default_rng(seed)
    draws = np.clip(generator.normal(size=(_DRAWN * count, bounds.shape[1])), *bounds)
    ends = each(_Descent(surrogate, target, bounds), list(draws))
    apart = [surrogate.center]
    for point, _ in sorted(ends, key=lambda end: end[1]):
        if all(np.linalg.norm(point - other) > _APART * np.sqrt(len(point)) for other in apart):
            apart.append(point)
    return apart[1 : count + 1]
