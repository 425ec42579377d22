"""Which side of the teeth the mean load presses: the drive flanks, or the back flanks of a machine that coasts."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from coupling.connector import ContactConnector
from coupling.statics import load_balances
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]

_NO_FORCE = 1e-9  # part of what the coordinates press below which a force is none


def mean_mesh_forces(system: CoupledSystem) -> FloatArray:
    """Force of each contact that is taken for pressed, by its mean stiffness, under the constant load [N], shape (c,).

    Negative where the load pulls its flanks apart. In a train of gears one after the other the torques alone give it.
    All 0 where the load cannot be balanced.
    """
    forces = np.zeros(len(system.contacts))
    if not system.contacts or not np.any(system.load) or not load_balances(system):
        return forces
    rigid, stiffest = system.unresisted_motions
    q = np.linalg.solve(system.mean_stiffness + stiffest * rigid @ rigid.T, system.load)
    stiffness = np.array([contact.drives * contact.contact.mean_stiffness for contact in system.contacts])
    forces = stiffness * (system.contact_directions.T @ q)
    rounding = _NO_FORCE * stiffness * (np.abs(system.contact_directions.T) @ np.abs(q))
    return np.where(np.abs(forces) > rounding, forces, 0.0)


def with_pressed_flanks(system: CoupledSystem, backs: Sequence[int | None]) -> CoupledSystem:
    """The system with back flanks in place of the drive flanks that its mean torque pulls apart.

    ``backs`` has, for each of the first contacts, the number of its back flanks, or None where these never meet.
    """
    forces = mean_mesh_forces(system)
    contacts: list[ContactConnector] = list(system.contacts)
    for number, back in enumerate(backs):
        if back is not None and forces[number] < 0.0:
            contacts[number] = replace(contacts[number], drives=False)
            contacts[back] = replace(contacts[back], drives=True)
    return replace(system, contacts=tuple(contacts))
