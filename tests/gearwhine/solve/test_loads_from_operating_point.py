"""Loads of rolling bearings and misalignment of flanks that a case leaves to the machine's operating point."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coupled_cases import about_operating_point

import gearwhine as gw
from gearwhine.case import CaseError, dump_case, load_case, parse_case, swept_keys
from gearwhine.cli import run_command
from gearwhine.coupling.errors import EquilibriumNotFoundError
from gearwhine.coupling.gears import loaded_transmission_error
from gearwhine.from_case.machine import describe_machine, rotor_bearings
from gearwhine.output.manifest import opened_dataset
from gearwhine.rotors.rolling_bearings import RollingBearing, rolling_equilibrium
from gearwhine.solve.machine import load_of_case, solve_pairs
from gearwhine.solve.rotors import solve_rotors
from gearwhine.sweep import PointResult, SweptPoint, collected_sweep, sweep_points
from gearwhine.sweep.solution import solve_point
from gearwhine.workers import code_digest

BALLS = {"catalogue": {"type": "deep-groove", "bore": "30 mm", "outer_diameter": "72 mm", "width": "19 mm"}}
ROLLERS = {"catalogue": {"type": "cylindrical-roller", "bore": "30 mm", "outer_diameter": "62 mm", "width": "16 mm"}}


FORCE = {"x": "300 N", "y": "-900 N", "z": "200 N"}


def document(misalignment: Any = "found", law: str = "linear") -> dict[str, Any]:
    """Two shafts on a ball and a roller bearing each, an overhung helical pair, and no load in any bearing."""
    bearings = [
        {
            "name": f"{rotor} {end}",
            "rotor": rotor,
            "at": at,
            "stiffness": {"rolling": {**rolling, "clearance": "8 um", "law": law}},
            "damping": {"xx": "400 N*s/m", "yy": "400 N*s/m"},
        }
        for rotor in ("input", "output")
        for end, at, rolling in (("left", "30 mm", BALLS), ("right", "150 mm", ROLLERS))
    ]
    gears = [
        {"name": name, "rotor": rotor, "at": "190 mm", "teeth": 29, "module": "2.5 mm", "face_width": "20 mm"}
        | {"pressure_angle": "20 deg", "helix_angle": angle, "bore": "30 mm"}
        for name, rotor, angle in (("pinion", "input", "12 deg"), ("wheel", "output", "-12 deg"))
    ]
    distance = 2.5e-3 * 29.0 / math.cos(math.radians(12.0))
    return {
        "material": {"steel": {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}},
        "rotor": [
            {"name": name, "axis": [x, "0 m"], "start": "0 m", "material": "steel"}
            | {"segments": [{"length": "210 mm", "diameter": "30 mm"}]}
            for name, x in (("input", "0 m"), ("output", f"{distance!r} m"))
        ],
        "bearing": bearings,
        "gear": gears,
        "gear_pair": [{"driver": "pinion", "driven": "wheel", "misalignment": misalignment}],
        "operation": {"speed": "1500 rpm", "torque": "60 N*m"},
    }


@pytest.fixture(scope="module")
def case() -> gw.Case:
    """The case of `document`."""
    return parse_case(document())


def test_bearings_are_linearised_where_the_machine_rests(case: gw.Case) -> None:
    """The coupled machine's mean bearing forces are those of the operating point, its stiffness the tangent there."""
    from gearwhine.coupling.statics.static_equilibrium import static_equilibrium

    point = describe_machine(case).operating_point()
    machine = about_operating_point(case).coupled
    q = static_equilibrium(machine.system)
    for load, connector in zip(point.bearings, machine.system.linear, strict=False):
        assert connector.offset is not None
        held = list(connector.axes)
        assert connector.stiffness == pytest.approx(load.stiffness[np.ix_(held, held)], rel=1e-12)
        force = connector.offset + connector.stiffness @ (connector.directions.T @ q)
        # One phase of the mesh in place of its mean, and a gear rigid on one section in place of its face.
        assert force[:2] == pytest.approx(load.force[:2], abs=5e-3 * float(np.hypot(*load.force[:2])))


def test_a_belt_in_the_case_loads_its_bearings(case: gw.Case) -> None:
    """600 N along y on the end of the input shaft, all of it and no more carried by its bearings, down to the signs."""
    belt = {"rotor": "input", "at": "210 mm", "y": "-600 N"}
    given = document()
    pulled = describe_machine(parse_case(given | {"operation": given["operation"] | {"force": [belt]}}))
    carried = [
        sum(one.force[:3] for one in machine.operating_point().bearings if one.mounted.rotor == "input")
        for machine in (describe_machine(case), pulled)
    ]
    assert carried[1] - carried[0] == pytest.approx([0.0, -600.0, 0.0], abs=1e-3)


def test_flanks_open_as_the_operating_point_finds(case: gw.Case) -> None:
    """The contact of a pair left to the operating point has the load over its face that was found there."""
    point = describe_machine(case).operating_point()
    (pair,), _ = solve_pairs(case, None)
    assert pair.contact.faces is not None
    assert pair.static.line_loads is not None
    (found,) = point.pairs
    assert np.ptp(pair.contact.faces.gap) == pytest.approx(np.ptp(found.gap), rel=1e-9)
    load = pair.static.line_loads.sum(axis=1)
    weights = np.gradient(pair.static.phases)
    mean = weights @ load / weights.sum()
    # The tilt changes the profile's side of the contact a little, which the pair's own contact leaves out.
    assert mean == pytest.approx(found.line_load, abs=0.02 * float(found.line_load.max()))
    (given,), _ = solve_pairs(parse_case(document(misalignment="0.2 mrad")), None)
    assert given.pair.misalignment == 2e-4
    assert not given.pair.face_gap


def test_rotors_alone_stand_on_the_same_bearings(case: gw.Case) -> None:
    """The rotors' own analyses take the bearings' tangent at the operating point, and the life at its load."""
    point = describe_machine(case).operating_point()
    solved = solve_rotors(case)
    for rotor in solved:
        for bearing in rotor.bearings:
            assert bearing.stiffness == pytest.approx(point.bearing(bearing.name).stiffness, rel=1e-12)
        assert set(rotor.rolling) == {bearing.name for bearing in rotor.bearings}


def test_nonlinear_bearings_start_at_their_load() -> None:
    """A bearing that follows its elements in motion is left to the operating point as well."""
    case = parse_case(document(law="nonlinear"))
    point = describe_machine(case).operating_point()
    machine = about_operating_point(case).coupled
    for connector in machine.system.nonlinear:
        assert connector.law.reference == pytest.approx(point.bearing(connector.name).deflection, rel=1e-12)


def test_a_given_load_is_taken() -> None:
    """A load that the case gives stays the one that the stiffness is made for."""
    changed = document()
    changed["bearing"][0]["load"] = FORCE
    stiffness = rotor_bearings(parse_case(changed).parts)["input"][0][0].stiffness
    assert np.abs(stiffness - rotor_bearings(parse_case(document()).parts)["input"][0][0].stiffness).max() > 1e6


@pytest.mark.slow
def test_a_run_has_the_operating_point_that_its_motion_starts_from(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As `load` finds it, in document, arrays, figures, report and terminal; what is typed is held against it."""
    changed = document(misalignment="0.2 mrad")
    changed["bearing"][0]["load"] = FORCE
    changed["transient"] = {"revolutions": 2, "discard": 1}
    file = tmp_path / "case.toml"
    file.write_text(dump_case(parse_case(changed)), encoding="utf-8")
    out = tmp_path / "out"
    assert run_command(["run", str(file), "-q", "-o", str(out)]) == 0
    told, alone = capsys.readouterr(), gw.load(file).operating_point()
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    load = summary["load"]
    assert {key: load[key] for key in load} == {key: alone.document[key] for key in load}
    (pair,) = load["gear_pairs"]
    assert (pair["misalignment_taken_rad"], pair["misalignment_taken_from"]) == (2e-4, "case")
    assert load["bearings"][0]["given_load_n"] == [300.0, -900.0, 200.0]
    assert "given_load_n" not in load["bearings"][1]
    names = [one["name"] for one in summary["warnings"]]
    assert (names.count("misalignment"), names.count("bearing load")) == (1, 1)
    assert f"the equilibrium finds {1e6 * pair['misalignment_rad']:.4g} µrad" in told.err
    assert "misalignment of 200 µrad taken, as the case gives it (found: " in told.out
    assert {"load-shaft-input.png", "load-misalignment.png", "load-face-pinion-wheel.png"} <= set(summary["files"])
    with opened_dataset(out / "results.nc") as data:
        assert data["misalignment"].values == pytest.approx([pair["misalignment_rad"]], rel=1e-12)
        assert data["misalignment_taken"].values == pytest.approx([2e-4])
        assert data["bearing_given_load"].sel(loaded_bearing="input left").values == pytest.approx([300, -900, 200])
        assert np.isnan(data["bearing_given_load"].sel(loaded_bearing="input right").values).all()
    assert run_command(["report", str(file), "-q", "-o", str(out)]) == 0
    page = (out / "report.html").read_text(encoding="utf-8")
    assert page.index("Operating point") < page.index("Coupled")
    assert "Further pictures" not in page


def test_a_run_takes_the_misalignment_found() -> None:
    """The gap over the face is solved once, for the pair's contact and the document."""
    result = gw.build(**document(), transient={"revolutions": 2, "discard": 1}).run()
    (pair,), load = result.solved.pairs, result.solved.load
    assert load is not None
    assert pair.solved.pair.face_gap == load.point.pairs[0].station_gap
    (told,) = result.document["load"]["gear_pairs"]
    assert told["misalignment_taken_rad"] == told["misalignment_rad"] != 0.0
    assert told["misalignment_taken_from"] == "operating point"
    assert not [one for one in result.document["warnings"] if one["name"] in ("misalignment", "bearing load")]


@pytest.mark.slow
def test_a_sweep_over_torque_finds_every_points_equilibrium(tmp_path: Path) -> None:
    """Bearing loads and misalignment are those of `load` at each torque, and the motion stands on them."""
    file = tmp_path / "case.toml"
    given = parse_case({**document(), "transient": {"revolutions": 2, "discard": 1}})
    file.write_text(dump_case(given), encoding="utf-8")
    keys = swept_keys(given, ["operation.torque=30 N*m,90 N*m"])
    swept = []
    for one in sweep_points(load_case(str(file)).source, keys):
        result = solve_point(one.case, None, code_digest())
        assert isinstance(result, PointResult), result
        load, point = result.document["load"], describe_machine(one.case).operating_point()
        (pair,), (expected,) = load["gear_pairs"], point.pairs
        assert pair["misalignment_taken_rad"] == pair["misalignment_rad"] == expected.misalignment
        for bearing in load["bearings"]:
            force = point.bearing(bearing["name"]).force[:2]
            assert bearing["force_n"][:2] == pytest.approx(force)
            mean = result.motion.bearing_force_mean[bearing["name"]][:2]
            assert mean == pytest.approx(force, abs=0.02 * float(np.hypot(*force)))
        swept.append(SweptPoint(one, result, resumed=False))
    data = collected_sweep(given, keys, swept)
    low, high = data["misalignment"].sel(loaded_pair="pinion -> wheel").values
    # Clearance takes up its part under the smallest load already, and Hertzian contact stiffens with the load.
    assert 1.0 < high / low < 3.0
    forces = data["bearing_operating_force"].sel(loaded_bearing="input right").values
    assert np.hypot(*forces[1, :2]) == pytest.approx(3.0 * np.hypot(*forces[0, :2]), rel=0.05)


def test_a_steady_motion_has_its_operating_point() -> None:
    """In its document, arrays and figures."""
    result = gw.build(**document()).steady()
    assert result.document["load"]["gear_pairs"][0]["misalignment_taken_from"] == "operating point"
    assert float(result.dataset["misalignment"][0]) == result.document["load"]["gear_pairs"][0]["misalignment_rad"]
    assert "load-misalignment" in [name for name, _ in result.figures()]


def test_an_analysis_whose_machine_has_no_operating_point_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the case gives all stiffness, it goes on; where bearings are left to the equilibrium, it needs one."""

    def none_found(*parts: Any) -> None:
        raise EquilibriumNotFoundError("no static equilibrium of the machine")

    monkeypatch.setattr("gearwhine.coupling.machine_description.solve_operating_point", none_found)
    changed = document(misalignment="0 rad")
    for bearing in changed["bearing"]:
        bearing["stiffness"] = {"matrix": np.diag([1e8, 1e8, 1e8, 1e5, 1e5]).tolist()}
    found, told = load_of_case(parse_case(changed).parts, describe_machine(parse_case(changed)))
    assert found is None
    assert told[0]["message"].startswith("no operating point is found")
    assert told[0]["message"].endswith(": no static equilibrium of the machine")
    with pytest.raises(EquilibriumNotFoundError):
        load_of_case(parse_case(document()).parts, describe_machine(parse_case(document()), None))
    idle = parse_case(document() | {"operation": {"speed": "1500 rpm", "torque": "0 N*m"}})
    assert load_of_case(idle.parts, describe_machine(idle)) == (None, [])


def test_a_bearing_without_any_load_is_refused(tmp_path: Path) -> None:
    """Without gear pairs nothing gives a bearing its load: the case names the key."""
    bare = document()
    for key in ("gear", "gear_pair", "operation"):
        del bare[key]
    with pytest.raises(CaseError, match=r"bearing\[0\]\.load.*the force of the shaft on it"):
        parse_case(bare)


TWO_WAYS = {"stiffness": {"matrix": np.diag([2e8, 2e8, 1e8, 0.0, 0.0]).tolist()}}
SPUR_DEFLECTION = 19.5e-6
ACROSS = {"stiffness": {"xx": "2e8 N/m", "yy": "2e8 N/m"}}


def typed(**pair: Any) -> dict[str, Any]:
    """The overhung pair on bearings of typed stiffness."""
    given = document()
    for bearing in given["bearing"]:
        bearing |= TWO_WAYS if bearing["name"].endswith("left") else ACROSS
    given["gear_pair"] = [{"driver": "pinion", "driven": "wheel"} | pair]
    return given


@pytest.mark.parametrize("given", [document, typed], ids=["rolling", "typed"])
def test_a_misalignment_left_out_is_that_of_the_equilibrium(given: Any) -> None:
    """With typed bearings as with rolling ones: motion takes the flanks as the machine stands, and `check` says so."""
    bare, named = given(), given()
    bare["gear_pair"][0].pop("misalignment", None)
    named["gear_pair"][0]["misalignment"] = "found"
    ((pair,), _), ((found,), _) = solve_pairs(parse_case(bare), None), solve_pairs(parse_case(named), None)
    assert pair.pair.face_gap == found.pair.face_gap != ()
    study = gw.build(**bare)
    load = study.operating_point()
    (told,) = load.document["gear_pairs"]
    assert told["misalignment_taken_from"] == "operating point"
    assert told["misalignment_taken_rad"] == told["misalignment_rad"] != 0.0
    assert not [one for one in load.document["warnings"] if one["name"] == "misalignment"]
    (checked,) = study.check().document["gear_pairs"]
    assert (checked["misalignment_from"], checked["misalignment_rad"]) == ("operating point", None)


def test_aligned_flanks_by_the_case_are_told_beside_what_is_found() -> None:
    """Above a tenth of the teeth's deflection over the face it is a warning, of every analysis of the machine."""
    study = gw.build(**typed(misalignment="0 rad"))
    for result in (study.operating_point(), study.system()):
        (entry,) = [one for one in result.document["warnings"] if one["name"] == "misalignment"]
        assert entry["given_rad"] == 0.0
    (pair,) = study.operating_point().document["gear_pairs"]
    deflection = pair["force_n"] / pair["mean_stiffness_n_per_m"]
    assert abs(entry["found_rad"]) * 20e-3 > 0.1 * deflection
    near = entry["found_rad"] + 0.09 * deflection / 20e-3
    nearly = gw.build(**typed(misalignment=near)).operating_point()
    assert "misalignment" not in [one["name"] for one in nearly.document.get("warnings", [])]


def test_the_library_takes_the_same_misalignment_as_the_case() -> None:
    """A pair of `gw.Machine` without one is as the machine stands; apart from a machine its flanks are aligned."""
    case = parse_case(typed())
    standing = about_operating_point(case)
    (pair,), coupled = standing.pairs, standing.coupled
    machine = describe_machine(case)
    bare = replace(machine, gear_pairs=[gw.GearPair("pinion", "wheel")])
    (same,) = bare.loaded_pairs()
    assert same.pair.face_gap == pair.pair.face_gap != ()
    (expected,), (contact,) = coupled.system.contacts, bare.assembled.system.contacts
    assert contact.contact.faces.gap == pytest.approx(expected.contact.faces.gap, rel=1e-9)
    assert gw.GearPair("pinion", "wheel").face_slices(pair.geometry, 1).gap == pytest.approx(0.0)


@pytest.mark.parametrize(("case", "torque"), [("helical-pair", 150.0), ("helical-pair", -150.0), ("spur-pair", 50.0)])
def test_gears_by_themselves_have_the_transmission_error_of_their_machine(case: str, torque: float) -> None:
    """Shafts of gears off their middle tilt: over the face, and against each other along the path of helical teeth."""
    helical = {"gear.*.at": "60 mm", "gear_pair.*.misalignment": "found"} if case == "helical-pair" else {}
    machine = gw.load(case, {**helical, "operation.torque": torque}).machine
    point = machine.operating_point()
    (load,), (pair,) = point.pairs, machine.with_flanks_of(point).loaded_pairs()
    assert (abs(load.path_slope) > 5e-5) == (case == "helical-pair")
    mesh = pair.static
    assert mesh.mean_transmission_error == pytest.approx(load.mean_transmission_error, rel=1e-9)
    assert mesh.peak_to_peak_transmission_error == pytest.approx(load.peak_to_peak_transmission_error, rel=1e-9)
    assert mesh.mean_mesh_stiffness == pytest.approx(load.mean_stiffness, rel=1e-9)


def test_a_gap_of_a_hundredth_of_the_teeth_deflection_is_none() -> None:
    """The largest gap of spur teeth that motion leaves out moves no harmonic of their transmission error by 0.01 dB."""
    aligned, tilted = (
        solve_pairs(gw.load("spur-pair", {"gear_pair.0.misalignment": angle}).case, None)[0][0]
        for angle in (0.0, 0.01 * SPUR_DEFLECTION / 6.35e-3)
    )
    deflection = aligned.static.force / aligned.static.mean_mesh_stiffness
    assert deflection == pytest.approx(SPUR_DEFLECTION, rel=0.1)
    phases = np.linspace(0.0, 1.0, 64, endpoint=False)
    harmonics = [
        np.abs(
            np.fft.rfft(loaded_transmission_error(pair.carrying_flanks, pair.static.force, phases).transmission_error)
        )
        for pair in (aligned, tilted)
    ]
    assert np.abs(20.0 * np.log10(harmonics[1][1:5] / harmonics[0][1:5])).max() < 0.01


def test_flanks_are_aligned_where_nothing_holds_the_machine() -> None:
    """One bearing across each shaft and none against tilting: no equilibrium, but a motion; and it says so."""
    given = typed()
    for gear in given["gear"]:
        gear["helix_angle"] = "0 deg"
    given["rotor"][1]["axis"] = ["72.5 mm", "0 m"]
    given["bearing"] = [bearing | ACROSS for bearing in given["bearing"] if bearing["name"].endswith("left")]
    case = parse_case(given)
    load, (entry,) = load_of_case(case.parts, describe_machine(case))
    assert load is None
    assert entry["message"].endswith("; the misalignment of gear pair 'pinion' -> 'wheel' is taken as 0")
    (pair,), _ = solve_pairs(case, None)
    assert (pair.pair.misalignment, pair.pair.face_gap) == (0.0, ())
    with pytest.warns(UserWarning, match="flanks are taken as aligned, as the machine has no operating point: .*"):
        _ = describe_machine(case).assembled
    with pytest.raises(EquilibriumNotFoundError):
        solve_pairs(parse_case(given | {"gear_pair": [given["gear_pair"][0] | {"misalignment": "found"}]}), None)


@pytest.mark.slow
def test_check_and_gears_say_which_misalignment_they_take(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """`check` solves nothing; `gears` finds it in rigid seats where it is left to the operating point."""
    # Seconds of search for the best relief, of which nothing is asked.
    monkeypatch.setattr("gearwhine.analyses.machine_results.solve_over_torques", lambda pairs, *_, **__: pairs)
    file = tmp_path / "case.toml"
    bare = document()
    for angle, command, expected in (
        ("found", "check", "misalignment left to the operating point; `gearwhine load` finds it"),
        (None, "check", "misalignment left to the operating point; `gearwhine load` finds it"),
        ("0.2 mrad", "check", "misalignment of 200 µrad taken, as the case gives it\n"),
        ("found", "gears", "µrad and the curvature of the flank gap taken, as the operating point has them"),
        ("0.2 mrad", "gears", "Misalignment of 200 µrad taken, as the case gives it; `gearwhine load` has"),
    ):
        bare["gear_pair"][0].pop("misalignment", None)
        bare["gear_pair"][0] |= {} if angle is None else {"misalignment": angle}
        file.write_text(dump_case(parse_case(bare)), encoding="utf-8")
        assert run_command([command, str(file), "-q", *["--verbose"] * (command == "check")]) == 0
        assert expected in capsys.readouterr().out
    # Beside a housing, which `gears` does not solve, it says whose misalignment it is.
    assert (
        run_command(
            [
                "gears",
                "small-gearbox",
                "-q",
                "--set",
                "gear_pair.0.misalignment=found",
                "-o",
                str(tmp_path / "out"),
                "--json",
            ]
        )
        == 0
    )
    (pair,) = json.loads(capsys.readouterr().out)["pairs"]
    assert (pair["misalignment_from"], pair["misalignment_seats"]) == ("operating point", "rigid")


def test_a_misalignment_is_an_angle_or_found() -> None:
    """Another word is refused with what would do."""
    with pytest.raises(CaseError, match=r"misalignment.*or \"found\""):
        parse_case(document(misalignment="some"))


def set_against_each_other(**more: Any) -> dict[str, Any]:
    """One shaft without gears on two rows in angular contact, the left one's ring displaced by 20 um."""
    size = {"type": "angular-contact", "bore": "35 mm", "outer_diameter": "72 mm", "width": "17 mm"}
    rolling = {"catalogue": size, "axial_offset": "20 um"}, {"catalogue": size, "carries": "-z"}
    return {
        "material": {"steel": {"youngs_modulus": "206 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}},
        "rotor": [{"name": "shaft", "material": "steel", "segments": [{"length": "200 mm", "diameter": "35 mm"}]}],
        "bearing": [
            {"name": name, "rotor": "shaft", "at": at, "stiffness": {"rolling": one}}
            for name, at, one in zip(("left", "right"), ("20 mm", "180 mm"), rolling, strict=True)
        ],
        **more,
    }


def test_an_offset_loads_both_bearings_of_a_shaft_without_gears() -> None:
    """Rows and shaft in series, all of 20 um; neither row has a load of its own in the case."""
    still = {"operation": {"speed": "1000 rpm", "torque": "0 N*m"}}
    (solved,) = solve_rotors(parse_case(set_against_each_other(**still)))
    left, right = (solved.rolling[name] for name in ("left", "right"))
    force = left.reaction[2]
    assert right.reaction[2] == pytest.approx(-force)
    row, held = left.bearing.rows[0], dict.fromkeys(("x", "y", "rx", "ry"), 0.0)
    alone = RollingBearing([replace(row, axial_offset=0.0)])
    deep = rolling_equilibrium(alone, [0.0, 0.0, force, 0.0, 0.0], held=held).displacement[2]
    shaft = force * 0.16 / (206e9 * math.pi / 4.0 * 0.035**2)
    assert 2.0 * deep + shaft == pytest.approx(20e-6, rel=1e-6)
    with pytest.raises(CaseError, match="a rolling bearing without preload has no stiffness"):
        parse_case(set_against_each_other())


@pytest.mark.slow
def test_gears_takes_the_housing_that_stands_in_its_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its best relief is then of the gap that `load` finds; without modes it is that of rigid seats, and it says so."""
    monkeypatch.setattr("gearwhine.analyses.machine_results.solve_over_torques", lambda pairs, *_, **__: pairs)
    changes = {"housing.box.mesh_size": "60 mm", "gear.*.at": "40 mm"}
    study = gw.load("small-gearbox", changes)
    (rigid,) = study.gears().document["pairs"]
    assert rigid["misalignment_seats"] == "rigid"
    study.modes().write(tmp_path)
    stood = gw.load("small-gearbox", changes, folder=tmp_path).gears().document
    kept = study.gears().document
    (found,) = study.operating_point().document["gear_pairs"]
    for document in (stood, kept):
        (pair,) = document["pairs"]
        assert pair["misalignment_seats"] == "housing"
        assert pair["misalignment_rad"] == pytest.approx(found["misalignment_rad"], rel=1e-6)
        assert "rigid seats" not in [entry["name"] for entry in document.get("warnings", ())]
    assert abs(rigid["misalignment_rad"] - found["misalignment_rad"]) > 0.02 * abs(found["misalignment_rad"])


def test_a_bearing_in_a_turning_shaft_lives_by_the_relative_speed() -> None:
    """24 teeth of the sun and 90 of the held ring: the carrier turns with 24/114 of the sun's 3000 rpm."""
    size = {"type": "deep-groove", "bore": "20 mm", "outer_diameter": "42 mm", "width": "12 mm"}
    changes = {"seat": "carrier", "at": "110 mm", "stiffness": {"rolling": {"catalogue": size}}, "damping": ""}
    case = gw.load("planetary-stage", {f"bearing.sun inner.{key}": value for key, value in changes.items()}).case
    lives = {name: life for rotor in solve_rotors(case, mode_count=2) for name, life in rotor.lives.items()}
    assert lives["sun inner"].speed == pytest.approx(100.0 * math.pi * (1.0 - 24.0 / 114.0))
