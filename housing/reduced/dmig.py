"""DMIG entries of Nastran: matrices at the motions of grid points, as its punch file has them.

Format: NX Nastran Quick Reference Guide, entry DMIG. The header is

    DMIG, NAME, 0, IFO, TIN, TOUT, POLAR, (blank), NCOL

with IFO 1 (square) or 6 (symmetric, one triangle given) and TIN 1 or 2 (real); a column is

    DMIG, NAME, GJ, CJ, (blank), G1, C1, A1, (B1), G2, C2, A2, (B2), ...

in free fields (commas), small ones (8 characters, eight a line) or large ones (16 characters, four a line).
"""

import io
import re
from collections.abc import Iterator

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.matrices import MOST_COORDINATES, Coordinate, LabelledMatrix, chosen_matrix

MOST_TERMS = MOST_COORDINATES**2

_SMALL, _LARGE = 8, 16
_EXPONENT = re.compile(r"(?<=[0-9.])([+-][0-9]+)$")  # of a number without the letter, such as 1.5+7


class _Entry:
    """An entry and its continuations: the line of its head, and the fields after the name DMIG."""

    def __init__(self, line: int, fields: list[str]) -> None:
        self.line, self.fields = line, fields


def read_dmig(text: str, file: str, name: str = "", kind: str = "") -> LabelledMatrix:
    """Read the DMIG matrix of a name, the only one, or that of a usual name.

    Parameters
    ----------
    text : str
    file : str
        Name of the file, for messages.
    name : str
    kind : {"", "mass", "stiffness", "damping"}
        Matrix that is meant where no name is given.

    Raises
    ------
    HousingError
        Where there is no such matrix, it is rectangular or complex, or an entry cannot be read.
    """
    name = name.upper()
    by_name: dict[str, list[_Entry]] = {}
    for entry in _entries(text, file):
        of = entry.fields[0].upper() if entry.fields else ""
        kept = by_name.setdefault(of, [])
        if name in ("", of):
            kept.append(entry)
    entries = by_name[chosen_matrix(list(by_name), name, kind, file)]
    header, *columns = entries
    is_symmetric = _is_symmetric(header, file)
    terms: dict[tuple[Coordinate, Coordinate], float] = {}
    for entry in columns:
        for pair, value in _terms(entry, file):
            if pair in terms:
                raise HousingError(f"{file}, line {entry.line}: expected each term once; {pair} is given again")
            terms[pair] = value
            if len(terms) > MOST_TERMS:
                raise HousingError(f"{file}: expected at most {MOST_TERMS} terms")
    if not terms:
        raise HousingError(f"{file}: expected columns of the matrix {entries[0].fields[0]!r} after its header")
    coordinates = sorted({one for pair in terms for one in pair}, key=lambda one: (one[1] == 0, one))
    if len(coordinates) > MOST_COORDINATES:
        raise HousingError(f"{file} has {len(coordinates)} coordinates; expected at most {MOST_COORDINATES}")
    place = {coordinate: row for row, coordinate in enumerate(coordinates)}
    values = np.zeros((len(place), len(place)))
    for (column, row), value in terms.items():
        values[place[row], place[column]] = value
        if is_symmetric:
            if column != row and (row, column) in terms:
                raise HousingError(f"{file}: expected one triangle of a symmetric matrix; {row} and {column} has both")
            values[place[column], place[row]] = value
    return LabelledMatrix(values, tuple(coordinates))


def _is_symmetric(header: _Entry, file: str) -> bool:
    """Return whether one triangle is given; refuse a header of another matrix."""
    at = f"{file}, line {header.line}"
    fields = [*header.fields, *[""] * 8]
    if fields[1] != "0":
        raise HousingError(f"{at}: expected the header of a DMIG matrix, whose third field is 0; got {fields[1]!r}")
    if fields[2] not in ("1", "6"):
        raise HousingError(f"{at}: expected a form of 1 (square) or 6 (symmetric); got {fields[2]!r}")
    if fields[3] not in ("1", "2"):
        raise HousingError(f"{at}: expected a type of 1 or 2 (real); got {fields[3]!r}")
    return fields[2] == "6"


def _terms(entry: _Entry, file: str) -> Iterator[tuple[tuple[Coordinate, Coordinate], float]]:
    """Yield ((column, row), value) of a column's entry."""
    fields = [*entry.fields, "", ""]
    column = _coordinate(fields[1], fields[2], entry, file)
    groups = entry.fields[4:]
    while groups and not groups[-1]:
        groups.pop()
    if not groups:
        raise HousingError(f"{file}, line {entry.line}: expected terms in the column of {column}")
    for first in range(0, len(groups), 4):
        node, axis, value = [*groups[first : first + 3], "", ""][:3]
        if not (node or axis or value):
            continue
        yield (column, _coordinate(node, axis, entry, file)), _real(value, entry, file)


def _coordinate(node: str, axis: str, entry: _Entry, file: str) -> Coordinate:
    """Return a grid point and its component; a scalar point has none."""
    if not re.fullmatch(r"[0-9]{1,9}", node) or not re.fullmatch(r"[0-6]?", axis):
        expected = "a grid point and a component from 0 to 6"
        raise HousingError(f"{file}, line {entry.line}: expected {expected}; got {node!r} and {axis!r}")
    return int(node), int(axis or 0)


def _real(text: str, entry: _Entry, file: str) -> float:
    """Return a real number as Nastran writes it: 1.5, 1.5E+7, 1.5D+7 or 1.5+7."""
    plain = _EXPONENT.sub(r"e\1", text.upper().replace("D", "E"))
    try:
        value = float(plain)
    except ValueError:
        raise HousingError(f"{file}, line {entry.line}: expected a real number; got {text!r}") from None
    if not np.isfinite(value):
        raise HousingError(f"{file}, line {entry.line}: expected a finite number; got {text!r}")
    return value


def _entries(text: str, file: str) -> Iterator[_Entry]:
    """Yield the DMIG entries of a file, continuations joined."""
    current: _Entry | None = None
    for number, raw in enumerate(io.StringIO(text), start=1):
        line = raw.split("$", 1)[0].rstrip().expandtabs(8)
        if not line:
            continue
        is_continuation = line[0] in " +*,"
        if is_continuation:
            if current is not None:
                current.fields += _fields(line)
            continue
        if current is not None:
            yield current
        keyword = re.split(r"[*, ]", line, maxsplit=1)[0].upper()
        current = _Entry(number, _fields(line)) if keyword == "DMIG" else None
    if current is not None:
        yield current


def _fields(line: str) -> list[str]:
    """Return the data fields of a line: four of a large one, eight otherwise, the last field's mark left out."""
    if "," in line:
        head, *fields = (field.strip() for field in line.split(","))
        count = 4 if head.endswith("*") or head.startswith("*") else 8
    else:
        is_large = "*" in line[:_SMALL]
        width, count = (_LARGE, 4) if is_large else (_SMALL, 8)
        fields = [line[_SMALL + place * width : _SMALL + (place + 1) * width].strip() for place in range(count)]
    return [*fields, *[""] * count][:count]
