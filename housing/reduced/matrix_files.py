"""Readers of reduced matrices by the ending of their file, each format in its own module.

Sizes are checked before anything is allocated, and nothing in a file is executed.
"""

import io
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy import io as scipy_io
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.reduced.abaqus import read_abaqus
from gearwhine.housing.reduced.dmig import read_dmig
from gearwhine.housing.reduced.harwell_boeing import read_harwell_boeing
from gearwhine.housing.reduced.matrices import MOST_COORDINATES, Coordinate, LabelledMatrix, chosen_matrix
from gearwhine.housing.reduced.op4 import read_op4

FloatArray = npt.NDArray[np.float64]

LARGEST_FILE = 300_000_000
"""Bytes beyond which a file is not read: a full matrix of the largest order, 24 characters a number, takes 216 MB."""

LARGEST_TEXT = 100_000_000
"""Bytes beyond which a file of terms as text is not read, which take several times as much while they are read."""

NASTRAN, CALCULIX, HARWELL_BOEING = (
    (".pch", ".bdf", ".dat", ".nas"),
    (".sti", ".mas"),
    (".matrix", ".hb", ".rsa", ".rua"),
)
ENDINGS = (".mtx", ".npz", ".nc", ".op4", *NASTRAN, *CALCULIX, *HARWELL_BOEING)

_BANNER = b"%%MatrixMarket"  # first word of a file of Matrix Market


def read_matrix(path: Path, *, name: str = "", kind: str = "") -> LabelledMatrix:
    """Read a square matrix.

    Parameters
    ----------
    path : path
        Matrix Market (``.mtx``), NumPy (``.npz``), NetCDF4 (``.nc``), Nastran (OUTPUT4: ``.op4``; DMIG: ``.pch``,
        ``.bdf``, ``.dat``, ``.nas``), Abaqus and CalculiX (``.mtx``, ``.sti``, ``.mas``) or Harwell-Boeing file of
        Ansys (``.matrix``, ``.hb``, ``.rsa``, ``.rua``).
    name : str
        Name of the array or matrix in the file; by default the only one, or the one that is usually named so.
    kind : {"", "mass", "stiffness", "damping"}
        Matrix that is meant where no name is given.

    Raises
    ------
    HousingError
        Where the file cannot be read, is damaged, or has another matrix.
    """
    ending = path.suffix.lower()
    try:
        is_bulk = ending in (".npz", ".nc", ".op4") or (ending == ".mtx" and _begins(path))
        largest = LARGEST_FILE if is_bulk else LARGEST_TEXT
        if path.stat().st_size > largest:
            raise HousingError(f"{path.name}: expected a file of at most {largest // 10**6} MB")
        if ending == ".mtx" and is_bulk:
            return LabelledMatrix(_matrix_market(path))
        if ending == ".npz":
            values, coordinates = _numpy_array(path, name, kind), _numpy_coordinates(path)
            return _labelled(path, values, coordinates)
        if ending == ".nc":
            return _labelled(path, *_netcdf_arrays(path, name, kind))
        if ending == ".op4":
            return LabelledMatrix(read_op4(path, name, kind))
        if ending in NASTRAN:
            return read_dmig(path.read_text("latin-1"), path.name, name, kind)
        if ending in (".mtx", *CALCULIX):
            return read_abaqus(path.read_text("latin-1"), path.name, name, kind)
        if ending in HARWELL_BOEING:
            return LabelledMatrix(read_harwell_boeing(path.read_text("latin-1"), path.name))
    except OSError as error:
        raise HousingError(f"{path.name}: expected a readable file ({error.strerror or error})") from error
    raise HousingError(f"{path.name}: expected a file that ends in one of {', '.join(ENDINGS)}")


def _begins(path: Path) -> bool:
    """Whether a file begins as one of Matrix Market."""
    with path.open("rb") as file:
        return file.read(len(_BANNER)).lower() == _BANNER.lower()


def _labelled(path: Path, values: FloatArray, coordinates: tuple[Coordinate, ...] | None) -> LabelledMatrix:
    if coordinates is not None and len(coordinates) != len(values):
        raise HousingError(f"{path.name}: nodes of {len(coordinates)} rows; expected {len(values)} of a matrix")
    return LabelledMatrix(values, coordinates)


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
    with _whole_archive(path), zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        if not {"nodes.npy", "axes.npy"} <= set(names):
            return None
        found = []
        for name in ("nodes.npy", "axes.npy"):
            if archive.getinfo(name).file_size > 16 * MOST_COORDINATES:
                raise HousingError(f"{path.name}: {name} is larger than {MOST_COORDINATES} numbers")
            with archive.open(name) as file:
                found.append(np.lib.format.read_array(file, allow_pickle=False))
    return _coordinates(path, *found)


def _coordinates(path: Path, nodes: npt.NDArray[np.int64], axes: npt.NDArray[np.int64]) -> tuple[Coordinate, ...]:
    """Coordinates by arrays of node numbers and components."""
    if nodes.shape != axes.shape or nodes.ndim != 1 or nodes.dtype.kind not in "iu" or axes.dtype.kind not in "iu":
        raise HousingError(f"{path.name}: expected whole numbers in nodes and axes, one of each coordinate")
    return tuple(zip(nodes.tolist(), axes.tolist(), strict=True))


def _numpy_array(path: Path, name: str, kind: str) -> FloatArray:
    """Read an array of real numbers from an archive of arrays, no objects."""
    with _whole_archive(path), zipfile.ZipFile(path) as archive:
        arrays = {entry.filename.removesuffix(".npy"): entry for entry in archive.infolist()}
        for label in ("nodes", "axes"):
            if len(arrays) > 1:
                arrays.pop(label, None)
        name = chosen_matrix(sorted(arrays), name, kind, path.name)
        with archive.open(arrays[name]) as file:
            version = np.lib.format.read_magic(file)
            header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
            shape, _, dtype = header(file)
        _check_shape(f"{path.name}: array {name!r}", shape)
        if dtype.kind not in "fiu":
            raise HousingError(f"{path.name}: array {name!r} is of {dtype}; expected real numbers")
        with archive.open(arrays[name]) as file:
            return np.asarray(np.lib.format.read_array(file, allow_pickle=False), dtype=np.float64)


@contextmanager
def _whole_archive(path: Path) -> Iterator[None]:
    """Refuse an archive of arrays that is damaged."""
    try:
        yield
    except HousingError:
        raise
    except (ValueError, zipfile.BadZipFile, zlib.error, EOFError, KeyError, NotImplementedError, RuntimeError) as error:
        raise HousingError(f"{path.name}: expected arrays as numpy.savez writes them ({error})") from error


def _netcdf_arrays(path: Path, name: str, kind: str) -> tuple[FloatArray, tuple[Coordinate, ...] | None]:
    """Read a variable of two dimensions, and coordinates by ``nodes`` and ``axes``, where it has these."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            arrays = {key: one for key, one in file.items() if isinstance(one, h5py.Dataset) and one.ndim == 2}
            chosen = chosen_matrix(sorted(arrays), name, kind, path.name)
            dataset = arrays[chosen]
            _check_shape(f"{path.name}: variable {chosen!r}", dataset.shape)
            if dataset.dtype.kind not in "fiu":
                raise HousingError(f"{path.name}: variable {chosen!r} is of {dataset.dtype}; expected real numbers")
            values = np.asarray(dataset[()], dtype=np.float64)
            labels = [file.get(key) for key in ("nodes", "axes")]
            if any(one is None for one in labels):
                return values, None
            if any(not isinstance(one, h5py.Dataset) or one.size > MOST_COORDINATES for one in labels):
                raise HousingError(f"{path.name}: expected nodes and axes of at most {MOST_COORDINATES} rows")
            return values, _coordinates(path, *(np.asarray(one[()]) for one in labels))
    except HousingError:
        raise
    except (ValueError, KeyError, RuntimeError, TypeError, OSError) as error:
        if not path.exists():
            raise
        raise HousingError(f"{path.name}: expected variables of a NetCDF4 file ({error})") from error
