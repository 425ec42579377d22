"""`gearwhine compare` with a file of responses and shapes: FRAC, and the rule of pairing from the case."""

from pathlib import Path

import numpy as np
import pytest

from gearwhine.case import load_case
from gearwhine.housing.measured import (
    MeasuredGeometry,
    MeasuredModes,
    MeasuredResponses,
    SurveyData,
    map_survey,
    write_survey,
)
from gearwhine.solve.housing_modes import solve_housing

CASE = """
title = "a box"

[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"

[housing]
material = "steel"
modes = 10
damping_ratio = 0.02

[housing.box]
size = ["200 mm", "160 mm", "240 mm"]
wall = "13 mm"
mesh_size = "50 mm"
feet = { size = ["40 mm", "20 mm", "40 mm"] }

[[housing.support]]
name = "foot 1"
surface = "foot-1"
fixed = ["x", "y", "z"]

[[housing.support]]
name = "foot 2"
surface = "foot-2"
fixed = ["x", "y", "z"]
"""
GAIN = 0.3 - 2.0j  # of the measured over the model's: FRAC does not see it


def survey_of(path: Path) -> SurveyData:
    """Six modes and the accelerances of ten modes at twelve points of the lid, two of them hit, summed by hand."""
    solved = solve_housing(load_case(str(path)).case)
    generator = np.random.default_rng(2)
    places = np.stack([generator.uniform(-0.08, 0.08, 12), np.full(12, 0.16), generator.uniform(-0.1, 0.1, 12)], axis=1)
    up = np.tile([0.0, 1.0, 0.0], (12, 1))
    geometry = MeasuredGeometry(tuple(map(str, range(1, 13))), places, np.arange(12), up)
    shapes = map_survey(solved.mesh, geometry).shapes(solved.modes.shapes)
    omega = solved.modes.frequencies
    lines = np.linspace(0.5 * omega[0], 0.98 * omega[-1], 300)
    hit = np.array([2, 7])
    gain = 1.0 / (omega[:, None] ** 2 - lines**2 + 0.04j * omega[:, None] * lines)
    receptance = np.einsum("md,mr,mw->drw", shapes, shapes[:, hit], gain)
    responses = MeasuredResponses(geometry, hit, up[hit], lines, -GAIN * lines**2 * receptance)
    modes = MeasuredModes(omega[:6], None, shapes[:6] + 0j, geometry)
    return SurveyData(geometry=geometry, modes=modes, responses=responses)


@pytest.mark.slow
def test_responses_are_compared_by_the_command(gearwhine, tmp_path: Path) -> None:
    (tmp_path / "box.toml").write_text(CASE, encoding="utf-8")
    write_survey(tmp_path / "survey.uff", survey_of(tmp_path / "box.toml"))
    (tmp_path / "box.toml").write_text(CASE + "\n[measured]\nfile = 'survey.uff'\n", encoding="utf-8")
    same = gearwhine("compare", "box.toml", "--json", "-q", "-o", "same").document["responses"]
    assert np.array(same["frac"]).shape == (12, 2)
    assert np.array(same["frac"]) == pytest.approx(np.ones((12, 2)), abs=1e-3)  # lines of a universal file
    assert same["lines"] == 300
    table = (tmp_path / "same" / "frac.csv").read_text(encoding="utf-8").splitlines()
    assert table[0] == "response,3 +y,8 +y"
    assert len(table) == 13

    heavier = ("--set", "material.steel.density=8250 kg/m^3")
    shown = gearwhine("compare", "box.toml", "-q", *heavier)
    assert "FRAC" in shown.out
    other = gearwhine("compare", "box.toml", "--json", "-q", *heavier).document["responses"]
    assert other["mean"] < 0.9  # all resonances 2.5 % off, more than their half-power width
    assert max(value for row in other["frac"] for value in row) < 0.99

    strict = ("--set", "measured.pairing.frequency_spread=0.01", *heavier)
    alone = gearwhine("compare", "box.toml", "--json", "-q", *strict).document
    assert len(alone["unpaired_measured"]) == 6  # 2.5 % is beyond twice 1 %
    refused = gearwhine("compare", "box.toml", "--set", "measured.pairing.least_mac=1.5")
    assert refused.code == 2
    assert "least_mac" in refused.err
