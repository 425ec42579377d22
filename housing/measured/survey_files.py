"""Survey files: universal files, and CSV tables of measured modes, chosen by their ending.

Tables have two forms, distinguished by the first cell of the header:

- ``frequency_hz[,damping_ratio]``: a mode a row.
- ``point,x,y,z,direction,NAME,…``: a degree of freedom a row, a mode a column. `direction` is an axis (``x``, ``-y``)
  or three numbers parted by blanks. A column named like the one before it with `` imag`` after it holds its imaginary
  part. Two rows without a place stand above the others: ``frequency_hz`` and, if known, ``damping_ratio``. An empty
  cell was not measured. Lengths are in metres, or in the unit of the column, ``x [mm]``, or in that given to the
  reader.

Commas, semicolons or tabs separate the cells; a line that begins with # is a remark.
"""

import csv
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured.survey_data import MeasuredGeometry, MeasuredModes, SurveyData
from gearwhine.housing.measured.universal_datasets import Frame
from gearwhine.housing.measured.universal_reading import read_universal
from gearwhine.housing.measured.universal_writing import write_universal
from gearwhine.housing.storage.atomic_file import atomic_file
from gearwhine.meshes.lengths import UNITS
from gearwhine.numerics.arrays import FloatArray

_FREQUENCY, _RATIO = "frequency_hz", "damping_ratio"
_PLACES = ("point", "x", "y", "z", "direction")
_IMAGINARY = " imag"
_AXES = {
    sign + name: factor * axis
    for sign, factor in (("", 1), ("+", 1), ("-", -1))
    for name, axis in zip("xyz", np.eye(3), strict=True)
}


def read_table(path: str | Path, *, unit: str | None = None) -> SurveyData:
    """Read a table of frequencies or of shapes.

    Parameters
    ----------
    path : path
    unit : {"m", "mm", "cm", "in"}, optional
        Unit of the lengths, where the header names none; a metre otherwise.

    Raises
    ------
    MeasuredDataError
        Where a cell is wrong; the message names the line, its content and the expected form.
    """
    path = Path(path)
    rows = _rows(path)
    header = [cell.lower() for cell in rows[0][1]]
    if header[0] == _FREQUENCY:
        return SurveyData(modes=_frequencies(rows, header, path.name))
    if header[0] == "point":
        return _shapes(rows, path.name, unit)
    raise MeasuredDataError(
        f"{path.name}: the first column is {rows[0][1][0]!r}; expected '{_FREQUENCY}' (a mode a row) or 'point' (a "
        "degree of freedom a row)"
    )


def write_table(path: str | Path, survey: SurveyData) -> None:
    """Write frequencies, or shapes with their points and frequencies, with every digit; points alone as they are.

    Trace lines have no place in a table.
    """
    path = Path(path)
    modes, geometry = survey.modes, survey.geometry
    lines: list[list[str]] = []
    if geometry is None or (modes is not None and modes.shapes is None):
        assert modes is not None
        ratios = modes.damping_ratios
        lines.append([_FREQUENCY] if ratios is None else [_FREQUENCY, _RATIO])
        for number, frequency in enumerate(modes.frequencies):
            cells = [_digits(frequency / (2.0 * np.pi))]
            lines.append(cells if ratios is None else [*cells, _digits(ratios[number])])
    else:
        lines = _shape_lines(geometry, modes)
    with atomic_file(path) as staged, staged.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(lines)


def _shape_lines(geometry: MeasuredGeometry, modes: MeasuredModes | None) -> list[list[str]]:
    count = 0 if modes is None else len(modes.frequencies)
    names = [name for number in range(1, count + 1) for name in (f"mode {number}", f"mode {number}{_IMAGINARY}")]
    lines = [[*_PLACES, *names]]
    if modes is not None:
        for label, values in ((_FREQUENCY, modes.frequencies / (2.0 * np.pi)), (_RATIO, modes.damping_ratios)):
            if values is not None:
                lines.append([label, "", "", "", "", *(cell for value in values for cell in (_digits(value), ""))])
    for dof, (point, direction) in enumerate(zip(geometry.points, geometry.directions, strict=True)):
        place = [_digits(value) for value in geometry.positions[point]]
        along = " ".join(_digits(value) for value in direction)
        shape = np.empty(0) if modes is None or modes.shapes is None else modes.shapes[:, dof]
        cells = [cell for value in shape for cell in (_digits(value.real), _digits(value.imag))]
        lines.append([geometry.labels[point], *place, along, *cells])
    return lines


def _digits(value: float) -> str:
    return "" if np.isnan(value) else repr(float(value))


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """Return the rows of the table without remarks, each with its line number; the header first."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise MeasuredDataError(f"{path.name} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise MeasuredDataError(f"{path.name} is no table: it is not text in UTF-8") from error
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip(" ,;\t") and not line.lstrip().startswith("#")
    ]
    if len(lines) < 2:
        raise MeasuredDataError(f"{path.name} is no table: it needs a header and at least one row")
    header = lines[0][1]
    parting = max(",;\t", key=header.count)
    rows = [(number, [cell.strip() for cell in next(csv.reader([line], delimiter=parting))]) for number, line in lines]
    width = len(rows[0][1])
    for number, cells in rows:
        if len(cells) != width:
            raise MeasuredDataError(f"line {number} of {path.name} has {len(cells)} cells; expected {width}")
    return rows


def _frequencies(rows: list[tuple[int, list[str]]], header: list[str], name: str) -> MeasuredModes:
    if header not in ([_FREQUENCY], [_FREQUENCY, _RATIO]):
        raise MeasuredDataError(f"{name} has columns {header}; expected '{_FREQUENCY}' and, if known, '{_RATIO}'")
    table = np.array([[_number(cell, number, name) for cell in cells] for number, cells in rows[1:]])
    table = table[np.argsort(table[:, 0], kind="stable")]
    return MeasuredModes(2.0 * np.pi * table[:, 0], table[:, 1] if len(header) == 2 else None)


def _shapes(rows: list[tuple[int, list[str]]], name: str, unit: str | None) -> SurveyData:
    scale, columns, parts = _header(rows[0][1], name, unit)
    above = {cells[0].lower(): cells for _, cells in rows[1:] if cells[0].lower() in (_FREQUENCY, _RATIO)}
    labels: dict[str, FloatArray] = {}
    points, directions, values = [], [], []
    for number, cells in rows[1:]:
        if cells[0].lower() in (_FREQUENCY, _RATIO):
            continue
        place = scale * np.array([_number(cell, number, name) for cell in cells[1:4]])
        if not np.allclose(labels.setdefault(cells[0], place), place, rtol=1e-9, atol=1e-12):
            raise MeasuredDataError(f"line {number} of {name}: point {cells[0]} stands at another place above")
        points.append(list(labels).index(cells[0]))
        directions.append(_direction(cells[4], number, name))
        values.append([_value(cells, column, imaginary, number, name) for column, imaginary in parts])
    if not points:
        raise MeasuredDataError(f"{name} holds no point")
    geometry = MeasuredGeometry(
        tuple(labels), np.array(list(labels.values())), np.array(points, dtype=np.int64), np.array(directions)
    )
    if not columns:
        return SurveyData(geometry)
    if _FREQUENCY not in above:
        raise MeasuredDataError(f"{name} has modes but no row '{_FREQUENCY}', which says how fast they vibrate")
    frequencies = np.array([_number(above[_FREQUENCY][column], 0, name) for column, _ in parts])
    ratios = None if _RATIO not in above else np.array([_number(above[_RATIO][column], 0, name) for column, _ in parts])
    order = np.argsort(frequencies, kind="stable")
    modes = MeasuredModes(
        2.0 * np.pi * frequencies[order],
        None if ratios is None else ratios[order],
        np.array(values).T[order],
        geometry,
    )
    return SurveyData(geometry, modes)


def _header(cells: list[str], name: str, unit: str | None) -> tuple[float, list[str], list[tuple[int, int | None]]]:
    """Metres in the table's unit, the modes' names, and the columns of each mode's real and imaginary part."""
    units: set[str] = set()
    plain = []
    for cell in cells[:5]:
        matched = re.fullmatch(r"(\w+)\s*(?:[\[(]\s*(\w+)\s*[\])])?", cell.lower())
        plain.append(matched[1] if matched else cell)
        if matched and matched[2]:
            units.add(matched[2])
    if tuple(plain) != _PLACES or len(units) > 1:
        raise MeasuredDataError(f"{name} begins with columns {cells[:5]}; expected {', '.join(_PLACES)}")
    unit_name = units.pop() if units else unit or "m"
    if unit_name not in UNITS:
        raise MeasuredDataError(f"{name}: lengths in {unit_name!r}; expected one of {', '.join(UNITS)}")
    parts: list[tuple[int, int | None]] = []
    names: list[str] = []
    for column, cell in enumerate(cells[5:], start=5):
        if names and cell == names[-1] + _IMAGINARY:
            parts[-1] = (parts[-1][0], column)
        else:
            names.append(cell)
            parts.append((column, None))
    return UNITS[unit_name], names, parts


def _value(cells: list[str], column: int, imaginary: int | None, number: int, name: str) -> complex:
    """One cell of a shape; NaN where it is empty."""
    if not cells[column]:
        return complex(np.nan, np.nan)
    return complex(
        _number(cells[column], number, name),
        0.0 if imaginary is None or not cells[imaginary] else _number(cells[imaginary], number, name),
    )


def _number(cell: str, number: int, name: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        where = f"line {number}" if number else "a row above the points"
        raise MeasuredDataError(f"{where} of {name}: {cell!r} is not a number")
    return value


def _direction(cell: str, number: int, name: str) -> FloatArray:
    if cell.lower() in _AXES:
        return np.asarray(_AXES[cell.lower()])
    parts = np.array([_number(part, number, name) for part in cell.split()])
    length = np.linalg.norm(parts)
    if parts.shape != (3,) or not length > 0.0:
        raise MeasuredDataError(
            f"line {number} of {name}: direction {cell!r}; expected an axis such as -y, or 3 numbers"
        )
    # A unit vector keeps its digits.
    return parts if abs(length - 1.0) < 1e-15 else np.asarray(parts / length)


UNIVERSAL = (".uff", ".unv", ".uf", ".bunv")
TABLES = (".csv", ".tsv", ".txt")


def read_survey(
    path: str | Path | Sequence[str | Path], *, unit: str | None = None, shape_frame: Frame | None = None
) -> SurveyData:
    """Read universal files of one survey, or a table; see :func:`read_universal` and :func:`read_table`.

    Raises
    ------
    MeasuredDataError
        Where the ending is of neither kind, a file cannot be used, or a table is one of several files.
    """
    paths = [Path(path)] if isinstance(path, str | Path) else [Path(one) for one in path]
    for one in paths:
        if one.suffix.lower() in UNIVERSAL:
            continue
        if one.suffix.lower() not in TABLES:
            raise MeasuredDataError(
                f"{one.name}: expected a universal file ({', '.join(UNIVERSAL)}) or a table ({', '.join(TABLES)})"
            )
        if len(paths) > 1:
            raise MeasuredDataError(f"{one.name} is a table, which stands alone; expected a list of universal files")
        return read_table(one, unit=unit)
    return read_universal(paths, unit=unit, shape_frame=shape_frame)


def write_survey(path: str | Path, survey: SurveyData) -> None:
    """Write a universal file or a table, whole or not at all; see :func:`write_universal` and :func:`write_table`."""
    path = Path(path)
    if path.suffix.lower() in UNIVERSAL:
        write_universal(path, survey)
    elif path.suffix.lower() in TABLES:
        write_table(path, survey)
    else:
        raise MeasuredDataError(f"{path.name}: expected an ending {', '.join(UNIVERSAL + TABLES)}")
