"""Files that a command would write over: none that its case reads, and none but those of earlier runs.

A file is ours where the folder's manifest lists it (:mod:`gearwhine.output.manifest`) or, in folders of versions
without one, the summary of a command's results. What a command will write is known by the patterns of its declaration
(:mod:`gearwhine.commands`), so that it is refused before the work; the files themselves are checked again before they
move (:func:`require_own`).
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from gearwhine.commands import COMMANDS
from gearwhine.failures import DamagedResultsError, ForeignFileError
from gearwhine.output.manifest import MANIFEST, listed_digests

_SUMMARY, _FOREMOST = "summary.json", "run"


def require_own(folder: Path, names: Iterable[str]) -> None:
    """Refuse to replace files that no earlier run made.

    Parameters
    ----------
    folder : path
        Output folder.
    names : iterable of str
        Names relative to it that are to be written.

    Raises
    ------
    ForeignFileError
        Where a file of one of the names is in the folder and not ours.
    """
    there = [name for name in names if (folder / name).exists() or (folder / name).is_symlink()]
    if there and (foreign := sorted(set(there) - _own_names(folder))):
        raise ForeignFileError(_in_words([folder / name for name in foreign], "no run of gearwhine made"))


def require_free(command: str, folder: Path, inputs: Sequence[Path], more: Sequence[str] = ()) -> None:
    """Refuse an output folder in which a command would replace one of its inputs, or a file that no run made.

    Parameters
    ----------
    command : str
        Name of a command.
    folder : path
        Output folder, which need not exist.
    inputs : sequence of path
        Files that the command reads.
    more : sequence of str
        Names of further files that it writes.

    Raises
    ------
    ForeignFileError
        Where one would be replaced. An input is found by its file, under another name or through a link, too.
    """
    if not folder.is_dir():
        return
    place = _place_of(folder, command)
    patterns = (*(COMMANDS[command].files if command in COMMANDS else ()), *more)
    names = [
        (place / path.name).as_posix()
        for path in sorted((folder / place).iterdir() if (folder / place).is_dir() else ())
        if any(fnmatchcase(path.name, pattern) for pattern in patterns) and not path.is_dir()
    ]
    read = [folder / name for name in names if any(_is_same(folder / name, file) for file in inputs)]
    if read:
        raise ForeignFileError(_in_words(read, "the case reads"))
    require_own(folder, names)


def _in_words(files: Sequence[Path], which: str) -> str:
    listed = ", ".join(str(file) for file in files[:5]) + (f" and {len(files) - 5} more" if len(files) > 5 else "")
    subject, object_ = ("a file", "it") if len(files) == 1 else ("files", "them")
    return f"{listed}: {subject} that {which}; the results would replace {object_}"


def _is_same(first: Path, second: Path) -> bool:
    try:
        return first.samefile(second)
    except OSError:  # a link that leads nowhere
        return False


def _place_of(folder: Path, command: str) -> Path:
    """Return the place of a command's results relative to the folder, see :mod:`gearwhine.output.store`."""
    summary = _summary(folder)
    beside = summary is not None and summary.get("command") != command and command in COMMANDS and command != _FOREMOST
    return Path(command) if beside else Path()


def _own_names(folder: Path) -> set[str]:
    """Return the names of the files in a folder that runs made."""
    try:
        names = {*listed_digests(folder), MANIFEST}
    except DamagedResultsError:  # what it listed is unknown; the summaries list most
        names = {MANIFEST}
    for place in (Path(), *(path.relative_to(folder) for path in folder.iterdir() if path.name in COMMANDS)):
        summary = _summary(folder / place)
        files = None if summary is None or str(summary.get("command")) not in COMMANDS else summary.get("files")
        if isinstance(files, list):
            names |= {name for name in files if isinstance(name, str)}
    return names


def _summary(folder: Path) -> Mapping[str, object] | None:
    try:
        summary = json.loads((folder / _SUMMARY).read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError, RecursionError):
        return {}
    return summary if isinstance(summary, Mapping) else {}
