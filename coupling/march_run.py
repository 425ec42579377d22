"""Newmark's march: where a march stands, and how it goes on from there.

Time is cut at every event (a pair of teeth entering or leaving contact), so no step crosses a jump of the mesh
stiffness. The stretches between are cut into equal steps. The local error of Newmark's method is that of its
period: one oscillation of circular frequency w advances by (w h)²/12 too little for each radian it turns. Its
mean over what is moving is measured by the second difference of the acceleration,

    error = |a₁ - 2 a₀ + a₋₁| / (12 |a|),

and stretches are repeated with finer steps until it is below the tolerance. Residual coordinates of the housing have
no part in this measure: they stand for static compliance, and their own frequencies are not meant to be followed. The
stiffest of them are not marched at all, see :mod:`coupling.condensation`.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from coupling.boundaries import block_ends, boundaries, coarsest_step, same_time
from coupling.errors import DeflectionError, TransientError
from coupling.settings import TransientOutputs, TransientSettings
from coupling.statics import coasting_velocity, static_equilibrium
from coupling.step import KernelArrays, StepCache, cut, kernel_arrays, scratch_room
from coupling.stored_energy import stored_energy
from coupling.system import CoupledSystem
from coupling.turning import Turning

FloatArray = npt.NDArray[np.float64]

_SEGMENTS_PER_CHUNK = 48  # stretches between two looks at the error
_FINEST_LEVEL = 24  # 4096 times finer than the coarsest step
_RUNAWAY = 1e4  # times the motion at rest: beyond, the machine is unstable, not lively
_GONE = 20.0  # mesh periods without a touch after which teeth that fly off count as lost


@dataclass(frozen=True)
class Checkpoint:
    """Where a march stands: all that it needs to go on, bit for bit as if it had never stopped.

    Attributes
    ----------
    block : int
        Blocks done.
    sample : int
        Samples written.
    time : float
        [s].
    q, v : ndarray, shape (n,)
        State of the coordinates that are followed.
    stored : float
        Energy in the teeth, and in the ties where they change with the speed [J].
    totals : ndarray, shape (5,)
        Work of the loads, energy lost, work of what turns, the largest kinetic energy, and what friction took from
        the nominal rotation [J].
    contact_totals : ndarray, shape (c, 4)
        Impulse [N s], time apart [s], largest force [N] since the record began, and time of the last touch [s].
    level : int
        How fine the steps are.
    steps, rejected, unsettled : int
        Taken, repeated, and taken with forces that Newton's method left unsettled.
    worst : float
        Largest accepted error measure.
    smallest : float
        Step [s].
    start_energy, energy, highest, lowest : float
        Energy held at the start, now, and at its extremes [J].
    seconds : float
        Time taken by the stepping [s].
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
        """Every field as an array, to be kept on file."""
        return {field.name: np.asarray(getattr(self, field.name)) for field in fields(self)}

    @staticmethod
    def from_arrays(arrays: Mapping[str, npt.NDArray[Any]]) -> "Checkpoint":
        """The checkpoint that gave such arrays."""
        values: dict[str, Any] = {field.name: np.asarray(arrays[field.name]) for field in fields(Checkpoint)}
        return Checkpoint(**{name: value if value.ndim else value.item() for name, value in values.items()})


def sample_times(settings: TransientSettings, first: int, count: int) -> FloatArray:
    """Times of some samples [s]."""
    return np.asarray(
        settings.record_from + settings.sample_interval * np.arange(first, first + count, dtype=np.float64)
    )


class MarchRun:
    """What stays the same through a march: Newmark's, in steps."""

    def __init__(
        self,
        system: CoupledSystem,
        settings: TransientSettings,
        outputs: TransientOutputs,
        turning: Turning,
        samples_per_block: int,
    ) -> None:
        self.system, self.settings, self.turning = system, settings, turning
        self.arrays: KernelArrays = kernel_arrays(system, outputs, settings.beta, settings.gamma)
        self.cache = StepCache(self.arrays, turning)
        self.base = coarsest_step(system, turning, settings.largest_step)
        self.ends = block_ends(settings.duration, settings.sample_interval, self.base, samples_per_block)
        pushing = sum((np.abs(load.values).max() * np.abs(load.direction) for load in system.timed_loads), 0.0)
        self.pushing = np.linalg.norm(system.load) + np.linalg.norm(pushing)
        self._cut = -1, np.zeros(0)
        # Nothing that stays together moves so much further than its loads press it.
        pushed = pushing + np.abs(system.load)
        self.reach = float(_resting(system, turning, pushed, settings.duration).max(initial=0.0))

    def start(self, initial: tuple[FloatArray, FloatArray] | None) -> Checkpoint:
        """Static equilibrium under the loads of the start, swinging where nothing resists; or a state that is given."""
        system, (_, rates, swings) = self.system, self.turning.at(0.0)
        load = sum((one.at(0.0) for one in system.timed_loads), system.load + swings[0] * system.swing)
        resting = system if np.array_equal(load, system.load) else replace(system, load=load)
        q, v = initial or (static_equilibrium(resting), coasting_velocity(system, float(rates[0])))
        q, v = q.astype(np.float64), v.astype(np.float64)
        first = float(self.bounds(0)[1])
        turned, rates, _ = self.turning.at(1e-7 * first)
        stored = stored_energy(*self.arrays[:3], q, v, float(turned[0]), float(rates[0]))
        energy = self.held(q, v) + stored
        return Checkpoint(
            block=0, sample=0, time=0.0, q=q, v=v, stored=stored, totals=np.zeros(5),
            contact_totals=np.zeros((len(system.contacts), 4)), level=0, steps=0, rejected=0, unsettled=0, worst=0.0,
            smallest=self.base, start_energy=energy, energy=energy, highest=energy, lowest=energy, seconds=0.0,
        )  # fmt: skip

    def through(self, number: int, before: Checkpoint, samples: Any, progress: Callable[[float], None]) -> Checkpoint:
        """One block."""
        from coupling.newmark import march

        settings, cache = self.settings, self.cache
        bounds = self.bounds(number)
        # An event may stand for the start of the record, when rounding alone holds the two apart.
        first_record = int(np.searchsorted(bounds, settings.record_from - same_time(self.base)))
        if bounds[0] > settings.record_from:
            first_record = -1
        state, position = before, 0
        if number == before.block == 0 and before.steps == 0:
            # Compiled before the clock starts.
            self._march(march, state, cut(cache, self.turning, bounds[:1], 1.0), samples)
        # Forces too small to see: below this an acceleration is rounding, and its curvature means nothing.
        quiet = (1e-9 * float(np.linalg.norm(self.system.stiffness @ state.q) + self.pushing)) ** 2
        bound = self.limit(number, state)
        clock = time.perf_counter() - before.seconds
        while position < len(bounds) - 1:
            last = min(position + _SEGMENTS_PER_CHUNK, len(bounds) - 1)
            if position < first_record < last:
                last = first_record
            segments = cut(cache, self.turning, bounds[position : last + 1], self.base * 2.0 ** (-0.5 * state.level))
            if position == first_record:
                fresh = np.column_stack([np.zeros_like(state.contact_totals[:, :3]), state.contact_totals[:, 3]])
                state = replace(state, contact_totals=fresh)
            trial, curvature, acceleration = self._march(march, state, segments, samples)
            steps = int(segments.steps.sum())
            if not np.isfinite(curvature) or not float(np.abs(trial.q).max(initial=0.0)) < bound:
                raise TransientError(self.lost(float(bounds[position]), state))
            error = float(np.sqrt(curvature / (acceleration + quiet * steps + 1e-300))) / 12.0
            if error > settings.tolerance:
                level = state.level + max(1, int(np.ceil(np.log2(error / settings.tolerance))))
                if level > _FINEST_LEVEL:
                    finest = self.base * 2.0 ** (-0.5 * _FINEST_LEVEL)
                    raise TransientError(
                        f"after t = {bounds[position]:.6g} s the tolerance {settings.tolerance:g} asks for steps below "
                        f"{finest:.1e} s; raise the tolerance or keep fewer high modes"
                    )
                state = replace(state, level=level, rejected=state.rejected + steps)
                continue
            self.require_possible(trial, float(bounds[position]), float(bounds[last]))
            energy = self.held(trial.q, trial.v) + trial.stored
            state = replace(
                trial,
                time=float(bounds[last]),
                steps=state.steps + steps,
                worst=max(state.worst, error),
                smallest=min(state.smallest, float(((segments.end - segments.start) / segments.steps).min())),
                level=max(state.level - 1, 0) if error < settings.tolerance / 3.0 else state.level,
                energy=energy,
                highest=max(state.highest, energy),
                lowest=min(state.lowest, energy),
            )
            position = last
            progress(float(bounds[position] / settings.duration))
        return replace(state, block=number + 1, seconds=time.perf_counter() - clock)

    def require_possible(self, state: Checkpoint, begin: float, now: float) -> None:
        """Refuse a motion that presses teeth together further than teeth can be, somewhere between two times [s].

        The compression is the larger of that at the end and the one that the largest force so far stands for.

        Raises
        ------
        DeflectionError
        """
        for contact, figures in zip(self.system.contacts, state.contact_totals, strict=True):
            pressed = max(
                float(contact.direction @ state.q) - contact.clearance,
                float(figures[2]) / contact.contact.mean_stiffness,
            )
            if pressed > contact.greatest_compression:
                raise DeflectionError(
                    f"the teeth of {contact.name} are pressed together by {1e3 * pressed:.3g} mm between "
                    f"t = {begin:.6g} s and {now:.6g} s, where teeth can follow "
                    f"{1e3 * contact.greatest_compression:.3g} mm at most (a quarter of the module); expected loads "
                    "that the teeth carry and a machine that is stable: look for negative damping ratios among the "
                    "coupled modes (gearwhine system)"
                )

    def limit(self, number: int, state: Checkpoint) -> float:
        """What no coordinate of a machine that holds together passes in a block."""
        bound = _RUNAWAY * (float(np.abs(state.q).max(initial=0.0)) + self.reach)
        bound += _RUNAWAY * float(np.linalg.norm(state.v)) * self.settings.duration if number == 0 else 0.0
        return bound if bound > 0.0 else np.inf

    def bounds(self, number: int) -> FloatArray:
        """Where a block is cut into stretches [s]."""
        if number != self._cut[0]:
            ends = float(self.ends[number]), float(self.ends[number + 1])
            self._cut = number, boundaries(self.system, self.turning, *ends, self.base, (self.settings.record_from,))
        return self._cut[1]

    def _march(self, kernel: Any, state: Checkpoint, segments: Any, samples: Any) -> tuple[Checkpoint, float, float]:
        """The kernel on copies of what it changes."""
        q, v, totals, contacts = (part.copy() for part in (state.q, state.v, state.totals, state.contact_totals))
        arrays = self.arrays
        head = (
            q, v, arrays.dynamics, arrays.contacts, arrays.bearings, self.cache.matrices, segments, arrays.outputs,
        )  # fmt: skip
        sample, stored, curvature, acceleration, unsettled = kernel(
            *head, samples, state.sample, state.stored, totals, contacts, scratch_room(arrays)
        )
        moved = replace(state, q=q, v=v, totals=totals, contact_totals=contacts, sample=sample, stored=stored)
        return replace(moved, unsettled=state.unsettled + unsettled), curvature, acceleration

    def held(self, q: FloatArray, v: FloatArray) -> float:
        """Energy of motion and of the springs that do not change [J]."""
        dynamics = self.arrays.dynamics
        energy = 0.5 * v @ v + 0.5 * q @ (dynamics.stiffness * q)
        if len(dynamics.tie_rates) == 1:
            tied = dynamics.ties @ q
            energy += 0.5 * tied @ dynamics.tie_stiffness[0] @ tied
        return float(energy)

    def lost(self, begin: float, state: Checkpoint, now: float | None = None) -> str:
        """What happened where the motion grows beyond bounds, after a time and until now [s]."""
        until = begin if now is None else now
        for contact, last in zip(self.system.contacts, state.contact_totals[:, 3], strict=True):
            if contact.drives and (until - last) * abs(contact.rate) > _GONE:
                return (
                    f"the teeth of {contact.name} came apart at t = {last:.6g} s and did not meet again: nothing "
                    "presses them together; look at the torques in and out, and whether the driver leads"
                )
        return (
            f"the motion diverged after t = {begin:.6g} s; the linear part may be unstable: look for "
            "negative damping ratios among the coupled modes"
        )


def _resting(system: CoupledSystem, turning: Turning, pushing: FloatArray | float, duration: float) -> FloatArray:
    """Coordinates that the loads' amplitudes would hold if they stood still, shape (n,); what is free, F t²/2."""
    fastest = max(1.0, float(turning.rates.max())) ** 2
    loads = sum((fastest * np.abs(load.amplitude) for load in system.harmonic_loads), np.zeros(system.size)) + pushing
    stiffness = np.abs(np.diag(system.mean_stiffness))
    compliance = np.full(system.size, 0.5 * duration**2)
    return np.asarray(loads * np.divide(1.0, stiffness, out=compliance, where=stiffness > 0.0))
