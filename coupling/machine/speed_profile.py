"""Speed profile of a run-up: speed over time, and rotation angle as time at the nominal speeds.

Mesh phases, runout, unbalance and gyroscopic terms are written for steady nominal speeds. A machine that runs up or
down turns through the same angles at other times. Its *nominal time* s(t) is the time in which the machine at nominal
speeds would turn through the same angle, so that all functions of the angle are functions of s, and

    s'  is the speed and  s''  the angular acceleration, as parts of the nominal speed.

At steady nominal speed s = t. The speed is piecewise linear here, s piecewise quadratic: angles, and the times at
which the teeth come into contact and leave it, are exact.

The free speed of a machine is the run-up of the rigid train under motor and load torque. The nominal rotation, about
which the coordinates move, is that of the rigid train,

    J dω/dt = T_motor(ω) - T_load(ω),

J = Σ J_r (ω_r/ω)² at the first driver's rotor. Where a shaft is a little faster or slower than its nominal rotation,
the torques change by their slope over speed: :class:`gearwhine.coupling.machine.loads.TorqueSlope`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError, TransientError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Number, attribute_findings, refuse, table_findings
from gearwhine.numerics.own_copies import keep_tuples


@dataclass(frozen=True)
class SpeedProfile:
    """Speed over time, relative to the nominal one; linear between k times, and constant before and after them.

    Attributes
    ----------
    times : ndarray, shape (k,)
        Times [s], ascending.
    speed_ratios : ndarray, shape (k,)
        Relative speeds s', not negative: reversed rotation would load the other flanks.
    """

    times: FloatArray
    speed_ratios: FloatArray

    def __post_init__(self) -> None:
        """Require finite speeds of one sense, one for each time, and times that ascend."""
        if self.times.ndim != 1 or self.times.shape != self.speed_ratios.shape or not self.times.size:
            raise CouplingError(
                f"speeds of shape {self.speed_ratios.shape} at times of shape {self.times.shape}; expected as many"
            )
        if not (np.all(np.isfinite(self.times)) and np.all(np.isfinite(self.speed_ratios))):
            raise CouplingError("a speed over time that is not finite")
        if np.any(np.diff(self.times) <= 0.0):
            raise CouplingError("the times of a speed over time do not ascend")
        if np.any(self.speed_ratios < 0.0):
            raise CouplingError("a speed over time changes its sign; expected one sense of rotation")

    @staticmethod
    def steady() -> "SpeedProfile":
        """Constant nominal speeds."""
        return SpeedProfile(np.zeros(1), np.ones(1))

    @property
    def is_steady(self) -> bool:
        """Whether the speeds are the nominal ones at all times."""
        return bool(np.all(self.speed_ratios == 1.0))

    @cached_property
    def _pieces(self) -> FloatArray:
        """Rows t, s, s' and s'' at the start of each interval; the first interval begins in the infinite past."""
        gaps = np.diff(self.times)
        slopes = np.concatenate([[0.0], np.diff(self.speed_ratios) / gaps, [0.0]])
        nominal_time = np.concatenate([[0.0], np.cumsum(0.5 * (self.speed_ratios[1:] + self.speed_ratios[:-1]) * gaps)])
        begins = np.concatenate([self.times[:1], self.times])
        pieces = np.column_stack(
            [
                begins,
                np.concatenate([nominal_time[:1], nominal_time]),
                np.concatenate([self.speed_ratios[:1], self.speed_ratios]),
                slopes,
            ]
        )
        # s = 0 at t = 0.
        pieces[:, 1] -= self._through(pieces, np.zeros(1))[0][0]
        return np.asarray(pieces)

    def _through(self, pieces: FloatArray, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        rows = pieces[np.searchsorted(self.times, times, side="right")]
        after = times - rows[:, 0]
        return rows[:, 1] + after * (rows[:, 2] + 0.5 * rows[:, 3] * after), rows[:, 2] + rows[:, 3] * after, rows[:, 3]

    def at(self, times: npt.ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Evaluate s [s], s' and s'' [1/s] just after times (m,) [s], shape (m,) each."""
        return self._through(self._pieces, np.atleast_1d(np.asarray(times, dtype=np.float64)))

    def times_of(self, nominal_time: FloatArray) -> FloatArray:
        """Return times at which the nominal time has given values [s], NaN where it never has, shape (m,)."""
        pieces = self._pieces
        rows = pieces[1:][np.maximum(np.searchsorted(pieces[1:, 1], nominal_time, side="right") - 1, 0)]
        rows = np.where((nominal_time < pieces[1, 1])[:, None], pieces[0], rows)
        far = nominal_time - rows[:, 1]
        with np.errstate(invalid="ignore", divide="ignore"):
            # The root of a quadratic in the form that loses no digits where the speed hardly changes.
            root = np.sqrt(rows[:, 2] ** 2 + 2.0 * rows[:, 3] * far)
            after = np.where(far == 0.0, 0.0, 2.0 * far / (rows[:, 2] + root))
        return np.asarray(np.where(np.isfinite(after), rows[:, 0] + after, np.nan))


@dataclass(frozen=True)
class SpeedRun:
    """Run of a machine through given speeds.

    Attributes
    ----------
    times : sequence of float
        Ascending times, two or more, the first of them 0 [s].
    speeds : sequence of float
        Speed of the first driver's shaft at each time without its sense [rad/s]; linear between.
    """

    times: Sequence[float]
    speeds: Sequence[float]

    def __post_init__(self) -> None:
        """Keep own copies; require a speed for each time, times that ascend from 0, and a machine that turns."""
        keep_tuples(self, "times", "speeds")
        speeds = Number(at_least=0.0, unit="rad/s")
        refuse(table_findings(("run", ""), self, "times", "speeds", least=2, values_are=speeds), CouplingError)
        if self.times[0] != 0.0 or not any(self.speeds):
            expected = "times from 0 s on, and speeds above 0"
            refuse([Finding(("run", ""), "times", self.times, expected)], CouplingError)

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self.times[-1])


@dataclass(frozen=True)
class FreeRun:
    """Run of a machine whose speed follows from its motor and its load.

    Attributes
    ----------
    start : float
        Speed of the first driver's shaft at t = 0, without its sense [rad/s].
    duration : float
        [s]
    """

    start: float
    duration: float

    def __post_init__(self) -> None:
        """Require a speed and a duration."""
        start, duration = Number(at_least=0.0, unit="rad/s"), Number(above=0.0, unit="s")
        refuse(attribute_findings(("run", ""), self, start=start, duration=duration), CouplingError)


@dataclass(frozen=True)
class TorqueLine:
    """Torque over the speed of the first driver's shaft, linear between speeds and constant beyond them.

    Attributes
    ----------
    speeds : sequence of float
        Ascending speeds without their sense [rad/s].
    torques : sequence of float
        Torque at each speed [N m].
    """

    speeds: Sequence[float]
    torques: Sequence[float]

    def __post_init__(self) -> None:
        """Keep own copies; require a torque for each speed, and speeds that ascend."""
        keep_tuples(self, "speeds", "torques")
        part = ("torque over speed", "")
        findings = [*table_findings(part, self, "speeds", "torques", least=2)]
        if not findings and self.speeds[0] < 0.0:
            findings.append(Finding(part, "speeds", self.speeds, "speeds of at least 0 rad/s, without their sense"))
        refuse(findings, CouplingError)

    def at(self, speed: float) -> float:
        """Torque at a speed [N m]."""
        return float(np.interp(speed, self.speeds, self.torques))


_PIECES = 1024
_RPM = 60.0 / (2.0 * np.pi)


def free_speed(
    motor: Callable[[float], float],
    load: Callable[[float], float],
    inertia: float,
    *,
    start: float,
    duration: float,
    nominal: float,
) -> SpeedProfile:
    """Speed of the rigid train over time, piecewise linear with pieces of equal duration.

    Parameters
    ----------
    motor, load : callable
        Torque [N m] by speed [rad/s], at the first driver's rotor.
    inertia : float
        Inertia of the train, reduced to the same rotor [kg m²].
    start : float
        Speed at t = 0 [rad/s], not negative.
    duration : float
        Duration [s].
    nominal : float
        Nominal speed, to which the result is relative [rad/s], positive.

    Raises
    ------
    TransientError
        Where the machine cannot start, or stalls.
    """
    from scipy.integrate import solve_ivp

    def surplus(speed: float) -> float:
        return motor(max(speed, 0.0)) - load(max(speed, 0.0))

    def stopped(_: float, state: FloatArray) -> float:
        return float(state[0])

    stopped.terminal = True  # type: ignore[attr-defined]
    stopped.direction = -1.0  # type: ignore[attr-defined]
    if start == 0.0 and surplus(0.0) <= 0.0:
        raise TransientError(
            f"the machine cannot start: at rest its motor gives {motor(0.0):.6g} N·m against a load of "
            f"{load(0.0):.6g} N·m; lower the load at rest, or start from a speed at which the motor is the stronger"
        )
    times = duration * np.arange(_PIECES + 1) / _PIECES
    # Torque lines have corners: steps no longer than an interval do not skip them.
    solution = solve_ivp(
        lambda _, state: [surplus(float(state[0])) / inertia],
        (0.0, duration),
        [start],
        t_eval=times,
        events=stopped,
        rtol=1e-10,
        atol=1e-12 * nominal,
        max_step=duration / _PIECES,
    )
    if solution.status == 1:
        assert solution.t_events is not None
        when = float(solution.t_events[0][0])
        raise TransientError(
            f"the machine stalls at t = {when:.6g} s: it started at {start * _RPM:.6g} rpm and stands still, its "
            f"motor giving {motor(0.0):.6g} N·m against a load of {load(0.0):.6g} N·m; lower the load, or end the "
            "run before"
        )
    if not solution.success:
        raise TransientError(f"the free speed cannot be followed beyond t = {solution.t[-1]:.6g} s: {solution.message}")
    return SpeedProfile(times, np.maximum(solution.y[0], 0.0) / nominal)
