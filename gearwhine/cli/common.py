"""Common course of a command on a case: options, reading the case, progress, and the result shown or printed.

The options are the case's name, the output folder, JSON, settings, quiet and fresh.
"""

import os
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter, Token

if TYPE_CHECKING:
    from gearwhine.analyses.result import Result
    from gearwhine.case import LoadedCase, Problem
    from gearwhine.numerics.progress import Progress


def _folder(type_: object, tokens: Sequence[Token]) -> Path:
    """Return the named folder; refuse an empty name, though as a path it is the current folder."""
    (token,) = tokens
    if not token.value.strip():
        raise ValueError("--output is empty; expected the name of a folder, such as results")
    return Path(token.value)


@Parameter(name="*")
@dataclass(frozen=True)
class Common:
    """Options of every command on a case."""

    output: Annotated[
        Path | None, Parameter(name=["--output", "-o"], converter=_folder, help="Folder for the results.")
    ] = None
    json: Annotated[bool, Parameter(name="--json", negative=(), help="Print one JSON document and nothing else.")] = (
        False
    )
    settings: Annotated[
        list[str],
        Parameter(
            name=["--set"],
            negative=(),
            consume_multiple=False,
            help="Change the case: key.path=value, such as --set housing.box.mesh_size='20 mm'. May be repeated.",
        ),
    ] = field(default_factory=list)
    quiet: Annotated[bool, Parameter(name=["--quiet", "-q"], negative=(), help="Show no progress.")] = False


NONE_GIVEN = Common()
CaseName = Annotated[str, Parameter(help="A case file (TOML), or the name of a bundled case.")]

_LONGEST_NAME, _LONGEST_PATH = 255, 3500  # bytes that common file systems take; the path leaves room for file names
_LONGEST_SHOWN = 60
_RESULTS = (".csv", ".glb", ".html", ".json", ".nc", ".png", ".toml", ".unv", ".vtu")


def on_case(
    name: str,
    common: Common,
    work: Callable[["LoadedCase", "Progress"], dict[str, Any]],
    show: Callable[[dict[str, Any]], None],
    command: str,
    *,
    writes: Sequence[str] = (),
    always_writes: bool = False,
) -> dict[str, Any]:
    """Read the case, do the work under a progress display, hand the result over and return it.

    Parameters
    ----------
    name, common, work, show
    command : str
        Name of the command.
    writes : sequence of str
        Names of files that it writes beside those of its declaration, see :mod:`gearwhine.commands`.
    always_writes : bool
        Whether it writes without ``--output``, too.
    """
    from gearwhine.case import CaseError, load_case
    from gearwhine.numerics.findings import RefusedPartError
    from gearwhine.output.quantity import add_warnings
    from gearwhine.output.terminal import say_warning
    from gearwhine.progress import shown

    loaded = load_case(name, common.settings)
    if common.output is not None:
        _check_folder(common.output)
    folder = _default_folder(name) if common.output is None and always_writes else common.output
    if folder is not None:
        _check_files(command, folder, loaded, writes)
    for warning in loaded.warnings:
        say_warning(warning)
    with shown(quiet=common.quiet) as progress:
        try:
            document = work(loaded, progress)
        except CaseError as error:
            error.problems = tuple(_in_file(problem, loaded.source.name) for problem in error.problems)
            raise
        except RefusedPartError as error:
            # Parts that do not fit each other, such as bearings that let the thrust of gears through, know no file.
            error.args = (f"{loaded.source.name}: {error}",)
            raise
    add_warnings(document)
    for warning in document["warnings"]:
        if warning["message"] not in loaded.warnings:
            say_warning(warning["message"])
    hand_over(document, common, show)
    return document


def _in_file(problem: "Problem", name: str) -> "Problem":
    """Return a problem of a key with the file of the case; one of an option as it is."""
    from gearwhine.case import Case

    of_key = re.split(r"[.[]", problem.key)[0] in Case.model_fields
    return replace(problem, source=name) if of_key and not problem.source else problem


def written(
    result: "Result[Any]", folder: Path | None, progress: "Progress", *, pictures: bool = True
) -> dict[str, Any]:
    """Write a result where a folder is given, and return its document."""
    return (result if folder is None else result.stored(folder, pictures=pictures, progress=progress)).document


def results_folder(case: str, common: Common) -> Path:
    """Return the folder for a command that always writes, once it is known to take files."""
    folder = common.output if common.output is not None else _default_folder(case)
    _check_folder(folder)
    return folder


def hand_over(document: dict[str, Any], common: Common, show: Callable[[dict[str, Any]], None]) -> None:
    """Print a document: as JSON where that is asked for, else as ``show`` does for a person."""
    from gearwhine.output import finite, json_text

    if common.json:
        sys.stdout.write(json_text(finite(document)) + "\n")
    else:
        show(document)


def _default_folder(case: str) -> Path:
    return Path(f"{Path(case).stem}-results")


def _check_files(command: str, folder: Path, loaded: "LoadedCase", writes: Sequence[str]) -> None:
    """Refuse a folder in which results would replace files of the user, before the work begins."""
    from gearwhine.case import CaseError, Problem
    from gearwhine.failures import ForeignFileError
    from gearwhine.output.files import finish_moves
    from gearwhine.output.own_files import require_free

    finish_moves(folder)
    try:
        require_free(command, folder, loaded.source.input_paths, writes)
    except ForeignFileError as error:
        raise CaseError(
            [Problem("--output", str(folder), f"another folder, or these files elsewhere: {error}")]
        ) from error


def _check_folder(folder: Path) -> None:
    """Refuse a folder that cannot hold results, before the work begins and without creating it."""
    from gearwhine.case import CaseError, Problem
    from gearwhine.commands import COMMANDS

    if any(len(os.fsencode(part)) > _LONGEST_NAME for part in folder.parts) or len(os.fsencode(folder)) > _LONGEST_PATH:
        short_name = f"{str(folder)[:_LONGEST_SHOWN]}…"
        raise CaseError([Problem("--output", short_name, f"a folder whose name has at most {_LONGEST_NAME} bytes")])
    place = folder
    while not place.exists() and place != place.parent:
        if place.is_symlink():
            raise CaseError([Problem("--output", str(folder), f"a folder; {place} is a link that leads nowhere")])
        place = place.parent
    if not place.is_dir() or not os.access(place, os.W_OK):
        reason = "is a file" if place.is_file() else "cannot be written to"
        raise CaseError([Problem("--output", str(folder), f"a folder for the results; {place} {reason}")])
    if folder.is_dir():
        folders = [path.name for path in sorted(folder.iterdir()) if path.suffix in _RESULTS and path.is_dir()]
        if folders:
            expected = f"a folder for the results; in this one {folders[0]!r}, where a file would go, is a folder"
            raise CaseError([Problem("--output", str(folder), expected)])
        for name in COMMANDS:
            place = folder / name
            if place.is_symlink() or (place.exists() and not place.is_dir()):
                expected = f"a folder for the results; in this one {name!r}, where that command's go, is no folder"
                raise CaseError([Problem("--output", str(folder), expected)])
