"""Readers of reduced matrices by the ending of their file, each format in its own module.

Sizes are checked before anything is allocated, and nothing in a file is executed.
"""

import io
import math
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

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
from gearwhine.numerics.arrays import FloatArray

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
        _check_shape(f"{path.name}: array {name!r}", _numpy_shape(path, archive, arrays[name]))
        return _numpy_values(archive, arrays[name])


def _numpy_shape(path: Path, archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> tuple[int, ...]:
    """Return the shape of an array of real numbers by its head."""
    with archive.open(entry) as file:
        version = np.lib.format.read_magic(file)
        header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = header(file)
    if dtype.kind not in "fiu":
        name = entry.filename.removesuffix(".npy")
        raise HousingError(f"{path.name}: array {name!r} is of {dtype}; expected real numbers")
    return tuple(map(int, shape))


def _numpy_values(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> FloatArray:
    with archive.open(entry) as file:
        return np.asarray(np.lib.format.read_array(file, allow_pickle=False), dtype=np.float64)


def read_arrays(
    path: Path, names: Sequence[str], most: int
) -> tuple[dict[str, FloatArray], tuple[Coordinate, ...] | None]:
    """Read arrays of real numbers by name from an archive of NumPy or a NetCDF4 file, and the coordinates beside them.

    Parameters
    ----------
    path : path
    names : sequence of str
    most : int
        Number of entries beyond which an array is refused.

    Raises
    ------
    HousingError
        Where the file cannot be read, lacks an array or has a larger one.
    """

    def refuse_large(name: str, shape: tuple[int, ...]) -> None:
        if math.prod(shape) > most:
            raise HousingError(f"{path.name}: array {name!r} has {math.prod(shape)} entries; expected at most {most}")

    try:
        if path.stat().st_size > LARGEST_FILE:
            raise HousingError(f"{path.name}: expected a file of at most {LARGEST_FILE // 10**6} MB")
        arrays = dict[str, FloatArray]()
        if path.suffix.lower() == ".nc":
            with _whole_netcdf(path) as variables:
                for name in names:
                    one = _netcdf_variable(path, variables, name)
                    refuse_large(name, one.shape)
                    arrays[name] = np.asarray(one[()], dtype=np.float64)
                return arrays, _netcdf_coordinates(path, variables)
        with _whole_archive(path), zipfile.ZipFile(path) as archive:
            entries = {entry.filename.removesuffix(".npy"): entry for entry in archive.infolist()}
            for name in names:
                if name not in entries:
                    raise HousingError(f"{path.name}: expected an array {name!r}")
                refuse_large(name, _numpy_shape(path, archive, entries[name]))
                arrays[name] = _numpy_values(archive, entries[name])
        return arrays, _numpy_coordinates(path)
    except OSError as error:
        raise HousingError(f"{path.name}: expected a readable file ({error.strerror or error})") from error


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

    with _whole_netcdf(path) as variables:
        arrays = [key for key, one in variables.items() if isinstance(one, h5py.Dataset) and one.ndim == 2]
        chosen = chosen_matrix(sorted(arrays), name, kind, path.name)
        dataset = _netcdf_variable(path, variables, chosen)
        _check_shape(f"{path.name}: variable {chosen!r}", dataset.shape)
        return np.asarray(dataset[()], dtype=np.float64), _netcdf_coordinates(path, variables)


def _netcdf_variable(path: Path, variables: Any, name: str) -> Any:
    """Return a variable of real numbers."""
    import h5py

    dataset = variables.get(name)
    if not isinstance(dataset, h5py.Dataset):
        raise HousingError(f"{path.name}: expected a variable {name!r}")
    if dataset.dtype.kind not in "fiu":
        raise HousingError(f"{path.name}: variable {name!r} is of {dataset.dtype}; expected real numbers")
    return dataset


def _netcdf_coordinates(path: Path, variables: Any) -> tuple[Coordinate, ...] | None:
    """Coordinates by the variables ``nodes`` and ``axes``; None without these."""
    import h5py

    labels = [variables.get(key) for key in ("nodes", "axes")]
    if any(one is None for one in labels):
        return None
    if any(not isinstance(one, h5py.Dataset) or one.size > MOST_COORDINATES for one in labels):
        raise HousingError(f"{path.name}: expected nodes and axes of at most {MOST_COORDINATES} rows")
    return _coordinates(path, *(np.asarray(one[()]) for one in labels))


@contextmanager
def _whole_netcdf(path: Path) -> Iterator[Any]:
    """Open a NetCDF4 file; refuse one that is damaged."""
    import h5py

    try:
        with h5py.File(path, "r") as variables:
            yield variables
    except HousingError:
        raise
    except (ValueError, KeyError, RuntimeError, TypeError, OSError) as error:
        if not path.exists():
            raise
        raise HousingError(f"{path.name}: expected variables of a NetCDF4 file ({error})") from error
