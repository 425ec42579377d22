"""NetCDF4 files of labelled arrays: values with dimensions, unit and name; and their SHA-256 digest.

Files are written and read without xarray, whose import takes long; xarray opens them.
"""

import hashlib
import json
from collections.abc import Mapping
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
        told = {"units": self.units, "long_name": self.long_name}
        return self.dimensions, self.values, {key: text for key, text in told.items() if text}


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
"""By name: its dimensions (one as plain text), its values, and its attributes."""


def write_netcdf(
    path: Path,
    variables: Variables,
    attributes: Mapping[str, Any],
    *,
    coordinates: Variables | None = None,
    fill: bool = True,
) -> None:
    """Write a file that xarray opens as the dataset of these variables, coordinates and attributes.

    Parameters
    ----------
    path
        Of a file that is not there yet.
    variables, coordinates
        Numbers, truth values or text. An array named after a dimension is a coordinate in either.
    attributes
        Of the whole file.
    fill
        Declare NaN as the missing number, as xarray does.

    Raises
    ------
    ValueError
        Where an array does not have the axes that its dimensions say, or two disagree about the length of one.
    OSError
        Where the file cannot be written.
    """
    import h5netcdf

    given = {**(coordinates or {}), **variables}
    arrays = {name: _array(values) for name, (_, values, _) in given.items()}
    dimensions = {name: _names(of) for name, (of, _, _) in given.items()}
    sizes = _sizes(arrays, dimensions)
    beside = {name: set(dimensions[name]) for name in coordinates or {} if name not in sizes}
    with h5netcdf.File(path, "w") as file:
        file.dimensions = sizes
        file.attrs.update(attributes)
        for name, array in arrays.items():
            told = dict(given[name][2])
            if array.dtype.kind == "b":
                array, told["dtype"] = array.astype(np.int8), "bool"
            if name in variables and name not in sizes:
                near = sorted(other for other, among in beside.items() if among <= set(dimensions[name]))
                told |= {"coordinates": " ".join(near)} if near else {}
            missing = array.dtype.type(np.nan) if fill and array.dtype.kind == "f" else None
            written = file.create_variable(name, dimensions[name], array.dtype, data=array, fillvalue=missing)
            written.attrs.update(told)


def read_netcdf(path: Path) -> tuple[dict[str, LabelledArray], dict[str, Any]]:
    """Read every variable of a file without any conversion by its attributes, and the attributes of the file.

    Raises
    ------
    OSError, ValueError, KeyError
        Where it is no such file, or a damaged one.
    """
    import h5netcdf

    with h5netcdf.File(path, "r", decode_vlen_strings=True) as file:
        return {str(name): _labelled(variable) for name, variable in file.variables.items()}, dict(file.attrs)


def _labelled(variable: Any) -> LabelledArray:
    labels = {str(name): str(text) for name, text in variable.attrs.items()}
    dimensions = tuple(map(str, variable.dimensions))
    values = np.asarray(variable[...])
    return LabelledArray(dimensions, values, labels.pop("units", ""), labels.pop("long_name", ""), labels)


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
