"""Pictures and tables of a comparison: what they show of pairs that are known."""

import csv
from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import Rectangle

from gearwhine.figures import (
    draw_comparison,
    draw_comparison_figures,
    draw_coordinate_criteria,
    draw_mac_matrix,
    save,
    save_all,
)
from gearwhine.housing import compare_by_shapes
from gearwhine.housing.correlation.comparison import Comparison, ModePair
from gearwhine.housing.measured import MeasuredGeometry, MeasuredModes
from gearwhine.results.comparison import dof_names, write_comparison

HERTZ = 2.0 * np.pi
# TM-104434, Table II: measured, analytical, difference in per cent as printed.
TABLE_II = [
    (658, 658, 0.0),
    (1049, 1006, -4.1),
    (1710, 1762, 3.0),
    (2000, 2051, 2.6),
    (2276, 2336, 2.6),
    (2536, 2536, 0.0),
    (2722, 2752, 1.1),
    (2962, 3012, 1.7),
]
MODEL = HERTZ * np.array(sorted([pair[1] for pair in TABLE_II] + [900.0, 1500.0]))  # two more beside the source's
SOURCE = Comparison(
    tuple(
        ModePair(HERTZ * a, HERTZ * b, n, int(np.searchsorted(MODEL, HERTZ * b)) + 1, 0.01)
        for n, (a, b, _) in enumerate(TABLE_II, start=1)
    ),
    "dominance",
    "dominance in order of frequency",
    (HERTZ * 500.0, HERTZ * 3100.0),
    gap=0.2,
    measures_agree=True,
)
GEOMETRY = MeasuredGeometry(
    ("1", "2", "3", "4", "5", "6"),
    np.zeros((6, 3)),
    np.arange(6),
    np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0], [0, 0, -1.0], [0.6, 0.8, 0], [0, 0, 1.0]]),
)


def _by_shapes() -> tuple[Comparison, np.ndarray]:
    """Five model modes; a test of the first, third and fourth, and one that is none of them."""
    x = np.arange(1, 7) / 7
    shapes = np.sin(np.pi * np.outer(np.arange(1, 6), x))
    frequencies = HERTZ * np.array([100.0, 200.0, 300.0, 400.0, 500.0])
    stray = np.sin(6 * np.pi * x)
    test = np.array([shapes[0], stray, shapes[2], shapes[3]]) + 0.0j
    measured = MeasuredModes(HERTZ * np.array([101.0, 180.0, 295.0, 408.0]), None, test, GEOMETRY)
    return compare_by_shapes(frequencies, shapes, measured), frequencies


def _read(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_source_s_table_stands_on_the_plane_within_its_band(tmp_path: Path) -> None:
    figure = draw_comparison("Table II", SOURCE, MODEL)
    plane, below = figure.axes
    pairs = next(group for group in plane.collections if group.get_label() == "pairs")
    assert np.asarray(pairs.get_offsets()) == pytest.approx(np.array([pair[:2] for pair in TABLE_II], dtype=float))
    errors = next(line for line in below.lines if line.get_label() == "error")
    printed = [error for _, _, error in TABLE_II]
    assert np.asarray(errors.get_ydata()) == pytest.approx(printed, abs=0.051)  # the source rounds 2.55 up
    (stems,) = (group for group in below.collections if len(group.get_paths()) == len(TABLE_II))
    ends = np.array([path.vertices[[0, -1]] for path in stems.get_paths()])
    assert ends[:, 0, 1] == pytest.approx(0.0)
    assert ends[:, 1, 1] == pytest.approx(printed, abs=0.051)
    band = plane.collections[0].get_paths()[0].vertices
    edge = plane.get_xlim()[1]
    assert (0.95 * edge, 1.05 * edge) == pytest.approx(sorted(set(band[np.isclose(band[:, 0], edge), 1])))
    others = [line.get_ydata()[0] for line in plane.lines if line.get_label() == "_unpaired model"]
    assert others == pytest.approx([900.0, 1500.0])
    save(figure, tmp_path / "comparison.png")


def test_shapes_add_every_mac_and_what_has_no_partner() -> None:
    comparison, frequencies = _by_shapes()
    assert comparison.shapes is not None
    assert comparison.shapes.unpaired_measured == (2,)
    assert comparison.shapes.unpaired_model == (2,)
    plane = draw_comparison("Beam", comparison, frequencies).axes[0]
    marked = [line for line in plane.lines if line.get_label() == "_unpaired measured"]
    assert [line.get_xdata()[0] for line in marked] == pytest.approx([180.0])
    missing = [line for line in plane.lines if line.get_label() == "_unpaired model"]
    assert [line.get_ydata()[0] for line in missing] == pytest.approx([200.0])
    assert missing[0].get_color() == marked[0].get_color()


def test_a_matrix_shows_its_values_and_outlines_pairs(tmp_path: Path) -> None:
    values = np.array([[1.0, 0.02], [0.3, 0.87], [0.0, 0.4]])
    figure = draw_mac_matrix("$x", values, ["1", "2", "3"], ["a", "b"], outlined=[(0, 0), (1, 1)])
    axes = figure.axes[0]
    texts = {text.get_position(): text.get_text() for text in axes.texts}
    assert texts == {(0.5, 0.5): "1.00", (0.5, 1.5): "0.30", (1.5, 1.5): "0.87", (1.5, 2.5): "0.40"}
    boxes = [patch.get_xy() for patch in axes.patches if isinstance(patch, Rectangle)]
    assert boxes == [(0.0, 0.0), (1.0, 1.0)]
    mesh = axes.collections[0]
    assert np.asarray(mesh.get_array()).reshape(3, 2) == pytest.approx(values)
    save(figure, tmp_path / "mac.png")
    with pytest.raises(ValueError, match="2 and 2 names for values of shape"):
        draw_mac_matrix("", values, ["1", "2"], ["a", "b"])


def test_a_large_matrix_leaves_numbers_out_and_stays_on_the_sheet() -> None:
    names = [str(number) for number in range(80)]
    figure = draw_mac_matrix("", np.eye(80), names, names)
    assert not figure.axes[0].texts
    assert figure.get_size_inches()[1] * 25.4 < 260.0


def test_what_stands_out_is_named() -> None:
    enhanced = np.full(20, 0.02)
    enhanced[7] = 0.4
    enhanced[3] = np.nan
    figure = draw_coordinate_criteria("", np.ones(20), enhanced, [f"p{number}" for number in range(20)])
    drawn = [text.get_text() for axes in figure.axes for text in axes.texts] + [
        text.get_text() for text in figure.texts
    ]
    assert "p7" in drawn
    assert "p8" not in drawn
    with pytest.raises(ValueError, match="for 2 degrees of freedom"):
        draw_coordinate_criteria("", np.ones(3), np.ones(3), ["a", "b"])


def test_degrees_of_freedom_are_named_by_point_and_direction() -> None:
    assert dof_names(GEOMETRY) == ["1 +x", "2 -x", "3 +y", "4 -z", "5 (0.60 0.80 0.00)", "6 +z"]


def test_files_of_a_comparison_by_frequency(tmp_path: Path) -> None:
    assert write_comparison(tmp_path, SOURCE) == ["comparison.csv"]
    assert save_all(draw_comparison_figures("Rig", SOURCE, MODEL), tmp_path) == ["comparison.png"]
    rows = _read(tmp_path / "comparison.csv")
    assert [(float(row["measured_hz"]), float(row["model_hz"])) for row in rows] == [pair[:2] for pair in TABLE_II]
    assert {row["mac"] for row in rows} == {""}


def test_files_of_a_comparison_by_shape(tmp_path: Path) -> None:
    comparison, frequencies = _by_shapes()
    files = write_comparison(tmp_path, comparison, GEOMETRY)
    files += save_all(draw_comparison_figures("Beam", comparison, frequencies, GEOMETRY), tmp_path)
    expected = {"comparison.csv", "comparison.png", "mac.csv", "mac.png", "auto-mac.png", "cross-orthogonality.png"}
    assert set(files) == expected | {"comac.csv", "comac.png"}
    assert all((tmp_path / name).stat().st_size > 0 for name in files)
    rows = _read(tmp_path / "comparison.csv")
    assert [row["measured_mode"] for row in rows] == ["1", "2", "3", "4"]
    assert [row["mode"] for row in rows] == ["1", "", "3", "4"]
    assert [float(row["mac"]) for row in rows if row["mac"]] == pytest.approx([1.0] * 3)
    table = np.loadtxt(tmp_path / "mac.csv", delimiter=",", skiprows=1)
    assert comparison.shapes is not None
    assert table[:, 2:] == pytest.approx(comparison.shapes.mac, rel=1e-5, abs=1e-9)
    assert [row["degree_of_freedom"] for row in _read(tmp_path / "comac.csv")] == dof_names(GEOMETRY)
