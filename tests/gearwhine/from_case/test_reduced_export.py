"""Housings of cases as reduced matrices in each format, taken back into a case: the machine's lines stay the same."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from solver_text import write_abaqus_terms, write_ansys_mapping, write_harwell_boeing, write_user_element

import gearwhine as gw
from gearwhine.case import CaseError, dump_case
from gearwhine.case_study import CaseStudy
from gearwhine.coupling.linear.frequency_response import mesh_error_response, sensor_force_response

Coordinates = list[tuple[int, int]]
Matrices = dict[str, npt.NDArray[np.float64]]
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


def as_abaqus_terms(folder: Path, coordinates: Coordinates, matrices: Matrices) -> list[str]:
    for kind, matrix in matrices.items():
        write_abaqus_terms(folder / f"{kind}.mtx", matrix, coordinates)
    return [f'{kind} = "{kind}.mtx"' for kind in matrices]


def as_user_element(folder: Path, coordinates: Coordinates, matrices: Matrices) -> list[str]:
    write_user_element(folder / "z1.mtx", matrices, coordinates)
    return [f'{kind} = "z1.mtx"' for kind in matrices]


def as_harwell_boeing(folder: Path, coordinates: Coordinates, matrices: Matrices) -> list[str]:
    for kind, matrix in matrices.items():
        write_harwell_boeing(folder / f"{kind}.matrix", matrix)
    # Modes are degrees of freedom that are none of the six, whatever node they have.
    write_ansys_mapping(folder / "box.mapping", coordinates)
    return [*(f'{kind} = "{kind}.matrix"' for kind in matrices), 'mapping = "box.mapping"']


OURS = ("box.npz", "box.nc", "box.pch", "box.op4", "box.mtx")
OTHERS: dict[str, Callable[[Path, Coordinates, Matrices], list[str]]] = {
    "terms": as_abaqus_terms,
    "user element": as_user_element,
    "Harwell-Boeing": as_harwell_boeing,
}


def taken_back(study: CaseStudy, folder: Path, name: str) -> CaseStudy:
    """The case with its housing written in a format and read again: one that we write, or one of other programs."""
    document = study.export_reduced(folder / (name if name in OURS else "box.npz"))
    assert document["reduced"]["left_out"] == []
    tables = folder / "box.toml"
    if name in OTHERS:
        with np.load(folder / "box.npz") as arrays:
            matrices = {kind: arrays[kind] for kind in ("mass", "stiffness", "damping")}
            coordinates = list(zip(arrays["nodes"].tolist(), arrays["axes"].tolist(), strict=True))
        lines = OTHERS[name](folder, coordinates, matrices)
        before, after = tables.read_text(encoding="utf-8").split("[housing.reduced]")
        rest = after.split("[[", 1)[1]
        tables.write_text("\n".join([before + "[housing.reduced]", *lines, "[[" + rest]), encoding="utf-8")
    (folder / "case.toml").write_text(with_tables(tables, dump_case(study.case)), encoding="utf-8")
    return gw.load(folder / "case.toml")


@pytest.mark.parametrize("name", [*OURS, *OTHERS])
def test_the_lines_stay_the_same(study: CaseStudy, tmp_path: Path, name: str) -> None:
    compare_lines(study, taken_back(study, tmp_path, name), precision=1e-7)


@pytest.mark.slow
def test_the_lines_of_the_rig_stay_the_same_in_each_format(tmp_path: Path) -> None:
    """A coarse mesh of the rig, whose sharp lines take every digit of a format."""
    rig = gw.load("nasa-gear-noise-rig", {"housing.box.mesh_size": "40 mm"})
    for number, name in enumerate([*OURS, *OTHERS]):
        (tmp_path / str(number)).mkdir()
        compare_lines(rig, taken_back(rig, tmp_path / str(number), name), precision=1e-6)


def compare_lines(study: CaseStudy, back: CaseStudy, precision: float) -> None:
    """Compare frequencies, bearing loads under a mesh error, and accelerations of sensors under forces at them."""
    assert study.case.housing is not None
    sensors = [sensor.name for sensor in study.case.housing.sensor]
    assert sensors
    ours, theirs = (one.under_load().loaded.coupled for one in (back, study))
    assert ours.housing is not None
    assert theirs.housing is not None
    known = ours.housing.kinds.count("housing")
    np.testing.assert_allclose(ours.housing.frequencies_hz, theirs.housing.frequencies_hz[:known], rtol=precision)
    w = 2.0 * np.pi * np.linspace(150.0, 2900.0, 23)
    one, other = (mesh_error_response(machine, w) for machine in (ours, theirs))
    for bearing, load in other.bearing_load.items():
        np.testing.assert_allclose(one.bearing_load[bearing], load, rtol=0.0, atol=precision * np.abs(load).max())
    for sensor in sensors:
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
    assert files == ["box-damping.mtx", "box-mass.mtx", "box-stiffness.mtx", "box.dof", "box.toml"]
    with pytest.raises(CaseError, match="no file of that name stands yet"):
        study.export_reduced(tmp_path / "box.mtx")


def test_other_endings_and_cases_without_a_housing_are_refused(study: CaseStudy, tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"ends in one of \.npz, \.nc, \.mtx, \.op4, \.pch"):
        study.export_reduced(tmp_path / "box.csv")
    with pytest.raises(CaseError, match="housing"):
        gw.load("spur-pair").export_reduced(tmp_path / "box.npz")
    assert not list(tmp_path.iterdir())
