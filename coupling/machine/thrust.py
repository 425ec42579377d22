"""Thrust and load shuttling: axial forces of helical gears on each rotor, and the moment of the moving tooth load.

A pair's force F acts along the normal of the teeth: in the transverse plane along the line of action, and along z by
F tan β_b. At constant torque the moment about z of every rotor balances, s Σ F R_b = T, which gives the forces; a rotor
on which their axial parts do not cancel needs a bearing that holds it along its axis. Without one it has no axial
coordinate, and the thrust would vanish from the model.

Load shuttling is the motion of the centre of the tooth load along the face; its moment tilts the shafts.

The force F of a mesh acts where the load per width q of its contact lines has its centre, not at the middle of the
face. From the middle of the face along the shafts, and from the pitch point along the line of action, that is

    z̄ = ∫ z q dz / F,        ξ̄ = ∫ ξ q dz / F,

both periodic with the mesh in helical gears, and constant offsets besides where flanks are misaligned (load shuttling:
Borner and Houser, SAE 961816, 1996). With e the direction in which the driver pushes and h the axial part
of the force over F, a force F (e, h) at that place has the moment of the same force at the pitch point and

    M = F (z̄ - h ξ̄) (-e_y, e_x)

about the driven gear's centre; the moment on the driver is opposite. Both arms are those of static equilibrium under
the mean force, which stands for F in M: the dynamic part of the force would add a product of two small quantities.
"""

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from coupling.gears import GearError, GearPairGeometry, ToothContact, loaded_transmission_error
from coupling.machine.connectors import MountedBearing
from coupling.machine.coupled_system import HarmonicLoad

_CANCELLED = 1e-6  # part of the largest axial force of a gear on the rotor that may be left over
FloatArray = npt.NDArray[np.float64]

_POINTS = 128  # phases of a mesh period
_HARMONICS = 6  # of the mesh frequency, at most
_SMALL = 0.01  # part of the greatest harmonic below which the last ones are left out
_NO_ARM = 1e-9  # part of the face width that is rounding


@dataclass(frozen=True)
class ThrustPair:
    """A gear pair in the thrust balance: its rotors, the names of its gears, and their geometry."""

    rotors: tuple[str, str]
    gears: tuple[str, str]
    geometry: GearPairGeometry


@dataclass(frozen=True)
class AxialForces:
    """Axial forces of the gears on one rotor at its torques.

    Attributes
    ----------
    gears : tuple of str
        Those with a helix angle.
    forces : tuple of float
        Along z on each of them [N].
    """

    gears: tuple[str, ...]
    forces: tuple[float, ...]

    @property
    def net(self) -> float:
        """Their sum [N]; zero where they cancel but for rounding."""
        total = sum(self.forces)
        return total if abs(total) > _CANCELLED * max(map(abs, self.forces), default=0.0) else 0.0


def axially_held(bearings: Sequence[MountedBearing], speeds: Mapping[str, float], among: Container[str]) -> set[str]:
    """Those of the given rotors ``among`` that a bearing with axial stiffness holds at their speeds [rad/s]."""
    return {
        mounted.rotor
        for mounted in bearings
        if mounted.rotor in among and _holds_axially(mounted, speeds[mounted.rotor])
    }


def _holds_axially(mounted: MountedBearing, speed: float) -> bool:
    elements = mounted.elements
    if mounted.needs_load and elements is not None:
        return elements.has_axial_stiffness
    return bool(mounted.bearing.at_speed(speed).spatial_stiffness[2, 2] > 0.0)


def axial_forces(
    pairs: Sequence[ThrustPair], speeds: Mapping[str, float], torques: Mapping[str, float]
) -> dict[str, AxialForces]:
    """Axial forces of helical gears on each rotor that has any, at constant torques.

    Parameters
    ----------
    pairs
        All gear pairs.
    speeds
        Signed speed of each rotor [rad/s].
    torques
        About z on each rotor [N m]; a rotor without one is free to turn.

    Notes
    -----
    Where several paths share a torque the least-squares forces are taken: equal pairs carry equal parts.
    """
    names = list(dict.fromkeys(name for pair in pairs for name in pair.rotors))
    moments = np.zeros((len(names), len(pairs)))
    senses = [1.0 if speeds[pair.rotors[0]] >= 0.0 else -1.0 for pair in pairs]
    for number, (pair, sense) in enumerate(zip(pairs, senses, strict=True)):
        for rotor, gear in zip(pair.rotors, (pair.geometry.driver, pair.geometry.driven), strict=True):
            moments[names.index(rotor), number] += sense * gear.base_radius
    acting = np.array([torques.get(name, 0.0) for name in names])
    mesh_forces = np.linalg.lstsq(moments, acting, rcond=None)[0] if pairs else np.zeros(0)
    found: dict[str, list[tuple[str, float]]] = {}
    for pair, sense, force in zip(pairs, senses, mesh_forces.tolist(), strict=True):
        helix = pair.geometry.driver.base_helix_angle
        if helix == 0.0:
            continue
        thrust = sense * force * float(np.tan(helix))
        for rotor, name, side in zip(pair.rotors, pair.gears, (1.0, -1.0), strict=True):
            found.setdefault(rotor, []).append((name, side * thrust))
    return {
        rotor: AxialForces(tuple(gear for gear, _ in here), tuple(force for _, force in here))
        for rotor, here in found.items()
    }


def require_thrust_carried(
    pairs: Sequence[ThrustPair],
    bearings: Sequence[MountedBearing],
    speeds: Mapping[str, float],
    torques: Mapping[str, float],
    movable: Container[str] | None = None,
) -> None:
    """Refuse helical gears that push a rotor which no bearing holds along its axis.

    Parameters
    ----------
    pairs, speeds, torques
        As of :func:`axial_forces`.
    bearings
        Those with axial stiffness carry thrust.
    movable
        Rotors with an axial coordinate; by default all.

    Raises
    ------
    CouplingError
        With the rotors, the gears and the forces [N].
    """
    forces = axial_forces(pairs, speeds, torques)
    held = axially_held(bearings, speeds, forces)
    loose = [
        f"rotor {rotor!r}: its gears {', '.join(map(repr, dict.fromkeys(here.gears)))} push it along its axis with "
        f"{abs(here.net):.4g} N, and none of its bearings has axial stiffness"
        for rotor, here in forces.items()
        if here.net != 0.0 and not (rotor in held and (movable is None or rotor in movable))
    ]
    if loose:
        raise CouplingError(
            "; ".join(loose)
            + "; expected a bearing that carries the thrust (a 5x5 stiffness matrix with the entry zz, "
            "or a rolling bearing that does not float), or helical gears whose thrusts on the rotor cancel"
        )


def load_arms(contact: ToothContact, geometry: GearPairGeometry, force: float, phases: npt.ArrayLike) -> FloatArray:
    """Centre of the load of a mesh, z̄ along the face and ξ̄ along the line of action [m], shape (n, 2).

    Zeros where the contact does not resolve its face.

    Parameters
    ----------
    contact : ToothContact
    geometry : GearPairGeometry
    force : float
        Along the line of action, above 0 [N].
    phases : array_like, shape (n,)
        Mesh periods.

    Raises
    ------
    GearError
        Where no teeth meet at some phase, or for a force below 0.
    """
    mesh = loaded_transmission_error(contact, force, phases)
    arms = np.zeros((mesh.phases.size, 2))
    if contact.faces is None or mesh.line_loads is None:
        return arms
    z, shift = contact.faces.z, contact.faces.shift
    along = (mesh.positions[:, :, None] + shift - geometry.pitch_point_position) * geometry.base_pitch
    shares = mesh.line_loads / mesh.line_loads.sum(axis=(1, 2))[:, None, None]
    arms[:, 0] = (shares * z).sum(axis=(1, 2))
    # Slots without a pair carry nothing, whatever their position.
    arms[:, 1] = np.where(shares > 0.0, shares * along, 0.0).sum(axis=(1, 2))
    return arms


def shuttling_loads(
    contact: ToothContact,
    geometry: GearPairGeometry,
    force: float,
    axial: float,
    tilting: FloatArray,
    phase: float,
    mesh_frequency: float,
) -> tuple[FloatArray, list[HarmonicLoad]]:
    """Moments of a mesh's load about the middle of the face, as a constant load and harmonics of the mesh frequency.

    Parameters
    ----------
    contact, geometry
        Of the flanks that carry.
    force : float
        Mean mesh force F, above 0 [N].
    axial : float
        Axial part h of the force over F, as the driven gear feels it.
    tilting : ndarray, shape (n,)
        Compression of the mesh by each coordinate, for each metre that the load is off the middle of the face.
    phase : float
        Mesh phase at t = 0 [mesh periods].
    mesh_frequency : float
        [Hz]; negative for flanks met in the opposite order.

    Returns
    -------
    constant : ndarray, shape (n,)
    harmonics : list of HarmonicLoad
    """
    nothing = np.zeros_like(tilting)
    if contact.faces is None or not np.any(tilting):
        return nothing, []
    phases = np.arange(_POINTS) / _POINTS if mesh_frequency != 0.0 else np.array([phase])
    try:
        arm = load_arms(contact, geometry, force, phases) @ [1.0, -axial]
    except GearError:
        return nothing, []
    if np.abs(arm).max() <= _NO_ARM * contact.faces.face_width:
        return nothing, []
    found = np.fft.rfft(arm) / len(arm)
    orders = np.arange(1, min(_HARMONICS, len(found) - 1) + 1)
    amplitudes = 2.0 * found[orders]
    if mesh_frequency < 0.0:
        amplitudes = amplitudes.conj()
    amplitudes = amplitudes * np.exp(2j * np.pi * np.sign(mesh_frequency) * orders * phase)
    heard = np.abs(amplitudes) > max(_SMALL * np.abs(amplitudes).max(initial=0.0), _NO_ARM * contact.faces.face_width)
    # On the coordinates acts minus the force times the compression's gradient.
    harmonics = [
        HarmonicLoad(2.0 * np.pi * order * abs(mesh_frequency), -force * amplitude * tilting, follows="turning")
        for order, amplitude in zip(orders[heard].tolist(), amplitudes[heard], strict=True)
    ]
    return -force * found[0].real * tilting, harmonics
