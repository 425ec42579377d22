"""Coordinates of a machine: rows of the motion of places on its components, and loads on them as generalised forces."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.components import Component, PinComponent, RotorComponent, pin_name
from gearwhine.coupling.machine.connectors import LinearConnector, SpeedTable
from gearwhine.coupling.machine.coupled_system import HarmonicLoad, TimedLoad, embed
from gearwhine.coupling.machine.loads import (
    AnyTorque,
    BowReactions,
    Drive,
    ShaftForce,
    Torque,
    TorqueHistory,
    TorqueRipple,
    TorqueSlope,
    Unbalance,
)
from gearwhine.coupling.machine.rotating_inertia import circling, rotating_inertia
from gearwhine.numerics.arrays import FloatArray


@dataclass
class CoordinateLoads:
    """Loads on the n coordinates, collected while the machine is assembled.

    Attributes
    ----------
    constant : ndarray, shape (n,)
    harmonic : list of HarmonicLoad
    timed : list of TimedLoad
    dashpots : list of LinearConnector
    centrifugal : ndarray, shape (n,), or float
        The part of the constant loads that is proportional to the square of the speed.
    angular : ndarray, shape (n,), or float
        Loads of an angular acceleration s'' of one.
    """

    constant: FloatArray
    harmonic: list[HarmonicLoad] = field(default_factory=list)
    timed: list[TimedLoad] = field(default_factory=list)
    dashpots: list[LinearConnector] = field(default_factory=list)
    centrifugal: FloatArray | float = 0.0
    angular: FloatArray | float = 0.0


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

    def is_rotor(self, name: str) -> bool:
        """Whether a component of this name is a rotor."""
        return name in self._numbers and isinstance(self.components[self._numbers[name]], RotorComponent)

    def rotor(self, name: str) -> RotorComponent:
        """Return the rotor of this name."""
        part = self.components[self._numbers[name]] if name in self._numbers else None
        if not isinstance(part, RotorComponent):
            names = sorted(part.name for part in self.components if isinstance(part, RotorComponent))
            raise CouplingError(f"no rotor is named {name!r}; there are: {', '.join(names)}")
        return part

    def pin(self, planet: str) -> PinComponent:
        """Return the elastic pin of a planet."""
        part = self.components[self._numbers[pin_name(planet)]]
        assert isinstance(part, PinComponent)
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
        loads.harmonic.append(HarmonicLoad(speed, force * rotating, "unbalance", "unbalance"))

    def add_bow(self, loads: CoordinateLoads, bow: BowReactions) -> None:
        """Add K b e^{iΩs} of a bow b: the shaft resists its motion u relative to the bow by K (u - b e^{iΩs})."""
        force = np.zeros_like(loads.constant, dtype=np.complex128)
        for at, value in zip(bow.at.tolist(), bow.forces, strict=True):
            force = force + value * self.rotating_force(bow.rotor, at)
        loads.harmonic.append(HarmonicLoad(self.speeds[bow.rotor], force, "turning", "shaft_bow"))

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
                    loads.harmonic.append(HarmonicLoad(torque.frequency, amplitude, "time", "torque_ripple"))
                    return
                assert torque.order is not None
                frequency = torque.order * abs(self.speeds[torque.rotor])
                loads.harmonic.append(HarmonicLoad(frequency, amplitude, "turning", "torque_ripple"))
            case TorqueSlope():
                loads.dashpots.append(_dashpot(torque, row))

    def acceleration_load(self, pairs: Sequence[tuple[str, str]], drives: Sequence[Drive]) -> FloatArray:
        """Load of an angular acceleration s'' = 1/s, at which each rotor gains its own speed in a second, shape (n,).

        The coordinates turn relative to the nominal rotation, so each shaft's inertia holds it back by -∫ Ω s'' dI_p,
        which its modes feel as -Ω s'' times the coordinates of a rotation of the whole. For rotors that gears connect,
        of inertia J and speed Ω, the drive adds (Σ J Ω²) s'' / Ω_drive, so that the train as a whole follows the
        nominal rotation, and no load is left on it. A planet circles with its carrier as well.

        Parameters
        ----------
        pairs : sequence of two names
            Rotors that gears connect.
        drives : sequence of Drive
            Drives, at most one for each train; a train without a drive is driven at the left end of its first rotor.
        """
        total = np.zeros(self.size)
        rotors = [part for part in self.components if isinstance(part, RotorComponent)]
        for train in trains([rotor.name for rotor in rotors], pairs):
            first = next((name for name in train if self.speeds[name] != 0.0), train[0])
            driving = [drive for drive in drives if drive.rotor in train] or [Drive(first, 0.0)]
            if len(driving) > 1:
                raise CouplingError(
                    f"rotors {[one.rotor for one in driving]} of one train are said to drive it; expected one"
                )
            for name in train:
                total -= self.speeds[name] * self.rigid_rotation(name)
                carrier = self.rotor(name).carrier
                if carrier is not None:
                    row = circling(self.rotor(name), self.rotor(carrier).axis)
                    total -= self.speeds[carrier] * self.rows(name, row)
            power = rotating_inertia(rotors, {name: self.speeds[name] for name in train})
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
