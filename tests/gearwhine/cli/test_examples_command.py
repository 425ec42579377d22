"""`gearwhine examples`: the bundled cases, and a copy of one to change."""

import json
from importlib.resources import files
from pathlib import Path

import pytest

from gearwhine.cli import run_command


def test_a_copied_example_is_the_bundled_file_and_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run_command(["examples", "--json"]) == 0
    names = {example["name"] for example in json.loads(capsys.readouterr().out)["examples"]}
    assert {"nasa-gear-noise-rig", "small-gearbox", "steel-box", "friswell-rotor", "gear-62-62", "spur-pair"} <= names
    assert run_command(["examples", "copy", "spur-pair"]) == 0
    assert "spur-pair.toml" in capsys.readouterr().out
    bundled = files("gearwhine.cases").joinpath("spur-pair.toml").read_bytes()
    assert (tmp_path / "spur-pair.toml").read_bytes() == bundled
    assert run_command(["check", "spur-pair.toml"]) == 0
    (tmp_path / "spur-pair.toml").write_text("mine", encoding="utf-8")
    assert run_command(["examples", "copy", "spur-pair"]) == 2  # it would overwrite
    assert (tmp_path / "spur-pair.toml").read_text(encoding="utf-8") == "mine"
    assert run_command(["examples", "copy", "spur-pair", "-o", "there"]) == 0
    assert [str(path) for path in sorted(Path().rglob("*.toml"))] == ["spur-pair.toml", "there/spur-pair.toml"]
