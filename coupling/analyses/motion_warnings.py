"""Warnings of a solved motion: free vibration that is left in the record, power above the limit, flanks that part."""

import numpy as np

from gearwhine.coupling.analyses.signature import SolvedSignature, TracedLine
from gearwhine.coupling.analyses.transient import SolvedTransient
from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.result_warnings import ResultWarning, warning

_UNWARNED_POWER_ABOVE_LIMIT = 0.5  # part of the power of an acceleration above the limit without a warning
# Free vibration at the begin of a record, as a part of that at the start, without a warning.
_SETTLED_SHARE = 0.02
_UNWARNED_TIME_APART = 1e-3  # part of the time in which flanks are apart without a warning
# Part of the resistance to a tilt of the face that flanks may have without that warning.
_UNWARNED_TILT_RESISTANCE = 0.1
_MOST_CHECKED_LINES = 5  # lines of a sensor that are looked at


def settling_warnings(transient: SolvedTransient, signature: SolvedSignature) -> list[ResultWarning]:
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


def beyond_limit_warnings(transient: SolvedTransient) -> list[ResultWarning]:
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


def parted_flank_warnings(machine: CoupledMachine, contact_loss: FloatArray) -> list[ResultWarning]:
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
