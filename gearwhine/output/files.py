"""Files of a results folder: files that appear whole or not at all, locks, digests, JSON.

Locks on folders serve runs that share a results folder. Digests take libraries by version, own code by its text.
"""

import errno
import fcntl
import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

from gearwhine.commands import COMMANDS
from gearwhine.failures import DamagedResultsError
from gearwhine.interruption import cleared_at_the_end, uninterrupted
from gearwhine.output.manifest import MANIFEST, file_digest, listed_digests, manifest_text
from gearwhine.output.own_files import require_own


@contextmanager
def exclusive_lock(folder: Path) -> Iterator[None]:
    """Make a folder where it is missing and hold its lock; waits for another run that holds it.

    The lock is on the folder itself: it leaves no file behind, and the system lets go of it when a process dies. Where
    a file system knows no locks the work goes on without.
    """
    while True:
        folder.mkdir(parents=True, exist_ok=True)
        try:
            handle = os.open(folder, os.O_RDONLY)
        except FileNotFoundError:  # another run has just removed it, empty
            continue
        try:
            _take(handle, wait=True)
            if folder.exists() and os.path.samestat(os.fstat(handle), folder.stat()):
                yield
                return
        finally:
            os.close(handle)


@contextmanager
def held_lock(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder that is this run's own, so that others see that it is in use."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        _take(handle, wait=False)
        yield
    finally:
        os.close(handle)


def is_locked(folder: Path) -> bool:
    """Whether a living process holds a folder's lock, or the lock cannot be read."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        return True
    try:
        return not _take(handle, wait=False)
    finally:
        os.close(handle)


def _take(handle: int, *, wait: bool) -> bool:
    """Take a lock; False where another process has it or there are no locks."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError:
        return False
    return True


def with_contents(value: Any, files: Mapping[str, Any]) -> Any:
    """Return the table with each file's content in place of its name."""
    if isinstance(value, Mapping):
        return {key: with_contents(inner, files) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [with_contents(inner, files) for inner in value]
    return files.get(value, value) if isinstance(value, str) else value


def texts_in(value: Any) -> set[str]:
    """Return every text in a table, however deep: the names of its materials are among them."""
    if isinstance(value, str):
        return {value}
    return set().union(*(texts_in(inner) for inner in _inner(value)))


PRESENTATION = (
    "gearwhine.cli",
    "gearwhine.commands",
    "gearwhine.drawing_process",
    "gearwhine.figures",
    "gearwhine.mode_pictures",
    "gearwhine.output.export",
    "gearwhine.output.report",
    "gearwhine.output.terminal",
    "gearwhine.housing.pictures",
)
"""Code that shows numbers and makes none."""

ROOMS = ("gearwhine.numerics", "gearwhine.meshes", "gearwhine.housing", "gearwhine.rotors", "gearwhine.coupling")
"""Packages of the physics, links in the front door's folder of a checkout."""


def _inner(value: Any) -> list[Any]:
    if isinstance(value, Mapping):
        return list(value.values())
    return list(value) if isinstance(value, list | tuple) else []


MODE_CACHE_FILE = "modes.nc"
"""Modes of the housing, which the commands of a results folder share."""
SUMMARY = "summary.json"
_STAGING, _COMPLETE = ".partial-", ".complete-"  # beginnings of the names of folders of staged files
_DRAWN = (".png", ".glb", ".vtu", ".toml")
_JSON_LINE = 160  # letters of a document's line that holds a whole list or object
_LONGEST_FILE_NAME = 60  # length of the longest name in a file's name [characters]


@contextmanager
def staging(folder: Path, settle: Callable[[Path], None] | None = None, *, listed: bool = True) -> Iterator[Path]:
    """Stage files in a folder inside the output folder: at the end they move out to it as one set.

    Where the work fails or is interrupted, the output folder keeps its files. Staged files of a killed run are removed
    first, those of a living one stay, and two runs move their files one after the other. A set is complete once its
    folder has another name: where the run is killed while its files move, the next one, or the next reader, moves the
    rest (:func:`finish_moves`).

    Parameters
    ----------
    folder : path
        The output folder.
    settle : callable, optional
        Called with the staged folder right before its files move, when no other run moves any.
    listed : bool
        Whether the folder's manifest lists the files.

    Raises
    ------
    ForeignFileError
        Where a file that no run made would be replaced.
    """
    is_new = not folder.exists()
    with room_named(folder), ExitStack() as stack:
        with exclusive_lock(folder):
            for stale in folder.glob(f"{_STAGING}*"):
                if stale.is_dir() and not stale.is_symlink() and not is_locked(stale):
                    shutil.rmtree(stale, ignore_errors=True)
            place = Path(tempfile.mkdtemp(prefix=_STAGING, dir=folder))
            stack.enter_context(held_lock(place))
        stack.enter_context(cleared_at_the_end(partial(clear_stage, place, folder if is_new else None), place))
        try:
            yield place
            with exclusive_lock(folder), uninterrupted():
                _finish_moves(folder)
                if settle is not None:
                    settle(place)
                require_own(folder, [path.relative_to(place).as_posix() for path in place.rglob("*") if path.is_file()])
                if listed:
                    _write_manifest(place, folder)
                complete = place.with_name(place.name.replace(_STAGING, _COMPLETE, 1))
                place.rename(complete)
                _move_out(complete, folder)
        finally:
            clear_stage(place, folder if is_new else None)


def clear_stage(place: Path, created: Path | None) -> None:
    """Remove staged files, and the output folder where these made it."""
    shutil.rmtree(place, ignore_errors=True)
    if created is not None:
        with suppress(OSError):  # it holds results, or another run is at work in it
            created.rmdir()


@contextmanager
def room_named(folder: Path) -> Iterator[None]:
    """Name a folder in the errors of writes that fail for want of room: neither they nor libraries say where."""
    try:
        yield
    except OSError as error:
        reason = errno.ENOSPC if os.strerror(errno.ENOSPC) in str(error) else error.errno
        if error.filename is None and reason in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO):
            named = OSError(reason, os.strerror(reason), str(folder))
            for note in getattr(error, "__notes__", ()):
                named.add_note(note)
            raise named from error
        raise


def finish_moves(folder: Path) -> None:
    """Move the rest of a complete set whose run was killed while its files moved to the output folder."""
    if any(folder.glob(f"{_COMPLETE}*")):
        with exclusive_lock(folder), uninterrupted():
            _finish_moves(folder)


def _finish_moves(folder: Path) -> None:
    """Move what is left of complete sets, under the folder's lock, so that no living run moves any."""
    for complete in sorted(folder.glob(f"{_COMPLETE}*")):
        if complete.is_dir() and not complete.is_symlink():
            _move_out(complete, folder)


def read_summary(folder: Path) -> Mapping[str, Any] | None:
    """Read the summary of a command's results in a folder; None where there is none that can be read."""
    try:
        summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return summary if isinstance(summary, Mapping) else None


def listed_files(folder: Path, place: Path) -> list[Path]:
    """Return the files that the summary in a place of the output folder lists and that exist there, without links."""
    names = (read_summary(folder / place) or {}).get("files", ())
    texts = {name for name in names if isinstance(name, str) and name} if isinstance(names, list) else set()
    paths = (Path(text) for text in sorted(texts))
    own = ((path, folder / path) for path in paths if path == place / path.name)
    return [path for path, file in own if file.is_file() and not file.is_symlink()]


def _move_out(place: Path, folder: Path) -> None:
    """Move a complete set of files to the output folder, remove those that it supersedes, and the emptied folder.

    Each step may be the last: the next call goes on from there. The summaries move behind the other files, because the
    earlier ones list what is to be removed, that of the folder itself as the last. The manifest moves behind all.
    """
    names = [path.relative_to(place) for path in sorted(place.rglob("*")) if path.is_file()]
    last = {SUMMARY: 1, MANIFEST: 2}
    for name in sorted(names, key=lambda name: (last.get(name.name, 0), -len(name.parts))):
        if name.name == SUMMARY:
            for old in _superseded(place, folder, name):
                (folder / old).unlink(missing_ok=True)
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        os.replace(place / name, target)
    shutil.rmtree(place, ignore_errors=True)


def _superseded(place: Path, folder: Path, summary: Path) -> list[Path]:
    """Return the files that an earlier summary lists and a new one, which takes its place, makes stale.

    These are drawings and cases that the command does not make anew, so that no old mode or gearbox stands among new
    ones; and files of another command, which stand in its own sub-folder now.
    """
    new, old = read_summary(place / summary.parent) or {}, read_summary(folder / summary.parent) or {}
    command = COMMANDS.get(str(new.get("command")))
    if command is not None and command.adds:
        return []
    earlier = [file for file in listed_files(folder, summary.parent) if file.as_posix() not in new.get("files", ())]
    owner = old.get("command")
    if owner == new.get("command") or str(owner) not in COMMANDS:
        return [file for file in earlier if file.suffix in _DRAWN]
    own = Path(str(owner))
    return [file for file in earlier if (folder / own / file.name).is_file() or (place / own / file.name).is_file()]


def _write_manifest(place: Path, folder: Path) -> None:
    """Write the manifest of all of a folder's files of runs as it is once the staged ones have moved there."""
    try:
        earlier = listed_digests(folder)
    except DamagedResultsError:  # what it listed is unknown; the summaries list most
        earlier = {}
    names = [path.relative_to(place) for path in sorted(place.rglob("*")) if path.is_file()]
    if not names:
        return
    removed = {old.as_posix() for name in names if name.name == SUMMARY for old in _superseded(place, folder, name)}
    kept = {name: digest for name, digest in earlier.items() if name not in removed}
    digests = kept | {name.as_posix(): file_digest(place / name) for name in names}
    (place / MANIFEST).write_text(manifest_text(digests), encoding="utf-8")


def json_text(document: Mapping[str, Any]) -> str:
    """Return a document as JSON for reading, refusing values that JSON has no word for.

    A list or object that fits on a line stands on one, and so does any list of plain values.
    """
    return _json_lines(document, "")


def _json_lines(value: Any, margin: str) -> str:
    """Return a value of a document as JSON, its further lines behind a margin."""
    text = json.dumps(value, ensure_ascii=False, allow_nan=False)
    inner = _inner(value)
    nested = any(isinstance(item, Mapping | list | tuple) for item in inner)
    if not inner or len(margin) + len(text) <= _JSON_LINE or not (nested or isinstance(value, Mapping)):
        return text
    further = f"{margin} "
    if isinstance(value, Mapping):
        entries = [
            f"{json.dumps(str(key), ensure_ascii=False)}: {_json_lines(item, further)}" for key, item in value.items()
        ]
        opening, closing = "{}"
    else:
        entries, (opening, closing) = [_json_lines(item, further) for item in inner], "[]"
    return f"{opening}\n{further}" + f",\n{further}".join(entries) + f"\n{margin}{closing}"


def finite(value: Any) -> Any:
    """Return the document with infinities and NaN as null, since JSON knows neither."""
    if isinstance(value, Mapping):
        return {key: finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    if isinstance(value, float) and (value != value or value in (float("inf"), float("-inf"))):
        return None
    return value


def file_stems(names: Sequence[str], prefix: str = "") -> list[str]:
    """Return a file stem for each name, after a prefix: distinct, and of letters that any file system takes."""
    stems: list[str] = []
    taken: set[str] = set()  # in small letters: some file systems take capitals for the same
    for number, name in enumerate(names, start=1):
        plain = re.sub(r"[^A-Za-z0-9._+-]+", "-", name).strip("-.")[:_LONGEST_FILE_NAME]
        stem = f"{prefix}{plain or number}"
        # Another name may already end in this one's number.
        while stem.lower() in taken:
            stem = f"{stem}-{number}"
        taken.add(stem.lower())
        stems.append(stem)
    return stems
