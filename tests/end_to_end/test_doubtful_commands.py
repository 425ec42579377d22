"""What commands refuse, or warn of, where a case can be solved but means nothing."""

import json
from pathlib import Path

import pytest

from gearwhine.cli import run_command

RADIAL = 'bearing.{}.stiffness={{ xx = "2e8 N/m", yy = "2e8 N/m" }}'
UNDAMPED = 'bearing.{}.damping={{ xx = "800 N*s/m", yy = "800 N*s/m" }}'


@pytest.mark.parametrize("command", ["check", "system", "run", "steady"])
def test_thrust_that_no_bearing_carries_is_refused_by_every_command(
    command: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    changes = [part for text in (RADIAL, UNDAMPED) for i in (0, 2) for part in ("--set", text.format(i))]
    assert run_command([command, "helical-pair", "-q", "-o", str(tmp_path / "out"), *changes]) == 2
    told = capsys.readouterr().err
    assert told.startswith("gearwhine: helical-pair.toml: rotor ")
    assert "'pinion' push it along its axis with 1125 N" in told
    assert "'wheel' push it along its axis with 1125 N" in told
    assert "Traceback" not in told


def test_check_refuses_a_load_that_the_rolling_bearing_cannot_carry(
    capsys: pytest.CaptureFixture[str],
) -> None:
    changes = [
        'bearing.0.stiffness={ rolling = { catalogue = { type = "deep-groove", bore = "35 mm", '
        'outer_diameter = "72 mm", width = "17 mm" } } }',
        'bearing.0.load={ x = "90 kN", y = 0 }',
    ]
    settings = [part for change in changes for part in ("--set", change)]
    told = []
    for command in ("rotors", "check"):
        assert run_command([command, "spur-pair", "-q", *settings]) == 2
        told.append(capsys.readouterr().err)
    assert told[0] == told[1]


@pytest.fixture
def whirling() -> list[str]:
    """Cross-coupled bearings that feed the whirl of both shafts of the spur pair."""
    stiffness = 'bearing.{}.stiffness={{ xx = "1e8 N/m", yy = "1e8 N/m", xy = "1e7 N/m", yx = "-1e7 N/m" }}'
    return [part for i in range(4) for part in ("--set", stiffness.format(i))]


def test_growing_coupled_modes_are_warned_of(whirling: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["system", "spur-pair", "-q", "--json", *whirling]) == 0
    told = capsys.readouterr()
    document = json.loads(told.out)
    growing = [entry for entry in document["warnings"] if entry["name"] == "unstable mode"]
    assert growing
    assert growing[0]["damping_ratio"] < 0.0
    # The same mode as in the list of modes.
    assert any(
        mode["damping_ratio"] == pytest.approx(growing[0]["damping_ratio"], rel=1e-9)
        and mode["frequency_hz"] == pytest.approx(growing[0]["frequency_hz"], rel=1e-9)
        for mode in document["modes"]
    )
    assert f"{growing[0]['frequency_hz']:.5g} Hz has the damping ratio" in told.err


def test_a_motion_that_teeth_cannot_follow_is_refused(
    whirling: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run_command(["run", "spur-pair", "-q", "--no-pictures", "-o", str(tmp_path / "out"), *whirling]) == 2
    told = capsys.readouterr().err
    assert "are pressed together by" in told
    assert "mm at most" in told
    assert "Traceback" not in told


def test_steady_motions_of_an_unstable_machine_warn(
    whirling: list[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run_command(["steady", "spur-pair", "-q", "--json", *whirling]) == 0
    told = capsys.readouterr()
    assert any(entry["name"] == "unstable mode" for entry in json.loads(told.out)["warnings"])
    assert "motions of this machine mean nothing beyond its onset" in told.err


@pytest.mark.slow
@pytest.mark.usefixtures("swept_here")
@pytest.mark.parametrize("command", ["run", "sweep"])
def test_a_load_that_the_bearing_does_not_carry_is_warned_of(
    command: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """100 N written for a bearing that carries its share of 1718 N."""
    changes = [
        'bearing.0.stiffness={ rolling = { catalogue = { type = "deep-groove", bore = "35 mm", '
        'outer_diameter = "72 mm", width = "17 mm" } } }',
        'bearing.0.load={ x = "0 N", y = "100 N" }',
        "transient.revolutions=3",
        "transient.discard=2",
    ]
    settings = [part for change in changes for part in ("--set", change)]
    more = ["--no-pictures"] if command == "run" else ["--workers", "1", "--over", "operation.speed=3000 rpm"]
    folder = tmp_path / "out"
    assert run_command([command, "spur-pair", "-q", "--json", "-o", str(folder), *more, *settings]) == 0
    document = json.loads(capsys.readouterr().out)
    warned = [entry for entry in document["warnings"] if entry["name"] == "bearing load"]
    assert warned
    assert "100 N radial" in warned[0]["message"]
