"""Names and largest size of files of other programs: here nothing is imported that reads them."""

from __future__ import annotations

import os
from pathlib import Path

LARGEST_MODEL = 50_000_000
"""Bytes of a file, and of XML or JSON in an archive, beyond which it is refused."""
ENDINGS = (".rexs", ".rexsj", ".rexsz", ".rexs.xml", ".rexs.json", ".rexs.zip")
"""Endings of the names of REXS files."""


def is_rexs_file(name: str | os.PathLike[str]) -> bool:
    """Whether a file is a REXS file by its name."""
    return os.fspath(name).lower().endswith(ENDINGS)


def bare_name(name: str | os.PathLike[str]) -> str:
    """Return the name of a REXS file without its folder and ending."""
    bare = Path(name).name
    ending = max((end for end in ENDINGS if bare.lower().endswith(end)), key=len, default="")
    return bare[: len(bare) - len(ending)] or "unit"
