"""The mesh's own checks, on tetrahedra small enough to see."""

import numpy as np
import pytest

from gearwhine.meshes import GeometryError, Mesh, mesh_quality

POINTS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]])
CELLS = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])


def test_unit_tetrahedron() -> None:
    mesh = Mesh.of_tetrahedra(POINTS[:4], CELLS[:1])
    assert mesh.order == 1
    assert mesh.corner_volumes == pytest.approx([1 / 6])
    a, b, c = np.moveaxis(mesh.points[mesh.boundary[0].nodes], 1, 0)
    outward = np.einsum("fi,fi->f", np.cross(b - a, c - a), (a + b + c) / 3 - 0.25)
    assert len(mesh.boundary[0]) == 4
    assert (outward > 0.0).all()


def test_a_shared_facet_is_not_boundary() -> None:
    mesh = Mesh.of_tetrahedra(POINTS, CELLS)
    assert len(mesh.boundary[0]) == 6
    assert [1, 2, 3] not in np.sort(mesh.boundary[0].nodes, axis=1).tolist()
    np.testing.assert_array_equal(mesh.bounds, [[0, 0, 0], [1, 1, 1]])


def test_quality_of_the_regular_tetrahedron_is_one() -> None:
    regular = np.array([[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]])
    quality = mesh_quality(Mesh.of_tetrahedra(regular, np.array([[0, 1, 2, 3]])))
    assert quality.shape == pytest.approx((1.0, 1.0))
    assert quality.edge_length == pytest.approx((np.sqrt(8.0),) * 3)
    assert quality.volume == pytest.approx(8 / 3)  # edge³ / (6 √2)


def test_quality_falls_as_the_tetrahedron_flattens() -> None:
    shapes = []
    for height in (1.0, 0.1, 0.01):
        points = POINTS[:4].copy()
        points[3, 2] = height
        shapes.append(mesh_quality(Mesh.of_tetrahedra(points, CELLS[:1])).shape[0])
    assert shapes[0] > shapes[1] > shapes[2] > 0.0


@pytest.mark.parametrize(
    ("points", "cells", "message"),
    [
        (POINTS[:, :2], CELLS, r"points have shape \(5, 2\)"),
        (POINTS, CELLS[:, :3], r"elements have shape \(2, 3\)"),
        (POINTS, CELLS[:0], "the mesh has no elements"),
        (np.where(POINTS == 1.0, np.nan, POINTS), CELLS, "not finite"),
        (POINTS, CELLS + 1, r"outside 0..4"),
        (POINTS, CELLS - 1, r"outside 0..4"),
        (POINTS, CELLS[:, [1, 0, 2, 3]], "2 of 2 elements have no positive volume"),
        (POINTS * [1.0, 1.0, 0.0], CELLS, "no positive volume"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(points: np.ndarray, cells: np.ndarray, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        Mesh.of_tetrahedra(points, cells)


@pytest.mark.parametrize(
    ("surface", "message"),
    [
        (np.array([[0, 1, 7]]), "surface 'lid' names nodes outside 0..4"),
        (np.array([[0, 1, -1]]), "surface 'lid' names nodes outside 0..4"),
        (np.array([[0, 1, 2, 3, 4, 0]]), r"surface 'lid' has shape \(1, 6\); expected \(n_facets, 3\)"),
    ],
)
def test_surfaces_that_do_not_fit_are_refused(surface: np.ndarray, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        Mesh.of_tetrahedra(POINTS, CELLS, surfaces={"lid": surface})


def test_volumes_that_do_not_fit_are_refused() -> None:
    with pytest.raises(GeometryError, match=r"volume 'part' names elements outside 0\.\.1"):
        Mesh.of_tetrahedra(POINTS, CELLS, volumes={"part": np.array([2])})


def test_unknown_surface_is_answered_with_the_known_ones() -> None:
    mesh = Mesh.of_tetrahedra(POINTS, CELLS, surfaces={"lid": np.array([[0, 2, 1]]), "base": np.array([[0, 1, 3]])})
    np.testing.assert_array_equal(mesh.surface("lid")[0].nodes, [[0, 2, 1]])
    with pytest.raises(GeometryError, match="no surface 'side'; it has: base, lid"):
        mesh.surface("side")
    with pytest.raises(GeometryError, match="it has: none"):
        Mesh.of_tetrahedra(POINTS, CELLS).surface("side")
