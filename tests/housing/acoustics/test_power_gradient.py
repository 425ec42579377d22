"""Gradient of the sound power: adjoint loads against closed forms and differences, and a mesh that slides."""

from collections.abc import Callable

import numpy as np
import pytest
from solids import spherical_shell

from gearwhine.housing.acoustics.medium import AIR
from gearwhine.housing.acoustics.power_gradient import PowerGradient
from gearwhine.housing.acoustics.radiation import HousingRadiation, Method
from gearwhine.housing.acoustics.surface_velocity import surface_velocity
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray

SIZE = (0.3, 0.2, 0.24)
HERTZ = 900.0
OMEGA = 2.0 * np.pi * HERTZ


def waves(mesh: Mesh, seed: int) -> FloatArray:
    """A smooth motion of the nodes, shape (n_nodes, 3)."""
    generator = np.random.default_rng(seed)
    directions, phases = generator.normal(size=(3, 3)), generator.uniform(0.0, 6.0, size=3)
    return np.asarray(np.cos(8.0 * mesh.points @ directions.T + phases))


@pytest.fixture(scope="module")
def solid(block: Callable[..., Mesh]) -> Mesh:
    return block(SIZE, (6, 4, 5))


def load_error(mesh: Mesh, edge: float, method: Method) -> float:
    """Largest error of the adjoint load, against the far field's power of a motion and changes that no mode has."""
    shapes = np.array([waves(mesh, seed) for seed in (1, 2)])
    radiation = HousingRadiation.of_surface(mesh, shapes, edge=edge, close_holes=0.05, method=method)
    rates = np.array([0.3 - 0.2j, 0.5 + 0.4j])
    load = PowerGradient.at(radiation, HERTZ).nodal_load(rates)
    motion = np.tensordot(rates / (1j * OMEGA), shapes, axes=1)
    errors = []
    for seed in (3, 4, 5):
        change = 1e-4 * (waves(mesh, seed) + 0.7j * waves(mesh, seed + 10))
        fields = np.array([motion.real, motion.imag, change.real, change.imag])
        sound = radiation.with_shapes(fields).solve(HERTZ, 1j * OMEGA * np.eye(4))
        own, other = np.array([1.0, 1j, 0.0, 0.0]), np.array([0.0, 0.0, 1.0, 1j])
        product = [(other.conj() @ sound.resistance @ one).real for one in (own, other)]
        size = np.sqrt((own.conj() @ sound.resistance @ own).real * product[1])
        errors.append(abs((load @ change.ravel()).real - product[0]) / size)
    return float(max(errors))


def test_the_adjoint_load_is_the_gradient(solid: Mesh) -> None:
    """Exact of the equivalent power; by boundary elements good to their reciprocity, as the square of the edge."""
    assert load_error(solid, 0.05, "erp") < 1e-12
    coarse, fine = (load_error(solid, edge, "boundary-elements") for edge in (0.06, 0.03))
    assert coarse < 1e-2
    assert fine < 0.5 * coarse


def test_modes_superpose(solid: Mesh) -> None:
    shapes = np.array([waves(solid, seed) for seed in (1, 2)])
    radiation = HousingRadiation.of_surface(solid, shapes, edge=0.05, close_holes=0.05)
    power, rates = PowerGradient.at(radiation, HERTZ), np.array([0.3 - 0.2j, 0.5 + 0.4j])
    whole, direct = power.sound(rates), radiation.solve(HERTZ, rates[:, None])
    assert whole.power == pytest.approx(direct.power, rel=1e-9)
    assert whole.surface_power == pytest.approx(direct.surface_power, rel=1e-9)
    assert 0.5 * (rates.conj() @ power.resistance @ rates).real == pytest.approx(
        direct.power, rel=5e-3
    )  # by reciprocity


def test_a_breathing_sphere() -> None:
    """A sphere of the radius a that breathes with the velocity v: W = 2π a² ρc v² (ka)² / (1 + (ka)²)."""
    radius = 0.15
    mesh = spherical_shell(0.12, radius, 8)
    radial = mesh.points / np.linalg.norm(mesh.points, axis=1, keepdims=True)
    radiation = HousingRadiation.of_surface(mesh, radial[None], edge=0.03, close_holes=0.03)
    power = PowerGradient.at(radiation, HERTZ)
    squared = (OMEGA / AIR.speed_of_sound * radius) ** 2
    expected = 4.0 * np.pi * radius**2 * AIR.impedance * squared / (1.0 + squared)
    assert power.resistance[0, 0] == pytest.approx(expected, rel=0.03)
    # dW = ω² R u du
    load = power.nodal_load(np.array([2.0 * 1j * OMEGA]))
    assert load @ radial.ravel() == pytest.approx(OMEGA**2 * expected * 2.0, rel=0.03)


@pytest.mark.parametrize("order", [1, 2])
def test_a_mesh_slides_along_the_surface(block: Callable[..., Mesh], order: int) -> None:
    """Of a motion u_z = a · x, nodes at V along the faces leave points of the surface with the motion -a · V."""
    mesh = block(SIZE, (6, 4, 5), order)
    slope, velocity = np.array([3.0, -2.0, 0.0]), np.array([0.4, 0.7, 0.2])
    motion = np.zeros((len(mesh.points), 3), dtype=complex)
    motion[:, 2] = (1.0 + 2.0j) * (mesh.points @ slope)
    radiation = HousingRadiation.of_surface(mesh, motion.real[None], edge=0.05, close_holes=0.05, method="erp")
    (points,), surface = radiation.skins, radiation.elements[0].surface
    change = points.sliding(np.tile(velocity, (len(mesh.points), 1)), motion).reshape(-1, 3)
    ends = np.abs(surface.normals[:, 2]) > 0.999
    expected = -(1.0 + 2.0j) * (slope @ velocity) * surface.normals[ends, 2]
    assert change[ends] == pytest.approx(np.tile(expected[:, None], 3), abs=1e-9)
    # The power at the same nodal motion, of equivalent power ½ ρc ω² ∫ |u · n|² dS.
    power = PowerGradient.at(radiation, HERTZ)
    own = power.by_sliding(np.array([1j * OMEGA]), motion.real + 0j, np.tile(velocity, (len(mesh.points), 1)))
    normal = (points.transfer @ motion.real.ravel()).reshape(-1, 3)
    slid = points.sliding(np.tile(velocity, (len(mesh.points), 1)), motion.real + 0j).real.reshape(-1, 3)
    weights = surface.areas / 12.0
    product = (normal * slid).sum(axis=1) + normal.sum(axis=1) * slid.sum(axis=1)
    assert own == pytest.approx(AIR.impedance * OMEGA**2 * float(weights @ product))


def test_a_mesh_that_slides_is_that_of_the_moved_mesh(solid: Mesh) -> None:
    """Against the transfer of a mesh whose nodes are moved, and the radiating surface not."""
    radiation = HousingRadiation.of_surface(solid, waves(solid, 1)[None], edge=0.05, close_holes=0.05)
    surface, (points,) = radiation.elements[0].surface, radiation.skins
    # Nodes slide along the faces and stay at the edges.
    inner = np.sin(np.pi * solid.points / np.array(SIZE))
    velocity, motion = inner * waves(solid, 3), waves(solid, 4)
    own = points.sliding(velocity, motion + 0j)
    step, either = 1e-6, []
    for way in (step, -step):
        moved = Mesh(solid.points + way * velocity, solid.blocks, solid.surfaces)
        either.append(surface_velocity(moved, surface).transfer() @ motion.ravel())
    expected = (either[0] - either[1]) / (2.0 * step)
    assert np.abs(own - expected).max() < 1e-3 * np.abs(expected).max()
    assert np.abs(own.imag).max() == 0.0
