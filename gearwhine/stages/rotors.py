"""The rotors of a case: modes at rest, whirl at speed, critical speeds."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import rotors as room
from gearwhine.case import (
    Case,
    CaseError,
    Problem,
    RadialDamping,
    RadialStiffness,
    RollingStiffness,
    require,
    rotor_speeds,
)
from gearwhine.case import Rotor as GivenRotor
from gearwhine.progress import Progress, silent
from gearwhine.stages.gears import gear_inertia

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
    """

    rotor: room.Rotor
    bearings: tuple[room.Bearing, ...]
    rest: room.RestFrequencies
    lateral: room.LateralModes
    torsional: room.TorsionalModes
    whirl: tuple[room.WhirlModes, ...]
    critical: room.CriticalSpeeds


def build_rotor(case: Case, given: GivenRotor) -> room.Rotor:
    """A rotor of the case, its gears on it as discs."""
    discs = [room.Disc(disc.at, disc.mass, disc.polar_inertia, disc.diametral_inertia) for disc in given.discs]
    for gear in case.gear:
        if gear.rotor == given.name and gear.at is not None:
            mass, polar, diametral = gear_inertia(case, gear)
            if mass or polar or diametral:
                discs.append(room.Disc(gear.at, mass, polar, diametral))
    segments = []
    for segment in given.segments:
        steel = case.material[segment.material or given.material]
        material = room.ShaftMaterial(steel.youngs_modulus, steel.shear_modulus, steel.density)
        segments.append(room.Segment(segment.length, segment.diameter, segment.bore, material, given.shear_coefficient))
    return room.Rotor(given.name, segments, discs, given.mass)


def build_bearings(case: Case, rotor: str) -> tuple[room.Bearing, ...]:
    """The bearings of one rotor, in the order of the file.

    Raises
    ------
    CaseError
        For stiffness given in a form that comes in a later version.
    """
    bearings = []
    for index, given in enumerate(case.bearing):
        if given.rotor != rotor:
            continue
        stiffness, damping = given.stiffness, given.damping
        if not isinstance(stiffness, RadialStiffness) or not isinstance(damping, RadialDamping):
            form = "rolling" if isinstance(stiffness, RollingStiffness) else "matrix"
            expected = "{ xx, yy, xy, yx }: bearings by 5x5 matrix or rolling geometry come in a later version"
            raise CaseError([Problem(f"bearing[{index}].stiffness", form, expected, label=f'bearing "{given.name}"')])
        bearings.append(
            room.Bearing(
                given.name,
                given.at,
                np.array([[stiffness.xx, stiffness.xy], [stiffness.yx, stiffness.yy]]),
                np.array([[damping.xx, damping.xy], [damping.yx, damping.yy]]),
            )
        )
    return tuple(bearings)


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
                "certificate": {
                    "limit_hz": one.rest.certificate.limit / _HERTZ,
                    "expected": one.rest.certificate.expected,
                    "found": one.rest.certificate.found,
                    "complete": one.rest.certificate.complete,
                    "max_residual": one.rest.certificate.max_residual,
                },
            }
            for one in solved
        ]
    }


def _speeds(case: Case, rotor: str) -> list[float]:
    """Speeds of one rotor at operation and through the sweep [rad/s]."""
    speeds = [] if case.operation is None else [rotor_speeds(case).get(rotor, 0.0)]
    for speed in case.sweep.speeds if case.sweep else ():
        speeds.append(rotor_speeds(case, speed).get(rotor, 0.0))
    return speeds
