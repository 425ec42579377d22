"""OUTPUT4 files of Nastran: matrices by columns, binary or as text, dense or sparse.

Format: NX Nastran User's Guide, module OUTPUT4. A matrix begins with NCOL, NROW, form, type and name; NROW is negative
where strings have a head of two numbers. A column is ICOL, IROW, NW and its numbers: from row IROW on, or, where IROW
is 0, strings of L words from row I on, each with the head I + 65536 (L + 1), or L + 1 and I. A double has two words.
The column NCOL + 1 ends the matrix. A symmetric matrix has all its columns. Integers, words and real numbers of
binary files of 64-bit Nastran have eight bytes, names sixteen.
"""

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.matrices import MOST_COORDINATES, chosen_matrix
from gearwhine.numerics.arrays import FloatArray

Strings = Iterator[tuple[int, int, FloatArray]]
"""Column, first row and numbers of each string of a matrix."""

_REAL_TYPES = (1, 2)  # single and double precision
_STRING = 65536


@dataclass(frozen=True)
class _Head:
    """Beginning of a matrix."""

    name: str
    columns: int
    rows: int
    type: int
    two_numbers: bool


@dataclass(frozen=True)
class _Layout:
    """Order of the bytes, ``<`` or ``>``, and number of them in a word of a binary file, 4 or 8."""

    order: str
    word: int

    @property
    def head(self) -> int:
        """Bytes of the record that begins a matrix: four integers and a name of two words."""
        return 6 * self.word

    def integers(self, data: bytes, count: int) -> tuple[int, ...]:
        """Return the first integers of a record."""
        return struct.unpack(f"{self.order}{count}{'q' if self.word == 8 else 'i'}", data[: count * self.word])

    def name(self, data: bytes) -> str:
        """Name of a matrix: two words of eight characters, of which some programs fill four and four with blanks."""
        text = data.decode("latin-1").upper()
        parts = [text[at : at + self.word] for at in range(0, len(text), self.word)]
        return "".join(part[:4] if not part[4:].strip() else part for part in parts).strip()

    def number(self, kind: int) -> "np.dtype[np.float64] | np.dtype[np.float32]":
        """Numbers of a matrix of this type."""
        return np.dtype(self.order + ("f4" if self.word == 4 and kind == 1 else "f8"))


def read_op4(path: Path, name: str = "", kind: str = "") -> FloatArray:
    """Read the real square matrix of a name, the only one, or that of a usual name; shape (n, n).

    Parameters
    ----------
    path : path
    name : str
    kind : {"", "mass", "stiffness", "damping"}
        Matrix that is meant where no name is given.

    Raises
    ------
    HousingError
        Where there is no such matrix, it is complex, not square or too large, or the file is damaged. Where no name is
        given, such matrices are passed over beside others.
    OSError
        Where the file cannot be opened.
    """
    content = path.read_bytes()
    parts = _of_text if _is_text(content) else _of_records
    heads = list[_Head]()
    for head, columns in parts(content, path.name):
        heads.append(head)
        for _ in columns:
            pass
    meant = [head for head in heads if name.upper() in ("", head.name)]
    square = [head for head in meant if not _fault(head)]
    if meant and not square:
        raise HousingError(f"{path.name}: {_fault(meant[0])}")
    # An external superelement has loads, recovery rows and empty matrices of order 1 beside stiffness and mass.
    filled = [head for head in square if head.rows > 1] or square
    wanted = chosen_matrix([head.name for head in filled or heads], name.upper(), kind, path.name)
    for head, columns in parts(content, path.name):
        if head.name == wanted:
            return _square(head, columns, path.name)
        for _ in columns:
            pass
    raise AssertionError(wanted)


def _fault(head: _Head) -> str:
    """Why a matrix is none of a housing: it is complex, not square or too large; empty where it may be one."""
    if head.type not in _REAL_TYPES:
        return f"matrix {head.name} is of type {head.type}; expected 1 or 2 (real)"
    if head.columns != head.rows or not 0 < head.rows <= MOST_COORDINATES:
        size = f"{head.rows} x {head.columns}"
        return f"{head.name} is {size}; expected a square matrix of order 1 to {MOST_COORDINATES}"
    return ""


def _square(head: _Head, columns: Strings, file: str) -> FloatArray:
    """Put the strings of a matrix into their places."""
    values = np.zeros((head.rows, head.columns))
    for column, row, numbers in columns:
        if not (1 <= column <= head.columns and row >= 1 and row + numbers.size - 1 <= head.rows):
            last = row + numbers.size - 1
            raise HousingError(
                f"{file}: rows {row} to {last} of column {column} of {head.name}; expected rows within its order, "
                f"{head.rows}"
            )
        values[row - 1 : row - 1 + numbers.size, column - 1] = numbers
    if not np.all(np.isfinite(values)):
        raise HousingError(f"{file}: {head.name} has entries that are not finite; expected real numbers")
    return values


# ------------------------------------------------------------------------------------------------------------ binary


def _is_text(content: bytes) -> bool:
    """Whether the first line of a file is that of a matrix as text, of printable characters."""
    return bool(re.match(rb"[ 0-9-]{32}", content[:32]))


def _of_records(content: bytes, file: str) -> Iterator[tuple[_Head, Strings]]:
    """Yield the matrices of a binary file, whose first four bytes tell its layout."""
    layouts = [_Layout(order, word) for order in "<>" for word in (4, 8)]
    begins = content[:4].ljust(4, b"\0")
    layout = next((one for one in layouts if struct.unpack(one.order + "i", begins)[0] == one.head), None)
    if layout is None:
        raise HousingError(f"{file}: expected an OUTPUT4 file of Nastran, binary or text")
    records = _records(content, layout.order, file)
    for record in records:
        if len(record) != layout.head:
            raise HousingError(f"{file}: expected the beginning of a matrix after the last one")
        columns, rows, _, kind = layout.integers(record, 4)
        head = _Head(layout.name(record[4 * layout.word :]), columns, abs(rows), kind, rows < 0)
        yield head, _binary_columns(records, head, layout, file)


def _records(content: bytes, order: str, file: str) -> Iterator[bytes]:
    """Yield the records of an unformatted file: each has its number of bytes before and after it."""
    at = 0
    while at < len(content):
        size = struct.unpack(order + "i", content[at : at + 4])[0] if at + 4 <= len(content) else -1
        end = at + 4 + size
        if size < 0 or content[end : end + 4] != content[at : at + 4]:
            raise HousingError(f"{file}: expected whole records; that at byte {at} is cut off or damaged")
        yield content[at + 4 : end]
        at = end + 4


def _binary_columns(records: Iterator[bytes], head: _Head, layout: _Layout, file: str) -> Strings:
    """Yield column, first row and numbers of each string of a matrix up to its last record."""
    word, dtype = layout.word, layout.number(head.type)
    for record in records:
        if len(record) < 3 * word:
            raise HousingError(f"{file}: expected the columns of {head.name}, complete to its end")
        column, row, _ = layout.integers(record, 3)
        if column > head.columns:
            return
        data = record[3 * word :]
        if row > 0:
            yield column, row, _numbers(data, dtype, file)
            continue
        while data:
            row, count, data = _string(data, head, layout, file)
            yield column, row, _numbers(data[: word * count], dtype, file)
            data = data[word * count :]
    raise HousingError(f"{file}: expected the columns of {head.name}, complete to its end")


def _string(data: bytes, head: _Head, layout: _Layout, file: str) -> tuple[int, int, bytes]:
    """First row, number of words, and what follows the head of a string."""
    size = (2 if head.two_numbers else 1) * layout.word
    if len(data) < size:
        raise HousingError(f"{file}: expected whole strings in the columns of {head.name}")
    if head.two_numbers:
        length, row = layout.integers(data, 2)
    else:
        length, row = divmod(layout.integers(data, 1)[0], _STRING)
    if not 2 <= length <= len(data) // layout.word:
        raise HousingError(f"{file}: expected whole strings in the columns of {head.name}")
    return row, length - 1, data[size:]


def _numbers(data: bytes, dtype: "np.dtype[np.float64] | np.dtype[np.float32]", file: str) -> FloatArray:
    if len(data) % dtype.itemsize:
        raise HousingError(f"{file}: expected whole numbers in each column")
    return np.frombuffer(data, dtype).astype(np.float64)


# -------------------------------------------------------------------------------------------------------------- text

_NUMBERS = re.compile(r"(\d+)[EDed](\d+)\.(\d+)")  # of the format of the numbers, such as 1P,3E23.16
_REAL = re.compile(r" *[+-]?[0-9]*\.")
_FIELD = 8


def _of_text(content: bytes, file: str) -> Iterator[tuple[_Head, Strings]]:
    """Yield the matrices of a file as text."""
    lines = _Lines(content.decode("latin-1").splitlines(), file)
    while lines.has_more:
        line = lines.next()
        columns, rows, _, kind = lines.integers(line, 4)
        form = _NUMBERS.search(line[5 * _FIELD :])
        if form is None:
            raise HousingError(f"{file}, line {lines.number}: expected the format of the numbers, such as 1P,3E23.16")
        name = line[4 * _FIELD : 5 * _FIELD].strip().upper()
        head = _Head(name, columns, abs(rows), kind, rows < 0)
        yield head, _text_columns(lines, head, int(form.group(2)))


class _Lines:
    """Lines of a file, one after another."""

    def __init__(self, lines: list[str], file: str) -> None:
        self._lines, self.file, self.number = lines, file, 0

    @property
    def has_more(self) -> bool:
        """Whether a line that is not blank follows."""
        while self.number < len(self._lines) and not self._lines[self.number].strip():
            self.number += 1
        return self.number < len(self._lines)

    def next(self) -> str:
        """Return the next line."""
        if not self.has_more:
            raise HousingError(f"{self.file}: expected the columns of its last matrix, complete to its end")
        self.number += 1
        return self._lines[self.number - 1]

    def integers(self, line: str, count: int) -> list[int]:
        """Integers in fields of eight characters."""
        try:
            return [int(line[_FIELD * place : _FIELD * (place + 1)]) for place in range(count)]
        except ValueError:
            raise HousingError(f"{self.file}, line {self.number}: expected {count} whole numbers") from None

    def numbers(self, width: int) -> FloatArray:
        """Real numbers of the lines that follow, up to a line of whole numbers."""
        found: list[float] = []
        while self.has_more and _REAL.match(self._lines[self.number]):
            line = self.next().rstrip().upper().replace("D", "E")
            try:
                found += [float(line[at : at + width]) for at in range(0, len(line), width)]
            except ValueError:
                raise HousingError(f"{self.file}, line {self.number}: expected numbers {width} wide") from None
        return np.array(found)


def _text_columns(lines: _Lines, head: _Head, width: int) -> Strings:
    """Yield column, first row and numbers of each string of a matrix up to its last record."""
    words = 1 if head.type in (1, 3) else 2  # of a real number, or of a part of a complex one
    while True:
        column, row, left = lines.integers(lines.next(), 3)
        if column > head.columns:
            lines.numbers(width)
            return
        if row > 0:
            yield column, row, lines.numbers(width)
            continue
        while left > 0:
            line = lines.next()
            if head.two_numbers:
                length, row = lines.integers(line, 2)
            else:
                length, row = divmod(_whole(line, lines), _STRING)
            numbers = lines.numbers(width)
            if numbers.size * words != length - 1:
                raise HousingError(
                    f"{lines.file}, line {lines.number}: expected {(length - 1) // words} numbers in a string of "
                    f"{head.name}; got {numbers.size}"
                )
            left -= length - 1 + (2 if head.two_numbers else 1)
            yield column, row, numbers


def _whole(line: str, lines: _Lines) -> int:
    """Whole number of a line; it may be wider than a field."""
    try:
        return int(line)
    except ValueError:
        raise HousingError(f"{lines.file}, line {lines.number}: expected a whole number") from None
