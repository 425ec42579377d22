r"""Matrices of a collocation element, compiled: exponentials and their integrals with the element's polynomials.

Importing this module imports numba.
"""

import cmath
import math

import numpy as np
import numpy.typing as npt

from coupling.periodic.arrays import Reference, Steps
from coupling.periodic.collocation import AT_END, MISSING, MONOMIALS, ORDER, PLACES
from rotors.compiled import uncounted

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_MOMENTS = ORDER + 2
_NEAR_END = 1.0  # largest |λ t| of a series of powers: no term of it is larger than its sum
_SERIES_WITHIN = 0.7  # of |z|: beyond, the recursion upwards loses no more than two digits of the highest
_TERMS = 40
_OVER: FloatArray = 1.0 / np.arange(1.0, _MOMENTS + _TERMS)
"""1 / 1, 1 / 2, ...: a division takes as long as all the rest of a term."""


@uncounted()
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


@uncounted()
def end_matrices(
    reference: Reference, h: float, part: float, decay: FloatArray, source: FloatArray, integral: ComplexArray
) -> None:
    """Matrices from an element's start and from its forces to the amplitudes at a part of its size h."""
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


@uncounted()
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
        turned = reference.eigenvalue[m] * h * part
        grown = cmath.exp(turned)
        total = grown * complex(z[m], z[count + m])
        moments(turned, grown, ORDER, integral)
        for b in range(c):
            sent = 0.0j
            for k in range(ORDER):
                sent += integral[k] * coefficient[k, b]
            total -= sent * reference.source[m, b]
        end[m], end[count + m] = total.real, total.imag


@uncounted(fastmath={"contract"})
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
    """As :func:`advance_to`, where the amplitudes at the end of the element are known already, for a part near 1.

    From there on by their power series, of as many terms as the fastest mode needs.
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


@uncounted()
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
                steps.felt[slot, i * c + a, m] = seen.real
                steps.felt[slot, i * c + a, count + m] = -seen.imag
                seen = complex(reference.rate[a, m], -reference.rate[a, count + m]) * grown
                steps.felt[slot, n + i * c + a, m] = seen.real
                steps.felt[slot, n + i * c + a, count + m] = -seen.imag
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
