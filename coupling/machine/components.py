"""Components for component mode synthesis: each part of the machine projected onto its modes, mass-normalised.

Component mode synthesis here takes the free modes of a part and, for the static response of the truncated ones,
residual attachment modes (MacNeal 1971, Rubin 1975), in place of the fixed-interface and constraint modes of the
Craig-Bampton method. A component's own equation of motion, with no connector attached, is

    q'' + (C + Ω G) q' + K q = f,

the mass being the identity. A *direction* is a row vector d such that d q is a motion of the component at one of
its ports; by virtual work a force F along it adds F d to f.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import linalg

from coupling.errors import CouplingError
from coupling.machine.gear_bodies import GearBody
from housing import HousingModes, ModeSet
from rotors import ModalRotor, Pedestal
from rotors.modes.lateral import LateralModes
from rotors.modes.modal_rotor import gyroscopic_matrix

FloatArray = npt.NDArray[np.float64]

_ROUNDING = 1e-10  # tolerance of a symmetric, positive semidefinite damping matrix, relative to its largest entry


@dataclass(frozen=True)
class Component:
    """A part of the machine in modal coordinates.

    Attributes
    ----------
    name : str
    kinds : tuple of str
        Kind of each coordinate: ``housing``, ``rotor`` (lateral), ``torsion``, ``axial``, ``pedestal``, or
        ``residual``: a residual attachment mode of the housing, the static response of its truncated modes. Its own
        frequency is no natural frequency of the housing, and motion at that frequency means nothing.
    stiffness : ndarray, shape (n, n)
        K [1/s²], symmetric.
    damping : ndarray, shape (n, n)
        C [1/s], symmetric.
    gyroscopic : ndarray, shape (n, n)
        G, skew: multiplied by the speed of rotation [rad/s] it joins the damping.
    """

    name: str
    kinds: tuple[str, ...]
    stiffness: FloatArray
    damping: FloatArray
    gyroscopic: FloatArray

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.kinds)


@dataclass(frozen=True)
class HousingComponent(Component):
    """The housing on its supports: its modes, then its residual attachments where it has them.

    Attributes
    ----------
    seats : mapping of str to ndarray, shape (n, 6)
        Motion of each seat's centre by the coordinates: translations x, y, z, rotations about x, y, z.
    seat_z : mapping of str to float
        z of each seat's centre [m].
    sensors : mapping of str to ndarray, shape (n,)
        Motion along each sensor by the coordinates.
    participation : ndarray, shape (n, 6), or None
        Participation φᵀ M R in rigid motions along and about x, y, z through the origin [√kg, √kg m]; needed where the
        base moves or there is weight.
    seat_axes : mapping of str to tuple of float
        x and y of each seat's centre [m], where they are known.
    """

    seats: Mapping[str, FloatArray]
    seat_z: Mapping[str, float]
    sensors: Mapping[str, FloatArray]
    participation: FloatArray | None = None
    seat_axes: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def seat_motions(self, seat: str, z: float) -> FloatArray:
        """Return a seat's rigid motion at z along the shaft [m]: x, y, z, rotations about x and y, shape (5, n).

        The transpose projects a bearing force onto the housing's modes (modal force).
        """
        x, y, along, about_x, about_y = self.seats[seat].T[:5]
        arm = z - self.seat_z[seat]
        # A rotation about y moves a point beyond the centre towards +z along +x, one about x along -y.
        return np.array([x + arm * about_y, y - arm * about_x, along, about_x, about_y])


@dataclass(frozen=True)
class RotorComponent(Component):
    """A rotor: lateral modes in the x and in the y plane, torsional modes, motion along its axis, in this order.

    The torsional modes are those of the shaft with the twist of its gears' bodies, see :func:`rotor_component`.

    Attributes
    ----------
    modal : ModalRotor
        Modes of the rotor: planar modes on averaged supports as the basis in both planes, and free torsional modes.
    start : float
        z of the rotor's left end [m].
    plane_basis : ndarray, shape (m, m)
        The plane's coordinates in terms of the planar modes, orthogonal: shift, tilt and bending of the free shaft.
    torsion_basis : ndarray, shape (t + g, t + g)
        The t torsional coordinates of ``modal`` and the rotations of the rims against their hubs, in terms of the
        component's torsional coordinates.
    axis : tuple of float
        x and y of the shaft's line [m].
    bodies : tuple of GearBody
        The g gears whose rims turn against their hubs.
    """

    modal: ModalRotor
    start: float
    plane_basis: FloatArray
    torsion_basis: FloatArray
    axis: tuple[float, float] = (0.0, 0.0)
    bodies: tuple[GearBody, ...] = ()

    def direction(self, at: float, axis: int) -> FloatArray:
        """Lateral motion (axis 0: x, 1: y) at a distance from the left end [m], shape (n,)."""
        return np.asarray(self.motions(at)[axis])

    def motions(self, at: float) -> FloatArray:
        """Motion of a section: x, y, z, rotations about x and y, shape (5, n), not to be written to."""
        return self._section(at)[:5]

    @cached_property
    def _sections(self) -> dict[float, FloatArray]:
        # Cached: a machine is assembled anew at every speed, with bearings and gears at the same places.
        return {}

    def _section(self, at: float) -> FloatArray:
        """Motions of a section and its rotation about z, shape (6, n)."""
        if at not in self._sections:
            motions, m, t = self.modal.motions(at), self.modal.lateral.count, self.modal.torsional.count
            rows = np.zeros((6, self.size))
            for plane in (slice(0, m), slice(m, 2 * m)):
                rows[:5, plane] = motions[:, plane] @ self.plane_basis
            rows[:5, self._torsion.stop :] = motions[:, 2 * m + t :]
            rows[5, self._torsion] = self.modal.rotation(at)[2 * m : 2 * m + t] @ self.torsion_basis[:t]
            self._sections[at] = rows
            self._sections[at].setflags(write=False)
        return self._sections[at]

    @property
    def _torsion(self) -> slice:
        """The torsional coordinates."""
        first = 2 * self.modal.lateral.count
        return slice(first, first + len(self.torsion_basis))

    def rotation(self, at: float) -> FloatArray:
        """Rotation about z at a distance from the left end [m], shape (n,), not to be written to."""
        return np.asarray(self._section(at)[5])

    def rim_rotation(self, gear: str, at: float) -> FloatArray:
        """Rotation about z of the teeth of a gear over a section at a distance from the left end [m], shape (n,)."""
        rotation = self.rotation(at)
        for number, body in enumerate(self.bodies):
            if body.gear == gear:
                rotation = rotation.copy()
                rotation[self._torsion] += self.torsion_basis[self.modal.torsional.count + number]
        return rotation

    @cached_property
    def turning(self) -> FloatArray:
        """Coordinates of a rotation of the whole rotor about z by one radian, shape (n,).

        The row is the first torsional mode, to which the others are orthogonal: it is ∫ dI_p of their rotations,
        and its square the rotor's polar inertia [kg m²]; not to be written to.
        """
        row = np.zeros(self.size)
        row[2 * self.modal.lateral.count] = 1.0 / self.modal.torsional.evaluate([0.0])[0, 0]
        row.setflags(write=False)
        return row


def housing_component(
    modes: ModeSet,
    damping_ratios: FloatArray,
    *,
    seats: Mapping[str, FloatArray],
    seat_z: Mapping[str, float],
    sensors: Mapping[str, FloatArray],
    damping_matrix: FloatArray | None = None,
    participation: FloatArray | None = None,
    seat_axes: Mapping[str, tuple[float, float]] | None = None,
    name: str = "housing",
) -> HousingComponent:
    """Assemble the housing from its modes and attachments: K = diag(ω²), C = diag(2 ζ ω) + Φᵀ C Φ.

    Parameters
    ----------
    modes : ModeSet
        Modes: m of them and, where there are attachments, k further ones: n = m + k coordinates.
    damping_ratios : ndarray, shape (m,)
        Damping ratios. Attachments take the highest of them.
    seats, seat_z, sensors, participation, seat_axes
        See :class:`HousingComponent`; by :meth:`housing.ModeSet.project_all`.
    damping_matrix : ndarray, shape (n, n), optional
        Φᵀ C Φ of dashpots, mounts and joints [1/s], which couples the coordinates.

    Raises
    ------
    CouplingError
        Where the damping does not fit the modes, the matrix would feed energy in, or motions and coordinates differ in
        number.
    """
    m = len(modes.frequencies)
    if damping_ratios.shape != (m,):
        raise CouplingError(f"{len(damping_ratios)} damping ratios for {m} housing modes; expected as many")
    omega, ratios = modes.frequencies, damping_ratios
    if modes.residual_modes is not None:
        omega = np.concatenate([omega, modes.residual_modes.frequencies])
        ratios = np.concatenate([ratios, np.full(len(omega) - m, damping_ratios.max(initial=0.0))])
    n = len(omega)
    for place, motion in [*seats.items(), *sensors.items()]:
        if len(motion) != n:
            raise CouplingError(f"{place!r}: motions of {len(motion)} coordinates; expected {n}, attachments included")
    damping = np.diag(2.0 * ratios * omega)
    if damping_matrix is not None:
        _check_damping(damping_matrix, n)
        damping = damping + damping_matrix
    return HousingComponent(
        name=name,
        kinds=("housing",) * m + ("residual",) * (n - m),
        stiffness=np.diag(omega**2),
        damping=damping,
        gyroscopic=np.zeros((n, n)),
        seats=seats,
        seat_z=seat_z,
        sensors=sensors,
        participation=participation,
        seat_axes=seat_axes or {},
    )


def component_of_housing(modes: HousingModes, name: str = "housing") -> HousingComponent:
    """Make the housing's component from its natural modes, see :meth:`housing.Housing.modes`."""
    seats = {seat.name: seat.center for seat in modes.housing.seats}
    return housing_component(
        modes.mode_set,
        np.full(len(modes.mode_set.frequencies), modes.housing.damping_ratio),
        seats=modes.seats,
        seat_z={seat: center[2] for seat, center in seats.items()},
        seat_axes={seat: center[:2] for seat, center in seats.items()},
        sensors=modes.sensors,
        damping_matrix=modes.damping_matrix,
        participation=modes.participation,
        name=name,
    )


@dataclass(frozen=True)
class PedestalComponent(Component):
    """Pedestal of a grounded bearing: its motions along x and y, times the root of its mass.

    Attributes
    ----------
    motion : ndarray, shape (2, 2)
        Motion of the bearing's foot along x and y by the coordinates [1/√kg].
    """

    motion: FloatArray


def pedestal_component(name: str, pedestal: Pedestal) -> PedestalComponent:
    """Make a pedestal's component of two coordinates.

    Raises
    ------
    CouplingError
        Where it has no mass, so that no time step could resolve its motion.
    """
    if pedestal.mass <= 0.0:
        raise CouplingError(
            f"{name}: a pedestal without mass cannot be followed in time; expected a mass, even a small one"
        )
    return PedestalComponent(
        name=name,
        kinds=("pedestal",) * 2,
        stiffness=pedestal.stiffness / pedestal.mass,
        damping=pedestal.damping / pedestal.mass,
        gyroscopic=np.zeros((2, 2)),
        motion=np.eye(2) / np.sqrt(pedestal.mass),
    )


def _check_damping(matrix: FloatArray, n: int) -> None:
    """Refuse a damping matrix of another order, or one that is not symmetric and free of gain."""
    if matrix.shape != (n, n):
        raise CouplingError(f"damping matrix of shape {matrix.shape} for {n} housing modes; expected ({n}, {n})")
    scale = float(np.abs(matrix).max(initial=0.0))
    if not np.isfinite(scale) or np.abs(matrix - matrix.T).max(initial=0.0) > _ROUNDING * scale:
        raise CouplingError("the damping matrix of the housing modes is not symmetric, or not finite")
    if n and np.linalg.eigvalsh(matrix)[0] < -_ROUNDING * n * scale:
        raise CouplingError("the damping matrix of the housing modes has a negative eigenvalue: it feeds energy in")


def rotor_component(
    name: str,
    modal: ModalRotor,
    *,
    start: float,
    damping_ratio: float = 0.0,
    axis: tuple[float, float] = (0.0, 0.0),
    bodies: Sequence[GearBody] = (),
) -> RotorComponent:
    """Project a rotor onto its modes, without the averaged springs of its planar basis.

    The planar modes are those at averaged support stiffness k̄ (TM-101442 Eq. 7). The springs come back with the
    bearings' connectors, so they are taken out here, K = diag(ω²) - Σ k̄ φ(z_b) φ(z_b)ᵀ in each plane (the
    *compensation* of TM-104434 Eqs. 11 to 15), and the same span is taken in the free shaft's own coordinates: its
    shift, its tilt, and the bending beside them that diagonalises K. The shaft's damping acts on bending and twisting,
    not on a motion of the shaft as a whole. The gyroscopic coupling of the planes is +G in the x rows and -G in the y
    rows, G_ij = ∫ φ'_i dI_p φ'_j, so that C + ΩG gives the terms G_v of Eqs. 1 and 2.

    The rims of gears turn against their hubs by φ, as coordinates beside those of the shaft's torsional modes q. With
    the modes' rotations τ at the hubs, their frequencies ω and the bodies' k, S and J_r
    (:mod:`coupling.gears.stiffness.body_twist`), whose inertia J the modes of the shaft contain,

        [I, τᵀ S; S τ, J_r] [q''; φ''] + [diag(ω²), 0; 0, k] [q; φ] = f.

    The component's torsional coordinates are the natural modes of this, the rigid rotation of all first. The shaft's
    damping ratio is theirs.

    An axial force P, in tension, resists the tilt by ∫ P dz per unit angle, and couples it with bending. A compressed
    shaft's tilt has negative stiffness: what holds the shaft is its bearings.

    Parameters
    ----------
    name : str
    modal : ModalRotor
        m planar, t torsional and a axial modes, vectors included. With g bodies of gears the component has
        2 m + t + g + a coordinates.
    start : float
        z of the rotor's left end [m].
    damping_ratio : float
        Damping ratio of the shaft's own material and fits, on every mode of the free shaft but its shift and tilt.
    axis : tuple of float
        x and y of the shaft's line [m], which matter where the base turns.
    bodies : sequence of GearBody
        Gears on the rotor whose rims turn against their hubs.
    """
    lateral, along = modal.lateral, np.zeros(0) if modal.axial is None else modal.axial.frequencies
    twisting, torsion_basis = _with_bodies(modal, bodies)
    # Beyond the shaft's own coordinates the hubs vibrate against their rims: static, as the attachment modes are.
    resolved = float(modal.torsional.frequencies.max(initial=0.0)) if bodies else np.inf
    m, n = lateral.count, modal.size + len(bodies)
    plane_basis, plane_stiffness, bending = _free_plane(lateral)
    stiffness = np.diag(np.concatenate([np.zeros(2 * m), twisting**2, along**2]))
    stiffness[:m, :m] = stiffness[m : 2 * m, m : 2 * m] = plane_stiffness
    # Zeros for motions as a whole: they strain no material, though an axial force may resist the tilt or drive it.
    damped = np.concatenate([bending, bending, twisting, along])
    gyroscopic = np.zeros((n, n))
    gyroscopic[: 2 * m, : 2 * m] = gyroscopic_matrix(plane_basis.T @ lateral.polar_inertia_matrix @ plane_basis)
    return RotorComponent(
        name=name,
        kinds=("rotor",) * (2 * m)
        + tuple("torsion" if one <= resolved else "residual" for one in twisting.tolist())
        + ("axial",) * len(along),
        stiffness=stiffness,
        damping=np.diag(2.0 * damping_ratio * damped),
        gyroscopic=gyroscopic,
        modal=modal,
        start=start,
        plane_basis=plane_basis,
        torsion_basis=torsion_basis,
        axis=axis,
        bodies=tuple(bodies),
    )


def _with_bodies(modal: ModalRotor, bodies: Sequence[GearBody]) -> tuple[FloatArray, FloatArray]:
    """Natural frequencies (t + g,) [rad/s] and modes (t + g, t + g) of the shaft's torsion with its gears' bodies."""
    t, g = modal.torsional.count, len(bodies)
    if not bodies:
        return modal.torsional.frequencies, np.eye(t)
    stiffness = np.diag([*modal.torsional.frequencies**2, *(body.stiffness for body in bodies)])
    mass = np.diag([*np.ones(t), *(body.rim_inertia for body in bodies)])
    coupling = modal.torsional.evaluate([body.at for body in bodies]) * [body.coupling_inertia for body in bodies]
    mass[:t, t:], mass[t:, :t] = coupling, coupling.T
    # The first coordinate is the rotation of all as one body: the other modes are orthogonal to it.
    whole = mass[0, 1:]
    values, vectors = linalg.eigh(stiffness[1:, 1:], mass[1:, 1:] - np.outer(whole, whole))
    basis = np.zeros((t + g, t + g))
    basis[0, 0], basis[0, 1:], basis[1:, 1:] = 1.0, -whole @ vectors, vectors
    return np.concatenate([modal.torsional.frequencies[:1], np.sqrt(values)]), basis


def _free_plane(lateral: LateralModes) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Orthogonal basis of a plane's free shaft (m, m), stiffness there (m, m) [1/s²], bending frequencies (m,) [rad/s].

    The frequencies are zero for the motions of the shaft as a whole, the first columns of the basis. These are
    known, and so is it that nothing resists them: among the eigenvalues of the stiffness their zeros cannot be told
    from soft bending, since their rounding error is that of the stiffest attachment mode.
    """
    whole, free = lateral.rigid_motions, lateral.free_stiffness
    count, unresisted = whole.shape[1], lateral.unresisted_motions
    beside = np.linalg.qr(whole, mode="complete")[0][:, count:]
    values, vectors = np.linalg.eigh(beside.T @ free @ beside)
    basis = np.hstack([whole, beside @ vectors])
    resisted = basis.T @ free @ whole
    resisted[:, :unresisted] = resisted[:unresisted] = 0.0
    stiffness = np.diag(np.concatenate([np.zeros(count), values]))
    stiffness[:, :count], stiffness[:count] = resisted, resisted.T
    return basis, stiffness, np.concatenate([np.zeros(count), np.sqrt(np.maximum(values, 0.0))])
