"""Radiation of a housing's modes over frequency, kept in the mode cache beside the modes that radiate."""

from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial
from typing import Any

from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.housing import HousingModes
from gearwhine.housing.acoustics.modal_radiation import ARRAYS, POINTS, ModalRadiation
from gearwhine.housing.acoustics.radiation import HousingRadiation
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress, in_order, silent
from gearwhine.numerics.source_digest import source_digest

_NOTE = "radiation"
_CODE = (
    "gearwhine.housing.acoustics",
    "gearwhine.housing.storage",
    "gearwhine.coupling.sound.acoustics",
    "gearwhine.coupling.sound.solution",
    "gearwhine.solve.kept_radiation",
)
_WITHOUT_EFFECT = {"lines", "microphone", "microphone_box"}


def kept_radiation(
    acoustics: Acoustics,
    housing: HousingModes,
    radiation: HousingRadiation,
    places: FloatArray,
    between: tuple[float, float],
    progress: Progress = silent,
) -> tuple[ModalRadiation, HousingModes]:
    """Return the radiation of a housing's modes over frequency, solved where the mode cache has it not.

    Parameters
    ----------
    acoustics : Acoustics
    housing : HousingModes
    radiation : HousingRadiation
        Radiation of the housing.
    places : ndarray, shape (m, 3)
        Places of the microphones [m].
    between : tuple of float
        Lowest and highest frequency [Hz].
    progress : callable

    Returns
    -------
    ModalRadiation
    HousingModes
        The housing, whose record holds it.
    """
    key = _key(acoustics, housing.widest_bore, places, between)
    record = housing.record
    if record.notes.get(_NOTE) == key:
        return ModalRadiation.of_arrays(record.extras), housing
    solved = ModalRadiation.solve(radiation, places, *between, points=POINTS, each=partial(_each, progress=progress))
    # All arrays of an earlier table are removed: its microphones must not stay where there are none now.
    other_extras = {name: array for name, array in record.extras.items() if name not in ARRAYS}
    extras = other_extras | solved.arrays()
    updated = replace(record, extras=extras, notes={**record.notes, _NOTE: key})
    return solved, replace(housing, record=updated, source_holds=False)


def _each(solve: Any, frequencies: Sequence[float], progress: Progress) -> tuple[Any, ...]:
    return in_order(solve, frequencies, "radiation of the modes over frequency", progress)


def _key(acoustics: Acoustics, widest_bore: float | None, places: FloatArray, between: tuple[float, float]) -> str:
    return content_key(
        {
            "acoustics": {name: value for name, value in asdict(acoustics).items() if name not in _WITHOUT_EFFECT},
            "widest_bore": widest_bore,
            "places": places.tolist(),
            "between": list(between),
            "source": source_digest(*_CODE),
        }
    )
