"""A rotor of a case from a file of ROSS: what of the case still counts, what is refused, what is written."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from gearwhine.case import CaseError, dump_case, load_case, parse_case
from gearwhine.cli import run_command
from gearwhine.from_case.rotors import build_bearings, build_rotor
from rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial, read_ross, write_ross

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
ROTOR = Rotor("fan", [Segment(0.5, 0.05, 0.0, STEEL), Segment(0.5, 0.06, 0.02, STEEL)], [Disc(0.5, 20.0, 0.4, 0.22)])
BEARINGS = (Bearing("left", 0.0, np.diag([1e7, 8e6]), np.diag([300.0, 200.0])), Bearing.isotropic("right", 1.0, 2e7))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """With a rotor's file in it."""
    assert write_ross(tmp_path / "fan.toml", ROTOR, BEARINGS) == ()
    return tmp_path


def entry(**more: object) -> dict:
    return {"rotor": [{"name": "input", "file": "fan.toml"} | more]}


def test_shaft_discs_and_bearings_are_those_of_the_file(folder: Path) -> None:
    case = parse_case(entry(discs=[{"at": "250 mm", "mass": "2 kg"}]), folder=folder)
    rotor, bearings = build_rotor(case, case.rotor[0]), build_bearings(case, "input")
    assert rotor.name == "input"
    assert rotor.segments == read_ross(folder / "fan.toml").rotor.segments
    assert rotor.discs == (*ROTOR.discs, Disc(0.25, 2.0))
    assert bearings == BEARINGS
    assert case.rotor[0].length == pytest.approx(1.0)


def test_a_bearing_of_the_same_name_and_rotor_takes_the_place_of_the_files(folder: Path) -> None:
    own = {"name": "left", "rotor": "input", "at": "10 mm", "stiffness": {"xx": 5e6, "yy": 5e6}}
    case = parse_case(entry() | {"bearing": [own]}, folder=folder)
    assert [(bearing.name, bearing.at) for bearing in build_bearings(case, "input")] == [("right", 1.0), ("left", 0.01)]


def test_a_resolved_case_reads_back_alike(folder: Path) -> None:
    case = parse_case(entry(mass="lumped", damping_ratio=0.01), folder=folder)
    written = tomllib.loads(dump_case(case))
    assert "segments" not in written["rotor"][0]
    again = parse_case(written)
    assert again == case
    assert build_rotor(again, again.rotor[0]).mass_model == "lumped"


def test_what_a_file_holds_and_a_rotor_does_not_is_a_warning(folder: Path) -> None:
    text = (folder / "fan.toml").read_text(encoding="utf-8").replace("beta = 0.0", "beta = 1e-6")
    (folder / "fan.toml").write_text(text, encoding="utf-8")
    (folder / "case.toml").write_text('[[rotor]]\nname = "input"\nfile = "fan.toml"\n', encoding="utf-8")
    (said,) = load_case(folder / "case.toml").warnings
    assert said.startswith('rotor "input": fan.toml: ShaftElement_Shaft Element 0 and ')
    assert said.endswith("beta is 1e-06; the shaft's internal damping is left out")


@pytest.mark.parametrize(
    ("change", "key", "said"),
    [
        ({"segments": [{"length": 1.0, "diameter": 0.05}]}, "rotor[0].segments", "no such key beside file"),
        ({"shear_coefficient": "cowper"}, "rotor[0].shear_coefficient", "no such key beside file"),
        ({"file": "none.toml"}, "rotor[0].file", "an existing file"),
        ({"discs": [{"at": "1.1 m", "mass": "1 kg"}]}, "rotor[0].discs[0].at", "which is 1000 mm long"),
        (
            {"file": "broken.toml"},
            "rotor[0].file",
            "a rotor saved by ROSS (broken.toml: ShaftElement_Shaft Element 0.odl is 'x'",
        ),
    ],
)
def test_what_is_wrong_is_named(change: dict, key: str, said: str, folder: Path) -> None:
    text = (folder / "fan.toml").read_text(encoding="utf-8")
    (folder / "broken.toml").write_text(text.replace("odl = 0.05", 'odl = "x"', 1), encoding="utf-8")
    with pytest.raises(CaseError) as raised:
        parse_case(entry(**change), folder=folder)
    (problem,) = raised.value.problems
    assert problem.key == key
    assert said in problem.expected


def test_without_file_and_segments_a_rotor_is_told_of_both() -> None:
    for given, key in (({}, "material"), ({"material": "steel"}, "segments")):
        with pytest.raises(CaseError, match=f"{key} .* expected .*, or a rotor's file instead, got nothing"):
            parse_case({"rotor": [{"name": "a"} | given]})


def test_a_rotors_file_stands_for_a_case_and_is_written_again(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = folder / "out"
    command = ["rotors", str(folder / "fan.toml"), "--write-ross", "--json", "-q", "-o", str(out)]
    assert run_command(command) == 0
    document = json.loads(capsys.readouterr().out)
    (rotor,) = document["rotors"]
    assert rotor["name"] == "fan"
    assert rotor["mass_kg"] == pytest.approx(ROTOR.mass)
    assert rotor["certificate"]["complete"]
    assert "fan.ross.toml" in document["files"]
    again, bearings, _ = read_ross(out / "fan.ross.toml")
    assert again.mass == pytest.approx(ROTOR.mass)
    assert bearings == BEARINGS


def test_a_broken_file_is_the_users_to_mend(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "fan.toml").write_text('ross_version = "2.3.0"\n[DiskElement_d]\nn = 0\n', encoding="utf-8")
    assert run_command(["rotors", str(folder / "fan.toml")]) == 2
    assert "fan.toml: no ShaftElement; expected a rotor with a shaft" in capsys.readouterr().err
