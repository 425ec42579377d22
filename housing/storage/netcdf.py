"""NetCDF4 files of labelled arrays: values with dimensions, unit and name; and their SHA-256 digest.

Files are written and read without xarray, whose import takes long; xarray opens them. They are HDF5 as the format of
NetCDF4 (Unidata, *NetCDF File Format Specifications*) has it: a dimension is a dimension scale, of its coordinates or
of none, and carries its number; an array carries the numbers of its dimensions.
"""

import errno
import hashlib
import io
import json
import os
import shutil
import sys
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class LabelledArray:
    """An array with its dimensions, unit and name.

    Attributes
    ----------
    dimensions : tuple of str
        A name for each axis.
    values : ndarray
        Numbers, or text.
    units : str
        ``"1"`` where it has none.
    long_name : str
        Name of the quantity in words.
    attributes : mapping of str to str
        Further attributes.
    """

    dimensions: tuple[str, ...]
    values: npt.NDArray[Any]
    units: str
    long_name: str
    attributes: Mapping[str, str] = field(default_factory=dict)

    @property
    def is_text(self) -> bool:
        """Whether the entries are text."""
        return self.values.dtype.kind in "UO"

    @property
    def labelled(self) -> "tuple[tuple[str, ...], npt.NDArray[Any], dict[str, str]]":
        """Dimensions, values, and unit and name where it has them, as :func:`write_netcdf` takes them."""
        attributes = {"units": self.units, "long_name": self.long_name}
        return self.dimensions, self.values, {key: text for key, text in attributes.items() if text}


def canonical_json(document: Mapping[str, Any]) -> str:
    """Canonical JSON of a document, the same for equal documents: keys in order, no blanks, no NaN."""
    return json.dumps(document, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


def content_key(document: Mapping[str, Any]) -> str:
    """SHA-256 of a document's canonical JSON, as hexadecimal digits."""
    return hashlib.sha256(_bytes(document)).hexdigest()


def digest(arrays: Mapping[str, LabelledArray], attributes: Mapping[str, Any] | None = None) -> str:
    """SHA-256 over names, labels and every byte of the values, whatever the order in the mapping.

    Numbers count by their bytes, so two arrays share a digest only where they are the same bit for bit.
    """
    total = hashlib.sha256(_bytes({"attributes": dict(attributes or {})}))
    for name in sorted(arrays):
        array = arrays[name]
        values = np.ascontiguousarray(array.values)
        labels = {
            "name": name,
            "dimensions": list(array.dimensions),
            "shape": list(array.values.shape),
            "type": "text" if array.is_text else values.dtype.newbyteorder("<").str,
            "units": array.units,
            "long_name": array.long_name,
            "attributes": dict(array.attributes),
        }
        if array.is_text:
            labels["text"] = [str(entry) for entry in values.ravel()]
        total.update(_bytes(labels))
        if not array.is_text:
            total.update(values.astype(values.dtype.newbyteorder("<"), copy=False).reshape(-1).view(np.uint8).data)
    return total.hexdigest()


def _bytes(document: Mapping[str, Any]) -> bytes:
    # Text of a damaged file may hold halves of characters: those count too.
    return canonical_json(document).encode("utf-8", "surrogatepass")


Variables = dict[str, tuple[Any, Any, dict[str, Any]]]
"""For each name, its dimensions (one as plain text), its values, and its attributes."""


def write_netcdf(
    path: Path,
    variables: Variables,
    attributes: Mapping[str, Any],
    *,
    coordinates: Variables | None = None,
    fill: bool = True,
) -> None:
    """Write a file that xarray opens as the dataset of these variables, coordinates and attributes.

    HDF5 writes to memory, and the bytes go to the file in one piece: where a disk is full, HDF5 itself ends the whole
    process as it closes a file.

    Parameters
    ----------
    path : path
        Path of a new file.
    variables, coordinates : mapping of str to (dimensions, values, attributes)
        Numbers, truth values or text. An array named after a dimension is a coordinate in either.
    attributes : mapping
        Attributes of the whole file.
    fill : bool
        Whether to declare NaN as the missing number, as xarray does.

    Raises
    ------
    ValueError
        Where an array does not have the axes that its dimensions say, or two disagree about the length of one.
    OSError
        Where the file cannot be written.
    """
    import h5py

    entries = {**(coordinates or {}), **variables}
    arrays = {name: _array(values) for name, (_, values, _) in entries.items()}
    dimensions = {name: _names(of) for name, (of, _, _) in entries.items()}
    sizes = _sizes(arrays, dimensions)
    numbers = {name: np.int32(number) for number, name in enumerate(sizes)}
    along_itself = {name for name in sizes if dimensions.get(name) == (name,)}
    beside = {name: set(dimensions[name]) for name in coordinates or {} if name not in sizes}
    image = io.BytesIO()
    with h5py.File(image, "w", track_order=True) as file:
        _tell(file.attrs, attributes)
        scales: dict[str, Any] = {}
        for name, size in sizes.items():
            if name not in along_itself:
                scales[name] = file.create_dataset(name, (size,), ">f4", track_order=True, **_open((size,)))
                scales[name].make_scale(_NO_VARIABLE + f"{size:10}".encode())
        datasets = {}
        for name, array in arrays.items():
            variable_attributes = dict(entries[name][2])
            if array.dtype.kind == "b":
                array, variable_attributes["dtype"] = array.astype(np.int8), "bool"
            if name in variables and name not in sizes:
                near = sorted(other for other, among in beside.items() if among <= set(dimensions[name]))
                variable_attributes |= {"coordinates": " ".join(near)} if near else {}
            stored = _BESIDE + name if name in scales else name
            if fill and array.dtype.kind == "f":
                variable_attributes["_FillValue"] = missing = array.dtype.type(np.nan)
                dataset = file.create_dataset(
                    stored, data=array, fillvalue=missing, track_order=True, **_open(array.shape)
                )
            else:
                dataset = file.create_dataset(stored, data=array, track_order=True, **_open(array.shape))
            if name in along_itself:
                dataset.make_scale(name)
                scales[name] = dataset
            datasets[name] = dataset
            _tell(dataset.attrs, variable_attributes)
        for name, scale in scales.items():
            scale.attrs["_Netcdf4Dimid"] = numbers[name]
        for name, dataset in datasets.items():
            # A coordinate's name gives its one dimension; to look a number up, readers look at every scale.
            if not dimensions[name] or name in along_itself:
                continue
            dataset.attrs["_Netcdf4Coordinates"] = np.array(
                [numbers[dimension] for dimension in dimensions[name]], dtype=np.int32
            )
            dataset.attrs["_Netcdf4Dimid"] = numbers[dimensions[name][0]]
            for axis, dimension in enumerate(dimensions[name]):
                dataset.dims[axis].attach_scale(scales[dimension])
        file.attrs["_NCProperties"] = np.bytes_(f"version=2,hdf5={h5py.version.hdf5_version},h5py={h5py.__version__}")
    with path.open("xb") as target:
        target.write(image.getbuffer())


def reserve_space(path: Path, size: int) -> None:
    """Reserve disk space behind the end of a file that HDF5 will then append to, which cuts off what it does not need.

    Parameters
    ----------
    path : path
    size : int
        Length of what will be appended [bytes].

    Raises
    ------
    OSError
        Where the disk has no room for it.
    """
    with path.open("r+b") as file:
        end = file.seek(0, os.SEEK_END)
        if sys.platform == "linux":
            os.posix_fallocate(file.fileno(), end, size + _STRUCTURE)
        elif shutil.disk_usage(path.parent).free < size + _STRUCTURE:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))


_STRUCTURE = 1 << 20  # what HDF5 adds for its own tables [bytes], at most


_NO_VARIABLE = b"This is a netCDF dimension but not a netCDF variable."


def _open(shape: tuple[int, ...]) -> dict[str, Any]:
    """Arguments of an array; its lengths of 0 may grow, as NetCDF has no other lengths of 0."""
    return {"maxshape": tuple(size or None for size in shape)} if 0 in shape else {}


def _tell(target: Any, attributes: Mapping[str, Any]) -> None:
    for name, value in attributes.items():
        target[name] = value if isinstance(value, str) else np.atleast_1d(value)


def read_netcdf(path: Path, names: Collection[str] | None = None) -> tuple[dict[str, LabelledArray], dict[str, Any]]:
    """Read variables of a file without any conversion by their attributes, and the attributes of the file.

    Parameters
    ----------
    path : Path
    names : collection of str, optional
        Variables to read, where they are there; every one by default.

    Raises
    ------
    OSError, RuntimeError, ValueError, KeyError
        Where it is no such file, or a damaged one.
    """
    import h5py

    with h5py.File(path, "r") as file:
        stored = stored_variables(file)
        read = {name: one for name, one in stored.items() if names is None or name in names}
        return {name: _labelled(one) for name, one in read.items()}, attributes_of(file)


@dataclass(frozen=True)
class StoredVariable:
    """A variable of an open file: its dimensions, its attributes, and where its values stand.

    Attributes
    ----------
    dimensions : tuple of str
    attributes : mapping
        Without those by which the format itself binds dimensions to arrays.
    dataset : h5py.Dataset
    """

    dimensions: tuple[str, ...]
    attributes: dict[str, Any]
    dataset: Any

    @property
    def values(self) -> Any:
        """What reads the values piece by piece, text decoded."""
        import h5py

        return self.dataset.asstr() if h5py.check_string_dtype(self.dataset.dtype) else self.dataset


_BESIDE = "_nc4_non_coord_"  # before the name of a variable that is named for a dimension and not along it
_OF_THE_FORMAT = frozenset(
    ["CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST", "_NCProperties", "_Netcdf4Coordinates", "_Netcdf4Dimid"]
)


def stored_variables(file: Any) -> dict[str, StoredVariable]:
    """Return the variables of an open file by name, each object looked up once.

    General readers ask the file for an object whenever they need it, which for a file of a hundred arrays takes most
    of the time.

    Parameters
    ----------
    file : h5py.File

    Raises
    ------
    OSError, RuntimeError, ValueError, KeyError
        Where the file is damaged, or has an axis without a dimension.
    """
    found: dict[str, StoredVariable] = {}
    for stored in file:
        dataset = file[stored]
        if not hasattr(dataset, "shape"):  # a group is no variable
            continue
        attributes = dataset.attrs
        if bytes(attributes.get("NAME", b"")).startswith(_NO_VARIABLE):
            continue
        dimensions = _dimensions(file, stored, dataset)
        found[stored.removeprefix(_BESIDE)] = StoredVariable(dimensions, attributes_of(dataset), dataset)
    return found


def _dimensions(file: Any, name: str, dataset: Any) -> tuple[str, ...]:
    import h5py

    if not dataset.shape:
        return ()
    if dataset.attrs.get("CLASS") == b"DIMENSION_SCALE" and len(dataset.shape) == 1:
        return (name,)
    scales = dataset.attrs["DIMENSION_LIST"]
    if len(scales) != len(dataset.shape) or not all(len(one) for one in scales):
        raise ValueError(f"variable {name!r} has an axis without a dimension")
    return tuple(h5py.h5r.get_name(one[-1], file.id).decode().rpartition("/")[2] for one in scales)


def attributes_of(stored: Any) -> dict[str, Any]:
    """Return the attributes of an open file or of an array in it, a list of one number as that number.

    Parameters
    ----------
    stored : h5py.File or h5py.Dataset
    """
    read = {str(name): stored.attrs[name] for name in stored.attrs if name not in _OF_THE_FORMAT}
    return {name: one[0] if isinstance(one, np.ndarray) and one.size == 1 else one for name, one in read.items()}


def _labelled(variable: StoredVariable) -> LabelledArray:
    labels = {name: str(text) for name, text in variable.attributes.items()}
    values = np.asarray(variable.values[...])
    return LabelledArray(variable.dimensions, values, labels.pop("units", ""), labels.pop("long_name", ""), labels)


def _array(values: Any) -> npt.NDArray[Any]:
    import h5py

    array = np.asarray(values)
    return array.astype(h5py.string_dtype()) if array.dtype.kind in "UO" else array


def _names(dimensions: Any) -> tuple[str, ...]:
    return (dimensions,) if isinstance(dimensions, str) else tuple(dimensions)


def _sizes(arrays: Mapping[str, npt.NDArray[Any]], dimensions: Mapping[str, tuple[str, ...]]) -> dict[str, int]:
    sizes: dict[str, int] = {}
    for name, array in arrays.items():
        if array.ndim != len(dimensions[name]):
            raise ValueError(f"{name!r} has {array.ndim} axes, and the dimensions {dimensions[name]}")
        for dimension, size in zip(dimensions[name], array.shape, strict=True):
            if sizes.setdefault(dimension, size) != size:
                raise ValueError(f"{name!r} has {size} along {dimension!r}, where another has {sizes[dimension]}")
    return sizes
