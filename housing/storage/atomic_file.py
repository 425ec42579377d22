"""Atomic writing of a file, which appears whole at its place or not at all; and its checksum.

The checksum, SHA-256 of the file's bytes, is appended at the end and detects damage before any reader opens the file:
HDF5 may loop for ever on a damaged one. HDF5 ignores bytes behind the end that the file itself states.
"""

import hashlib
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def atomic_file(path: Path) -> Iterator[Path]:
    """Give a path to write to; where the block ends without an error, that file takes the place of ``path``.

    The file is written under its own name in a hidden folder beside it, which is removed in any case.
    """
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.stem}-") as folder:
        staged = Path(folder, path.name)
        yield staged
        os.replace(staged, path)


_MARK = b"\nsha256 "
_SEAL = len(_MARK) + 64


def write_checksum(path: Path) -> None:
    """Append the checksum to a complete file."""
    line = _MARK + _digest(path, path.stat().st_size)
    with path.open("ab") as file:
        file.write(line)


def checksum_holds(path: Path) -> bool | None:
    """Whether a file's bytes have the checksum at its end; None where it has no checksum.

    Raises
    ------
    OSError
        Where the file cannot be read.
    """
    size = path.stat().st_size - _SEAL
    if size < 0:
        return None
    with path.open("rb") as file:
        file.seek(-_SEAL, os.SEEK_END)
        line = file.read()
    if not line.startswith(_MARK):
        return None
    return line == _MARK + _digest(path, size)


def _digest(path: Path, size: int) -> bytes:
    """SHA-256 of the first bytes of a file, in hexadecimal."""
    total = hashlib.sha256()
    with path.open("rb") as file:
        while size > 0 and (piece := file.read(min(size, 1 << 20))):
            total.update(piece)
            size -= len(piece)
    return total.hexdigest().encode()
