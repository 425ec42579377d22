"""Housings of cases as reduced matrices in each format, taken back into a case: the machine's lines stay the same."""

from pathlib import Path

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.case_study import CaseStudy
from gearwhine.coupling.linear.frequency_response import mesh_error_response, sensor_force_response

SETTINGS = {"housing.box.mesh_size": "40 mm"}


@pytest.fixture(scope="module")
def study() -> CaseStudy:
    return gw.load("small-gearbox", SETTINGS)


def with_tables(tables: Path, original: str) -> str:
    """The case with its housing's tables replaced by those that the export wrote."""
    kept, skipping = [], False
    for line in original.splitlines():
        if line.startswith("["):
            skipping = line.strip("[]").split(".")[0] in ("housing", "measured", "acoustics", "update", "provenance")
        if not skipping:
            kept.append(line)
    return "\n".join([*kept, "", tables.read_text(encoding="utf-8")])


@pytest.mark.parametrize(("name", "has_sensors"), [("box.npz", True), ("box.pch", True), ("box.op4", False)])
def test_the_lines_stay_the_same(study: CaseStudy, tmp_path: Path, name: str, has_sensors: bool) -> None:
    document = study.export_reduced(tmp_path / name)
    assert set(document["files"]) == {name, "box.toml"}
    sensors = [sensor.name for sensor in study.case.housing.sensor] if study.case.housing else []
    assert sensors
    assert document["reduced"]["left_out"] == ([] if has_sensors else sensors)
    original = (Path(gw.__file__).parent / "cases" / "small-gearbox.toml").read_text(encoding="utf-8")
    (tmp_path / "case.toml").write_text(with_tables(tmp_path / "box.toml", original), encoding="utf-8")
    back = gw.load(tmp_path / "case.toml")
    ours, theirs = (one.under_load().loaded.coupled for one in (back, study))
    assert ours.housing is not None
    assert theirs.housing is not None
    precision = 2e-6 if name == "box.pch" else 1e-7  # DMIG has ten digits
    known = ours.housing.kinds.count("housing")
    np.testing.assert_allclose(ours.housing.frequencies_hz, theirs.housing.frequencies_hz[:known], rtol=precision)
    w = 2.0 * np.pi * np.linspace(150.0, 2900.0, 23)
    one, other = (mesh_error_response(machine, w) for machine in (ours, theirs))
    for bearing, load in other.bearing_load.items():
        np.testing.assert_allclose(one.bearing_load[bearing], load, rtol=0.0, atol=precision * np.abs(load).max())
    for sensor in sensors if has_sensors else ():
        one, other = (sensor_force_response(machine, w, sensor=sensor) for machine in (ours, theirs))
        line = other.sensor_acceleration[sensor]
        atol = precision * np.abs(line).max()
        np.testing.assert_allclose(one.sensor_acceleration[sensor], line, rtol=0.0, atol=atol)


def test_coordinates_are_those_of_craig_and_bampton(study: CaseStudy, tmp_path: Path) -> None:
    """Nodes and modes with the nodes held have no stiffness between them, and these modes are orthogonal."""
    study.export_reduced(tmp_path / "box.npz")
    with np.load(tmp_path / "box.npz") as arrays:
        stiffness, mass, internal = arrays["stiffness"], arrays["mass"], arrays["axes"] == 0
    size = np.sqrt(np.diag(stiffness))
    scaled = stiffness / size / size[:, None]
    assert np.abs(scaled[internal][:, ~internal]).max() < 1e-6
    among = np.ix_(internal, internal)
    np.testing.assert_allclose(scaled[among], np.eye(internal.sum()), atol=1e-8)
    np.testing.assert_allclose(mass[among], np.eye(internal.sum()), atol=1e-8)


def test_matrix_market_has_a_file_for_each_matrix(study: CaseStudy, tmp_path: Path) -> None:
    files = study.export_reduced(tmp_path / "box.mtx")["files"]
    assert files == ["box-damping.mtx", "box-mass.mtx", "box-stiffness.mtx", "box.toml"]
    with pytest.raises(CaseError, match="no file of that name stands yet"):
        study.export_reduced(tmp_path / "box.mtx")


def test_other_endings_and_cases_without_a_housing_are_refused(study: CaseStudy, tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"ends in one of \.npz, \.mtx, \.op4, \.pch"):
        study.export_reduced(tmp_path / "box.csv")
    with pytest.raises(CaseError, match="housing"):
        gw.load("spur-pair").export_reduced(tmp_path / "box.npz")
    assert not list(tmp_path.iterdir())
