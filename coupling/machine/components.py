"""Components for component mode synthesis: each part of the machine projected onto its modes, mass-normalised.

Component mode synthesis here takes the free modes of a part and, for the static response of the truncated ones,
residual attachment modes (MacNeal 1971, Rubin 1975), in place of the fixed-interface and constraint modes of the
Craig-Bampton method. A component's own equation of motion, with no connector attached, is

    q'' + (C + Ω G) q' + K q = f,

the mass being the identity. A *direction* is a row vector d such that d q is a motion of the component at one of
its ports; by virtual work a force F along it adds F d to f.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import linalg

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears.stiffness.wheel_modes import PlateMode
from gearwhine.coupling.machine.gear_bodies import GearBody, RimSpring
from gearwhine.coupling.machine.pins import MountedPin
from gearwhine.housing import HousingModes, ModeSet
from gearwhine.housing.modes.housing_field import HousingField
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, refuse
from gearwhine.numerics.result_warnings import ResultWarning
from gearwhine.rotors import ModalRotor, Pedestal
from gearwhine.rotors.modes.lateral import LateralModes
from gearwhine.rotors.modes.modal_rotor import gyroscopic_matrix
from gearwhine.rotors.modes.torsional_and_axial import AxialModes

# Tolerance of a symmetric, positive semidefinite damping matrix, relative to its largest entry.
_DAMPING_MATRIX_ROUNDING = 1e-10


@dataclass(frozen=True)
class FrameTerms:
    """What the turning of a component's frame adds to its equation of motion, shapes (n, n).

    :mod:`gearwhine.coupling.machine.frames` has the equation. At the relative speed s' and the angular acceleration s''
    it adds s' ``coriolis`` to the damping, and s' ``circulatory`` + s'² ``centripetal`` + s'' ``angular`` to the
    stiffness.

    Attributes
    ----------
    coriolis : ndarray
        [1/s], skew.
    circulatory : ndarray
        [1/s²], skew: of damping in the frame at rest.
    centripetal : ndarray
        [1/s²], symmetric: of inertia and gyroscopic moment.
    angular : ndarray
        [1/s], skew.
    """

    coriolis: FloatArray
    circulatory: FloatArray
    centripetal: FloatArray
    angular: FloatArray

    @property
    def stiffness(self) -> FloatArray:
        """What is added to the stiffness at the nominal speed [1/s²]."""
        return self.circulatory + self.centripetal

    def among(self, numbers: npt.NDArray[np.int64]) -> "FrameTerms":
        """Terms of some of the coordinates."""
        square = np.ix_(numbers, numbers)
        return FrameTerms(*(part[square] for part in (self.coriolis, self.circulatory, self.centripetal, self.angular)))


@dataclass(frozen=True)
class Component:
    """A part of the machine in modal coordinates.

    Attributes
    ----------
    name : str
    kinds : tuple of str
        Kind of each coordinate: ``housing``, ``rotor`` (lateral), ``torsion``, ``axial``, ``body`` (a gear's
        body with nodal diameters), ``pedestal``, or ``residual``: a residual attachment mode of the housing, the static
        response of its truncated modes. Its own frequency is no natural frequency of the housing, and motion at that
        frequency means nothing.
    stiffness : ndarray, shape (n, n)
        K [1/s²], symmetric.
    damping : ndarray, shape (n, n)
        C [1/s], symmetric.
    gyroscopic : ndarray, shape (n, n)
        G, skew: multiplied by the speed of rotation [rad/s] it joins the damping.
    frame : FrameTerms or None
        Further terms of coordinates in a frame that turns; None in one that stands still.
    """

    name: str
    kinds: tuple[str, ...]
    stiffness: FloatArray
    damping: FloatArray
    gyroscopic: FloatArray
    frame: FrameTerms | None = field(default=None, kw_only=True)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.kinds)


@dataclass(frozen=True)
class SensorPlace:
    """Position of a sensor [m] and the unit vector of its direction, shapes (3,)."""

    position: FloatArray
    direction: FloatArray


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
    sensor_places : mapping of str to SensorPlace
        Place of each sensor, by which it shows motion in space where the base moves.
    complete_below : float or None
        Frequency below which its modes are complete [rad/s]; None where that is not known.
    coarser : HousingComponent or None
        The housing with fewer residual modes; the difference estimates the truncation error.
    warnings : tuple of dict
        Warnings about the housing's model.
    seat_reach : mapping of str to float
        Distance along z from a seat's centre within which a bearing sits in it [m], where it is known.
    displacement_field : HousingField or None
        Mesh and shapes of its coordinates, which sound needs; None of a reduced housing.
    ring_motions : mapping of str to ndarray, shape (n, 2 + 4 orders)
        Deformation of each bore with a ring gear by the coordinates: a₀, c₀, and a_n, b_n, c_n, d_n of each order, see
        :func:`gearwhine.housing.model.patches.ring_matrix`.
    mass : float or None
        Mass of the housing [kg], where it is known.

    Raises
    ------
    CouplingError
        Where a matrix or a motion is not finite or of another shape, K or C is not symmetric or has a negative
        eigenvalue, G is not skew, or a seat has no place along z.
    """

    seats: Mapping[str, FloatArray]
    seat_z: Mapping[str, float]
    sensors: Mapping[str, FloatArray]
    participation: FloatArray | None = None
    seat_axes: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    sensor_places: Mapping[str, SensorPlace] = field(default_factory=dict)
    complete_below: float | None = None
    coarser: "HousingComponent | None" = None
    warnings: tuple[ResultWarning, ...] = ()
    seat_reach: Mapping[str, float] = field(default_factory=dict)
    displacement_field: HousingField | None = None
    ring_motions: Mapping[str, FloatArray] = field(default_factory=dict)
    mass: float | None = None

    def __post_init__(self) -> None:
        """Check that the matrices and motions are those of a housing."""
        refuse(_component_findings(self), CouplingError)

    @property
    def frequencies_hz(self) -> FloatArray:
        """Natural frequencies of its modes [Hz], without residual modes."""
        modes = sum(kind == "housing" for kind in self.kinds)
        return np.asarray(np.sqrt(np.diag(self.stiffness)[:modes]) / (2.0 * np.pi))

    def seat_motions(self, seat: str, z: float) -> FloatArray:
        """Return a seat's rigid motion at z along the shaft [m]: x, y, z, rotations about x and y, shape (5, n).

        The transpose projects a bearing force onto the housing's modes (modal force).
        """
        x, y, along, about_x, about_y = self.seats[seat].T[:5]
        arm = z - self.seat_z[seat]
        # A rotation about y moves a point beyond the centre towards +z along +x, one about x along -y.
        return np.array([x + arm * about_y, y - arm * about_x, along, about_x, about_y])

    def section_motions(self, seat: str, z: float) -> FloatArray:
        """Return a seat's rigid motion at z along the shaft [m] with its rotation about z too, shape (6, n)."""
        return np.vstack([self.seat_motions(seat, z), self.seats[seat].T[5]])

    def ring_harmonics(self, seat: str, push: Sequence[float], angle: float) -> list[tuple[FloatArray, FloatArray]]:
        """Motion of ring teeth along a push that turns, by the deformation of their bore: (n,) and (n,) of each order.

        Parameters
        ----------
        seat : str
        push : (x, y)
            Unit vector at the angle of the tooth contact at first; it turns with the contact.
        angle : float
            Angle of the contact from x about the bore's axis at first [rad].

        Returns
        -------
        list of two ndarray
            Parts A_n and B_n of the motion Σ A_n cos nα + B_n sin nα at α beyond the first angle, from order 0 on.
        """
        radial = push[0] * math.cos(angle) + push[1] * math.sin(angle)
        tangential = push[1] * math.cos(angle) - push[0] * math.sin(angle)
        rows = self.ring_motions[seat].T
        parts = [(radial * rows[0] + tangential * rows[1], np.zeros(self.size))]
        for order in range(1, (len(rows) - 2) // 4 + 1):
            a, b, c, d = rows[4 * order - 2 : 4 * order + 2]
            cosine, sine = radial * a + tangential * c, radial * b + tangential * d
            turn = order * angle
            parts.append(
                (cosine * math.cos(turn) + sine * math.sin(turn), sine * math.cos(turn) - cosine * math.sin(turn))
            )
        return parts


@dataclass(frozen=True)
class RotorComponent(Component):
    """A rotor: lateral modes in the x and in the y plane, torsional modes, motion along its axis, in this order.

    The modes are those of the shaft with the rims of its gears on their hubs, see :func:`rotor_component`.

    Last are the cosine and the sine of each mode of a gear's body with two nodal diameters or more.

    Attributes
    ----------
    modal : ModalRotor
        Modes of the rotor: planar modes on averaged supports as the basis in both planes, and free torsional modes.
    start : float
        z of the rotor's left end [m].
    plane_basis : ndarray, shape (m + s, m + s)
        The m planar modes of ``modal`` and the s shifts of rims and tilting modes of gear bodies, in terms of a
        plane's coordinates: shift, tilt and bending of the free shaft. Without rims it is orthogonal.
    torsion_basis : ndarray, shape (t + g, t + g)
        The t torsional modes of ``modal`` and the rotations of g rims against their hubs, in terms of the component's
        torsional coordinates.
    axial_basis : ndarray, shape (a + u, a + u)
        The a axial modes of ``modal`` and u umbrella modes of gear bodies, in terms of the component's axial
        coordinates.
    axis : tuple of float
        x and y of the shaft's line [m].
    bodies : tuple of GearBody
        Gears whose rims move on their hubs.
    damping_ratio : float
        Damping ratio of the shaft and the gears' bodies.
    carrier : str or None
        Rotor with which the shaft's axis turns, of a planet; ``axis`` is its place at t = 0.
    pin : MountedPin or None
        Elastic pin between the carrier and the bearings of a planet; None of a rigid one.
    internal_damping : ndarray, shape (n,)
        Damping by the shaft's deformation, which rotates with the shaft [1/s].
    """

    modal: ModalRotor
    start: float
    plane_basis: FloatArray
    torsion_basis: FloatArray
    axial_basis: FloatArray
    axis: tuple[float, float] = (0.0, 0.0)
    bodies: tuple[GearBody, ...] = ()
    damping_ratio: float = 0.0
    carrier: str | None = None
    pin: MountedPin | None = None
    internal_damping: FloatArray = field(default_factory=lambda: np.zeros(0))

    def direction(self, at: float, axis: int) -> FloatArray:
        """Lateral motion (axis 0: x, 1: y) at a distance from the left end [m], shape (n,)."""
        return np.asarray(self.motions(at)[axis])

    def motions(self, at: float) -> FloatArray:
        """Motion of a section: x, y, z, rotations about x and y, shape (5, n), not to be written to."""
        return self._section(at)[:5]

    def station(self, z: float) -> float:
        """Section of the rotor nearest to a place along z, from its left end [m]."""
        return min(max(z - self.start, 0.0), float(self.modal.lateral.stations[-1]))

    def seat_motions(self, axis: Sequence[float], z: float) -> FloatArray:
        """Motion of a seat in this rotor, such as a planet's pin: x, y, z, rotations about x and y, shape (5, n).

        The seat moves as one body with the section at z, or with the end of the rotor where that is nearer.

        Parameters
        ----------
        axis : sequence of float
            x and y of the seat's axis [m].
        z : float
            Place along the shafts [m].
        """
        at = self.station(z)
        return seat_in_section(self._section(at), np.subtract(axis, self.axis), z - self.start - at)

    @cached_property
    def _sections(self) -> dict[float, FloatArray]:
        # Cached: a machine is assembled anew at every speed, with bearings and gears at the same places.
        return {}

    def _section(self, at: float) -> FloatArray:
        """Motions of a section and its rotation about z, shape (6, n)."""
        if at not in self._sections:
            motions, m, t = self.modal.motions(at), self.modal.lateral.count, self.modal.torsional.count
            rows = np.zeros((6, self.size))
            for modes, plane in zip((slice(0, m), slice(m, 2 * m)), self._planes, strict=True):
                rows[:5, plane] = motions[:, modes] @ self.plane_basis[:m]
            rows[:5, self.axial] = motions[:, 2 * m + t :] @ self.axial_basis[: motions.shape[1] - 2 * m - t]
            rows[5, self._torsion] = self.modal.rotation(at)[2 * m : 2 * m + t] @ self.torsion_basis[:t]
            self._sections[at] = rows
            self._sections[at].setflags(write=False)
        return self._sections[at]

    @property
    def plane_size(self) -> int:
        """Number of coordinates of a plane, m + s."""
        return len(self.plane_basis)

    @property
    def _planes(self) -> tuple[slice, slice]:
        """Coordinates of the x and of the y plane."""
        return slice(0, self.plane_size), slice(self.plane_size, 2 * self.plane_size)

    @property
    def _torsion(self) -> slice:
        """The torsional coordinates."""
        first = 2 * self.plane_size
        return slice(first, first + len(self.torsion_basis))

    @property
    def axial(self) -> slice:
        """The axial coordinates."""
        return slice(self._torsion.stop, self._torsion.stop + len(self.axial_basis))

    @property
    def plates(self) -> tuple[tuple[str, PlateMode, slice], ...]:
        """Modes of gear bodies with two nodal diameters or more: gear, mode, and coordinates of its cosine and sine."""
        modes = [(body.gear, mode) for body in self.bodies for mode in body.plates if mode.nodal_diameters > 1]
        firsts = range(self.axial.stop, self.size, 2)
        return tuple((gear, mode, slice(at, at + 2)) for (gear, mode), at in zip(modes, firsts, strict=True))

    def rotation(self, at: float) -> FloatArray:
        """Rotation about z at a distance from the left end [m], shape (n,), not to be written to."""
        return np.asarray(self._section(at)[5])

    def rim_section(self, gear: str, at: float) -> FloatArray:
        """Motion of the teeth of a gear over a section at a distance from the left end [m], shape (6, n).

        Along x, y, z and about them: that of the section with the rim's rotation and shift on its hub.
        """
        body = next((body for body in self.bodies if body.gear == gear), None)
        if body is None:
            return self._section(at)
        rows = self._section(at).copy()
        if body.twist is not None:
            number = [one.gear for one in self.bodies if one.twist is not None].index(gear)
            rows[5, self._torsion] += self.torsion_basis[self.modal.torsional.count + number]
        if body.shift is not None:
            number = [one.gear for one in self.bodies if one.shift is not None].index(gear)
            for row, own in zip(rows, self._planes, strict=False):
                row[own] += self.plane_basis[self.modal.lateral.count + number]
        return rows

    def plate_rows(self, gear: str, arm: tuple[float, float]) -> FloatArray:
        """Motion of the teeth of a gear by the modes of its body out of the plane, shape (5, n): `PlateMode.rows`."""
        rows = np.zeros((5, self.size))
        for name, mode, coordinates in self._plate_coordinates:
            if name == gear:
                rows += mode.rows(arm) @ coordinates
        return rows

    @cached_property
    def _plate_coordinates(self) -> list[tuple[str, PlateMode, FloatArray]]:
        """Gear, mode, and cosine and sine by the coordinates (2, n) of the modes out of the plane."""
        found = []
        shifts = sum(body.shift is not None for body in self.bodies)
        umbrellas, tilts = 0 if self.modal.axial is None else self.modal.axial.count, self.modal.lateral.count + shifts
        pairs = {id(mode): own for _, mode, own in self.plates}
        for body in self.bodies:
            for mode in body.plates:
                rows = np.zeros((mode.size, self.size))
                if mode.nodal_diameters == 0:
                    if self.modal.axial is None:
                        continue
                    rows[0, self.axial] = self.axial_basis[umbrellas]
                    umbrellas += 1
                elif mode.nodal_diameters == 1:
                    for row, own in zip(rows, self._planes, strict=True):
                        row[own] = self.plane_basis[tilts]
                    tilts += 1
                else:
                    rows[:, pairs[id(mode)]] = np.eye(2)
                found.append((body.gear, mode, rows))
        return found

    @cached_property
    def turning(self) -> FloatArray:
        """Coordinates of a rotation of the whole rotor about z by one radian, shape (n,).

        The row is the first torsional mode, to which the others are orthogonal: it is ∫ dI_p of their rotations,
        and its square the rotor's polar inertia [kg m²]; not to be written to.
        """
        row = np.zeros(self.size)
        row[2 * self.plane_size] = 1.0 / self.modal.torsional.evaluate([0.0])[0, 0]
        row.setflags(write=False)
        return row


def seat_in_section(section: FloatArray, arm: FloatArray, along: float) -> FloatArray:
    """Motion of a seat that moves as one body with a section: x, y, z, rotations about x and y, shape (5, n).

    Parameters
    ----------
    section : ndarray, shape (6, n)
        Motion of the section along and about x, y, z by n coordinates.
    arm : ndarray, shape (2,)
        Place of the seat from the section's centre across the shaft [m].
    along : float
        Place along the shaft from the section [m].
    """
    x, y, z, about_x, about_y, turned = section
    return np.array(
        [
            x + along * about_y - arm[1] * turned,
            y - along * about_x + arm[0] * turned,
            z + arm[1] * about_x - arm[0] * about_y,
            about_x,
            about_y,
        ]
    )


def _component_findings(component: HousingComponent) -> Iterator[Finding]:
    """Yield what no housing is: K and C without negative eigenvalues, G skew, motions by each coordinate."""
    part, n = ("housing", component.name), component.size
    shapes: dict[str, tuple[FloatArray, tuple[int, ...]]] = {
        name: (getattr(component, name), (n, n)) for name in ("stiffness", "damping", "gyroscopic")
    }
    shapes |= {f"seats.{name}": (motion, (n, 6)) for name, motion in component.seats.items()}
    shapes |= {f"sensors.{name}": (motion, (n,)) for name, motion in component.sensors.items()}
    shapes |= {
        f"ring_motions.{name}": (motion, (n, 2 + 4 * max((np.shape(motion)[-1] - 2) // 4, 1)))
        for name, motion in component.ring_motions.items()
    }
    if component.participation is not None:
        shapes["participation"] = (component.participation, (n, 6))
    findings = []
    for attribute, (array, shape) in shapes.items():
        if np.shape(array) != shape:
            findings.append(Finding(part, attribute, array, f"numbers of shape {shape}, for {n} coordinates"))
        elif not np.isfinite(np.asarray(array)).all():
            findings.append(Finding(part, attribute, array, "finite numbers"))
    for name in component.seats:
        z = component.seat_z.get(name, math.nan)
        if not math.isfinite(z):
            findings.append(Finding(part, f"seat_z.{name}", z, "a finite number m, the z of the seat's centre"))
    yield from findings
    if findings:
        return
    for attribute in ("stiffness", "damping"):
        matrix = getattr(component, attribute)
        scale = float(np.abs(matrix).max(initial=0.0))
        if np.abs(matrix - matrix.T).max(initial=0.0) > _DAMPING_MATRIX_ROUNDING * scale:
            yield Finding(part, attribute, matrix, "a symmetric matrix")
        elif n and (least := float(np.linalg.eigvalsh(matrix)[0])) < -_DAMPING_MATRIX_ROUNDING * n * scale:
            expected = f"a matrix without negative eigenvalues, as of any housing; the least one is {least:.4g}"
            yield Finding(part, attribute, matrix, expected)
    skew = component.gyroscopic
    if np.abs(skew + skew.T).max(initial=0.0) > _DAMPING_MATRIX_ROUNDING * np.abs(skew).max(initial=0.0):
        yield Finding(part, "gyroscopic", skew, "a skew matrix")


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
    sensor_places: Mapping[str, SensorPlace] | None = None,
    seat_reach: Mapping[str, float] | None = None,
    ring_motions: Mapping[str, FloatArray] | None = None,
) -> HousingComponent:
    """Assemble the housing from its modes and attachments: K = diag(ω²), C = diag(2 ζ ω) + Φᵀ C Φ.

    Parameters
    ----------
    modes : ModeSet
        Modes: m of them and, where there are attachments, k further ones: n = m + k coordinates.
    damping_ratios : ndarray, shape (m,)
        Damping ratios. Attachments take the highest of them.
    seats, seat_z, sensors, participation, seat_axes, sensor_places, seat_reach, ring_motions
        See :class:`HousingComponent`; by :meth:`gearwhine.housing.ModeSet.project_all`.
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
        name="housing",
        kinds=("housing",) * m + ("residual",) * (n - m),
        stiffness=np.diag(omega**2),
        damping=damping,
        gyroscopic=np.zeros((n, n)),
        seats=seats,
        seat_z=seat_z,
        sensors=sensors,
        participation=participation,
        seat_axes=seat_axes or {},
        sensor_places=sensor_places or {},
        complete_below=modes.certificate.limit,
        seat_reach=seat_reach or {},
        ring_motions=ring_motions or {},
    )


def component_of_housing(modes: HousingModes, *, participates: bool, with_coarser: bool = True) -> HousingComponent:
    """Make the housing's component from its natural modes.

    Parameters
    ----------
    modes : HousingModes
        See :meth:`gearwhine.housing.Housing.modes`.
    participates : bool
        Whether the base moves or there is weight, for which the housing's mass matrix is assembled.
    with_coarser : bool
        Whether it has the coarser one, with a response less of residual modes.
    """
    participation = modes.participation if participates else None
    coarser = None
    if with_coarser and modes.with_a_response_less is not None:
        fewer, transformation = modes.with_a_response_less
        moved = None if participation is None else transformation.T @ participation
        coarser = _component_of_modes(fewer, moved)
    return replace(
        _component_of_modes(modes, participation),
        coarser=coarser,
        warnings=tuple(modes.result_warnings),
        displacement_field=modes.displacement_field,
        mass=modes.mass,
    )


def _component_of_modes(modes: HousingModes, participation: FloatArray | None) -> HousingComponent:
    seats = {seat.name: seat.center for seat in modes.housing.seats}
    return housing_component(
        modes.modes,
        modes.damping_ratios,
        seats=modes.seat_motions,
        seat_z={seat: center[2] for seat, center in seats.items()},
        seat_axes={seat: center[:2] for seat, center in seats.items()},
        seat_reach={seat.name: seat.reach for seat in modes.housing.seats if seat.reach is not None},
        sensors=modes.sensor_motions,
        sensor_places={name: SensorPlace(port.position, port.direction) for name, port in modes.sensors.items()},
        damping_matrix=modes.damping_matrix,
        participation=participation,
        ring_motions=modes.ring_motions,
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


@dataclass(frozen=True, eq=False)
class PinComponent(Component):
    """Pin of a planet: motions of its coordinates times the root of an inertia so small that they respond statically.

    Attributes
    ----------
    mounted : MountedPin
    """

    mounted: MountedPin

    def motions(self, z: float) -> FloatArray:
        """Motion x, y, z and rotations about x and y of the seat of a bearing, (5, n)."""
        return np.asarray(self.mounted.motions(z) / self.mounted.scale)


def pin_component(planet: str, mounted: MountedPin) -> PinComponent:
    """Make the component of a planet's pin; what holds it are the walls of its carrier."""
    kinds, zero = ("residual",) * mounted.size, np.zeros((mounted.size, mounted.size))
    return PinComponent(pin_name(planet), kinds, zero, zero, zero, mounted)


def pin_name(planet: str) -> str:
    """Name of a planet's pin among components and connectors."""
    return f"pin of {planet}"


def _check_damping(matrix: FloatArray, n: int) -> None:
    """Refuse a damping matrix of another order, or one that is not symmetric and free of gain."""
    if matrix.shape != (n, n):
        raise CouplingError(f"damping matrix of shape {matrix.shape} for {n} housing modes; expected ({n}, {n})")
    scale = float(np.abs(matrix).max(initial=0.0))
    if not np.isfinite(scale) or np.abs(matrix - matrix.T).max(initial=0.0) > _DAMPING_MATRIX_ROUNDING * scale:
        raise CouplingError("the damping matrix of the housing modes is not symmetric, or not finite")
    if n and np.linalg.eigvalsh(matrix)[0] < -_DAMPING_MATRIX_ROUNDING * n * scale:
        raise CouplingError("the damping matrix of the housing modes has a negative eigenvalue: it feeds energy in")


def rotor_component(
    name: str,
    modal: ModalRotor,
    *,
    start: float,
    damping_ratio: float = 0.0,
    axis: tuple[float, float] = (0.0, 0.0),
    bodies: Sequence[GearBody] = (),
    carrier: str | None = None,
    pin: MountedPin | None = None,
    internal_damping: float = 0.0,
) -> RotorComponent:
    """Project a rotor onto its modes, without the averaged springs of its planar basis.

    The planar modes are those at averaged support stiffness k̄ (TM-101442 Eq. 7). The springs come back with the
    bearings' connectors, so they are taken out here, K = diag(ω²) - Σ k̄ φ(z_b) φ(z_b)ᵀ in each plane (the
    *compensation* of TM-104434 Eqs. 11 to 15), and the same span is taken in the free shaft's own coordinates: its
    shift, its tilt, and the bending beside them that diagonalises K. The shaft's damping acts on bending and twisting,
    not on a motion of the shaft as a whole. The gyroscopic coupling of the planes is +G in the x rows and -G in the y
    rows, G_ij = ∫ φ'_i dI_p φ'_j, so that C + ΩG gives the terms G_v of Eqs. 1 and 2.

    The rims of gears move on their hubs by φ, as coordinates beside those of the shaft's modes q. With the modes'
    motions τ of the hubs, their stiffness K, and the springs k and inertias S and J_r of the rims
    (:mod:`gearwhine.coupling.gears.stiffness.rim_on_hub`), whose whole inertia the modes of the shaft contain,

        [I, τᵀ S; S τ, J_r] [q''; φ''] + [K, 0; 0, k] [q; φ] = f.

    The component's coordinates are the natural modes of this: in torsion, the rigid rotation of all first, and alike in
    both planes, after shift and tilt of all as one body. The shaft's damping ratio is theirs. Modes of
    gear bodies without and with one nodal diameter join the motion along the axis and the tilts in the same way, with
    1, Γ and ω² in place of J_r, S and k, and with their part in the gyroscopic moment; those with more, which no motion
    of the hub excites, stand by themselves. Of a shaft with rims the coordinates above its own highest mode, and above
    the limit of the bodies, are of the kind ``residual``, as attachment modes of the housing are: hubs
    between shaft and rims vibrate there, and no step in time is refined for them.

    An axial force P, in tension, resists the tilt by ∫ P dz per unit angle, and couples it with bending. A compressed
    shaft's tilt has negative stiffness: what holds the shaft is its bearings.

    Parameters
    ----------
    name : str
    modal : ModalRotor
        m planar, t torsional and a axial modes, vectors included. With s shifts and tilting modes, g rotations, u
        umbrella modes, and p modes with more nodal diameters, the component has 2 (m + s) + t + g + a + u + 2 p
        coordinates.
    start : float
        z of the rotor's left end [m].
    damping_ratio : float
        Damping ratio of the shaft's own material and fits, on every mode of the free shaft but its shift and tilt.
    axis : tuple of float
        x and y of the shaft's line [m], which matter where the base turns.
    bodies : sequence of GearBody
        Gears on the rotor whose rims move on their hubs.
    carrier : str, optional
        Rotor with which the shaft's axis turns.
    pin : MountedPin, optional
        Elastic pin of a planet in its carrier.
    internal_damping : float
        Viscous damping over stiffness of the shaft's material, C = η K, in the rotating shaft [s].
    """
    lateral = modal.lateral
    twisting, torsion_basis = _torsion_with_rims(modal, bodies)
    along, axial_basis = _axial_with_rims(modal, bodies)
    plane_basis, plane_stiffness, bending = _free_plane(lateral, bodies)
    pairs = [mode for body in bodies for mode in body.plates if mode.nodal_diameters > 1]
    plates = np.repeat([mode.frequency for mode in pairs], 2)
    size = len(plane_basis)
    n = 2 * size + len(twisting) + len(along) + len(plates)
    stiffness = np.diag(np.concatenate([np.zeros(2 * size), twisting**2, along**2, plates**2]))
    stiffness[:size, :size] = stiffness[size : 2 * size, size : 2 * size] = plane_stiffness
    # Zeros for motions as a whole: they strain no material, though an axial force may resist the tilt or drive it.
    damped = np.concatenate([bending, bending, twisting, along, plates])
    gyroscopic = np.zeros((n, n))
    gyroscopic[: 2 * size, : 2 * size] = gyroscopic_matrix(_plane_spin(lateral, bodies, plane_basis))
    # Modes of the shaft are certified up to these; what lies above is static, hubs between shaft and rims among it.
    limit = max((body.limit for body in bodies), default=0.0)
    own, own_bending = (
        max(float(modes.frequencies[: modes.certificate.found].max(initial=0.0)), limit) if bodies else np.inf
        for modes in (modal.torsional, lateral)
    )
    plane_kinds = _kinds("rotor", bending, own_bending)
    axial_kinds = ("axial",) * len(along) if modal.axial is None else _axial_kinds(along, modal.axial, limit)
    return RotorComponent(
        name=name,
        kinds=(
            *plane_kinds,
            *plane_kinds,
            *_kinds("torsion", twisting, own),
            *axial_kinds,
            *_kinds("body", plates, limit),
        ),
        stiffness=stiffness,
        damping=np.diag(2.0 * damping_ratio * damped),
        gyroscopic=gyroscopic,
        modal=modal,
        start=start,
        plane_basis=plane_basis,
        torsion_basis=torsion_basis,
        axial_basis=axial_basis,
        axis=axis,
        bodies=tuple(bodies),
        damping_ratio=damping_ratio,
        carrier=carrier,
        pin=pin,
        internal_damping=internal_damping * np.concatenate([damped[: n - len(plates)], 0.0 * plates]) ** 2,
    )


_HIGHEST_SHAFT_FREQUENCY_RATIO = (
    1.0 + 1e-9
)  # by which a frequency may exceed the highest of the shaft and be one of its own


def _kinds(kind: str, frequencies: FloatArray, highest: float) -> tuple[str, ...]:
    """Kinds of coordinates by their frequencies: above the highest mode of the shaft they are residual."""
    return tuple(
        kind if one <= _HIGHEST_SHAFT_FREQUENCY_RATIO * highest else "residual" for one in frequencies.tolist()
    )


def _torsion_with_rims(modal: ModalRotor, bodies: Sequence[GearBody]) -> tuple[FloatArray, FloatArray]:
    """Natural frequencies (t + g,) [rad/s] and modes (t + g, t + g) of the shaft's torsion with rims on their hubs."""
    t, frequencies = modal.torsional.count, modal.torsional.frequencies
    rims = [(body.at, body.twist) for body in bodies if body.twist is not None]
    if not rims:
        return frequencies, np.eye(t)
    basis, stiffness = _with_rims(np.diag(frequencies**2), modal.torsional.evaluate([at for at, _ in rims]), rims)
    # The first coordinate is the rotation of all as one body.
    values, vectors = np.linalg.eigh(stiffness[1:, 1:])
    basis[:, 1:] = basis[:, 1:] @ vectors
    return np.concatenate([frequencies[:1], np.sqrt(values)]), basis


def _axial_with_rims(modal: ModalRotor, bodies: Sequence[GearBody]) -> tuple[FloatArray, FloatArray]:
    """Natural frequencies (a + u,) [rad/s] and modes (a + u, a + u) of the shaft along its axis with rims on hubs."""
    if modal.axial is None:
        return np.zeros(0), np.zeros((0, 0))
    frequencies = modal.axial.frequencies
    rims = _plates_as_springs(bodies, 0)
    if not rims:
        return frequencies, np.eye(frequencies.size)
    basis, stiffness = _with_rims(np.diag(frequencies**2), modal.axial.evaluate([at for at, _ in rims]), rims)
    # The first coordinate is the motion of all as one body.
    values, vectors = np.linalg.eigh(stiffness[1:, 1:])
    basis[:, 1:] = basis[:, 1:] @ vectors
    return np.concatenate([frequencies[:1], np.sqrt(values)]), basis


def _plates_as_springs(bodies: Sequence[GearBody], nodal_diameters: int) -> list[tuple[float, RimSpring]]:
    """Stations and springs of the bodies' modes with a number of nodal diameters; their modal mass is 1."""
    return [
        (body.at, RimSpring(mode.frequency**2, mode.coupling, 1.0))
        for body in bodies
        for mode in body.plates_with(nodal_diameters)
    ]


def _axial_kinds(frequencies: FloatArray, axial: AxialModes, limit: float) -> tuple[str, ...]:
    """Kinds of the axial coordinates; of a shaft without axial rims all are axial."""
    highest = max(float(axial.frequencies.max(initial=0.0)), limit)
    return _kinds("axial", frequencies, np.inf if frequencies.size == axial.count else highest)


def _plane_spin(lateral: LateralModes, bodies: Sequence[GearBody], basis: FloatArray) -> FloatArray:
    """Polar inertia over a plane's coordinates (m + s, m + s): of the shaft, and of tilting modes of gear bodies."""
    m, tilts = lateral.count, [(body.at, mode) for body in bodies for mode in body.plates_with(1)]
    if not tilts:
        return np.asarray(basis[:m].T @ lateral.polar_inertia_matrix @ basis[:m])
    spin = np.zeros((len(basis), len(basis)))
    first = len(basis) - len(tilts)
    spin[:m, :m] = lateral.polar_inertia_matrix
    slopes = lateral.evaluate([at for at, _ in tilts])[1]
    spin[:m, first:] = slopes * [mode.coupling_spin for _, mode in tilts]
    spin[first:, :m] = spin[:m, first:].T
    spin[first:, first:] = np.diag([2.0 * mode.rotation for _, mode in tilts])
    return np.asarray(basis.T @ spin @ basis)


def _with_rims(
    stiffness: FloatArray, hubs: FloatArray, rims: Sequence[tuple[float, RimSpring]]
) -> tuple[FloatArray, FloatArray]:
    """Join rims on hubs to mass-normalised coordinates q of a shaft, as mass-normalised coordinates p.

    With q + τ S φ = p₁ and Lᵀ φ = p₂, L Lᵀ = J_r - S τᵀ τ S, the inertia is the identity, and motions of all as one
    body, in which φ = 0, are the same in q and in p₁.

    Parameters
    ----------
    stiffness : ndarray, shape (m, m)
        K of the shaft [1/s²].
    hubs : ndarray, shape (m, g)
        Motion τ of the hubs by the coordinates.
    rims : sequence of (float, RimSpring)
        Stations and springs of the g rims.

    Returns
    -------
    basis, stiffness : ndarray, shape (m + g, m + g)
        The coordinates q and the rims' motions φ in terms of p, and K in terms of p.
    """
    m, springs = len(stiffness), [spring for _, spring in rims]
    carried = hubs * [spring.coupling_inertia for spring in springs]
    factor = np.linalg.cholesky(np.diag([spring.rim_inertia for spring in springs]) - carried.T @ carried)
    rim = np.linalg.inv(factor).T
    basis = np.block([[np.eye(m), -carried @ rim], [np.zeros((len(springs), m)), rim]])
    whole = linalg.block_diag(stiffness, np.diag([spring.stiffness for spring in springs]))
    return basis, basis.T @ whole @ basis


def _free_plane(lateral: LateralModes, bodies: Sequence[GearBody]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Basis of a plane's free shaft with rims (m + s, m + s), stiffness there [1/s²], bending frequencies [rad/s].

    The frequencies are zero for the motions of the shaft as a whole, the first columns of the basis. These are
    known, and so is it that nothing resists them: among the eigenvalues of the stiffness their zeros cannot be told
    from soft bending, since their rounding error is that of the stiffest attachment mode.
    """
    whole, free = lateral.rigid_motions, lateral.free_stiffness
    count, unresisted = whole.shape[1], lateral.unresisted_motions
    shifts = [(body.at, body.shift) for body in bodies if body.shift is not None]
    tilts = _plates_as_springs(bodies, 1)
    rims = [*shifts, *tilts]
    joined = np.eye(lateral.count)
    if rims:
        hubs = [lateral.evaluate([at for at, _ in some])[row] for row, some in enumerate((shifts, tilts)) if some]
        joined, free = _with_rims(free, np.hstack(hubs), rims)
        whole = np.vstack([whole, np.zeros((len(rims), count))])
    beside = np.linalg.qr(whole, mode="complete")[0][:, count:]
    values, vectors = np.linalg.eigh(beside.T @ free @ beside)
    basis = np.hstack([whole, beside @ vectors])
    resisted = basis.T @ free @ whole
    resisted[:, :unresisted] = resisted[:unresisted] = 0.0
    stiffness = np.diag(np.concatenate([np.zeros(count), values]))
    stiffness[:, :count], stiffness[:count] = resisted, resisted.T
    return joined @ basis, stiffness, np.concatenate([np.zeros(count), np.sqrt(np.maximum(values, 0.0))])
