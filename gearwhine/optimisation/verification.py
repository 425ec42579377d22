"""Check of designs by the full machine: transients of the start and the proposed, beside lines of the linear machine.

An optimisation ranks by linear lines, by operating points or by gears alone. In the transient teeth part, runout and
unbalance act, and the record holds every frequency up to where the housing's modes are complete. Lines at a few speeds
may pass resonances by: start and proposed designs have them over the whole range, in steps that no mode of 1 % damping
fits between.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from gearwhine.coupling.analyses.loaded_machine import load_machine
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.analyses.transient import solve_transient
from gearwhine.coupling.linear.lines_over_speed import lines_over_speed, sensor_rms
from gearwhine.coupling.load_analysis.load_warnings import load_or_reason
from gearwhine.coupling.machine_description import Machine
from gearwhine.numerics.arrays import FloatArray
from gearwhine.solutions import Failure
from gearwhine.variation.quantities import level_of

Levels = Mapping[str, float]
Moving = tuple[Machine, TransientPlan, bool | None]
"""A machine, the stretch of its motion, and whether it needs an operating point, see
:func:`gearwhine.coupling.load_analysis.load_warnings.load_or_reason`."""
DOUBT = 1.0
"""Change of a level below which a design is neither louder nor quieter [dB]."""
MOST_SPEEDS = 6
"""Largest number of speeds of a transient."""
MOST_STEPS = 400
"""Largest number of speeds of lines over a range."""
_STEP = 0.01  # ratio of neighbouring speeds less 1: half the half-power width of a mode with 1 % of critical damping


@dataclass(frozen=True, eq=False)
class Motion:
    """A design by linear machine and transient, at the speeds of the check.

    Attributes
    ----------
    linear, motion : dict of str to float
        Highest level of each sensor over the speeds, of the mesh harmonics of the linear machine and of the transient
        [dB re 1 µm/s²].
    peak_force_ratio : dict of str to float
        Largest tooth force of each pair over its mean.
    contact_loss : dict of str to float
        Largest part of the time in which the flanks of a pair are apart.
    speeds : ndarray, shape (s,)
        Speeds over the whole range, without sense [rad/s]; empty where there is one speed, and of machines that are
        another one at each speed.
    over_speed : dict of str to ndarray, shape (s,)
        Levels of the linear machine at these, by sensor [dB re 1 µm/s²].
    """

    linear: Levels
    motion: Levels
    peak_force_ratio: Levels
    contact_loss: Levels
    speeds: FloatArray = field(default_factory=lambda: np.empty(0))
    over_speed: Mapping[str, FloatArray] = field(default_factory=dict)

    @property
    def highest(self) -> dict[str, tuple[float, float]]:
        """Highest level over the range, and the speed at which it is [rad/s], by sensor."""
        places = {sensor: int(np.argmax(levels)) for sensor, levels in self.over_speed.items()}
        return {sensor: (float(self.over_speed[sensor][at]), float(self.speeds[at])) for sensor, at in places.items()}


@dataclass(frozen=True, eq=False)
class Verification:
    """Start and proposed designs by the full machine.

    Attributes
    ----------
    speeds : tuple of float
        Signed speeds [rad/s].
    start : Motion or Failure
    designs : tuple of Motion or Failure
        The proposed designs, in the order of :attr:`gearwhine.optimisation.optimised.Optimised.chosen`.
    given : dict of str to tuple of float
        Level of each sensor by the given speeds alone, of the start and of the designs [dB re 1 µm/s²].
    """

    speeds: tuple[float, ...]
    start: Motion | Failure
    designs: tuple[Motion | Failure, ...]
    given: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    @property
    def passed_by(self) -> dict[str, tuple[tuple[float, float], ...]]:
        """Sensors that are louder between the given speeds: level at these, and over the range, of start and designs.

        Those at which any of them is louder by more than :data:`DOUBT`.
        """
        found = {}
        solved = [one for one in (self.start, *self.designs) if isinstance(one, Motion)]
        for sensor, given in self.given.items() if len(solved) == 1 + len(self.designs) else ():
            if all(sensor in one.over_speed for one in solved):
                levels = tuple(zip(given, (one.highest[sensor][0] for one in solved), strict=True))
                if any(highest > level + DOUBT for level, highest in levels):
                    found[sensor] = levels
        return found

    @property
    def contradicted(self) -> list[str]:
        """Sensors at which linear machine and transient disagree on whether a design is quieter than the start."""
        return list(dict.fromkeys(sensor for one in self.designs for sensor in self._contradicted(one)))

    def _contradicted(self, design: Motion | Failure) -> list[str]:
        if isinstance(self.start, Failure) or isinstance(design, Failure):
            return []
        changes = {
            sensor: (design.linear[sensor] - self.start.linear[sensor], design.motion[sensor] - level)
            for sensor, level in self.start.motion.items()
            if sensor in design.linear and sensor in self.start.linear
        }
        return [
            sensor
            for sensor, (linear, motion) in changes.items()
            if (linear < -DOUBT and motion > -0.25 * abs(linear)) or (linear > DOUBT and motion < 0.25 * linear)
        ]


def motion_of(
    machine: Machine,
    plan: TransientPlan,
    speeds: Sequence[float],
    over: Sequence[float] = (),
    *,
    needs_load: bool | None,
) -> Motion:
    """Solve the transient of a machine at some speeds, its lines there, and over the range of the speeds ``over``.

    Raises
    ------
    gearwhine.coupling.CouplingError, gearwhine.coupling.TransientError, ...
        Where the machine cannot be solved.
    """
    load = load_or_reason(machine, is_needed=needs_load)[0] if machine.is_loaded else None
    housing = machine.housing_component
    limit = None if housing is None else housing.complete_below
    linear, motion = dict[str, float](), dict[str, float]()
    force, loss = dict[str, float](), dict[str, float]()
    for speed in speeds:
        loaded = load_machine(replace(machine, speed=speed), None if load is None else load.point)
        solved = solve_transient(loaded.coupled, plan)
        if limit is not None:
            levels = level_of(sensor_rms(loaded.coupled, limit))
            for sensor, level in zip(loaded.coupled.sensor_rows, levels.tolist(), strict=True):
                linear[sensor] = max(level, linear.get(sensor, -math.inf))
        for sensor in solved.sensor_spectra:
            level = float(level_of(np.array(solved.sensor_rms(sensor))))
            motion[sensor] = max(level, motion.get(sensor, -math.inf))
        figures = solved.result
        for number, pair in enumerate(loaded.pairs):
            name = f"{pair.geometry.driver.name}-{pair.geometry.driven.name}"
            mean = float(figures.mean_force[number])
            ratio = float(figures.peak_force[number]) / mean if mean else math.nan
            force[name] = max(ratio, force.get(name, 0.0))
            loss[name] = max(float(figures.contact_loss[number]), loss.get(name, 0.0))
    fine, by_sensor = np.empty(0), dict[str, FloatArray]()
    tables = any(one.bearing.speeds is not None for one in machine.bearings)
    if limit is not None and not tables and len(set(map(abs, over))) > 1:
        coupled = load_machine(machine, None if load is None else load.point).coupled
        if not coupled.system.turns:
            fine = range_of(over)
            found = lines_over_speed(coupled, (np.sign(coupled.speed) * fine).tolist(), limit)
            by_sensor = dict(zip(found.sensors, level_of(found.rms), strict=True))
    return Motion(linear, motion, force, loss, fine, by_sensor)


def range_of(speeds: Sequence[float]) -> FloatArray:
    """Return speeds over the range of some, without sense and themselves among them, ascending [rad/s]."""
    given = np.unique(np.abs(speeds))
    count = min(math.ceil(math.log(given[-1] / given[0]) / math.log1p(_STEP)) + 1, MOST_STEPS)
    return np.unique(np.concatenate([given, np.geomspace(given[0], given[-1], count)[1:-1]]))


def checked_speeds(wanted: Sequence[float], loudest: Sequence[float]) -> tuple[float, ...]:
    """Return the speeds of the check: all, where they are few, else those at which a sensor is loudest.

    Parameters
    ----------
    wanted : sequence of float
        Signed speeds of the lines [rad/s].
    loudest : sequence of float
        Speeds at which sensors of start or best are loudest [rad/s], of any sign.
    """
    if len(wanted) <= MOST_SPEEDS:
        return tuple(wanted)
    near = [min(wanted, key=lambda speed: abs(abs(speed) - abs(one))) for one in loudest]
    return tuple(dict.fromkeys(near or wanted[-1:]))[:MOST_SPEEDS]
