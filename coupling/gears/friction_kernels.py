r"""Tooth friction, compiled: shares of the mesh force that act across the line of action.

With the elastic forces E_j of the pairs at the positions s_j, and F the whole force with its damping, which the pairs
are taken to share as they share the elastic one, friction pushes with

    mu F A,    A = sum_j E_j sgn(s_j - s_C) / sum_j E_j,        mu F B,    B = sum_j E_j sgn(s_j - s_C) s_j / sum_j E_j

along the directions in which a pair at s slides, ``a + s b``. Where a line of contact lies across the path, its slices
reverse one after another, each under its own load: sums over slices replace the E_j (:mod:`coupling.gears.sliding`).
With A and B go their slopes by the compression, so that Newton's tangent, no longer symmetric, is exact: k_j being that
of each pair by the pairs' own compression x, ``A' = (sum_j k_j sgn(...) - A k) / E dx/d delta``.

Importing this module imports numba.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from coupling.gears.kernels import PRECISE, law_value, locate, pair_force_and_tangent, pairs_compression, penetration
from coupling.gears.law_table import FIRST_PAIR, HUNTING, KIND_STEP, PAIR, PAIRS, PAIRS_AT
from rotors.compiled import counted, uncounted

FloatArray = npt.NDArray[np.float64]


@uncounted()
def friction_shares(
    phase: float, compression: float, law: FloatArray, at: int, by_slices: bool, pitch_point: float, path_end: float
) -> tuple[float, float, float, float]:
    """Compute the friction shares A and B and their derivatives by the compression [1/m]; zeros where no pair touches.

    Parameters
    ----------
    phase, compression : float
        As for `coupling.gears.kernels.tooth_force`.
    law : ndarray
    at : int
        Index at which the numbers begin of the contact law or, with ``by_slices``, of `SlidingFriction.shares`.
    by_slices : bool
        Whether the sliding of a line of contact reverses slice by slice.
    pitch_point, path_end : float
        As in `coupling.gears.sliding.SlidingFriction`.
    """
    number, interval, u, _ = locate(law, at, phase)
    # The pairs' own compression, without that of their gears' bodies.
    own, gain = pairs_compression(law, at, number, interval, u, compression, PRECISE)
    pairs = int(law_value(law, at + PAIRS))
    hunting, first = int(law_value(law, at + HUNTING)), int(law_value(law, at + FIRST_PAIR))
    pairs_at = at + int(law_value(law, at + PAIRS_AT))
    # Shares hold three kinds for each: the force, the signed force, and the signed force times its position.
    next_kind = int(law_value(law, at + KIND_STEP))
    elastic, stiff, across, across_slope, moments, moments_slope = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for pair in range(pairs):
        start = pairs_at + PAIR * (pairs * interval + pair)
        approach, here = penetration(law, at, hunting, int(number) - first - pair, u, own, start)
        if approach <= 0.0:
            continue
        force, k, _ = pair_force_and_tangent(law, at, here, u, approach)
        if by_slices:
            signed, signed_slope, _ = pair_force_and_tangent(law, at, here + next_kind, u, approach)
            moment, moment_slope, _ = pair_force_and_tangent(law, at, here + 2 * next_kind, u, approach)
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
