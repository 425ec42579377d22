"""Loads on a machine: unbalance, shaft bow, torques; on its parts by name, and on the coordinates."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from coupling.component import Component, RotorComponent
from coupling.connector import LinearConnector, SpeedTable
from coupling.errors import CouplingError
from coupling.system import HarmonicLoad, TimedLoad, embed

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Unbalance:
    """Mass times eccentricity [kg m] at a distance from the rotor's left end [m], ahead of x by a phase [rad]."""

    rotor: str
    at: float
    moment: float
    phase: float


@dataclass(frozen=True)
class BowReactions:
    """Shaft bow as forces on the straight shaft that rotate with it, see :func:`rotors.bow_shape`.

    Attributes
    ----------
    at : ndarray, shape (k,)
        From the rotor's left end [m].
    forces : ndarray of complex, shape (k,)
        Along x and, as the imaginary part, y of the shaft as it stands at t = 0 [N].
    """

    rotor: str
    at: FloatArray
    forces: npt.NDArray[np.complex128]


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
        w over the speed of its rotor: the frequency follows the speed.
    frequency : float or None
        w [rad/s], whatever the speed; one of the two.
    """

    rotor: str
    at: float
    amplitude: float
    phase: float = 0.0
    order: float | None = None
    frequency: float | None = None

    def __post_init__(self) -> None:
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
    rates : ndarray, shape (t,)
        Speeds as parts of the nominal one, ascending.
    slopes : ndarray, shape (t,)
        dT/dω there: negative for most motors, whose torque then damps departures from the nominal speed.
    """

    name: str
    rotor: str
    at: float
    rates: FloatArray
    slopes: FloatArray


AnyTorque = Torque | TorqueHistory | TorqueRipple | TorqueSlope


def constant_torques(torques: "Sequence[AnyTorque]") -> dict[str, float]:
    """Sum of the torques on each rotor [N m]: of tables over time the largest value, without ripples and slopes."""
    total: dict[str, float] = {}
    for torque in torques:
        match torque:
            case Torque():
                value = torque.value
            case TorqueHistory():
                value = float(torque.values[np.abs(torque.values).argmax()])
            case _:
                continue
        total[torque.rotor] = total.get(torque.rotor, 0.0) + value
    return total


@dataclass(frozen=True)
class Drive:
    """Station at which the torque acts that accelerates a train: a rotor, and a distance from its left end [m]."""

    rotor: str
    at: float


@dataclass
class Loads:
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
        n.
    """

    def __init__(self, components: Sequence[Component], speeds: Mapping[str, float]) -> None:
        self.components, self.speeds = components, speeds
        self.size = sum(component.size for component in components)
        self._numbers = {part.name: i for i, part in enumerate(components)}

    def rotor(self, name: str) -> RotorComponent:
        """The rotor of this name."""
        part = self.components[self._numbers[name]] if name in self._numbers else None
        if not isinstance(part, RotorComponent):
            known = sorted(part.name for part in self.components if isinstance(part, RotorComponent))
            raise CouplingError(f"no rotor is named {name!r}; there are: {', '.join(known)}")
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

    def add_unbalance(self, loads: Loads, unbalance: Unbalance) -> None:
        """m e Ω² (cos, sin)(Ω t + phase) on x and y: y lags x by a quarter turn, in the sense of rotation."""
        speed = self.speeds[unbalance.rotor]
        rotating = self.rotating_force(unbalance.rotor, unbalance.at)
        if speed == 0.0 or unbalance.moment == 0.0:
            return
        force = unbalance.moment * speed**2 * np.exp(1j * unbalance.phase)
        loads.harmonic.append(HarmonicLoad(speed, force * rotating, follows="unbalance"))

    def add_bow(self, loads: Loads, bow: BowReactions) -> None:
        """K b e^{iΩs} of a bow b: the shaft resists its motion u beside the bow by K (u - b e^{iΩs})."""
        force = np.zeros_like(loads.constant, dtype=np.complex128)
        for at, value in zip(bow.at.tolist(), bow.forces, strict=True):
            force = force + value * self.rotating_force(bow.rotor, at)
        loads.harmonic.append(HarmonicLoad(self.speeds[bow.rotor], force, follows="turning"))

    def add_torque(self, loads: Loads, torque: AnyTorque) -> None:
        """A torque that is constant, tabled over time, harmonic, or a slope over the speed."""
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
            One for each train at most; a train without is driven at the left end of its first rotor.
        """
        total = np.zeros(self.size)
        rotors = [part.name for part in self.components if isinstance(part, RotorComponent)]
        for train in trains(rotors, pairs):
            here = [drive for drive in drives if drive.rotor in train] or [Drive(train[0], 0.0)]
            if len(here) > 1:
                raise CouplingError(
                    f"rotors {[one.rotor for one in here]} of one train are said to drive it; expected one"
                )
            for name in train:
                total -= self.speeds[name] * self.rigid_rotation(name)
            power = sum(self.speeds[name] ** 2 * float(np.sum(self.rigid_rotation(name) ** 2)) for name in train)
            if power:
                total += power / self.speeds[here[0].rotor] * self.rotation(here[0].rotor, here[0].at)
        return total


def _dashpot(slope: TorqueSlope, row: FloatArray) -> LinearConnector:
    """A torque's slope over speed as a dashpot of minus the slope."""
    damping = -slope.slopes.reshape(-1, 1, 1)
    none = np.zeros_like(damping)
    table = SpeedTable(slope.rates, none, damping) if np.ptp(slope.slopes) > 0.0 else None
    middle = none[0], damping[0]
    if table is not None:
        middle = table.at(1.0)
    return LinearConnector(slope.name, row[:, None], *middle, over_speed=table)


def trains(names: Sequence[str], pairs: Sequence[tuple[str, str]]) -> list[list[str]]:
    """Gear trains: rotors that gear pairs connect, in their order; a rotor without a pair is a train of its own."""
    found = [[name] for name in names]
    for first, second in pairs:
        one, other = (next(train for train in found if name in train) for name in (first, second))
        if one is not other:
            found.remove(other)
            one += other
    return [sorted(train, key=list(names).index) for train in found]
