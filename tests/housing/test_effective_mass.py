"""Mass properties against closed forms, and effective masses against Euler and Bernoulli's cantilever."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from scipy import linalg

from gearwhine.housing import Certificate, Housing, Material, ModeSet, Support, assemble, effective_mass, solve_modes
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.patches import rigid_body, rigid_motions
from gearwhine.housing.model.supports import fixed_freedoms
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray

LENGTH, WIDTH, DEPTH = 0.6, 0.02, 0.024


@pytest.fixture(scope="module")
def cantilever(block: Callable[..., Mesh], steel: Material) -> tuple[Mesh, Matrices, npt.NDArray[np.int64]]:
    """A slender beam along z, clamped at z = 0."""
    mesh = block((WIDTH, DEPTH, LENGTH), (1, 1, 12))
    fixed = fixed_freedoms(mesh, [Support("root", surface="bottom", fixed=(True, True, True))])
    return mesh, assemble(mesh, steel), fixed


def bending_parts(count: int) -> FloatArray:
    """Effective mass of a cantilever's bending modes as parts of its mass: (2 σ / β)², Euler and Bernoulli.

    cos β cosh β = -1, and ∫φ dz / L = 2 σ / β with φ of unit mean square, σ = (sinh β - sin β) / (cosh β + cos β).
    """
    roots = []
    for number in range(count):
        low, high = np.pi * number, np.pi * (number + 1)
        for _ in range(80):
            middle = 0.5 * (low + high)
            same = (np.cos(low) + 1 / np.cosh(low)) * (np.cos(middle) + 1 / np.cosh(middle)) > 0
            low, high = (middle, high) if same else (low, middle)
        roots.append(low)
    beta = np.array(roots)
    return (2.0 * (np.sinh(beta) - np.sin(beta)) / (np.cosh(beta) + np.cos(beta)) / beta) ** 2


def test_closed_form_of_the_cantilever() -> None:
    """The textbook's percentages (61.3, 18.8, 6.5), so that the closed form itself is checked."""
    np.testing.assert_allclose(100 * bending_parts(3), [61.3, 18.8, 6.5], atol=0.05)


@pytest.mark.parametrize("axis", [0, 1])
def test_cantilever_bending(cantilever: tuple[Mesh, Matrices, npt.NDArray[np.int64]], axis: int) -> None:
    mesh, matrices, fixed = cantilever
    modes = solve_modes(matrices.held(fixed), frequency_limit=2 * np.pi * 1500.0)
    result = effective_mass(matrices.held(fixed), mesh.points, modes)
    fractions = result.fractions[:, axis]
    bending = np.sort(fractions)[::-1][:3]
    # The clamped section's own mass moves with the ground and shear and rotary inertia are small: within 1 %.
    np.testing.assert_allclose(bending, bending_parts(3), rtol=0.01, atol=0.002)
    assert fractions[np.argmax(fractions)] == fractions[fractions > 1e-6][0]  # the first of its plane


def test_modes_and_fixed_patch_press_on_a_shaken_ground_as_the_whole_block(
    block: Callable[..., Mesh], steel: Material
) -> None:
    """Reference: u of all degrees of freedom with the clamped ones moved by e^iωt, by dense algebra, without modes.

    The ground feels Rᵀ_s (K - ω² M) u there; by all modes it is -ω² times the patch's own mass and the oscillators'
    L² / (1 - ω² / ω_r²). Below the first mode and between modes, and Parseval's sum leaves nothing.
    """
    mesh = block((0.05, 0.06, 0.08))
    matrices = assemble(mesh, steel)
    fixed = fixed_freedoms(mesh, [Support("root", surface="bottom", fixed=(True, True, True))])
    free = np.setdiff1d(np.arange(3 * matrices.n_nodes), fixed)
    stiffness, mass = (part.toarray()[np.ix_(free, free)] for part in (matrices.stiffness, matrices.mass))
    values, vectors = linalg.eigh(stiffness, mass)
    shapes = np.zeros((len(values), 3 * matrices.n_nodes))
    shapes[:, free] = vectors.T
    certificate = Certificate(1.0, len(values), len(values), 0.0, 0.0)
    modes = ModeSet(np.sqrt(values), shapes.reshape(len(values), -1, 3), certificate, {}, "dense", 0.0, 1)
    result = effective_mass(matrices.held(fixed), mesh.points, modes)
    np.testing.assert_allclose(result.mass.sum(axis=0), result.free, rtol=1e-9)
    np.testing.assert_allclose(result.missing, 0.0, atol=1e-9)
    assert (result.captured < 1.0).all()  # the patch's own mass is in no mode
    fields = rigid_motions(mesh.points, result.center).reshape(-1, 6)
    for omega in (0.6 * modes.frequencies[0], 0.5 * (modes.frequencies[3] + modes.frequencies[4])):
        dynamic = matrices.stiffness.toarray() - omega**2 * matrices.mass.toarray()
        motion = fields.copy()
        motion[free] = -np.linalg.solve(dynamic[np.ix_(free, free)], dynamic[np.ix_(free, fixed)] @ fields[fixed])
        force = np.einsum("ij,ij->j", fields[fixed], dynamic[fixed] @ motion)
        oscillators = (result.mass / (1.0 - (omega / modes.frequencies) ** 2)[:, None]).sum(axis=0)
        np.testing.assert_allclose(force, -(omega**2) * (result.total - result.free + oscillators), rtol=1e-7)


def test_participation_is_that_of_the_moving_ground(block: Callable[..., Mesh], steel: Material) -> None:
    """The same φᵀ M R as that by which a machine's housing is shaken, about the same point."""
    mesh = block((0.05, 0.06, 0.08))
    housing = Housing(mesh, steel, fixtures=(Support("root", surface="bottom", fixed=(True, True, True)),))
    matrices = housing.matrices()
    modes = solve_modes(matrices, count=6)
    result = effective_mass(matrices, mesh.points, modes)
    about_origin = housing.participation(matrices, modes)
    np.testing.assert_allclose(result.participation[:, :3], about_origin[:, :3], rtol=1e-9, atol=1e-12)


def test_a_free_bodys_rigid_modes_carry_all(box: Mesh, box_matrices: Matrices) -> None:
    modes = solve_modes(box_matrices, count=12)
    result = effective_mass(box_matrices, box.points, modes)
    np.testing.assert_allclose(result.fractions[:6].sum(axis=0), 1.0, rtol=1e-9)
    assert result.fractions[6:].max() < 1e-9
    np.testing.assert_allclose(result.total[:3], box_matrices.total_mass, rtol=1e-12)


def test_mass_properties_of_a_block(block: Callable[..., Mesh], steel: Material) -> None:
    """m (b² + c²) / 12 about the middle, wherever the block stands."""
    size = np.array([0.05, 0.06, 0.3])
    mesh = block(tuple(size), (1, 1, 2))
    away = Mesh(mesh.points + [0.4, -0.2, 0.1], mesh.blocks)
    body = rigid_body(away.points, assemble(away, steel))
    mass = 7850.0 * size.prod()
    assert body.mass == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(body.center, 0.5 * size + [0.4, -0.2, 0.1], rtol=1e-12)
    inertia = mass / 12.0 * ((size**2).sum() - size**2)
    np.testing.assert_allclose(body.inertia, np.diag(inertia), atol=1e-12 * inertia.max())


def test_rigid_fields_span_the_rigid_motions(box: Mesh, box_matrices: Matrices, request: pytest.FixtureRequest) -> None:
    """About another centre they span the same motions as the tests' own about the origin, and strain nothing."""
    others: FloatArray = request.getfixturevalue("rigid_fields")(box.points)
    ours = rigid_motions(box.points, np.array([0.1, 0.2, -0.3])).reshape(-1, 6).T
    left = ours - np.linalg.lstsq(others.T, ours.T)[0].T @ others
    assert np.abs(left).max() < 1e-12
    assert np.abs(box_matrices.stiffness @ ours.T).max() < 1e-10 * abs(box_matrices.stiffness).max()
