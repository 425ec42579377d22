"""The tooth contact law, compiled: scalars and plain arrays in, scalars out, no allocation.

Importing this module imports numba.  The law is derived in :mod:`coupling.gears.tooth_contact`; arguments
that describe the contact come from `ToothContact.kernel_arguments`:
``tooth_force(phase, compression, rate, *contact.kernel_arguments)``.

What costs time here is not arithmetic but waiting, and arrays that change hands. Numba counts each array in and out of
a function, atomically, unless it can prove that it need not: hence entries are read one by one, never through views,
nothing can raise (division follows numpy), and `face_force` is put in place.  Each argument is copied at every call:
hence few arrays.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from rotors.compiled import counted, inner, uncounted

FloatArray = npt.NDArray[np.float64]
TangentForce = tuple[float, float, float, float, float, int]


@inner(fastmath={"contract"}, inline="always")
def face_force(
    cells: FloatArray, kind: int, at: int, unit: float, per_unit: float, p: float, r: float
) -> tuple[float, float, float, float]:
    """Force, tangent, energy and the energy's slope by p of a pair whose face is loaded unevenly.

    ``cells`` (v, d, m, 20), ``unit``: see :mod:`coupling.gears.face_table`; ``kind`` and ``at`` say which kind of
    pair and which interval, ``unit r^2`` is the compression beyond first touch, ``per_unit`` is 1 / ``unit``.
    """
    cell = min(int(r), cells.shape[1] - 1)
    begin = float(cell)
    rho = r - begin
    # The force's cubic in rho at this p, and how it changes with p: Horner's scheme for both at once.
    top = cells[kind, cell, at, 12]
    low = cells[kind, cell, at, 8] + p * top
    mid = cells[kind, cell, at, 4] + p * low
    v0, d0 = cells[kind, cell, at, 0] + p * mid, mid + p * (low + p * top)
    top = cells[kind, cell, at, 13]
    low = cells[kind, cell, at, 9] + p * top
    mid = cells[kind, cell, at, 5] + p * low
    v1, d1 = cells[kind, cell, at, 1] + p * mid, mid + p * (low + p * top)
    top = cells[kind, cell, at, 14]
    low = cells[kind, cell, at, 10] + p * top
    mid = cells[kind, cell, at, 6] + p * low
    v2, d2 = cells[kind, cell, at, 2] + p * mid, mid + p * (low + p * top)
    top = cells[kind, cell, at, 15]
    low = cells[kind, cell, at, 11] + p * top
    mid = cells[kind, cell, at, 7] + p * low
    v3, d3 = cells[kind, cell, at, 3] + p * mid, mid + p * (low + p * top)
    top = cells[kind, cell, at, 19]
    low = cells[kind, cell, at, 18] + p * top
    mid = cells[kind, cell, at, 17] + p * low
    v4, d4 = cells[kind, cell, at, 16] + p * mid, mid + p * (low + p * top)
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


@uncounted(fastmath={"contract"})
def tooth_force(
    phase: float,
    compression: float,
    rate: float,
    start: float,
    end: float,
    parts: float,
    table: FloatArray,
    damping: float,
    damping_depth: float,
    entering: FloatArray,
    faces: FloatArray,
    face_depth: float,
) -> TangentForce:
    """Force of the tooth contact, its tangent, and its stored energy.

    Parameters
    ----------
    phase : float
        Mesh periods since the driver's zero, any real number.
    compression, rate : float
        Compression of the contact [m] and its rate [m/s].
    start, end : float
        Positions in base pitches between which pairs touch.
    parts : float
        Rows of the table per base pitch.
    table : ndarray, shape (v, m + 1, 11)
        For each kind of pair, the cubics of its gap [m] and of its stiffness [N/m]; see `coupling.gears.law_table`.
    damping : float
        Damping coefficient [N s/m] of a mesh that is pressed together by ``damping_depth`` or more.
    damping_depth : float
        Compression of the deepest pair [m] up to which the damping fades in; 0 for all of it at first touch.
    entering : ndarray, shape (h, 2)
        What pitch deviations add to the gap of the pair that enters at phase n, at n mod h [m], and which kind that
        pair is; empty where all pairs are alike.
    faces : ndarray, shape (v, d, m, 20)
        Where the load spreads over the face, the cells of `coupling.gears.face_table`, on the same intervals; they
        stand for the stiffness, and the gap is that of first touch.
    face_depth : float
        Their unit of compression [m]; 0 where there are none.

    Returns
    -------
    force : float
        Pushing the gears apart [N].
    stiffness_tangent, damping_tangent : float
        Its derivatives by compression [N/m] and rate [N s/m]; where the force is held at zero, 0 and the
        coefficient by which the springs' power is lost.
    energy : float
        Stored in the pairs [J].
    energy_phase_slope : float
        Derivative of the energy by phase at fixed compression [J per mesh period].
    touching : int
        Number of pairs that touch.
    """
    number = np.floor(phase)
    position = phase - number
    if position >= 1.0:  # a phase a hair below a whole number rounds up
        position -= 1.0
        number += 1.0
    ahead = np.ceil(start - position)
    position += ahead
    number -= ahead
    uneven = face_depth > 0.0
    per_depth = 1.0 / face_depth if uneven else 0.0
    force, tangent, energy, slope = 0.0, 0.0, 0.0, 0.0
    touching, deepest = 0, 0.0
    next_at, next_kind, next_u, next_approach, next_root = 0, 0, 0.0, -1.0, 0.0
    more = True
    while more:
        # Where the next pair is, one pair ahead of its forces, which need not wait for looking it up and for the root.
        at, kind, u, approach, root = next_at, next_kind, next_u, next_approach, next_root
        more = position < end
        if more:
            next_at = int(table[0, int((position - start) * parts), 0])
            while table[0, next_at + 1, 1] <= position:
                next_at += 1
            next_u = (position - table[0, next_at, 1]) * table[0, next_at, 2]
            next_approach = compression
            if entering.size > 0:
                pair = int(number) % entering.shape[0]
                next_approach -= entering[pair, 0]
                next_kind = int(entering[pair, 1])
            g0, g1 = table[next_kind, next_at, 3], table[next_kind, next_at, 4]
            g2, g3 = table[next_kind, next_at, 5], table[next_kind, next_at, 6]
            next_approach -= g0 + next_u * (g1 + next_u * (g2 + next_u * g3))
            if uneven:
                next_root = math.sqrt(max(next_approach, 0.0) * per_depth)
            position += 1.0
            number -= 1.0
        if approach > 0.0:
            per_width = table[0, at, 2]
            g1, g2, g3 = table[kind, at, 4], table[kind, at, 5], table[kind, at, 6]
            gap_slope = g1 + u * (2.0 * g2 + 3.0 * u * g3)
            touching += 1
            deepest = max(deepest, approach)
            if uneven:
                pair_force, pair_tangent, pair_energy, pair_slope = face_force(
                    faces, kind, at, face_depth, per_depth, u, root
                )
                force += pair_force
                tangent += pair_tangent
                energy += pair_energy
                slope += (pair_slope - pair_force * gap_slope) * per_width
            else:
                c0, c1, c2, c3 = table[kind, at, 7], table[kind, at, 8], table[kind, at, 9], table[kind, at, 10]
                k = c0 + u * (c1 + u * (c2 + u * c3))
                k_slope = c1 + u * (2.0 * c2 + 3.0 * u * c3)
                force += k * approach
                tangent += k
                energy += 0.5 * k * approach * approach
                slope += (0.5 * k_slope * approach - k * gap_slope) * approach * per_width
    if touching == 0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0
    if deepest < damping_depth:
        tangent += damping * rate / damping_depth
        damping *= deepest / damping_depth
    if force + damping * rate < 0.0:
        # Teeth do not pull: the damping takes no more than the springs give, and all of that.
        return 0.0, 0.0, -force / rate, energy, slope, touching
    return force + damping * rate, tangent, damping, energy, slope, touching


@counted()
def tooth_force_history(
    phase: FloatArray,
    compression: FloatArray,
    rate: FloatArray,
    start: float,
    end: float,
    parts: float,
    table: FloatArray,
    damping: float,
    damping_depth: float,
    entering: FloatArray,
    faces: FloatArray,
    face_depth: float,
) -> FloatArray:
    """`tooth_force` at every sample of a history.

    Parameters
    ----------
    phase, compression, rate : ndarray, shape (t,)
    start, end, parts, table, damping, damping_depth, entering, faces, face_depth
        As for `tooth_force`.

    Returns
    -------
    ndarray, shape (t, 6)
        Columns in the order that `tooth_force` returns them.
    """
    law = (start, end, parts, table, damping, damping_depth, entering, faces, face_depth)
    history = np.empty((phase.size, 6))
    for i in range(phase.size):
        force, tangent, viscous, energy, slope, touching = tooth_force(phase[i], compression[i], rate[i], *law)
        history[i, 0], history[i, 1], history[i, 2] = force, tangent, viscous
        history[i, 3], history[i, 4], history[i, 5] = energy, slope, touching
    return history
