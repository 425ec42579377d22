"""Proofs of a sound: power through the surface against that in the far field, and the pressure inside the surface."""

from collections.abc import Sequence
from typing import Any, Protocol, TypeVar

import numpy as np

from gearwhine.output.quantity import warning
from housing.acoustics.boundary_elements import SoundField
from housing.acoustics.radiation import EquivalentField, RadiatedSound
from housing.acoustics.sound_levels import power_level

_FLAT = 1e-6  # of a face's size: height over the plane that it lies in

COUNTS = 1e-4
"""Part of the whole power above which a line has to prove its own, and radiation efficiency above which a mode has."""

LEAK = 0.1
"""Pressure inside, relative to that on the surface, above which a solution is doubtful."""


def power_balance_db(sound: RadiatedSound) -> float | None:
    """Level of the power through the surface over that in the far field [dB]; None of an estimate, which has one."""
    if any(isinstance(field, EquivalentField) for field in sound.fields):
        return None
    return float(power_level(sound.surface_power) - power_level(sound.power)) if sound.power > 0.0 else 0.0


def interior_pressure(sound: RadiatedSound) -> float | None:
    """Pressure inside relative to that on the surface, where zero is exact; None of faces and of an estimate."""
    proved = [one for one in sound.fields if isinstance(one, SoundField) and not _in_baffle(one)]
    return max((field.interior_residual for field in proved), default=None)


def _in_baffle(field: SoundField) -> bool:
    """Whether a field is that of a flat face in the hard plane, which has no inside."""
    if field.plane is None:
        return False
    points = field.surface.points
    return bool(np.abs(field.plane.height(points)).max() <= _FLAT * np.ptp(points, axis=0).max())


def require_proof(sound: RadiatedSound, what: str) -> list[dict[str, Any]]:
    """Hold a sound against its proofs; return a warning where the pressure inside is large.

    Raises
    ------
    housing.HousingError
        Where the powers through the surface and in the far field differ by more than 10 %.
    """
    sound.require_balance()
    leak = interior_pressure(sound)
    if leak is None or leak <= LEAK:
        return []
    message = (
        f"the sound of {what} at {sound.frequency_hz:.1f} Hz is doubtful: the pressure inside the radiating surface is "
        f"{100.0 * leak:.2g} % of that on it, where zero is exact; use smaller triangles"
    )
    return [warning("interior_pressure", message, frequency_hz=sound.frequency_hz, relative=leak)]


class Powers(Protocol):
    """Sound power by two ways [W]."""

    @property
    def power(self) -> float: ...  # noqa: D102
    @property
    def surface_power(self) -> float: ...  # noqa: D102


Sound = TypeVar("Sound", bound=Powers)


def counting(sounds: Sequence[Sound]) -> list[Sound]:
    """Return those of a motion's lines whose power counts beside that of all, by either way to find it."""
    least = COUNTS * sum(sound.power for sound in sounds)
    return [sound for sound in sounds if max(sound.power, sound.surface_power) > least]


def require_proofs(sounds: Sequence[RadiatedSound]) -> list[dict[str, Any]]:
    """Hold the sounds of all lines of a motion against their proofs, but for those too weak to count.

    Returns
    -------
    list of dict
        Warnings.

    Raises
    ------
    housing.HousingError
        As :func:`require_proof`.
    """
    return [told for sound in counting(sounds) for told in require_proof(sound, "a line")]
