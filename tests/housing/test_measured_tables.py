"""Measured modes as tables (CSV)."""

from pathlib import Path

import numpy as np
import pytest

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured import MeasuredGeometry, MeasuredModes, SurveyData, read_survey, read_table, write_table


def table(tmp_path: Path, text: str, name: str = "modes.csv") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_frequencies_and_damping(tmp_path: Path) -> None:
    found = read_survey(table(tmp_path, "# the rig\nfrequency_hz;damping_ratio\n1049;0.01\n658;0.02\n")).modes
    np.testing.assert_allclose(found.frequencies, 2 * np.pi * np.array([658.0, 1049.0]))
    np.testing.assert_allclose(found.damping_ratios, [0.02, 0.01])
    assert found.shapes is None


SHAPES = """point,x [mm],y [mm],z [mm],direction,first,second,second imag
frequency_hz,,,,,1049,658,
damping_ratio,,,,,0.01,0.02,
lid 1,0,254,100,y,0.5,1,0.25
lid 1,0,254,100,-x,,-2,
side,139.5,100,0,3 0 4,1e-3,3,0
"""


def test_shapes_with_their_points(tmp_path: Path) -> None:
    found = read_table(table(tmp_path, SHAPES))
    geometry, modes = found.geometry, found.modes
    assert geometry.labels == ("lid 1", "side")
    np.testing.assert_allclose(geometry.positions, [[0, 0.254, 0.1], [0.1395, 0.1, 0]])
    np.testing.assert_array_equal(geometry.points, [0, 0, 1])
    np.testing.assert_allclose(geometry.directions, [[0, 1, 0], [-1, 0, 0], [0.6, 0, 0.8]])
    np.testing.assert_allclose(modes.frequencies, 2 * np.pi * np.array([658.0, 1049.0]))
    np.testing.assert_allclose(modes.damping_ratios, [0.02, 0.01])
    np.testing.assert_array_equal(modes.shapes, [[1 + 0.25j, -2, 3], [0.5, complex(np.nan, np.nan), 1e-3]])


def test_a_round_trip_is_exact(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    directions = rng.normal(size=(5, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    geometry = MeasuredGeometry(("a", "b", "c"), rng.normal(size=(3, 3)), np.array([0, 0, 1, 2, 2]), directions)
    shapes = rng.normal(size=(4, 5)) + 1j * rng.normal(size=(4, 5))
    shapes[1, 2] = np.nan
    modes = MeasuredModes(np.sort(rng.uniform(1, 9, 4)), rng.uniform(0, 0.1, 4), shapes, geometry)
    write_table(tmp_path / "s.csv", SurveyData(geometry, modes))
    again = read_table(tmp_path / "s.csv")
    np.testing.assert_array_equal(again.geometry.positions, geometry.positions)
    np.testing.assert_allclose(again.geometry.directions, directions, atol=2e-16)
    np.testing.assert_array_equal(again.modes.shapes, shapes)
    np.testing.assert_array_equal(again.modes.damping_ratios, modes.damping_ratios)
    np.testing.assert_allclose(again.modes.frequencies, modes.frequencies, rtol=1e-15)
    plain = SurveyData(modes=MeasuredModes(modes.frequencies))
    write_table(tmp_path / "f.csv", plain)
    np.testing.assert_allclose(read_table(tmp_path / "f.csv").modes.frequencies, modes.frequencies, rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("mode,hz\n1,658\n", r"first column is 'mode'; expected 'frequency_hz'.*or 'point'"),
        ("frequency_hz\n", "needs a header and at least one row"),
        ("frequency_hz\n658\nfast\n", "line 3 of modes.csv: 'fast' is not a number"),
        ("frequency_hz,ratio\n658,0.1\n", "expected 'frequency_hz' and, if known, 'damping_ratio'"),
        ("frequency_hz\n-658\n", "must be positive"),
        ("frequency_hz\n658,1\n", "line 2 of modes.csv has 2 cells; expected 1"),
        (SHAPES.replace("frequency_hz,,,,,1049,658,\n", ""), "no row 'frequency_hz'"),
        (SHAPES.replace("3 0 4", "up"), "line 6 of modes.csv: 'up' is not a number"),
        (SHAPES.replace("3 0 4", "3 4"), "line 6 of modes.csv: direction '3 4'"),
        (
            SHAPES.replace("lid 1,0,254,100,-x", "lid 1,1,254,100,-x"),
            "line 5 of modes.csv: point lid 1 stands at another",
        ),
        (SHAPES.replace("[mm]", "[furlong]"), "'furlong'; expected one of m, mm, cm, in"),
        (SHAPES.replace("direction", "normal"), "expected point, x, y, z, direction"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read_table(table(tmp_path, text))


def test_files_of_another_kind_are_refused(tmp_path: Path) -> None:
    with pytest.raises(MeasuredDataError, match="expected a universal file"):
        read_survey(tmp_path / "modes.xlsx")
    with pytest.raises(MeasuredDataError, match="cannot be read"):
        read_survey(tmp_path / "missing.csv")
    path = tmp_path / "binary.csv"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(MeasuredDataError, match="not text"):
        read_table(path)
