"""What is known of the rotors, as the command's JSON: each key with its unit."""

from typing import Any

import numpy as np
import numpy.typing as npt

import rotors as room
from gearwhine.stages.rotors import SolvedRotor

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi
_RPM = 60.0 / (2.0 * np.pi)

# A damping ratio nearer to zero than this is rounding: the mode neither grows nor decays.
NEUTRAL = 1e-9


def rotors_document(solved: tuple[SolvedRotor, ...]) -> dict[str, Any]:
    """The rotors as the command's JSON."""
    return {
        "rotors": [
            {
                "name": one.rotor.name,
                "mass_kg": one.rotor.mass,
                "length_m": one.rotor.length,
                "lateral_hz": (one.rest.frequencies / _HERTZ).tolist(),
                "torsional_hz": (one.torsional.frequencies / _HERTZ).tolist(),
                "rest_bearings_at_rpm": _in_rpm(one.rest_speed),
                "operation_rpm": _in_rpm(one.operation),
                "whirl": [{"speed_rpm": whirl.speed * _RPM} | _modes(whirl) for whirl in one.whirl],
                "critical_speeds_rpm": (one.critical.speeds * _RPM).tolist(),
                "critical_bearings_at_rpm": _in_rpm(one.critical_speed),
                "critical_directions": one.critical.direction.round(6).tolist(),
                "critical_margins": _margins(one),
                "campbell": _campbell(one.campbell),
                "damping": "of the bearings; the shaft's own acts in the coupled system",
                "certificate": _certificate(one),
            }
            for one in solved
        ]
    }


def log_decrement(damping_ratio: FloatArray) -> FloatArray:
    """Natural logarithm of the ratio of two amplitudes one period apart, δ = 2πζ / √(1 − ζ²)."""
    return np.asarray(2.0 * np.pi * damping_ratio / np.sqrt(1.0 - damping_ratio**2))


def is_stable(whirl: room.WhirlModes) -> bool:
    """Whether no mode grows by itself."""
    return bool((whirl.damping_ratios >= -NEUTRAL).all())


def _in_rpm(speed: float | None) -> float | None:
    return None if speed is None else speed * _RPM


def _modes(whirl: room.WhirlModes) -> dict[str, Any]:
    return {
        "frequency_hz": (whirl.frequencies / _HERTZ).tolist(),
        "damping_ratio": whirl.damping_ratios.tolist(),
        "log_decrement": log_decrement(whirl.damping_ratios).tolist(),
        "direction": whirl.direction.tolist(),
        "stable": is_stable(whirl),
    }


def _campbell(campbell: tuple[room.WhirlModes, ...]) -> dict[str, Any] | None:
    """Whirl over speed, a row for each speed, and the lowest speed at which a mode grows; None without speeds."""
    if not campbell:
        return None
    unstable = [abs(whirl.speed) * _RPM for whirl in campbell if not is_stable(whirl)]
    rows = [_modes(whirl) for whirl in campbell]
    return {
        "speed_rpm": [whirl.speed * _RPM for whirl in campbell],
        **{key: [row[key] for row in rows] for key in ("frequency_hz", "log_decrement", "direction")},
        "unstable_from_rpm": min(unstable, default=None),
    }


def _margins(one: SolvedRotor) -> list[float] | None:
    """How far each critical speed lies from the speed of operation, as a part of that; None where nothing turns."""
    if not one.operation:
        return None
    return [float(speed) / abs(one.operation) - 1.0 for speed in one.critical.speeds]


def _certificate(one: SolvedRotor) -> dict[str, Any]:
    """The count's proof; for stiffness that couples the planes there is no count, and nothing is claimed."""
    certificate = one.rest.certificate
    coupled = any(bearing.has_cross_stiffness for bearing in one.resting)
    return {
        "limit_hz": None if coupled else certificate.limit / _HERTZ,
        "expected": None if coupled else certificate.expected,
        "found": len(one.rest.frequencies),
        "complete": None if coupled else certificate.complete,
        "max_residual": certificate.max_residual,
    }
