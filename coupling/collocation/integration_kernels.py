r"""Exponential collocation from element to element, compiled, with exactly placed switches of contact; dense output.

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

Dense output is the motion between the Gauss points of a trace. The energy balance sums work, losses and contact figures
over a trace.

Importing this module imports numba.
"""

import cmath
import math

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.collocation.arrays import (
    BINOMIAL,
    GAUSS,
    INSIDE,
    MONOMIALS,
    ORDER,
    PLACES,
    FreeMotion,
    Powers,
    PowersRoom,
    Reference,
    Steps,
    Trace,
    Work,
)
from gearwhine.coupling.collocation.element_kernels import (
    advance,
    advance_to,
    carry_on,
    estimate,
    fill_step,
    held_energy,
    interpolated,
    law,
    moments,
    solve_element,
)
from gearwhine.coupling.collocation.switch_kernels import (
    apply_saltation,
    branch,
    first_switch,
    propagate_sensitivity,
    saltation_factor,
)
from gearwhine.coupling.connector_forces.contact_kernels import DAMPING, FORCE, PHASE_SLOPE
from gearwhine.coupling.connector_forces.dense_kernels import SUMS, project
from gearwhine.coupling.connector_forces.kernel_arrays import (
    DAMPING_LOSS,
    LARGEST_KINETIC,
    LOAD_WORK,
    ROTATION_WORK,
    Contacts,
)
from gearwhine.numerics.compiled import counted, inner, uncounted

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_MOST_CUTS = 40  # largest number of cuts of one element; beyond, the flanks graze and cuts gain nothing
_TRIES = 10  # number of ladder sizes tried for one switch
_BEYOND = 0.06  # extension of an element's motion past its end, over its size
NO_BALANCE, NO_ROOM = 1, 2


@inner()
def nearest_step_size(reference: Reference, steps: Steps, length: float, work: Work) -> int:
    """Slot of the size nearest to a length on the step-size ladder, with its matrices filled in."""
    first, last = steps.ladder[0], steps.size.size - 1
    ratio = math.log(steps.size[first] / steps.size[first + 1])
    slot = int(min(max(first + round(math.log(steps.size[first] / length) / ratio), first), last))
    if steps.filled[slot] == 0:
        fill_step(reference, steps, slot, work.integral, work.values)
    return slot


@inner(forceinline=True)
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
            trace.phase_slope[count, i, a] = work.laws[row, PHASE_SLOPE]
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
    stored: int,
    work: Work,
) -> tuple[int, int, int]:
    """Integrate the amplitudes z and their disturbances through elements; slot -1 marks an element of any size.

    Disturbances are laid out as in :mod:`gearwhine.coupling.collocation.switch_kernels`. The trace holds ``stored``
    elements at the start. Returns the number of stored elements, the number of cuts, and 0, ``NO_BALANCE`` or
    ``NO_ROOM``.
    """
    c = reference.stiffness.size
    count, cuts = stored, 0
    for element in range(starts.size):
        time, left = starts[element], sizes[element]
        whole, cuts_here = left, 0
        stop = time + whole * (1.0 - INSIDE)
        slot, reach = slots[element], left
        while True:
            if slot < 0:
                slot = nearest_step_size(reference, steps, min(left, reach), work)
            elif steps.filled[slot] == 0:
                fill_step(reference, steps, slot, work.integral, work.values)
            tries = 0
            while True:
                solved = solve_element(reference, contacts, steps, slot, time, z, work)
                h = steps.size[slot]
                # An element with a slot has the slot's whole size; beyond the end it reaches only as far as
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
                if which >= 0 and at <= PLACES[ORDER - 1] and tries < _TRIES:
                    # Some places lie beyond the switch: solve again with a size that ends near it.
                    closer = nearest_step_size(reference, steps, at * h, work)
                    if closer != slot:
                        tries, slot = tries + 1, closer
                        continue
                if solved:
                    break
                # Where an element is long for the teeth's own vibration, the forces that the law sends back change
                # the compressions by more than they came from: Newton's method may then circle around a balance, or
                # there is none. Over a short one they hardly change them, and there is one balance.
                shorter = nearest_step_size(reference, steps, 0.5 * min(h, left), work)
                if shorter == slot:
                    return count, cuts, NO_BALANCE
                tries, slot, reach = 0, shorter, steps.size[shorter]
            if which >= 0:
                part = at
            if count >= trace.start.size:
                return count, cuts, NO_ROOM
            length = part * h
            write_element(reference, contacts, steps, slot, time, length, z, modes, trace, count, work)
            count += 1
            if columns.shape[0] > 0:
                propagate_sensitivity(reference, steps, slot, part, columns, work)
            if part != 1.0:
                carry_on(reference, h, part, z, work.excess, work.end, work.coefficient, work.integral, work.term)
            for i in range(z.size):
                z[i] = work.end[i]
            if left - length <= 1e-12 * whole:
                break
            if which >= 0:
                cuts, cuts_here = cuts + 1, cuts_here + 1
                if columns.shape[0] > 0:
                    inside = 1e-5 * min(length, left - length)
                    x, v = interpolated(work.delta, which, part), interpolated(work.rate, which, part)
                    row = ORDER * c + 2 * c
                    jump = saltation_factor(reference, contacts, which, time + length, x, v, inside, work.laws, row)
                    if jump != 0.0:
                        apply_saltation(reference, which, jump, columns)
            time += length
            left -= length
            slot = -1
    return count, cuts, 0


_EVEN = 1e-6  # tolerance of evenly spaced times, over the spacing


@counted()
def amplitudes_at(reference: Reference, trace: Trace, times: FloatArray) -> FloatArray:
    """Amplitudes at ascending times, shape (t, 2 m).

    At even spacing the amplitudes within an element follow from each other by the exponentials of the spacing, equal
    for all of them, with the excess expanded about each time.
    """
    c, m = reference.stiffness.size, reference.eigenvalue.size
    out = np.empty((times.size, 2 * m))
    integral, coefficient = np.empty(ORDER, dtype=np.complex128), np.empty((ORDER, c))
    series, shifted = np.empty((ORDER, c)), np.empty(ORDER * c)
    excess = trace.excess.reshape(trace.start.size, ORDER * c)
    spacing = times[1] - times[0] if times.size > 1 else 0.0
    decay, source = np.empty((2, m)), np.empty((ORDER * c, 2 * m))
    for k in range(m):
        z = reference.eigenvalue[k] * spacing
        grown = cmath.exp(z)
        decay[0, k], decay[1, k] = grown.real, grown.imag
        moments(z, grown, ORDER, integral)
        for p in range(ORDER):
            for a in range(c):
                sent = integral[p] * spacing * reference.source[k, a]
                source[p * c + a, k], source[p * c + a, m + k] = sent.real, sent.imag
    element, of = 0, -1
    for i in range(times.size):
        while element < trace.start.size - 1 and times[i] >= trace.start[element + 1]:
            element += 1
        h = trace.size[element] / trace.part[element]
        u = (times[i] - trace.start[element]) / h
        if of != element or abs(times[i] - times[i - 1] - spacing) > _EVEN * spacing:
            of = element
            advance_to(reference, h, u, trace.state[element], excess[element], out[i], coefficient, integral)
            for p in range(ORDER):
                for a in range(c):
                    series[p, a] = 0.0
                    for j in range(ORDER):
                        series[p, a] += MONOMIALS[j, p] * trace.excess[element, j, a]
            continue
        # Expansion of the excess about the previous time, in spacings.
        u -= spacing / h
        scale = 1.0
        for p in range(ORDER):
            for a in range(c):
                total = 0.0
                for j in range(ORDER - 1, p - 1, -1):
                    total = total * u + BINOMIAL[j, p] * series[j, a]
                shifted[p * c + a] = scale * total
            scale *= spacing / h
        advance(decay, source, out[i - 1], shifted, out[i])
    return out


@counted()
def forces_at(
    contacts: Contacts, times: FloatArray, delta: FloatArray, rate: FloatArray, work: Work, out: FloatArray
) -> None:
    """Force of the contact law at times (t,), compressions and rates (t, c), into ``out`` (t, c)."""
    row = work.laws.shape[0] - 1
    for i in range(times.size):
        for a in range(contacts.phase.size):
            law(contacts, a, times[i], delta[i, a], rate[i, a], work.laws, row)
            out[i, a] = work.laws[row, FORCE]


@inner()
def weights_of(trace: Trace, element: int, out: FloatArray) -> None:
    """Quadrature weights [s] at the places (s,) over an element; Gauss weights for an element of full size."""
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


@inner()
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
def loss_and_squares(loss: FloatArray, rate: FloatArray) -> tuple[float, float]:
    """Power loss by damping at rates (n,), and the sum of their squares: twice the kinetic energy."""
    power, squares = 0.0, 0.0
    for k in range(rate.size):
        square = rate[k] * rate[k]
        power += loss[k] * square
        squares += square
    return power, squares


@inner()
def add_batch(powers: Powers, room: PowersRoom, count: int, totals: FloatArray) -> None:
    """Add the powers of a batch with known amplitudes and rates, and keep the largest kinetic energy."""
    for number in range(count):
        for i in range(ORDER):
            amplitude, rate = room.amplitude[number * ORDER + i], room.rate[number * ORDER + i]
            loss, speed_squared = loss_and_squares(powers.loss, rate)
            if powers.skew.shape[0] > 0:
                project(powers.skew, rate, room.along)
                for j in range(powers.skew.shape[0]):
                    loss += 0.5 * amplitude[j] * room.along[j]
            pushed = 0.0
            project(powers.pushing, rate, room.along)
            for j in range(powers.riding.size):
                pushed += amplitude[powers.riding[j]] * room.along[j]
            totals[LOAD_WORK] += room.weights[number, i] * pushed
            totals[DAMPING_LOSS] += room.weights[number, i] * loss
            totals[LARGEST_KINETIC] = max(totals[LARGEST_KINETIC], 0.5 * speed_squared)


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

    ``excess`` (e, s c) is the trace's, ``totals`` (5,) are those of
    :class:`gearwhine.coupling.time.integration.Checkpoint`. Rates of a batch of elements are one product, for their
    rows do not fit the innermost cache beside an element's matrices.
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
    in the teeth before the elements, the result the energy after: it jumps where pairs enter or leave contact.
    """
    lost, rotation_work = 0.0, 0.0
    for element in range(trace.start.size):
        weights_of(trace, element, weights)
        h = trace.size[element] / trace.part[element]
        rotation_work += trace.energy[element, 0] - stored
        stored = trace.energy[element, 1]
        for a in range(contacts.phase.size):
            touching = False
            for i in range(ORDER):
                force = trace.force[element, i, a]
                power = contacts.mesh_frequency[a] * trace.phase_slope[element, i, a]
                for m in range(contacts.errors.shape[1]):
                    w = contacts.errors[a, m, 1]
                    angle = w * (trace.start[element] + h * PLACES[i]) + contacts.errors[a, m, 2]
                    power += force * contacts.errors[a, m, 0] * w * math.sin(angle)
                rotation_work += weights[i] * power
                lost += weights[i] * trace.loss[element, i, a]
                figures[a, 0] += weights[i] * force
                figures[a, 2] = max(figures[a, 2], force)
                touching = touching or force > 0.0
            # Flanks that touch without a force, where the damping would pull, count as apart; switches bound those.
            if touching:
                figures[a, 3] = max(figures[a, 3], trace.start[element] + trace.size[element])
            else:
                figures[a, 1] += trace.size[element]
    totals[DAMPING_LOSS] += lost
    totals[ROTATION_WORK] += rotation_work
    return stored
