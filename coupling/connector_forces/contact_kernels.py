"""Tooth contact forces within a time step, compiled: compressions, contact law, friction, Newton iteration.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from coupling.connector_forces.bearing_kernels import evaluate_bearings
from coupling.connector_forces.dense_kernels import solve_in_place
from coupling.connector_forces.kernel_arrays import Bearings, Contacts, Scratch
from coupling.gears.contact.tooth_force_kernels import friction_shares, ranked_penetration, tooth_force
from rotors.numerics.compiled import inner

FloatArray = npt.NDArray[np.float64]

_NEWTON_STEPS = 30

# Columns of the laws' table: results of coupling.gears.contact.tooth_force_kernels.tooth_force.
FORCE, TANGENT, DAMPING, ENERGY, PHASE_SLOPE, TOUCHING = 0, 1, 2, 3, 4, 5


@inner()
def flank_gap(
    clearance: FloatArray, errors: FloatArray, k: int, nominal_time: float, speed: float
) -> tuple[float, float]:
    """Gap of a contact, its clearance (backlash) and runout error, which reduces its compression [m]; its rate."""
    value, rate = clearance[k], 0.0
    for m in range(errors.shape[1]):
        amplitude, w = errors[k, m, 0], errors[k, m, 1]
        if amplitude != 0.0:
            angle = w * nominal_time + errors[k, m, 2]
            value += amplitude * math.cos(angle)
            rate -= amplitude * w * speed * math.sin(angle)
    return value, rate


@inner(inline="always")
def evaluate_contact(
    contacts: Contacts, k: int, nominal_time: float, delta: float, rate: float, laws: FloatArray, row: int
) -> None:
    """Evaluate the contact law into a row of the laws' table."""
    phase = contacts.phase[k] + contacts.mesh_frequency[k] * nominal_time
    law = tooth_force(phase, delta, rate, contacts.law, contacts.law_at[k])
    laws[row, FORCE], laws[row, TANGENT], laws[row, DAMPING] = law[0], law[1], law[2]
    laws[row, ENERGY], laws[row, PHASE_SLOPE], laws[row, TOUCHING] = law[3], law[4], law[5]


@inner()
def penetration(contacts: Contacts, k: int, nominal_time: float, delta: float, rank: int) -> float:
    """Penetration of the ``rank``-th most compressed tooth pair of a contact [m]."""
    return ranked_penetration(
        contacts.phase[k] + contacts.mesh_frequency[k] * nominal_time, delta, contacts.law, contacts.law_at[k], rank
    )


@inner()
def evaluate_friction(
    contacts: Contacts, k: int, nominal_time: float, delta: float, laws: FloatArray, force: FloatArray, drag: FloatArray
) -> None:
    """Evaluate the two friction forces of a contact, and their slopes by compression and by rate (4,)."""
    row = contacts.friction_row[k]
    a, b, a_slope, b_slope = 0.0, 0.0, 0.0, 0.0
    if laws[k, FORCE] > 0.0:
        by_slices = contacts.shares_at[k] >= 0
        a, b, a_slope, b_slope = friction_shares(
            contacts.phase[k] + contacts.mesh_frequency[k] * nominal_time,
            delta,
            contacts.law,
            contacts.shares_at[k] if by_slices else contacts.law_at[k],
            by_slices,
            contacts.friction[k, 1],
            contacts.friction[k, 2],
        )
    coulomb = contacts.friction[k, 0] * laws[k, FORCE]
    stiff, viscous = contacts.friction[k, 0] * laws[k, TANGENT], contacts.friction[k, 0] * laws[k, DAMPING]
    force[row], force[row + 1] = coulomb * a, coulomb * b
    drag[0], drag[1] = stiff * a + coulomb * a_slope, stiff * b + coulomb * b_slope
    drag[2], drag[3] = viscous * a, viscous * b


@inner(inline="always")
def evaluate_forces(contacts: Contacts, bearings: Bearings, nominal_time: float, scratch: Scratch) -> None:
    """Evaluate all nonlinear laws at the deflections and rates in ``scratch``: teeth, their friction, bearings.

    Fills in the laws' table, the force along every direction, the friction's slopes, the bearings' tangents, and the
    energy stored in the bearings.
    """
    delta, rate, laws, push = scratch.delta, scratch.rate, scratch.laws, scratch.push
    for k in range(contacts.phase.size):
        evaluate_contact(contacts, k, nominal_time, delta[k], rate[k], laws, k)
        push[k] = laws[k, FORCE]
        if contacts.friction_row[k] >= 0:
            evaluate_friction(contacts, k, nominal_time, delta[k], laws, push, scratch.drag[k])
    if bearings.axis.size > 0:
        evaluate_bearings(
            bearings, contacts.phase.size, nominal_time, delta, push, scratch.tangents, scratch.bearing_work
        )


@inner(inline="always")
def solve_contact_forces(
    contacts: Contacts,
    bearings: Bearings,
    nominal_time: float,
    flexibility: FloatArray,
    by_displacement: float,
    by_velocity: float,
    scratch: Scratch,
) -> bool:
    """Contact forces by Newton iteration, from the deflections and rates without them.

    Fills in deflections, rates, laws and forces; returns whether the iteration converged. The tooth contact law is
    piecewise linear but for wide faces, so the iteration ends after a few steps with the right set of touching pairs.
    Bearings begin with their last forces. The function is inlined, as passing its arguments would cost time at every
    call.
    """
    free, free_rate, delta, rate, push = (
        scratch.delta_free,
        scratch.rate_free,
        scratch.delta,
        scratch.rate,
        scratch.push,
    )
    laws, drag, tangents, jacobian, residual = (
        scratch.laws, scratch.drag, scratch.tangents, scratch.jacobian, scratch.residual,
    )  # fmt: skip
    c, u, directions = contacts.phase.size, free.size, push.size
    per = by_velocity / by_displacement
    for k in range(u):
        delta[k] = free[k]
    for k in range(c, u):
        for j in range(directions):
            delta[k] -= by_displacement * flexibility[k, j] * push[j]
    for _ in range(_NEWTON_STEPS):
        for k in range(c):
            rate[k] = free_rate[k] + per * (delta[k] - free[k])
        evaluate_forces(contacts, bearings, nominal_time, scratch)
        largest, scale = 0.0, 1e-300
        for k in range(u):
            residual[k, 0] = free[k] - delta[k]
            for j in range(directions):
                residual[k, 0] -= by_displacement * flexibility[k, j] * push[j]
            scale = max(scale, abs(free[k]) + abs(delta[k]))
            largest = max(largest, abs(residual[k, 0]))
        if largest <= 1e-13 * scale:
            return True
        for k in range(u):
            for j in range(c):
                stiff = laws[j, TANGENT] + laws[j, DAMPING] * per
                jacobian[k, j] = by_displacement * flexibility[k, j] * stiff
                row = contacts.friction_row[j]
                if row >= 0:
                    jacobian[k, j] += by_displacement * (
                        flexibility[k, row] * (drag[j, 0] + drag[j, 2] * per)
                        + flexibility[k, row + 1] * (drag[j, 1] + drag[j, 3] * per)
                    )
            for number in range(bearings.preload.size):
                first, end = bearings.first[number], bearings.first[number + 1]
                for j in range(first, end):
                    value = 0.0
                    for i in range(first, end):
                        value += flexibility[k, c + i] * tangents[number, i - first, j - first]
                    jacobian[k, c + j] = by_displacement * value
            jacobian[k, k] += 1.0
        solve_in_place(jacobian, residual)
        for k in range(u):
            delta[k] += residual[k, 0]
    return False
