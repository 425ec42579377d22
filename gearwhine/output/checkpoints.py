"""Checkpoints of a time integration: its blocks in files of the output folder, from which a later run goes on.

A run stores its blocks in a hidden folder of the output folder, each with the state after it, for a later
restart. The folder bears the key of everything that the integration depends on, and goes when the results are written,
unless these have no pictures: then the same run with pictures takes the motion from it.
A block and its checkpoint are one file that appears whole: it is written beside, forced to the disk, and renamed. A run
that is killed, interrupted or fails leaves its blocks; the next run with the same key goes on behind the last one
before any damage. A run of anything else clears them away.
"""

import os
import shutil
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np

from gearwhine.coupling.analyses.recording import Arrays
from gearwhine.interruption import cleared_at_the_end
from gearwhine.output.files import clear_stage, exclusive_lock, held_lock, is_locked, room_named

_FOLDER_PREFIX = ".resume-"
_MOST_KEPT = 200e6  # bytes of blocks that stay in memory for the result of a run, or in the folder for its pictures
_KEY_DIGITS = 16  # digits of the key in the folder's name: no two integrations of one folder share them by chance


class BlockFiles:
    """Blocks in a folder, one file each; those behind a damaged or missing one do not count."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._count = 0
        self._kept: list[Arrays] | None = None
        # All are read: a disk, a copy or another program damages any of them, not only the last one written.
        while self._is_whole(self._count):
            self._count += 1

    def __len__(self) -> int:
        """Return the number of whole blocks, up to the first damaged or missing one."""
        return self._count

    @property
    def is_empty(self) -> bool:
        """Whether no block is on file, an uncounted one of an interruption included."""
        return not self._file(0).exists()

    def append(self, arrays: Arrays) -> None:
        """Write the next block: after this call it is there, whatever happens."""
        target = self._file(self._count)
        beside = target.with_suffix(".part")
        try:
            with beside.open("wb") as file:
                np.savez(file, allow_pickle=False, **arrays)
                file.flush()
                os.fsync(file.fileno())
            os.replace(beside, target)
        except OSError:
            beside.unlink(missing_ok=True)
            raise
        _force_names(self._folder)
        self._count += 1

    def __getitem__(self, number: int) -> Arrays:
        """Read the arrays of a block.

        Raises
        ------
        FileNotFoundError
            Where the blocks are gone and were too large to keep.
        """
        place = range(self._count)[number]
        return self._read(place) if self._kept is None else self._kept[place]

    def keep(self) -> None:
        """Read the blocks into memory, unless they are large: a result reads the motion when their files are gone."""
        if not self.are_large:
            self._kept = [self._read(number) for number in range(self._count)]

    @property
    def are_large(self) -> bool:
        """Whether the blocks are too large to keep beside the results."""
        return sum(self._file(number).stat().st_size for number in range(self._count)) > _MOST_KEPT

    def _file(self, number: int) -> Path:
        return self._folder / f"block-{number:08d}.npz"

    def _read(self, number: int) -> Arrays:
        if not self._folder.exists():
            raise FileNotFoundError(
                f"the motion over time was too long to stay in memory when its results were written: it is in "
                f"{self._folder.parent}"
            )
        with self._file(number).open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            return {name: arrays[name] for name in arrays.files}

    def _is_whole(self, number: int) -> bool:
        """Whether a block is there and every array in it has the checksum that was written with it."""
        try:
            with zipfile.ZipFile(self._file(number)) as file:
                return bool(file.namelist()) and file.testzip() is None
        # A damaged header claims a compression, an encryption or a length that no block has.
        except (OSError, ValueError, EOFError, RuntimeError, zipfile.BadZipFile, zlib.error, struct.error):
            return False


@contextmanager
def stored_record(folder: Path, key: str, *, fresh: bool = False, stays: bool = False) -> Iterator[BlockFiles]:
    """Checkpoint blocks in an output folder under a key, whose files go when the work inside ends well.

    If a living run performs the same integration in the same folder, this one stores blocks of its own.

    Parameters
    ----------
    folder : path
        The output folder.
    key : str
        Key of all inputs of the blocks.
    fresh : bool
        Whether to remove stored blocks, and begin anew.
    stays : bool
        Whether the files stay for another run, unless they are large.
    """
    is_new = not folder.exists()
    with room_named(folder), ExitStack() as stack:
        with exclusive_lock(folder):
            place = _place(folder, f"{_FOLDER_PREFIX}{key[:_KEY_DIGITS]}", fresh=fresh)
            stack.enter_context(held_lock(place))
        blocks = BlockFiles(place)

        def leave() -> str | None:
            """Clear away a folder without blocks; return where those of others are kept."""
            if not blocks.is_empty:
                kept = f"what was marched so far is kept in {place}"
                return f"{kept}: the same command goes on from there, --fresh does not"
            clear_stage(place, folder if is_new else None)
            return None

        stack.enter_context(cleared_at_the_end(leave))
        try:
            yield blocks
        except BaseException as error:
            note = leave()
            if note is not None and isinstance(error, KeyboardInterrupt | OSError):
                error.add_note(note)
            raise
        blocks.keep()
        if not stays or blocks.are_large:
            clear_stage(place, None)


def _place(folder: Path, name: str, *, fresh: bool) -> Path:
    """Return a folder for the blocks, after those of any other ended run are cleared away."""
    target = folder / name
    for candidate in folder.glob(f"{_FOLDER_PREFIX}*"):
        if (
            candidate.is_dir()
            and not candidate.is_symlink()
            and (fresh or candidate != target)
            and not is_locked(candidate)
        ):
            shutil.rmtree(candidate, ignore_errors=True)
    if target.exists() and is_locked(target):
        return Path(tempfile.mkdtemp(prefix=f"{name}-", dir=folder))
    target.mkdir(exist_ok=True)
    return target


def _force_names(folder: Path) -> None:
    """Force a folder's entries to the disk."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
