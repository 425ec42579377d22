"""Texts of what hardly any result has: documents made by hand, and the numbers of their texts read back from them."""

from typing import Any

import pytest
from numbers_of_texts import foreign_numbers

from gearwhine.output.sections import Section, Table
from gearwhine.results.mesh_lines import line_content
from gearwhine.results.optimisation import _answer, _change, _limit
from gearwhine.results.system import _crossings

Document = dict[str, Any]


def _planets(*errors: float) -> list[Document]:
    return [{"load_share": 0.3 + 1e3 * error, "pin_error_m": [0.1 * error, -error]} for error in errors]


def test_planets_that_differ_are_said_to_by_their_causes() -> None:
    """Of two sets one has pins off their places, by 43 µm at most; the other differs by the housing alone."""
    line = {"cause": "1× set", "harmonic": 1, "turns": {"carrier": -1.0}, "kind": "sideband", "phasing": 0.02}
    line |= {"ideal_phasing": 0.0, "suppressed": True, "frequency_hz": 812.0}
    line["sensor_acceleration_m_per_s2"] = {"together": {"top": 0.2, "side": 0.3}}
    sets = [{"name": "first", "planets": _planets(0.0, 43e-6, 12e-6)}, {"name": "second", "planets": _planets(0.0)}]
    document = {"mesh_lines": [line], "load": {"planetary": sets, "seats": "housing", "gravity_m_per_s2": [0.0, -9.81]}}
    content = list(line_content(document))
    assert foreign_numbers(document, [Section("", tuple(content))]) == []
    (said,) = [str(one) for one in content if str(one).startswith("Equal planets would cancel")]
    first, second = said.partition("The planets of first")[2].split("The planets of second")
    assert "43 µm off" in first
    assert "µm off" not in second
    for words in (first, second):
        assert "gravity and a housing that yields" in words


@pytest.mark.parametrize(
    ("start", "design", "unit", "words"),
    [(81.25, 77.0, "dB", "-4.2 dB"), (8.0, 9.0, "m", "+12.5 %"), (-8.0, -9.0, "m", "-12.5 %"), (0.0, 1.0, "m", "")],
)
def test_an_aim_changes_by_decibels_or_by_a_part_of_its_start(
    start: float, design: float, unit: str, words: str
) -> None:
    assert _change({"start": start, "designs": [design, 0.5 * design], "unit": unit}) == words
    assert _change({"start": start, "designs": [], "unit": unit}) == ""


def test_what_the_best_design_wins_is_said_in_the_units_that_are_shown() -> None:
    """A transmission error of 2.5 µm that becomes 1.25 µm, and a force in newtons, of the first of two designs."""
    error = {"name": "gear_pairs.a -> b.peak_to_peak_m", "start": 2.5e-6, "designs": [1.25e-6, 3e-6], "unit": "m"}
    force = {"name": "bearings.left.force_n", "start": 810.0, "designs": [640.0, 12.0], "unit": "N"}
    chosen = [{"number": number, "design": name} for number, name in ((7, "best"), (9, "quietest"))]
    document = {"chosen": chosen, "aims": [error, force], "limits": [error], "missed": True, "designs": 64}
    (said,) = _answer(document)
    assert said.startswith("Design 7 (best of 64): peak to peak [µm] of ")
    assert " 2.5 → 1.25, force [N] of " in said
    assert said.endswith(" 810 → 640; limits are missed.")
    assert [_limit(error | {key: 2e-6}) for key in ("at_most", "at_least")] == ["≤ 2", "≥ 2"]


def test_crossings_that_the_table_has_no_room_for_are_counted() -> None:
    crossings = [
        {"kind": kind, "line": "1× input", "speed_rpm": -1000.0 - number, "margin": 1e-3 * number - 0.01}
        | {
            "frequency_hz": 900.0 + number,
            "damping_ratio": 0.01,
            "mode": 3,
            "where": "input",
            "whirl": 0.0,
            "teeth": 0.1,
        }
        for number, kind in enumerate(["rotor"] * 42 + ["residual"] * 3)
    ]
    lines = [{"name": "1× input", "kind": "shaft"}]
    document = {"lines": lines, "crossings": crossings, "speeds_rpm": [0.0, -4000.0], "unsettled": []}
    content = list(_crossings(document))
    (table,) = [one for one in content if isinstance(one, Table)]
    shown = len(table.filled()[1])
    assert 0 < shown < 42
    assert str(content[-1]).startswith(f"{45 - shown} more crossings")
    # Those nearest to the operation, by ascending speeds.
    margins = sorted(abs(one["margin"]) for one in crossings[:42])[:shown]
    assert sorted(abs(row["margin"]) for row in table.rows) == margins
    assert [abs(row["speed_rpm"]) for row in table.rows] == sorted(abs(row["speed_rpm"]) for row in table.rows)
