"""The figures of an exact march's proof, compiled: amplitudes within elements, and what the contacts come to.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from coupling.kernel_arrays import Contacts
from coupling.periodic.arrays import Steps, Trace
from coupling.periodic.collocation import GAUSS, MONOMIALS, ORDER, PLACES
from coupling.periodic.element import advance
from rotors.compiled import uncounted

FloatArray = npt.NDArray[np.float64]


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


@uncounted()
def amplitudes_within(
    steps: Steps,
    trace: Trace,
    excess: FloatArray,
    first: int,
    last: int,
    out: FloatArray,
    times: FloatArray,
    weights: FloatArray,
) -> None:
    """Amplitudes (b s, 2 m) at the places of b elements, the places' times (b s,), and weights of integrals (b, s).

    ``excess`` (e, s c) is the trace's. Columns of ``out`` beyond the amplitudes are left as they are.
    """
    for element in range(first, last):
        weights_of(trace, element, weights[element - first])
        slot, h = trace.slot[element], trace.size[element] / trace.part[element]
        for i in range(ORDER):
            row = (element - first) * ORDER + i
            times[row] = trace.start[element] + PLACES[i] * h
            decay, source = steps.inner_decay[slot, i], steps.inner_source[slot, i]
            advance(decay, source, trace.state[element], excess[element], out[row, : trace.state.shape[1]])


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
