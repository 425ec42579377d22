"""Mistakes of a study, each of another kind, in one refusal."""

from pathlib import Path

import pytest

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.case.load import bundled_case

VARIATION = """
[variation]
analyses = ["gears", "motion"]
[variation.vary]
"gear.pinoin.tip_relief.amount" = { normal = ["20 um", "2 um"] }
"gear.wheel.face_width" = { normal = ["-6 mm", "0.1 mm"] }
"gear.*.errors.helix.slope" = { class = 7, independent = true }
"operation.torque" = { normal = ["70 N*m", "2 mm"] }
[[variation.correlation]]
keys = ["gear.*.errors.helix.slope", "operation.torque"]
coefficient = 0.5
"""
DESIGN = """
[optimisation]
robust = { deviations = 2 }
[optimisation.design]
"gear.pinoin.tip_relief.amount" = { range = ["10 um", "20 um"] }
"gear.wheel.face_width" = { range = ["-6 mm", "7 mm"] }
"gear.pinion.tip_relief.amount" = { range = ["10 um", "20 mm/s"] }
"""


def _problems(tmp_path: Path, text: str, command: str) -> list[str]:
    bundled = bundled_case("spur-pair")
    assert bundled is not None
    path = tmp_path / "pair.toml"
    # Without the transient that the motion needs.
    case, _, rest = bundled.read_text().partition("[transient]")
    path.write_text(case + rest.partition("\n\n")[2] + text)
    with pytest.raises(CaseError) as refused:
        getattr(gw.load(path), command)(folder=tmp_path / "out", workers=1)
    return [str(problem) for problem in refused.value.problems]


def test_all_of_a_variation(tmp_path: Path) -> None:
    found = _problems(tmp_path, VARIATION, "vary")
    for said in ("did you mean 'pinion'", "face_width", "operation.torque", "variation.correlation", "transient"):
        assert sum(said in one for one in found) == 1, said
    assert len(found) == 5


def test_all_of_a_design(tmp_path: Path) -> None:
    found = _problems(tmp_path, DESIGN, "optimise")
    expected = ("did you mean 'pinion'", "face_width", "tip_relief.amount'.range", "optimisation.aim", "variation:")
    for said in expected:
        assert sum(said in one for one in found) == 1, said
    assert len(found) == 5
