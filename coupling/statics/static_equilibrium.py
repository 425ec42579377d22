"""Static equilibrium of the coupled system under its mean loads, by Newton's method; loaded flanks.

Sought are coordinates q at which the residual F - K q - Σ d f(dᵀ q) is zero, with the tooth contacts at their mesh
phases and rolling bearings at their cage angles of one time.

The sign of the mean mesh force decides which flanks are loaded: the drive flanks, or the back flanks of a machine that
coasts.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from gearwhine.coupling.connector_forces.kernel_arrays import bearing_arrays
from gearwhine.coupling.errors import CouplingError, TransientError
from gearwhine.coupling.machine.connectors import ContactConnector, NonlinearConnector
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.numerics.arrays import FloatArray

_LOAD_ROUNDING = 1e-10  # part of the loads that is rounding of the rigid-body motions
_PUSHED = 1e-9  # part of a load below which its share in a rigid-body motion is rounding
_STEPS = 60
_HALVINGS = 12  # largest number of halvings of a Newton step that increases the residual


def static_equilibrium(system: CoupledSystem, time: float = 0.0) -> FloatArray:
    """Coordinates in static equilibrium under the constant load, at mesh phases, cage and carrier angles of a time.

    Newton's method solves K q + Σ d f(dᵀ q) = F, with the friction of the sliding teeth. Rigid-body motions, such as
    gears that roll together, must carry no load; they stay at zero.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    CouplingError
        Where the load drives a rigid-body motion: the torques do not balance.
    TransientError
        Where teeth or bearings find no equilibrium.
    """
    balances = load_balances(system)
    system = system.standing(time)
    rigid, stiffest = system.rigid_body_motions
    if not balances:
        raise CouplingError(
            "the loads do not balance: they would accelerate a motion that nothing resists, such as the train's "
            "rotation or a housing without supports; check the torques in and out against the gear ratios, and the "
            "supports' stiffness"
        )
    penalty = stiffest * rigid @ rigid.T
    # Newton's method starts from closed teeth: deviations and runout may exceed the deflection under the load, and from
    # open teeth the tangent would be singular.
    closing = np.zeros(system.size)
    for contact in system.contacts:
        if contact.loaded:
            first_touch = float(contact.contact.pairs(contact.phase_after(time)).deviation.min())
            gap = first_touch + contact.clearance + contact.runout(time)
            closing += contact.contact.unloaded_mean_mesh_stiffness * gap * contact.direction
    # Bearings begin at their mean load: within their clearance the tangent would be singular.
    closing += tangent_offset(system, time)
    q: FloatArray = np.asarray(
        np.linalg.solve(system.mean_stiffness + penalty, system.load + closing), dtype=np.float64
    )
    loading = float(np.linalg.norm(system.load) + np.linalg.norm(closing)) or 1e-300
    residual, tangent = _out_of_balance(system, penalty, q, time)
    for _ in range(_STEPS):
        if np.linalg.norm(residual) <= 1e-10 * loading:
            return q
        step = np.linalg.lstsq(tangent, residual, rcond=1e-15)[0]
        for halving in range(_HALVINGS if system.nonlinear else 1):
            trial, slope = _out_of_balance(system, penalty, q + 0.5**halving * step, time)
            if np.linalg.norm(trial) < np.linalg.norm(residual):
                break
        q, residual, tangent = q + 0.5**halving * step, trial, slope
    _require_closed_flanks(system, penalty)
    raise TransientError(
        f"no static equilibrium of teeth and bearings after {_STEPS} Newton steps; the torque may be too small to "
        "close the mesh, or the play of a bearing leave its shaft loose"
    )


def _require_closed_flanks(system: CoupledSystem, penalty: FloatArray) -> None:
    """Raise `CouplingError` where the mean torque opens flanks without back flanks."""
    q = np.linalg.solve(system.mean_stiffness + penalty, system.load)
    for contact in system.contacts:
        force = contact.contact.unloaded_mean_mesh_stiffness * float(contact.direction @ q)
        if contact.loaded and force < -_PUSHED * contact.contact.unloaded_mean_mesh_stiffness * float(
            np.abs(contact.direction) @ np.abs(q)
        ):
            raise CouplingError(
                f"the torque pulls the flanks of {contact.name} apart with {-force:.5g} N and nothing stops them: the "
                "driver is driven, and without backlash its back flanks never meet; give the pair a backlash, or turn "
                "the sign of the torque or of the speed"
            )


def tangent_offset(system: CoupledSystem, time: float = 0.0) -> FloatArray:
    """Constant load, shape (n,), with which nonlinear bearings act as their tangents about their mean loads."""
    offset = np.zeros(system.size)
    for bearing in system.nonlinear:
        reference = bearing.law.reference[bearing.axes]
        about, _ = _bearing(bearing, reference, time)
        offset += bearing.directions @ (bearing.stiffness @ reference - about)
    return offset


def load_balances(system: CoupledSystem) -> bool:
    """Whether the constant load does no work in any rigid-body motion, in the mean over a turn of the directions."""
    return not drives([one.load for one in system.over_turn], system.free_over_turn)


def drives(loads: Sequence[FloatArray], motions: Sequence[FloatArray], rounding: float = _LOAD_ROUNDING) -> bool:
    """Whether loads (n,) over a turn do work in the mean in motions, columns of (n, m) at each, above their rounding.

    A force that shifts a carrier gives the centrifugal forces of planets at unequal angles a moment that swings.
    """
    work = np.mean([free @ (free.T @ load) for load, free in zip(loads, motions, strict=True)], axis=0)
    # Relative to the load's entries, and beside the rounding of the motions themselves.
    size = np.mean(np.abs(loads), axis=0)
    return any(
        np.any(np.abs(free.T @ work) > 1e-6 * np.abs(free.T) @ size + rounding * np.linalg.norm(size))
        for free in motions
    )


def _out_of_balance(
    system: CoupledSystem, penalty: FloatArray, q: FloatArray, time: float
) -> tuple[FloatArray, FloatArray]:
    """Residual F - K q - Σ d f(dᵀ q), shape (n,), and tangent stiffness, shape (n, n)."""
    from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force

    residual = system.load - system.stiffness @ q - penalty @ q
    tangent = system.stiffness + penalty
    for contact in system.contacts:
        compression = float(contact.direction @ q) - contact.runout(time) - contact.clearance
        phase = contact.phase_after(time)
        force, slope = tooth_force(phase, compression, 0.0, *contact.contact.kernel_arguments)[:2]
        push, rise = force * contact.direction, slope * contact.direction
        if contact.sliding is not None:
            rubbing, rising = friction_push(contact, phase, compression, force, slope)
            push, rise = push + rubbing, rise + rising
        residual = residual - push
        tangent = tangent + np.outer(rise, contact.direction)
    for bearing in system.nonlinear:
        deflection = bearing.directions.T @ q
        force_on_shaft, stiffness = _bearing(bearing, deflection, time)
        residual = residual - bearing.directions @ (force_on_shaft - bearing.stiffness @ deflection)
        tangent = tangent + bearing.directions @ (stiffness - bearing.stiffness) @ bearing.directions.T
    return residual, tangent


def friction_push(
    contact: ContactConnector, phase: float, compression: float, force: float, slope: float
) -> tuple[FloatArray, FloatArray]:
    """Friction force of a contact on the coordinates, to be subtracted, and its slope by the compression, shapes (n,).

    ``force`` and ``slope`` are those of the contact.
    """
    from gearwhine.coupling.gears.contact.tooth_force_kernels import friction_shares

    assert contact.sliding is not None
    if force <= 0.0:
        return np.zeros_like(contact.direction), np.zeros_like(contact.direction)
    friction = contact.sliding.friction
    law, by_slices = contact.friction_law
    a, b, a_slope, b_slope = friction_shares(
        phase, compression, law, 0, by_slices, friction.pitch_point, friction.path_end
    )
    turned = friction.coefficient * float(np.sign(contact.sliding.nominal[1])) * contact.sliding.directions
    return turned @ [force * a, force * b], turned @ [slope * a + force * a_slope, slope * b + force * b_slope]


def _bearing(connector: NonlinearConnector, deflection: FloatArray, time: float) -> tuple[FloatArray, FloatArray]:
    """Force and tangent of a nonlinear bearing at its deflections, over its directions."""
    from gearwhine.coupling.connector_forces.bearing_kernels import bearing_force

    q, force, tangent = connector.law.reference.copy(), np.zeros(5), np.zeros((5, 5))
    q[connector.axes] = deflection
    bearing_force(bearing_arrays([connector]), 0, time, q, force, tangent)
    return force[connector.axes], tangent[np.ix_(connector.axes, connector.axes)]


def coasting_velocity(system: CoupledSystem, rate: float) -> FloatArray:
    """Return initial velocities, shape (n,): rigid-body motions then oscillate under harmonic loads without drift.

    The response of such a motion to Re(F e^{iwt}) has the velocity Re(F e^{iwt} / (iw)). From rest a drift would be
    added to it. ``rate`` is the speed as a part of the nominal one.
    """
    velocity = np.zeros(system.size)
    for load in system.harmonic_loads:
        frequency = load.frequency if load.follows == "time" else load.frequency * rate
        if frequency == 0.0:
            continue
        rigid = system.rigid_body_motions[0]
        pushed = rigid.T @ load.amplitude
        if np.abs(pushed).max(initial=0.0) > _PUSHED * np.linalg.norm(load.amplitude):
            velocity += rigid @ (pushed / (1j * frequency)).real
    return velocity


_NO_FORCE = 1e-9  # part of the contact force by each coordinate below which a force is rounding


def mean_mesh_forces(system: CoupledSystem) -> FloatArray:
    """Mean mesh force of each drive flank, at its mean stiffness, under the constant load [N], shape (c,).

    It is the mean over a turn of directions that turn. Negative where the load pulls the flanks apart. In a train of
    gears one after the other it follows from the torques alone. All 0 where the load cannot be balanced.
    """
    forces, rounding = np.zeros((2, len(system.contacts)))
    if not system.contacts or not any(np.any(one.load) for one in system.over_turn) or not load_balances(system):
        return forces
    stiffest, stiffness = system.rigid_body_motions[1], system.loaded_flank_stiffness
    for one, free in zip(system.over_turn, system.free_over_turn, strict=True):
        q = np.linalg.solve(one.mean_stiffness + stiffest * free @ free.T, one.load)
        forces += stiffness * (one.contact_directions.T @ q)
        rounding += _NO_FORCE * stiffness * (np.abs(one.contact_directions.T) @ np.abs(q))
    return np.where(np.abs(forces) > rounding, forces, 0.0) / len(system.over_turn)


def with_loaded_flanks(
    system: CoupledSystem, backs: Sequence[int | None], turning: Callable[[CoupledSystem], CoupledSystem]
) -> CoupledSystem:
    """Exchange drive and back flanks where the mean torque pulls the drive flanks apart.

    ``backs`` has, for each of the first contacts, the number of its back flanks, or None where these never meet;
    ``turning`` turns the directions of the system with its carriers.
    """
    meeting = [(number, back) for number, back in enumerate(backs) if back is not None]
    forces = mean_mesh_forces(turning(system)) if meeting else np.zeros(0)
    exchanged = [(number, back) for number, back in meeting if forces[number] < 0.0]
    if not exchanged:
        return system
    contacts: list[ContactConnector] = list(system.contacts)
    for number, back in exchanged:
        contacts[number] = replace(contacts[number], loaded=False)
        contacts[back] = replace(contacts[back], loaded=True)
    return replace(system, contacts=tuple(contacts))
