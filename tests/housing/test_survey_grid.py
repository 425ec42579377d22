"""The survey of 116 points over five faces."""

import numpy as np
import pytest

from gearwhine.housing import HousingError
from gearwhine.housing.measured.survey_planning import SURVEY_COUNTS, Survey, survey_grid
from gearwhine.meshes import BoxGeometry, Mesh

NORMALS = {"top": (0, 1, 0), "left": (-1, 0, 0), "right": (1, 0, 0), "back": (0, 0, -1), "front": (0, 0, 1)}
BOX = np.array([[-0.10, 0.0, -0.12], [0.10, 0.16, 0.12]])


@pytest.fixture(scope="module")
def survey(box: Mesh) -> Survey:
    return survey_grid(box, BOX)


def test_the_rig_had_116_points(survey: Survey) -> None:
    """TM-104434, "Experimental study"."""
    assert sum(columns * rows for columns, rows in SURVEY_COUNTS.values()) == 116
    assert survey.positions.shape == survey.normals.shape == (116, 3)


def test_points_lie_on_their_faces_and_look_outward(survey: Survey, geometry: BoxGeometry) -> None:
    start = 0
    for face, (columns, rows) in SURVEY_COUNTS.items():
        stop = start + columns * rows
        normal = np.array(NORMALS[face], dtype=float)
        np.testing.assert_array_equal(survey.normals[start:stop], np.tile(normal, (columns * rows, 1)))
        outside = np.where(normal > 0, BOX[1], BOX[0]) @ np.abs(normal)
        depth = survey.positions[start:stop] @ np.abs(normal) - outside
        # A point over a boss stands on it, as far out as the boss is long.
        allowed = {0.0, 0.01} if face == "front" else {0.0}
        assert set(np.abs(depth.round(9)).tolist()) <= allowed, face
        start = stop


def test_points_without_a_bore_below_stand_at_the_middles_of_an_even_grid(survey: Survey) -> None:
    columns, rows = SURVEY_COUNTS["top"]
    z, x = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows, indexing="ij")
    expected = np.stack([-0.10 + 0.20 * x, np.full_like(x, 0.16), -0.12 + 0.24 * z], axis=-1).reshape(-1, 3)
    # gmsh's middle nodes are off the middles of straight edges by up to a few millionths of an edge.
    np.testing.assert_allclose(survey.positions[: columns * rows], expected, atol=1e-6)


def test_points_over_a_bore_move_to_its_rim(survey: Survey, geometry: BoxGeometry) -> None:
    for bore in geometry.bores:
        near = np.sign(survey.positions[:, 2]) == np.sign(bore.center[2])
        ends = near & (np.abs(survey.normals[:, 2]) == 1.0)
        radius = np.hypot(*(survey.positions[ends, :2] - np.array(bore.center[:2])).T)
        # Facets are cut straight between corners on the rim.
        assert radius.min() > 0.7 * bore.diameter / 2


def test_linear_fields_are_read_exactly(survey: Survey, box: Mesh) -> None:
    """On plane faces a linear field is read as it is there: u = A x + b."""
    matrix, offset = np.arange(9.0).reshape(3, 3) - 4.0, np.array([1.0, -2.0, 0.5])
    fields = np.stack([(box.points @ matrix.T + offset), np.tile(offset, (len(box.points), 1))])
    expected = np.einsum("pi,pi->p", survey.positions @ matrix.T + offset, survey.normals)
    motion = survey.normal_motion(fields)
    np.testing.assert_allclose(motion[0], expected, atol=1e-12)
    np.testing.assert_allclose(motion[1], survey.normals @ offset, atol=1e-12)


def test_other_grids_can_be_asked_for(box: Mesh) -> None:
    assert len(survey_grid(box, BOX, {"top": (2, 3), "bottom": (1, 1)}).positions) == 7


def test_a_box_that_is_not_the_housing_is_refused(box: Mesh) -> None:
    with pytest.raises(HousingError, match="no part of the housing lies in the box"):
        survey_grid(box, BOX + 5.0)
