r"""The friction of a tooth contact, compiled: shares of the mesh force that act across the line of action.

With the elastic forces E_j of the pairs at the positions s_j, and F the whole force with its damping, which the pairs
are taken to share as they share the elastic one, friction pushes with

    mu F A,    A = sum_j E_j sgn(s_j - s_C) / sum_j E_j,        mu F B,    B = sum_j E_j sgn(s_j - s_C) s_j / sum_j E_j

along the directions in which a pair at s slides, ``a + s b``. With A and B go their slopes by the compression, so that
Newton's tangent, no longer symmetric, is exact: k_j being that of each pair, ``A' = (sum_j k_j sgn(...) - A k) / E``.

Importing this module imports numba.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from coupling.gears.kernels import face_force
from rotors.compiled import uncounted

FloatArray = npt.NDArray[np.float64]


@uncounted()
def mean_turn(position: float, pitch_point: float, half_line: float, path_end: float) -> tuple[float, float]:
    """Means of sgn(x - s_C) and of x sgn(x - s_C) over the part of a contact line that lies on the path."""
    low, high = max(position - half_line, 0.0), min(position + half_line, path_end)
    if high <= low:
        # A point; beyond the path the corner that slides there.
        at = min(max(position, 0.0), path_end)
        sign = 1.0 if at > pitch_point else (-1.0 if at < pitch_point else 0.0)
        return sign, sign * at
    turn = min(max(pitch_point, low), high)
    length = high - low
    return (high + low - 2.0 * turn) / length, 0.5 * (high * high + low * low - 2.0 * turn * turn) / length


@uncounted()
def friction_shares(
    phase: float,
    compression: float,
    start: float,
    end: float,
    parts: float,
    table: FloatArray,
    entering: FloatArray,
    faces: FloatArray,
    face_depth: float,
    pitch_point: float,
    half_line: float,
    path_end: float,
) -> tuple[float, float, float, float]:
    """A, B and their slopes by the compression [1/m]; zeros where no pair touches.

    ``start`` to ``face_depth`` are those of `coupling.gears.kernels.tooth_force`, the last three as in
    `coupling.gears.sliding.SlidingFriction`.
    """
    number = np.floor(phase)
    position = phase - number
    if position >= 1.0:  # a phase a hair below a whole number rounds up
        position -= 1.0
        number += 1.0
    ahead = np.ceil(start - position)
    position += ahead
    number -= ahead
    elastic, stiff, across, across_slope, by_place, by_place_slope = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    while position < end:
        at = int(table[0, int((position - start) * parts), 0])
        while table[0, at + 1, 1] <= position:
            at += 1
        u = (position - table[0, at, 1]) * table[0, at, 2]
        approach, kind = compression, 0
        if entering.size > 0:
            pair = int(number) % entering.shape[0]
            approach -= entering[pair, 0]
            kind = int(entering[pair, 1])
        approach -= table[kind, at, 3] + u * (table[kind, at, 4] + u * (table[kind, at, 5] + u * table[kind, at, 6]))
        if approach > 0.0:
            if face_depth > 0.0:
                root = np.sqrt(approach / face_depth)
                force, k, _, _ = face_force(faces, kind, at, face_depth, 1.0 / face_depth, u, root)
            else:
                k = table[kind, at, 7] + u * (table[kind, at, 8] + u * (table[kind, at, 9] + u * table[kind, at, 10]))
                force = k * approach
            sign, placed = mean_turn(position, pitch_point, half_line, path_end)
            elastic += force
            stiff += k
            across += sign * force
            across_slope += sign * k
            by_place += placed * force
            by_place_slope += placed * k
        position += 1.0
        number -= 1.0
    if elastic <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    a, b = across / elastic, by_place / elastic
    return a, b, (across_slope - a * stiff) / elastic, (by_place_slope - b * stiff) / elastic
