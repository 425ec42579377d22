"""A survey put on the model: nearest points, frames brought together, and what cannot be told."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured import MeasuredGeometry, align_landmarks, align_to_surface, map_survey, outer_facets
from gearwhine.housing.measured.alignment import fit_points
from gearwhine.housing.measured.survey_planning import Survey, survey_grid
from gearwhine.meshes import BoxGeometry, Mesh
from gearwhine.meshes.elements import facet_centers, facet_normals
from gearwhine.numerics.arrays import FloatArray

BOX = np.array([[-0.10, 0.0, -0.12], [0.10, 0.16, 0.12]])
TURN = Rotation.from_euler("xyz", [20, -35, 100], degrees=True).as_matrix()
SHIFT = np.array([0.3, -0.2, 0.5])


@pytest.fixture(scope="module")
def survey(box: Mesh) -> Survey:
    return survey_grid(box, BOX)


@pytest.fixture(scope="module")
def geometry_of_survey(survey: Survey) -> MeasuredGeometry:
    labels = tuple(str(number) for number in range(1, len(survey.positions) + 1))
    return MeasuredGeometry(labels, survey.positions, np.arange(len(labels)), survey.normals)


def moved(geometry: MeasuredGeometry, rotation: FloatArray = TURN, shift: FloatArray = SHIFT) -> MeasuredGeometry:
    return replace(
        geometry, positions=geometry.positions @ rotation.T + shift, directions=geometry.directions @ rotation.T
    )


def test_outer_facets_are_those_on_the_outside(box: Mesh, geometry: BoxGeometry) -> None:
    """Of a closed box with two bores: none of the cavity's walls, all of the outer faces."""
    inside = np.array(geometry.size) / 2.0 - 0.02 + 1e-6
    middle = np.array([0.0, 0.08, 0.0])
    all_centers = facet_centers(box.points, box.boundary)
    on_planes = np.abs(np.abs(all_centers - middle) - np.array(geometry.size) / 2.0) < 1e-6
    on_outside = (on_planes & (np.abs(facet_normals(box.points, box.boundary)) > 1 - 1e-6)).any(axis=1)
    chosen = facet_centers(box.points, outer_facets(box))
    assert not (np.abs(chosen - middle) < inside).all(axis=1).any()
    kept = {tuple(center) for center in chosen.round(9).tolist()}
    missing = [center for center in all_centers[on_outside].round(9).tolist() if tuple(center) not in kept]
    assert missing == []


def test_points_on_the_surface_stay_and_move_as_the_model_does(
    box: Mesh, survey: Survey, geometry_of_survey: MeasuredGeometry
) -> None:
    """The survey grid's own interpolation is another path to the same motions."""
    mapped = map_survey(box, geometry_of_survey)
    assert mapped.far == ()
    assert mapped.distances.max() < 1e-12
    shapes = np.random.default_rng(0).normal(size=(3, len(box.points), 3))
    np.testing.assert_allclose(mapped.shapes(shapes), survey.normal_motion(shapes), atol=1e-12)


def test_a_linear_field_is_read_along_the_measured_direction(box: Mesh, geometry_of_survey: MeasuredGeometry) -> None:
    """On plane faces u = A x is read exactly, along directions askew."""
    matrix, askew = np.arange(9.0).reshape(3, 3), np.array([2.0, -1.0, 2.0]) / 3.0
    top = np.flatnonzero(geometry_of_survey.positions[:, 1] > 0.16 - 1e-9)
    geometry = MeasuredGeometry(
        geometry_of_survey.labels, geometry_of_survey.positions, top, np.tile(askew, (len(top), 1))
    )
    found = map_survey(box, geometry).shapes((box.points @ matrix.T)[None])
    np.testing.assert_allclose(found[0], geometry_of_survey.positions[top] @ matrix.T @ askew, atol=1e-12)


def test_points_off_the_surface_are_told_with_their_distance(box: Mesh, geometry_of_survey: MeasuredGeometry) -> None:
    positions = geometry_of_survey.positions.copy()
    positions[3] += 0.004 * geometry_of_survey.directions[3]
    positions[7] += 0.03 * geometry_of_survey.directions[7]
    mapped = map_survey(box, replace(geometry_of_survey, positions=positions))
    assert mapped.far == ("8",)
    np.testing.assert_allclose(mapped.distances[[3, 7]], [0.004, 0.03], rtol=1e-9)
    assert map_survey(box, replace(geometry_of_survey, positions=positions), tolerance=1e-3).far == ("8", "4")


def test_inner_walls_are_never_taken(box: Mesh, geometry_of_survey: MeasuredGeometry) -> None:
    """Points 15 mm below the faces of 20 mm walls are nearer to the cavity; they still belong to the outside."""
    depth = 0.015
    positions = geometry_of_survey.positions - depth * geometry_of_survey.directions
    middles = [point for point in range(28) if abs(positions[point, 0]) < 0.06 and abs(positions[point, 2]) < 0.08]
    mapped = map_survey(box, replace(geometry_of_survey, positions=positions), tolerance=0.05)
    np.testing.assert_allclose(mapped.distances[middles], depth, rtol=1e-6)


@pytest.mark.parametrize(
    ("scale", "hint"), [(1000.0, "in mm, not in m"), (1 / 0.0254, "in in, not in m"), (1e-3, "not in")]
)
def test_another_unit_is_recognised(box: Mesh, geometry_of_survey: MeasuredGeometry, scale: float, hint: str) -> None:
    with pytest.raises(MeasuredDataError, match=hint):
        map_survey(box, replace(geometry_of_survey, positions=scale * geometry_of_survey.positions))


def test_another_frame_is_refused_with_advice(box: Mesh, geometry_of_survey: MeasuredGeometry) -> None:
    with pytest.raises(MeasuredDataError, match=r"116 points.*It can be aligned"):
        map_survey(box, moved(geometry_of_survey))


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), scale=st.sampled_from([1.0, 1e-3, 25.4]))
def test_landmarks_give_back_the_motion_exactly(seed: int, scale: float) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(5, 3))
    rotation, shift = Rotation.random(rng=rng).as_matrix(), rng.normal(size=3)
    motion, found = fit_points(points / scale, points @ rotation.T + shift)
    np.testing.assert_allclose(motion.rotation, rotation, atol=1e-9)
    assert found == pytest.approx(scale)


def test_a_mirror_image_is_no_rotation() -> None:
    points = np.random.default_rng(1).normal(size=(6, 3))
    motion, _ = fit_points(points, points * [1, 1, -1])
    assert np.linalg.det(motion.rotation) == pytest.approx(1.0)


def test_alignment_by_landmarks(box: Mesh, geometry_of_survey: MeasuredGeometry) -> None:
    given_geometry = moved(geometry_of_survey)
    landmarks = {label: tuple(geometry_of_survey.positions[int(label) - 1]) for label in ("1", "28", "60", "110")}
    alignment = align_landmarks(given_geometry, landmarks)
    assert alignment.largest < 1e-12
    mapped = map_survey(box, given_geometry, alignment=alignment)
    assert mapped.distances.max() < 1e-9
    np.testing.assert_allclose(mapped.geometry.directions, geometry_of_survey.directions, atol=1e-9)
    in_millimetres = replace(given_geometry, positions=1e3 * given_geometry.positions)
    assert "in mm, not in m" in align_landmarks(in_millimetres, landmarks).remarks[0]
    with pytest.raises(MeasuredDataError, match="'lid' is not among"):
        align_landmarks(given_geometry, {"lid": (0.0, 0.0, 0.0)})
    with pytest.raises(MeasuredDataError, match="lie on one line"):
        align_landmarks(given_geometry, {"1": (0.0, 0.0, 0.0), "2": (1.0, 0.0, 0.0)})


@pytest.mark.slow
def test_alignment_by_the_surface_says_what_a_symmetric_box_leaves_open(
    box: Mesh, geometry_of_survey: MeasuredGeometry
) -> None:
    """A box turned by 180° about y is the same box but for its bores: two positions, of which one is right."""
    rng = np.random.default_rng(1)
    given_geometry = moved(geometry_of_survey)
    noisy = replace(given_geometry, positions=given_geometry.positions + 5e-4 * rng.normal(size=(116, 3)))
    alignment = align_to_surface(box, noisy)
    assert alignment.rms < 7e-4
    assert len(alignment.others) == 1
    assert "turned by 180° about y" in alignment.remarks[0]
    errors = [
        np.abs(motion.place(given_geometry.positions) - geometry_of_survey.positions).max()
        for motion in (alignment.motion, *alignment.others)
    ]
    # Distances along the walls say little of where along them: a few times the noise is left.
    assert min(errors) < 3e-3


def test_a_survey_nearly_in_place_is_not_turned(box: Mesh, geometry_of_survey: MeasuredGeometry) -> None:
    small = Rotation.from_euler("y", 4, degrees=True).as_matrix()
    alignment = align_to_surface(box, moved(geometry_of_survey, small, np.array([0.01, 0.0, -0.01])))
    np.testing.assert_allclose(alignment.motion.rotation, small.T, atol=5e-3)


def test_points_on_one_face_alone_can_slide(box: Mesh, geometry_of_survey: MeasuredGeometry) -> None:
    top = geometry_of_survey.positions[:28]
    one_face = MeasuredGeometry(geometry_of_survey.labels[:28], top, np.arange(28), geometry_of_survey.directions[:28])
    alignment = align_to_surface(box, one_face)
    assert any("slide along the surface" in remark for remark in alignment.remarks)


def test_a_point_beside_a_block_lies_on_the_face_it_looks_at(block: Callable[..., Mesh]) -> None:
    """A solid block, whose faces are all outer ones."""
    mesh = block((0.3, 0.2, 0.1), (3, 2, 1), 2)
    geometry = MeasuredGeometry(("a",), np.array([[0.1, 0.07, 0.102]]), np.array([0]), np.array([[0, 0, 1.0]]))
    mapped = map_survey(mesh, geometry)
    np.testing.assert_allclose(mapped.positions, [[0.1, 0.07, 0.1]], atol=1e-12)
    np.testing.assert_allclose(mapped.normals, [[0, 0, 1]], atol=1e-12)
