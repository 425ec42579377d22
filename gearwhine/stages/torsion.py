"""What swinging torques do to a rotor's torsion, by the torques and probes of `[rotor_analysis.torsional_response]`."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import rotors as room
from gearwhine.case import Rotor as GivenRotor
from gearwhine.case import RotorAnalysis, TorsionalAnalysis, TorsionProbe

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_HERTZ = 2.0 * np.pi
_STEPS = 400  # of frequency, where none are given
_MODES, _BEYOND = 3, 1.25  # up to this elastic mode, and a little beyond
_RIGID = 1000.0 * _HERTZ  # highest frequency for a rotor that has no elastic mode [rad/s]
_TORQUE_PLACES = 201  # along a rotor, to look for its largest torque


@dataclass(frozen=True)
class TorsionReading:
    """What a probe reads at every frequency, Re(amplitude e^{iωt}) each.

    Attributes
    ----------
    probe : TorsionProbe
    frequencies : (b,) array
        [rad/s].
    angle, torque : (b,) complex arrays
        About the axis [rad]; and carried by the shaft to the right of the probe, at its right end to the left [N m].
    """

    probe: TorsionProbe
    frequencies: FloatArray
    angle: ComplexArray
    torque: ComplexArray

    @property
    def largest_angle(self) -> tuple[float, float]:
        """Largest angle [rad] and its frequency [rad/s]."""
        return _largest(self.angle, self.frequencies)

    @property
    def largest_torque(self) -> tuple[float, float]:
        """Largest torque [N m] and its frequency [rad/s]."""
        return _largest(self.torque, self.frequencies)


def _largest(amplitude: ComplexArray, frequencies: FloatArray) -> tuple[float, float]:
    sizes = np.abs(amplitude)
    highest = int(sizes.argmax())
    return float(sizes[highest]), float(frequencies[highest])


@dataclass(frozen=True)
class SolvedTorsion:
    """Steady torsional response of one rotor.

    Attributes
    ----------
    response : rotors.TorsionalResponse
    readings : tuple of TorsionReading
    places : (p,) array
        Along the shaft [m].
    largest_torque : (p,) array
        What the shaft carries there at most over all frequencies, zero to peak [N m].
    worst_frequency : (p,) array
        And at which frequency [rad/s].
    """

    response: room.TorsionalResponse
    readings: tuple[TorsionReading, ...]
    places: FloatArray
    largest_torque: FloatArray
    worst_frequency: FloatArray

    @property
    def worst(self) -> tuple[float, float, float]:
        """Largest torque of the whole shaft [N m], its place [m] and its frequency [rad/s]."""
        place = int(self.largest_torque.argmax())
        return float(self.largest_torque[place]), float(self.places[place]), float(self.worst_frequency[place])


def solve_torsion(
    analysis: RotorAnalysis, given: GivenRotor, rotor: room.Rotor, modes: room.TorsionalModes
) -> SolvedTorsion | None:
    """The torsional response of one rotor; None where no torque acts on it. ``modes`` are its own, free to turn."""
    wanted = analysis.torsional_response
    torques = [] if wanted is None else [torque for torque in wanted.torques if torque.rotor == given.name]
    if wanted is None or not torques:
        return None
    held = [spring for spring in wanted.springs if spring.rotor == given.name]
    ratio = given.damping_ratio if wanted.damping_ratio is None else wanted.damping_ratio
    response = room.torsional_response(
        rotor,
        [room.Torque(one.at, one.amplitude * np.exp(1j * one.phase)) for one in torques],
        _frequencies(wanted, modes, damped=ratio > 0.0),
        springs=[room.AxisSpring(one.at, one.stiffness) for one in held if one.stiffness > 0.0],
        dashpots=[room.TorsionalDashpot(one.at, one.damping) for one in held if one.damping > 0.0],
        damping_ratio=ratio,
    )
    probes = _torsion_probes(wanted, given, rotor)
    angles, carried = (read([probe.at for probe in probes]) for read in (response.angle, response.torque))
    places = np.union1d(np.linspace(0.0, rotor.length, _TORQUE_PLACES), rotor.stations)
    sizes = np.abs(response.torque(places))
    worst = sizes.argmax(axis=0)
    return SolvedTorsion(
        response,
        tuple(
            TorsionReading(probe, response.frequencies, angles[:, k], carried[:, k]) for k, probe in enumerate(probes)
        ),
        places,
        sizes.max(axis=0),
        response.frequencies[worst],
    )


def _frequencies(wanted: TorsionalAnalysis, modes: room.TorsionalModes, *, damped: bool) -> FloatArray:
    """As given; else even steps up to beyond the third elastic mode, with the modes' own where damping bounds them."""
    if wanted.frequency is not None:
        return _HERTZ * np.array(wanted.frequency.frequencies)
    elastic = modes.frequencies[modes.frequencies > 0.0][:_MODES]
    highest = _BEYOND * float(elastic[-1]) if elastic.size else _RIGID
    steps = highest * np.arange(1, _STEPS + 1) / _STEPS
    return np.union1d(steps, elastic) if damped else steps


def _torsion_probes(wanted: TorsionalAnalysis, given: GivenRotor, rotor: room.Rotor) -> list[TorsionProbe]:
    """The probes of one rotor; where the case names none at all, one at each torque and at either end."""
    if wanted.probes:
        return [probe for probe in wanted.probes if probe.rotor == given.name]
    places = {0.0: "left end", rotor.length: "right end"}
    for number, torque in enumerate((one for one in wanted.torques if one.rotor == given.name), start=1):
        places[torque.at] = f"torque {number}"
    return [TorsionProbe(name=name, rotor=given.name, at=at) for at, name in sorted(places.items())]
