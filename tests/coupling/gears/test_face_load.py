"""Contact of flanks that approach unevenly over the face: its potential, its limits, and the place of its load."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.coupling.gears import (
    ConstantStiffness,
    Gear,
    GearError,
    GearPairGeometry,
    HelixDeviation,
    PotentialEnergyStiffness,
    TipRelief,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.loaded.face_load import FaceContact, lagrange
from gearwhine.coupling.machine.load_shuttling import load_arms
from gearwhine.coupling.statics.static_model import face_stations
from gearwhine.numerics.arrays import FloatArray

WIDTH, FORCE = 24e-3, 6000.0
ALPHA = math.radians(20.0)
PINION = Gear("pinion", 24, 3e-3, ALPHA, WIDTH, tip_relief=TipRelief(10e-6, length=3e-3))
WHEEL = replace(PINION, name="wheel", teeth=37)
MODEL = PotentialEnergyStiffness()
PHASES = np.arange(32) / 32.0
CROWN = HelixDeviation(crowning=8e-6)


def pair_of(degrees: float) -> GearPairGeometry:
    angle = math.radians(degrees)
    return GearPairGeometry(
        replace(PINION, helix_angle=angle, helix_deviation=CROWN), replace(WHEEL, helix_angle=-angle)
    )


def face(degrees: float, axial: float | None = None, misalignment: float = 0.0) -> FaceContact:
    geometry = pair_of(degrees)
    slices = face_slices(geometry, misalignment=misalignment)
    contact = tooth_contact(geometry, MODEL, corner_contact=True, faces=slices)
    slope = -math.tan(geometry.driver.base_helix_angle) if axial is None else axial
    return FaceContact(contact, geometry, face_stations(WIDTH), slope)


HELICAL, SPUR = face(14.0), face(0.0)


def approaches(mean: float, shape: float) -> st.SearchStrategy[FloatArray]:
    """Approaches of the flanks about a mean [m] with shapes of some size [m], and a tilt of as much over the face."""
    part = st.floats(-1.0, 1.0)
    return st.lists(part, min_size=6, max_size=6).map(
        lambda parts: np.append(mean + shape * np.array(parts[:5]), shape / WIDTH * parts[5])
    )


def differences(function: object, at: FloatArray, scale: FloatArray) -> FloatArray:
    """Central differences of fourth order of a function of an array, (..., m)."""
    columns = []
    for axis, step in enumerate(scale):
        values = [
            np.asarray(function(at + shift * step * np.eye(at.size)[axis]))  # type: ignore[operator]
            for shift in (-2.0, -1.0, 1.0, 2.0)
        ]
        columns.append((values[0] - 8.0 * values[1] + 8.0 * values[2] - values[3]) / (12.0 * step))
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("mesh", [HELICAL, SPUR], ids=["helical", "spur"])
def test_loads_are_the_slope_of_the_energy_and_stiffness_that_of_the_loads(mesh: FaceContact) -> None:
    """With part of the face apart; the energy is smooth, but for slices that just touch within a step."""
    size = np.append(np.ones(5), 1.0 / WIDTH)
    approach = np.append([28e-6, 26e-6, 18e-6, 9e-6, 4e-6], 4e-4)
    state = mesh.at(approach)
    assert state.force > 0.0
    loaded = mesh.under_force(state.force, approach - mesh.uniform * float(mesh.face_mean @ approach)).line_load
    assert (loaded == 0.0).any()
    slope = differences(lambda y: mesh.at(y).energy, approach, 5e-9 * size)
    np.testing.assert_allclose(slope, state.loads, rtol=0.0, atol=2e-8 * state.force)
    # Loads have corners where slices come into contact, which a step of a nanometre hardly ever meets.
    rise = differences(lambda y: mesh.at(y).loads, approach, 1e-10 * size)
    assert np.abs((rise - state.stiffness) / np.outer(size, size)).max() < 1e-8 * state.stiffness[:5, :5].sum()
    np.testing.assert_array_equal(state.stiffness, state.stiffness.T)


@settings(max_examples=15)
@given(approaches(20e-6, 25e-6), approaches(20e-6, 25e-6))
def test_the_energy_is_convex(first: FloatArray, second: FloatArray) -> None:
    """Loads rise along any change of the approach, the energy lies above its tangents, no stiffness is negative."""
    one, other = HELICAL.at(first), HELICAL.at(second)
    scale = max(one.energy, other.energy) + 1e-12
    assert (other.loads - one.loads) @ (second - first) >= -1e-9 * scale
    assert other.energy - one.energy - one.loads @ (second - first) >= -1e-9 * scale
    values = np.linalg.eigvalsh(one.stiffness / np.outer([1, 1, 1, 1, 1, 1 / WIDTH], [1, 1, 1, 1, 1, 1 / WIDTH]))
    assert values[0] >= -1e-9 * abs(values[-1])


@settings(max_examples=10)
@given(approaches(0.0, 10e-6), st.floats(10.0, 2e4))
def test_the_mean_over_a_period_carries_the_force(shape: FloatArray, force: float) -> None:
    """Conjugate loads at the stations sum to the mesh force at every phase, and in the mean; a round trip closes."""
    shape = shape - HELICAL.uniform * float(HELICAL.face_mean @ shape)
    load = HELICAL.under_force(force, shape)
    np.testing.assert_allclose(load.loads[:, :-1].sum(axis=1), force, rtol=1e-9)
    np.testing.assert_allclose(load.line_load.sum(axis=1) * WIDTH / HELICAL.z.size, force, rtol=1e-9)
    state = HELICAL.at(shape + HELICAL.uniform * load.deflection.mean())
    assert state.force == pytest.approx(force, rel=1e-8)
    np.testing.assert_allclose(state.loads, load.loads.mean(axis=0), atol=1e-8 * force)


@pytest.mark.parametrize(("degrees", "misalignment"), [(0.0, 0.0), (14.0, 0.0), (0.0, 4e-4), (14.0, -3e-4)])
def test_straight_approaches_are_those_of_misaligned_flanks(degrees: float, misalignment: float) -> None:
    """Without axial forces, a gap that opens by mu z is an approach of -mu z."""
    geometry = pair_of(degrees)
    contact = tooth_contact(
        geometry, MODEL, corner_contact=True, faces=face_slices(geometry, misalignment=misalignment)
    )
    mesh = face(degrees, axial=0.0)
    shape = -misalignment * np.append(mesh.stations, 0.0)
    for force in (200.0, FORCE):
        expected = loaded_transmission_error(contact, force, PHASES)
        assert expected.line_loads is not None
        found = mesh.under_force(force, shape, PHASES)
        np.testing.assert_allclose(found.deflection, expected.transmission_error, rtol=1e-9)
        np.testing.assert_allclose(found.line_load, expected.line_loads.sum(axis=1), atol=1e-6 * force / WIDTH)
        np.testing.assert_allclose(mesh.stiffness_of(found), expected.tangent_stiffness, rtol=1e-8)


def test_the_moments_of_the_load_are_those_of_its_centre() -> None:
    """The loads at the stations have the moment of the line load, and the tilt that of the load's place on the path."""
    geometry = pair_of(14.0)
    contact = tooth_contact(geometry, MODEL, corner_contact=True, faces=face_slices(geometry))
    mesh = face(14.0)
    load = mesh.under_force(FORCE, np.zeros(6), PHASES)
    over, along = load_arms(contact, geometry, FORCE, PHASES).T
    np.testing.assert_allclose(load.loads[:, :-1] @ mesh.stations, FORCE * over, atol=1e-9 * FORCE * WIDTH)
    tilt = math.tan(geometry.driver.base_helix_angle) * FORCE * along
    np.testing.assert_allclose(load.loads[:, -1], tilt, atol=1e-9 * FORCE * WIDTH)


def test_the_spring_of_a_whole_mesh_lies_on_the_whole_path() -> None:
    """Its even load has its centre in the middle of the path of contact, off the pitch point."""
    geometry = pair_of(14.0)
    faces = replace(face_slices(geometry), coupling=0.0)
    contact = tooth_contact(geometry, ConstantStiffness(4e8), faces=replace(faces, gap=0.0 * faces.gap))
    mesh = FaceContact(contact, geometry, face_stations(WIDTH), 1.0)
    middle = geometry.base_pitch * (0.5 * geometry.contact_ratio - geometry.pitch_point_position)
    assert abs(middle) > 1e-5
    loads = mesh.under_force(FORCE, np.zeros(6)).loads.mean(axis=0)
    assert loads[-1] == pytest.approx(-FORCE * middle, rel=1e-3)


@settings(max_examples=10)
@given(st.floats(1e-6, 2e-3), st.sampled_from([HELICAL, SPUR]))
def test_the_load_moves_to_the_end_that_approaches_more(slope: float, mesh: FaceContact) -> None:
    centres = [
        mesh.under_force(FORCE, side * slope * np.append(mesh.stations, 0.0)).line_load.mean(axis=0) @ mesh.z
        for side in (-1.0, 0.0, 1.0)
    ]
    assert centres[0] < centres[1] < centres[2]


def test_flanks_apart_carry_nothing() -> None:
    state = HELICAL.at(-1e-6 * HELICAL.uniform)
    assert (state.energy, state.force) == (0.0, 0.0)
    assert not state.loads.any()
    assert not state.stiffness.any()
    # Just beyond first touch the force begins from nothing.
    assert 0.0 < HELICAL.at((HELICAL.touch + 1e-9) * HELICAL.uniform).force < 5.0


def test_means_and_slopes_over_the_face() -> None:
    """Polynomials through the stations are exact; the mean and the slope are those of the best straight line."""
    stations = face_stations(WIDTH)
    z = HELICAL.z
    assert stations[[0, -1]].tolist() == pytest.approx([-0.5 * WIDTH, 0.5 * WIDTH])
    for power in range(5):
        np.testing.assert_allclose(lagrange(stations, z) @ stations**power, z**power, atol=1e-12 * WIDTH**power)
    bent = np.append(3e-6 + 2e-4 * stations + 0.5 * stations**2, 0.7)
    slope, mean = np.polyfit(z, 3e-6 + 2e-4 * z + 0.5 * z**2, 1)
    assert HELICAL.face_slope @ bent == pytest.approx(slope, rel=1e-9)
    assert HELICAL.face_mean @ bent == pytest.approx(mean, rel=1e-9)


def test_a_contact_without_slices_and_stations_off_the_face_are_refused() -> None:
    geometry = pair_of(0.0)
    plain = replace(tooth_contact(geometry, MODEL), faces=None)
    with pytest.raises(GearError, match="the contact has no face slices; expected those of `face_slices`"):
        FaceContact(plain, geometry, face_stations(WIDTH), 0.0)
    sliced = tooth_contact(geometry, MODEL, faces=face_slices(geometry))
    for stations in (np.array([0.0]), np.array([-0.02, 0.0, 0.01])):
        with pytest.raises(GearError, match=r"stations .* m; expected two or more within the face"):
            FaceContact(sliced, geometry, stations, 0.0)


@settings(deadline=None, max_examples=15)
@given(st.lists(st.tuples(st.floats(-2e-5, 6e-5), approaches(0.0, 2e-5)), min_size=2, max_size=4))
def test_an_approach_has_no_memory_of_those_before(path: list[tuple[float, FloatArray]]) -> None:
    """The search starts from the last approach's force and slices, touching or apart."""
    mesh = face(14.0)
    for mean, shape in path:
        approach = shape + mean * mesh.uniform
        found, alone = mesh.at(approach), face(14.0).at(approach)
        assert found.force == pytest.approx(alone.force, rel=1e-9, abs=1e-9)
        scale = np.abs(alone.stiffness).max()
        np.testing.assert_allclose(found.stiffness, alone.stiffness, rtol=1e-8, atol=1e-9 * scale)
        np.testing.assert_allclose(found.loads, alone.loads, rtol=1e-8, atol=1e-9 * np.abs(alone.loads).max())
    unloaded = face(14.0).unloaded_tangent
    assert mesh.unloaded_tangent.mean_stiffness == pytest.approx(unloaded.mean_stiffness, rel=1e-12)
