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
        while at > 0 and knots[at] > position:
            at -= 1
        while at < pieces - 1 and knots[at + 1] <= position:
            at += 1
        gap_of_pair = 0.0
        if pair_gaps.size > 0:
            pair = number % pair_gaps.size
            gap_of_pair, kind = pair_gaps[pair], pair_kinds[pair]
        cubic = curves[kind, at]
        span = knots[at + 1] - knots[at]
        u = (position - knots[at]) / span
        approach = compression - gap_of_pair - (cubic[4] + u * (cubic[5] + u * (cubic[6] + u * cubic[7])))
        if approach > 0.0:
            k = cubic[0] + u * (cubic[1] + u * (cubic[2] + u * cubic[3]))
            k_slope = cubic[1] + u * (2.0 * cubic[2] + 3.0 * u * cubic[3])
            gap_slope = cubic[5] + u * (2.0 * cubic[6] + 3.0 * u * cubic[7])
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
) -> FloatArray:
    """`tooth_force` at every sample of a history.

    Parameters
    ----------
    phase, compression, rate : ndarray, shape (t,)
    knots, curves, damping, damping_depth, pair_gaps, pair_kinds
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
        )
        history[i, 0], history[i, 1], history[i, 2] = force, tangent, viscous
        history[i, 3], history[i, 4], history[i, 5] = energy, slope, touching
    return history
