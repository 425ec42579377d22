"""Plausibility of a solved machine: bearing loads and speeds, unstable modes and modal truncation error.

Gear pairs without torque, and lines of torque that miss the torque of operation, are warned of before anything is
solved. Bearing loads of a run are compared with the loads that the bearings' stiffness was computed for. Warnings name
rolling bearings so fast that the centrifugal force of their elements matters, and coupled modes with negative damping
or negative stiffness. The modal truncation error is given for the sensors' lines, line by line and by bands.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.coupling import CoupledMachine, Machine, coupled_modes
from gearwhine.coupling import stability as coupled_stability
from gearwhine.coupling.analyses.signature import SolvedSignature, TracedLine
from gearwhine.coupling.analyses.transient import SolvedTransient
from gearwhine.coupling.description.excitation import Run
from gearwhine.coupling.linear.complex_modes import Stability
from gearwhine.coupling.linear.damping_band import DampingBand
from gearwhine.coupling.linear.frequency_response import BasisError
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms
from gearwhine.coupling.machine.base_motion import BaseHistory
from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.coupling.machine.speed_profile import FreeRun
from gearwhine.coupling.statics.mean_mesh import mean_contact
from gearwhine.numerics.result_warnings import warning
from gearwhine.rotors.rolling_bearings import RollingBearing

FloatArray = npt.NDArray[np.float64]

_UNWARNED_DIFFERENCE = 0.1  # difference of both forces up to which no warning is given, as a part of the larger one
_LOAD_ROUNDING = 1e-6  # part of the load below which a component counts as zero
_UNWARNED_POWER_ABOVE_LIMIT = 0.5  # part of the power of an acceleration above the limit without a warning
# Free vibration at the begin of a record, as a part of that at the start, without a warning.
_SETTLED_SHARE = 0.02
_UNWARNED_TIME_APART = 1e-3  # part of the time in which flanks are apart without a warning
# Part of the resistance to a tilt of the face that flanks may have without that warning.
_UNWARNED_TILT_RESISTANCE = 0.1
_MOST_CHECKED_LINES = 5  # lines of a sensor that are looked at
_OFF_LINE = 0.05  # difference of a line from the torque of operation without a warning, as a part of the larger torque


def bearing_load_warnings(
    bearings: Sequence[MountedBearing],
    mean_force: Mapping[str, FloatArray],
    found_by: str = "the run",
    known: Sequence[Mapping[str, Any]] = (),
) -> list[dict[str, Any]]:
    """Warn of bearings whose stiffness was made for another load than the mean force of the shaft on them.

    The stiffness of rolling bearings and stops depends on their load. Radial forces are compared as
    vectors, since elements are pressed where the load points; the axial ones beside them. A difference counts against
    the resultant load, so that a small component does not matter.

    Parameters
    ----------
    bearings : sequence of MountedBearing
    mean_force : mapping of str to ndarray, shape (3,)
        Mean force on each bearing along x, y, z [N].
    found_by : str
        Analysis that finds the force, for the message.
    known : sequence of mapping
        Warnings that exist already; bearings that they name are left out.
    """
    warnings = []
    named = {entry["bearing"] for entry in known if entry["name"] == "bearing load"}
    for mounted in bearings:
        name = mounted.bearing.name
        if mounted.design_load is None or name not in mean_force or name in named:
            continue
        assumed = np.array(mounted.design_load)
        actual = np.asarray(mean_force[name], dtype=np.float64)
        scale = max(float(np.linalg.norm(assumed)), float(np.linalg.norm(actual)))
        radial = float(np.hypot(*(actual - assumed)[:2]))
        axial = abs(float(actual[2] - assumed[2]))
        if max(radial, axial) <= _UNWARNED_DIFFERENCE * scale:
            continue
        # The message proposes a load for the case, which must be free of rounding errors.
        actual = np.where(np.abs(actual) > _LOAD_ROUNDING * scale, actual, 0.0)
        sizes = [(float(np.hypot(*force[:2])), float(force[2])) for force in (assumed, actual)]
        warnings.append(
            warning(
                "bearing load",
                f'bearing "{name}": its stiffness was made for a load of {sizes[0][0]:.4g} N radial and '
                f"{sizes[0][1]:.4g} N axial, {found_by} finds {sizes[1][0]:.4g} N radial and "
                f"{sizes[1][1]:.4g} N axial; "
                f"give it the load {{ x = {actual[0]:.4g}, y = {actual[1]:.4g}, z = {actual[2]:.4g} }} N",
                bearing=name,
                assumed_force_n=assumed.tolist(),
                mean_force_n=actual.tolist(),
            )
        )
    return warnings


def settling_warnings(transient: SolvedTransient, signature: SolvedSignature) -> list[dict[str, Any]]:
    """Warn of high lines near coupled modes whose free vibration from the start is still there when the record begins.

    Parameters
    ----------
    transient : SolvedTransient
        At steady speed.
    signature : SolvedSignature
        Its lines; the highest of each sensor count.
    """
    begin = transient.record.sampling.settings.record_from
    near: dict[int, TracedLine] = {}
    for lines in signature.lines.values():
        for line in lines[:_MOST_CHECKED_LINES]:
            if line.named.mode is not None and line.named.kind != "mode":
                near.setdefault(line.named.mode, line)
    warnings = []
    for mode, line in sorted(near.items()):
        decay = -float(signature.modes.eigenvalues[mode].real)
        left = float(np.exp(-decay * begin))
        if decay <= 0.0 or left <= _SETTLED_SHARE:
            continue
        turns = int(np.ceil(np.log(1.0 / _SETTLED_SHARE) / decay * abs(transient.speed) / (2.0 * np.pi)))
        hertz = float(signature.modes.frequencies_hz[mode])
        message = (
            f"{line.named.name} at {line.frequency:.5g} Hz stands near a coupled mode of {hertz:.5g} Hz whose free "
            f"vibration has fallen to {100.0 * left:.2g} % of its start when the record begins, so the line may be "
            f"off: take transient.discard = {turns} revolutions for {100.0 * _SETTLED_SHARE:.0f} %, or `steady`"
        )
        warnings.append(warning("settling", message, frequency_hz=line.frequency, mode_hz=hertz, left=left))
    return warnings


def beyond_limit_warnings(transient: SolvedTransient) -> list[dict[str, Any]]:
    """Warn of sensors most of whose power lies above the frequency up to which the housing's modes are complete.

    Parameters
    ----------
    transient : SolvedTransient
        Transient whose spectra reach beyond that frequency; a long record is stored up to it only.
    """
    if transient.record.sampling.is_long:
        return []
    limit = transient.trusted_limit
    parts: dict[str, float] = {}
    for name, spectrum in transient.sensor_spectra.items():
        below, whole = (float(spectrum.rms(end)) for end in (limit, np.inf))
        if whole > 0.0 and 1.0 - (below / whole) ** 2 > _UNWARNED_POWER_ABOVE_LIMIT:
            parts[name] = 1.0 - (below / whole) ** 2
    if not parts:
        return []
    listed = ", ".join(f"{name} {100.0 * part:.3g} %" for name, part in parts.items())
    message = (
        f"most of the power of the acceleration lies above {limit:.0f} Hz, where modes of the housing are missing "
        f"({listed}): rms, peaks and sounds are without it; raise housing.frequency_limit or housing.modes"
    )
    return [warning("power beyond the limit", message, trusted_below_hz=limit, parts=parts)]


def operation_warnings(machine: Machine) -> list[dict[str, Any]]:
    """Warn of gear pairs without torque in a loaded train, and of torque lines that miss the torque of operation.

    Outputs that are named may leave a pair idle on purpose.
    """
    if not machine.gear_pairs:
        return []
    warnings = []
    torques = np.abs(machine.pair_torques)
    for pair, torque in zip(machine.gear_pairs, torques, strict=True):
        if not machine.outputs and torques.max() > 0.0 and torque <= _LOAD_ROUNDING * torques.max():
            message = (
                f"{pair.label} carries no torque, as nothing is taken off behind it: are its driver and driven "
                "exchanged, or does an [[operation.output]] lack?"
            )
            warnings.append(warning("idle gear pair", message, gear_pair=f"{pair.driver} -> {pair.driven}"))
    for name, line in (("motor", machine.motor), ("load", machine.load)):
        if line is None:
            continue
        torque = line.at(abs(machine.speed))
        if abs(torque - machine.torque) > _OFF_LINE * max(abs(torque), abs(machine.torque)):
            message = (
                f"[operation.{name}] has {torque:.4g} N m at the speed of operation, where the torque is "
                f"{machine.torque:.4g} N m: only a [transient.run] whose speed is free follows the line, all else "
                "has the torque"
            )
            warnings.append(warning("torque line", message, line=name, line_n_m=torque, torque_n_m=machine.torque))
    return warnings


def unbalanced_torque_warnings(machine: Machine, run: Run | None) -> list[dict[str, Any]]:
    """Warn of torques over time that do not balance, so that a train turns away from its nominal rotation."""
    net, free = machine.unbalanced_torque, isinstance(run, FreeRun)
    if net == 0.0:
        return []
    speed = "the speed told is that of motor and load alone" if free else "its speed is no longer that of operation"
    remedy = "put them into [operation.motor] and [operation.load]" if free else "balance them, or take a free run"
    message = (
        f"torques `over_time` leave up to {net:.4g} N m at the first driver unbalanced: the train turns away from its "
        f"nominal rotation, {speed}, and meshes, unbalance and spectra follow the nominal one; {remedy}"
    )
    return [warning("unbalanced torque", message, torque_n_m=net)]


def constant_speed_warnings(machine: Machine) -> list[dict[str, Any]]:
    """Warn of loads over time, which have no part in a motion that repeats at constant speed and torque."""
    left_out = [key for key in ("over_time",) if machine.torque_over_time is not None]
    left_out += ["output.over_time" for output in machine.outputs if output.over_time is not None][:1]
    if machine.base is not None and any(isinstance(part, BaseHistory) for part in machine.base.parts):
        left_out.append("base.over_time")
    if not left_out:
        return []
    keys = " and ".join(f"operation.{key}" for key in left_out)
    message = f"{keys} take no part in a motion that repeats, which is that at constant torque; `run` has them"
    return [warning("loads over time", message, keys=[f"operation.{key}" for key in left_out])]


FASTEST = 5e5
"""Speed factor n d_m of a rolling bearing [mm/min] beyond which the centrifugal force of its elements is warned of.

At it a ball of a 6308 (65 mm, 15 mm) is thrown outwards with 44 N, which is 3 % of the load of the most loaded one
where the bearing carries a twentieth of its dynamic rating.
"""


def centrifugal_warnings(
    bearings: Iterable[tuple[str, RollingBearing, float]], largest: Mapping[str, float] | None = None
) -> list[dict[str, Any]]:
    """Warn of rolling bearings whose elements' centrifugal force, which their equilibrium leaves out, matters.

    Parameters
    ----------
    bearings : iterable of (str, RollingBearing, float)
        Name, elements and shaft speed of each bearing [rad/s].
    largest : mapping of str to float, optional
        Load of the most loaded element on the outer ring by bearing, where it is known [N].
    """
    warnings = []
    for name, bearing, speed in bearings:
        row = max(bearing.rows, key=lambda candidate: candidate.pitch_diameter)
        rpm = abs(speed) * 60.0 / _TWO_PI
        factor = rpm * 1e3 * row.pitch_diameter
        if factor <= FASTEST:
            continue
        force, load = row.centrifugal_force(speed), (largest or {}).get(name)
        beside = "" if load is None else f", beside {load:.3g} N on the most loaded one"
        warnings.append(
            warning(
                "bearing speed",
                f'bearing "{name}": n·d_m = {factor:.3g} mm/min ({rpm:.5g} rpm, pitch circle '
                f"{1e3 * row.pitch_diameter:.4g} mm), above {FASTEST:.0f}: its elements are thrown on the outer ring "
                f"with {force:.3g} N each{beside}; the equilibrium leaves that out, so pressure and life of the outer "
                "ring are too favourable, and contact angles and stiffness are those at low speed",
                bearing=name,
                speed_factor_mm_per_min=factor,
                centrifugal_force_n=force,
            )
        )
    return warnings


_TWO_PI = 2.0 * np.pi
_NAMED_MODES = 5  # growing modes named one by one


def unstable_modes_warnings(stability: Stability) -> list[dict[str, Any]]:
    """One warning for each growing mode, the fastest first; beyond a few they are counted."""
    warnings = []
    for mode in stability.growing[:_NAMED_MODES]:
        frequency = abs(mode.eigenvalue) / _TWO_PI
        where = f" ({mode.where})" if mode.where else ""
        fed = ", ".join(part.name for part, _ in mode.feeders[:3])
        warnings.append(
            warning(
                "unstable mode",
                f"the coupled {mode.kind} mode{where} at {frequency:.5g} Hz has the damping ratio "
                f"{mode.damping_ratio:.3g}: it grows by itself"
                + (f", fed by {fed}" if fed else "")
                + "; motions of this machine mean nothing beyond its onset",
                frequency_hz=frequency,
                damping_ratio=mode.damping_ratio,
                kind=mode.kind,
                where=mode.where,
            )
        )
    if len(stability.growing) > _NAMED_MODES:
        warnings.append(
            warning("unstable mode", f"{len(stability.growing) - _NAMED_MODES} further coupled modes grow as well")
        )
    return warnings


def machine_warnings(machine: CoupledMachine) -> list[dict[str, Any]]:
    """Warnings of the growing modes of a machine about its mean contact.

    Raises
    ------
    gearwhine.coupling.ModesError
        Where modes fail their proof.
    """
    system = machine.system
    return unstable_modes_warnings(coupled_stability(coupled_modes(system, mean_contact(system))))


def parted_flank_warnings(machine: CoupledMachine, contact_loss: FloatArray) -> list[dict[str, Any]]:
    """Warn of flanks that part in motion and whose resistance to tilting, linear about the mean load, holds shafts.

    Parameters
    ----------
    machine : CoupledMachine
    contact_loss : ndarray, shape (c,)
        Part of the time in which the flanks of each contact are apart.
    """
    system = machine.system
    rigid, stiffest = system.rigid_body_motions
    tilts = [
        one
        for one in system.linear
        if one.of_contact is not None and contact_loss[one.of_contact] > _UNWARNED_TIME_APART
    ]
    if not tilts:
        return []
    held = system.mean_stiffness + stiffest * rigid @ rigid.T
    warnings = []
    for tilt in tilts:
        assert tilt.of_contact is not None
        yielding = tilt.directions.T @ np.linalg.solve(held, tilt.directions)
        # Part of a moment on the slope of the face that its flanks resist, and not the shafts.
        part = float((tilt.stiffness @ yielding)[0, 0])
        name, loss = system.contacts[tilt.of_contact].name, float(contact_loss[tilt.of_contact])
        if part > _UNWARNED_TILT_RESISTANCE:
            message = (
                f"{name}: flanks are apart {100.0 * loss:.2g} % of the time, in which they resist no tilt of the "
                f"shafts; the motion keeps that resistance, {100.0 * part:.2g} % of all against a tilt of the face, "
                "as under the mean load"
            )
            warnings.append(warning("parted flanks", message, contact=name, contact_loss=loss, part=part))
    return warnings


_BANDS = 8  # bands of equal width up to the limit
_OF_A_BAND = 12  # frequencies in each band


def add_uncertainty(document: dict[str, Any], error: BasisError | None, limit_hz: float | None) -> None:
    """Add ``uncertainty`` to every line of the document's sensors, and its course by bands under ``basis_error``.

    Parameters
    ----------
    document : dict
        Document with ``sensors``, whose ``peaks`` or ``lines`` have a ``frequency_hz``, or with ``motions`` that have
        such sensors.
    error : BasisError or None
        None, where no basis is behind the lines: nothing is added.
    limit_hz : float or None
        Upper end of the bands; no bands where it is not given.
    """
    if error is None:
        return
    rows = _sensor_lines(document)
    frequencies = np.unique([line["frequency_hz"] for _, line in rows])
    errors = error.at(_TWO_PI * frequencies)
    for name, line in rows:
        line["uncertainty"] = float(errors[name][np.searchsorted(frequencies, line["frequency_hz"])])
    if limit_hz is not None:
        document["basis_error"] = _bands(error, limit_hz)


def _sensor_lines(document: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Return the lines of a document's sensors, and of those of its motions, each with the sensor's name."""
    holders = [document, *document.get("motions", ())]
    sensors = [sensor for holder in holders for sensor in holder.get("sensors", ())]
    return [(sensor["name"], line) for sensor in sensors for key in ("peaks", "lines") for line in sensor.get(key, ())]


def add_mechanisms(document: dict[str, Any], mechanisms: LineMechanisms, within_hz: float = 0.0) -> None:
    """Add its mechanisms and its band by damping to every line of the document's sensors.

    ``parts`` are the amplitudes by what excites the line, ``part_shares`` the parts in phase with their sum, and
    ``parts_together_m_per_s2`` the amplitude of the sum, by the linear model; ``band_db`` is [below, above], all
    damping doubled and halved. ``mesh_lines`` have them by sensor. What stands in a document over a run is no line: it
    has the band alone.

    Parameters
    ----------
    document : dict
    mechanisms : LineMechanisms
    within_hz : float
        Distance within which the frequencies of lines are known [Hz].
    """
    rows, harmonics = _sensor_lines(document), document.get("mesh_lines") or ()
    frequencies = np.unique([line["frequency_hz"] for line in (*(line for _, line in rows), *harmonics)])
    frequencies = frequencies[frequencies > 0.0]
    if not frequencies.size or not mechanisms.machine.sensor_rows:
        return
    within = _TWO_PI * within_hz
    bands = DampingBand(mechanisms).at(_TWO_PI * frequencies, within)
    steady = document.get("run") is None
    parts = [mechanisms.parts(_TWO_PI * hertz, within) for hertz in frequencies.tolist()] if steady else None

    def figures(sensor: str, hertz: float) -> dict[str, Any]:
        place = int(np.searchsorted(frequencies, hertz))
        found: dict[str, Any] = {"band_db": bands[sensor][place].tolist()}
        if parts is not None and sensor in parts[place]:
            of_line = parts[place][sensor]
            found |= {
                "parts": of_line.amplitudes,
                "part_shares": of_line.shares,
                "parts_together_m_per_s2": of_line.together,
            }
        return found

    for sensor, line in rows:
        if line["frequency_hz"] > 0.0:
            line.update(figures(sensor, line["frequency_hz"]))
    for line in harmonics:
        by_sensor = {sensor: figures(sensor, line["frequency_hz"]) for sensor in bands}
        for key in ("band_db", "parts", "part_shares", "parts_together_m_per_s2"):
            line[key] = {sensor: found[key] for sensor, found in by_sensor.items() if key in found}


def _bands(error: BasisError, limit_hz: float) -> list[dict[str, Any]]:
    """Median and largest relative error of each sensor, by bands."""
    edges = np.linspace(0.0, limit_hz, _BANDS + 1)
    inner = (np.arange(_OF_A_BAND) + 0.5) / _OF_A_BAND
    frequencies = edges[:-1, None] + np.diff(edges)[:, None] * inner
    errors = {name: values.reshape(_BANDS, -1) for name, values in error.at(_TWO_PI * frequencies.ravel()).items()}
    return [
        {
            "from_hz": float(edges[band]),
            "to_hz": float(edges[band + 1]),
            "sensors": [
                {"name": name, "median": float(np.median(values[band])), "largest": float(values[band].max())}
                for name, values in errors.items()
            ],
        }
        for band in range(_BANDS)
    ]
