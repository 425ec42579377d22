"""Seats, springs, sensors and areas on triangles and quadrilaterals of every order."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.housing import Material, Seat, Sensor, Support, assemble, attach_fixtures
from gearwhine.housing.fem.nearest_point import NearestOnSurface, surface_point
from gearwhine.housing.fem.surface import surface_quadrature
from gearwhine.housing.model.seats import seat_matrix, sensor_port
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import KINDS, SOLIDS, facet_centers, facet_nodes, facet_normals, pick_facets

SIZE = (1.2, 0.8, 0.5)


@pytest.fixture(params=SOLIDS)
def slab(request: pytest.FixtureRequest, block_of: Callable[..., Mesh]) -> Mesh:
    mesh = block_of(request.param, SIZE, (2, 1, 1))
    centers = facet_centers(mesh.points, mesh.boundary)
    surfaces = {"top": centers[:, 2] > SIZE[2] - 1e-9, "right": centers[:, 0] > SIZE[0] - 1e-9}
    return replace(mesh, surfaces={name: pick_facets(mesh.boundary, mask) for name, mask in surfaces.items()})


def test_areas_normals_and_closedness(slab: Mesh) -> None:
    a, b, c = SIZE
    total = sum(patch.area for patch in surface_quadrature(slab, slab.boundary))
    assert total == pytest.approx(2 * (a * b + b * c + a * c))
    assert sum(patch.area for patch in surface_quadrature(slab, slab.surface("top"))) == pytest.approx(a * b)
    np.testing.assert_allclose(
        facet_normals(slab.points, slab.surface("top")), [[0, 0, 1]] * 2 * (len(slab.surface("top")[0]) // 2)
    )
    outward = facet_centers(slab.points, slab.boundary) - np.array(SIZE) / 2
    assert (np.einsum("fi,fi->f", facet_normals(slab.points, slab.boundary), outward) > 0.0).all()


def test_seats_see_rigid_motion_and_hand_on_whole_forces(slab: Mesh) -> None:
    center = (1.1, 0.3, 0.2)
    matrix = seat_matrix(slab, Seat("right", center))
    motion = np.array([0.3, -1.2, 0.7, 2.0, -0.4, 1.1])
    field = motion[:3] + np.cross(motion[3:], slab.points - center)
    np.testing.assert_allclose(matrix @ field.ravel(), motion, atol=1e-12)
    loads = np.array([10.0, -20.0, 30.0, 0.4, -0.5, 0.6])
    forces = (matrix.T @ loads).reshape(-1, 3)
    np.testing.assert_allclose(forces.sum(axis=0), loads[:3], atol=1e-11)
    np.testing.assert_allclose(np.cross(slab.points - center, forces).sum(axis=0), loads[3:], atol=1e-11)
    assert set(np.flatnonzero(np.abs(forces).max(axis=1))) <= set(facet_nodes(slab.surface("right")))


def test_springs_store_the_energy_of_the_field(slab: Mesh, steel: Material) -> None:
    """u_z = x^p over a patch of length a: ½ k/(a b) ∫ x^2p dA = ½ k a^2p / (2 p + 1)."""
    p = slab.order
    free = assemble(slab, steel)
    held = attach_fixtures(free, slab, [Support("s", surface="top", stiffness=(0.0, 0.0, 1e12))])
    spring = held.stiffness - free.stiffness
    field = np.zeros((len(slab.points), 3))
    field[:, 2] = slab.points[:, 0] ** p
    energy = 0.5 * field.ravel() @ spring @ field.ravel()
    assert energy == pytest.approx(0.5e12 * SIZE[0] ** (2 * p) / (2 * p + 1), rel=1e-4)


def test_sensors_read_the_elements_own_polynomials(slab: Mesh) -> None:
    p = slab.order
    x, y, z = slab.points.T
    field = np.stack([1 + x**p, 2 * y**p - x, z + x - y], axis=1).ravel()
    for place in ((0.37, 0.21, SIZE[2]), (0.9, 0.77, SIZE[2]), (SIZE[0], 0.3, 0.41), (0.6, 0.0, 0.13)):
        for axis, expected in enumerate((1 + place[0] ** p, 2 * place[1] ** p - place[0], sum(place) - 2 * place[1])):
            port = sensor_port(slab, Sensor("s", place, tuple(np.eye(3)[axis])))
            assert port.distance < 1e-12
            assert (port.matrix @ field)[0] == pytest.approx(expected, abs=1e-12)


def _barrel(points: np.ndarray) -> np.ndarray:
    """The slab's x rolled round a cylinder of radius 1 at z = 0, its z outward."""
    x, y, z = points.T
    radius = 1.0 + z
    return np.stack([radius * np.sin(x), y, radius * np.cos(x)], axis=1)


@pytest.mark.parametrize("kind", [kind for kind in SOLIDS if KINDS[kind].order == 2])
def test_the_nearest_point_of_a_curved_facet_has_its_normal_towards_the_place(
    block_of: Callable[..., Mesh], kind: str
) -> None:
    mesh = block_of(kind, SIZE, (3, 1, 1), _barrel)
    rng = np.random.default_rng(3)
    dense = _samples(mesh)
    for angle, y in zip(rng.uniform(0.1, 1.1, 12), rng.uniform(0.05, 0.75, 12), strict=True):
        place = np.array([1.7 * np.sin(angle), y, 1.7 * np.cos(angle)])
        point = surface_point(mesh, mesh.boundary, place)
        gap = place - point.position
        distance = np.linalg.norm(gap)
        # No sampled point of the surface is nearer, and off the facet's edges the normal points at the place.
        assert distance <= np.linalg.norm(dense - place, axis=1).min() + 1e-9
        assert distance == pytest.approx(0.2, abs=2e-3)
        assert point.normal @ gap / distance > 1.0 - 2e-3
        assert point.weights.sum() == pytest.approx(1.0)
        np.testing.assert_allclose(point.weights @ mesh.points[point.nodes], point.position)


def _samples(mesh: Mesh) -> np.ndarray:
    """Many points of the curved boundary, by its quadrature points."""
    return np.concatenate([patch.points.reshape(-1, 3) for patch in surface_quadrature(mesh, mesh.boundary)])


def test_a_place_projected_along_a_direction_keeps_its_other_coordinates(block_of: Callable[..., Mesh]) -> None:
    for kind in ("hexahedron20", "tetra10", "wedge15"):
        mesh = block_of(kind, SIZE, (3, 1, 1), _barrel)
        outer = pick_facets(
            mesh.boundary, np.linalg.norm(facet_centers(mesh.points, mesh.boundary)[:, [0, 2]], axis=1) > 1.45
        )
        place = np.array([0.61, 0.33, 9.0])
        point = NearestOnSurface(mesh, outer, along=np.array([0.0, 0.0, 1.0])).point(place)
        np.testing.assert_allclose(point.position[:2], place[:2], atol=1e-9)
        assert np.hypot(point.position[0], point.position[2]) == pytest.approx(1.5, abs=5e-3)
