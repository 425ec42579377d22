"""What drives a machine from outside, on its parts by name, and the loads on the coordinates that come of it."""

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
    """What a bow loads the straight shaft with: forces that turn with it, see :func:`rotors.bow_shape`.

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
    """A torque about z that swings, amplitude cos(w t + phase) [N m].

    Attributes
    ----------
    order : float or None
        w over the speed of the rotor that it acts on: it turns with the shaft, faster and slower.
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
    """By how much a torque about z rises with the speed of its own rotor beside the nominal one [N m s].

    Attributes
    ----------
    rates : ndarray, shape (t,)
        Speeds as parts of the nominal one, ascending.
    slopes : ndarray, shape (t,)
        dT/dω there: a motor's torque mostly falls, and so resists what departs from the nominal speed.
    """

    name: str
    rotor: str
    at: float
    rates: FloatArray
    slopes: FloatArray


AnyTorque = Torque | TorqueHistory | TorqueRipple | TorqueSlope


def constant_torques(torques: "Sequence[AnyTorque]") -> dict[str, float]:
    """Sum of the torques on each rotor [N m], of those that vary over time the largest value; ripples left out."""
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
    """Where the torque comes in that speeds a train up: a rotor, and a distance from its left end [m]."""

    rotor: str
    at: float


@dataclass
class Loads:
    """What acts on the coordinates, n of them; a collection that is still added to.

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


class LoadedParts:
    """The components of a machine with their speeds, and where loads on its rotors act."""

    def __init__(self, components: Sequence[Component], speeds: Mapping[str, float]) -> None:
        self._components, self._speeds = components, speeds
        self._rotors = {part.name: i for i, part in enumerate(components) if isinstance(part, RotorComponent)}

    def rotor(self, name: str) -> tuple[int, RotorComponent]:
        """A rotor and its number among the components."""
        if name not in self._rotors:
            raise CouplingError(f"no rotor is named {name!r}; there are: {', '.join(sorted(self._rotors))}")
        part = self._components[self._rotors[name]]
        assert isinstance(part, RotorComponent)
        return self._rotors[name], part

    def turning(self, name: str) -> FloatArray:
        """Coordinates of a rotation of a whole rotor by one radian, shape (n,)."""
        which, rotor = self.rotor(name)
        return embed(self._components, which, rotor.turning)

    def rotation(self, name: str, at: float) -> FloatArray:
        """Rotation about z of a place on a rotor, shape (n,)."""
        which, rotor = self.rotor(name)
        return embed(self._components, which, rotor.rotation(at))

    def circling(self, name: str, at: float) -> npt.NDArray[np.complex128]:
        """Amplitude of a force of 1 N that circles counter-clockwise, (cos, sin) on x and y, shape (n,)."""
        which, rotor = self.rotor(name)
        x, y = (embed(self._components, which, rotor.direction(at, axis)) for axis in (0, 1))
        return np.asarray(x - 1j * y)

    def add_unbalance(self, loads: Loads, unbalance: Unbalance) -> None:
        """m e Ω² (cos, sin)(Ω t + phase) on x and y: y lags x by a quarter turn, in the sense of rotation."""
        speed = self._speeds[unbalance.rotor]
        circling = self.circling(unbalance.rotor, unbalance.at)
        if speed == 0.0 or unbalance.moment == 0.0:
            return
        force = unbalance.moment * speed**2 * np.exp(1j * unbalance.phase)
        loads.harmonic.append(HarmonicLoad(speed, force * circling, follows="unbalance"))

    def add_bow(self, loads: Loads, bow: BowReactions) -> None:
        """K b e^{iΩs} of a bow b: the shaft resists what its motion u differs from it, by K (u - b e^{iΩs})."""
        force = np.zeros_like(loads.constant, dtype=np.complex128)
        for at, value in zip(bow.at.tolist(), bow.forces, strict=True):
            force = force + value * self.circling(bow.rotor, at)
        loads.harmonic.append(HarmonicLoad(self._speeds[bow.rotor], force, follows="turning"))

    def add_torque(self, loads: Loads, torque: AnyTorque) -> None:
        """Constant, over time, swinging, or by the speed beside the nominal one."""
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
                frequency = torque.order * abs(self._speeds[torque.rotor])
                loads.harmonic.append(HarmonicLoad(frequency, amplitude, follows="turning"))
            case TorqueSlope():
                loads.dashpots.append(_dashpot(torque, row))

    def swing(self, pairs: Sequence[tuple[str, str]], drives: Sequence[Drive]) -> FloatArray:
        """Load of an angular acceleration s'' = 1/s, at which each rotor gains its own speed in a second, shape (n,).

        The coordinates turn relative to the nominal rotation, so each shaft's inertia holds it back by -∫ Ω s'' dI_p,
        which its modes feel as -Ω s'' times the coordinates of a rotation of the whole. For rotors that gears tie, of
        inertia J and speed Ω, the drive adds (Σ J Ω²) s'' / Ω_drive, so that the train as a whole follows the nominal
        rotation, and no load is left on it.

        Parameters
        ----------
        pairs : sequence of two names
            Rotors that gears tie.
        drives : sequence of Drive
            One for each train at most; a train without is driven at the left end of its first rotor.
        """
        total = np.zeros(sum(component.size for component in self._components))
        for train in trains(list(self._rotors), pairs):
            here = [drive for drive in drives if drive.rotor in train] or [Drive(train[0], 0.0)]
            if len(here) > 1:
                raise CouplingError(
                    f"rotors {[one.rotor for one in here]} of one train are said to drive it; expected one"
                )
            for name in train:
                total -= self._speeds[name] * self.turning(name)
            power = sum(self._speeds[name] ** 2 * float(np.sum(self.turning(name) ** 2)) for name in train)
            if power:
                total += power / self._speeds[here[0].rotor] * self.rotation(here[0].rotor, here[0].at)
        return total


def _dashpot(slope: TorqueSlope, row: FloatArray) -> LinearConnector:
    """A torque's slope over speed resists as a dashpot of minus the slope."""
    damping = -slope.slopes.reshape(-1, 1, 1)
    none = np.zeros_like(damping)
    table = SpeedTable(slope.rates, none, damping) if np.ptp(slope.slopes) > 0.0 else None
    middle = none[0], damping[0]
    if table is not None:
        middle = table.at(1.0)
    return LinearConnector(slope.name, row[:, None], *middle, over_speed=table)


def trains(names: Sequence[str], pairs: Sequence[tuple[str, str]]) -> list[list[str]]:
    """Rotors that gear pairs tie together, in their order; a rotor that none ties is a train of its own."""
    found = [[name] for name in names]
    for first, second in pairs:
        one, other = (next(train for train in found if name in train) for name in (first, second))
        if one is not other:
            found.remove(other)
            one += other
    return [sorted(train, key=list(names).index) for train in found]
