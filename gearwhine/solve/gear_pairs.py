"""Gear pairs of a case: their analyses, and the objective of each one's best tip relief."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from gearwhine.case import Case, CaseError, GearPair, Problem, require
from gearwhine.case.errors import NOTHING
from gearwhine.case.gears import ReliefAim as GivenAim
from gearwhine.coupling.analyses.gear_pairs import (
    PairAnalysis,
    analyse_pair,
    force_origins,
    level_at_sensors,
    sensor_model,
    weights_below,
)
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
from gearwhine.coupling.gears.loaded.optimal_relief import PeakToPeak, ReliefAim, WeightedHarmonics
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.from_case.machine import describe_machine, misalignments_of_case
from gearwhine.housing import HousingModes
from gearwhine.numerics.progress import Progress, silent
from gearwhine.solve.housing_modes import solve_housing


def analyse_pairs(
    case: Case, solved: Sequence[LoadedGearPair], point: OperatingPoint | None = None
) -> tuple[PairAnalysis, ...]:
    """Analyse each solved gear pair under the case's torque and without load.

    ``point`` is the machine's operating point, where it is solved.
    """
    analysed = []
    rows = zip(
        case.gear_pair,
        solved,
        misalignments_of_case(case.parts, point),
        force_origins(case.parts.train, point),
        strict=True,
    )
    for entry, pair, misalignment, origin in rows:
        analysis = analyse_pair(pair, misalignment)
        analysed.append(replace(analysis, aim_given=entry.relief_aim is not None, force_origin=origin))
    return tuple(analysed)


def relief_aims(
    case: Case,
    pairs: tuple[LoadedGearPair, ...],
    progress: Progress = silent,
    *,
    point: OperatingPoint | None = None,
    housing: HousingModes | None = None,
) -> tuple[ReliefAim, ...]:
    """Objective of the tip-relief search for each pair.

    ``point`` is the machine's operating point, where it is solved already.

    The aim at a sensor is its level, see :func:`gearwhine.coupling.analyses.gear_pairs.level_at_sensors`. By default it
    is the sensor at which the
    given flanks are loudest, where ``housing`` is given and the machine turns, else the peak-to-peak transmission
    error. Where the case names a sensor, the housing is solved for it if it is not given.

    Raises
    ------
    CaseError
        Where a sensor is aimed at and the pair does not turn, or no multiple lies below the model's limit.
    CouplingError
        Where the machine's loads cannot balance, so that a pair has no mean force in it.
    """
    aims = [entry.relief_aim for entry in case.gear_pair]
    # The level at a sensor needs a machine that turns in a housing with sensors.
    turns = case.operation is not None and case.operation.speed != 0.0 and bool(case.rotor)
    if not aims_at_sensor(case.gear_pair) and not (turns and housing is not None and housing.sensors):
        return tuple(_without_sensor(aim) for aim in aims)
    require(case, "rotor", "operation", "housing", command="gears with the aim at a sensor")
    housing = housing or solve_housing(case, progress)
    described = describe_machine(case, housing)
    model = sensor_model(described, point, pairs, progress)
    rows = zip(range(len(aims)), pairs, aims, strict=True)
    return tuple(_aim_of(model, housing, number, pair, aim) for number, pair, aim in rows)


def _aim_of(
    model: MeshHarmonicModel, housing: HousingModes, number: int, pair: LoadedGearPair, aim: GivenAim | None
) -> ReliefAim:
    """Return the objective of a pair in a machine: at a sensor, by default at the loudest one."""
    if pair.static.force == 0.0:
        return PeakToPeak()  # a pair without load has no best relief
    if aim is not None and aim.sensor is None:
        return _without_sensor(aim)
    limit, key = housing.trusted_limit_hz, f"gear_pair[{number}].relief_aim"
    given = {} if aim is None else aim.weights
    weights = weights_below(limit, pair, given)
    if not weights:
        if aim is None:
            return PeakToPeak()
        if not pair.mesh_frequency:
            raise CaseError([Problem(key, NOTHING, "a speed: the level at a sensor is of gears that turn")])
        expected = (
            f"multiples of the mesh frequency of {pair.mesh_frequency:.5g} Hz below {limit:.5g} Hz, up to which the "
            "modes are known"
        )
        raise CaseError([Problem(f"{key}.harmonics", list(given) or NOTHING, expected)])
    sensors = tuple(housing.sensors) if aim is None or aim.sensor is None else (aim.sensor,)
    return level_at_sensors(model, number, pair, sensors, weights)


def aims_at_sensor(pairs: Iterable[GearPair]) -> bool:
    """Whether the tip relief of a gear pair aims at a sensor, for which the housing is solved."""
    return any(pair.relief_aim is not None and pair.relief_aim.sensor is not None for pair in pairs)


def _without_sensor(aim: GivenAim | None) -> ReliefAim:
    return PeakToPeak() if aim is None or aim.peak_to_peak else WeightedHarmonics(aim.weights)
