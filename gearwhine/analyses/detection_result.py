"""Result of a detection study: gearboxes with and without a fault, solved in parallel, and where the fault is seen."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from gearwhine.analyses.origin import Origin
from gearwhine.analyses.result import Result
from gearwhine.analyses.variation_result import drawn_points, in_solved_housing, sampled_points
from gearwhine.case import Case, CaseError, CaseSource, Problem, case_document, require
from gearwhine.case.bearings import Bearing, BearingFault, CageSlip
from gearwhine.case.detection import MOST_GEARBOXES, Detection
from gearwhine.case.errors import UNSAID, key_of, look_up
from gearwhine.case.load import findings_of
from gearwhine.case.model import lacking
from gearwhine.case.overrides import ListPlace, matching_places, parse_key_path
from gearwhine.case.variation import Variation
from gearwhine.coupling import CouplingError, Machine
from gearwhine.coupling.analyses.condition_record import LEAST_TURNS
from gearwhine.coupling.analyses.gear_condition import INDICATORS, OF_ONE_RECORD
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.description.changed import number_at, path_steps, value_at
from gearwhine.coupling.gears import Gear, GearError
from gearwhine.detection.detectability import DetectionResult, Monitor, Observation, detected_parts
from gearwhine.detection.samples import Design, DetectionCase, DetectionMachine, Watched, detection_design
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.names import did_you_mean
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning
from gearwhine.results.detection import DETECTION, detection_document
from gearwhine.rotors.rolling_bearings import BearingDamage
from gearwhine.settings import Settings
from gearwhine.solutions import Failure
from gearwhine.solve.machine import plan_of
from gearwhine.solve.radiated_power import Radiations
from gearwhine.study_folder import StudyFolder
from gearwhine.variation.inputs import Input, correlation_matrix, varied_inputs
from gearwhine.variation.machines import Maker, VariedMachine
from gearwhine.variation.quantities import Evaluation, Wanted
from gearwhine.variation.run import run_samples
from gearwhine.variation.samples import Outcome, Sampled, VariedCase

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FOLDER = "detection-samples"
"""Folder of the record within the results folder."""
_SPARE_TURNS = 0.5  # that the filters of a record take from its ends


@dataclass(frozen=True)
class PlannedDetection:
    """A detection study of a case, checked before anything is solved.

    Attributes
    ----------
    case : Case
    settings : Detection
    source : CaseSource
        Content of the case without the tables of the study.
    inputs : tuple of Input
        Varied inputs; none where all gearboxes are alike.
    variation : Variation
    between : tuple of int
        Numbers of the inputs that differ between two records of one gearbox.
    without : str
        Change that makes a healthy gearbox.
    gear : str
    monitor : Monitor
    spall : (str, BearingDamage) or None
        Name of the bearing, and its spall, where that is the fault.
    slips : tuple of (str, int)
        Key and value of the seed of each slip that scatters: it differs from record to record.
    """

    case: Case
    settings: Detection
    source: CaseSource
    inputs: tuple[Input, ...]
    variation: Variation
    between: tuple[int, ...]
    without: str
    gear: str
    monitor: Monitor
    spall: tuple[str, BearingDamage] | None = None
    slips: tuple[tuple[str, int], ...] = ()

    @property
    def is_varied(self) -> bool:
        """Whether records differ by more than noise."""
        return bool(self.inputs or self.slips)

    @property
    def written(self) -> dict[float, str]:
        """Sizes of the fault as the case writes them, by their value in SI."""
        return _written(self.settings)

    def study(self, varied: VariedCase) -> DetectionCase:
        """Return the gearboxes of a case with its varied inputs."""
        watched = _watched(self.monitor, self.gear, self.spall)
        return DetectionCase(varied, self.settings.fault, self.without, self.written, watched, self.slips)


def plan_detection(source: CaseSource) -> PlannedDetection:
    """Check the detection study of a case.

    Parameters
    ----------
    source : CaseSource
        Content that the case is made of.

    Raises
    ------
    CaseError
        Where the case has no fault, sensor or gear of such a name, a size is beyond what the model allows, the record
        holds too few turns, or nothing scatters.
    """
    case = source.changed_case()
    settings = case.detection
    if settings is None:
        raise lacking(case, "detection", command="detect")
    require(case, "rotor", "gear_pair", "operation", "transient", command="detect")
    variation = case.variation or Variation()
    inputs = varied_inputs(source, variation)
    correlation_matrix(inputs, variation)
    slips = _slips(source.document)
    _require_scatter(settings, is_varied=bool(inputs or slips))
    table = case.housing or case.reduced_housing
    sensors = _sensors(() if table is None else tuple(sensor.name for sensor in table.sensor), settings)
    shafts = {one.name: one.rotor for one in case.gear}
    # Planets that are written once are found as they are written, where changes of their keys go.
    documents = case_document(case), source.document
    without = _healthy_change(documents, settings)
    bearing, spall = _spall(source.document, case.bearing, settings)
    beside = [one.name for one in case.gear if bearing is not None and one.rotor == bearing.rotor]
    gear = _gear(list(shafts), next(iter(beside), case.gear_pair[0].driver), settings)
    plain = source.without("detection", "variation")
    _require_severities(plain, settings, without)
    _require_turns(plan_of(case), shafts[gear] or "", case.parts.train.ratios)
    monitor = _monitor(settings, sensors, of_bearing=bearing is not None)
    between = _between(source, variation, settings, inputs)
    struck = None if bearing is None or spall is None else (bearing.name, spall)
    return PlannedDetection(case, settings, plain, inputs, variation, between, without, gear, monitor, struck, slips)


def _indicators(settings: Detection, *, of_bearing: bool) -> tuple[str, ...]:
    """Return the indicators by default: of a bearing, whose strikes no average keeps, those of the signal."""
    if of_bearing:
        return tuple(name for name, indicator in INDICATORS.items() if indicator.of_time)
    return tuple(INDICATORS) if settings.baseline == "own" else OF_ONE_RECORD


def solve_detection(source: CaseSource, folder: StudyFolder) -> Result[DetectionResult]:
    """Solve the gearboxes of a detection study, and find where its fault is seen.

    Parameters
    ----------
    source : CaseSource
        Content that the case with its detection study is made of.
    folder : StudyFolder

    Raises
    ------
    CaseError
        See :func:`plan_detection`.
    gearwhine.coupling.CouplingError
        Where the gearbox without the fault has no record.
    gearwhine.failures.WorkersError
        Where the processes do not start.
    """
    start = time.perf_counter()
    planned = plan_detection(source)
    case, settings, monitor = planned.case, planned.settings, planned.monitor
    varied = VariedCase(planned.source, planned.inputs, Wanted(("motion",)))
    varied, housing = in_solved_housing(varied, folder, "detect")
    cube = _cube(planned, _records(settings, is_varied=planned.is_varied))
    study, between = planned.study(varied), planned.between
    detected = _detected(study, settings, monitor, planned.gear, cube, between, folder, is_varied=planned.is_varied)
    return _result(Origin(case.title, case=case, housing=housing), detected, start, varied.start_warnings)


def detect_in_machine(
    make: Maker,
    machine: Machine,
    fault: str,
    sizes: Sequence[float],
    inputs: tuple[Input, ...],
    settings: Settings,
    folder: StudyFolder,
    origin: Origin,
    **keys: Any,
) -> Result[DetectionResult]:
    """Find where a fault in a machine of Python is seen; see :meth:`gearwhine.study.Study.detect`.

    Parameters
    ----------
    make : callable
        Makes a machine of values by the paths of attributes.
    machine : Machine
    fault : str
        Path of the fault's size.
    sizes : sequence of float
    inputs : tuple of Input
        Varied attributes; none where all machines are alike.
    settings : Settings
        With the stretch of the motion.
    folder : StudyFolder
    origin : Origin
    **keys
        Keys of `[detection]`.
    """
    start, plan = time.perf_counter(), settings.transient
    if plan is None or not machine.gear_pairs:
        raise CouplingError("detect: expected a machine with a gear pair, and settings with a transient")
    detection = _detection_of(fault, sizes, keys)
    steps, fault = path_steps(fault), detection.fault
    number_at(machine, fault)
    slips = tuple(
        (f'bearings."{one.bearing.name}".law.slip.seed', one.slip.seed)
        for one in machine.bearings
        if one.slip.scatter > 0.0
    )
    _require_scatter(detection, is_varied=bool(inputs or slips))
    component = machine.housing_component
    sensors = _sensors(() if component is None else tuple(component.sensors), detection)
    # As in a case, a healthy machine is without the tooth's or bearing's damage.
    damages = next((place for place, step in enumerate(steps) if step in ("faults", "spalls")), None)
    without = dict[str, object]()
    damaged: Any = None
    if damages is not None:
        table = _dotted(steps[: damages + 1])
        damaged = value_at(machine, _dotted(steps[: damages + 2]))
        without = {table: tuple(one for one in value_at(machine, table) if one is not damaged)}
    for number, size in enumerate(detection.sizes):
        _require_size(make, fault, size, number)
    bearing = None
    if steps[0] == "bearings" and damages is not None:
        bearing = value_at(machine, _dotted(steps[:2]))
    spall = None if bearing is None else (bearing.bearing.name, damaged)
    shafts = {one.gear.name: one.shaft for one in machine.gears}
    beside = [name for name, shaft in shafts.items() if bearing is not None and shaft == bearing.rotor]
    of_fault = [value_at(machine, _dotted(steps[:2])).gear.name] if steps[0] == "gears" else beside
    gear = _gear_of(list(shafts), next(iter(of_fault), machine.gear_pairs[0].driver), detection)
    _require_turns(plan, shafts[gear], machine.train.ratios)
    monitor = _monitor(detection, sensors, of_bearing=bearing is not None)
    names = [_dotted(path_steps(one.name)) for one in inputs]
    _require_between(detection, names)
    between = tuple(number for number, name in enumerate(names) if name in detection.between)
    varied = VariedMachine(make, inputs, Wanted(("motion",), plan=plan), Radiations(), machine)
    study = DetectionMachine(varied, fault, without, _watched(monitor, gear, spall), slips, plan)
    is_varied = bool(inputs or slips)
    count = _records(detection, is_varied=is_varied)
    cube = drawn_points(len(inputs), count, detection.seed) if inputs else np.empty((count, 0))
    detected = _detected(study, detection, monitor, gear, cube, between, folder, is_varied=is_varied)
    return _result(origin, detected, start, varied.start_warnings)


def _detection_of(fault: str, sizes: Sequence[float], keys: Mapping[str, Any]) -> Detection:
    """Return the settings of a study by the keys of `[detection]`, with paths as key paths.

    Raises
    ------
    CaseError
        With all that is wrong.
    """
    keys = dict(keys) | {"fault": _dotted(path_steps(fault)), "severities": list(sizes)}
    if "between" in keys:
        keys["between"] = [_dotted(path_steps(one)) for one in keys["between"]]
    try:
        found = Case.model_validate({"detection": keys}).detection
    except ValidationError as error:
        raise CaseError(Problem(key_of(one.location), UNSAID, one.expected) for one in findings_of(error)) from None
    assert found is not None
    return found


def _dotted(steps: Sequence[str]) -> str:
    return ".".join(step if step.isidentifier() or step.isdecimal() else f'"{step}"' for step in steps)


def _require_size(make: Maker, fault: str, size: float, number: int) -> None:
    """Refuse a size of a fault that the machine or the model of a damaged tooth does not allow.

    Raises
    ------
    CaseError
    """
    try:
        machine = make({fault: size})
        assert isinstance(machine, Machine)
        _require_sound_teeth([one.gear for one in machine.gears])
    except ValueError as error:
        expected = f"a size that the machine takes: {error}"
        raise CaseError([Problem(key_of(("detection", "severities", number)), size, expected)]) from None


def _detected(
    study: Sampled,
    settings: Detection,
    monitor: Monitor,
    gear: str,
    cube: FloatArray,
    between: Sequence[int],
    folder: StudyFolder,
    *,
    is_varied: bool,
) -> DetectionResult:
    """Solve the gearboxes of a study, of a case or of Python, and find where their fault is seen.

    Parameters
    ----------
    study : Sampled
    settings : Detection
    monitor : Monitor
    gear : str
    cube : ndarray, shape (n, d)
        Point of the unit cube of each gearbox.
    between : sequence of int
        Numbers of the inputs that differ between two records of one gearbox.
    folder : StudyFolder
    is_varied : bool
        Whether records differ by more than noise.
    """
    written = _written(settings)
    # Gearboxes that are all alike have one record, and as many noises.
    healthy, faulty = (settings.healthy, settings.faulty) if is_varied else (1, 1)
    baselines = between if is_varied and monitor.has_own_baseline else None
    design = detection_design(cube, settings.sizes, healthy, faulty, baselines)
    points = design.points
    folder.progress("the gearbox without the fault")
    first = run_samples(study, points[:1], replace(folder, workers=1, scheduler=None, progress=silent), FOLDER)
    if isinstance(reference := first.outcomes[0], Failure):
        raise CouplingError(f"the gearbox without the fault: {reference.message}")
    solved = run_samples(study, points, replace(folder, fresh=False), FOLDER)
    outcomes = solved.outcomes
    folder.progress("thresholds and probabilities of detection")
    parts = detected_parts(monitor, list(_observations(design, outcomes, settings, is_varied=is_varied)))
    return DetectionResult(
        fault=settings.fault,
        gear=gear,
        severities=written,
        monitor=monitor,
        is_varied=is_varied,
        turns=reference.numbers["turns"],
        limit_hz=reference.numbers["limit_hz"],
        parts=parts,
        failures={number: one for number, one in enumerate(outcomes) if isinstance(one, Failure)},
        samples=len(points),
        resumed=solved.resumed - (0 if first.resumed else 1),
    )


def _result(
    origin: Origin, found: DetectionResult, start: float, warnings: Sequence[ResultWarning]
) -> Result[DetectionResult]:
    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures.detection import draw_detection

        return draw_detection(origin.title, found)

    document = detection_document(found)
    return origin.study_result("detect", found, document, DETECTION, figures, start, warnings=warnings)


def _records(settings: Detection, *, is_varied: bool) -> int:
    """Return the number of gearboxes without and with the fault; those that are all alike have one record each."""
    healthy, faulty = (settings.healthy, settings.faulty) if is_varied else (1, 1)
    count = healthy + faulty * len(settings.sizes)
    if count > MOST_GEARBOXES:
        raise CaseError([Problem("detection.faulty", settings.faulty, f"{MOST_GEARBOXES} gearboxes in all")])
    return count


def _written(settings: Detection) -> dict[float, str]:
    """Return the sizes of a fault as they are written, by their value in SI."""
    return {size: _text(text) for size, text in zip(settings.sizes, settings.severities, strict=True)}


def _watched(monitor: Monitor, gear: str, spall: tuple[str, BearingDamage] | None) -> Watched:
    return Watched(gear, spall, is_averaged=any(not INDICATORS[name].of_time for name in monitor.indicators))


def _monitor(settings: Detection, sensors: tuple[str, ...], *, of_bearing: bool) -> Monitor:
    return Monitor(
        sensors,
        settings.indicators or _indicators(settings, of_bearing=of_bearing),
        settings.sensor_noise,
        settings.averages,
        settings.false_alarm,
        settings.threshold,
        settings.seed,
        settings.baseline == "own",
    )


def _require_scatter(settings: Detection, *, is_varied: bool) -> None:
    if not is_varied and settings.sensor_noise == 0.0:
        expected = "noise above 0, or distributions under [variation.vary]: without scatter there is no threshold"
        raise CaseError([Problem("detection.sensor_noise", 0.0, expected)])


def _observations(
    design: Design, outcomes: Sequence[Outcome], settings: Detection, *, is_varied: bool
) -> Iterator[Observation]:
    """Yield the records with those that they are compared with; of a gearbox that does not vary with many noises."""
    noise = 0
    for number, size in enumerate(design.sizes.tolist()):
        found, earlier = outcomes[design.gearbox(number)], outcomes[design.baseline(number)]
        for _ in range(1 if is_varied else settings.faulty if size else settings.healthy):
            noise += 1
            if isinstance(found, Evaluation) and isinstance(earlier, Evaluation):
                yield Observation(found, earlier, size, noise)


def _cube(planned: PlannedDetection, count: int) -> FloatArray:
    """Return a point of the unit cube for each gearbox, shape (n, d)."""
    if not planned.inputs:
        return np.empty((count, 0))
    return sampled_points(planned.inputs, planned.variation, count, planned.settings.seed)


def _text(written: str | float) -> str:
    return written if isinstance(written, str) else repr(written)


def _between(source: CaseSource, variation: Variation, settings: Detection, inputs: Sequence[Input]) -> tuple[int, ...]:
    """Return the numbers of the inputs that differ between two records of one gearbox."""
    _require_between(settings, list(variation.vary))
    chosen = variation.model_copy(update={"vary": {key: variation.vary[key] for key in settings.between}})
    names = {one.name for one in varied_inputs(source, chosen)}
    return tuple(number for number, one in enumerate(inputs) if one.name in names)


def _require_between(settings: Detection, varied: Sequence[str]) -> None:
    """Refuse keys that differ between two records and are not varied."""
    problems = [
        Problem(
            key_of(("detection", "between", number)),
            key,
            f"a key of [variation.vary], as it stands there{did_you_mean(key, varied)}",
        )
        for number, key in enumerate(settings.between)
        if key not in varied
    ]
    if problems:
        raise CaseError(problems)


def _sensors(names: tuple[str, ...], settings: Detection) -> tuple[str, ...]:
    """Return the sensors that are asked for, by default all there are."""
    if not names:
        raise CaseError([Problem("housing.sensor", UNSAID, "a sensor or more, which 'detect' listens to")])
    problems = [
        Problem(key_of(("detection", "sensors", number)), name, f"one of {', '.join(names)}{did_you_mean(name, names)}")
        for number, name in enumerate(settings.sensors)
        if name not in names
    ]
    if problems:
        raise CaseError(problems)
    return tuple(dict.fromkeys(settings.sensors)) or names


def _gear(names: Sequence[str], driver: str, settings: Detection) -> str:
    """Return the gear by whose shaft signals are averaged, by default the faulty one, else the first driver."""
    steps = parse_key_path(settings.fault) or ()
    of_fault = steps[1] if len(steps) > 1 and steps[0] == "gear" else ""
    by_number = isinstance(of_fault, ListPlace) or of_fault not in names
    if of_fault.isdecimal() and by_number and int(of_fault) < len(names):
        of_fault = names[int(of_fault)]
    return _gear_of(names, of_fault if of_fault in names else driver, settings)


def _gear_of(names: Sequence[str], usual: str, settings: Detection) -> str:
    """Return the gear that is asked for, by default the usual one."""
    chosen = settings.gear or usual
    if chosen not in names:
        expected = f"the name of a gear: {', '.join(names)}{did_you_mean(chosen, names)}"
        raise CaseError([Problem("detection.gear", chosen, expected)])
    return chosen


def _spall(
    document: Mapping[str, Any], bearings: Sequence[Bearing], settings: Detection
) -> tuple[Bearing | None, BearingDamage | None]:
    """Return the bearing whose spall is the fault, with that; twice None where it is another fault.

    Of planets that are made of one it is the bearing of the first, which has the speed of all.
    """
    steps = parse_key_path(settings.fault) or ()
    if steps[:1] != ("bearing",) or steps[2:3] != ("fault",):
        return None, None
    (place,) = matching_places(document, steps[:2])
    written: Any = look_up(document, place)
    faults = written["fault"]
    fault = faults if isinstance(faults, Mapping) else faults[int(steps[3]) if steps[3].isdecimal() else 0]
    spall = BearingFault.model_validate({key: value for key, value in fault.items() if key != "planet"}).build()
    return next(one for one in bearings if one.name in (written["name"], f"{written['name']} 1")), spall


def _slips(document: Mapping[str, Any]) -> tuple[tuple[str, int], ...]:
    """Return key and value of the seed of each cage's slip that scatters."""
    found = list[tuple[str, int]]()
    for place in matching_places(document, ("bearing", "*", "slip")):
        slip = CageSlip.model_validate(look_up(document, place))
        if slip.scatter > 0.0:
            found.append((key_of((*place, "seed")), slip.seed))
    return tuple(found)


def _healthy_change(documents: Sequence[Mapping[str, Any]], settings: Detection) -> str:
    """Return the change that takes the fault from the case; empty where its key is of no damaged tooth."""
    steps = parse_key_path(settings.fault) or ()
    if "*" in steps:
        raise CaseError([Problem("detection.fault", settings.fault, "the key of one fault, without *")])
    if "fault" not in steps:
        if not _is_in(documents, steps):
            raise CaseError([Problem("detection.fault", settings.fault, f"a key of the case; {_KEYS}")])
        return ""
    place = steps.index("fault")
    # One fault may stand as a table, which the case holds as a list.
    inside = steps[place + 1 :]
    listed = inside if inside and inside[0].isdecimal() else ("0", *inside)
    if not _is_in(documents, (*steps[: place + 1], *listed), steps):
        raise CaseError([Problem("detection.fault", settings.fault, f"the key of a fault that the case has; {_KEYS}")])
    end = place + 2 if inside and inside[0].isdecimal() else place + 1
    return key_of(tuple(int(step) if isinstance(step, ListPlace) else step for step in steps[:end])) + "="


def _is_in(documents: Sequence[Mapping[str, Any]], *paths: Sequence[str]) -> bool:
    """Whether a key path leads to something in a document."""
    return any(True for document in documents for steps in paths for _ in matching_places(document, steps))


_KEYS = (
    'such as "gear.pinion.fault.depth" of fault = { kind = "crack", tooth = 5, depth = "1 mm" }, or '
    '"bearing.left.fault.length" of fault = { on = "outer", length = "1 mm", depth = "0.1 mm" }'
)


def _require_severities(source: CaseSource, settings: Detection, without: str) -> None:
    """Refuse sizes that the case or the model of a damaged tooth does not allow.

    Raises
    ------
    CaseError
    """
    problems = list[Problem]()
    if without:
        source.changed_case([without])
    for number, written in enumerate(settings.severities):
        key = key_of(("detection", "severities", number))
        try:
            changed = source.changed_case([f"{settings.fault}={_text(written)}"])
            _require_sound_teeth(changed.parts.gears.values())
        except CaseError as error:
            problems += [
                Problem(key, written, f"a size that the case takes; {one.key}: expected {one.expected}")
                for one in error.problems
            ]
        except GearError as error:
            problems.append(Problem(key, written, f"a size that the model takes: {error}"))
    if problems:
        raise CaseError(problems)


def _require_sound_teeth(gears: Iterable[Gear]) -> None:
    """Refuse damage of teeth that its model does not allow.

    Raises
    ------
    gearwhine.coupling.gears.GearError
    """
    for gear in gears:
        ends = np.array([gear.roll_angle(gear.form_radius), gear.roll_angle(gear.tip_radius)])
        for fault in gear.faults:
            fault.extra_compliance(gear, ends)


def _require_turns(plan: TransientPlan, shaft: str, ratios: Mapping[str, Fraction]) -> None:
    """Refuse a record at constant speed that holds too few turns of a shaft.

    Raises
    ------
    CaseError
    """
    if plan.revolutions is None:
        return
    ratio = abs(float(ratios.get(shaft, 0)))
    turns = ratio * (plan.revolutions - plan.discarded)
    if ratio > 0.0 and turns < LEAST_TURNS + _SPARE_TURNS:
        least = plan.discarded + (LEAST_TURNS + _SPARE_TURNS) / ratio
        expected = (
            f"{least:.4g} or more: beyond the {plan.discarded:g} that are discarded, {LEAST_TURNS} whole turns of "
            f"{shaft!r} are averaged, and the filter of the record takes a part of one"
        )
        raise CaseError([Problem("transient.revolutions", plan.revolutions, expected)])
