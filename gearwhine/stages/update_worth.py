"""What an update is worth, on the search's mesh: modes held back, and random sets of frequencies fitted likewise.

"Likewise" is shorter than the race, which for each set would take a quarter of an hour: one start, on that mesh alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from gearwhine.progress import Progress
from gearwhine.stages.designs import HousingDesign, HousingDesigns
from housing.updating import (
    Debiased,
    Each,
    Effort,
    HeldBack,
    NullFit,
    Target,
    debiased,
    fit_sets,
    hold_back,
    null_fits,
)

FloatArray = npt.NDArray[np.float64]

_SOLVES = 6  # of each fit
_STARTS = 16  # on the surrogate
_KEPT = 7  # of the designs judged, that random sets may begin at


@dataclass(frozen=True)
class NullTest:
    """Random sets fitted, and the measured one in the same way.

    Attributes
    ----------
    fits : list of NullFit
    measured : NullFit
        From the case's own design: of what the race has found for it nothing is given.
    """

    fits: list[NullFit]
    measured: NullFit


@dataclass(frozen=True)
class _Solved:
    """Solves designs to be sent to other processes."""

    designs: HousingDesigns

    def __call__(self, coordinates: FloatArray) -> HousingDesign:
        return self.designs.solve(coordinates).light()


def held_back_modes(
    start: Debiased[HousingDesign], target: Target, seed: int, each: Each, progress: Progress
) -> list[HeldBack]:
    """Each mode predicted by a fit to the others, from the case as it stands.

    Parameters
    ----------
    start : Debiased
        On the search's mesh, by the bias there: what is known at the end has seen the mode that is held back.
    target, seed, each, progress
        See :func:`housing.updating.hold_back`.
    """
    progress(f"holding back {len(target.noise)} modes, one at a time")
    designs = _alone(start.design)
    solve, begin = debiased(designs.solve, start.bias), Debiased(start.design.light(), start.bias)
    return hold_back(solve, target, designs.parameters, begin, _effort(seed), each, progress)


def random_sets(
    tuned: Debiased[HousingDesign],
    seen: Sequence[FloatArray],
    target: Target,
    count: int,
    seed: int,
    each: Each,
    progress: Progress,
) -> NullTest:
    """Random sets fitted from the nearest of some designs.

    Parameters
    ----------
    tuned : Debiased
        On the search's mesh, where the search has ended, by the bias there.
    seen : sequence of ndarray
        Coordinates of designs that the race has come through; the first is its start.
    target, seed, each, progress
        See :func:`housing.updating.null_fits`.
    count : int
        How many sets.
    """
    progress(f"fitting {count} random sets of {len(target.noise)} frequencies")
    designs = _alone(tuned.design)
    solve = debiased(designs.solve, tuned.bias)
    known = [*each(_Solved(designs), _thinned(seen)), tuned.design.light()]
    starts, parameters = [Debiased(design, tuned.bias) for design in known], designs.parameters
    fits = null_fits(solve, target, parameters, starts, _effort(seed), count, each=each, progress=progress)
    (own,) = fit_sets(solve, target, parameters, starts[:1], _effort(seed), [target.frequencies], each)
    return NullTest(fits, own)


def _effort(seed: int) -> Effort:
    return Effort(solves=_SOLVES, starts=_STARTS, seed=seed)


def _alone(design: HousingDesign) -> HousingDesigns:
    """What solves a design's like by one thread, as a draft."""
    return replace(design.designs, threads=1, draft=True)


def _thinned(points: Sequence[FloatArray]) -> list[FloatArray]:
    """The first, the last and some between."""
    chosen = np.unique(np.linspace(0, len(points) - 1, min(len(points), _KEPT)).round().astype(int))
    return [points[place] for place in chosen]
