"""Matrices as text of Abaqus and CalculiX: terms by node and degree of freedom, and linear user elements.

- ``*MATRIX OUTPUT`` of Abaqus, ``*SUBSTRUCTURE MATRIX OUTPUT, OUTPUT FILE=MATRIX`` of CalculiX: a line for each term,
  with the node and degree of freedom of its row and of its column; or, as ``FORMAT=COORDINATE``, row and column alone.
- ``*SUBSTRUCTURE MATRIX OUTPUT, OUTPUT FILE=USER DEFINED``: ``*USER ELEMENT, LINEAR`` with its nodes in a comment, the
  degrees of freedom of the first node, those from other places in the list on, and ``*MATRIX`` by rows up to the
  diagonal.
- ``*FREQUENCY, SOLVER=MATRIXSTORAGE`` of CalculiX: row, column and number in ``.sti`` and ``.mas``.

Formats: Abaqus Keywords Guide, MATRIX OUTPUT, SUBSTRUCTURE MATRIX OUTPUT and USER ELEMENT; CalculiX CrunchiX manual,
the same keywords and FREQUENCY. Both programs number degrees of freedom from 1 to 6 along and about x, y, z; others,
and those of nodes below 1, which Abaqus adds itself, are internal coordinates.
"""

import re
import warnings
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.matrices import MOST_COORDINATES, Coordinate, LabelledMatrix, chosen_matrix
from gearwhine.numerics.arrays import FloatArray

_INTERNAL = 1000  # internal numbers that one node may have
_LARGEST_NODE = 1e9
_ACTIVE = re.compile(r" *\d+( *, *\d+)*,? *")


def read_abaqus(text: str, file: str, name: str = "", kind: str = "") -> LabelledMatrix:
    """Read the matrix of a file of terms, or that of a type in a user element.

    Parameters
    ----------
    text : str
    file : str
        Name of the file, for messages.
    name : str
        ``STIFFNESS`` or ``MASS`` of a user element with both.
    kind : {"", "mass", "stiffness", "damping"}
        Matrix that is meant where no name is given.

    Raises
    ------
    HousingError
        Where the file is neither, is damaged or too large.
    """
    lines = text.splitlines()
    if any(line.lstrip().upper().startswith("*USER ELEMENT") for line in lines):
        return _of_user_element(lines, file, name, kind)
    return _of_terms(lines, file)


def coordinate_of(node: int, axis: int) -> Coordinate:
    """Return the coordinate of a node's degree of freedom, an internal one where it is no motion of a node."""
    if node > 0 and 1 <= axis <= 6:
        return node, axis
    return abs(node) * _INTERNAL + axis + _INTERNAL // 2 * (node > 0), 0


# -------------------------------------------------------------------------------------------------------------- terms


def _of_terms(lines: list[str], file: str) -> LabelledMatrix:
    """Read lines of row and column, each a node and a degree of freedom or a number alone, and a term."""
    keyword = next((line.strip() for line in lines if re.match(r" *\*[^*]", line)), None)
    if keyword is not None:
        raise HousingError(f"{file}: expected the terms of a matrix or a *USER ELEMENT; it has {keyword[:60]}")
    data = [line.strip().rstrip(",") for line in lines if line.strip() and not line.lstrip().startswith("*")]
    table = _table(data, file)
    if table.shape[1] not in (3, 5):
        expected = "five numbers a line (node, degree of freedom, node, degree of freedom, term), or three"
        raise HousingError(f"{file}: expected {expected} (row, column, term); got {table.shape[1]}")
    labels, terms = table[:, :-1], table[:, -1]
    if not np.isfinite(table).all():
        raise HousingError(f"{file}: expected finite numbers in every line")
    if (labels != np.round(labels)).any() or np.abs(labels).max() > _LARGEST_NODE:
        raise HousingError(f"{file}: expected whole numbers of rows and columns")
    half = labels.shape[1] // 2
    if half == 2 and (labels[:, [1, 3]].min() < 1 or labels[:, [1, 3]].max() >= _INTERNAL // 2):
        raise HousingError(f"{file}: expected degrees of freedom from 1 to {_INTERNAL // 2 - 1}")
    both = np.vstack([labels[:, :half], labels[:, half:]]).astype(np.int64)
    if half == 1:
        if both.min() < 1:
            raise HousingError(f"{file}: expected rows and columns from 1 on")
        order, places = int(both.max()), both[:, 0] - 1
        coordinates = None
    else:
        found, inverse = np.unique(both, axis=0, return_inverse=True)
        order, places = len(found), inverse.reshape(-1)
        coordinates = tuple(coordinate_of(node, axis) for node, axis in found.tolist())
    if order > MOST_COORDINATES:
        raise HousingError(f"{file} has {order} coordinates; expected at most {MOST_COORDINATES}")
    rows, columns = places[: len(terms)], places[len(terms) :]
    return LabelledMatrix(filled(rows, columns, terms, order, file), coordinates)


def filled(
    rows: npt.NDArray[np.int64], columns: npt.NDArray[np.int64], terms: FloatArray, order: int, file: str
) -> FloatArray:
    """Put terms into their places, shape (order, order); where one triangle alone is given, into the other one too.

    Raises
    ------
    HousingError
        Where a term is given twice.
    """
    place, count = np.unique(rows * order + columns, return_counts=True)
    if (count > 1).any():
        row, column = divmod(int(place[count > 1][0]), order)
        raise HousingError(f"{file}: expected each term once; row {row + 1}, column {column + 1} is given again")
    values = np.zeros((order, order))
    values[rows, columns] = terms
    beside = rows != columns
    given = np.zeros((order, order), dtype=bool)
    given[rows[beside], columns[beside]] = True
    if not (given & given.T).any():
        values[columns[beside], rows[beside]] = terms[beside]
    return values


def _table(lines: list[str], file: str) -> FloatArray:
    """Read lines of numbers that have equally many."""
    if not lines:
        raise HousingError(f"{file}: expected the terms of a matrix; it has none")
    separator = "," if "," in lines[0] else None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return np.loadtxt(lines, delimiter=separator, ndmin=2)
    except (ValueError, UserWarning) as error:
        raise HousingError(f"{file}: expected numbers alone, equally many in each line ({error})") from None


# ------------------------------------------------------------------------------------------------------- user element


@dataclass
class _UserElement:
    """What has been read of a user element: nodes of its list, degrees of freedom, and numbers by type of matrix."""

    nodes: list[int] = field(default_factory=list)
    active: list[list[int]] = field(default_factory=list)
    numbers: dict[str, list[str]] = field(default_factory=dict)

    def coordinates(self, file: str) -> tuple[Coordinate, ...]:
        """Coordinates of the rows: the degrees of freedom of each node of the list in turn.

        Raises
        ------
        HousingError
            Where a line of degrees of freedom begins at no place of the list, or the list has a coordinate twice.
        """
        first, *others = self.active or [[]]
        later = {place: axes for place, *axes in others}
        if not first or any(not 2 <= place <= len(self.nodes) or not axes for place, axes in later.items()):
            raise HousingError(f"{file}: expected the degrees of freedom of each of the {len(self.nodes)} nodes")
        coordinates, axes = list[Coordinate](), first
        for place, node in enumerate(self.nodes, start=1):
            axes = later.get(place, axes)
            coordinates += [coordinate_of(node, axis) for axis in axes]
        if len(coordinates) > MOST_COORDINATES:
            raise HousingError(f"{file} has {len(coordinates)} coordinates; expected at most {MOST_COORDINATES}")
        if len(set(coordinates)) < len(coordinates):
            raise HousingError(f"{file}: expected each degree of freedom of a node once")
        return tuple(coordinates)


def _of_user_element(lines: list[str], file: str, name: str, kind: str) -> LabelledMatrix:
    """Read a matrix of a linear user element."""
    element = _parsed(lines, file)
    coordinates = element.coordinates(file)
    wanted = chosen_matrix(list(element.numbers), name.upper(), kind, file)
    text = " ".join(element.numbers[wanted]).replace(",", " ").upper().replace("D", "E").split()
    n = len(coordinates)
    try:
        numbers = np.array(text, dtype=np.float64)
    except ValueError as error:
        raise HousingError(f"{file}: expected numbers in the matrix of type {wanted} ({error})") from None
    values = np.zeros((n, n))
    if numbers.size == n * (n + 1) // 2:
        lower = np.tril_indices(n)
        values[lower] = numbers
        values.T[lower] = numbers
    elif numbers.size == n * n:
        values = numbers.reshape(n, n)
    else:
        expected = f"{n * (n + 1) // 2} numbers of its {n} degrees of freedom, by rows up to the diagonal"
        raise HousingError(f"{file}: expected in the matrix of type {wanted} {expected}; got {numbers.size}")
    return LabelledMatrix(values, coordinates)


def _parsed(lines: list[str], file: str) -> _UserElement:
    """Sort the lines of a user element: nodes in comments, degrees of freedom, numbers of matrices."""
    element, part = _UserElement(), ""
    for number, raw in enumerate(lines, start=1):
        line = raw.strip()
        upper = re.sub(r"\s+", "", line.upper())
        if not line:
            continue
        if upper.startswith("**"):
            if part == "element" and _ACTIVE.fullmatch(line[2:].replace("-", "")):
                element.nodes += _whole(line[2:], file, number)
        elif upper.startswith("*USERELEMENT"):
            if element.active:
                raise HousingError(f"{file}, line {number}: expected one *USER ELEMENT; it has another one")
            part = "element"
        elif upper.startswith("*MATRIX"):
            of = re.search(r"TYPE=(\w+)", upper)
            part = "" if of is None else of[1]
            if part in ("", "ELEMENT") or part in element.numbers:
                raise HousingError(f"{file}, line {number}: expected *MATRIX with a type, each once")
            element.numbers[part] = []
        elif upper.startswith("*"):
            part = ""
        elif part == "element":
            element.active.append(_whole(line, file, number))
        elif part:
            element.numbers[part].append(line)
        if len(element.nodes) > MOST_COORDINATES or len(element.active) > MOST_COORDINATES:
            raise HousingError(f"{file}: expected at most {MOST_COORDINATES} nodes")
    if not element.nodes or not element.numbers:
        raise HousingError(f"{file}: expected the nodes of the element in comments, and a *MATRIX after them")
    return element


def _whole(text: str, file: str, number: int) -> list[int]:
    """Whole numbers between commas; the last one may have a comma behind it."""
    try:
        found = [int(part) for part in text.strip().rstrip(",").split(",")]
    except ValueError:
        raise HousingError(f"{file}, line {number}: expected whole numbers; got {text.strip()[:60]!r}") from None
    if any(abs(one) > _LARGEST_NODE for one in found):
        raise HousingError(f"{file}, line {number}: expected numbers of nodes up to {_LARGEST_NODE:g}")
    return found
