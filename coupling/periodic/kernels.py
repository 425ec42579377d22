r"""The march over a period, compiled: exponential collocation with exactly placed switches.

Importing this module imports numba.

The linear machine with its teeth at their mean stiffness k̄ and damping c̄ has eigenvalues λ, and in its amplitudes z
the whole machine is

    z' = λ z - b g,        g = f(δ, δ', t) - k̄ δ - c̄ δ',        δ = δ_p(t) + Re Σ d z,

δ_p being the compression in the reference's own periodic response to the loads. Over an element of size h the excess
forces g are the polynomial through their values at the Gauss places, with which the equation is solved exactly:

    z(h) = e^{λh} z(0) - ∫₀ʰ e^{λ(h - t)} b g(t) dt,

so no mode is too stiff for a step; only the excess has to be resolved. The values at the places follow from Newton's
method on the law. Where the law changes its branch within an element (teeth meet or part, another pair takes load), the
element is cut at that moment, found to rounding.
"""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np
import numpy.typing as npt
from numba import njit

from coupling.gears.kernels import tooth_force
from coupling.periodic.arrays import Reference, Steps, Trace
from coupling.periodic.collocation import BARYCENTRIC, MONOMIALS, ORDER, PLACES, POINTS

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]
Laws = tuple[Any, ...]

_NEWTON_STEPS = 40
_INSIDE = 1e-6  # part of an element by which a look at its ends stands inside
_MOST_CUTS = 40  # of one element; beyond, the flanks graze each other and the cuts gain nothing
_BEYOND = 0.05  # how far past an element's end its compression is carried on in the search of a switch
NO_BALANCE, NO_ROOM = 1, 2


@njit(cache=True, nogil=True)
def moments(z: complex, out: ComplexArray) -> None:
    """∫₀¹ e^{z(1-u)} uᵏ du for k = 0 ... ORDER - 1."""
    if abs(z) < 5.0:
        term = complex(1.0 / ORDER)
        total = term
        for i in range(1, 60):
            term *= z / (ORDER + i)
            total += term
            if abs(term) < 1e-18 * abs(total):
                break
        out[ORDER - 1] = total
        for k in range(ORDER - 1, 0, -1):
            out[k - 1] = (1.0 + z * out[k]) / k
    else:
        out[0] = (cmath.exp(z) - 1.0) / z
        for k in range(1, ORDER):
            out[k] = (k * out[k - 1] - 1.0) / z


@njit(cache=True, nogil=True)
def step_matrices(reference: Reference, h: float, steps: Steps, slot: int) -> None:
    """Fill in what an element of size h needs."""
    c = reference.stiffness.size
    steps.size[slot] = h
    steps.flexibility[slot] = 0.0
    steps.rate_flexibility[slot] = 0.0
    integral = np.empty(ORDER, dtype=np.complex128)
    for m in range(reference.eigenvalue.size):
        z = reference.eigenvalue[m] * h
        steps.decay[slot, m] = cmath.exp(z)
        moments(z, integral)
        for j in range(ORDER):
            total = 0.0j
            for k in range(ORDER):
                total += MONOMIALS[j, k] * integral[k]
            for b in range(c):
                steps.source[slot, m, j * c + b] = h * total * reference.source[m, b]
        for i in range(ORDER):
            place = PLACES[i]
            grown = cmath.exp(z * place)
            for a in range(c):
                steps.displacement[slot, i, a, m] = reference.displacement[a, m] * grown
                steps.rate[slot, i, a, m] = reference.rate[a, m] * grown
            moments(z * place, integral)
            for j in range(ORDER):
                total, power = 0.0j, place
                for k in range(ORDER):
                    total += MONOMIALS[j, k] * power * integral[k]
                    power *= place
                for b in range(c):
                    sent = h * total * reference.source[m, b]
                    for a in range(c):
                        steps.flexibility[slot, i * c + a, j * c + b] += (reference.displacement[a, m] * sent).real
                        steps.rate_flexibility[slot, i * c + a, j * c + b] += (reference.rate[a, m] * sent).real


@njit(cache=True, nogil=True)
def fill_steps(reference: Reference, sizes: FloatArray, steps: Steps) -> None:
    """Fill in the elements of the given sizes."""
    for slot in range(sizes.size):
        step_matrices(reference, sizes[slot], steps, slot)


@njit(cache=True, nogil=True)
def particular(reference: Reference, a: int, time: float) -> tuple[float, float]:
    """Compression of a contact and its rate in the reference's own response."""
    delta, rate = reference.mean[a], 0.0
    for i in range(reference.frequency.size):
        w = reference.frequency[i]
        turned = reference.phasor[a, i] * cmath.exp(1j * w * time)
        delta += turned.real
        rate -= w * turned.imag
    return delta, rate


@njit(cache=True, nogil=True)
def compression(reference: Reference, a: int, time: float, z: ComplexArray) -> tuple[float, float]:
    """Compression of a contact and its rate, from the amplitudes."""
    delta, rate = particular(reference, a, time)
    for m in range(z.size):
        delta += (reference.displacement[a, m] * z[m]).real
        rate += (reference.rate[a, m] * z[m]).real
    return delta, rate


@njit(cache=True, nogil=True)
def law_at(
    reference: Reference, laws: Laws, a: int, time: float, delta: float, rate: float
) -> tuple[float, float, float, float, float, int]:
    """The law of one contact; see :func:`coupling.gears.kernels.tooth_force`."""
    return tooth_force(reference.phase[a] + reference.mesh_rate[a] * time, delta, rate, *laws[a])


@njit(cache=True, nogil=True)
def branch(reference: Reference, laws: Laws, a: int, time: float, delta: float, rate: float) -> int:
    """Which smooth branch the law is on: the number of touching pairs, and what the damping does."""
    law = law_at(reference, laws, a, time, delta, rate)
    if law[5] == 0:
        return 0
    if law[0] == 0.0 and law[1] == 0.0:
        return 4 * law[5] + 1
    if law[2] < reference.full_damping[a] * (1.0 - 1e-14):
        return 4 * law[5] + 2
    return 4 * law[5] + 3


@njit(cache=True, nogil=True)
def interpolated(values: FloatArray, a: int, u: float) -> float:
    """The polynomial through values (ORDER + 2, c) at the points, at u."""
    above, below = 0.0, 0.0
    for i in range(ORDER + 2):
        apart = u - POINTS[i]
        if apart == 0.0:
            return float(values[i, a])
        weight = BARYCENTRIC[i] / apart
        above += weight * values[i, a]
        below += weight
    return above / below


@njit(cache=True, nogil=True)
def eliminate(matrix: FloatArray, right: FloatArray) -> None:
    """Gaussian elimination with row exchanges; the columns of ``right`` (n, p) become the solutions.

    Systems are as small as the places times the contacts, for which LAPACK's call would not pay.
    """
    n, p = right.shape[0], right.shape[1]
    for column in range(n):
        pivot = column
        for row in range(column + 1, n):
            if abs(matrix[row, column]) > abs(matrix[pivot, column]):
                pivot = row
        if pivot != column:
            for j in range(n):
                matrix[column, j], matrix[pivot, j] = matrix[pivot, j], matrix[column, j]
            for j in range(p):
                right[column, j], right[pivot, j] = right[pivot, j], right[column, j]
        for row in range(column + 1, n):
            factor = matrix[row, column] / matrix[column, column]
            for j in range(column, n):
                matrix[row, j] -= factor * matrix[column, j]
            for j in range(p):
                right[row, j] -= factor * right[column, j]
    for row in range(n - 1, -1, -1):
        for i in range(row + 1, n):
            for j in range(p):
                right[row, j] -= matrix[row, i] * right[i, j]
        for j in range(p):
            right[row, j] /= matrix[row, row]


@njit(cache=True, nogil=True)
def solve_element(
    reference: Reference,
    laws: Laws,
    steps: Steps,
    slot: int,
    time: float,
    z: ComplexArray,
    end: ComplexArray,
    excess: FloatArray,
    delta: FloatArray,
    rate: FloatArray,
    force: FloatArray,
    slope: FloatArray,
    rate_slope: FloatArray,
) -> bool:
    """Excess forces at the places and amplitudes at the end.

    ``excess``, ``force`` and the slopes of the excess by compression and rate have shape (s c,); ``delta`` and
    ``rate`` (s + 2, c) hold the ends too.
    """
    c, h = reference.stiffness.size, steps.size[slot]
    n = ORDER * c
    base, base_rate = np.empty(n), np.empty(n)
    for a in range(c):
        delta[0, a], rate[0, a] = compression(reference, a, time, z)
        for i in range(ORDER):
            x, v = particular(reference, a, time + PLACES[i] * h)
            for m in range(z.size):
                x += (steps.displacement[slot, i, a, m] * z[m]).real
                v += (steps.rate[slot, i, a, m] * z[m]).real
            base[i * c + a], base_rate[i * c + a] = x, v
    solved = n == 0
    best = math.inf
    part = 1.0
    move = np.zeros(n)
    for _ in range(_NEWTON_STEPS):
        if n == 0:
            break
        right = np.empty((n, 1))
        matrix = np.zeros((n, n))
        largest, scale = 0.0, 1e-300
        for row in range(n):
            i, a = row // c, row % c
            x, v = base[row], base_rate[row]
            for column in range(n):
                x -= steps.flexibility[slot, row, column] * excess[column]
                v -= steps.rate_flexibility[slot, row, column] * excess[column]
            delta[i + 1, a], rate[i + 1, a] = x, v
            law = law_at(reference, laws, a, time + PLACES[i] * h, x, v)
            force[row] = law[0]
            slope[row] = law[1] - reference.stiffness[a]
            rate_slope[row] = law[2] - reference.damping[a]
            if law[0] == 0.0 and law[1] == 0.0:
                rate_slope[row] = -reference.damping[a]  # held at zero: what the law returns is a loss, no slope
            right[row, 0] = law[0] - reference.stiffness[a] * x - reference.damping[a] * v - excess[row]
            largest = max(largest, abs(right[row, 0]))
            scale = max(scale, abs(law[0]) + abs(reference.stiffness[a] * x) + abs(reference.damping[a] * v))
            for column in range(n):
                matrix[row, column] = (
                    slope[row] * steps.flexibility[slot, row, column]
                    + rate_slope[row] * steps.rate_flexibility[slot, row, column]
                )
            matrix[row, row] += 1.0
        if largest <= 1e-13 * scale:
            solved = True
            break
        if largest > best and part > 0.02:
            part *= 0.5
            for row in range(n):
                excess[row] -= part * move[row]
            continue
        best, part = largest, 1.0
        eliminate(matrix, right)
        for row in range(n):
            move[row] = right[row, 0]
            excess[row] += move[row]
    if not solved and best <= 1e-9 * scale:
        solved = True
    for m in range(z.size):
        total = steps.decay[slot, m] * z[m]
        for column in range(n):
            total -= steps.source[slot, m, column] * excess[column]
        end[m] = total
    for a in range(c):
        delta[ORDER + 1, a], rate[ORDER + 1, a] = compression(reference, a, time + h, end)
    return solved


@njit(cache=True, nogil=True)
def first_switch(
    reference: Reference,
    laws: Laws,
    time: float,
    h: float,
    stop: float,
    furthest: float,
    delta: FloatArray,
    rate: FloatArray,
) -> tuple[float, int]:
    """Where a law first changes its branch, as a part of h, and of which contact; beyond ``furthest`` where none does.

    No law is looked at later than ``stop``.
    """
    first, which = 2.0, -1
    for a in range(reference.stiffness.size):
        before = _INSIDE
        old = branch(
            reference, laws, a, time + before * h, interpolated(delta, a, before), interpolated(rate, a, before)
        )
        for i in range(1, ORDER + 3):
            # The places, the end, and how far past it the compression is carried on.
            u = furthest if i == ORDER + 2 else min(POINTS[i], furthest)
            if i == ORDER + 1:
                u = min(1.0 - _INSIDE, furthest)
            if u <= before or before >= first:
                continue
            at = min(time + u * h, stop)
            if branch(reference, laws, a, at, interpolated(delta, a, u), interpolated(rate, a, u)) == old:
                before = u
                continue
            low, high = before, u
            for _ in range(60):
                middle = 0.5 * (low + high)
                at = min(time + middle * h, stop)
                x, v = interpolated(delta, a, middle), interpolated(rate, a, middle)
                if branch(reference, laws, a, at, x, v) == old:
                    low = middle
                else:
                    high = middle
            if high < first:
                first, which = high, a
            break
    return first, which


@njit(cache=True, nogil=True)
def gap_of_first_touch(reference: Reference, laws: Laws, a: int, time: float, near: float) -> float:
    """Compression at which the first pair touches at a time, near a compression."""
    reach = 1e-12 * reference.scale[a] + 1e-9 * abs(near)
    low, high = near, near
    for _ in range(200):
        if law_at(reference, laws, a, time, low, 0.0)[5] == 0:
            break
        low -= reach
        reach *= 1.5
    for _ in range(200):
        if law_at(reference, laws, a, time, high, 0.0)[5] > 0:
            break
        high += reach
        reach *= 1.5
    for _ in range(100):
        middle = 0.5 * (low + high)
        if law_at(reference, laws, a, time, middle, 0.0)[5] == 0:
            low = middle
        else:
            high = middle
    return high


@njit(cache=True, nogil=True)
def jump_at(reference: Reference, laws: Laws, a: int, time: float, delta: float, rate: float, inside: float) -> float:
    """Step in the force of a contact over the speed of crossing, where its flanks meet or part."""
    before = law_at(reference, laws, a, time - inside, delta - rate * inside, rate)
    after = law_at(reference, laws, a, time + inside, delta + rate * inside, rate)
    if (before[5] == 0) == (after[5] == 0):
        return 0.0
    touching, sign = (after, 1.0) if after[5] > 0 else (before, -1.0)
    if touching[0] == 0.0 or touching[2] < reference.full_damping[a] * (1.0 - 1e-14):
        return 0.0  # held at zero by the law, or its damping only fades in: no step
    later = gap_of_first_touch(reference, laws, a, time + inside, delta)
    sooner = gap_of_first_touch(reference, laws, a, time - inside, delta)
    crossing = rate - (later - sooner) / (2.0 * inside)
    # The springs start from nothing; only the damping can step.
    return sign * touching[2] * rate / crossing if crossing != 0.0 else 0.0


@njit(cache=True, nogil=True)
def vary(
    reference: Reference,
    steps: Steps,
    slot: int,
    slope: FloatArray,
    rate_slope: FloatArray,
    real: FloatArray,
    imag: FloatArray,
) -> None:
    """Carry the p variations over an element; amplitudes' real and imaginary parts, shape (m, p)."""
    c, count, p = reference.stiffness.size, real.shape[0], real.shape[1]
    n = ORDER * c
    matrix, right = np.empty((n, n)), np.zeros((n, p))
    for row in range(n):
        i, a = row // c, row % c
        for column in range(n):
            matrix[row, column] = (
                slope[row] * steps.flexibility[slot, row, column]
                + rate_slope[row] * steps.rate_flexibility[slot, row, column]
            )
        matrix[row, row] += 1.0
        for m in range(count):
            felt = slope[row] * steps.displacement[slot, i, a, m] + rate_slope[row] * steps.rate[slot, i, a, m]
            x, y = felt.real, felt.imag
            for k in range(p):
                right[row, k] += x * real[m, k] - y * imag[m, k]
    eliminate(matrix, right)
    for m in range(count):
        x, y = steps.decay[slot, m].real, steps.decay[slot, m].imag
        for k in range(p):
            kept = real[m, k]
            real[m, k] = x * kept - y * imag[m, k]
            imag[m, k] = x * imag[m, k] + y * kept
        for row in range(n):
            x, y = steps.source[slot, m, row].real, steps.source[slot, m, row].imag
            for k in range(p):
                real[m, k] -= x * right[row, k]
                imag[m, k] -= y * right[row, k]


@njit(cache=True, nogil=True)
def cross(reference: Reference, a: int, jump: float, real: FloatArray, imag: FloatArray) -> None:
    """Carry the variations over a moment at which the force of a contact steps: the sooner, the longer it acts."""
    count, p = real.shape[0], real.shape[1]
    moved = np.zeros(p)
    for m in range(count):
        x, y = reference.displacement[a, m].real, reference.displacement[a, m].imag
        for k in range(p):
            moved[k] += x * real[m, k] - y * imag[m, k]
    for m in range(count):
        x, y = jump * reference.source[m, a].real, jump * reference.source[m, a].imag
        for k in range(p):
            real[m, k] -= x * moved[k]
            imag[m, k] -= y * moved[k]


@njit(cache=True, nogil=True)
def march(
    reference: Reference,
    laws: Laws,
    steps: Steps,
    starts: FloatArray,
    slots: IntArray,
    z: ComplexArray,
    real: FloatArray,
    imag: FloatArray,
    trace: Trace,
) -> tuple[int, int, int]:
    """Carry the amplitudes z and their variations through the elements.

    Returns how many elements the trace holds, how many cuts there were, and 0, ``NO_BALANCE`` or ``NO_ROOM``.
    """
    c, m = reference.stiffness.size, z.size
    n = ORDER * c
    cut, rest = steps.size.size - 2, steps.size.size - 1
    end = np.empty(m, dtype=np.complex128)
    excess, force, slope, rate_slope = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    delta, rate = np.zeros((ORDER + 2, c)), np.zeros((ORDER + 2, c))
    count, cuts = 0, 0
    for element in range(starts.size):
        time, slot = starts[element], slots[element]
        whole = steps.size[slot]
        stop = time + whole * (1.0 - _INSIDE)
        left, cuts_here = whole, 0
        while True:
            solved = solve_element(
                reference, laws, steps, slot, time, z, end, excess, delta, rate, force, slope, rate_slope
            )
            at, which = 2.0, -1
            if cuts_here < _MOST_CUTS:
                at, which = first_switch(reference, laws, time, left, stop, 1.0, delta, rate)
            used = slot
            if at * left > (1.0 - 1e-9) * left or at * left < 1e-11 * whole:
                at, which = 2.0, -1
            if which < 0 and not solved:
                return count, cuts, NO_BALANCE
            if which >= 0:
                size = at * left
                for _ in range(10):
                    step_matrices(reference, size, steps, cut)
                    solve_element(
                        reference, laws, steps, cut, time, z, end, excess, delta, rate, force, slope, rate_slope
                    )
                    furthest = min(1.0 + _BEYOND, left / size)
                    at, found = first_switch(reference, laws, time, size, stop, furthest, delta, rate)
                    if found >= 0:
                        which = found
                    better = min(at, furthest) * size
                    moved = abs(better - size)
                    if moved <= 1e-14 * whole or better < 1e-11 * whole:
                        break
                    size = better
                used = cut
            if count >= trace.start.size:
                return count, cuts, NO_ROOM
            h = steps.size[used]
            trace.start[count], trace.size[count] = time, h
            trace.state[count] = z
            for i in range(ORDER):
                for a in range(c):
                    trace.excess[count, i, a] = excess[i * c + a]
                    trace.force[count, i, a] = force[i * c + a]
                    trace.compression[count, i, a] = delta[i + 1, a]
                    trace.rate[count, i, a] = rate[i + 1, a]
            for a in range(c):
                middle = time + 0.5 * h
                x, v = interpolated(delta, a, 0.5), interpolated(rate, a, 0.5)
                trace.apart[count, a] = 1.0 if branch(reference, laws, a, middle, x, v) == 0 else 0.0
            count += 1
            if real.shape[1] > 0:
                vary(reference, steps, used, slope, rate_slope, real, imag)
            z[:] = end
            if which < 0:
                break
            cuts += 1
            cuts_here += 1
            if real.shape[1] > 0:
                inside = 1e-5 * min(h, left - h)
                jump = jump_at(
                    reference, laws, which, time + h, delta[ORDER + 1, which], rate[ORDER + 1, which], inside
                )
                if jump != 0.0:
                    cross(reference, which, jump, real, imag)
            time += h
            left -= h
            step_matrices(reference, left, steps, rest)
            slot = rest
    return count, cuts, 0


@njit(cache=True, nogil=True)
def amplitudes_at(reference: Reference, trace: Trace, count: int, times: FloatArray) -> ComplexArray:
    """Amplitudes at ascending times within the period, shape (t, m)."""
    c, m = reference.stiffness.size, reference.eigenvalue.size
    out = np.empty((times.size, m), dtype=np.complex128)
    integral = np.empty(ORDER, dtype=np.complex128)
    element = 0
    coefficient = np.zeros((ORDER, c))
    fresh = True
    for i in range(times.size):
        while element < count - 1 and times[i] >= trace.start[element + 1]:
            element += 1
            fresh = True
        h = trace.size[element]
        if fresh:
            coefficient[:] = 0.0
            for k in range(ORDER):
                for a in range(c):
                    for j in range(ORDER):
                        coefficient[k, a] += MONOMIALS[j, k] * trace.excess[element, j, a]
            fresh = False
        u = (times[i] - trace.start[element]) / h
        for k in range(m):
            z = reference.eigenvalue[k] * h * u
            moments(z, integral)
            total = cmath.exp(z) * trace.state[element, k]
            power = u
            for p in range(ORDER):
                for a in range(c):
                    total -= h * reference.source[k, a] * power * integral[p] * coefficient[p, a]
                power *= u
            out[i, k] = total
    return out


@njit(cache=True, nogil=True)
def forces_at(
    reference: Reference, laws: Laws, times: FloatArray, delta: FloatArray, rate: FloatArray, out: FloatArray
) -> None:
    """The law at times, compressions and rates; all but the times of shape (t, c)."""
    for i in range(times.size):
        for a in range(reference.stiffness.size):
            out[i, a] = law_at(reference, laws, a, times[i], delta[i, a], rate[i, a])[0]
