"""A machine of Python has the results of the same machine in a case: numbers, warnings, figures and files."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import gearwhine as gw
from gearwhine.coupling import CouplingError, SpeedRun, TorqueOverTime
from gearwhine.coupling.gears.loaded.optimal_relief import PeakToPeak
from gearwhine.solve.housing_modes import bearing_places, describe_housing
from gearwhine.solve.machine import plan_of

SHORT = {"transient.revolutions": 6, "transient.discard": 3}
# What a case says beside its machine, and what depends on the clock or the folder.
OF_THE_CASE = {
    "title",
    "damping",
    "warnings",
    "seconds",
    "gear_pairs",
    "housing",
    "rotors",
    "pairs",
    "system",
    "steps_per_second",
}


def alike(found: dict[str, Any], expected: dict[str, Any]) -> None:
    """Every key of the machine's document is in the case's, with the same value."""
    for key in found.keys() - OF_THE_CASE:
        assert json.dumps(found[key], default=str) == json.dumps(expected[key], default=str), key
    messages = {entry["message"] for entry in expected["warnings"]}
    assert {entry["message"] for entry in found["warnings"]} <= messages


@pytest.fixture(scope="module")
def study() -> gw.Study:
    return gw.load("spur-pair", SHORT)


@pytest.fixture(scope="module")
def machine(study: gw.Study) -> gw.MachineStudy:
    return gw.MachineStudy(study.machine, "two spur gears")


def test_modes_and_responses_are_those_of_the_case(study: gw.Study, machine: gw.MachineStudy) -> None:
    found, expected = machine.system(), study.system()
    alike(found.document, expected.document)
    for name, array in expected.dataset.data_vars.items():
        np.testing.assert_array_equal(found.dataset[name], array)
        assert found.dataset[name].attrs == array.attrs
    assert found.proofs.keys() == expected.proofs.keys()
    assert [name for name, _ in found.figures()] == [name for name, _ in expected.figures()]


def test_the_operating_point_is_that_of_the_case(study: gw.Study, machine: gw.MachineStudy) -> None:
    found, expected = machine.operating_point(), study.operating_point()
    alike(found.document, expected.document)
    assert found.document["bearings"][0]["force_n"] == expected.document["bearings"][0]["force_n"]


def test_the_periodic_motion_is_that_of_the_case(study: gw.Study, machine: gw.MachineStudy) -> None:
    alike(machine.steady().document, study.steady().document)


def test_motion_over_time_is_that_of_the_case_and_is_written(
    study: gw.Study, machine: gw.MachineStudy, tmp_path: Path
) -> None:
    found, expected = machine.simulate(plan_of(study.case)), study.simulate()
    assert found.document["steps"] == expected.document["steps"]
    for name in ("mesh_force", "bearing_force"):
        np.testing.assert_array_equal(found.dataset[name], expected.dataset[name])
    peaks = [pair["peak_force_n"] for pair in found.document["gear_pairs"]]
    assert peaks == [pair["peak_force_n"] for pair in expected.document["gear_pairs"]]
    files = found.write(tmp_path, pictures=False)
    assert {"results.nc", "summary.json"} <= set(files)
    with xr.open_dataset(tmp_path / "results.nc", engine="h5netcdf") as data:
        assert data.attrs["title"] == "two spur gears"
        np.testing.assert_array_equal(data["mesh_force"], found.dataset["mesh_force"])
    assert json.loads((tmp_path / "summary.json").read_text())["steps"] == found.document["steps"]
    assert "two spur gears" in found._repr_html_()
    assert found.plot("mesh-force").axes


def test_a_run_up_of_a_machine_is_that_of_the_case() -> None:
    run = {"run": {"from": "600 rpm", "to": "1500 rpm", "time": "60 ms"}}
    study = gw.load("spur-pair", {"transient": run})
    speeds = tuple(np.array([600.0, 1500.0]) * np.pi / 30.0)
    plan = replace(plan_of(study.case), run=SpeedRun((0.0, 0.06), speeds))
    found = gw.MachineStudy(study.machine).simulate(plan)
    expected = study.simulate()
    np.testing.assert_allclose(found.dataset["mesh_force"], expected.dataset["mesh_force"], rtol=1e-9)


def test_what_loads_a_machine_over_time_acts_and_is_checked(machine: gw.MachineStudy) -> None:
    """The mean mesh force of the last revolution follows a torque that has risen by half."""
    given = machine.machine
    risen = replace(given, torque_over_time=TorqueOverTime((0.0, 1e-3), (0.0, 0.5 * given.torque)))
    plan = {"revolutions": 6.0, "discard": 5.0, "tolerance": 1e-4}
    forces = [
        float(gw.MachineStudy(one).simulate(**plan).dataset["mesh_force"].isel(contact=0).mean())
        for one in (given, risen)
    ]
    assert forces[1] == pytest.approx(1.5 * forces[0], rel=0.02)
    with pytest.raises(CouplingError, match=r"torque over time: times is .*; expected numbers that ascend"):
        TorqueOverTime((1.0, 0.0), (1.0, 2.0))
    with pytest.raises(CouplingError, match="expected one of the two"):
        machine.simulate()


@pytest.mark.slow
def test_a_machine_in_its_housing_has_the_lines_of_the_case() -> None:
    """Sensors, mechanisms of their lines, bands by damping and the error of the modal basis, at rest and in motion."""
    coarse = {"housing.box.mesh_size": "45 mm", "transient.revolutions": 4, "transient.discard": 2}
    study = gw.load("small-gearbox", coarse)
    machine = gw.MachineStudy(study.machine, study.case.title)
    moved, expected = machine.simulate(plan_of(study.case)), study.simulate()
    for name in ("sensor_acceleration", "sensor_spectrum", "mesh_force", "bearing_force"):
        np.testing.assert_array_equal(moved.dataset[name], expected.dataset[name])
    for found, of_case in zip(moved.document["sensors"], expected.document["sensors"], strict=True):
        assert found == of_case
        assert {"parts", "band_db", "uncertainty"} <= found["peaks"][0].keys()
    loaded, by_case = machine.operating_point(), study.operating_point()
    assert loaded.document["bearings"] == by_case.document["bearings"]
    assert loaded.document["gear_pairs"] == by_case.document["gear_pairs"]
    alike(machine.steady().document, study.steady().document)


@pytest.mark.slow
def test_a_machine_on_the_modes_of_a_housing_of_python_is_that_of_the_case() -> None:
    """The housing is meshed and solved by `gw.Housing`, with the parts of the case; its modes carry the machine."""
    coarse = {"housing.box.mesh_size": "45 mm", "transient": ""}
    study = gw.load("small-gearbox", coarse)
    case, solved = study.case, study.housing
    assert solved is not None
    assert case.housing is not None
    assert isinstance(case.housing.damping_ratio, float)
    described = replace(describe_housing(case, solved.mesh), damping_ratio=case.housing.damping_ratio)
    places = bearing_places(case)
    modes = described.modes(below_hz=case.housing.frequency_limit, bearings=places)
    found = gw.MachineStudy(replace(study.machine, housing=modes)).steady()
    expected = study.steady()
    motions = (result.document["motions"][0]["sensors"] for result in (found, expected))
    for one, other in zip(*motions, strict=True):
        assert one["name"] == other["name"]
        assert one["rms_m_per_s2"] == pytest.approx(other["rms_m_per_s2"], rel=1e-9)


def equal(found: gw.Result[Any], expected: gw.Result[Any]) -> None:
    """Document, arrays and figures are the same."""
    assert found.json() == expected.json()
    assert set(found.dataset.variables) == set(expected.dataset.variables)
    for name, array in expected.dataset.variables.items():
        np.testing.assert_array_equal(found.dataset.variables[name], array)
        assert found.dataset.variables[name].attrs == array.attrs
    assert [name for name, _ in found.figures()] == [name for name, _ in expected.figures()]


def test_rotors_and_gears_are_those_of_the_case(study: gw.Study, machine: gw.MachineStudy) -> None:
    for found, expected in ((machine.rotors(), study.rotors()), (machine.gears(), study.gears())):
        equal(found, expected)


def test_rotors_take_their_own_settings(machine: gw.MachineStudy) -> None:
    speeds = [50.0, 100.0, 150.0]
    rotors = machine.rotors(speeds=speeds, mode_count=4, orders=(2.0,)).document["rotors"]
    ratio = machine.machine.speeds["output"] / machine.machine.speed
    for rotor, factor in zip(rotors, (1.0, ratio), strict=True):
        assert sorted(rotor["campbell"]["speed_rpm"], key=abs) == pytest.approx(
            [factor * speed * 30.0 / np.pi for speed in speeds]
        )
        assert [row["order"] for row in rotor["campbell"]["orders"]] == [2.0]
    with pytest.raises(gw.RotorError, match="mode_count"):
        machine.rotors(mode_count=0)
    with pytest.raises(CouplingError, match="an aim for each of the 1 gear pairs, got 2"):
        machine.gears([PeakToPeak(), PeakToPeak()])


@pytest.mark.slow
def test_the_best_relief_of_a_machine_in_a_housing_aims_at_the_loudest_sensor_as_in_the_case() -> None:
    study = gw.load("small-gearbox", {"housing.box.mesh_size": "50 mm"})
    found = gw.MachineStudy(study.machine).gears()  # solves the housing, which `gears` of the case then takes
    equal(found, study.gears())
    assert found.document["pairs"][0]["optimal_relief"]["aim"]["kind"] == "sensor"
