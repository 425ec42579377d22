"""Readers of reduced matrices: Matrix Market, NumPy arrays, and the DMIG entries and OUTPUT4 files of Nastran.

Sizes are checked before anything is allocated, and nothing in a file is executed.
"""

import io
import zipfile
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy import io as scipy_io
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.dmig import read_dmig
from gearwhine.housing.reduced.matrices import MOST_COORDINATES, Coordinate, LabelledMatrix
from gearwhine.housing.reduced.op4 import read_op4

FloatArray = npt.NDArray[np.float64]

LARGEST_FILE = 300_000_000
"""Bytes beyond which a file is not read: a full matrix of the largest order, 24 characters a number, takes 216 MB."""

LARGEST_DMIG = 100_000_000
"""Bytes beyond which a DMIG file is not read, whose terms take several times as much while they are read."""

ENDINGS = (".mtx", ".npz", ".op4", ".pch", ".bdf", ".dat", ".nas")


def read_matrix(path: Path, *, name: str = "") -> LabelledMatrix:
    """Read a square matrix.

    Parameters
    ----------
    path : path
        Matrix Market (``.mtx``), NumPy (``.npz``) or Nastran (OUTPUT4: ``.op4``; DMIG: ``.pch``, ``.bdf``, ``.dat``,
        ``.nas``) file.
    name : str
        Name of the array or matrix in the file; by default the only one.

    Raises
    ------
    HousingError
        Where the file cannot be read, is damaged, or has another matrix.
    """
    ending = path.suffix.lower()
    try:
        largest = LARGEST_FILE if ending in (".mtx", ".npz", ".op4") else LARGEST_DMIG
        if path.stat().st_size > largest:
            raise HousingError(f"{path.name}: expected a file of at most {largest // 10**6} MB")
        if ending == ".mtx":
            return LabelledMatrix(_matrix_market(path))
        if ending == ".npz":
            values, coordinates = _numpy_array(path, name), _numpy_coordinates(path)
            if coordinates is not None and len(coordinates) != len(values):
                raise HousingError(f"{path.name}: nodes of {len(coordinates)} rows; expected {len(values)} of a matrix")
            return LabelledMatrix(values, coordinates)
        if ending == ".op4":
            return LabelledMatrix(read_op4(path, name))
        if ending in ENDINGS:
            return read_dmig(path.read_text("latin-1"), path.name, name)
    except OSError as error:
        raise HousingError(f"{path.name}: expected a readable file ({error.strerror or error})") from error
    raise HousingError(f"{path.name}: expected a file that ends in one of {', '.join(ENDINGS)}")


def _check_shape(file: str, shape: tuple[int, ...]) -> None:
    """Refuse a shape that is not square or too large."""
    if len(shape) != 2 or shape[0] != shape[1] or not 0 < shape[0] <= MOST_COORDINATES:
        text = " x ".join(map(str, shape)) or "a single number"
        raise HousingError(f"{file} holds {text}; expected a square matrix of order 1 to {MOST_COORDINATES}")


def _matrix_market(path: Path) -> FloatArray:
    """Read a real matrix of Matrix Market, dense or sparse, general or symmetric."""
    content = path.read_bytes()
    try:
        rows, columns, entries, _, kind, _ = scipy_io.mminfo(io.BytesIO(content))
        _check_shape(path.name, (rows, columns))
        if kind not in ("real", "double", "integer"):
            raise HousingError(f"{path.name} holds {kind} numbers; expected real ones")
        if entries > rows * columns:
            raise HousingError(f"{path.name} announces {entries} entries; expected at most {rows * columns}")
        read = scipy_io.mmread(io.BytesIO(content))
    except HousingError:
        raise
    except (ValueError, OverflowError, TypeError) as error:
        raise HousingError(f"{path.name}: expected a Matrix Market file, complete to its end ({error})") from error
    return np.asarray(read.toarray() if sparse.issparse(read) else read, dtype=np.float64)


def _numpy_coordinates(path: Path) -> tuple[Coordinate, ...] | None:
    """Coordinates by the arrays ``nodes`` and ``axes`` beside the matrices; None without these."""
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        if not {"nodes.npy", "axes.npy"} <= set(names):
            return None
        found = []
        for name in ("nodes.npy", "axes.npy"):
            if archive.getinfo(name).file_size > 16 * MOST_COORDINATES:
                raise HousingError(f"{path.name}: {name} is larger than {MOST_COORDINATES} numbers")
            with archive.open(name) as file:
                found.append(np.lib.format.read_array(file, allow_pickle=False))
    nodes, axes = found
    if nodes.shape != axes.shape or nodes.ndim != 1 or nodes.dtype.kind not in "iu" or axes.dtype.kind not in "iu":
        raise HousingError(f"{path.name}: expected whole numbers in nodes and axes, one of each coordinate")
    return tuple(zip(nodes.tolist(), axes.tolist(), strict=True))


def _numpy_array(path: Path, name: str) -> FloatArray:
    """Read an array of real numbers from an archive of arrays, no objects."""
    try:
        with zipfile.ZipFile(path) as archive:
            arrays = {entry.filename.removesuffix(".npy"): entry for entry in archive.infolist()}
            for label in ("nodes", "axes"):
                if len(arrays) > 1:
                    arrays.pop(label, None)
            if not name and len(arrays) == 1:
                name = next(iter(arrays))
            if name not in arrays:
                listed = ", ".join(map(repr, sorted(arrays)[:20]))
                raise HousingError(f"{path.name}: expected the name of an array in it, one of {listed}; got {name!r}")
            with archive.open(arrays[name]) as file:
                version = np.lib.format.read_magic(file)
                header = (
                    np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
                )
                shape, _, dtype = header(file)
            _check_shape(f"{path.name}: array {name!r}", shape)
            if dtype.kind not in "fiu":
                raise HousingError(f"{path.name}: array {name!r} is of {dtype}; expected real numbers")
            with archive.open(arrays[name]) as file:
                return np.asarray(np.lib.format.read_array(file, allow_pickle=False), dtype=np.float64)
    except HousingError:
        raise
    except (ValueError, zipfile.BadZipFile, EOFError, KeyError, NotImplementedError, RuntimeError) as error:
        raise HousingError(f"{path.name}: expected arrays as numpy.savez writes them ({error})") from error
