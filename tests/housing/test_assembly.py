"""Stiffness and mass against scikit-fem's own forms, uniform strain and rigid motion."""

import tracemalloc
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
import skfem
from scipy import sparse
from skfem.helpers import ddot, div, dot, sym_grad, trace

from gearwhine.housing import HousingError, Material, assemble
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.meshes import ElementBlock, Mesh
from gearwhine.meshes.elements import KINDS, SOLIDS, facet_nodes
from gearwhine.meshes.shape_functions import node_order, quadrature, reference_element


def _skfem_mesh(kind: str) -> tuple[type, type]:
    """scikit-fem's mesh classes with the corners of a kind: with straight edges, and isoparametric."""
    base = {"tetra": skfem.MeshTet1, "hexahedron": skfem.MeshHex1, "wedge": skfem.MeshWedge1}[KINDS[kind].corners]

    element = type(reference_element(kind))

    @dataclass(repr=False)
    class Isoparametric(base):  # type: ignore[misc,valid-type]
        elem: type = element
        affine: bool = False
        sort_t: bool = False

    return base, Isoparametric


def _skfem_matrices(mesh: Mesh, material: Material) -> tuple[sparse.csr_array, sparse.csr_array]:
    """scikit-fem's elasticity and mass on the same nodes, in our numbering and by the same quadrature."""
    (block,) = mesh.blocks
    kind = block.of
    nodes = block.nodes[:, np.argsort(node_order(block.kind))]  # in scikit-fem's order of a kind's nodes
    corners, local = np.unique(nodes[:, : kind.n_corners], return_inverse=True)
    base, isoparametric = _skfem_mesh(block.kind)
    linear = base(mesh.points[corners].T, local.reshape(-1, kind.n_corners).T)
    solid = linear
    if kind.order == 2:
        solid = isoparametric.from_mesh(linear)
        places = solid.doflocs.copy()
        places[:, solid.dofs.element_dofs] = mesh.points[nodes.T].transpose(2, 0, 1)
        solid = isoparametric(places, solid.t)
    lam, mu = material.lame

    @skfem.BilinearForm
    def elasticity(u, v, _):  # type: ignore[no-untyped-def]
        strain = sym_grad(u)
        return lam * trace(strain) * div(v) + 2 * mu * ddot(strain, sym_grad(v))

    @skfem.BilinearForm
    def inertia(u, v, _):  # type: ignore[no-untyped-def]
        return material.density * dot(u, v)

    matrices = []
    # More than affine tetrahedra need, whose stiffness is exact at less.
    degrees = (2 * kind.order + 1 if kind.corners == "tetra" else 2 * kind.order, 2 * kind.order)
    for form, degree in zip((elasticity, inertia), degrees, strict=True):
        # scikit-fem's own quadrature of a wedge is no product of a triangle's and a line's: its weights sum to 1/4.
        rule = {"quadrature": quadrature("wedge", degree)} if kind.corners == "wedge" else {"intorder": degree}
        element = reference_element(block.kind)
        basis = skfem.Basis(solid, skfem.ElementVector(element), mapping=solid.mapping(), **rule)
        ours = (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), -1).T
        theirs = np.empty(basis.N, dtype=np.int64)
        theirs[ours] = basis.element_dofs
        matrices.append(sparse.csr_array(form.assemble(basis))[theirs][:, theirs])
    return matrices[0], matrices[1]


def _assert_as_scikit_fem(mesh: Mesh, steel: Material) -> None:
    ours = assemble(mesh, steel)
    stiffness, mass = _skfem_matrices(mesh, steel)
    assert abs(ours.stiffness - stiffness).max() < 1e-13 * abs(stiffness).max()
    assert abs(ours.mass - mass).max() < 1e-13 * abs(mass).max()


@pytest.mark.parametrize("name", ["box", "straight_box"])
def test_housings_are_identical_to_scikit_fem(name: str, steel: Material, request: pytest.FixtureRequest) -> None:
    _assert_as_scikit_fem(request.getfixturevalue(name), steel)


def _bent(points: np.ndarray) -> np.ndarray:
    """A smooth map with curved edges and faces, and nothing parallel."""
    x, y, z = points.T
    return np.stack([x + 0.2 * y * z - 0.1 * y**2, y + 0.15 * x * z + 0.1 * z, z + 0.1 * x**2 - 0.15 * x * y], axis=1)


@pytest.mark.parametrize("kind", SOLIDS)
def test_every_kind_is_identical_to_scikit_fem_where_curved(
    block_of: Callable[..., Mesh], steel: Material, kind: str
) -> None:
    _assert_as_scikit_fem(block_of(kind, cells=(2, 1, 2), bend=_bent), steel)


@pytest.mark.parametrize("kind", SOLIDS)
def test_every_kind_has_the_exact_energies_of_its_polynomials(
    block_of: Callable[..., Mesh], steel: Material, kind: str
) -> None:
    """Parallelepipeds: u_x = x^p stores ½ (λ + 2 μ) p² ∫ x^(2p-2) dV and moves with ½ ρ ∫ x^2p dV, upright or not."""
    a, b, c = 0.9, 0.7, 0.5
    p = KINDS[kind].order
    slant = np.array([[1.0, 0.0, 0.0], [0.3, 1.0, 0.0], [-0.2, 0.4, 1.0]])  # x stays; y and z lean
    mesh = block_of(kind, (a, b, c), (2, 1, 1), lambda points: points @ slant.T)
    matrices = assemble(mesh, steel)
    lam, mu = steel.lame
    field = np.zeros_like(mesh.points)
    field[:, 0] = mesh.points[:, 0] ** p
    strain = (lam + 2 * mu) * p**2 * a ** (2 * p - 1) / (2 * p - 1) * b * c
    assert field.ravel() @ matrices.stiffness @ field.ravel() == pytest.approx(strain, rel=1e-12)
    motion = steel.density * a ** (2 * p + 1) / (2 * p + 1) * b * c
    assert field.ravel() @ matrices.mass @ field.ravel() == pytest.approx(motion, rel=1e-12)


@pytest.mark.parametrize("kind", SOLIDS)
def test_every_kind_has_six_rigid_motions_and_no_others(
    block_of: Callable[..., Mesh], steel: Material, rigid_fields: Callable[..., np.ndarray], kind: str
) -> None:
    mesh = block_of(kind, bend=_bent)
    matrices = assemble(mesh, steel)
    rigid = rigid_fields(mesh.points)
    assert np.abs(matrices.stiffness @ rigid.T).max() < 1e-12 * abs(matrices.stiffness).max()
    values = np.linalg.eigvalsh(matrices.stiffness.toarray())
    assert np.count_nonzero(values < 1e-9 * values.max()) == 6
    assert np.linalg.eigvalsh(matrices.mass.toarray()).min() > 0.0


def _mixed(block_of: Callable[..., Mesh]) -> Mesh:
    """Wedges and hexahedra side by side: blocks of two kinds that share the quadrilaterals between them."""
    left, right = block_of("wedge15", cells=(1, 2, 2)), block_of("hexahedron20", cells=(1, 2, 2))
    points = np.vstack([left.points, right.points + [1.0, 0.0, 0.0]])
    unique, inverse = np.unique(np.round(4 * points), axis=0, return_inverse=True)
    first, second = left.blocks[0], right.blocks[0]
    blocks = (
        ElementBlock("wedge15", inverse[first.nodes]),
        ElementBlock("hexahedron20", inverse[second.nodes + len(left.points)]),
    )
    volumes = {"left": np.arange(8), "right": np.arange(8, 12)}
    return Mesh(unique / 4, blocks, volumes=volumes)


def test_kinds_mix_in_one_mesh(block_of: Callable[..., Mesh], steel: Material) -> None:
    """Uniform strain is exact across the face where the kinds meet, and leaves no force within."""
    mesh = _mixed(block_of)
    matrices = assemble(mesh, steel)
    assert matrices.total_mass == pytest.approx(2 * steel.density)
    gradient = np.array([[1.0, 0.4, -0.2], [0.1, -0.5, 0.3], [0.6, -0.7, 0.2]]) * 1e-3
    field = mesh.points @ gradient.T
    strain = (gradient + gradient.T) / 2
    energy = np.einsum("ij,ijkl,kl->", strain, steel.elasticity, strain) * 2
    assert field.ravel() @ matrices.stiffness @ field.ravel() == pytest.approx(energy, rel=1e-12)
    inner = np.setdiff1d(np.arange(len(mesh.points)), facet_nodes(mesh.boundary))
    forces = (matrices.stiffness @ field.ravel()).reshape(-1, 3)
    assert len(inner) > 0
    assert np.abs(forces[inner]).max() < 1e-12 * abs(matrices.stiffness).max() * np.abs(field).max()


def test_each_volume_has_its_own_material(block_of: Callable[..., Mesh], steel: Material) -> None:
    """The matrices are the sums of those of the parts, each by itself in its material."""
    mesh = _mixed(block_of)
    soft = Material(70e9, 0.33, 2700.0)
    both = assemble(mesh, steel, {"right": soft})
    assert both.total_mass == pytest.approx(steel.density + soft.density)
    parts = []
    for block, material in zip(mesh.blocks, (steel, soft), strict=True):
        used, inverse = np.unique(block.nodes, return_inverse=True)
        alone = Mesh(mesh.points[used], (ElementBlock(block.kind, inverse.reshape(block.nodes.shape)),))
        dofs = (3 * used[:, None] + np.arange(3)).ravel()
        spread = sparse.csr_array((np.ones(len(dofs)), (dofs, np.arange(len(dofs)))), shape=(3 * len(mesh.points),) * 2)
        spread = spread[:, : len(dofs)]
        parts.append([spread @ matrix @ spread.T for matrix in _pair(assemble(alone, material))])
    for ours, (first, second) in zip(_pair(both), zip(*parts, strict=True), strict=True):
        assert abs(ours - first - second).max() < 1e-14 * abs(ours).max()
    only = assemble(mesh, soft, {"left": steel})
    assert np.array_equal(only.blocks, both.blocks)


def _pair(matrices: Matrices) -> tuple[sparse.csr_array, sparse.csr_array]:
    return matrices.stiffness, matrices.mass


def test_materials_of_unknown_or_overlapping_volumes_are_refused(
    block_of: Callable[..., Mesh], steel: Material
) -> None:
    mesh = _mixed(block_of)
    with pytest.raises(HousingError, match=r"no volume 'lid' to be of its own material; it has: left, right"):
        assemble(mesh, steel, {"lid": steel})
    overlapping = replace(mesh, volumes={**mesh.volumes, "some": np.array([7, 8])})
    with pytest.raises(HousingError, match=r"volumes 'right' and 'some' share 1 elements"):
        assemble(overlapping, steel, {"right": steel, "some": steel})


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


def test_threads_and_chunks_make_no_difference(box: Mesh, steel: Material, box_matrices: Matrices) -> None:
    for threads, chunk in ((1, None), (3, None), (2, 100), (1, 100), (5, 7)):
        again = assemble(box, steel, threads=threads, chunk=chunk)
        if chunk is None:
            assert np.array_equal(again.blocks, box_matrices.blocks)
            assert np.array_equal(again.node_mass, box_matrices.node_mass)
        assert np.abs(again.blocks - box_matrices.blocks).max() < 1e-14 * np.abs(box_matrices.blocks).max()
        np.testing.assert_allclose(again.node_mass, box_matrices.node_mass, atol=1e-15 * box_matrices.total_mass)
    assert np.array_equal(
        assemble(box, steel, threads=1, chunk=100).blocks, assemble(box, steel, threads=4, chunk=100).blocks
    )
    for wrong in ({"threads": 0}, {"chunk": 0}):
        with pytest.raises(HousingError, match="give at least 1 of both"):
            assemble(box, steel, **wrong)


def test_working_memory_is_bounded_by_the_chunks(block_of: Callable[..., Mesh], steel: Material) -> None:
    """Beside the result and the sums that become it, small chunks need little, however many elements there are."""
    mesh = block_of("hexahedron20", cells=(10, 10, 6))
    assemble(mesh, steel)  # what is read once, such as shape functions
    peaks = {}
    for chunk in (20, 600):
        tracemalloc.start()
        result = assemble(mesh, steel, threads=1, chunk=chunk)
        peaks[chunk] = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    kept = result.blocks.nbytes + result.node_mass.nbytes + result.neighbors.nbytes
    assert peaks[20] < 3.5 * kept
    assert peaks[600] > peaks[20] + 580 * 8 * (3 * 20) ** 2  # the gradient products of all elements at once


def test_folded_elements_are_refused(block: Callable[..., Mesh], steel: Material) -> None:
    """A middle node pushed beyond the opposite corner folds the element although its corners are in order."""
    mesh = block((1.0, 1.0, 1.0))
    points, first = mesh.points.copy(), mesh.blocks[0].nodes[0]
    points[first[4]] += 2 * (points[first[3]] - points[first[4]])
    with pytest.raises(HousingError, match="folded by their curved sides"):
        assemble(replace(mesh, points=points), steel)


def test_barely_folded_elements_are_counted(block: Callable[..., Mesh], steel: Material) -> None:
    """Stiffness and mass have points of their own, of which the first to lose its volume counts."""
    mesh = block((1.0, 1.0, 1.0))
    first = mesh.blocks[0].nodes[0]
    toward = mesh.points[first[3]] - mesh.points[first[4]]
    refused = []
    for part in np.linspace(0.1, 1.0, 46):
        points = mesh.points.copy()
        points[first[4]] += part * toward
        try:
            assemble(replace(mesh, points=points), steel)
        except HousingError as error:
            refused.append(str(error))
    assert 0 < len(refused) < 46
    assert not [message for message in refused if message.startswith("0 ")]


def test_nodes_without_elements_are_refused(block: Callable[..., Mesh], steel: Material) -> None:
    mesh = block((1.0, 1.0, 1.0))
    with pytest.raises(HousingError, match="1 of the mesh's 66 nodes belong to no element"):
        assemble(replace(mesh, points=np.vstack([mesh.points, [9.0, 9.0, 9.0]])), steel)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((0.0, 0.3, 7850.0), "youngs_modulus is 0; expected an elastic modulus"),
        ((207e9, 0.3, -1.0), "density is -1; expected a density above 0"),
        ((float("nan"), 0.3, 7850.0), "youngs_modulus is nan; expected an elastic modulus"),
        ((207e9, 0.5, 7850.0), "poisson_ratio is 0.5; expected a Poisson ratio of at least 0 and below 0.4999"),
        ((207e9, -0.1, 7850.0), "poisson_ratio is -0.1; expected a Poisson ratio of at least 0"),
    ],
)
def test_impossible_materials_are_refused(values: tuple[float, float, float], message: str) -> None:
    with pytest.raises(HousingError, match=message):
        Material(*values)
