"""The front door in Python: cases and objects in, labelled results out, the same numbers as the command's."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import gearwhine as gw
from gearwhine.case import Bearing, Material, Rotor
from gearwhine.cli import run_command
from gearwhine.failures import explain
from gearwhine.output.manifest import MANIFEST
from gearwhine.rotors.rolling_bearings import catalogue_bearing

pytestmark = pytest.mark.usefixtures("few_reliefs_tried")

COARSE = {"housing.box.mesh_size": "45 mm", "housing.frequency_limit": "2.5 kHz"}
BOX = {"housing.box.mesh_size": "60 mm"}
SHORT = {"transient.revolutions": 6, "transient.discard": 4, "transient.tolerance": 5e-3}


@pytest.fixture(scope="module")
def study() -> gw.CaseStudy:
    return gw.load("small-gearbox", COARSE | SHORT)


ROD = {"name": "rod", "material": "steel", "segments": [{"length": "500 mm", "diameter": "30 mm"}]}


def test_every_name_of_the_front_door_is_there() -> None:
    assert len(gw.__all__) <= 60
    assert all(getattr(gw, name) is not None for name in gw.__all__)
    with pytest.raises(AttributeError, match="no attribute 'gear_box'"):
        gw.gear_box  # noqa: B018 - its absence is the point


@pytest.mark.parametrize(
    ("given", "expected"),
    [({}, "1"), ({"OPENBLAS_NUM_THREADS": "3"}, "3"), ({"OMP_NUM_THREADS": "2"}, None)],
)
def test_command_has_one_thread_of_blas_unless_told_otherwise(given: dict[str, str], expected: str | None) -> None:
    blas = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    environment = {name: value for name, value in os.environ.items() if name not in blas} | given
    code = (
        "import os, sys, gearwhine.cli\n"
        "from gearwhine.__main__ import main\n"
        "def told(*_, **__): print('numpy' in sys.modules, os.environ.get('OPENBLAS_NUM_THREADS'))\n"
        "gearwhine.cli.run_command = told\n"
        "main()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.split() == ["False", str(expected)]


@pytest.mark.slow
def test_modes_are_the_command_s(study: gw.CaseStudy, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = study.modes()
    changes = [part for key, value in (COARSE | SHORT).items() for part in ("--set", f"{key}={value}")]
    assert run_command(["modes", "small-gearbox", "--json", "-q", *changes]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert [mode["frequency_hz"] for mode in printed["modes"]] == found.dataset["housing_frequency"].values.tolist()
    assert found.dataset["housing_frequency"].attrs["units"] == "Hz"
    assert found.proofs["certificate"]["complete"]
    assert json.loads(found.json())["modes"] == printed["modes"]


def test_the_housing_is_solved_once(study: gw.CaseStudy) -> None:
    assert study.modes().solved is study.housing
    assert study.system().solved.machine.housing is not None
    # The machine as an object stands in the same housing, not on the ground.
    assert study.machine.housing_component is not None
    assert all(mounted.seat in study.machine.housing_component.seats for mounted in study.machine.bearings)
    assert study.modes().solved is study.housing


@pytest.mark.slow
def test_modes_are_written_without_loading_a_library_of_figures(tmp_path: Path) -> None:
    code = (
        f"import sys, gearwhine as gw; files = gw.load('steel-box', {BOX!r}).modes().write({str(tmp_path)!r})\n"
        "print('results.nc' in files, 'matplotlib' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True", "False"]


@pytest.mark.slow
def test_a_written_result_is_the_dataset(study: gw.CaseStudy, tmp_path: Path) -> None:
    found = study.changed({"sweep.speed": ["2000 rpm", "3000 rpm", "4000 rpm"]}).system(campbell=True)
    files = found.write(tmp_path)
    assert {"results.nc", "summary.json", "case.toml", "system-campbell.png"} <= set(files)
    with xr.open_dataset(tmp_path / "results.nc") as written:
        xr.testing.assert_allclose(written, found.dataset)
    names = [name for name, _ in found.figures()]
    assert names[0] == "system-campbell"
    assert found.plot("system-campbell").axes
    with pytest.raises(KeyError, match="no figure 'campbel' of 'system'; there are: system-campbell"):
        found.plot("campbel")


def test_what_is_done_to_a_dataset_stays_in_it(study: gw.CaseStudy, tmp_path: Path) -> None:
    """Neither other results of the study nor what is written know of it."""
    before, result = study.modes().dataset.copy(deep=True), study.modes()
    for name, variable in result.dataset.variables.items():
        if variable.dtype.kind == "f" and variable.dims and name not in result.dataset.dims:
            variable.values *= 2.0
    assert not result.dataset.identical(before)
    xr.testing.assert_identical(study.modes().dataset, before)
    result.write(tmp_path, pictures=False)
    with xr.open_dataset(tmp_path / "results.nc", engine="h5netcdf") as written:
        for name, variable in before.variables.items():
            np.testing.assert_array_equal(written[name].values, variable.values, err_msg=str(name))


def test_a_dataset_of_arrays_at_hand_is_a_copy(study: gw.CaseStudy) -> None:
    at_hand = xr.Dataset({"level": ("sensor", np.array([1.0, 2.0]))})
    result = gw.Result("sweep", study.case, None, {}, _arrays=lambda: at_hand)
    result.dataset["level"].values[:] = 0.0
    assert at_hand["level"].values.tolist() == [1.0, 2.0]


@pytest.mark.slow
def test_a_run_has_histories_in_memory_as_on_file(study: gw.CaseStudy, tmp_path: Path) -> None:
    found = study.simulate()
    assert found.command == "simulate"
    assert found.proofs["energy_error"] < 1e-2
    found.write(tmp_path, pictures=False)
    assert not list(tmp_path.glob("*.png"))
    with xr.open_dataset(tmp_path / "results.nc") as written:
        xr.testing.assert_allclose(written, found.dataset)
        # Two turns of a first driver with 28 teeth: the mesh order stands in line 2 × 28.
        force = found.dataset["mesh_force"].isel(contact=0).values
        lines = np.abs(np.fft.rfft(force - force.mean()))
        assert lines.argmax() % (2 * 28) == 0


def test_gears_and_rotors_need_no_housing() -> None:
    study = gw.load("small-gearbox")
    gears, rotors = study.gears(), study.rotors()
    assert study._kept.solved is None
    assert gears.dataset["transmission_error"].attrs["units"] == "m"
    assert gears.solved[0].solved.torque == pytest.approx(study.case.operation.torque if study.case.operation else 0.0)
    assert [one.rotor.name for one in rotors.solved] == [rotor.name for rotor in study.case.rotor]
    assert "gears-pinion-wheel-stiffness" in [name for name, _ in gears.figures()]


def test_a_case_of_python_objects_is_that_of_a_file() -> None:
    tables = {
        "material": {"steel": Material(youngs_modulus=207e9, poisson_ratio=0.3, density=7850.0)},
        "rotor": [
            Rotor.model_validate(
                {"name": "shaft", "material": "steel", "segments": [{"length": "500 mm", "diameter": "30 mm"}]}
            )
        ],
        "bearing": [
            Bearing.model_validate(
                {"name": name, "rotor": "shaft", "at": at, "seat": "ground", "stiffness": {"xx": 1e8, "yy": 1e8}}
            )
            for name, at in (("left", 0.02), ("right", 0.48))
        ],
    }
    found = gw.build(**tables).rotors()
    mass = 7850.0 * np.pi / 4.0 * 0.03**2 * 0.5
    assert found.document["rotors"][0]["mass_kg"] == pytest.approx(mass, rel=1e-12)
    plain = {
        "material": {"steel": {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}},
        "rotor": [{"name": "shaft", "material": "steel", "segments": [{"length": 0.5, "diameter": 0.03}]}],
        "bearing": [
            {"name": name, "rotor": "shaft", "at": at, "seat": "ground", "stiffness": {"xx": 1e8, "yy": 1e8}}
            for name, at in (("left", 0.02), ("right", 0.48))
        ],
    }
    assert gw.build(**plain).rotors().document["rotors"] == found.document["rotors"]


def test_what_the_case_reader_refuses_objects_refuse_in_the_same_words(tmp_path: Path) -> None:
    with pytest.raises(gw.CaseError, match=r"rotor\[0\]\.material"):
        gw.build(rotor=[{"name": "shaft", "material": "stele", "segments": [{"length": 0.5, "diameter": 0.03}]}])
    with pytest.raises(gw.CaseError, match="sweep: expected speeds"):
        gw.build(
            material={"steel": {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850}},
            rotor=[{"name": "shaft", "material": "steel", "segments": [{"length": 0.5, "diameter": 0.03}]}],
        ).sweep(folder=tmp_path)
    with pytest.raises(gw.CaseError, match=r"housing\.box\.mesh_size"):
        gw.load("small-gearbox", {"housing.box.mesh_size": "-3 mm"})


def test_the_machine_of_a_case_is_the_one_that_its_analyses_solve() -> None:
    study = gw.load("spur-pair")
    machine = study.machine
    assert isinstance(machine, gw.Machine)
    assert machine.speeds == pytest.approx({"input": gw.rpm(5500.0), "output": -gw.rpm(5500.0)})
    from gearwhine.coupling import coupled_modes

    found = coupled_modes(machine.assemble().system).frequencies_hz
    assert found == pytest.approx(study.system().dataset["system_frequency"].values, rel=1e-9)


@pytest.mark.slow
def test_sidebands_are_drawn_over_speed() -> None:
    """Lines of sidebands stand in a Campbell diagram, so asking for them asks for one."""
    study = gw.load("spur-pair", {"rotor.input.modes": 2, "rotor.output.modes": 2})
    assert study.system().solved.campbell is None
    assert study.system(sidebands=2).solved.campbell is not None
    assert study.system(mesh_harmonics=4).solved.campbell is not None


def test_wrong_input_is_a_value_error_and_a_failed_proof_a_runtime_error() -> None:
    """So that one base class catches what all packages refuse; the command exits with 2 and 1."""
    exported = (gw.CaseError, gw.GeometryError, gw.HousingError, gw.RotorError, gw.GearError, gw.CouplingError)
    assert all(issubclass(one, ValueError) for one in exported)
    wrong = proofs = 0
    for name in (
        "gearwhine.meshes.errors",
        "gearwhine.housing.errors",
        "gearwhine.rotors.errors",
        "gearwhine.coupling.errors",
        "gearwhine.coupling.gears.errors",
    ):
        for error in vars(import_module(name)).values():
            if isinstance(error, type) and issubclass(error, Exception) and error.__module__ == name:
                code, message = explain(error("why"))
                assert message == "why"
                assert issubclass(error, ValueError if code == 2 else RuntimeError)
                assert code == 1 or issubclass(error, exported)
                wrong, proofs = wrong + (code == 2), proofs + (code == 1)
    assert (wrong, proofs) >= (12, 10)
    with pytest.raises(gw.RotorError, match="mass"):
        gw.Disc(at=0.1, mass=-1.0, polar_inertia=0.0, diametral_inertia=0.0)


def test_speeds_in_revolutions_a_minute_and_back() -> None:
    assert gw.rpm(30.0) == pytest.approx(np.pi)
    assert gw.to_rpm(gw.rpm(-1234.5)) == pytest.approx(-1234.5, rel=1e-15)


def test_axes_too_far_apart_are_refused_with_both_distances() -> None:
    words = (
        r"gear_pair\[0\].*the teeth lose contact at a centre distance of 244\.45 mm; they mesh without backlash at "
        r"88\.9 mm; the axes are those of 'input' and 'output'"
    )
    with pytest.raises(gw.CaseError, match=words):
        gw.load("spur-pair", {"rotor.input.axis": ["-200 mm", "0 mm"]})


def test_a_check_is_a_result_like_the_others(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = gw.load("spur-pair").check()
    pair = found.document["gear_pairs"][0]
    assert pair["mesh_frequency_hz"] == pytest.approx(28 * 5500.0 / 60.0, rel=1e-12)
    assert found.solved.pairs[0].geometry.contact_ratio == pair["contact_ratio"]
    assert found.warnings == []
    assert run_command(["check", "spur-pair", "--json", "-q"]) == 0
    assert json.loads(capsys.readouterr().out) == json.loads(found.json())
    assert found.write(tmp_path) == ["case.toml", "summary.json"]
    assert json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["gear_pairs"][0] == pair
    assert run_command(["report", "spur-pair", "-q", "-o", str(tmp_path)]) == 0
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert ">gearwhine check</h2>" in page
    assert "mesh frequency 2566.67 Hz" in page


def test_modes_are_selected_by_their_number(study: gw.CaseStudy) -> None:
    housing, system, rotors = study.modes().dataset, study.system().dataset, study.rotors().dataset
    for data, variable, dimension in (
        (housing, "housing_frequency", "housing_mode"),
        (system, "system_frequency", "system_mode"),
        (rotors, "rotor_rest_frequency", "rest_mode"),
        (rotors, "rotor_torsional_frequency", "torsional_mode"),
        (rotors, "rotor_lateral_shape", "lateral_mode"),
        (rotors, "rotor_whirl_deflection", "whirl_mode"),
    ):
        numbers = data[dimension]
        assert numbers.values.tolist() == list(range(1, data.sizes[dimension] + 1))
        assert numbers.attrs["units"] == "1"
        assert numbers.attrs["long_name"].startswith("number of the ")
        np.testing.assert_array_equal(data[variable].sel({dimension: 3}), data[variable].isel({dimension: 2}))


def test_changes_of_a_case_may_be_lists_and_tables() -> None:
    run = {"from": "1500 rpm", "to": "4500 rpm", "time": "0.5 s"}
    changes = {"transient": {"run": run, "tolerance": 1e-3}, "measured": {"frequencies": ["658 Hz", 1049.0]}}
    case = gw.load("small-gearbox", changes).case
    assert case.transient is not None
    assert case.transient.run is not None
    assert case.transient.tolerance == 1e-3
    assert case.measured is not None
    assert case.measured.frequencies == pytest.approx((658.0, 1049.0))
    assert gw.load("small-gearbox", {"transient": ""}).case.transient is None


def test_the_examples_of_docstrings_hold() -> None:
    import doctest

    from gearwhine import study as module

    assert doctest.testmod(module).failed == 0


@pytest.mark.slow
def test_a_simulation_leaves_the_results_of_a_run_in_the_folder(tmp_path: Path) -> None:
    study = gw.load("spur-pair", SHORT)
    study.run().write(tmp_path, pictures=False)
    # The manifest lists the files of both.
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.name != MANIFEST}
    files = study.simulate().write(tmp_path, pictures=False)
    assert {"simulate/results.nc", "simulate/summary.json"} <= set(files)
    after = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file() and path.name != MANIFEST}
    assert after == before
    assert json.loads((tmp_path / "simulate" / "summary.json").read_text(encoding="utf-8"))["command"] == "simulate"
    assert run_command(["report", "spur-pair", "-q", "-o", str(tmp_path)]) == 0
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert ">gearwhine simulate</h2>" in page
    assert ">gearwhine run</h2>" in page
    assert page.count("the energy balance closes") == 3  # of each, and once on the first page


def test_a_changed_study_solves_its_housing_again_only_where_it_has_to(study: gw.CaseStudy) -> None:
    assert study.housing is not None
    kept = study.changed({"operation.torque": "30 N*m", "gear.*.tip_relief": ""})
    assert (kept.case.operation.torque, study.case.operation.torque) != (30.0, 30.0)  # type: ignore[union-attr]
    assert [gear.tip_relief for gear in kept.case.gear] == [None, None]
    assert kept.case.transient == study.case.transient  # by the changes that the first one was loaded with
    assert kept.housing is study.housing
    for change in ({"housing.box.wall": "9 mm"}, {"bearing.0.at": "12 mm"}, {"housing.damping_ratio": 0.05}):
        assert study.changed(change)._kept.solved is None
    # Pictures stand upright by the gravity, which changes no mode.
    assert study.changed({"operation.gravity": [0.0, -9.81, 0.0]})._kept is study._kept
    assert study.changed({"operation.gravity": [-9.81, 0.0, 0.0]})._kept is not study._kept
    built = gw.build(
        material={"steel": {"youngs_modulus": 207e9, "poisson_ratio": 0.3, "density": 7850.0}}, rotor=[ROD]
    )
    longer = built.changed({"rotor.rod.segments[0].length": "600 mm"}).changed(["title=longer"])
    assert (longer.case.title, longer.case.rotor[0].segments[0].length) == ("longer", 0.6)  # type: ignore[union-attr]
    with pytest.raises(gw.CaseError, match="one of 'rod'"):
        built.changed({"rotor.rodd.mass": "lumped"})


def test_machines_and_operating_points_print_in_a_line() -> None:
    machine = gw.load("spur-pair").machine
    text = repr(machine)
    assert text == "<Machine: 2 shafts, 4 bearings, 2 gears, 1 gear pair, without housing; 5500 rpm, 71.77 N·m>"
    text = repr(machine.operating_point())
    assert text.startswith("<OperatingPoint: input-back 859.12 N, input-front 859.12 N, output-back 859.12 N, ")
    assert text.endswith(" µrad>")
    assert len(text) < 200


def test_rolling_bearings_of_objects_get_their_stiffness_from_the_operating_point() -> None:
    """Gears stand in the middle of their shafts: a bearing carries half the mesh force, whatever its stiffness."""
    machine = gw.load("spur-pair").machine
    elements = catalogue_bearing("deep-groove", 0.025, 0.052, 0.015, clearance=6e-6, dynamic=14.8e3, static=7.8e3)
    bearings = [
        gw.MountedBearing.from_elements(one.bearing.name, one.bearing.at, one.rotor, one.seat, elements, damping=500.0)
        for one in machine.bearings
    ]
    assert all(one.needs_load and one.elements is elements for one in bearings)
    assert bearings[0].bearing.spatial_damping.diagonal().tolist() == [500.0, 500.0, 0.0, 0.0, 0.0]
    on_rolling = replace(machine, bearings=bearings)
    with pytest.raises(gw.CouplingError, match=r"no stiffness yet for input-back, .*at_operating_point"):
        on_rolling.assemble()
    loaded = on_rolling.operating_point()
    for bearing, linear in zip(loaded.bearings, machine.operating_point().bearings, strict=True):
        np.testing.assert_allclose(bearing.force[:2], linear.force[:2], rtol=1e-6)
    stiff = on_rolling.at_operating_point(loaded).bearings[0].bearing.spatial_stiffness
    assert stiff[0, 0] > 1e7
    assert stiff[1, 1] > 1e7
