"""Seats and sensors: rigid motion, equilibrium of forces, interpolation."""

import numpy as np
import pytest

from gearwhine.housing import HousingError, Seat, Sensor
from gearwhine.housing.model.seats import seat_matrix, sensor_port
from gearwhine.meshes import Mesh

FRONT = Seat("front-seat", (-0.03, 0.08, 0.115))


def test_a_breathing_bore_does_not_move(box: Mesh) -> None:
    """u = a radial stretch: by symmetry no motion, but for the facets' uneven cover of the circle."""
    field = np.zeros((len(box.points), 3))
    field[:, :2] = (box.points - FRONT.center)[:, :2]
    motion = seat_matrix(box, FRONT) @ field.ravel()
    assert np.abs(motion[:3]).max() < 0.02 * 0.025
    assert np.abs(motion[3:]).max() < 0.02


def test_a_center_far_beyond_the_seat_is_refused(box: Mesh) -> None:
    with pytest.raises(HousingError, match="seat 'front-seat' is too small to tell its rotations"):
        seat_matrix(box, Seat("front-seat", (1e4, 0.0, 0.0)))


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
