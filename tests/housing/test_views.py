"""Directions of view: the corner that shows most of the motion, and a housing that stands upright."""

from collections.abc import Callable

import numpy as np
import pytest

from gearwhine.housing.errors import HousingError
from gearwhine.housing.pictures.drawn_shapes import DrawnHousing, DrawnShape, drawn_housing
from gearwhine.housing.pictures.gltf import _upright
from gearwhine.housing.pictures.views import _turn, check_view, view_of_most_motion, viewing_direction
from gearwhine.meshes import Mesh

X, Y, Z = np.eye(3)


@pytest.fixture
def surface(block_of: Callable[..., Mesh]) -> DrawnHousing:
    return drawn_housing(block_of("hexahedron20", (0.3, 0.2, 0.2), (9, 6, 6)))


def _bulging(surface: DrawnHousing, axis: int, high: bool, rest: float = 0.0) -> DrawnShape:
    """Bulge one face of the block; all else moves by `rest` of it."""
    end = surface.rest[:, axis].max() if high else surface.rest[:, axis].min()
    strength = np.where(np.isclose(surface.rest[:, axis], end), 1.0, rest)
    return DrawnShape("shape", "shape", "", strength[:, None] * np.eye(3)[axis])


@pytest.mark.parametrize(
    ("axis", "high", "toward"),
    [(0, True, X), (0, False, -X), (1, True, Y), (1, False, -Y), (2, True, Z), (2, False, -Z)],
)
def test_the_side_that_moves_is_seen(surface: DrawnHousing, axis: int, high: bool, toward: np.ndarray) -> None:
    view = view_of_most_motion(surface, _bulging(surface, axis, high))
    assert viewing_direction(view) @ toward > 0.3
    if high:
        assert view == "iso"  # the usual corner is kept where it shows as much


def test_motion_of_all_faces_keeps_the_usual_corner(surface: DrawnHousing) -> None:
    assert view_of_most_motion(surface, _bulging(surface, 0, high=False, rest=0.9)) == "iso"


def test_motion_inside_a_cavity_is_not_seen(surface: DrawnHousing) -> None:
    """A wall within the block faces the eye at the usual corner, behind the face that hides it."""
    inner = surface.rest * np.array([0.2, 0.4, 0.4]) + np.array([0.05, 0.06, 0.06])
    triangles = np.concatenate([surface.triangles, surface.triangles + len(surface.rest)])
    both = DrawnHousing(np.concatenate([surface.rest, inner]), triangles, np.arange(2 * len(inner)))
    hidden = np.zeros(len(both.rest))
    hidden[len(inner) :][np.isclose(inner[:, 0], inner[:, 0].max())] = 1.0
    hidden[: len(inner)][np.isclose(surface.rest[:, 0], 0.0)] = 0.3
    shape = DrawnShape("shape", "shape", "", hidden[:, None] * X)
    assert viewing_direction(view_of_most_motion(both, shape)) @ -X > 0.3


@pytest.mark.parametrize("up", [X, -X, Y, -Y, Z, -Z, np.array([0.6, 0.8, 0.0]), np.array([0.0, -0.6, 0.8])])
def test_up_stays_up_by_a_rotation(up: np.ndarray) -> None:
    turn = _turn(up)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    np.testing.assert_allclose(turn @ Y, up, atol=1e-12)
    assert viewing_direction("top", up) @ up == pytest.approx(1.0, abs=1e-5)
    assert viewing_direction("iso", up) @ up == pytest.approx(viewing_direction("iso") @ Y)
    x, y, z, w = _upright(up)  # in a model, up is turned to y: v' = v + 2 q × (q × v + w v)
    q = np.array([x, y, z])
    np.testing.assert_allclose(up + 2.0 * np.cross(q, np.cross(q, up) + w * up), Y, atol=1e-12)


def test_a_view_of_another_name_is_refused() -> None:
    with pytest.raises(HousingError, match="there are auto, iso"):
        check_view("inside")
