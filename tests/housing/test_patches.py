"""Patches: the rigid motion they stand for, whatever facets they are made of."""

from collections.abc import Callable

import numpy as np
import pytest

from gearwhine.housing import HousingError, Patch
from gearwhine.housing.fem.nearest_point import surface_point
from gearwhine.housing.model.patches import patch_center, patch_matrix, point_matrix, rigid_motions
from gearwhine.meshes import GeometryError, Mesh


@pytest.mark.parametrize("center", [None, (0.3, -0.7, 0.2), (0.0, 0.0, 50.0)])
def test_a_patch_sees_rigid_motions_exactly_from_near_and_far(
    block: Callable[..., Mesh], center: tuple[float, float, float] | None
) -> None:
    mesh = block((0.10, 0.07, 0.05), (2, 1, 1))
    facets = mesh.surface("top")
    about = patch_center(mesh, facets) if center is None else np.array(center)
    port = patch_matrix(mesh, facets, None if center is None else about)
    seen = port @ rigid_motions(mesh.points, about).reshape(-1, 6)
    np.testing.assert_allclose(seen, np.eye(6), atol=1e-11 * (1 + np.abs(about).max()) ** 2)


def test_the_middle_of_a_patch_is_that_of_its_area(block: Callable[..., Mesh]) -> None:
    mesh = block((0.10, 0.07, 0.05), (2, 1, 1))
    np.testing.assert_allclose(Patch(surface="top").center(mesh), (0.05, 0.035, 0.05), atol=1e-15)
    left = Patch(box=((0.0, 0.0, 0.05), (0.05, 0.07, 0.05)))
    np.testing.assert_allclose(left.center(mesh), (0.025, 0.035, 0.05), atol=1e-15)


def test_the_mean_rotation_of_a_bent_patch_is_its_least_squares_slope(block: Callable[..., Mesh]) -> None:
    """u_z = x² over 0 < x < a: mean a²/3, least-squares slope a, so the rotation about y is -a."""
    a = 0.10
    mesh = block((a, 0.07, 0.05), (2, 1, 1))
    field = np.zeros((len(mesh.points), 3))
    field[:, 2] = mesh.points[:, 0] ** 2
    motion = patch_matrix(mesh, mesh.surface("top")) @ field.ravel()
    np.testing.assert_allclose(motion, [0, 0, a**2 / 3, 0, -a, 0], atol=1e-13)


def test_a_point_moves_with_the_field_there(box: Mesh) -> None:
    place = np.array([0.013, 0.16, 0.031])
    port = point_matrix(box, surface_point(box, box.boundary, place))
    slope = np.arange(9.0).reshape(3, 3)
    np.testing.assert_allclose(port @ (box.points @ slope.T).ravel(), slope @ place, atol=1e-12)


def test_patches_that_make_no_sense_are_refused(box: Mesh) -> None:
    with pytest.raises(HousingError, match="a surface, a box, a plane or a circle, one of the four"):
        Patch()
    with pytest.raises(HousingError, match="one of the four"):
        Patch("foot-1", ((0, 0, 0), (1, 1, 1)))
    with pytest.raises(GeometryError, match=r"no surface 'foot-5'"):
        Patch("foot-5").facets(box)
    with pytest.raises(GeometryError, match="no facet of the surface lies in the box"):
        Patch(box=((1, 1, 1), (2, 2, 2))).facets(box)
    with pytest.raises(HousingError, match="surface of mount 'm' is too small to tell its rotations"):
        patch_matrix(box, box.surface("foot-1"), np.array([1e4, 0.0, 0.0]), name="mount 'm'")
    with pytest.raises(HousingError, match="no facets has no area"):
        patch_center(box, ())


def test_a_patch_drawn_out_to_a_thread_is_refused(block: Callable[..., Mesh]) -> None:
    """A strip some 10⁵ times as long as wide cannot tell how it turns about itself."""
    mesh = block((1.0, 1e-5, 1e-5))
    with pytest.raises(HousingError, match="too small to tell its rotations"):
        patch_matrix(mesh, mesh.surface("top"))
