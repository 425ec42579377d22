"""Result of an optimisation: designs tried in parallel, the best of them beside the start, and its check in motion."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, get_args

import numpy as np

from gearwhine.analyses.origin import Origin
from gearwhine.analyses.result import Result, no_files
from gearwhine.analyses.variation_result import (
    in_solved_housing,
    limits_of,
    name_problems,
    sampled_points,
    study_folder,
    wanted_of,
    wanted_of_machine,
)
from gearwhine.case import CaseError, CaseSource, Problem, case_document, dump_case
from gearwhine.case.errors import NOTHING, UNSAID, Refusal
from gearwhine.case.model import lacking
from gearwhine.case.optimisation import Aim, Method, Optimisation, Robust
from gearwhine.case.units import si_amount
from gearwhine.case.variation import Limit, Variation
from gearwhine.coupling import CouplingError, Machine
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.failures import explain
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.distributions import Discrete, Uniform
from gearwhine.numerics.findings import Choice, Number, Rule, attribute_findings, refuse
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning
from gearwhine.optimisation.design import (
    AS_WRITTEN,
    DesignInput,
    ProposedCase,
    alone_warnings,
    design_inputs,
    require_scatter,
    space_of,
    start_point,
    value_problems,
    written_value,
)
from gearwhine.optimisation.evaluations import Evaluations, failure_of
from gearwhine.optimisation.goals import NO_AIM, YIELD, Goals, goals_of, statistic_problems
from gearwhine.optimisation.optimised import Design, Optimised, design_of
from gearwhine.optimisation.proposed_machine import ProposedMachine
from gearwhine.optimisation.scatter import Scatter
from gearwhine.optimisation.search import Ended, Trials, require_pareto_library, search, tried_whole
from gearwhine.optimisation.verification import Motion, Moving, Verification, checked_speeds, motion_of
from gearwhine.output.quantity import RPM
from gearwhine.results.optimisation import OPTIMISED, optimised_document
from gearwhine.settings import Settings
from gearwhine.solutions import Failure, StudyProgress
from gearwhine.solve.radiated_power import Radiations
from gearwhine.study_folder import StudyFolder
from gearwhine.variation.cost import cost_of_study
from gearwhine.variation.inputs import varied_inputs
from gearwhine.variation.machines import Made, Maker, made
from gearwhine.variation.named_quantities import analysis_of, plain_pattern, statistic_of
from gearwhine.variation.quantities import ANALYSES, Evaluation, Wanted
from gearwhine.variation.samples import Varied
from gearwhine.workers import default_workers

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_GRID = 100_000
"""Most designs of a grid."""


def solve_optimisation(
    source: CaseSource,
    folder: StudyFolder,
    *,
    evaluations: int | None = None,
    method: Method | None = None,
    seed: int | None = None,
) -> Result[Optimised]:
    """Find the best designs of a case, with the designs of a generation in parallel.

    Parameters
    ----------
    source : CaseSource
        Content of the case with its optimisation, from which the designs are made, too.
    folder : StudyFolder
    evaluations, method, seed
        As of :meth:`gearwhine.case_study.CaseStudy.optimise`.

    Raises
    ------
    CaseError
        Where a key cannot be designed, or an aim, a limit or a range cannot be.
    gearwhine.failures.MissingExtraError
        Where several aims need a package that is not installed.
    gearwhine.failures.WorkersError
        Where the processes do not start.
    """
    begin, case = time.perf_counter(), source.changed_case()
    optimisation = case.optimisation
    if optimisation is None:
        raise lacking(case, "optimisation", command="optimise")
    settings = SearchSettings(
        optimisation.method if method is None else method,
        optimisation.evaluations if evaluations is None else evaluations,
        optimisation.seed if seed is None else seed,
    )
    settings.require_library(optimisation.aim)
    inputs, scatter, wanted = plan_optimisation(source, optimisation)
    plain = source.without("variation", "optimisation")
    good = {} if case.variation is None else case.variation.limit
    variation = None if optimisation.robust is None else case.variation
    for one in alone_warnings(plain, inputs):
        folder.progress(f"{one['message']}\n")
    proposed = ProposedCase(plain, inputs, wanted, variation=variation)
    proposed, housing = in_solved_housing(proposed, folder, "optimise")
    aimed = _Aimed(optimisation.aim, optimisation.limit, optimisation.robust, good)
    document = case_document(plain.changed_case())
    first = _First(start_point(plain, inputs), tuple(_written(document, one) for one in inputs))
    optimised = _optimised(proposed, inputs, aimed, settings, scatter, first, folder)
    transient, operation = case.transient, case.operation
    if optimisation.verify and operation is not None and transient is not None and transient.run is None:
        optimised = _verified(proposed, optimised, operation.speed, len(scatter[0]), folder.progress)
    origin = Origin(case.title, case=case, housing=housing)

    def design_cases(place: Path, *, pictures: bool) -> Mapping[str, Any]:
        """Write the best design and those of the front as cases."""
        for file, number in optimised.cases.items():
            made = proposed.case(_as_designed(optimised.designs[number], len(scatter[0])))
            title = f"{origin.title}: design {number + 1}".strip(": ")
            # With its scatter and its aims, so that it can be varied, and searched from.
            kept = {"title": title, "variation": case.variation, "optimisation": case.optimisation}
            text = dump_case(made.model_copy(update=kept))
            (place / file).write_text(text, encoding="utf-8")
        return {}

    return _result(origin, optimised, begin, design_cases, proposed.start_warnings)


def optimise(
    make: Callable[[Mapping[str, float]], Machine | Mapping[str, float]],
    laws: Mapping[str, Uniform | Discrete],
    aims: Mapping[str, str | Aim],
    *,
    evaluations: int = 100,
    limits: Mapping[str, tuple[float | None, float | None]] | None = None,
    start: Mapping[str, float] | None = None,
    analyses: Sequence[str] | None = None,
    speeds: Sequence[float] = (),
    plan: TransientPlan | None = None,
    acoustics: Acoustics | None = None,
    scatter: Scatter | None = None,
    method: Method = "search",
    levels: int = 5,
    seed: int = 1,
    title: str = "",
    progress: Progress = silent,
    folder: str | os.PathLike[str] | None = None,
    workers: int | None = 1,
    scheduler: str | None = None,
    fresh: bool = False,
) -> Result[Optimised]:
    """Find the best of the machines that a function makes of designed values.

    Parameters
    ----------
    make : callable
        Makes a machine of the values by name, or returns quantities of your own by name, which are taken as they are.
        What it cannot make raises `ValueError`, and the design fails by itself.
    laws : mapping of str to Uniform or Discrete
        Range of each value, or the list of those that it may have, of :mod:`gearwhine.numerics.distributions`.
    aims : mapping of str to str or Aim
        "least" or "most" by the name of a quantity; an `Aim` of :mod:`gearwhine.case.optimisation` may have a weight.
    evaluations : int
        Largest number of machines.
    limits : mapping of str to tuple, optional
        Least and largest value of a quantity, None where there is none: ``{"bearing.left.life_h": (5000.0, None)}``.
    start : mapping of str to float, optional
        Values to begin with and to compare with; by default the middle of each range, the first value of each list.
    analyses : sequence of str, optional
        What is found of each machine; by default what aims and limits name.
    speeds : sequence of float
        Signed speeds of "lines" and "sound" [rad/s]; by default that of each machine.
    plan : TransientPlan, optional
        Stretch of the motion; with it the transient of the start and of the proposed machines is solved at the end.
    acoustics : Acoustics, optional
        Settings of "sound", by default boundary elements in free air; each housing is solved once.
    scatter : Scatter, optional
        Machines about each design, of :mod:`gearwhine.optimisation.scatter`; aims and limits are then of the worse side
        of their scatter, or of statistics such as ``mean of machine.mass_kg`` and ``yield``.
    method : {"search", "grid"}
        "grid" tries every combination of the values, of each range a number of levels.
    levels : int
        Number of levels of a range in a grid.
    seed : int
    title : str
    progress : callable
    folder, workers, scheduler, fresh
        As of :func:`gearwhine.vary`.

    Raises
    ------
    CouplingError
        Where an analysis is none of these, nothing is designed, or a range or an aim cannot be.
    CaseError
        Where an aim or a limit is of a quantity that the machines do not have.
    gearwhine.failures.MissingExtraError
        Where several aims need a package that is not installed.
    Exception
        What `make` or an analysis raises of the start.

    Examples
    --------
    >>> import gearwhine as gw
    >>> from gearwhine.numerics.distributions import Uniform
    >>> def bar(values):
    ...     width, height = values["width"], values["height"]
    ...     return {"area_m2": width * height, "stiffness": width * height**3}
    >>> ranges = {"width": Uniform(0.1, 1.0), "height": Uniform(0.1, 1.0)}
    >>> best = gw.optimise(bar, ranges, {"area_m2": "least"}, limits={"stiffness": (0.2, None)}).solved.best
    >>> round(best.sides["area_m2"][0], 3)
    0.2
    """
    inputs = designed_inputs(laws, levels)
    middles = {
        name: law.values[0] if isinstance(law, Discrete) else 0.5 * (law.low + law.high) for name, law in laws.items()
    }
    first = dict(start or middles)
    if set(first) != set(laws):
        raise CouplingError(f"optimise: a start with {', '.join(first)}; expected a value of each of {', '.join(laws)}")
    machine = made(make, ({} if scatter is None else scatter.medians) | first)
    settings = Settings(title, plan, speeds=speeds, acoustics=acoustics)
    search_settings = SearchSettings(method, evaluations, seed)
    with study_folder(progress, folder, workers, scheduler, fresh=fresh) as place:
        return optimise_machine(
            make, machine, inputs, first, aims, search_settings, settings, place,
            limits=limits, analyses=analyses, scatter=scatter,
        )  # fmt: skip


def optimise_machine(
    make: Maker,
    machine: Made,
    inputs: tuple[DesignInput, ...],
    first: Mapping[str, float],
    aims: Mapping[str, str | Aim],
    search_settings: SearchSettings,
    settings: Settings,
    folder: StudyFolder,
    *,
    origin: Origin | None = None,
    limits: Mapping[str, tuple[float | None, float | None]] | None = None,
    analyses: Sequence[str] | None = None,
    scatter: Scatter | None = None,
) -> Result[Optimised]:
    """Find the best of the machines that a function makes, beside one with its values; see :func:`optimise`."""
    begin = time.perf_counter()
    good = {} if scatter is None else limits_of("optimise, scatter", scatter.good)
    robust = None if scatter is None else scatter.robust
    aimed = _Aimed(_senses(aims), limits_of("optimise", limits), robust, good)
    if not aimed.aims:
        raise CaseError([NO_AIM])
    if analyses is None:
        named = map(analysis_of, _quantities_named(aimed.aims, aimed.limits, good))
        analyses = tuple(dict.fromkeys(filter(None, named)))
    wanted = wanted_of_machine("optimise", machine, settings, analyses)
    if problems := list(statistic_problems(aimed.aims, aimed.limits, robust, good)):
        raise CaseError(problems)
    search_settings.require_library(aimed.aims)
    radiations, plan = Radiations(settings.acoustics, folder.progress), settings.transient
    proposed = ProposedMachine(make, inputs, wanted, radiations, machine, first=first, scatter=scatter, plan=plan)
    points = np.zeros((1, 0)) if scatter is None else scatter.points
    coordinates = [one.coordinate_of(float(first[one.name])) for one in inputs]
    start = _First(coordinates, tuple(f"{float(first[one.name]):.6g}" for one in inputs))
    optimised = _optimised(proposed, inputs, aimed, search_settings, points, start, folder)
    if isinstance(machine, Machine) and plan is not None and plan.run is None:
        optimised = _verified(proposed, optimised, machine.speed, len(points[0]), folder.progress)
    return _result(origin or Origin(settings.title), optimised, begin, warnings=proposed.start_warnings)


class _Proposed(Varied, Protocol):
    """Designs by their points, of a case or as a function makes them."""

    def moving(self, point: FloatArray | None, /) -> Moving:
        """Return the machine of a design, of None that of the start, and how its motion is found."""


@dataclass(frozen=True)
class _Aimed:
    """Aims and limits by the names that are given, how the scatter counts, and the limits of a yield."""

    aims: Mapping[str, Aim]
    limits: Mapping[str, Limit]
    robust: Robust | None
    good: Mapping[str, Limit]


@dataclass(frozen=True)
class _First:
    """Start: its coordinate of each input, None of a value that the design does not have, and its values in words."""

    coordinates: Sequence[float | None]
    written: tuple[str, ...]


def _optimised(
    proposed: _Proposed,
    inputs: tuple[DesignInput, ...],
    aimed: _Aimed,
    settings: SearchSettings,
    scatter: FloatArray,
    first: _First,
    folder: StudyFolder,
) -> Optimised:
    """Search the designs of a case or of Python, with those of a generation in parallel.

    Parameters
    ----------
    proposed : _Proposed
    inputs : tuple of DesignInput
    aimed : _Aimed
    settings : SearchSettings
    scatter : ndarray, shape (n, v)
        Points of the scatter about each design.
    first : _First
    folder : StudyFolder
    """
    folder.progress("the start")
    nominal = proposed.evaluation(None)
    if not nominal.numbers:
        raise CouplingError(f"optimise: no analysis finds {', '.join(aimed.aims)}; expected names as machine.mass_kg")
    goals = goals_of(aimed.aims, aimed.limits, list(nominal.numbers), aimed.robust, aimed.good)
    evaluated = Evaluations(proposed, folder)

    def tried(points: FloatArray, to_come: int) -> list[Design]:
        rows = np.vstack([_with_scatter(point, scatter) for point in points])
        outcomes = evaluated.of(rows, to_come * len(scatter))
        groups = [outcomes[place : place + len(scatter)] for place in range(0, len(rows), len(scatter))]
        found = [[one.numbers for one in group if isinstance(one, Evaluation)] for group in groups]
        return [
            design_of(point, numbers, failure_of(group), goals)
            for point, numbers, group in zip(points, found, groups, strict=True)
        ]

    count = _most_designs(inputs, settings) * len(scatter)
    as_written = np.full((1, len(inputs)), AS_WRITTEN)
    with evaluated.opened():
        (start,) = tried(as_written, 0)
        one = evaluated.of(_with_scatter(as_written[0], scatter[:1]))[0]
        if isinstance(one, Evaluation) and folder.scheduler is None:
            taken = sum(one.seconds.values()) * count / (folder.workers or default_workers())
            if text := cost_of_study(one, taken, count, "gearboxes at most", "optimisation"):
                folder.progress(f"{text}\n")
        designs, ended = _searched(inputs, goals, settings, first.coordinates, tried, folder.progress)
    return Optimised(
        inputs=inputs,
        goals=goals,
        method=settings.words(goals, inputs),
        start=start,
        written=first.written,
        designs=tuple(designs),
        ended=ended,
        gearboxes=len(scatter),
        resumed=evaluated.resumed,
    )


@dataclass(frozen=True)
class SearchSettings:
    """How designs are searched for."""

    method: Method
    evaluations: int
    seed: int

    def __post_init__(self) -> None:
        """Refuse numbers that cannot be, and a method that there is not."""
        rules: dict[str, Rule] = {
            "method": Choice(get_args(Method)),
            "evaluations": Number(at_least=1, whole=True),
            "seed": Number(at_least=0, whole=True),
        }
        refuse(attribute_findings(("optimise", ""), self, **rules), CouplingError)

    def require_library(self, aims: Mapping[str, Aim]) -> None:
        """Refuse a search for a Pareto front where its library is not installed."""
        if self.method == "search" and len(aims) > 1 and any(aim.weight is None for aim in aims.values()):
            require_pareto_library()

    def words(self, goals: Goals, inputs: Sequence[DesignInput]) -> str:
        """Return the method in words."""
        if self.method == "grid":
            return "grid"
        if goals.count > 1:
            return "NSGA-II"
        if all(one.count for one in inputs):
            return "differential evolution"
        return "differential evolution, then trust region"


def _searched(
    inputs: Sequence[DesignInput],
    goals: Goals,
    settings: SearchSettings,
    coordinates: Sequence[float | None],
    tried: Callable[[FloatArray, int], list[Design]],
    progress: Progress,
) -> tuple[list[Design], Ended]:
    """Try designs as the method says."""
    designs, space = list[Design](), space_of(inputs)
    budget, levels = _most_designs(inputs, settings), [one.levels for one in inputs]
    reached = StudyProgress(progress, "designs", budget)

    def find(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        found = tried(points, budget - len(designs) - len(points))
        designs.extend(found)
        within = sum(one.excess == 0.0 for one in designs)
        reached.report(len(designs), f" at most, {within} within the limits")
        return np.array([one.minimised for one in found]), np.array([one.excesses for one in found])

    trials = Trials(space, find, budget)
    if settings.method == "grid":
        return designs, tried_whole(trials, levels)
    start = None if None in coordinates else np.array(coordinates, dtype=np.float64)
    return designs, search(trials, start, settings.seed, goals.count)


def _most_designs(inputs: Sequence[DesignInput], settings: SearchSettings) -> int:
    """Return the largest number of designs that are tried."""
    if settings.method != "grid":
        return settings.evaluations
    count = int(np.prod([one.count or one.levels for one in inputs], dtype=np.float64))
    if count > MOST_GRID:
        raise CaseError([Problem("the number of designs of the grid", count, f"at most {MOST_GRID}")])
    return count


def _with_scatter(point: FloatArray, scatter: FloatArray) -> FloatArray:
    """Return the points of all gearboxes about a design, shape (n, d + v)."""
    return np.hstack([np.repeat(point[None], len(scatter), axis=0), scatter])


def _scatter(
    robust: Robust | None, variation: Variation | None, source: CaseSource, inputs: Sequence[DesignInput]
) -> FloatArray:
    """Return the points of the scatter about each design, shape (n, v); one without coordinates where there is none."""
    if robust is None:
        return np.zeros((1, 0))
    if variation is None or not variation.vary:
        expected = "distributions of keys under [variation.vary], by which gearboxes scatter about each design"
        raise CaseError([Problem("variation", NOTHING, expected)])
    require_scatter(inputs, source, variation)
    return sampled_points(varied_inputs(source, variation), variation, robust.samples, variation.seed)


def _written(document: Mapping[str, Any], one: DesignInput) -> str:
    """Return the values that the case has at the keys of an input, one where they are alike."""
    alone = [replace(one, keys=(key,)) for key in one.keys]
    return ", ".join(dict.fromkeys(_shown(each, written_value(document, each)) or "–" for each in alone))


def _shown(one: DesignInput, value: object) -> str:
    """Return a value of the case in the unit of the design; empty where it has none."""
    amount, scale = si_amount(value), si_amount(f"1 {one.unit}") if one.unit else 1.0
    if one.words or amount is None or scale is None:
        return "" if value is NOTHING else str(value)
    return f"{amount / one.keys[0][1] / scale:.6g} {one.unit}".strip()


def plan_optimisation(
    source: CaseSource, optimisation: Optimisation
) -> tuple[tuple[DesignInput, ...], FloatArray, Wanted]:
    """Check the optimisation of a case; return its inputs, the points of the scatter and what is found of each design.

    Raises
    ------
    CaseError
        With every key that cannot be designed, and every aim, limit and range that cannot be.
    """
    case, refusal, plain = source.changed_case(), Refusal(), source.without("variation", "optimisation")
    if not optimisation.design:
        refusal.add(Problem("optimisation.design", UNSAID, "the values of one key or more"))
    if not optimisation.aim:
        refusal.add(NO_AIM)
    inputs = design_inputs(source, optimisation, refusal)
    refusal.add(*value_problems(plain, inputs))
    good = {} if case.variation is None else case.variation.limit
    refusal.add(*statistic_problems(optimisation.aim, optimisation.limit, optimisation.robust, good))
    variation = None if optimisation.robust is None else case.variation
    with refusal:
        _scatter(optimisation.robust, variation, plain, inputs)
    asked = _with_what_is_named(optimisation, good)
    with refusal:
        wanted = wanted_of(case, asked, "optimise")
        goals = {"aim": list(optimisation.aim), "limit": list(optimisation.limit)}
        for table, names in goals.items():
            of_quantities = [name for name in names if name != YIELD]
            refusal.add(*name_problems(case, wanted, ("optimisation", table), of_quantities))
        if any(YIELD in names for names in goals.values()):
            refusal.add(*name_problems(case, wanted, ("variation", "limit"), good))
        refusal.add(*name_problems(case, wanted, ("optimisation", "quantities"), optimisation.quantities))
    refusal.require_none(source.name)
    return inputs, _scatter(optimisation.robust, variation, plain, inputs), wanted_of(case, asked, "optimise")


def _quantities_named(aims: Iterable[str], limits: Iterable[str], good: Iterable[str]) -> list[str]:
    """Return the quantities of aims and limits: of a statistic its own, of a yield those of a good gearbox."""
    named = [*aims, *limits]
    of_yield = good if YIELD in named else ()
    return [statistic_of(name)[1] for name in (*(name for name in named if name != YIELD), *of_yield)]


def _with_what_is_named(optimisation: Optimisation, good: Mapping[str, Limit]) -> Optimisation:
    """Return an optimisation with the analyses of the quantities that it names, and with these beside its own.

    Names that no analysis has are refused later.
    """
    named = _quantities_named(optimisation.aim, optimisation.limit, good)
    found = {analysis_of(name) for name in (*named, *optimisation.quantities)} - {None}
    changes: dict[str, Any] = {}
    if optimisation.quantities:
        kept = (*optimisation.quantities, *map(plain_pattern, named), "sensor.*.loudest_speed_rpm")
        changes["quantities"] = tuple(dict.fromkeys(kept))
    if optimisation.analyses is None and found:
        changes["analyses"] = tuple(name for name in ANALYSES if name in found)
    return optimisation.model_copy(update=changes)


def designed_inputs(laws: Mapping[str, Uniform | Discrete], levels: int) -> tuple[DesignInput, ...]:
    """Return the inputs of a design by ranges and lists of values, in SI.

    Raises
    ------
    CouplingError
    """
    if not laws:
        raise CouplingError("optimise: no laws; expected the range of one value or more")
    for name, law in laws.items():
        if not isinstance(law, Uniform | Discrete):
            raise CouplingError(f"optimise: {name} has {law!r}; expected Uniform(low, high) or Discrete(values)")
    if levels < 2:
        raise CouplingError(f"optimise: {levels} levels; expected 2 or more")
    return tuple(DesignInput(name, law, "", (), ((name, 1.0),), levels=levels) for name, law in laws.items())


def _senses(aims: Mapping[str, str | Aim]) -> dict[str, Aim]:
    senses = dict[str, Aim]()
    for name, sense in aims.items():
        if isinstance(sense, Aim):
            senses[name] = sense
        elif sense in ("least", "most"):
            senses[name] = Aim.model_validate({"sense": sense})
        else:
            raise CouplingError(f'optimise: the aim {name} is {sense!r}; expected "least" or "most"')
    weighted = sum(aim.weight is not None for aim in senses.values())
    if weighted not in (0, len(senses)):
        raise CouplingError("optimise: some aims have a weight; expected one on all of them, or on none")
    return senses


def _verified(proposed: _Proposed, optimised: Optimised, speed: float, scatter: int, progress: Progress) -> Optimised:
    """Return an optimisation with the transient of its start and of the proposed designs, where there are such.

    Parameters
    ----------
    proposed : _Proposed
    optimised : Optimised
    speed : float
        Signed speed of the start [rad/s].
    scatter : int
        Number of the scatter's coordinates.
    progress : callable
    """
    proposals = [optimised.designs[number] for number in optimised.chosen]
    if not proposals:
        return optimised
    loudest = [
        value / RPM
        for design in (optimised.start, *proposals)
        for name, (value, _) in design.sides.items()
        if name.endswith("loudest_speed_rpm")
    ]
    given = proposed.wanted.speeds
    speeds = checked_speeds(given or (speed,), loudest)

    def motion(point: FloatArray | None) -> Motion | Failure:
        def solved() -> Motion:
            machine, plan, needs_load = proposed.moving(point)
            return motion_of(machine, plan, speeds, given, needs_load=needs_load)

        return _motion_or_failure(solved)

    progress(f"the transient of the start at {len(speeds)} speeds")
    start = motion(None)
    found = list[Motion | Failure]()
    for design, label in zip(proposals, optimised.chosen.values(), strict=True):
        progress(f"the transient of the design {label!r} at {len(speeds)} speeds")
        found.append(motion(_as_designed(design, scatter)))
    return replace(optimised, verification=Verification(speeds, start, tuple(found), _given_levels(optimised)))


def _given_levels(optimised: Optimised) -> dict[str, tuple[float, ...]]:
    """Return the levels of sensors of the start and of the proposed designs, where all of them were found."""
    designs = [optimised.start, *(optimised.designs[number] for number in optimised.chosen)]
    names = [name for name in designs[0].sides if name.startswith("sensor.") and name.endswith(".level_db")]
    return {
        name.removeprefix("sensor.").removesuffix(".level_db"): tuple(one.sides[name][0] for one in designs)
        for name in names
        if all(name in one.sides and one.sides[name][0] == one.sides[name][1] for one in designs)
    }


def _as_designed(design: Design, scatter: int) -> FloatArray:
    """Return the point of a design without scatter, by the number of the scatter's coordinates."""
    return np.concatenate([design.point, np.full(scatter, AS_WRITTEN)])


def _motion_or_failure(solved: Callable[[], Motion]) -> Motion | Failure:
    try:
        return solved()
    except Exception as error:
        message = explain(error)[1]
        if message is None:
            raise
        return Failure(message)


def _result(
    origin: Origin,
    optimised: Optimised,
    begin: float,
    files: Callable[..., Mapping[str, Any]] = no_files,
    warnings: Sequence[ResultWarning] = (),
) -> Result[Optimised]:
    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures.optimisation import draw_optimisation

        return draw_optimisation(origin.title, optimised)

    document = optimised_document(optimised)
    return origin.study_result("optimise", optimised, document, OPTIMISED, figures, begin, files, warnings)
