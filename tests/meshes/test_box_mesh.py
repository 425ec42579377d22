"""The box's mesh against its closed formulas.

A circle of radius r in n straight segments loses, with α = π/n, the area n r² (α − sin α cos α). In n parabolic arcs
through the middle nodes it loses only n r² (α − sin α cos α − 4/3 sin α (1 − cos α)). The volume of a hole or a boss
may be wrong by that much times its length, and n is counted in the mesh.
"""

import numpy as np
import pytest

from gearwhine.meshes import BoxGeometry, Mesh, WallThickness, mesh_box, mesh_quality
from gearwhine.meshes.elements import facet_nodes
from gearwhine.numerics.arrays import FloatArray, IntArray

_EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])


def _area(points: FloatArray, facets: IntArray) -> float:
    """Area of triangles; of six-node ones by the three-point rule, exact where the facet is plane."""
    if facets.shape[1] == 3:
        a, b, c = np.moveaxis(points[facets], 1, 0)
        return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
    total = 0.0
    for u, v in ((1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3)):
        w = 1 - u - v
        by_u = np.array([1 - 4 * w, 4 * u - 1, 0, 4 * (w - u), 4 * v, -4 * v])
        by_v = np.array([1 - 4 * w, 0, 4 * v - 1, -4 * u, 4 * u, 4 * (w - v)])
        tangents = np.einsum("a,fai->fi", by_u, points[facets]), np.einsum("a,fai->fi", by_v, points[facets])
        total += float(np.linalg.norm(np.cross(*tangents), axis=1).sum() / 6)
    return total


def _lost(radius: float, segments: int, order: int) -> float:
    """Area that a circle loses in so many segments [m²]."""
    half = np.pi / segments
    segment = half - np.sin(half) * np.cos(half)
    if order == 2:
        segment -= 4 / 3 * np.sin(half) * (1 - np.cos(half))
    return float(segments * radius**2 * abs(segment))


def _segments(mesh: Mesh, center: tuple[float, float, float], radius: float) -> int:
    """Corner nodes on the sparsest plane ring of a cylinder along z."""
    corners = mesh.points[np.unique(mesh.blocks[0].nodes[:, :4])]
    on = np.abs(np.hypot(corners[:, 0] - center[0], corners[:, 1] - center[1]) - radius) < 1e-9
    near = np.sign(corners[:, 2]) == np.sign(center[2])
    heights = corners[on & near, 2]
    return min(np.count_nonzero(np.abs(heights - end) < 1e-9) for end in (heights.min(), heights.max()))


def _volume(geometry: BoxGeometry) -> float:
    (width, height, depth), wall = geometry.size, geometry.wall
    cavity = (width - wall.left - wall.right) * (height - wall.bottom - wall.top) * (depth - wall.back - wall.front)
    total = width * height * depth - cavity
    if geometry.feet is not None:
        total += 4 * float(np.prod(geometry.feet.size))
    for bore in geometry.bores:
        thickness = wall.back if geometry.end_wall(bore) == "back" else wall.front
        total -= np.pi / 4 * bore.diameter**2 * thickness
        if bore.boss:
            total += np.pi / 4 * (bore.boss.diameter**2 - bore.diameter**2) * bore.boss.length
    return float(total)


def _volume_allowance(geometry: BoxGeometry, mesh: Mesh, order: int) -> float:
    allowed = 0.0
    for bore in geometry.bores:
        start, end = geometry.bore_span(bore)
        allowed += _lost(bore.diameter / 2, _segments(mesh, bore.center, bore.diameter / 2), order) * (end - start)
        if bore.boss:
            lost = _lost(bore.boss.diameter / 2, _segments(mesh, bore.center, bore.boss.diameter / 2), order)
            allowed += lost * bore.boss.length
    return allowed


def _isoparametric_volume(mesh: Mesh) -> float:
    """∫ x·n dA / 3 over the curved boundary, by a rule of degree 5 on each facet (the integrand's own degree)."""
    r = np.sqrt(15.0)
    a, b = (6 - r) / 21, (6 + r) / 21
    rule = [(1 / 3, 1 / 3, 9 / 40)]
    rule += [(u, v, (155 - r) / 1200) for u, v in ((a, a), (1 - 2 * a, a), (a, 1 - 2 * a))]
    rule += [(u, v, (155 + r) / 1200) for u, v in ((b, b), (1 - 2 * b, b), (b, 1 - 2 * b))]
    nodes = mesh.points[mesh.boundary[0].nodes]
    total = 0.0
    for u, v, weight in rule:
        w = 1 - u - v
        shape = np.array([w * (2 * w - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * u * w, 4 * u * v, 4 * v * w])
        by_u = np.array([1 - 4 * w, 4 * u - 1, 0, 4 * (w - u), 4 * v, -4 * v])
        by_v = np.array([1 - 4 * w, 0, 4 * v - 1, -4 * u, 4 * u, 4 * (w - v)])
        place, along, across = (np.einsum("a,fai->fi", values, nodes) for values in (shape, by_u, by_v))
        total += weight / 2 * float(np.einsum("fi,fi->", place, np.cross(along, across))) / 3
    return total


def test_plain_box_has_the_closed_volume_and_areas_exactly() -> None:
    geometry = BoxGeometry((0.2, 0.16, 0.24), WallThickness(0.010, 0.012, 0.015, 0.011, 0.013, 0.014))
    mesh = mesh_box(geometry, 0.05, order=2)
    assert mesh_quality(mesh).volume == pytest.approx(_volume(geometry), rel=1e-9)
    expected = {"left": 0.16 * 0.24, "right": 0.16 * 0.24, "bottom": 0.2 * 0.24, "top": 0.2 * 0.24}
    expected |= {"back": 0.2 * 0.16, "front": 0.2 * 0.16}
    assert {name: _area(mesh.points, facets[0].nodes) for name, facets in mesh.surfaces.items()} == pytest.approx(
        expected
    )


def test_volume_within_the_chord_error_of_straight_facets(geometry: BoxGeometry, straight: Mesh) -> None:
    error = abs(mesh_quality(straight).volume - _volume(geometry))
    assert 0.0 < error < _volume_allowance(geometry, straight, order=1)


def test_volume_within_the_arc_error_of_curved_facets(geometry: BoxGeometry, curved: Mesh) -> None:
    error = abs(_isoparametric_volume(curved) - _volume(geometry))
    # Twice: between the ends of a bore the mesh may be sparser than at them.
    assert error < 2 * _volume_allowance(geometry, curved, order=2)


@pytest.mark.parametrize("order", [1, 2])
def test_named_surfaces_have_their_closed_areas(
    geometry: BoxGeometry, straight: Mesh, curved: Mesh, order: int
) -> None:
    mesh = straight if order == 1 else curved
    (width, height, depth), feet = geometry.size, geometry.feet
    assert feet is not None
    fx, fy, fz = feet.size
    # The outer sides of the feet are flush with the walls and belong to them.
    expected = {
        "left": (height * depth + 2 * fy * fz, 0.0),
        "right": (height * depth + 2 * fy * fz, 0.0),
        "top": (width * depth, 0.0),
        "bottom": (width * depth - 4 * fx * fz, 0.0),
    }
    expected |= {f"foot-{number}": (fx * fz, 0.0) for number in (1, 2, 3, 4)}
    for wall in ("back", "front"):
        area, allowed = width * height + 2 * fx * fy, 0.0
        for bore in geometry.bores:
            if geometry.end_wall(bore) == wall:
                radius = (bore.boss.diameter if bore.boss else bore.diameter) / 2
                area -= np.pi * radius**2
                allowed += _lost(radius, _segments(mesh, bore.center, radius), order)
        expected[wall] = (area, allowed)
    for bore in geometry.bores:
        start, end = geometry.bore_span(bore)
        radius = bore.diameter / 2
        half = np.pi / _segments(mesh, bore.center, radius)
        # Chords shorten a circle by 1 - sin α / α; a facet that spans several of them is no better.
        shortening = 1 - np.sin(half) / half if order == 1 else (1 - np.sin(half) / half) / 4
        expected[bore.name] = (2 * np.pi * radius * (end - start), 2 * shortening * 2 * np.pi * radius * (end - start))
    assert set(mesh.surfaces) == set(expected)
    for name, (area, allowed) in expected.items():
        assert abs(_area(mesh.points, mesh.surfaces[name][0].nodes) - area) <= allowed + 1e-9 * area, name


def test_feet_are_numbered_round_the_base(geometry: BoxGeometry, straight: Mesh) -> None:
    signs = {"foot-1": (-1, -1), "foot-2": (1, -1), "foot-3": (1, 1), "foot-4": (-1, 1)}
    for name, (x, z) in signs.items():
        nodes = straight.points[facet_nodes(straight.surface(name))]
        np.testing.assert_allclose(nodes[:, 1], -0.02, atol=1e-12)
        assert (np.sign(nodes[:, 0]) == x).all()
        assert (np.sign(nodes[:, 2]) == z).all()


@pytest.mark.parametrize("order", [1, 2])
def test_boundary_is_closed_and_looks_outward(straight: Mesh, curved: Mesh, order: int) -> None:
    mesh = straight if order == 1 else curved
    a, b, c = np.moveaxis(mesh.points[mesh.boundary[0].corners], 1, 0)
    normals = np.cross(b - a, c - a) / 2
    total = np.linalg.norm(normals, axis=1).sum()
    assert np.linalg.norm(normals.sum(axis=0)) < 1e-12 * total
    # Gauss: ∫ x·n dA = 3 V, with its sign.
    flux = np.einsum("fi,fi->", (a + b + c) / 3, normals)
    assert flux == pytest.approx(3 * mesh_quality(mesh).volume, rel=1e-10)


def test_every_named_facet_belongs_to_the_boundary(curved: Mesh) -> None:
    boundary = {tuple(sorted(facet)) for facet in curved.boundary[0].nodes.tolist()}
    for name, facets in curved.surfaces.items():
        assert {tuple(sorted(facet)) for facet in facets[0].nodes.tolist()} <= boundary, name


def test_middle_nodes_follow_the_order_of_vtk(geometry: BoxGeometry, curved: Mesh) -> None:
    middle = curved.points[curved.blocks[0].nodes[:, _EDGES]].mean(axis=2)
    placed = curved.points[curved.blocks[0].nodes[:, 4:]]
    offset = np.linalg.norm(placed - middle, axis=2)
    round_ = np.zeros(len(curved.points), dtype=bool)
    for bore in geometry.bores:
        for diameter in (bore.diameter, *((bore.boss.diameter,) if bore.boss else ())):
            radius = np.hypot(curved.points[:, 0] - bore.center[0], curved.points[:, 1] - bore.center[1])
            round_ |= np.abs(radius - diameter / 2) < 1e-8
    bent = round_[curved.blocks[0].nodes[:, 4:]]
    assert offset[~bent].max() < 1e-6  # gmsh itself is off by up to a few millionths of an edge
    assert bent.any()
    # A middle node on a circle is off its chord by the sagitta, less than half an edge.
    edges = np.linalg.norm(np.diff(curved.points[curved.blocks[0].nodes[:, _EDGES]], axis=2)[:, :, 0], axis=2)
    assert (offset < 0.5 * edges).all()


def test_middle_nodes_of_named_facets_lie_between_their_corners(curved: Mesh) -> None:
    for name in ("top", "foot-3", "left"):
        facets = curved.points[curved.surface(name)[0].nodes]
        for middle, (i, j) in zip((3, 4, 5), ((0, 1), (1, 2), (0, 2)), strict=True):
            np.testing.assert_allclose(facets[:, middle], (facets[:, i] + facets[:, j]) / 2, atol=1e-6)


def test_bore_nodes_lie_on_their_cylinder(geometry: BoxGeometry, curved: Mesh) -> None:
    for bore in geometry.bores:
        nodes = curved.points[facet_nodes(curved.surface(bore.name))]
        radius = np.hypot(nodes[:, 0] - bore.center[0], nodes[:, 1] - bore.center[1])
        np.testing.assert_allclose(radius, bore.diameter / 2, atol=1e-8)
        assert nodes[:, 2].min() == pytest.approx(geometry.bore_span(bore)[0], abs=1e-9)
        assert nodes[:, 2].max() == pytest.approx(geometry.bore_span(bore)[1], abs=1e-9)


def test_the_same_geometry_gives_the_same_mesh(geometry: BoxGeometry, curved: Mesh) -> None:
    again = mesh_box(geometry, 0.02, order=2)
    assert np.array_equal(again.points, curved.points)
    assert np.array_equal(again.blocks[0].nodes, curved.blocks[0].nodes)
    assert all(np.array_equal(again.surface(name)[0].nodes, curved.surface(name)[0].nodes) for name in curved.surfaces)


def test_every_node_is_used_and_edges_have_the_size_asked_for(curved: Mesh) -> None:
    assert np.array_equal(np.unique(curved.blocks[0].nodes), np.arange(len(curved.points)))
    _, median, largest = mesh_quality(curved).edge_length
    assert 0.5 * 0.02 < median < 1.5 * 0.02
    assert largest < 3 * 0.02
