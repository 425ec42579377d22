"""Mounts and joints: rigid bodies on springs in closed form, no work in common motion, one pattern for all shifts."""

from collections.abc import Callable

import numpy as np
import pytest

from gearwhine.housing import (
    Bushing,
    HousingError,
    Joint,
    LumpedMass,
    Material,
    Mount,
    Patch,
    Support,
    assemble,
    attach_fixtures,
    solve_modes,
)
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.bushings import Axial, axes_along
from gearwhine.housing.model.fixtures import MOST_PATCH_NODES, port_fixture_matrices
from gearwhine.housing.model.patches import rigid_motions
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray

SIDES = (0.10, 0.08, 0.06)
BASE, LID = Patch(surface="bottom"), Patch(surface="top")


@pytest.fixture(scope="module")
def solid(block: Callable[..., Mesh], steel: Material) -> tuple[Mesh, Matrices]:
    """A free block of 0.10 x 0.08 x 0.06 m; its first elastic mode is above 10 kHz."""
    mesh = block(SIDES)
    return mesh, assemble(mesh, steel)


@pytest.fixture(scope="module")
def pair(block: Callable[..., Mesh], steel: Material) -> tuple[Mesh, Matrices]:
    """Two blocks one above the other, 10 mm apart, sharing no node: surfaces bottom, lower, upper, top."""
    one = block(SIDES)
    return (mesh := _stacked(one, one.points + [0.0, 0.0, SIDES[2] + 0.01])), assemble(mesh, steel)


def _stacked(one: Mesh, other_points: FloatArray) -> Mesh:
    n = len(one.points)
    cells, bottom, top = (part[0].nodes for part in (one.blocks, one.surface("bottom"), one.surface("top")))
    surfaces = {"bottom": bottom, "lower": top, "upper": bottom + n, "top": top + n}
    return Mesh.of_tetrahedra(np.vstack([one.points, other_points]), np.vstack([cells, cells + n]), surfaces)


def _block_body() -> tuple[float, FloatArray]:
    """Mass and principal moments of inertia of the block."""
    a, b, c = SIDES
    mass = 7850.0 * a * b * c
    return mass, mass / 12.0 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])


def test_a_block_on_a_soft_mount_is_a_rigid_body_on_springs(solid: tuple[Mesh, Matrices]) -> None:
    """Heave and yaw stand alone; sway along x or y goes with rocking, the centre of gravity being h above the mount:

    (k - ω² m)(k_r - ω² (I + m h²)) = (ω² m h)², for motions u of the mount's centre.
    """
    mesh, free = solid
    k, kr, h = (2e4, 3e4, 5e4), (40.0, 70.0, 90.0), SIDES[2] / 2
    mass, inertia = _block_body()
    expected = [np.sqrt(k[2] / mass), np.sqrt(kr[2] / inertia[2])]
    for across, about in ((0, 1), (1, 0)):
        tip = inertia[about] + mass * h * h
        # m I ω⁴ - (k tip + kr m) ω² + k kr = 0, since m tip - (m h)² = m I.
        squares = np.roots([mass * inertia[about], -(k[across] * tip + kr[about] * mass), k[across] * kr[about]])
        expected += list(np.sqrt(squares))
    modes = solve_modes(attach_fixtures(free, mesh, [Mount("m", BASE, Bushing((*k, *kr)))]), count=6)
    np.testing.assert_allclose(modes.frequencies[:6], np.sort(expected), rtol=2e-5)


def test_a_mount_whose_axes_meet_at_the_centre_of_gravity_decouples(solid: tuple[Mesh, Matrices]) -> None:
    mesh, free = solid
    mass, inertia = _block_body()
    k = (2e4, 3e4, 5e4, 40.0, 70.0, 90.0)
    middle = (SIDES[0] / 2, SIDES[1] / 2, SIDES[2] / 2)
    modes = solve_modes(attach_fixtures(free, mesh, [Mount("m", BASE, Bushing(k), center=middle)]), count=6)
    expected = np.sort(np.sqrt(np.array(k) / np.array([mass] * 3 + list(inertia))))
    np.testing.assert_allclose(modes.frequencies[:6], expected, rtol=2e-5)


@pytest.mark.parametrize("turned", [(0, 1, 2), (1, 2, 0), (2, 0, 1)])
def test_the_axes_of_a_mount_turn_its_springs(solid: tuple[Mesh, Matrices], turned: tuple[int, int, int]) -> None:
    """Amounts along own axes that are the global ones in another order are the amounts in that order."""
    amounts = np.array([1.0, 2.0, 3.0, 0.1, 0.2, 0.3]) * 1e6
    rows = np.eye(3)[list(turned)]
    own = Bushing(tuple(amounts), axes=tuple(map(tuple, rows)))
    sorted_amounts = np.empty(6)
    sorted_amounts[list(turned)], sorted_amounts[[3 + t for t in turned]] = amounts[:3], amounts[3:]
    np.testing.assert_allclose(own.matrix(own.stiffness), np.diag(sorted_amounts), atol=1e-9)


@pytest.mark.parametrize("axis", [(0.0, 0.0, 2.0), (1.0, 0.0, 0.0), (1.0, -2.0, 0.5)])
def test_springs_that_know_one_axis(axis: tuple[float, float, float]) -> None:
    """K = k_s I + (k_a - k_s) n nᵀ, for translations and for rotations."""
    n = np.array(axis) / np.linalg.norm(axis)
    bolt = Bushing.along(axis, Axial(axial=5.0, shear=2.0, tilting=0.3, torsional=0.7), Axial(shear=1.5))
    stiffness = bolt.matrix(bolt.stiffness)
    np.testing.assert_allclose(stiffness[:3, :3], 2.0 * np.eye(3) + 3.0 * np.outer(n, n), atol=1e-14)
    np.testing.assert_allclose(stiffness[3:, 3:], 0.3 * np.eye(3) + 0.4 * np.outer(n, n), atol=1e-14)
    assert np.abs(stiffness[:3, 3:]).max() == 0.0
    np.testing.assert_allclose(bolt.matrix(bolt.damping)[:3, :3], 1.5 * (np.eye(3) - np.outer(n, n)), atol=1e-14)


def test_axes_along_two_directions_are_right_handed_and_start_across() -> None:
    frame = np.array(axes_along((0.0, 0.0, 3.0), (1.0, 1.0, 7.0)))
    np.testing.assert_allclose(frame, [[np.sqrt(0.5), np.sqrt(0.5), 0], [-np.sqrt(0.5), np.sqrt(0.5), 0], [0, 0, 1]])
    with pytest.raises(HousingError, match="expected a direction"):
        axes_along((0.0, 0.0, 0.0))
    with pytest.raises(HousingError, match="not along another axis"):
        axes_along((0.0, 0.0, 1.0), (0.0, 0.0, -2.0))


def test_a_joint_does_no_work_in_a_motion_that_both_parts_share(pair: tuple[Mesh, Matrices]) -> None:
    mesh, _ = pair
    bushing = Bushing((3e8, 2e8, 5e8, 4e5, 6e5, 7e5), (3e3, 2e3, 5e3, 4.0, 6.0, 7.0))
    for center in (None, (0.4, -0.3, 0.2)):
        additions = Joint("j", Patch("lower"), Patch("upper"), bushing, center).additions(mesh)
        n = len(mesh.points)
        rigid = rigid_motions(mesh.points, mesh.points.mean(axis=0)).reshape(-1, 6)
        # Shared motion against the same motion of the upper part alone, which must meet the springs.
        alone = rigid.copy()
        alone[: 3 * n // 2] = 0.0
        for blocks in (additions.stiffness, additions.damping):
            matrix = blocks.matrix(n)
            shared, parted = (np.einsum("ir,ir->r", field, matrix @ field) for field in (rigid, alone))
            assert (parted > 0.0).all()
            assert np.abs(shared / parted).max() < 1e-12
            assert np.array_equal(matrix.toarray(), matrix.toarray().T)


def test_two_free_bodies_with_a_joint_have_six_rigid_modes_and_six_of_the_joint(pair: tuple[Mesh, Matrices]) -> None:
    """Along the joint's axis ω² = k (1/m₁ + 1/m₂), about it ω² = k_t (1/I₁ + 1/I₂)."""
    mesh, free = pair
    assert solve_modes(free, count=12).frequencies[:12].max() == 0.0
    bolt = Bushing.along((0, 0, 1), Axial(axial=4e5, shear=1e5, tilting=900.0, torsional=300.0))
    matrices = attach_fixtures(free, mesh, [Joint("bolt", Patch("lower"), Patch("upper"), bolt)])
    modes = solve_modes(matrices, count=12)
    assert modes.certificate.complete
    assert modes.frequencies[:6].max() == 0.0
    assert modes.frequencies[6] > 100.0
    mass, inertia = _block_body()
    for expected in (np.sqrt(4e5 * 2 / mass), np.sqrt(300.0 * 2 / inertia[2])):
        assert np.abs(modes.frequencies[6:12] / expected - 1).min() < 1e-4


def test_a_stiff_joint_welds_two_halves(block: Callable[..., Mesh], steel: Material) -> None:
    """Halves of a bar whose faces move as one by a very stiff joint: lengthwise modes are those of the whole bar.

    With Poisson's ratio 0 a lengthwise wave leaves cross-sections plane, so the joint hinders nothing: f = c n / 2L.
    """
    material = Material(210e9, 0.0, 7800.0)
    one = block((0.01, 0.01, 0.1), (1, 1, 4))
    mesh = _stacked(one, one.points + [0.0, 0.0, 0.1])
    joint = Joint("weld", Patch("lower"), Patch("upper"), Bushing((1e14, 1e14, 1e14, 1e10, 1e10, 1e10)))
    matrices = attach_fixtures(assemble(mesh, material), mesh, [joint])
    expected = np.pi * np.sqrt(210e9 / 7800.0) / 0.2
    modes = solve_modes(matrices, frequency_limit=1.05 * expected)
    assert np.abs(modes.frequencies / expected - 1).min() < 1e-4


def test_whole_matrices_stand_on_one_pattern(pair: tuple[Mesh, Matrices]) -> None:
    mesh, free = pair
    inertia = ((2e-3, 0, 0), (0, 2e-3, 0), (0, 0, 3e-3))
    attached = attach_fixtures(
        free,
        mesh,
        [
            Support("base", surface="bottom", stiffness=(1e7, 2e7, 3e7), damping=(10.0, 0.0, 5.0)),
            Joint("bolt", Patch("lower"), Patch("upper"), Bushing((1e8,) * 3 + (1e4,) * 3, (50.0,) * 6)),
            LumpedMass("motor", 1.5, LID, inertia=inertia, offset=(0.0, 0.01, 0.05)),
        ],
    )
    stiffness = attached.stiffness
    for shift in (0.0, -1e4, 3e7):
        shifted = attached.shifted(shift)
        assert np.array_equal(shifted.indptr, stiffness.indptr)
        assert np.array_equal(shifted.indices, stiffness.indices)
        difference = (stiffness - shift * attached.mass - shifted).toarray()
        assert np.abs(difference).max() <= 1e-13 * np.abs(shifted).max()
    for matrix in (attached.stiffness, attached.mass, attached.damping):
        dense = matrix.toarray()
        np.testing.assert_allclose(dense, dense.T, rtol=0.0, atol=1e-14 * np.abs(dense).max())
    assert np.linalg.eigvalsh(attached.mass.toarray())[0] > 0.0


def test_attached_one_by_one_or_together_is_the_same(pair: tuple[Mesh, Matrices]) -> None:
    mesh, free = pair
    things = [
        Mount("a", BASE, Bushing((1e7,) * 6, (3.0,) * 6)),
        LumpedMass("b", 0.4, LID, offset=(0.01, 0.0, 0.0)),
        LumpedMass("c", 0.2, position=(0.03, 0.03, 0.13)),
        Joint("d", Patch("lower"), Patch("upper"), Bushing((1e8,) * 6)),
    ]
    together, serial_map = attach_fixtures(free, mesh, things), free
    for thing in reversed(things):
        serial_map = attach_fixtures(serial_map, mesh, [thing])
    for name in ("stiffness", "mass", "damping"):
        ours, theirs = getattr(together, name).toarray(), getattr(serial_map, name).toarray()
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-14 * np.abs(ours).max())


def test_nothing_attached_leaves_the_matrices_as_they_are(solid: tuple[Mesh, Matrices]) -> None:
    mesh, free = solid
    same = attach_fixtures(free, mesh, [])
    assert same.blocks is free.blocks
    assert same.neighbors is free.neighbors
    assert same.damping.nnz == 0
    damped = attach_fixtures(free, mesh, [Support("d", surface="bottom", damping=(1.0, 2.0, 3.0))])
    assert damped.blocks is free.blocks


def test_a_dashpot_meets_a_translation_and_spares_the_stiffness(solid: tuple[Mesh, Matrices]) -> None:
    mesh, free = solid
    damped = attach_fixtures(free, mesh, [Support("d", surface="bottom", damping=(7.0, 0.0, 3.0))])
    translations = rigid_motions(mesh.points, np.zeros(3)).reshape(-1, 6)[:, :3]
    resistance = translations.T @ damped.damping @ translations
    np.testing.assert_allclose(resistance, np.diag([7.0, 0.0, 3.0]), atol=1e-12)
    assert np.array_equal(damped.stiffness.data, free.stiffness.data)


def test_too_large_a_patch_is_refused() -> None:
    from scipy import sparse

    count = MOST_PATCH_NODES + 1
    port = sparse.csr_array(np.ones((1, 3 * count)))
    with pytest.raises(HousingError, match=rf"mount 'm' ties {count} nodes.*smaller patch or larger elements"):
        port_fixture_matrices(port, name="mount 'm'", stiffness=np.eye(1))


def test_bushings_and_joints_that_make_no_sense_are_refused() -> None:
    with pytest.raises(HousingError, match="none of them negative"):
        Bushing((1.0, -1.0, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(HousingError, match="none of them negative"):
        Bushing((1.0, np.nan, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(HousingError, match="all zero hold nothing"):
        Bushing()
    with pytest.raises(HousingError, match="right-handed"):
        Bushing((1.0,) * 6, axes=((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)))
    with pytest.raises(HousingError, match="at right angles"):
        Bushing((1.0,) * 6, axes=((1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    with pytest.raises(HousingError, match="'j' ties a patch to itself"):
        Joint("j", LID, LID, Bushing((1.0,) * 6))
