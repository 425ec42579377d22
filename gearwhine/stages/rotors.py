"""The rotors of a case: modes at rest, whirl at speed, critical speeds."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import rotors as room
from gearwhine.case import Case, require, rotor_speeds
from gearwhine.progress import Progress, silent
from gearwhine.stages.bearings import build_bearings, rolling_document
from gearwhine.stages.build import build_rotor

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi
_RPM = 60.0 / (2.0 * np.pi)


@dataclass(frozen=True)
class SolvedRotor:
    """What is known of one rotor on grounded bearings.

    Attributes
    ----------
    rotor : rotors.Rotor
        With its gears as discs.
    bearings : tuple of rotors.Bearing
    rest : rotors.RestFrequencies
    lateral : rotors.LateralModes
        In one plane at averaged support stiffness.
    torsional : rotors.TorsionalModes
    whirl : tuple of rotors.WhirlModes
        At the speed of operation, then at those of the sweep.
    critical : rotors.CriticalSpeeds
    rolling : list of dict
        What its rolling bearings carry, as the command's JSON.
    """

    rotor: room.Rotor
    bearings: tuple[room.Bearing, ...]
    rest: room.RestFrequencies
    lateral: room.LateralModes
    torsional: room.TorsionalModes
    whirl: tuple[room.WhirlModes, ...]
    critical: room.CriticalSpeeds
    rolling: list[dict[str, Any]]


def solve_rotors(case: Case, progress: Progress = silent) -> tuple[SolvedRotor, ...]:
    """Every rotor of the case, alone on grounded bearings.

    Raises
    ------
    CaseError, rotors.RotorError
        Where the case has no rotors, or one cannot be solved as it stands.
    """
    require(case, "rotor", command="rotors")
    solved = []
    for given in case.rotor:
        progress(f"rotor {given.name}")
        rotor, bearings = build_rotor(case, given), build_bearings(case, given.name)
        basis = room.whirl_basis(rotor, bearings)
        solved.append(
            SolvedRotor(
                rotor=rotor,
                bearings=bearings,
                rest=room.rest_frequencies(rotor, bearings),
                lateral=room.solve_lateral_modes(rotor, [bearing.mean_support for bearing in bearings]),
                torsional=room.solve_torsional_modes(rotor),
                whirl=tuple(
                    room.solve_whirl(rotor, bearings, speed, basis=basis) for speed in _speeds(case, given.name)
                ),
                critical=room.critical_speeds(rotor, bearings, basis=basis),
                rolling=rolling_document(case, given.name),
            )
        )
    return tuple(solved)


def rotors_document(solved: tuple[SolvedRotor, ...]) -> dict[str, Any]:
    """The rotors as the command's JSON."""
    return {
        "rotors": [
            {
                "name": one.rotor.name,
                "mass_kg": one.rotor.mass,
                "lateral_hz": (one.rest.frequencies / _HERTZ).tolist(),
                "torsional_hz": (one.torsional.frequencies / _HERTZ).tolist(),
                "whirl": [
                    {
                        "speed_rpm": whirl.speed * _RPM,
                        "frequency_hz": (whirl.frequencies / _HERTZ).tolist(),
                        "damping_ratio": whirl.damping_ratios.tolist(),
                        "direction": whirl.direction.tolist(),
                    }
                    for whirl in one.whirl
                ],
                "critical_speeds_rpm": (one.critical.speeds * _RPM).tolist(),
                "critical_directions": one.critical.direction.round(6).tolist(),
                "rolling_bearings": one.rolling,
                "damping": "of the bearings; the shaft's own acts in the coupled system",
                "certificate": _certificate(one),
            }
            for one in solved
        ]
    }


def _certificate(one: SolvedRotor) -> dict[str, Any]:
    """The count's proof; for stiffness that couples the planes there is no count, and nothing is claimed."""
    certificate = one.rest.certificate
    coupled = any(bearing.has_cross_stiffness for bearing in one.bearings)
    return {
        "limit_hz": None if coupled else certificate.limit / _HERTZ,
        "expected": None if coupled else certificate.expected,
        "found": len(one.rest.frequencies),
        "complete": None if coupled else certificate.complete,
        "max_residual": certificate.max_residual,
    }


def _speeds(case: Case, rotor: str) -> list[float]:
    """Speeds of one rotor at operation and through the sweep [rad/s]."""
    speeds = [] if case.operation is None else [rotor_speeds(case).get(rotor, 0.0)]
    for speed in case.sweep.speeds if case.sweep else ():
        speeds.append(rotor_speeds(case, speed).get(rotor, 0.0))
    return speeds
