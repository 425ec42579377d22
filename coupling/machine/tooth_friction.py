r"""Tooth friction in the coupled system: sliding velocity of a pair of teeth, friction force, and friction torque.

With e the unit vector along which the driver pushes, s its sense of rotation and t = s z × e that in which its flank
moves across the line of action, the flanks of a pair at the position x along the path (in base pitches) slide by

    w = t (u_k - u_i)' + s (ξ_k θ_k' + ξ_i θ_i'),        ξ_k = ξ_k0 + x p_b,    ξ_i = ξ_i0 - x p_b,

linear in x: w = (a + x b)ᵀ q' beside the nominal rotation's W_a + x W_b. By virtual work friction does -μ F sgn(w) (a +
x b) to the coordinates: ± the force on both gears, and the moments ξ_k and ξ_i times it on their shafts. The sign is
that of the nominal rotation, which reverses at the pitch point; vibration would reverse the force some microseconds
earlier or later.

The friction torque of a gear train is supplied by its drive. Speeds are prescribed, so the work of the friction on
motions that nothing resists, the rotation of the whole train, is given back to them at once, as an inertia force of
d'Alembert: a and b are taken orthogonal to those motions.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearwhine.coupling.gears import GearPairGeometry, loaded_transmission_error
from gearwhine.coupling.gears.contact.sliding_friction import SlidingFriction
from gearwhine.coupling.gears.loaded.transmission_error import LoadedMesh, mesh_period_phases
from gearwhine.coupling.machine.connectors import ContactConnector, Sliding
from gearwhine.coupling.machine.coordinates import MachineCoordinates
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.machine.mesh_kinematics import LineOfAction
from gearwhine.coupling.machine.mounted_parts import MountedGear
from gearwhine.numerics.arrays import FloatArray

_POINTS = 200  # number of phases of a mesh period, as in the mean mesh
_BESIDE_STEP = 1e-9  # distance of a phase from a step [mesh periods]


def sliding_flanks(
    coordinates: MachineCoordinates,
    places: Sequence[tuple[MountedGear, float]],
    geometry: GearPairGeometry,
    friction: SlidingFriction,
    line: LineOfAction,
    frame: float = 0.0,
) -> Sliding:
    """Sliding velocity of the flanks of a gear pair by the coordinates and the nominal rotation.

    The nominal sliding is that seen from the carrier of a planet, on which both axes stand still.

    Parameters
    ----------
    coordinates : MachineCoordinates
    places : two of (MountedGear, float)
        Driver and driven gear, and where the mesh force acts from the left ends of their rotors [m].
    geometry : GearPairGeometry
    friction : SlidingFriction
    line : LineOfAction
    frame : float
        Speed at which the line of centres turns with the carrier of a planet [rad/s].
    """
    across = line.sense * np.array([-line.push[1], line.push[0]])
    gears = (geometry.driver, geometry.driven)
    rolls = (geometry.driver_roll_angle, geometry.driven_roll_angle)
    directions = np.zeros((coordinates.size, 2))
    nominal = np.zeros(2)
    for (mounted, at), gear, roll, side in zip(places, gears, rolls, (1.0, -1.0), strict=True):
        name = mounted.rotor
        rotor = coordinates.rotor(name)
        begin, end = line.sense * gear.base_radius * roll(np.array([0.0, 1.0]))
        rim = rotor.rim_section(mounted.name, at)
        moved, rotation = side * (across @ rim[:2]), rim[5]
        directions += coordinates.rows(name, np.array([moved + begin * rotation, (end - begin) * rotation])).T
        nominal += (coordinates.speeds[name] - frame) * np.array([begin, end - begin])
    return Sliding(friction, directions, nominal)


def friction_of(
    contact: ContactConnector,
    nominal_time: FloatArray,
    speed_ratios: FloatArray,
    compression: FloatArray,
    force: FloatArray,
) -> FloatArray:
    """Friction force of a contact and the power it takes, sample by sample; zeros without friction.

    Parameters
    ----------
    contact : ContactConnector
    nominal_time, speed_ratios : ndarray, shape (s,)
        Nominal time [s], and speed as a part of the nominal one.
    compression, force : ndarray, shape (s,)
        Compression of the contact [m] and its force [N].

    Returns
    -------
    ndarray, shape (s, 2)
        Force across the line of action, positive where it opposes the sliding of a pair that recedes from the pitch
        point [N], and the power that it takes from the nominal rotation [W], μ F (W_a A + W_b B) by the speed.
    """
    if contact.sliding is None:
        return np.zeros((len(force), 2))
    from gearwhine.coupling.gears.contact.tooth_force_kernels import friction_history

    friction, nominal = contact.sliding.friction, contact.sliding.nominal
    law, by_slices = contact.friction_law
    shares = friction_history(
        contact.phase + contact.mesh_frequency * nominal_time,
        np.ascontiguousarray(compression),
        law,
        by_slices,
        friction.pitch_point,
        friction.path_end,
    )
    pushed = friction.coefficient * force
    # A pair slides one way before the pitch point and the other way behind it, so the sense of rotation cancels here.
    power = np.sign(nominal[1]) * pushed * (shares @ nominal) * speed_ratios
    return np.column_stack([pushed * shares[:, 0], power])


def alike_teeth(contact: ContactConnector, force: float) -> tuple[LoadedMesh, FloatArray | None]:
    """Mesh of a contact under a force [N] over a period with all teeth alike, and its friction force by the phase.

    The friction is μ F (A, B) [N], shape (n, 2), see `friction_of`; None without friction.
    """
    law = contact.contact.teeth_alike
    phases = mesh_period_phases(law, _POINTS)
    if contact.sliding is None:
        return loaded_transmission_error(law, force, phases), None
    from gearwhine.coupling.gears.contact.tooth_force_kernels import friction_history

    alike = contact if law is contact.contact else contact.with_law(law)
    assert alike.sliding is not None
    sliding = alike.sliding.friction
    steps = np.array(sliding.event_phases)
    phases = np.unique(np.concatenate([phases, (steps - _BESIDE_STEP) % 1.0, (steps + _BESIDE_STEP) % 1.0]))
    mesh = loaded_transmission_error(law, force, phases)
    compression = np.ascontiguousarray(mesh.transmission_error)
    shares = friction_history(mesh.phases, compression, *alike.friction_law, sliding.pitch_point, sliding.path_end)
    sense = np.sign(contact.sliding.nominal[1])
    return mesh, np.asarray(sense * sliding.coefficient * force * shares)


def with_balanced_friction(system: CoupledSystem) -> CoupledSystem:
    """Return the system with friction orthogonal to the rigid-body motions, whose speed is prescribed."""
    if all(contact.sliding is None for contact in system.contacts):
        return system
    free = system.rigid_body_motions[0]

    def held(contact: ContactConnector) -> ContactConnector:
        if contact.sliding is None:
            return contact
        rows = contact.sliding.directions
        return replace(contact, sliding=replace(contact.sliding, directions=rows - free @ (free.T @ rows)))

    return replace(system, contacts=tuple(held(contact) for contact in system.contacts))
