"""Newmark step matrices, compiled: inverse of a diagonal with gyroscopic blocks, corrected for the connectors.

Importing this module imports numba.

With the mass the identity, one step of Newmark's method solves S a = r with

    S = I + γ h (C + s' G) + β h² (K + P) = S₀ + U E Uᵀ,        E = γ h C_t + β h² K_t,

    P = s'' A + s' N + s'² Z,

G the gyroscopic and Coriolis terms, A those of the angular acceleration, which are G where no frame turns, N and Z the
circulatory and centripetal terms of frames that turn (:class:`gearwhine.coupling.machine.components.FrameTerms`).
S₀ is diagonal but for one block for each shaft that turns, U the few directions of bearings, mounts and the like. With
B = S₀⁻¹, by Sherman, Morrison and Woodbury,

    S⁻¹ = B - B U (I + E Uᵀ B U)⁻¹ E Uᵀ B.
"""

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.connector_forces.dense_kernels import add_rows, project, project_spans, solve_in_place
from gearwhine.coupling.connector_forces.kernel_arrays import Contacts, Dynamics, StepMatrices
from gearwhine.numerics.compiled import counted, inner

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@inner()
def connector_laws(dynamics: Dynamics, speed: float, stiffness: FloatArray, damping: FloatArray) -> None:
    """Interpolate K_t and C_t linearly at a speed, into two arrays (r, r)."""
    ratios, last = dynamics.connector_speed_ratios, dynamics.connector_speed_ratios.size - 1
    at = 0
    while at < last - 1 and speed > ratios[at + 1]:
        at += 1
    part = 0.0
    if last > 0:
        part = min(max((speed - ratios[at]) / (ratios[at + 1] - ratios[at]), 0.0), 1.0)
    after = min(at + 1, last)
    for i in range(stiffness.shape[0]):
        for j in range(stiffness.shape[0]):
            low, high = dynamics.connector_stiffness[at, i, j], dynamics.connector_stiffness[after, i, j]
            stiffness[i, j] = low + part * (high - low)
            low, high = dynamics.connector_damping[at, i, j], dynamics.connector_damping[after, i, j]
            damping[i, j] = low + part * (high - low)


@inner()
def add_gyroscopic(
    blocks: FloatArray, first: IntArray, size: IntArray, factor: float, x: FloatArray, out: FloatArray, work: FloatArray
) -> None:
    """Add ``factor`` G x, block by block; ``work`` (b,) is overwritten."""
    for g in range(first.size):
        among = slice(first[g], first[g] + size[g])
        apply_block(blocks[g], x[among], factor, work)
        part = out[among]
        for i in range(part.size):
            part[i] += work[i]


@inner(forceinline=True)
def apply_block(block: FloatArray, x: FloatArray, factor: float, out: FloatArray) -> None:
    """Compute ``factor`` B x from the rows of Bᵀ, which have the padded width: loops of sixteen vectorise."""
    for i in range(out.size):
        out[i] = 0.0
    add_rows(block, x, factor, out)


@inner(forceinline=True)
def apply_base(
    base: FloatArray,
    blocks: FloatArray,
    first: IntArray,
    size: IntArray,
    x: FloatArray,
    out: FloatArray,
    work: FloatArray,
) -> None:
    """Multiply B x into another array, with the base and the blocks of a step size; ``work`` (b,) is overwritten."""
    for i in range(x.size):
        out[i] = base[i] * x[i]
    for g in range(first.size):
        among = slice(first[g], first[g] + size[g])
        apply_block(blocks[g], x[among], 1.0, work)
        part = out[among]
        for i in range(part.size):
            part[i] = work[i]


@counted()
def build_steps(
    dynamics: Dynamics,
    contacts: Contacts,
    sizes: FloatArray,
    speeds: FloatArray,
    accelerations: FloatArray,
    slots: IntArray,
    matrices: StepMatrices,
) -> None:
    """Fill slots with the matrices of step sizes h at speeds s' and angular accelerations s''."""
    r, n = dynamics.connectors.shape
    c = contacts.direction.shape[0]
    along, seen, correction = np.zeros(r), np.zeros(c), np.zeros(r)
    column, solved, work = np.zeros(n), np.zeros(n), np.zeros(dynamics.gyroscopic.shape[2])
    first_of, size_of = dynamics.block_start, dynamics.block_size
    for number in range(slots.size):
        h, speed, acceleration, slot = sizes[number], speeds[number], accelerations[number], slots[number]
        by_velocity, by_displacement = dynamics.gamma * h, dynamics.beta * h * h
        matrices.size[slot] = h
        for i in range(n):
            diagonal = 1.0 + by_velocity * dynamics.damping[i] + by_displacement * dynamics.stiffness[i]
            matrices.base[slot, i] = 1.0 / diagonal
        rate = by_velocity * speed
        for g in range(first_of.size):
            first, size = first_of[g], size_of[g]
            # The block is transposed, as its inverse is the transposed inverse.
            block, inverse = np.zeros((size, size)), np.eye(size)
            for i in range(size):
                for j in range(size):
                    position = acceleration * dynamics.angular[g, i, j]
                    if dynamics.has_frames:
                        position += speed * dynamics.circulatory[g, i, j]
                        position += speed * speed * dynamics.centripetal[g, i, j]
                    matrices.position[slot, g, i, j] = position
                    block[i, j] = rate * dynamics.gyroscopic[g, i, j] + by_displacement * position
                block[i, i] += 1.0 / matrices.base[slot, first + i]
            solve_in_place(block, inverse)
            for i in range(size):
                for j in range(size):
                    matrices.blocks[slot, g, i, j] = inverse[i, j]

        stiffness, damping = matrices.connector_stiffness[slot], matrices.connector_damping[slot]
        connector_laws(dynamics, speed, stiffness, damping)
        for k in range(r):
            for i in range(n):
                column[i] = dynamics.connectors[k, i]
            apply_base(matrices.base[slot], matrices.blocks[slot], first_of, size_of, column, solved, work)
            for i in range(n):
                matrices.connectors[slot, k, i] = solved[i]
            project(dynamics.connectors, solved, along)
            for j in range(r):
                matrices.connector_flexibility[slot, j, k] = along[j]
        across, link = np.eye(r), np.zeros((r, r))
        for i in range(r):
            for j in range(r):
                e = by_velocity * damping[i, j] + by_displacement * stiffness[i, j]
                link[i, j] = e
                for k in range(r):
                    across[i, k] += e * matrices.connector_flexibility[slot, j, k]
        solve_in_place(across, link)
        for i in range(r):
            for j in range(r):
                matrices.woodbury[slot, i, j] = link[i, j]

        for k in range(c):
            for i in range(n):
                column[i] = contacts.direction[k, i]
            apply_base(matrices.base[slot], matrices.blocks[slot], first_of, size_of, column, solved, work)
            project(dynamics.connectors, solved, along)
            for j in range(r):
                correction[j] = 0.0
                for i in range(r):
                    correction[j] += link[j, i] * along[i]
            for j in range(r):
                for i in range(n):
                    solved[i] -= matrices.connectors[slot, j, i] * correction[j]
                for i in range(r):
                    along[i] -= matrices.connector_flexibility[slot, i, j] * correction[j]
            for i in range(n):
                matrices.contact[slot, k, i] = solved[i]
            for j in range(r):
                matrices.contact_connectors[slot, k, j] = along[j]
            project_spans(contacts.direction, contacts.spans, solved, seen)
            for j in range(c):
                matrices.flexibility[slot, j, k] = seen[j]
