"""Compiled energy of a row of balls, see :mod:`gearwhine.rotors.rolling_bearings.element_contacts`.

Importing this module imports numba.
"""

import math

from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.compiled import FUSED, uncounted


@uncounted(fastmath=FUSED)
def ball_energy(
    start: FloatArray,
    motion: FloatArray,
    stiffness: float,
    distance: float,
    excess: float,
    q: FloatArray,
    gradient: FloatArray,
    hessian: FloatArray,
) -> tuple[float, float]:
    """Add the derivatives of the energy ⅖ K δ^{5/2} of all balls over the ring's displacement; energy and loads.

    Parameters
    ----------
    start : ndarray, shape (2,)
        v₀ [m].
    motion : ndarray, shape (n, 2, 5)
        B of each ball.
    stiffness, distance, excess : float
        K [N/m^{3/2}], A [m] and |v₀|² − A² [m²].
    q : ndarray, shape (5,)
        Displacement of the inner ring.
    gradient, hessian : ndarray, shape (5,) and (5, 5)
        The derivatives are added to these.

    Returns
    -------
    float, float
        Energy [J] and the sum of the loads [N].
    """
    value, loads = 0.0, 0.0
    for ball in range(motion.shape[0]):
        u, w = 0.0, 0.0
        for i in range(5):
            u += motion[ball, 0, i] * q[i]
            w += motion[ball, 1, i] * q[i]
        x, y = start[0] + u, start[1] + w
        length = math.sqrt(x * x + y * y)
        approach = (excess + 2.0 * (u * start[0] + w * start[1]) + u * u + w * w) / (length + distance)
        if not approach > 0.0:
            continue
        root = math.sqrt(approach)
        load, tangent = stiffness * approach * root, 1.5 * stiffness * root
        value += 0.4 * load * approach
        loads += load
        x, y, across = x / length, y / length, load / length
        for i in range(5):
            along_i = x * motion[ball, 0, i] + y * motion[ball, 1, i]
            across_i = x * motion[ball, 1, i] - y * motion[ball, 0, i]
            gradient[i] += load * along_i
            for j in range(5):
                along_j = x * motion[ball, 0, j] + y * motion[ball, 1, j]
                across_j = x * motion[ball, 1, j] - y * motion[ball, 0, j]
                hessian[i, j] += tangent * along_i * along_j + across * across_i * across_j
    return value, loads
