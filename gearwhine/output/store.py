"""The results folder: each command's results by themselves, with the case, its input files and when they were made.

A command's results stand in the folder itself where no other command's do, else in a sub-folder named for the command;
those of ``run`` always stand in the folder itself, and what another command left there moves to its sub-folder. The
housing's modes are shared by all.
"""

import json
import os
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from gearwhine.case import Case, dump_case
from gearwhine.commands import COMMANDS
from gearwhine.housing.storage.netcdf import Variables, read_netcdf
from gearwhine.output.files import (
    MODE_CACHE_FILE,
    SUMMARY,
    finite,
    json_text,
    listed_files,
    read_summary,
    staging,
)

DATA = "results.nc"
"""Name of the file of a result's labelled arrays."""
_FOREMOST = "run"


@dataclass(frozen=True)
class Kept:
    """Parts of an earlier result of the same analysis in a folder, which a new result there keeps.

    Attributes
    ----------
    document : mapping
        Keys of the document.
    variables : mapping
        Arrays of the file, as :class:`gearwhine.output.dataset.LabelledArrays` has them.
    files : sequence of path
        Drawings.
    """

    document: Mapping[str, Any] = field(default_factory=dict)
    variables: Variables = field(default_factory=dict)
    files: Sequence[Path] = ()


@dataclass(frozen=True)
class Option:
    """Part of a result that an option of its command adds.

    Attributes
    ----------
    keys : tuple of str
        Keys of the document; the first one names the option.
    dimensions : tuple of str
        Beginnings of the names of its dimensions in the file.
    files : str
        Pattern of the names of its drawings.
    """

    keys: tuple[str, ...]
    dimensions: tuple[str, ...]
    files: str

    def has(self, dimensions: Sequence[str]) -> bool:
        """Whether an array with these dimensions belongs to the option."""
        return any(dimension.startswith(self.dimensions) for dimension in dimensions)


def kept_options(
    options: Sequence[Option],
    same: Sequence[str],
    case: Case,
    document: Mapping[str, Any],
    place: Path,
    earlier: Mapping[str, Any],
) -> Kept:
    """Return the parts of an earlier result in a folder by options that a new one is not asked for.

    They are kept where the case, its input files and the parts that both results have are the same, number for number:
    a user who asks for one option after the other has both in the report, and does not pay for the first one twice
    (``load small-gearbox --sensitivity`` takes a minute).

    Parameters
    ----------
    options : sequence of Option
        Options of the command.
    same : sequence of str
        Keys of the document that no option changes.
    case : Case
    document : mapping
        Document of the new result.
    place : path
        Folder of the earlier result.
    earlier : mapping
        Document of the earlier result.
    """
    now = json.loads(json_text(finite(document)))
    missing = [option for option in options if option.keys[0] in earlier and option.keys[0] not in document]
    alike = all(now.get(key) == earlier.get(key) for key in same)
    alike = alike and earlier.get("input_files") == case.input_files.contents
    try:
        if not missing or not alike or (place / "case.toml").read_text(encoding="utf-8") != dump_case(case):
            return Kept()
        arrays, _ = read_netcdf(place / "results.nc")
    except (OSError, ValueError, KeyError):
        return Kept()
    names = [option.keys[0] for option in missing]
    entries: dict[str, Any] = {key: earlier[key] for option in missing for key in option.keys if key in earlier}
    warnings = [entry for entry in earlier.get("warnings", ()) if entry["name"] in names]
    variables = {
        name: array.labelled
        for name, array in arrays.items()
        if any(option.has(array.dimensions) for option in missing)
    }
    files = [file for option in missing for file in sorted(place.glob(option.files))]
    return Kept(entries | {"kept": [*entries], "warnings": [*document["warnings"], *warnings]}, variables, files)


def kept_sentence(document: Mapping[str, Any], options: Sequence[Option], alike: str) -> Iterator[str]:
    """Yield a sentence on the options that a document has from an earlier result in its folder, where it has any.

    Parameters
    ----------
    document : mapping
    options : sequence of Option
        Options of the command.
    alike : str
        Name of the parts that both results have in common.
    """
    kept_keys = document.get("kept", ())
    if names := [option.keys[0].replace("_", " ") for option in options if option.keys[0] in kept_keys]:
        yield f"Of the results that stood in the folder, of the same {alike}: {' and '.join(names)}"


def store_results(
    command: str,
    document: dict[str, Any],
    case: Case | None,
    folder: Path,
    write: Callable[[Path], None],
    *,
    modes_stored: bool = False,
) -> None:
    """Store a command's results in a folder.

    Parameters
    ----------
    command : str
        One of :data:`gearwhine.commands.COMMANDS`.
    document : dict
        Document that is stored as the summary; it gains the command, the time, the input files as they were read, and
        the files written.
    case : Case or None
        Case, which is stored as it is resolved; None for objects of Python.
    folder : path
        Output folder.
    write : callable
        Writes the command's own files into a folder.
    modes_stored : bool
        Whether the folder holds the modes of the results, so that they are listed though not written.
    """

    def settle(place: Path) -> None:
        command_folder = _place_of(folder, command)
        (place / command_folder).mkdir(exist_ok=True)
        for path in sorted(place.iterdir()):
            if path.is_file() and path.name != MODE_CACHE_FILE:
                path.rename(place / command_folder / path.name)
        names = {path.relative_to(place).as_posix() for path in place.rglob("*") if path.is_file()}
        if modes_stored:
            names.add(MODE_CACHE_FILE)
        files = [*sorted(names), (command_folder / SUMMARY).as_posix()]
        read = {} if case is None else {"input_files": case.input_files.contents}
        document.update(command=command, made_at=_now(), **read, folder=str(folder), files=files)
        if command == _FOREMOST and (moved := _give_way(place, folder)):
            document["moved"] = {"command": moved, "to": (folder / moved).as_posix()}
        (place / command_folder / SUMMARY).write_text(json_text(finite(document)) + "\n", encoding="utf-8")

    with staging(folder, settle) as place:
        if case is not None:
            (place / "case.toml").write_text(dump_case(case), encoding="utf-8")
        write(place)


def stored_results(folder: Path) -> list[tuple[Path, Mapping[str, Any]]]:
    """Return the results in a folder, newest first: the relative place of each, and its document."""
    places = [Path(), *(Path(command) for command in COMMANDS if not (folder / command).is_symlink())]
    results = [(place, summary) for place in places if (summary := read_summary(folder / place)) is not None]
    return sorted(results, key=lambda result: str(result[1].get("made_at", "")), reverse=True)


def earlier_result(folder: Path, command: str) -> tuple[Path, Mapping[str, Any]] | None:
    """Return the place of a command's results in a folder, and their document; None where there are none."""
    matches = [
        (folder / place, summary) for place, summary in stored_results(folder) if summary.get("command") == command
    ]
    return matches[0] if matches else None


def _place_of(folder: Path, command: str) -> Path:
    """Return the place of a command's results relative to the folder."""
    if not (folder / SUMMARY).exists() or command == _FOREMOST:
        return Path()
    owner = (read_summary(folder) or {}).get("command")
    return Path() if owner == command else Path(command)


def _give_way(place: Path, folder: Path) -> str | None:
    """Stage the results of another command, which stand in the folder itself, for its sub-folder: they move as well.

    Returns the name of the command, which is that of the sub-folder; None where there is nothing to move.
    """
    document = dict(read_summary(folder) or {})
    owner = document.get("command")
    if not isinstance(owner, str) or owner == _FOREMOST or owner not in COMMANDS:
        return None
    shared = [MODE_CACHE_FILE] if (folder / MODE_CACHE_FILE).is_file() else []
    names = [path.name for path in listed_files(folder, Path()) if path.name not in (MODE_CACHE_FILE, SUMMARY)]
    document["files"] = [*shared, *(f"{owner}/{name}" for name in [*names, SUMMARY])]
    (place / owner).mkdir()
    for name in names:
        try:
            os.link(folder / name, place / owner / name)
        except OSError:  # of a file system without links
            shutil.copyfile(folder / name, place / owner / name)
    (place / owner / SUMMARY).write_text(json_text(document) + "\n", encoding="utf-8")
    return owner


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
