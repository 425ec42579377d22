"""What is known of the rotors, as the command's JSON: each key with its unit."""

from typing import Any

import numpy as np
import numpy.typing as npt

import rotors as room
from gearwhine.stages.rotor_loads import Reading, SolvedResponse
from gearwhine.stages.rotors import SolvedRotor

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi
_RPM = 60.0 / (2.0 * np.pi)

# A damping ratio nearer to zero than this is rounding: the mode neither grows nor decays.
NEUTRAL = 1e-9

STATIC_PLACES = 401
"""Along a shaft, where its deflection is read."""


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
                "critical_map": _critical_map(one.critical_map),
                "unbalance_response": _response(one.response),
                "static": _static(one),
                "unheld": one.unheld,
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


def _campbell(campbell: room.Campbell | None) -> dict[str, Any] | None:
    """Whirl over speed, a row for each speed and a column for each branch; None without speeds."""
    if campbell is None:
        return None
    growing = (campbell.log_decrements < -NEUTRAL).any(axis=1)
    unstable = np.abs(campbell.speeds[growing]) * _RPM
    return {
        "speed_rpm": (campbell.speeds * _RPM).tolist(),
        "frequency_hz": _known(campbell.frequencies / _HERTZ),
        "log_decrement": _known(campbell.log_decrements),
        "direction": _known(campbell.direction),
        "proved": campbell.proved.tolist(),
        "crossings": [
            {
                "speed_rpm": crossing.speed * _RPM,
                "direction": crossing.direction,
                "log_decrement": crossing.log_decrement,
            }
            for crossing in campbell.crossings()
        ],
        "unstable_from_rpm": float(unstable.min()) if unstable.size else None,
    }


def _known(values: FloatArray) -> list[list[float | None]]:
    """Rows of numbers, None where a branch is not known."""
    return [[None if np.isnan(value) else float(value) for value in row] for row in values]


def _critical_map(found: room.CriticalSpeedMap | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {"stiffness_n_per_m": found.stiffnesses.tolist(), "speed_rpm": _known(found.speeds * _RPM)}


def _response(response: SolvedResponse | None) -> dict[str, Any] | None:
    """Amplitude and phase lag of every probe over speed."""
    if response is None:
        return None
    return {
        "speed_rpm": (response.speeds * _RPM).tolist(),
        "probes": [
            {
                "name": reading.name,
                "at_m": reading.at,
                "angle_deg": float(np.degrees(reading.angle)),
                "peak_to_peak_m": (2.0 * np.abs(reading.amplitude)).tolist(),
                "phase_lag_deg": np.degrees(-np.angle(reading.amplitude)).tolist(),
                "major_axis_m": reading.major_axis.tolist(),
                "highest": _highest(response.speeds, reading),
            }
            for reading in response.readings
        ],
    }


def _highest(speeds: FloatArray, reading: Reading) -> dict[str, float]:
    place = int(np.argmax(np.abs(reading.amplitude)))
    return {
        "speed_rpm": float(speeds[place]) * _RPM,
        "peak_to_peak_m": float(2.0 * np.abs(reading.amplitude[place])),
    }


def _static(one: SolvedRotor) -> dict[str, Any] | None:
    """Loads on the bearings under the rotor's weight, and its largest deflection."""
    if one.static is None:
        return None
    z = np.linspace(0.0, one.rotor.length, STATIC_PLACES)
    size = np.linalg.norm(one.static.evaluate(z), axis=0)
    return {
        "gravity_m_per_s2": one.static.gravity.tolist(),
        "bearing_loads": [
            {"bearing": name, "force_n": load[:3].tolist(), "moment_n_m": load[3:].tolist()}
            for name, load in zip(one.static.bearings, one.static.bearing_loads, strict=True)
        ],
        "largest_deflection_m": float(size.max()),
        "at_m": float(z[np.argmax(size)]),
    }


def _margins(one: SolvedRotor) -> list[float] | None:
    """How far each critical speed lies from the speed of operation, as a part of that; None where nothing turns."""
    if not one.operation:
        return None
    return [float(speed) / abs(one.operation) - 1.0 for speed in one.critical.speeds]


def _certificate(one: SolvedRotor) -> dict[str, Any]:
    """The count's proof, of the frequencies at rest."""
    certificate = one.rest.certificate
    return {
        "limit_hz": certificate.limit / _HERTZ,
        "expected": certificate.expected,
        "found": certificate.found,
        "complete": certificate.complete,
        "max_residual": certificate.max_residual,
    }
