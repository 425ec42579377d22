"""Updating a case's housing: its `[update]` numbers fitted to the measured modes, and what the fit is worth.

The search is made on a mesh of its own, coarse enough for many solves, that moves with the box, with that mesh's bias
taken off. The box's own mesh decides: it judges every few solves, and the search ends with a few designs more there,
each meshed anew.
"""

import time
from dataclasses import dataclass, replace

from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.progress import Progress, silent
from gearwhine.stages.designs import HousingDesign, HousingDesigns
from gearwhine.stages.side_by_side import default_workers, side_by_side
from gearwhine.stages.update_keys import FittedCase, fitted_case
from gearwhine.stages.update_target import measurement_of
from gearwhine.stages.update_worth import NullTest, held_back_modes, random_sets, whole_search
from housing.updating import (
    Each,
    Effort,
    HeldBack,
    Meshes,
    Misfit,
    ModalState,
    Posterior,
    Raced,
    Step,
    Target,
    measure,
    polish,
    posterior,
    race,
)


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
    start : HousingDesign
        Where the search began, on its coarser mesh.
    target : Target
    left_out : int
        Measured degrees of freedom that took no part.
    posterior : Posterior
    steps : tuple of Step
        Every true solve of the search.
    held_back : list of HeldBack
        Empty where not asked for.
    null : NullTest, or None
        Likewise None.
    seconds : dict of str to float
    """

    fitted: FittedCase
    before: HousingDesign
    after: HousingDesign
    misfit_before: Misfit
    misfit_after: Misfit
    start: HousingDesign
    target: Target
    left_out: int
    posterior: Posterior
    steps: tuple[Step, ...]
    held_back: list[HeldBack]
    null: NullTest | None
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
    fine = HousingDesigns(fitted_case(case), given.modes, measured.observer, threads=threads, as_written=True)
    coarse = replace(fine, case=fitted_case(case, given.mesh_size))
    progress("solving the housing as it stands")
    same = coarse.case_at(coarse.start) == fine.case_at(fine.start)
    effort = Effort(solves=given.solves, seed=given.seed)
    with side_by_side(min(threads, default_workers())) as each:
        before, start = _started(fine, fine if same else coarse, each)
        raced = _raced(fine, start, None if same else before.state, target, effort, 1 + given.explore, each, progress)
    seconds = {"search": time.perf_counter() - begin}
    begin = time.perf_counter()
    progress("going on with the housing's own mesh")
    found = polish(replace(fine, draft=True).solve, raced, target, fine.parameters, effort, progress)
    # On the way modes were not counted; those that are told of have their proof.
    after = replace(fine.solve(found.design.coordinates), known=found.design.surrogate())
    seconds["own_mesh"] = time.perf_counter() - begin
    spread = posterior(target, found.misfit, after.coordinates, after.surrogate().at(after.coordinates))
    rows: list[HeldBack] = []
    null_test: NullTest | None = None
    # One thread each, as in the race.
    with side_by_side(min(threads, default_workers()) if held_back or null else 1) as each:
        procedure = whole_search(start, effort, 1 + given.explore)
        if held_back:
            begin = time.perf_counter()
            rows = held_back_modes(procedure, target, each, progress)
            seconds["held_back"] = time.perf_counter() - begin
        if null:
            begin = time.perf_counter()
            null_test = random_sets(procedure, target, null, each, progress)
            seconds["null"] = time.perf_counter() - begin
    return SolvedUpdate(
        fitted=fine.case,
        before=before,
        after=after,
        misfit_before=measure(target, before.state, before.coordinates, strict=True),
        misfit_after=measure(target, after.state, after.coordinates, strict=True),
        start=start,
        target=target,
        left_out=measured.left_out,
        posterior=spread,
        steps=raced.steps + found.steps,
        held_back=rows,
        null=null_test,
        seconds=seconds,
    )


def _started(fine: HousingDesigns, coarse: HousingDesigns, each: Each) -> tuple[HousingDesign, HousingDesign]:
    """The housing as it stands on both meshes.

    By one thread each, as all that follows in the race: with other numbers of threads sums are rounded otherwise, and a
    search that is led by its last digits ends elsewhere.
    """
    alone = replace(fine, threads=1)
    tasks = [(alone, coarse is fine), (replace(coarse, threads=1), True)]
    solved = list(each(_as_it_stands, tasks[: 1 if coarse is fine else 2]))
    return solved[0], solved[-1]


def _as_it_stands(task: tuple[HousingDesigns, bool]) -> HousingDesign:
    """Solved where the case begins, and with its neighbourhood where that is wanted."""
    designs, wanted = task
    design = designs.solve(designs.start)
    return replace(design, known=design.surrogate()) if wanted else design


def _raced(
    fine: HousingDesigns,
    start: HousingDesign,
    judged: ModalState | None,
    target: Target,
    effort: Effort,
    count: int,
    each: Each,
    progress: Progress,
) -> Raced[HousingDesign]:
    """The search from the start and others on the coarse mesh, judged by the fine one, one thread for each."""
    coarse, own = (replace(designs, threads=1, draft=True) for designs in (start.designs, fine))
    meshes = Meshes(coarse.solve, None if judged is None else own.solve, HousingDesign.light)
    return race(meshes, target, coarse.parameters, start, judged, effort, count, each, progress)
