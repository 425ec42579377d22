"""Nastran decks completed for meshio: framed bulk data, and every continuation marked."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

ENDINGS = (".bdf", ".fem", ".nas")

_BEGIN, _END = "BEGIN BULK", "ENDDATA"
_FIELD = 8 * " "


def framed_deck(text: str) -> str:
    """A deck whose bulk data stand between BEGIN BULK and ENDDATA, with a plus sign before each continuation.

    gmsh and others write bulk data alone, as for an INCLUDE; and a continuation may begin with a blank field, which
    meshio takes for one only where the line before it is filled up to 80 letters.
    """
    lines = [f"+{line[1:]}" if line.startswith(_FIELD) and line.strip() else line for line in text.splitlines()]
    if not any(line.strip().startswith(_BEGIN) for line in lines):
        lines.insert(0, _BEGIN)
    if not any(line.startswith(_END) for line in lines):
        lines.append(_END)
    return "\n".join([*lines, ""])


@contextmanager
def framed_file(path: Path) -> Iterator[Path]:
    """A copy of a deck in this form, as long as it is needed; files of other formats as they are."""
    if path.suffix.lower() not in ENDINGS:
        yield path
        return
    with TemporaryDirectory(prefix="gearwhine-nastran-") as folder:
        copy = Path(folder) / path.name
        copy.write_text(framed_deck(path.read_text(encoding="utf-8", errors="replace")), encoding="utf-8")
        yield copy
