"""Switches of contact within an element of time, compiled: root finding on the branches of the contact law.

Importing this module imports numba.
"""

import numpy as np
import numpy.typing as npt

from coupling.contact_kernels import DAMPING, FORCE, TANGENT, TOUCHING, penetration
from coupling.kernel_arrays import Contacts
from coupling.periodic.arrays import Reference
from coupling.periodic.collocation import INSIDE, ORDER, PLACES
from coupling.periodic.element import interpolated, law
from coupling.periodic.element_work import Work
from rotors.compiled import uncounted

FloatArray = npt.NDArray[np.float64]

_NEAR, _ROUGHLY = 1e-14, 1e-3  # parts of an element to which a switch is located, finely and roughly
_ALMOST = 1.0 - 1e-14
# A branch is four times the number of touching pairs, plus the state of their damping.
_PAIR, _HELD, _FADING, _FULL = 4, 1, 2, 3


@uncounted()
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


@uncounted()
def by_pairs(old: int, new: int) -> bool:
    """Whether the first change from one branch to another is that a pair begins or ceases to touch."""
    if old // _PAIR == new // _PAIR:
        return False
    return old == 0 or old % _PAIR == new % _PAIR or (new == 0 and old % _PAIR == _FADING)


@uncounted()
def next_part(x: float, other: float, third: float, f: float, f_other: float, f_third: float, near: float) -> float:
    """Next trial of a root search, as a part of the way from one bound to the other.

    By inverse quadratic interpolation where it is safe, else bisection: T. R. Chandrupatla, Advances in
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


@uncounted()
def has_left(old: int, reference: Reference, contacts: Contacts, a: int, at: float, u: float, work: Work) -> bool:
    """Whether a contact's law at a place u, at the time ``at``, is on another branch than the old one."""
    trial = work.laws.shape[0] - 1
    law(contacts, a, at, interpolated(work.delta, a, u), interpolated(work.rate, a, u), work.laws, trial)
    return branch(reference, a, work.laws, trial) != old


@uncounted()
def touching_changes(
    contacts: Contacts, a: int, time: float, h: float, stop: float, x: float, other: float, rank: int, near: float,
    work: Work,
) -> tuple[float, float]:  # fmt: skip
    """Two places, ``near`` from each other at most, between which a pair begins or ceases to touch.

    x and other are places on either side of it; the place on the side of x is returned first. Without a change between
    x and other, these are returned.
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


@uncounted()
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
    """Location at which a contact leaves its old branch, as a part of h, too late by ``near`` at most.

    It lies between two places. Where a pair begins or ceases to touch, it is the root of the pair's penetration; other
    switches are found by bisection.
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


@uncounted(forceinline=True)
def first_switch(
    reference: Reference, contacts: Contacts, time: float, h: float, stop: float, furthest: float, work: Work
) -> tuple[float, int]:
    """First switch of a contact law, as a part of h, and its contact; beyond ``furthest`` without any.

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
            # A switch before the last place is located again, with places before it.
            near = _NEAR if u > PLACES[ORDER - 1] else _ROUGHLY
            new = branch(reference, a, laws, i * c + a if at_place else row)
            found = placed(reference, contacts, a, time, h, stop, before, u, old, new, near, work)
            if found < first:
                first, which = found, a
            break
    return first, which
