"""Files that appear whole or not at all."""

import errno
import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

from gearwhine.locks import exclusive_lock, held_lock, is_locked

SUMMARY = "summary.json"
COMMANDS = ("run", "modes", "rotors", "gears", "system", "steady", "sweep", "compare", "survey", "update", "render")
"""Commands that leave results in the output folder."""

_STAGING = ".partial-"
_DRAWN = (".png", ".glb", ".vtu")
_LONGEST = 60  # of a name in a file's [characters]


@contextmanager
def staging(folder: Path, settle: Callable[[Path], Path | None] | None = None) -> Iterator[Path]:
    """A folder inside the output folder whose files move out to it, one by one and whole, at the end.

    Where the work fails or is interrupted, the output folder keeps what it had. What a killed run left behind is
    cleared away first; what a living one is still at is left alone, and two runs move their files one after the other.

    Parameters
    ----------
    folder : path
        The output folder.
    settle : callable, optional
        Called with the staged folder right before its files move, when no other run moves any. Returns the place of a
        command's results, relative to the output folder; drawings that the earlier summary there lists and this run
        does not draw anew are then cleared away, so that no old mode stands among the new ones. None where the files
        add to earlier ones.
    """
    made = not folder.exists()
    with ExitStack() as stack:
        with exclusive_lock(folder):
            for stale in folder.glob(f"{_STAGING}*"):
                if stale.is_dir() and not stale.is_symlink() and not is_locked(stale):
                    shutil.rmtree(stale, ignore_errors=True)
            place = Path(tempfile.mkdtemp(prefix=_STAGING, dir=folder))
            stack.enter_context(held_lock(place))
        try:
            yield place
            with exclusive_lock(folder):
                replaced = None if settle is None else settle(place)
                _move_out(place, folder, replaced)
        except OSError as error:
            # Libraries that write files do not say where there was no room.
            if error.filename is None and (error.errno == errno.ENOSPC or os.strerror(errno.ENOSPC) in str(error)):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(folder)) from error
            raise
        finally:
            shutil.rmtree(place, ignore_errors=True)
            if made:
                with suppress(OSError):  # it holds results, or another run is at work in it
                    folder.rmdir()


def read_summary(folder: Path) -> Mapping[str, Any] | None:
    """The summary of a command's results in a folder; None where there is none, or what is there is no such thing."""
    try:
        summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return summary if isinstance(summary, Mapping) else None


def listed_files(folder: Path, own: Path) -> list[Path]:
    """Files that the summary in a place of the output folder lists and that stand there: no links, no other places."""
    names = (read_summary(folder / own) or {}).get("files", ())
    texts = {name for name in names if isinstance(name, str) and name} if isinstance(names, list) else set()
    found = (Path(text) for text in sorted(texts))
    return [one for one in found if one == own / one.name and _is_plain_file(folder / one)]


def _is_plain_file(path: Path) -> bool:
    return path.is_file() and not path.is_symlink()


def _move_out(place: Path, folder: Path, replaced: Path | None) -> None:
    """Move a run's files to the output folder, and clear away what it does not draw anew."""
    names = [path.relative_to(place) for path in sorted(place.rglob("*")) if path.is_file()]
    stale = [] if replaced is None else [one for one in listed_files(folder, replaced) if one.suffix in _DRAWN]
    # The summary moves last: where it is new, all is new, and until then the old one lists what is to be cleared.
    for name in sorted(names, key=lambda name: name.name == SUMMARY):
        if name.name == SUMMARY:
            for old in stale:
                if old not in names:
                    (folder / old).unlink(missing_ok=True)
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        os.replace(place / name, target)


def json_text(document: Mapping[str, Any]) -> str:
    """A document as JSON, refusing values that JSON has no word for."""
    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)


def finite(value: Any) -> Any:
    """The same document with infinities and NaN as null, since JSON knows neither."""
    if isinstance(value, Mapping):
        return {key: finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    if isinstance(value, float) and (value != value or value in (float("inf"), float("-inf"))):
        return None
    return value


def file_stems(names: Sequence[str], prefix: str = "") -> list[str]:
    """A file's stem for each name, after a prefix: of letters that any file system takes, and no two alike."""
    stems: list[str] = []
    for number, name in enumerate(names, start=1):
        plain = re.sub(r"[^A-Za-z0-9._+-]+", "-", name).strip("-.")[:_LONGEST]
        stem = f"{prefix}{plain or number}"
        # Some file systems take capitals and small letters for the same.
        if stem.lower() in (other.lower() for other in stems):
            stem = f"{stem}-{number}"
        stems.append(stem)
    return stems
