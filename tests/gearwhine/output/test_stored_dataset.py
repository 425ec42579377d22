"""The reader of files of results: its datasets are those of xarray's own, whoever wrote the file."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from gearwhine.housing.storage.netcdf import write_netcdf
from gearwhine.output.stored_dataset import StoredResults

COORDINATES: dict[str, Any] = {
    "speed": ((), 3000.0, {"units": "rpm"}),
    "sensor": ("sensor", ["top", "End ° é"], {}),
    "order": ("line", np.arange(3), {"units": "1"}),
}
VARIABLES: dict[str, Any] = {
    "level": (("sensor", "line"), [[1.0, np.nan, 3.0], [4.0, 5.0, 6.0]], {"units": "m/s2", "number": 3}),
    "short": ("line", np.array([0.5, 0.25, np.nan], dtype=np.float32), {"range": np.array([0.25, 0.5])}),
    "square": (("line", "side"), np.arange(6).reshape(3, 2), {}),
    "done": ("sensor", [True, False], {}),
    "name": (("line", "side"), [["", "b"], ["c", "d"], ["e", "é"]], {}),
    "of_nothing": ("none", np.empty(0), {}),
    "side": ("line", [1.0, 2.0, 3.0], {}),  # named for a dimension, and not along it
}
ATTRIBUTES = {"title": "Two sensors", "number": 3}


def by_this_package(path: Path) -> None:
    write_netcdf(path, VARIABLES, ATTRIBUTES, coordinates=COORDINATES)


def by_xarray(path: Path) -> None:
    variables = {name: entry for name, entry in VARIABLES.items() if name != "side"}
    xr.Dataset(variables, COORDINATES, ATTRIBUTES).to_netcdf(path, engine="h5netcdf")


@pytest.mark.parametrize("write", [by_this_package, by_xarray])
def test_a_dataset_is_that_of_the_general_reader(write: Any, tmp_path: Path) -> None:
    path = tmp_path / "results.nc"
    write(path)
    dropped = ["side"]  # no dataset of xarray has such a variable
    with (
        xr.open_dataset(path, engine=StoredResults, drop_variables=dropped) as found,
        xr.open_dataset(path, engine="h5netcdf", drop_variables=dropped) as expected,
    ):
        np.testing.assert_array_equal(found["level"].isel(line=[2, 0], sensor=1), [6.0, 4.0])
        xr.testing.assert_identical(found.load(), expected.load())
        assert list(found.data_vars) == list(expected.data_vars)
        for name, variable in expected.variables.items():
            assert found[name].dtype == variable.dtype, name
            assert {key: type(one) for key, one in found[name].attrs.items()} == {
                key: type(one) for key, one in variable.attrs.items()
            }


def test_arrays_stay_in_the_file_until_they_are_asked_for(tmp_path: Path) -> None:
    by_this_package(tmp_path / "results.nc")
    with xr.open_dataset(tmp_path / "results.nc", engine=StoredResults, drop_variables=["side"]) as found:
        assert not found["level"].variable._in_memory
        assert found["level"].values[1, 2] == 6.0
        kept = found["short"]
    with pytest.raises((OSError, ValueError, RuntimeError)):
        kept.load()


def test_what_is_no_such_file_is_an_error_and_stays_closed(tmp_path: Path) -> None:
    (tmp_path / "results.nc").write_bytes(b"no file of arrays")
    with pytest.raises(OSError, match="signature not found"):
        xr.open_dataset(tmp_path / "results.nc", engine=StoredResults)
