"""What a rotor's weight, unbalance and bow do to it, by the speeds and probes of `[rotor_analysis]`."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import rotors as room
from gearwhine.case import Case, Probe, RotorAnalysis, response_speeds
from gearwhine.case import Rotor as GivenRotor

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_DEFLECTION_PLACES = 201  # along a rotor, of its static deflection


@dataclass(frozen=True)
class SolvedWeight:
    """A rotor in its bearings under gravity.

    Attributes
    ----------
    deflection : rotors.StaticDeflection
    speed : float
        Where tables over speed were read [rad/s].
    places : (p,) array
        Evenly along the shaft, and every station [m].
    displacement : (2, p) array
        Over x and y [m].
    """

    deflection: room.StaticDeflection
    speed: float
    places: FloatArray
    displacement: FloatArray

    @property
    def largest(self) -> tuple[float, float]:
        """Largest deflection and its place along the shaft [m]."""
        sag = np.hypot(*self.displacement)
        lowest = int(sag.argmax())
        return float(sag[lowest]), float(self.places[lowest])


@dataclass(frozen=True)
class ProbeReading:
    """What a probe reads at every speed.

    Attributes
    ----------
    probe : Probe
    speeds : (b,) array
        [rad/s].
    amplitude : (b,) complex array
        Reading Re(amplitude e^{iΩt}) along the probe's angle, run-out included; t from where the mark passes x [m].
    major_axis : (b,) array
        Half the length of the orbit that is read there [m].
    """

    probe: Probe
    speeds: FloatArray
    amplitude: ComplexArray
    major_axis: FloatArray

    @property
    def phase_lag(self) -> FloatArray:
        """By which the reading is behind the rotor's mark, from 0 to 2π, (b,) [rad]."""
        return np.asarray(np.mod(-np.angle(self.amplitude), 2.0 * np.pi))

    @property
    def largest(self) -> tuple[float, float]:
        """Largest reading [m] and its speed [rad/s]."""
        sizes = np.abs(self.amplitude)
        highest = int(sizes.argmax())
        return float(sizes[highest]), float(self.speeds[highest])


@dataclass(frozen=True)
class SolvedResponse:
    """Synchronous response to unbalance and bow.

    Attributes
    ----------
    response : rotors.SynchronousResponse
    readings, at_operation : tuple of ProbeReading
        Of every probe over the speeds of the response; and at the speed of operation alone, empty where there is none.
    """

    response: room.SynchronousResponse
    readings: tuple[ProbeReading, ...]
    at_operation: tuple[ProbeReading, ...]


def solve_weight(
    analysis: RotorAnalysis, rotor: room.Rotor, bearings: tuple[room.Bearing, ...], speed: float
) -> SolvedWeight | str:
    """Deflection and bearing loads under gravity, or why there are none: a free rotor falls, but may well whirl.

    ``speed`` [rad/s] is where tables over speed are read.
    """
    try:
        deflection = room.static_deflection(rotor, bearings, gravity=analysis.gravity, speed=speed)
    except room.RotorError as error:
        return str(error)
    places = np.union1d(np.linspace(0.0, rotor.length, _DEFLECTION_PLACES), rotor.stations)
    return SolvedWeight(deflection, speed, places, deflection.evaluate(places)[:2])


def solve_response(
    case: Case,
    analysis: RotorAnalysis,
    given: GivenRotor,
    rotor: room.Rotor,
    bearings: tuple[room.Bearing, ...],
    operation: float | None,
    *,
    held: bool,
) -> SolvedResponse | None:
    """Response to unbalance and bow over speed; None without either, or without a speed.

    A rotor that is not ``held`` has no answer at rest, which is left out.
    """
    speeds = [speed for speed in response_speeds(case, given.name) if speed or held]
    if not (given.unbalance or given.bow) or not speeds:
        return None
    unbalances, bow = given.build_unbalance(), given.build_bow()
    response = room.unbalance_response(rotor, bearings, unbalances, speeds, bow=bow)
    probes = _probes(case, analysis, given)
    at_operation: tuple[ProbeReading, ...] = ()
    if operation:
        once = room.unbalance_response(rotor, bearings, unbalances, [operation], bow=bow)
        at_operation = tuple(_read(once, probe) for probe in probes)
    return SolvedResponse(response, tuple(_read(response, probe) for probe in probes), at_operation)


def _read(response: room.SynchronousResponse, probe: Probe) -> ProbeReading:
    x, y = (part[:, 0] for part in response.reading([probe.at]))
    along = x * np.cos(probe.angle) + y * np.sin(probe.angle)
    return ProbeReading(probe, response.speeds, along, room.orbit_of(x, y, response.frequencies).major)


def _probes(case: Case, analysis: RotorAnalysis, given: GivenRotor) -> list[Probe]:
    """The probes of one rotor; where the case names none at all, one at each bearing and unbalance, along x."""
    chosen = analysis.unbalance_response.probes
    if chosen:
        return [probe for probe in chosen if probe.rotor == given.name]
    places = {bearing.at: bearing.name for bearing in case.bearing if bearing.rotor == given.name}
    for number, unbalance in enumerate(given.unbalance, start=1):
        places.setdefault(unbalance.at, f"unbalance {number}")
    return [Probe(name=name, rotor=given.name, at=at) for at, name in sorted(places.items())]
