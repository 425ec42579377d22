"""Proofs of a sound as they are told: power through the surface over that in the far field, and the pressure inside."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearwhine.output.quantity import warning
from housing.acoustics.boundary_elements import SoundField
from housing.acoustics.radiation import EquivalentField, RadiatedSound, require_balances
from housing.acoustics.sound_levels import power_level


def power_balance_db(sound: RadiatedSound) -> float | None:
    """Level of the power through the surface over that in the far field [dB]; None of an estimate, which has one."""
    if any(isinstance(field, EquivalentField) for field in sound.fields):
        return None
    return float(power_level(sound.surface_power) - power_level(sound.power)) if sound.power > 0.0 else 0.0


def interior_pressure(sound: RadiatedSound) -> float | None:
    """Pressure inside relative to that on the surface, where zero is exact; None where there is no such proof."""
    closed = any(isinstance(one, SoundField) and not one.baffled for one in sound.fields)
    return sound.interior_residual if closed and np.isfinite(sound.interior_residual) else None


def doubts(sound: RadiatedSound, what: str) -> list[dict[str, Any]]:
    """Return a warning where the pressure inside does not prove the sound of a line or a mode."""
    if sound.doubt is None:
        return []
    return [
        warning(
            "interior_pressure",
            f"the sound of {what} at {sound.frequency_hz:.1f} Hz is doubtful: {sound.doubt}",
            frequency_hz=sound.frequency_hz,
            relative=interior_pressure(sound),
        )
    ]


def require_proofs(
    sounds: Sequence[RadiatedSound], what: str = "a line", *, alone: bool = False
) -> list[dict[str, Any]]:
    """Hold sounds against their proofs, but for those too weak to count.

    Parameters
    ----------
    sounds : sequence of RadiatedSound
    what : str
        Makes the sound, in words.
    alone : bool
        As in :func:`housing.acoustics.radiation.require_balances`.

    Returns
    -------
    list of dict
        Warnings.

    Raises
    ------
    housing.HousingError
        As :func:`housing.acoustics.radiation.require_balances`.
    """
    return [told for sound in require_balances(sounds, alone=alone) for told in doubts(sound, what)]
