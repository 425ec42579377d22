"""Mean mesh stiffness of each contact under its mean mesh force.

Over a mesh period the number of loaded teeth changes, while the mean force of a contact stays that of the torques. So a
contact under its mean force F is replaced by its mean curve δ̄(F), the loaded transmission error's mean over the period,
and the machine rests where K q + Σ d F = f with dᵀ q = δ̄(F). In a train of gears one after the other the torques alone
give F; where meshes share a torque, their stiffness and deviations divide it.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.gears import GearError, ToothContact, hunting_period_mesh, loaded_transmission_error, mesh_period_phases
from coupling.gears.static import period_mean
from coupling.statics import load_balances
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]

_POINTS = 200  # phases of a mesh period, beside its events
_SETTLED = 1e-7  # change of the force in a step of the iteration, relative to the largest force
_ROUNDING = 1e-9  # part of the contact force by each coordinate below which a force is rounding
_LOOSE = 1e-12  # part of the largest stiffness below which a stiffness is zero
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
        dF/dδ̄ [N/m]: the harmonic mean of the tangent.
    """

    force: float
    stiffness: float
    deflection: float
    secant: float


_PARTED = MeanMesh(0.0, 0.0, 0.0, 0.0)


def mean_mesh(contact: ToothContact, force: float) -> MeanMesh:
    """Means of a contact in static equilibrium under a force over its mesh period, or its hunting period.

    Parameters
    ----------
    contact : ToothContact
    force : float
        Along the line of action, above 0 [N].

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

    Newton's method on the contacts' mean curves, from their stiffness without load. A contact that the mean load opens
    while others carry it has no force and no stiffness.
    """
    nothing: list[MeanMesh | None] = [None] * len(system.contacts)
    driving = [number for number, contact in enumerate(system.contacts) if contact.drives]
    if not driving or not np.any(system.load) or not load_balances(system):
        return nothing
    rigid, stiffest = system.rigid_body_motions
    held = system.stiffness + stiffest * rigid @ rigid.T
    directions = system.contact_directions[:, driving]
    laws = [system.contacts[number].contact for number in driving]
    stiffness = np.array([law.mean_mesh_stiffness for law in laws])
    offset = np.array([system.contacts[number].clearance for number in driving])
    before = np.full(len(driving), np.nan)
    pressed = np.ones(len(driving), dtype=bool)
    found: list[MeanMesh | None] = [None] * len(driving)
    for _ in range(_ITERATIONS):
        matrix = held + (directions * (stiffness * pressed)) @ directions.T
        if not np.all(pressed) and np.linalg.svd(matrix, compute_uv=False)[-1] < _LOOSE * stiffest:
            # The mean load parts flanks and nothing else holds the train.
            return nothing
        q = np.linalg.solve(matrix, system.load + directions @ (stiffness * pressed * offset))
        force = stiffness * (directions.T @ q - offset)
        rounding = _ROUNDING * stiffness * (np.abs(directions.T) @ np.abs(q))
        settled = np.abs(force - before) <= _SETTLED * np.abs(force * pressed).max() + rounding
        parted = force < -rounding
        if np.all(settled | parted) and np.array_equal(parted, ~pressed):
            break
        before, pressed = force, ~parted
        for number, law in enumerate(laws):
            if force[number] <= rounding[number]:
                found[number] = _PARTED if parted[number] else None
                continue
            try:
                mean = mean_mesh(law, float(force[number]))
            except GearError:
                found[number] = None
                continue
            found[number] = mean
            stiffness[number] = mean.secant
            clearance = system.contacts[driving[number]].clearance
            offset[number] = clearance + mean.deflection - mean.force / mean.secant
    for number, one in zip(driving, found, strict=True):
        nothing[number] = one
    return nothing
