"""Trust-region search: steps on a surrogate, full solutions, and acceptance of true decreases of the misfit only.

Within the region the surrogate is searched from many starts by Gauss-Newton steps on the modes that are paired there;
the best end point is solved in full. Where that lessens the misfit it is the next design, else the region shrinks.
scipy's ``least_squares`` on the solved designs takes twice the solutions and pairs 3 or 4 of 12 housings wrongly, since
it does not know of modes that change partners between two designs: ``benchmarks/update_search.py``.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, Self, TypeVar

import numpy as np
from scipy.optimize import lsq_linear

from gearwhine.housing.errors import HousingError
from gearwhine.housing.updating.misfit import UNPAIRED, Misfit, Target, measure, residuals
from gearwhine.housing.updating.parameters import Parameter, coordinate_bounds
from gearwhine.housing.updating.surrogate import ModalState, Neighbour, Surrogate
from gearwhine.numerics.arrays import FloatArray

_STEPS = 8  # Gauss-Newton steps from each start
_LEAST_PREDICTED_DECREASE = 0.02  # least predicted decrease for a full solution, as a part of the misfit
_SHORTENED = (1.0, 0.5, 0.25, 0.1)


class Design(Protocol):
    """A design that has been solved."""

    @property
    def coordinates(self) -> FloatArray:
        """Coordinates z, shape (n_parameters,)."""

    @property
    def state(self) -> ModalState:
        """Modes of the design."""

    def surrogate(self) -> Surrogate:
        """Return the surrogate about the design."""


AnyDesign = TypeVar("AnyDesign", bound=Design)

Solve = Callable[[FloatArray, AnyDesign | None], AnyDesign]
"""Solves a design at coordinates z; the second argument is a neighbour whose mesh it may start from.

Raises :class:`gearwhine.housing.HousingError` where there is no sound model."""


@dataclass(frozen=True)
class Effort:
    """Limits and settings of a search.

    Attributes
    ----------
    solves : int
        Largest number of full solutions.
    starts : int
        Starts on the surrogate, in each region.
    trust : float
        Half-width of the first region, as a part of each range.
    least_trust : float
        Half-width below which the search ends.
    enough : float
        J below which the search ends.
    seed : int
    """

    solves: int = 30
    starts: int = 40
    trust: float = 0.15
    least_trust: float = 0.005
    enough: float = 0.0
    seed: int = 1


@dataclass(frozen=True)
class Step:
    """One full solution of a search: predicted and true misfit, and the trust region."""

    promised: float
    found: float
    accepted: bool
    trust: float
    rms_percent: float


@dataclass(frozen=True)
class SearchResult(Generic[AnyDesign]):
    """Result of a search."""

    design: AnyDesign
    misfit: Misfit
    steps: tuple[Step, ...]


def search(
    solve: Solve[AnyDesign],
    target: Target,
    parameters: Sequence[Parameter],
    start: AnyDesign,
    effort: Effort = Effort(),
    progress: Callable[[str], None] = lambda message: None,
    until: Callable[[AnyDesign], bool] = lambda design: False,
) -> SearchResult[AnyDesign]:
    """Fit the parameters, from a design that has been solved.

    Parameters
    ----------
    solve : callable
        See :data:`Solve`.
    target : Target
    parameters : sequence of Parameter
    start : Design
    effort : Effort
    progress : callable
        Called with a line of text for each solution.
    until : callable
        Whether the search may end at a design.

    Returns
    -------
    SearchResult
        The best of all designs solved, the start among them; or the first at which the search may end.
    """
    bounds = coordinate_bounds(parameters)
    generator = np.random.default_rng(effort.seed)
    design, misfit = start, measure(target, start.state, start.coordinates)
    trust, steps = effort.trust, list[Step]()
    surrogate = None
    while len(steps) < effort.solves and trust >= effort.least_trust and misfit.value > effort.enough:
        region = _region(design.coordinates, bounds, trust)
        if surrogate is None:
            surrogate = design.surrogate()
        point, promised = search_surrogate(surrogate, target, region, effort.starts, generator)
        if promised > misfit.value - _LEAST_PREDICTED_DECREASE * abs(misfit.value):
            # No better point found: perhaps it is so near that other starts find it in a smaller region.
            trust *= 0.5
            continue
        try:
            trial = solve(point, design)
        except HousingError as error:
            progress(f"solve {len(steps) + 1}: no sound housing there ({error})")
            steps.append(Step(promised, np.inf, False, trust, np.inf))
            trust *= 0.5
            continue
        measured = measure(target, trial.state, trial.coordinates)
        accepted = measured.value < misfit.value
        steps.append(Step(promised, measured.value, accepted, trust, measured.rms_percent))
        gain_ratio = (misfit.value - measured.value) / (misfit.value - promised)
        progress(
            f"solve {len(steps)}: misfit {measured.value:.4g} ({'better' if accepted else 'no better'} than "
            f"{misfit.value:.4g}, {promised:.4g} promised), rms {measured.rms_percent:.2f} %, "
            f"{measured.in_words}, "
            f"trust {trust:.3f}"
        )
        enough = until(trial)
        if accepted or enough:
            design, misfit, surrogate = trial, measured, None
        if enough:
            break
        trust = min(trust * 1.4, 0.4) if gain_ratio > 0.6 else trust if gain_ratio > 0.25 else trust * 0.5
    return SearchResult(design, misfit, tuple(steps))


def search_surrogate(
    surrogate: Surrogate, target: Target, region: FloatArray, starts: int, generator: np.random.Generator
) -> tuple[FloatArray, float]:
    """Minimise the misfit of the surrogate within a region, shape (2, n): least misfit and its coordinates."""
    low, high = region
    center = np.clip(surrogate.center, low, high)
    points = [center, *(low + (high - low) * generator.random((starts, len(low))))]
    first, *others = (_Place.on(surrogate, target, point) for point in points)
    best_point, best = center, first.misfit.value
    # The surrogate's centre, and the better half of the others, since most of these reach the same minima.
    for start in [first, *sorted(others, key=lambda place: place.misfit.value)[: max(1, starts // 2)]]:
        point, value = descend(surrogate, target, start, region)
        if value < best:
            best_point, best = point, value
    return best_point, best


@dataclass(frozen=True)
class _Place:
    """A point of the surrogate with its modes and its misfit."""

    point: FloatArray
    near: Neighbour
    misfit: Misfit

    @classmethod
    def on(cls, surrogate: Surrogate, target: Target, point: FloatArray) -> Self:
        near = surrogate.at(point)
        return cls(point, near, measure(target, near.state, point))


def descend(
    surrogate: Surrogate, target: Target, start: FloatArray | _Place, region: FloatArray, steps: int = _STEPS
) -> tuple[FloatArray, float]:
    """Descend from a start by Gauss-Newton steps on the surrogate, within the region."""
    low, high = region
    place = start if isinstance(start, _Place) else _Place.on(surrogate, target, start)
    point, near, misfit = place.point, place.near, place.misfit
    for _ in range(steps):
        if (misfit.pairs == UNPAIRED).all():
            break
        missed, slopes = residuals(target, misfit, near, penalties=True)
        rows, right = [slopes, np.eye(len(point))], [-missed, -point]
        room = np.stack([low - point, high - point]) + np.array([[-1e-12], [1e-12]])
        step = lsq_linear(np.vstack(rows), np.concatenate(right), bounds=room, method="bvls").x
        for part in _SHORTENED:
            trial = _Place.on(surrogate, target, np.clip(point + part * step, low, high))
            if trial.misfit.value < misfit.value:
                break
        else:
            break
        settled = misfit.value - trial.misfit.value < 1e-3 * misfit.value
        point, near, misfit = trial.point, trial.near, trial.misfit
        if settled:
            break
    return point, misfit.value


def _region(point: FloatArray, bounds: FloatArray, trust: float) -> FloatArray:
    half = trust * (bounds[1] - bounds[0])
    return np.stack([np.maximum(point - half, bounds[0]), np.minimum(point + half, bounds[1])])
