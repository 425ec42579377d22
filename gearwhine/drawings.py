"""Which mode shapes to draw, and drawing them: pictures, or models that move."""

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from gearwhine.case import CaseError, Problem
from gearwhine.progress import Progress
from gearwhine.stages.housing import SolvedHousing, strongest_modes

if TYPE_CHECKING:
    from housing import Comparison

ModeFormat = Literal["png", "glb"]

_MOST_MODES = 5000
_DOMINANT = 8


def draw_modes(
    housing: SolvedHousing,
    comparison: "Comparison | None",
    which: str,
    view: str,
    mode_format: ModeFormat,
    place: Path,
    progress: Progress,
) -> list[str]:
    """Draw modes into a folder and name the files.

    Parameters
    ----------
    housing : SolvedHousing
    comparison : Comparison or None
        With measured modes; those paired with one count as the dominant ones and say so in the picture.
    which : str
        ``dominant``, ``all``, or numbers as :func:`parse_numbers` reads them.
    view : str
        From where to look at pictures.
    mode_format : {"png", "glb"}
        A picture of each mode and one sheet of all; or a model of each that moves.
    place : path
    progress : callable
    """
    notes = {}
    if comparison is not None:
        notes = {
            pair.mode: f"measured {pair.measured / (2.0 * np.pi):.0f} Hz ({pair.error_percent:+.1f} %"
            + (")" if pair.mac is None else f", MAC {pair.mac:.2f})")
            for pair in comparison.pairs
        }
    count = len(housing.modes.frequencies)
    if which == "all":
        numbers = list(range(1, count + 1))
    elif which == "dominant":
        numbers = sorted(notes) if notes else strongest_modes(housing, _DOMINANT)
    else:
        numbers = parse_numbers(which, count)
    if mode_format == "glb":
        from housing.gltf import write_mode_models

        return [path.name for path in write_mode_models(housing.mesh, housing.modes, numbers, place)]
    from housing import pictures

    files = pictures.render_modes(
        housing.mesh, housing.modes, numbers, place, notes=notes, view=view, progress=progress
    )
    if len(numbers) > 1:
        progress("drawing all on one sheet")
        sheet = place / "modes.png"
        files.append(pictures.render_gallery(housing.mesh, housing.modes, numbers, sheet, notes=notes, view=view))
    return [path.name for path in files]


def parse_numbers(text: str, count: int | None) -> list[int]:
    """Mode numbers from text such as ``1,4-6``; ``count`` is how many modes there are, where that is known.

    Raises
    ------
    CaseError
        For anything else, or a mode that does not exist.
    """
    numbers: list[int] = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        if not first.strip().isdecimal() or (last and not last.strip().isdecimal()):
            raise CaseError([Problem("--modes", text, "'dominant', 'all', or numbers such as '1,4,9' or '1-6'")])
        if int(last or first) > _MOST_MODES:
            raise CaseError([Problem("--modes", text, f"mode numbers of at most {_MOST_MODES}")])
        numbers += range(int(first), int(last or first) + 1)
    missing = [number for number in numbers if number < 1 or (count is not None and number > count)]
    if missing or not numbers:
        raise CaseError(
            [Problem("--modes", text, f"mode numbers from 1 to {count if count is not None else 'the last'}")]
        )
    return numbers
