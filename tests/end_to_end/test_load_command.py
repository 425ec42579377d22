"""`gearwhine load` on a gearbox with its housing: files, JSON and the report."""

import json
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from gearwhine.cli import run_command
from gearwhine.output.manifest import opened_dataset


@pytest.mark.slow
def test_options_of_one_folder_keep_each_others_results(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"

    def load(*options: str, case: str = "spur-pair") -> dict[str, Any]:
        assert run_command(["load", case, "-q", "--json", "-o", str(out), *options]) == 0
        document: dict[str, Any] = json.loads(capsys.readouterr().out)
        assert json.loads((out / "summary.json").read_text(encoding="utf-8")) == document
        assert all((out / name).is_file() for name in document["files"])
        return document

    first = load("--sensitivity")
    with opened_dataset(out / "results.nc") as data:
        influences = data["misalignment_change"].load()
    second = load("--over-torque")
    assert second["sensitivity"] == first["sensitivity"]
    assert second["kept"] == ["sensitivity"]
    assert "load-over-torque.png" in second["files"]
    with opened_dataset(out / "results.nc") as data:
        xr.testing.assert_identical(data["misalignment_change"].load(), influences)
        assert data["misalignment_over_torque"].dims == ("load_torque", "loaded_pair")
    third = load()
    assert third["kept"] == ["over_torque", "sensitivity"]
    assert (third["over_torque"], third["sensitivity"]) == (second["over_torque"], first["sensitivity"])
    assert set(third["files"]) == set(second["files"])
    with opened_dataset(out / "results.nc") as data:
        xr.testing.assert_identical(data["misalignment_change"].load(), influences)
        assert data["misalignment_over_torque"].notnull().all()
    assert run_command(["report", "spur-pair", "-q", "-o", str(out)]) == 0
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "Over torque" in page
    assert "Change by a step of one parameter" in page
    assert "Misalignment, K_Hβ, mesh stiffness and transmission error over the torque." in page
    capsys.readouterr()
    # Another equilibrium has none of it: one of other numbers, or of another case.
    summary = out / "summary.json"
    summary.write_text(json.dumps(third | {"shafts": []}), encoding="utf-8")
    assert not {"kept", "sensitivity", "over_torque"} & set(load())
    load("--over-torque")
    other = load("--set", "operation.torque=50 N*m")
    assert not {"kept", "sensitivity", "over_torque"} & set(other)
    assert "load-over-torque.png" not in {path.name for path in out.iterdir()}


def test_rigid_seats_leave_the_housing_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The same equilibrium as of the case without a housing; no housing is solved for it."""
    out = tmp_path / "out"
    assert run_command(["load", "small-gearbox", "-q", "--json", "--rigid-seats", "-o", str(out)]) == 0
    rigid = json.loads(capsys.readouterr().out)
    assert rigid["seats"] == "rigid"
    assert all(bearing["seat_displacement_m"] == [0.0, 0.0, 0.0] for bearing in rigid["bearings"])
    assert not {"modes.nc", "load-housing.png"} & {path.name for path in out.iterdir()}
    bare = ("--set", "housing=", "--set", "bearing.*.seat=ground")
    assert run_command(["load", "small-gearbox", "-q", "--json", *bare]) == 0
    alone = json.loads(capsys.readouterr().out)
    assert [one["force_n"] for one in rigid["bearings"]] == [one["force_n"] for one in alone["bearings"]]
    assert rigid["gear_pairs"] == alone["gear_pairs"]


def test_a_folder_is_reported_without_its_case(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert run_command(["load", "spur-pair", "-q", "-o", str(out)]) == 0
    assert run_command(["report", str(out), "-q"]) == 0
    assert "report.html" in capsys.readouterr().out
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "2 shafts, 4 bearings and 1 gear pair" in page
    assert "Operating point" in page
    assert "Does not fit" not in page
    assert run_command(["report", str(tmp_path)]) == 2
    told = capsys.readouterr().err
    assert "what is asked for cannot be used as it stands" in told
    assert f"as `gearwhine run CASE -o {tmp_path}` leaves it" in told
    assert run_command(["report", str(out), "-o", str(tmp_path / "other")]) == 2
    assert "none beside the results folder" in capsys.readouterr().err
