r"""Collocation element of time, compiled: contact forces at its Gauss points, and the defect of their polynomial.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from coupling.contact_kernels import DAMPING, ENERGY, FORCE, TANGENT, evaluate_contact
from coupling.kernel_arrays import Contacts
from coupling.periodic.arrays import Reference, Steps
from coupling.periodic.collocation import AT_ENDS, BARYCENTRIC, INSIDE, MONOMIALS, ORDER, PLACES, POINTS
from coupling.periodic.element_work import Work
from coupling.row_kernels import SUMS, add_rows
from coupling.small_systems import solve_in_place
from rotors.compiled import uncounted

FloatArray = npt.NDArray[np.float64]

_NEWTON_STEPS = 40


@uncounted(forceinline=True)
def law(contacts: Contacts, a: int, time: float, delta: float, rate: float, laws: FloatArray, row: int) -> None:
    """Evaluate the law of one contact into a row."""
    evaluate_contact(contacts, a, time, delta, rate, laws, row)


@uncounted(fastmath=SUMS)
def product(row: FloatArray, a: int, z: FloatArray) -> float:
    """Product of a row of a matrix with the amplitudes."""
    total = 0.0
    for i in range(z.size):
        total += row[a, i] * z[i]
    return total


@uncounted(fastmath={"contract"})
def advance(decay: FloatArray, source: FloatArray, z: FloatArray, excess: FloatArray, end: FloatArray) -> None:
    """Amplitudes at the end or a place from those at the start and the excess forces."""
    count = decay.shape[1]
    # Rows by names of their own: through indices the compiler does not see that it may take several numbers at once.
    u, v, x, y, real, imag = decay[0], decay[1], z[:count], z[count:], end[:count], end[count:]
    for m in range(count):
        real[m] = u[m] * x[m] - v[m] * y[m]
        imag[m] = u[m] * y[m] + v[m] * x[m]
    add_rows(source, excess, -1.0, end)


@uncounted(forceinline=True)
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


@uncounted(forceinline=True)
def solve_element(
    reference: Reference, contacts: Contacts, steps: Steps, slot: int, time: float, z: FloatArray, work: Work
) -> bool:
    """Newton's method for the excess forces at the places; compressions and rates there and at both ends."""
    c, h = reference.stiffness.size, steps.size[slot]
    n = ORDER * c
    base, excess, move, laws = work.base, work.excess, work.move, work.laws
    delta, rate, slope, rate_slope = work.delta, work.rate, work.slope, work.rate_slope
    matrix, right, end = work.matrix, work.right, work.end
    for row in range(2 * n):
        base[row] = product(steps.felt[slot], row, z)
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
            held = force == 0.0 and tangent == 0.0
            rate_slope[row] = (0.0 if held else laws[row, DAMPING]) - reference.damping[a]
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


@uncounted(fastmath=SUMS, forceinline=True)
def estimate(reference: Reference, steps: Steps, slot: int, part: float, z: FloatArray, modes: int, work: Work) -> None:
    """Defect of the polynomial of the excess, carried to the end: squares of error and amplitudes.

    The defect vanishes at the places; its values at both ends give the rest of its shape. In an element that ends at a
    part of its size only the value at its start is on the law's branch; added is the triangle between the last place
    and the end, which does not cancel.
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


@uncounted()
def held_energy(laws: FloatArray, first: int, count: int) -> float:
    """Energy held in the teeth, by rows of the laws [J]."""
    total = 0.0
    for row in range(first, first + count):
        total += laws[row, ENERGY]
    return total
