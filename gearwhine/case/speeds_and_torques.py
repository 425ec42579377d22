"""Shaft speeds, torques and mesh frequencies of a case, by arithmetic alone.

The speeds of rotor analyses follow from them: of whirl, the Campbell diagram and responses, as given in the case or by
default. They are speeds of the rotor itself [rad/s], positive counter-clockwise from +z.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from typing import TYPE_CHECKING

from gearwhine.case.errors import NOTHING, UNSAID, CaseError, Problem
from gearwhine.case.gears import readable_pairs, train_of_pairs
from gearwhine.case.model import Case, require
from gearwhine.case.operation import listed
from gearwhine.numerics import speed_ranges
from gearwhine.numerics.speed_ranges import BEYOND_OPERATION, CAMPBELL_STEPS, SLOWEST_OF_BRANCH, evenly

if TYPE_CHECKING:
    from gearwhine.coupling.description.gear_train import GearTrain
    from gearwhine.coupling.machine.loads import Torque


def gear_train_of(case: Case) -> GearTrain:
    """Return the gear train of a case; without gear pairs every shaft turns at the speed of the first."""
    shafts = [rotor.name for rotor in case.rotor] or [gear.name for gear in case.gear]
    return train_of_pairs(readable_pairs(case.gear, enumerate(case.gear_pair)), shafts)


def speed_ratios(case: Case) -> dict[str, Fraction]:
    """Return each shaft's speed over the first driver's, exact and signed; 1 for every rotor without gear pairs.

    Keys are rotor names, or gear names in a case without rotors.
    """
    return dict(gear_train_of(case).ratios)


def rotor_speeds(case: Case, speed: float | None = None) -> dict[str, float]:
    """Return each shaft's speed [rad/s], positive counter-clockwise from +z.

    Parameters
    ----------
    case : Case
        Case with gear pairs; without them every rotor turns at the same speed.
    speed : float, optional
        Speed of the first driver's rotor [rad/s]; by default that of `[operation]`.

    Raises
    ------
    CaseError
        When no speed is given and the case has no `[operation]`.
    """
    speed = _speed(case, speed)
    return {name: speed * float(ratio) for name, ratio in speed_ratios(case).items()}


def mesh_frequencies(case: Case, speed: float | None = None) -> tuple[float, ...]:
    """Return the tooth-mesh frequency of each gear pair [Hz], in the order of the file; see `rotor_speeds`."""
    return gear_train_of(case).mesh_frequencies(_speed(case, speed))


def applied_torques(case: Case, torque: float | None = None) -> tuple[Torque, ...]:
    """Return the torques from outside: the input first, then the outputs. They balance through the gears.

    They are those of :meth:`gearwhine.coupling.description.gear_train.GearTrain.applied_torques`. Without an `at`, the
    input is at the left end of its rotor, an output at the right end; in a case without rotors shafts have no length,
    and every torque is at 0.

    Parameters
    ----------
    case : Case
        Case with an `[operation]`.
    torque : float, optional
        Input torque [N m], which the outputs take in their proportions; by default that of `[operation]`.

    Raises
    ------
    CaseError
        When the case has no `[operation]`.
    """
    require(case, "operation", command="torques")
    operation = case.operation
    assert operation is not None
    entering = operation.torque if torque is None else torque
    outputs = [output.build() for output in operation.output]
    train = gear_train_of(case)
    ends = {rotor.name: rotor.length for rotor in case.rotor} or dict.fromkeys(train.ratios, 0.0)
    return train.applied_torques(entering, operation.speed, outputs, operation.at or 0.0, ends=ends)


def pair_torques(case: Case) -> tuple[float, ...]:
    """Return the mean torque that each gear pair takes off its driver [N m], in the order of the file.

    Positive where power flows from driver to driven; see
    :meth:`gearwhine.coupling.description.gear_train.GearTrain.pair_torques`.

    Raises
    ------
    CaseError
        When the case has no `[operation]`.
    """
    return gear_train_of(case).mean_pair_torques(applied_torques(case), _speed(case))


def force_origins(case: Case) -> tuple[str, ...]:
    """Return what the mean force of each gear pair follows from.

    See :attr:`gearwhine.coupling.description.gear_train.GearTrain.force_origins`.
    """
    return gear_train_of(case).force_origins


def _speed(case: Case, speed: float | None = None) -> float:
    """Return a speed of the first driver's rotor [rad/s], by default that of `[operation]`."""
    if speed is None:
        require(case, "operation", command="rotor speeds")
        assert case.operation is not None
        speed = case.operation.speed
    return speed


def with_sense_of_operation(case: Case, speeds: Iterable[float]) -> tuple[float, ...]:
    """Return speeds of the first driver's rotor [rad/s] in the sense of the speed of operation, whatever their own.

    Lists and ranges of speeds hold absolute values. Without an operation the speeds stay as they are.
    """
    if case.operation is None:
        return tuple(speeds)
    sense = case.operation.speed
    return tuple(math.copysign(speed, sense) for speed in speeds)


def whirl_speeds(case: Case, rotor: str) -> tuple[float, ...]:
    """Return the speed of operation, then those of the sweep."""
    operation_speed = () if case.operation is None else (case.operation.speed,)
    return _turned(case, rotor, (*operation_speed, *(case.sweep.speeds if case.sweep else ())))


def campbell_speeds(case: Case, rotor: str) -> tuple[float, ...]:
    """Return the speeds of the Campbell diagram: as given, else the sweep's, else up to beyond operation, else none.

    Ascending, each once; those of a rotor that turns clockwise are negative.
    """
    return tuple(sorted(set(_diagram_speeds(case, rotor))))


def _diagram_speeds(case: Case, rotor: str) -> tuple[float, ...]:
    analysis = case.rotor_analysis
    if analysis is not None and analysis.speed is not None:
        return _turned(case, rotor, listed(analysis.speed))
    if case.sweep is not None:
        return _turned(case, rotor, case.sweep.speeds)
    operation = None if case.operation is None else _turned(case, rotor, (case.operation.speed,))[0]
    return speed_ranges.campbell_speeds(operation, table_range(case, rotor))


def response_speeds(case: Case, rotor: str) -> tuple[float, ...]:
    """Return the speeds of the unbalance response: as given, else the range of the Campbell diagram in finer steps.

    From the slowest to the fastest, each once.
    """
    analysis = case.rotor_analysis
    if analysis is not None and analysis.unbalance_response.speed is not None:
        return tuple(sorted(set(_turned(case, rotor, listed(analysis.unbalance_response.speed))), key=abs))
    return speed_ranges.response_speeds(campbell_speeds(case, rotor))


def table_range(case: Case, rotor: str) -> tuple[float, float]:
    """Return the lowest and the highest speed, without sense, that the tables of all bearings of a rotor hold.

    Zero and infinity for bearings without tables.
    """
    own = [bearing for bearing in case.bearing if bearing.rotor == rotor]
    saved, replaced = case.rotor_named(rotor).saved, {bearing.name for bearing in own}
    of_file = [bearing.speeds for bearing in (saved.bearings if saved else ()) if bearing.name not in replaced]
    tables = [table for table in (*(bearing.speeds for bearing in own), *of_file) if table is not None]
    lowest = max((float(table[0]) for table in tables), default=0.0)
    return lowest, min((float(table[-1]) for table in tables), default=math.inf)


def range_of_tables(case: Case, lowest: float, highest: float) -> tuple[float, float]:
    """Return the part of a range of speeds of the first driver's rotor that the tables of all bearings hold.

    Parameters
    ----------
    lowest, highest : float
        Speeds without sense [rad/s].

    Raises
    ------
    CaseError
        Where the tables have no range in common with it.
    """
    low, high = lowest, highest
    for name, speed in rotor_speeds(case).items():
        least, most = table_range(case, name)
        ratio = abs(speed / case.operation.speed) if case.operation is not None and case.operation.speed else 0.0
        if ratio > 0.0:
            low, high = max(low, least / ratio), min(high, most / ratio)
    if not low < high:
        raise CaseError(
            [Problem("bearing", NOTHING, "tables over speed with a range in common, for a diagram over speed")]
        )
    return low, high


def diagram_speeds(case: Case) -> tuple[float, ...]:
    """Speeds of the first driver [rad/s] for the diagram: the sweep's, else up to beyond operation; ascending in size.

    Raises
    ------
    CaseError
        For a machine that stands still, whose bearings' tables leave no range, or a sweep of one speed.
    """
    assert case.operation is not None
    operation = case.operation.speed
    if operation == 0.0:
        raise CaseError([Problem("operation.speed", 0.0, "a speed: a diagram over speed is of a machine that turns")])
    if case.sweep is not None:
        speeds = sorted({abs(speed) for speed in case.sweep.speeds})
        if len(speeds) < 2:
            raise CaseError([Problem("sweep.speed", NOTHING, "two or more speeds for a diagram over speed")])
        return with_sense_of_operation(case, speeds)
    low, high = range_of_tables(case, 0.0, BEYOND_OPERATION * abs(operation))
    return with_sense_of_operation(case, evenly(low, high, CAMPBELL_STEPS))


def branch_speeds(case: Case, *, downwards: bool = False) -> tuple[float, float]:
    """Return the speeds from which and to which a motion is followed [rad/s]: the sweep's range, or about operation.

    Raises
    ------
    CaseError
        Where the sweep holds no range of speeds above zero, or the bearings' tables leave none.
    """
    assert case.operation is not None
    operation = abs(case.operation.speed)
    if case.sweep is None:
        low, high = range_of_tables(case, SLOWEST_OF_BRANCH * operation, BEYOND_OPERATION * operation)
    else:
        speeds = [abs(speed) for speed in case.sweep.speeds]
        low, high = min(speeds), max(speeds)
        if not 0.0 < low < high:
            expected = "a range of speeds above zero, over which a motion is followed"
            raise CaseError([Problem("sweep.speed", UNSAID, expected)])
    first, last = with_sense_of_operation(case, (high, low) if downwards else (low, high))
    return first, last


def _turned(case: Case, rotor: str, speeds: tuple[float, ...]) -> tuple[float, ...]:
    """Return speeds of the first driver's rotor, in the sense of operation, as those of another rotor.

    A rotor outside the train stands still.
    """
    ratio = float(speed_ratios(case).get(rotor, 0.0))
    return tuple(ratio * speed for speed in with_sense_of_operation(case, speeds))
