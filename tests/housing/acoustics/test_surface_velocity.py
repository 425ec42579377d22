"""Transfer of a housing's motion to a radiating surface."""

from collections.abc import Callable

import numpy as np
import pytest
from solids import cubes, hollow_box, spherical_shell

from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.acoustics.surface_velocity import (
    SurfaceVelocity,
    face_surface,
    surface_velocity,
    transfer_error,
    velocity_transfer,
)
from gearwhine.housing.acoustics.wrapping import wrap
from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.surface import flat_faces
from gearwhine.meshes import GeometryError, Mesh

SIZE = (0.3, 0.2, 0.24)


@pytest.fixture(scope="module")
def solid(block: Callable[..., Mesh]) -> tuple[Mesh, RadiatingSurface]:
    """A block of ten-node tetrahedra and its wrap, whose faces coincide."""
    mesh = block(SIZE, (6, 4, 5))
    return mesh, wrap(mesh, 0.045, 0.05)


@pytest.fixture(scope="module")
def boxed(box: Mesh) -> SurfaceVelocity:
    return surface_velocity(box, wrap(box, 0.025, 0.055))


def _flux(surface: RadiatingSurface, corners: np.ndarray, chosen: np.ndarray) -> float:
    return float((surface.areas * corners.reshape(-1, 3).mean(axis=1))[chosen].sum())


def test_rigid_motion_is_carried_exactly(solid: tuple[Mesh, RadiatingSurface]) -> None:
    mesh, surface = solid
    motion = np.array([0.3, -1.1, 0.7]) + np.cross([2.0, 5.0, -3.0], mesh.points)
    expected = np.array([0.3, -1.1, 0.7]) + np.cross([2.0, 5.0, -3.0], surface.corners)
    normal = velocity_transfer(mesh, surface) @ motion.ravel()
    assert normal == pytest.approx(np.einsum("eci,ei->ec", expected, surface.normals).ravel(), abs=1e-9)


def test_the_flux_of_a_quadratic_motion_is_exact(solid: tuple[Mesh, RadiatingSurface]) -> None:
    # u_z = x² + x y: its flux through the upper face is b (a³ / 3 + a² b / 4).
    mesh, surface = solid
    motion = np.zeros_like(mesh.points)
    motion[:, 2] = mesh.points[:, 0] ** 2 + mesh.points[:, 0] * mesh.points[:, 1]
    normal = velocity_transfer(mesh, surface) @ motion.ravel()
    a, b, _ = SIZE
    upper = surface.normals[:, 2] > 0.5
    # Six points in a triangle miss the kinks between the elements, but no more.
    assert _flux(surface, normal, upper) == pytest.approx(a**3 * b / 3 + a**2 * b**2 / 4, rel=1e-3)


def test_a_cap_moves_with_its_rim() -> None:
    mesh = hollow_box(6)
    surface = wrap(mesh, 0.02, 0.09)
    velocity = surface_velocity(mesh, surface)
    motion = np.tile([0.0, 0.0, 1.0], (len(mesh.points), 1))
    assert velocity.transfer() @ motion.ravel() == pytest.approx(np.repeat(surface.normals[:, 2], 3), abs=1e-9)
    assert velocity.cap_area == pytest.approx(0.06**2, rel=0.2)
    assert velocity.distances.max() < 1e-9


def test_surfaces_left_out_are_at_rest(solid: tuple[Mesh, RadiatingSurface]) -> None:
    mesh, surface = solid
    motion = np.tile([1.0, 1.0, 1.0], (len(mesh.points), 1))
    for without in ("bottom", mesh.surface("bottom")):
        normal = (velocity_transfer(mesh, surface, (without,)) @ motion.ravel()).reshape(-1, 3)
        lower = surface.normals[:, 2] < -0.5
        assert np.abs(normal[lower]).max() == 0.0
        assert normal[~lower] == pytest.approx(np.repeat(surface.normals[~lower].sum(axis=1)[:, None], 3, axis=1))
    with pytest.raises(GeometryError, match="no surface 'sole'"):
        velocity_transfer(mesh, surface, ("sole",))


def test_the_sides_of_a_thin_wall_are_told_apart() -> None:
    mesh = cubes(np.ones((10, 8, 1), dtype=bool), (0.03, 0.03, 0.004))
    motion = np.zeros_like(mesh.points)
    motion[:, 2] = np.where(mesh.points[:, 2] > 0.002, 1.0, 3.0)
    surface = wrap(mesh, 0.02, 0.0)
    normal = (velocity_transfer(mesh, surface) @ motion.ravel()).reshape(-1, 3)
    assert normal[surface.normals[:, 2] > 0.9] == pytest.approx(1.0)
    assert normal[surface.normals[:, 2] < -0.9] == pytest.approx(-3.0)


def test_a_pulsating_sphere_has_the_same_velocity_everywhere() -> None:
    mesh = spherical_shell(0.13, 0.15, 10)
    radial = mesh.points / np.linalg.norm(mesh.points, axis=1, keepdims=True)
    surface = wrap(mesh, 0.03, 0.02)
    normal = velocity_transfer(mesh, surface) @ radial.ravel()
    assert normal.min() > 0.96
    assert normal.max() < 1.01


def test_faces_of_a_box_have_their_names(boxed: SurfaceVelocity) -> None:
    labels = np.array(boxed.face_of_triangles())
    areas = {label: boxed.surface.areas[labels == label].sum() for label in np.unique(labels)}
    assert areas["top"] == pytest.approx(0.20 * 0.24, rel=0.02)
    assert areas["left"] == pytest.approx(0.16 * 0.24 + 2 * 0.02 * 0.05, rel=0.02)  # with the feet, flush with it
    assert areas["foot-1"] == pytest.approx(0.04 * 0.05, rel=0.1)
    assert areas["cap"] == pytest.approx(2 * np.pi / 4 * 0.05**2, rel=0.35)
    assert "other (+x)" in areas  # a foot's side
    assert boxed.cap_area == pytest.approx(2 * np.pi / 4 * 0.05**2, rel=0.25)


def test_faces_without_a_name_have_that_of_their_place(solid: tuple[Mesh, RadiatingSurface]) -> None:
    mesh, surface = solid
    labels = np.array(surface_velocity(mesh, surface).face_of_triangles())
    assert set(labels[surface.normals[:, 2] > 0.5]) == {"top"}
    (largest,) = set(labels[surface.normals[:, 1] > 0.5])
    assert largest in {face.name for face in flat_faces(mesh)}
    x, _, z = (1e3 * mesh.bounds.mean(axis=0)).round().astype(int).tolist()
    assert largest == f"+y at {x}, {round(1e3 * mesh.bounds[1, 1])}, {z} mm"


def test_long_waves_pass_and_short_ones_are_refused(boxed: SurfaceVelocity) -> None:
    points = boxed.mesh.points
    axis = np.array([0.6, 0.5, np.sqrt(1.0 - 0.61)])

    def waves(length: float) -> np.ndarray:
        phases = 2 * np.pi / length * points @ axis + np.array([[0.0], [1.0], [2.0]])
        return np.cos(phases)[:, :, None] * np.ones(3)

    long = transfer_error(boxed, waves(0.4))
    assert np.abs(long.relative).max() < 0.05
    assert long.surface_area == pytest.approx(long.skin_area, rel=0.05)
    long.require()
    coarse = surface_velocity(boxed.mesh, wrap(boxed.mesh, 0.08, 0.055))
    with pytest.raises(HousingError, match="shorter edges"):
        transfer_error(coarse, waves(0.06)).require()


@pytest.mark.parametrize("order", [1, 2])
def test_a_face_of_facets_is_exact_at_its_nodes(block: Callable[..., Mesh], order: int) -> None:
    mesh = block(SIZE, (2, 2, 2), order)
    surface, points = face_surface(mesh, mesh.surface("top"))
    assert surface.area == pytest.approx(SIZE[0] * SIZE[1])
    assert surface.normals == pytest.approx(np.tile([0.0, 0.0, 1.0], (len(surface.triangles), 1)))
    motion = np.sin(20.0 * mesh.points + np.array([0.1, 0.2, 0.3]))
    normal = (points.transfer @ motion.ravel()).reshape(-1, 3)
    assert normal == pytest.approx(np.sin(20.0 * surface.corners[..., 2] + 0.3))
    expected = {tuple(np.round(place, 9)) for place in mesh.points[np.isclose(mesh.points[:, 2], SIZE[2])]}
    assert {tuple(np.round(place, 9)) for place in surface.points} == expected


@pytest.mark.parametrize("kind", ["hexahedron20", "hexahedron27"])
def test_a_face_of_quadrilaterals_keeps_all_nodes_but_none_twice(kind: str) -> None:
    from gearwhine.meshes import ElementBlock
    from gearwhine.meshes.elements import KINDS

    places = np.array(KINDS[kind].places)
    mesh = Mesh(places * 0.1, (ElementBlock(kind, np.arange(len(places))[None]),))
    surface, _ = face_surface(mesh, mesh.boundary)
    surface.require_closed()
    assert surface.volume == pytest.approx(1e-3)
    assert len(surface.points) == (20 if kind == "hexahedron20" else 26)
