"""A rotor of a case from a file of ROSS: what of the case still counts, what is refused, what is written."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from gearwhine.case import CaseError, dump_case, load_case, parse_case
from gearwhine.cli import run_command
from gearwhine.results.check import check_document, sections
from gearwhine.rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial, read_ross, write_ross

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
    rotor, bearings = case.parts.rotors[0], case.parts.bearings_on("input")
    assert rotor.name == "input"
    assert rotor.segments == read_ross(folder / "fan.toml").rotor.segments
    assert rotor.discs == (*ROTOR.discs, Disc(0.25, 2.0))
    assert bearings == BEARINGS
    assert case.rotor[0].length == pytest.approx(1.0)
    notes = [section.note.strip() for section in sections(check_document(case)) if section.title == "bearings"]
    assert notes == ["left: input on ground"]


def test_a_bearing_of_the_same_name_and_rotor_takes_the_place_of_the_files(folder: Path) -> None:
    own = {"name": "left", "rotor": "input", "at": "10 mm", "stiffness": {"xx": 5e6, "yy": 5e6}}
    case = parse_case(entry() | {"bearing": [own]}, folder=folder)
    assert [(bearing.name, bearing.at) for bearing in case.parts.bearings_on("input")] == [
        ("right", 1.0),
        ("left", 0.01),
    ]


def test_a_resolved_case_reads_back_alike(folder: Path) -> None:
    case = parse_case(entry(mass="lumped", damping_ratio=0.01), folder=folder)
    written = tomllib.loads(dump_case(case))
    assert "segments" not in written["rotor"][0]
    again = parse_case(written)
    assert again == case
    assert again.parts.rotors[0].mass_model == "lumped"


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


ALUMINIUM = ShaftMaterial(70e9, 26.3e9, 2700.0)
STEEL_TABLE = {"youngs_modulus": "210 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}
ON_THE_SHAFT = {
    "gear": {"name": "g", "rotor": "input", "teeth": 40, "module": "4 mm", "face_width": "40 mm", "bore": "50 mm"},
    "disc": {"width": "40 mm", "diameter": "160 mm", "bore": "50 mm"},
}


def on_two_metals(folder: Path, kind: str, at: str, **more: object) -> dict:
    """A gear or a disc on a shaft of aluminium up to 0.5 m, of steel beyond; the case has a material, too."""
    assert write_ross(folder / "fan.toml", Rotor("fan", [Segment(0.5, 0.05, 0.0, m) for m in (ALUMINIUM, STEEL)])) == ()
    part = ON_THE_SHAFT[kind] | {"at": at} | more
    parts = {"gear": [part]} if kind == "gear" else {}
    return {"material": {"rail": STEEL_TABLE}} | entry(**({} if parts else {"discs": [part]})) | parts


@pytest.mark.parametrize("kind", ["gear", "disc"])
@pytest.mark.parametrize(("at", "material"), [("250 mm", ALUMINIUM), ("750 mm", STEEL)])
def test_parts_on_a_files_shaft_are_of_its_material_there(
    kind: str, at: str, material: ShaftMaterial, folder: Path
) -> None:
    case = parse_case(on_two_metals(folder, kind, at), folder=folder)
    (disc,) = case.parts.rotors[0].discs
    # A gear's blank is a cylinder between its pitch circle of 160 mm and the bore, as the disc is.
    assert disc.mass == pytest.approx(material.density * np.pi / 4.0 * (0.16**2 - 0.05**2) * 0.04)
    if kind == "gear":
        gear = case.parts.gears[case.gear[0].name]
        assert gear.youngs_modulus == pytest.approx(material.youngs_modulus)
        assert gear.poisson_ratio == pytest.approx(material.youngs_modulus / material.shear_modulus / 2.0 - 1.0)


@pytest.mark.parametrize(("kind", "key"), [("gear", "gear[0].material"), ("disc", "rotor[0].discs[0].material")])
def test_where_two_materials_of_a_file_meet_one_is_asked_for(kind: str, key: str, folder: Path) -> None:
    with pytest.raises(CaseError) as raised:
        parse_case(on_two_metals(folder, kind, "500 mm"), folder=folder)
    (problem,) = raised.value.problems
    assert problem.key == key
    assert "its file has not one that a solid can have at 500 mm" in problem.expected
    case = parse_case(on_two_metals(folder, kind, "500 mm", material="rail"), folder=folder)
    (disc,) = case.parts.rotors[0].discs
    assert disc.mass == pytest.approx(7850.0 * np.pi / 4.0 * (0.16**2 - 0.05**2) * 0.04)


def test_a_rotors_own_material_is_that_of_parts_on_its_files_shaft(folder: Path) -> None:
    given = on_two_metals(folder, "gear", "250 mm")
    given["rotor"][0]["material"] = "rail"
    case = parse_case(given, folder=folder)
    assert case.parts.gears[case.gear[0].name].youngs_modulus == 210e9


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
