"""Wrapping of meshes in closed radiating surfaces."""

import re
from dataclasses import replace

import numpy as np
import pytest
from solids import cubes, hollow_box, spherical_shell

from gearwhine.housing.acoustics import wrapping
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.acoustics.surface_velocity import surface_velocity
from gearwhine.housing.acoustics.wrapping import _collapse, _divided, least_angles, wrap
from gearwhine.housing.errors import HousingError
from gearwhine.housing.pictures.drawn_shapes import outer_skin
from gearwhine.meshes import Mesh


def _least_angle(surface: RadiatingSurface) -> float:
    return float(np.degrees(least_angles(surface.corners).min()))


def _edges(surface: RadiatingSurface) -> np.ndarray:
    return np.linalg.norm(surface.corners - np.roll(surface.corners, 1, axis=1), axis=2)


def test_a_block_keeps_its_faces_edges_and_corners() -> None:
    mesh = cubes(np.ones((6, 4, 5), dtype=bool), (0.05, 0.05, 0.05))
    surface = wrap(mesh, 0.03, 0.05)
    assert surface.area == pytest.approx(2 * (0.3 * 0.2 + 0.2 * 0.25 + 0.25 * 0.3), rel=1e-6)
    assert surface.volume == pytest.approx(0.3 * 0.2 * 0.25, rel=1e-6)
    assert np.abs(surface.normals).max(axis=1) == pytest.approx(1.0, abs=1e-6)
    assert _edges(surface).mean() == pytest.approx(0.03, rel=0.15)
    assert _least_angle(surface) > 25.0


def test_a_turned_block_keeps_its_edges() -> None:
    mesh = cubes(np.ones((6, 4, 5), dtype=bool), (0.05, 0.05, 0.05))
    (a, b), c = (np.cos(0.5), np.sin(0.5)), np.cos(0.3)
    about_z = np.array([[a, -b, 0.0], [b, a, 0.0], [0.0, 0.0, 1.0]])
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, c, -np.sin(0.3)], [0.0, np.sin(0.3), c]])
    surface = wrap(mesh.rotated(about_x @ about_z), 0.03, 0.05)
    assert surface.area == pytest.approx(2 * (0.3 * 0.2 + 0.2 * 0.25 + 0.25 * 0.3), rel=0.01)
    assert surface.volume == pytest.approx(0.3 * 0.2 * 0.25, rel=0.01)
    assert _least_angle(surface) > 12.0


def test_a_hole_is_capped_flat_and_the_inside_left_out() -> None:
    surface = wrap(hollow_box(6), 0.025, 0.09)
    assert surface.volume == pytest.approx(0.3 * 0.24 * 0.2, rel=1e-6)
    assert surface.area == pytest.approx(2 * (0.3 * 0.24 + 0.24 * 0.2 + 0.2 * 0.3), rel=1e-6)


def test_a_concave_corner_is_not_filled() -> None:
    cells = np.ones((6, 6, 6), dtype=bool)
    cells[3:, 3:] = False
    surface = wrap(cubes(cells, (0.04, 0.04, 0.04)), 0.03, 0.2)
    assert surface.volume == pytest.approx(0.75 * 0.24**3, rel=1e-6)
    assert surface.area == pytest.approx(4 * 0.24**2 + 2 * 0.75 * 0.24**2, rel=1e-6)


def test_a_sphere_is_followed() -> None:
    mesh = spherical_shell(0.13, 0.15, 16)
    surface = wrap(mesh, 0.02, 0.02)
    velocity = surface_velocity(mesh, surface)
    assert surface.area == pytest.approx(4 * np.pi * 0.15**2, rel=0.01)
    assert surface.volume == pytest.approx(4 / 3 * np.pi * 0.15**3, rel=0.015)
    assert velocity.distances.max() < 0.05 * 0.02
    assert _least_angle(surface) > 20.0


def test_the_wrap_is_the_same_every_time(box: Mesh) -> None:
    first, second = wrap(box, 0.03, 0.055), wrap(box, 0.03, 0.055)
    assert np.array_equal(first.points, second.points)
    assert np.array_equal(first.triangles, second.triangles)


@pytest.mark.parametrize("hole", [10, 18])
def test_a_leak_is_refused_with_the_diameter_that_closes_it(hole: int) -> None:
    mesh = hollow_box(hole)
    with pytest.raises(HousingError, match=r"near \(.*, 120, .*\) mm wider than close_holes of 65 mm") as caught:
        wrap(mesh, 0.025, 0.065)
    found = re.search(r"close_holes of about (\d+) mm", str(caught.value))
    assert found is not None
    assert wrap(mesh, 0.025, 1e-3 * float(found[1])).volume == pytest.approx(0.3 * 0.24 * 0.2, rel=0.01)


def test_a_wide_bore_of_a_narrow_box_is_capped() -> None:
    cells = np.ones((30, 30, 8), dtype=bool)
    cells[1:-1, 1:-1, 1:-1] = False
    x, y = np.mgrid[:30, :30]
    cells[np.hypot(x - 14.5, y - 14.5) < 5.5] = False
    surface = wrap(cubes(cells, (0.01, 0.01, 0.01)), 0.025, 0.12)
    assert surface.volume == pytest.approx(0.3 * 0.3 * 0.08, rel=1e-6)


@pytest.mark.parametrize(("edge", "close_holes"), [(0.0, 0.05), (-0.01, 0.05), (0.02, -0.01), (np.nan, 0.05)])
def test_sizes_must_be_positive(edge: float, close_holes: float) -> None:
    with pytest.raises(HousingError, match="expected"):
        wrap(hollow_box(6), edge, close_holes)


def test_too_fine_a_wrap_is_refused() -> None:
    with pytest.raises(HousingError, match="cells"):
        wrap(hollow_box(6), 0.0005, 0.05)


def test_a_thin_plate_keeps_its_rim() -> None:
    surface = wrap(cubes(np.ones((10, 8, 1), dtype=bool), (0.03, 0.03, 0.004)), 0.02, 0.0)
    assert surface.volume == pytest.approx(0.3 * 0.24 * 0.004, rel=1e-6)
    assert surface.area == pytest.approx(2 * (0.3 * 0.24 + 0.54 * 0.004), rel=1e-6)


def test_long_edges_are_halved_where_they_lie() -> None:
    """A tetrahedron with a long edge: the surface stays, closed and with outward normals, in shorter edges."""
    points = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.3, 1.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    given = RadiatingSurface(points, faces)
    for longest in (3.0, 1.1, 0.5):
        halved = RadiatingSurface(*_divided(points, faces, longest))
        halved.require_closed()
        assert _edges(halved).max() <= longest
        assert halved.area == pytest.approx(given.area, rel=1e-13)
        assert halved.volume == pytest.approx(given.volume, rel=1e-13)
        # Every triangle lies in one of the four faces, and looks the same way.
        alike = np.einsum("tj,fj->tf", halved.normals, given.normals).max(axis=1)
        assert alike == pytest.approx(1.0)
        again = _divided(halved.points, halved.triangles, longest)
        assert len(again[1]) == len(halved.triangles)
    # Halves of the longest edge of a triangle are at least half as sharp as it.
    assert _least_angle(halved) > 0.5 * _least_angle(given)


def test_a_tapered_rib_is_spanned_by_triangles_of_its_height() -> None:
    """A plate with a gusset: an edge along its slope was 2.1 cells long, and six of the mean edge are a wavelength."""
    cells = np.zeros((12, 5, 8), dtype=bool)
    cells[:, 0] = cells[5] = True
    mesh = cubes(cells, (0.02, 0.02, 0.02))
    x, y, z = mesh.points.T
    sloped = np.where(y > 0.02, 0.02 + (y - 0.02) * (1.0 - z / 0.16), y)
    surface = wrap(replace(mesh, points=np.column_stack([x, sloped, z])), 0.04, 0.03)
    assert _edges(surface).max() <= 1.7 * 0.04 / 1.05 + 1e-12
    assert surface.volume == pytest.approx(0.24 * 0.02 * 0.16 + 0.5 * 0.02 * 0.08 * 0.16, rel=0.06)


def test_an_edge_beside_a_flat_triangle_collapses_without_dividing_by_its_area():
    """A pyramid on both sides of a ring, of whose corners one lies between its neighbour and the tip."""
    angles = np.arange(6) * np.pi / 3.0
    ring = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1)
    points = np.concatenate([ring, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    points[1] = 0.5 * (points[0] + points[6])
    corners = [(i, (i + 1) % 6, 6) for i in range(6)] + [((i + 1) % 6, i, 7) for i in range(6)]
    around = [{number for number, triangle in enumerate(corners) if vertex in triangle} for vertex in range(8)]
    with np.errstate(divide="raise", invalid="raise"):
        gone = _collapse(points, corners, around, 0, 5, 1.0)
    assert set(gone) <= {5, 11}


@pytest.fixture
def plate() -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a plate of 0.6 m by 0.6 m by 0.1 m, by squares of 0.1 m in two triangles."""
    mesh = cubes(np.ones((6, 6, 1), dtype=bool), (0.1, 0.1, 0.1))
    skin = outer_skin(mesh)
    return mesh.points[skin.nodes], skin.triangles


def _vertex(points: np.ndarray, *place: float) -> int:
    return int(np.linalg.norm(points - np.array(place), axis=1).argmin())


def test_a_folded_vertex_goes_back_between_its_neighbours(
    plate: tuple[np.ndarray, np.ndarray], monkeypatch: pytest.MonkeyPatch
) -> None:
    """All vertices of folded triangles go half the way to the mean of their neighbours, the others stay."""
    points, triangles = plate
    vertex = _vertex(points, 0.3, 0.3, 0.1)
    folded = points.copy()
    folded[vertex, 0] += 0.14  # beyond the next vertex
    once = folded.copy()
    neighbours = {n: {int(m) for row in triangles if n in row for m in row if m != n} for n in range(len(points))}
    normals = np.cross(
        folded[triangles[:, 1]] - folded[triangles[:, 0]], folded[triangles[:, 2]] - folded[triangles[:, 0]]
    )
    upside = [n for n, row in enumerate(triangles) if normals[n, 2] < 0.0 and folded[row, 2].min() > 0.05]
    beside = [n for n, row in enumerate(triangles) for m in upside if len({*row} & {*triangles[m]}) == 2]
    moved = {int(n) for row in (*upside, *(n for n in beside if normals[n, 2] > 0.0)) for n in triangles[row]}
    for n in moved:
        once[n] += 0.5 * (folded[list(neighbours[n])].mean(axis=0) - folded[n])
    assert vertex in moved
    monkeypatch.setattr(wrapping, "_UNFOLDINGS", 1)
    np.testing.assert_allclose(wrapping._unfolded(folded, triangles), once, atol=1e-15)
    monkeypatch.undo()
    flat = wrapping._unfolded(folded, triangles)
    after = np.cross(flat[triangles[:, 1]] - flat[triangles[:, 0]], flat[triangles[:, 2]] - flat[triangles[:, 0]])
    assert (after[flat[triangles][:, :, 2].min(axis=1) > 0.05][:, 2] > 0.0).all()
    np.testing.assert_array_equal(wrapping._unfolded(points, triangles), points)


@pytest.mark.parametrize("moved", [(0.088, 0.0), (-0.044, 0.05)])
def test_a_needle_in_a_flat_face_is_mended(plate: tuple[np.ndarray, np.ndarray], moved: tuple[float, float]) -> None:
    """A short edge collapses, a long one is flipped: area, volume and closure stay, and no triangle is a needle."""
    points, triangles = plate
    needles = points.copy()
    needles[_vertex(points, 0.3, 0.3, 0.1), :2] += moved
    before, after = (
        RadiatingSurface(*surface) for surface in ((needles, triangles), wrapping._mended(needles, triangles, 0.1))
    )
    assert _least_angle(before) < 8.0
    assert _least_angle(after) > 15.0
    assert (after.area, after.volume) == pytest.approx((before.area, before.volume), rel=1e-12)
    edges = np.sort(np.concatenate([after.triangles[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
