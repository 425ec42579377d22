"""`gearwhine export CASE --rexs FILE`: a gear unit's file, with the operating point that stands in OUT."""

import json
from pathlib import Path
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.case import load_case
from gearwhine.cli import run_command
from gearwhine.exchange.rexs import RexsModel, read_rexs


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def printed(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    assert run_command([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)  # type: ignore[no-any-return]


def torque_in(model: RexsModel) -> float:
    (load,) = (one for one in model.of_kind("external_load") if one.flag("defines_torque"))
    return load.required("torque_around_u_axis", "N*m")


def test_a_case_is_written_with_what_the_schema_does_not_hold(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["export", "spur-pair", "--rexs", "unit.rexs"]) == 0
    shown = capsys.readouterr().out
    for words in ("REXS 1.7", "without an operating point", 'left out: rotor "input": unbalance', "unit.rexs"):
        assert words in shown
    assert [path.name for path in folder.iterdir()] == ["unit.rexs"]
    assert load_case("unit.rexs").case.gear[0].tip_relief == load_case("spur-pair").case.gear[0].tip_relief


def test_settings_are_of_the_case_that_is_written(capsys: pytest.CaptureFixture[str]) -> None:
    document = printed(capsys, "export", "spur-pair", "--rexs", "made/unit.rexs", "--set", "operation.torque=40 N*m")
    assert document["files"] == ["unit.rexs"]
    assert {"kind": "left out", "about": 'rotor "input"', "text": "unbalance"} in document["rexs"]["notes"]
    assert torque_in(read_rexs("made/unit.rexs")) == pytest.approx(40.0, rel=1e-14)


def test_an_operating_point_is_taken_from_the_results_of_this_very_case(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["load", "spur-pair", "-o", "out", "-q"]) == 0
    capsys.readouterr()
    document = printed(capsys, "export", "spur-pair", "--rexs", "unit.rexs", "-o", "out")
    assert document["rexs"]["load_case"]
    assert len(read_rexs("unit.rexs").load_cases) == 1
    assert printed(capsys, "export", "out", "--rexs", "of-folder.rexs")["rexs"]["load_case"]
    other = printed(capsys, "export", "spur-pair", "--rexs", "2.rexs", "-o", "out", "--set", "operation.torque=40 N*m")
    assert not other["rexs"]["load_case"]
    assert not read_rexs("2.rexs").load_cases
    study = gw.load("spur-pair")
    assert {note.text for note in study.export_rexs("3.rexs", "out")} >= {"unbalance", "damping"}
    assert len(read_rexs("3.rexs").load_cases) == 1


def test_nothing_that_stands_there_is_replaced(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "unit.rexs").write_text("mine")
    assert run_command(["export", "spur-pair", "--rexs", "unit.rexs"]) == 2
    assert "a place where no file of that name stands yet" in capsys.readouterr().err
    assert (folder / "unit.rexs").read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["steel-box", "--rexs", "unit.rexs"], "'export --rexs' needs [[gear]], which this case does not have"),
        (["gear-62-62", "--rexs", "unit.rexs"], "'export --rexs' needs [[rotor]], which this case does not have"),
        (["spur-pair", "--rexs", "unit.xml"], "the name of a REXS file, which ends in .rexs"),
        (["spur-pair", "--rexs", "unit.rexs", "--csv"], "no other format beside it"),
        ([".", "--rexs", "unit.rexs"], "a case, or a folder with results of one"),
    ],
)
def test_what_cannot_be_written_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], said: str
) -> None:
    assert run_command(["export", *arguments]) == 2
    assert said in capsys.readouterr().err
    assert not list(folder.iterdir())
