"""Loads on a machine: unbalance, shaft bow, forces, torques, base excitation and gravity, as loads on the coordinates.

Loads act on parts by name. Base excitation and gravity are inertia loads on coordinates that are relative to a moving
base.

With u = q + R s, R the six rigid motions of the base about a point, the coordinates are loaded by -P a, where P = ∫ φ R
dm is their participation and a the acceleration, three components along and three about x, y and z. Rotations of the
base are small: terms quadratic in them, and Coriolis forces on the vibration, are neglected. The gyroscopic moment of a
shaft that rotates at Ω on a base that tilts at the speeds ω_x and ω_y is kept: Ω ∫ β dI_p ω_x on the x plane and Ω ∫ β
dI_p ω_y on the y plane, at the nominal speed. Gravity loads the same masses, by P g.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from coupling.machine.components import Component, HousingComponent, PedestalComponent, RotorComponent
from coupling.machine.connectors import LinearConnector, SpeedTable
from coupling.machine.coupled_system import HarmonicLoad, TimedLoad, embed

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

Point = tuple[float, float, float]
_VELOCITY_PIECES = 16  # number of chords that replace the velocity's parabola between two accelerations


@dataclass(frozen=True)
class Unbalance:
    """Mass times eccentricity [kg m] at a distance from the rotor's left end [m], ahead of x by a phase [rad]."""

    rotor: str
    at: float
    moment: float
    phase: float


@dataclass(frozen=True)
class BowReactions:
    """Shaft bow as forces on the straight shaft that rotate with it, see :func:`rotors.analyses.unbalance.bow_shape`.

    Attributes
    ----------
    at : ndarray, shape (k,)
        Stations from the rotor's left end [m].
    forces : ndarray of complex, shape (k,)
        Forces along x and, as the imaginary part, along y with the shaft at its angle of t = 0 [N].
    """

    rotor: str
    at: FloatArray
    forces: npt.NDArray[np.complex128]


@dataclass(frozen=True)
class ShaftForce:
    """A constant force along x, y, z [N] on a rotor at a distance from its left end [m], such as the pull of a belt."""

    rotor: str
    at: float
    force: tuple[float, float, float]


@dataclass(frozen=True)
class Torque:
    """A constant torque about z [N m] on a rotor at a distance from its left end [m]."""

    rotor: str
    at: float
    value: float


@dataclass(frozen=True)
class TorqueHistory:
    """A torque about z over time, linear between the times [s] and constant beyond them; values in N m, shape (l,)."""

    rotor: str
    at: float
    times: FloatArray
    values: FloatArray


@dataclass(frozen=True)
class TorqueRipple:
    """A harmonic torque about z, amplitude cos(w t + phase) [N m].

    Attributes
    ----------
    order : float or None
        Frequency w over the speed of the rotor: the frequency follows the speed.
    frequency : float or None
        Frequency w independent of the speed [rad/s]; either this or the order is given.
    """

    rotor: str
    at: float
    amplitude: float
    phase: float = 0.0
    order: float | None = None
    frequency: float | None = None

    def __post_init__(self) -> None:
        """Require either an order or a frequency."""
        if (self.order is None) == (self.frequency is None):
            raise CouplingError(
                f"a torque ripple on {self.rotor!r} of order {self.order} and frequency {self.frequency}; "
                "expected one of the two"
            )


@dataclass(frozen=True)
class TorqueSlope:
    """Slope of a torque about z over the speed of its rotor, about the nominal speed [N m s].

    Attributes
    ----------
    speed_ratios : ndarray, shape (t,)
        Speeds as parts of the nominal one, ascending.
    slopes : ndarray, shape (t,)
        Slopes dT/dω at these speeds: negative for most motors, whose torque damps departures from the nominal speed.
    """

    name: str
    rotor: str
    at: float
    speed_ratios: FloatArray
    slopes: FloatArray

    def at_speed_ratio(self, ratio: float) -> "TorqueSlope":
        """Return the slope over speed, relative to ``ratio`` times the nominal speed."""
        if ratio == 0.0:
            # At a nominal speed of 0 there are no speed ratios: the slope is that at standstill.
            at_rest = np.interp(0.0, self.speed_ratios, self.slopes)
            return replace(self, speed_ratios=np.ones(1), slopes=np.array([at_rest]))
        return replace(self, speed_ratios=self.speed_ratios / abs(ratio))


AnyTorque = Torque | TorqueHistory | TorqueRipple | TorqueSlope


def largest_torques(torques: "Sequence[AnyTorque]") -> dict[str, float]:
    """Largest sum over time of the torques on each rotor [N m], with its sign; ripples and slopes do not count."""
    constant: dict[str, float] = {}
    histories: dict[str, list[TorqueHistory]] = {}
    for torque in torques:
        match torque:
            case Torque():
                constant[torque.rotor] = constant.get(torque.rotor, 0.0) + torque.value
            case TorqueHistory():
                histories.setdefault(torque.rotor, []).append(torque)
    largest = dict(constant)
    for rotor, given in histories.items():
        times = np.unique(np.concatenate([history.times for history in given]))
        total = constant.get(rotor, 0.0) + sum(np.interp(times, history.times, history.values) for history in given)
        largest[rotor] = float(total[np.abs(total).argmax()])
    return largest


@dataclass(frozen=True)
class Drive:
    """Station of the torque that accelerates a train: a rotor, and the distance from its left end [m]."""

    rotor: str
    at: float


@dataclass(frozen=True)
class MachineLoads:
    """Loads on the parts of a machine.

    Attributes
    ----------
    unbalances : sequence of Unbalance
    bows : sequence of BowReactions
    torques : sequence of AnyTorque
    drives : sequence of Drive
        Stations of the torques that accelerate a train, see :meth:`MachineCoordinates.acceleration_load`.
    base : BaseMotion, optional
        Motion of the ground under bearings, pedestals and the housing's supports.
    gravity : sequence of float, optional
        Acceleration of free fall along x, y, z [m/s²].
    forces : sequence of ShaftForce
    """

    unbalances: Sequence[Unbalance] = ()
    bows: Sequence[BowReactions] = ()
    torques: Sequence[AnyTorque] = ()
    drives: Sequence[Drive] = ()
    base: "BaseMotion | None" = None
    gravity: Sequence[float] | None = None
    forces: Sequence[ShaftForce] = ()

    def at_speed_ratio(self, ratio: float) -> "MachineLoads":
        """Return the same loads on the machine at ``ratio`` times its nominal speeds."""
        torques = [
            torque.at_speed_ratio(ratio) if isinstance(torque, TorqueSlope) else torque for torque in self.torques
        ]
        return replace(self, torques=tuple(torques))


UNLOADED = MachineLoads()


@dataclass
class CoordinateLoads:
    """Loads on the n coordinates, collected while the machine is assembled.

    Attributes
    ----------
    constant : ndarray, shape (n,)
    harmonic : list of HarmonicLoad
    timed : list of TimedLoad
    dashpots : list of LinearConnector
    """

    constant: FloatArray
    harmonic: list[HarmonicLoad] = field(default_factory=list)
    timed: list[TimedLoad] = field(default_factory=list)
    dashpots: list[LinearConnector] = field(default_factory=list)


class MachineCoordinates:
    """The n coordinates of a machine's components: rows of the motion of places on them, and loads on those places.

    Attributes
    ----------
    components : sequence of Component
    speeds : mapping of str to float
        Signed speed of each rotor [rad/s].
    size : int
        Number of coordinates, n.
    """

    def __init__(self, components: Sequence[Component], speeds: Mapping[str, float]) -> None:
        self.components, self.speeds = components, speeds
        self.size = sum(component.size for component in components)
        self._numbers = {part.name: i for i, part in enumerate(components)}

    def rotor(self, name: str) -> RotorComponent:
        """Return the rotor of this name."""
        part = self.components[self._numbers[name]] if name in self._numbers else None
        if not isinstance(part, RotorComponent):
            names = sorted(part.name for part in self.components if isinstance(part, RotorComponent))
            raise CouplingError(f"no rotor is named {name!r}; there are: {', '.join(names)}")
        return part

    def rows(self, name: str, rows: FloatArray) -> FloatArray:
        """Rows over the coordinates of one component, shape (..., m), as rows over all of them, shape (..., n)."""
        return embed(self.components, self._numbers[name], rows)

    def rigid_rotation(self, name: str) -> FloatArray:
        """Coordinates of a rotation of a whole rotor by one radian, shape (n,)."""
        return self.rows(name, self.rotor(name).turning)

    def rotation(self, name: str, at: float) -> FloatArray:
        """Rotation about z of a station of a rotor, shape (n,)."""
        return self.rows(name, self.rotor(name).rotation(at))

    def rotating_force(self, name: str, at: float) -> npt.NDArray[np.complex128]:
        """Amplitude of a force of 1 N that rotates counter-clockwise, (cos, sin) on x and y, shape (n,)."""
        x, y = self.rows(name, self.rotor(name).motions(at)[:2])
        return np.asarray(x - 1j * y)

    def add_unbalance(self, loads: CoordinateLoads, unbalance: Unbalance) -> None:
        """Add an unbalance m e Ω² (cos, sin)(Ω t + phase): y lags x by a quarter turn, in the sense of rotation."""
        speed = self.speeds[unbalance.rotor]
        rotating = self.rotating_force(unbalance.rotor, unbalance.at)
        if speed == 0.0 or unbalance.moment == 0.0:
            return
        force = unbalance.moment * speed**2 * np.exp(1j * unbalance.phase)
        loads.harmonic.append(HarmonicLoad(speed, force * rotating, follows="unbalance"))

    def add_bow(self, loads: CoordinateLoads, bow: BowReactions) -> None:
        """Add K b e^{iΩs} of a bow b: the shaft resists its motion u relative to the bow by K (u - b e^{iΩs})."""
        force = np.zeros_like(loads.constant, dtype=np.complex128)
        for at, value in zip(bow.at.tolist(), bow.forces, strict=True):
            force = force + value * self.rotating_force(bow.rotor, at)
        loads.harmonic.append(HarmonicLoad(self.speeds[bow.rotor], force, follows="turning"))

    def add_force(self, loads: CoordinateLoads, force: ShaftForce) -> None:
        """Add a constant force on a section of a rotor.

        Raises
        ------
        CouplingError
            Where the force has a part along z and nothing holds the rotor along its axis.
        """
        rotor = self.rotor(force.rotor)
        if force.force[2] != 0.0 and rotor.modal.axial is None:
            raise CouplingError(
                f"a force of {force.force[2]:.4g} N along z on rotor {force.rotor!r}, which no bearing holds along its "
                "axis; expected a bearing with axial stiffness, or a force across the axis"
            )
        loads.constant += np.array(force.force) @ self.rows(force.rotor, rotor.motions(force.at)[:3])

    def add_torque(self, loads: CoordinateLoads, torque: AnyTorque) -> None:
        """Add a torque: constant, tabled over time, harmonic, or a slope over the speed."""
        row = self.rotation(torque.rotor, torque.at)
        match torque:
            case Torque():
                loads.constant += torque.value * row
            case TorqueHistory():
                loads.timed.append(TimedLoad(torque.times, torque.values, row))
            case TorqueRipple():
                amplitude = torque.amplitude * np.exp(1j * torque.phase) * row
                if torque.frequency is not None:
                    loads.harmonic.append(HarmonicLoad(torque.frequency, amplitude))
                    return
                assert torque.order is not None
                frequency = torque.order * abs(self.speeds[torque.rotor])
                loads.harmonic.append(HarmonicLoad(frequency, amplitude, follows="turning"))
            case TorqueSlope():
                loads.dashpots.append(_dashpot(torque, row))

    def acceleration_load(self, pairs: Sequence[tuple[str, str]], drives: Sequence[Drive]) -> FloatArray:
        """Load of an angular acceleration s'' = 1/s, at which each rotor gains its own speed in a second, shape (n,).

        The coordinates turn relative to the nominal rotation, so each shaft's inertia holds it back by -∫ Ω s'' dI_p,
        which its modes feel as -Ω s'' times the coordinates of a rotation of the whole. For rotors that gears connect,
        of inertia J and speed Ω, the drive adds (Σ J Ω²) s'' / Ω_drive, so that the train as a whole follows the
        nominal rotation, and no load is left on it.

        Parameters
        ----------
        pairs : sequence of two names
            Rotors that gears connect.
        drives : sequence of Drive
            Drives, at most one for each train; a train without a drive is driven at the left end of its first rotor.
        """
        total = np.zeros(self.size)
        rotors = [part.name for part in self.components if isinstance(part, RotorComponent)]
        for train in trains(rotors, pairs):
            driving = [drive for drive in drives if drive.rotor in train] or [Drive(train[0], 0.0)]
            if len(driving) > 1:
                raise CouplingError(
                    f"rotors {[one.rotor for one in driving]} of one train are said to drive it; expected one"
                )
            for name in train:
                total -= self.speeds[name] * self.rigid_rotation(name)
            power = sum(self.speeds[name] ** 2 * float(np.sum(self.rigid_rotation(name) ** 2)) for name in train)
            if power:
                total += power / self.speeds[driving[0].rotor] * self.rotation(driving[0].rotor, driving[0].at)
        return total


def _dashpot(slope: TorqueSlope, row: FloatArray) -> LinearConnector:
    """Replace a torque's slope over speed by a dashpot of minus the slope."""
    damping = -slope.slopes.reshape(-1, 1, 1)
    none = np.zeros_like(damping)
    table = SpeedTable(slope.speed_ratios, none, damping) if np.ptp(slope.slopes) > 0.0 else None
    middle = none[0], damping[0]
    if table is not None:
        middle = table.at(1.0)
    return LinearConnector(slope.name, row[:, None], *middle, over_speed=table)


def trains(names: Sequence[str], pairs: Sequence[tuple[str, str]]) -> list[list[str]]:
    """Gear trains: rotors that gear pairs connect, in order; a rotor without a pair is a train by itself."""
    groups = [[name] for name in names]
    for first, second in pairs:
        first_group, second_group = (next(train for train in groups if name in train) for name in (first, second))
        if first_group is not second_group:
            groups.remove(second_group)
            first_group += second_group
    return [sorted(train, key=list(names).index) for train in groups]


@dataclass(frozen=True)
class BaseHarmonic:
    """Re(amplitude e^{iwt}), w in rad/s, amplitude (6,) in m/s² and rad/s²."""

    frequency: float
    amplitude: ComplexArray


@dataclass(frozen=True)
class BaseHistory:
    """Accelerations (l, 6) in m/s² and rad/s², linear between times (l,) in s and constant beyond them."""

    times: FloatArray
    values: FloatArray

    def __post_init__(self) -> None:
        """Require six accelerations for each time, and times that ascend."""
        if self.values.shape != (len(self.times), 6) or not len(self.times) or np.any(np.diff(self.times) <= 0.0):
            raise CouplingError(
                f"a base's accelerations of shape {self.values.shape} at {len(self.times)} times; expected six for "
                "each, and times that ascend"
            )


@dataclass(frozen=True)
class BaseMotion:
    """Motion of the base: acceleration of a point of it [m], and angular acceleration about axes through this point.

    Attributes
    ----------
    parts : tuple
        Parts of the motion, whose accelerations add up.
    point : tuple of float
    """

    parts: tuple[BaseHarmonic | BaseHistory, ...]
    point: Point = (0.0, 0.0, 0.0)

    def acceleration(self, times: FloatArray) -> FloatArray:
        """Acceleration of the base at some times [m/s², rad/s²], shape (s, 6)."""
        total = np.zeros((len(times), 6))
        for part in self.parts:
            if isinstance(part, BaseHarmonic):
                total += (np.exp(1j * part.frequency * times)[:, None] * part.amplitude).real
            else:
                total += np.column_stack([np.interp(times, part.times, column) for column in part.values.T])
        return total

    def acceleration_at(self, position: FloatArray, direction: FloatArray, times: FloatArray) -> FloatArray:
        """Acceleration along a direction at a place that moves with the base [m/s²], shape (s,)."""
        moment = np.cross(np.subtract(position, self.point), direction)
        return np.asarray(self.acceleration(times) @ np.concatenate([direction, moment]))


def base_loads(
    components: Sequence[Component], speeds: Sequence[float], base: BaseMotion, places: dict[str, Point]
) -> tuple[list[HarmonicLoad], list[TimedLoad]]:
    """Inertia loads of a moving base; ``places`` are the positions of the pedestals [m]."""
    carried = participations(components, base.point, places)
    tilting = _gyroscopic(components, speeds)
    harmonic: list[HarmonicLoad] = []
    timed: list[TimedLoad] = []
    for part in base.parts:
        if isinstance(part, BaseHarmonic):
            velocity = part.amplitude / (1j * part.frequency)
            harmonic.append(HarmonicLoad(part.frequency, tilting @ velocity - carried @ part.amplitude))
            continue
        moved = np.flatnonzero(np.any(part.values != 0.0, axis=0))
        timed += [TimedLoad(part.times, part.values[:, k], -carried[:, k]) for k in moved]
        times, velocities = _velocities(part)
        timed += [TimedLoad(times, velocities[:, k], tilting[:, k]) for k in moved if np.any(tilting[:, k])]
    return harmonic, timed


def gravity_load(components: Sequence[Component], gravity: Sequence[float], places: dict[str, Point]) -> FloatArray:
    """Weight under an acceleration along x, y, z [m/s²], shape (n,)."""
    return participations(components, (0.0, 0.0, 0.0), places)[:, :3] @ np.array(gravity, dtype=np.float64)


def participations(components: Sequence[Component], point: Point, places: dict[str, Point]) -> FloatArray:
    """Participation P of all coordinates in rigid motions of a base about a point [√kg, √kg m], shape (n, 6).

    Raises
    ------
    CouplingError
        Where a component has no participation.
    """
    rows = []
    for component in components:
        if isinstance(component, RotorComponent):
            rows.append(_of_rotor(component, point))
        elif isinstance(component, HousingComponent):
            if component.participation is None:
                raise CouplingError(f"{component.name}: expected its participation in the motions of its base")
            rows.append(_about(component.participation, point))
        elif isinstance(component, PedestalComponent):
            whole = np.zeros((2, 6))
            whole[:, :2] = np.linalg.inv(component.motion)
            x, y, z = np.subtract(places[component.name], point)
            whole[:, 3:] = whole[:, :2] @ np.array([[0.0, z, -y], [-z, 0.0, x]])
            rows.append(whole)
    return np.vstack(rows)


def _about(participation: FloatArray, point: Point) -> FloatArray:
    """Participation about a point from that about the origin."""
    x, y, z = point
    # α × (r - p) = α × r + p × α.
    moved = participation.copy()
    moved[:, 3:] += participation[:, :3] @ np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return moved


def _of_rotor(rotor: RotorComponent, point: Point) -> FloatArray:
    participation = rotor.modal.participation
    if participation is None:
        raise CouplingError(f"{rotor.name}: expected its participation in the motions of its base")
    m, (x, y) = rotor.modal.lateral.count, np.subtract(rotor.axis, point[:2])
    shift, tilt = rotor.plane_basis.T @ participation.displacement, rotor.plane_basis.T @ participation.tilt
    tilt = tilt + (rotor.start - point[2]) * shift
    whole = np.zeros((rotor.size, 6))
    whole[:m, 0], whole[:m, 4], whole[:m, 5] = shift, tilt, -y * shift
    whole[m : 2 * m, 1], whole[m : 2 * m, 3], whole[m : 2 * m, 5] = shift, -tilt, x * shift
    whole[:, 5] += rotor.turning
    along = slice(rotor.size - len(participation.axial), rotor.size)
    axial = participation.axial
    whole[along, 2], whole[along, 3], whole[along, 4] = axial, y * axial, -x * axial
    return whole


def _gyroscopic(components: Sequence[Component], speeds: Sequence[float]) -> FloatArray:
    """Gyroscopic load of a base that turns at 1 rad/s about each axis, in the rotations' columns, shape (n, 6)."""
    rows = []
    for component, speed in zip(components, speeds, strict=True):
        whole = np.zeros((component.size, 6))
        if isinstance(component, RotorComponent) and component.modal.participation is not None:
            m = component.modal.lateral.count
            moment = speed * component.plane_basis.T @ component.modal.participation.spin
            whole[:m, 3], whole[m : 2 * m, 4] = moment, moment
        rows.append(whole)
    return np.vstack(rows)


def _velocities(part: BaseHistory) -> tuple[FloatArray, FloatArray]:
    """Velocities from a table of accelerations, at rest at its first time."""
    gaps = np.arange(_VELOCITY_PIECES) / _VELOCITY_PIECES
    times = np.append((part.times[:-1, None] + np.diff(part.times)[:, None] * gaps).ravel(), part.times[-1])
    values = np.column_stack([np.interp(times, part.times, column) for column in part.values.T])
    gained = 0.5 * (values[1:] + values[:-1]) * np.diff(times)[:, None]
    return times, np.vstack([np.zeros(6), np.cumsum(gained, axis=0)])
