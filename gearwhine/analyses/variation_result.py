"""Result of a variation, of a case or of machines of Python: gearboxes, solved in parallel, with their statistics."""

from __future__ import annotations

import fnmatch
import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from gearwhine.analyses.origin import Origin
from gearwhine.analyses.result import Result, no_files
from gearwhine.case import Case, CaseError, CaseSource, Problem, dump_case, require
from gearwhine.case.analysis_speeds import with_sense_of
from gearwhine.case.errors import UNSAID, Location, Refusal, key_of
from gearwhine.case.model import lacking
from gearwhine.case.operation import Operation
from gearwhine.case.optimisation import Optimisation
from gearwhine.case.variation import Limit, Variation
from gearwhine.coupling import CouplingError, Machine
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.distributions import Discrete, Distribution, correlated, correlation_findings
from gearwhine.numerics.findings import Number, Rule, attribute_findings, refuse
from gearwhine.numerics.names import one_of
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning
from gearwhine.numerics.sampling import IndexPoints, WidenedPoints, index_points, sobol_points, widened_points
from gearwhine.output import staging
from gearwhine.output.files import MODE_CACHE_FILE
from gearwhine.output.quantity import RPM
from gearwhine.results.variation import VARIED, runout_twice_warnings, varied_document
from gearwhine.settings import Settings
from gearwhine.solve.acoustics import acoustics_of
from gearwhine.solve.housing_modes import solve_housing, write_mode_cache
from gearwhine.solve.machine import reduce_housing
from gearwhine.solve.radiated_power import Radiations, radiated_power_of
from gearwhine.study_folder import StudyFolder
from gearwhine.variation.inputs import Input, Pitches, Wider, correlation_matrix, inputs_of, refusals, values_at
from gearwhine.variation.machines import Made, Maker, VariedMachine, made
from gearwhine.variation.named_quantities import QUANTITIES, analysis_of, matches, possible_quantities, statistic_of
from gearwhine.variation.quantities import ANALYSES, Evaluation, Wanted, usual_analyses
from gearwhine.variation.run import run_samples
from gearwhine.variation.samples import Varied, VariedCase
from gearwhine.variation.statistics import VariedResult, WorstGearbox, known_limits

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearwhine.housing import HousingModes

MOST_GEARBOXES = 10_000_000
"""Most gearboxes of a study."""
_MOST_CHECKED = 100  # values of a list that are checked before any gearbox is solved
MOST_WIDENED = 10.0
"""Largest factor by which a distribution is made wider."""


def solve_variation(
    case: Case,
    source: CaseSource,
    folder: StudyFolder,
    *,
    samples: int | None = None,
    indices: bool = False,
    widen: float | None = None,
    seed: int | None = None,
) -> Result[VariedResult]:
    """Solve the gearboxes of a varied case, in parallel.

    Parameters
    ----------
    case : Case
        Case with its variation.
    source : CaseSource
        Content that the case is made of, from which the samples are made, too.
    folder : StudyFolder
    samples, indices, widen, seed
        As of :meth:`gearwhine.case_study.CaseStudy.vary`.

    Raises
    ------
    CaseError
        Where a key cannot be varied, or a distribution or a limit cannot be.
    gearwhine.failures.WorkersError
        Where the processes do not start.
    """
    start = time.perf_counter()
    variation = case.variation
    if variation is None:
        raise lacking(case, "variation", command="vary")
    inputs, wanted = plan_variation(case, source)
    drawn = Drawn(
        variation.samples if samples is None else samples,
        variation.seed if seed is None else seed,
        indices,
        widen,
        correlation_matrix(inputs, variation),
    )
    design = _design(inputs, drawn)
    plain = VariedCase(source.without("variation"), inputs, wanted, wider=design.wider)
    varied, housing = in_solved_housing(plain, folder, "vary")
    speed = None if case.operation is None else case.operation.speed
    result = _solved(varied, design, variation.limit, speed, folder)
    origin = Origin(case.title, case=case, housing=housing)

    def worst_cases(place: Path, *, pictures: bool) -> Mapping[str, Any]:
        """Write the worst gearboxes as cases."""
        for worst in result.worst_gearboxes:
            sample = varied.case(result.points[worst.number])
            told = _told(worst, sample.title, sample.notes, sample.operation if wanted.speeds else None)
            assert worst.file is not None
            (place / worst.file).write_text(dump_case(sample.model_copy(update=told)), encoding="utf-8")
        return {}

    warnings = [*varied.start_warnings, *runout_twice_warnings(inputs, case.gear)]
    return _result(origin, result, start, worst_cases, warnings)


@dataclass(frozen=True)
class Drawn:
    """How many gearboxes are drawn, and how; see :meth:`gearwhine.case_study.CaseStudy.vary`.

    Attributes
    ----------
    samples, seed : int
    indices : bool
    widen : float, optional
    correlation : ndarray, shape (d, d), optional
        Correlation of the inputs' normal scores; None where they are independent.
    """

    samples: int
    seed: int = 1
    indices: bool = False
    widen: float | None = None
    correlation: FloatArray | None = None

    def __post_init__(self) -> None:
        """Refuse numbers that cannot be."""
        rules: dict[str, Rule] = {
            "samples": Number(at_least=1, whole=True),
            "seed": Number(at_least=0, whole=True),
            "widen": Number(above=1.0, at_most=MOST_WIDENED, optional=True),
        }
        refuse(attribute_findings(("vary", ""), self, **rules), CouplingError)


@dataclass(frozen=True, eq=False)
class _Design:
    """Points of the samples of some inputs.

    Attributes
    ----------
    drawn : Drawn
    wider : sequence of (Input or None)
        See :func:`gearwhine.variation.inputs.inputs_at`.
    points : ndarray, shape (n, d)
    plan : IndexPoints, WidenedPoints or None
        Where indices are wanted, or what wider inputs cost.
    """

    drawn: Drawn
    wider: Wider
    points: FloatArray
    plan: IndexPoints | WidenedPoints | None = None


def _design(inputs: tuple[Input, ...], drawn: Drawn) -> _Design:
    """Return the points of the samples.

    Raises
    ------
    CaseError
        Where indices are wanted beside wider or correlated inputs, no input can be wider, or the gearboxes are too
        many.
    """
    wider = _wider(inputs, drawn.widen)
    if drawn.indices and wider:
        raise CaseError([Problem("widen", UNSAID, "one of indices and widen; each is a study of its own")])
    widened = [number for number, one in enumerate(wider) if one is not None]
    total = drawn.samples * (len(inputs) + 2 if drawn.indices else 1 + len(widened))
    if total > MOST_GEARBOXES:
        raise CaseError([Problem("the number of gearboxes", total, f"at most {MOST_GEARBOXES}")])
    if drawn.indices:
        if drawn.correlation is not None:
            expected = "no correlations beside --indices: the variance splits into parts of independent inputs alone"
            raise CaseError([Problem("variation.correlation", UNSAID, expected)])
        plan = index_points(drawn.samples, tuple((number,) for number in range(len(inputs))), drawn.seed)
        return _Design(drawn, wider, plan.points, plan)
    points = drawn_points(len(inputs), drawn.samples, drawn.seed, drawn.correlation)
    if not widened:
        return _Design(drawn, wider, points)
    of_wider = widened_points(points, widened)
    return _Design(drawn, wider, of_wider.points, of_wider)


def _solved(
    varied: Varied, design: _Design, limit: Mapping[str, Limit], speed: float | None, folder: StudyFolder
) -> VariedResult:
    """Solve the gearboxes of a design, of a case or of Python.

    Parameters
    ----------
    varied : Varied
    design : _Design
    limit : mapping of str to Limit
        By the name of a quantity, which may have ``*``.
    speed : float or None
        Signed speed of curves without other speeds [rad/s].
    folder : StudyFolder

    Raises
    ------
    CaseError
        Where a quantity or a limit is of none that the gearbox without changes has.
    gearwhine.failures.WorkersError
        Where the processes do not start.
    Exception
        What the gearbox without changes cannot be solved for.
    """
    refusal, wanted, points, plan = Refusal(), varied.wanted, design.points, design.plan
    folder.progress("the gearbox without changes")
    nominal = varied.evaluation(None)
    with refusal:
        _require_quantities(wanted, nominal)
    with refusal:
        limits = known_limits(limit, list(nominal.numbers))
    refusal.require_none()
    if plan is not None:
        aim = "Sobol' indices" if design.drawn.indices else "what wider ones cost"
        folder.progress(f"{plan.rows} rows of {len(plan.inputs)} inputs for {aim}: {len(points)} gearboxes")
    if "gears" in wanted.analyses and not wanted.names and any(isinstance(one.law, Pitches) for one in varied.inputs):
        folder.progress(
            "pitch deviations make all mesh periods of a gearbox differ: its transmission error over all of them may "
            'take most of the time; [variation] quantities = ["*.transmission_error_peak_to_peak_m", …] leaves it out\n'
        )
    solved = run_samples(varied, points, folder)
    return VariedResult(
        inputs=varied.inputs,
        points=points,
        values=values_at(varied.inputs, points, varied.wider),
        nominal=nominal,
        outcomes=solved.outcomes,
        limits=limits,
        speeds=np.array(wanted.speeds or ([] if speed is None else [speed])),
        design=plan,
        resumed=solved.resumed,
        widening=design.drawn.widen,
    )


def plan_variation(case: Case, source: CaseSource) -> tuple[tuple[Input, ...], Wanted]:
    """Check the variation of a case, and return its inputs and what is found of each gearbox.

    Raises
    ------
    CaseError
        With every key that cannot be varied, and every distribution, limit and quantity that cannot be.
    """
    variation, refusal = case.variation or Variation(), Refusal()
    if not variation.vary:
        expected = "a distribution of one key or more"
        raise CaseError([Problem("variation.vary", UNSAID, expected, source=source.name)])
    inputs = inputs_of(source, variation.vary, ("variation", "vary"), refusal)
    tied = np.zeros(len(inputs), dtype=bool)
    with refusal:
        matrix = correlation_matrix(inputs, variation)
        if matrix is not None:
            tied = (matrix != np.eye(len(inputs))).any(axis=0)
    refusal.add(*_value_problems(source.without("variation"), inputs, tied.tolist()))
    with refusal:
        wanted = wanted_of(case, variation)
        refusal.add(*name_problems(case, wanted, ("variation", "quantities"), variation.quantities))
        refusal.add(*name_problems(case, wanted, ("variation", "limit"), variation.limit))
    refusal.require_none(source.name)
    return inputs, wanted_of(case, variation)


def _told(worst: WorstGearbox, title: str, notes: str, operation: Operation | None) -> dict[str, Any]:
    """Return title, notes and operation of a worst gearbox's case, with the speed of the value in its title.

    Without an operation to change, the value is one at the speed of the case.
    """
    number = f"gearbox {worst.number}, {worst.name} = {worst.value:.6g}"
    if worst.speed is None or operation is None:
        return {"title": f"{title}: {number}".strip(": ")}
    rpm = f"{RPM * abs(worst.speed):.5g} rpm"
    note = (
        f"The speed of operation is {rpm}, at which {worst.name} is the highest over the speeds of the study; that "
        f"has the operating point at {RPM * abs(operation.speed):.5g} rpm."
    )
    return {
        "title": f"{title}: {number} at {rpm}".strip(": "),
        "notes": f"{notes}\n{note}".strip(),
        "operation": operation.model_copy(update={"speed": worst.speed}),
    }


def vary(
    make: Callable[[Mapping[str, float]], Machine],
    laws: Mapping[str, Distribution],
    samples: int = 256,
    *,
    analyses: Sequence[str] | None = None,
    quantities: Sequence[str] = (),
    speeds: Sequence[float] = (),
    plan: TransientPlan | None = None,
    limits: Mapping[str, tuple[float | None, float | None]] | None = None,
    correlations: Mapping[tuple[str, str], float] | None = None,
    acoustics: Acoustics | None = None,
    indices: bool = False,
    widen: float | None = None,
    seed: int = 1,
    title: str = "",
    progress: Progress = silent,
    folder: str | os.PathLike[str] | None = None,
    workers: int | None = 1,
    scheduler: str | None = None,
    fresh: bool = False,
) -> Result[VariedResult]:
    """Solve many machines that a function makes of drawn values, and find their scatter, its causes, and the yield.

    Parameters
    ----------
    make : callable
        Makes a machine of the values by name, or returns quantities of your own by name, which are taken as they are.
        What it cannot make raises `ValueError`, and the sample fails by itself.
    laws : mapping of str to Distribution
        Distribution of each value, of :mod:`gearwhine.numerics.distributions`.
    samples : int
        Number of machines; with ``indices`` times the number of values and two more.
    analyses : sequence of str, optional
        What is found of each: "gears", "load", "rotors", "mass", "modes", "lines", "sound", "motion". By default
        gears, load and lines, as far as the machine has them.
    quantities : sequence of str
        Names of the quantities that are found, ``*`` for any part of a name; by default all of the analyses.
    speeds : sequence of float
        Signed speeds of "lines" and "sound" [rad/s]; by default that of each machine.
    plan : TransientPlan, optional
        Stretch of the motion.
    limits : mapping of str to tuple, optional
        Least and largest value of good machines by quantity, None where there is none:
        ``{"bearing.left.life_h": (5000.0, None)}``.
    correlations : mapping of (str, str) to float, optional
        Correlations of the normal scores of two values each, by their names; none by default.
    acoustics : Acoustics, optional
        Settings of "sound", by default boundary elements in free air; each housing is solved once.
    indices : bool
        Find Sobol' indices.
    widen : float, optional
        Factor by which each distribution in turn is made wider, to see what it costs.
    seed : int
    title : str
    progress : callable
    folder : path, optional
        Folder of the samples; those that it holds of the same function and machine are not solved again.
    workers : int, optional
        Number of processes; None for as many as cores where that is worth their start. They need what `make` holds on
        to as a copy, by pickle.
    scheduler : str, optional
        Address of a running Dask scheduler, whose workers are used instead.
    fresh : bool
        Solve again what the folder holds.

    Raises
    ------
    CouplingError
        Where an analysis is none of these, nothing is varied, or a number cannot be.
    CaseError
        Where a limit is of a quantity that the machines do not have.
    gearwhine.failures.WorkersError
        Where the processes do not start.
    Exception
        What `make` or an analysis raises of the machine of all medians.

    Examples
    --------
    >>> import gearwhine as gw
    >>> from gearwhine.numerics.distributions import Normal
    >>> def shaft(values):
    ...     rotor = gw.Rotor("shaft", [gw.Segment(0.5, values["diameter"], 0.0, gw.STEEL)])
    ...     held = [gw.Bearing.isotropic(f"at {at}", at, 1e8) for at in (0.02, 0.48)]
    ...     return gw.Machine([gw.Shaft(rotor)], [gw.MountedBearing(one, "shaft", None) for one in held], speed=100.0)
    >>> varied = gw.vary(shaft, {"diameter": Normal(0.03, 1e-4)}, 16, analyses=["rotors"])
    >>> [one.name for one in varied.solved.quantities][:1]
    ['rotor.shaft.critical_speed_1_rpm']
    """
    drawn = Drawn(samples, seed, indices, widen, correlation_of_laws(laws, correlations))
    inputs = inputs_of_laws("vary", laws)
    machine = made(make, {one.name: one.value(0.5) for one in inputs})
    settings = Settings(title, transient=plan, speeds=speeds, acoustics=acoustics)
    with study_folder(progress, folder, workers, scheduler, fresh=fresh) as place:
        return vary_machine(
            make, machine, inputs, drawn, settings, place,
            analyses=analyses, quantities=quantities, limits=limits,
        )  # fmt: skip


def vary_machine(
    make: Maker,
    machine: Made,
    inputs: tuple[Input, ...],
    drawn: Drawn,
    settings: Settings,
    folder: StudyFolder,
    *,
    origin: Origin | None = None,
    analyses: Sequence[str] | None = None,
    quantities: Sequence[str] = (),
    limits: Mapping[str, tuple[float | None, float | None]] | None = None,
) -> Result[VariedResult]:
    """Solve the machines that a function makes of the values of inputs, about a machine; see :func:`vary`."""
    start = time.perf_counter()
    wanted = wanted_of_machine("vary", machine, settings, analyses, quantities)
    limit = limits_of("vary", limits)
    design = _design(inputs, drawn)
    radiations = Radiations(settings.acoustics, folder.progress)
    varied = VariedMachine(make, inputs, wanted, radiations, machine, design.wider)
    speed = machine.speed if isinstance(machine, Machine) else None
    result = _solved(varied, design, limit, speed, folder)
    return _result(origin or Origin(settings.title), result, start, warnings=varied.start_warnings)


def inputs_of_laws(command: str, laws: Mapping[str, Distribution]) -> tuple[Input, ...]:
    """Return the inputs of distributions by name, in SI.

    Raises
    ------
    CouplingError
    """
    if not laws:
        raise CouplingError(f"{command}: expected a distribution of one value or more")
    for name, law in laws.items():
        if not hasattr(law, "quantile"):
            raise CouplingError(f"{command}: {name!r} is {law!r}; expected a distribution, such as Normal(1.0, 0.1)")
    return tuple(Input(name, law, "", (), ((name, 1.0),)) for name, law in laws.items())


def correlation_of_laws(names: Iterable[str], pairs: Mapping[tuple[str, str], float] | None) -> FloatArray | None:
    """Return the correlation of the normal scores of values by name, shape (d, d); None where they are independent.

    Raises
    ------
    CouplingError
        Where a pair is none of two names, or the coefficients cannot be together.
    """
    if not pairs:
        return None
    places = {name: place for place, name in enumerate(names)}
    matrix = np.eye(len(places))
    for pair, coefficient in pairs.items():
        if len(set(pair)) != 2 or not set(pair) <= set(places):
            raise CouplingError(f"vary: a correlation of {pair!r}; expected two of {', '.join(places)}")
        first, second = (places[name] for name in pair)
        matrix[first, second] = matrix[second, first] = coefficient
    refuse(correlation_findings(matrix), CouplingError)
    return matrix


def wanted_of_machine(
    command: str,
    machine: Made,
    settings: Settings,
    analyses: Sequence[str] | None,
    quantities: Sequence[str] = (),
) -> Wanted:
    """Return what is found of each machine: as asked for, else what the quantities need, else what the machine allows.

    Raises
    ------
    CouplingError
        Where there is no such analysis, or the machine lacks what it needs.
    """
    quantities = (quantities,) if isinstance(quantities, str) else quantities
    asked = _asked((analyses,) if isinstance(analyses, str) else analyses, quantities)
    if asked is None and isinstance(machine, Machine):
        housing = machine.housing_component
        listens = housing is not None and bool(housing.sensors)
        asked = usual_analyses(has_pairs=bool(machine.gear_pairs), is_loaded=machine.is_loaded, listens=listens)
    asked = asked or ()
    if unknown := [name for name in asked if name not in ANALYSES]:
        raise CouplingError(f"{command}: analyses of {unknown[0]!r}; expected some of {', '.join(ANALYSES)}")
    lacks = dict[str, bool]()
    if isinstance(machine, Machine):
        lacks = {"gear_pair": not machine.gear_pairs, "bearing": not machine.bearings}
    for name in asked:
        if missing := next((table for table in ANALYSES[name].needs if lacks.get(table)), None):
            raise CouplingError(f"{command}: the machine has no quantity of {name}; expected a {missing} in it")
    over_speed = {"lines", "sound"} & set(asked)
    speeds = tuple(settings.speeds) if over_speed else ()
    return Wanted(asked, speeds, settings.transient if "motion" in asked else None, names=tuple(quantities))


@contextmanager
def study_folder(
    progress: Progress,
    folder: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    *,
    fresh: bool = False,
) -> Iterator[StudyFolder]:
    """Yield the folder of a study of Python; without one, one that ends with the block."""
    with TemporaryDirectory() if folder is None else nullcontext(folder) as place:
        yield StudyFolder(Path(place), workers, scheduler, fresh, progress)


def _wider(inputs: tuple[Input, ...], factor: float | None) -> Wider:
    """Return the inputs with distributions wider by a factor, see :func:`gearwhine.variation.inputs.inputs_at`."""
    if factor is None:
        return ()
    wider = [one.widened(factor) for one in inputs]
    if not any(wider):
        raise CaseError([Problem("widen", factor, "an input with a tolerance; there are only values without one")])
    return wider


def sampled_points(inputs: Sequence[Input], variation: Variation, samples: int, seed: int) -> FloatArray:
    """Return points of the unit cube for inputs with the correlations of a variation, shape (n, d)."""
    return drawn_points(len(inputs), samples, seed, correlation_matrix(inputs, variation))


def drawn_points(inputs: int, samples: int, seed: int, correlation: FloatArray | None = None) -> FloatArray:
    """Return points of the unit cube for a number of inputs, shape (n, d)."""
    points = sobol_points(samples, inputs, seed)
    return points if correlation is None else correlated(points, correlation)


AnyVaried = TypeVar("AnyVaried", bound=VariedCase)


def in_solved_housing(varied: AnyVaried, folder: StudyFolder, command: str) -> tuple[AnyVaried, HousingModes | None]:
    """Return a varied case with the solved housing of the case without changes, and that; None without one."""
    case = varied.source.changed_case()
    if case.housing is None or not case.rotor:
        return varied, None
    housing = solve_housing(case, folder.progress, command=command, folder=folder.path, fresh=folder.fresh)
    housing, radiated = _kept_housing(housing, folder), None
    if varied.wanted.has_sound:
        radiated, housing = radiated_power_of(acoustics_of(case), housing, folder.progress)
        housing = _kept_housing(housing, folder)
    reduced, key = reduce_housing(case, housing, with_coarser=False), varied.key_of_housing(case)
    return replace(varied, solved=housing, housing=reduced, housing_key=key, radiated=radiated), housing


def _kept_housing(housing: HousingModes, folder: StudyFolder) -> HousingModes:
    """Keep modes, which took minutes, in the folder before the samples, so that an interruption leaves them."""
    if housing.source_holds:
        return housing
    with staging(folder.path) as place:
        write_mode_cache(place, housing)
    return replace(housing, source=folder.path / MODE_CACHE_FILE, source_holds=True)


def limits_of(command: str, limits: Mapping[str, tuple[float | None, float | None]] | None) -> dict[str, Limit]:
    """Return limits of quantities that are given by their least and largest values.

    Raises
    ------
    CouplingError
    """
    found = dict[str, Limit]()
    for name, ends in (limits or {}).items():
        try:
            least, most = ends
            found[name] = Limit(at_least=least, at_most=most)
        except (TypeError, ValueError) as error:
            expected = "a least value and a largest one that is no less, of which one may be None"
            raise CouplingError(f"{command}: the limit of {name!r} is {ends!r}; expected {expected}") from error
    return found


def wanted_of(case: Case, variation: Variation | Optimisation, command: str = "vary") -> Wanted:
    """Return what is found of each gearbox: as asked for, else what the case allows."""
    analyses: tuple[str, ...]
    names = variation.quantities
    listens = any(one is not None and one.sensor for one in (case.housing, case.reduced_housing))
    asked = _asked(variation.analyses, names)
    if asked is not None:
        for name in asked:
            require(case, *ANALYSES[name].needs, command=f"{command}, analyses = ['{name}']")
        if "lines" in asked and not listens:
            table = "variation" if isinstance(variation, Variation) else "optimisation"
            expected = "a housing with a sensor beside 'lines', which finds levels at sensors; the case has none"
            raise CaseError([Problem(f"{table}.analyses", UNSAID, expected)])
        analyses = asked
    else:
        loaded = case.parts.is_loaded
        analyses = usual_analyses(has_pairs=bool(case.gear_pair), is_loaded=loaded, listens=listens)
        if analyses == ("rotors",) and not case.rotor:
            expected = "a gear pair or a shaft: nothing else is found of a varied case"
            raise CaseError([Problem("variation.analyses", UNSAID, expected)])
    speeds = variation.speeds or (() if case.sweep is None else case.sweep.speeds)
    over_speed = {"lines", "sound"} & set(analyses)
    return Wanted(analyses, with_sense_of(case.operation, speeds) if over_speed else (), names=names)


def _asked(analyses: Sequence[str] | None, quantities: Sequence[str]) -> tuple[str, ...] | None:
    """Return the analyses that are asked for, else those of the quantities; None where nothing tells."""
    needed = [analysis_of(name) for name in quantities]
    if analyses is None and quantities and None not in needed:
        return tuple(name for name in ANALYSES if name in needed)
    return None if analyses is None else tuple(analyses)


def name_problems(case: Case, wanted: Wanted, table: Location, named: Iterable[str]) -> Iterator[Problem]:
    """Yield names in a table of a case that are of no quantity of its gearboxes, before anything is solved for them.

    A name may have a statistic before it, and ``*`` in it.
    """
    names = dict(possible_quantities(parts_of(case)))
    for name in named:
        statistic, quantity = statistic_of(name)
        found = [one for one in names if matches(one, quantity)]
        expected = ""
        if not found and not statistic and " of " in name:
            expected = "'mean of', 'standard deviation of' or 'quantile 0.95 of', and the name of a quantity"
        elif not found:
            expected = _nearest_quantity(quantity, list(names))
        elif not any(names[one] in wanted.analyses for one in found):
            expected = f"{names[found[0]]!r} among the analyses, which finds it"
        elif not any(wanted.has(one) for one in found):
            expected = f"{found[0]!r} among the quantities, beside those that are found"
        if expected:
            yield Problem(key_of((*table, name)), UNSAID, expected)


def _nearest_quantity(name: str, names: Sequence[str]) -> str:
    """Return what a name that no quantity has may have meant: a quantity of its part, or a part of its kind."""
    part, _, last = name.rpartition(".")
    kind, _, own = part.partition(".")
    of_part = dict.fromkeys(one.rpartition(".")[2] for one in names if matches(one.rpartition(".")[0], part))
    if of_part:
        hint = "; a life is that of a rolling bearing" if last.endswith("life_h") else ""
        return one_of(f"a quantity of {part}", last, list(of_part)) + hint
    parts = dict.fromkeys(one.rpartition(".")[0].partition(".")[2] for one in names if one.startswith(f"{kind}."))
    if parts:
        return one_of(f"a {kind.replace('_', ' ')} of this case", own, list(parts))
    if any(one.kind == kind for one in QUANTITIES):
        return f"a {kind.replace('_', ' ')} in the case, which has none"
    return one_of("a quantity of this case", name, names)


def parts_of(case: Case) -> dict[str, list[str]]:
    """Return the names of a case's parts by their kind, as names of quantities have them."""
    table = case.housing or case.reduced_housing
    bearings = case.parts.bearings if case.rotor else ()
    return {
        "gear_pair": [f"{pair.driver}-{pair.driven}" for pair in case.gear_pair],
        "bearing": [one.bearing.name for one in bearings],
        "rolling_bearing": [one.bearing.name for one in bearings if one.rolling is not None],
        "planetary": [one.name for one in case.planetary],
        "rotor": [one.name for one in case.rotor],
        "gear": [one.name for one in case.gear],
        "sensor": [one.name for one in table.sensor] if table else [],
        "housing": [""] if table else [],
        "machine": [""],
    }


def _require_quantities(wanted: Wanted, nominal: Evaluation) -> None:
    """Refuse names of quantities that the gearboxes do not have.

    Raises
    ------
    CaseError
    """
    every = [*nominal.numbers, *nominal.curves]
    without = [(place, name) for place, name in enumerate(wanted.names) if not fnmatch.filter(every, name)]
    if without:
        expected = f"a quantity of {', '.join(wanted.analyses)}; docs/how-to/variation.md lists them"
        raise CaseError(Problem(f"variation.quantities[{place}]", name, expected) for place, name in without)


def _value_problems(source: CaseSource, inputs: Sequence[Input], tied: Sequence[bool]) -> Iterator[Problem]:
    """Yield problems of keys that do not take their median, an end of their range, or one of their values.

    A value of a list may fail where others do not, and an input that a correlation ties to others may fit the case with
    these alone: there only the key itself is checked.
    """
    for one, with_others in zip(inputs, tied, strict=True):
        tried = [(texts, *refusals(source, texts)) for texts in map(list, _tried(one))]
        one_holds = isinstance(one.law, Discrete) and any(not own and not others for _, own, others in tried)
        for texts, own, others in tried:
            # A problem of another key does not show the value.
            value = "" if own else f" = {texts[0].partition('=')[2]}"
            if told := own or ([] if with_others or one_holds else others):
                place = f"{source.name}: variation.vary, {one.name}{value}"
                yield from (replace(problem, source=place) for problem in told)
                break


def _tried(one: Input) -> Iterator[Iterator[str]]:
    """Yield the changes by an input's values: all of a list, or its median and the ends of its range."""
    if isinstance(one.law, Discrete):
        yield from map(one.overrides_of, one.law.values[:_MOST_CHECKED])
        return
    yield one.overrides(0.5)
    if not isinstance(one.law, Pitches):
        ends = one.law.quantile(np.array([0.0, 1.0]))
        yield from map(one.overrides_of, ends[np.isfinite(ends)].tolist())


def _result(
    origin: Origin,
    result: VariedResult,
    start: float,
    files: Callable[..., Mapping[str, Any]] = no_files,
    warnings: Sequence[ResultWarning] = (),
) -> Result[VariedResult]:
    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures.variation import draw_variation

        return draw_variation(origin.title, result)

    return origin.study_result("vary", result, varied_document(result), VARIED, figures, start, files, warnings)
