"""Model updating of a case's housing: the search, the cross-validation of the fit, and the updated case.

The targets are measured frequencies, and shapes where a survey holds some. The search is made on a mesh of its own,
coarse enough for many solves, that moves with the box, with that mesh's bias taken off. The box's own mesh decides: it
judges every few solves, and the search ends with a few designs more there, each meshed anew.

Cross-validation leaves modes out in turn, and fits random frequency sets as the null hypothesis. Each is the whole
search again. On the housing's own mesh it would take as long as the update itself, so all are made on the coarser one,
as if that were the housing; the measured set too, with which the random ones are compared. Local processes share these
long tasks with small results.

The updated case is the case file with the fitted numbers, their provenance and their prior.
"""

import tempfile
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import tomli_w
from scipy import sparse

from gearwhine.case import Case, CaseError, Problem, UpdateParameter
from gearwhine.case.checks.whole_case import without_changed
from gearwhine.case.errors import UNSAID, Location, key_of
from gearwhine.case.measured import Measured, Update
from gearwhine.case.model import lacking
from gearwhine.case.units import si_unit
from gearwhine.from_case.mesh import build_mesh
from gearwhine.from_case.parametric_housing import (
    FittedCase,
    FittedNumber,
    HousingAtParameters,
    ParametricHousing,
    fitted_case,
    unit_in_si,
    with_entry,
)
from gearwhine.housing.correlation import dominance_band, real_shapes
from gearwhine.housing.measured import MeasuredGeometry, map_survey
from gearwhine.housing.modal_test import ModalTest
from gearwhine.housing.updating import (
    UNPAIRED,
    Each,
    Effort,
    LeftOutMode,
    Meshes,
    Misfit,
    ModeCount,
    MultistartResult,
    NullFit,
    Parameter,
    Posterior,
    Procedure,
    Step,
    Target,
    leave_one_out,
    measure,
    multistart_search,
    null_fits,
    polish,
    posterior,
    serial_map,
)
from gearwhine.interruption import each_from_thread, in_thread
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.solve.comparison import modal_test_of, refused_by_key
from gearwhine.workers import await_workers, connected, default_workers

_TWO_PI = 2.0 * np.pi

_EXPLAINED_DEVIATIONS = 2.0  # standard deviations of a frequency that its noise explains
_MARGIN = 1.0 / 3.0  # least gap of the two other measures, as a part of that of the measure that decides

Observer = Callable[[Mesh], sparse.csr_array]
"""Returns for a mesh the matrix of the degrees of freedom where shapes were measured, shape (n_dofs, 3 n_nodes)."""


@dataclass(frozen=True)
class Measurement:
    """Measured modes as the fit uses them.

    Attributes
    ----------
    target : Target
    observer : callable, optional
        Observer of the measured shapes; None without shapes.
    left_out : int
        Number of degrees of freedom that are left out, since they were not measured in every mode.
    """

    target: Target
    observer: Observer | None = None
    left_out: int = 0


def measurement_of(
    measured: Measured, table: Update, mesh: Callable[[], Mesh], progress: Progress = silent
) -> Measurement:
    """Measured targets of an update.

    `[measured] pairing` says how modes are paired. Complex shapes are turned on to the real axis.

    Parameters
    ----------
    measured : gearwhine.case.Measured
    table : gearwhine.case.Update
    mesh : callable
        Meshes the housing, on which measured shapes are aligned.
    progress : callable

    Raises
    ------
    CaseError
        Where the survey does not lie on the housing, or shapes share too few degrees of freedom.
    """
    test = modal_test_of(measured, progress)
    modes = test.modes
    mode_count, pairing = table.model_modes, measured.paired_by
    by_dominance = pairing == "dominance"
    target = Target(
        frequencies=modes.frequencies,
        noise=np.full(len(modes.frequencies), table.frequency_noise),
        band=dominance_band(modes.frequencies),
        gap=table.gap if by_dominance else 0.0,
        margin=_MARGIN * table.gap if table.gap and by_dominance else -np.inf,
        count=None if mode_count is None else ModeCount(_TWO_PI * mode_count.below, mode_count.least, mode_count.most),
    )
    if pairing != "shapes":
        return Measurement(replace(target, pairing=pairing))
    if modes.shapes is None or modes.geometry is None:
        raise CaseError([Problem("measured.file", UNSAID, "shapes at points, by which modes are paired")])
    return _with_shapes(test, modes.shapes, modes.geometry, table, mesh, target)


def _with_shapes(
    test: ModalTest,
    shapes: ComplexArray,
    geometry: MeasuredGeometry,
    table: Update,
    mesh: Callable[[], Mesh],
    target: Target,
) -> Measurement:
    shared = np.flatnonzero(~np.isnan(shapes).any(axis=0))
    if len(shared) <= len(shapes):
        expected = (
            f"shapes that share more than {len(shapes)} degrees of freedom, as many as there are modes; "
            f"{len(shared)} were measured in all of them"
        )
        raise CaseError([Problem("measured.file", UNSAID, expected)])
    # Aligned once: an alignment that followed each design would hide its changes of size.
    with refused_by_key():
        alignment = test.mapped(mesh(), geometry).alignment

    def observer(mesh: Mesh) -> sparse.csr_array:
        mapped = map_survey(mesh, geometry, alignment=alignment, tolerance=test.tolerance)
        return sparse.csr_array(mapped.matrix[shared])

    with_shapes = Target(
        frequencies=target.frequencies,
        noise=target.noise,
        band=target.band,
        shapes=real_shapes(shapes[:, shared]),
        shape_noise=table.shape_noise,
        count=target.count,
    )
    return Measurement(with_shapes, observer, shapes.shape[1] - len(shared))


_CLEAR_DOMINANCE_GAP = 0.1  # gap of dominance from which the choice of modes is a clear one


@dataclass(frozen=True)
class NullTest:
    """Random sets fitted, and the measured one in the same way.

    Attributes
    ----------
    measured : NullFit
    fits : list of NullFit
    """

    measured: NullFit
    fits: list[NullFit]

    @property
    def as_good_in_rms(self) -> float:
        """Part of the random sets whose root-mean-square error is no larger than that of the measured one."""
        return self._part(fit.rms_percent <= self.measured.rms_percent for fit in self.fits)

    @property
    def all_met(self) -> float:
        """Part of the random sets for which all that is asked for is met."""
        return self._part(fit.is_met for fit in self.fits)

    @property
    def median_rms_percent(self) -> float:
        """Median of the random sets' root-mean-square errors."""
        return median(fit.rms_percent for fit in self.fits)

    def within(self, percent: float, *, clear: bool = False) -> float:
        """Part of the random sets fitted within an error, if asked for with a clear choice of modes."""
        return self._part(
            fit.max_percent <= percent
            and (not clear or (fit.gap is not None and fit.gap >= _CLEAR_DOMINANCE_GAP and bool(fit.measures_agree)))
            for fit in self.fits
        )

    def _part(self, met: Iterable[bool]) -> float:
        return sum(met) / len(self.fits)


def full_update_search(start: HousingAtParameters, effort: Effort, count: int) -> Procedure[HousingAtParameters]:
    """Return the update's search as made on the mesh of one design alone, by one thread, from that design.

    Parameters
    ----------
    start : HousingAtParameters
    effort : Effort
        Effort of the update.
    count : int
        Number of starts of the multistart search, this one included.
    """
    designs = replace(start.designs, threads=1, draft=True)
    return Procedure(designs.solve, designs.parameters, start.light(), effort, count)


@contextmanager
def in_parallel(workers: int) -> Iterator[Each]:
    """Pool of single-thread processes, which end with the block; one worker is this process.

    Raises
    ------
    WorkersError
        Where the processes do not start.
    """
    if workers < 2:
        yield serial_map
        return
    with tempfile.TemporaryDirectory(prefix="gearwhine-") as place, connected(workers, None, Path(place)) as client:
        await_workers(client, workers)

        def each(work: Callable[[Any], Any], tasks: Sequence[Any]) -> Iterator[Any]:
            with warnings.catch_warnings():
                # Dask would rather have large tasks scattered first; ours are few and long.
                warnings.filterwarnings("ignore", message="Sending large graph")
                futures = in_thread(lambda: [client.submit(work, task, pure=False) for task in tasks])
            return each_from_thread(future.result() for future in futures)

        yield each


_AT_END = 1e-3  # part of a range that counts as its end
_PARTS = 4  # parameters named of each combination


@dataclass(frozen=True)
class FoundNumber:
    """Parameter of an update and its fitted value.

    Attributes
    ----------
    number : FittedNumber
    value, deviation : float
        Value and its standard deviation [SI].
    left : float
        Standard deviation as a part of that of the prior.
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
        """Unit of the parameter in the case [SI]."""
        return unit_in_si(self.number.given)

    @property
    def unit(self) -> str:
        """SI unit of the value, ``"1"`` of a factor; plain numbers in the case's range have that of their keys."""
        given = self.number.given
        return si_unit(given.unit) if given.unit or given.factor else "SI"

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
        Measured circular frequency [rad/s].
    before_error, error : float
        Errors ln(model / measured); NaN without a partner.
    mode : int or None
        Number of its partner in the housing after the update, from 1, rigid modes counted.
    before_mac, mac : float or None
        MAC with the partner; None without shapes.
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


def noise_warnings(misfit: Misfit, noise: FloatArray) -> list[dict[str, Any]]:
    """Warn of a fit that leaves frequencies further off than their noise explains.

    The posterior covariance takes the residuals for noise of the stated size. Where they are larger, the standard
    deviations of the fitted numbers are too small.

    Parameters
    ----------
    misfit : Misfit
        Of the fitted housing.
    noise : ndarray, shape (n,)
        Relative standard deviation of each measured frequency; infinite where it takes no part.
    """
    counted_in = (misfit.pairs != UNPAIRED) & np.isfinite(noise)
    errors = np.abs(misfit.errors[counted_in])
    beyond = errors > _EXPLAINED_DEVIATIONS * noise[counted_in]
    if not beyond.any():
        return []
    worst = int(np.argmax(errors / noise[counted_in]))
    message = (
        f"the fit leaves {int(beyond.sum())} of {len(errors)} frequencies further off than twice their noise, the "
        f"worst by {100.0 * errors[worst]:.2f} % where frequency_noise is {100.0 * noise[counted_in][worst]:.2g} %: "
        "the give or take of the fitted numbers counts the noise alone and is too small; the model lacks something, or "
        "the noise is larger"
    )
    return [warning("fit beyond noise", message, frequencies=int(beyond.sum()))]


@dataclass(frozen=True)
class SolvedUpdate:
    """A housing updated.

    Attributes
    ----------
    fitted : FittedCase
    before, after : HousingAtParameters
        Designs on the box's own mesh.
    misfit_before, misfit_after : Misfit
        Misfits of these designs.
    start : HousingAtParameters
        Design at which the search begins, on its coarser mesh.
    target : Target
    left_out : int
        Number of measured degrees of freedom that are left out.
    posterior : Posterior
    steps : tuple of Step
        Every true solve of the search.
    held_back : list of LeftOutMode
        Predictions of modes that are held back; empty where not asked for.
    null : NullTest or None
        Fits of random sets; None where not asked for.
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
        deviations = self.posterior.frequency_deviations()
        # Nothing drives a housing without seats.
        state = self.after.state
        strengths = state.dominance.acceleration if state.seats.shape[1] else None
        return tuple(
            UpdatedPair(
                measured=float(measured),
                before_error=float(before.errors[place]),
                error=float(after.errors[place]),
                mode=None if mode == UNPAIRED else self.after.state.number(int(mode)),
                before_mac=None if before.mac is None else float(before.mac[place]),
                mac=None if after.mac is None else float(after.mac[place]),
                strength=None if mode == UNPAIRED or strengths is None else float(strengths[mode]),
                uncertainty=None if mode == UNPAIRED else float(deviations[mode]),
            )
            for place, (measured, mode) in enumerate(zip(self.target.frequencies, after.pairs, strict=True))
        )

    @property
    def combinations(self) -> list[tuple[float, dict[str, float]]]:
        """Combinations of parameters: the information of the data on each, and its leading parts by name."""
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
    gearwhine.housing.HousingError
        Where the model cannot be solved as it stands.
    """
    table, housing, given = case.update, case.housing, case.measured
    if table is None or housing is None or given is None:
        raise lacking(case, "housing", "measured", "update", command="update")
    if housing.accuracy is not None:
        expected = "a mesh_size in its place: designs are compared on elements of one size (`gearwhine modes` finds it)"
        raise CaseError([Problem("housing.accuracy", f"{100 * housing.accuracy:g} %", expected)])
    mesh = partial(build_mesh, housing, case.material, case.input_files)
    measured = measurement_of(given, table, mesh, progress)
    target = measured.target
    if null and target.shapes is not None:
        expected = "0 where shapes were measured: random frequencies have none"
        raise CaseError([Problem("--null", null, expected)])
    begin = time.perf_counter()
    fine = ParametricHousing(fitted_case(case), table.modes, measured.observer, threads=threads, as_written=True)
    coarse = replace(fine, case=fitted_case(case, table.mesh_size))
    effort, count = Effort(solves=table.solves, seed=table.seed), 1 + table.explore
    before, start, raced = _raced(fine, coarse, target, effort, count, threads, progress)
    seconds = {"search": time.perf_counter() - begin}
    begin = time.perf_counter()
    progress("going on with the housing's own mesh")
    polished = polish(replace(fine, draft=True).solve, raced, target, fine.parameters, effort, progress)
    # The search does not count modes; the reported ones are certified.
    after = replace(fine.solve(polished.design.coordinates), known=polished.design.surrogate())
    seconds["own_mesh"] = time.perf_counter() - begin
    rows: list[LeftOutMode] = []
    null_test: NullTest | None = None
    with _sharing(threads, len(target.noise) * held_back + null) as each:
        procedure = full_update_search(start, effort, count)
        if held_back:
            begin = time.perf_counter()
            progress(f"holding back {len(target.noise)} modes, one at a time")
            rows = leave_one_out(procedure, target, each, progress)
            seconds["held_back"] = time.perf_counter() - begin
        if null:
            begin = time.perf_counter()
            progress(f"fitting the measured and {null} random sets of {len(target.noise)} frequencies")
            null_test = NullTest(*null_fits(procedure, target, null, each=each, progress=progress))
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
        posterior=posterior(target, polished.misfit, after.coordinates, after.surrogate().at(after.coordinates)),
        steps=raced.steps + polished.steps,
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
    """Solve the housing as it stands on both meshes, and search from there and from other starts.

    Several starts use one thread each, from the first solution on: other numbers of threads round sums differently, and
    a search that depends on last digits ends elsewhere.
    """
    progress("solving the housing as it stands")
    each_has = threads if count == 1 else 1
    fine, coarse = replace(fine, threads=each_has), replace(coarse, threads=each_has)
    same = coarse.housing_at(coarse.start) == fine.housing_at(fine.start)
    with _sharing(threads, count) as each:
        tasks = [(fine, True)] if same else [(fine, False), (coarse, True)]
        solved: list[HousingAtParameters] = list(each(_as_it_stands, tasks))
        before, start = solved[0], solved[-1]
        solve_fine = None if same else replace(fine, draft=True).solve
        meshes = Meshes(replace(coarse, draft=True).solve, solve_fine, HousingAtParameters.light)
        judged = None if same else before.state
        raced = multistart_search(meshes, target, coarse.parameters, start, judged, effort, count, each, progress)
    return before, start, raced


def _as_it_stands(task: tuple[ParametricHousing, bool]) -> HousingAtParameters:
    """Solve the design that the case gives, with its surrogate where asked."""
    designs, with_surrogate = task
    design = designs.solve(designs.start)
    return replace(design, known=design.surrogate()) if with_surrogate else design


def updated_case(solved: SolvedUpdate) -> str:
    """Return the updated case as TOML; each fitted number's old value, new value and reason stand in [provenance].

    The prior stays where it was: an update of the updated case begins at the fitted value, and is drawn to the old
    nominal one.
    """
    fitted, fine = solved.fitted, solved.misfit_after
    document, changed = fitted.document, set[Location]()
    provenance: dict[str, str] = {}
    old = solved.misfit_before
    remarks = [
        f"# Updated to {len(fine.pairs)} measured frequencies by 'gearwhine update'; errors:",
        f"#   before: rms {old.rms_percent:.2f} %, largest {old.max_percent:.2f} %",
        f"#   after:  rms {fine.rms_percent:.2f} %, largest {fine.max_percent:.2f} %, {_clear(fine)}",
        "# Each parameter before and after, with one standard deviation of what prior and measurement leave of it:",
    ]
    prior: dict[int, dict[str, Any]] = {}
    for place, fitted_number in enumerate(solved.found):
        number = fitted_number.number
        was, now, give = (
            _shown(value, number.given) for value in (number.start, fitted_number.value, fitted_number.deviation)
        )
        remarks.append(f"#   {number.parameter.name}: {was} -> {now}, give or take {give}")
        why = f"found: by updating to the measured frequencies; {was} before, {now} give or take {give} after"
        for location, value in number.entries(number.as_written(fitted_number.value)):
            text = f"{value:.10g}" if number.given.factor or not number.given.unit else _shown(value, number.given)
            document = with_entry(document, location, float(text) if _is_number(text) else text)
            changed.add(location)
            provenance[key_of(location)] = why
        prior[place] = _prior(number, number.as_written(fitted_number.value))
    before = fitted.document
    for place, entry in prior.items():
        document = with_entry(
            document, ("update", "parameter", place), {**document["update"]["parameter"][place], **entry}
        )
    document = without_changed(dict(document), before, changed)
    document["provenance"] = {**document.get("provenance", {}), **provenance}
    return "\n".join(remarks) + "\n\n" + tomli_w.dumps(document)


def _clear(misfit: Misfit) -> str:
    if misfit.mac is not None:
        return f"least MAC {misfit.mac.min():.2f}"
    if misfit.choice_shortfall is None:
        return "paired by frequency alone"
    return f"gap of dominance {misfit.gap:.2f}"


def _prior(number: FittedNumber, value: float) -> dict[str, Any]:
    """Return the prior about the old number of the case, as entries of the case with a new value.

    A factor multiplies the numbers of its keys, which are the fitted ones in the new case: there nominal value, spread
    and range are parts of these.
    """
    parameter, entry = number.parameter, number.given
    if not entry.factor:
        return {"nominal": _exact(parameter.nominal, entry), "spread": _exact(parameter.spread, entry)}
    low, nominal, high, spread = (
        _exact(quantity / value, entry)
        for quantity in (
            min(parameter.low, value),  # the digits of a value at the end of its range are fewer than those of that end
            parameter.nominal,
            max(parameter.high, value),
            parameter.spread,
        )
    )
    return {"range": [low, high], "nominal": nominal, "spread": spread}


def _exact(value: float, entry: UpdateParameter) -> str | float:
    """Return a value in the unit of its range, to as many digits as files need."""
    text = f"{value / unit_in_si(entry):.12g}"
    return f"{text} {entry.unit}" if entry.unit else float(text)


def _shown(value: float, entry: UpdateParameter) -> str:
    """Return a value in the unit of its range, to five digits."""
    return f"{value / unit_in_si(entry):.5g} {entry.unit}".strip()


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
