"""What is known of the rotors, as the command's JSON: each key with its unit."""

from typing import Any

import numpy as np
import numpy.typing as npt

import rotors as room
from gearwhine.doubtful import warning
from gearwhine.stages.rotor_loads import SolvedResponse
from gearwhine.stages.rotors import SolvedRotor
from gearwhine.stages.torsion import SolvedTorsion
from rotors.rolling import RollingState

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi
_RPM = 60.0 / (2.0 * np.pi)

_ROTATING = (
    "rotor {!r}: the damping of its coupling across the axis turns with the shaft and feeds forward whirl at speeds "
    "above its frequency; whirl and its stability are told without it here, and with it by `gearwhine system`"
)

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
                "bearings": [bearing.name for bearing in one.bearings],
                "lateral_hz": (one.rest.frequencies[one.rest.axial_share <= room.MOSTLY_AXIAL] / _HERTZ).tolist(),
                "lateral_axial_share": one.rest.axial_share[one.rest.axial_share <= room.MOSTLY_AXIAL].tolist(),
                "axial_hz": (one.axial / _HERTZ).tolist(),
                "strain_energy": _strain_energy(one),
                "torsional_hz": (one.torsional.frequencies / _HERTZ).tolist(),
                "rest_bearings_at_rpm": _in_rpm(one.rest_speed),
                "operation_rpm": _in_rpm(one.operation),
                "whirl": [
                    {"speed_rpm": whirl.speed * _RPM} | _modes(whirl) | {"strain_energy": _whirl_strain(one, whirl)}
                    for whirl in one.whirl
                ],
                "critical_speeds_rpm": (one.critical.speeds * _RPM).tolist(),
                "critical_directions": one.critical.direction.round(6).tolist(),
                "critical_axial_share": one.critical.axial_share.tolist(),
                "critical_margins": _margins(one),
                "campbell": _campbell(one),
                "static": _static(one),
                "unbalance_response": None if one.response is None else _response(one.response),
                "rolling_bearings": [_rolling(name, state) for name, state in one.rolling.items()],
                "damping": "of the bearings; that of the shaft and of its couplings acts in the coupled system",
                "torsional_response": None if one.torsion is None else _torsion(one.torsion),
                "stiffness_map": None if one.stiffness_map is None else _stiffness_map(one.stiffness_map),
                "certificate": _certificate(one),
            }
            for one in solved
        ],
        "warnings": [
            warning("rotating damping", _ROTATING.format(one.rotor.name), rotor=one.rotor.name)
            for one in solved
            if any(_damps_across(part) for part in one.rotor.segments)
        ],
    }


def _damps_across(part: room.Segment | room.Coupling) -> bool:
    """Whether a coupling damps motion across the axis, which it does in the turning shaft."""
    return isinstance(part, room.Coupling) and (part.lateral_damping > 0.0 or part.tilt_damping > 0.0)


def _strain_energy(one: SolvedRotor) -> dict[str, Any]:
    """Shares of each planar mode's strain energy in the segments and the bearings, a row for each mode."""
    segments, bearings = one.lateral.strain_energy_shares(one.rotor.joints)
    return {
        "frequency_hz": (one.lateral.frequencies / _HERTZ).tolist(),
        "segments": segments.tolist(),
        "bearings": bearings.tolist(),
    }


def _whirl_strain(one: SolvedRotor, whirl: room.WhirlModes) -> dict[str, Any]:
    """Shares of each whirl mode's strain energy, in the mean of a cycle, a row for each mode."""
    shares = whirl.strain_energy_shares(one.rotor.joints)
    parts: dict[str, Any] = {"segments": shares.lengths.tolist(), "bearings": shares.bearings.tolist()}
    if any(bearing.pedestal is not None for bearing in one.bearings):
        parts["pedestals"] = shares.pedestals.tolist()
    return parts


def _stiffness_map(of: room.CriticalSpeedMap) -> dict[str, Any]:
    whirl = "forward" if of.direction > 0 else "backward"
    return {
        "stiffness_n_per_m": of.stiffnesses.tolist(),
        f"{whirl}_critical_speeds_rpm": (of.speeds * _RPM).tolist(),
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
        "axial_share": whirl.axial_share.tolist(),
        "stable": is_stable(whirl),
    }


def _campbell(one: SolvedRotor) -> dict[str, Any] | None:
    """Whirl over speed, a row for each speed and a column for each branch; None without speeds.

    ``unstable_from_rpm`` is the lowest speed looked at, without its sense, at which a mode grows.
    """
    if one.campbell is None:
        return None
    diagram, crossings = one.campbell, one.crossings
    # Branches that do not oscillate at a speed are not a number there, which compares as stable.
    grows = (diagram.log_decrements < -2.0 * np.pi * NEUTRAL).any(axis=1)
    return {
        "speed_rpm": (diagram.speeds * _RPM).tolist(),
        "frequency_hz": (diagram.frequencies / _HERTZ).tolist(),
        "log_decrement": diagram.log_decrements.tolist(),
        "direction": diagram.direction.tolist(),
        "axial_share": diagram.axial_share.tolist(),
        "unstable_from_rpm": float(np.abs(diagram.speeds[grows]).min()) * _RPM if grows.any() else None,
        "proved_at_rpm": (diagram.speeds[diagram.proved] * _RPM).tolist(),
        "critical_speeds": None if isinstance(crossings, str) else [_crossing(one, each) for each in crossings],
        "why_no_critical_speeds": crossings if isinstance(crossings, str) else None,
        "orders": [
            {
                "order": order,
                "critical_speeds": None if isinstance(found, str) else [_crossing(one, each) for each in found],
                "why_no_critical_speeds": found if isinstance(found, str) else None,
            }
            for order, found in one.orders.items()
        ],
    }


def _crossing(one: SolvedRotor, crossing: room.Crossing) -> dict[str, Any]:
    """A damped critical speed."""
    return {
        "speed_rpm": crossing.speed * _RPM,
        "direction": crossing.direction,
        "axial_share": crossing.axial_share,
        "log_decrement": crossing.log_decrement,
        "margin": abs(crossing.speed / one.operation) - 1.0 if one.operation else None,
    }


def _rolling(name: str, state: RollingState) -> dict[str, Any]:
    """A rolling bearing under its load: where the shaft goes, the stiffness there, how hard its elements are pressed.

    ``stiffness`` is over x, y, z and the rotations about x and y, in N/m, N/rad and N m/rad.
    """
    return {
        "name": name,
        "load_n": state.load[:3].tolist(),
        "displacement_m": state.displacement[:3].tolist(),
        "stiffness": state.stiffness.tolist(),
        "elements": sum(row.count for row in state.bearing.rows),
        "loaded_elements": state.loaded,
        "peak_pressure_pa": state.peak_pressure,
        "residual": state.residual,
    }


def _static(one: SolvedRotor) -> dict[str, Any]:
    """Bearing loads under gravity and the shaft's sag; or why there are none."""
    if isinstance(one.weight, str):
        return {"bearings": None, "why_not": one.weight}
    deflection = one.weight.deflection
    sag = np.hypot(*one.weight.displacement)
    lowest = int(sag.argmax())
    return {
        "gravity_m_per_s2": deflection.gravity.tolist(),
        "bearings_at_rpm": None if one.rest_speed is None else _in_rpm(one.weight.speed),
        "bearings": [
            {"name": name, "load_n": load[:3].tolist(), "moment_n_m": load[3:].tolist()}
            for name, load in zip(deflection.bearings, deflection.bearing_loads, strict=True)
        ],
        "largest_deflection_m": float(sag[lowest]),
        "largest_deflection_at_m": float(one.weight.places[lowest]),
        "place_m": one.weight.places.tolist(),
        "deflection_m": one.weight.displacement.tolist(),
    }


def _response(solved: SolvedResponse) -> dict[str, Any]:
    """What each probe reads over speed, at its largest and at operation; forces on the bearings over x and y."""
    response = solved.response
    rows = []
    for place, reading in enumerate(solved.readings):
        amplitude = np.abs(reading.amplitude)
        largest = int(amplitude.argmax())
        at_operation = solved.at_operation[place] if solved.at_operation else None
        rows.append(
            {
                "name": reading.probe.name,
                "at_m": reading.probe.at,
                "angle_deg": float(np.degrees(reading.probe.angle)),
                "amplitude_m": amplitude.tolist(),
                "phase_lag_deg": np.degrees(reading.phase_lag).tolist(),
                "major_axis_m": reading.major_axis.tolist(),
                "largest_amplitude_m": float(amplitude[largest]),
                "largest_at_rpm": float(response.speeds[largest]) * _RPM,
                "operation_amplitude_m": None if at_operation is None else float(abs(at_operation.amplitude[0])),
                "operation_phase_lag_deg": None
                if at_operation is None
                else float(np.degrees(at_operation.phase_lag[0])),
            }
        )
    forces = np.abs(response.bearing_forces[:, :, :2])
    return {
        "speed_rpm": (response.speeds * _RPM).tolist(),
        "amplitude_convention": "zero to peak",
        "probes": rows,
        "bearings": [
            {"name": name, "force_n": forces[:, place].T.tolist()} for place, name in enumerate(response.bearings)
        ],
    }


def _torsion(solved: SolvedTorsion) -> dict[str, Any]:
    """Angle and torque at each probe over frequency, and where the shaft carries most."""
    frequencies = solved.response.frequencies / _HERTZ
    rows = []
    for reading in solved.readings:
        angle, torque = np.abs(reading.angle), np.abs(reading.torque)
        rows.append(
            {
                "name": reading.probe.name,
                "at_m": reading.probe.at,
                "angle_rad": angle.tolist(),
                "angle_phase_deg": np.degrees(np.angle(reading.angle)).tolist(),
                "torque_n_m": torque.tolist(),
                "torque_phase_deg": np.degrees(np.angle(reading.torque)).tolist(),
                "largest_angle_rad": float(angle.max()),
                "largest_angle_at_hz": float(frequencies[angle.argmax()]),
                "largest_torque_n_m": float(torque.max()),
                "largest_torque_at_hz": float(frequencies[torque.argmax()]),
            }
        )
    worst = int(solved.largest_torque.argmax())
    return {
        "frequency_hz": frequencies.tolist(),
        "damping_ratio": solved.response.damping_ratio,
        "amplitude_convention": "zero to peak",
        "probes": rows,
        "largest_torque_n_m": float(solved.largest_torque[worst]),
        "largest_torque_at_m": float(solved.places[worst]),
        "largest_torque_at_hz": float(solved.worst_frequency[worst]) / _HERTZ,
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
