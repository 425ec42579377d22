"""Seats and sensors: rigid motion, equilibrium of forces, interpolation."""

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.housing import HousingError, Seat, Sensor
from gearwhine.housing.model.seats import seat_matrix, sensor_port
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import facet_nodes

FRONT = Seat("front-seat", (-0.03, 0.08, 0.115))


@pytest.mark.parametrize("name", ["box", "straight_box"])
def test_seat_sees_rigid_motions_exactly(name: str, request: pytest.FixtureRequest) -> None:
    mesh = request.getfixturevalue(name)
    matrix = seat_matrix(mesh, FRONT)
    motions = np.vstack([np.eye(6), [0.3, -1.2, 0.7, 2.0, -0.4, 1.1]])
    for motion in motions:
        field = motion[:3] + np.cross(motion[3:], mesh.points - FRONT.center)
        np.testing.assert_allclose(matrix @ field.ravel(), motion, atol=1e-10)


def test_seat_hands_on_force_and_moment_whole(box: Mesh) -> None:
    """The nodal forces Pᵀ f have the resultant force and the moment about the centre that f names."""
    loads = np.array([10.0, -20.0, 30.0, 0.4, -0.5, 0.6])
    forces = (seat_matrix(box, FRONT).T @ loads).reshape(-1, 3)
    np.testing.assert_allclose(forces.sum(axis=0), loads[:3], atol=1e-9)
    moment = np.cross(box.points - FRONT.center, forces).sum(axis=0)
    np.testing.assert_allclose(moment, loads[3:], atol=1e-9)
    loaded = np.flatnonzero(np.abs(forces).max(axis=1))
    assert set(loaded) <= set(facet_nodes(box.surface("front-seat")))


def test_work_at_the_seat_is_work_at_the_nodes(box: Mesh) -> None:
    matrix = seat_matrix(box, FRONT)
    generator = np.random.default_rng(1)
    loads, field = generator.standard_normal(6), generator.standard_normal(3 * len(box.points))
    assert (matrix.T @ loads) @ field == pytest.approx(loads @ (matrix @ field), rel=1e-12)


def test_a_breathing_bore_does_not_move(box: Mesh) -> None:
    """u = a radial stretch: by symmetry no motion, but for the facets' uneven cover of the circle."""
    field = np.zeros((len(box.points), 3))
    field[:, :2] = (box.points - FRONT.center)[:, :2]
    motion = seat_matrix(box, FRONT) @ field.ravel()
    assert np.abs(motion[:3]).max() < 0.02 * 0.025
    assert np.abs(motion[3:]).max() < 0.02


def test_moving_the_center_moves_the_motion_as_a_rigid_body(box: Mesh) -> None:
    field = np.random.default_rng(2).standard_normal(3 * len(box.points))
    shift = np.array([0.01, -0.02, 0.03])
    here = seat_matrix(box, FRONT) @ field
    there = seat_matrix(box, Seat(FRONT.name, tuple(np.array(FRONT.center) + shift))) @ field
    np.testing.assert_allclose(there[3:], here[3:], rtol=1e-8)
    np.testing.assert_allclose(there[:3], here[:3] + np.cross(here[3:], shift), rtol=1e-8)


def test_a_center_far_beyond_the_seat_is_refused(box: Mesh) -> None:
    with pytest.raises(HousingError, match="seat 'front-seat' is too small to tell its rotations"):
        seat_matrix(box, Seat("front-seat", (1e4, 0.0, 0.0)))


def _quadratic(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([1 + x - 2 * z + 3 * x * z, y + x * x - z * z, 2 - z + 5 * x * y + y * z], axis=-1)


def _linear(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([1 + x - 2 * z, y + 3 * x, 2 - z + y], axis=-1)


# On plane faces, away from the bores: anywhere within facets, on edges of the mesh or not.
PLACES = [(0.013, 0.16, 0.031), (-0.071, 0.16, -0.0923), (0.1, 0.077, 0.011), (-0.1, 0.031, -0.05), (0.081, 0.15, 0.12)]


@pytest.mark.parametrize("place", PLACES)
def test_sensor_reads_quadratic_fields_exactly(box: Mesh, place: tuple[float, float, float]) -> None:
    field = _quadratic(box.points).ravel()
    for direction in np.eye(3):
        port = sensor_port(box, Sensor("s", place, tuple(direction)))
        np.testing.assert_allclose(port.position, place, atol=1e-12)
        assert port.distance < 1e-12
        assert (port.matrix @ field)[0] == pytest.approx(_quadratic(np.array(place)) @ direction, abs=1e-12)


@pytest.mark.parametrize("place", PLACES)
def test_sensor_on_straight_elements_reads_linear_fields_exactly(
    straight_box: Mesh, place: tuple[float, float, float]
) -> None:
    field = _linear(straight_box.points).ravel()
    port = sensor_port(straight_box, Sensor("s", place, (1.0, 2.0, -2.0)))
    np.testing.assert_allclose(port.direction, np.array([1.0, 2.0, -2.0]) / 3)
    assert (port.matrix @ field)[0] == pytest.approx(_linear(np.array(place)) @ port.direction, abs=1e-12)


def test_sensor_looks_along_the_outward_normal_unless_told(box: Mesh) -> None:
    normals = {(0.013, 0.16, 0.03): (0, 1, 0), (0.1, 0.07, 0.01): (1, 0, 0), (0.08, 0.15, -0.12): (0, 0, -1)}
    for place, normal in normals.items():
        np.testing.assert_allclose(sensor_port(box, Sensor("s", place)).direction, normal, atol=1e-12)


def test_sensor_off_the_surface_is_put_on_it_and_says_how_far(box: Mesh) -> None:
    port = sensor_port(box, Sensor("s", (0.013, 0.175, 0.031)))
    np.testing.assert_allclose(port.position, (0.013, 0.16, 0.031), atol=1e-12)
    assert port.distance == pytest.approx(0.015)
    corner = sensor_port(box, Sensor("s", (0.13, 0.20, 0.12)))
    np.testing.assert_allclose(corner.position, (0.10, 0.16, 0.12), atol=1e-12)
    assert corner.distance == pytest.approx(0.05)  # 3-4-5


def test_sensor_without_direction_length_is_refused(box: Mesh) -> None:
    with pytest.raises(HousingError, match=r"sensor 'top': direction is .*; expected a vector that has a length"):
        sensor_port(box, Sensor("top", (0.0, 0.16, 0.0), (0.0, 0.0, 0.0)))
