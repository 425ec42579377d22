"""Atomic writing of a file: it appears whole at its place, or not at all."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def atomic_file(path: Path) -> Iterator[Path]:
    """Give a path to write to; where the block ends without an error, that file takes the place of ``path``.

    The file is written under its own name in a hidden folder beside, which goes away in any case.
    """
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.stem}-") as folder:
        staged = Path(folder, path.name)
        yield staged
        os.replace(staged, path)
