"""What every command leaves in its folder: the case, the modes, its own files, and the summary that lists them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from gearwhine.case import Case, dump_case
from gearwhine.doubtful import add_warnings
from gearwhine.output import SUMMARY, earlier_drawings, finite, json_text, staging
from gearwhine.stages.housing import SolvedHousing
from gearwhine.stages.kept_modes import MODES_FILE, keep_modes


def kept_in(
    document: dict[str, Any],
    case: Case,
    folder: Path | None,
    write: Callable[[Path], None] = lambda place: None,
    housing: SolvedHousing | None = None,
) -> dict[str, Any]:
    """The document; where a folder is given, also in it, with the resolved case, the modes and what ``write`` adds."""
    add_warnings(document)
    if folder is None:
        return document
    with staging(folder) as place:
        (place / "case.toml").write_text(dump_case(case), encoding="utf-8")
        write(place)
        if housing is not None:
            keep_modes(place, housing)
        files = files_in(place, housing)
        document |= {"folder": str(folder), "files": files}
        # Drawings that stay from an earlier run are listed on, so that the next one that draws anew clears them.
        if stay := [name for name in earlier_drawings(folder) if name not in files]:
            document["earlier_drawings"] = stay
        (place / SUMMARY).write_text(json_text(finite(document)) + "\n", encoding="utf-8")
    return document


def files_in(place: Path, housing: SolvedHousing | None, *, summary: bool = True) -> list[str]:
    """The results' files: those staged, the mode file that was read and stays, and the summary last."""
    names = {str(path.relative_to(place)) for path in place.rglob("*") if path.is_file()}
    if housing is not None and housing.source is not None:
        names.add(MODES_FILE)
    return sorted(names) + ([SUMMARY] if summary else [])
