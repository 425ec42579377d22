"""Files that name the node and component of each row of a matrix: mappings of Ansys and of CalculiX.

- HBMAT of Ansys writes a line for each equation: its number, the node, and the label of its degree of freedom.
- ``*FREQUENCY, SOLVER=MATRIXSTORAGE`` of CalculiX writes ``node.direction``. Several directions behind one point,
  such as ``101.123456``, are as many rows, and direction 0 is an internal coordinate.
"""

import re
from collections.abc import Sequence
from pathlib import Path

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.matrices import MOST_COORDINATES, Coordinate

LABELS = ("UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ")
"""Degrees of freedom 1 to 6 of Ansys."""

_LARGEST = 10_000_000
_ANSYS = re.compile(r"\s*(\d{1,9})\s+(\d{1,9})\s+([A-Z]\w*)\s*", re.IGNORECASE)
_CALCULIX = re.compile(r"\s*(\d{1,9})\.(0|[1-6]{1,6})\s*")


def read_row_labels(path: Path) -> tuple[Coordinate, ...]:
    """Read the coordinates of the rows of a matrix, in their order.

    Degrees of freedom other than the six of :data:`LABELS` are internal coordinates.

    Raises
    ------
    HousingError
        Where the file has no rows, or their numbers have gaps.
    """
    try:
        if path.stat().st_size > _LARGEST:
            raise HousingError(f"{path.name}: expected a file of at most {_LARGEST // 10**6} MB")
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
    return tuple(found)


def write_row_labels(path: Path, coordinates: Sequence[Coordinate]) -> None:
    """Write a line ``node.component`` for each coordinate."""
    path.write_text("".join(f"{node}.{axis}\n" for node, axis in coordinates), encoding="ascii")
