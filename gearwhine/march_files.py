"""Checkpoint files of a time integration: each block of the record with the state after it, for a later restart.

A run keeps its blocks in a hidden folder of the output folder, which bears the key of everything the march depends on
and goes when the results are written. A block and its checkpoint are one file that appears whole: it is written beside,
forced to the disk, and renamed. Who is killed, interrupted or fails leaves the blocks it has; the next run with the
same key goes on behind the last one before any damage. A run of anything else clears them away.
"""

import os
import shutil
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from gearwhine.locks import exclusive_lock, held_lock, is_locked

_KEPT = ".resume-"
_KEY_DIGITS = 16  # of the folder's name: no two marches of one folder share them by chance

Arrays = Mapping[str, npt.NDArray[Any]]


class Blocks(Protocol):
    """Blocks in their order, in memory or on file."""

    def __len__(self) -> int: ...
    def append(self, arrays: Arrays, /) -> None: ...
    def __getitem__(self, number: int, /) -> Arrays: ...


class BlockFiles:
    """Blocks in a folder, one file each; those behind a damaged or missing one do not count."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._count = 0
        # All are read: a disk, a copy or another program damages any of them, not only the last one written.
        while self._is_whole(self._count):
            self._count += 1

    def __len__(self) -> int:
        return self._count

    @property
    def is_empty(self) -> bool:
        """Whether no block is on file, an uncounted one of an interruption included."""
        return not self._file(0).exists()

    def append(self, arrays: Arrays) -> None:
        """Write the next block: after this call it is there, whatever happens."""
        target = self._file(self._count)
        beside = target.with_suffix(".part")
        with beside.open("wb") as file:
            np.savez(file, allow_pickle=False, **arrays)
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, target)
        _force_names(self._folder)
        self._count += 1

    def __getitem__(self, number: int) -> Arrays:
        return self._read(range(self._count)[number])

    def _file(self, number: int) -> Path:
        return self._folder / f"block-{number:08d}.npz"

    def _read(self, number: int) -> Arrays:
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
def stored_record(folder: Path, key: str, *, fresh: bool = False) -> Iterator[BlockFiles]:
    """Checkpoint blocks in an output folder under a key, removed when the work inside ends well.

    Where a living run is at the same march in the same folder, this one keeps blocks of its own.

    Parameters
    ----------
    folder : path
        The output folder.
    key : str
        Of all that the blocks depend on.
    fresh : bool
        Clear away what is there, and begin anew.
    """
    made = not folder.exists()
    with ExitStack() as stack:
        with exclusive_lock(folder):
            place = _place(folder, f"{_KEPT}{key[:_KEY_DIGITS]}", fresh=fresh)
            stack.enter_context(held_lock(place))
        blocks = BlockFiles(place)
        try:
            yield blocks
        except BaseException as error:
            if blocks.is_empty:
                _clear(place, folder if made else None)
            elif isinstance(error, KeyboardInterrupt):
                error.add_note("what was marched so far is kept: the same command goes on from there, --fresh does not")
            raise
        _clear(place, None)


def _place(folder: Path, name: str, *, fresh: bool) -> Path:
    """A folder for the blocks, after those of dead runs of anything else are cleared away."""
    wanted = folder / name
    for other in folder.glob(f"{_KEPT}*"):
        if other.is_dir() and not other.is_symlink() and (fresh or other != wanted) and not is_locked(other):
            shutil.rmtree(other, ignore_errors=True)
    if wanted.exists() and is_locked(wanted):
        return Path(tempfile.mkdtemp(prefix=f"{name}-", dir=folder))
    wanted.mkdir(exist_ok=True)
    return wanted


def _clear(place: Path, made: Path | None) -> None:
    shutil.rmtree(place, ignore_errors=True)
    if made is not None:
        with suppress(OSError):  # another run is at work in it
            made.rmdir()


def _force_names(folder: Path) -> None:
    """Force a folder's entries to the disk."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
