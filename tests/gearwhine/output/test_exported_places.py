"""Points and directions of sensors in universal files: those of each result in a folder, not of the case at hand."""

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
import xarray as xr
from sounding_gearbox import small_gearbox

from gearwhine.cli import run_command
from gearwhine.output.export import _microphone_places
from gearwhine.output.manifest import MANIFEST
from gearwhine.results_folder import export_results

pytestmark = pytest.mark.usefixtures("mechanisms_left_out")


def sensors(x: str) -> dict[str, Any]:
    """One sensor half a millimetre above the top at y = 160 mm, one along the normal of the right wall."""
    top = {"name": "top", "position": [x, "160.5 mm", "30 mm"], "direction": [0, -1, 0]}
    return {"housing.sensor": [top, {"name": "wall", "position": ["110 mm", "90 mm", "-20 mm"]}]}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result with the sensor at x = 20 mm, then one with the sensor at x = 35 mm, in one folder."""
    place = tmp_path_factory.mktemp("two") / "out"
    coarse = small_gearbox().changed({"housing.box.mesh_size": "45 mm"})
    coarse.changed(sensors("20 mm")).system().write(place, pictures=False)
    coarse.changed(sensors("35 mm") | {"transient": ""}).run().write(place, pictures=False)
    return place


def exported(path: Path) -> tuple[list[tuple[float, float, float]], dict[str, set[tuple[int, int]]]]:
    """Return points of a universal file, and point and direction of the functions of each name."""
    file = pyuff.UFF(str(path))
    kinds = file.get_set_types()
    points: list[tuple[float, float, float]] = []
    for index in np.flatnonzero(kinds == 2411):
        found = file.read_sets(int(index))
        points += zip(*(found[axis].tolist() for axis in "xyz"), strict=True)
    places: dict[str, set[tuple[int, int]]] = {}
    for index in np.flatnonzero(kinds == 58):
        one = file.read_sets(int(index))
        places.setdefault(one["rsp_ent_name"].strip(), set()).add((int(one["rsp_node"]), int(one["rsp_dir"])))
    return points, places


@pytest.mark.slow
def test_each_file_has_the_points_of_its_own_result(folder: Path) -> None:
    document = export_results(folder, ("uff",))
    assert document["warnings"] == []
    for name, x in (("system", 0.02), ("run", 0.035)):
        points, places = exported(folder / "exports" / f"{name}.uff")
        np.testing.assert_allclose(points, [(x, 0.16, 0.03), (0.11, 0.09, -0.02)], atol=1e-12)
        assert places == {"top": {(1, -2)}, "wall": {(2, 1)}}


def without_places(folder: Path, place: Path) -> Path:
    """Copy a result without the arrays of its sensors' places."""
    shutil.copytree(folder, place, ignore=shutil.ignore_patterns("exports"))
    path = place / "results.nc"
    data = xr.load_dataset(path, engine="h5netcdf").drop_vars(["sensor_position", "sensor_direction"])
    path.unlink()
    data.to_netcdf(path, engine="h5netcdf")
    (place / MANIFEST).unlink()
    return place


@pytest.mark.slow
@pytest.mark.parametrize("name", ["results.nc", "summary.json"])
@pytest.mark.parametrize("damage", ["a flipped bit", "cut off"])
def test_damaged_results_are_neither_exported_nor_reported(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, damage: str
) -> None:
    place = tmp_path / "damaged"
    shutil.copytree(folder, place, ignore=shutil.ignore_patterns("exports"))
    content = bytearray((place / name).read_bytes())
    content[len(content) // 2] ^= 1
    (place / name).write_bytes(content if damage == "a flipped bit" else content[: len(content) // 2])
    for command in (["export", "--csv"], ["export", "--uff"], ["report"]):
        assert run_command([command[0], "small-gearbox", "-q", "-o", str(place), *command[1:]]) == 2
        assert str(place / name) in capsys.readouterr().err
    assert not (place / "report.html").exists()
    assert not (place / "exports").exists()


@pytest.mark.slow
def test_points_that_are_not_known_are_warned_of(folder: Path, tmp_path: Path) -> None:
    place = without_places(folder, tmp_path / "without")
    (warned,) = export_results(place, ("uff",))["warnings"]
    assert (warned["file"], warned["sensors"]) == ("run.uff", ["top", "wall"])
    _, places = exported(place / "exports" / "run.uff")
    assert places == {"top": {(0, 0)}, "wall": {(0, 0)}}


def test_a_case_is_not_changed_by_its_export(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["export", "small-gearbox", "-q", "--uff", "-o", str(folder), "--set", "housing.sensor.top.direction=x"]
    assert run_command(command) == 2
    assert "results are exported as they are" in capsys.readouterr().err


def test_microphones_are_points_after_those_of_the_sensors() -> None:
    """A point of a universal file has one number: two microphones after three sensors are the fourth and the fifth."""
    rows = np.array([[0.1, 1.2, 0.3], [-0.4, 0.5, 0.6]])
    data = xr.Dataset(
        {"microphone_position": (("microphone", "axis"), rows)}, {"microphone": ["ear", "window"], "axis": list("xyz")}
    )
    places, positions = _microphone_places(data, 3)
    assert places == {("microphone", "ear"): (4, 0), ("microphone", "window"): (5, 0)}
    np.testing.assert_array_equal(positions, rows)
    assert _microphone_places(xr.Dataset(), 3) == ({}, [])
