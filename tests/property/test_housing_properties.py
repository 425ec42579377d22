"""What holds for every housing: scaling laws, frames, reciprocity, Rayleigh's principle, rigid motion of the ports."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gearwhine.housing import Material, Seat, Sensor, Support, assemble, attach_fixtures, solve_modes
from gearwhine.housing.fem.factorization import Factorizer
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.seats import seat_matrix, sensor_port
from gearwhine.meshes import Bore, BoxGeometry, Mesh, WallThickness, mesh_box
from gearwhine.meshes.elements import facet_corners

STEEL = Material(207e9, 0.3, 7850.0)
few = settings(max_examples=12, deadline=None)
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


@few
@given(size=st.floats(1e-2, 1e2), stiffness=st.floats(1e-2, 1e2), density=st.floats(1e-2, 1e2))
def test_frequencies_scale_as_wave_speed_over_length(
    mesh: Mesh, frequencies: npt.NDArray[np.float64], size: float, stiffness: float, density: float
) -> None:
    """ω ~ √(E / ρ) / L at the same Poisson's ratio."""
    material = Material(STEEL.youngs_modulus * stiffness, STEEL.poisson_ratio, STEEL.density * density)
    scaled = assemble(replace(mesh, points=mesh.points * size), material)
    expected = frequencies * np.sqrt(stiffness / density) / size
    found = solve_modes(scaled, count=12).frequencies[:12]
    np.testing.assert_allclose(found, expected, rtol=1e-8)


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


@few
@given(places=st.tuples(places, places), frequency=st.floats(10.0, 3000.0))
def test_receptances_are_reciprocal(
    mesh: Mesh, matrices: Matrices, places: tuple[tuple[float, float, float], ...], frequency: float
) -> None:
    """Maxwell and Betti: what a force at one port does at another is what it does the other way round."""
    seat = seat_matrix(mesh, Seat("seat", (0.01, 0.08, 0.105))).toarray()
    sensors = [sensor_port(mesh, Sensor("s", place)).matrix.toarray() for place in places]
    ports = np.vstack([seat, *sensors])
    dynamic = matrices.shifted(-((2 * np.pi * frequency) ** 2))
    receptance = ports @ Factorizer().factor(dynamic).solve(ports.T)
    np.testing.assert_allclose(receptance, receptance.T, rtol=0.0, atol=1e-8 * np.abs(receptance).max())
    assert np.linalg.eigvalsh((receptance + receptance.T) / 2).min() > -1e-9 * np.abs(receptance).max()


@pytest.mark.slow
@few
@given(stiffness=st.tuples(*[st.floats(0.0, 1e9)] * 3), more=st.floats(1.0, 100.0))
def test_springs_raise_every_frequency_or_leave_it(
    mesh: Mesh, matrices: Matrices, stiffness: tuple[float, float, float], more: float
) -> None:
    """Rayleigh: stiffer supports lower no natural frequency."""
    stiffness = (stiffness[0] + 1e6, *stiffness[1:])
    soft = Support("base", surface="bottom", stiffness=stiffness)
    hard = replace(soft, stiffness=tuple(more * value for value in stiffness))
    lower, upper = (
        solve_modes(attach_fixtures(matrices, mesh, [support]), count=10).frequencies[:10] for support in (soft, hard)
    )
    assert (upper >= lower * (1 - 1e-8) - 1e-6 * upper[-1]).all()


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


@few
@given(shift_hz=st.floats(100.0, 12000.0))
def test_inertia_counts_the_modes_below_any_frequency(
    matrices: Matrices, frequencies: npt.NDArray[np.float64], shift_hz: float
) -> None:
    shift = min(2 * np.pi * shift_hz, 0.999 * float(frequencies[-1]))
    if np.abs(frequencies / shift - 1).min() < 1e-6:
        return
    shifted = matrices.shifted(shift**2)
    assert Factorizer().factor(shifted).negative == np.count_nonzero(frequencies < shift)
