r"""Exponential collocation from element to element, compiled, with exactly placed switches of contact.

Importing this module imports numba.

The linear machine with its teeth at their mean stiffness k̄ and damping c̄ has eigenvalues λ, and in its amplitudes z
the whole machine is

    z' = λ z - b g,        g = f(δ, δ', t) - k̄ δ - c̄ δ',        δ = Re Σ d z,

the reference's own response to the loads being amplitudes that no contact changes. Over an element of size h
the excess forces g are the polynomial through their values at the Gauss places, with which the equation is solved
exactly:

    z(h) = e^{λh} z(0) - ∫₀ʰ e^{λ(h - t)} b g(t) dt,

so no mode is too stiff for a step; only the excess has to be resolved. The values at the places follow from Newton's
method on the law.

Where the law changes its branch within an element (teeth meet or part, another pair takes load), the element ends at
that moment, found to rounding. Up to there and a little beyond, the motion is smooth: so a size of the ladder serves
whose last place is just before the switch, and the same integral to a part of it, which may be a little more than 1,
gives the state at the switch.
"""

import math

import numpy as np
import numpy.typing as npt

from coupling.contact_kernels import DAMPING, FORCE, PHASE_SLOPE
from coupling.kernel_arrays import Contacts
from coupling.periodic.arrays import Reference, Steps, Trace
from coupling.periodic.collocation import INSIDE, ORDER, PLACES
from coupling.periodic.element import (
    estimate,
    held_energy,
    interpolated,
    law,
    solve_element,
)
from coupling.periodic.element_matrices import carry_on, fill_step
from coupling.periodic.element_work import Work
from coupling.periodic.switches import branch, first_switch
from coupling.periodic.variations import cross, jump_at, vary
from rotors.compiled import uncounted

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_MOST_CUTS = 40  # of one element; with more, the flanks graze each other and cuts gain nothing
_TRIES = 10  # sizes for one switch
_BEYOND = 0.06  # part of a size by which its motion is extended past its end
NO_BALANCE, NO_ROOM = 1, 2


@uncounted()
def rung(reference: Reference, steps: Steps, length: float, work: Work) -> int:
    """Slot of the ladder's size nearest to a length, filled in."""
    first, last = steps.ladder[0], steps.size.size - 1
    ratio = math.log(steps.size[first] / steps.size[first + 1])
    slot = int(min(max(first + round(math.log(steps.size[first] / length) / ratio), first), last))
    if steps.filled[slot] == 0:
        fill_step(reference, steps, slot, work.integral, work.values)
    return slot


@uncounted(forceinline=True)
def write_element(
    reference: Reference,
    contacts: Contacts,
    steps: Steps,
    slot: int,
    time: float,
    length: float,
    z: FloatArray,
    modes: int,
    trace: Trace,
    count: int,
    work: Work,
) -> None:
    """Write an accepted element into the trace."""
    c, h = reference.stiffness.size, steps.size[slot]
    n = ORDER * c
    part = length / h
    trace.start[count], trace.size[count], trace.part[count], trace.slot[count] = time, length, part, slot
    for i in range(z.size):
        trace.state[count, i] = z[i]
    for i in range(ORDER):
        for a in range(c):
            row = i * c + a
            v = work.rate[i + 1, a]
            trace.excess[count, i, a] = work.excess[row]
            trace.force[count, i, a] = work.laws[row, FORCE]
            trace.compression[count, i, a] = work.delta[i + 1, a]
            trace.loss[count, i, a] = work.laws[row, DAMPING] * v * v
            trace.turning[count, i, a] = work.laws[row, PHASE_SLOPE]
    trace.energy[count, 0] = held_energy(work.laws, n, c)
    u = part - INSIDE
    for a in range(c):
        # Just before the end, which a switch may have moved since the laws were evaluated.
        x, v = interpolated(work.delta, a, u), interpolated(work.rate, a, u)
        law(contacts, a, time + u * h, x, v, work.laws, n + c + a)
        work.looked[2, a], work.looked[3, a] = x, v
        trace.apart[count, a] = 1.0 if branch(reference, a, work.laws, n + a) == 0 else 0.0
    trace.energy[count, 1] = held_energy(work.laws, n + c, c)
    estimate(reference, steps, slot, part, z, modes, work)
    trace.error[count, 0], trace.error[count, 1] = work.measure[0], work.measure[1]


@uncounted()
def integrate_elements(
    reference: Reference,
    contacts: Contacts,
    steps: Steps,
    starts: FloatArray,
    sizes: FloatArray,
    slots: IntArray,
    z: FloatArray,
    columns: FloatArray,
    modes: int,
    trace: Trace,
    held: int,
    work: Work,
) -> tuple[int, int, int]:
    """Integrate the amplitudes z and their disturbances through elements, each of a slot's size or, at -1, of any.

    Disturbances as in :mod:`coupling.periodic.variations`. The trace holds ``held`` elements before. Returns the number
    of elements after, the number of cuts, and 0, ``NO_BALANCE`` or ``NO_ROOM``.
    """
    c = reference.stiffness.size
    count, cuts = held, 0
    for element in range(starts.size):
        time, left = starts[element], sizes[element]
        whole, cuts_here = left, 0
        stop = time + whole * (1.0 - INSIDE)
        slot = slots[element]
        while True:
            if slot < 0:
                slot = rung(reference, steps, left, work)
            elif steps.filled[slot] == 0:
                fill_step(reference, steps, slot, work.integral, work.values)
            tries = 0
            while True:
                solved = solve_element(reference, contacts, steps, slot, time, z, work)
                h = steps.size[slot]
                # An element of a size that occurs is all of it; beyond a size's end it reaches only as far as
                # evaluated.
                part = 1.0 if slot < steps.ladder[0] else left / h
                furthest = min(part - INSIDE, 1.0 + _BEYOND)
                if part >= 1.0 + _BEYOND:
                    part = 1.0
                which, at = -1, 2.0
                if cuts_here < _MOST_CUTS:
                    at, which = first_switch(reference, contacts, time, h, stop, furthest, work)
                if at * h > (1.0 - 1e-9) * left or at * h < 1e-11 * whole:
                    which = -1
                if which < 0 or at > PLACES[ORDER - 1] or tries == _TRIES:
                    break
                # Some places lie beyond the switch: again with a size that ends near it.
                closer = rung(reference, steps, at * h, work)
                if closer == slot:
                    break
                tries, slot = tries + 1, closer
            if which >= 0:
                part = at
            if which < 0 and not solved:
                return count, cuts, NO_BALANCE
            if count >= trace.start.size:
                return count, cuts, NO_ROOM
            length = part * h
            write_element(reference, contacts, steps, slot, time, length, z, modes, trace, count, work)
            count += 1
            if columns.shape[0] > 0:
                vary(reference, steps, slot, part, columns, work)
            if part != 1.0:
                carry_on(reference, h, part, z, work.excess, work.end, work.coefficient, work.integral, work.term)
            for i in range(z.size):
                z[i] = work.end[i]
            if left - length <= 1e-12 * whole:
                break
            cuts_here += 1
            if which >= 0:
                cuts += 1
                if columns.shape[0] > 0:
                    inside = 1e-5 * min(length, left - length)
                    x, v = interpolated(work.delta, which, part), interpolated(work.rate, which, part)
                    row = ORDER * c + 2 * c
                    jump = jump_at(reference, contacts, which, time + length, x, v, inside, work.laws, row)
                    if jump != 0.0:
                        cross(reference, which, jump, columns)
            time += length
            left -= length
            slot = -1
    return count, cuts, 0
