"""NetCDF files of results as xarray datasets whose arrays are read as they are asked for."""

from __future__ import annotations

from os import PathLike, fspath
from typing import Any

import h5py
import xarray as xr
from xarray.backends import BackendArray, BackendEntrypoint
from xarray.core import indexing

from gearwhine.housing.storage.netcdf import StoredVariable, attributes_of, stored_variables


class StoredResults(BackendEntrypoint):
    """Reader for ``xarray.open_dataset`` of files that this package wrote.

    The dataset is that of xarray's own readers. They look an object up in the file whenever they need it, several
    thousand times in a file of a hundred arrays; this one does so once for each.
    """

    def open_dataset(self, filename_or_obj: Any, *, drop_variables: Any = None) -> xr.Dataset:
        """Open a file, whose arrays stay in it until they are asked for."""
        path: str | PathLike[str] = filename_or_obj
        file = h5py.File(fspath(path), "r")
        try:
            variables = {
                name: _variable(one)
                for name, one in stored_variables(file).items()
                if name not in (drop_variables or ())
            }
            data = xr.decode_cf(xr.Dataset(variables, attrs=attributes_of(file)))
        except BaseException:
            file.close()
            raise
        data.set_close(file.close)
        return data


def _variable(stored: StoredVariable) -> xr.Variable:
    values = indexing.LazilyIndexedArray(_StoredArray(stored))
    # As its own readers say that an array of objects is of text.
    encoding = {"dtype": str} if values.dtype.kind == "O" else {}
    return xr.Variable(stored.dimensions, values, stored.attributes, encoding)


class _StoredArray(BackendArray):
    def __init__(self, variable: StoredVariable) -> None:
        self._values = variable.values
        self.shape = variable.dataset.shape
        self.dtype = self._values.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(
            key, self.shape, indexing.IndexingSupport.OUTER_1VECTOR, lambda at: self._values[at]
        )
