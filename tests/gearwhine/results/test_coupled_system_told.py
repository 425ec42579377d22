"""What the coupled system says of modes that nothing damps, and of a sum rule that its modes miss."""

from typing import Any, cast

import numpy as np
import pytest

from gearwhine.coupling.linear.frequency_response import BasisError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.output.sections import Table
from gearwhine.results.mesh_lines import line_content
from gearwhine.results.sensor_line_estimates import add_uncertainty
from gearwhine.results.system import sections

STRAINED = {"kind": "gear_meshes", "name": "s -> p", "share": 0.62}
CERTIFICATE = {"found": 8, "expected": 8, "zeros": 2, "max_residual": 1e-12}


def _mode(hertz: float, ratio: float) -> dict[str, Any]:
    energy = dict.fromkeys(("housing", "torsion", "axial", "residual", "mesh", "body", "pedestal"), 0.0) | {
        "rotor": 1.0
    }
    mode = {"number": 1, "frequency_hz": hertz, "damped_frequency_hz": hertz, "damping_ratio": ratio}
    return mode | {"kind": "rotor", "where": "sun", "energy": energy, "strained_most": STRAINED}


def _told(sum_rule: float, *, complete: bool, whirl: float = 0.0) -> tuple[str, list[Any]]:
    peaks = [{"frequency_hz": hertz, "amplitude": 1e6 * height} for hertz, height in ((500.0, 90.0), (800.0, 3.0))]
    response = {"excitation": "transmission error of s -> p", "per": "m"}
    document = {
        "coordinates": 4,
        "speed_rpm": 3000.0,
        "modes": [_mode(500.0, 1e-5), _mode(800.0, 0.02) | {"whirl": whirl}],
        "certificate": CERTIFICATE | {"sum_rule": sum_rule, "complete": complete},
        "transmissibility": [response | {"mesh_force_n": {"s -> p": peaks}, "sensor_acceleration_m_per_s2": {}}],
    }
    content = [one for section in sections(document) for one in section.content]
    return " ".join(str(one) for one in content if isinstance(one, str)), content


def test_a_peak_that_nothing_damps_comes_last_without_a_height() -> None:
    text, content = _told(1e-14, complete=True)
    cells = [cell for table in content if isinstance(table, Table) for row in table.filled()[1] for cell in row]
    assert "800 (3)  500 (undamped)" in cells
    assert cells.count("teeth of s -> p 62 %") == 2
    assert "damping ratio is below 0.001" in text


def test_a_missed_sum_rule_is_no_proof() -> None:
    assert "sum rule kept to 1e-14." in _told(1e-14, complete=True)[0]
    text = _told(0.2, complete=False)[0]
    assert "sum rule missed by 2e-01" in text
    assert "responses are solved directly" in text


def test_arrows_of_whirl_have_a_legend() -> None:
    """`whirl` is 1 of a counter-clockwise circle, seen from +z."""
    text, content = _told(1e-14, complete=True, whirl=1.0)
    table = next(one for one in content if isinstance(one, Table))
    assert any("rotor: sun ↺" in cell for row in table.filled()[1] for cell in row)
    assert "↺ counter-clockwise" in text
    assert "↺" not in _told(1e-14, complete=True)[0]


def _line(hertz: float, together: float, in_all: float) -> dict[str, Any]:
    parts = {
        "by_transmission_error": {"top": together},
        "by_load_shuttling": {"top": 0.1},
        "together": {"top": together},
    }
    line = {"frequency_hz": hertz, "cause": "1× a -> b", "order": 1.0, "sensor_acceleration_m_per_s2": parts}
    return line | {"band_db": {"top": [-1.0, 1.0]}, "parts_together_m_per_s2": {"top": in_all}}


def test_a_line_that_pitch_errors_of_another_stage_meet_is_ranked_by_all_of_them() -> None:
    table, words = list(line_content({"mesh_lines": [_line(1112.0, 5.0, 5.0), _line(376.0, 4.7, 15.8)]}))[1:3]
    assert isinstance(table, Table)
    columns, rows = table.filled()
    headings = [column.heading for column in columns]
    assert [row[headings.index("in all")] for row in rows] == ["15.8", "5"]
    assert "pitch deviations of the other gears" in str(words)
    table, words = list(line_content({"mesh_lines": [_line(1112.0, 5.0, 5.01)]}))[1:3]
    assert isinstance(table, Table)
    assert "in all" not in [column.heading for column in table.filled()[0]]
    assert "In all" not in str(words)


def test_lines_by_the_meshes_have_the_error_of_the_modal_basis_at_their_own_frequency() -> None:
    class Error:
        def at(self, frequencies: FloatArray) -> dict[str, FloatArray]:
            hertz = frequencies / (2.0 * np.pi)
            return {"top": 1e-5 * hertz, "side": 2e-5 * hertz}

    lines: list[dict[str, Any]] = [{"frequency_hz": hertz} for hertz in (1400.0, 700.0)]
    peak: dict[str, Any] = {"frequency_hz": 900.0}
    document = {"mesh_lines": lines, "sensors": [{"name": "side", "peaks": [peak]}]}
    add_uncertainty(document, cast("BasisError", Error()), None)
    assert [line["uncertainty"]["top"] for line in lines] == pytest.approx([0.014, 0.007])
    assert [line["uncertainty"]["side"] for line in lines] == pytest.approx([0.028, 0.014])
    assert peak["uncertainty"] == pytest.approx(0.018)
