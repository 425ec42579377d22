r"""Collocation element of time, compiled: its matrices, contact forces at its Gauss points, defect of their polynomial.

The matrices are exponentials of the modes and their integrals with the element's polynomials, see
:mod:`gearwhine.coupling.collocation.integration_kernels`.

Importing this module imports numba.
"""

import cmath
import math

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.collocation.arrays import (
    AT_END,
    AT_ENDS,
    BARYCENTRIC,
    INSIDE,
    MISSING,
    MONOMIALS,
    ORDER,
    PLACES,
    POINTS,
    Reference,
    Steps,
    Work,
)
from gearwhine.coupling.connector_forces.contact_kernels import DAMPING, ENERGY, FORCE, TANGENT, evaluate_contact
from gearwhine.coupling.connector_forces.dense_kernels import SUMS, add_rows, solve_in_place
from gearwhine.coupling.connector_forces.kernel_arrays import Contacts
from gearwhine.numerics.compiled import inner

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_MOMENTS = ORDER + 2
_NEAR_END = 1.0  # largest |λ t| for the power series: no term is larger than the sum
_SERIES_WITHIN = 0.7  # largest |z| for the series; beyond it the upward recursion loses at most two digits
_TERMS = 40
_OVER: FloatArray = 1.0 / np.arange(1.0, _MOMENTS + _TERMS)
"""1 / 1, 1 / 2, ...: tabulated, as a division takes as long as the rest of a term."""


@inner()
def moments(z: complex, grown: complex, count: int, out: ComplexArray) -> None:
    """∫₀¹ e^{z(1-u)} uᵏ du for k = 0 ... count - 1, e^z being known."""
    if z.real * z.real + z.imag * z.imag < _SERIES_WITHIN**2:
        term = complex(_OVER[count - 1])
        total = term
        for i in range(_TERMS - 1):
            term *= z * _OVER[count + i]
            total += term
            if abs(term.real) + abs(term.imag) < 1e-17 * (abs(total.real) + abs(total.imag)):
                break
        out[count - 1] = total
        for k in range(count - 1, 0, -1):
            out[k - 1] = (1.0 + z * out[k]) * _OVER[k - 1]
    else:
        inverse = 1.0 / z
        out[0] = (grown - 1.0) * inverse
        for k in range(1, count):
            out[k] = (k * out[k - 1] - 1.0) * inverse


@inner()
def end_matrices(
    reference: Reference, h: float, part: float, decay: FloatArray, source: FloatArray, integral: ComplexArray
) -> None:
    """Matrices that map the amplitudes at the start and the forces to the amplitudes at a part of the size h."""
    c, count = reference.stiffness.size, reference.eigenvalue.size
    for m in range(count):
        z = reference.eigenvalue[m] * h * part
        grown = cmath.exp(z)
        decay[0, m], decay[1, m] = grown.real, grown.imag
        moments(z, grown, ORDER, integral)
        for j in range(ORDER):
            total, power = 0.0j, h * part
            for k in range(ORDER):
                total += integral[k] * (power * MONOMIALS[j, k])
                power *= part
            for b in range(c):
                sent = total * reference.source[m, b]
                source[j * c + b, m], source[j * c + b, count + m] = sent.real, sent.imag


@inner()
def advance_to(
    reference: Reference,
    h: float,
    part: float,
    z: FloatArray,
    excess: FloatArray,
    end: FloatArray,
    coefficient: FloatArray,
    integral: ComplexArray,
) -> None:
    """Amplitudes at a part of an element of size h from those at its start and the excess forces at its places."""
    c, count = reference.stiffness.size, reference.eigenvalue.size
    power = h
    for k in range(ORDER):
        power *= part
        for b in range(c):
            coefficient[k, b] = 0.0
            for j in range(ORDER):
                coefficient[k, b] += power * MONOMIALS[j, k] * excess[j * c + b]
    for m in range(count):
        exponent = reference.eigenvalue[m] * h * part
        grown = cmath.exp(exponent)
        total = grown * complex(z[m], z[count + m])
        moments(exponent, grown, ORDER, integral)
        for b in range(c):
            sent = 0.0j
            for k in range(ORDER):
                sent += integral[k] * coefficient[k, b]
            total -= sent * reference.source[m, b]
        end[m], end[count + m] = total.real, total.imag


@inner(fastmath={"contract"})
def carry_on(
    reference: Reference,
    h: float,
    part: float,
    z: FloatArray,
    excess: FloatArray,
    end: FloatArray,
    coefficient: FloatArray,
    integral: ComplexArray,
    term: FloatArray,
) -> None:
    """Advance as :func:`advance_to`, where the amplitudes at the end of the element are known, for a part near 1.

    The power series about the end has as many terms as the fastest mode needs.
    """
    c, count = reference.stiffness.size, reference.eigenvalue.size
    beyond, fastest = h * (part - 1.0), 0.0
    for m in range(count):
        value = reference.eigenvalue[m]
        fastest = max(fastest, value.real * value.real + value.imag * value.imag)
    fastest = math.sqrt(fastest) * abs(beyond)
    if fastest > _NEAR_END:
        advance_to(reference, h, part, z, excess, end, coefficient, integral)
        return
    power = beyond
    for k in range(ORDER):
        for b in range(c):
            coefficient[k, b] = 0.0
            for j in range(ORDER):
                coefficient[k, b] += power * AT_END[j, k] * excess[j * c + b]
        power *= part - 1.0
    # The force adds to the first terms of the series.
    terms, size = ORDER, 1.0
    while size > 1e-17:
        terms += 1
        size *= fastest / terms
    for i in range(end.size):
        term[i] = end[i]
    for k in range(terms):
        # All modes together, term by term: no sum waits for the one before.
        over = 1.0 / (k + 1)
        for m in range(count):
            x, y = reference.eigenvalue[m].real * beyond, reference.eigenvalue[m].imag * beyond
            p, q = term[m], term[count + m]
            term[m], term[count + m] = (x * p - y * q) * over, (x * q + y * p) * over
        if k < ORDER:
            for b in range(c):
                sent = coefficient[k, b] * over
                for m in range(count):
                    term[m] -= sent * reference.source[m, b].real
                    term[count + m] -= sent * reference.source[m, b].imag
        for i in range(end.size):
            end[i] += term[i]


@inner()
def fill_step(reference: Reference, steps: Steps, slot: int, integral: ComplexArray, values: ComplexArray) -> None:
    """Fill in the matrices of an element of a slot's size."""
    c, h, count = reference.stiffness.size, steps.size[slot], reference.eigenvalue.size
    n = ORDER * c
    for row in range(2 * n):
        for column in range(n):
            steps.flexibility[slot, row, column] = 0.0
    end_matrices(reference, h, 1.0, steps.decay[slot], steps.source[slot], integral)
    for m in range(count):
        moments(
            reference.eigenvalue[m] * h, complex(steps.decay[slot, 0, m], steps.decay[slot, 1, m]), _MOMENTS, integral
        )
        for end in range(2):
            total = 0.0j
            for k in range(_MOMENTS):
                total += integral[k] * (h * MISSING[end, k])
            for b in range(c):
                sent = total * reference.source[m, b]
                steps.missed[slot, end * c + b, m] = sent.real
                steps.missed[slot, end * c + b, count + m] = sent.imag
        for i in range(ORDER):
            place = PLACES[i]
            z = reference.eigenvalue[m] * h * place
            grown = cmath.exp(z)
            for a in range(c):
                # Re(d z) is the product of the rows Re d, -Im d with Re z, Im z.
                seen = complex(reference.displacement[a, m], -reference.displacement[a, count + m]) * grown
                steps.free_response[slot, i * c + a, m] = seen.real
                steps.free_response[slot, i * c + a, count + m] = -seen.imag
                seen = complex(reference.rate[a, m], -reference.rate[a, count + m]) * grown
                steps.free_response[slot, n + i * c + a, m] = seen.real
                steps.free_response[slot, n + i * c + a, count + m] = -seen.imag
            moments(z, grown, ORDER, integral)
            for j in range(ORDER):
                values[j] = 0.0j
                power = h * place
                for k in range(ORDER):
                    values[j] += integral[k] * (power * MONOMIALS[j, k])
                    power *= place
            if steps.inner_decay.shape[0] > 0:
                steps.inner_decay[slot, i, 0, m], steps.inner_decay[slot, i, 1, m] = grown.real, grown.imag
            for j in range(ORDER):
                for b in range(c):
                    sent = values[j] * reference.source[m, b]
                    x, y = sent.real, sent.imag
                    if steps.inner_decay.shape[0] > 0:
                        steps.inner_source[slot, i, j * c + b, m] = x
                        steps.inner_source[slot, i, j * c + b, count + m] = y
                    if x == 0.0 and y == 0.0:
                        continue
                    for a in range(c):
                        steps.flexibility[slot, i * c + a, j * c + b] += (
                            reference.displacement[a, m] * x + reference.displacement[a, count + m] * y
                        )
                        steps.flexibility[slot, n + i * c + a, j * c + b] += (
                            reference.rate[a, m] * x + reference.rate[a, count + m] * y
                        )
    steps.filled[slot] = 1


_NEWTON_STEPS = 40


@inner(forceinline=True)
def law(contacts: Contacts, a: int, time: float, delta: float, rate: float, laws: FloatArray, row: int) -> None:
    """Evaluate the law of one contact into a row."""
    evaluate_contact(contacts, a, time, delta, rate, laws, row)


@inner(fastmath=SUMS)
def product(row: FloatArray, a: int, z: FloatArray) -> float:
    """Product of a row of a matrix with the amplitudes."""
    total = 0.0
    for i in range(z.size):
        total += row[a, i] * z[i]
    return total


@inner(fastmath={"contract"})
def advance(decay: FloatArray, source: FloatArray, z: FloatArray, excess: FloatArray, end: FloatArray) -> None:
    """Amplitudes at the end or a place from those at the start and the excess forces."""
    count = decay.shape[1]
    # Each row has its own name: through indices the compiler does not vectorise.
    u, v, x, y, real, imag = decay[0], decay[1], z[:count], z[count:], end[:count], end[count:]
    for m in range(count):
        real[m] = u[m] * x[m] - v[m] * y[m]
        imag[m] = u[m] * y[m] + v[m] * x[m]
    add_rows(source, excess, -1.0, end)


@inner(forceinline=True)
def interpolated(values: FloatArray, a: int, u: float) -> float:
    """Evaluate at u the polynomial through values (ORDER + 2, c) at the Gauss points."""
    above, below = 0.0, 0.0
    for i in range(ORDER + 2):
        apart = u - POINTS[i]
        if apart == 0.0:
            return float(values[i, a])
        weight = BARYCENTRIC[i] / apart
        above += weight * values[i, a]
        below += weight
    return above / below


@inner(forceinline=True)
def solve_element(
    reference: Reference, contacts: Contacts, steps: Steps, slot: int, time: float, z: FloatArray, work: Work
) -> bool:
    """Solve for the excess forces at the places by Newton's method; compressions and rates there and at both ends."""
    c, h = reference.stiffness.size, steps.size[slot]
    n = ORDER * c
    base, excess, move, laws = work.base, work.excess, work.move, work.laws
    delta, rate, slope, rate_slope = work.delta, work.rate, work.slope, work.rate_slope
    matrix, right, end = work.matrix, work.right, work.end
    for row in range(2 * n):
        base[row] = product(steps.free_response[slot], row, z)
    for a in range(c):
        delta[0, a], rate[0, a] = product(reference.displacement, a, z), product(reference.rate, a, z)
    solved = n == 0
    best, part, scale = math.inf, 1.0, 1.0
    for i in range(n):
        move[i] = 0.0
    for _ in range(_NEWTON_STEPS):
        if n == 0:
            break
        largest, scale = 0.0, 1e-300
        for row in range(n):
            i, a = row // c, row % c
            x, v = base[row], base[n + row]
            for column in range(n):
                x -= steps.flexibility[slot, row, column] * excess[column]
                v -= steps.flexibility[slot, n + row, column] * excess[column]
            delta[i + 1, a], rate[i + 1, a] = x, v
            law(contacts, a, time + PLACES[i] * h, x, v, laws, row)
            force, tangent = laws[row, FORCE], laws[row, TANGENT]
            slope[row] = tangent - reference.stiffness[a]
            # Where the law holds the force at zero, it returns a loss and no slope.
            unmoved = force == 0.0 and tangent == 0.0
            rate_slope[row] = (0.0 if unmoved else laws[row, DAMPING]) - reference.damping[a]
            right[row, 0] = force - reference.stiffness[a] * x - reference.damping[a] * v - excess[row]
            largest = max(largest, abs(right[row, 0]))
            scale = max(scale, abs(force) + abs(reference.stiffness[a] * x) + abs(reference.damping[a] * v))
        if largest <= 1e-13 * scale:
            solved = True
            break
        if largest > best and part > 0.02:
            part *= 0.5
            for row in range(n):
                excess[row] -= part * move[row]
            continue
        best, part = largest, 1.0
        for row in range(n):
            for column in range(n):
                matrix[row, column] = (
                    slope[row] * steps.flexibility[slot, row, column]
                    + rate_slope[row] * steps.flexibility[slot, n + row, column]
                )
            matrix[row, row] += 1.0
        solve_in_place(matrix, right)
        for row in range(n):
            move[row] = right[row, 0]
            excess[row] += move[row]
    advance(steps.decay[slot], steps.source[slot], z, excess, end)
    for a in range(c):
        delta[ORDER + 1, a] = product(reference.displacement, a, end)
        rate[ORDER + 1, a] = product(reference.rate, a, end)
    return solved or best <= 1e-9 * scale


@inner(fastmath=SUMS, forceinline=True)
def estimate(reference: Reference, steps: Steps, slot: int, part: float, z: FloatArray, modes: int, work: Work) -> None:
    """Squares of the amplitude error at the end, by the defect of the excess polynomial, and of the amplitudes.

    The defect vanishes at the places; its values at both ends determine its shape. In an element that ends at a part
    of its size only the value at the start is on the law's branch; there the triangle between the last place and the
    end, which does not cancel, is added.
    """
    c = reference.stiffness.size
    n = ORDER * c
    error, h, count = work.end_error, steps.size[slot], reference.eigenvalue.size
    for i in range(error.size):
        error[i] = 0.0
    for a in range(c):
        k, d = reference.stiffness[a], reference.damping[a]
        first = work.laws[n + a, FORCE] - k * work.looked[0, a] - d * work.looked[1, a]
        last = work.laws[n + c + a, FORCE] - k * work.looked[2, a] - d * work.looked[3, a]
        for j in range(ORDER):
            at_end = AT_ENDS[1, j]
            if part != 1.0:
                at_end = MONOMIALS[j, ORDER - 1]
                for power in range(ORDER - 2, -1, -1):
                    at_end = at_end * (part - INSIDE) + MONOMIALS[j, power]
            first -= AT_ENDS[0, j] * work.excess[j * c + a]
            last -= at_end * work.excess[j * c + a]
        triangle = 0.5 * h * (1.0 - part) * last
        if part != 1.0:
            last = -first
        if triangle != 0.0:
            for m in range(modes):
                error[m] += triangle * reference.source[m, a].real
                error[count + m] += triangle * reference.source[m, a].imag
        for i in range(error.size):
            error[i] += steps.missed[slot, a, i] * first + steps.missed[slot, c + a, i] * last
    # The reference's own amplitudes have no source, and so no error.
    wrong, size = 0.0, 0.0
    for i in range(error.size):
        wrong += error[i] * error[i]
    for m in range(modes):
        size += z[m] * z[m] + z[count + m] * z[count + m]
    work.measure[0], work.measure[1] = wrong, size


@inner()
def held_energy(laws: FloatArray, first: int, count: int) -> float:
    """Energy stored in the teeth [J], summed over rows of the laws."""
    total = 0.0
    for row in range(first, first + count):
        total += laws[row, ENERGY]
    return total
