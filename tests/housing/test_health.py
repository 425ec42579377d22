"""The health report: quiet where all is well, and each of its checks caught failing."""

from dataclasses import replace

import numpy as np
import pytest

from gearwhine.housing import (
    Certificate,
    HealthReport,
    LumpedMass,
    Material,
    ModeSet,
    Patch,
    Seat,
    Support,
    assemble,
    attach_fixtures,
    health_report,
    solve_modes,
)
from gearwhine.housing.errors import HealthError
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.material import enclosed_volume
from gearwhine.housing.model.seats import seat_matrix
from gearwhine.housing.model.supports import grounding
from gearwhine.housing.modes.health import HealthLine
from gearwhine.meshes import Mesh

FEET = tuple(Support(f"foot {number}", surface=f"foot-{number}", stiffness=(2e8, 8e8, 3e8)) for number in (1, 2, 3, 4))
DENSITY = 7850.0


@pytest.fixture(scope="module")
def sprung(box: Mesh, box_matrices: Matrices) -> Matrices:
    return attach_fixtures(box_matrices, box, FEET)


@pytest.fixture(scope="module")
def modes(box: Mesh, sprung: Matrices) -> ModeSet:
    port = seat_matrix(box, Seat("front-seat", (-0.03, 0.08, 0.12)))[:2]
    return solve_modes(sprung, frequency_limit=2 * np.pi * 3000.0, ports=port)


def report(box: Mesh, unsupported: Matrices, sprung: Matrices, modes: ModeSet) -> HealthReport:
    volume, center = enclosed_volume(box)
    return health_report(box, unsupported, sprung, FEET, modes, mass=DENSITY * volume, center=center)


def failing(health: HealthReport) -> list[str]:
    return [line.name for line in health.lines if not line.ok]


def test_a_sound_housing_passes(box: Mesh, box_matrices: Matrices, sprung: Matrices, modes: ModeSet) -> None:
    health = report(box, box_matrices, sprung, modes)
    assert failing(health) == []
    assert health.ok
    health.require()
    assert health.body.mass == pytest.approx(box_matrices.total_mass, rel=1e-12)
    lines = {line.name: line for line in health.lines}
    assert 0.0 < lines["static error, modes alone"].value < 1.0
    assert lines["static error, with attachments"].value < 1e-10


def test_a_large_housing_is_checked_without_matrices_of_its_own(
    box: Mesh, box_matrices: Matrices, modes: ModeSet, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Products of the blocks, on feet and with a mass, against those of the matrices; the checks take no others."""
    motor = LumpedMass("motor", 3.0, Patch(surface="foot-1"), offset=(0.0, 0.2, 0.0))
    whole = attach_fixtures(box_matrices, box, [*FEET, motor])
    x = np.random.default_rng(3).standard_normal((3 * len(box.points), 7))
    expected = whole.stiffness @ x, abs(whole.stiffness) @ x, whole.mass @ x
    monkeypatch.setattr("gearwhine.housing.fem.matrices._NODES_BY_BLOCKS", 0)
    free, large = replace(box_matrices), replace(whole)
    products = large.stiffness_operator @ x, large.absolute_stiffness_operator @ x, large.mass_operator @ x
    for product, by_matrix in zip(products, expected, strict=True):
        assert np.abs(product - by_matrix).max() < 1e-13 * np.abs(by_matrix).max()
    sprung = attach_fixtures(free, box, FEET)
    assert failing(report(box, free, sprung, modes)) == []
    assert not {"stiffness", "mass"} & set(vars(free) | vars(sprung))


def test_volume_and_centroid_of_a_cylinder_bored_box(box: Mesh) -> None:
    """Against the sums of the elements' own volumes, whose corners' part is exact for the straight ones."""
    from gearwhine.housing.fem.assembly import assemble as sum_elements

    body = sum_elements(box, Material(207e9, 0.3, 1.0))  # of unit density: its mass is its volume
    volume, center = enclosed_volume(box)
    assert volume == pytest.approx(body.total_mass, rel=1e-12)
    weights = body.mass.sum(axis=0).reshape(-1, 3)[:, 0]
    np.testing.assert_allclose(center, weights @ box.points / weights.sum(), atol=1e-9)


def test_wrong_density_unit_or_geometry_is_caught(
    box: Mesh, box_matrices: Matrices, sprung: Matrices, modes: ModeSet
) -> None:
    volume, center = enclosed_volume(box)
    with pytest.raises(HealthError, match="mass 1e-05"):
        health_report(
            box, box_matrices, sprung, FEET, modes, mass=DENSITY * volume * (1 + 1e-5), center=center
        ).require()
    off = center + np.array([0.0, 1e-4, 0.0])
    wrong = health_report(box, box_matrices, sprung, FEET, modes, mass=DENSITY * volume, center=off)
    assert failing(wrong) == ["centre of gravity"]


def test_a_stiffness_that_resists_rigid_motion_is_caught(box: Mesh, sprung: Matrices, modes: ModeSet) -> None:
    """The supported matrices taken for the unsupported."""
    assert failing(report(box, sprung, sprung, modes)) == ["rigid-body strain"]


def test_an_unsymmetric_stiffness_is_caught(
    box: Mesh, box_matrices: Matrices, sprung: Matrices, modes: ModeSet
) -> None:
    blocks = sprung.blocks.copy()
    blocks[0, 0, 1] += 1e-6 * np.abs(blocks).max()
    assert "symmetry" in failing(report(box, box_matrices, replace(sprung, blocks=blocks), modes))


def test_modes_that_are_not_its_own_are_caught(
    box: Mesh, box_matrices: Matrices, sprung: Matrices, modes: ModeSet
) -> None:
    mixed = modes.shapes.copy()
    mixed[0] += 1e-4 * mixed[1]
    health = report(box, box_matrices, sprung, replace(modes, shapes=mixed))
    assert failing(health) == ["orthogonality in mass", "orthogonality in stiffness"]
    moved = replace(modes, frequencies=modes.frequencies * 1.001)
    assert failing(report(box, box_matrices, sprung, moved)) == ["orthogonality in stiffness"]
    short = replace(modes, certificate=replace(modes.certificate, expected=modes.certificate.expected + 1))
    assert failing(report(box, box_matrices, sprung, short)) == ["certificate"]
    with pytest.raises(HealthError, match="the inertia demands"):
        report(box, box_matrices, sprung, short).require()


def test_parts_that_are_not_joined_are_told(block, steel: Material) -> None:
    """Two cubes, one clamped: six rigid modes where none belongs; right numbers, but hardly what was meant."""
    one = block((0.1, 0.1, 0.1))
    points = np.vstack([one.points, one.points + [0.3, 0.0, 0.0]])
    cells = one.blocks[0].nodes
    bottom = one.surface("bottom")[0].nodes
    two = Mesh.of_tetrahedra(points, np.vstack([cells, cells + len(one.points)]), {"bottom": bottom})
    matrices = assemble(two, steel)
    support = Support("root", surface="bottom", fixed=(True, True, True))
    modes = solve_modes(attach_fixtures(matrices, two, [support]), count=8)
    volume, center = enclosed_volume(two)
    health = health_report(two, matrices, matrices, [support], modes, mass=DENSITY * volume, center=center)
    assert failing(health) == ["rigid modes"]
    assert "joined?" in next(line.why for line in health.lines if line.name == "rigid modes")
    health.require()  # for the engineer to judge


@pytest.mark.parametrize(
    ("supports", "free", "named"),
    [
        ((), 6, {"x", "y", "z", "rotation x", "rotation y", "rotation z"}),
        ((Support("a", surface="foot-1", fixed=(True, True, True)),), 0, set()),
        ((Support("a", surface="foot-1", fixed=(False, True, False)),), 3, {"x", "z", "rotation y"}),
        ((Support("a", surface="foot-1", stiffness=(0.0, 1.0, 0.0)),), 3, {"x", "z", "rotation y"}),
        (
            (
                Support("a", surface="foot-1", stiffness=(1e9, 0.0, 0.0)),
                Support("b", surface="foot-2", fixed=(False, True, True)),
            ),
            0,
            set(),
        ),
    ],
)
def test_what_the_supports_leave_free(box: Mesh, supports: tuple[Support, ...], free: int, named: set[str]) -> None:
    """A plane patch that slides holds its normal and the two rotations that tilt it, and no more."""
    held = grounding(box, supports, np.array([0.0, 0.0, 0.0]))
    assert held.free_motions == free
    assert named <= set(held.free_directions)


def test_shares_of_the_feet(box: Mesh) -> None:
    """Translations by the springs' own stiffness, whatever their places; rocking by the square of the distance."""
    center = np.array([0.0, 0.08, 0.0])
    held = grounding(box, FEET, center)
    for foot in held.supports:
        np.testing.assert_allclose(foot.stiffness[:3], FEET[0].stiffness, rtol=1e-9)
        np.testing.assert_allclose(foot.share[:3], 0.25, rtol=1e-9)
    # A foot of 40 x 50 mm in the corner of a base of 200 x 240 mm: ∫ z² dA / A = z̄² + 0.05² / 12, and so for y.
    high = 0.08 - min(box.points[:, 1]) if box.points[:, 1].min() < 0 else 0.08
    rocking = 8e8 * ((0.12 - 0.025) ** 2 + 0.05**2 / 12) + 3e8 * high**2
    np.testing.assert_allclose([foot.stiffness[3] for foot in held.supports], rocking, rtol=1e-9)


def test_a_housing_free_to_move_is_told_not_refused(box: Mesh, box_matrices: Matrices) -> None:
    slide = (Support("slide", surface="foot-1", fixed=(False, True, False)),)
    modes = solve_modes(attach_fixtures(box_matrices, box, slide), count=5)
    volume, center = enclosed_volume(box)
    health = health_report(box, box_matrices, box_matrices, slide, modes, mass=DENSITY * volume, center=center)
    assert failing(health) == ["grounding"]
    assert "can still move: x, z, rotation y" in next(line.why for line in health.lines if not line.ok)
    health.require()
    assert (modes.frequencies[:3] == 0.0).all()


def test_no_number_is_no_pass() -> None:
    assert not HealthLine("a", float("nan"), 1.0, "").ok
    assert HealthLine("a", float("inf"), None, "").ok
    assert not Certificate(1.0, 2, 1, 0.0, 0.0).complete
