r"""Exponential collocation: time integration at constant speed that is exact in the linear machine.

The machine with its mean mesh stiffness is linear and time-invariant, so its motion is known in closed form: modes by
their exponentials, gyroscopic and damped as they are; harmonic loads and runout errors by the steady response of the
reference; rigid-body motions by uniform acceleration. The difference of the tooth forces from their mean law, one force
for each contact, is all that is approximated: over an element of time by the polynomial through its values at Gauss
points, see :mod:`gearwhine.coupling.collocation.integration_kernels`, whose elements the search of periodic motions
shares. Elements end at every tooth event, and where a contact law changes its branch by itself.

The local error is that of the polynomial. It has no defect at the Gauss points, so between them the defect has the
shape of the polynomial that vanishes there, and two evaluations of the law just inside the element's ends give its
size. Carried through the propagator,

    e = -∫₀ʰ e^{λ(h - t)} b (g - p) dt,

it is the error of the state at the element's end, of the true order 2 s + 1; its largest, relative to the amplitudes'
root mean square, is kept below the tolerance by the number of elements between events.

The record (states, samples and energy balance) is read from the trace of the elements.
"""

from dataclasses import replace
from typing import Literal

import numpy as np

from gearwhine.coupling.collocation.arrays import (
    ORDER,
    FreeMotion,
    Powers,
    Steps,
    Trace,
    element_work,
    empty_steps,
    empty_trace,
    first_elements,
    powers_room,
)
from gearwhine.coupling.collocation.linear_part import LinearPart, linear_part
from gearwhine.coupling.connector_forces.kernel_arrays import LOAD_WORK, Contacts, Samples
from gearwhine.coupling.errors import PeriodicError, TransientError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.time.condensation import condensed
from gearwhine.coupling.time.integration import Attempt, Checkpoint, coarsest_step, sample_times
from gearwhine.coupling.time.settings import TransientOutputs, TransientSettings
from gearwhine.coupling.time.step_matrices import kernel_arrays
from gearwhine.numerics.arrays import FloatArray, IntArray

_STRETCHES, _ELEMENTS = 256, 1024  # approximate largest numbers between two checks of the error
_FIRST_STRETCHES = 8  # number before the first check, where most failing attempts fail
_SIZES = 64  # number of element sizes with exact matrices, in addition to the ladder's
_SAME_SIZE = 1e-11  # parts of the coarsest element by which elements of one size may differ
_MUCH_BETTER = 0.08  # part of the tolerance up to which elements may grow
_CUTS = 400  # room for switches in a chunk, besides four for each element


class CollocationRecord:
    """Output rows over the amplitudes; n coordinates, M amplitudes."""

    def __init__(self, part: LinearPart, outputs: TransientOutputs, contacts: Contacts) -> None:
        self.part, self.contacts, system = part, contacts, part.system
        modes, count = len(part.eigenvalues), len(part.reference.eigenvalue)
        # Loads are amplitudes too, as the reference's own response is: constant ones last, harmonic ones at its
        # frequencies.
        load = np.zeros((system.size, 2 * count))
        load[:, count - 1] = system.load
        for harmonic in system.harmonic_loads:
            if harmonic.frequency == 0.0:
                load[:, count - 1] += harmonic.amplitude.real
                continue
            column = modes + int(np.searchsorted(part.frequencies, harmonic.frequency))
            load[:, column] += harmonic.amplitude.real
            load[:, count + column] -= harmonic.amplitude.imag
        self._constant = load[:, count - 1]
        moving = load - system.stiffness @ part.displacement_rows - system.damping @ part.velocity_rows
        self._displacement = outputs.displacement @ part.displacement_rows, outputs.displacement @ part.rigid
        self._velocity = outputs.velocity @ part.velocity_rows, outputs.velocity @ part.rigid
        self._acceleration = outputs.acceleration @ moving, outputs.acceleration @ system.contact_directions
        self._powers = self._rows_of_powers(load)
        self._room = powers_room(2 * count + part.rigid.shape[1], system.size, ORDER)

    def _rows_of_powers(self, load: FloatArray) -> Powers:
        part, system = self.part, self.part.system
        # In the principal directions of the damping matrix the squares of the rates give the loss.
        loss, directions = np.linalg.eigh(0.5 * (system.damping + system.damping.T))
        forces = system.stiffness @ part.displacement_rows
        skew = (system.stiffness - system.stiffness.T) @ part.displacement_rows
        if np.abs(skew).max(initial=0.0) <= 1e-12 * np.abs(forces).max(initial=0.0):
            skew = skew[:, :0]
        # The work of constant loads is exact, by the displacements: modes too fast for the elements, such as those of
        # residual coordinates, would spoil its quadrature.
        riding = np.flatnonzero(np.any(load, axis=0) & (np.arange(load.shape[1]) != len(part.reference.eigenvalue) - 1))
        rows = np.hstack([part.velocity_rows, part.rigid]), skew, load[:, riding]
        rate, skew, pushing = (np.ascontiguousarray(row.T @ directions) for row in rows)
        return Powers(rate, loss, skew, riding, pushing)

    def free_motion(self, state: Checkpoint) -> FreeMotion:
        """Rigid-body motion from a state on."""
        rigid = self.part.rigid
        q, v = self.part.own_response(state.time)
        return FreeMotion(
            np.array([state.time]), rigid.T @ (state.q - q), rigid.T @ (state.v - v), rigid.T @ self._constant
        )

    def motion(self, z: FloatArray, free: FreeMotion, time: float) -> tuple[FloatArray, FloatArray]:
        """Coordinates and their rates at a time, shape (n,) each."""
        place, rate = free.at(np.array([time]))
        rigid = self.part.rigid
        return self.part.displacement_rows @ z + rigid @ place[0], self.part.velocity_rows @ z + rigid @ rate[0]

    def write(self, trace: Trace, free: FreeMotion, times: FloatArray, samples: Samples, first: int) -> None:
        """Write the samples at ascending times of a trace, from number ``first`` on."""
        from gearwhine.coupling.collocation.integration_kernels import amplitudes_at, forces_at

        reference = self.part.reference
        rows = slice(first - samples.offset, first - samples.offset + len(times))
        z = amplitudes_at(reference, trace, times)
        place, rate = free.at(times)
        samples.displacement[rows] = z @ self._displacement[0].T + place @ self._displacement[1].T
        samples.velocity[rows] = z @ self._velocity[0].T + rate @ self._velocity[1].T
        delta, slip = z @ reference.displacement.T, z @ reference.rate.T
        force = np.zeros_like(delta)
        forces_at(self.contacts, times, delta, slip, element_work(0, 0, delta.shape[1]), force)
        samples.compression[rows], samples.force[rows] = delta, force
        samples.acceleration[rows] = z @ self._acceleration[0].T - force @ self._acceleration[1].T

    def add(self, state: Checkpoint, trace: Trace, steps: Steps, free: FreeMotion, displaced: FloatArray) -> Checkpoint:
        """Add the work, the losses and the contact figures of a trace that displaces the coordinates to the state."""
        from gearwhine.coupling.collocation.integration_kernels import add_contacts, add_powers

        totals, figures = state.totals.copy(), state.contact_totals.copy()
        totals[LOAD_WORK] += self._constant @ displaced
        excess = trace.excess.reshape(len(trace.start), ORDER * trace.excess.shape[2])
        add_powers(steps, trace, excess, self._powers, free, self._room, totals)
        stored = add_contacts(trace, self.contacts, state.stored, self._room.weights[0], totals, figures)
        return replace(state, totals=totals, stored=float(stored), contact_totals=figures)

    def contact_figures(self, before: Checkpoint, trace: Trace) -> FloatArray:
        """Impulse, time apart, largest force and last touch, shape (c, 4), with those of a trace added."""
        from gearwhine.coupling.collocation.integration_kernels import add_contacts

        figures = before.contact_totals.copy()
        add_contacts(trace, self.contacts, before.stored, self._room.weights[0], before.totals.copy(), figures)
        return figures


def integration_method(
    system: CoupledSystem, settings: TransientSettings, profile: SpeedProfile
) -> Literal["newmark", "exact"]:
    """Choose the method of time integration: the given one, or by ``auto`` the exact one wherever it applies.

    Raises
    ------
    TransientError
        Where the exact method is given and does not apply, with the reason.
    """
    return "newmark" if exact_part(condensed(system).system, settings, profile) is None else "exact"


def exact_part(system: CoupledSystem, settings: TransientSettings, profile: SpeedProfile) -> LinearPart | None:
    """Linear part of the exact method; None for Newmark's method.

    Raises
    ------
    TransientError
        As :func:`integration_method`.
    """
    if settings.method == "newmark":
        return None
    reason = ""
    if not profile.is_steady:
        reason = "the speed varies, and with it the machine"
    elif system.timed_loads:
        reason = "a load is a table over time"
    elif system.turning_names:
        reason = f"the directions of {', '.join(system.turning_names)} turn with a carrier"
    elif not system.is_smooth:
        reason = "it knows no nonlinear bearings" if system.nonlinear else "it knows no friction between the teeth"
    else:
        try:
            return steady_part(system)
        except PeriodicError as error:
            reason = str(error)
    if settings.method == "exact":
        raise TransientError(f"exponential collocation does not apply: {reason}; use Newmark's method")
    return None


def steady_part(system: CoupledSystem) -> LinearPart:
    """Return the linear part, its rates in units of the fastest mesh, load or mode."""
    rates = [2.0 * np.pi * abs(contact.mesh_frequency) for contact in system.contacts]
    rates += [abs(load.frequency) for load in system.harmonic_loads]
    return linear_part(system, max(rates, default=0.0) or system.highest_frequency or 1.0, repeats=False)


class CollocationStepper:
    """Exponential collocation, a :class:`gearwhine.coupling.time.integration.Stepper`; a step is an element of time."""

    steps_in_one = ORDER  # an element has this many places and stands for as many steps
    order = 6.0  # at least, kinks in the laws' tables included
    levels = 2
    too_fine = "elements below {step:.1e} s; raise the tolerance"

    def __init__(
        self, part: LinearPart, settings: TransientSettings, outputs: TransientOutputs, profile: SpeedProfile
    ) -> None:
        self.system, self._part, self._settings = part.system, part, settings
        self.arrays = kernel_arrays(part.system, outputs, settings.beta, settings.gamma)
        self.grow_to = _MUCH_BETTER * settings.tolerance
        self._coarsest = ORDER * coarsest_step(part.system, profile, settings.largest_step)
        self._record = CollocationRecord(part, outputs, self.arrays.contacts)
        self._steps = empty_steps(part.reference, np.zeros(_SIZES), self._coarsest, inner=True)
        self._shape = part.reference.eigenvalue.size, ORDER, len(part.system.contacts)
        self._trace = empty_trace(0, *self._shape)
        self._undisturbed = np.zeros((0, 2 * self._shape[0]))
        # Below this size the motion is rounding of the reference's response.
        magnitude = float(np.linalg.norm(part.mean) + np.abs(part.amplitudes).sum())
        self._quiet = (1e-9 * magnitude) ** 2 + 1e-300

    def begin_block(self, state: Checkpoint, bounds: FloatArray, samples: Samples, *, compiles: bool) -> None:
        """Prepare for a block.

        The sizes with exact matrices and the initial forces of Newton's iteration are new in every block, so that a run
        that continues from a checkpoint does exactly the same.
        """
        self._sizes, self._work = _Sizes(self._steps, _SAME_SIZE * self._coarsest), element_work(*self._shape)
        self._free = self._record.free_motion(state)
        self._z = self._part.amplitudes_of(self._part.state(state.q, state.v, state.time), state.time)
        self._most_stretches = _FIRST_STRETCHES
        if compiles:
            trace, _ = self._elements(bounds[:1], np.zeros(0, dtype=np.int64))
            self._record.write(trace, self._free, np.zeros(0), samples, 0)
            self._record.add(state, trace, self._steps, self._free, np.zeros_like(state.q))

    def chunk(self, bounds: FloatArray, step: float) -> int:
        """Return the number of stretches between ``bounds`` to attempt at once."""
        elements = np.cumsum(_pieces(bounds, step))
        return min(max(1, min(self._most_stretches, int(np.searchsorted(elements, _ELEMENTS)))), len(bounds) - 1)

    def attempt(self, state: Checkpoint, bounds: FloatArray, step: float, samples: Samples) -> Attempt:
        """Integrate over the stretches between ``bounds``, each cut into equal elements."""
        pieces = _pieces(bounds, step)
        self._chunk, self._end = self._elements(bounds, pieces)
        q, v = self._record.motion(self._end, self._free, float(bounds[-1]))
        error = self._chunk.error
        local = float(np.sqrt(error[:, 0].max() / (error[:, 1].mean() + self._quiet)))
        return Attempt(q, v, local, len(error), float((np.diff(bounds) / pieces).min()))

    def accept(self, state: Checkpoint, done: float, samples: Samples) -> Checkpoint:
        """Return the state after the last attempt, with its work, contact figures and samples."""
        reached, _ = self._record.motion(self._end, self._free, done)
        after = self._record.add(state, self._chunk, self._steps, self._free, reached - state.q)
        if done > self._settings.record_from:
            times = self._times_until(done, state.sample)
            self._record.write(self._chunk, self._free, times, samples, state.sample)
            after = replace(after, sample=state.sample + len(times))
        self._z, self._most_stretches = self._end, min(2 * self._most_stretches, _STRETCHES)
        return after

    def last_touch(self, state: Checkpoint, begin: float, done: float) -> tuple[FloatArray, float]:
        """Last touches up to the end of the chunk that diverged."""
        return self._record.contact_figures(state, self._chunk)[:, 3], done

    def _times_until(self, done: float, first: int) -> FloatArray:
        """Return times of the samples from number ``first`` on that are no later than ``done`` [s]."""
        settings = self._settings
        # One more sample than rounding may leave out.
        count = int((done - settings.record_from) / settings.sample_interval) + 2 - first
        times = sample_times(settings, first, max(min(count, settings.samples - first), 0))
        return times[times <= done]

    def _elements(self, stretches: FloatArray, pieces: IntArray) -> tuple[Trace, FloatArray]:
        """Trace of the elements of some stretches of time, and the amplitudes at their end.

        The trace holds until the next call.
        """
        from gearwhine.coupling.collocation.integration_kernels import NO_BALANCE, NO_ROOM, integrate_elements

        reference, modes = self._part.reference, len(self._part.eigenvalues)
        lengths = np.diff(stretches) / pieces
        length, slots = np.repeat(lengths, pieces), np.repeat(self._sizes.slots(lengths), pieces)
        within = np.arange(len(length)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        starts = np.repeat(stretches[:-1], pieces) + within * length
        room = _CUTS + 5 * len(length)
        if room > len(self._trace.start):
            self._trace = empty_trace(room, *self._shape)
        trace, end = self._trace, self._z.copy()
        head = reference, self.arrays.contacts, self._steps, starts, length, slots, end, self._undisturbed
        count, _, wrong = integrate_elements(*head, modes, trace, 0, self._work)
        where = f"after t = {trace.start[max(int(count) - 1, 0)]:.6g} s"
        if wrong == NO_BALANCE:
            raise TransientError(f"{where} the teeth's forces do not balance; expected a law that grows")
        if wrong == NO_ROOM:
            raise TransientError(f"{where} the flanks chatter without end; give the mesh some damping")
        return first_elements(trace, int(count)), end


def _pieces(bounds: FloatArray, size: float) -> IntArray:
    """Count equal elements, no larger than ``size`` [s], in each stretch between the bounds."""
    return np.maximum(np.ceil(np.diff(bounds) / size - 1e-9), 1.0).astype(np.int64)


class _Sizes:
    """Sizes of elements with exact matrices; all other sizes take those of the ladder."""

    def __init__(self, steps: Steps, unit: float) -> None:
        self._steps, self._unit, self._known = steps, unit, dict[int, int]()

    def slots(self, lengths: FloatArray) -> IntArray:
        """Slot of each length, -1 for none: the first sizes get one, while there is room."""
        # Sizes that differ by rounding are one.
        keys, first, which = np.unique(np.rint(lengths / self._unit), return_index=True, return_inverse=True)
        slots = np.full(len(keys), -1, dtype=np.int64)
        for i, key in enumerate(keys.astype(np.int64).tolist()):
            if key not in self._known and len(self._known) < _SIZES:
                self._known[key] = len(self._known)
                self._steps.size[self._known[key]] = lengths[first[i]]
                self._steps.filled[self._known[key]] = 0
            slots[i] = self._known.get(key, -1)
        return slots[which]
