"""Shaft speeds, torques and mesh frequencies of a case, by arithmetic alone.

The speeds of rotor analyses follow from them: of whirl, the Campbell diagram and responses, as given in the case or by
default. They are speeds of the rotor itself [rad/s], positive counter-clockwise from +z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from gearwhine.case.gears import readable_pairs, shaft_of, train_of_pairs
from gearwhine.case.model import Case, require
from gearwhine.case.operation import listed

if TYPE_CHECKING:
    from coupling.machine.gear_train import GearTrain


@dataclass(frozen=True)
class AppliedTorque:
    """A torque from outside on a shaft.

    Attributes
    ----------
    shaft
        The rotor; the gear itself in a case without rotors.
    at
        Station from the rotor's left end [m]; None in a case without rotors.
    torque
        About +z, counter-clockwise positive [N m].
    """

    shaft: str
    at: float | None
    torque: float


def gear_train_of(case: Case) -> GearTrain:
    """Return the gear train of a case."""
    return train_of_pairs(readable_pairs(case.gear, enumerate(case.gear_pair)))


def speed_ratios(case: Case) -> dict[str, Fraction]:
    """Return each shaft's speed over the first driver's, exact and signed; 1 for every rotor without gear pairs.

    Keys are rotor names, or gear names in a case without rotors.
    """
    if not case.gear_pair:
        return {name: Fraction(1) for name in _shafts(case)}
    return dict(gear_train_of(case).ratios)


def rotor_speeds(case: Case, speed: float | None = None) -> dict[str, float]:
    """Return each shaft's speed [rad/s], positive counter-clockwise from +z.

    Parameters
    ----------
    case
        With gear pairs; without, every rotor turns at the same speed.
    speed
        Of the first driver's rotor [rad/s]; None: that of `[operation]`.

    Raises
    ------
    CaseError
        When no speed is given and the case has no `[operation]`.
    """
    if speed is None:
        require(case, "operation", command="rotor speeds")
        assert case.operation is not None
        speed = case.operation.speed
    return {name: speed * float(ratio) for name, ratio in speed_ratios(case).items()}


def mesh_frequencies(case: Case, speed: float | None = None) -> tuple[float, ...]:
    """Return the tooth-mesh frequency of each gear pair [Hz], in the order of the file; see `rotor_speeds`."""
    speeds = rotor_speeds(case, speed)
    drivers = (case.gear_named(pair.driver) for pair in case.gear_pair)
    return tuple(abs(speeds[shaft_of(gear)]) * gear.teeth / (2.0 * math.pi) for gear in drivers)


def applied_torques(case: Case, torque: float | None = None) -> tuple[AppliedTorque, ...]:
    """Return the torques from outside: the input first, then the outputs. They balance through the gears.

    Parameters
    ----------
    case
        With an `[operation]`.
    torque
        Input torque [N m], which the outputs take in their proportions; None: the torque of `[operation]`.

    The input drives the first driver's shaft in its direction of turning; outputs work against the turning of theirs.
    Without outputs, the shafts that drive no other take equal power. Outputs are scaled, within the 1 % that a case
    may be off, to balance the input exactly. Without an `at`, the input is at the left end of its rotor, an output at
    the right end.

    Raises
    ------
    CaseError
        When the case has no `[operation]`.
    """
    require(case, "operation", command="torques")
    operation = case.operation
    assert operation is not None
    ratios = speed_ratios(case)
    entering = operation.torque if torque is None else torque
    if entering == 0.0 or not ratios or not (case.gear_pair or operation.output):
        return ()
    from coupling.machine.gear_train import GearTrain, Output, shared_torques

    first = next(iter(ratios)) if case.gear_pair else operation.output[0].rotor
    turning = math.copysign(1.0, operation.speed)
    applied = [AppliedTorque(first, _station(case, first, operation.at, 0.0), turning * entering)]
    train = gear_train_of(case) if case.gear_pair else GearTrain((), ratios, ())
    outputs = [Output(output.rotor, output.torque, output.at) for output in operation.output]
    speeds = {shaft: float(ratio) for shaft, ratio in ratios.items()}
    for output, taken in shared_torques(train, speeds, entering, outputs):
        against = -turning * math.copysign(1.0, ratios[output.shaft])
        applied.append(AppliedTorque(output.shaft, _station(case, output.shaft, output.at, 1.0), against * taken))
    return tuple(applied)


def pair_torques(case: Case) -> tuple[float, ...]:
    """Return the mean torque that each gear pair takes off its driver [N m], in the order of the file.

    Positive where power flows from driver to driven. Speeds fix the power through every pair of a tree; where pairs
    form a loop, the smallest flows that balance are taken, which is what equal contacts would carry.

    Raises
    ------
    CaseError
        When the case has no `[operation]`.
    """
    train = gear_train_of(case)
    turning = 1.0 if case.operation is None else math.copysign(1.0, case.operation.speed)
    torques = dict.fromkeys(train.ratios, 0.0)
    for applied in applied_torques(case):
        torques[applied.shaft] += applied.torque * turning * math.copysign(1.0, train.ratios[applied.shaft])
    return train.pair_torques(torques)


def _shafts(case: Case) -> list[str]:
    return [rotor.name for rotor in case.rotor] or [gear.name for gear in case.gear]


def _station(case: Case, shaft: str, at: float | None, default: float) -> float | None:
    """Return the station of a torque; by default at this fraction of the rotor's length."""
    if not case.rotor:
        return None
    return at if at is not None else default * case.rotor_named(shaft).length


BEYOND_OPERATION = 1.5
"""How far a Campbell diagram goes where no speeds are given, over the speed of operation."""

CAMPBELL_STEPS = 50
RESPONSE_STEPS = 300


def whirl_speeds(case: Case, rotor: str) -> tuple[float, ...]:
    """Return the speed of operation, then those of the sweep."""
    given = () if case.operation is None else (case.operation.speed,)
    return _turned(case, rotor, (*given, *(case.sweep.speeds if case.sweep else ())))


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
    if case.operation is None or case.operation.speed == 0.0:
        return ()
    (highest,) = _turned(case, rotor, (BEYOND_OPERATION * case.operation.speed,))
    low, high = table_range(case, rotor)
    if low >= abs(highest):
        return ()
    return _evenly(math.copysign(low, highest), math.copysign(min(high, abs(highest)), highest), CAMPBELL_STEPS)


def response_speeds(case: Case, rotor: str) -> tuple[float, ...]:
    """Return the speeds of the unbalance response: as given, else the range of the Campbell diagram in finer steps.

    From the slowest to the fastest, each once.
    """
    analysis = case.rotor_analysis
    if analysis is not None and analysis.unbalance_response.speed is not None:
        return tuple(sorted(set(_turned(case, rotor, listed(analysis.unbalance_response.speed))), key=abs))
    speeds = campbell_speeds(case, rotor)
    if len(speeds) < 2:
        return speeds
    return _evenly(min(speeds, key=abs), max(speeds, key=abs), RESPONSE_STEPS)


def table_range(case: Case, rotor: str) -> tuple[float, float]:
    """Return the lowest and the highest speed that the tables of all of a rotor's bearings hold, without their sense.

    Zero and infinity for bearings without tables.
    """
    tables = [bearing.speeds for bearing in case.bearing if bearing.rotor == rotor and bearing.speeds is not None]
    return max((table[0] for table in tables), default=0.0), min((table[-1] for table in tables), default=math.inf)


def _turned(case: Case, rotor: str, speeds: tuple[float, ...]) -> tuple[float, ...]:
    """Return speeds of the first driver's rotor as those of another; a rotor that nothing turns stands still."""
    ratio = float(speed_ratios(case).get(rotor, 0.0))
    return tuple(ratio * speed for speed in speeds)


def _evenly(first: float, last: float, steps: int) -> tuple[float, ...]:
    return (*(first + (last - first) * step / steps for step in range(steps)), last)
