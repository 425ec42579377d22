"""Dense output of exponential collocation, compiled: the motion between the Gauss points of a trace.

Importing this module imports numba.
"""

import cmath

import numpy as np
import numpy.typing as npt

from coupling.contact_kernels import FORCE
from coupling.kernel_arrays import Contacts
from coupling.periodic.arrays import Reference, Trace
from coupling.periodic.collocation import BINOMIAL, MONOMIALS, ORDER
from coupling.periodic.element import advance, law
from coupling.periodic.element_matrices import advance_to, moments
from coupling.periodic.element_work import Work
from rotors.compiled import counted

FloatArray = npt.NDArray[np.float64]

_EVEN = 1e-6  # part of the spacing by which times at even spacing may miss it


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
        # The excess about the time before, in spacings.
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
