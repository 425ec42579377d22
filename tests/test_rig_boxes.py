"""The study of boxes with the rig's frequencies: what it keeps is sound, and its documentation has the tables of it."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).parent.parent / "benchmarks"))

import rig_boxes
from rig_boxes import END, MESH_HZ, STATEMENTS, TOP, WITHIN

FOUND = rig_boxes.read_found()
EQUAL = rig_boxes.equal_boxes(FOUND)


def test_the_draws_are_those_of_the_first_numbers() -> None:
    numbers = sorted(int(name.removeprefix("box-")) for name in FOUND if name.startswith("box-"))
    assert numbers == list(range(1, len(numbers) + 1))


def test_every_box_that_was_fitted_meets_the_table_and_is_judged_by_all_statements() -> None:
    fitted = {name for name, box in FOUND.items() if box.get("outcome") == "fitted"}
    assert fitted == set(EQUAL)
    for box in (*EQUAL.values(), FOUND["nasa-gear-noise-rig"]):
        assert np.abs(box["errors_percent"]).max() <= 100.0 * WITHIN
        assert set(box["statements"]) == set(STATEMENTS)
        assert {sensor: list(lines) for sensor, lines in box["mesh_lines"].items()} == {
            sensor: [str(speed) for speed in MESH_HZ] for sensor in (TOP, END)
        }


def test_the_documentation_has_the_tables_of_the_study() -> None:
    text = (Path(__file__).parent.parent / "docs" / "rig-spectra.md").read_text(encoding="utf-8")
    for rows in (rig_boxes.statement_rows(FOUND), rig_boxes.count_rows(FOUND), rig_boxes.level_rows(FOUND)):
        assert "\n".join(rows) in text


def test_a_draw_depends_on_its_number_alone() -> None:
    first, again, other = (rig_boxes.start_of_box(number)["housing"]["box"]["wall"] for number in (1, 1, 2))
    assert first == again
    assert all(first[face] != other[face] for face in first)


def test_numbers_are_kept_to_four_digits() -> None:
    assert rig_boxes.rounded({"a": [1.23456, 2], "b": {"c": 123456.0}, "d": True}) == {
        "a": [1.235, 2],
        "b": {"c": 123500.0},
        "d": True,
    }


def test_boxes_that_miss_the_table_and_those_that_were_not_drawn_do_not_count() -> None:
    box = {"errors_percent": [1.0, -4.03], "statements": {}}
    found = {"box-1": box, "box-2": {**box, "errors_percent": [1.0, -4.05]}, "box-3": {"outcome": "refused"}, "x": box}
    assert list(rig_boxes.equal_boxes(found)) == ["box-1"]


@pytest.mark.slow
def test_a_start_that_is_far_off_is_refused(tmp_path: Path) -> None:
    from rig_box_fits import START_RMS_PERCENT, fit_box

    start = rig_boxes.case_of(rig_boxes.start_of_box(8), tmp_path / "box.toml")
    fitted = fit_box(start, None, WITHIN)
    assert (fitted.outcome, fitted.document, fitted.solves) == ("refused", None, 0)
    assert fitted.start_rms_percent > START_RMS_PERCENT
