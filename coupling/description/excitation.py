"""Excitation of a machine beside its mean torques: torques over time and over speed, ripple, run-ups, base, gravity.

A machine has a mean speed and mean torques. What varies about them is given by the objects of this module, with the
sense of a positive torque: of the input with the rotation of its shaft, of an output against that of its own, also
where the output is negative and drives. :func:`machine_driving` turns them into torques about z of single shafts.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from gearwhine.coupling.description.gear_train import GearTrain, Output
from gearwhine.coupling.description.parts import Shaft
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.base_motion import BaseMotion
from gearwhine.coupling.machine.components import RotorComponent
from gearwhine.coupling.machine.loads import (
    AnyTorque,
    Drive,
    Ripple,
    Torque,
    TorqueHistory,
    TorqueOverTime,
    TorqueSlope,
)
from gearwhine.coupling.machine.rotating_inertia import rotating_inertia
from gearwhine.coupling.machine.speed_profile import FreeRun, SpeedProfile, SpeedRun, TorqueLine, free_speed
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.own_copies import keep_tuples

Run = SpeedRun | FreeRun

_TORQUE_ROUNDING = 1e-9  # part of the largest torque below which a sum of torques is rounding
_SLOPE_STEP = 1e-6  # part of the nominal speed to both sides of a corner of a torque line


class ExcitedMachine(Protocol):
    """The parts of a machine that its excitation needs, see :class:`gearwhine.coupling.Machine`."""

    @property
    def shafts(self) -> Sequence[Shaft]:
        """Shafts of the machine."""
        ...

    @property
    def train(self) -> GearTrain:
        """Gear train."""
        ...

    @property
    def speed(self) -> float:
        """Speed of the first driver's shaft [rad/s]."""
        ...

    @property
    def torque(self) -> float:
        """Mean input torque [N m]."""
        ...

    @property
    def torque_at(self) -> float:
        """Station of the input torque [m]."""
        ...

    @property
    def outputs(self) -> Sequence[Output]:
        """Outputs."""
        ...

    @property
    def torque_over_time(self) -> TorqueOverTime | None:
        """Input torque added over time."""
        ...

    @property
    def ripple(self) -> Sequence[Ripple]:
        """Ripple of the input torque."""
        ...

    @property
    def motor(self) -> TorqueLine | None:
        """Input torque over speed."""
        ...

    @property
    def load(self) -> TorqueLine | None:
        """Torque over speed that the outputs take."""
        ...

    @property
    def base(self) -> BaseMotion | None:
        """Motion of the ground."""
        ...

    @property
    def gravity(self) -> Sequence[float] | None:
        """Acceleration of free fall [m/s²]."""
        ...

    def torques_from_outside(self, torque: float) -> tuple[Torque, ...]:
        """Torques about z by an input torque [N m]."""
        ...


@dataclass(frozen=True)
class Driving:
    """Excitation of a machine, on its shafts.

    Attributes
    ----------
    torques : sequence of AnyTorque
        Torques with stations on their shafts.
    drives : sequence of Drive
        Stations of the torques that accelerate a train.
    speed_range : tuple of float
        Lowest and highest speed of the run, as parts of the machine's speed.
    base : BaseMotion, optional
        Motion of the ground.
    gravity : sequence of float, optional
        Acceleration of free fall along x, y, z [m/s²].
    speed_profile : SpeedProfile, optional
        Speed over time; None where it is the nominal one all along.
    """

    torques: Sequence[AnyTorque] = ()
    drives: Sequence[Drive] = ()
    speed_range: tuple[float, float] = (1.0, 1.0)
    base: BaseMotion | None = None
    gravity: Sequence[float] | None = None
    speed_profile: SpeedProfile | None = None

    def __post_init__(self) -> None:
        """Keep own copies."""
        keep_tuples(self, "torques", "drives", "speed_range", "gravity")


def machine_driving(machine: ExcitedMachine, rotors: Sequence[RotorComponent], run: Run | None = None) -> Driving:
    """Return the torques of a machine on its shafts, and its speed over time.

    Parameters
    ----------
    machine : ExcitedMachine
    rotors : sequence of RotorComponent
        Its shafts, of whose inertia a free speed follows.
    run : SpeedRun or FreeRun, optional
        Speed over time; constant by default.

    Raises
    ------
    CouplingError
        Where a free run has no motor.
    TransientError
        Where a free speed cannot start or stalls.
    """
    nominal, load = abs(machine.speed), machine.load
    shares = machine.torques_from_outside(1.0)
    profile = _speed_profile(machine, rotors, run, shares)
    torques: list[AnyTorque] = []
    if isinstance(run, FreeRun) and profile is not None and load is not None:
        # The torque at the nominal speed is the mean load, about which meshes are linear and their load shuttles.
        mean = load.at(nominal)
        torques += machine.torques_from_outside(mean)
        beyond = np.array([load.at(rate * nominal) for rate in profile.speed_ratios]) - mean
        torques += [TorqueHistory(share.rotor, share.at, profile.times, share.value * beyond) for share in shares]
    else:
        torques += machine.torques_from_outside(machine.torque)
    if isinstance(run, FreeRun):
        torques += _slopes(machine, shares)
    torques += _variations(machine, shares)
    drives = [Drive(shares[0].rotor, shares[0].at)] if shares else []
    # The nominal speed is among those at which the machine is assembled.
    rates = np.array([1.0, *(() if profile is None else profile.speed_ratios)])
    speed_range = float(rates.min()), float(rates.max())
    return Driving(torques, drives, speed_range, machine.base, machine.gravity, profile)


def unbalanced_torque(machine: ExcitedMachine) -> float:
    """Largest torque that the histories over time leave unbalanced in the train, at the first driver's shaft [N m].

    Where it is not zero the train as a whole turns away from its nominal rotation.
    """
    ratios = machine.train.ratios
    shares = machine.torques_from_outside(1.0)
    histories = [one for one in _variations(machine, shares) if isinstance(one, TorqueHistory)]
    if not shares or not histories:
        return 0.0
    first = float(ratios[shares[0].rotor])
    times = np.unique(np.concatenate([one.times for one in histories]))
    net = sum(np.interp(times, one.times, one.values) * float(ratios[one.rotor]) / first for one in histories)
    size = max(float(np.abs(one.values).max() * abs(float(ratios[one.rotor]) / first)) for one in histories)
    largest = float(np.abs(net).max())
    return largest if largest > _TORQUE_ROUNDING * size else 0.0


def train_inertia(train: GearTrain, rotors: Sequence[RotorComponent], first: str) -> float:
    """Polar inertia of the shafts that turn with the first driver's, reduced to that one [kg m²].

    Without gear pairs that shaft turns alone.
    """
    rotating = set(train.ratios) if train.pairs else {first}
    ratio = float(train.ratios[first])
    return rotating_inertia(rotors, {name: float(train.ratios[name]) / ratio for name in rotating})


def _speed_profile(
    machine: ExcitedMachine, rotors: Sequence[RotorComponent], run: Run | None, shares: Sequence[Torque]
) -> SpeedProfile | None:
    """Return the speed over time of a run; None at constant speed."""
    nominal, load = abs(machine.speed), machine.load
    if run is None:
        return None
    if isinstance(run, SpeedRun):
        return SpeedProfile(np.array(run.times), np.array(run.speeds) / nominal)
    if machine.motor is None or not shares:
        raise CouplingError("a free run without a motor; expected `motor`, a torque over speed, and what it drives")
    return free_speed(
        machine.motor.at,
        lambda speed: machine.torque if load is None else load.at(speed),
        train_inertia(machine.train, rotors, shares[0].rotor),
        start=run.start,
        duration=run.duration,
        nominal=nominal,
    )


def _slopes(machine: ExcitedMachine, shares: Sequence[Torque]) -> Iterator[TorqueSlope]:
    """Yield the slopes of the motor's and the load's torques over a shaft's deviation from its nominal rotation.

    A line's torque T(ω) at the first driver stands for a torque share T about z on a shaft of r times the speed, which
    changes by s T' share / |r| with the shaft's own speed about z: the share has the sense of rotation s of what drives
    the shaft, the opposite one of what brakes it.
    """
    ratios = machine.train.ratios
    first = abs(float(ratios[shares[0].rotor]))
    for number, share in enumerate(shares):
        line = machine.load if number else machine.motor
        if line is None:
            continue
        rates, slopes = _slope_table(line, abs(machine.speed))
        sense = machine.train.rotation_sense(share.rotor, machine.speed)
        factor = sense * share.value * first / abs(float(ratios[share.rotor]))
        name = f"load on {share.rotor}, {number}" if number else "motor"
        yield TorqueSlope(name, share.rotor, share.at, rates, factor * slopes)


def _slope_table(line: TorqueLine, nominal: float) -> tuple[FloatArray, FloatArray]:
    """Return dT/dω of a piecewise linear torque, constant beyond its ends, on both sides of every corner."""
    corners = np.array(line.speeds) / nominal
    steps = np.concatenate([[0.0], np.diff(line.torques) / np.diff(line.speeds), [0.0]])
    hair = min(_SLOPE_STEP, 0.25 * float(np.diff(corners).min()))
    return np.column_stack([corners - hair, corners + hair]).ravel(), np.repeat(steps, 2)[1:-1]


def _variations(machine: ExcitedMachine, shares: Sequence[Torque]) -> Iterator[AnyTorque]:
    """Yield the histories added to the torques and the ripple about them."""
    if shares:
        entering, leaving = shares[0], shares[1:]
    else:
        turning = math.copysign(1.0, machine.speed)
        entering, leaving = Torque(machine.shafts[0].name, machine.torque_at, turning), ()
    history = machine.torque_over_time
    if history is not None:
        yield history.on(entering.rotor, entering.at, math.copysign(1.0, entering.value))
        if not any(output.over_time for output in machine.outputs):
            yield from (history.on(share.rotor, share.at, share.value) for share in leaving)
    yield from (ripple.on(entering.rotor, entering.at, entering.value) for ripple in machine.ripple)
    for output, share in zip(machine.outputs, leaving, strict=False):
        taken_off = -machine.train.rotation_sense(share.rotor, machine.speed)
        if output.over_time is not None:
            yield output.over_time.on(share.rotor, share.at, taken_off)
        yield from (ripple.on(share.rotor, share.at, taken_off) for ripple in output.ripple)
