"""Static equilibrium of the coupled system under its mean loads."""

import numpy as np
import numpy.typing as npt

from coupling.connector import ContactConnector
from coupling.errors import CouplingError, TransientError
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]

_RIGID = 1e-12  # stiffness below this part of the largest is a motion that nothing resists
_PUSHED = 1e-9  # part of a load below which its share in a motion is rounding
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

    rigid, stiffest = _unresisted(system)
    if rigid.size:
        driven = rigid.T @ system.load
        # Beside a load that balances in itself, and beside the rounding of what a motion is.
        scale = 1e-6 * np.abs(rigid.T) @ np.abs(system.load) + _RIGID * np.linalg.norm(system.load)
        if np.any(np.abs(driven) > scale):
            raise CouplingError(
                "the loads do not balance: they would accelerate a motion that nothing resists, such as the train's "
                "rotation or a housing without supports; check the torques in and out against the gear ratios, and the "
                "supports' stiffness"
            )
    penalty = stiffest * rigid @ rigid.T
    # Newton's method starts from teeth that touch: deviations and runout may hold them further apart than the load
    # presses, and from open teeth it would stop at a motion that nothing holds.
    closing = np.zeros(system.size)
    for contact in system.contacts:
        if contact.drives:
            first_touch = float(contact.contact.pairs(_phase(contact, time)).deviation.min())
            closing += contact.contact.mean_stiffness * (first_touch + _error(contact, time)) * contact.direction
    q: FloatArray = np.asarray(
        np.linalg.solve(system.mean_stiffness() + penalty, system.load + closing), dtype=np.float64
    )
    pressing = float(np.linalg.norm(system.load) + np.linalg.norm(closing)) or 1e-300
    for _ in range(_STEPS):
        residual = system.load - system.stiffness @ q - penalty @ q
        tangent = system.stiffness + penalty
        for contact in system.contacts:
            compression = float(contact.direction @ q) - _error(contact, time) - contact.clearance
            law = contact.contact.kernel_arguments
            force, slope = tooth_force(_phase(contact, time), compression, 0.0, *law)[:2]
            residual = residual - force * contact.direction
            tangent = tangent + slope * np.outer(contact.direction, contact.direction)
        if np.linalg.norm(residual) <= 1e-10 * pressing:
            return q
        q = q + np.linalg.lstsq(tangent, residual, rcond=1e-15)[0]
    raise TransientError(
        f"no static equilibrium of the teeth after {_STEPS} Newton steps; the torque may be too small to close the mesh"
    )


def coasting_velocity(system: CoupledSystem, rate: float) -> FloatArray:
    """Rates at t = 0 with which motions that nothing resists swing under harmonic loads and stay where they are, (n,).

    Such a motion answers Re(F e^{iwt}) by the velocity Re(F e^{iwt} / (iw)). From rest it would drift away beside it,
    as a train does that a ripple of its torque has pushed once. ``rate`` is the speed as a part of the nominal one.
    """
    velocity = np.zeros(system.size)
    rigid = None
    for load in system.harmonic_loads:
        frequency = load.frequency if load.follows == "time" else load.frequency * rate
        if frequency == 0.0:
            continue
        rigid = _unresisted(system)[0] if rigid is None else rigid
        pushed = rigid.T @ load.amplitude
        if np.abs(pushed).max(initial=0.0) > _PUSHED * np.linalg.norm(load.amplitude):
            velocity += rigid @ (pushed / (1j * frequency)).real
    return velocity


def _unresisted(system: CoupledSystem) -> tuple[FloatArray, float]:
    """Orthonormal motions that no spring resists, in columns, and the largest stiffness [1/s²]."""
    values, vectors = np.linalg.eigh(0.5 * (system.mean_stiffness() + system.mean_stiffness().T))
    return vectors[:, np.abs(values) < _RIGID * max(abs(values[-1]), 1e-300)], float(values[-1])


def _phase(contact: ContactConnector, time: float) -> float:
    """Phase of a contact just after a time [mesh periods]."""
    return contact.phase + contact.rate * time + 1e-9


def _error(contact: ContactConnector, time: float) -> float:
    """Runout error of a contact [m]."""
    return float(np.sum(contact.errors[:, 0] * np.cos(contact.errors[:, 1] * time + contact.errors[:, 2])))
