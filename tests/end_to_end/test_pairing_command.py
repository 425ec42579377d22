"""`[measured] pairing`: the comparison of a housing without bearing seats, and what is refused before its solution."""

import json
from pathlib import Path
from typing import Any

import pytest

from gearwhine.case import CaseError, load_case
from gearwhine.solve import comparison

CASE = """
title = "plain box"
[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
[housing]
material = "steel"
frequency_limit = "2.2 kHz"
[housing.box]
size = ["300 mm", "200 mm", "200 mm"]
wall = "10 mm"
mesh_size = "70 mm"
[[housing.support]]
name = "base"
plane = { axis = "y", at = "0 mm" }
fixed = ["x", "y", "z"]
[measured]
frequencies = ["1200 Hz", "1300 Hz"]
"""


@pytest.fixture
def plain(tmp_path: Path) -> Path:
    (tmp_path / "box.toml").write_text(CASE, encoding="utf-8")
    return tmp_path / "box.toml"


def test_a_housing_without_seats_is_compared_with_a_list(gearwhine: Any, plain: Path) -> None:
    document = gearwhine("run", "box.toml", "--json", "-q", "-o", "out", "--no-pictures").document
    compared = document["compare"]
    assert compared["pairing"] == "nearest"
    assert not {"gap", "measures_agree"} & set(compared)
    modes = [mode["frequency_hz"] for mode in document["housing"]["modes"]]
    for pair in compared["pairs"]:
        assert pair["model_hz"] == pytest.approx(modes[pair["mode"] - 1])
    assert [entry["name"] for entry in document["warnings"]].count("weak pairing") == 1
    outcome = gearwhine("compare", "box.toml", "-q", "-o", "out", "--set", "measured.pairing=order")
    assert outcome.code == 0
    assert "Paired by order of frequency, the first with the first" in outcome.out
    stored = json.loads((plain.parent / "out" / "compare" / "summary.json").read_text(encoding="utf-8"))
    assert [pair["mode"] for pair in stored["pairs"]] == [1, 2]
    assert stored["pairing"] == "order"
    assert "compare/comparison.png" in stored["files"]
    assert gearwhine("report", "box.toml", "-q", "-o", "out").code == 0
    page = (plain.parent / "out" / "report.html").read_text(encoding="utf-8")
    assert "nearest frequencies in order" in page


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("measured.pairing=dominance", "measured.pairing: expected 'nearest' or 'order': dominance is the strength"),
        ("measured.pairing=shapes", "measured.pairing: expected 'nearest', 'order' or 'dominance': no shapes"),
        ("measured.pairing=likeness", "measured.pairing: expected one of 'order', 'nearest', 'dominance' or 'shapes'"),
        ("measured.pairing.least_mac=0.9", "no shapes are measured"),
        ("housing.frequency_limit=1.3 kHz", "housing.frequency_limit: expected at least 1365 Hz"),
        ("measured.frequencies=[1300, 1200]", "measured.frequencies[1]: expected a frequency above the one before"),
        ("measured.frequencies=[1300, 1300]", "measured.frequencies[1]: expected a frequency above the one before"),
    ],
)
def test_what_a_pairing_lacks_is_refused_by_check(gearwhine: Any, plain: Path, change: str, said: str) -> None:
    outcome = gearwhine("check", "box.toml", "-q", "--set", change)
    assert outcome.code == 2
    assert said in outcome.err


def test_too_few_modes_are_refused_before_they_are_solved(plain: Path) -> None:
    document = CASE.replace('frequency_limit = "2.2 kHz"', "modes = 1") + 'pairing = "order"\n'
    plain.write_text(document, encoding="utf-8")
    case = load_case(str(plain)).case
    with pytest.raises(CaseError, match=r"housing\.modes: expected at least 2"):
        comparison.require_comparable(case.measured, case.housing)


def test_the_table_of_defaults_that_older_resolved_cases_state_is_read(plain: Path) -> None:
    table = "[measured.pairing]\nleast_mac = 0.5\nfrequency_spread = 0.2\ncloseness = 0.01\nduplicate_mac = 0.9\n"
    plain.write_text(CASE + table, encoding="utf-8")
    measured = load_case(str(plain)).case.measured
    assert measured is not None
    assert measured.paired_by == "nearest"
