"""Cross-validation of a fit: leave-one-out prediction of measured modes, and fits to random frequencies.

Many parameters fit few frequencies, so that a small error proves little. A mode that took no part in the fit tests it;
and where random frequencies are fitted as well as the measured ones, the fit alone proves nothing about the housing.
Each test repeats the whole procedure, from the same start with as many solves; only the mesh is coarser.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Generic

import numpy as np

from gearwhine.housing.updating.misfit import UNPAIRED, Misfit, Target, is_met, measure
from gearwhine.housing.updating.multistart import Each, Meshes, multistart_search, polish, serial_map
from gearwhine.housing.updating.parameters import Parameter, Posterior, posterior
from gearwhine.housing.updating.trust_region import AnyDesign, Effort, Solve
from gearwhine.numerics.arrays import FloatArray

# Least relative distance of two random frequencies, which a survey could still separate.
_LEAST_FREQUENCY_DISTANCE = 0.01


@dataclass(frozen=True)
class LeftOutMode:
    """A mode that was left out of the fit, and predicted by it.

    Attributes
    ----------
    mode : int
        Index among the measured modes, from 0.
    measured, predicted : float
        Circular frequencies [rad/s].
    deviation : float
        Relative standard deviation of the prediction, by the posterior of the others and the mode's own noise.
    prior_deviation : float
        Standard deviation of the prediction before the fit, at the start design.
    start : float
        Frequency of the start design [rad/s].
    rms_percent : float
        Root mean square error of the modes that were fitted.
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
        """Error of the start design in the same measure."""
        return 100.0 * (self.start / self.measured - 1.0)


@dataclass(frozen=True)
class NullFit:
    """A set of frequencies and the quality of the model's fit to it.

    Attributes
    ----------
    frequencies : ndarray, shape (n,)
        Circular frequencies [rad/s], ascending.
    rms_percent, max_percent : float
        Errors of the dominant modes.
    gap : float or None
    measures_agree : bool or None
        None where dominance does not choose the modes.
    count : int
        See :class:`Misfit`.
    is_met : bool
        See :func:`is_met`.
    """

    frequencies: FloatArray
    rms_percent: float
    max_percent: float
    gap: float | None
    measures_agree: bool | None
    count: int
    is_met: bool


@dataclass(frozen=True)
class Procedure(Generic[AnyDesign]):
    """The whole search on one mesh: multistart search, and the final steps where it has not met the target.

    Attributes
    ----------
    solve : callable
        See :data:`gearwhine.housing.updating.Solve`.
    parameters : sequence of Parameter
    start : Design
        Start design, solved.
    effort : Effort
    count : int
        Number of starts, the given one among them.
    """

    solve: Solve[AnyDesign]
    parameters: Sequence[Parameter]
    start: AnyDesign
    effort: Effort
    count: int

    def __call__(self, target: Target) -> tuple[Misfit, Posterior]:
        """Run the search: misfit of the result, by dominant modes, and posterior of the parameters."""
        meshes = Meshes(self.solve, None)
        best = multistart_search(meshes, target, self.parameters, self.start, None, self.effort, self.count)
        polished = polish(self.solve, best, target, self.parameters, self.effort)
        design, coordinates = polished.design, polished.design.coordinates
        near = design.surrogate().at(coordinates)
        judged = measure(target, design.state, coordinates, strict=True)
        return judged, posterior(target, polished.misfit, coordinates, near)


def leave_one_out(
    procedure: Procedure[AnyDesign],
    target: Target,
    each: Each = serial_map,
    progress: Callable[[str], None] = lambda message: None,
) -> list[LeftOutMode]:
    """Leave-one-out: for each measured mode fit all others from the start, and predict it.

    The number of dominant modes stays known, so that the pairing is the same as when all are fitted.

    Parameters
    ----------
    procedure : Procedure
    target : Target
    each : callable
        See :class:`Each`: the result does not depend on the number of workers.
    progress : callable
    """
    start = procedure.start
    first = measure(target, start.state, start.coordinates, strict=True)
    before = start.surrogate().at(start.coordinates)
    modes = range(len(target.noise))
    targets = [replace(target, noise=np.where(np.arange(len(modes)) == mode, np.inf, target.noise)) for mode in modes]
    rows = []
    for mode, (misfit, after) in enumerate(each(procedure, targets)):
        rows.append(
            LeftOutMode(
                mode=mode,
                measured=float(target.frequencies[mode]),
                predicted=float(target.frequencies[mode] * np.exp(misfit.errors[mode])),
                deviation=_deviation(after.frequency_deviations(), misfit, mode, target),
                prior_deviation=_deviation(np.linalg.norm(before.slopes, axis=0), first, mode, target),
                start=float(target.frequencies[mode] * np.exp(first.errors[mode])),
                rms_percent=float(100.0 * np.sqrt(np.mean(np.expm1(np.delete(misfit.errors, mode)) ** 2))),
            )
        )
        progress(f"mode {mode + 1} predicted within {rows[-1].error_percent:+.2f} % by the others")
    return rows


def _deviation(left: FloatArray, misfit: Misfit, mode: int, target: Target) -> float:
    """Return the standard deviation of a measured mode and its model partner together; NaN without a partner."""
    pair = misfit.pairs[mode]
    return float("nan") if pair == UNPAIRED else float(np.hypot(left[pair], target.noise[mode]))


def null_fits(
    procedure: Procedure[AnyDesign],
    target: Target,
    count: int,
    each: Each = serial_map,
    progress: Callable[[str], None] = lambda message: None,
) -> tuple[NullFit, list[NullFit]]:
    """Fit the measured frequencies, and random sets of as many between the first and the last measured one.

    Parameters
    ----------
    procedure : Procedure
    target : Target
    count : int
        Number of random sets.
    each, progress
        See :func:`leave_one_out`.

    Returns
    -------
    measured : NullFit
    random : list of NullFit
    """
    generator = np.random.default_rng(0)
    drawn = [random_frequencies(target.frequencies, generator) for _ in range(count)]
    sets = [target, *(replace(target, frequencies=frequencies) for frequencies in drawn)]
    fits = []
    for number, (misfit, _) in enumerate(each(procedure, sets)):
        fits.append(
            NullFit(
                frequencies=sets[number].frequencies,
                rms_percent=misfit.rms_percent,
                max_percent=misfit.max_percent,
                gap=misfit.gap if misfit.by_dominance else None,
                measures_agree=misfit.measures_agree if misfit.by_dominance else None,
                count=misfit.count,
                is_met=is_met(sets[number], misfit),
            )
        )
        which = f"random set {number} of {count}" if number else "the measured set"
        progress(f"{which}: rms {misfit.rms_percent:.2f} %, max {misfit.max_percent:.2f} %")
    return fits[0], fits[1:]


def random_frequencies(measured: FloatArray, generator: np.random.Generator) -> FloatArray:
    """Random frequencies, as many as measured, uniform between the first and the last, none too close for a survey."""
    low, high = float(measured[0]), float(measured[-1])
    while True:
        drawn = np.sort(generator.uniform(low, high, len(measured)))
        if len(drawn) == 1 or (np.diff(np.log(drawn)) > _LEAST_FREQUENCY_DISTANCE).all():
            return np.asarray(drawn)
