"""Ribs, cover, bolt patches and fillets against their closed volumes, areas and places."""

import math

import numpy as np
import pytest

from gearwhine.meshes import (
    Bore,
    Boss,
    BoxGeometry,
    Cover,
    CoverBolts,
    Feet,
    Fillets,
    Flange,
    Mesh,
    Rib,
    WallThickness,
    find_bores,
    mesh_box,
)
from gearwhine.meshes.elements import Facets, facet_nodes
from gearwhine.meshes.shape_functions import quadrature, shape_functions

SIZE = (0.20, 0.16, 0.24)
WALL = WallThickness(left=0.010, right=0.012, bottom=0.015, top=0.011, back=0.013, front=0.014)
CAVITY = (0.178, 0.134, 0.213)
PLAIN = float(np.prod(SIZE) - np.prod(CAVITY))


def _area(mesh: Mesh, facets: Facets) -> float:
    """Area of curved facets by quadrature."""
    total = 0.0
    for block in facets:
        places, weights = quadrature(block.kind, 4)
        _, gradients = shape_functions(block.kind, places)
        tangents = np.einsum("fai,qaj->fqij", mesh.points[block.nodes], gradients)
        total += float((np.linalg.norm(np.cross(tangents[..., 0], tangents[..., 1]), axis=2) @ weights).sum())
    return total


def _rounded(size: tuple[float, float, float], radius: float) -> float:
    """Volume of a box with all its edges rounded (Steiner's formula for the box that the balls' middles fill)."""
    a, b, c = (length - 2 * radius for length in size)
    return (
        a * b * c
        + 2 * radius * (a * b + b * c + c * a)
        + math.pi * radius**2 * (a + b + c)
        + 4 / 3 * math.pi * radius**3
    )


def test_ribs_add_what_they_are_made_of() -> None:
    ribs = (
        Rib("left", "y", at=0.03, height=0.02, thickness=0.008),
        Rib("top", "x", at=-0.05, height=0.015, thickness=0.006, start=-0.05, end=0.07),
        Rib("bottom", "z", at=0.02, height=0.03, thickness=0.01, side="inside"),
        Rib("back", "x", at=0.1, height=0.012, thickness=0.009, side="inside", start=-0.08, end=0.01),
    )
    mesh = mesh_box(BoxGeometry(SIZE, WALL, ribs=ribs), 0.04, order=1)
    added = 0.02 * 0.008 * 0.16 + 0.015 * 0.006 * 0.12 + 0.03 * 0.01 * CAVITY[2] + 0.012 * 0.009 * 0.09
    assert mesh.element_volumes.sum() == pytest.approx(PLAIN + added, rel=1e-9)
    # The wall's own face is what the ribs leave of it.
    assert _area(mesh, mesh.surface("left")) == pytest.approx(SIZE[1] * (SIZE[2] - 0.008), rel=1e-9)
    # A rib that runs the whole height ends flush with the top, which it widens.
    top = SIZE[0] * SIZE[2] - 0.006 * 0.12 + 0.02 * 0.008
    assert _area(mesh, mesh.surface("top")) == pytest.approx(top, rel=1e-9)
    np.testing.assert_allclose(mesh.bounds, [[-0.12, 0.0, -0.12], [0.10, 0.175, 0.12]], atol=1e-12)


def test_ribs_may_cross() -> None:
    ribs = (Rib("right", "y", 0.0, 0.02, 0.008), Rib("right", "z", 0.08, 0.02, 0.006))
    mesh = mesh_box(BoxGeometry(SIZE, WALL, ribs=ribs), 0.04, order=1)
    added = 0.02 * (0.008 * 0.16 + 0.006 * 0.24 - 0.008 * 0.006)
    assert mesh.element_volumes.sum() == pytest.approx(PLAIN + added, rel=1e-9)


@pytest.mark.parametrize("face", ["top", "front", "left"])
@pytest.mark.parametrize("side", ["outside", "inside"])
def test_a_cover_lies_on_a_flange_and_shares_nodes_only_where_bonded(face: str, side: str) -> None:
    width, thickness = 0.018, 0.014
    axis = {"left": 0, "top": 1, "front": 2}[face]
    a, b = (other for other in range(3) if other != axis)
    bolts = CoverBolts(diameter=0.006, per_edge=(2, 3), patch_diameter=0.015)
    bolted = BoxGeometry(SIZE, WALL, cover=Cover(face, Flange(width, thickness, side), bolts))  # type: ignore[arg-type]
    bonded = BoxGeometry(SIZE, WALL, cover=Cover(face, Flange(width, thickness, side), bonded=True))  # type: ignore[arg-type]
    if side == "outside":
        ring = (SIZE[a] + 2 * width) * (SIZE[b] + 2 * width) - SIZE[a] * SIZE[b]
        expected = PLAIN + ring * (thickness + WALL.of(face))  # type: ignore[arg-type]
    else:
        ring = CAVITY[a] * CAVITY[b] - (CAVITY[a] - 2 * width) * (CAVITY[b] - 2 * width)
        expected = PLAIN + ring * thickness
    for geometry in (bolted, bonded):
        mesh = mesh_box(geometry, 0.05, order=1)
        assert mesh.element_volumes.sum() == pytest.approx(expected, rel=1e-9)
        (block,) = mesh.blocks
        cover, body = (np.unique(block.nodes[mesh.volumes[part]]) for part in ("cover", "body"))
        shared = np.intersect1d(cover, body)
        if geometry is bolted:
            assert shared.size == 0
            assert len(geometry.bolts) == 6
        else:
            plane = (SIZE[axis] / 2 if axis != 1 else SIZE[1]) - WALL.of(face)  # type: ignore[arg-type]
            plane = -plane if face == "left" else plane
            np.testing.assert_allclose(mesh.points[shared, axis], plane, atol=1e-12)
            assert np.ptp(mesh.points[shared], axis=0)[a] > CAVITY[a]
            assert geometry.bolts == ()


def test_bolts_stand_in_rows_round_the_rim_with_a_patch_on_each_side() -> None:
    bolts = CoverBolts(diameter=0.006, per_edge=(3, 4), patch_diameter=0.016)
    geometry = BoxGeometry(SIZE, WALL, cover=Cover("top", Flange(0.018, 0.014), bolts))
    mesh = mesh_box(geometry, 0.02, order=2)
    # The rim reaches from 18 mm outside the box to the inside of each wall.
    x, z = [-0.104, 0.0, 0.103], np.linspace(-0.1225, 0.122, 4)
    low, high = (-0.118 - 0.090) / 2, (0.118 + 0.088) / 2
    assert [low, high] == pytest.approx([x[0], x[2]])
    assert len(geometry.bolts) == 10
    places = {(round(bolt.position[0], 6), round(bolt.position[2], 6)) for bolt in geometry.bolts}
    rows = {(round(u, 6), round(v, 6)) for u in (low, (low + high) / 2, high) for v in (z[0], z[3])}
    rows |= {(round(u, 6), round(v, 6)) for u in (low, high) for v in z}
    assert places == rows
    for bolt in geometry.bolts:
        assert bolt.axis == (0.0, 1.0, 0.0)
        assert bolt.position[1] == pytest.approx(SIZE[1] - WALL.top)
        # A screw in the tapped flange: the cover and half the bolt's diameter (Shigley, Table 8-7, t2 >= d).
        assert bolt.grip == pytest.approx(0.011 + 0.003)
        for name in (bolt.cover_surface, bolt.body_surface):
            assert _area(mesh, mesh.surface(name)) == pytest.approx(math.pi / 4 * 0.016**2, rel=2e-3)
            nodes = mesh.points[facet_nodes(mesh.surface(name))]
            np.testing.assert_allclose(nodes[:, 1], bolt.position[1], atol=1e-9)
            assert np.hypot(*(nodes - bolt.position)[:, [0, 2]].T).max() == pytest.approx(0.008, rel=1e-6)


def test_a_seat_in_the_cover_is_bored_through_plate_and_boss() -> None:
    bores = (Bore("lid", (0.0, 0.08, 0.12), 0.05, Boss(0.07, 0.009)), Bore("wall", (0.0, 0.08, -0.12), 0.04))
    rib = Rib("front", "y", at=0.06, height=0.02, thickness=0.008)
    cover = Cover("front", Flange(0.018, 0.014), CoverBolts(0.006, (2, 2)))
    mesh = mesh_box(BoxGeometry(SIZE, WALL, bores, cover=cover, ribs=(rib,)), 0.02, order=2)
    (block,) = mesh.blocks
    plate = mesh.volumes["cover"]
    assert np.isin(facet_nodes(mesh.surface("lid")), block.nodes[plate]).all()
    assert [(bore.diameter, bore.length) for bore in find_bores(mesh)] == [
        pytest.approx((0.05, 0.023)),
        pytest.approx((0.04, 0.013)),
    ]
    # The rib runs over the whole plate, the flange's part too.
    expected = (
        (SIZE[0] + 0.036) * (SIZE[1] + 0.036) * WALL.front
        + math.pi / 4 * (0.07**2 * 0.009 - 0.05**2 * 0.023)
        + 0.02 * 0.008 * (SIZE[1] + 0.036)
    )
    assert mesh.element_volumes[plate].sum() == pytest.approx(expected, rel=1e-4)


def test_feet_carry_the_circles_of_their_bolts() -> None:
    mesh = mesh_box(BoxGeometry(SIZE, WALL, feet=Feet((0.04, 0.02, 0.05), bolt_patch=0.03)), 0.015, order=2)
    assert mesh.element_volumes.sum() == pytest.approx(PLAIN + 4 * 0.04 * 0.02 * 0.05, rel=1e-6)
    for number, (x, z) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
        circle = mesh.surface(f"foot-{number}-bolt")
        assert _area(mesh, circle) == pytest.approx(math.pi / 4 * 0.03**2, rel=2e-3)
        assert _area(mesh, mesh.surface(f"foot-{number}")) == pytest.approx(0.04 * 0.05, rel=1e-9)
        middle = mesh.points[facet_nodes(circle)].mean(axis=0)
        np.testing.assert_allclose(middle, [x * 0.08, -0.02, z * 0.095], atol=5e-4)


def test_fillets_round_the_cavity_and_the_box() -> None:
    inside, outside = 0.030, 0.012
    mesh = mesh_box(BoxGeometry(SIZE, WALL, fillets=Fillets(inside, outside)), 0.02, order=2)
    sharp = float(np.prod(CAVITY))
    changed = (sharp - _rounded(CAVITY, inside)) - (float(np.prod(SIZE)) - _rounded(SIZE, outside))
    assert mesh.element_volumes.sum() - PLAIN == pytest.approx(
        changed, rel=0.02
    )  # a quarter circle in two or three parabolas
    assert _area(mesh, mesh.surface("top")) == pytest.approx((0.20 - 2 * outside) * (0.24 - 2 * outside), rel=1e-6)
    assert mesh.corner_volumes.min() > 0.0


def test_elements_that_small_fillets_would_fold_are_straightened() -> None:
    """Fillets of a fifth of the element size: every element keeps a positive Jacobian, and most stay curved."""
    mesh = mesh_box(BoxGeometry(SIZE, WALL, fillets=Fillets(0.006, 0.004)), 0.02, order=2)
    (block,) = mesh.blocks
    places, _ = quadrature("tetra10", 4)
    _, gradients = shape_functions("tetra10", places)
    jacobians = np.linalg.det(np.einsum("fai,qaj->fqij", mesh.points[block.nodes], gradients))
    assert jacobians.min() > 0.0
    sharp = float(np.prod(CAVITY))
    changed = (sharp - _rounded(CAVITY, 0.006)) - (float(np.prod(SIZE)) - _rounded(SIZE, 0.004))
    assert mesh.element_volumes.sum() - PLAIN == pytest.approx(changed, rel=0.1)
