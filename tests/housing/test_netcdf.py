"""Files of labelled arrays: what xarray opens is the dataset that was meant, and what is read is what was written."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from gearwhine.housing.storage.netcdf import read_netcdf, write_netcdf

LEVEL = {"units": "m/s2", "long_name": "amplitude"}
COORDINATES = {
    "speed": ((), 3000.0, {"units": "rpm"}),
    "sensor": ("sensor", ["top", "End ° é"], {}),
    "order": ("line", np.arange(3), {}),  # not of a dimension's name
}
VARIABLES = {
    "level": (("sensor", "line"), [[1.0, np.nan, 3.0], [4.0, 5.0, 6.0]], LEVEL),
    "short": ("line", np.array([0.5, 0.25, np.nan], dtype=np.float32), {}),
    "count": (("sensor",), np.array([3, 4]), {}),
    "done": ("sensor", [True, False], {}),
    "name": ("line", ["", "b", "c"], {}),
    "line_frequency": ("line", [1.0, 2.0, 3.0], {}),
    "of_nothing": ("none", np.empty(0), {}),
}
ATTRIBUTES = {"title": "Two sensors", "number": 3}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "file.nc"
    write_netcdf(path, VARIABLES, ATTRIBUTES, coordinates=COORDINATES)
    return path


def test_xarray_opens_the_dataset_that_was_meant(file: Path) -> None:
    with xr.open_dataset(file, engine="h5netcdf") as opened:
        meant = xr.Dataset(VARIABLES, COORDINATES, ATTRIBUTES)
        xr.testing.assert_identical(opened.load(), meant)
        assert {name: opened[name].dtype.kind for name in ("done", "count", "short")} == {
            "done": "b",
            "count": "i",
            "short": "f",
        }


def test_what_is_read_is_what_was_written(file: Path) -> None:
    arrays, attributes = read_netcdf(file)
    assert attributes == ATTRIBUTES
    assert set(arrays) == set(VARIABLES) | set(COORDINATES)
    level = arrays["level"]
    assert (level.dimensions, level.units, level.long_name) == (("sensor", "line"), "m/s2", "amplitude")
    np.testing.assert_array_equal(level.values, VARIABLES["level"][1])
    assert arrays["sensor"].values.tolist() == ["top", "End ° é"]
    assert arrays["of_nothing"].values.shape == (0,)
    some, attributes = read_netcdf(file, ("level", "absent"))
    assert (list(some), attributes) == (["level"], ATTRIBUTES)
    np.testing.assert_array_equal(some["level"].values, level.values)


def test_without_fill_no_number_stands_for_a_missing_one(tmp_path: Path) -> None:
    write_netcdf(tmp_path / "file.nc", VARIABLES, {}, fill=False)
    arrays, _ = read_netcdf(tmp_path / "file.nc")
    assert "_FillValue" not in arrays["level"].attributes


@pytest.mark.parametrize(
    ("wrong", "said"),
    [({"b": ("line", np.zeros(4), {})}, "4 along 'line'"), ({"b": ("line", np.zeros((3, 2)), {})}, "2 axes")],
)
def test_arrays_that_do_not_fit_their_dimensions_are_refused(wrong: dict, said: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=said):
        write_netcdf(tmp_path / "file.nc", {"a": ("line", np.zeros(3), {}), **wrong}, {})
    assert not (tmp_path / "file.nc").exists()
