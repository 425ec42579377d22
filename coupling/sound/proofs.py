"""Proofs of a sound: power by two ways, the pressure inside, and the error of known sources inside."""

from collections.abc import Mapping, Sequence

import numpy as np

from gearwhine.housing.acoustics.boundary_elements import SoundField
from gearwhine.housing.acoustics.known_source import SourceError
from gearwhine.housing.acoustics.radiation import SOURCE_HEARD, EquivalentField, RadiatedSound, require_proved
from gearwhine.housing.acoustics.sound_levels import power_level
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.result_warnings import ResultWarning, warning

_GATHERED = ("known_source", "microphone_known_source")


def power_balance_db(sound: RadiatedSound) -> float | None:
    """Level of the power through the surface over that in the far field [dB]; None of an estimate, which has one."""
    if any(isinstance(field, EquivalentField) for field in sound.fields):
        return None
    return float(power_level(sound.surface_power) - power_level(sound.power)) if sound.power > 0.0 else 0.0


def interior_pressure(sound: RadiatedSound) -> float | None:
    """Pressure inside relative to that on the surface, where zero is exact; None where there is no such proof."""
    return sound.interior_residual if _is_closed(sound) and np.isfinite(sound.interior_residual) else None


def known_source(sound: RadiatedSound) -> SourceError | None:
    """Error of the pressure of known sources inside, at the vertices; None where there is no such proof."""
    return sound.source_error if _is_closed(sound) and np.isfinite(sound.source_error.largest) else None


def known_source_at(sound: RadiatedSound, places: FloatArray) -> FloatArray | None:
    """Error of known sources at microphones, shape (m,); None without microphones, or where there is no such proof.

    Parameters
    ----------
    sound : RadiatedSound
    places : ndarray, shape (m, 3)
        Places of the microphones [m].
    """
    return None if not len(places) or known_source(sound) is None else sound.source_error_at(places)


def _is_closed(sound: RadiatedSound) -> bool:
    return any(isinstance(field, SoundField) and not field.baffled for field in sound.fields)


def doubts(sound: RadiatedSound, source: str) -> list[ResultWarning]:
    """Return warnings where the pressure inside or known sources do not prove the sound of a line or a mode."""
    warnings = []
    error = known_source(sound)
    for name, doubt, figures in (
        ("interior_pressure", sound.doubt, {"relative": interior_pressure(sound)}),
        ("known_source", sound.source_doubt, {"relative": None if error is None else error.largest}),
    ):
        if doubt is not None:
            message = f"the sound of {source} at {sound.frequency_hz:.1f} Hz is doubtful: {doubt}"
            warnings.append(warning(name, message, frequency_hz=sound.frequency_hz, **figures))
    return warnings


def microphone_doubts(frequency_hz: float, errors: Mapping[str, float]) -> list[ResultWarning]:
    """Return a warning where the pressure at a microphone is doubtful, since that of a known source is.

    Parameters
    ----------
    frequency_hz : float
    errors : mapping of str to float
        Relative error of known sources at each microphone; the largest is reported.
    """
    name = max(errors, key=lambda source: errors[source], default=None)
    if name is None or not SOURCE_HEARD < errors[name] < np.inf:
        return []
    message = (
        f"the sound pressure at microphone {name!r} at {frequency_hz:.1f} Hz is doubtful: that of a known source "
        f"inside the radiating surface is off by {100.0 * errors[name]:.2g} % there; use smaller triangles"
    )
    return [warning("microphone_known_source", message, frequency_hz=frequency_hz, relative=errors[name])]


def gathered(warnings: Sequence[ResultWarning]) -> list[ResultWarning]:
    """Merge the warnings of known sources into the worst one, with the number of the others.

    Parameters
    ----------
    warnings : sequence of dict
        Warnings of any kind; those of other kinds stay as they are.
    """
    merged = [entry for entry in warnings if entry["name"] not in _GATHERED]
    for name in _GATHERED:
        alike = [entry for entry in warnings if entry["name"] == name]
        if alike:
            worst_entry = max(
                alike, key=lambda entry: np.inf if entry["relative"] is None else float(entry["relative"])
            )
            others = len(alike) - 1
            more = f" ({others} more {'is' if others == 1 else 'are'} doubtful, too)" if others else ""
            merged.append(worst_entry | {"message": worst_entry["message"] + more, "count": len(alike)})
    return merged


def require_proofs(
    sounds: Sequence[RadiatedSound], source: str = "a line", *, alone: bool = False
) -> list[ResultWarning]:
    """Check sounds by their proofs, except those too weak to count.

    Parameters
    ----------
    sounds : sequence of RadiatedSound
    source : str
        Source of the sound, in words.
    alone : bool
        As in :func:`gearwhine.housing.acoustics.radiation.require_proved`.

    Returns
    -------
    list of dict
        Warnings.

    Raises
    ------
    gearwhine.housing.HousingError
        As :func:`gearwhine.housing.acoustics.radiation.require_proved`.
    """
    return [entry for sound in require_proved(sounds, alone=alone) for entry in doubts(sound, source)]
