r"""Variational equations, compiled: small disturbances over an element, and over a step of a contact force.

Importing this module imports numba.

p disturbances of the amplitudes are the rows of an array (p, 2 m): the real parts of all modes, then the imaginary
ones. Over an element the forces at its places follow the disturbance z of its start by

    (I + S F) g = S f z,

f its compressions and rates there, F those of the forces, S the slopes of the law; and z becomes e^{λh} z - b g. The
solution of the small system for S f serves all disturbances, of which each is then read and written once.
"""

import math

import numpy as np
import numpy.typing as npt

from coupling.contact_kernels import DAMPING, FORCE, TOUCHING, penetration
from coupling.kernel_arrays import Contacts
from coupling.periodic.arrays import Reference, Steps
from coupling.periodic.element import law
from coupling.periodic.element_matrices import end_matrices
from coupling.periodic.element_work import Work
from coupling.row_kernels import SUMS
from coupling.small_systems import solve_part_in_place
from rotors.compiled import uncounted

FloatArray = npt.NDArray[np.float64]

_UNROLLED = 5  # number of forces in :func:`carry`: those of one contact in elements of order 5


@uncounted()
def feed_back(steps: Steps, slot: int, work: Work) -> int:
    """Rows of the forces by a disturbance; returns their number, with their indices in ``work.active``."""
    n, size = work.excess.size, steps.felt.shape[2]
    matrix, shares, felt = work.matrix, work.shares, work.feedback
    active = 0
    for row in range(n):
        # Flanks that are apart, also in the reference, have no slope: no disturbance changes their force.
        if work.slope[row] != 0.0 or work.rate_slope[row] != 0.0:
            work.active[active] = row
            active += 1
    for i in range(active):
        row = work.active[i]
        x, v = work.slope[row], work.rate_slope[row]
        for j in range(active):
            column = work.active[j]
            matrix[i, j] = x * steps.flexibility[slot, row, column] + v * steps.flexibility[slot, n + row, column]
            shares[i, j] = shares[i, active + j] = 0.0
        matrix[i, i] += 1.0
        shares[i, i], shares[i, active + i] = x, v
    solve_part_in_place(matrix, shares, active, 2 * active)
    for i in range(active):
        for m in range(size):
            felt[i, m] = 0.0
        for j in range(active):
            row, x, v = work.active[j], shares[i, j], shares[i, active + j]
            for m in range(size):
                felt[i, m] += x * steps.felt[slot, row, m] + v * steps.felt[slot, n + row, m]
    return active


@uncounted()
def send(decay: FloatArray, source: FloatArray, slot: int, active: int, work: Work) -> None:
    """Rows of the amplitudes at an element's end by its forces, and the decay of those at its start."""
    for i in range(active):
        row = work.active[i]
        for m in range(work.sent.shape[1]):
            work.sent[i, m] = source[slot, row, m]
    for m in range(decay.shape[2]):
        work.decay[0, m], work.decay[1, m] = decay[slot, 0, m], decay[slot, 1, m]


@uncounted(fastmath=SUMS)
def carry(columns: FloatArray, decay: FloatArray, felt: FloatArray, sent: FloatArray) -> None:
    """Disturbances at the end from those at the start, by ``_UNROLLED`` forces."""
    size = columns.shape[1]
    modes = size // 2
    for k in range(columns.shape[0]):
        a = b = c = d = e = 0.0
        for i in range(size):
            z = columns[k, i]
            a += felt[0, i] * z
            b += felt[1, i] * z
            c += felt[2, i] * z
            d += felt[3, i] * z
            e += felt[4, i] * z
        for i in range(modes):
            j = modes + i
            x, y, p, q = columns[k, i], columns[k, j], decay[0, i], decay[1, i]
            one = a * sent[0, i] + b * sent[1, i] + c * sent[2, i] + d * sent[3, i] + e * sent[4, i]
            two = a * sent[0, j] + b * sent[1, j] + c * sent[2, j] + d * sent[3, j] + e * sent[4, j]
            columns[k, i] = p * x - q * y - one
            columns[k, j] = p * y + q * x - two


@uncounted(fastmath=SUMS)
def carry_any(
    columns: FloatArray, decay: FloatArray, felt: FloatArray, sent: FloatArray, active: int, force: FloatArray
) -> None:
    """As :func:`carry`, for any number of forces."""
    size = columns.shape[1]
    modes = size // 2
    for k in range(columns.shape[0]):
        for row in range(active):
            total = 0.0
            for i in range(size):
                total += felt[row, i] * columns[k, i]
            force[row] = total
        for i in range(modes):
            x, y, p, q = columns[k, i], columns[k, modes + i], decay[0, i], decay[1, i]
            columns[k, i] = p * x - q * y
            columns[k, modes + i] = p * y + q * x
        for row in range(active):
            total = force[row]
            for i in range(size):
                columns[k, i] -= total * sent[row, i]


@uncounted()
def vary(reference: Reference, steps: Steps, slot: int, part: float, columns: FloatArray, work: Work) -> None:
    """Propagate the disturbances over an element of a slot's size, or over a part of it."""
    active = feed_back(steps, slot, work)
    if part == 1.0:
        send(steps.decay, steps.source, slot, active, work)
    else:
        end = 0 * slot  # 0, in a form that is no constant: a constant would compile all anew
        end_matrices(reference, steps.size[slot], part, work.cut_decay[end], work.cut_source[end], work.integral)
        send(work.cut_decay, work.cut_source, end, active, work)
    if active == _UNROLLED:
        carry(columns, work.decay, work.feedback, work.sent)
    else:
        carry_any(columns, work.decay, work.feedback, work.sent, active, work.moved)


@uncounted(fastmath=SUMS)
def cross(reference: Reference, a: int, jump: float, columns: FloatArray) -> None:
    """Propagate the disturbances over a step of a contact force: the sooner it comes, the longer it acts."""
    modes = columns.shape[1] // 2
    for k in range(columns.shape[0]):
        moved = 0.0
        for m in range(modes):
            moved += reference.displacement[a, m] * columns[k, m]
            moved += reference.displacement[a, modes + m] * columns[k, modes + m]
        for m in range(modes):
            columns[k, m] -= jump * moved * reference.source[m, a].real
            columns[k, modes + m] -= jump * moved * reference.source[m, a].imag


@uncounted()
def jump_at(
    reference: Reference,
    contacts: Contacts,
    a: int,
    time: float,
    delta: float,
    rate: float,
    inside: float,
    laws: FloatArray,
    row: int,
) -> float:
    """Step of a contact force over the speed of crossing, where its flanks meet or part."""
    law(contacts, a, time - inside, delta - rate * inside, rate, laws, row)
    before, force, damping = laws[row, TOUCHING] > 0.0, laws[row, FORCE], laws[row, DAMPING]
    law(contacts, a, time + inside, delta + rate * inside, rate, laws, row)
    after, sign = laws[row, TOUCHING] > 0.0, -1.0
    if before == after:
        return 0.0
    if after:
        force, damping, sign = laws[row, FORCE], laws[row, DAMPING], 1.0
    if force == 0.0 or damping < reference.full_damping[a] * (1.0 - 1e-14):
        return 0.0  # held at zero by the law, or its damping only fades in: no step
    # Flanks first touch at the compression less the largest penetration.
    later = delta - penetration(contacts, a, time + inside, delta, 1)
    sooner = delta - penetration(contacts, a, time - inside, delta, 1)
    crossing = rate - (later - sooner) / (2.0 * inside)
    # The springs start from nothing; only the damping can step.
    return sign * damping * rate / crossing if math.isfinite(crossing) and crossing != 0.0 else 0.0
