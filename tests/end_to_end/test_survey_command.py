"""A survey planned, "measured" on the model itself and compared with it: through the real command."""

from pathlib import Path

import numpy as np
import pytest

from gearwhine.case import bundled_case
from gearwhine.housing import read_modes
from gearwhine.housing.measured import MeasuredModes, SurveyData, map_survey, read_survey, write_universal

COARSE = ("--set", 'housing.box.mesh_size="45 mm"')


@pytest.fixture
def planned(gearwhine, tmp_path: Path) -> Path:
    outcome = gearwhine("survey", "small-gearbox", "--sensors", "24", "-o", "out", "--json", "-q", *COARSE)
    assert outcome.code == 0, outcome.err
    document = outcome.document
    assert len(document["sensors"]) == 24
    assert sum(one["independence"] for one in document["sensors"]) == pytest.approx(len(document["modes"]))
    assert document["auto_mac_largest"] < 0.5
    assert {"survey.uff", "survey.csv"} <= set(document["files"])
    return tmp_path / "out"


@pytest.mark.slow
def test_a_planned_survey_measures_the_model_that_planned_it(gearwhine, planned: Path, tmp_path: Path) -> None:
    ours, theirs = read_survey(planned / "survey.csv").geometry, read_survey(planned / "survey.uff").geometry
    assert ours.labels == theirs.labels
    np.testing.assert_allclose(theirs.positions, ours.positions, atol=1e-6)
    record = read_modes(planned / "modes.nc")
    seen = map_survey(record.mesh, ours)
    modes = record.modes
    shapes = seen.shapes(modes.shapes[:3]).astype(complex)
    measured = MeasuredModes(1.01 * modes.frequencies[:3], np.full(3, 0.01), shapes, ours)
    write_universal(tmp_path / "measured.uff", SurveyData(ours, measured))
    case = tmp_path / "case.toml"
    text = bundled_case("small-gearbox").read_text(encoding="utf-8")
    start = text.index("[measured]")
    stop = next((at for at in (text.find("\n[", start + 1),) if at > 0), len(text))
    case.write_text(text[:start] + '[measured]\nfile = "measured.uff"\n' + text[stop:], encoding="utf-8")
    checked = gearwhine("check", str(case), "--json", "-q").document["measured"]
    assert (checked["points"], checked["degrees_of_freedom"]) == (24, 24)
    np.testing.assert_allclose(checked["frequencies_hz"], 1.01 * modes.frequencies_hz[:3], rtol=1e-5)
    told = gearwhine("check", str(case), "-q").out
    assert "24 points over" in told
    assert "real shapes" in told
    compared = gearwhine("compare", str(case), "-o", "out", "--json", "-q", *COARSE)
    assert compared.code == 0, compared.err
    survey = compared.document["survey"]
    assert compared.document["reused"] is True
    assert (survey["points"], survey["far_points"]) == (24, [])
    assert survey["worst_distance_m"] < 1e-6
    shown = gearwhine("compare", str(case), "-o", "out", "-q", *COARSE).out
    assert "24 points, 24 measured directions" in shown
