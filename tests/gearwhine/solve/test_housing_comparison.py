"""A solved housing against a test made of its own modes: the stage, its document, and what the screen says."""

import json
from dataclasses import replace

import numpy as np
import pytest
from numbers_of_texts import foreign_numbers

from gearwhine.case import load_case
from gearwhine.housing import HousingError, HousingModes
from gearwhine.housing.correlation.comparison import Pairing
from gearwhine.housing.measured import MeasuredGeometry, MeasuredModes
from gearwhine.housing.modal_test import pair_modes
from gearwhine.output import finite, json_text
from gearwhine.output.terminal import shown_by
from gearwhine.results.comparison import _survey, comparison_document, sections
from gearwhine.solve.comparison import compare_measured
from gearwhine.solve.housing_modes import solve_housing

CASE = load_case("small-gearbox", ("housing.box.mesh_size=30 mm", "housing.frequency_limit=4 kHz")).case


@pytest.fixture(scope="module")
def solved() -> HousingModes:
    return solve_housing(CASE)


@pytest.fixture(scope="module")
def twin(solved: HousingModes) -> tuple[MeasuredModes, np.ndarray]:
    """All modes but the third and the last two, 2 % lower, the second of them found twice; and the model's shapes."""
    shapes = solved.survey.normal_motion(solved.modes.shapes)
    frequencies = solved.modes.frequencies
    kept = [mode for mode in range(len(frequencies) - 2) if mode != 2]
    count = len(solved.survey.positions)
    geometry = MeasuredGeometry(
        tuple(str(number + 1) for number in range(count)),
        solved.survey.positions,
        np.arange(count),
        solved.survey.normals,
    )
    found = np.append(0.98 * frequencies[kept], 0.975 * frequencies[1])
    test = np.vstack([shapes[kept], shapes[1] + 0.02 * shapes[0]]) * (1.0 + 2.0j)
    order = np.argsort(found)
    return MeasuredModes(found[order], None, test[order], geometry), shapes


def test_the_twin_is_paired_by_shape(solved: HousingModes, twin: tuple[MeasuredModes, np.ndarray]) -> None:
    comparison = pair_modes(solved, *twin)
    document = json.loads(json_text(finite(comparison_document(comparison, solved))))
    count = len(twin[0].frequencies)
    assert [pair["mode"] for pair in document["pairs"]] == [1, 2, *range(4, count + 1)]
    errors = [pair["error_percent"] for pair in document["pairs"]]
    assert errors == pytest.approx([100.0 / 0.98 - 100.0] * len(errors))
    assert [pair["mac"] for pair in document["pairs"]] == pytest.approx([1.0] * len(errors))
    assert [mode["mode"] for mode in document["unpaired_model"]] == [3]
    assert [mode["measured_mode"] for mode in document["unpaired_measured"]] == [2]
    (twice,) = document["duplicates"]
    assert twice["modes"] == [2, 3]
    assert not {"gap", "measures_agree", "chance_error_percent"} & set(document)  # of other pairings
    assert document["pairing"] == "shapes"
    assert document["pairs"][0]["strength"] == pytest.approx(float(solved.strengths.acceleration[0]))
    assert document["phase_collinearity"] == pytest.approx([1.0] * count)
    assert np.array(document["mac"]).shape == (len(solved.modes.frequencies), count)


def test_the_screen_says_what_is_missing(
    solved: HousingModes, twin: tuple[MeasuredModes, np.ndarray], capsys: pytest.CaptureFixture[str]
) -> None:
    document = finite(comparison_document(pair_modes(solved, *twin), solved))
    assert foreign_numbers(document, sections(document)) == []
    shown_by(sections)(document)
    out = capsys.readouterr().out
    assert "confidence" in out
    assert "Measured mode 2 (" in out
    assert "Model modes in the measured band that no measured mode is: 3 (" in out
    assert "Measured modes 2 and 3 may be one mode found twice (MAC 1.00)." in out
    assert "coin toss" not in out


def test_a_model_known_less_high_than_the_test_is_refused(
    solved: HousingModes, twin: tuple[MeasuredModes, np.ndarray]
) -> None:
    measured, shapes = twin
    high = replace(measured, frequencies=1.2 * measured.frequencies)
    with pytest.raises(HousingError, match="are paired with the model's up to there"):
        pair_modes(solved, high, shapes)


def test_measured_frequencies_alone_are_paired_as_the_case_says(solved: HousingModes) -> None:
    given = MeasuredModes(2.0 * np.pi * np.array(CASE.measured.frequencies))
    comparison = pair_modes(solved, given, pairing="dominance")
    assert comparison.shapes is None
    assert comparison.gap is not None
    assert comparison.pairs == compare_measured(CASE.measured, solved).comparison.pairs  # the case asks for dominance
    assert pair_modes(solved, given).pairing == "nearest"
    document = finite(comparison_document(comparison, solved))
    assert foreign_numbers(document, sections(document)) == []
    counted, highest = document["model_modes"], float(given.frequencies.max()) / (2.0 * np.pi)
    assert counted["below_hz"] >= min(highest, solved.trusted_limit_hz)
    assert counted["count"] == np.count_nonzero(solved.modes.frequencies_hz < counted["below_hz"])


@pytest.mark.parametrize("pairing", ["order", "nearest", "dominance"])
def test_pairs_of_frequencies_have_the_mac_of_measured_shapes(
    solved: HousingModes, twin: tuple[MeasuredModes, np.ndarray], pairing: Pairing
) -> None:
    by_shape, other = (pair_modes(solved, *twin, pairing=name) for name in ("shapes", pairing))
    document = json.loads(json_text(finite(comparison_document(other, solved))))
    assert document["pairing"] == pairing
    assert document["mac"] == comparison_document(by_shape, solved)["mac"]
    for pair in document["pairs"]:
        assert pair["mac"] == pytest.approx(document["mac"][pair["mode"] - 1][pair["measured_mode"] - 1])
    if pairing == "order":  # mode 2 was found twice and mode 3 not at all
        assert [pair["mode"] for pair in document["pairs"]] == list(range(1, len(document["pairs"]) + 1))
        assert document["pairs"][0]["mac"] == pytest.approx(1.0)
        assert document["pairs"][3]["mac"] == pytest.approx(1.0)
        assert document["pairs"][2]["mac"] < 0.9


def test_distances_of_a_survey_are_told_in_millimetres_each_its_own() -> None:
    survey = {
        "points": 7,
        "degrees_of_freedom": 19,
        "rms_distance_m": 0.0012,
        "worst_distance_m": 0.0034,
        "worst_point": "5",
        "tolerance_m": 0.0021,
        "far_points": ["5", "6"],
        "alignment": {
            "by": "corners",
            "turned_degrees": 12.0,
            "rms_m": 0.0056,
            "largest_m": 0.0078,
            "remarks": ["turned"],
        },
    }
    assert list(_survey(survey)) == [
        "Survey: 7 points, 19 measured directions; 1.2 mm from the surface in the mean, 3.4 mm at worst (point 5).",
        "Farther than 2.1 mm: 5, 6.",
        "Aligned by corners, turned by 12.0°; 5.6 mm left in the mean, 7.8 mm at most.",
        "Note: turned.",
    ]
