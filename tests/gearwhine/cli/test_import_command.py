"""The front doors to REXS files: `gearwhine import`, `check` on such a file, and `gw.load`."""

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest
from rexs_files import helical_stage, planetary_stage

import gearwhine as gw
from gearwhine.case import load_case
from gearwhine.cli import run_command


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "unit.rexs").write_bytes(helical_stage().xml())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def printed(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    assert run_command([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)  # type: ignore[no-any-return]


def test_a_case_is_written_beside_the_report_of_what_was_assumed(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(["import", "unit.rexs"]) == 0
    shown = capsys.readouterr().out
    for words in ("REXS 1.4", "load case 2: 30 % of the time", "no profile shift", "left out: lubricant", "unit.toml"):
        assert words in shown
    loaded = load_case(folder / "unit.toml")
    assert loaded.case == load_case(folder / "unit.rexs").case
    assert sorted(path.name for path in folder.iterdir()) == ["unit.rexs", "unit.toml"]


def test_another_load_case_and_another_place(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    document = printed(capsys, "import", "unit.rexs", "-o", "made/second.toml", "--load-case", "2")
    assert document["files"] == ["second.toml"]
    assert document["imported"]["load_cases"][0].startswith("load case 2")
    assert {note["kind"] for note in document["imported"]["notes"]} == {"assumed", "changed", "left out"}
    assert document["case"] == "made/second.toml"
    written = tomllib.loads((folder / "made" / "second.toml").read_text(encoding="utf-8"))
    assert document["taken"] == {kind: len(table) for kind, table in written.items() if isinstance(table, list)}
    assert any(one["component"].startswith("lubricant") for one in document["left_out"])
    assert any("no profile shift" in one["why"] for one in document["assumed"])
    for one in document["assumed"]:
        assert one.keys() == {"key", "value", "why"}
        assert one["key"] or one["value"] is None
    operation = load_case(folder / "made" / "second.toml").case.operation
    assert operation is not None
    assert operation.torque == 40.0


def test_nothing_that_stands_there_is_replaced(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "unit.toml").write_text("mine")
    assert run_command(["import", "unit.rexs"]) == 2
    assert "a place where no file of that name stands yet" in capsys.readouterr().err
    (folder / "link.toml").symlink_to(folder / "nowhere")
    assert run_command(["import", "unit.rexs", "-o", "link.toml"]) == 2
    assert (folder / "unit.toml").read_text() == "mine"
    assert not (folder / "nowhere").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["unit.toml"], "a REXS file, which ends in .rexs"),
        (["absent.rexs"], "an existing file"),
        (["unit.rexs", "-o", "unit.txt"], "a case file, which ends in .toml"),
        (["unit.rexs", "--load-case", "9"], "load_spectrum: expected a load case among 1, 2, got '9'"),
    ],
)
def test_wrong_arguments_are_refused(arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["import", *arguments]) == 2
    assert said in " ".join(capsys.readouterr().err.split())


def test_a_wrong_file_is_refused_by_its_component_and_writes_nothing(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = helical_stage()
    del file.named("pinion")["normal_module"]
    (folder / "unit.rexs").write_bytes(file.xml())
    for command in (["import", "unit.rexs"], ["check", "unit.rexs"]):
        assert run_command(command) == 2
        said = capsys.readouterr().err
        assert 'unit.rexs: cylindrical_gear 11 "pinion": expected the attribute normal_module' in said
    assert [path.name for path in folder.iterdir()] == ["unit.rexs"]


def test_a_case_that_cannot_be_solved_yet_is_written_and_says_what_it_lacks(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = helical_stage()
    file.named("wheel")["helix_angle_reference_diameter"] = (-15.0, "deg")
    (folder / "unit.rexs").write_bytes(file.xml())
    assert run_command(["import", "unit.rexs"]) == 2
    said = capsys.readouterr().err
    assert "unit.toml is written; it is to be completed" in said
    assert "opposite hands" in said
    assert (folder / "unit.toml").is_file()


def test_check_says_what_it_understood(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["check", "unit.rexs"]) == 0
    shown = capsys.readouterr()
    assert "from unit.rexs (REXS 1.4, written by Test 1.2 on 2024-05-06)" in shown.out
    assert "no profile shift" in shown.out
    assert "warning: imported from unit.rexs (REXS 1.4" in shown.err
    document = printed(capsys, "check", "unit.rexs", "--set", "operation.speed=2000 rpm")
    (pair,) = document["gear_pairs"]
    assert pair["ratio"] == pytest.approx(59 / 20)
    assert document["operation"]["speed_rpm"] == pytest.approx(2000.0)
    assert document["imported"]["origin"].startswith("unit.rexs (REXS 1.4")


def test_a_file_is_loaded_as_a_study_that_can_be_changed(folder: Path) -> None:
    (folder / "set.rexsj").write_bytes(planetary_stage().json())
    study = gw.load("set.rexsj")
    assert study.warnings[0].startswith("imported from set.rexsj (REXS 1.7")
    checked = study.check().document
    assert checked["planetary"][0]["name"] == "set"
    faster = study.changed({"operation.speed": "1200 rpm"})
    assert faster.case.operation is not None
    assert faster.case.operation.speed == pytest.approx(40.0 * 3.141592653589793)
    assert faster.check().document["imported"] == checked["imported"]
