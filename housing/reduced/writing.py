"""Writers of reduced matrices for other programs: NumPy, NetCDF, Matrix Market, OUTPUT4 and DMIG of Nastran.

Formats as in :mod:`gearwhine.housing.reduced.matrix_files`, :mod:`gearwhine.housing.reduced.op4` and
:mod:`gearwhine.housing.reduced.dmig`.
"""

import struct
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from scipy import io

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.matrices import Coordinate, ReducedMatrices
from gearwhine.housing.reduced.row_labels import write_row_labels
from gearwhine.housing.storage.netcdf import Variables, write_netcdf
from gearwhine.numerics.arrays import FloatArray

_LARGE = 16  # characters of a large field

WRITTEN_ENDINGS = (".npz", ".nc", ".mtx", ".op4", ".pch")
NAMES = {"mass": "MAAX", "stiffness": "KAAX", "damping": "BAAX"}
"""Names of the matrices in files of Nastran."""


def write_matrices(path: Path, matrices: ReducedMatrices) -> dict[str, Path]:
    """Write the matrices in SI into one file, or into one each where the format holds only one.

    Parameters
    ----------
    path : path
        File that ends in ``.npz``, ``.nc``, ``.mtx``, ``.op4`` or ``.pch``. With ``.mtx`` its name gets the matrix
        before the ending: ``box.mtx`` becomes ``box-mass.mtx`` and so on.
    matrices : ReducedMatrices

    Returns
    -------
    dict of str to path
        File of ``mass``, ``stiffness`` and ``damping``, where there is one; of a format that does not name the rows,
        as ``mapping`` the ``.dof`` file that does.

    Raises
    ------
    HousingError
        Where the ending is another one.
    """
    values = {"mass": matrices.mass, "stiffness": matrices.stiffness}
    if matrices.damping is not None:
        values["damping"] = matrices.damping
    ending = path.suffix.lower()
    if ending == ".mtx":
        files = {kind: path.with_name(f"{path.stem}-{kind}{path.suffix}") for kind in values}
        for kind, file in files.items():
            with file.open("wb") as out:
                io.mmwrite(out, values[kind], precision=17, symmetry="symmetric")
        return files | _mapping(path, matrices)
    if ending == ".npz":
        nodes, axes = np.array(matrices.coordinates, dtype=np.int64).T
        np.savez(path, **values, nodes=nodes, axes=axes)  # type: ignore[arg-type]
    elif ending == ".nc":
        nodes, axes = np.array(matrices.coordinates, dtype=np.int64).T
        square = {kind: (("row", "column"), matrix, {"units": "SI"}) for kind, matrix in values.items()}
        labels: Variables = {"nodes": ("row", nodes, {}), "axes": ("row", axes, {})}
        write_netcdf(path, {**square, **labels}, {"title": "Reduced matrices; axis 0 is an internal coordinate"})
    elif ending == ".op4":
        path.write_bytes(b"".join(_records(NAMES[kind], matrix) for kind, matrix in values.items()))
        return dict.fromkeys(values, path) | _mapping(path, matrices)
    elif ending == ".pch":
        path.write_text("\n".join([*_dmig(values, matrices.coordinates), ""]), encoding="ascii")
    else:
        raise HousingError(f"{path.name}: expected a file that ends in one of {', '.join(WRITTEN_ENDINGS)}")
    return dict.fromkeys(values, path)


def _mapping(path: Path, matrices: ReducedMatrices) -> dict[str, Path]:
    """Write the coordinates of the rows into a file beside that of the matrices."""
    labels = path.with_suffix(".dof")
    write_row_labels(labels, matrices.coordinates)
    return {"mapping": labels}


def _records(name: str, matrix: FloatArray) -> bytes:
    """Matrix as OUTPUT4: symmetric, of doubles, dense, with integers of 32 bits, low bytes first."""

    def record(integers: tuple[int, ...], data: bytes) -> bytes:
        content = struct.pack(f"<{len(integers)}i", *integers) + data
        size = struct.pack("<i", len(content))
        return size + content + size

    order = len(matrix)
    numbered = enumerate(matrix.T, start=1)
    columns = [record((number, 1, 2 * order), column.astype("<f8").tobytes()) for number, column in numbered]
    head = record((order, order, 6, 2), f"{name:8}".encode("ascii"))
    return b"".join([head, *columns, record((order + 1, 1, 2), np.array([1.0], "<f8").tobytes())])


def _dmig(values: Mapping[str, FloatArray], coordinates: tuple[Coordinate, ...]) -> Iterator[str]:
    """Yield entries in large fields."""

    def line(head: str, *fields: object) -> str:
        return f"{head:8}" + "".join(f"{field!s:>16}" for field in fields)

    yield "$ kg, m, s, N; scalar points are internal coordinates"
    for kind, matrix in values.items():
        name = NAMES[kind]
        yield f"{'DMIG':8}{name:8}{0:>8}{6:>8}{2:>8}{0:>8}{'':16}{len(matrix):>8}"
        for column, (node, axis) in enumerate(coordinates):
            rows = column + np.flatnonzero(matrix[column:, column])
            if rows.size:
                yield line("DMIG*", name, node, axis, "")
            for row in rows.tolist():
                yield line("*", *coordinates[row], _field(float(matrix[row, column])))


def _field(value: float) -> str:
    """Return a number in sixteen characters, without the letter of its exponent: 1.23456789012+7."""
    for decimals in range(11, 6, -1):
        mantissa, exponent = f"{value:.{decimals}E}".split("E")
        if len(text := f"{mantissa}{int(exponent):+d}") <= _LARGE:
            break
    return text
