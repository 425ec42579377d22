r"""The exact march: a transient at constant speed without time steps of the modes.

The machine with its teeth at their mean is linear and does not change in time, so its motion is known in closed form:
modes by their exponentials, gyroscopic and damped as they are; harmonic loads and runout errors by the reference's own
response; motions that nothing resists by uniform acceleration. What remains is what the teeth do beyond their mean, one
force for each contact, and this alone is approximated: over an element of time by the polynomial through its values at
Gauss places, see :mod:`coupling.periodic.kernels`; this march shares its elements with the search of periodic motions.
They end at every tooth event, and where a law changes its branch by itself.

The local error is what that polynomial misses. It has no defect at the places, so between them the defect has the shape
of the polynomial that vanishes there, and two looks at the law just inside the element's ends give its size. Carried
through the propagator,

    e = -∫₀ʰ e^{λ(h - t)} b (g - p) dt,

it is the error of the state at the element's end, of the true order 2 s + 1; its largest, relative to the amplitudes'
root mean square, is kept below the tolerance by the number of elements between events.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from coupling.boundaries import same_time
from coupling.condensation import condensed
from coupling.errors import PeriodicError, TransientError
from coupling.exact_record import Record
from coupling.kernel_arrays import Samples
from coupling.march_run import Checkpoint, MarchRun, sample_times
from coupling.periodic.arrays import Steps, Trace, empty_trace, first_elements
from coupling.periodic.collocation import ORDER
from coupling.periodic.element_work import element_work
from coupling.periodic.linear_part import LinearPart, linear_part
from coupling.periodic.orbit import element_sizes
from coupling.settings import TransientOutputs, TransientSettings
from coupling.system import CoupledSystem
from coupling.turning import Turning

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_STRETCHES, _ELEMENTS = 256, 1024  # at most about so many between two looks at the error ...
_FIRST_STRETCHES = 8  # ... and at first: most of what is marched in vain is found out there
_SIZES = 64  # that have matrices of their own, besides the ladder's
_SAME_SIZE = 1e-11  # parts of the coarsest element by which elements of one size may differ
_FINEST_LEVEL = 24  # 4096 times finer than the coarsest element
_ORDER_OF_ERROR = 6.0  # in which it falls at least, kinks in the laws' tables included
_MUCH_BETTER = 1e-2  # part of the tolerance below which elements may grow
_CUTS = 400  # room for switches in a chunk, besides four for each element


def march_method(system: CoupledSystem, settings: TransientSettings, turning: Turning) -> Literal["newmark", "exact"]:
    """Which method marches: the one asked for, or by ``auto`` the exact one wherever it applies.

    Raises
    ------
    TransientError
        Where the exact one is asked for and does not apply, with the reason.
    """
    return "newmark" if exact_part(condensed(system).system, settings, turning) is None else "exact"


def exact_part(system: CoupledSystem, settings: TransientSettings, turning: Turning) -> LinearPart | None:
    """The linear part that is marched exactly; None where Newmark's method marches.

    Raises
    ------
    TransientError
        As :func:`march_method`.
    """
    if settings.method == "newmark":
        return None
    reason = ""
    if not turning.is_steady:
        reason = "the speed varies, and with it the machine"
    elif system.timed_loads:
        reason = "a load is a table over time"
    elif not system.is_smooth:
        reason = "it knows no nonlinear bearings" if system.nonlinear else "it knows no friction between the teeth"
    else:
        try:
            return steady_part(system)
        except PeriodicError as error:
            reason = str(error)
    if settings.method == "exact":
        raise TransientError(f"the exact march does not apply: {reason}; march by Newmark's method")
    return None


def steady_part(system: CoupledSystem) -> LinearPart:
    """The linear part in units of the fastest mesh, load or mode."""
    rates = [2.0 * np.pi * abs(contact.rate) for contact in system.contacts]
    rates += [abs(load.frequency) for load in system.harmonic_loads]
    return linear_part(system, max(rates, default=0.0) or system.highest_frequency or 1.0, repeats=False)


class ExactRun(MarchRun):
    """What stays the same through an exact march."""

    def __init__(
        self,
        part: LinearPart,
        settings: TransientSettings,
        outputs: TransientOutputs,
        turning: Turning,
        samples_per_block: int,
    ) -> None:
        super().__init__(part.system, settings, outputs, turning, samples_per_block)
        self.base *= ORDER  # as many places as there would be steps
        self.part = part
        self.record = Record(self.part, outputs, self.arrays.contacts)
        self._steps = element_sizes(self.part, np.zeros(_SIZES), self.base, inner=True)
        self._shape = part.reference.eigenvalue.size, ORDER, len(part.system.contacts)
        self._trace, self._work = empty_trace(0, *self._shape), element_work(*self._shape)
        self._undisturbed = np.zeros((0, 2 * self._shape[0]))
        # Below this the motion is rounding of the reference's.
        own = float(np.linalg.norm(self.part.mean) + np.abs(self.part.amplitudes).sum())
        self._quiet = (1e-9 * own) ** 2 + 1e-300

    def through(
        self, number: int, before: Checkpoint, samples: Samples, progress: Callable[[float], None]
    ) -> Checkpoint:
        """One block."""
        # New in every block, so that a march that goes on from a checkpoint does just the same: the sizes that have
        # matrices of their own, and the forces that Newton's method begins with.
        settings, record, sizes = self.settings, self.record, _Sizes(self._steps, _SAME_SIZE * self.base)
        self._work = element_work(*self._shape)
        bounds = self.bounds(number)
        first_record = int(np.searchsorted(bounds, settings.record_from - same_time(self.base)))
        if bounds[0] > settings.record_from:
            first_record = -1
        limit, free = self.limit(number, before), record.free_motion(before)
        z = self.part.amplitudes_of(self.part.state(before.q, before.v, before.time), before.time)
        if number == before.block == 0 and before.steps == 0:
            # Compiled before the clock starts.
            trace, _ = self._elements(bounds[:1], np.zeros(0, dtype=np.int64), z, sizes)
            record.write(trace, free, np.zeros(0), samples, 0)
            record.add(before, trace, self._steps, free)
        clock = time.perf_counter() - before.seconds
        state, position, stretch_limit = before, 0, _FIRST_STRETCHES
        while position < len(bounds) - 1:
            element = self.base * 2.0 ** (-0.5 * state.level)
            pieces = np.maximum(np.ceil(np.diff(bounds[position:]) / element - 1e-9), 1.0).astype(np.int64)
            last = position + max(1, min(stretch_limit, int(np.searchsorted(np.cumsum(pieces), _ELEMENTS))))
            last = min(last, len(bounds) - 1)
            if position < first_record < last:
                last = first_record
            if position == first_record:
                fresh = np.column_stack([np.zeros_like(state.contact_totals[:, :3]), state.contact_totals[:, 3]])
                state = replace(state, contact_totals=fresh)
            stretches, pieces = bounds[position : last + 1], pieces[: last - position]
            trace, end = self._elements(stretches, pieces, z, sizes)
            done = float(bounds[last])
            q, v = record.motion(end, free, done)
            error = float(np.sqrt(trace.error[:, 0].max() / (trace.error[:, 1].mean() + self._quiet)))
            if not (np.isfinite(error) and float(np.abs(q).max(initial=0.0)) < limit):
                figures = record.contact_figures(state, trace)
                raise TransientError(self.lost(float(bounds[position]), replace(state, contact_totals=figures), done))
            if error > settings.tolerance:
                state = self._finer(state, float(bounds[position]), error, len(trace.start))
                continue
            state = record.add(state, trace, self._steps, free)
            self.require_possible(replace(state, q=q), float(bounds[position]), done)
            if done > settings.record_from:
                times = self._times_until(done, state.sample)
                record.write(trace, free, times, samples, state.sample)
                state = replace(state, sample=state.sample + len(times))
            energy = self.held(q, v) + state.stored
            state = replace(
                state,
                time=done,
                q=q,
                v=v,
                steps=state.steps + len(trace.start),
                worst=max(state.worst, error),
                smallest=min(state.smallest, float((np.diff(stretches) / pieces).min())),
                level=max(state.level - 1, 0) if error < _MUCH_BETTER * settings.tolerance else state.level,
                energy=energy,
                highest=max(state.highest, energy),
                lowest=min(state.lowest, energy),
            )
            z, position, stretch_limit = end, last, min(2 * stretch_limit, _STRETCHES)
            progress(done / settings.duration)
        return replace(state, block=number + 1, seconds=time.perf_counter() - clock)

    def _times_until(self, done: float, first: int) -> FloatArray:
        """Of the samples from a first one that are no later than a time [s]."""
        settings = self.settings
        # One more than rounding may leave out.
        count = int((done - settings.record_from) / settings.sample_interval) + 2 - first
        times = sample_times(settings, first, max(min(count, settings.samples - first), 0))
        return times[times <= done]

    def _elements(
        self, stretches: FloatArray, pieces: IntArray, z: FloatArray, sizes: "_Sizes"
    ) -> tuple[Trace, FloatArray]:
        """Through stretches of time, each cut into equal pieces: the trace, and the amplitudes at the end.

        The trace holds until the next call.
        """
        from coupling.periodic.kernels import NO_BALANCE, NO_ROOM, march

        reference, modes = self.part.reference, len(self.part.eigenvalues)
        lengths = np.diff(stretches) / pieces
        length, slots = np.repeat(lengths, pieces), np.repeat(sizes.slots(lengths), pieces)
        within = np.arange(len(length)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        starts = np.repeat(stretches[:-1], pieces) + within * length
        room = _CUTS + 5 * len(length)
        if room > len(self._trace.start):
            self._trace = empty_trace(room, *self._shape)
        trace, end = self._trace, z.copy()
        head = reference, self.arrays.contacts, self._steps, starts, length, slots, end, self._undisturbed
        count, _, wrong = march(*head, modes, trace, 0, self._work)
        where = f"after t = {trace.start[max(int(count) - 1, 0)]:.6g} s"
        if wrong == NO_BALANCE:
            raise TransientError(f"{where} the teeth's forces do not balance; expected a law that grows")
        if wrong == NO_ROOM:
            raise TransientError(f"{where} the flanks chatter without end; give the mesh some damping")
        return first_elements(trace, int(count)), end

    def _finer(self, state: Checkpoint, begin: float, error: float, repeated: int) -> Checkpoint:
        """Shorter elements for the next try."""
        gain = np.log2(error / self.settings.tolerance) / _ORDER_OF_ERROR
        level = state.level + max(1, int(np.ceil(2.0 * gain)))
        if level > _FINEST_LEVEL:
            finest = self.base * 2.0 ** (-0.5 * _FINEST_LEVEL)
            raise TransientError(
                f"after t = {begin:.6g} s the tolerance {self.settings.tolerance:g} asks for elements below "
                f"{finest:.1e} s; raise the tolerance"
            )
        return replace(state, level=level, rejected=state.rejected + repeated)


class _Sizes:
    """Which sizes of elements have matrices of their own; all others make do with the ladder's."""

    def __init__(self, steps: Steps, unit: float) -> None:
        self._steps, self._unit, self._known = steps, unit, dict[int, int]()

    def slots(self, lengths: FloatArray) -> IntArray:
        """The slot of each length, -1 for none: the first sizes get one, while there is room."""
        # What rounding alone holds apart is one size.
        keys, first, which = np.unique(np.rint(lengths / self._unit), return_index=True, return_inverse=True)
        slots = np.full(len(keys), -1, dtype=np.int64)
        for i, key in enumerate(keys.astype(np.int64).tolist()):
            if key not in self._known and len(self._known) < _SIZES:
                self._known[key] = len(self._known)
                self._steps.size[self._known[key]] = lengths[first[i]]
                self._steps.filled[self._known[key]] = 0
            slots[i] = self._known.get(key, -1)
        return slots[which]
