"""Time integration: the driver that carries a coupled system from event to event, whatever method steps it.

Time is cut at every event (a pair of teeth entering or leaving contact, a load or speed changing its slope), so no step
crosses a jump of the mesh stiffness. The stretches between events are cut into equal steps by a stepper: Newmark's
method (:mod:`gearwhine.coupling.time.newmark_stepper`) or exponential collocation
(:mod:`gearwhine.coupling.time.exponential_collocation`). The driver takes a chunk of stretches at a time, accepts it
where the stepper's local error is below the tolerance, and repeats it with finer steps otherwise.
"""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.connector_forces.kernel_arrays import LAST_TOUCH, PEAK, Samples
from gearwhine.coupling.errors import DeflectionError, TransientError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.machine.driving_frequencies import harmonic_frequencies
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.statics.static_equilibrium import coasting_velocity, static_equilibrium
from gearwhine.coupling.time.settings import TransientSettings
from gearwhine.coupling.time.step_matrices import KernelArrays, stored_energy
from gearwhine.numerics.arrays import FloatArray

_POINTS_PER_PERIOD = 6  # points in a period of the highest natural frequency; the tolerance refines motions that matter
_STEPS_PER_SEGMENT = 64  # largest number of steps between two cuts where no event cuts the time
_SPEED_GAIN = 2e-4  # change of speed over the nominal one within which a stretch's matrices stay the same
_SAME_TIME = 1e-6  # part of the coarsest step within which two events are one
SAMPLES_PER_BLOCK = 32768
_STEPS_PER_BLOCK = 1 << 20
_MOST_BLOCKS = 1 << 24


def coarsest_step(system: CoupledSystem, profile: SpeedProfile, largest: float) -> float:
    """Coarsest step [s]: it resolves the highest natural frequency and every excitation at the highest speed.

    A step that is a whole number of an excitation's periods would see a constant load, and no local error.
    """
    fastest = max(1.0, float(profile.speed_ratios.max()))
    exciting = [2.0 * np.pi * one for one in harmonic_frequencies(system, fastest)]
    exciting += [fastest * abs(rate) for rate in system.turning_rates]
    highest = max([system.highest_frequency, *exciting])
    resolving = 2.0 * np.pi / (highest * _POINTS_PER_PERIOD) if highest > 0.0 else np.inf
    return float(min(largest / fastest, resolving))


def same_time(step: float) -> float:
    """Tolerance within which two events are one [s]."""
    return _SAME_TIME * step


def block_ends(duration: float, interval: float, step: float, samples: int = SAMPLES_PER_BLOCK) -> FloatArray:
    """Return ends of blocks with a limited number of samples and coarsest steps, from 0 to the duration [s].

    Raises
    ------
    TransientError
        Where there would be too many blocks for any run.
    """
    count = np.ceil(max(duration / (interval * samples), duration / (step * _STEPS_PER_BLOCK), 1.0))
    if not count < _MOST_BLOCKS:
        raise TransientError(f"{duration:g} s at steps of {step:.2g} s and samples every {interval:.2g} s have no end")
    return np.asarray(duration * np.arange(int(count) + 1) / int(count))


def boundaries(
    system: CoupledSystem, profile: SpeedProfile, start: float, end: float, step: float, others: tuple[float, ...]
) -> FloatArray:
    """Start, events and end of a block, with long stretches between them cut evenly [s]."""
    inner = [np.array([time for time in others if start < time < end])]
    inner += [times[(times > start) & (times < end)] for times in _known_times(system, profile)]
    (turned_from,), (turned_to,) = (profile.at(time)[0] for time in (start, end))
    for contact in system.contacts:
        inner.append(profile.times_of(contact.event_times(float(turned_from), float(turned_to))))
    times = np.unique(np.concatenate([*inner, [start, end]]))
    times = times[np.isfinite(times) & (times >= start) & (times <= end)]
    # Events that rounding alone holds apart are one.
    near = same_time(step)
    times = times[np.concatenate([[True], np.diff(times) > near])]
    if times[-1] < end and len(times) > 1:
        times = np.append(times[:-1], end)
    # Matrices are those of a stretch's mean speed.
    gained = np.abs(np.diff(profile.at(times)[1]))
    pieces = np.maximum(np.ceil(np.diff(times) / (_STEPS_PER_SEGMENT * step)), np.ceil(gained / _SPEED_GAIN))
    pieces = np.maximum(np.minimum(pieces, np.ceil(np.diff(times) / (8.0 * step))), 1.0).astype(np.int64)
    if pieces.max() == 1:
        return np.asarray(times)
    cuts = [begin + (stop - begin) * np.arange(n) / n for begin, stop, n in zip(times, times[1:], pieces, strict=False)]
    return np.concatenate([*cuts, times[-1:]])


def _known_times(system: CoupledSystem, profile: SpeedProfile) -> Iterator[FloatArray]:
    """Yield times at which loads and speeds change their slope [s]."""
    if len(profile.times) > 1:
        yield profile.times
        # Connectors change their slope over speed where these speeds are passed.
        for rate in system.connector_speed_ratios if len(system.connector_speed_ratios) > 1 else ():
            before, after = profile.speed_ratios[:-1] - rate, profile.speed_ratios[1:] - rate
            crossing = before * after < 0.0
            part = before[crossing] / (before[crossing] - after[crossing])
            yield profile.times[:-1][crossing] + part * np.diff(profile.times)[crossing]
    for load in system.timed_loads:
        yield load.times


_FINEST = 12  # number of times that the coarsest step may be halved
_RUNAWAY = 1e4  # motion over the motion at rest beyond which the machine counts as unstable
_GONE = 20.0  # number of mesh periods without contact after which separated teeth count as lost


@dataclass(frozen=True)
class Checkpoint:
    """State of a time integration between two blocks: the run continues from it bit for bit.

    Attributes
    ----------
    block : int
        Blocks done.
    sample : int
        Samples written.
    time : float
        Time [s].
    q, v : ndarray, shape (n,)
        Coordinates and their rates, of the condensed system.
    stored : float
        Energy in the teeth, and in the connectors where these change with the speed [J].
    totals : ndarray, shape (5,)
        Work of the loads, energy lost, work of the rotating contacts, the largest kinetic energy, and the energy that
        friction took from the nominal rotation [J].
    contact_totals : ndarray, shape (c, 4)
        Impulse [N s], time apart [s], largest force [N] since the record began, and time of the last touch [s].
    level : int
        Refinement of the steps, in levels of the stepper.
    steps, rejected, unsettled : int
        Steps taken, repeated, and taken without convergence of Newton's iteration on the contact forces.
    worst : float
        Largest accepted local error.
    smallest : float
        Smallest step [s].
    start_energy, energy, highest, lowest : float
        Energy held at the start, now, and at its extremes [J].
    seconds : float
        Computing time of the steps [s].
    """

    block: int
    sample: int
    time: float
    q: FloatArray
    v: FloatArray
    stored: float
    totals: FloatArray
    contact_totals: FloatArray
    level: int
    steps: int
    rejected: int
    unsettled: int
    worst: float
    smallest: float
    start_energy: float
    energy: float
    highest: float
    lowest: float
    seconds: float

    def as_arrays(self) -> dict[str, npt.NDArray[Any]]:
        """Every field as an array, to be written to a file."""
        return {field.name: np.asarray(getattr(self, field.name)) for field in fields(self)}

    @staticmethod
    def from_arrays(arrays: Mapping[str, npt.NDArray[Any]]) -> "Checkpoint":
        """Restore the checkpoint from the arrays of :meth:`as_arrays`."""
        values: dict[str, Any] = {field.name: np.asarray(arrays[field.name]) for field in fields(Checkpoint)}
        return Checkpoint(**{name: value if value.ndim else value.item() for name, value in values.items()})


def sample_times(settings: TransientSettings, first: int, count: int) -> FloatArray:
    """Return times of ``count`` samples from number ``first`` on [s]."""
    return np.asarray(
        settings.record_from + settings.sample_interval * np.arange(first, first + count, dtype=np.float64)
    )


@dataclass(frozen=True)
class Attempt:
    """Steps through a chunk of stretches, before the driver has accepted them.

    Attributes
    ----------
    q, v : ndarray, shape (n,)
        State at the end.
    error : float
        Local error of the steps, relative; infinite where the motion is not finite.
    steps : int
    smallest : float
        Smallest step [s].
    """

    q: FloatArray
    v: FloatArray
    error: float
    steps: int
    smallest: float


class Stepper(Protocol):
    """A method of time integration.

    Attributes
    ----------
    arrays : KernelArrays
    system : CoupledSystem
        System that is integrated.
    steps_in_one : int
        Number of Newmark steps that one step of this method stands for.
    order : float
        Power of the step size with which the local error falls.
    levels : int
        Number of levels of refinement by which a step halves.
    grow_to : float
        Local error up to which steps may grow, by that order.
    too_fine : str
        End of the message where the tolerance asks for steps that are too small, with the field ``step`` [s].
    """

    arrays: KernelArrays
    system: CoupledSystem
    steps_in_one: int
    order: float
    levels: int
    grow_to: float
    too_fine: str

    def begin_block(self, state: Checkpoint, bounds: FloatArray, samples: Samples, *, compiles: bool) -> None:
        """Prepare for a block; ``compiles`` where the kernels are to be compiled before the clock starts."""

    def chunk(self, bounds: FloatArray, step: float) -> int:
        """Return the number of stretches between ``bounds`` to attempt at once, with steps of at most ``step`` [s]."""

    def attempt(self, state: Checkpoint, bounds: FloatArray, step: float, samples: Samples) -> Attempt:
        """Step through the stretches between ``bounds``."""

    def accept(self, state: Checkpoint, done: float, samples: Samples) -> Checkpoint:
        """Return the state after the last attempt, with its work, contact figures and samples, up to ``done`` [s]."""

    def last_touch(self, state: Checkpoint, begin: float, done: float) -> tuple[FloatArray, float]:
        """Time of the last touch of each contact before a divergence, shape (c,), and the end of that record [s]."""


class Integration:
    """Driver of a time integration: its constant settings, and the loop over chunks of steps."""

    def __init__(
        self, stepper: Stepper, settings: TransientSettings, profile: SpeedProfile, samples_per_block: int
    ) -> None:
        system = stepper.system
        self.system, self.settings, self.profile, self.stepper = system, settings, profile, stepper
        self.arrays = stepper.arrays
        step = coarsest_step(system, profile, settings.largest_step)
        self.base = step * stepper.steps_in_one
        self.ends = block_ends(settings.duration, settings.sample_interval, step, samples_per_block)
        self._cut = -1, np.zeros(0)
        # A stable machine moves no further than a multiple of its static deflection.
        applied = timed_amplitude(system) + np.abs(system.load)
        self.reach = float(_resting(system, profile, applied, settings.duration).max(initial=0.0))

    def start(self, initial: tuple[FloatArray, FloatArray] | None) -> Checkpoint:
        """Start from static equilibrium under the initial loads, coasting where nothing resists, or a given state."""
        system, (_, rates, accelerations) = self.system, self.profile.at(0.0)
        steady = system.load + (rates[0] ** 2 - 1.0) * system.centrifugal_load
        load = sum((load.at(0.0) for load in system.timed_loads), steady + accelerations[0] * system.acceleration_load)
        resting = system if np.array_equal(load, system.load) else replace(system, load=load)
        q, v = initial or (static_equilibrium(resting), coasting_velocity(system, float(rates[0])))
        q, v = q.astype(np.float64), v.astype(np.float64)
        first = float(self.bounds(0)[1])
        nominal_time, rates, _ = self.profile.at(1e-7 * first)
        stored = stored_energy(*self.arrays[:4], q, v, float(nominal_time[0]), float(rates[0]))
        energy = self.held(q, v) + stored
        return Checkpoint(
            block=0, sample=0, time=0.0, q=q, v=v, stored=stored, totals=np.zeros(5),
            contact_totals=np.zeros((len(system.contacts), 4)), level=0, steps=0, rejected=0, unsettled=0, worst=0.0,
            smallest=self.base, start_energy=energy, energy=energy, highest=energy, lowest=energy, seconds=0.0,
        )  # fmt: skip

    def through(
        self, number: int, before: Checkpoint, samples: Samples, progress: Callable[[float], None]
    ) -> Checkpoint:
        """Integrate through one block, its samples written on the way."""
        settings, stepper, bounds = self.settings, self.stepper, self.bounds(number)
        # An event or the start of a block may stand for the start of the record, where rounding alone separates them.
        rounding = same_time(self.base)
        first_record = int(np.searchsorted(bounds, settings.record_from - rounding))
        if bounds[0] > settings.record_from + rounding:
            first_record = -1
        limit = self.limit(number, before)
        stepper.begin_block(before, bounds, samples, compiles=number == before.block == 0 and before.steps == 0)
        clock = time.perf_counter() - before.seconds
        state, position = before, 0
        while position < len(bounds) - 1:
            step = self.base * 2.0 ** (-state.level / stepper.levels)
            last = position + stepper.chunk(bounds[position:], step)
            if position < first_record < last:
                last = first_record
            if position == first_record:
                fresh = np.zeros_like(state.contact_totals)
                fresh[:, LAST_TOUCH] = state.contact_totals[:, LAST_TOUCH]
                state = replace(state, contact_totals=fresh)
            begin, done = float(bounds[position]), float(bounds[last])
            attempt = stepper.attempt(state, bounds[position : last + 1], step, samples)
            if not (np.isfinite(attempt.error) and float(np.abs(attempt.q).max(initial=0.0)) < limit):
                raise TransientError(self._divergence(begin, *stepper.last_touch(state, begin, done)))
            if attempt.error > settings.tolerance:
                state = self._finer(state, begin, attempt)
                continue
            after = stepper.accept(state, done, samples)
            self._require_possible(attempt.q, after.contact_totals[:, PEAK], begin, done)
            energy = self.held(attempt.q, attempt.v) + after.stored
            state = replace(
                after,
                time=done,
                q=attempt.q,
                v=attempt.v,
                steps=state.steps + attempt.steps,
                worst=max(state.worst, attempt.error),
                smallest=min(state.smallest, attempt.smallest),
                level=self._coarser(state.level, attempt.error),
                energy=energy,
                highest=max(state.highest, energy),
                lowest=min(state.lowest, energy),
            )
            position = last
            progress(done / settings.duration)
        return replace(state, block=number + 1, seconds=time.perf_counter() - clock)

    def _finer(self, state: Checkpoint, begin: float, attempt: Attempt) -> Checkpoint:
        """Smaller steps for the next attempt, by the order of the local error."""
        needed = self.stepper.levels * np.log2(attempt.error / self.settings.tolerance) / self.stepper.order
        level = state.level + max(1, int(np.ceil(needed)))
        if level > _FINEST * self.stepper.levels:
            finest = self.stepper.too_fine.format(step=self.base * 2.0**-_FINEST)
            raise TransientError(f"after t = {begin:.6g} s the tolerance {self.settings.tolerance:g} asks for {finest}")
        return replace(state, level=level, rejected=state.rejected + attempt.steps)

    def _coarser(self, level: int, error: float) -> int:
        """Level after an accepted error: by its order steps grow up to the error aimed at, by √2 at most."""
        stepper = self.stepper
        spare = stepper.levels * np.log2(stepper.grow_to / max(error, 1e-300)) / stepper.order
        return level - min(max(int(np.floor(spare)), 0), stepper.levels // 2, level)

    def _require_possible(self, q: FloatArray, peaks: FloatArray, begin: float, now: float) -> None:
        """Refuse a motion that compresses teeth further than teeth can deflect, somewhere between two times [s].

        The compression is the larger of that at the end and that of the largest force so far.

        Raises
        ------
        DeflectionError
        """
        turned_to = float(self.profile.at(now)[0][0])
        for contact, peak in zip(self.system.contacts, peaks.tolist(), strict=True):
            compression = max(
                float(contact.direction_at(turned_to) @ q) - contact.clearance,
                peak / contact.contact.unloaded_mean_mesh_stiffness,
            )
            if compression > contact.compression_limit:
                raise DeflectionError(
                    f"the teeth of {contact.name} are pressed together by {1e3 * compression:.3g} mm between "
                    f"t = {begin:.6g} s and {now:.6g} s, where teeth can follow "
                    f"{1e3 * contact.compression_limit:.3g} mm at most (a quarter of the module); expected loads "
                    "that the teeth carry: look at the torque first (gearwhine check, gearwhine gears); a machine that "
                    "is not stable comes here too, by negative damping ratios of coupled modes (gearwhine system)"
                )

    def limit(self, number: int, state: Checkpoint) -> float:
        """Bound on every coordinate of a stable machine in a block."""
        bound = _RUNAWAY * (float(np.abs(state.q).max(initial=0.0)) + self.reach)
        bound += _RUNAWAY * float(np.linalg.norm(state.v)) * self.settings.duration if number == 0 else 0.0
        return bound if bound > 0.0 else np.inf

    def bounds(self, number: int) -> FloatArray:
        """Bounds of the stretches of a block [s]."""
        if number != self._cut[0]:
            ends = float(self.ends[number]), float(self.ends[number + 1])
            self._cut = number, boundaries(self.system, self.profile, *ends, self.base, (self.settings.record_from,))
        return self._cut[1]

    def held(self, q: FloatArray, v: FloatArray) -> float:
        """Kinetic energy and strain energy of the springs that do not change with the speed [J]."""
        dynamics = self.arrays.dynamics
        energy = 0.5 * v @ v + 0.5 * q @ (dynamics.stiffness * q)
        if len(dynamics.connector_speed_ratios) == 1:
            deflection = dynamics.connectors @ q
            energy += 0.5 * deflection @ dynamics.connector_stiffness[0] @ deflection
        return float(energy)

    def _divergence(self, begin: float, last_touch: FloatArray, until: float) -> str:
        """Message about a motion that grows beyond bounds after the time ``begin`` [s]."""
        for contact, last in zip(self.system.contacts, last_touch, strict=True):
            if contact.loaded and (until - last) * abs(contact.mesh_frequency) > _GONE:
                return (
                    f"the teeth of {contact.name} came apart at t = {last:.6g} s and did not meet again: nothing "
                    "holds them together; look at the torques in and out, and whether the driver leads"
                )
        return (
            f"the motion diverged after t = {begin:.6g} s; the linear part may be unstable: look for "
            "negative damping ratios among the coupled modes"
        )


def timed_amplitude(system: CoupledSystem) -> FloatArray | float:
    """Largest load on each coordinate from the tables over time, shape (n,); 0 without any."""
    return sum((np.abs(load.values).max() * np.abs(load.direction) for load in system.timed_loads), 0.0)


def _resting(system: CoupledSystem, profile: SpeedProfile, applied: FloatArray, duration: float) -> FloatArray:
    """Coordinates under the loads' amplitudes at rest, shape (n,); F t²/2 where nothing resists."""
    fastest = max(1.0, float(profile.speed_ratios.max())) ** 2
    loads = sum((fastest * np.abs(load.amplitude) for load in system.harmonic_loads), np.zeros(system.size)) + applied
    stiffness = np.abs(np.diag(system.mean_stiffness))
    compliance = np.full(system.size, 0.5 * duration**2)
    return np.asarray(loads * np.divide(1.0, stiffness, out=compliance, where=stiffness > 0.0))
