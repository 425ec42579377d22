"""Model updating of a case's housing: the search, and the validation of the fit.

The search is made on a mesh of its own, coarse enough for many solves, that moves with the box, with that mesh's bias
taken off. The box's own mesh decides: it judges every few solves, and the search ends with a few designs more there,
each meshed anew.
"""

import time
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearwhine.case import Case, CaseError, Problem, require
from gearwhine.progress import Progress, silent
from gearwhine.stages.designs import HousingAtParameters, ParametricHousing
from gearwhine.stages.side_by_side import default_workers, in_parallel
from gearwhine.stages.update_keys import FittedCase, FittedNumber, fitted_case, unit_in_si
from gearwhine.stages.update_target import measurement_of
from gearwhine.stages.update_worth import NullTest, full_update_search, leave_one_out_modes, random_frequency_sets
from housing.updating import (
    UNPAIRED,
    Each,
    Effort,
    LeftOutMode,
    Meshes,
    Misfit,
    MultistartResult,
    Parameter,
    Posterior,
    Step,
    Target,
    measure,
    multistart_search,
    polish,
    posterior,
)

_AT_END = 1e-3  # part of a range that counts as its end
_PARTS = 4  # parameters named of each combination


@dataclass(frozen=True)
class FoundNumber:
    """Parameter of an update and what was found for it.

    Attributes
    ----------
    number : FittedNumber
    value, deviation : float
        With its standard deviation, in SI.
    left : float
        Standard deviation as a part of the prior's.
    """

    number: FittedNumber
    value: float
    deviation: float
    left: float

    @property
    def parameter(self) -> Parameter:
        """The parameter with its range and prior."""
        return self.number.parameter

    @property
    def unit_in_si(self) -> float:
        """The unit that the case gives it in."""
        return unit_in_si(self.number.given)

    @property
    def is_at_end(self) -> bool:
        """Whether the value stands at an end of its range."""
        low, high = self.parameter.low, self.parameter.high
        return bool(min(self.value - low, high - self.value) < _AT_END * (high - low))


@dataclass(frozen=True)
class UpdatedPair:
    """Measured mode, and its partner before and after an update.

    Attributes
    ----------
    measured : float
        Circular frequency [rad/s].
    before_error, error : float
        ln(model / measured); NaN where it has no partner.
    mode : int or None
        Number of its partner after the update, from 1.
    before_mac, mac : float or None
        None without shapes.
    strength : float or None
        The partner's lateral acceleration strength [1/kg].
    uncertainty : float or None
        Relative standard deviation of the partner's frequency that the parameters leave.
    """

    measured: float
    before_error: float
    error: float
    mode: int | None
    before_mac: float | None
    mac: float | None
    strength: float | None
    uncertainty: float | None

    @property
    def before(self) -> float:
        """Circular frequency of the model before the update [rad/s]."""
        return float(self.measured * np.exp(self.before_error))

    @property
    def after(self) -> float:
        """Circular frequency of the model after the update [rad/s]."""
        return float(self.measured * np.exp(self.error))

    @property
    def before_error_percent(self) -> float:
        """Model minus measured before the update, in per cent of measured."""
        return float(100.0 * np.expm1(self.before_error))

    @property
    def error_percent(self) -> float:
        """Model minus measured after the update, in per cent of measured."""
        return float(100.0 * np.expm1(self.error))


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
    before: HousingAtParameters
    after: HousingAtParameters
    misfit_before: Misfit
    misfit_after: Misfit
    start: HousingAtParameters
    target: Target
    left_out: int
    posterior: Posterior
    steps: tuple[Step, ...]
    held_back: list[LeftOutMode]
    null: NullTest | None
    seconds: dict[str, float]

    @cached_property
    def found(self) -> tuple[FoundNumber, ...]:
        """The parameters with their values after the update."""
        numbers = self.fitted.numbers
        values = self.posterior.values([number.parameter for number in numbers])
        return tuple(
            FoundNumber(number, *value, float(left))
            for number, value, left in zip(numbers, values, self.posterior.deviations, strict=True)
        )

    @cached_property
    def pairs(self) -> tuple[UpdatedPair, ...]:
        """The measured modes with their partners before and after."""
        before, after = self.misfit_before, self.misfit_after
        left = self.posterior.frequency_deviations()
        strengths = self.after.state.dominance.acceleration
        return tuple(
            UpdatedPair(
                measured=float(measured),
                before_error=float(before.errors[place]),
                error=float(after.errors[place]),
                mode=None if mode == UNPAIRED else int(mode) + 1,
                before_mac=None if before.mac is None else float(before.mac[place]),
                mac=None if after.mac is None else float(after.mac[place]),
                strength=None if mode == UNPAIRED else float(strengths[mode]),
                uncertainty=None if mode == UNPAIRED else float(left[mode]),
            )
            for place, (measured, mode) in enumerate(zip(self.target.frequencies, after.pairs, strict=True))
        )

    @property
    def combinations(self) -> list[tuple[float, dict[str, float]]]:
        """Combinations of parameters by what the data say of them: information, and the leading parts by name."""
        rows = []
        for information, direction in zip(self.posterior.information, self.posterior.directions, strict=True):
            leading = np.argsort(-np.abs(direction))[:_PARTS]
            sign = np.sign(direction[leading[0]])
            parts = {self.found[place].parameter.name: float(sign * direction[place]) for place in leading}
            rows.append((float(information), parts))
        return rows


def update_housing(
    case: Case, progress: Progress = silent, *, null: int = 0, held_back: bool = False, threads: int = 2
) -> SolvedUpdate:
    """Fit the parameters of a case's `[update]` to its measured modes.

    Parameters
    ----------
    case : Case
    progress : callable
    null : int
        Number of random frequency sets to fit.
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
    fine = ParametricHousing(fitted_case(case), given.modes, measured.observer, threads=threads, as_written=True)
    coarse = replace(fine, case=fitted_case(case, given.mesh_size))
    effort, count = Effort(solves=given.solves, seed=given.seed), 1 + given.explore
    before, start, raced = _raced(fine, coarse, target, effort, count, threads, progress)
    seconds = {"search": time.perf_counter() - begin}
    begin = time.perf_counter()
    progress("going on with the housing's own mesh")
    found = polish(replace(fine, draft=True).solve, raced, target, fine.parameters, effort, progress)
    # On the way modes were not counted; those that are reported are certified.
    after = replace(fine.solve(found.design.coordinates), known=found.design.surrogate())
    seconds["own_mesh"] = time.perf_counter() - begin
    rows: list[LeftOutMode] = []
    null_test: NullTest | None = None
    with _sharing(threads, len(target.noise) * held_back + null) as each:
        procedure = full_update_search(start, effort, count)
        if held_back:
            begin = time.perf_counter()
            rows = leave_one_out_modes(procedure, target, each, progress)
            seconds["held_back"] = time.perf_counter() - begin
        if null:
            begin = time.perf_counter()
            null_test = random_frequency_sets(procedure, target, null, each, progress)
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
        posterior=posterior(target, found.misfit, after.coordinates, after.surrogate().at(after.coordinates)),
        steps=raced.steps + found.steps,
        held_back=rows,
        null=null_test,
        seconds=seconds,
    )


def _sharing(threads: int, tasks: int) -> AbstractContextManager[Each]:
    """Pool for single-thread tasks; one task is done in this process."""
    return in_parallel(min(threads, tasks, default_workers()))


def _raced(
    fine: ParametricHousing,
    coarse: ParametricHousing,
    target: Target,
    effort: Effort,
    count: int,
    threads: int,
    progress: Progress,
) -> tuple[HousingAtParameters, HousingAtParameters, MultistartResult[HousingAtParameters]]:
    """The housing as it stands on both meshes, and the search from there and from other starts.

    Where there are several starts all is done by one thread each, from the first solution on: with other numbers of
    threads sums are rounded otherwise, and a search that is led by its last digits ends elsewhere.
    """
    progress("solving the housing as it stands")
    each_has = threads if count == 1 else 1
    fine, coarse = replace(fine, threads=each_has), replace(coarse, threads=each_has)
    same = coarse.case_at(coarse.start) == fine.case_at(fine.start)
    with _sharing(threads, count) as each:
        tasks = [(fine, True)] if same else [(fine, False), (coarse, True)]
        solved: list[HousingAtParameters] = list(each(_as_it_stands, tasks))
        before, start = solved[0], solved[-1]
        own = None if same else replace(fine, draft=True).solve
        meshes = Meshes(replace(coarse, draft=True).solve, own, HousingAtParameters.light)
        judged = None if same else before.state
        raced = multistart_search(meshes, target, coarse.parameters, start, judged, effort, count, each, progress)
    return before, start, raced


def _as_it_stands(task: tuple[ParametricHousing, bool]) -> HousingAtParameters:
    """Solved where the case begins, and with its neighbourhood where that is wanted."""
    designs, wanted = task
    design = designs.solve(designs.start)
    return replace(design, known=design.surrogate()) if wanted else design
