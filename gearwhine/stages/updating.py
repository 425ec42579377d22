"""Updating a case's housing: its `[update]` numbers fitted to the measured modes, and what the fit is worth.

The search is made on a mesh of its own, coarse enough for many solves, that moves with the box. The box's own mesh
decides: the search goes on there with a few designs more, each meshed anew.
"""

import time
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.progress import Progress, silent
from gearwhine.stages.designs import HousingDesign, HousingDesigns
from gearwhine.stages.update_keys import FittedCase, fitted_case
from gearwhine.stages.update_target import measurement_of
from housing.updating import (
    Effort,
    Found,
    HeldBack,
    Misfit,
    NullFit,
    Posterior,
    Step,
    Target,
    explore,
    hold_back,
    measure,
    null_fits,
    posterior,
    search,
)

FloatArray = npt.NDArray[np.float64]

_REFINED = 0.05  # trust region of the search that goes on with the finer mesh
_FEW = 10  # solves of that search, and of each random set
_SOFT, _WIDE = 0.4, 0.25  # firmness of the penalties and trust region to begin with
_FIRM = 3.0  # how much less soft the penalties are there
_STARTS = 16  # on the surrogate, where the search is made over and over


@dataclass(frozen=True)
class SolvedUpdate:
    """A housing updated.

    Attributes
    ----------
    fitted : FittedCase
    before, after : HousingDesign
        On the box's own mesh.
    misfit_before, misfit_after : Misfit
        Theirs.
    tuned : HousingDesign
        Where the search on the coarser mesh came to.
    misfit_tuned : Misfit
        Its misfit there.
    target : Target
    left_out : int
        Measured degrees of freedom that took no part.
    posterior : Posterior
    steps : tuple of Step
        Every true solve of the search.
    held_back : list of HeldBack
        Empty where not asked for.
    null : list of NullFit
        Likewise.
    seconds : dict of str to float
    """

    fitted: FittedCase
    before: HousingDesign
    after: HousingDesign
    misfit_before: Misfit
    misfit_after: Misfit
    tuned: HousingDesign
    misfit_tuned: Misfit
    target: Target
    left_out: int
    posterior: Posterior
    steps: tuple[Step, ...]
    held_back: list[HeldBack]
    null: list[NullFit]
    seconds: dict[str, float]


def update_housing(
    case: Case, progress: Progress = silent, *, null: int = 0, held_back: bool = False, threads: int = 2
) -> SolvedUpdate:
    """Fit the parameters of a case's `[update]` to its measured modes.

    Parameters
    ----------
    case : Case
    progress : callable
    null : int
        How many random sets of frequencies to fit likewise.
    held_back : bool
        Whether to fit again without each measured mode in turn, and to predict it.
    threads : int

    Raises
    ------
    CaseError
        Where the case has no parameters or nothing measured, a key leads to no number, or random sets are asked for
        beside measured shapes.
    housing.HousingError
        Where the model cannot be solved as it stands.
    """
    require(case, "housing", "measured", "update", command="update")
    given = case.update
    assert given is not None
    assert case.housing is not None
    measured = measurement_of(case, progress)
    target = measured.target
    if null and target.shapes is not None:
        expected = "0 where shapes were measured: random frequencies have none"
        raise CaseError([Problem("--null", null, expected)])
    begin = time.perf_counter()
    fine = HousingDesigns(fitted_case(case), given.modes, measured.observer, threads=threads)
    coarse = replace(fine, case=fitted_case(case, given.mesh_size))
    progress("solving the housing as it stands")
    start = coarse.solve(coarse.start)
    known: list[HousingDesign] = [start]

    def solve(coordinates: FloatArray, near: HousingDesign | None) -> HousingDesign:
        solved = coarse.solve(coordinates, near)
        if null:  # each keeps a mesh and its modes in memory
            known.append(solved)
        return solved

    effort = Effort(solves=given.solves, seed=given.seed)
    # Soft penalties lead past what is in the way; then the housing is meshed anew, and they count in full.
    half = replace(effort, solves=max(1, given.solves // 2), trust=_WIDE)
    found = explore(solve, replace(target, firmness=_SOFT), coarse.parameters, start, half, given.explore, progress)
    left = replace(effort, solves=max(1, given.solves - len(found.steps)))
    anew = found.design if found.design is start else solve(found.design.coordinates, None)
    full = search(solve, target, coarse.parameters, anew, left, progress)
    found = replace(full, steps=found.steps + full.steps)
    seconds = {"search": time.perf_counter() - begin}
    begin = time.perf_counter()
    tuned = found.design
    before, found = _polished(fine, start, found, target, effort, progress)
    seconds["own_mesh"] = time.perf_counter() - begin
    after = found.design
    spread = posterior(target, found.misfit, after.coordinates, after.surrogate().at(after.coordinates))
    rows: list[HeldBack] = []
    fits: list[NullFit] = []
    if held_back:
        begin = time.perf_counter()
        rows = hold_back(coarse.solve, target, coarse.parameters, start, replace(effort, starts=_STARTS), progress)
        seconds["held_back"] = time.perf_counter() - begin
    if null:
        begin = time.perf_counter()
        few = replace(effort, solves=min(given.solves, _FEW), starts=_STARTS)
        fits = null_fits(coarse.solve, target, coarse.parameters, _thinned(known), few, null, progress=progress)
        seconds["null"] = time.perf_counter() - begin
    return SolvedUpdate(
        fitted=fine.case,
        before=before,
        after=after,
        misfit_before=measure(target, before.state, before.coordinates, strict=True),
        misfit_after=measure(target, after.state, after.coordinates, strict=True),
        tuned=tuned,
        misfit_tuned=measure(target, tuned.state, tuned.coordinates, strict=True),
        target=target,
        left_out=measured.left_out,
        posterior=spread,
        steps=found.steps,
        held_back=rows,
        null=fits,
        seconds=seconds,
    )


def _polished(
    fine: HousingDesigns,
    start: HousingDesign,
    found: Found[HousingDesign],
    target: Target,
    effort: Effort,
    progress: Progress,
) -> tuple[HousingDesign, Found[HousingDesign]]:
    """The start on the housing's own mesh, and the search that goes on there from where it came to on a coarser one.

    Penalties are firm now: what was bent to get here has to be straight in the end. Each design is meshed anew: what a
    moved mesh has and a new one has not is no property of the housing.
    """
    before, begin = start, found.design
    if start.case != fine.case_at(fine.start):
        progress("solving the housing as it stands on its own mesh")
        before = fine.solve(fine.start)
        progress("going on with the housing's own mesh")
        begin = fine.solve(found.design.coordinates)
    few = replace(effort, solves=_FEW, trust=_REFINED)
    firm = replace(target, firmness=_FIRM)
    last = search(lambda point, near: fine.solve(point), firm, fine.parameters, begin, few, progress)
    return before, replace(last, steps=found.steps + last.steps)


def _thinned(designs: list[HousingDesign]) -> list[HousingDesign]:
    """The first, the last and some between."""
    chosen = np.unique(np.linspace(0, len(designs) - 1, min(len(designs), 8)).round().astype(int))
    return [designs[place] for place in chosen]
