"""Pitch deviations of a case file: read, written back, and handed on to the gears and the contacts of the machine."""

import math
import tomllib
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled

from gearwhine.case import Case, CaseError, dump_case, load_case, parse_case
from gearwhine.coupling.gears.geometry.pitch_deviations import pitch_gaps
from gearwhine.from_case.machine import solve_gears

MICROMETRES = [0.0, 1.0, -2.5, *([0.5] * 25)]


def document_with(pitch: object) -> dict[str, Any]:
    document = tomllib.loads(files("gearwhine.cases").joinpath("spur-pair.toml").read_text(encoding="utf-8"))
    document["gear"][0]["errors"] = {"eccentricity": "1 um", "pitch": pitch}
    return document


def case_with(pitch: object) -> Case:
    return parse_case(document_with(pitch))


def test_deviations_are_lengths_tooth_by_tooth() -> None:
    case = case_with([f"{value} um" for value in MICROMETRES])
    assert case.gear[0].errors.pitch == pytest.approx([1e-6 * value for value in MICROMETRES], rel=1e-12)
    assert case.gear[1].errors.pitch == ()
    assert case.parts.gears[case.gear[0].name].pitch_deviations == case.gear[0].errors.pitch


def test_written_back_they_load_equal() -> None:
    case = case_with([f"{value} um" for value in MICROMETRES])
    assert parse_case(tomllib.loads(dump_case(case))) == case


def test_a_length_for_each_tooth_within_reason() -> None:
    with pytest.raises(CaseError, match=r"at most 0\.001 m"):
        case_with(["1 um"] * 27 + ["2 mm"])
    with pytest.raises(CaseError, match="a length"):
        case_with(["1 um"] * 27 + ["1 deg"])
    with pytest.raises(CaseError, match="one deviation for each of 28 teeth, or none"):
        case_with(["1 um"] * 27)


def test_bundled_cases_have_none() -> None:
    case = load_case("spur-pair").case
    assert all(pair.contact.pitch_gaps.size == 0 for pair in solve_gears(case.parts))


def test_they_reach_both_flanks_of_the_machine() -> None:
    case = case_with([f"{value} um" for value in MICROMETRES])
    pairs = solve_gears(case.parts)
    drive, back = coupled(case).system.contacts
    expected = -np.array(MICROMETRES) * 1e-6 * math.cos(math.radians(20.0))
    np.testing.assert_allclose(drive.contact.pitch_gaps, expected, rtol=1e-9)
    np.testing.assert_array_equal(drive.contact.pitch_gaps, pitch_gaps(pairs[0].geometry))
    # On the other side the same displacements with the other sign, met in the opposite order.
    backwards = [np.roll(-expected[::-1], shift) for shift in range(28)]
    assert any(np.allclose(back.contact.pitch_gaps, row, rtol=1e-9) for row in backwards)
