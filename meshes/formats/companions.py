"""Companion files of a mesh file: those that are read with it, such as included decks and arrays in HDF5."""

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from gearwhine.meshes.formats.abaqus_cards import included_files
from gearwhine.meshes.formats.nastran import included_decks, is_nastran

_TETGEN = (".node", ".ele")


def companion_files(path: Path) -> tuple[Path, ...]:
    """Return the existing files that are read with a mesh file, ascending by their paths.

    They are the decks and lines of data that a deck of Abaqus, CalculiX or Nastran includes, however deep; the arrays
    of XDMF; the other file of TetGen's pair; and the cell data beside a mesh of DOLFIN. A file of any other kind has
    none, nor has a broken one, which its reader refuses.
    """
    ending, whole, found = path.suffix.lower(), path.resolve(), set[Path]()
    nastran = is_nastran(path)
    waiting = [whole]
    while waiting:
        others = included_decks(waiting.pop()) if nastran else _named_by(waiting.pop(), ending)
        named = {other.resolve() for other in others if other.is_file()} - found - {whole}
        found |= named
        waiting += named
    return tuple(sorted(found))


def _named_by(path: Path, ending: str) -> Iterator[Path]:
    """Yield the files that a file refers to itself, whether they exist or not, as the ending of the mesh file says."""
    if ending == ".inp":
        yield from included_files(path)
    elif ending == ".xdmf":
        yield from _arrays_of_xdmf(path)
    elif ending in _TETGEN:
        yield from (path.with_suffix(other) for other in _TETGEN)
    elif ending == ".xml":
        yield from (other for other in path.parent.glob("*.xml") if other.name.startswith(f"{path.stem}_"))


def _arrays_of_xdmf(path: Path) -> Iterator[Path]:
    try:
        items = list(ElementTree.parse(path).iter("DataItem"))
    except (ElementTree.ParseError, UnicodeDecodeError):
        return
    for item in items:
        place = (item.text or "").strip()
        if item.get("Format") == "HDF":
            yield path.parent / place.rpartition(":")[0]
        elif item.get("Format") == "Binary":
            yield Path(place)
