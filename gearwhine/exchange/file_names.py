"""Names and largest size of files of other programs: here nothing is imported that reads them."""

from __future__ import annotations

import os

LARGEST_MODEL = 50_000_000
"""Bytes of a file, and of XML or JSON in an archive, beyond which it is refused."""
ENDINGS = (".rexs", ".rexsj", ".rexsz", ".rexs.xml", ".rexs.json", ".rexs.zip")
"""Endings of the names of REXS files."""


def is_rexs_file(name: str | os.PathLike[str]) -> bool:
    """Whether a file is a REXS file by its name."""
    return os.fspath(name).lower().endswith(ENDINGS)
