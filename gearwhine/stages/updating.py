"""Updating a case's housing: its `[update]` numbers fitted to the measured modes, and what the fit is worth.

The search is made on a mesh of its own, coarse enough for many solves. The box's own mesh decides: the difference that
it makes to each paired mode is taken into the target, and the search goes on until the finer mesh's misfit no longer
falls.
"""

import time
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.progress import Progress, silent
from gearwhine.stages.designs import HousingDesign, HousingDesigns
from gearwhine.stages.measured import read_measured
from gearwhine.stages.update_keys import FittedCase, fitted_case
from housing.correlation import dominance_band
from housing.updating import (
    Effort,
    Found,
    HeldBack,
    Misfit,
    ModeCount,
    NullFit,
    Posterior,
    Solve,
    Step,
    Target,
    counterparts,
    explore,
    hold_back,
    measure,
    null_fits,
    posterior,
    search,
)

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi
_ROUNDS = 4  # of correcting the target by the finer mesh
_REFINED = 0.05  # trust region of a search that goes on after such a correction
_FEW = 10  # solves of each such search, and of each random set
_MARGIN = 1.0 / 3.0  # of the least gap, for the two measures beside the one that decides
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
        On the mesh of the search.
    misfit_tuned : Misfit
        Its misfit, corrected by the finer mesh.
    target : Target
        With the correction.
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
        Where the case has no parameters or nothing measured, or a key leads to no number.
    housing.HousingError
        Where the model cannot be solved as it stands.
    """
    require(case, "housing", "measured", "update", command="update")
    given = case.update
    assert given is not None
    assert case.housing is not None
    if not case.housing.seat:
        raise CaseError(
            [Problem("housing.seat", (), "bearing seats: dominance is the strength between seats and skin")]
        )
    begin = time.perf_counter()
    fine = HousingDesigns(fitted_case(case), given.modes, threads=threads)
    coarse = replace(fine, case=fitted_case(case, given.mesh_size))
    target = target_of(case)
    progress("solving the housing as it stands")
    start = coarse.solve(coarse.start)
    known: list[HousingDesign] = [start]

    def solve(coordinates: FloatArray, near: HousingDesign | None) -> HousingDesign:
        solved = coarse.solve(coordinates, near)
        if null:  # each keeps a mesh and its modes in memory
            known.append(solved)
        return solved

    effort = Effort(solves=given.solves)
    found = explore(solve, target, coarse.parameters, start, effort, given.explore, progress)
    seconds = {"search": time.perf_counter() - begin}
    begin = time.perf_counter()
    before, after, found, target = _corrected(fine, found, target, start, solve, effort, progress)
    seconds["correction"] = time.perf_counter() - begin
    tuned = found.design
    spread = posterior(target, found.misfit, tuned.coordinates, tuned.surrogate().at(tuned.coordinates))
    rows: list[HeldBack] = []
    fits: list[NullFit] = []
    if held_back:
        begin = time.perf_counter()
        rows = hold_back(coarse.solve, target, coarse.parameters, start, replace(effort, starts=_STARTS), progress)
        seconds["held_back"] = time.perf_counter() - begin
    if null:
        begin = time.perf_counter()
        few = replace(effort, solves=_FEW, starts=_STARTS)
        fits = null_fits(coarse.solve, target, coarse.parameters, _thinned(known), few, null, progress=progress)
        seconds["null"] = time.perf_counter() - begin
    own = target_of(case)
    return SolvedUpdate(
        fitted=fine.case,
        before=before,
        after=after,
        misfit_before=measure(own, before.state, before.coordinates),
        misfit_after=measure(own, after.state, after.coordinates),
        tuned=tuned,
        misfit_tuned=found.misfit,
        target=target,
        posterior=spread,
        steps=found.steps,
        held_back=rows,
        null=fits,
        seconds=seconds,
    )


def target_of(case: Case) -> Target:
    """What a case's housing is to meet."""
    assert case.update is not None
    measured = read_measured(case).frequencies
    known = case.update.model_modes
    return Target(
        frequencies=measured,
        noise=np.full(len(measured), case.update.frequency_noise),
        band=dominance_band(measured),
        gap=case.update.gap,
        margin=_MARGIN * case.update.gap if case.update.gap else -np.inf,
        count=None if known is None else ModeCount(_HERTZ * known.below, known.least, known.most),
    )


def _corrected(
    fine: HousingDesigns,
    found: Found[HousingDesign],
    target: Target,
    start: HousingDesign,
    solve: Solve[HousingDesign],
    effort: Effort,
    progress: Progress,
) -> tuple[HousingDesign, HousingDesign, Found[HousingDesign], Target]:
    """The start and the best design on the finer mesh, the search that led there, and its corrected target."""
    if start.designs.case.document == fine.case.document:
        return start, found.design, found, target
    progress("solving the housing as it stands on its own mesh")
    before = fine.solve(fine.start)
    best: tuple[float, HousingDesign, Found[HousingDesign], Target] | None = None
    own, steps = target, found.steps
    for _ in range(_ROUNDS):
        progress("solving on the housing's own mesh")
        after = fine.solve(found.design.coordinates)
        misfit = measure(own, after.state, after.coordinates)
        progress(
            f"on its own mesh: rms {misfit.rms_percent:.2f} %, max {misfit.max_percent:.2f} %, gap {misfit.gap:.2f}, "
            f"margin {misfit.margin:.2f}"
        )
        coarse = measure(own, found.design.state, found.design.coordinates)
        # Of the very modes that the search has paired: the finer mesh may pair others, which is the gap's and the
        # margin's matter and no error of discretisation.
        told = np.maximum(coarse.pairs, 0)
        same = counterparts(told, found.design.state, after.state)
        corrected = replace(
            target,
            bias=np.log(after.state.frequencies[same] / found.design.state.frequencies[told]),
            gap=own.gap + (max(coarse.gap - misfit.gap, 0.0) if own.gap else 0.0),
            margin=own.margin + (max(coarse.margin - misfit.margin, 0.0) if own.gap else 0.0),
        )
        here = replace(found, misfit=measure(corrected, found.design.state, found.design.coordinates))
        if best is not None and misfit.value > best[0] * (1.0 - _REFINED):
            if misfit.value < best[0]:
                best = (misfit.value, after, here, corrected)
            break
        best, target = (misfit.value, after, here, corrected), corrected
        few = replace(effort, solves=_FEW, trust=_REFINED)
        found = search(solve, target, start.designs.parameters, found.design, few, progress)
        steps += found.steps
        if found.design is here.design:
            break
    assert best is not None
    return before, best[1], replace(best[2], steps=steps), best[3]


def _thinned(designs: list[HousingDesign]) -> list[HousingDesign]:
    """The first, the last and some between."""
    chosen = np.unique(np.linspace(0, len(designs) - 1, min(len(designs), 8)).round().astype(int))
    return [designs[place] for place in chosen]
