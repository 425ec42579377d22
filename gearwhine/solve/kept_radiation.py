"""Radiation of a housing's modes, each at its frequency and all over frequency, kept beside them in the mode cache."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.coupling import CoupledMachine
from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.coupling.sound.motion_lines import MotionLines
from gearwhine.coupling.sound.solution import ModeSound, SolvedSound, SoundOfModes, solve_sound
from gearwhine.housing import HousingModes
from gearwhine.housing.acoustics.known_source import SourceError
from gearwhine.housing.acoustics.modal_radiation import ARRAYS, POINTS, ModalRadiation
from gearwhine.housing.acoustics.radiation import HousingRadiation
from gearwhine.housing.acoustics.reduced_elements import SpanningSolutions
from gearwhine.housing.modes.housing_field import HousingField
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress, in_order, silent
from gearwhine.numerics.source_digest import source_digest

_NOTE = "radiation"
_NOTE_OF_MODES = "sound of the modes"
_NOTE_OF_SPAN = "solutions that span the sound"
_CODE = (
    "gearwhine.housing.acoustics",
    "gearwhine.housing.storage",
    "gearwhine.coupling.sound.acoustics",
    "gearwhine.coupling.sound.proofs",
    "gearwhine.coupling.sound.solution",
    "gearwhine.numerics.dense_least_squares",
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
    key = _key(acoustics, housing.displacement_field, places=places.tolist(), between=list(between))
    record = housing.record
    if record.notes.get(_NOTE) == key:
        return ModalRadiation.of_arrays(record.extras), housing
    spans = KeptSpan(acoustics, housing)
    radiation = spans.spanned(radiation, np.linspace(*between, POINTS), between, progress)
    housing, record = spans.housing, spans.housing.record
    solved = ModalRadiation.solve(radiation, places, *between, points=POINTS, each=partial(_each, progress=progress))
    # All arrays of an earlier table are removed: its microphones must not stay where there are none now.
    other_extras = {name: array for name, array in record.extras.items() if name not in ARRAYS}
    extras = other_extras | solved.arrays()
    updated = replace(record, extras=extras, notes={**record.notes, _NOTE: key})
    return solved, replace(housing, record=updated, source_holds=False)


def _each(solve: Any, frequencies: Sequence[float], progress: Progress) -> tuple[Any, ...]:
    return in_order(solve, frequencies, "radiation of the modes over frequency", progress)


def sound_of_housing(
    acoustics: Acoustics,
    housing: HousingModes,
    motion: MotionLines | None = None,
    machine: CoupledMachine | None = None,
    progress: Progress = silent,
) -> tuple[SolvedSound, HousingModes]:
    """Solve for the sound of a housing's modes, unless the mode cache has it, and of the lines of a motion.

    Parameters
    ----------
    acoustics, housing, motion, machine, progress
        See :func:`gearwhine.coupling.sound.solution.solve_sound`.

    Returns
    -------
    SolvedSound
    HousingModes
        The housing, whose record holds the sound of the modes.
    """
    field = housing.displacement_field
    key = _key(acoustics, field, limit_hz=acoustics.limit_hz(field))
    kept = housing.record.notes.get(_NOTE_OF_MODES, {})
    of_modes = _of_text(kept["sound"]) if kept.get("key") == key else None
    if of_modes is not None:
        progress("sound of the housing's modes read from the mode cache")
    spans = KeptSpan(acoustics, housing)
    solved = solve_sound(acoustics, field, motion, machine, progress, of_modes=of_modes, span=spans.spanned)
    if of_modes is None:
        # As text, since the errors of known sources may be infinite.
        note = {"key": key, "sound": json.dumps(asdict(solved.of_modes))}
        record = spans.housing.record
        record = replace(record, notes={**record.notes, _NOTE_OF_MODES: note})
        return solved, replace(housing, record=record, source_holds=False)
    return solved, spans.housing


class KeptSpan:
    """Solutions that span the sound of a housing's modes at all frequencies, kept beside the modes.

    Parameters
    ----------
    acoustics : Acoustics
    housing : HousingModes

    Attributes
    ----------
    housing : HousingModes
        The housing, whose record holds them once they are solved.
    """

    def __init__(self, acoustics: Acoustics, housing: HousingModes) -> None:
        self.housing = housing
        self._key = _key(acoustics, housing.displacement_field)

    def spanned(
        self,
        radiation: HousingRadiation,
        wanted: FloatArray,
        between: tuple[float, float],
        progress: Progress = silent,
    ) -> HousingRadiation:
        """Return the radiation with kept solutions, or with solutions that it then keeps.

        See :meth:`gearwhine.housing.acoustics.radiation.HousingRadiation.spanned`.
        """
        record, known = self.housing.record, None
        if record.notes.get(_NOTE_OF_SPAN) == self._key:
            known = SpanningSolutions.of_arrays(record.extras)
        spanned = radiation.spanned(wanted, between, progress, known)
        if spanned is not radiation and spanned.reduced is not None and spanned.reduced.solutions is not known:
            extras = {**record.extras, **spanned.reduced.solutions.arrays()}
            updated = replace(record, extras=extras, notes={**record.notes, _NOTE_OF_SPAN: self._key})
            self.housing = replace(self.housing, record=updated, source_holds=False)
        return spanned


def _of_text(text: str) -> SoundOfModes:
    """Return the sound of modes that stands in a note."""
    document = json.loads(text)
    modes = []
    for mode in document["modes"]:
        error = mode["known_source"]
        source = None if error is None else SourceError(**(error | {"place": tuple(error["place"])}))
        modes.append(ModeSound(**(mode | {"known_source": source})))
    return SoundOfModes(tuple(modes), tuple(document["warnings"]))


def _key(acoustics: Acoustics, field: HousingField, **of_solution: Any) -> str:
    return content_key(
        {
            "acoustics": {name: value for name, value in asdict(acoustics).items() if name not in _WITHOUT_EFFECT},
            "widest_bore": field.widest_bore,
            "field": _digest(field),
            "source": source_digest(*_CODE),
            **of_solution,
        }
    )


def _digest(field: HousingField) -> str:
    """SHA-256 of a displacement field: its mesh with the named faces, and frequencies and shapes of its modes."""
    total = hashlib.sha256()
    arrays: list[tuple[str, npt.NDArray[Any]]] = [
        ("points", field.mesh.points),
        ("frequencies", field.modes.frequencies),
        ("shapes", field.shapes),
    ]
    arrays += [("elements", block.nodes) for block in field.mesh.blocks]
    arrays += [(name, block.nodes) for name, facets in sorted(field.mesh.surfaces.items()) for block in facets]
    for name, values in arrays:
        total.update(f"{name}\0{values.shape}\0{values.dtype.str}\0".encode())
        total.update(np.ascontiguousarray(values).data)
    return total.hexdigest()
