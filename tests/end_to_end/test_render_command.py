"""`gearwhine render` beyond modes: lines of a run, measured shapes, films, and a renderer that dies."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from gearwhine.mode_pictures import moving_shapes
from gearwhine.output.manifest import MANIFEST, opened_dataset

pytestmark = pytest.mark.rendered

CASE = ("small-gearbox", "--set", "housing.box.mesh_size=40 mm", "--set", "housing.frequency_limit=2.2 kHz", "-q")


@pytest.fixture
def run_on_file(gearwhine, tmp_path: Path) -> Path:
    """The modes' results file with a spectrum put in: mode 2 alone moves, at 1 m √kg / s² on the line of 500 Hz."""
    outcome = gearwhine("modes", *CASE, "-o", "out", "--json")
    assert outcome.code == 0, outcome.err
    path = tmp_path / "out" / "results.nc"
    with opened_dataset(path) as dataset:
        content = dataset.load()
    spectrum = np.zeros((len(content["housing_mode"]), 21, 2))
    spectrum[1, 10, 1] = 1.0
    content["housing_acceleration_spectrum"] = (("housing_mode", "housing_line", "part"), spectrum)
    content["line_frequency"] = (("sensor", "line"), [[500.0, np.nan]] * 2)
    content["line_name"] = (("sensor", "line"), [["1× shaft", ""]] * 2)
    content = content.assign_coords(housing_line=np.arange(21) * 50.0)
    path.unlink()
    content.to_netcdf(path, engine="h5netcdf")
    (path.parent / MANIFEST).unlink()  # its digest is that of the file before
    return path


@pytest.mark.slow
def test_an_interactive_report_has_the_shapes_of_the_folder(gearwhine, run_on_file: Path, tmp_path: Path) -> None:
    outcome = gearwhine("report", *CASE, "--interactive", "-o", "out", "--json")
    assert outcome.code == 0, outcome.err
    assert outcome.document["files"] == ["report-interactive.html"]
    assert not (tmp_path / "out" / "report.html").exists()
    page = (tmp_path / "out" / "report-interactive.html").read_text(encoding="utf-8")
    listed = re.findall(r'data-shape="\d+" data-picture="([^"]+)"', page)
    with xr.open_dataset(tmp_path / "out" / "modes.nc", engine="h5netcdf") as kept:
        modes = kept["frequency"].values
        shape = kept["shape"].values[1]
    assert listed == ["line-500.0Hz", *(f"mode-{n:02d}-{hertz:.0f}Hz" for n, hertz in enumerate(modes, start=1))]
    # The line is mode 2 alone, and so says its size as `render` does.
    told = re.search(r'data-title="([^"]*1× shaft)" data-note="largest ([\d.e+-]+) µm', page)
    assert told is not None
    largest = np.linalg.norm(shape, axis=1).max() / (2.0 * np.pi * 500.0) ** 2
    assert float(told[2]) == pytest.approx(1e6 * largest, rel=1e-2)
    # Modes of another solution may have other signs: no line is made of them.
    with opened_dataset(run_on_file) as dataset:
        content = dataset.load()
    content["survey_shape"][1] *= -1.0
    run_on_file.unlink()
    content.to_netcdf(run_on_file, engine="h5netcdf")
    assert [shape.name for shape in moving_shapes(tmp_path / "out")] == listed[1:]
    (tmp_path / "out" / "modes.nc").unlink()
    assert moving_shapes(tmp_path / "out") == []


@pytest.mark.slow
def test_a_line_is_drawn_in_its_true_size(gearwhine, run_on_file: Path, tmp_path: Path) -> None:
    """One mode's line: its share is 1, and its largest acceleration that of the mode's own shape on file."""
    outcome = gearwhine("render", *CASE, "-o", "out", "--line", "490", "--json")
    assert outcome.code == 0, outcome.err
    (line,) = outcome.document["lines"]
    assert line["frequency_hz"] == pytest.approx(500.0)
    assert line["modes"][0]["number"] == 2
    assert line["modes"][0]["kinetic_energy_share"] == pytest.approx(1.0)
    with xr.open_dataset(tmp_path / "out" / "modes.nc", engine="h5netcdf") as kept:
        shape = kept["shape"].values[1]
    largest = np.linalg.norm(shape, axis=1).max()
    assert line["largest_acceleration_m_per_s2"] == pytest.approx(largest, rel=1e-6)
    assert line["largest_displacement_m"] == pytest.approx(largest / (2 * np.pi * 500.0) ** 2, rel=1e-6)
    # Beside the run's results, in a place of its own.
    assert "render/line-500.0Hz.png" in outcome.document["files"]
    assert not any(name.startswith("mode-") for name in outcome.document["files"])
    beyond = gearwhine("render", *CASE, "-o", "out", "--line", "1100")
    assert beyond.code == 2
    assert "a line from 50 to 1000 Hz, which stand 50 Hz apart" in beyond.err
    with opened_dataset(run_on_file) as dataset:
        content = dataset.load()
    content["survey_shape"][1] *= -1.0
    run_on_file.unlink()
    content.to_netcdf(run_on_file, engine="h5netcdf")
    other = gearwhine("render", *CASE, "-o", "out", "--line", "500")
    assert other.code == 2
    assert "these results are another's" in other.err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--line", "500"), "after 'gearwhine run'"),
        (("--line", "-3"), "a frequency above zero"),
        (("--line", "500", "--format", "glb"), "png, gif or mp4 with --line"),
        (("--measured",), "a survey with points and shapes"),
    ],
)
def test_what_cannot_be_drawn_is_said(gearwhine, arguments: tuple[str, ...], said: str) -> None:
    outcome = gearwhine("render", *CASE, "-o", "out", *arguments)
    assert outcome.code == 2
    assert said in outcome.err


@pytest.mark.slow
def test_a_renderer_that_dies_is_told_of_and_leaves_no_pictures(
    gearwhine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """VTK's window for an X server ends its process where there is none."""
    monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "vtkXOpenGLRenderWindow")
    monkeypatch.delenv("DISPLAY", raising=False)
    outcome = gearwhine("render", *CASE, "-o", "out", "--modes", "1")
    assert outcome.code == 1
    assert "the renderer" in outcome.err
    assert "libegl1" in outcome.err
    assert "Traceback" not in outcome.err
    assert not (tmp_path / "out").exists()
