"""What becomes of small disturbances of a motion, compiled: over an element, and over a moment where a force steps.

Importing this module imports numba. p disturbances are the columns of an array (2 m, p) of amplitudes.
"""

import numpy as np
import numpy.typing as npt

from coupling.contact_kernels import DAMPING, FORCE, TOUCHING
from coupling.kernel_arrays import Contacts
from coupling.periodic.arrays import Reference, Steps
from coupling.periodic.collocation import ORDER
from coupling.periodic.element import law
from coupling.periodic.element_work import Work
from coupling.small_systems import solve_in_place
from rotors.compiled import uncounted

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@uncounted()
def felt_by(steps: Steps, slot: int, columns: FloatArray, active: int, work: Work) -> None:
    """What the disturbances make of the excess forces that they change, if the other forces stayed as they are."""
    count, p, n = columns.shape[0], columns.shape[1], work.excess.size
    right = work.columns
    # Four rows of them at a time: they are read once, and the sums read and written less often.
    i = 0
    while i < count:
        many = i + 4 <= count
        for j in range(active):
            row = work.active[j]
            x, v = work.slope[row], work.rate_slope[row]
            a = x * steps.felt[slot, i, row] + v * steps.felt[slot, i, n + row]
            if not many:
                for k in range(p):
                    right[row, k] += a * columns[i, k]
                continue
            b = x * steps.felt[slot, i + 1, row] + v * steps.felt[slot, i + 1, n + row]
            c = x * steps.felt[slot, i + 2, row] + v * steps.felt[slot, i + 2, n + row]
            d = x * steps.felt[slot, i + 3, row] + v * steps.felt[slot, i + 3, n + row]
            for k in range(p):
                right[row, k] += (
                    a * columns[i, k] + b * columns[i + 1, k] + c * columns[i + 2, k] + d * columns[i + 3, k]
                )
        i += 4 if many else 1


@uncounted()
def send(source: FloatArray, end: int, row: int, columns: FloatArray, work: Work) -> None:
    """Take what one excess force sends to the end off the disturbances there."""
    for i in range(columns.shape[0]):
        a = source[end, row, i]
        for k in range(columns.shape[1]):
            columns[i, k] -= a * work.columns[row, k]


@uncounted()
def decay_and_send(
    decay: ComplexArray, source: FloatArray, end: int, columns: FloatArray, active: int, work: Work
) -> None:
    """Disturbances at the end from those at the start and the excess forces, as many as one contact has at once."""
    right, rows = work.columns, work.active
    q, r, s, t, u = rows[0], rows[1], rows[2], rows[3], rows[4]
    for m in range(columns.shape[0] // 2):
        x, y, i, j = decay[end, m].real, decay[end, m].imag, 2 * m, 2 * m + 1
        if active < ORDER:
            for k in range(columns.shape[1]):
                one, two = columns[i, k], columns[j, k]
                columns[i, k], columns[j, k] = x * one - y * two, x * two + y * one
            continue
        a, b, c, d, e = source[end, q, i], source[end, r, i], source[end, s, i], source[end, t, i], source[end, u, i]
        f, g, h, v, w = source[end, q, j], source[end, r, j], source[end, s, j], source[end, t, j], source[end, u, j]
        for k in range(columns.shape[1]):
            one, two = columns[i, k], columns[j, k]
            sent = a * right[q, k] + b * right[r, k] + c * right[s, k] + d * right[t, k] + e * right[u, k]
            felt = f * right[q, k] + g * right[r, k] + h * right[s, k] + v * right[t, k] + w * right[u, k]
            columns[i, k] = x * one - y * two - sent
            columns[j, k] = x * two + y * one - felt
    for k in range(ORDER if active >= ORDER else 0, active):
        send(source, end, rows[k], columns, work)


@uncounted()
def vary(
    steps: Steps, slot: int, decay: ComplexArray, source: FloatArray, end: int, columns: FloatArray, work: Work
) -> None:
    """Carry the disturbances over an element of a slot's size, with the matrices ``end`` to where it ends."""
    n = work.excess.size
    matrix, right = work.matrix, work.columns
    active = 0
    for row in range(n):
        x, v = work.slope[row], work.rate_slope[row]
        for column in range(n):
            matrix[row, column] = (
                x * steps.flexibility[slot, row, column] + v * steps.flexibility[slot, n + row, column]
            )
        matrix[row, row] += 1.0
        for k in range(columns.shape[1]):
            right[row, k] = 0.0
        # Flanks that are apart, in the reference too, have no slope: no disturbance changes their force.
        if x != 0.0 or v != 0.0:
            work.active[active] = row
            active += 1
    felt_by(steps, slot, columns, active, work)
    solve_in_place(matrix, right)
    decay_and_send(decay, source, end, columns, active, work)


@uncounted()
def cross(reference: Reference, a: int, jump: float, columns: FloatArray, moved: FloatArray) -> None:
    """Carry the disturbances over a moment at which the force of a contact steps: the sooner, the longer it acts."""
    count, p = columns.shape[0], columns.shape[1]
    for k in range(p):
        moved[k] = 0.0
    for i in range(count):
        for k in range(p):
            moved[k] += reference.displacement[a, i] * columns[i, k]
    for m in range(count // 2):
        x, y = jump * reference.source[m, a].real, jump * reference.source[m, a].imag
        for k in range(p):
            columns[2 * m, k] -= x * moved[k]
            columns[2 * m + 1, k] -= y * moved[k]


@uncounted()
def touches(contacts: Contacts, a: int, time: float, delta: float, laws: FloatArray, row: int) -> bool:
    """Whether any pair touches at a time and a compression."""
    law(contacts, a, time, delta, 0.0, laws, row)
    return bool(laws[row, TOUCHING] > 0.0)


@uncounted()
def first_touch(
    reference: Reference, contacts: Contacts, a: int, time: float, near: float, laws: FloatArray, row: int
) -> float:
    """Compression at which the first pair touches at a time, near a compression."""
    reach = 1e-12 * reference.scale[a] + 1e-9 * abs(near)
    low, high = near, near
    for _ in range(200):
        if not touches(contacts, a, time, low, laws, row):
            break
        low -= reach
        reach *= 1.5
    for _ in range(200):
        if touches(contacts, a, time, high, laws, row):
            break
        high += reach
        reach *= 1.5
    for _ in range(100):
        middle = 0.5 * (low + high)
        if touches(contacts, a, time, middle, laws, row):
            high = middle
        else:
            low = middle
    return high


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
    """Step in the force of a contact over the speed of crossing, where its flanks meet or part."""
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
    later = first_touch(reference, contacts, a, time + inside, delta, laws, row)
    sooner = first_touch(reference, contacts, a, time - inside, delta, laws, row)
    crossing = rate - (later - sooner) / (2.0 * inside)
    # The springs start from nothing; only the damping can step.
    return sign * damping * rate / crossing if crossing != 0.0 else 0.0
