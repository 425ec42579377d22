"""A machine of Python has the results of the same machine in a case: numbers, warnings, figures and files."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import gearwhine as gw
from gearwhine.coupling import CouplingError, TorqueOverTime
from gearwhine.coupling.gears.loaded.optimal_relief import PeakToPeak
from gearwhine.coupling.sound import Acoustics
from gearwhine.from_case.machine import describe_machine
from gearwhine.results_folder import write_report
from gearwhine.solve.machine import plan_of

pytestmark = pytest.mark.usefixtures("few_reliefs_tried")

SHORT = {"transient.revolutions": 6, "transient.discard": 3}


@pytest.fixture(scope="module")
def study() -> gw.CaseStudy:
    return gw.load("spur-pair", SHORT)


@pytest.fixture(scope="module")
def machine(study: gw.CaseStudy) -> gw.Study:
    return gw.Study(study.machine, gw.Settings("two spur gears"))


def test_motion_over_time_is_that_of_the_case_and_is_written(
    study: gw.CaseStudy, machine: gw.Study, tmp_path: Path
) -> None:
    found, expected = machine.simulate(plan_of(study.case)), study.simulate()
    assert found.document["steps"] == expected.document["steps"]
    for name in ("mesh_force", "bearing_force"):
        np.testing.assert_array_equal(found.dataset[name], expected.dataset[name])
    peaks = [pair["peak_force_n"] for pair in found.document["gear_pairs"]]
    assert peaks == [pair["peak_force_n"] for pair in expected.document["gear_pairs"]]
    # No modes of a housing end anywhere.
    assert found.proofs["trusted_below_hz"] is None
    assert "trusted_below_hz" not in found.dataset["mesh_force_spectrum"].attrs
    files = found.write(tmp_path, pictures=False)
    assert {"results.nc", "summary.json"} <= set(files)
    with xr.open_dataset(tmp_path / "results.nc", engine="h5netcdf") as data:
        assert data.attrs["title"] == "two spur gears"
        np.testing.assert_array_equal(data["mesh_force"], found.dataset["mesh_force"])
    assert json.loads((tmp_path / "summary.json").read_text())["steps"] == found.document["steps"]
    assert "two spur gears" in found._repr_html_()
    assert found.plot("mesh-force").axes


@pytest.mark.parametrize("name", ["spur-pair", "planetary-stage", "overhung-fan"])
def test_check_of_a_machine_is_that_of_the_case_without_its_housing(name: str) -> None:
    case = gw.load(name)
    on_ground = describe_machine(case.case)
    found = gw.Study(on_ground, case.settings).check()
    expected = case.check().document
    without = {"warnings", "bearings"} if "housing" in expected else set()
    assert set(expected) - set(found.document) <= {"housing", "rotor_analysis", "damping", "provenance"}
    for key in set(found.document) - without:
        assert found.document[key] == expected[key], key
    assert [one["seat"] for one in found.document["bearings"] if one["rotor"] == "sun"] in ([], ["ground"] * 2)
    thin = replace(on_ground, gravity=(0.0, -90.0, 0.0))
    assert any("m/s²" in text or "90" in text for text in gw.Study(thin).check().warnings)


def test_what_loads_a_machine_over_time_acts_and_is_checked(machine: gw.Study) -> None:
    """The mean mesh force of the last revolution follows a torque that has risen by half."""
    given = machine.machine
    risen = replace(given, torque_over_time=TorqueOverTime((0.0, 1e-3), (0.0, 0.5 * given.torque)))
    plan = {"revolutions": 6.0, "discard": 5.0, "tolerance": 1e-4}
    forces = [
        float(gw.Study(one).simulate(**plan).dataset["mesh_force"].isel(contact=0).mean()) for one in (given, risen)
    ]
    assert forces[1] == pytest.approx(1.5 * forces[0], rel=0.02)
    with pytest.raises(CouplingError, match=r"torque over time: times is .*; expected numbers that ascend"):
        TorqueOverTime((1.0, 0.0), (1.0, 2.0))
    with pytest.raises(CouplingError, match="simulate: expected how far to integrate"):
        machine.simulate()
    with pytest.raises(CouplingError, match="run is '0 to 3000 rpm'; expected a SpeedRun or a FreeRun"):
        machine.simulate(run="0 to 3000 rpm")
    assert "5500" in machine._repr_html_()
    with pytest.raises(CouplingError, match="a study is of a gearwhine\\.Machine, got 'spur-pair'"):
        gw.Study("spur-pair")  # type: ignore[arg-type]
    with pytest.raises(CouplingError, match=r"a study takes gearwhine\.Settings, .* got 'a title'"):
        gw.Study(given, "a title")  # type: ignore[arg-type]


def test_writing_a_result_leaves_it_as_it_is(machine: gw.Study, tmp_path: Path) -> None:
    result = machine.operating_point()
    before = result.json()
    files = result.write(tmp_path / "one", pictures=False)
    assert result.json() == before
    stored = result.stored(tmp_path / "two", pictures=False)
    assert stored.document["files"] == files
    assert stored.document["folder"] == str(tmp_path / "two")


def test_analyses_of_a_machine_keep_their_own_results_in_a_folder(machine: gw.Study, tmp_path: Path) -> None:
    """In either order; the report shows both."""
    rotors, point = machine.rotors(mode_count=4), machine.operating_point()
    for name, pair in (("one", (rotors, point)), ("two", (point, rotors))):
        first, second = pair
        first.write(tmp_path / name, pictures=False)
        before = (tmp_path / name / "results.nc").read_bytes()
        files = second.write(tmp_path / name, pictures=False)
        assert f"{second.command}/results.nc" in files
        assert (tmp_path / name / "results.nc").read_bytes() == before
        assert json.loads((tmp_path / name / "summary.json").read_text())["command"] == first.command
        page = write_report(tmp_path / name)
        assert page["files"] == ["report.html"]
        text = (tmp_path / name / "report.html").read_text(encoding="utf-8")
        assert ">gearwhine rotors</h2>" in text
        assert ">gearwhine load</h2>" in text


def test_a_whole_run_is_that_of_the_case(study: gw.CaseStudy) -> None:
    """A machine with the settings of a case; the case adds what it says of its damping, and other times."""
    found, expected = gw.Study(study.machine, study.settings).run(), study.run()
    of_case = {key: value for key, value in expected.document.items() if key not in {"seconds", "damping"}}
    of_machine = {key: value for key, value in found.document.items() if key != "seconds"}
    for document in (of_case, of_machine):
        document.pop("steps_per_second", None)
    assert json.dumps(of_machine) == json.dumps(of_case)
    assert set(found.dataset.variables) == set(expected.dataset.variables)
    for name in ("mesh_force", "system_frequency", "rotor_rest_frequency", "transmission_error"):
        np.testing.assert_array_equal(found.dataset[name], expected.dataset[name])
    assert [name for name, _ in found.figures()] == [name for name, _ in expected.figures()]


def test_speeds_of_the_settings_are_those_of_diagrams_and_branches(machine: gw.Study) -> None:
    speed = machine.machine.speed
    over = gw.Study(machine.machine, gw.Settings(speeds=[0.8 * speed, 1.1 * speed]))
    assert over.system().solved.campbell is not None
    assert machine.system().solved.campbell is None
    assert machine.system(campbell=True).solved.campbell is not None
    with pytest.raises(CouplingError, match=r"settings: speeds is .*; expected numbers, each a finite number rad/s"):
        gw.Settings(speeds=[float("nan")])


def test_what_has_no_range_of_speeds_is_refused(machine: gw.Study) -> None:
    given, speed = machine.machine, machine.machine.speed
    at_rest = gw.Study(replace(given, speed=0.0))
    with pytest.raises(CouplingError, match="expected a speed: a diagram over speed is of a machine that turns"):
        at_rest.system(campbell=True)
    with pytest.raises(CouplingError, match="steady: expected a speed"):
        at_rest.steady()
    one = gw.Study(given, gw.Settings(speeds=[speed]))
    with pytest.raises(CouplingError, match="the speeds of the settings: expected two or more speeds"):
        one.system(campbell=True)
    for speeds in ([speed], [-speed, 2.0 * speed], [0.0, speed]):
        with pytest.raises(CouplingError, match="the settings: expected a range of speeds above zero, of one sense"):
            gw.Study(given, gw.Settings(speeds=speeds)).steady(curve=True)


def test_an_object_beside_its_attributes_is_refused(study: gw.CaseStudy, machine: gw.Study) -> None:
    """One of the two would be dropped without a word."""
    plan = gw.TransientPlan(revolutions=4.0)
    for one in (study, machine):
        with pytest.raises(CouplingError, match="simulate: expected a TransientPlan or its attributes by name, got"):
            one.simulate(plan, discard=2.0)
        with pytest.raises(CouplingError, match="sound: expected an Acoustics or its attributes by name, got"):
            one.sound(Acoustics(method="erp"), floor=-0.1)


def test_rotors_take_their_own_settings(machine: gw.Study) -> None:
    speeds = [50.0, 100.0, 150.0]
    over = gw.Study(machine.machine, gw.Settings(speeds=speeds))
    rotors = over.rotors(mode_count=4, orders=(2.0,)).document["rotors"]
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
