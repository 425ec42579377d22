"""What a notebook shows of machines, housing modes and cases."""

import math
import re
import runpy
import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import gearwhine as gw


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Formatters that the package registers as IPython imports it, by the name of what they show."""
    formatters: dict[str, Any] = {}

    def for_type_by_name(module: str, name: str, formatter: Any) -> None:
        assert isinstance(getattr(__import__(module, fromlist=[name]), name), type)
        formatters[name] = formatter

    html = SimpleNamespace(for_type_by_name=for_type_by_name)
    shell = SimpleNamespace(display_formatter=SimpleNamespace(formatters={"text/html": html}))
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))  # type: ignore[arg-type]
    runpy.run_path(str(gw.__file__))
    return formatters


def cells(html: str) -> list[list[str]]:
    rows = re.findall(r"<tr>(.*?)</tr>", html, re.DOTALL)
    return [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in rows if "<td" in row]


def test_a_machine_is_shown_by_its_shafts_and_pairs(shown: dict[str, Any]) -> None:
    """Shafts of 240 and 200 mm; 23 on 41 teeth at 3000 rpm."""
    study = gw.load("helical-pair", {"rotor.output.segments.0.length": "200 mm", "bearing.output-right.at": "180 mm"})
    first, second, pair = cells(shown["Machine"](study.machine))
    assert first[0] == "input"
    assert [second[0], *second[4:]] == ["output", "output-left, output-right", "wheel"]
    assert [float(cell) for cell in (*first[1:3], *second[1:3])] == [3000.0, 240.0, -1682.9, 200.0]
    (shaft,) = study.machine.shafts[1].rotor.segments
    mass = math.pi / 4.0 * shaft.outer_diameter**2 * 0.2 * shaft.material.density
    assert float(second[3]) == pytest.approx(mass, rel=1e-3)
    assert pair[0].split() == ["pinion", "→", "wheel"]
    assert pair[1] == "23 : 41"
    assert [float(pair[2]), float(pair[4])] == pytest.approx([41 / 23, 23 * 50.0], rel=1e-4)
    assert shown["Case"](study.case).count("<table>") > 0


def test_modes_are_shown_with_their_proof(shown: dict[str, Any]) -> None:
    certificate = SimpleNamespace(found=2, expected=3, complete=False)
    modes = SimpleNamespace(
        frequencies_hz=np.array([100.0, 250.0]),
        total_damping_ratios=np.array([0.01, 0.02]),
        modes=SimpleNamespace(certificate=certificate),
    )
    html = shown["HousingModes"](modes)
    assert [[float(cell) for cell in row] for row in cells(html)] == [[1.0, 100.0, 1.0], [2.0, 250.0, 2.0]]
    assert "2 modes found, 3 counted" in html
    assert "finding failed" in html


def test_hostile_names_stay_text_in_a_notebook() -> None:
    shown = gw.load("spur-pair", {"title": "<script>alert(1)</script>"})._repr_html_()
    assert "<script>" not in shown
    assert "&lt;script&gt;" in shown
