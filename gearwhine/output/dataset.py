"""Labelled arrays of a result: its declared quantities with their dimensions and units, in memory or as NetCDF."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import numpy.typing as npt

from gearwhine import __version__
from gearwhine.case import Case, dump_case
from gearwhine.housing.storage.netcdf import Variables, write_netcdf
from gearwhine.output.quantity import ABSENT, RPM, Field, Fields, Part, Quantity

if TYPE_CHECKING:
    import xarray as xr


PHASE_CONVENTION = "of spectra: of the cosine at t = 0 of the histories' time axis"
"""Attribute of every file of results."""


class Stream(Protocol):
    """Arrays that are too long for memory: they are written behind the others."""

    def labels(self) -> Variables:
        """Return the coordinates along their dimensions, which the file must hold first."""

    def append_to(self, path: Path) -> None:
        """Append the arrays piece by piece to a file that holds the others."""

    def add_to(self, variables: Variables) -> None:
        """Add the arrays in memory to the others."""


@dataclass(frozen=True)
class LabelledArrays:
    """A result as arrays with dimensions, units and long names.

    Attributes
    ----------
    variables : mapping of str to (dimensions, values, attributes)
        A variable that is named for its only dimension is the coordinate along it.
    scalars : mapping of the same kind
        Coordinates without a dimension.
    attributes : mapping of str to str
        Attributes of the whole.
    streams : tuple of Stream
    """

    variables: Variables
    scalars: Variables
    attributes: dict[str, str]
    streams: tuple[Stream, ...] = field(default=())

    def write(self, path: Path) -> None:
        """Write a NetCDF4 file that any tool opens."""
        write_netcdf(path, self.variables, self.attributes, coordinates=self.scalars)
        for stream in self.streams:
            stream.append_to(path)

    def dataset(self) -> xr.Dataset:
        """Return the arrays as an xarray dataset, copies of those of the solution."""
        import xarray as xr

        variables = {
            name: (dimensions, np.array(values), attributes)
            for name, (dimensions, values, attributes) in self.variables.items()
        }
        for stream in self.streams:
            stream.add_to(variables)
        return xr.Dataset(variables, self.scalars, self.attributes)


@dataclass(frozen=True)
class Labels:
    """Labels of a file of results.

    Attributes
    ----------
    title : str
    speed : float or None
        Speed of the first driver [rad/s]; None where there is none.
    case : str or None
        The case as TOML; None for objects of Python.
    """

    title: str
    speed: float | None = None
    case: str | None = None


def labels_of(case: Case) -> Labels:
    """Return the labels of results of a case."""
    return Labels(case.title, None if case.operation is None else case.operation.speed, dump_case(case))


def labelled(labels: Labels, *parts: tuple[Fields, Any], streams: Sequence[Stream] = ()) -> LabelledArrays:
    """Return solved objects, each with the declaration of its quantities, as labelled arrays; None is left out."""
    variables: Variables = {}
    for fields, solved in parts:
        variables |= {} if solved is None else arrays_of(fields, solved)
    for stream in streams:
        variables = stream.labels() | variables
    scalars: Variables = {}
    if labels.speed is not None:
        attributes = {"units": "rpm", "long_name": "speed of the first driver"}
        scalars["speed"] = ((), labels.speed * RPM, attributes)
    return LabelledArrays(variables, scalars, file_attributes(labels), tuple(streams))


def file_attributes(labels: Labels) -> dict[str, str]:
    """Attributes of every file of results."""
    return {
        "title": labels.title,
        "source": f"gearwhine {__version__}",
        **({} if labels.case is None else {"case": labels.case}),
        "amplitude_convention": "peak: the amplitude of a cosine a cos(2 pi f t + phase) is a",
        "phase_convention": PHASE_CONVENTION,
    }


def arrays_of(fields: Iterable[Field], solved: Any) -> Variables:
    """Return those declared quantities of a solved object that have a name in the file, with their labels."""
    variables: Variables = {}
    _add_fields(fields, [solved], (), variables)
    return variables


def _add_fields(fields: Iterable[Field], objects: Sequence[Any], along: tuple[str, ...], variables: Variables) -> None:
    """Add the quantities of objects along a dimension, None where one is missing; or of a single object."""
    for entry in fields:
        if isinstance(entry, Quantity):
            if entry.name:
                _add_quantity(entry, objects, along, variables)
            continue
        inner = [_value_of(entry, item) for item in objects]
        if isinstance(entry, Part):
            if any(item is not None for item in inner):
                _add_fields(entry.fields, inner, along, variables)
        elif entry.dimension:
            rows = [row for item in inner if item is not None for row in item]
            if rows:
                _add_fields(entry.fields, rows, (entry.dimension,), variables)


def _value_of(field: Field, of: Any) -> Any:
    value = None if of is None else field.value_of(of)
    return None if value is ABSENT else value


def _add_quantity(quantity: Quantity, objects: Sequence[Any], along: tuple[str, ...], variables: Variables) -> None:
    values = [_value_of(quantity, item) for item in objects]
    first = next((number for number, value in enumerate(values) if value is not None), None)
    if first is None:
        return
    if isinstance(values[first], dict):
        labels = quantity.dimensions[0]
        variables.setdefault(labels, ((labels,), list(values[first]), {}))
        values = [None if value is None else np.array(list(value.values())) for value in values]
    if quantity.name in variables and quantity.dimensions != (quantity.name,):
        raise ValueError(f"{quantity.name!r} is declared twice")
    unit, long_name = quantity.file_unit, quantity.meaning_in(objects[first])
    attributes: dict[str, Any] = {"units": unit} if unit else {}
    attributes |= {"long_name": long_name} if long_name else {}
    attributes |= {} if quantity.attributes is None else quantity.attributes(objects[first])
    if quantity.common or not along:
        variables[quantity.name] = (quantity.dimensions, values[first], attributes)
    else:
        variables[quantity.name] = (
            (*along, *quantity.dimensions),
            _stacked(values, len(quantity.dimensions)),
            attributes,
        )


def _stacked(values: Sequence[Any], axes: int) -> npt.NDArray[Any]:
    """Return the values of all rows in one array, NaN where one is missing or shorter than another."""
    arrays = [np.empty((0,) * axes) if value is None else np.asarray(value) for value in values]
    shapes = {array.shape for array in arrays}
    if all(value is not None for value in values) and len(shapes) == 1:
        return np.array(arrays)
    shape = tuple(max(lengths) for lengths in zip(*(array.shape for array in arrays), strict=True))
    whole = np.full((len(arrays), *shape), np.nan)
    for row, (array, value) in enumerate(zip(arrays, values, strict=True)):
        if value is not None:
            whole[row : row + 1][(slice(None), *map(slice, array.shape))] = array
    return whole
