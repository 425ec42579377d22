"""Harwell-Boeing files, as HBMAT of Ansys writes them as text.

Format: I. S. Duff, R. G. Grimes, J. G. Lewis, *Users' Guide for the Harwell-Boeing Sparse Matrix Collection* (1992),
section 2. Four lines: title; numbers of lines in all, of pointers, row indices, values and right-hand sides; type,
rows, columns and entries; formats. With right-hand sides a fifth line follows. Type RSA has one triangle, RUA has all.
"""

import re
from collections.abc import Sequence

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.abaqus import filled
from gearwhine.housing.reduced.matrices import MOST_COORDINATES
from gearwhine.numerics.arrays import FloatArray

_FORMAT = re.compile(r"\((?:\d*P,?)?(\d*)([IEDFG])(\d+)(?:\.\d+)?(?:E\d+)?\)")


def read_harwell_boeing(text: str, file: str) -> FloatArray:
    """Read the real square matrix of a file, shape (n, n).

    Raises
    ------
    HousingError
        Where the matrix is of another type, not square or too large, or the file is damaged.
    """
    lines = text.splitlines()
    head = lines[1:4]
    if len(head) < 3:
        raise HousingError(f"{file}: expected a Harwell-Boeing file, which begins with four lines")
    counts = _whole(head[0].split(), file)
    kind, *sizes = head[1].split() or [""]
    rows, columns, entries = ([*_whole(sizes, file), 0, 0, 0])[:3]
    if kind.upper() not in ("RSA", "RUA"):
        raise HousingError(f"{file}: expected a matrix of type RSA or RUA (real, assembled); got {kind[:20]!r}")
    if rows != columns or not 0 < rows <= MOST_COORDINATES:
        raise HousingError(
            f"{file} holds {rows} x {columns}; expected a square matrix of order 1 to {MOST_COORDINATES}"
        )
    if len(counts) < 4 or min(counts) < 0 or not 0 < entries <= rows * rows:
        raise HousingError(f"{file}: expected the numbers of lines, and from 1 to {rows * rows} entries; got {entries}")
    widths = [int(match[3]) for match in _FORMAT.finditer(re.sub(r"\s", "", head[2].upper()))]
    if len(widths) < 3 or min(widths) < 1:
        raise HousingError(f"{file}: expected the formats of the numbers; got {head[2].strip()[:60]!r}")
    at = 5 if len(counts) > 4 and counts[4] else 4
    fields = list[list[str]]()
    for count, width, needed in zip(counts[1:4], widths, (rows + 1, entries, entries), strict=False):
        parts = [part for line in lines[at : at + count] for part in _fields(line, width)]
        if len(parts) < needed:
            raise HousingError(f"{file}: expected {needed} numbers in {count} lines after line {at}; got {len(parts)}")
        fields.append(parts[:needed])
        at += count
    pointers, indices = (np.array(_whole(part, file), dtype=np.int64) - 1 for part in fields[:2])
    try:
        values = np.array([part.upper().replace("D", "E") for part in fields[2]], dtype=np.float64)
    except ValueError as error:
        raise HousingError(f"{file}: expected real numbers ({error})") from None
    lengths = np.diff(pointers)
    if pointers[0] != 0 or pointers[-1] != entries or (lengths < 0).any():
        raise HousingError(f"{file}: expected pointers that ascend from 1 to {entries + 1}")
    if indices.min() < 0 or indices.max() >= rows:
        raise HousingError(f"{file}: expected row indices from 1 to {rows}")
    if not np.isfinite(values).all():
        raise HousingError(f"{file}: expected finite numbers")
    of_column = np.repeat(np.arange(rows, dtype=np.int64), lengths)
    if kind.upper() == "RSA":
        return filled(indices, of_column, values, rows, file)
    full = np.zeros((rows, rows))
    full[indices, of_column] = values
    return full


def _fields(line: str, width: int) -> list[str]:
    """Fields of a line that are not blank."""
    parts = (line[first : first + width].strip() for first in range(0, len(line), width))
    return [part for part in parts if part]


def _whole(parts: Sequence[str], file: str) -> list[int]:
    try:
        found = [int(part) for part in parts]
    except ValueError as error:
        raise HousingError(f"{file}: expected whole numbers ({error})") from None
    if any(abs(one) > 10**15 for one in found):
        raise HousingError(f"{file}: expected whole numbers of at most fifteen digits")
    return found
