"""The tooth contact law, compiled: scalars and plain arrays in, scalars out, no allocation.

Importing this module imports numba.  The law is derived in :mod:`coupling.gears.tooth_contact`; arguments
that describe the contact come from `ToothContact.kernel_arguments`:
``tooth_force(phase, compression, rate, *contact.kernel_arguments)``.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
TangentForce = tuple[float, float, float, float, float, int]


@njit(cache=True, nogil=True)
def face_force(cells: FloatArray, unit: float, p: float, depth: float) -> tuple[float, float, float, float]:
    """Force, tangent, energy and the energy's slope by p of a pair whose face is loaded unevenly.

    ``cells`` (d, 20), ``unit``: see :mod:`coupling.gears.face_table`; ``depth`` is the compression beyond first touch.
    """
    r = math.sqrt(depth / unit)
    last = cells.shape[0] - 1
    cell = min(int(r), last)
    rho = min(r - cell, 1.0)
    begin = float(cell)
    c = cells[cell]
    # The force's cubic in rho at this p, and how it changes with p.
    v0 = c[0] + p * (c[4] + p * (c[8] + p * c[12]))
    v1 = c[1] + p * (c[5] + p * (c[9] + p * c[13]))
    v2 = c[2] + p * (c[6] + p * (c[10] + p * c[14]))
    v3 = c[3] + p * (c[7] + p * (c[11] + p * c[15]))
    d0 = c[4] + p * (2.0 * c[8] + 3.0 * p * c[12])
    d1 = c[5] + p * (2.0 * c[9] + 3.0 * p * c[13])
    d2 = c[6] + p * (2.0 * c[10] + 3.0 * p * c[14])
    d3 = c[7] + p * (2.0 * c[11] + 3.0 * p * c[15])
    force = v0 + rho * (v1 + rho * (v2 + rho * v3))
    # Integrals of the powers of rho times 2 a r.
    w0 = begin + 0.5 * rho
    w1 = rho * (0.5 * begin + rho / 3.0)
    w2 = rho * rho * (begin / 3.0 + 0.25 * rho)
    w3 = rho * rho * rho * (0.25 * begin + 0.2 * rho)
    twice = 2.0 * unit * rho
    energy = c[16] + p * (c[17] + p * (c[18] + p * c[19])) + twice * (v0 * w0 + v1 * w1 + v2 * w2 + v3 * w3)
    slope = c[17] + p * (2.0 * c[18] + 3.0 * p * c[19]) + twice * (d0 * w0 + d1 * w1 + d2 * w2 + d3 * w3)
    at = 2.0 * unit * (begin + rho)
    tangent = (v1 + rho * (2.0 * v2 + 3.0 * rho * v3)) / at if at > 0.0 else 0.0
    if r > last + 1.0:
        beyond = depth - unit * (last + 1.0) ** 2
        tangent_slope = (d1 + 2.0 * d2 + 3.0 * d3) / at
        energy += (force + 0.5 * tangent * beyond) * beyond
        slope += (d0 + d1 + d2 + d3 + 0.5 * tangent_slope * beyond) * beyond
        force += tangent * beyond
    return force, tangent, energy, slope


@njit(cache=True, nogil=True)
def tooth_force(
    phase: float,
    compression: float,
    rate: float,
    knots: FloatArray,
    curves: FloatArray,
    damping: float,
    damping_depth: float,
    pair_gaps: FloatArray,
    pair_kinds: IntArray,
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
    knots : ndarray, shape (m + 1,)
        Positions in base pitches; pairs touch between the first and the last.
    curves : ndarray, shape (v, m, 8)
        On every interval and for each kind of pair, the cubic coefficients of its stiffness [N/m] and then those of
        its gap [m], in a variable that runs from 0 to 1.
    damping : float
        Damping coefficient [N s/m] of a mesh that is pressed together by ``damping_depth`` or more.
    damping_depth : float
        Compression of the deepest pair [m] up to which the damping fades in; 0 for all of it at first touch.
    pair_gaps : ndarray, shape (h,)
        What pitch deviations add to the gap of the pair that enters at phase n, at n mod h [m]; empty where all
        pairs are alike.
    pair_kinds : ndarray of int, shape (h,)
        Which kind that pair is.
    faces : ndarray, shape (v, m, d, 20)
        Where the load spreads over the face, the cells of `coupling.gears.face_table`, on the same knots; they stand
        for the stiffness, and the gap is that of first touch. Empty where it does not.
    face_depth : float
        Their unit of compression [m].

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
    number = math.floor(phase)
    position = phase - number
    if position >= 1.0:  # a phase a hair below a whole number rounds up
        position -= 1.0
        number += 1
    pieces = knots.size - 1
    start, end = knots[0], knots[pieces]
    per_length = pieces / (end - start)
    force, tangent, energy, slope = 0.0, 0.0, 0.0, 0.0
    touching, deepest, kind = 0, 0.0, 0
    ahead = math.ceil(start - position)
    position += ahead
    number -= ahead
    while position < end:
        # The knots are nearly uniform: a guess, then a few steps.
        at = min(int((position - start) * per_length), pieces - 1)
        while knots[at] > position and at > 0:
            at -= 1
        while knots[at + 1] <= position and at < pieces - 1:
            at += 1
        gap_of_pair = 0.0
        if pair_gaps.size > 0:
            pair = number % pair_gaps.size
            gap_of_pair, kind = pair_gaps[pair], pair_kinds[pair]
        span = knots[at + 1] - knots[at]
        u = (position - knots[at]) / span
        # Single entries: a view of the row would be counted, in and out, at every call.
        c4, c5, c6, c7 = curves[kind, at, 4], curves[kind, at, 5], curves[kind, at, 6], curves[kind, at, 7]
        approach = compression - gap_of_pair - (c4 + u * (c5 + u * (c6 + u * c7)))
        if approach > 0.0 and faces.size > 0:
            pair_force, pair_tangent, pair_energy, pair_slope = face_force(faces[kind, at], face_depth, u, approach)
            gap_slope = c5 + u * (2.0 * c6 + 3.0 * u * c7)
            force += pair_force
            tangent += pair_tangent
            energy += pair_energy
            slope += (pair_slope - pair_force * gap_slope) / span
            touching += 1
            deepest = max(deepest, approach)
        elif approach > 0.0:
            c0, c1, c2, c3 = curves[kind, at, 0], curves[kind, at, 1], curves[kind, at, 2], curves[kind, at, 3]
            k = c0 + u * (c1 + u * (c2 + u * c3))
            k_slope = c1 + u * (2.0 * c2 + 3.0 * u * c3)
            gap_slope = c5 + u * (2.0 * c6 + 3.0 * u * c7)
            force += k * approach
            tangent += k
            energy += 0.5 * k * approach * approach
            slope += (0.5 * k_slope * approach - k * gap_slope) * approach / span
            touching += 1
            deepest = max(deepest, approach)
        position += 1.0
        number -= 1
    if touching == 0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0
    if deepest < damping_depth:
        tangent += damping * rate / damping_depth
        damping *= deepest / damping_depth
    if force + damping * rate < 0.0:
        # Teeth do not pull: the damping takes no more than the springs give, and all of that.
        return 0.0, 0.0, -force / rate, energy, slope, touching
    return force + damping * rate, tangent, damping, energy, slope, touching


@njit(cache=True, nogil=True)
def tooth_force_history(
    phase: FloatArray,
    compression: FloatArray,
    rate: FloatArray,
    knots: FloatArray,
    curves: FloatArray,
    damping: float,
    damping_depth: float,
    pair_gaps: FloatArray,
    pair_kinds: IntArray,
    faces: FloatArray,
    face_depth: float,
) -> FloatArray:
    """`tooth_force` at every sample of a history.

    Parameters
    ----------
    phase, compression, rate : ndarray, shape (t,)
    knots, curves, damping, damping_depth, pair_gaps, pair_kinds, faces, face_depth
        As for `tooth_force`.

    Returns
    -------
    ndarray, shape (t, 6)
        Columns in the order that `tooth_force` returns them.
    """
    history = np.empty((phase.size, 6))
    for i in range(phase.size):
        force, tangent, viscous, energy, slope, touching = tooth_force(
            phase[i],
            compression[i],
            rate[i],
            knots,
            curves,
            damping,
            damping_depth,
            pair_gaps,
            pair_kinds,
            faces,
            face_depth,
        )
        history[i, 0], history[i, 1], history[i, 2] = force, tangent, viscous
        history[i, 3], history[i, 4], history[i, 5] = energy, slope, touching
    return history
