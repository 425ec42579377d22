"""Linearised tooth contacts: mesh stiffness and damping about the mean load, or at an instant."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from coupling.mean_mesh import mean_meshes
from coupling.statics import static_equilibrium
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ContactState:
    """Mesh stiffness and damping of each contact in linear analyses.

    Attributes
    ----------
    stiffness : ndarray, shape (c,)
        Of each contact of the system, drive flanks and back flanks [N/m]; 0 without contact.
    damping : ndarray, shape (c,)
        [N s/m].
    force : ndarray, shape (c,), or None
        Mean force about which the contact is linearised [N]; 0 for the stiffness without load.
    """

    stiffness: FloatArray
    damping: FloatArray
    force: FloatArray | None = None


def mean_contact(system: CoupledSystem) -> ContactState:
    """Contacts linearised about the mean load: each loaded flank at its mean mesh stiffness under its mean force.

    The mean mesh stiffness under load is the mean over a mesh period of the tangent dF/dδ at static equilibrium under
    the contact's mean force: load sharing, reliefs, deviations, corner contact and uneven faces count. A flank
    without a mean force has its mean stiffness without load, see :func:`unloaded_contact`.
    """
    state = unloaded_contact(system)
    means = mean_meshes(system)
    stiffness = [k if mean is None else mean.stiffness for k, mean in zip(state.stiffness, means, strict=True)]
    force = [0.0 if mean is None else mean.force for mean in means]
    return replace(state, stiffness=np.array(stiffness, dtype=np.float64), force=np.array(force, dtype=np.float64))


def unloaded_contact(system: CoupledSystem) -> ContactState:
    """Drive flanks at their mean stiffness with all pairs on the path of contact touching, the back flanks apart."""
    return ContactState(system.drive_stiffness, system.drive_damping)


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
        As :func:`coupling.static_equilibrium`.
    """
    from coupling.gears.kernels import tooth_force

    q = static_equilibrium(system, time)
    tangents = []
    for contact in system.contacts:
        compression = float(contact.direction @ q) - contact.runout(time) - contact.clearance
        law = contact.contact.kernel_arguments
        force, *tangent = tooth_force(contact.phase_after(time), compression, 0.0, *law)[:3]
        # Of a contact that is held apart the law gives the coefficient of its losses, which act on no force.
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
    if chosen.rate == 0.0:
        raise CouplingError(f"{chosen.name} does not turn, so it has no phase but its own; expected a speed")
    return float(((np.sign(chosen.rate) * (phase - chosen.phase)) % 1.0) / abs(chosen.rate))


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
    return stiffness, system.damping + (directions * contact.damping) @ directions.T
