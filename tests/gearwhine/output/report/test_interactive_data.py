"""Data of the curves and shapes of an interactive report: each block, unpacked, holds what the results file holds."""

import base64
import gzip
import hashlib
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from gearwhine.output.report.interactive import MovingShape, Scripts, live_parts
from gearwhine.output.sections import Curves, Section

SPECTRA = Curves("acceleration", ("frequency",), "Spectra -> lines.")
MAPS = Curves("map", ("frequency", "speed"), "Run-up.", logarithmic=False)
BROKEN = Curves("nothing", ("frequency",), "No such array.")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Spectra of three sensors, one silent, trusted up to 30 Hz; a map of each over two speeds."""
    frequency, speed = np.array([0.0, 10.0, 20.0, 30.0, 40.0]), np.array([1000.0, 2000.0])
    spectra = np.array([[1.0, 2.0, 3.0, 4.0, 5.0], np.zeros(5), [60.0, 70.0, np.nan, 90.0, 100.0]])
    maps = spectra[:, None, :] * np.array([1.0, 7.0])[:, None]
    axes = {"units": "Hz", "long_name": "frequency"}, {"units": "rpm", "long_name": "speed"}
    xr.Dataset(
        {
            "acceleration": (
                ("sensor", "frequency"),
                spectra,
                {"units": "m s-2", "long_name": "acceleration", "trusted_below_hz": 30.0},
            ),
            "map": (("sensor", "speed", "frequency"), maps, {"units": "see map_unit"}),
        },
        {
            "sensor": ["top", "silent", "side"],
            "frequency": ("frequency", frequency, axes[0]),
            "speed": ("speed", speed, axes[1]),
        },
    ).to_netcdf(tmp_path / "results.nc", engine="h5netcdf")
    return tmp_path


def blocks(html: str, kind: str) -> list[bytes]:
    found = re.findall(rf'<script type="application/gzip" class="{kind}"[^>]*>(.*?)</script>', html)
    return [gzip.decompress(base64.b64decode(one)) for one in found]


def test_curves_are_those_of_the_file_by_name_and_unit(folder: Path) -> None:
    scripts = Scripts()
    inner = Section("maps", curves=(MAPS, BROKEN))
    outer = Section("spectra", inner=(inner,), curves=(SPECTRA,))
    html = live_parts(scripts, folder, [outer])
    assert [html[id(one)].count("<figure") for one in (outer, inner)] == [1, 2]
    assert re.findall(r'data-plot="(\d+)"', html[id(outer)] + html[id(inner)]) == ["0", "1", "2"]
    spectra, top, side = (json.loads(one) for one in blocks(scripts.written(), "drawing"))
    assert spectra["value"] == "acceleration [m\N{NO-BREAK SPACE}s⁻²]"
    assert (spectra["axes"], spectra["logarithmic"]) == (["frequency [Hz]"], True)
    # The sensor that shows nothing has no curve, nor has any beyond what is trusted.
    assert spectra["x"] == [0.0, 10.0, 20.0, 30.0]
    curves = [{"name": "top", "y": [1.0, 2.0, 3.0, 4.0]}, {"name": "side", "y": [60.0, 70.0, None, 90.0]}]
    assert spectra["curves"] == curves
    assert "Spectra → lines." in html[id(outer)]
    for drawing, name, row in (
        (top, "top", [1.0, 2.0, 3.0, 4.0, 5.0]),
        (side, "side", [60.0, 70.0, None, 90.0, 100.0]),
    ):
        assert (drawing["caption"], drawing["value"], drawing["logarithmic"]) == (f"Run-up: {name}.", "Run-up", False)
        assert drawing["axes"] == ["frequency [Hz]", "speed [rpm]"]
        assert (drawing["x"], drawing["y"]) == ([0.0, 10.0, 20.0, 30.0, 40.0], [1000.0, 2000.0])
        assert drawing["z"] == [row, [None if value is None else 7.0 * value for value in row]]


def test_nothing_is_drawn_without_a_file_or_a_declaration(folder: Path, tmp_path: Path) -> None:
    section = Section("spectra", curves=(SPECTRA,))
    assert live_parts(None, folder, [section]) == {}
    assert live_parts(Scripts(), folder, [Section("words", ("text",))]) == {}
    assert live_parts(Scripts(), tmp_path / "elsewhere", [section]) == {}
    assert Scripts().viewer([]) == ""


def test_shapes_stand_under_their_numbers_and_the_policy_allows_what_stands_there(folder: Path) -> None:
    shapes = [MovingShape(f"mode-{n}", f"mode {n} -> <up>", f"note {n}", bytes([n]) * 9) for n in (1, 2)]
    scripts = Scripts(shapes)
    assert [shape.place for shape in shapes] == ["picture mode-1", "picture mode-2"]
    entries: list[Any] = re.findall(
        r'<li id="(\w+)"><button type="button" data-shape="(\d)" data-picture="([\w-]+)">(.*?)</button>',
        scripts.viewer(["a", "b"]),
    )
    assert [entry[:3] for entry in entries] == [("a", "0", "mode-1"), ("b", "1", "mode-2")]
    assert all("&lt;up&gt;" in entry[3] for entry in entries)
    live_parts(scripts, folder, [Section("spectra", curves=(SPECTRA,))])
    html = scripts.written()
    assert blocks(html, "model") == [shape.model for shape in shapes]
    assert re.findall(r'data-title="(.*?)" data-note="(.*?)"', html) == [
        (f"mode {n} → &lt;up&gt;", f"note {n}") for n in (1, 2)
    ]
    assert re.findall(r'class="library" data-name="([\w-]+)"', html) == ["model-viewer", "plotly"]
    run = [*blocks(html, "library"), re.findall(r"<script>(.*?)</script>", html, re.DOTALL)[0].encode()]
    allowed = re.findall(r"'sha256-(.*?)'", scripts.policy())
    assert allowed == [base64.b64encode(hashlib.sha256(text).digest()).decode() for text in run]
