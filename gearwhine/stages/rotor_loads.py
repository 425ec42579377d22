"""What loads do to a rotor of a case, alone on grounded bearings: its own weight, unbalance and bow."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import rotors as room
from gearwhine.case import Case, RotorAnalysis, response_speeds
from gearwhine.case import Rotor as GivenRotor

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_SAME_PLACE = 1e-9  # of a rotor's length
_BOW_KEYS = ("at", "amplitude", "phase")


@dataclass(frozen=True)
class Reading:
    """What a probe reads of the synchronous motion, its run-out included.

    Attributes
    ----------
    name : str
    at : float
        Its station [m from the left end].
    angle : float
        Its direction from x [rad].
    amplitude : ndarray of complex, shape (s,)
        Displacement Re(amplitude e^{iΩt}) along it at every speed [m].
    major_axis : ndarray, shape (s,)
        Larger half axis of the orbit there [m].
    """

    name: str
    at: float
    angle: float
    amplitude: ComplexArray
    major_axis: FloatArray


@dataclass(frozen=True)
class SolvedResponse:
    """The response to unbalance and bow over speed.

    Attributes
    ----------
    speeds : ndarray, shape (s,)
        Ascending without their sense [rad/s].
    readings : tuple of Reading
    bearing_forces : ndarray, shape (s, bearings, 2)
        Amplitude of each bearing's force along x and y [N].
    """

    speeds: FloatArray
    readings: tuple[Reading, ...]
    bearing_forces: FloatArray


def solve_response(
    case: Case, given: GivenRotor, rotor: room.Rotor, bearings: Sequence[room.Bearing]
) -> SolvedResponse | None:
    """Response to the rotor's unbalance and bow; None without either, without speeds, or on no bearings at all."""
    speeds = np.unique(np.abs(response_speeds(case, given.name)))
    if not (given.unbalance or given.bow) or not speeds.size or not bearings:
        return None
    sense = -1.0 if min(response_speeds(case, given.name), default=0.0) < 0.0 else 1.0
    bow = None
    if given.bow:
        at, amplitude, phase = (np.array([getattr(point, key) for point in given.bow]) for key in _BOW_KEYS)
        bow = room.Bow(at, amplitude, phase)
    unbalances = [room.Unbalance(one.at, one.moment, one.phase) for one in given.unbalance]
    response = room.unbalance_response(rotor, bearings, unbalances, sense * speeds, bow=bow)
    probes = _probes(case, given, bearings, rotor.length)
    x, y = response.reading([at for _, at, _ in probes])
    orbit = room.orbit_of(x, y, response.frequencies[:, None])
    readings = [
        Reading(name, at, angle, x[:, i] * np.cos(angle) + y[:, i] * np.sin(angle), orbit.major[:, i])
        for i, (name, at, angle) in enumerate(probes)
    ]
    return SolvedResponse(speeds, tuple(readings), np.abs(response.bearing_forces[:, :, :2]))


def _probes(
    case: Case, given: GivenRotor, bearings: Sequence[room.Bearing], length: float
) -> list[tuple[str, float, float]]:
    """Name, station and angle of each probe: the case's, or along x at every bearing and every load."""
    analysis = case.rotor_analysis or RotorAnalysis()
    own = [(one.name, one.at, one.angle) for one in analysis.unbalance_response.probes if one.rotor == given.name]
    if own:
        return own
    probes = [(bearing.name, bearing.at, 0.0) for bearing in bearings]
    for what, at in [("unbalance", one.at) for one in given.unbalance] + [("bow", one.at) for one in given.bow]:
        if all(abs(at - other) > _SAME_PLACE * length for _, other, _ in probes):
            probes.append((f"{what} at {1e3 * at:.6g} mm", at, 0.0))
    return probes


def solve_static(
    case: Case, rotor: room.Rotor, bearings: Sequence[room.Bearing]
) -> tuple[room.StaticDeflection | None, str | None]:
    """How the rotor hangs in its bearings by its weight; or None, and why they do not hold it."""
    analysis = case.rotor_analysis or RotorAnalysis()
    try:
        return room.static_deflection(rotor, bearings, gravity=analysis.gravity), None
    except room.RotorError as error:
        return None, str(error)
