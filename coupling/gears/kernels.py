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
TangentForce = tuple[float, float, float, float, float, int]


@njit(cache=True, nogil=True)
def tooth_force(
    phase: float,
    compression: float,
    rate: float,
    contact_ratio: float,
    stiffness: FloatArray,
    deviation_knots: FloatArray,
    deviation: FloatArray,
    damping: float,
    pitch_gaps: FloatArray,
    damping_depth: float,
) -> TangentForce:
    """Force of the tooth contact, its tangent, and its stored energy.

    Parameters
    ----------
    phase : float
        Mesh periods since the driver's zero, any real number.
    compression, rate : float
        Compression of the contact [m] and its rate [m/s].
    contact_ratio : float
        Length of contact in base pitches.
    stiffness : ndarray, shape (n, 4)
        Cubic coefficients of a pair's stiffness [N/m] on n equal intervals of [0, contact_ratio].
    deviation_knots, deviation : ndarray, shapes (m + 1,), (m, 4)
        Knots and cubic coefficients of a pair's profile deviation [m].
    damping : float
        Damping coefficient [N s/m] of a mesh that is pressed together by ``damping_depth`` or more.
    pitch_gaps : ndarray, shape (h,)
        What pitch deviations add to the gap of the pair that enters at phase n, at n mod h [m]; empty for none.
    damping_depth : float
        Compression of the deepest pair [m] up to which the damping fades in; 0 for all of it at first touch.

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
    intervals = stiffness.shape[0]
    width = contact_ratio / intervals
    force, tangent, energy, slope = 0.0, 0.0, 0.0, 0.0
    touching, deepest = 0, 0.0
    while position < contact_ratio:
        low, high = 0, deviation_knots.size - 1
        while high - low > 1:
            middle = (low + high) // 2
            if deviation_knots[middle] <= position:
                low = middle
            else:
                high = middle
        span = deviation_knots[low + 1] - deviation_knots[low]
        u = (position - deviation_knots[low]) / span
        gap = deviation[low, 0] + u * (deviation[low, 1] + u * (deviation[low, 2] + u * deviation[low, 3]))
        if pitch_gaps.size > 0:
            gap += pitch_gaps[number % pitch_gaps.size]
        approach = compression - gap
        if approach > 0.0:
            gap_slope = deviation[low, 1] + u * (2.0 * deviation[low, 2] + 3.0 * u * deviation[low, 3])
            at = min(int(position / width), intervals - 1)
            v = position / width - at
            k = stiffness[at, 0] + v * (stiffness[at, 1] + v * (stiffness[at, 2] + v * stiffness[at, 3]))
            k_slope = stiffness[at, 1] + v * (2.0 * stiffness[at, 2] + 3.0 * v * stiffness[at, 3])
            force += k * approach
            tangent += k
            energy += 0.5 * k * approach * approach
            slope += 0.5 * k_slope / width * approach * approach - k * approach * gap_slope / span
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
    contact_ratio: float,
    stiffness: FloatArray,
    deviation_knots: FloatArray,
    deviation: FloatArray,
    damping: float,
    pitch_gaps: FloatArray,
    damping_depth: float,
) -> FloatArray:
    """`tooth_force` at every sample of a history.

    Parameters
    ----------
    phase, compression, rate : ndarray, shape (t,)
    contact_ratio, stiffness, deviation_knots, deviation, damping, pitch_gaps, damping_depth
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
            contact_ratio,
            stiffness,
            deviation_knots,
            deviation,
            damping,
            pitch_gaps,
            damping_depth,
        )
        history[i, 0], history[i, 1], history[i, 2] = force, tangent, viscous
        history[i, 3], history[i, 4], history[i, 5] = energy, slope, touching
    return history
