"""From a survey's file to pairs by shape: a housing's own modes, written as a test program would, and compared."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case import load_case
from gearwhine.housing.correlation.comparison import Comparison, ModePair
from gearwhine.housing.measured import MeasuredGeometry, MeasuredModes
from gearwhine.housing.measured.survey_data import SurveyData
from gearwhine.housing.measured.survey_files import write_survey
from gearwhine.housing.modal_test import comparison_warnings
from gearwhine.solve.housing_modes import solve_housing

COARSE = ("housing.box.mesh_size=45 mm", "housing.frequency_limit=4 kHz")


@pytest.mark.slow
def test_a_survey_in_a_file_is_paired_by_shape(tmp_path: Path) -> None:
    """Modes 1, 2, 4 and 5 of the housing as measured 1 % lower: these are found, and mode 3 is named missing."""
    solved = solve_housing(load_case("small-gearbox", COARSE).case)
    positions, normals = solved.survey.positions, solved.survey.normals
    count = len(positions)
    geometry = MeasuredGeometry(tuple(str(number + 1) for number in range(count)), positions, np.arange(count), normals)
    found = [0, 1, 3, 4]
    shapes = solved.survey.normal_motion(solved.modes.shapes)[found]
    modes = MeasuredModes(0.99 * solved.modes.frequencies[found], np.full(4, 0.01), shapes + 0j, geometry)
    write_survey(tmp_path / "survey.uff", SurveyData(geometry=geometry, modes=modes))
    out = tmp_path / "out"
    found = gw.load("small-gearbox", (*COARSE, f'measured={{file="{tmp_path}/survey.uff"}}')).compare()
    found.write(out)
    document = found.document
    assert [pair["mode"] for pair in document["pairs"]] == [1, 2, 4, 5]
    assert [pair["mac"] for pair in document["pairs"]] == pytest.approx([1.0] * 4, abs=1e-6)
    assert [pair["error_percent"] for pair in document["pairs"]] == pytest.approx([100.0 / 0.99 - 100.0] * 4, rel=1e-3)
    assert [mode["mode"] for mode in document["unpaired_model"]] == [3]
    assert document["survey"]["worst_distance_m"] == pytest.approx(0.0, abs=1e-5)
    assert {"mac.png", "comac.png", "comparison.png", "comparison.csv"} <= {path.name for path in out.iterdir()}


def test_pairs_that_hang_on_the_mesh_are_told() -> None:
    """Two modes 1 % apart, one of which the mesh raises by 3 %, may change places; a third at 2 kHz may not."""
    frequencies = 2.0 * np.pi * np.array([1000.0, 1010.0, 2000.0])
    modes: Any = SimpleNamespace(frequencies=frequencies, discretisation_errors=np.array([0.001, 0.03, 0.03]))
    pairs = tuple(
        ModePair(float(hertz), float(model), number, number, None)
        for number, (hertz, model) in enumerate(zip(0.99 * frequencies, frequencies, strict=True), start=1)
    )
    comparison = Comparison(pairs, "order", "by order", (0.0, np.inf))
    (told,) = comparison_warnings(comparison, modes)
    assert told["modes"] == [1, 2]
    assert told["message"].startswith("pairs may change with the mesh: model modes 1, 2 ")
    assert comparison_warnings(replace(comparison, pairing="shapes"), modes) == []


def test_a_mode_that_a_finer_mesh_would_bring_nearer_is_told() -> None:
    """Measured 1030 Hz is nearest to 1000 Hz; 1100 Hz, which the mesh raises by 6 %, is at 1034 Hz on a fine one."""
    frequencies = 2.0 * np.pi * np.array([1000.0, 1100.0, 2000.0])
    modes: Any = SimpleNamespace(frequencies=frequencies, discretisation_errors=np.array([0.001, 0.06, 0.001]))
    pairs = tuple(
        ModePair(2.0 * np.pi * hertz, float(frequencies[number - 1]), place, number, None)
        for place, (hertz, number) in enumerate(((1030.0, 1), (1980.0, 3)), start=1)
    )
    comparison = Comparison(pairs, "nearest", "by nearest frequencies", (0.0, np.inf))
    (told,) = comparison_warnings(comparison, modes)
    assert told["modes"] == [1]
    assert comparison_warnings(replace(comparison, pairing="order"), modes) == []


@pytest.mark.slow
def test_a_run_warns_of_the_edge_of_the_band_as_the_comparison_does(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mode identified at the edge of the measured band stays doubtful where a run shows it beside the model's."""
    cut = MeasuredModes(2.0 * np.pi * np.array([1900.0, 2300.0]), np.array([0.01, 0.02]), cut_by_band=(1,))
    monkeypatch.setattr("gearwhine.solve.comparison.read_measured", lambda measured, progress: cut)
    few = ("housing.box.mesh_size=60 mm", "measured={frequencies=['1 kHz']}")
    study = gw.load("steel-box", few)
    for result in (study.run(), study.compare()):
        (told,) = (one for one in result.document["warnings"] if one["name"] == "edge of the band")
        assert told["modes"] == [2]
        assert "half-power width of measured mode 2 (2300 Hz)" in told["message"]
