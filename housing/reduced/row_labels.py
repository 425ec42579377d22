"""Files that name the node and component of each row of a matrix: of Ansys, CalculiX and Nastran.

- HBMAT of Ansys writes a line for each equation: its number, the node, and the label of its degree of freedom.
- ``*FREQUENCY, SOLVER=MATRIXSTORAGE`` of CalculiX writes ``node.direction``. Several directions behind one point,
  such as ``101.123456``, are as many rows, and direction 0 is an internal coordinate.
- EXTSEOUT of Nastran writes a card EXTRN to its punch file: points with their components. Scalar points, of component
  0, are internal coordinates. A grid point may move along the axes of a coordinate system of its own.
"""

import re
from collections.abc import Sequence
from pathlib import Path

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.matrices import MOST_COORDINATES, Coordinate, RowLabels
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.formats.nastran_boundary import read_boundary

LABELS = ("UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ")
"""Degrees of freedom 1 to 6 of Ansys."""

PUNCH_FILES = (".pch", ".asm", ".bdf", ".dat", ".nas")
"""Endings of files of Nastran, which have a card EXTRN."""

_LARGEST = 10_000_000
_ANSYS = re.compile(r"\s*(\d{1,9})\s+(\d{1,9})\s+([A-Z]\w*)\s*", re.IGNORECASE)
_EXTRN = re.compile(rb"^EXTRN\b", re.MULTILINE | re.IGNORECASE)
_CALCULIX = re.compile(r"\s*(\d{1,9})\.(0|[1-6]{1,6})\s*")


def read_row_labels(path: Path) -> RowLabels:
    """Read the coordinates of the rows of a matrix, in their order.

    Degrees of freedom other than the six of :data:`LABELS` are internal coordinates.

    Raises
    ------
    HousingError
        Where the file has no rows, their numbers have gaps, or it is damaged.
    """
    try:
        if path.stat().st_size > _LARGEST:
            raise HousingError(f"{path.name}: expected a file of at most {_LARGEST // 10**6} MB")
        if path.suffix.lower() in PUNCH_FILES:
            return _of_superelement(path)
        lines = path.read_text("latin-1").splitlines()
    except OSError as error:
        raise HousingError(f"{path.name}: expected a readable file ({error.strerror or error})") from error
    found = list[Coordinate]()
    for line in lines:
        if match := _CALCULIX.fullmatch(line):
            found += [(int(match[1]), int(axis)) for axis in match[2]]
        elif match := _ANSYS.fullmatch(line):
            if int(match[1]) != len(found) + 1:
                raise HousingError(f"{path.name}: expected equation {len(found) + 1}; got {match[1]}")
            label = match[3].upper()
            found.append((int(match[2]), LABELS.index(label) + 1) if label in LABELS else (len(found) + 1, 0))
    if not 0 < len(found) <= MOST_COORDINATES:
        expected = "lines such as 5.3 (CalculiX) or 1 5 UZ (Ansys), a row each"
        raise HousingError(f"{path.name}: expected {expected}, from 1 to {MOST_COORDINATES}; got {len(found)}")
    return RowLabels(tuple(found))


def row_labels_beside(path: Path) -> Path | None:
    """Return the file of the rows that a program writes beside a matrix under the same name; None without one.

    These are ``.dof`` of CalculiX and of :func:`write_row_labels`, ``.mapping`` of Ansys, and ``.pch`` of Nastran where
    it has a card EXTRN.
    """
    for ending in (".dof", ".mapping", ".pch"):
        beside = path.with_suffix(ending)
        if beside == path or not beside.is_file():
            continue
        if ending != ".pch" or _EXTRN.search(beside.read_bytes()[:_LARGEST]):
            return beside
    return None


def _of_superelement(path: Path) -> RowLabels:
    """Coordinates of the boundary of an external superelement of Nastran."""
    try:
        boundary = read_boundary(path, MOST_COORDINATES)
    except GeometryError as error:
        raise HousingError(f"{path.name}: expected the punch file of EXTSEOUT; {error}") from error
    found = tuple((point, int(axis)) for point, axes in boundary.points for axis in axes)
    if len(found) > MOST_COORDINATES:
        raise HousingError(f"{path.name}: expected at most {MOST_COORDINATES} rows; got {len(found)}")
    return RowLabels(found, boundary.axes)


def write_row_labels(path: Path, coordinates: Sequence[Coordinate]) -> None:
    """Write a line ``node.component`` for each coordinate."""
    path.write_text("".join(f"{node}.{axis}\n" for node, axis in coordinates), encoding="ascii")
