"""`gearwhine update` on a small housing whose secret is known, from the command line to the file it writes."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gearwhine.case import load_case
from gearwhine.from_case.parametric_housing import ParametricHousing, fitted_case
from gearwhine.housing.measured import MeasuredGeometry, MeasuredModes, SurveyData, map_survey, write_survey
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


def secret_survey(text: str) -> SurveyData:
    """What a survey of 60 points finds of the box with its secret walls: seven of the first nine modes.

    5 % noise in the motions, 0.1 % in the frequencies; scales and phases arbitrary; one point lacks the third mode.
    """
    generator = np.random.default_rng(4)
    case = load_case(text, [f"housing.box.wall.{face}={value} m" for face, value in SECRET.items()]).case
    secret = ParametricHousing(fitted_case(case), 24, threads=1).solve(np.zeros(2))
    assert secret.shapes is not None
    corners = np.array([[-0.1, 0.0, -0.12], [0.1, 0.16, 0.12]])
    where = corners[0] + (corners[1] - corners[0]) * generator.uniform(0.05, 0.95, size=(60, 3))
    sides = generator.integers(0, 3, 60), generator.integers(0, 2, 60)
    where[np.arange(60), sides[0]] = corners[sides[1], sides[0]]
    directions = np.zeros((60, 3))
    directions[np.arange(60), sides[0]] = 2.0 * sides[1] - 1.0
    geometry = MeasuredGeometry(tuple(map(str, range(1, 61))), where, np.arange(60), directions)
    seen = [0, 1, 2, 4, 5, 7, 8]
    shapes = map_survey(secret.mesh, geometry).shapes(secret.shapes)[seen]
    shapes += 0.05 * np.sqrt((shapes**2).mean(axis=1))[:, None] * generator.normal(size=shapes.shape)
    scaled = shapes * np.exp(2j * np.pi * generator.uniform(size=len(seen)))[:, None]
    frequencies = secret.state.frequencies[seen] * (1.0 + 1e-3 * generator.normal(size=len(seen)))
    modes = MeasuredModes(frequencies, None, scaled, geometry)
    return SurveyData(geometry=geometry, modes=modes)


@pytest.mark.slow
def test_an_update_by_measured_shapes_finds_a_secret(gearwhine, one_worker: Callable[[], None], tmp_path: Path) -> None:
    one_worker()
    walls = "{ left = '13 mm', right = '13 mm', bottom = '13 mm', top = '13 mm', back = '13 mm', front = '13 mm' }"
    text = CASE.replace('wall = "13 mm"', f"wall = {walls}")
    # 5 % are the survey's; shapes of two meshes as coarse as these differ by more.
    text = text.replace('mesh_size = "54 mm"', "shape_noise = 0.2")
    (tmp_path / "plain.toml").write_text(text + "\n[measured]\nfrequencies = ['1 kHz']\n", encoding="utf-8")
    survey = secret_survey(str(tmp_path / "plain.toml"))
    write_survey(tmp_path / "survey.uff", survey)
    (tmp_path / "box.toml").write_text(text + "\n[measured]\nfile = 'survey.uff'\n", encoding="utf-8")

    outcome = gearwhine("update", "box.toml", "--json", "-q", "-o", "out")
    assert outcome.code == 0
    document = outcome.document
    assert document["pairing"] == "shapes"
    assert [pair["mode"] for pair in document["pairs"]] == [1, 2, 3, 5, 6, 8, 9]
    assert min(pair["mac"] for pair in document["pairs"]) > 0.98  # 5 % noise leaves 1 / (1 + 0.05²)
    assert "gap" not in document
    assert document["wrong_pairs"] == 0
    for row in document["parameters"]:
        assert abs(row["after"] - SECRET[row["name"]]) < 3.0 * row["standard_deviation"]
        assert row["standard_deviation"] < 0.1 * row["prior"]["spread"]
    assert document["before"]["rms_error_percent"] > 5.0 * document["rms_error_percent"]
    assert "least MAC" in (tmp_path / "out" / "updated.toml").read_text(encoding="utf-8").partition("\n\n")[0]

    refused = gearwhine("update", "box.toml", "-q", "--null", "2")
    assert refused.code == 2
    assert "random frequencies have none" in refused.err


@pytest.mark.parametrize(
    ("case", "said"), [("steel-box", "[measured]"), ("nasa-gear-noise-rig", "[update]"), ("three-stage", "[housing]")]
)
def test_what_an_update_needs_is_said(gearwhine, case: str, said: str) -> None:
    outcome = gearwhine("update", case)
    assert outcome.code == 2
    assert said in outcome.err
