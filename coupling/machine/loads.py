"""Loads on a machine by the names of its parts: unbalance, shaft bow, forces, torques and their ripple.

:mod:`gearwhine.coupling.machine.coordinates` turns them into generalised forces,
:mod:`gearwhine.coupling.machine.base_motion` does it for a moving base and gravity.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.base_motion import BaseMotion
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Number, Numbers, Rule, Text, attribute_findings, refuse, table_findings
from gearwhine.numerics.own_copies import keep_arrays, keep_tuples


@dataclass(frozen=True)
class Unbalance:
    """Mass times eccentricity [kg m] at a distance from the rotor's left end [m], ahead of x by a phase [rad]."""

    rotor: str
    at: float
    moment: float
    phase: float


@dataclass(frozen=True)
class BowReactions:
    """Shaft bow as forces on the straight shaft that rotate with it.

    See :func:`gearwhine.rotors.analyses.unbalance.bow_shape`.

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

    def __post_init__(self) -> None:
        """Keep own copies, and check place and force."""
        keep_tuples(self, "force")
        rules: dict[str, Rule] = {"rotor": Text(), "at": Number(at_least=0.0, unit="m"), "force": Numbers(3)}
        refuse(attribute_findings(("force", str(self.rotor)), self, **rules), CouplingError)


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

    def __post_init__(self) -> None:
        """Keep own copies."""
        keep_arrays(self, "times", "values")


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


@dataclass(frozen=True)
class TorqueOverTime:
    """Torque added over time, positive as the torque it is added to: linear between times, constant beyond them.

    Attributes
    ----------
    times : sequence of float
        Ascending times [s].
    torques : sequence of float
        Torque at each time [N m].
    """

    times: Sequence[float]
    torques: Sequence[float]

    def __post_init__(self) -> None:
        """Keep own copies; require a torque for each time, and times that ascend."""
        keep_tuples(self, "times", "torques")
        refuse(table_findings(("torque over time", ""), self, "times", "torques"), CouplingError)

    def on(self, rotor: str, at: float, factor: float) -> TorqueHistory:
        """Return the torque about z, times a factor, on a rotor at a station [m]."""
        return TorqueHistory(rotor, at, np.array(self.times), factor * np.array(self.torques))


@dataclass(frozen=True)
class Ripple:
    """Harmonic part of a torque, amplitude cos(w t + phase), positive as the torque it is added to.

    Attributes
    ----------
    amplitude : float
        [N m]
    phase : float
        [rad]
    order : float or None
        Cycles per revolution of the shaft.
    frequency : float or None
        Frequency w independent of the speed [rad/s]; either this or the order is given.
    """

    amplitude: float
    phase: float = 0.0
    order: float | None = None
    frequency: float | None = None

    def __post_init__(self) -> None:
        """Require finite numbers, and either an order or a frequency."""
        rules: dict[str, Rule] = {
            "amplitude": Number(unit="N m"),
            "phase": Number(unit="rad"),
            "order": Number(above=0.0, optional=True),
            "frequency": Number(above=0.0, optional=True, unit="rad/s"),
        }
        part = ("ripple", "")
        findings = list(attribute_findings(part, self, **rules))
        if (self.order is None) == (self.frequency is None):
            findings.append(Finding(part, "order", None, "either an 'order' of the shaft's rotation or a 'frequency'"))
        refuse(findings, CouplingError)

    def on(self, rotor: str, at: float, sense: float) -> TorqueRipple:
        """Return the ripple about z on a rotor at a station [m], positive in a sense of rotation."""
        amplitude = math.copysign(self.amplitude, sense * self.amplitude)
        return TorqueRipple(rotor, at, amplitude, self.phase, self.order, self.frequency)


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

    def __post_init__(self) -> None:
        """Keep own copies."""
        keep_arrays(self, "speed_ratios", "slopes")

    def at_speed_ratio(self, ratio: float) -> "TorqueSlope":
        """Return the slope over speed, relative to ``ratio`` times the nominal speed."""
        if ratio == 0.0:
            # At a nominal speed of 0 there are no speed ratios: the slope is that at standstill.
            at_rest = np.interp(0.0, self.speed_ratios, self.slopes)
            return replace(self, speed_ratios=np.ones(1), slopes=np.array([at_rest]))
        return replace(self, speed_ratios=self.speed_ratios / abs(ratio))


AnyTorque = Torque | TorqueHistory | TorqueRipple | TorqueSlope


def largest_torques(torques: Sequence[AnyTorque]) -> dict[str, float]:
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
        Stations of the torques that accelerate a train, see :mod:`gearwhine.coupling.machine.coordinates`.
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
    base: BaseMotion | None = None
    gravity: Sequence[float] | None = None
    forces: Sequence[ShaftForce] = ()

    def at_speed_ratio(self, ratio: float) -> "MachineLoads":
        """Return the same loads on the machine at ``ratio`` times its nominal speeds."""
        torques = [
            torque.at_speed_ratio(ratio) if isinstance(torque, TorqueSlope) else torque for torque in self.torques
        ]
        return replace(self, torques=tuple(torques))


UNLOADED = MachineLoads()
