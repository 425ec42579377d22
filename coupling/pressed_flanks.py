"""Loaded flanks: drive flanks, or back flanks of a machine that coasts, by the mean mesh force."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from coupling.connector import ContactConnector
from coupling.statics import load_balances
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]

_NO_FORCE = 1e-9  # part of the contact force by each coordinate below which a force is rounding


def mean_mesh_forces(system: CoupledSystem) -> FloatArray:
    """Mean mesh force of each drive flank, at its mean stiffness, under the constant load [N], shape (c,).

    Negative where the load pulls the flanks apart. In a train of gears one after the other it follows from the torques
    alone. All 0 where the load cannot be balanced.
    """
    forces = np.zeros(len(system.contacts))
    if not system.contacts or not np.any(system.load) or not load_balances(system):
        return forces
    rigid, stiffest = system.rigid_body_motions
    q = np.linalg.solve(system.mean_stiffness + stiffest * rigid @ rigid.T, system.load)
    stiffness = system.drive_stiffness
    forces = stiffness * (system.contact_directions.T @ q)
    rounding = _NO_FORCE * stiffness * (np.abs(system.contact_directions.T) @ np.abs(q))
    return np.where(np.abs(forces) > rounding, forces, 0.0)


def with_loaded_flanks(system: CoupledSystem, backs: Sequence[int | None]) -> CoupledSystem:
    """The system with back flanks as its drive flanks where the mean torque pulls the drive flanks apart.

    ``backs`` has, for each of the first contacts, the number of its back flanks, or None where these never meet.
    """
    forces = mean_mesh_forces(system)
    contacts: list[ContactConnector] = list(system.contacts)
    for number, back in enumerate(backs):
        if back is not None and forces[number] < 0.0:
            contacts[number] = replace(contacts[number], drives=False)
            contacts[back] = replace(contacts[back], drives=True)
    return replace(system, contacts=tuple(contacts))
