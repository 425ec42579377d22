"""What holds for every housing: scaling laws, frames, reciprocity, Rayleigh's principle, rigid motion of the ports."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gearwhine.housing import Material, Seat, Sensor, assemble, solve_modes
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.seats import seat_matrix, sensor_port
from gearwhine.meshes import Bore, BoxGeometry, Mesh, WallThickness, mesh_box
from gearwhine.meshes.elements import facet_corners

STEEL = Material(207e9, 0.3, 7850.0)
some = settings(max_examples=30, deadline=None)

angles = st.tuples(*[st.floats(-np.pi, np.pi)] * 3)
motions = st.tuples(*[st.floats(-1.0, 1.0)] * 6)
places = st.tuples(*[st.floats(-0.2, 0.3)] * 3)


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    bores = (Bore("seat", (0.01, 0.08, 0.12), 0.06),)
    return mesh_box(BoxGeometry((0.20, 0.16, 0.24), WallThickness.uniform(0.03), bores), 0.09)


@pytest.fixture(scope="module")
def matrices(mesh: Mesh) -> Matrices:
    return assemble(mesh, STEEL)


@pytest.fixture(scope="module")
def frequencies(matrices: Matrices) -> npt.NDArray[np.float64]:
    return solve_modes(matrices, count=12).frequencies[:12]


@some
@given(angles=angles, seed=st.integers(0, 2**16))
def test_strain_and_kinetic_energy_know_no_frame(
    mesh: Mesh, matrices: Matrices, angles: tuple[float, float, float], seed: int
) -> None:
    turn = Rotation.from_euler("xyz", angles).as_matrix()
    turned = assemble(replace(mesh, points=mesh.points @ turn.T), STEEL)
    field = np.random.default_rng(seed).standard_normal(mesh.points.shape)
    for ours, theirs in ((matrices.stiffness, turned.stiffness), (matrices.mass, turned.mass)):
        here, there = field.ravel(), (field @ turn.T).ravel()
        assert there @ theirs @ there == pytest.approx(here @ ours @ here, rel=1e-10)


@some
@given(motion=motions, center=places)
def test_seats_see_rigid_motions_about_any_center(
    mesh: Mesh, motion: tuple[float, ...], center: tuple[float, float, float]
) -> None:
    translation, rotation = np.array(motion[:3]), np.array(motion[3:])
    field = translation + np.cross(rotation, mesh.points - center)
    seen = seat_matrix(mesh, Seat("seat", center)) @ field.ravel()
    np.testing.assert_allclose(seen, motion, atol=1e-9)


@some
@given(place=places, gradient=st.tuples(*[st.floats(-5.0, 5.0)] * 9), direction=st.sampled_from(range(3)))
def test_sensors_read_linear_fields_where_they_stand(
    mesh: Mesh, place: tuple[float, float, float], gradient: tuple[float, ...], direction: int
) -> None:
    """Isoparametric elements hold linear fields exactly, curved ones too."""
    slope = np.array(gradient).reshape(3, 3)
    port = sensor_port(mesh, Sensor("s", place, tuple(np.eye(3)[direction])))
    field = mesh.points @ slope.T + [1.0, 2.0, 3.0]
    expected = slope @ port.position + [1.0, 2.0, 3.0]
    assert (port.matrix @ field.ravel())[0] == pytest.approx(expected[direction], abs=1e-10)
    assert port.distance == pytest.approx(float(np.linalg.norm(port.position - place)))


@some
@given(place=places)
def test_sensors_stand_no_farther_than_the_nearest_node(mesh: Mesh, place: tuple[float, float, float]) -> None:
    nodes = mesh.points[facet_corners(mesh.boundary)]
    nearest = float(np.linalg.norm(nodes - place, axis=1).min())
    # On the bore the facet bulges beyond its flat triangle by its sagitta at most.
    assert sensor_port(mesh, Sensor("s", place)).distance <= nearest + 0.005
