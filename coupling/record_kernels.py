"""The figures of an exact march's proof, compiled: work, losses and what the contacts come to, from a trace.

Importing this module imports numba. Element by element, with nothing kept between: memory costs more than sums here.
"""

import math

import numpy as np
import numpy.typing as npt

from coupling.kernel_arrays import Contacts
from coupling.periodic.arrays import FreeMotion, Powers, PowersRoom, Steps, Trace
from coupling.periodic.collocation import GAUSS, MONOMIALS, ORDER, PLACES
from rotors.compiled import uncounted

FloatArray = npt.NDArray[np.float64]

_SUMS = {"reassoc", "contract", "nsz"}


@uncounted()
def weights_of(trace: Trace, element: int, out: FloatArray) -> None:
    """Weights [s] at the places (s,) of an integral over an element; Gauss's own where it is all of its size."""
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


@uncounted(fastmath=_SUMS)
def amplitudes_within(steps: Steps, trace: Trace, element: int, i: int, out: FloatArray) -> None:
    """Amplitudes (2 m,) at a place of an element."""
    slot = trace.slot[element]
    for k in range(out.size // 2):
        x, y = steps.inner_decay[slot, i, k].real, steps.inner_decay[slot, i, k].imag
        out[2 * k] = x * trace.state[element, 2 * k] - y * trace.state[element, 2 * k + 1]
        out[2 * k + 1] = x * trace.state[element, 2 * k + 1] + y * trace.state[element, 2 * k]
    c = trace.excess.shape[2]
    for j in range(ORDER):
        for a in range(c):
            g = trace.excess[element, j, a]
            for k in range(out.size):
                out[k] -= steps.inner_source[slot, i, j * c + a, k] * g


@uncounted(fastmath=_SUMS)
def add_powers(
    steps: Steps, trace: Trace, powers: Powers, free: FreeMotion, room: PowersRoom, totals: FloatArray
) -> None:
    """Add what the loads give and what damping without the teeth's takes [J], and keep the largest kinetic energy.

    ``totals`` (5,) are those of :class:`coupling.marching.Checkpoint`.
    """
    amplitude, rate = room.amplitude, room.rate
    n = rate.size
    for element in range(trace.start.size):
        weights_of(trace, element, room.weights)
        h = trace.size[element] / trace.part[element]
        for i in range(ORDER):
            amplitudes_within(steps, trace, element, i, amplitude)
            after = trace.start[element] + PLACES[i] * h - free.time[0]
            for k in range(n):
                rate[k] = 0.0
            for j in range(amplitude.size):
                value = amplitude[j]
                for k in range(n):
                    rate[k] += value * powers.rate[j, k]
            for j in range(free.rate.size):
                value = free.rate[j] + free.acceleration[j] * after
                for k in range(n):
                    rate[k] += value * powers.free[j, k]
            taken, held, pushed = 0.0, 0.0, 0.0
            for k in range(n):
                square = rate[k] * rate[k]
                taken += powers.loss[k] * square
                held += square
            for j in range(powers.skew.shape[0]):
                along = 0.0
                for k in range(n):
                    along += powers.skew[j, k] * rate[k]
                taken += 0.5 * amplitude[j] * along
            for j in range(powers.riding.size):
                along = 0.0
                for k in range(n):
                    along += powers.pushing[j, k] * rate[k]
                pushed += amplitude[powers.riding[j]] * along
            totals[0] += room.weights[i] * pushed
            totals[1] += room.weights[i] * taken
            totals[3] = max(totals[3], 0.5 * held)


@uncounted()
def add_contacts(
    trace: Trace, contacts: Contacts, stored: float, weights: FloatArray, totals: FloatArray, figures: FloatArray
) -> float:
    """Add what the contacts' damping takes, and the work of the turning teeth: ∂U/∂p p' - f e' [J].

    ``figures`` (c, 4) are impulse, time apart, largest force and last touch of each contact. Given is what the teeth
    held before, returned what they hold after: it jumps where pairs come and go.
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
