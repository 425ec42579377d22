"""Mean mesh stiffness of each contact under its mean mesh force.

Over a mesh period the number of loaded teeth changes, while the mean force of a contact stays that of the torques. So a
contact under its mean force F is replaced by its mean curve δ̄(F), the loaded transmission error's mean over the
period, and the machine rests where K q + Σ d F = f with dᵀ q = δ̄(F). In a train of gears one after the other the
torques alone give F; where meshes share a torque, their stiffness and deviations divide it. On carriers that turn the
sharing changes over a turn, by weight, other meshes and a housing that is not alike all round: F is the mean over it,
with none at the angles where the contact is parted.

Linear analyses take the tooth contacts as mesh stiffness and damping about the mean load, or at an instant
(`ContactState`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import GearError, ToothContact, loaded_transmission_error
from gearwhine.coupling.gears.loaded.transmission_error import hunting_period_mesh, mesh_period_phases, period_mean
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.statics.static_equilibrium import drives, load_balances, static_equilibrium, tangent_offset
from gearwhine.numerics.arrays import FloatArray

_POINTS = 200  # number of phases of a mesh period, in addition to its events
_CONVERGED_FORCE_CHANGE = 1e-7  # change of the force in a step of the iteration, relative to the largest force
_FORCE_ROUNDING = 1e-9  # part of the contact force by each coordinate below which a force is rounding
_ZERO_STIFFNESS_SHARE = 1e-12  # part of the largest stiffness below which a stiffness is zero
_PULL = 1e-5  # part of the largest force that flanks may pull and yet be closed: a loose planet may touch without force
_LOOSE_LOAD = 1e-6  # part of the loads by which unequal planets, or rounding, may push those that are loose
_ITERATIONS = 30


@dataclass(frozen=True)
class MeanMesh:
    """Mean of a contact over a mesh period under its mean force.

    Attributes
    ----------
    force : float
        Mean mesh force F > 0 [N].
    stiffness : float
        Mean of the tangent dF/dδ over the period [N/m].
    deflection : float
        Mean loaded transmission error δ̄ [m].
    secant : float
        Derivative dF/dδ̄ [N/m]: the harmonic mean of the tangent.
    """

    force: float
    stiffness: float
    deflection: float
    secant: float


_PARTED_MESH = MeanMesh(0.0, 0.0, 0.0, 0.0)


def mean_mesh(contact: ToothContact, force: float) -> MeanMesh:
    """Means of a contact in static equilibrium under a force over its mesh period, or its hunting period.

    Parameters
    ----------
    contact : ToothContact
    force : float
        Force along the line of action, above 0 [N].

    Raises
    ------
    GearError
        Where no teeth meet at some phase.
    """
    if contact.hunting_period > 1:
        mesh = hunting_period_mesh(contact, force)
    else:
        mesh = loaded_transmission_error(contact, force, mesh_period_phases(contact, _POINTS))
    softness = period_mean(mesh.phases, 1.0 / mesh.tangent_stiffness)
    return MeanMesh(force, mesh.mean_mesh_stiffness, mesh.mean_transmission_error, 1.0 / softness)


def mean_meshes(system: CoupledSystem) -> list[MeanMesh | None]:
    """Mean mesh of each contact under the constant load; None without a mean force or where the load cannot balance.

    See `mean_equilibrium`.
    """
    return mean_equilibrium(system)[0]


def mean_equilibrium(system: CoupledSystem) -> tuple[list[MeanMesh | None], FloatArray]:
    """Mean mesh of each contact, as of `mean_meshes`, and the mean motion under the constant load, shape (n,).

    See `equilibrium_over_turn`.
    """
    means, motions = equilibrium_over_turn(system)
    return means, motions.mean(axis=0)


def equilibrium_over_turn(system: CoupledSystem) -> tuple[list[MeanMesh | None], FloatArray]:
    """Mean mesh of each contact, and the motion at each of `CoupledSystem.turn_times` under the constant load, (t, n).

    Newton's method is applied to the contacts' mean curves, starting with their stiffness without load. A contact that
    the mean load opens while others carry the load has no force and no stiffness. Nonlinear bearings act as their
    tangents about their mean loads. The motion is zero where the load cannot balance.

    Where directions turn, the machine rests at several angles of its carriers, with all that stands still, such as
    weight, in its place. A contact has its tangent under its mean force over the turn at each of them, and no force at
    those where it would pull.
    """
    without_force: list[MeanMesh | None] = [None] * len(system.contacts)
    driving = [number for number, contact in enumerate(system.contacts) if contact.loaded]
    stands = system.over_turn
    at_rest = np.zeros((len(stands), system.size))
    if not driving or not any(np.any(one.load) for one in stands) or not load_balances(system):
        return without_force, at_rest
    stiffest = system.rigid_body_motions[1]
    rigid = np.array([stiffest * free @ free.T for free in system.free_over_turn])
    stiffness_held = np.array([one.stiffness for one in stands]) + rigid
    directions = np.array([one.contact_directions[:, driving] for one in stands])
    load = np.array([one.load + tangent_offset(one) for one in stands])
    laws = [system.contacts[number].contact for number in driving]
    clearance = np.array([system.contacts[number].clearance for number in driving])
    stiffness = np.array([law.unloaded_mean_mesh_stiffness for law in laws])
    offset = clearance.copy()
    before = np.full(len(driving), np.nan)
    loaded = np.ones((len(stands), len(driving)), dtype=bool)
    meshes: list[MeanMesh | None] = [None] * len(driving)
    for _ in range(_ITERATIONS):
        closed = directions * loaded[:, None, :]
        matrix = stiffness_held + (closed * stiffness) @ directions.mT
        pressed = load + closed @ (stiffness * offset)
        if not np.all(loaded):
            loose = [_loose_motions(one, stiffest) for one in matrix]
            if drives(pressed, loose, _LOOSE_LOAD):
                # The mean load opens flanks, and nothing else holds the train.
                return without_force, at_rest
            matrix += stiffest * np.array([free @ free.T for free in loose])
        q = np.linalg.solve(matrix, pressed[..., None])[..., 0]
        compression = np.einsum("tnc,tn->tc", directions, q)
        pull = stiffness * (compression - offset)
        rounding = _FORCE_ROUNDING * stiffness * np.einsum("tnc,tn->tc", np.abs(directions), np.abs(q))
        slack = _PULL * loaded * np.abs(pull * loaded).max()
        parted = pull < -np.maximum(rounding, slack)
        force, rounding = np.where(parted, 0.0, pull).mean(axis=0), rounding.mean(axis=0)
        converged = np.abs(force - before) <= _CONVERGED_FORCE_CHANGE * np.abs(force).max() + rounding
        if np.all(converged) and np.array_equal(parted, ~loaded):
            break
        before, loaded = force, ~parted
        for number, law in enumerate(laws):
            if force[number] <= rounding[number]:
                meshes[number] = _PARTED_MESH if parted[:, number].all() else None
                continue
            try:
                mean = mean_mesh(law, float(force[number]))
            except GearError:
                meshes[number] = None
                continue
            meshes[number] = mean
            stiffness[number] = mean.secant
            offset[number] = clearance[number] + mean.deflection - mean.force / mean.secant
    for number, mesh in zip(driving, meshes, strict=True):
        without_force[number] = mesh
    return without_force, np.asarray(q)


def _loose_motions(stiffness: FloatArray, stiffest: float) -> FloatArray:
    """Orthonormal motions that a stiffness does not resist, as columns: a planet that has lost contact may turn."""
    values, vectors = np.linalg.eigh(0.5 * (stiffness + stiffness.T))
    return np.asarray(vectors[:, np.abs(values) < _ZERO_STIFFNESS_SHARE * stiffest])


@dataclass(frozen=True)
class ContactState:
    """Mesh stiffness and damping of each contact in linear analyses.

    Attributes
    ----------
    stiffness : ndarray, shape (c,)
        Stiffness of each contact of the system, drive flanks and back flanks [N/m]; 0 without contact.
    damping : ndarray, shape (c,)
        Damping of each contact [N s/m].
    force : ndarray, shape (c,), or None
        Mean force about which the contact is linearised [N]; 0 for the stiffness without load.
    """

    stiffness: FloatArray
    damping: FloatArray
    force: FloatArray | None = None


def mean_contact(system: CoupledSystem, means: Sequence[MeanMesh | None] | None = None) -> ContactState:
    """Contacts linearised about the mean load: each loaded flank at its mean mesh stiffness under its mean force.

    The mean mesh stiffness under load is the mean over a mesh period of the tangent dF/dδ at static equilibrium under
    the contact's mean force: load sharing, reliefs, deviations, corner contact and uneven faces count. A flank
    without a mean force has its mean stiffness without load, see :func:`unloaded_contact`. ``means`` are those of
    `mean_meshes`, where they are known.
    """
    state = unloaded_contact(system)
    means = mean_meshes(system) if means is None else means
    stiffness = [k if mean is None else mean.stiffness for k, mean in zip(state.stiffness, means, strict=True)]
    force = [0.0 if mean is None else mean.force for mean in means]
    return replace(state, stiffness=np.array(stiffness, dtype=np.float64), force=np.array(force, dtype=np.float64))


def unloaded_contact(system: CoupledSystem) -> ContactState:
    """Drive flanks at their mean stiffness with all pairs on the path of contact touching, the back flanks apart."""
    return ContactState(system.loaded_flank_stiffness, system.loaded_flank_damping)


def contact_at(system: CoupledSystem, time: float) -> ContactState:
    """Tangents of the contact law in static equilibrium under the constant load, at the mesh phases of a time.

    Reliefs, deviations and backlash count: a pair that the load does not close has no stiffness.

    Parameters
    ----------
    system : CoupledSystem
    time : float
        [s]; :func:`time_of_phase` gives that of a mesh phase.

    Raises
    ------
    CouplingError, TransientError
        As :func:`gearwhine.coupling.static_equilibrium`.
    """
    from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force

    q = static_equilibrium(system, time)
    tangents = []
    for contact in system.standing(time).contacts:
        compression = float(contact.direction @ q) - contact.runout(time) - contact.clearance
        law = contact.contact.kernel_arguments
        force, *tangent = tooth_force(contact.phase_after(time), compression, 0.0, *law)[:3]
        # For open flanks the law returns the coefficient of losses, which is no damping force.
        tangents.append(tangent if force > 0.0 else [0.0, 0.0])
    stiffness, damping = np.array(tangents).reshape(-1, 2).T
    return ContactState(stiffness, damping)


def time_of_phase(system: CoupledSystem, phase: float, contact: int = 0) -> float:
    """First time at or after 0 at which a contact stands at a phase of its mesh period [s].

    Raises
    ------
    CouplingError
        Where the system has no such contact, or it does not turn.
    """
    if not 0 <= contact < len(system.contacts):
        raise CouplingError(
            f"contact number {contact} of {len(system.contacts)}; expected 0 or more, below their count"
        )
    chosen = system.contacts[contact]
    if chosen.mesh_frequency == 0.0:
        raise CouplingError(f"{chosen.name} does not turn, so it has no phase but its own; expected a speed")
    return float(((np.sign(chosen.mesh_frequency) * (phase - chosen.phase)) % 1.0) / abs(chosen.mesh_frequency))


def linear_matrices(system: CoupledSystem, contact: ContactState) -> tuple[FloatArray, FloatArray]:
    """K [1/s²] and C [1/s] with the contacts in a state, shape (n, n) both.

    Raises
    ------
    CouplingError
        Where the state has another number of contacts than the system.
    """
    count = len(system.contacts)
    if contact.stiffness.shape != (count,) or contact.damping.shape != (count,):
        raise CouplingError(
            f"a contact state of shapes {contact.stiffness.shape} and {contact.damping.shape}; expected ({count},) both"
        )
    directions = system.contact_directions
    stiffness = system.stiffness + (directions * contact.stiffness) @ directions.T
    damping = system.damping + (directions * contact.damping) @ directions.T
    for connector in system.linear:
        # Flanks that are apart resist no tilting either.
        if connector.of_contact is not None and contact.stiffness[connector.of_contact] == 0.0:
            stiffness = stiffness - connector.directions @ connector.stiffness @ connector.directions.T
            damping = damping - connector.directions @ connector.damping @ connector.directions.T
    return stiffness, damping
