"""What a fit is worth: modes held back from it, and the same search made on frequencies that no one measured.

Many parameters fit few frequencies, so that a small error proves little. A mode that took no part in the fit tests it;
and where random frequencies are fitted as well as the measured ones, the fit alone says nothing of the housing.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Generic

import numpy as np
import numpy.typing as npt

from housing.updating.misfit import Misfit, Target, measure
from housing.updating.parameters import Parameter
from housing.updating.posterior import Posterior, posterior
from housing.updating.race import FIRMNESS, TRUST, Each, one_by_one
from housing.updating.search import AnyDesign, Effort, Found, Solve, Step, search

FloatArray = npt.NDArray[np.float64]

_APART = 0.01  # least relative distance of two random frequencies: what a survey would tell apart
_BATCH = 4  # fits between two words of progress


@dataclass(frozen=True)
class HeldBack:
    """A mode that was left out of the fit, and predicted by it.

    Attributes
    ----------
    mode : int
        Its place among the measured ones, from 0.
    measured, predicted : float
        Circular frequencies [rad/s].
    deviation : float
        Relative standard deviation of the prediction, by the posterior of the others and the mode's own noise.
    prior_deviation : float
        The same before any fit, at the design where it began.
    start : float
        What that design had [rad/s].
    rms_percent : float
        Of the modes that were fitted.
    """

    mode: int
    measured: float
    predicted: float
    deviation: float
    prior_deviation: float
    start: float
    rms_percent: float

    @property
    def error_percent(self) -> float:
        """Predicted minus measured, in per cent of measured."""
        return 100.0 * (self.predicted / self.measured - 1.0)

    @property
    def start_error_percent(self) -> float:
        """The same of the design where the fit began."""
        return 100.0 * (self.start / self.measured - 1.0)


@dataclass(frozen=True)
class NullFit:
    """A set of frequencies that no one measured, and how well the same model fits it."""

    frequencies: FloatArray
    rms_percent: float
    max_percent: float
    gap: float
    measures_agree: bool
    value: float


def search_in_heats(
    solve: Solve[AnyDesign],
    target: Target,
    parameters: Sequence[Parameter],
    start: AnyDesign,
    effort: Effort,
) -> Found[AnyDesign]:
    """A short search from one start: half of the solves with the penalties of a race's first heat, half of its second.

    The end of the first heat is the start of the second, whatever it misses by full penalties.
    """
    solves = (effort.solves - effort.solves // 2, effort.solves // 2)
    found, steps = None, tuple[Step, ...]()
    for number, firmness, trust in zip(solves, FIRMNESS, TRUST, strict=False):
        bent = replace(target, firmness=firmness * target.firmness)
        begin = start if found is None else found.design
        found = search(solve, bent, parameters, begin, replace(effort, solves=number, trust=trust))
        steps += found.steps
    assert found is not None
    return replace(found, steps=steps)


@dataclass(frozen=True)
class _Fit(Generic[AnyDesign]):
    """A fit from a start to a target, as a worker is told."""

    solve: Solve[AnyDesign]
    parameters: tuple[Parameter, ...]
    effort: Effort

    def __call__(self, task: tuple[Target, AnyDesign, int]) -> tuple[Misfit, Posterior]:
        """The misfit where it ends, by dominant modes and full penalties, and what it leaves of the parameters."""
        target, start, seed = task
        found = search_in_heats(self.solve, target, self.parameters, start, replace(self.effort, seed=seed))
        near = found.design.surrogate().at(found.design.coordinates)
        return found.misfit, posterior(target, found.misfit, found.design.coordinates, near)


def hold_back(
    solve: Solve[AnyDesign],
    target: Target,
    parameters: Sequence[Parameter],
    start: AnyDesign,
    effort: Effort,
    each: Each = one_by_one,
    progress: Callable[[str], None] = lambda message: None,
) -> list[HeldBack]:
    """Fit to all measured modes but one, from the start, and predict that one; for each of them.

    How many dominant modes there are stays known, so that the pairing is the same as when all are fitted.

    Parameters
    ----------
    solve : callable
        See :data:`housing.updating.Solve`.
    target : Target
    parameters : sequence of Parameter
    start : Design
    effort : Effort
        Of each fit; see :func:`search_in_heats`.
    each : callable
        See :class:`Each`: the result does not depend on how many are run side by side.
    progress : callable
    """
    first = measure(target, start.state, start.coordinates)
    before = start.surrogate().at(start.coordinates)
    modes = range(len(target.noise))
    held = [replace(target, noise=np.where(np.arange(len(modes)) == mode, np.inf, target.noise)) for mode in modes]
    fit = _Fit(solve, tuple(parameters), effort)
    rows = []
    ended = _in_batches(each, fit, [(others, start, effort.seed) for others in held])
    for mode, (misfit, after) in enumerate(ended):
        noise, left = target.noise[mode], np.delete(misfit.errors, mode)
        slopes = before.slopes[:, first.pairs[mode]]
        rows.append(
            HeldBack(
                mode=mode,
                measured=float(target.frequencies[mode]),
                predicted=float(target.frequencies[mode] * np.exp(misfit.errors[mode])),
                deviation=float(np.hypot(after.frequency_deviations()[misfit.pairs[mode]], noise)),
                prior_deviation=float(np.hypot(np.linalg.norm(slopes), noise)),
                start=float(target.frequencies[mode] * np.exp(first.errors[mode])),
                rms_percent=float(100.0 * np.sqrt(np.mean(np.expm1(left) ** 2))),
            )
        )
        progress(f"mode {mode + 1} predicted within {rows[-1].error_percent:+.2f} % by the others")
    return rows


def null_fits(
    solve: Solve[AnyDesign],
    target: Target,
    parameters: Sequence[Parameter],
    starts: Sequence[AnyDesign],
    effort: Effort,
    count: int,
    seed: int = 0,
    each: Each = one_by_one,
    progress: Callable[[str], None] = lambda message: None,
) -> list[NullFit]:
    """The same search on random sets of as many frequencies, between the first and the last measured one.

    Each set begins at whichever of some designs, already solved, is nearest to it: what the search for the measured set
    had to find by itself is a gift here. What is not given is the race: one start, and the solves of a few.

    Parameters
    ----------
    solve, target, parameters, effort, each, progress
        See :func:`hold_back`.
    starts : sequence of Design
    count : int
        How many sets.
    seed : int
        Of their frequencies.
    """
    generator = np.random.default_rng(seed)
    sets = [random_frequencies(target.frequencies, generator) for _ in range(count)]
    fits = []
    for number, fit in enumerate(fit_sets(solve, target, parameters, starts, effort, sets, each)):
        fits.append(fit)
        progress(f"random set {number + 1} of {count}: rms {fit.rms_percent:.2f} %, max {fit.max_percent:.2f} %")
    return fits


def fit_sets(
    solve: Solve[AnyDesign],
    target: Target,
    parameters: Sequence[Parameter],
    starts: Sequence[AnyDesign],
    effort: Effort,
    sets: Sequence[FloatArray],
    each: Each = one_by_one,
) -> Iterator[NullFit]:
    """Fit sets of frequencies, each from the nearest of some designs, a few at a time; see :func:`null_fits`."""
    tasks = []
    for number, frequencies in enumerate(sets):
        null = replace(target, frequencies=frequencies)
        start = min(starts, key=lambda design: measure(null, design.state, design.coordinates).value)
        tasks.append((null, start, effort.seed + number))
    ended = _in_batches(each, _Fit(solve, tuple(parameters), effort), tasks)
    for drawn, (misfit, _) in zip(sets, ended, strict=True):
        yield _null_fit(drawn, misfit)


def _in_batches(
    each: Each, fit: _Fit[AnyDesign], tasks: Sequence[tuple[Target, AnyDesign, int]]
) -> Iterator[tuple[Misfit, Posterior]]:
    """The results in the tasks' order, so many at a time that one hears of them on the way."""
    for first in range(0, len(tasks), _BATCH):
        yield from each(fit, tasks[first : first + _BATCH])


def random_frequencies(measured: FloatArray, generator: np.random.Generator) -> FloatArray:
    """As many frequencies, uniform between the first and the last measured one, none too close for a survey."""
    low, high = float(measured[0]), float(measured[-1])
    while True:
        drawn = np.sort(generator.uniform(low, high, len(measured)))
        if len(drawn) == 1 or (np.diff(np.log(drawn)) > _APART).all():
            return np.asarray(drawn)


def _null_fit(frequencies: FloatArray, misfit: Misfit) -> NullFit:
    return NullFit(frequencies, misfit.rms_percent, misfit.max_percent, misfit.gap, misfit.measures_agree, misfit.value)
