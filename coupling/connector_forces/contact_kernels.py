"""Tooth contact forces within a time step, compiled: compressions, contact law, friction, Newton iteration.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.connector_forces.bearing_kernels import evaluate_bearings
from gearwhine.coupling.connector_forces.dense_kernels import largest_row_sum, project, solve_in_place
from gearwhine.coupling.connector_forces.kernel_arrays import Bearings, Contacts, Scratch
from gearwhine.coupling.gears.contact.tooth_force_kernels import (
    friction_shares,
    ranked_penetration,
    tooth_energy,
    tooth_force,
    tooth_force_and_energy,
    tooth_force_and_tangents,
)
from gearwhine.numerics.compiled import inner

FloatArray = npt.NDArray[np.float64]

_NEWTON_STEPS = 30
_CONVERGED = 1e-13
"""Error of the deflections, over the largest of them, at which Newton's iteration ends."""

# Columns of the laws' table: results of gearwhine.coupling.gears.contact.tooth_force_kernels.tooth_force.
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


@inner(forceinline=True)
def evaluate_contact(
    contacts: Contacts, k: int, nominal_time: float, delta: float, rate: float, laws: FloatArray, row: int
) -> None:
    """Evaluate the contact law into a row of the laws' table."""
    phase = contacts.phase[k] + contacts.mesh_frequency[k] * nominal_time
    law = tooth_force(phase, delta, rate, contacts.law, contacts.law_at[k])
    laws[row, FORCE], laws[row, TANGENT], laws[row, DAMPING] = law[0], law[1], law[2]
    laws[row, ENERGY], laws[row, PHASE_SLOPE], laws[row, TOUCHING] = law[3], law[4], law[5]


@inner(forceinline=True)
def evaluate_tangents(
    contacts: Contacts, k: int, nominal_time: float, delta: float, rate: float, laws: FloatArray
) -> None:
    """Evaluate force and tangents of a contact into its row of the laws' table."""
    phase = contacts.phase[k] + contacts.mesh_frequency[k] * nominal_time
    law = tooth_force_and_tangents(phase, delta, rate, contacts.law, contacts.law_at[k])
    laws[k, FORCE], laws[k, TANGENT], laws[k, DAMPING] = law[0], law[1], law[2]


@inner(forceinline=True)
def _evaluate_with_energy(
    contacts: Contacts, k: int, nominal_time: float, delta: float, rate: float, laws: FloatArray
) -> None:
    """Evaluate force, tangents and energy of a contact into its row of the laws' table."""
    phase = contacts.phase[k] + contacts.mesh_frequency[k] * nominal_time
    law = tooth_force_and_energy(phase, delta, rate, contacts.law, contacts.law_at[k])
    laws[k, FORCE], laws[k, TANGENT], laws[k, DAMPING], laws[k, ENERGY] = law[0], law[1], law[2], law[3]


@inner(forceinline=True)
def energy_at(
    contacts: Contacts, k: int, nominal_time: float, delta: float, laws: FloatArray, known: float, rate: float
) -> float:
    """Energy in the teeth of a contact [J], from the row of the laws' table at a compression ``known`` near ``delta``.

    ``rate`` is the rate at ``known``; the elastic force, which the law's damping hides, follows with the tangent.
    """
    phase = contacts.phase[k] + contacts.mesh_frequency[k] * nominal_time
    force = laws[k, FORCE] - laws[k, DAMPING] * rate + laws[k, TANGENT] * (delta - known)
    return tooth_energy(phase, delta, force, contacts.law, contacts.law_at[k])


@inner()
def penetration(contacts: Contacts, k: int, nominal_time: float, delta: float, rank: int) -> float:
    """Penetration of the ``rank``-th most compressed tooth pair of a contact [m]."""
    phase = contacts.phase[k] + contacts.mesh_frequency[k] * nominal_time
    # A literal, which max() does not return, would be compiled for anew.
    return ranked_penetration(phase, delta, contacts.law, contacts.law_at[k], max(rank, 1))


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


@inner(forceinline=True)
def evaluate_forces(contacts: Contacts, bearings: Bearings, nominal_time: float, scratch: Scratch) -> None:
    """Evaluate all nonlinear laws at the deflections and rates in ``scratch``: teeth, their friction, bearings.

    Fills in the laws' table but for the phase slope and the touching pairs, the force along every direction, the
    friction's slopes, the bearings' tangents, and the energy stored in the bearings.
    """
    delta, rate, laws, push = scratch.delta, scratch.rate, scratch.laws, scratch.push
    for k in range(contacts.phase.size):
        _evaluate_with_energy(contacts, k, nominal_time, delta[k], rate[k], laws)
        push[k] = laws[k, FORCE]
        if contacts.friction_row[k] >= 0:
            evaluate_friction(contacts, k, nominal_time, delta[k], laws, push, scratch.drag[k])
    if bearings.axis.size > 0:
        evaluate_bearings(
            bearings, contacts.phase.size, nominal_time, delta, push, scratch.tangents, scratch.bearing_work
        )
        if bearings.damping.shape[0] > 0:
            _add_damping_forces(bearings, contacts.phase.size, rate, push)


@inner()
def _add_damping_forces(bearings: Bearings, offset: int, rate: FloatArray, push: FloatArray) -> None:
    for number in range(bearings.damping.shape[0]):
        first, end = bearings.first[number], bearings.first[number + 1]
        for i in range(first, end):
            for j in range(first, end):
                push[offset + i] += bearings.damping[number, i - first, j - first] * rate[offset + j]


@inner()
def _add_damping_tangents(bearings: Bearings, per: float, tangents: FloatArray) -> None:
    for number in range(bearings.damping.shape[0]):
        for i in range(5):
            for j in range(5):
                tangents[number, i, j] += per * bearings.damping[number, i, j]


@inner()
def _stiffest(contacts: Contacts, bearings: Bearings, per: float, scratch: Scratch) -> float:
    """Largest slope of a law's force so far: what a slope may change by within a small step.

    A contact that touches anew has none yet, and one whose damping is held back has none that means anything.
    """
    laws, stiffest = scratch.laws, scratch.stiffest[0]
    for k in range(contacts.phase.size):
        if laws[k, FORCE] > 0.0:
            stiffest = max(stiffest, laws[k, TANGENT] + laws[k, DAMPING] * per)
    for number in range(bearings.preload.size):
        # A law without rolling elements is linear.
        count = bearings.first[number + 1] - bearings.first[number]
        if bearings.first_row[number + 1] == bearings.first_row[number]:
            continue
        for i in range(count):
            for j in range(count):
                stiffest = max(stiffest, abs(scratch.tangents[number, i, j]))
    scratch.stiffest[0] = stiffest
    return float(stiffest)


@inner()
def _follow_tangents(contacts: Contacts, bearings: Bearings, per: float, scratch: Scratch) -> None:
    """Take forces and the teeth's energy by their tangents to the deflections of the last Newton step."""
    laws, drag, push, step, rate = scratch.laws, scratch.drag, scratch.push, scratch.residual, scratch.rate
    c = contacts.phase.size
    for k in range(c):
        d = step[k, 0]
        laws[k, ENERGY] += (laws[k, FORCE] - laws[k, DAMPING] * rate[k]) * d
        rate[k] += per * d
        if laws[k, FORCE] == 0.0:
            continue
        laws[k, FORCE] += (laws[k, TANGENT] + laws[k, DAMPING] * per) * d
        push[k] = laws[k, FORCE]
        row = contacts.friction_row[k]
        if row >= 0:
            push[row] += (drag[k, 0] + drag[k, 2] * per) * d
            push[row + 1] += (drag[k, 1] + drag[k, 3] * per) * d
    if bearings.damping.shape[0] > 0:
        for k in range(c, rate.size):
            rate[k] += per * step[k, 0]
    for number in range(bearings.preload.size):
        first, end = bearings.first[number], bearings.first[number + 1]
        for i in range(first, end):
            for j in range(first, end):
                push[c + i] += scratch.tangents[number, i - first, j - first] * step[c + j, 0]


@inner(forceinline=True)
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
    It begins with the forces of the last steps, extrapolated. A step after which the error cannot exceed the tolerance,
    even if a slope changed by the largest one so far, is the last: forces follow their tangents, and the laws need no
    evaluation anew. The function is inlined, as passing its arguments would cost time at every call.
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
    damped = bearings.damping.shape[0] > 0
    with_rates = u if damped else c
    # Forces on a parabola through the last ones are so near that mostly one evaluation is enough.
    for j in range(directions):
        last, change = push[j], push[j] - scratch.push_before[j]
        push[j] += 2.0 * change - scratch.push_change[j]
        scratch.push_before[j], scratch.push_change[j] = last, change
    of_deflections, yielded = flexibility[:u], scratch.yielded
    most = largest_row_sum(of_deflections)
    project(of_deflections, push, yielded)
    for k in range(u):
        delta[k] = free[k] - by_displacement * yielded[k]
    for _ in range(_NEWTON_STEPS):
        for k in range(with_rates):
            rate[k] = free_rate[k] + per * (delta[k] - free[k])
        evaluate_forces(contacts, bearings, nominal_time, scratch)
        if damped:
            _add_damping_tangents(bearings, per, tangents)
        largest, scale = 0.0, 1e-300
        project(of_deflections, push, yielded)
        for k in range(u):
            residual[k, 0] = free[k] - delta[k] - by_displacement * yielded[k]
            scale = max(scale, abs(free[k]) + abs(delta[k]))
            largest = max(largest, abs(residual[k, 0]))
        if largest <= _CONVERGED * scale:
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
            among = slice(c + bearings.first[number], c + bearings.first[number + 1])
            flexible, columns, tangent = of_deflections[:, among], jacobian[:, among], tangents[number]
            for k in range(u):
                for j in range(columns.shape[1]):
                    value = 0.0
                    for i in range(columns.shape[1]):
                        value += flexible[k, i] * tangent[i, j]
                    columns[k, j] = by_displacement * value
        for k in range(u):
            jacobian[k, k] += 1.0
        solve_in_place(jacobian, residual)
        farthest = 0.0
        for k in range(u):
            delta[k] += residual[k, 0]
            farthest = max(farthest, abs(residual[k, 0]))
        if by_displacement * _stiffest(contacts, bearings, per, scratch) * farthest * most <= _CONVERGED * scale:
            _follow_tangents(contacts, bearings, per, scratch)
            return True
    return False
