"""A survey as a wireframe: lines of grids, motions from directions, shapes laid over each other; all by closed form."""

import numpy as np
import pytest

from gearwhine.housing.measured import MeasuredGeometry
from gearwhine.housing.pictures.drawn_shapes import laid_over, point_motions, wireframe


def _grid(columns: int, rows: int, lines: tuple[tuple[int, ...], ...] = ()) -> MeasuredGeometry:
    places = np.array([[x, y, 0.0] for x in range(columns) for y in range(rows)], dtype=float)
    count = len(places)
    labels = tuple(map(str, range(count)))
    return MeasuredGeometry(labels, places, np.arange(count), np.tile([0.0, 0.0, 1.0], (count, 1)), lines)


def test_without_lines_a_grid_is_joined_along_its_columns_and_rows() -> None:
    geometry = _grid(5, 4)
    edges = wireframe(geometry)
    lengths = np.linalg.norm(np.diff(geometry.positions[edges], axis=1)[:, 0], axis=1)
    np.testing.assert_allclose(lengths, 1.0)
    assert len(edges) == 5 * 3 + 4 * 4


def test_the_surveys_own_lines_are_kept_each_once() -> None:
    edges = wireframe(_grid(3, 1, lines=((0, 2), (2, 0), (2, 1, 0))))
    assert edges.tolist() == [[0, 1], [0, 2], [1, 2]]


def test_one_point_has_no_lines() -> None:
    assert wireframe(_grid(1, 1)).shape == (0, 2)


def test_a_motion_measured_in_three_skew_directions_is_found_and_what_is_missing_rests() -> None:
    directions = np.array([[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.0, 0.6, 0.8], [0.0, 0.0, 1.0]])
    geometry = MeasuredGeometry(("a", "b"), np.eye(3)[:2], np.array([0, 0, 0, 1]), directions)
    motion = np.array([0.3, -0.2, 0.5])
    found = point_motions(geometry, np.array([*(directions[:3] @ motion), np.nan]))
    np.testing.assert_allclose(found, [motion, [0.0, 0.0, 0.0]], atol=1e-12)


@pytest.mark.parametrize("scale", [2.0, -0.1, 3.0 * np.exp(2.0j)])
def test_a_scaled_and_turned_shape_lies_on_the_models(scale: complex) -> None:
    model = np.random.default_rng(0).normal(size=12)
    measured = scale * model.astype(complex)
    measured[3] = np.nan
    laid = laid_over(measured, model)
    assert np.isnan(laid[3])
    np.testing.assert_allclose(np.delete(laid, 3), np.delete(model, 3), rtol=1e-12)
