"""NetCDF4 files of labelled arrays, written and read without xarray, whose import takes long; xarray opens them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from housing.labelled import LabelledArray

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
