"""The tooth contacts within a time step, compiled: their compressions, their law, and their forces.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from coupling.gears.kernels import tooth_force
from coupling.kernel_arrays import Contacts
from coupling.small_systems import solve_in_place

FloatArray = npt.NDArray[np.float64]

_NEWTON_STEPS = 30

# Columns of the laws' table: what the contact law gives, see coupling.gears.kernels.tooth_force.
FORCE, TANGENT, DAMPING, ENERGY, PHASE_SLOPE, TOUCHING = 0, 1, 2, 3, 4, 5


@njit(cache=True, nogil=True, error_model="numpy")
def deviation_of(clearance: FloatArray, errors: FloatArray, k: int, turned: float, speed: float) -> tuple[float, float]:
    """What runout and clearance take from a contact's compression [m], and its rate [m/s]."""
    value, rate = clearance[k], 0.0
    for m in range(errors.shape[1]):
        amplitude, w = errors[k, m, 0], errors[k, m, 1]
        if amplitude != 0.0:
            angle = w * turned + errors[k, m, 2]
            value += amplitude * math.cos(angle)
            rate -= amplitude * w * speed * math.sin(angle)
    return value, rate


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def take_law(contacts: Contacts, k: int, turned: float, delta: float, rate: float, laws: FloatArray, row: int) -> None:
    """Fill in a row of the laws' table for a contact."""
    if delta <= contacts.first_touch[k]:
        laws[row, :] = 0.0
        return
    law = tooth_force(
        contacts.phase[k] + contacts.rate[k] * turned,
        delta,
        rate,
        contacts.reach[k, 0],
        contacts.reach[k, 1],
        contacts.reach[k, 2],
        contacts.curves[k],
        contacts.damping[k],
        contacts.damping_depth[k],
        contacts.entering[k, : contacts.pairs[k]],
        contacts.faces[k],
        contacts.face_depth[k],
    )
    laws[row, FORCE], laws[row, TANGENT], laws[row, DAMPING] = law[0], law[1], law[2]
    laws[row, ENERGY], laws[row, PHASE_SLOPE], laws[row, TOUCHING] = law[3], law[4], law[5]


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def settle(
    contacts: Contacts,
    turned: float,
    free: FloatArray,
    free_rate: FloatArray,
    flexibility: FloatArray,
    by_displacement: float,
    by_velocity: float,
    delta: FloatArray,
    rate: FloatArray,
    laws: FloatArray,
    jacobian: FloatArray,
    residual: FloatArray,
) -> bool:
    """Contact forces from the compressions and rates without contact, by Newton's method on the compressions.

    Fills in compressions, rates and laws. The law is piecewise linear but for wide faces, so the method ends after a
    few steps with the right set of touching pairs.
    """
    c = free.size
    per = by_velocity / by_displacement
    delta[:] = free
    for _ in range(_NEWTON_STEPS):
        for k in range(c):
            rate[k] = free_rate[k] + per * (delta[k] - free[k])
            take_law(contacts, k, turned, delta[k], rate[k], laws, k)
        largest, scale = 0.0, 1e-300
        for k in range(c):
            residual[k, 0] = free[k] - delta[k]
            for j in range(c):
                residual[k, 0] -= by_displacement * flexibility[k, j] * laws[j, FORCE]
            scale = max(scale, abs(free[k]) + abs(delta[k]))
            largest = max(largest, abs(residual[k, 0]))
        if largest <= 1e-13 * scale:
            return True
        for k in range(c):
            for j in range(c):
                stiff = laws[j, TANGENT] + laws[j, DAMPING] * per
                jacobian[k, j] = by_displacement * flexibility[k, j] * stiff
            jacobian[k, k] += 1.0
        solve_in_place(jacobian, residual)
        for k in range(c):
            delta[k] += residual[k, 0]
    return False
