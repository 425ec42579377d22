"""The tooth contacts within a time step, compiled: their compressions, their law, and their forces.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from coupling.gears.kernels import tooth_force
from coupling.kernel_arrays import Contacts

FloatArray = npt.NDArray[np.float64]

_NEWTON_STEPS = 30


@njit(cache=True, nogil=True)
def compression_of(contacts: Contacts, k: int, q: FloatArray, v: FloatArray, time: float) -> tuple[float, float]:
    """δ and δ' of a contact."""
    delta, rate = -contacts.clearance[k], 0.0
    for i in range(q.size):
        delta += contacts.direction[k, i] * q[i]
        rate += contacts.direction[k, i] * v[i]
    for m in range(contacts.errors.shape[1]):
        amplitude, w = contacts.errors[k, m, 0], contacts.errors[k, m, 1]
        angle = w * time + contacts.errors[k, m, 2]
        delta -= amplitude * math.cos(angle)
        rate += amplitude * w * math.sin(angle)
    return delta, rate


@njit(cache=True, nogil=True, inline="always")
def law_of(
    contacts: Contacts, k: int, time: float, delta: float, rate: float
) -> tuple[float, float, float, float, float, int]:
    """The contact law of one contact; see :func:`coupling.gears.kernels.tooth_force`."""
    return tooth_force(
        contacts.phase[k] + contacts.rate[k] * time,
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


@njit(cache=True, nogil=True)
def contact_state(contacts: Contacts, time: float, delta: FloatArray, rate: FloatArray, force: FloatArray) -> float:
    """Fill in the forces; returns the energy stored in the teeth."""
    energy = 0.0
    for k in range(force.size):
        law = law_of(contacts, k, time, delta[k], rate[k])
        force[k] = law[0]
        energy += law[3]
    return energy


@njit(cache=True, nogil=True)
def contact_energy(contacts: Contacts, q: FloatArray, v: FloatArray, time: float) -> float:
    """Energy stored in the teeth at a time [J]."""
    energy = 0.0
    for k in range(contacts.phase.size):
        delta, rate = compression_of(contacts, k, q, v, time)
        energy += law_of(contacts, k, time, delta, rate)[3]
    return energy


@njit(cache=True, nogil=True)
def settle(
    contacts: Contacts,
    q: FloatArray,
    v: FloatArray,
    time: float,
    flexibility: FloatArray,
    by_displacement: float,
    by_velocity: float,
    force: FloatArray,
) -> bool:
    """Contact forces from the motion without contact, by Newton's method on the compressions.

    The law is piecewise linear, so the method ends after a few steps with the right set of touching pairs.
    """
    c = force.size
    free, free_rate = np.zeros(c), np.zeros(c)
    delta = np.zeros(c)
    stiff = np.zeros(c)
    for k in range(c):
        free[k], free_rate[k] = compression_of(contacts, k, q, v, time)
        delta[k] = free[k]
    for _ in range(_NEWTON_STEPS):
        for k in range(c):
            rate = free_rate[k] + by_velocity / by_displacement * (delta[k] - free[k])
            law = law_of(contacts, k, time, delta[k], rate)
            force[k] = law[0]
            stiff[k] = law[1] + law[2] * by_velocity / by_displacement
        jacobian, residual = np.eye(c), np.zeros(c)
        largest, scale = 0.0, 1e-300
        for k in range(c):
            residual[k] = free[k] - delta[k]
            for j in range(c):
                residual[k] -= by_displacement * flexibility[k, j] * force[j]
                jacobian[k, j] += by_displacement * flexibility[k, j] * stiff[j]
            scale = max(scale, abs(free[k]) + abs(delta[k]))
            largest = max(largest, abs(residual[k]))
        if largest <= 1e-13 * scale:
            return True
        _solve_in_place(jacobian, residual)
        for k in range(c):
            delta[k] += residual[k]
    return False


@njit(cache=True, nogil=True)
def _solve_in_place(matrix: FloatArray, right: FloatArray) -> None:
    """Gaussian elimination with row exchanges for the few contacts; `right` becomes the solution."""
    n = right.size
    for column in range(n):
        pivot = column
        for row in range(column + 1, n):
            if abs(matrix[row, column]) > abs(matrix[pivot, column]):
                pivot = row
        if pivot != column:
            for j in range(n):
                matrix[column, j], matrix[pivot, j] = matrix[pivot, j], matrix[column, j]
            right[column], right[pivot] = right[pivot], right[column]
        for row in range(column + 1, n):
            factor = matrix[row, column] / matrix[column, column]
            for j in range(column, n):
                matrix[row, j] -= factor * matrix[column, j]
            right[row] -= factor * right[column]
    for row in range(n - 1, -1, -1):
        for j in range(row + 1, n):
            right[row] -= matrix[row, j] * right[j]
        right[row] /= matrix[row, row]
