"""Ill meshes, each made on purpose, are told by name; sound ones are not doubted."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.meshes import ElementBlock, GeometryError, Mesh, MeshDefect, diagnose
from gearwhine.meshes.diagnosis import bodies
from gearwhine.meshes.elements import KINDS, SOLIDS


def _join(first: Mesh, second: Mesh, offset: tuple[float, float, float], *, merge: bool) -> Mesh:
    """Two meshes in one; with ``merge``, nodes at the same place become one."""
    points = np.vstack([first.points, second.points + offset])
    blocks = (*first.blocks, *(ElementBlock(b.kind, b.nodes + len(first.points)) for b in second.blocks))
    if not merge:
        return Mesh(points, blocks)
    _, index, inverse = np.unique(np.round(points * 1e6), axis=0, return_index=True, return_inverse=True)
    return Mesh(points[index], tuple(ElementBlock(b.kind, inverse[b.nodes]) for b in blocks))


def _only(mesh: Mesh, **options: float) -> MeshDefect:
    (mesh_defect,) = diagnose(mesh, **options)
    return mesh_defect


@pytest.mark.parametrize("kind", SOLIDS)
def test_sound_meshes_are_not_doubted(block_of: Callable[..., Mesh], kind: str) -> None:
    assert diagnose(block_of(kind, cells=(3, 2, 2)), unit=1.0) == ()


def test_a_housing_with_everything_is_not_doubted(straight: Mesh, curved: Mesh) -> None:
    assert diagnose(straight, unit=1.0) == diagnose(curved, unit=1.0) == ()


def test_kinds_that_share_their_faces_are_sound(block_of: Callable[..., Mesh]) -> None:
    stack = _join(block_of("wedge15"), block_of("hexahedron20"), (1.0, 0.0, 0.0), merge=True)
    assert diagnose(stack) == ()
    assert bodies(stack).max() == 0


def test_loose_bodies_are_counted_and_placed(block_of: Callable[..., Mesh]) -> None:
    mesh = _join(block_of("tetra", cells=(2, 1, 1)), block_of("tetra", (0.5, 0.5, 0.5)), (4.0, 0.0, 0.0), merge=False)
    found = _only(mesh)
    assert (found.name, found.severity, found.count) == ("disconnected", "warning", 2)
    assert "one of 11.1 % of the volume around (4.25, 0.25, 0.25) m" in found.message
    assert np.bincount(bodies(mesh)).tolist() == [12, 6]


@pytest.mark.parametrize("kind", ["tetra10", "hexahedron", "wedge"])
def test_unmerged_bodies_are_told_from_loose_ones(block_of: Callable[..., Mesh], kind: str) -> None:
    mesh = _join(block_of(kind, cells=(1, 2, 2)), block_of(kind, cells=(1, 2, 2)), (1.0, 0.0, 0.0), merge=False)
    error, warning = diagnose(mesh)
    assert (error.name, error.severity, error.count) == ("disconnected", "error", 9)
    assert "falls into 2 bodies whose nodes coincide at 9 places, the first at (1, 0, 0) m; merge them" in error.message
    assert (warning.name, warning.severity) == ("disconnected", "warning")
    assert diagnose(_join(*[block_of(kind, cells=(1, 2, 2))] * 2, (1.0, 0.0, 0.0), merge=True)) == ()


def test_bodies_that_joints_connect_may_touch_and_others_are_told(block_of: Callable[..., Mesh]) -> None:
    """Three cubes in a row, unmerged: each joint takes away the four places where its two cubes meet."""
    one = block_of("hexahedron")
    row = _join(_join(one, one, (1.0, 0.0, 0.0), merge=False), one, (2.0, 0.0, 0.0), merge=False)
    first, second, third = np.split(np.arange(24), 3)
    ends = [np.array([first[0], second[0]]), np.array([third[0], second[3]])]
    assert [found.count for found in diagnose(row)] == [8, 3]
    error, warning = diagnose(row, joined=ends[:1])
    assert (error.name, error.severity, error.count, error.place[0]) == ("disconnected", "error", 4, 2.0)
    assert (warning.name, warning.count) == ("disconnected", 2)
    assert "2 bodies that share no node and no joint: beside the largest one of 33.3 % of the volume" in warning.message
    assert diagnose(row, joined=ends) == ()
    assert diagnose(row, joined=[np.array([first[0], third[0]]), ends[0]]) == ()
    # A joint within a body connects nothing.
    assert [found.count for found in diagnose(row, joined=[first[:2]])] == [8, 3]


def test_unmatched_bodies_that_a_joint_connects_are_no_defect(block_of: Callable[..., Mesh]) -> None:
    one = block_of("hexahedron", (2.0, 2.0, 1.0))
    mesh = _join(one, one, (0.5, 0.5, 1.0), merge=False)
    assert diagnose(mesh, joined=[np.array([0, 8])]) == ()


def test_a_slit_within_one_body_is_told(block_of: Callable[..., Mesh]) -> None:
    """A ring of eight bricks whose last joint is not merged: one body, whose nodes meet in pairs."""
    mesh = block_of("hexahedron", (1.0, 1.0, 1.0), (8, 1, 1))
    angle = 2 * np.pi * mesh.points[:, 0]
    radius = 1.0 + mesh.points[:, 1]
    ring = replace(mesh, points=np.stack([-radius * np.cos(angle), radius * np.sin(angle), mesh.points[:, 2]], axis=1))
    found = _only(ring)
    assert (found.name, found.severity, found.count) == ("slit", "warning", 4)


def test_bricks_that_share_an_edge_or_a_node_are_hinged(block_of: Callable[..., Mesh]) -> None:
    one = block_of("hexahedron")
    for offset in ((1.0, 1.0, 0.0), (1.0, 1.0, 1.0)):
        found = _only(_join(one, one, offset, merge=True))
        assert (found.name, found.count) == ("hinged", 1)
        assert "hang on by an edge or a node alone" in found.message


def test_elements_given_twice_are_non_manifold(block_of: Callable[..., Mesh]) -> None:
    mesh = block_of("hexahedron", cells=(2, 1, 1))
    nodes = mesh.blocks[0].nodes
    names = {one.name: one for one in diagnose(replace(mesh, blocks=(ElementBlock("hexahedron", nodes[[0, 1, 1]]),)))}
    assert set(names) == {"non-manifold", "overlapping"}
    # The face between the two bricks belongs to three elements; the other five of the doubled one to two on one side.
    assert (names["non-manifold"].count, names["overlapping"].count) == (1, 5)
    assert "(1, 0.5, 0.5) m" not in names["non-manifold"].message  # x = 0.5 is where the bricks meet
    np.testing.assert_allclose(names["non-manifold"].place[0], 0.5)


def test_neighbours_on_the_same_side_overlap() -> None:
    """Two tetrahedra on one triangle, both above it."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, 1.0], [0.3, 0.3, 0.8]])
    found = _only(Mesh.of_tetrahedra(points, np.array([[0, 1, 2, 3], [0, 1, 2, 4]])))
    assert (found.name, found.severity, found.count) == ("overlapping", "error", 1)
    assert "both elements lie on the same side" in found.message


def test_inverted_and_flat_elements_make_no_mesh(block_of: Callable[..., Mesh]) -> None:
    mesh = block_of("wedge")
    nodes = mesh.blocks[0].nodes.copy()
    nodes[1] = nodes[1, KINDS["wedge"].mirrored]
    with pytest.raises(GeometryError, match="1 of 2 elements have no positive volume: 1 are inverted, 0 flat"):
        Mesh(mesh.points, (ElementBlock("wedge", nodes),))
    with pytest.raises(GeometryError, match=r"2 of 2 elements have no positive volume: 0 are inverted, 2 flat"):
        Mesh(mesh.points * [1.0, 1.0, 0.0], mesh.blocks)


def test_collapsed_and_nearly_flat_elements_are_degenerate(block_of: Callable[..., Mesh]) -> None:
    mesh = block_of("hexahedron")
    nodes = mesh.blocks[0].nodes.copy()
    nodes[0, [3, 7]] = nodes[0, [2, 6]]  # a wedge written as a brick, as some programs do
    names = {one.name: one for one in diagnose(replace(mesh, blocks=(ElementBlock("hexahedron", nodes),)))}
    assert names["degenerate"].severity == "error"
    assert "1 elements name a node twice" in names["degenerate"].message
    thin = diagnose(replace(block_of("tetra"), points=block_of("tetra").points * [1.0, 1.0, 1e-10]))[0]
    assert (thin.name, thin.severity, thin.count) == ("degenerate", "error", 6)
    assert "next to no volume" in thin.message


def test_folded_elements_and_folded_nodes_are_told_apart(block_of: Callable[..., Mesh]) -> None:
    """The middle node of an edge may move a quarter of it before the map folds at the end (quarter-point node)."""
    mesh = block_of("hexahedron20")
    middle = np.flatnonzero((mesh.points == [0.5, 0.0, 0.0]).all(axis=1))
    for shift, expected in ((0.2, []), (0.3, ["warning"]), (2.0, ["error"])):
        points = mesh.points.copy()
        points[middle, 0] += shift
        found = [one for one in diagnose(replace(mesh, points=points)) if one.name == "folded"]
        assert [one.severity for one in found] == expected


def test_bad_shapes_are_placed(block_of: Callable[..., Mesh]) -> None:
    """A brick a, a, h has the mean ratio 3 h^(2/3) / (2 + h²) by a = 1."""
    height = 0.001
    mesh = _join(block_of("hexahedron"), block_of("hexahedron", (1.0, 1.0, height)), (0.0, 0.0, 1.0), merge=True)
    found = _only(mesh)
    assert (found.name, found.severity, found.count) == ("shape", "warning", 1)
    assert f"the worst with {3 * height ** (2 / 3) / (2 + height**2):.2g} at (0.5, 0.5, 1.0005) m" in found.message


def test_unused_nodes_are_told(block_of: Callable[..., Mesh]) -> None:
    mesh = block_of("wedge")
    found = _only(replace(mesh, points=np.vstack([mesh.points, [7.0, 8.0, 9.0]])))
    assert (found.name, found.severity, found.count) == ("unused nodes", "error", 1)
    assert "(7, 8, 9) m" in found.message


def test_orders_that_meet_do_not_conform(block_of: Callable[..., Mesh]) -> None:
    mesh = _join(block_of("hexahedron20"), block_of("hexahedron"), (1.0, 0.0, 0.0), merge=True)
    found = _only(mesh)
    assert (found.name, found.severity, found.count) == ("non-conforming", "error", 4)
    assert "elements of order 1 and 2" in found.message


def test_hanging_nodes_do_not_conform(block_of: Callable[..., Mesh]) -> None:
    """Four bricks on one: the middles of its edges and of its face hang; the corners are shared."""
    coarse, fine = block_of("hexahedron"), block_of("hexahedron", cells=(1, 2, 2))
    found = _only(_join(coarse, fine, (1.0, 0.0, 0.0), merge=True))
    assert (found.name, found.severity, found.count) == ("non-conforming", "error", 5)
    assert "lie within facets that they are no part of" in found.message


def test_quadrilaterals_on_triangles_do_not_conform(block_of: Callable[..., Mesh]) -> None:
    """Their corners are shared, but an edge of the triangles crosses the quadrilateral."""
    for kinds, offset in ((("tetra", "hexahedron"), (1.0, 0.0, 0.0)), (("wedge15", "hexahedron20"), (0.0, 0.0, 1.0))):
        found = _only(_join(*map(block_of, kinds), offset, merge=True))
        assert (found.name, found.severity, found.count) == ("non-conforming", "error", 1)
        assert "1 quadrilaterals lie on triangles" in found.message


def test_loose_bodies_that_touch_with_other_meshes_are_told(block_of: Callable[..., Mesh]) -> None:
    """A plate of two bricks, shifted on a plate of two: its nodes lie within facets, none at a node."""
    one = block_of("hexahedron", (2.0, 2.0, 1.0))
    names = {one.name: one for one in diagnose(_join(one, one, (0.5, 0.5, 1.0), merge=False))}
    assert set(names) == {"disconnected", "non-conforming"}
    assert {found.severity for found in names.values()} == {"warning"}


@pytest.mark.parametrize(
    ("length", "unit", "message"),
    [
        (0.33e-3, 1e-3, r"the part is 0.33 mm long; is the unit 'mm'? With 'm' it would be 330 mm"),
        (330.0, 1.0, r"the part is 330 m long; is the unit 'm'? With 'mm' it would be 330 mm"),
        (13.0, 1.0, None),
        (0.010, 1e-3, None),
        (25.4, 1.0, "the part is 25.4 m long; is the unit 'm'? With 'in' it would be 645 mm"),
        (1e-9, 1.0, "the part is 1e-06 mm long; is the unit 'm'?"),
        (330.0, None, None),
    ],
)
def test_sizes_that_no_housing_has_are_doubted(
    block_of: Callable[..., Mesh], length: float, unit: float | None, message: str | None
) -> None:
    mesh = block_of("hexahedron", (length, 0.7 * length, 0.5 * length))
    if message is None:
        assert diagnose(mesh, unit=unit) == ()
    else:
        found = _only(mesh, unit=unit)
        assert (found.name, found.severity, found.message) == ("unit", "warning", message)
