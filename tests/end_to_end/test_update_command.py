"""`gearwhine update` on a small housing whose secret is known, from the command line to the file it writes."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from gearwhine.case import load_case
from gearwhine.solve import updating

SECRET = {"top": 10.5e-3, "front": 15e-3}
CASE = """
title = "a box with a secret"

[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"

[housing]
material = "steel"
frequency_limit = "5 kHz"

[housing.box]
size = ["200 mm", "160 mm", "240 mm"]
wall = "13 mm"
mesh_size = "50 mm"
feet = { size = ["40 mm", "20 mm", "40 mm"] }

[[housing.seat]]
name = "front seat"
center = ["10 mm", "80 mm", "120 mm"]
diameter = "50 mm"

[[housing.seat]]
name = "back seat"
center = ["0 mm", "85 mm", "-120 mm"]
diameter = "50 mm"

[[housing.support]]
name = "foot 1"
surface = "foot-1"
fixed = ["x", "y", "z"]

[[housing.support]]
name = "foot 2"
surface = "foot-2"
fixed = ["x", "y", "z"]

[update]
mesh_size = "54 mm"
modes = 24
gap = 0.0
frequency_noise = 0.002

[[update.parameter]]
name = "top"
keys = ["housing.box.wall.top"]
range = ["8 mm", "20 mm"]
spread = "3 mm"

[[update.parameter]]
name = "front"
keys = ["housing.box.wall.front"]
range = ["8 mm", "20 mm"]
spread = "3 mm"
"""


@pytest.fixture
def one_worker(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """Work in this process from here on: which process does it changes nothing, and to start others takes seconds."""
    return lambda: monkeypatch.setattr(updating, "default_workers", lambda: 1)


@pytest.mark.slow
def test_an_update_finds_a_secret_and_writes_it(gearwhine, one_worker: Callable[[], None], tmp_path: Path) -> None:
    (tmp_path / "box.toml").write_text(CASE, encoding="utf-8")
    walls = [f"housing.box.wall.{face}=13 mm" for face in ("left", "right", "bottom", "back")]
    walls += [f"housing.box.wall.{face}={value} m" for face, value in SECRET.items()]
    secret = [part for wall in ("housing.box.wall=", *walls) for part in ("--set", wall)]
    modes = gearwhine("modes", "box.toml", "--json", "-q", *secret).document["modes"]
    strongest = sorted(modes[:20], key=lambda mode: -mode["strength"])[:5]
    measured = sorted(round(mode["frequency_hz"], 2) for mode in strongest)
    with_measured = CASE + f"\n[measured]\nfrequencies = {[f'{value} Hz' for value in measured]}\n"
    (tmp_path / "box.toml").write_text(with_measured, encoding="utf-8")

    shown = gearwhine("update", "box.toml", "-q", "-o", "out")
    assert shown.code == 0
    assert "the data tell" in shown.out
    assert "--null" in shown.out
    document = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert document["before"]["rms_error_percent"] > 1.0
    assert document["max_error_percent"] < 0.5
    for row in document["parameters"]:
        # The secret's own mesh has other elements: some 0.2 % in frequency, as much as the noise stated.
        assert abs(row["after"] - SECRET[row["name"]]) < 3.0 * row["standard_deviation"]
        assert row["standard_deviation"] < 0.3 * row["prior"]["spread"]
        assert row["before"] == pytest.approx(0.013)
    assert document["identifiability"]["learned_combinations"] == 2
    assert [pair["measured_hz"] for pair in document["pairs"]] == pytest.approx(measured)

    text = (tmp_path / "out" / "updated.toml").read_text(encoding="utf-8")
    assert "-> " in text.partition("\n\n")[0]
    updated = load_case(str(tmp_path / "out" / "updated.toml")).case
    assert updated.housing is not None
    assert updated.housing.box is not None
    for row in document["parameters"]:
        assert getattr(updated.housing.box.walls, row["name"]) == pytest.approx(row["after"], rel=1e-4)
        assert updated.provenance[f"housing.box.wall.{row['name']}"].startswith("found: by updating")
    assert updated.update is not None
    assert updated.update.parameter[0].nominal == "13 mm"  # the prior has not moved
    compared = gearwhine("compare", "out/updated.toml", "--json", "-q").document
    assert compared["max_error_percent"] == pytest.approx(document["max_error_percent"], abs=0.02)

    one_worker()
    short = ("--set", "update.mesh_size=", "--set", "update.solves=2")
    worth = gearwhine("update", "out/updated.toml", "-o", "again", "--null", "1", "--held-back", "--json", *short)
    assert worth.code == 0
    assert "mode 5 predicted within" in worth.err
    assert "random set 1 of 1" in worth.err
    told = worth.document
    # Two walls and five modes: the other four tell of each, and random sets are not fitted.
    for row in told["held_back"]:
        assert abs(row["error_percent"]) < 3.0 * row["standard_deviation_percent"] < 6.0
    assert told["null"]["sets"] == len(told["null"]["fits"]) == 1
    assert told["null"]["within_1_percent"] == 0.0
    assert told["null"]["measured_likewise"]["max_error_percent"] < 1.0


@pytest.mark.parametrize(
    ("case", "said"), [("steel-box", "[measured]"), ("nasa-gear-noise-rig", "[update]"), ("three-stage", "[housing]")]
)
def test_what_an_update_needs_is_said(gearwhine, case: str, said: str) -> None:
    outcome = gearwhine("update", case)
    assert outcome.code == 2
    assert said in outcome.err
