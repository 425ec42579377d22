"""Reading of REXS files: XML (`.rexs`), JSON (`.rexsj`), and either of them in a zip archive (`.rexsz`).

Sizes are bounded before anything is read into memory: of the file, and of what an archive unpacks to. Nothing of an
archive is written to disk, and only its one model is unpacked, so that names in it lead nowhere.
"""

from __future__ import annotations

import io
import os
import zipfile
import zlib
from pathlib import Path

from gearwhine.exchange.file_names import LARGEST_MODEL
from gearwhine.exchange.rexs.errors import wrong
from gearwhine.exchange.rexs.json_reader import read_json
from gearwhine.exchange.rexs.model import RexsModel
from gearwhine.exchange.rexs.xml_reader import read_xml

MOST_MEMBERS = 1000
"""Files in an archive beyond which it is refused."""


def read_rexs(path: str | os.PathLike[str]) -> RexsModel:
    """Read a REXS file.

    Raises
    ------
    RexsError
        Where it is no REXS file, too large, or contradicts itself.
    OSError
        Where it cannot be read.
    """
    place = Path(path)
    with place.open("rb") as file:
        content = file.read(LARGEST_MODEL + 1)
    return read_content(content)


def read_content(content: bytes) -> RexsModel:
    """Read the content of a REXS file, whose kind is seen by how it begins.

    Raises
    ------
    RexsError
        As :func:`read_rexs`.
    """
    if content.startswith(b"PK"):
        content = _model_of_archive(content)
    if len(content) > LARGEST_MODEL:
        raise wrong("the file", f"at most {LARGEST_MODEL // 10**6} MB")
    if not content.strip():
        raise wrong("the file", "a REXS model; the file is empty")
    begins = content[:200].removeprefix(b"\xef\xbb\xbf").lstrip()
    return read_json(content) if begins.startswith(b"{") else read_xml(content)


def _is_model(name: str) -> bool:
    """Whether a file of an archive is a model by its name; `._` begins what macOS keeps beside one."""
    return name.lower().endswith((".rexs", ".rexsj")) and not name.rpartition("/")[2].startswith("._")


def _model_of_archive(content: bytes) -> bytes:
    """Return the one model of an archive."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = archive.infolist()
            if len(members) > MOST_MEMBERS:
                raise wrong("the archive", f"at most {MOST_MEMBERS} files", len(members))
            models = [one for one in members if _is_model(one.filename)]
            if len(models) != 1:
                names = ", ".join(one.filename[:60] for one in models) or "none"
                raise wrong("the archive", "one file that ends in .rexs or .rexsj", names)
            (member,) = models
            if member.flag_bits & 1:
                raise wrong(f"the archive: {member.filename[:60]}", "a file without a password")
            # What it says of its size is not believed: no more than the limit is unpacked.
            with archive.open(member) as file:
                unpacked = file.read(LARGEST_MODEL + 1)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, OSError, ValueError) as error:
        if isinstance(error, ValueError) and hasattr(error, "problems"):
            raise
        raise wrong("the archive", "a whole zip archive", str(error)) from None
    if len(unpacked) > LARGEST_MODEL:
        raise wrong(f"the archive: {member.filename[:60]}", f"a model of at most {LARGEST_MODEL // 10**6} MB")
    return unpacked
