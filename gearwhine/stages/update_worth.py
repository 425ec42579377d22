"""What an update is worth, on the search's mesh: modes held back, and random sets of frequencies fitted likewise.

"Likewise" is what one start of the race goes through on that mesh, its two heats: a race for each set would take days.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.progress import Progress
from gearwhine.stages.designs import HousingDesign, HousingDesigns
from housing.updating import (
    Debiased,
    Each,
    Effort,
    HeldBack,
    MeshBias,
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
    start: HousingDesign, bias: MeshBias | None, target: Target, seed: int, each: Each, progress: Progress
) -> list[HeldBack]:
    """Each mode predicted by a fit to the others, from the case as it stands.

    Parameters
    ----------
    start : HousingDesign
        Of the search's mesh.
    bias : MeshBias, or None
        That mesh's, at the start: what is known at the end has seen the mode that is held back.
    """
    progress(f"holding back {len(target.noise)} modes, one at a time")
    solve = debiased(start.designs.solve, bias)
    effort = Effort(solves=_SOLVES, starts=_STARTS, seed=seed)
    return hold_back(solve, target, start.designs.parameters, Debiased(start.light(), bias), effort, each, progress)


def null_test(
    tuned: HousingDesign,
    bias: MeshBias | None,
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
    tuned : HousingDesign
        Of the search's mesh, where the search has ended.
    bias : MeshBias, or None
        That mesh's, there.
    seen : sequence of ndarray
        Coordinates of designs that the race has come through; the first is its start.
    """
    progress(f"fitting {count} random sets of {len(target.noise)} frequencies")
    designs = tuned.designs
    solve = debiased(designs.solve, bias)
    known = [Debiased(design, bias) for design in [*each(_Solved(designs), _thinned(seen)), tuned.light()]]
    effort = Effort(solves=_SOLVES, starts=_STARTS, seed=seed)
    fits = null_fits(solve, target, designs.parameters, known, effort, count, each=each, progress=progress)
    (own,) = fit_sets(solve, target, designs.parameters, known[:1], effort, [target.frequencies], each)
    return NullTest(fits, own)


def _thinned(points: Sequence[FloatArray]) -> list[FloatArray]:
    """The first, the last and some between."""
    chosen = np.unique(np.linspace(0, len(points) - 1, min(len(points), _KEPT)).round().astype(int))
    return [points[place] for place in chosen]
