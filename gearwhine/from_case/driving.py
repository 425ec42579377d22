"""Excitation of the machine of a case: speed profile, torques over time, ripple, base motion, gravity."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, TorqueLine, applied_torques, speed_ratios
from gearwhine.case.speeds_and_torques import gear_train_of
from gearwhine.coupling import SpeedProfile, Torque
from gearwhine.coupling.machine.components import RotorComponent
from gearwhine.coupling.machine.loads import AnyTorque, Drive, TorqueHistory, TorqueSlope
from gearwhine.coupling.machine.parts import Driving
from gearwhine.coupling.machine.speed_profile import free_speed

FloatArray = npt.NDArray[np.float64]

_ROUNDING = 1e-9  # part of the largest torque below which a sum of torques is rounding
_SLOPE_STEP = 1e-6  # part of the nominal speed to both sides of a corner of a torque line


@dataclass(frozen=True)
class CaseDriving(Driving):
    """Excitation of the machine of a case.

    Attributes
    ----------
    turning : SpeedProfile or None
        Speed over time; None where it is the nominal one all along.
    """

    turning: SpeedProfile | None = None


def driving(case: Case, rotors: Sequence[RotorComponent]) -> CaseDriving:
    """Speed profile, torques, base motion and gravity of a case with an operation.

    Raises
    ------
    gearwhine.coupling.TransientError
        Where a free speed cannot start or stalls.
    """
    operation = case.operation
    assert operation is not None
    nominal = abs(operation.speed)
    run = None if case.transient is None else case.transient.run
    shares = applied_torques(case, 1.0)
    turning = None
    if run is not None and run.free:
        assert operation.motor is not None
        motor, load = operation.motor, operation.load
        turning = free_speed(
            lambda speed: _torque(motor, speed),
            lambda speed: operation.torque if load is None else _torque(load, speed),
            train_inertia(case, rotors),
            start=run.line[1][0],
            duration=run.duration,
            nominal=nominal,
        )
    elif run is not None:
        times, speeds = (np.array(part) for part in run.line)
        turning = SpeedProfile(times, speeds / nominal)
    torques: list[AnyTorque] = []
    if turning is not None and run is not None and run.free and operation.load is not None:
        # The torque at the nominal speed is the mean load, about which meshes are linear and their load shuttles.
        mean = _torque(operation.load, nominal)
        torques += applied_torques(case, mean)
        beyond = np.array([_torque(operation.load, rate * nominal) for rate in turning.speed_ratios]) - mean
        torques += [_history(share, turning.times, beyond) for share in shares]
    else:
        torques += applied_torques(case)
    if run is not None and run.free:
        torques += _slopes(case, shares)
    torques += _variations(case, shares)
    drives = [Drive(shares[0].rotor, shares[0].at)] if shares else []
    # The nominal speed is among those at which the machine is assembled.
    rates = np.array([1.0, *(() if turning is None else turning.speed_ratios)])
    return CaseDriving(
        torques,
        drives,
        (float(rates.min()), float(rates.max())),
        None if operation.base is None else operation.base.build(),
        operation.gravity,
        turning,
    )


def unbalanced_torque(case: Case) -> float:
    """Largest torque that the histories `over_time` leave unbalanced in the train, at the first driver's rotor [N m].

    Where it is not zero the train as a whole turns away from its nominal rotation.
    """
    ratios = speed_ratios(case)
    shares = applied_torques(case, 1.0)
    histories = [one for one in _variations(case, shares) if isinstance(one, TorqueHistory)]
    if not shares or not histories:
        return 0.0
    first = float(ratios[shares[0].rotor])
    times = np.unique(np.concatenate([one.times for one in histories]))
    net = sum(np.interp(times, one.times, one.values) * float(ratios[one.rotor]) / first for one in histories)
    size = max(float(np.abs(one.values).max() * abs(float(ratios[one.rotor]) / first)) for one in histories)
    largest = float(np.abs(net).max())
    return largest if largest > _ROUNDING * size else 0.0


def train_inertia(case: Case, rotors: Sequence[RotorComponent]) -> float:
    """Polar inertia of the train, reduced to the first driver's rotor [kg m²]."""
    ratios = speed_ratios(case)
    shares = applied_torques(case, 1.0)
    rotating = set(ratios) if case.gear_pair else {shares[0].rotor}
    inertias = {rotor.name: float(np.sum(rotor.turning**2)) for rotor in rotors}
    first = float(ratios[shares[0].rotor])
    return sum(inertias[name] * (float(ratios[name]) / first) ** 2 for name in inertias if name in rotating)


def _torque(line: TorqueLine, speed: float) -> float:
    return float(np.interp(speed, line.speed, line.torque))


def _history(share: Torque, times: FloatArray, values: FloatArray) -> TorqueHistory:
    return TorqueHistory(share.rotor, share.at, times, share.value * values)


def _slopes(case: Case, shares: Sequence[Torque]) -> Iterator[TorqueSlope]:
    """Yield the slopes of the motor's and the load's torques over a shaft's deviation from its nominal rotation.

    A line's torque T(ω) at the first driver stands for a torque share T about z on a rotor of r times the speed, which
    changes by s T' share / |r| with the rotor's own speed about z: the share has the sense of rotation s of what drives
    the rotor, the opposite one of what brakes it.
    """
    operation = case.operation
    assert operation is not None
    train = gear_train_of(case)
    ratios = train.ratios
    first = abs(float(ratios[shares[0].rotor]))
    for number, share in enumerate(shares):
        line = operation.load if number else operation.motor
        if line is None:
            continue
        rates, slopes = _slope_table(line, abs(operation.speed))
        sense = train.rotation_sense(share.rotor, operation.speed)
        factor = sense * share.value * first / abs(float(ratios[share.rotor]))
        name = f"load on {share.rotor}, {number}" if number else "motor"
        yield TorqueSlope(name, share.rotor, share.at, rates, factor * slopes)


def _slope_table(line: TorqueLine, nominal: float) -> tuple[FloatArray, FloatArray]:
    """Return dT/dω of a piecewise linear torque, constant beyond its ends, on both sides of every corner."""
    corners = np.array(line.speed) / nominal
    steps = np.concatenate([[0.0], np.diff(line.torque) / np.diff(line.speed), [0.0]])
    hair = min(_SLOPE_STEP, 0.25 * float(np.diff(corners).min()))
    return np.column_stack([corners - hair, corners + hair]).ravel(), np.repeat(steps, 2)[1:-1]


def _variations(case: Case, shares: Sequence[Torque]) -> Iterator[AnyTorque]:
    """Yield the histories added to the torques and the ripple about them.

    They have the sense of a positive torque: of the input with the rotation of its shaft, of an output against that of
    its own, also where the output is negative and drives.
    """
    operation = case.operation
    assert operation is not None
    if shares:
        entering, leaving = shares[0], shares[1:]
    else:
        turning = math.copysign(1.0, operation.speed)
        entering, leaving = Torque(case.rotor[0].name, operation.at or 0.0, turning), ()
    output_histories = [output.over_time for output in operation.output]
    if operation.over_time is not None:
        yield operation.over_time.build(entering.rotor, entering.at, math.copysign(1.0, entering.value))
        if not any(output_histories):
            yield from (operation.over_time.build(share.rotor, share.at, share.value) for share in leaving)
    yield from (ripple.build(entering.rotor, entering.at, entering.value) for ripple in operation.ripple)
    train = gear_train_of(case)
    for output, share in zip(operation.output, leaving, strict=False):
        taken_off = -train.rotation_sense(share.rotor, operation.speed)
        if output.over_time is not None:
            yield output.over_time.build(share.rotor, share.at, taken_off)
        yield from (ripple.build(share.rotor, share.at, taken_off) for ripple in output.ripple)
