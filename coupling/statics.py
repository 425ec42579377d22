"""Static equilibrium of the coupled system under its mean loads."""

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError, TransientError
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]

_RIGID = 1e-9  # stiffness below this part of the largest is a motion that nothing resists
_STEPS = 60


def static_equilibrium(system: CoupledSystem, time: float = 0.0) -> FloatArray:
    """Coordinates at rest under the constant load, the teeth standing where they are at a time.

    Newton's method on K q + Σ d f(dᵀ q) = F. Motions that no spring resists, such as gears that roll together,
    must carry no load; they stay at zero.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    CouplingError
        Where the load drives a motion that nothing resists: the torques do not balance.
    TransientError
        Where the teeth find no equilibrium.
    """
    from coupling.gears.kernels import tooth_force

    symmetric = 0.5 * (system.mean_stiffness() + system.mean_stiffness().T)
    values, vectors = np.linalg.eigh(symmetric)
    rigid = vectors[:, np.abs(values) < _RIGID * max(abs(values[-1]), 1e-300)]
    if rigid.size:
        driven = rigid.T @ system.load
        scale = np.abs(rigid.T) @ np.abs(system.load)
        if np.any(np.abs(driven) > 1e-6 * scale):
            raise CouplingError(
                "the loads do not balance: they would accelerate a motion that nothing resists, such as the train's "
                "rotation; check the torques in and out against the gear ratios"
            )
    penalty = float(values[-1]) * rigid @ rigid.T
    q: FloatArray = np.linalg.solve(system.mean_stiffness() + penalty, system.load)
    for _ in range(_STEPS):
        residual = system.load - system.stiffness @ q - penalty @ q
        tangent = system.stiffness + penalty
        for contact in system.contacts:
            error = float(np.sum(contact.errors[:, 0] * np.cos(contact.errors[:, 1] * time + contact.errors[:, 2])))
            compression = float(contact.direction @ q) - error - contact.clearance
            phase = contact.phase + contact.rate * time + 1e-9
            force, slope = tooth_force(phase, compression, 0.0, *contact.contact.kernel_arguments)[:2]
            residual = residual - force * contact.direction
            tangent = tangent + slope * np.outer(contact.direction, contact.direction)
        step = np.linalg.lstsq(tangent, residual, rcond=1e-13)[0]
        q = q + step
        if np.abs(step).max() <= 1e-12 * max(np.abs(q).max(), 1e-300):
            return q
    raise TransientError(
        f"no static equilibrium of the teeth after {_STEPS} Newton steps; the torque may be too small to close the mesh"
    )
