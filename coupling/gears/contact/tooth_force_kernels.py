r"""Tooth contact force and tooth friction, compiled: scalars and a row of numbers in, scalars out, no allocation.

The law is derived in :mod:`gearwhine.coupling.gears.contact.contact_law`; the contact's row of numbers is laid out by
:mod:`gearwhine.coupling.gears.contact.lookup_tables` and comes from `ToothContact.kernel_arguments`:
``tooth_force(phase, compression, rate, *contact.kernel_arguments)``.

The overhead of calls costs more time here than the arithmetic. Each argument is copied at every call: hence one array.
Numba counts references to an array atomically at each call, unless it can prove that it need not: hence entries are
read one by one, never through views, nothing can raise (division follows numpy), and small functions are inlined. It
checks every index for being negative, counted from the end: hence `law_value`.

Tooth friction is given by the shares of the mesh force that act across the line of action.

With the elastic forces E_j of the pairs at the positions s_j, and F the whole force with its damping, which the pairs
are taken to share as they share the elastic one, friction pushes with

    mu F A,    A = sum_j E_j sgn(s_j - s_C) / sum_j E_j,        mu F B,    B = sum_j E_j sgn(s_j - s_C) s_j / sum_j E_j

along the directions in which a pair at s slides, ``a + s b``. Where a line of contact lies across the path, its slices
reverse one after another, each under its own load: sums over slices replace the E_j
(:mod:`gearwhine.coupling.gears.contact.sliding_friction`). With A and B go their slopes by the compression, so that
Newton's tangent, no longer symmetric, is exact: k_j being that of each pair by the pairs' own compression x, ``A' =
(sum_j k_j sgn(...) - A k) / E dx/d delta``.

Importing this module imports numba.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears.contact.lookup_tables import (
    CELL,
    CELLS_AT,
    DAMPING,
    DAMPING_DEPTH,
    DEPTH_STEP,
    DEPTH_UNIT,
    DEPTHS,
    ENTERING,
    ENTERING_AT,
    FIRST_PAIR,
    FIRST_TOUCH,
    GUESS_AT,
    HEADER,
    HUNTING,
    INTERVAL,
    INTERVALS_AT,
    OTHER_TILT_PERIOD,
    PAIR,
    PAIRS,
    PAIRS_AT,
    PARTS,
    SHARED,
    TILT_PARTS,
    TILT_PERIOD,
    TILTS_AT,
    VARIANT_STEP,
)
from gearwhine.numerics.compiled import counted, inner, uncounted

FloatArray = npt.NDArray[np.float64]
TangentForce = tuple[float, float, float, float, float, int]

_NEWTON_STEPS = 60
_DOUBT = 1e-12
"""Part of the compression within which a pair's first touch is rounding."""
PRECISE, _NEAR_ENOUGH = 1e-9, 1e-4
"""Corrections after which the pairs' compression is exact to rounding: at once, or after one more Newton step."""
_SETTLED = 1e-6
"""Correction of the pairs' compression after which their energy is exact to rounding."""


@inner(forceinline=True)
def law_value(law: FloatArray, index: int) -> float:
    """Return the number of the contact law at a non-negative index."""
    value: float = law[np.uint64(index)]
    return value


@inner(forceinline=True)
def locate(law: FloatArray, at: int, phase: float) -> tuple[float, int, float, float]:
    """Whole periods, interval of the period, position in it from 0 to 1, and one over its width."""
    number = np.floor(phase)
    x = phase - number
    if x >= 1.0:  # a phase just below a whole number rounds up
        x -= 1.0
        number += 1.0
    interval = int(law_value(law, at + HEADER + int(x * law_value(law, at + PARTS))))
    place = at + int(law_value(law, at + INTERVALS_AT)) + INTERVAL * interval
    while law_value(law, place + INTERVAL) <= x:
        place += INTERVAL
        interval += 1
    per_width = law_value(law, place + 1)
    return number, interval, (x - law_value(law, place)) * per_width, per_width


@inner(fastmath={"contract"}, forceinline=True)
def tooth_tilt(law: FloatArray, at: int, phase: float) -> tuple[float, float]:
    """Deflection of the mesh by tilting bodies as teeth differ [m], and its derivative by the phase."""
    value, slope = 0.0, 0.0
    first = int(law_value(law, at + TILT_PERIOD))
    if first > 0:
        per_period = law_value(law, at + TILT_PARTS)
        parts, number = int(per_period), int(np.floor(phase))
        u = (phase - np.floor(phase)) * per_period
        part = min(int(u), parts - 1)
        u -= part
        start, second = at + int(law_value(law, at + TILTS_AT)), int(law_value(law, at + OTHER_TILT_PERIOD))
        place = start + 4 * (parts * (number % first) + part)
        c1, c2, c3 = law_value(law, place + 1), law_value(law, place + 2), law_value(law, place + 3)
        value = law_value(law, place) + u * (c1 + u * (c2 + u * c3))
        slope = c1 + u * (2.0 * c2 + 3.0 * u * c3)
        if second > 0:
            place = start + 4 * (parts * (first + number % second) + part)
            c1, c2, c3 = law_value(law, place + 1), law_value(law, place + 2), law_value(law, place + 3)
            value += law_value(law, place) + u * (c1 + u * (c2 + u * c3))
            slope += c1 + u * (2.0 * c2 + 3.0 * u * c3)
        slope *= per_period
    return value, slope


@inner(fastmath={"contract"}, forceinline=True)
def penetration(
    law: FloatArray, at: int, hunting: int, entered: int, u: float, compression: float, place: int
) -> tuple[float, int]:
    """Penetration of a pair's flanks [m], negative where they are apart, and the index of its numbers.

    ``place``: index of the same pair's numbers if it is of the first variant; ``entered``: phase at which it entered.
    """
    if hunting > 0:
        entry = at + int(law_value(law, at + ENTERING_AT)) + ENTERING * (entered % hunting)
        compression -= law_value(law, entry)
        place += int(law_value(law, entry + 1)) * int(law_value(law, at + VARIANT_STEP))
    g0, g1 = law_value(law, place), law_value(law, place + 1)
    return compression - g0 - u * (g1 + u * (law_value(law, place + 2) + u * law_value(law, place + 3))), place


@inner(fastmath={"contract"}, forceinline=True)
def face_force(
    law: FloatArray, cell: int, unit: float, per_unit: float, p: float, begin: float, rho: float
) -> tuple[float, float, float, float]:
    """Force, tangent, energy and the energy's derivative by p of a pair with an uneven load across its face.

    ``cell``: index of its numbers, see :mod:`gearwhine.coupling.gears.contact.lookup_tables`; ``unit (begin + rho)^2``
    is the compression beyond first touch, ``per_unit`` is 1 / ``unit``.
    """
    # The force's cubic in rho at this p, and how it changes with p: Horner's scheme for both at once.
    top = law_value(law, cell + 12)
    low = law_value(law, cell + 8) + p * top
    mid = law_value(law, cell + 4) + p * low
    v0, d0 = law_value(law, cell) + p * mid, mid + p * (low + p * top)
    top = law_value(law, cell + 13)
    low = law_value(law, cell + 9) + p * top
    mid = law_value(law, cell + 5) + p * low
    v1, d1 = law_value(law, cell + 1) + p * mid, mid + p * (low + p * top)
    top = law_value(law, cell + 14)
    low = law_value(law, cell + 10) + p * top
    mid = law_value(law, cell + 6) + p * low
    v2, d2 = law_value(law, cell + 2) + p * mid, mid + p * (low + p * top)
    top = law_value(law, cell + 15)
    low = law_value(law, cell + 11) + p * top
    mid = law_value(law, cell + 7) + p * low
    v3, d3 = law_value(law, cell + 3) + p * mid, mid + p * (low + p * top)
    top = law_value(law, cell + 19)
    low = law_value(law, cell + 18) + p * top
    mid = law_value(law, cell + 17) + p * low
    v4, d4 = law_value(law, cell + 16) + p * mid, mid + p * (low + p * top)
    # Integrals of the powers of rho times 2 a r.
    power = 2.0 * unit * rho
    w0 = power * (begin + 0.5 * rho)
    power *= rho
    w1 = power * (0.5 * begin + (1.0 / 3.0) * rho)
    power *= rho
    w2 = power * ((1.0 / 3.0) * begin + 0.25 * rho)
    w3 = power * rho * (0.25 * begin + 0.2 * rho)
    force = v0 + rho * (v1 + rho * (v2 + rho * v3))
    tangent = (v1 + rho * (2.0 * v2 + 3.0 * rho * v3)) * (0.5 * per_unit / (begin + rho))
    energy = (v4 + v0 * w0) + (v1 * w1 + v2 * w2) + v3 * w3
    slope = (d4 + d0 * w0) + (d1 * w1 + d2 * w2) + d3 * w3
    return force, tangent, energy, slope


@inner(fastmath={"contract"}, forceinline=True)
def face_force_and_tangent(
    law: FloatArray, cell: int, per_unit: float, p: float, begin: float, rho: float
) -> tuple[float, float, float]:
    """Force and tangent as in `face_force`, and the tangent's slope by the compression.

    Newton's iteration in `pairs_compression` needs no energy: the polynomials of `face_force` are repeated here
    without those of the energy, which cost as much again.
    """
    v0 = law_value(law, cell) + p * (
        law_value(law, cell + 4) + p * (law_value(law, cell + 8) + p * law_value(law, cell + 12))
    )
    v1 = law_value(law, cell + 1) + p * (
        law_value(law, cell + 5) + p * (law_value(law, cell + 9) + p * law_value(law, cell + 13))
    )
    v2 = law_value(law, cell + 2) + p * (
        law_value(law, cell + 6) + p * (law_value(law, cell + 10) + p * law_value(law, cell + 14))
    )
    v3 = law_value(law, cell + 3) + p * (
        law_value(law, cell + 7) + p * (law_value(law, cell + 11) + p * law_value(law, cell + 15))
    )
    force = v0 + rho * (v1 + rho * (v2 + rho * v3))
    by_r, per_r = v1 + rho * (2.0 * v2 + 3.0 * rho * v3), 0.5 * per_unit / (begin + rho)
    curvature = ((2.0 * v2 + 6.0 * rho * v3) - by_r / (begin + rho)) * per_r * per_r
    return force, by_r * per_r, curvature


@inner(fastmath={"contract"}, forceinline=True)
def pair_force_and_tangent(
    law: FloatArray, at: int, place: int, u: float, approach: float
) -> tuple[float, float, float]:
    """Force, tangent and the tangent's derivative of a pair with a penetration ``approach`` > 0.

    ``place``: index of its numbers. `tooth_force` has the same law in line, with the energy: it looks up what its
    pairs share only once.
    """
    unit = law_value(law, at + DEPTH_UNIT)
    if unit > 0.0:
        per_unit = 1.0 / unit
        r = math.sqrt(approach * per_unit)
        depth = min(int(r), int(law_value(law, at + DEPTHS)) - 1)
        cell = at + int(law_value(law, at + CELLS_AT)) + depth * int(law_value(law, at + DEPTH_STEP))
        cell += CELL * int(law_value(law, place + 4))
        p = law_value(law, place + 5) + u * law_value(law, place + 6)
        return face_force_and_tangent(law, cell, per_unit, p, float(depth), r - depth)
    c1, c2, c3 = law_value(law, place + 5), law_value(law, place + 6), law_value(law, place + 7)
    k = law_value(law, place + 4) + u * (c1 + u * (c2 + u * c3))
    return k * approach, k, 0.0


@inner(fastmath={"contract"}, forceinline=True)
def pairs_compression(
    law: FloatArray, at: int, number: float, interval: int, u: float, compression: float, precision: float
) -> tuple[float, float]:
    """Compression x of the pairs without the gears' bodies, and its derivative by the mesh's compression.

    x is the root of ``x + C F(x) = compression``, whose left side increases, by Newton's method between bounds.
    The iteration stops where the curvature of F changes a step by no more than ``precision`` of the whole compression,
    and adds that change: the error is of the next order.

    ``number``, ``interval``, ``u``: from `locate`.
    """
    shared = law_value(law, at + SHARED)
    if shared == 0.0:
        return compression, 1.0
    pairs, hunting = int(law_value(law, at + PAIRS)), int(law_value(law, at + HUNTING))
    first = int(number) - int(law_value(law, at + FIRST_PAIR))
    start = at + int(law_value(law, at + PAIRS_AT)) + PAIR * pairs * interval
    low = min(law_value(law, at + FIRST_TOUCH), compression)
    high, x, gain = compression, compression, 1.0
    small = precision * (compression - low)
    unit = law_value(law, at + DEPTH_UNIT)
    if unit > 0.0:
        r = math.sqrt((compression - low) / unit)
        depth = min(int(r), int(law_value(law, at + DEPTHS)) - 1)
        guess = at + int(law_value(law, at + GUESS_AT)) + depth
        left = law_value(law, guess)
        left += min(r - depth, 1.0) * (law_value(law, guess + 1) - left)
        x = low + left * (compression - low)
    for _ in range(_NEWTON_STEPS):
        force, tangent, curvature, nearest = 0.0, 0.0, 0.0, math.inf
        for pair in range(pairs):
            approach, place = penetration(law, at, hunting, first - pair, u, x, start + PAIR * pair)
            nearest = min(nearest, abs(approach))
            if approach > 0.0:
                pair_force, pair_tangent, pair_curvature = pair_force_and_tangent(law, at, place, u, approach)
                force += pair_force
                tangent += pair_tangent
                curvature += pair_curvature
        excess = x + shared * force - compression
        if excess > 0.0:
            high = x
        else:
            low = x
        gain = 1.0 / (1.0 + shared * tangent)
        step = excess * gain
        bend = 0.5 * shared * curvature * gain * step * step
        # The curvature of a pair's force grows towards its first touch.
        if abs(bend) <= small and abs(step) <= max(0.25 * nearest, 0.01 * small):
            x -= step + bend
            break
        x -= step
        if not low <= x <= high:
            x = 0.5 * (low + high)
    return x, gain


@uncounted(fastmath={"contract"})
def ranked_penetration(phase: float, compression: float, law: FloatArray, at: int, rank: int) -> float:
    """Penetration of the ``rank``-th most compressed tooth pair, by the mesh's compression [m]; -inf without one.

    At least ``rank`` pairs touch where it is positive, as `tooth_force` counts them, with the same arguments. Unlike
    their number it gives the distance to the next change. Before the pair touches, the pairs ahead of it carry the load
    and their gears' bodies deflect by ``c F``.
    """
    return _ranked(phase, compression - tooth_tilt(law, at, phase)[0], law, at, rank)


@uncounted(fastmath={"contract"})
def _ranked(phase: float, compression: float, law: FloatArray, at: int, rank: int) -> float:
    """`ranked_penetration` by the compression beside `tooth_tilt`."""
    number, interval, u, _ = locate(law, at, phase)
    pairs, hunting = int(law_value(law, at + PAIRS)), int(law_value(law, at + HUNTING))
    start = at + int(law_value(law, at + PAIRS_AT)) + PAIR * pairs * interval
    first = int(number) - int(law_value(law, at + FIRST_PAIR))
    shared = law_value(law, at + SHARED)
    for pair in range(pairs):
        depth, _ = penetration(law, at, hunting, first - pair, u, compression, start + PAIR * pair)
        before, force = 0, 0.0
        for rival in range(pairs):
            other, place = penetration(law, at, hunting, first - rival, u, compression, start + PAIR * rival)
            if other > depth or (other == depth and rival < pair):
                before += 1
                if shared > 0.0 and -math.inf < depth < other:
                    force += pair_force_and_tangent(law, at, place, u, other - depth)[0]
        if before == rank - 1:
            return depth - shared * force
    return -math.inf


@inner(fastmath={"contract"}, forceinline=True)
def _contact_force_and_energy(phase: float, compression: float, rate: float, law: FloatArray, at: int) -> TangentForce:
    """Evaluate the law, as `tooth_force` returns it; where it is inlined, what a caller leaves is not computed."""
    tilt, tilt_slope = tooth_tilt(law, at, phase)
    compression -= tilt
    if compression <= law_value(law, at + FIRST_TOUCH):
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0
    number, interval, u, per_width = locate(law, at, phase)
    pairs = int(law_value(law, at + PAIRS))
    hunting = int(law_value(law, at + HUNTING))
    unit = law_value(law, at + DEPTH_UNIT)
    uneven = unit > 0.0
    per_unit, cells, deepest_cell, depth_step = 0.0, 0, 0, 0
    if uneven:
        per_unit = 1.0 / unit
        cells = at + int(law_value(law, at + CELLS_AT))
        deepest_cell, depth_step = int(law_value(law, at + DEPTHS)) - 1, int(law_value(law, at + DEPTH_STEP))
    start = at + int(law_value(law, at + PAIRS_AT)) + PAIR * pairs * interval
    shared = law_value(law, at + SHARED)
    force, tangent, energy, slope = 0.0, 0.0, 0.0, 0.0
    touching, deepest, x = 0, 0.0, compression
    if uneven:
        x, _ = pairs_compression(law, at, number, interval, u, compression, _NEAR_ENOUGH)
    first = int(number) - int(law_value(law, at + FIRST_PAIR))
    doubt = _DOUBT * abs(compression) if shared > 0.0 else 0.0
    # Pairs in contact at the mesh's whole compression lose contact as the bodies take their share, one round each.
    for _ in range(pairs + 1):
        force, tangent, energy, slope, slope_by_x, curve = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        touching, deepest, nearest = 0, 0.0, math.inf
        for pair in range(pairs):
            approach, place = penetration(law, at, hunting, first - pair, u, x, start + PAIR * pair)
            if approach <= 0.0:
                continue
            g2, g3 = law_value(law, place + 2), law_value(law, place + 3)
            gap_slope = law_value(law, place + 1) + u * (2.0 * g2 + 3.0 * u * g3)
            touching += 1
            deepest = max(deepest, approach)
            nearest = min(nearest, approach)
            if uneven:
                r = math.sqrt(approach * per_unit)
                depth = min(int(r), deepest_cell)
                cell = cells + depth * depth_step + CELL * int(law_value(law, place + 4))
                length = law_value(law, place + 6)
                p = law_value(law, place + 5) + u * length
                begin = float(depth)
                pair_force, pair_tangent, pair_energy, pair_slope = face_force(
                    law, cell, unit, per_unit, p, begin, r - begin
                )
                force += pair_force
                tangent += pair_tangent
                energy += pair_energy
                slope += pair_slope * length - pair_force * gap_slope
            else:
                c1, c2, c3 = law_value(law, place + 5), law_value(law, place + 6), law_value(law, place + 7)
                k = law_value(law, place + 4) + u * (c1 + u * (c2 + u * c3))
                k_slope = c1 + u * (2.0 * c2 + 3.0 * u * c3)
                force += k * approach
                tangent += k
                energy += 0.5 * k * approach * approach
                pull = k_slope * approach - k * gap_slope
                slope += (pull - 0.5 * k_slope * approach) * approach
                slope_by_x += pull
                curve += 0.5 * k_slope
        # Excess of x over the pairs' compression with the touching pairs.
        excess = (x - compression + shared * force) / (1.0 + shared * tangent)
        touches = uneven or excess < nearest
        if abs(excess - nearest) <= doubt and not uneven:
            # Within rounding of its first touch a pair counts if the search for that event counts it.
            # At least one touches; max() is no literal, for which the kernel would be compiled anew.
            touches = _ranked(phase, compression, law, at, max(touching, 1)) > 0.0
        if touches:
            energy += excess * (0.5 * excess * tangent - force)
            slope += excess * (excess * curve - slope_by_x)
            force -= excess * tangent
            deepest -= excess
            break
        x -= excess + 2.0 * doubt
    if touching == 0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0
    energy += 0.5 * shared * force * force
    gain = 1.0 / (1.0 + shared * tangent)
    tangent *= gain
    slope = slope * per_width - force * tilt_slope
    damping, damping_depth = law_value(law, at + DAMPING), law_value(law, at + DAMPING_DEPTH)
    if deepest < damping_depth:
        tangent += damping * rate / damping_depth * gain
        damping *= deepest / damping_depth
    if force + damping * rate < 0.0:
        # Teeth do not pull: the damping absorbs at most the springs' force, here all of it.
        return 0.0, 0.0, -force / rate, energy, slope, touching
    return force + damping * rate, tangent, damping, energy, slope, touching


@uncounted(fastmath={"contract"})
def tooth_force(phase: float, compression: float, rate: float, law: FloatArray, at: int) -> TangentForce:
    """Force of the tooth contact, its tangent, and its stored energy.

    Parameters
    ----------
    phase : float
        Mesh periods since the driver's zero, any real number.
    compression, rate : float
        Compression of the contact [m] and its rate [m/s].
    law : ndarray
        Numbers of `gearwhine.coupling.gears.contact.lookup_tables`, of one law or of several laws in a row.
    at : int
        Index at which the numbers of this law begin.

    Returns
    -------
    force : float
        Force that pushes the gears apart [N].
    stiffness_tangent, damping_tangent : float
        Derivatives of the force by compression [N/m] and rate [N s/m]; where the force is held at zero, 0 and the
        coefficient by which the springs' power is lost.
    energy : float
        Energy stored in the pairs [J].
    energy_phase_slope : float
        Derivative of the energy by phase at fixed compression [J per mesh period].
    touching : int
        Number of pairs that touch.
    """
    return _contact_force_and_energy(phase, compression, rate, law, at)


@inner(fastmath={"contract"})
def tooth_force_and_tangents(
    phase: float, compression: float, rate: float, law: FloatArray, at: int
) -> tuple[float, float, float]:
    """Force and its tangents by compression and rate, the first three results of `tooth_force`."""
    force, tangent, damping, _, _, _ = _contact_force_and_energy(phase, compression, rate, law, at)
    return force, tangent, damping


@inner(fastmath={"contract"})
def tooth_force_and_energy(
    phase: float, compression: float, rate: float, law: FloatArray, at: int
) -> tuple[float, float, float, float]:
    """Force, its tangents and the stored energy, the first four results of `tooth_force`."""
    force, tangent, damping, energy, _, _ = _contact_force_and_energy(phase, compression, rate, law, at)
    return force, tangent, damping, energy


@inner(fastmath={"contract"})
def tooth_energy(phase: float, compression: float, force: float, law: FloatArray, at: int) -> float:
    """Energy stored in the pairs [J], the fourth result of `tooth_force`, from their elastic force as far as known.

    With x the pairs' own compression, U(x) + (compression - x)^2 / 2 C is stationary at the compression that the pairs
    have: an error of x, after the Newton step that corrects it, enters in its third power. So one round is mostly
    enough, without the iteration for x.

    Parameters
    ----------
    phase, compression, law, at
        As for `tooth_force`.
    force : float
        Elastic force of the pairs [N], about.
    """
    compression -= tooth_tilt(law, at, phase)[0]
    if compression <= law_value(law, at + FIRST_TOUCH):
        return 0.0
    number, interval, u, _ = locate(law, at, phase)
    pairs, hunting = int(law_value(law, at + PAIRS)), int(law_value(law, at + HUNTING))
    unit = law_value(law, at + DEPTH_UNIT)
    uneven = unit > 0.0
    per_unit, cells, deepest_cell, depth_step = 0.0, 0, 0, 0
    if uneven:
        per_unit = 1.0 / unit
        cells = at + int(law_value(law, at + CELLS_AT))
        deepest_cell, depth_step = int(law_value(law, at + DEPTHS)) - 1, int(law_value(law, at + DEPTH_STEP))
    start = at + int(law_value(law, at + PAIRS_AT)) + PAIR * pairs * interval
    shared = law_value(law, at + SHARED)
    first = int(number) - int(law_value(law, at + FIRST_PAIR))
    x, small, energy = compression - shared * force, _SETTLED * abs(compression), 0.0
    for _ in range(_NEWTON_STEPS):
        force, tangent, energy = 0.0, 0.0, 0.0
        for pair in range(pairs):
            approach, place = penetration(law, at, hunting, first - pair, u, x, start + PAIR * pair)
            if approach <= 0.0:
                continue
            if uneven:
                r = math.sqrt(approach * per_unit)
                depth = min(int(r), deepest_cell)
                cell = cells + depth * depth_step + CELL * int(law_value(law, place + 4))
                p = law_value(law, place + 5) + u * law_value(law, place + 6)
                begin = float(depth)
                pair_force, pair_tangent, pair_energy, _ = face_force(law, cell, unit, per_unit, p, begin, r - begin)
                force += pair_force
                tangent += pair_tangent
                energy += pair_energy
            else:
                c1, c2, c3 = law_value(law, place + 5), law_value(law, place + 6), law_value(law, place + 7)
                k = law_value(law, place + 4) + u * (c1 + u * (c2 + u * c3))
                force += k * approach
                tangent += k
                energy += 0.5 * k * approach * approach
        excess = (x - compression + shared * force) / (1.0 + shared * tangent)
        if abs(excess) <= small:
            energy += excess * (0.5 * excess * tangent - force)
            force -= excess * tangent
            break
        x -= excess
    return energy + 0.5 * shared * force * force


@counted()
def tooth_force_history(
    phase: FloatArray, compression: FloatArray, rate: FloatArray, law: FloatArray, at: int
) -> FloatArray:
    """`tooth_force` at every sample of a history.

    Parameters
    ----------
    phase, compression, rate : ndarray, shape (t,)
    law, at
        As for `tooth_force`.

    Returns
    -------
    ndarray, shape (t, 6)
        Columns in the order that `tooth_force` returns them.
    """
    history = np.empty((phase.size, 6))
    for i in range(phase.size):
        force, tangent, viscous, energy, slope, touching = tooth_force(phase[i], compression[i], rate[i], law, at)
        history[i, 0], history[i, 1], history[i, 2] = force, tangent, viscous
        history[i, 3], history[i, 4], history[i, 5] = energy, slope, touching
    return history


@uncounted()
def friction_shares(
    phase: float, compression: float, law: FloatArray, at: int, by_slices: bool, pitch_point: float, path_end: float
) -> tuple[float, float, float, float]:
    """Compute the friction shares A and B and their derivatives by the compression [1/m]; zeros where no pair touches.

    Parameters
    ----------
    phase, compression : float
        Phase and compression as for `gearwhine.coupling.gears.contact.tooth_force_kernels.tooth_force`.
    law : ndarray
    at : int
        Index at which the numbers begin of the contact law or, with ``by_slices``, of `SlidingFriction.shares`.
    by_slices : bool
        Whether the sliding of a line of contact reverses slice by slice.
    pitch_point, path_end : float
        Distances as in `gearwhine.coupling.gears.contact.sliding_friction.SlidingFriction`.
    """
    compression -= tooth_tilt(law, at, phase)[0]
    number, interval, u, _ = locate(law, at, phase)
    # Compression of the pairs without that of the gears' bodies.
    flank_compression, gain = pairs_compression(law, at, number, interval, u, compression, PRECISE)
    pairs = int(law_value(law, at + PAIRS))
    hunting, first = int(law_value(law, at + HUNTING)), int(law_value(law, at + FIRST_PAIR))
    pairs_at = at + int(law_value(law, at + PAIRS_AT))
    # Shares hold three variants for each: the force, the signed force, and the signed force times its position.
    next_variant = int(law_value(law, at + VARIANT_STEP))
    elastic, stiff, across, across_slope, moments, moments_slope = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for pair in range(pairs):
        start = pairs_at + PAIR * (pairs * interval + pair)
        approach, place = penetration(law, at, hunting, int(number) - first - pair, u, flank_compression, start)
        if approach <= 0.0:
            continue
        force, k, _ = pair_force_and_tangent(law, at, place, u, approach)
        if by_slices:
            signed, signed_slope, _ = pair_force_and_tangent(law, at, place + next_variant, u, approach)
            moment, moment_slope, _ = pair_force_and_tangent(law, at, place + 2 * next_variant, u, approach)
        else:
            # Beyond the path the corner slides, at the end of the path.
            position = min(max(phase - number + (first + pair), 0.0), path_end)
            sign = 1.0 if position > pitch_point else (-1.0 if position < pitch_point else 0.0)
            signed, signed_slope = sign * force, sign * k
            moment, moment_slope = position * signed, position * signed_slope
        elastic += force
        stiff += k
        across += signed
        across_slope += signed_slope
        moments += moment
        moments_slope += moment_slope
    if elastic <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    a, b = across / elastic, moments / elastic
    rise = gain / elastic
    return a, b, (across_slope - a * stiff) * rise, (moments_slope - b * stiff) * rise


@counted()
def friction_history(
    phase: FloatArray,
    compression: FloatArray,
    law: FloatArray,
    by_slices: bool,
    pitch_point: float,
    path_end: float,
) -> FloatArray:
    """Compute A and B of `friction_shares` at every sample, shape (t, 2), from phases and compressions (t,)."""
    history = np.empty((phase.size, 2))
    for i in range(phase.size):
        history[i, 0], history[i, 1], _, _ = friction_shares(
            phase[i], compression[i], law, 0, by_slices, pitch_point, path_end
        )
    return history
