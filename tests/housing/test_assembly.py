"""Stiffness and mass against scikit-fem's own forms, uniform strain and rigid motion."""

from collections.abc import Callable

import numpy as np
import pytest
import skfem
from scipy import sparse
from skfem.helpers import ddot, div, dot, sym_grad, trace

from housing import HousingError, Material, Matrices, assemble
from meshes import Mesh


def _skfem_matrices(mesh: Mesh, material: Material) -> tuple[sparse.csr_array, sparse.csr_array]:
    """scikit-fem's elasticity and mass on the same nodes, in our numbering and by the same quadrature degrees."""
    corners, local = np.unique(mesh.cells[:, :4], return_inverse=True)
    linear = skfem.MeshTet(mesh.points[corners].T, local.reshape(-1, 4).T)
    if mesh.order == 1:
        solid, element, degrees = linear, skfem.ElementTetP1(), (1, 2)
    else:
        solid, element, degrees = skfem.MeshTet2.from_mesh(linear), skfem.ElementTetP2(), (2, 4)
        places = solid.doflocs.copy()
        places[:, solid.dofs.element_dofs] = mesh.points[mesh.cells.T].transpose(2, 0, 1)
        solid = skfem.MeshTet2(places, solid.t)
    lam, mu = material.lame

    @skfem.BilinearForm
    def elasticity(u, v, _):  # type: ignore[no-untyped-def]
        strain = sym_grad(u)
        return lam * trace(strain) * div(v) + 2 * mu * ddot(strain, sym_grad(v))

    @skfem.BilinearForm
    def inertia(u, v, _):  # type: ignore[no-untyped-def]
        return material.density * dot(u, v)

    matrices = []
    for form, degree in zip((elasticity, inertia), degrees, strict=True):
        basis = skfem.Basis(solid, skfem.ElementVector(element), intorder=degree)
        ours = (3 * mesh.cells[:, :, None] + np.arange(3)).reshape(len(mesh.cells), -1).T
        theirs = np.empty(basis.N, dtype=np.int64)
        theirs[ours] = basis.element_dofs
        matrices.append(sparse.csr_array(form.assemble(basis))[theirs][:, theirs])
    return matrices[0], matrices[1]


@pytest.mark.parametrize("name", ["box", "straight_box"])
def test_identical_to_scikit_fem(name: str, steel: Material, request: pytest.FixtureRequest) -> None:
    mesh = request.getfixturevalue(name)
    ours = assemble(mesh, steel)
    stiffness, mass = _skfem_matrices(mesh, steel)
    assert abs(ours.stiffness - stiffness).max() < 1e-13 * abs(stiffness).max()
    assert abs(ours.mass - mass).max() < 1e-13 * abs(mass).max()


def test_matrices_are_symmetric_and_the_mass_is_positive(cube: tuple[Mesh, Matrices], box_matrices: Matrices) -> None:
    assert abs(box_matrices.stiffness - box_matrices.stiffness.T).max() < 1e-13 * abs(box_matrices.stiffness).max()
    assert abs(box_matrices.mass - box_matrices.mass.T).max() == 0.0
    assert np.linalg.eigvalsh(cube[1].mass.toarray()).min() > 0.0


@pytest.mark.parametrize("order", [1, 2])
def test_rigid_motions_and_nothing_else_meet_no_stiffness(
    block: Callable[..., Mesh], steel: Material, rigid_fields: Callable[..., np.ndarray], order: int
) -> None:
    mesh = block((0.10, 0.07, 0.05), order=order)
    stiffness = assemble(mesh, steel).stiffness
    rigid = rigid_fields(mesh.points)
    assert np.abs(stiffness @ rigid.T).max() < 1e-13 * abs(stiffness).max() * np.abs(rigid).max() * 10
    values = np.linalg.eigvalsh(stiffness.toarray())
    assert np.count_nonzero(values < 1e-9 * values.max()) == 6


def test_rigid_motions_meet_no_stiffness_on_curved_elements(
    box: Mesh, box_matrices: Matrices, rigid_fields: Callable[..., np.ndarray]
) -> None:
    rigid = rigid_fields(box.points)
    forces = box_matrices.stiffness @ rigid.T
    assert np.abs(forces).max() < 1e-12 * abs(box_matrices.stiffness).max()


def test_mass_and_moments_of_inertia_of_a_block(
    block: Callable[..., Mesh], steel: Material, rigid_fields: Callable[..., np.ndarray]
) -> None:
    """m = ρ a b c; about the centre m (b² + c²) / 12 and so on; no products of inertia."""
    a, b, c = 0.10, 0.07, 0.05
    mesh = block((a, b, c), (2, 1, 1))
    matrices = assemble(mesh, steel)
    mass = steel.density * a * b * c
    assert matrices.total_mass == pytest.approx(mass, rel=1e-12)
    rigid = rigid_fields(mesh.points - [a / 2, b / 2, c / 2])
    expected = mass * np.diag([1, 1, 1, (b * b + c * c) / 12, (a * a + c * c) / 12, (a * a + b * b) / 12])
    np.testing.assert_allclose(rigid @ matrices.mass @ rigid.T, expected, atol=1e-12 * mass)


@pytest.mark.parametrize("order", [1, 2])
def test_uniform_strain_stores_the_energy_of_hookes_law(
    block: Callable[..., Mesh], steel: Material, order: int
) -> None:
    """½ uᵀ K u = ½ ε : c : ε V for u = A x, whatever A's rotation."""
    size = (0.10, 0.07, 0.05)
    mesh = block(size, (2, 1, 1), order)
    gradient = np.array([[1.0, 0.4, -0.2], [0.1, -0.5, 0.3], [0.6, -0.7, 0.2]]) * 1e-3
    field = (mesh.points @ gradient.T).ravel()
    strain = (gradient + gradient.T) / 2
    energy = 0.5 * np.einsum("ij,ijkl,kl->", strain, steel.elasticity, strain) * np.prod(size)
    assert 0.5 * field @ assemble(mesh, steel).stiffness @ field == pytest.approx(energy, rel=1e-12)


def test_elasticity_is_hookes_law_in_tension_and_shear(steel: Material) -> None:
    """Uniaxial stress E ε stretches by ε and thins by ν ε; a shear γ costs G γ with G = E / 2(1 + ν)."""
    e, nu = steel.youngs_modulus, steel.poisson_ratio
    tension = np.einsum("ijkl,kl->ij", steel.elasticity, np.diag([1.0, -nu, -nu]))
    np.testing.assert_allclose(tension, np.diag([e, 0.0, 0.0]), atol=1e-6 * e)
    shear = np.zeros((3, 3))
    shear[0, 1] = shear[1, 0] = 0.5
    assert np.einsum("ijkl,kl->ij", steel.elasticity, shear)[0, 1] == pytest.approx(e / (2 * (1 + nu)))


def test_shifted_is_the_combination_on_one_pattern(box_matrices: Matrices) -> None:
    shifted = box_matrices.shifted(3e7)
    expected = box_matrices.stiffness - 3e7 * box_matrices.mass
    assert abs(shifted - expected).max() < 1e-14 * abs(expected).max()
    assert np.array_equal(shifted.indices, box_matrices.shifted(0.0).indices)
    assert np.array_equal(shifted.indptr, box_matrices.stiffness.indptr)


def test_large_meshes_are_assembled_in_parts_that_make_no_difference(
    box: Mesh, steel: Material, box_matrices: Matrices, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("housing.assembly._CHUNK", 100)
    again = assemble(box, steel)
    assert np.abs(again.blocks - box_matrices.blocks).max() < 1e-14 * np.abs(box_matrices.blocks).max()
    np.testing.assert_allclose(again.node_mass, box_matrices.node_mass, atol=1e-15 * box_matrices.total_mass)


def test_folded_elements_are_refused(block: Callable[..., Mesh], steel: Material) -> None:
    """A middle node pushed beyond the opposite corner folds the element although its corners are in order."""
    mesh = block((1.0, 1.0, 1.0))
    points, first = mesh.points.copy(), mesh.cells[0]
    points[first[4]] += 2 * (points[first[3]] - points[first[4]])
    with pytest.raises(HousingError, match="folded by their curved sides"):
        assemble(Mesh(points, mesh.cells), steel)


def test_nodes_without_elements_are_refused(block: Callable[..., Mesh], steel: Material) -> None:
    mesh = block((1.0, 1.0, 1.0))
    with pytest.raises(HousingError, match="1 of the mesh's 66 nodes belong to no element"):
        assemble(Mesh(np.vstack([mesh.points, [9.0, 9.0, 9.0]]), mesh.cells), steel)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((0.0, 0.3, 7850.0), "E = 0.0 Pa"),
        ((207e9, 0.3, -1.0), r"ρ = -1.0 kg/m³ must be positive"),
        ((float("nan"), 0.3, 7850.0), "E = nan"),
        ((207e9, 0.5, 7850.0), "Poisson's ratio 0.5"),
        ((207e9, -0.1, 7850.0), "Poisson's ratio -0.1"),
    ],
)
def test_impossible_materials_are_refused(values: tuple[float, float, float], message: str) -> None:
    with pytest.raises(HousingError, match=message):
        Material(*values)
