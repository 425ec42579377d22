"""What a fit is worth: modes held back from it, and the same search made on frequencies that no one measured.

Many parameters fit few frequencies, so that a small error proves little. A mode that took no part in the fit tests it;
and where random frequencies are fitted as well as the measured ones, the fit alone says nothing of the housing.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from housing.updating.misfit import Misfit, Target, measure
from housing.updating.parameters import Parameter
from housing.updating.posterior import posterior
from housing.updating.search import AnyDesign, Effort, Solve, search

FloatArray = npt.NDArray[np.float64]

_APART = 0.01  # least relative distance of two random frequencies: what a survey would tell apart


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


def hold_back(
    solve: Solve[AnyDesign],
    target: Target,
    parameters: Sequence[Parameter],
    start: AnyDesign,
    effort: Effort,
    progress: Callable[[str], None] = lambda message: None,
) -> list[HeldBack]:
    """Fit to all measured modes but one, from the start, and predict that one; for each of them.

    How many dominant modes there are stays known, so that the pairing is the same as when all are fitted.
    """
    rows = []
    first = measure(target, start.state, start.coordinates)
    before = start.surrogate().at(start.coordinates)
    for mode, noise in enumerate(target.noise):
        progress(f"holding back mode {mode + 1} of {len(target.noise)}")
        others = replace(target, noise=np.where(np.arange(len(target.noise)) == mode, np.inf, target.noise))
        found = search(solve, others, parameters, start, effort)
        near = found.design.surrogate().at(found.design.coordinates)
        after = posterior(others, found.misfit, found.design.coordinates, near)
        pair = int(found.misfit.pairs[mode])
        left = np.delete(found.misfit.errors, mode)
        slopes = before.slopes[:, first.pairs[mode]]
        rows.append(
            HeldBack(
                mode=mode,
                measured=float(target.frequencies[mode]),
                predicted=float(target.frequencies[mode] * np.exp(found.misfit.errors[mode])),
                deviation=float(np.hypot(after.frequency_deviations()[pair], noise)),
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
    progress: Callable[[str], None] = lambda message: None,
) -> list[NullFit]:
    """The same search on random sets of as many frequencies, between the first and the last measured one.

    Each set begins at whichever of some designs, already solved, is nearest to it: what the search for the measured set
    had to find by itself is a gift here, so that the null test errs on the side of doubt.
    """
    generator = np.random.default_rng(seed)
    fits = []
    for number in range(count):
        drawn = random_frequencies(target.frequencies, generator)
        null = replace(target, frequencies=drawn)
        start = min(starts, key=lambda design: measure(null, design.state, design.coordinates).value)
        found = search(solve, null, parameters, start, replace(effort, seed=effort.seed + number))
        fits.append(_null_fit(drawn, found.misfit))
        progress(
            f"random set {number + 1} of {count}: rms {fits[-1].rms_percent:.2f} %, max {fits[-1].max_percent:.2f} %"
        )
    return fits


def random_frequencies(measured: FloatArray, generator: np.random.Generator) -> FloatArray:
    """As many frequencies, uniform between the first and the last measured one, none too close for a survey."""
    low, high = float(measured[0]), float(measured[-1])
    while True:
        drawn = np.sort(generator.uniform(low, high, len(measured)))
        if len(drawn) == 1 or (np.diff(np.log(drawn)) > _APART).all():
            return np.asarray(drawn)


def _null_fit(frequencies: FloatArray, misfit: Misfit) -> NullFit:
    return NullFit(frequencies, misfit.rms_percent, misfit.max_percent, misfit.gap, misfit.measures_agree, misfit.value)
