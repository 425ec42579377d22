"""Operation, transient and sweep of a case: torques, the speed profile of a run, base motion, sampling.

Torques are constant, or vary over time and speed, with ripple. Base motion, `[operation.base]`, is the acceleration of
the ground. Attributes are named as the keys and are in SI: speeds in rad/s, frequencies in Hz.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import ConfigDict, Field, StrictBool, Tag, model_validator

from gearwhine.case import units
from gearwhine.case.fields import (
    MOST_ENTRIES,
    Angle,
    Force,
    LengthFromZero,
    ObjectTable,
    Point,
    PositiveFrequency,
    Quantity,
    RotorName,
    ShaftName,
    Speed,
    SpeedFromZero,
    Table,
    Whole,
    by_table,
    wrong,
)

if TYPE_CHECKING:
    from gearwhine.coupling import BaseMotion, GivenSpeed
    from gearwhine.coupling.analyses.recording import TransientPlan
    from gearwhine.coupling.analyses.run_up import OrderTracking as BuiltTracking
    from gearwhine.coupling.description.gear_train import GearTrain
    from gearwhine.coupling.description.gear_train import Output as BuiltOutput
    from gearwhine.coupling.machine.loads import Ripple, Torque, TorqueOverTime
    from gearwhine.coupling.machine.loads import ShaftForce as BuiltForce
    from gearwhine.coupling.machine.speed_profile import FreeRun, SpeedRun
    from gearwhine.coupling.machine.speed_profile import TorqueLine as BuiltLine

Time = Annotated[float, Quantity(units.TIME, at_least=0.0, at_most=1e6)]
PositiveTime = Annotated[float, Quantity(units.TIME, above=0.0, at_most=1e6)]
SignedTorque = Annotated[float, Quantity(units.TORQUE)]
Order = Annotated[float, Quantity(units.RATIO, above=0.0, at_most=1e4)]


class TorqueLine(ObjectTable):
    """A torque over the speed of the first driver's rotor [N m over rad/s]: linear between, constant beyond."""

    key_of_attribute: ClassVar = {"speeds": "speed", "torques": "torque"}

    speed: tuple[SpeedFromZero, ...] = Field(min_length=2, max_length=MOST_ENTRIES)
    """Ascending speeds of the first driver's rotor."""
    torque: tuple[SignedTorque, ...] = Field(max_length=MOST_ENTRIES)
    """Torque at each speed, linear between, constant beyond."""

    def build(self) -> BuiltLine:
        """Build the torque over speed."""
        from gearwhine.coupling.machine.speed_profile import TorqueLine as BuiltLine

        return BuiltLine(self.speed, self.torque)


class TorqueHistory(ObjectTable):
    """Torque added over time [N m over s]: linear between the times, constant beyond."""

    key_of_attribute: ClassVar = {"times": "time", "torques": "torque"}

    time: tuple[Time, ...] = Field(min_length=1, max_length=MOST_ENTRIES)
    """Ascending times."""
    torque: tuple[SignedTorque, ...] = Field(max_length=MOST_ENTRIES)
    """Torque at each time, linear between, constant beyond."""

    def build(self) -> TorqueOverTime:
        """Build the torque over time."""
        from gearwhine.coupling.machine.loads import TorqueOverTime

        return TorqueOverTime(self.time, self.torque)


class TorqueRipple(ObjectTable):
    """Harmonic ripple of a torque: amplitude [N m], phase [rad], and an order of its shaft or a frequency [Hz]."""

    amplitude: SignedTorque
    """Amplitude, zero to peak."""
    phase: Angle = 0.0
    """Phase."""
    order: Order | None = None
    """Cycles per revolution of its shaft. One of this and `frequency`."""
    frequency: PositiveFrequency | None = None
    """Frequency. One of this and `order`."""

    def build(self) -> Ripple:
        """Build the ripple."""
        from gearwhine.coupling.machine.loads import Ripple

        frequency = None if self.frequency is None else 2.0 * math.pi * self.frequency
        return Ripple(self.amplitude, self.phase, self.order, frequency)


class OrderTracking(Table):
    """`[transient.run.orders]`: windows of the order cuts along a run, by revolutions of the first driver's rotor."""

    window: Literal["hann", "uniform"] = "hann"
    """Weights of a window's samples."""
    resolution: Annotated[float, Quantity(units.RATIO, at_least=1e-3, at_most=1.0)] | None = None
    """Spacing of the orders that a window tells apart: it is as many revolutions long as the inverse, rounded up.
    Default: as fine as the orders of shafts and meshes need, as far as the run has revolutions for it."""
    overlap: Annotated[float, Quantity(units.RATIO, at_least=0.0, at_most=0.99)] = 0.9
    """Part of a window that the next one shares. There are at most 400 windows."""

    def build(self) -> BuiltTracking:
        """Build the windows."""
        from gearwhine.coupling.analyses.run_up import OrderTracking as BuiltTracking

        return BuiltTracking(self.window, self.resolution, self.overlap)


class Run(Table):
    """`[transient.run]`: how the speed of the first driver's rotor varies, in the sense of `[operation] speed`.

    From a speed to another in a time; by speeds at times; or free from the first speed on, the motor against the load.
    """

    model_config = ConfigDict(serialize_by_alias=True)

    start: SpeedFromZero | None = Field(default=None, alias="from")
    """Speed at the start."""
    to: SpeedFromZero | None = None
    """Speed at the end. Default: the speed is free, and follows from `motor` and load."""
    time: PositiveTime | None = None
    """Duration."""
    times: tuple[Time, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Ascending times from 0 s on, with `speeds`; in place of `from`, `to` and `time`."""
    speeds: tuple[SpeedFromZero, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Speed at each time, linear between."""
    orders: OrderTracking = OrderTracking()
    """Windows of the order cuts."""

    @model_validator(mode="after")
    def _one_form(self) -> Run:
        if not (self.times or self.speeds):
            for key, value, expected in (("from", self.start, "a speed to start from"), ("time", self.time, "a time")):
                if value is None:
                    raise wrong(f"{expected}, or a table of 'times' and 'speeds'", key)
            if self.to == 0.0 == self.start:
                raise wrong("a speed other than zero at one end", "to")
            return self
        for key, value in (("from", self.start), ("to", self.to), ("time", self.time)):
            if value is not None:
                raise wrong("no such key beside 'times' and 'speeds'", key)
        _check_table("times", self.times, "speeds", self.speeds)
        if len(self.times) < 2 or self.times[0] != 0.0:
            raise wrong("two times or more, the first of them 0 s", "times")
        if not any(self.speeds):
            raise wrong("a speed other than zero", "speeds")
        return self

    @property
    def free(self) -> bool:
        """Whether the speed follows from the motor and the load."""
        return not self.times and self.to is None

    @property
    def duration(self) -> float:
        """Duration of the run [s]."""
        return self.times[-1] if self.time is None else self.time

    def build(self) -> SpeedRun | FreeRun:
        """Build the run of the machine."""
        from gearwhine.coupling.machine.speed_profile import FreeRun, SpeedRun

        times, speeds = self.line
        return FreeRun(speeds[0], self.duration) if self.free else SpeedRun(times, speeds)

    @property
    def line(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Times [s] and speeds [rad/s] between which the speed is linear; of a free run its start alone."""
        if self.times or self.start is None:
            return self.times, self.speeds
        if self.to is None:
            return (0.0,), (self.start,)
        return (0.0, self.duration), (self.start, self.to)


def _check_table(key: str, places: tuple[float, ...], other_key: str, values: tuple[float, ...]) -> None:
    """Raise for a table that does not ascend, or whose lists differ in length."""
    if len(values) != len(places):
        raise wrong(f"one value for each entry of '{key}', {len(places)} (there are {len(values)})", other_key)
    if any(after <= before for before, after in pairwise(places)):
        raise wrong("entries that ascend", key)


COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")

Acceleration = Annotated[float, Quantity(units.ACCELERATION, at_least=-1e4, at_most=1e4)]
AngularAcceleration = Annotated[float, Quantity(units.ANGULAR_ACCELERATION, at_least=-1e4, at_most=1e4)]
Accelerations = Annotated[tuple[Acceleration, ...], Field(max_length=MOST_ENTRIES)]
AngularAccelerations = Annotated[tuple[AngularAcceleration, ...], Field(max_length=MOST_ENTRIES)]


class BaseHarmonic(Table):
    """Accelerations along and about x, y, z [m/s², rad/s²] that swing at a frequency [Hz], ahead by a phase [rad]."""

    frequency: PositiveFrequency
    """Frequency."""
    x: Acceleration = 0.0
    """Amplitude of the acceleration along x."""
    y: Acceleration = 0.0
    """Amplitude of the acceleration along y."""
    z: Acceleration = 0.0
    """Amplitude of the acceleration along z."""
    rx: AngularAcceleration = 0.0
    """Amplitude of the angular acceleration about x, not with a run."""
    ry: AngularAcceleration = 0.0
    """Amplitude of the angular acceleration about y, not with a run."""
    rz: AngularAcceleration = 0.0
    """Amplitude of the angular acceleration about z."""
    phase: Angle = 0.0
    """Phase."""

    @property
    def amplitudes(self) -> tuple[float, ...]:
        """Amplitudes of x, y, z, rx, ry, rz."""
        return tuple(getattr(self, name) for name in COMPONENTS)


class BaseHistory(Table):
    """Accelerations over time [s], a list for each component that moves: linear between, constant beyond."""

    time: tuple[Time, ...] = Field(min_length=1, max_length=MOST_ENTRIES)
    """Ascending times."""
    x: Accelerations = ()
    """Acceleration at each time along x."""
    y: Accelerations = ()
    """Acceleration at each time along y."""
    z: Accelerations = ()
    """Acceleration at each time along z."""
    rx: AngularAccelerations = ()
    """Angular acceleration at each time about x, not with a run."""
    ry: AngularAccelerations = ()
    """Angular acceleration at each time about y, not with a run."""
    rz: AngularAccelerations = ()
    """Angular acceleration at each time about z."""

    @model_validator(mode="after")
    def _of_one_length(self) -> BaseHistory:
        if any(after <= before for before, after in pairwise(self.time)):
            raise wrong("times that ascend", "time")
        for name in COMPONENTS:
            count = len(getattr(self, name))
            if count not in (0, len(self.time)):
                raise wrong(f"one value for each of the {len(self.time)} times (there are {count})", name)
        return self

    @property
    def rows(self) -> tuple[tuple[float, ...], ...]:
        """Lists of x, y, z, rx, ry, rz, zeros where there is none."""
        return tuple(getattr(self, name) or (0.0,) * len(self.time) for name in COMPONENTS)


class Base(Table):
    """`[operation.base]`: how the ground moves at a point of it [m] and about axes through this point."""

    point: Point = (0.0, 0.0, 0.0)
    """Point of the ground that the accelerations are of."""
    harmonic: tuple[BaseHarmonic, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Harmonic accelerations."""
    over_time: BaseHistory | None = None
    """Accelerations over time."""

    @property
    def tilts(self) -> bool:
        """Whether it turns about x or y."""
        rows = [harmonic.amplitudes for harmonic in self.harmonic]
        turning = any(row[3] or row[4] for row in rows)
        return turning or (self.over_time is not None and any(map(any, self.over_time.rows[3:5])))

    def build(self) -> BaseMotion:
        """Build the base motion, the acceleration of the ground."""
        import numpy as np

        from gearwhine.coupling import BaseMotion
        from gearwhine.coupling.machine.base_motion import BaseHarmonic as BuiltHarmonic
        from gearwhine.coupling.machine.base_motion import BaseHistory as BuiltHistory

        parts: list[BuiltHarmonic | BuiltHistory] = [
            BuiltHarmonic(
                2.0 * math.pi * harmonic.frequency, np.array(harmonic.amplitudes) * np.exp(1j * harmonic.phase)
            )
            for harmonic in self.harmonic
        ]
        if self.over_time is not None:
            parts.append(BuiltHistory(np.array(self.over_time.time), np.array(self.over_time.rows).T))
        return BaseMotion(tuple(parts), self.point)


class Output(Table):
    """`[[operation.output]]`: a torque taken off a rotor [N m], at a station [m]; None: its right end."""

    rotor: ShaftName
    """Name of the rotor."""
    torque: SignedTorque
    """Torque taken off; negative where the machine coasts, or a second motor drives this rotor."""
    at: LengthFromZero | None = None
    """Station on the rotor. Default: the right end."""
    over_time: TorqueHistory | None = None
    """Torque taken off besides, over time. Default: its share of the input's."""
    ripple: tuple[TorqueRipple, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Harmonic parts of the torque taken off."""

    def build(self) -> BuiltOutput:
        """Build the output torque of the gear train."""
        from gearwhine.coupling.description.gear_train import Output as BuiltOutput

        history = None if self.over_time is None else self.over_time.build()
        return BuiltOutput(self.rotor, self.torque, self.at, history, [ripple.build() for ripple in self.ripple])


class Drive(Table):
    """`[[operation.drive]]`: a further rotor that turns at a given speed [rad/s]."""

    rotor: RotorName
    """Name of the rotor."""
    speed: Speed
    """Speed, positive counter-clockwise seen from +z; that of the first driver is `[operation] speed`."""
    at: LengthFromZero | None = None
    """Station of its torque on the rotor. Default: the right end."""

    def build(self) -> GivenSpeed:
        """Build the drive of the gear train."""
        from gearwhine.coupling import GivenSpeed

        return GivenSpeed(self.rotor, self.speed, self.at)


class ShaftForce(Table):
    """`[[operation.force]]`: a constant force on a rotor [N], at a station [m], such as the pull of a belt."""

    rotor: RotorName
    """Name of the rotor."""
    at: LengthFromZero
    """Station from the rotor's left end."""
    x: Force = 0.0
    """Force along x."""
    y: Force = 0.0
    """Force along y."""
    z: Force = 0.0
    """Force along z."""

    def build(self) -> BuiltForce:
        """Build the force on the shaft."""
        from gearwhine.coupling.machine.loads import ShaftForce as BuiltForce

        return BuiltForce(self.rotor, self.at, (self.x, self.y, self.z))


class Operation(Table):
    """`[operation]`: speed [rad/s] and torque [N m] of the first driver's rotor."""

    speed: Speed
    """Speed of the first driver's rotor, positive counter-clockwise seen from +z."""
    rotor: RotorName | None = None
    """Rotor that turns at `speed` and takes `torque` in. Default: that of the first `gear_pair`'s driver, or where this
    one is held or a planet, its carrier."""
    torque: SignedTorque = 0.0
    """Torque on the first driver's rotor in the direction of rotation. A negative one brakes: every pair then starts on
    its back flanks, for which it needs a `backlash`."""
    at: LengthFromZero | None = None
    """Station of the torque on its rotor. Default: the left end."""
    over_time: TorqueHistory | None = None
    """Torque added over time; the outputs share it in their proportions, unless one has its own."""
    ripple: tuple[TorqueRipple, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Harmonic parts of the torque."""
    motor: TorqueLine | None = None
    """Driving torque over speed, of a run whose speed is free."""
    load: TorqueLine | None = None
    """Torque over speed that the outputs take in all, at the first driver's rotor. Default: `torque` at any speed."""
    base: Base | None = None
    """Motion of the ground. Sensors then show their acceleration in space."""
    gravity: tuple[Acceleration, Acceleration, Acceleration] | None = None
    """Acceleration of gravity along x, y, z. Default: none."""
    output: tuple[Output, ...] = Field(default=(), max_length=1000)
    """Torques taken off, in proportion to `torque`, without which none can be given. Default: the rotors that drive no
    other share the power equally."""
    drive: tuple[Drive, ...] = Field(default=(), max_length=1000)
    """Further rotors of given speed, as the second input of a differential; their torques follow from the balance."""
    force: tuple[ShaftForce, ...] = Field(default=(), max_length=1000)
    """Constant forces on the shafts, such as the pull of a belt."""

    def applied_torques(self, train: GearTrain, lengths: Mapping[str, float]) -> tuple[Torque, ...]:
        """Return the torques from outside: the input first, then the outputs. They balance through the gears.

        Parameters
        ----------
        train : GearTrain
        lengths : mapping of str to float
            Length of each shaft [m]: the default station of an output; 0 for shafts that are not there.
        """
        outputs = [output.build() for output in self.output]
        ends = dict.fromkeys(train.ratios, 0.0) | dict(lengths)
        given = [drive.build() for drive in self.drive]
        return train.applied_torques(self.torque, self.speed, outputs, self.at or 0.0, ends=ends, given=given)

    def loaded_rotors(self, names: Iterable[str], *, geared: bool) -> frozenset[str]:
        """Return the rotors that gear pairs, weight or forces load across their axis or along it."""
        if geared or (self.gravity is not None and any(self.gravity)):
            return frozenset(names)
        return frozenset(force.rotor for force in self.force if force.x or force.y or force.z)


def _half_the_run(data: dict[str, Any]) -> float:
    return float(data.get("revolutions") or 0.0) / 2.0


class Transient(ObjectTable):
    """`[transient]`: revolutions of the first driver's rotor, those discarded, and the steps."""

    revolutions: Annotated[float, Quantity(units.RATIO, above=0.0, at_most=1e6)] | None = None
    """Revolutions of the first driver's rotor. One of this and `run`. Lines at a steady speed are sharpest where the
    record, these less `discard`, holds whole turns of all shafts but planets: multiples of 19 where a carrier is slower
    by 19/4, and one more for the filter of a long record. Else they are taken under a window, which spreads each over
    its neighbours."""
    run: Run | None = None
    """Run-up, run-down or free run, in place of `revolutions`."""
    discard: Annotated[float, Quantity(units.RATIO, at_least=0.0)] = Field(default_factory=_half_the_run)
    """Revolutions before spectra are taken. Default: half of them; of a run 0."""
    points_per_revolution: Annotated[int, Whole(200, 1_000_000)] = 200
    """Least number of recorded points of each revolution, raised to a power of two; no step is longer than one of them
    would be."""
    tolerance: Annotated[float, Quantity(units.RATIO, above=0.0, at_most=0.1)] = 5e-4
    """Relative tolerance of the steps. At the default the five highest lines of a sensor were within 2.5 % and those of
    a mesh force within 0.1 % of those at 1e-5, on two bundled cases; 1e-3 takes 0.7 of the steps for 5 %, 1e-4 twice
    the steps for 0.6 %."""
    start: Literal["equilibrium", "unloaded"] = "equilibrium"
    """"equilibrium" under the load; or "unloaded": straight shafts, teeth that just touch and a load that is applied at
    once, so that the record shows free vibrations."""
    method: Literal["newmark", "exact", "auto"] = "newmark"
    """"newmark"; "exact", the integration from tooth event to tooth event at constant speed; or "auto", exact where
    that applies. On four bundled cases "exact" took 0.7 to
    1.3 times the processor time of "newmark" at the default tolerance, with the five highest lines of a mesh force
    within 0.02 % in place of 0.5 %; of a lightly damped pair (`damping_ratio = 0.01` at 2500 rpm) 1.4 s for 0.001 %,
    where "newmark" takes 2.5 s for 1.9 % and 16 s for 0.015 %."""
    modal_coordinates: Annotated[int, Whole(0, 1000)] = 0
    """Number of each rotor's torsional and bending modes, and of the housing's, to record and draw in time and
    frequency."""
    indicators: StrictBool = False
    """Condition indicators of gears and bearings at the sensors. Default: where a tooth or a bearing is damaged."""

    def build(self) -> TransientPlan:
        """Build the plan of the transient."""
        from gearwhine.coupling.analyses.recording import TransientPlan

        return TransientPlan(
            self.revolutions,
            None if self.run is None else self.run.build(),
            self.discard,
            self.points_per_revolution,
            self.tolerance,
            self.start,
            self.method,
            self.modal_coordinates,
            self.indicators,
        )


class SpeedRange(Table):
    """Speeds from `start` (key `from`) to `to` by `step` [rad/s], both ends included."""

    model_config = ConfigDict(serialize_by_alias=True)

    start: SpeedFromZero = Field(alias="from")
    """First speed."""
    to: SpeedFromZero
    """Last speed, included."""
    step: Speed
    """Step, negative downwards."""

    @model_validator(mode="after")
    def _leads_there(self) -> SpeedRange:
        span = self.to - self.start
        if self.step == 0.0 or span * self.step < 0.0:
            raise wrong("a step that leads from 'from' to 'to'", "step")
        if span / self.step > MOST_ENTRIES:
            raise wrong(f"a step that makes at most {MOST_ENTRIES} speeds", "step")
        return self


Speeds = Annotated[
    Annotated[SpeedRange, Tag("~table")]
    | Annotated[tuple[SpeedFromZero, ...], Tag("~list"), Field(min_length=1, max_length=MOST_ENTRIES)],
    by_table("~list"),
]
"""Speeds as a range or as a list [rad/s]."""


def listed(speeds: SpeedRange | tuple[float, ...]) -> tuple[float, ...]:
    """Return every speed of a range or list [rad/s], in order."""
    if not isinstance(speeds, SpeedRange):
        return speeds
    count = math.floor((speeds.to - speeds.start) / speeds.step + 1e-9) + 1
    return tuple(speeds.start + index * speeds.step for index in range(count))


class Sweep(Table):
    """`[sweep]`: the speeds to go through, as a range or a list."""

    speed: Speeds
    """Speeds of the first driver's rotor, in the sense of `[operation] speed`: a list or a range."""

    @property
    def speeds(self) -> tuple[float, ...]:
        """Every speed of the sweep [rad/s], in order."""
        return listed(self.speed)
