"""Measured modes of a case: listed, or in a file that is read, checked and laid on the model."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from case_housings import mesh_of

import gearwhine as gw
from gearwhine.case import CaseError, case_document, dump_case, load_case, parse_case
from gearwhine.housing.measured import MeasuredGeometry, MeasuredModes, MeasuredResponses, SurveyData, write_survey
from gearwhine.housing.measured.survey_planning import survey_grid
from gearwhine.meshes import Mesh
from gearwhine.output.quantity import document_of
from gearwhine.results.check import MEASURED, check_document
from gearwhine.results.comparison import survey_document
from gearwhine.solve.comparison import modal_test_of, read_measured, refused_by_key

RIG: dict[str, Any] = case_document(load_case("nasa-gear-noise-rig").case)
COARSE = np.array([[-0.1395, 0.0, -0.165], [0.1395, 0.254, 0.165]])


def case_with(folder: Path, **measured: Any) -> Any:
    return parse_case(RIG | {"measured": measured, "provenance": {}}, folder=folder)


def a_survey(count: int = 9) -> SurveyData:
    """Points on the lid, in millimetres of the rig's own frame."""
    rng = np.random.default_rng(0)
    places = np.stack([rng.uniform(-0.1, 0.1, count), np.full(count, 0.254), rng.uniform(-0.1, 0.1, count)], axis=1)
    labels = tuple(str(number) for number in range(1, count + 1))
    geometry = MeasuredGeometry(labels, places, np.arange(count), np.tile([0.0, 1.0, 0.0], (count, 1)))
    shapes = rng.normal(size=(2, count)) + 0j
    return SurveyData(geometry, MeasuredModes(2 * np.pi * np.array([658.0, 1049.0]), None, shapes, geometry))


def test_listed_frequencies_may_have_damping(tmp_path: Path) -> None:
    given = case_with(tmp_path, frequencies=["658 Hz", "1.049 kHz"], damping_ratios=[0.01, 0.02])
    modes = read_measured(given.measured)
    np.testing.assert_allclose(modes.frequencies, 2 * np.pi * np.array([658.0, 1049.0]))
    np.testing.assert_array_equal(modes.damping_ratios, [0.01, 0.02])
    assert modes.shapes is None


@pytest.mark.parametrize("name", ["survey.uff", "survey.csv"])
def test_a_file_is_found_from_the_case_and_read(tmp_path: Path, name: str) -> None:
    write_survey(tmp_path / name, a_survey())
    case = case_with(tmp_path, file=name)
    modes = read_measured(case.measured)
    np.testing.assert_allclose(modes.frequencies, 2 * np.pi * np.array([658.0, 1049.0]))
    assert modes.shapes.shape == (2, 9)
    document = document_of(MEASURED, case.measured)
    assert (document["points"], document["degrees_of_freedom"], document["complex"]) == (9, 9, False)
    assert parse_case(case_document(case), folder="/") == case
    assert "survey" in dump_case(case)


def test_a_list_of_files_is_one_survey(tmp_path: Path) -> None:
    """Points and shapes apart: the file of shapes is the whole one without its data set of points."""
    write_survey(tmp_path / "points.uff", SurveyData(a_survey().geometry))
    write_survey(tmp_path / "whole.uff", a_survey())
    text = (tmp_path / "whole.uff").read_text(encoding="ascii")
    lines = text.splitlines(keepends=True)
    start = next(number for number, line in enumerate(lines) if line.strip() == "2411") - 1
    end = next(number for number in range(start + 1, len(lines)) if lines[number].strip() == "-1") + 1
    (tmp_path / "shapes.uff").write_text("".join(lines[:start] + lines[end:]), encoding="ascii")
    case = case_with(tmp_path, file=["points.uff", "shapes.uff"])
    np.testing.assert_allclose(read_measured(case.measured).shapes, a_survey().modes.shapes, atol=1e-5)
    assert document_of(MEASURED, case.measured)["file"] == f"{tmp_path / 'points.uff'} and {tmp_path / 'shapes.uff'}"
    assert parse_case(case_document(case), folder="/") == case
    alone = case_with(tmp_path, file="shapes.uff")
    assert not alone.measured.has_shapes
    assert alone.measured.paired_by == "nearest"
    for files, key in ((["points.uff", "gone.uff"], "measured.file[1]"), ([], "measured.file")):
        with pytest.raises(CaseError) as caught:
            case_with(tmp_path, file=files)
        assert [problem.key for problem in caught.value.problems] == [key]
    write_survey(tmp_path / "points.uff", SurveyData(a_survey(10).geometry))
    assert case_with(tmp_path, file=["points.uff", "shapes.uff"]).measured != case.measured


def test_check_says_what_was_read_and_assumed(tmp_path: Path) -> None:
    write_survey(tmp_path / "f.csv", SurveyData(modes=MeasuredModes(2 * np.pi * np.array([658.0]))))
    document = check_document(case_with(tmp_path, file="f.csv"))
    assert document["measured"]["frequencies_hz"] == pytest.approx([658.0])
    told = check_document(case_with(_universal(tmp_path), file="survey.uff", unit="in"))
    assert any("lengths taken in in" in warning["message"] for warning in told["warnings"])


def _universal(folder: Path) -> Path:
    write_survey(folder / "survey.uff", a_survey())
    return folder


@pytest.mark.parametrize(
    ("measured", "key", "expected"),
    [
        ({}, "measured.frequencies", "either 'frequencies' or a 'file'"),
        ({"frequencies": ["1 Hz"], "file": "survey.uff"}, "measured.frequencies", "either 'frequencies' or a 'file'"),
        ({"file": "missing.uff"}, "measured.file", "an existing file"),
        ({"file": "broken.uff"}, "measured.file", "no universal file"),
        ({"file": "points.uff"}, "measured.file", "holds points alone"),
        ({"file": "f.csv", "align": True}, "measured.align", "no points"),
        ({"file": "survey.uff", "unit": "furlong"}, "measured.unit", "one of 'm', 'mm', 'cm' or 'in'"),
        ({"file": "survey.uff", "align": "yes"}, "measured.align", "true or false"),
        ({"file": "survey.uff", "align": {"landmarks": []}}, "measured.align.landmarks", "at least 3"),
        ({"file": "survey.uff", "damping_ratios": [0.1]}, "measured.damping_ratios", "beside a file"),
        ({"frequencies": ["1 Hz"], "damping_ratios": [0.1, 0.2]}, "measured.damping_ratios", "each of the 1"),
        ({"frequencies": ["1 Hz"], "align": True}, "measured.align", "without a file"),
        ({"frequencies": ["2 Hz", "1 Hz"]}, "measured.frequencies[1]", "above the one before"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, measured: dict[str, Any], key: str, expected: str) -> None:
    _universal(tmp_path)
    (tmp_path / "broken.uff").write_text("nothing of the kind", encoding="ascii")
    write_survey(tmp_path / "points.uff", SurveyData(a_survey().geometry))
    write_survey(tmp_path / "f.csv", SurveyData(modes=MeasuredModes(np.array([1.0]))))
    with pytest.raises(CaseError) as caught:
        case_with(tmp_path, **measured)
    (problem,) = caught.value.problems
    assert problem.key == key
    assert expected in str(problem)


def test_modes_are_found_in_a_file_of_responses(tmp_path: Path) -> None:
    """One mode at 100 Hz with 1 % damping at nine points: H = -ω² φ φ₁ / (ω₀² - ω² + 2iζω₀ω)."""
    geometry = a_survey().geometry
    omega, natural = 2 * np.pi * np.arange(20.0, 201.0), 2 * np.pi * 100.0
    shape = np.arange(1.0, 10.0)
    values = -(omega**2) / (natural**2 - omega**2 + 0.02j * natural * omega) * shape[:, None]
    responses = MeasuredResponses(geometry, np.array([0]), np.array([[0, 1.0, 0]]), omega, values[:, None] + 0j)
    write_survey(tmp_path / "frf.uff", SurveyData(geometry, None, responses))
    case = case_with(tmp_path, file="frf.uff")
    assert document_of(MEASURED, case.measured)["responses"]["lines"] == 181
    modes = read_measured(case.measured)
    np.testing.assert_allclose(modes.frequencies, [natural], rtol=1e-6)
    np.testing.assert_allclose(modes.damping_ratios, [0.01], rtol=1e-4)
    np.testing.assert_allclose(np.abs(modes.shapes[0]), shape / 9.0, rtol=1e-6)


@pytest.fixture(scope="module")
def rig_mesh() -> Mesh:

    return mesh_of(load_case("nasa-gear-noise-rig", ['housing.box.mesh_size="60 mm"']).case)


def test_the_survey_is_laid_on_the_housing(tmp_path: Path, rig_mesh: Mesh) -> None:
    """The 116 points of the model's own grid, given in another frame and brought back by four landmarks."""
    grid = survey_grid(rig_mesh, COARSE)
    turn, shift = np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]]), np.array([1.0, 2.0, 3.0])
    labels = tuple(str(number) for number in range(1, 117))
    geometry = MeasuredGeometry(labels, grid.positions @ turn.T + shift, np.arange(116), grid.normals @ turn.T)
    shapes = np.ones((1, 116), dtype=complex)
    write_survey(tmp_path / "s.csv", SurveyData(geometry, MeasuredModes(np.array([1.0]), None, shapes, geometry)))
    landmarks = [
        {"point": label, "position": grid.positions[int(label) - 1].tolist()} for label in ("1", "40", "80", "116")
    ]
    case = case_with(tmp_path, file="s.csv", align={"landmarks": landmarks})
    test = modal_test_of(case.measured)
    survey = test.mapped(rig_mesh, test.modes.geometry)
    assert survey.distances.max() < 1e-9
    document = survey_document(survey)
    assert document["alignment"]["turned_degrees"] == pytest.approx(120.0)
    field = np.random.default_rng(0).normal(size=(1, len(rig_mesh.points), 3))
    np.testing.assert_allclose(survey.shapes(field), grid.normal_motion(field), atol=1e-9)
    with pytest.raises(CaseError, match=r"measured\.file.*can be aligned"), refused_by_key():
        modal_test_of(case_with(tmp_path, file="s.csv").measured).mapped(rig_mesh, geometry)


@pytest.mark.parametrize(
    ("frequencies", "said"),
    [
        (["0.658 Hz", "1.049 Hz", "2.722 Hz"], "the highest is 2.722 Hz: is it kHz?"),
        (["0.658 Hz", "1.049 Hz", "2722 Hz"], "2722 Hz follows 1.049 Hz"),
        (["658 Hz", "1049 Hz", "2722 Hz"], ""),
        (["200 Hz", "1049 Hz", "2722 Hz"], ""),
    ],
)
def test_measured_frequencies_of_another_unit_are_doubted(frequencies: list[str], said: str) -> None:
    case = gw.load("nasa-gear-noise-rig", {"measured": {"frequencies": frequencies}})
    doubts = [text for text in case.warnings if "measured.frequencies" in text]
    assert [said in text for text in doubts] == [True] * bool(said)


def test_measured_radians_in_place_of_hertz_are_named_where_the_range_falls_short() -> None:
    radians = [f"{2.0 * np.pi * frequency} Hz" for frequency in (658.0, 1049.0, 2722.0)]
    with pytest.raises(CaseError, match="in Hz, if these are in rad/s"):
        gw.load("nasa-gear-noise-rig", {"measured": {"frequencies": radians}}).check()
