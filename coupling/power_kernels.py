"""Energy balance of a time step, compiled: powers of loads, losses and rotation, and stored energy.

Importing this module imports numba.
"""

import numpy as np
import numpy.typing as npt

from coupling.contact_kernels import DAMPING, ENERGY, FORCE, PHASE_SLOPE
from coupling.kernel_arrays import Contacts, Dynamics, Scratch
from coupling.row_kernels import SUMS
from rotors.compiled import inner

FloatArray = npt.NDArray[np.float64]


@inner(fastmath=SUMS, forceinline=True)
def stored_in(dynamics: Dynamics, stiffness: FloatArray, scratch: Scratch) -> float:
    """Energy in the teeth, in the nonlinear part of bearings, and in connectors that change with the speed [J].

    ``stiffness`` (r, r) is K_t.
    """
    energy, tq = scratch.held[0, 0], scratch.tq
    if dynamics.connector_rates.size > 1:
        for i in range(tq.size):
            for j in range(tq.size):
                energy += 0.5 * tq[i] * stiffness[i, j] * tq[j]
    for k in range(scratch.laws.shape[0]):
        energy += scratch.laws[k, ENERGY]
    return float(energy)


@inner(fastmath=SUMS, forceinline=True)
def evaluate_powers(
    dynamics: Dynamics,
    contacts: Contacts,
    stiffness: FloatArray,
    damping: FloatArray,
    speed: float,
    v: FloatArray,
    scratch: Scratch,
) -> None:
    """Powers of the loads, of the losses, of the rotation, and of friction from the nominal rotation [W].

    The last entry is twice the kinetic energy [J]. With the teeth's energy U(p, δ), δ = dᵀq - e: the rotating teeth
    give ∂U/∂p p' - f e', and the damping takes v C v + c δ'². Together with the loads they change the energy of motion,
    springs and teeth. ``stiffness`` and ``damping`` (r, r) are K_t and C_t.
    """
    tq, tv, laws = scratch.tq, scratch.tv, scratch.laws
    given, lost, square = 0.0, 0.0, 0.0
    for i in range(v.size):
        given += scratch.load[i] * v[i]
        lost += dynamics.damping[i] * v[i] * v[i]
        square += v[i] * v[i]
    for i in range(tv.size):
        for j in range(tv.size):
            lost += tv[i] * damping[i, j] * tv[j]
    if dynamics.has_skew:
        for i in range(tv.size):
            for j in range(tv.size):
                lost += 0.5 * tv[i] * (stiffness[i, j] - stiffness[j, i]) * tq[j]
    turning = scratch.held[0, 1] * speed
    for k in range(laws.shape[0]):
        turning += laws[k, PHASE_SLOPE] * contacts.rate[k] * speed - laws[k, FORCE] * scratch.slip[k]
        lost += laws[k, DAMPING] * scratch.rate[k] * scratch.rate[k]
    powers = scratch.powers
    powers[0], powers[1], powers[2], powers[3], powers[4] = given, lost, turning, 0.0, square
    if scratch.push.size > scratch.delta.size:
        _add_friction(contacts, speed, scratch)


@inner()
def _add_friction(contacts: Contacts, speed: float, scratch: Scratch) -> None:
    """Add the powers of friction: from the nominal rotation, and to the coordinates [W].

    The flanks slide by W s' in the nominal rotation and by w' beside it, and f (W s' + w') turns to heat. The former,
    Σ μ F_j |w_j| and never negative, comes from the drive of the machine. The latter is small, and excites the
    coordinates as often as it brakes them.
    """
    push, dv, powers = scratch.push, scratch.dv, scratch.powers
    for k in range(contacts.friction_row.size):
        row = contacts.friction_row[k]
        if row >= 0:
            powers[2] -= push[row] * dv[row] + push[row + 1] * dv[row + 1]
            powers[3] += (push[row] * contacts.sliding[k, 0] + push[row + 1] * contacts.sliding[k, 1]) * speed
