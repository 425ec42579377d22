r"""Switches of contact in an element of time, compiled: root finding, sensitivities and saltation for the monodromy.

A switch is the root at which the contact law changes its branch. The variational equations carry small disturbances
over an element, and over a step of a contact force.

p disturbances of the amplitudes are the rows of an array (p, 2 m): the real parts of all modes, then the imaginary
ones. Over an element the forces at its places follow the disturbance z of its start by

    (I + S F) g = S f z,

f its compressions and rates there, F those of the forces, S the slopes of the law; and z becomes e^{λh} z - b g. The
solution of the small system for S f serves all disturbances, of which each is then read and written once.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.collocation.arrays import INSIDE, ORDER, PLACES, Reference, Steps, Work
from gearwhine.coupling.collocation.element_kernels import end_matrices, interpolated, law
from gearwhine.coupling.connector_forces.contact_kernels import DAMPING, FORCE, TANGENT, TOUCHING, penetration
from gearwhine.coupling.connector_forces.dense_kernels import SUMS, solve_part_in_place
from gearwhine.coupling.connector_forces.kernel_arrays import Contacts
from gearwhine.numerics.compiled import inner

FloatArray = npt.NDArray[np.float64]

_NEAR, _ROUGHLY = 1e-14, 1e-3  # tolerances of a switch's location over the element's length, fine and rough
_ALMOST = 1.0 - 1e-14
# A branch is four times the number of touching pairs, plus the state of their damping.
_PAIR, _HELD, _FADING, _FULL = 4, 1, 2, 3


@inner()
def branch(reference: Reference, a: int, laws: FloatArray, row: int) -> int:
    """Smooth branch of a contact law: the number of touching pairs and the state of the damping."""
    touching = int(laws[row, TOUCHING])
    if touching == 0:
        return 0
    if laws[row, FORCE] == 0.0 and laws[row, TANGENT] == 0.0:
        return _PAIR * touching + _HELD
    if laws[row, DAMPING] < reference.full_damping[a] * _ALMOST:
        return _PAIR * touching + _FADING
    return _PAIR * touching + _FULL


@inner()
def by_pairs(old: int, new: int) -> bool:
    """Whether the first change from one branch to another is that a pair begins or ceases to touch."""
    if old // _PAIR == new // _PAIR:
        return False
    return old == 0 or old % _PAIR == new % _PAIR or (new == 0 and old % _PAIR == _FADING)


@inner()
def next_part(x: float, other: float, third: float, f: float, f_other: float, f_third: float, near: float) -> float:
    """Next trial of a root search, as a fraction of the way from one bound to the other.

    Inverse quadratic interpolation where it is safe, else bisection: T. R. Chandrupatla, Advances in
    Engineering Software 28 (1997) 145-149.
    """
    part = 0.5
    way, change = (x - other) / (third - other), (f - f_other) / (f_third - f_other)
    if change * change < way and (1.0 - change) * (1.0 - change) < 1.0 - way:
        part = f / (f_other - f) * f_third / (f_other - f_third)
        part += (third - x) / (other - x) * f / (f_third - f) * f_other / (f_third - f_other)
    # At least this far from a bound, so that the bounds close in on the root.
    least = min(0.5 * near / abs(x - other), 0.5)
    return float(min(max(part, least), 1.0 - least))


@inner()
def has_left(old: int, reference: Reference, contacts: Contacts, a: int, at: float, u: float, work: Work) -> bool:
    """Whether a contact's law at the place u and the time ``at`` is on another branch than ``old``."""
    trial = work.laws.shape[0] - 1
    law(contacts, a, at, interpolated(work.delta, a, u), interpolated(work.rate, a, u), work.laws, trial)
    return branch(reference, a, work.laws, trial) != old


@inner()
def touching_changes(
    contacts: Contacts, a: int, time: float, h: float, stop: float, x: float, other: float, rank: int, near: float,
    work: Work,
) -> tuple[float, float]:  # fmt: skip
    """Bracket of width ``near`` around the place at which a pair begins or ceases to touch.

    ``x`` and ``other`` are places on either side of it; the place on the side of ``x`` is returned first. Without a
    change between ``x`` and ``other``, these are returned.
    """
    f = penetration(contacts, a, min(time + x * h, stop), interpolated(work.delta, a, x), rank)
    f_other = penetration(contacts, a, min(time + other * h, stop), interpolated(work.delta, a, other), rank)
    if f * f_other >= 0.0:
        return x, other
    touches, swapped, third, f_third, part = f > 0.0, False, other, f_other, 0.5
    while abs(x - other) > near:
        u = x + part * (other - x)
        value = penetration(contacts, a, min(time + u * h, stop), interpolated(work.delta, a, u), rank)
        if ((value > 0.0) == touches) != swapped:
            third, f_third = x, f
        else:
            third, f_third, other, f_other, swapped = other, f_other, x, f, not swapped
        x, f = u, value
        part = next_part(x, other, third, f, f_other, f_third, near)
    return (other, x) if swapped else (x, other)


@inner()
def placed(
    reference: Reference,
    contacts: Contacts,
    a: int,
    time: float,
    h: float,
    stop: float,
    before: float,
    after: float,
    old: int,
    new: int,
    near: float,
    work: Work,
) -> float:
    """Place at which a contact leaves its old branch, as a fraction of h, too late by ``near`` at most.

    Where a pair begins or ceases to touch, the place is the root of the pair's penetration; other switches are located
    by bisection.
    """
    if by_pairs(old, new):
        rank = old // _PAIR + 1 if new > old else old // _PAIR
        outside, inside = touching_changes(contacts, a, time, h, stop, after, before, rank, near, work)
        # A motion that turns back may have left the branch before, for another reason; and within rounding the law may
        # still be on its old branch.
        if inside > before and has_left(old, reference, contacts, a, min(time + inside * h, stop), inside, work):
            after = inside
        elif outside == after or has_left(old, reference, contacts, a, min(time + outside * h, stop), outside, work):
            before, after = inside, outside
        else:
            before = outside
    while after - before > near:
        u = 0.5 * (before + after)
        if has_left(old, reference, contacts, a, min(time + u * h, stop), u, work):
            after = u
        else:
            before = u
    return after


@inner(forceinline=True)
def first_switch(
    reference: Reference, contacts: Contacts, time: float, h: float, stop: float, furthest: float, work: Work
) -> tuple[float, int]:
    """First switch of a contact law, as a fraction of h, and its contact; beyond ``furthest`` without a switch.

    No law is evaluated later than ``stop``. The laws just after the start are left in the rows behind those of the
    places.
    """
    c = reference.stiffness.size
    n = ORDER * c
    delta, rate, laws = work.delta, work.rate, work.laws
    first, which = 2.0, -1
    for a in range(c):
        before, row = INSIDE, n + a
        x, v = interpolated(delta, a, before), interpolated(rate, a, before)
        law(contacts, a, time + before * h, x, v, laws, row)
        work.looked[0, a], work.looked[1, a] = x, v
        old = branch(reference, a, laws, row)
        row = n + c + a
        x, v = interpolated(delta, a, furthest), interpolated(rate, a, furthest)
        law(contacts, a, min(time + furthest * h, stop), x, v, laws, row)
        for i in range(ORDER + 1):
            # The places, then the furthest point.
            at_place = i < ORDER and PLACES[i] < furthest
            u = PLACES[i] if at_place else furthest
            if before >= first:
                break
            if branch(reference, a, laws, i * c + a if at_place else row) == old:
                before = u
                if not at_place:
                    break
                continue
            # A switch before the last place is located again from the places before it.
            near = _NEAR if u > PLACES[ORDER - 1] else _ROUGHLY
            new = branch(reference, a, laws, i * c + a if at_place else row)
            time_of = placed(reference, contacts, a, time, h, stop, before, u, old, new, near, work)
            if time_of < first:
                first, which = time_of, a
            break
    return first, which


_UNROLLED = 5  # number of forces in :func:`apply_sensitivity`: those of one contact in elements of order 5


@inner()
def force_sensitivity(steps: Steps, slot: int, work: Work) -> int:
    """Sensitivity of the forces to the amplitudes at the start, S f; returns the number of rows ``work.active``."""
    n, size = work.excess.size, steps.free_response.shape[2]
    matrix, shares, rows = work.matrix, work.shares, work.force_rows
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
            rows[i, m] = 0.0
        for j in range(active):
            row, x, v = work.active[j], shares[i, j], shares[i, active + j]
            for m in range(size):
                rows[i, m] += x * steps.free_response[slot, row, m] + v * steps.free_response[slot, n + row, m]
    return active


@inner()
def gather_end_response(decay: FloatArray, source: FloatArray, slot: int, active: int, work: Work) -> None:
    """Response b of the amplitudes at an element's end to its forces, and their free decay e^{λh} from its start."""
    for i in range(active):
        row = work.active[i]
        for m in range(work.end_response.shape[1]):
            work.end_response[i, m] = source[slot, row, m]
    for m in range(decay.shape[2]):
        work.decay[0, m], work.decay[1, m] = decay[slot, 0, m], decay[slot, 1, m]


@inner(fastmath=SUMS)
def apply_sensitivity(columns: FloatArray, decay: FloatArray, rows: FloatArray, ends: FloatArray) -> None:
    """Sensitivities at the end from those at the start, e^{λh} z - b g, with ``_UNROLLED`` forces."""
    size = columns.shape[1]
    modes = size // 2
    for k in range(columns.shape[0]):
        a = b = c = d = e = 0.0
        for i in range(size):
            z = columns[k, i]
            a += rows[0, i] * z
            b += rows[1, i] * z
            c += rows[2, i] * z
            d += rows[3, i] * z
            e += rows[4, i] * z
        for i in range(modes):
            j = modes + i
            x, y, p, q = columns[k, i], columns[k, j], decay[0, i], decay[1, i]
            derivative = a * ends[0, i] + b * ends[1, i] + c * ends[2, i] + d * ends[3, i] + e * ends[4, i]
            two = a * ends[0, j] + b * ends[1, j] + c * ends[2, j] + d * ends[3, j] + e * ends[4, j]
            columns[k, i] = p * x - q * y - derivative
            columns[k, j] = p * y + q * x - two


@inner(fastmath=SUMS)
def apply_sensitivity_of_any(
    columns: FloatArray,
    decay: FloatArray,
    rows: FloatArray,
    ends: FloatArray,
    active: int,
    force: FloatArray,
) -> None:
    """Apply :func:`apply_sensitivity` for any number of forces."""
    size = columns.shape[1]
    modes = size // 2
    for k in range(columns.shape[0]):
        for row in range(active):
            total = 0.0
            for i in range(size):
                total += rows[row, i] * columns[k, i]
            force[row] = total
        for i in range(modes):
            x, y, p, q = columns[k, i], columns[k, modes + i], decay[0, i], decay[1, i]
            columns[k, i] = p * x - q * y
            columns[k, modes + i] = p * y + q * x
        for row in range(active):
            total = force[row]
            for i in range(size):
                columns[k, i] -= total * ends[row, i]


@inner()
def propagate_sensitivity(
    reference: Reference, steps: Steps, slot: int, part: float, columns: FloatArray, work: Work
) -> None:
    """Solve the variational (sensitivity) equations over an element of a slot's size, or over a part of it."""
    active = force_sensitivity(steps, slot, work)
    if part == 1.0:
        gather_end_response(steps.decay, steps.source, slot, active, work)
    else:
        end = 0 * slot  # 0, in a form that is no constant: a constant would compile all anew
        end_matrices(reference, steps.size[slot], part, work.cut_decay[end], work.cut_source[end], work.integral)
        gather_end_response(work.cut_decay, work.cut_source, end, active, work)
    if active == _UNROLLED:
        apply_sensitivity(columns, work.decay, work.force_rows, work.end_response)
    else:
        apply_sensitivity_of_any(columns, work.decay, work.force_rows, work.end_response, active, work.moved)


@inner(fastmath=SUMS)
def apply_saltation(reference: Reference, a: int, jump: float, columns: FloatArray) -> None:
    """Apply the saltation matrix of a step of a contact force: the sooner it comes, the longer it acts."""
    modes = columns.shape[1] // 2
    for k in range(columns.shape[0]):
        moved = 0.0
        for m in range(modes):
            moved += reference.displacement[a, m] * columns[k, m]
            moved += reference.displacement[a, modes + m] * columns[k, modes + m]
        for m in range(modes):
            columns[k, m] -= jump * moved * reference.source[m, a].real
            columns[k, modes + m] -= jump * moved * reference.source[m, a].imag


@inner()
def saltation_factor(
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
    """Saltation factor: step of a contact force over the speed of crossing, where its flanks meet or part."""
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
