"""Energy balance of exponential collocation, compiled: work, losses and contact figures of a trace.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from coupling.kernel_arrays import Contacts
from coupling.periodic.arrays import FreeMotion, Powers, PowersRoom, Steps, Trace
from coupling.periodic.collocation import GAUSS, MONOMIALS, ORDER, PLACES
from coupling.periodic.element import advance
from coupling.row_kernels import SUMS, project
from rotors.compiled import counted, inner, uncounted

FloatArray = npt.NDArray[np.float64]


@uncounted()
def weights_of(trace: Trace, element: int, out: FloatArray) -> None:
    """Quadrature weights [s] at the places (s,) over an element; Gauss weights where it is all of its size."""
    part = trace.part[element]
    h = trace.size[element] / part
    for j in range(ORDER):
        if part == 1.0:
            out[j] = h * GAUSS[j]
            continue
        total, power = 0.0, h
        for k in range(ORDER):
            power *= part
            total += MONOMIALS[j, k] * power / (k + 1)
        out[j] = total


@uncounted()
def amplitudes_of(
    steps: Steps, trace: Trace, excess: FloatArray, free: FreeMotion, first: int, room: PowersRoom
) -> int:
    """Amplitudes at the places of a batch of elements, and quadrature weights; returns the number of elements.

    ``excess`` (e, s c) is the trace's.
    """
    size, count = trace.state.shape[1], int(min(room.weights.shape[0], trace.start.size - first))
    for number in range(count):
        element = first + number
        weights_of(trace, element, room.weights[number])
        slot, h = trace.slot[element], trace.size[element] / trace.part[element]
        for i in range(ORDER):
            amplitude = room.amplitude[number * ORDER + i]
            decay, source = steps.inner_decay[slot, i], steps.inner_source[slot, i]
            advance(decay, source, trace.state[element], excess[element], amplitude[:size])
            after = trace.start[element] + PLACES[i] * h - free.time[0]
            for j in range(free.rate.size):
                amplitude[size + j] = free.rate[j] + free.acceleration[j] * after
    return count


@inner(fastmath=SUMS, forceinline=True)
def lost_and_held(loss: FloatArray, rate: FloatArray) -> tuple[float, float]:
    """Power loss by damping at some rates (n,), and twice their kinetic energy."""
    lost, held = 0.0, 0.0
    for k in range(rate.size):
        square = rate[k] * rate[k]
        lost += loss[k] * square
        held += square
    return lost, held


@uncounted()
def add_batch(powers: Powers, room: PowersRoom, count: int, totals: FloatArray) -> None:
    """Add the powers of a batch with known amplitudes and rates, and keep the largest kinetic energy."""
    for number in range(count):
        for i in range(ORDER):
            amplitude, rate = room.amplitude[number * ORDER + i], room.rate[number * ORDER + i]
            taken, held = lost_and_held(powers.loss, rate)
            if powers.skew.shape[0] > 0:
                project(powers.skew, rate, room.along)
                for j in range(powers.skew.shape[0]):
                    taken += 0.5 * amplitude[j] * room.along[j]
            pushed = 0.0
            project(powers.pushing, rate, room.along)
            for j in range(powers.riding.size):
                pushed += amplitude[powers.riding[j]] * room.along[j]
            totals[0] += room.weights[number, i] * pushed
            totals[1] += room.weights[number, i] * taken
            totals[3] = max(totals[3], 0.5 * held)


@counted()
def add_powers(
    steps: Steps,
    trace: Trace,
    excess: FloatArray,
    powers: Powers,
    free: FreeMotion,
    room: PowersRoom,
    totals: FloatArray,
) -> None:
    """Add the work of the loads and the losses without those of the teeth [J], and keep the largest kinetic energy.

    ``excess`` (e, s c) is the trace's, ``totals`` (5,) are those of :class:`coupling.march_run.Checkpoint`. Rates of a
    batch of elements are one product, for their rows do not fit the innermost cache beside an element's matrices.
    """
    for first in range(0, trace.start.size, room.weights.shape[0]):
        count = amplitudes_of(steps, trace, excess, free, first, room)
        np.dot(room.amplitude, powers.rate, room.rate)
        add_batch(powers, room, count, totals)


@uncounted()
def add_contacts(
    trace: Trace, contacts: Contacts, stored: float, weights: FloatArray, totals: FloatArray, figures: FloatArray
) -> float:
    """Add the losses by the contacts' damping, and the work of the rotating teeth: ∂U/∂p p' - f e' [J].

    ``figures`` (c, 4) are impulse, time apart, largest force and last touch of each contact. ``stored`` is the energy
    in the teeth before, the result that after: it jumps where pairs enter or leave contact.
    """
    lost, turned = 0.0, 0.0
    for element in range(trace.start.size):
        weights_of(trace, element, weights)
        h = trace.size[element] / trace.part[element]
        turned += trace.energy[element, 0] - stored
        stored = trace.energy[element, 1]
        for a in range(contacts.phase.size):
            touching = False
            for i in range(ORDER):
                force = trace.force[element, i, a]
                power = contacts.rate[a] * trace.turning[element, i, a]
                for m in range(contacts.errors.shape[1]):
                    w = contacts.errors[a, m, 1]
                    angle = w * (trace.start[element] + h * PLACES[i]) + contacts.errors[a, m, 2]
                    power += force * contacts.errors[a, m, 0] * w * math.sin(angle)
                turned += weights[i] * power
                lost += weights[i] * trace.loss[element, i, a]
                figures[a, 0] += weights[i] * force
                figures[a, 2] = max(figures[a, 2], force)
                touching = touching or force > 0.0
            # Flanks that touch without a force, where the damping would pull, count as apart; switches bound those.
            if touching:
                figures[a, 3] = max(figures[a, 3], trace.start[element] + trace.size[element])
            else:
                figures[a, 1] += trace.size[element]
    totals[1] += lost
    totals[2] += turned
    return stored
